//! Searching gains from the console: begin, say how it goes, and show what was found before it is applied.

use super::{App, Message};
use crate::layers::Layer;
use crate::view::PopupRow;
use telemetry::edits::Edit;
use telemetry::gain_search::{GainSearch, SearchGoal};

impl App<'_> {
    /// Begins a search; `stop` ends it with the best so far.
    pub(super) fn search(&mut self, words: &str) {
        if words == "stop" {
            match &self.search {
                Some(search) => search.stop(),
                None => self.tell(Message::Bad("no search is under way".into())),
            }
            return;
        }
        let units = telemetry::reader::lock(&self.feed).units();
        if let Some(search) = &self.search {
            self.tell(Message::Bad(format!("{}: `:search stop` ends it", search.words(&units))));
            return;
        }
        let Some((settings, rotor)) = self.machine() else { return };
        // A speed on its way passes all from here to there.
        let highest = self.present_speed().map_or(settings.speed, |now| now.max(settings.speed));
        let present = rotor::Settings { speed: highest, ..settings.clone() };
        let goal = SearchGoal::read(words, &present, &units).map_err(|why| why.to_string());
        let begun = goal.and_then(|goal| GainSearch::begin(&rotor, &settings, goal).map_err(|why| why.to_string()));
        match begun {
            Ok(search) => {
                self.tell(Message::Good(search.words(&units)));
                self.search = Some(search);
            }
            Err(why) => self.tell(Message::Bad(why)),
        }
    }

    /// Shows how a search goes and, once it has ended, asks whether to apply what it found: meanwhile every panel shows it
    /// beside the present gains. Returns whether anything has changed.
    pub(super) fn watch_search(&mut self) -> bool {
        let Some(search) = &self.search else { return false };
        // What is being typed or asked comes first: the answer waits.
        if !self.layers.is_empty() {
            return false;
        }
        let units = telemetry::reader::lock(&self.feed).units();
        let (goal, words) = (search.goal().words(&units), search.words(&units));
        let robust = search.goal().robust;
        let Some(ended) = search.ended() else {
            let shows = self.message.0 != Message::Good(words.clone());
            self.tell(Message::Good(words));
            return shows;
        };
        self.search = None;
        match ended {
            Ok(found) => {
                let proven = if found.proven { "proven" } else { "the worst found" };
                let early = if found.stopped { ", stopped early" } else { "" };
                let [now, new] = &*found.effects;
                let worse = match &now.drawbacks_of(new)[..] {
                    [] => String::new(),
                    worse => format!(", but, beside now, {}", worse.join(", ")),
                };
                let unmet = match &found.unmet[..] {
                    [] => String::new(),
                    unmet => format!(", with {}", unmet.join(" and ")),
                };
                let worse = format!("{unmet}{worse}");
                let compared = telemetry::comparison::rows(now, new, &units).into_iter();
                self.compared = compared.map(|row| PopupRow { word: row.quantity, detail: row.told }).collect();
                let what = format!(
                    "found {goal}{early}: min damping {:.4} at {} ({proven}){worse}",
                    found.min_damping,
                    units.speed_told(found.worst_speed)
                );
                let change = Box::new((found.before, found.settings));
                let candidate = Box::new(change.1.clone());
                self.message = (Message::Hints, std::time::Instant::now());
                let edit = Edit::Become(change, format!("gains searched {goal}"));
                // What rounding decides is told as exactly zero: no success.
                let holds = found.min_damping > 0.0 && new.min_damping > 0.0;
                self.layers.push(if holds {
                    Layer::AskFound(edit, what)
                } else {
                    let verdict = crate::theme::verdict(found.min_damping).1;
                    let instead = if robust && !found.stopped {
                        ": no such gains hold for any deadband, see `:search full`; "
                    } else {
                        ": "
                    };
                    Layer::AskUnstable(edit, candidate, format!("{verdict}{instead}{what}"))
                });
            }
            Err(why) => self.tell(Message::Bad(format!("search {goal}: {why}"))),
        }
        true
    }
}
