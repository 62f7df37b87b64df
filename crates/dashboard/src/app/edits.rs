//! Changes of the machine: what an action stands for as an edit, and who gets it.

use rotor::{C64, Key, Settings};
use telemetry::drill::{self, DrillError, FaultOrder};
use telemetry::edits::{Edit, EditOutcome, Harm};
use telemetry::reader::lock;
use telemetry::units::ScreenUnits;
use units::Typed;

use super::{App, LOCKED};
use crate::actions::Action;
use crate::layers::Layer;
use crate::question::Question;
use crate::view::Message;

/// The impulse of the impulse key, along y in `e_t` per unit of `tau`: the one of the report's Figs. 3.8 to 3.10.
const IMPULSE: f64 = -2.5;

impl App<'_> {
    /// What became of an edit.
    pub(crate) fn take_outcome(&mut self, outcome: EditOutcome) {
        match outcome {
            EditOutcome::Done(text) => self.tell(Message::Good(text)),
            EditOutcome::Swapped(text, before) => {
                self.held = Some(*before);
                self.tell(Message::Good(text));
            }
            EditOutcome::Refused(text) => self.tell(Message::Bad(text)),
            EditOutcome::Asks(edit, settings, harms) => {
                let why = self.question_of(&harms);
                // No key that was meant for something else may answer.
                if self.layers.is_empty() {
                    self.layers.push(Layer::AskUnstable(edit, settings, why));
                } else if !matches!(self.layers.last(), Some(Layer::AskUnstable(..))) {
                    self.tell(Message::Bad(format!("{}: not done", why.whole())));
                }
            }
        }
    }

    /// Sets the selected setting to what was typed.
    pub(super) fn take_value(&mut self, text: &str) {
        let Some(key) = self.selected() else { return };
        match key.parameter.read(text) {
            Ok(value) => {
                let present = self.settings().ok_or_else(|| "no settings are known yet".to_owned());
                match present.and_then(|present| self.typed(&present, &[(key, value)])) {
                    Ok(edit) => self.send(edit),
                    Err(why) => self.tell(Message::Bad(why)),
                }
            }
            Err(expected) => {
                let or_off = if key.parameter.off.is_some() { ", or off" } else { "" };
                self.tell(Message::Bad(format!("{key} = '{text}': {expected}{or_off}")));
            }
        }
    }

    /// The change that sets what was typed.
    fn typed(&self, present: &Settings, values: &[(Key, Typed)]) -> Result<Edit, String> {
        let rotor = lock(&self.feed).rotor();
        let typed = self.units().settings_of_typed(rotor.as_deref(), present, values);
        typed.map(Edit::Set).map_err(|error| error.to_string())
    }

    /// A setting raised by so many of its steps.
    pub(super) fn nudge(&self, key: Key, steps: f64) -> Edit {
        let units = self.units();
        let (settings, rotor) = self.settings_and_rotor();
        let step = settings.as_ref().map_or_else(|| units.step(key), |settings| units.step_among(key, settings));
        let delta = steps * step / units.setting(key).factor;
        let each = rotor.zip(settings).and_then(|(rotor, settings)| settings.each(&rotor, key).ok());
        match each {
            Some(keys) if keys.len() > 1 => Edit::NudgeAll(keys, delta),
            _ => Edit::Nudge(key, delta),
        }
    }

    /// The change that sends the speed on its way, of speeds and a rate as typed.
    fn run_up(&self, present: &Settings, from: Option<Typed>, to: Typed, rate: Typed) -> Result<Edit, String> {
        let keys = ["speed", "ramp"].map(|key| key.parse().map_err(|error: rotor::SettingsError| error.to_string()));
        let [speed, ramp] = keys;
        let speed = speed?;
        let change = self.typed(present, &[(speed, to), (ramp?, rate)])?;
        let units = self.units();
        if let (Some(from), Some(now)) = (from, self.present_speed()) {
            let there = units.value_of(speed, from, |alone| alone / units.speed.factor);
            let there = there.map_err(|expected| format!("'{from}': {expected}"))?;
            if (now - there).abs() > 1e-3 * there.abs().max(1.0) {
                let now = units.speed_told(now);
                return Err(format!("it spins at {now}, not at {from}: `:run-up {from} {rate}` goes there first"));
            }
        }
        Ok(change)
    }

    /// The change that keeps the speed where it is; nothing if it is not on its way.
    fn stay(&self) -> Option<Edit> {
        let now = self.present_speed()?;
        let key = "speed".parse().ok()?;
        (self.settings()?.speed != now).then(|| Edit::Set(vec![(key, now)]))
    }

    /// The change that sends the speed to rest: as fast as it changes, or may change where it does not.
    fn to_rest(&self, present: &Settings) -> Result<Edit, String> {
        let (speed, changes) = self.present_motion().ok_or("no step has come yet")?;
        let rate = if changes == 0.0 { present.ramp } else { changes.abs() };
        if speed == 0.0 && present.speed == 0.0 {
            return Err("it is at rest, or on its way there".into());
        }
        if !rate.is_finite() {
            return Err("it would jump: `:run-up 0 RATE` says how fast it shall go to rest".into());
        }
        let wanted = Settings { speed: 0.0, ramp: rate, ..present.clone() };
        Ok(Edit::Become(Box::new((present.clone(), wanted)), "the speed goes to rest".into()))
    }

    /// The change that makes a fault, or puts it back.
    fn drill(&self, words: &str, present: &Settings) -> Result<Edit, String> {
        if self.player.is_some() {
            // What was done on the way is in the recording; which of it was a fault, nobody keeps here.
            return Err(
                "a drill is for a machine that runs: here type the settings that a fault changes, and u undoes them"
                    .into(),
            );
        }
        let feed = lock(&self.feed);
        let active = feed.active_fault();
        if words == "off" {
            let active = active.ok_or("no fault of a drill is there, as far as the events tell")?;
            return Ok(Edit::Drill(active.back.clone(), drill::OVER.to_owned()));
        }
        let rotor = feed.rotor().ok_or("no rotor is known yet")?;
        let (order, units) = (FaultOrder::read(words).map_err(|why| why.to_string())?, feed.units());
        let changes = order.changes(&rotor, present, (&units, ScreenUnits::setting), active);
        let changes = changes.map_err(|why| match why {
            DrillError::Settings(error) => units.fault(&error),
            other => other.to_string(),
        })?;
        Ok(Edit::Drill(changes, order.cause()))
    }

    /// Says of a row of settings which of them nothing is left of, on a rotor with so many masses.
    fn overridden(&self, values: &[(Key, Typed)]) -> Option<String> {
        let masses = lock(&self.feed).rotor().map_or(rotor::MAX_MASSES, |rotor| rotor.len());
        let mut assigned = rotor::typed::Assigned::new(masses);
        let noted = values.iter().try_for_each(|(key, value)| assigned.key(*key, &format!("{key}={value}")));
        noted.err().map(|undone| undone.to_string())
    }

    /// Has something done. On a bench the edit thread does it, and asks first if it would make a stable rotor unstable.
    pub(super) fn send(&mut self, edit: Edit) {
        if self.player.is_some() {
            let before = self.settings();
            if let Some(words) = self.play(|player, feed, time| player.edit(&edit, feed, time)) {
                if matches!(edit, Edit::Swap(_)) {
                    self.held = before;
                }
                self.tell(Message::Good(words));
            }
        } else if self.read_only {
            self.tell(Message::Bad("read-only: this dashboard changes nothing".into()));
        } else if self.locked {
            self.tell(Message::Bad(LOCKED.into()));
        } else if self.edits.try_send(edit).is_err() {
            self.tell(Message::Bad("the simulation does not keep up with the changes: wait".into()));
        }
    }

    /// Has a change of the machine carried out, or says why it cannot be.
    pub(super) fn change(&mut self, action: &Action) {
        let Some(present) = self.settings() else {
            self.tell(Message::Bad("no settings are known yet".into()));
            return;
        };
        match self.edit_of(action, &present) {
            Some(Ok(edit)) => self.send(edit),
            Some(Err(why)) => self.tell(Message::Bad(why)),
            None => {}
        }
    }

    /// The edit that an action stands for under the settings in force: what it refers to (the selected setting, the held ones, the
    /// bearing, gains that are kept) is put in its place. Nothing for an action that changes no machine.
    ///
    /// # Errors
    /// In words: what it refers to is not there, or nothing would be left of it.
    pub(super) fn edit_of(&self, action: &Action, present: &Settings) -> Option<Result<Edit, String>> {
        Some(match action {
            Action::Edit(edit) => Ok(edit.clone()),
            Action::NudgeSelected(steps) => {
                let key = self.selected().ok_or_else(|| "no settings are known yet".to_owned());
                key.map(|key| self.nudge(key, *steps))
            }
            Action::SetTyped(values) => match self.overridden(values) {
                Some(why) => Err(why),
                None => self.typed(present, values),
            },
            Action::RunUp { from, to, rate } => self.run_up(present, *from, *to, *rate),
            Action::Stay => self.stay().ok_or_else(|| "the speed is not on its way".into()),
            Action::ToRest => self.to_rest(present),
            Action::Drill(words) => self.drill(words, present),
            Action::StrikeBearing => {
                let bearing = self.selected().and_then(|key| present.bearing_of(key)).unwrap_or(0);
                let struck = present.feedback.bearings.get(bearing).unwrap_or(present.feedback.first());
                Ok(Edit::Impulse(struck.station, C64::new(IMPULSE, 0.0)))
            }
            Action::SwapHeld => {
                let held = self.held.clone().map(|held| Edit::Swap(Box::new(held)));
                held.ok_or_else(|| "nothing is held to switch to: hold the settings first".into())
            }
            Action::Load(name) => {
                self.presets.load(name, present.deadband.len()).map_err(|why| why.to_string()).map(|feedback| {
                    let wanted = Settings { feedback, ..present.clone() };
                    Edit::Become(Box::new((present.clone(), wanted)), format!("gains '{name}'"))
                })
            }
            _ => return None,
        })
    }

    /// What is asked about a change that would do harm.
    pub(super) fn question_of(&self, harms: &[Harm]) -> Question {
        let units = self.units();
        let mut parts = Vec::new();
        for harm in harms {
            if !parts.is_empty() {
                parts.push((0, ", and ".to_owned()));
            }
            match harm {
                Harm::Unjudged => parts.extend([
                    (0, "not known to be stable with that".to_owned()),
                    (1, ": its poles cannot be computed".to_owned()),
                ]),
                Harm::Unstable(damping) => parts.extend([
                    (0, format!("{} with that", crate::theme::verdict(*damping).1)),
                    (1, format!(": minimum damping {damping:.4}")),
                ]),
                Harm::Trips(trips) => {
                    let told = trips.words(|length| units.length.told(length, 4));
                    let (brief, numbers) = told.split_once(':').unwrap_or((&told, ""));
                    parts.push((0, brief.to_owned()));
                    parts.push((1, format!(":{numbers}")));
                }
            }
        }
        Question::of(parts)
    }

    /// Restarts the rotor; or the simulation, if that has ended and was ours.
    pub(super) fn restart(&mut self) {
        if let Some(simulation) = &mut self.simulation
            && simulation.ended().is_some()
        {
            let revived = simulation.restart();
            self.told_end = false;
            self.tell(match revived {
                Ok(()) => Message::Good("the simulation was started again".into()),
                Err(why) => Message::Bad(why.to_string()),
            });
        } else {
            self.send(Edit::Restart);
        }
    }
}
