//! Which tones, how large, and for how long.

use std::f64::consts::{PI, TAU};
use std::str::FromStr;

use machine::{MachinePoles, MarginsError, Multisine, Tone};
use rotor::C64;
use units::{Dimension, Typed};

use super::Subject;
use crate::failure::Failure;
use crate::output;
use crate::quantity::{QuantityRange, TypedQuantity};

/// What is left of a transient when measuring begins.
const LEFT: f64 = 1e-4;
/// How many times the lowest frequency the highest is, if nobody says.
const SPAN: f64 = 40.0;
/// Share of the room up to the trip limit that tones take, where nobody says how large they shall be in themselves.
const ROOM: f64 = 0.1;
/// A force smaller than this share of what the trip limit would take is no measure of anything.
const NO_FORCE: f64 = 1e-9;

/// How large tones shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Amplitude {
    /// Each, in the units of the machine.
    Each(Typed),
    /// All together, as a root mean square, over the present force.
    Share(f64),
}

impl FromStr for Amplitude {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let is_size = |x: &f64| *x > 0.0 && x.is_finite();
        let read = match typed.strip_suffix('%') {
            Some(share) => share.trim().parse().ok().filter(is_size).map(|percent| Self::Share(percent / 100.0)),
            None => Typed::read(Dimension::Force, typed).ok().filter(|x| is_size(&x.number())).map(Self::Each),
        };
        read.ok_or_else(|| "expected a force greater than 0, or a share such as 2%".to_owned())
    }
}

/// What was asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) band: Option<QuantityRange>,
    pub(super) tones: u32,
    pub(super) periods: u32,
    pub(super) seed: u64,
}

/// A measurement.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) multisine: Multisine,
    pub(super) tones: Vec<Tone>,
    /// Steps that are not looked at: until the machine has settled.
    pub(super) settle: u64,
    /// Steps of a period.
    pub(super) period: u64,
    pub(super) periods: u32,
}

impl Plan {
    /// The measurement of this machine.
    ///
    /// # Errors
    /// A machine that is not stable, a band that does not fit, tones that are too small or too large.
    pub(super) fn of(subject: &Subject, bounds: &Bounds, amplitude: Amplitude) -> Result<Self, Failure> {
        let (settings, dtau) = (&subject.settings, subject.dtau);
        let poles = MachinePoles::of(&subject.rotor, settings)?;
        let rightmost = poles.modes.iter().map(|mode| mode.pole).max_by(|a, b| a.re.total_cmp(&b.re));
        let slowest = rightmost.map_or(1.0, |pole| -pole.re);
        if let Some(pole) = rightmost.filter(|pole| pole.re >= 0.0) {
            let unstable = MarginsError::Unstable { speed: settings.speed, pole };
            return Err(super::super::margin::told(&unstable, subject.units));
        }
        let [from, to] = band(subject, bounds.band)?;
        // Close enough for all tones, and whole steps.
        let wanted = from.min((to - from) / f64::from(bounds.tones.max(2) - 1));
        let period = (TAU / wanted / dtau * (1.0 - 1e-12)).ceil();
        let spacing = TAU / (period * dtau);
        let [first, last] = [(from / spacing - 1e-6).ceil().max(1.0), (to / spacing + 1e-6).floor()];
        let settle = (-LEFT.ln() / slowest / dtau).ceil();
        let steps = settle + f64::from(bounds.periods) * period;
        if steps > 1e9 || last > f64::from(Multisine::MAX_LINE) {
            let told = subject.units.time_text(steps * dtau);
            return Err(Failure::Usage(format!(
                "that would take {told}: a band that begins higher, or is wider, would do"
            )));
        }
        let unit = Multisine {
            seed: bounds.seed,
            period: period * dtau,
            lines: [first as u32, last as u32],
            tones: bounds.tones,
            away_from: settings.speed,
            amplitude: 1.0,
            duration: steps * dtau,
        };
        let tones = unit.tones().map_err(|error| Failure::Usage(error.to_string()))?;
        let multisine = Multisine { amplitude: size(subject, amplitude, &tones)?, ..unit };
        let tones = multisine.tones().map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(Self { multisine, tones, settle: settle as u64, period: period as u64, periods: bounds.periods })
    }

    /// All steps.
    pub(super) fn steps(&self) -> u64 {
        self.settle + u64::from(self.periods) * self.period
    }

    /// Says what will bend what is measured, if it is known before.
    pub(super) fn warn(&self, subject: &Subject) {
        let added: f64 = self.tones.iter().map(|tone| (tone.amplitude * sensitivity(subject, tone)).norm()).sum();
        if subject.present_force + added > subject.settings.feedback.first().parts.limit {
            output::warn("the force may reach its limit under these tones, which bends what is measured");
        }
    }
}

fn sensitivity(subject: &Subject, tone: &Tone) -> C64 {
    subject.machine.gain.at(tone.frequency).sensitivity()
}

/// The band as asked for, in radians per `tau`.
fn band(subject: &Subject, typed: Option<QuantityRange>) -> Result<[f64; 2], Failure> {
    let per = subject.units.frequency(1.0);
    let most = PI / subject.dtau.max(subject.settings.feedback.sample());
    let Some(typed) = typed else {
        let to = (0.5 * subject.machine.band()[1]).min(0.9 * most);
        return Ok([to / SPAN, to]);
    };
    let band = subject.units.read_range("--band", typed)?;
    let band = [band.from, band.to];
    if band[0] <= 0.0 {
        return Err(Failure::Usage(format!(
            "--band {typed}: expected frequencies greater than 0, each is measured both ways"
        )));
    }
    if band[1] >= most {
        let least = output::rounded(most * per);
        return Err(Failure::Usage(format!(
            "--band {typed}: steps and samples of this bench tell frequencies apart up to {least}{}",
            subject.units.pick("", " Hz")
        )));
    }
    Ok(band)
}

/// The amplitude of each of some tones of amplitude 1.
fn size(subject: &Subject, amplitude: Amplitude, tones: &[Tone]) -> Result<f64, Failure> {
    let share = match amplitude {
        Amplitude::Each(typed) => {
            let typed = TypedQuantity { dimension: Dimension::Force, typed };
            return subject.units.read_on(subject.bearing_mass(), "--amplitude", typed);
        }
        Amplitude::Share(share) => share,
    };
    let moved = subject.machine.excited(tones)?.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let room = (subject.settings.trip - subject.radius).max(0.0) / moved;
    // Tones of random phases add up as the root of their number.
    let of_force = share * subject.present_force / (tones.len() as f64).sqrt();
    let amplitude = if of_force > NO_FORCE * room { of_force.min(ROOM * room) } else { ROOM * ROOM * room };
    if amplitude > 0.0 && amplitude.is_finite() {
        return Ok(amplitude);
    }
    Err(Failure::Work("the orbit is at its trip limit: there is no room for an excitation".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_amplitude_is_a_force_or_a_share_of_one() {
        assert_eq!("0.5".parse(), Ok(Amplitude::Each(0.5.into())));
        assert_eq!("2%".parse(), Ok(Amplitude::Share(0.02)));
        for wrong in ["0", "-1%", "%", "much", "inf", "NaN"] {
            assert!(wrong.parse::<Amplitude>().is_err(), "{wrong}");
        }
    }
}
