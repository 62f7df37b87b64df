//! One set of margins, for people and scripts.

use ::linear::{AmplitudePeak, DelayMargin, GainMargin, Margins, PhaseMargin};
use machine::{ISO_14839_3, MachineMargins, WORST, sensitivity_zone};
use serde_json::{Map, Value, json};

use crate::catalog::Machine;
use crate::output::Cell;
use crate::units::CommandUnits;

/// Why there is none of each of [`WORST`]; of gains, as far as [`linear::STRONGEST`] looks.
pub(super) const WITHOUT: [&str; WORST.len()] = [
    "no delay makes it unstable: the loop gain is 1 nowhere",
    "no gain up to 100 times as large makes it unstable, nor up to 10 000 times where nothing is late",
    "no smaller gain makes it unstable",
    "the loop gain is 1 nowhere",
    "",
    "",
    "",
    "the loop has no force to speak of",
];

pub(super) const COLUMNS: [&str; 4] = ["margin", "value", "unit", "frequency"];

pub(super) const COLUMNS_SI: [&str; 4] = ["margin", "value", "unit", "frequency (Hz)"];

/// One set of margins, for people and scripts.
pub(super) struct MarginsTold<'a> {
    pub(super) speed: f64,
    pub(super) margins: &'a Margins,
    pub(super) force: AmplitudePeak,
    pub(super) units: CommandUnits,
    pub(super) zones: [f64; 3],
    /// Mass ratio of the control bearing's mass.
    pub(super) mass: f64,
}

impl<'a> MarginsTold<'a> {
    /// Those of a machine; of several control bearings the worst of each.
    pub(super) fn of_all(found: &'a MachineMargins, units: CommandUnits, zones: [f64; 3], mass: f64) -> Self {
        Self { speed: found.speed, margins: &found.margins, force: found.force, units, zones, mass }
    }

    fn zone(&self, peak: f64) -> &'static str {
        sensitivity_zone(peak, self.zones)
    }

    /// A row of the table for one of [`WORST`].
    pub(super) fn row(&self, kind: usize, at: Option<f64>) -> Vec<Cell> {
        let (units, margins) = (self.units, self.margins);
        let peak = |peak: AmplitudePeak| Some((peak.amplitude, "", peak.frequency));
        let force = units.force(1.0, self.mass) / units.length(1.0);
        let entry = match kind {
            0 => margins.delay.map(|d| (units.time(d.delay), units.pick("tau", "s"), Some(d.frequency))),
            1 => margins.gain_up.map(|g| (g.factor, "times", Some(g.frequency))),
            2 => margins.gain_down.map(|g| (g.factor, "times", Some(g.frequency))),
            3 => margins.phase.map(|p| (p.angle.to_degrees(), "degrees", Some(p.frequency))),
            4 => peak(margins.sensitivity()),
            5 => peak(margins.axis),
            6 => peak(margins.complementary),
            _ => Some((self.force.amplitude * force, units.pick("w0^2", "N/m"), self.force.frequency)),
        };
        let mut row = vec![Cell::from(&WORST[kind])];
        match entry {
            Some((value, unit, frequency)) => {
                let frequency = frequency.map_or(Cell::Without("far out"), |w| units.frequency(w).into());
                let unit = if kind == 4 { format!("zone {}", self.zone(value)) } else { unit.to_owned() };
                row.extend([value.into(), Cell::from(&unit), frequency]);
            }
            None => row.extend([Cell::Without("none"), Cell::from(&""), Cell::Without("")]),
        }
        row.extend(at.map(|speed| Cell::from(units.speed(speed))));
        row
    }

    /// Every margin as scripts read it.
    pub(super) fn fields(&self) -> Map<String, Value> {
        let margins = self.margins;
        let peak = |AmplitudePeak { amplitude, frequency }: AmplitudePeak| {
            // A peak at 0 has no sign.
            let mut made = json!({"peak": amplitude, "frequency": frequency.map(|frequency| frequency + 0.0)});
            if frequency.is_none() {
                made["frequency_null"] = json!("it is approached as the frequency grows without bound");
            }
            made
        };
        let delay = |DelayMargin { delay, frequency }: DelayMargin| {
            let turns = delay * self.speed / std::f64::consts::TAU;
            let seconds = self.units.scales().map(|scales| scales.seconds(delay));
            let mut made = json!({
                "tau": delay,
                "seconds": seconds,
                "turns": (self.speed != 0.0).then_some(turns),
                "frequency": frequency,
            });
            if seconds.is_none() {
                made["seconds_null"] = json!("the rotor is dimensionless");
            }
            if self.speed == 0.0 {
                made["turns_null"] = json!("the rotor is at rest");
            }
            made
        };
        let gain = |GainMargin { factor, frequency }: GainMargin| json!({"factor": factor, "frequency": frequency});
        let phase = |PhaseMargin { angle, frequency }: PhaseMargin| json!({"degrees": angle.to_degrees(), "frequency": frequency});
        let mut made = Map::new();
        let put = |to: &mut Map<String, Value>, name: &str, value: Option<Value>, kind: usize| {
            if value.is_none() {
                to.insert(format!("{name}_null"), json!(WITHOUT[kind]));
            }
            to.insert(name.into(), value.unwrap_or(Value::Null));
        };
        put(&mut made, "delay", margins.delay.map(delay), 0);
        let mut gains = Map::new();
        put(&mut gains, "up", margins.gain_up.map(gain), 1);
        put(&mut gains, "down", margins.gain_down.map(gain), 2);
        made.insert("gain".into(), Value::Object(gains));
        put(&mut made, "phase", margins.phase.map(phase), 3);
        let worst = margins.sensitivity();
        made.insert(
            "sensitivity".into(),
            json!({
                "peak": worst.amplitude,
                "decibels": 20.0 * worst.amplitude.log10(),
                "frequency": worst.frequency.map(|frequency| frequency + 0.0),
                "zone": self.zone(worst.amplitude),
                "zones": self.zones,
                "forward": peak(margins.forward),
                "backward": peak(margins.backward),
                "axis": peak(margins.axis),
            }),
        );
        made.insert("complementary".into(), peak(margins.complementary));
        made.insert("force".into(), peak(self.force));
        made
    }

    /// What must be known of all this, in lines.
    pub(super) fn remarks(&self, machine: &Machine) -> String {
        let feedback = &machine.settings.feedback;
        let origin = if self.zones == ISO_14839_3 { "the limits of ISO 14839-3" } else { "limits as typed" };
        let [a, b, c] = self.zones;
        let mut lines = vec![
            format!("zones A, B, C end at a sensitivity of {a}, {b}, {c} ({origin}); an aid, not a certificate"),
            format!(
                "frequency in {}, negative for backward whirl; axis: one real axis; force: per noise in the displacements",
                self.units.pick("radians per tau", "Hz")
            ),
        ];
        if feedback.bearings.len() > 1 {
            lines.push("each bearing is opened with the others closed; all: the worst of them, the delay one in all commands at once".into());
        }
        if feedback.sample() > 0.0 {
            lines.push("sampled: the gain is that from sample to sample, up to half the sampling rate".into());
        }
        let is_bent = |parts: &control::Parts| {
            parts.limit.min(parts.slew).is_finite() || parts.noise > 0.0 || parts.quantum > 0.0
        };
        if feedback.bearings.iter().any(|bearing| is_bent(&bearing.parts)) {
            lines.push("noise, resolution and limits play no part".into());
        }
        lines.join("\n")
    }
}
