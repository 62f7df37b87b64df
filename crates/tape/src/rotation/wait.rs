//! What waits for a trip: the last seconds, and how things stood when they began.

use std::collections::VecDeque;

use super::Subject;
use crate::sink::{Head, Item};

/// What waits for a trip.
#[derive(Default)]
pub(super) struct Wait {
    /// As things stood when the oldest item came.
    pub(super) head: Option<Head>,
    pub(super) items: VecDeque<Item>,
    /// A trip has come: its file is written until then.
    pub(super) until_ns: Option<u64>,
}

impl Wait {
    /// Lets go of everything before the first steps that reach past `oldest_ns`; settings among it go into the head.
    pub(super) fn let_go(&mut self, oldest_ns: u64, subject: &Subject) {
        loop {
            let is_new = |item: &Item| match item {
                Item::Steps(batch) => batch.span().is_some_and(|(_, last)| last.wall_ns >= oldest_ns),
                _ => false,
            };
            let Some(first_steps) = self.items.iter().position(|item| matches!(item, Item::Steps(_))) else { break };
            let keeps_steps = is_new(&self.items[first_steps]);
            // The head is not a thing among others: it is taken up at once.
            let upto = if keeps_steps {
                self.items.iter().rposition(|item| matches!(item, Item::Run(..))).map_or(0, |at| at + 1)
            } else {
                first_steps + 1
            };
            if upto == 0 {
                break;
            }
            for item in self.items.drain(..upto) {
                match item {
                    Item::Run(bench_status, _) => self.head = Some(subject.head(bench_status)),
                    Item::Event(event) => {
                        if let Some(head) = &mut self.head {
                            head.follow(&event);
                        }
                    }
                    Item::Remark(remark) => {
                        if let Some(head) = &mut self.head {
                            head.heed(&remark);
                        }
                    }
                    Item::Snapshot(snapshot, at) => {
                        if let Some(head) = &mut self.head {
                            head.snapshot = Some((snapshot, at));
                        }
                    }
                    Item::Steps(_) | Item::BenchStatus(..) => {}
                }
            }
        }
    }
}
