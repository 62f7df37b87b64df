//! The one place that turns the dimensionless quantities of a bench into those on the screen: of a rotor given in SI units
//! micrometres, newtons, rpm and hertz, of any other what it is counted in. `tau` stays `tau`, with seconds beside it where there is room.

use alarms::Watch;
use rotor::{ChangedValue, ControlMasses, Difference, Feedback, GainKind, Key, Rotor, Scales, Settings, SettingsError};
use text::number::{nice_ceiling, short, significant};
use units::{Dimension, Typed, TypedError};

pub use units::Unit;

/// The part of the largest gain of a signal that a step of one of them is at least, but for rounding down.
const OF_LARGEST: f64 = 0.01;
/// Significant digits of a value in a message.
const DIGITS: usize = 7;

/// What is watched, as a quantity.
#[must_use]
pub fn dimension_of(watch: Watch) -> Dimension {
    match watch {
        Watch::Orbit => Dimension::Length,
        Watch::Force => Dimension::Force,
        Watch::DelayMargin => Dimension::Time,
        _ => Dimension::Number,
    }
}

/// The units of a bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Scales of a rotor in SI units.
    pub scales: Option<Scales>,
    /// Displacements and clearances.
    pub length: Unit,
    /// Velocities of masses.
    pub velocity: Unit,
    /// The control force of the first control bearing, in which the largest of several is told too.
    pub force: Unit,
    /// By which control is a force, bearing by bearing.
    pub masses: ControlMasses,
    /// Frequencies of whirl.
    pub frequency: Unit,
    /// Real and imaginary parts of poles.
    pub rate: Unit,
    /// Spin speeds.
    pub speed: Unit,
}

impl Units {
    /// Those of a rotor that is counted in its own scales.
    pub const DIMENSIONLESS: Self = Self {
        scales: None,
        length: Unit { factor: 1.0, name: "e_t" },
        velocity: Unit { factor: 1.0, name: "w0 e_t" },
        force: Unit { factor: 1.0, name: "m_b w0² e_t" },
        masses: ControlMasses::ONES,
        frequency: Unit { factor: 1.0, name: "w0" },
        rate: Unit { factor: 1.0, name: "w0" },
        speed: Unit { factor: 1.0, name: "R" },
    };

    /// Those of a machine.
    pub fn of_machine(rotor: &Rotor, feedback: &Feedback) -> Self {
        Self::of(rotor.scales().copied(), ControlMasses::of(rotor, feedback))
    }

    /// Those of a bench whose bench status has `scales`, with control bearings that carry these masses.
    pub fn of(scales: Option<Scales>, masses: ControlMasses) -> Self {
        let Some(scales) = scales else { return Self { masses, ..Self::DIMENSIONLESS } };
        // One prefix for a rotor, whatever it does: numbers must not jump.
        let (per_metre, length, velocity) = match scales.e_t {
            ..1e-3 => (1e6, "μm", "μm/s"),
            ..1.0 => (1e3, "mm", "mm/s"),
            _ => (1.0, "m", "m/s"),
        };
        let si = |dimension: Dimension| dimension.si(&scales, masses.ratio(0));
        let with_prefix = |dimension, name| Unit { factor: si(dimension).factor * per_metre, name };
        Self {
            scales: Some(scales),
            length: with_prefix(Dimension::Length, length),
            velocity: with_prefix(Dimension::Velocity, velocity),
            force: si(Dimension::Force),
            masses,
            frequency: si(Dimension::Frequency),
            rate: si(Dimension::Rate),
            speed: si(Dimension::Speed),
        }
    }

    /// The control force of a control bearing, counted from 0.
    pub fn force_of(&self, bearing: usize) -> Unit {
        Unit { factor: self.factor_of(bearing) * self.force.factor, ..self.force }
    }

    /// How many times the force of the first control bearing one of the same number is at another; 1 where things are told as they are.
    pub fn factor_of(&self, bearing: usize) -> f64 {
        if self.scales.is_some() { self.masses.as_of_first(bearing, 1.0) } else { 1.0 }
    }

    /// What a quantity of a step is counted in; forces as those of the first control bearing.
    pub fn of_dimension(&self, dimension: Dimension) -> Unit {
        match dimension {
            // `tau` stays `tau`.
            Dimension::Whole | Dimension::Number | Dimension::Time => Unit { factor: 1.0, name: "" },
            Dimension::Angle => Unit { factor: 1.0, name: "rad" },
            Dimension::Speed => self.speed,
            Dimension::SpeedRate => match self.scales {
                Some(scales) => dimension.si(&scales, 1.0),
                None => Unit { factor: 1.0, name: "w0 R" },
            },
            Dimension::Length => self.length,
            Dimension::Velocity => self.velocity,
            Dimension::Force => self.force,
            Dimension::ForceRate => match self.scales {
                Some(scales) => Unit { factor: self.force.factor * scales.w0, name: "N/s" },
                None => Unit { factor: 1.0, name: "m_b w0³ e_t" },
            },
            Dimension::Frequency => self.frequency,
            Dimension::Rate => self.rate,
            Dimension::Stiffness | Dimension::Damping => match self.scales {
                Some(scales) => dimension.si(&scales, self.masses.ratio(0)),
                None => Unit { factor: 1.0, name: "" },
            },
        }
    }

    /// What a setting is counted in where it is shown, and typed without a unit: clearances in what radii are in.
    pub fn setting(&self, key: Key) -> Unit {
        match (self.scales, key.parameter.dimension) {
            (None, _) => Unit { factor: 1.0, name: key.parameter.unit() },
            (Some(_), Dimension::Length) => self.length,
            (Some(scales), dimension) => dimension.si(&scales, self.masses.of_key(key)),
        }
    }

    /// The same on the command line and in files, which count lengths in metres.
    pub fn setting_in_files(&self, key: Key) -> Unit {
        match self.scales {
            None => self.setting(key),
            Some(_) => self.table_of(key).unit(key.parameter.dimension),
        }
    }

    /// The table of units for a setting.
    fn table_of(&self, key: Key) -> units::Units {
        units::Units::of(self.scales, self.masses.of_key(key))
    }

    /// The table of units, forces being those of the first control bearing.
    pub fn table(&self) -> units::Units {
        units::Units::of(self.scales, self.masses.ratio(0))
    }

    /// The dimensionless value that was typed for a quantity, forces on the first control bearing; `alone` is that of a number without a
    /// unit.
    ///
    /// # Errors
    /// An SI unit where there are no scales.
    pub fn quantity(
        &self,
        dimension: Dimension,
        typed: Typed,
        alone: impl FnOnce(f64) -> f64,
    ) -> Result<f64, TypedError> {
        typed.value(&self.table(), dimension, alone)
    }

    /// A time as people read it: `30.0 tau`, of a rotor in SI units `30.0 tau = 100 ms`.
    pub fn time_told(&self, tau: f64, digits: usize) -> String {
        format!("{} tau{}", short(tau, digits), self.seconds_told(tau, digits))
    }

    /// The moment of a step as people read it: `tau 30.0`, or `tau 30.0 = 100 ms`.
    pub fn moment_told(&self, tau: f64, digits: usize) -> String {
        format!("tau {}{}", short(tau, digits), self.seconds_told(tau, digits))
    }

    fn seconds_told(&self, tau: f64, digits: usize) -> String {
        let told = |seconds: f64| {
            let (per_second, unit) = match seconds.abs() {
                // Of nothing too.
                0.0 | 1.0.. => (1.0, "s"),
                1e-3.. => (1e3, "ms"),
                _ => (1e6, "μs"),
            };
            format!(" = {} {unit}", short(seconds * per_second, digits))
        };
        self.scales.map_or_else(String::new, |scales| told(scales.seconds(tau)))
    }

    /// What one key press adds to a setting, as it is shown: a round number.
    pub fn step(&self, key: Key) -> f64 {
        self.step_of(key, key.parameter.step)
    }

    /// The same among these settings: of a gain no less than a part of the largest gain of its signal, as gains in front of a filter are
    /// large, and what is round for those of others moves nothing.
    pub fn step_among(&self, key: Key, settings: &Settings) -> f64 {
        let own = key.parameter.step;
        if key.parameter.gain.is_none() {
            return self.step(key);
        }
        let signal = settings.feedback.signals().nth(key.index.unwrap_or(0));
        let gains =
            signal.into_iter().flat_map(|signal| GainKind::ALL.map(|kind| signal.gain(kind).at(settings.speed)));
        let largest = gains.map(f64::abs).fold(0.0, f64::max);
        if OF_LARGEST * largest <= own {
            return self.step(key);
        }
        let decade = 10_f64.powf(largest.log10().floor());
        let round = [5.0, 2.0, 1.0].into_iter().map(|digit| digit * decade).find(|round| *round <= largest);
        self.step_of(key, own.max(significant(OF_LARGEST * round.unwrap_or(decade), 4)))
    }

    fn step_of(&self, key: Key, step: f64) -> f64 {
        match self.setting(key).factor {
            1.0 => step,
            // What the product of round numbers leaves behind their digits is not part of them.
            factor => significant(nice_ceiling(step * factor), 4),
        }
    }

    /// Changes of `settings` as they were typed, dimensionless: what is typed for all control bearings is that for each.
    ///
    /// # Errors
    /// A clearance where nothing of `rotor`, if that is known, has play; an SI unit where there are no scales.
    pub fn settings_of_typed(
        &self,
        rotor: Option<&Rotor>,
        settings: &Settings,
        typed: &[(Key, Typed)],
    ) -> Result<Vec<(Key, f64)>, SettingsError> {
        let mut values = Vec::with_capacity(typed.len());
        for &(key, typed) in typed {
            let each = rotor.map_or_else(|| Ok(settings.each_bearing(key)), |rotor| settings.each(rotor, key))?;
            for key in each {
                let value = self.value_of(key, typed, |number| number / self.setting(key).factor);
                let no_value = |expected| SettingsError::NoValue {
                    key: key.to_string(),
                    found: typed.to_string(),
                    expected,
                    or_off: key.parameter.off.is_some(),
                };
                values.push((key, value.map_err(no_value)?));
            }
        }
        Ok(values)
    }

    /// The dimensionless value that was typed for a setting; `alone` is that of a number without a unit.
    ///
    /// # Errors
    /// An SI unit where there are no scales.
    pub fn value_of(&self, key: Key, typed: Typed, alone: impl FnOnce(f64) -> f64) -> Result<f64, TypedError> {
        typed.value(&self.table_of(key), key.parameter.dimension, alone)
    }

    /// A value of a setting as people read it: with its unit where that is none of the machine's own.
    pub fn value(&self, key: Key, value: f64) -> String {
        self.value_in(key, value, DIGITS)
    }

    fn value_in(&self, key: Key, value: f64, digits: usize) -> String {
        if key.parameter.off == Some(value) && value != 0.0 {
            return "off".to_owned();
        }
        let unit = self.setting(key);
        let told = significant(value * unit.factor, digits).to_string();
        if unit.factor == 1.0 { told } else { format!("{told} {}", unit.name) }
    }

    /// A number without a unit as people read it.
    pub fn value_digits(&self, value: f64) -> f64 {
        significant(value, DIGITS)
    }

    /// What is wrong with a change, in the units that it was typed in.
    pub fn fault(&self, error: &SettingsError) -> String {
        if let SettingsError::OutOfRange { key, found, min, max, or_off } = error
            && let Ok(of) = key.parse::<Key>()
            && self.setting(of).factor != 1.0
        {
            let [found, min, max] = [found, min, max].map(|value| self.value(of, *value));
            let off = if *or_off { ", or off" } else { "" };
            return format!("{key} = {found}: expected a number from {min} to {max}{off}");
        }
        error.to_string()
    }

    /// What has changed, as people read it.
    pub fn difference(&self, before: &Settings, after: &Settings) -> String {
        let Difference { values, law } = Difference::between(before, after);
        // As few digits as tell the two apart, but for a few that read well.
        let one = |ChangedValue { key, label, was, is }: &ChangedValue| {
            let told = |digits| [*was, *is].map(|value| self.value_in(*key, value, digits));
            let [was, is] = (DIGITS..17).map(told).find(|[was, is]| was != is).unwrap_or_else(|| told(17));
            format!("{label} {was} -> {is}")
        };
        let told = values.iter().map(one).chain(law.then(|| "another feedback".to_owned()));
        told.collect::<Vec<_>>().join(", ")
    }

    /// A spin speed as people read it.
    pub fn speed(&self, speed: f64) -> String {
        match self.scales {
            Some(scales) => format!("{:.0}", scales.rpm(speed)),
            None => format!("{}", (speed * 1000.0).round() / 1000.0),
        }
    }

    /// The same with its name: `R 2.5`, or `955 rpm`.
    pub fn speed_told(&self, speed: f64) -> String {
        match self.scales {
            Some(_) => format!("{} rpm", self.speed(speed)),
            None => format!("R {}", self.speed(speed)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::SI;

    #[test]
    fn val_a_rotor_in_si_units_is_told_in_micrometres_newtons_hertz_and_rpm() {
        let units = Units::of(Some(SI), ControlMasses::default());
        assert_eq!(units.length.told(2.0, 4), "10.00 μm");
        // m_b w0^2 e_t = 2 kg (1000/s)^2 5e-6 m.
        assert_eq!(units.force.told(1.0, 4), "10.00 N");
        assert_eq!(units.velocity.told(1.0, 4), "5000 μm/s");
        // 1000 rad/s are 159.15 Hz and 9549.3 rpm.
        assert_eq!(units.frequency.told(1.0, 5), "159.15 Hz");
        assert_eq!((units.speed(1.0), units.speed_told(1.0)), ("9549".into(), "9549 rpm".into()));
        assert_eq!(units.rate.told(-0.5, 4), "-500.0 1/s");
        let large = Scales { e_t: 2e-3, ..SI };
        assert_eq!(Units::of(Some(large), ControlMasses::default()).length.told(2.0, 4), "4.000 mm");
    }

    #[test]
    fn val_seconds_stand_beside_tau() {
        let units = Units::of(Some(SI), ControlMasses::default());
        // w0 = 1000 rad/s.
        assert_eq!(
            (units.time_told(30.0, 3), units.moment_told(-2.5, 4)),
            ("30.0 tau = 30.0 ms".into(), "tau -2.500 = -2.500 ms".into())
        );
        assert_eq!(Units::DIMENSIONLESS.time_told(30.0, 3), "30.0 tau");
    }

    #[test]
    fn changes_are_told_in_what_they_were_typed_in() {
        let units = Units::of(Some(SI), ControlMasses::default());
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        let mut before = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "composite").unwrap());
        let speed: Key = "speed".parse().unwrap();
        let [typed] = units.settings_of_typed(None, &before, &[(speed, 30_000.0.into())]).unwrap()[..] else {
            panic!("one")
        };
        let after = Settings { speed: typed.1, ..before.clone() };
        assert_eq!(units.value(speed, typed.1), "30000 rpm");
        assert_eq!(units.difference(&before, &after), "speed 0 rpm -> 30000 rpm");
        assert_eq!(Units::DIMENSIONLESS.value(speed, 2.5), "2.5");
        before.speed = 1.0;
        let kd: Key = "kd".parse().unwrap();
        let nudged = crate::edits::Edit::Nudge(kd, 0.01).applied(&before).unwrap();
        // m_b w0^2 = 2 kg (1000/s)^2.
        assert_eq!(units.difference(&before, &nudged), "kd.1 -1175800 N/m -> -1155800 N/m");
    }

    #[test]
    fn gains_before_a_filter_are_nudged_by_a_part_of_what_they_are() {
        let rotor = rotor::builtin::rotor("rig").unwrap();
        let settings = Settings::new(&rotor, 2.5, rotor::builtin::feedback(&rotor, "own").unwrap());
        let units = Units::of_machine(&rotor, &settings.feedback);
        for name in ["left.kd", "right.kd"] {
            let key = settings.key(name).unwrap();
            let value = settings.get(key).unwrap().abs() * units.setting(key).factor;
            let part = units.step_among(key, &settings) / value;
            assert!((0.004..0.02).contains(&part), "{name}: {part} of {value}");
        }
        // A gain that is nothing yet, by that of its signal; small gains and what is no gain as ever.
        let cd = settings.key("left.cd").unwrap();
        assert!(units.step_among(cd, &settings) > 100.0 * units.step(cd));
        let three_mass = rotor::builtin::rotor("three-mass").unwrap();
        let own = Settings::new(&three_mass, 2.5, rotor::builtin::feedback(&three_mass, "composite").unwrap());
        for key in own.keys() {
            assert_eq!(Units::DIMENSIONLESS.step_among(key, &own), Units::DIMENSIONLESS.step(key), "{key}");
        }
    }

    #[test]
    fn undo_messages_have_no_sixteen_digits_but_tell_small_changes() {
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        let before = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "composite").unwrap());
        let kd: Key = "kd".parse().unwrap();
        let told = |was: f64, is: f64| {
            let [mut was_in, mut is_in] = [before.clone(), before.clone()];
            was_in.set(kd, was).unwrap();
            is_in.set(kd, is).unwrap();
            Units::DIMENSIONLESS.difference(&was_in, &is_in)
        };
        assert_eq!(told(-0.391_234_567_891_234_5, 0.25), "kd.1 -0.3912346 -> 0.25");
        assert_eq!(told(0.3, 0.1 + 0.2), "kd.1 0.3 -> 0.30000000000000004");
        assert_eq!(told(0.123_456_789, 0.123_456_788), "kd.1 0.123456789 -> 0.123456788");
    }

    #[test]
    fn settings_are_typed_as_on_the_command_line_and_nudged_by_round_numbers() {
        let [speed, deadband, kd] = ["speed", "deadband", "kd"].map(|name| name.parse::<Key>().unwrap());
        let units = Units::of(Some(SI), ControlMasses::default());
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        let settings = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "composite").unwrap());
        let typed = |typed: [f64; 3]| [speed, deadband, kd].into_iter().zip(typed.map(Typed::from)).collect::<Vec<_>>();
        let said = ["159.154943091895 Hz", "1e-5m", "0.2 N/um"];
        let said =
            [speed, deadband, kd].into_iter().zip(said).map(|(key, said)| (key, key.parameter.read(said).unwrap()));
        // 1000 rad/s; 10 of 5 um; 2 kg (1000/s)^2 = 2e6 N/m.
        for typed in [typed([9_549.296_585_513_72, 10.0, 2e5]), said.collect()] {
            let typed = units.settings_of_typed(Some(&rotor), &settings, &typed).unwrap();
            let near = |(at, value): (usize, f64)| (typed[at].1 / value - 1.0).abs() < 1e-12;
            assert!([1.0, 2.0, 0.1].into_iter().enumerate().all(near), "{typed:?}");
        }
        assert_eq!([speed, deadband, kd].map(|key| units.step(key)), [500.0, 0.5, 20_000.0]);
        assert_eq!([deadband, kd].map(|key| units.setting(key).name), ["μm", "N/m"]);
        let refused =
            Units::DIMENSIONLESS.settings_of_typed(None, &settings, &[(kd, kd.parameter.read("2N/m").unwrap())]);
        assert!(refused.unwrap_err().to_string().starts_with("kd = '2 N/m': expected a number without a unit"));
        assert_eq!([speed, deadband].map(|key| Units::DIMENSIONLESS.step(key)), [0.05, 0.1]);
    }

    /// 30 kg and 10 kg with a control bearing each, the second first: K_t e_t are 72 N, so that 1 is 18 N and 54 N.
    #[test]
    fn val_a_force_is_typed_and_told_by_the_mass_of_its_own_control_bearing() {
        let mass = |mass| rotor::PhysicalMass { mass, bearing_stiffness: 1.8e6, unbalance: 1e-5, ..Default::default() };
        let rotor = Rotor::from_si("rig", vec![mass(30.0), mass(10.0)], vec![1e6], None).unwrap();
        let bearings = [1, 0].map(|station| rotor::ControlBearing::new(station, vec![])).to_vec();
        let before = Settings::new(&rotor, 0.0, Feedback { bearings });
        let units = Units::of_machine(&rotor, &before.feedback);
        let near =
            |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found} and {expected}");
        let key = |typed: &str| before.key(typed).unwrap();
        let typed = [(key("limit"), Typed::from(54.0)), (key("slew.2"), 16_200.0.into())];
        let typed = units.settings_of_typed(Some(&rotor), &before, &typed).unwrap();
        let told: Vec<String> = typed.iter().map(|(key, _)| key.to_string()).collect();
        assert_eq!(told, ["limit.1", "limit.2", "slew.2"], "what is typed for all is that for each");
        [3.0, 1.0, 1.0].iter().zip(&typed).for_each(|(expected, (_, found))| near(*found, *expected));
        let mut after = before.clone();
        typed.iter().for_each(|(key, value)| after.set(*key, *value).unwrap());
        let words = "1.limit off -> 54 N, 2.limit off -> 54 N, 2.slew off -> 16200 N/s";
        assert_eq!(units.difference(&before, &after), words);
        near(units.force_of(0).factor, 18.0);
        near(units.force_of(1).factor, 54.0);
        near(units.factor_of(1), 3.0);
        // A limit of 1 is as large a force on the second as one of 3 on the first, and nudged by a round number of its own.
        assert_eq!([key("limit.1"), key("limit.2")].map(|key| units.step(key)), [20.0, 60.0]);
        // A rotor without scales is told as it is: in accelerations.
        let plain = Units::of_machine(&rotor.dimensionless(), &before.feedback);
        assert_eq!((plain.factor_of(1), plain.setting(key("limit.2")).factor), (1.0, 1.0));
    }

    #[test]
    fn any_other_rotor_is_told_in_its_own_scales() {
        let units = Units::of(None, ControlMasses::default());
        assert_eq!(units, Units::DIMENSIONLESS);
        assert_eq!((units.length.told(2.0, 4), units.speed_told(2.5)), ("2.000 e_t".into(), "R 2.5".into()));
    }
}
