//! Ends of a range that cannot set its answer: their first network holds more than all networks of the end
//! that holds least, and their other networks are not searched.

use super::row::Row;
use super::search::{Done, Found};
use crate::outcome::boundary::Beyond;

/// The first network of an end must hold at least this multiple of the greatest ratio among the networks of
/// the end that holds least, or the square of the spread of those networks, if that is more. So even a
/// network of the end that lies twice as far below its first as that spread holds more than the least of
/// them.
const CLEAR: f64 = 1.1;

/// The ends of the same ranges that hold less than row `at` by the closed form for a lone particle: one for
/// each row that it is an end of. Empty if it holds least itself, was asked for, or is an end of a row that
/// is searched itself.
pub(super) fn holding_less(rows: &[Row], at: usize) -> Vec<usize> {
    let row = &rows[at];
    if row.end_of.is_none() {
        return Vec::new();
    }
    let is_end_of =
        |parent: &Row, end: &Row| parent.thickness == end.thickness && parent.ends.contains(&end.density);
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

/// The ratio that the first network of an end must hold, so that it cannot set the answer beside rows that
/// hold less, once all networks of those rows are done; `None` if the end is searched in any case.
pub(super) fn clear_of(done: &[Done], holding_less: &[(usize, u64)]) -> Option<f64> {
    let ratio = |&(row, networks): &(usize, u64)| {
        let of_row = done.iter().filter(|done| done.row == row);
        let held: Option<Vec<f64>> = of_row.map(|done| holds_to(&done.found)).collect();
        let held = held.filter(|held| held.len() as u64 == networks)?;
        let greatest = held.iter().copied().reduce(f64::max)?;
        let apart = greatest / held.into_iter().reduce(f64::min)?;
        Some(greatest * CLEAR.max(apart * apart))
    };
    let ratios: Option<Vec<f64>> = holding_less.iter().map(ratio).collect();
    ratios?.into_iter().reduce(f64::max).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
}

/// The ratio up to which a network holds; 0 if it erodes at every ratio of the search, `None` if it is
/// unknown.
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
    use crate::study::boundary::search::Ended;

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
    fn an_end_has_to_hold_clearly_more() {
        let wanted = |less: &[Found]| {
            let done: Vec<Done> =
                (1..).zip(less).map(|(network, result)| done(1, network, result.clone())).collect();
            clear_of(&done, &[(1, less.len() as u64)])
        };
        let near =
            |ratio: Option<f64>, wanted: f64| ratio.is_some_and(|ratio| (ratio - wanted).abs() < 1e-12);
        assert!(near(wanted(&[at(4.0)]), 4.4));
        // 4 % apart, and 25 %.
        assert!(near(wanted(&[at(4.0), at(4.16)]), 4.16 * 1.1));
        assert!(near(wanted(&[at(5.0), at(4.0)]), 5.0 * 1.5625));
        let erodes = beyond(Beyond::Below, Ended::Erodes(0.5));
        let holds = beyond(Beyond::Above, Ended::Holds(1, 100.0));
        let unknown = beyond(Beyond::Above, Ended::NotWalked("too fine".into()));
        for less in [erodes, holds, unknown] {
            assert_eq!(wanted(&[at(4.0), less.clone()]), None, "{less:?}");
            assert_eq!(wanted(std::slice::from_ref(&less)), None, "{less:?}");
        }
    }

    #[test]
    fn all_networks_of_the_worse_end_and_every_range_count() {
        let all = [done(1, 2, at(4.1)), done(1, 1, at(4.0)), done(3, 1, at(5.0))];
        assert_eq!(clear_of(&all, &[(1, 2)]), Some(4.1 * CLEAR));
        assert_eq!(clear_of(&all, &[(1, 2), (3, 1)]), Some(5.0 * CLEAR));
        assert_eq!(clear_of(&all, &[(1, 3)]), None);
        assert_eq!(clear_of(&all, &[]), None);
    }
}
