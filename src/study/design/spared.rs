//! Ends of a range that cannot set its answer: their first network says so, beside all of the end that holds
//! least, and the others are not searched.

use super::row::Row;
use super::search::{Done, Found};
use crate::outcome::design::Beyond;

/// The first network of an end has to hold so many times as much as the greatest of the networks of the end
/// that holds least. So even one of its networks that lies as far below its first as those lie apart holds
/// more than the least of them, as many times as much.
const CLEAR: f64 = 1.25;

/// The ends of the same ranges that hold less than row `at` by the closed form for a lone particle: one for
/// each row that it is an end of. Empty where it holds least itself, or was asked for, or is an end of a row
/// that is searched itself.
pub(super) fn holding_less(rows: &[Row], at: usize) -> Vec<usize> {
    let row = &rows[at];
    if row.end_of.is_none() {
        return Vec::new();
    }
    let is_end_of = |parent: &Row, end: &Row| {
        parent.wanted.thickness == end.wanted.thickness && parent.ends.contains(&end.wanted.density)
    };
    let parents = || rows.iter().filter(|parent| is_end_of(parent, row));
    if parents().any(|parent| parent.networks() > 0) {
        return Vec::new();
    }
    let least = parents().map(|parent| {
        let ends = (0..rows.len()).filter(|&end| is_end_of(parent, &rows[end]));
        ends.min_by(|&a, &b| rows[a].start().total_cmp(&rows[b].start())).expect("the row is one")
    });
    let least: Vec<usize> = least.collect();
    if least.contains(&at) { Vec::new() } else { least }
}

/// Whether the first network of row `at` shows that it holds clearly more than these rows, of which all
/// networks are done.
pub(super) fn is_spared(done: &[Done], at: usize, holding_less: &[(usize, u64)]) -> bool {
    let of_row = |row: usize| done.iter().filter(move |done| done.row == row);
    let first = of_row(at).find(|done| done.network == 1);
    let Some(own) = first.and_then(|done| holds_to(&done.found)) else { return false };
    let greatest = |&(row, networks): &(usize, u64)| {
        let held: Option<Vec<f64>> = of_row(row).map(|done| holds_to(&done.found)).collect();
        held.filter(|held| held.len() as u64 == networks)?.into_iter().reduce(f64::max)
    };
    let is_clear = |less| greatest(less).is_some_and(|greatest| own >= CLEAR * greatest);
    own > 0.0 && !holding_less.is_empty() && holding_less.iter().all(is_clear)
}

/// The ratio up to which a network holds; 0 where it erodes at every ratio of the search, `None` where it is
/// not known.
fn holds_to(found: &Found) -> Option<f64> {
    match (found.no_erosion, &found.no_erosion_beyond) {
        (Some(ratio), _) => Some(ratio),
        (None, Some((Beyond::Below, _))) => Some(0.0),
        (None, _) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::design::search::Ended;

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
        let spared = |less: &Found, own: &Found| {
            is_spared(&[done(1, 1, less.clone()), done(2, 1, own.clone())], 2, &[(1, 1)])
        };
        assert!(spared(&at(4.0), &at(5.0)));
        assert!(!spared(&at(4.0), &at(4.9)));
        assert!(!spared(&at(5.0), &at(4.0)));
        let erodes = beyond(Beyond::Below, Ended::Erodes(0.5));
        assert!(spared(&erodes, &at(4.0)));
        assert!(!spared(&at(4.0), &erodes));
        assert!(!spared(&erodes, &erodes));
        for unknown in [
            beyond(Beyond::Above, Ended::Holds(1, 100.0)),
            beyond(Beyond::Above, Ended::NotWalked("too fine".into())),
        ] {
            assert!(!spared(&at(4.0), &unknown));
            assert!(!spared(&unknown, &at(4.0)));
        }
    }

    #[test]
    fn all_networks_of_the_worse_end_and_every_range_count() {
        let all = [done(1, 2, at(4.8)), done(1, 1, at(4.0)), done(2, 1, at(6.0)), done(3, 1, at(5.0))];
        assert!(is_spared(&all, 2, &[(1, 2)]));
        assert!(!is_spared(&all, 2, &[(1, 2), (3, 1)]));
        assert!(!is_spared(&all, 2, &[(1, 3)]));
        assert!(!is_spared(&all, 2, &[]));
        assert!(!is_spared(&all[..2], 2, &[(1, 2)]));
        // By its first network alone the worse end would be clear.
        assert!(!is_spared(&[done(1, 1, at(4.0)), done(1, 2, at(4.9)), done(2, 1, at(6.0))], 2, &[(1, 2)]));
    }
}
