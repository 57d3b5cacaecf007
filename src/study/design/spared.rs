//! Ends of a range that cannot set its answer: their first network says so, and the others are not searched.

use super::row::Row;
use super::search::{Done, Ended, Found};
use crate::outcome::design::Beyond;

/// An end that holds so many times as much as the end that holds least, on the first network of either, holds
/// more on all others. Boundaries of networks of one curve differ by less (`results/design.md`).
const CLEAR: f64 = 1.25;

/// The ends of the same ranges that hold less than row `at` by the closed form for a lone particle: one for
/// each row that it is an end of. Empty where it holds least itself, or was asked for.
pub(super) fn holding_less(rows: &[Row], at: usize) -> Vec<usize> {
    let row = &rows[at];
    if row.end_of.is_none() {
        return Vec::new();
    }
    let is_end_of = |parent: &Row, end: &Row| {
        parent.wanted.thickness == end.wanted.thickness && parent.ends.contains(&end.wanted.density)
    };
    let parents = rows.iter().filter(|parent| is_end_of(parent, row));
    let least = parents.map(|parent| {
        let ends = (0..rows.len()).filter(|&end| is_end_of(parent, &rows[end]));
        ends.min_by(|&a, &b| rows[a].start().total_cmp(&rows[b].start())).expect("the row is one")
    });
    let least: Vec<usize> = least.collect();
    if least.contains(&at) { Vec::new() } else { least }
}

/// Whether the first network of row `at` shows that it holds clearly more than these rows, whose first
/// networks are done.
pub(super) fn is_spared(done: &[Done], at: usize, holding_less: &[usize]) -> bool {
    let first = |row: usize| done.iter().find(|done| (done.row, done.network) == (row, 1));
    let held = |row: usize| first(row).and_then(|done| holds_to(&done.found));
    let Some(own) = held(at) else { return false };
    !holding_less.is_empty()
        && holding_less.iter().all(|&less| held(less).is_some_and(|held| own >= CLEAR * held))
}

/// The ratio up to which a network holds; 0 where it erodes at every ratio of the search, `None` where what
/// cannot be walked keeps it from being known.
fn holds_to(found: &Found) -> Option<f64> {
    match (found.no_erosion, &found.no_erosion_beyond) {
        (Some(ratio), _) => Some(ratio),
        (None, Some((Beyond::Below, _))) => Some(0.0),
        (None, Some((Beyond::Above, Ended::Holds(_, ratio)))) => Some(*ratio),
        (None, _) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn done(row: usize, network: u64, found: Found) -> Done {
        Done { row, network, found }
    }

    fn at(ratio: f64) -> Found {
        Found { no_erosion: Some(ratio), ..Found::default() }
    }

    fn beyond(side: Beyond, why: Ended) -> Found {
        Found { no_erosion_beyond: Some((side, why)), ..Found::default() }
    }

    #[test]
    fn an_end_is_spared_where_it_clearly_holds_more() {
        let spared = |less: Found, own: Found| is_spared(&[done(1, 1, less), done(2, 1, own)], 2, &[1]);
        assert!(spared(at(4.0), at(5.0)));
        assert!(!spared(at(4.0), at(4.9)));
        assert!(!spared(at(5.0), at(4.0)));
        let erodes = beyond(Beyond::Below, Ended::Erodes(0.5));
        let holds = beyond(Beyond::Above, Ended::Holds(1, 100.0));
        assert!(spared(erodes.clone(), at(4.0)));
        assert!(spared(at(4.0), holds.clone()));
        assert!(!spared(at(4.0), erodes));
        assert!(!spared(holds.clone(), holds));
        let not_walked = beyond(Beyond::Above, Ended::NotWalked("too fine".into()));
        assert!(!spared(at(4.0), not_walked.clone()));
        assert!(!spared(not_walked, at(4.0)));
    }

    #[test]
    fn only_first_networks_count_and_every_range_has_to_be_clear() {
        let all = [done(1, 2, at(9.0)), done(1, 1, at(4.0)), done(2, 1, at(5.5)), done(3, 1, at(5.0))];
        assert!(is_spared(&all, 2, &[1]));
        assert!(!is_spared(&all, 2, &[1, 3]));
        assert!(!is_spared(&all, 2, &[]));
        assert!(!is_spared(&all[..1], 2, &[1]));
    }
}
