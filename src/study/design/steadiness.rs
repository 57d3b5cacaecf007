//! What the walks of a row say against its no-erosion boundary: that a few particles decide, or that the
//! search ended too near for that to be seen.

use crate::outcome::verdict::THRESHOLD;

use super::kept::Done;

/// Up to this many times a boundary has to be searched for erosion that comes and goes to be seen.
const SEEN_TO: f64 = 1.3;

/// Why the boundary of these networks, whose median is `median`, is in doubt; `end` is the largest ratio of
/// the search.
pub(super) fn doubt(done: &[&Done], median: f64, end: f64) -> Option<String> {
    let eroding: Vec<&&Done> = done.iter().filter(|of| of.found.no_erosion.is_some()).collect();
    let unsteady = eroding.iter().filter(|of| comes_and_goes(&of.found.walks)).count();
    if unsteady > 0 && 2 * unsteady >= eroding.len() {
        return Some(format!(
            "on {unsteady} of {} networks that erode a larger D15F/D85B was seen to hold: there a few \
             particles decide, and with other random numbers the boundary may lie lower. A larger network is \
             steadier",
            eroding.len()
        ));
    }
    (end < SEEN_TO * median).then(|| {
        format!(
            "the search ends at D15F/D85B {end:.2}, too near above the boundary to see whether a few \
             particles decide there: a higher end of --bracket shows it"
        )
    })
}

/// Whether some ratio holds in the first run above one that erodes, of walks in the order of their ratios.
fn comes_and_goes(walks: &[(f64, f64, Option<f64>)]) -> bool {
    let mut of_first = walks.iter().map(|walk| walk.1);
    of_first.any(|eroded| eroded >= THRESHOLD) && of_first.any(|eroded| eroded < THRESHOLD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::design::Beyond;
    use crate::study::design::search::Found;

    /// A network of which the first run erodes so much (%) at ratios 1, 2 and on, and the second at 4.
    fn network(first: &[f64]) -> Done {
        let walks: Vec<_> = (1u32..).zip(first).map(|(s, e)| (f64::from(s), e / 100.0, Some(0.0))).collect();
        let no_erosion = walks.iter().find(|walk| walk.1 >= THRESHOLD).map(|walk| walk.0);
        let beyond = no_erosion.is_none().then(|| (Beyond::Above, "holds".to_owned()));
        let found = Found { no_erosion, no_erosion_beyond: beyond, walks, ..Found::default() };
        Done { row: 0, network: 1, found }
    }

    fn said(networks: &[&[f64]], median: f64, end: f64) -> String {
        let done: Vec<Done> = networks.iter().map(|first| network(first)).collect();
        doubt(&done.iter().collect::<Vec<_>>(), median, end).unwrap_or_default()
    }

    const STEADY: &[f64] = &[1.0, 5.0, 8.0, 20.0];
    const UNSTEADY: &[f64] = &[1.0, 7.5, 7.4, 20.0];
    const HOLDING: &[f64] = &[1.0, 2.0, 3.0, 4.0];

    #[test]
    fn half_of_the_networks_that_erode_are_enough() {
        assert_eq!(said(&[STEADY, STEADY, UNSTEADY], 3.0, 100.0), "");
        assert!(said(&[STEADY, UNSTEADY], 3.0, 100.0).starts_with("on 1 of 2 networks that erode"));
        assert!(said(&[STEADY, UNSTEADY, HOLDING], 3.0, 100.0).starts_with("on 1 of 2 networks that erode"));
        assert!(said(&[UNSTEADY], 3.0, 100.0).starts_with("on 1 of 1 networks"));
        assert_eq!(said(&[STEADY], 3.0, 100.0), "");
    }

    #[test]
    fn a_search_that_ends_at_the_boundary_sees_nothing_above_it() {
        assert!(said(&[STEADY, STEADY], 3.0, 3.8).starts_with("the search ends at D15F/D85B 3.80"));
        assert_eq!(said(&[STEADY, STEADY], 3.0, 4.0), "");
    }

    #[test]
    fn the_second_run_says_nothing_of_the_boundary_of_no_erosion() {
        let mut second = network(STEADY);
        for (walk, eroded) in second.found.walks.iter_mut().zip([0.0, 0.08, 0.01, 0.02]) {
            walk.2 = Some(eroded);
        }
        second.found.is_not_monotone = true;
        assert_eq!(doubt(&[&second], 3.0, 100.0), None);
    }
}
