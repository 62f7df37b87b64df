//! Searching gains from the console: begin, say how it goes, and show what was found before it is applied.

use super::{App, Message};
use crate::layers::Layer;
use crate::question::Question;
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
                let [now, new] = &*found.effects;
                let compared = telemetry::comparison::rows(now, new, &units).into_iter();
                self.compared = compared.map(|row| PopupRow { word: row.quantity, detail: row.told }).collect();
                // What has no room goes in this order: the rest stands above the line too.
                let mut parts = vec![(0, "found".to_owned()), (5, format!(" {goal}"))];
                if found.stopped {
                    parts.push((1, ", stopped early".to_owned()));
                }
                parts.push((0, format!(": min damping {:.4}", new.min_damping)));
                if let (true, Some(worst)) = (robust, new.any_deadband) {
                    parts.push((2, format!(", any deadband {worst:.4}")));
                }
                if let Some(speed) = found.worst_speed {
                    parts.push((6, format!(" at {}", units.speed_told(speed))));
                }
                parts.push((7, format!(" ({proven})")));
                parts.extend(found.unmet.iter().map(|unmet| (2, format!(", with {unmet}"))));
                let worse = now.drawbacks_of(new);
                if !worse.is_empty() {
                    parts.push((3, format!(", but, beside now, {}", worse.join(", "))));
                }
                let change = Box::new((found.before, found.settings));
                let candidate = Box::new(change.1.clone());
                self.message = (Message::Hints, std::time::Instant::now());
                let edit = Edit::Become(change, format!("gains searched {goal}"));
                // What rounding decides is told as exactly zero: no success.
                let holds = found.min_damping > 0.0 && new.min_damping > 0.0;
                self.layers.push(if holds {
                    Layer::AskFound(edit, Question::of(parts))
                } else {
                    let verdict = crate::theme::verdict(found.min_damping).1;
                    let instead = if robust && !found.stopped {
                        ": no such gains hold for any deadband, see `:search full`; "
                    } else {
                        ": "
                    };
                    let parts = [(0, verdict.to_owned()), (1, instead.to_owned())].into_iter().chain(parts);
                    Layer::AskUnstable(edit, candidate, Question::of(parts))
                });
            }
            Err(why) => self.tell(Message::Bad(format!("search {goal}: {why}"))),
        }
        true
    }
}
