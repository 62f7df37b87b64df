//! Excitations of the loop's command: refused where they would trip the machine or mean nothing, and watched until they are over.

use machine::{Excitation, MachineLoop, MachinePoles, Multisine, Tone};
use rotor::{Rotor, Settings};

use crate::log::When;

/// Tones that begin at once swing in: until that has died down the motion is twice theirs at most, where one mode carries them.
const SWINGING_IN: f64 = 2.0;

/// How the machine stands that is to be excited.
#[derive(Debug)]
pub(crate) struct Present<'a> {
    pub(crate) rotor: &'a Rotor,
    pub(crate) settings: &'a Settings,
    /// Spin speed of this moment.
    pub(crate) speed: f64,
    /// The largest orbit of late, in `e_t`.
    pub(crate) radius: f64,
    pub(crate) is_tripped: bool,
}

impl Present<'_> {
    /// The excitation, ready to begin; or why the machine must not be excited so.
    pub(crate) fn excitation(&self, multisine: &Multisine) -> Result<Box<Excitation>, String> {
        let made = Excitation::of(multisine).map_err(|error| error.to_string())?;
        let tones = multisine.tones().map_err(|error| error.to_string())?;
        if self.is_tripped {
            return Err("the machine has tripped: restart it first".into());
        }
        if self.speed != self.settings.speed {
            return Err("the speed is on its way: wait until it is there".into());
        }
        let poles = MachinePoles::of(self.rotor, self.settings).map_err(|error| error.to_string())?;
        if let Some(mode) = poles.modes.iter().find(|mode| mode.pole.re >= 0.0) {
            return Err(format!(
                "the machine is not stable: it has a pole at {} {:+} j, so its loop has no response",
                mode.pole.re, mode.pole.im
            ));
        }
        self.stays_within(&tones)?;
        Ok(Box::new(made))
    }

    /// Refuses tones under which a mass could come to the trip limit.
    fn stays_within(&self, tones: &[Tone]) -> Result<(), String> {
        let machine = MachineLoop::at(self.rotor, self.settings, self.speed).map_err(|error| error.to_string())?;
        let moved = machine.excited(tones).map_err(|error| error.to_string())?;
        // No number is no promise either.
        let worst = moved.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let Some((mass, moved)) = worst else { return Ok(()) };
        let [reached, limit] = [self.radius + SWINGING_IN * moved, self.settings.trip];
        if reached < limit {
            return Ok(());
        }
        let told = |length: f64| {
            let scaled = self.rotor.scales().map_or((length, "e_t"), |scales| (scales.metres(length), "m"));
            format!("{} {}", text::number::significant(scaled.0, 6), scaled.1)
        };
        Err(format!(
            "the excitation could trip the machine: mass {} could move by {} beside the {} that orbits reach now, and the limit is {}; \
             a smaller amplitude would do",
            mass + 1,
            told(SWINGING_IN * moved),
            told(self.radius),
            told(limit)
        ))
    }
}

/// An excitation that goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excited {
    from: When,
    duration: f64,
    dtau: f64,
}

impl Excited {
    pub(crate) fn new(from: When, multisine: &Multisine, dtau: f64) -> Self {
        Self { from, duration: multisine.duration, dtau }
    }

    /// When it is over by itself: before that step.
    pub(crate) fn ends(&self) -> When {
        let steps = (self.duration / self.dtau * (1.0 - 1e-12)).ceil();
        When { step: self.from.step + steps as u64, tau: self.from.tau + self.duration }
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    fn multisine(amplitude: f64) -> Multisine {
        Multisine { seed: 1, period: 50.0, lines: [1, 40], tones: 20, away_from: 2.5, amplitude, duration: 100.0 }
    }

    #[test]
    fn what_would_trip_or_means_nothing_is_refused_in_words() {
        let rotor = builtin::rotor("three-mass").unwrap();
        let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
        settings.trip = 5.0;
        let present = Present { rotor: &rotor, settings: &settings, speed: 2.5, radius: 2.0, is_tripped: false };
        let ask = |present: &Present<'_>, amplitude| present.excitation(&multisine(amplitude)).map(drop);
        assert_eq!(ask(&present, 1e-4), Ok(()));
        let words = ask(&present, 1.0).unwrap_err();
        assert!(words.starts_with("the excitation could trip the machine: mass "), "{words}");
        assert!(words.contains("beside the 2 e_t that orbits reach now, and the limit is 5 e_t"), "{words}");
        // Where there is no room left at all.
        assert!(ask(&Present { radius: 5.0, ..present }, 1e-9).is_err());
        let refused = |present: &Present<'_>| ask(present, 1e-4).unwrap_err();
        let tripped = Present { rotor: &rotor, settings: &settings, speed: 2.5, radius: 2.0, is_tripped: true };
        assert!(refused(&tripped).contains("has tripped"));
        let moving = Present { speed: 2.4, is_tripped: false, ..tripped };
        assert!(refused(&moving).contains("on its way"));
        let settings = Settings::new(&rotor, 4.0, builtin::feedback(&rotor, "off").unwrap());
        let unstable = Present { rotor: &rotor, settings: &settings, speed: 4.0, radius: 2.0, is_tripped: false };
        assert!(refused(&unstable).contains("not stable: it has a pole at"));
    }

    #[test]
    fn it_ends_before_the_first_step_that_begins_without_it() {
        let from = When { step: 10, tau: 0.1 };
        let of = |duration| Excited::new(from, &Multisine { duration, ..multisine(1.0) }, 0.01).ends().step;
        assert_eq!((of(1.0), of(1.004), of(0.004)), (110, 111, 11));
    }
}
