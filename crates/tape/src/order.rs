//! Which stretches of steps make up a recording, when some have been put behind it again, or say numbers that cannot be.

use crate::contents::Stretch;
use crate::damage::{Damage, DamageKind, LostSteps};

/// Stretches in the order of their steps, without those that hold what others hold: of all ways to leave some out, that
/// which keeps most steps, so that one damaged number costs its own stretch and no other. Says which have been left out.
pub(crate) fn in_order(mut stretches: Vec<Stretch>, damage: &mut Vec<Damage>) -> Vec<Stretch> {
    // Of two that are the same the first in the file is looked at first, and taken.
    stretches.sort_by_key(|stretch| (stretch.last.seq, stretch.first.seq, stretch.offset));
    // Most steps among the first `i`, and whether the last of these is one of them.
    let mut best: Vec<(u64, bool)> = vec![(0, false)];
    let before = |stretch: &Stretch| stretches.partition_point(|other| other.last.seq < stretch.first.seq);
    for stretch in &stretches {
        let without = best.last().map_or(0, |(rows, _)| *rows);
        let with = best[before(stretch)].0.saturating_add(stretch.rows);
        best.push(if with > without { (with, true) } else { (without, false) });
    }
    let mut is_kept = vec![false; stretches.len()];
    let mut left = stretches.len();
    while left > 0 {
        let is_one = best[left].1;
        is_kept[left - 1] = is_one;
        left = if is_one { before(&stretches[left - 1]) } else { left - 1 };
    }
    let (mut kept, mut others) = (Vec::with_capacity(stretches.len()), Vec::new());
    for (stretch, is_kept) in stretches.into_iter().zip(is_kept) {
        if is_kept { kept.push(stretch) } else { others.push(stretch) }
    }
    others.sort_by_key(|stretch| stretch.offset);
    for stretch in others {
        let kind = if is_within(&stretch, &kept) { DamageKind::Repeated } else { DamageKind::Unreadable };
        let more = Damage::at(stretch.offset, stretch.bytes, kind);
        match damage.last_mut() {
            // Drawings lie between stretches: one place from the first to the last of them.
            Some(last) if last.kind == kind && kind == DamageKind::Repeated => {
                last.bytes = more.byte + more.bytes - last.byte;
            }
            _ => damage.push(more),
        }
    }
    kept
}

/// Whether the steps of a stretch are, as far as its ends tell, all on file.
fn is_within(stretch: &Stretch, kept: &[Stretch]) -> bool {
    let first = kept.partition_point(|other| other.last.seq < stretch.first.seq);
    let last = kept.partition_point(|other| other.first.seq <= stretch.last.seq);
    let covering = kept.get(first..last).unwrap_or_default();
    covering.first().is_some_and(|other| other.first.seq <= stretch.first.seq)
        && covering.last().is_some_and(|other| other.last.seq >= stretch.last.seq)
}

/// Says of damage which steps are missing where it is.
pub(crate) fn lost_steps(damage: &mut [Damage], stretches: &[Stretch]) {
    let mut in_file: Vec<&Stretch> = stretches.iter().collect();
    in_file.sort_by_key(|stretch| stretch.offset);
    let mut told = None;
    for damage in damage {
        let after = in_file.partition_point(|stretch| stretch.offset < damage.byte);
        let (Some(before), Some(next)) = (after.checked_sub(1).map(|at| in_file[at]), in_file.get(after)) else {
            continue;
        };
        // Of several places between the same steps the first tells of them.
        if next.first.seq > before.last.seq + 1 && told.replace(after) != Some(after) {
            let from = before.last.seq + 1;
            damage.steps = Some(LostSteps { from, count: next.first.seq - from });
        }
    }
}

#[cfg(test)]
mod tests {
    use wire::Moment;

    use super::*;

    /// A stretch of steps at `offset`, 100 bytes long.
    fn stretch(offset: u64, first: u64, last: u64, rows: u64) -> Stretch {
        let moment = |seq| Moment { seq, tau: 0.0, wall_ns: 0 };
        let (first, last) = (moment(first), moment(last));
        Stretch { part: 0, offset, bytes: 100, rows, first, last, gaps: Vec::new() }
    }

    fn ordered(stretches: &[Stretch]) -> (Vec<u64>, Vec<Damage>) {
        let mut damage = Vec::new();
        let kept = in_order(stretches.to_vec(), &mut damage);
        (kept.iter().map(|stretch| stretch.offset).collect(), damage)
    }

    #[test]
    fn steps_that_come_twice_are_read_once() {
        let parts = [stretch(0, 0, 9, 10), stretch(100, 10, 19, 10)];
        assert_eq!(ordered(&parts), (vec![0, 100], vec![]));
        let twice = [stretch(0, 0, 9, 10), stretch(100, 10, 19, 10), stretch(300, 0, 9, 10), stretch(400, 10, 19, 10)];
        assert_eq!(ordered(&twice), (vec![0, 100], vec![Damage::at(300, 200, DamageKind::Repeated)]));
    }

    /// All that came after it was left out for one damaged number.
    #[test]
    fn a_damaged_number_costs_its_stretch_and_no_other() {
        let of = |last| {
            [stretch(0, 0, 9, 10), stretch(100, 10, last, 10), stretch(200, 20, 29, 10), stretch(300, 30, 39, 10)]
        };
        let damage = vec![Damage::at(100, 100, DamageKind::Unreadable)];
        assert_eq!(ordered(&of(1 << 40)), (vec![0, 200, 300], damage));
        assert_eq!(ordered(&of(19)), (vec![0, 100, 200, 300], vec![]));
    }

    #[test]
    fn damage_between_steps_says_which_are_missing() {
        let mut damage = [20, 150, 160, 450].map(|byte| Damage::at(byte, 10, DamageKind::Checksum));
        lost_steps(&mut damage, &[stretch(50, 0, 9, 10), stretch(200, 30, 39, 10)]);
        let steps = damage.map(|damage| damage.steps);
        assert_eq!(steps, [None, Some(LostSteps { from: 10, count: 20 }), None, None]);
    }
}
