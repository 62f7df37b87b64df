//! The messages, field by field. All are `#[repr(C)]` and of fixed size; [`SCHEMA`] counts their versions.
//!
//! Dimensionless units of the model throughout: displacement in `e_t`, velocity in `e_t` per unit of `tau`, control in
//! `w0^2 e_t` (the force on the bearing's mass, divided by that mass). Lists are filled from the front and padded with
//! zeros; a count says how far.

use std::fmt;

use rotor::{C64, MAX_MASSES, Scales};
use text::number::significant;

use crate::Text;
use iceoryx2::prelude::ZeroCopySend;

use crate::wire_struct::message;

/// Version of all messages together. It is checked before a port opens: a reader of another version is told so.
pub const SCHEMA: u32 = 5;

/// What is special about a step: bits 0 to 15 are contact of mass 1 to 16 with its support bearing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(pub u32);

impl Flags {
    /// The control bearing is at its limit.
    pub const SATURATED: Self = Self(1 << 16);
    /// The machine has tripped: the rotor is held where it was, or coasts down.
    pub const TRIPPED: Self = Self(1 << 17);
    /// The step was sent more than one period of wake-ups (of a step, or of all steps that share one) after it was due.
    pub const LATE: Self = Self(1 << 18);
    /// The command comes from a controller outside.
    pub const EXTERNAL: Self = Self(1 << 19);
    /// A command from outside that should be there is not: the last one is held.
    pub const HELD: Self = Self(1 << 20);
    /// Beside [`Flags::TRIPPED`]: the machine is not held, its speed coasts down to rest and the rotor goes on moving.
    pub const COASTING: Self = Self(1 << 21);

    /// Flags with the contact bits `mask`, bit `i` for mass `i`.
    #[must_use]
    pub fn contact(mask: u32) -> Self {
        Self(mask & 0xffff)
    }

    /// Whether all bits of `other` are set.
    #[must_use]
    pub fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether mass `mass` (counted from 0) presses on its bearing.
    #[must_use]
    pub fn in_contact(self, mass: usize) -> bool {
        mass < MAX_MASSES && self.0 >> mass & 1 == 1
    }

    /// Whether the machine stands still after a trip: the steps repeat the one that tripped it.
    #[must_use]
    pub fn stands_still(self) -> bool {
        self.has(Self::TRIPPED) && !self.has(Self::COASTING)
    }

    /// Every flag that is set, by name: `contact.1`, `saturated`, `tripped`, `late`, `external`, `held`, `coasting`.
    #[must_use]
    pub fn names(self) -> Vec<String> {
        let contact = (0..MAX_MASSES).filter(|i| self.in_contact(*i)).map(|i| format!("contact.{}", i + 1));
        let rest = [
            (Self::SATURATED, "saturated"),
            (Self::TRIPPED, "tripped"),
            (Self::LATE, "late"),
            (Self::EXTERNAL, "external"),
            (Self::HELD, "held"),
            (Self::COASTING, "coasting"),
        ];
        contact.chain(rest.into_iter().filter(|(flag, _)| self.has(*flag)).map(|(_, name)| name.to_owned())).collect()
    }
}

impl std::ops::BitOr for Flags {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl std::ops::BitOrAssign for Flags {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

message! {
    "whirl.BenchStatus"
    /// The whole slow picture of a bench in one message, so that its parts always fit together. [`crate::BenchStatus`] is it with
    /// the documents that it names.
    pub struct BenchStatusMessage {
        /// Which run of which process: as in the steps.
        pub run_id: u64,
        /// Number of this bench status in its run: rises by 1.
        pub number: u64,
        /// Wall clock when it was made, nanoseconds since 1970.
        pub wall_ns: u64,
        /// Wall clock when the process started, nanoseconds since 1970.
        pub started_ns: u64,
        /// Process id of the simulation.
        pub pid: u32,
        /// How many masses the rotor has, and sensors: what a step's words are laid out for in this run.
        pub masses: u32,
        /// Version of the program that simulates.
        pub version: Text<16>,
        /// The rotor's name.
        pub rotor_name: Text<64>,
        /// Hash of the rotor's document.
        pub rotor: u64,
        /// Hash of the document of the settings in force.
        pub settings: u64,
        /// Scales of an SI rotor: `w0` in rad/s, `K_t` in N/m, `M_t` in kg, `e_t` in m; all zero for a dimensionless one.
        pub scales: [f64; 4],
        /// Steps a second that it paces itself to.
        pub rate_hz: f64,
        /// Advance of `tau` per step.
        pub dtau: f64,
        /// Runge-Kutta steps that make one step under the settings in force, at least 1: see [`rotor::step`].
        pub substeps: u32,
        /// The leg of its profile that the speed is on, counted from 1, and how many legs there are; zeros where it follows none, or has
        /// come to the end of it.
        pub leg: [u16; 2],
        /// Revision of the settings: 1 at the start, up by 1 with each change.
        pub revision: u64,
        /// The first step made with them.
        pub applied_at_step: u64,
        /// Who made the last change.
        pub changed_by: Text<32>,
        /// Poles under the settings in force.
        pub analysis: Analysis,
        /// How well the process keeps its pace.
        pub health: Health,
        /// How a controller outside does; all zero where there was none.
        pub control: ControlHealth,
        /// What tripped the machine.
        pub trip: Trip,
    }
}

impl BenchStatusMessage {
    /// The scales of an SI rotor; everything else in the messages is dimensionless.
    #[must_use]
    pub fn scales(&self) -> Option<Scales> {
        let [w0, k_t, m_t, e_t] = self.scales;
        (w0 > 0.0).then_some(Scales { w0, k_t, m_t, e_t })
    }
}

message! {
    "whirl.Analysis"
    /// The poles of the linear rotor, deadband neglected.
    pub struct Analysis {
        /// The revision of the settings that it is for; 0 while there is none.
        pub revision: u64,
        /// How many of `poles` are used: all, or the 32 least damped; 0 if there are none, as with unequal amplifiers or too long a delay.
        pub count: u32,
        /// Always 0.
        pub reserved: u32,
        /// Spin speed `R` that it is for: while that changes, the one of some tenth of a second ago.
        pub speed: f64,
        /// The smallest damping ratio of the modes that count (of shaft elements not the fastest, as long as they decay); 0 if there are no poles.
        pub min_damping: f64,
        /// The poles `[re, im]`, least damped first.
        pub poles: [[f64; 2]; 2 * MAX_MASSES],
    }
}

impl Analysis {
    /// The poles, least damped first.
    pub fn poles(&self) -> impl ExactSizeIterator<Item = C64> {
        self.poles[..(self.count as usize).min(2 * MAX_MASSES)].iter().map(|[re, im]| C64::new(*re, *im))
    }
}

message! {
    "whirl.Health"
    /// How well the simulation keeps its pace. Counts are since the process started; percentiles too.
    pub struct Health {
        /// Steps sent.
        pub steps: u64,
        /// Steps sent more than one period of wake-ups (of a step, or of all steps that share one) after they were due.
        pub late: u64,
        /// Deadlines given up because the process was too far behind to catch up.
        pub missed: u64,
        /// How long after its deadline a wake-up came, microseconds: median.
        pub lateness_p50_us: f64,
        /// The same, 99th percentile.
        pub lateness_p99_us: f64,
        /// The same, the worst.
        pub lateness_max_us: f64,
        /// What a step costs (step, fill and send), microseconds: median.
        pub cost_p50_us: f64,
        /// The same, 99th percentile.
        pub cost_p99_us: f64,
        /// How many readers of the state there are.
        pub subscribers: u32,
        /// Always 0.
        pub reserved: u32,
    }
}

message! {
    "whirl.ControlHealth"
    /// How a controller outside does. Counts are since the process started; percentiles too.
    pub struct ControlHealth {
        /// Commands that were taken.
        pub taken: u64,
        /// Of these, commands that came after their deadline.
        pub late: u64,
        /// Samples whose command was not there at its deadline.
        pub missed: u64,
        /// Commands that were not taken, because they were not finite.
        pub refused: u64,
        /// How often commands from outside came to act.
        pub took_over: u64,
        /// How often the law of the bench had to take over.
        pub lost: u64,
        /// How long after its readings a command was sent, by its own time stamp, microseconds: median; 0 where none has one.
        pub age_p50_us: f64,
        /// The same, 99th percentile.
        pub age_p99_us: f64,
        /// 1 if commands from outside act, 0 while the law of the bench does.
        pub acting: u32,
        /// Always 0.
        pub reserved: u32,
    }
}

message! {
    "whirl.Trip"
    /// What tripped the machine; all zero while it runs.
    pub struct Trip {
        /// 0 running, 1 an orbit grew past the limit, 2 the motion left the range of numbers, 3 no command came from outside,
        /// 4 an orbit grew past the limit, and the speed coasts down.
        pub cause: u32,
        /// The mass with the largest orbit, counted from 1.
        pub mass: u32,
        /// The step at which it happened.
        pub step: u64,
        /// Its radius then, in `e_t`; the last finite one.
        pub radius: f64,
        /// The limit then in force, in `e_t`.
        pub limit: f64,
    }
}

impl Trip {
    /// A trip with this step, of a cause as above; the mass is counted from 0 here.
    #[must_use]
    pub fn new(step: u64, cause: u32, mass: usize, [radius, limit]: [f64; 2]) -> Self {
        Self { cause, mass: mass as u32 + 1, step, radius, limit }
    }

    /// Whether the machine has tripped.
    #[must_use]
    pub fn is_tripped(&self) -> bool {
        self.cause != 0
    }

    /// Whether the machine is not held since: its speed coasts down.
    #[must_use]
    pub fn coasts(&self) -> bool {
        self.cause == 4
    }

    /// In words, with lengths in metres where the rotor has scales, else in `e_t`.
    #[must_use]
    pub fn told(&self, scales: Option<Scales>) -> String {
        // What the product of factors leaves behind six digits is not part of a length.
        let metres = |scales: Scales, length: f64| format!("{} m", significant(scales.metres(length), 6));
        let radius = scales.map_or_else(|| format!("{:.4} e_t", self.radius), |scales| metres(scales, self.radius));
        let limit = scales.map_or_else(|| format!("{} e_t", self.limit), |scales| metres(scales, self.limit));
        self.words(&radius, &limit)
    }

    /// The same with the orbit's radius and its limit as somebody else tells them.
    #[must_use]
    pub fn words(&self, radius: &str, limit: &str) -> String {
        match self.cause {
            0 => "running".to_owned(),
            1 => format!("orbit of mass {} reached {radius}, past the limit of {limit}", self.mass),
            4 => {
                format!(
                    "orbit of mass {} reached {radius}, past the limit of {limit}, and the speed coasts down",
                    self.mass
                )
            }
            3 => format!("no command came from the controller outside; orbit of mass {} at {radius}", self.mass),
            _ => format!("motion of mass {} left the range of numbers after {radius}", self.mass),
        }
    }
}

impl fmt::Display for Trip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told(None))
    }
}

message! {
    "whirl.Request"
    /// A change that a reader asks for. The document of the settings that it names comes with it; [`crate::Request`] is both.
    pub struct RequestMessage {
        /// 1 settings, 2 impulse, 3 restart, 4 note, 5 excitation of the loop's command, 6 end of it.
        pub kind: u32,
        /// Impulse: the mass, counted from 0.
        pub mass: u32,
        /// Settings: the revision they are based on; refused if it is no longer in force.
        pub base_revision: u64,
        /// Settings: hash of the document of the new ones.
        pub settings: u64,
        /// Impulse: change of velocity `[vy, vz]`.
        pub impulse: [f64; 2],
        /// Who asks.
        pub who: Text<32>,
        /// Why, as it shall stand in the log: `undo`, `typed`, a reason that a person gave; may be empty.
        pub why: Text<120>,
        /// Note: what it says. Excitation: its tones, such as
        /// `seed=1 period=50.0 lines=1..40 tones=20 away_from=2.5 amplitude=0.125 duration=250.0`: amplitude and a random phase each on
        /// multiples of 2 pi / period, of both signs, away from the spin speed by two.
        pub text: Text<240>,
    }
}

impl RequestMessage {
    /// Whether it asks for new settings.
    #[must_use]
    pub fn asks_for_settings(&self) -> bool {
        self.kind == 1
    }
}

message! {
    "whirl.Answer"
    /// What became of a request.
    pub struct Answer {
        /// 1 accepted, 0 refused.
        pub accepted: u32,
        /// 1 if it was refused because the settings had changed meanwhile: look again and ask again.
        pub outdated: u32,
        /// Runge-Kutta steps that make one step, as [`BenchStatusMessage::substeps`], now and before the request.
        pub substeps: [u32; 2],
        /// The revision now in force.
        pub revision: u64,
        /// Hash of the document of the settings now in force.
        pub settings: u64,
        /// Accepted: the first step made with the change.
        pub applied_at_step: u64,
        /// Accepted: time of the rotor when it took effect, as in [`crate::EventMessage::tau`].
        pub tau: f64,
        /// Refused: why.
        pub reason: Text<240>,
    }
}

impl Answer {
    /// The request took effect with step `step`, when the rotor's time was `tau`.
    #[must_use]
    pub fn accepted(revision: u64, step: u64, tau: f64) -> Self {
        Self { accepted: 1, revision, applied_at_step: step, tau, ..Self::default() }
    }

    /// The request was refused.
    #[must_use]
    pub fn refused(revision: u64, reason: &str) -> Self {
        Self { revision, reason: Text::new(reason), ..Self::default() }
    }

    /// Whether it was accepted.
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.accepted == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_have_names() {
        let flags = Flags::contact(0b101) | Flags::LATE | Flags::TRIPPED;
        assert_eq!(flags.names(), ["contact.1", "contact.3", "tripped", "late"]);
        assert!(flags.in_contact(2) && !flags.in_contact(1) && !flags.in_contact(18));
    }
}
