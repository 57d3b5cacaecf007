//! Doubts about a row's no-erosion boundary: a few particles decide.

use crate::outcome::verdict::THRESHOLD;

use super::search::Done;

/// Networks whose no-erosion boundary is in doubt: the number that hold a ratio above an eroding one, if that
/// is half or more of the networks that erode, and the number that erode.
pub(super) fn doubt(done: &[&Done]) -> Option<[u64; 2]> {
    let eroding: Vec<&&Done> = done.iter().filter(|network| network.found.no_erosion.is_some()).collect();
    let unsteady = eroding.iter().filter(|network| comes_and_goes(&network.found.walks)).count();
    (unsteady > 0 && 2 * unsteady >= eroding.len()).then_some([unsteady as u64, eroding.len() as u64])
}

/// True if some ratio holds in the first run above one that erodes, for walks in the order of their ratios.
fn comes_and_goes(walks: &[(f64, f64, Option<f64>)]) -> bool {
    let mut of_first = walks.iter().map(|walk| walk.1);
    of_first.any(|eroded| eroded >= THRESHOLD) && of_first.any(|eroded| eroded < THRESHOLD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::boundary::Beyond;
    use crate::study::boundary::search::{Ended, Found};

    /// A network whose first run erodes these percentages at ratios 1, 2 and on, and whose second run does at
    /// 4.
    fn network(first: &[f64]) -> Done {
        let walks: Vec<_> = (1u32..).zip(first).map(|(s, e)| (f64::from(s), e / 100.0, Some(0.0))).collect();
        let no_erosion = walks.iter().find(|walk| walk.1 >= THRESHOLD).map(|walk| walk.0);
        let beyond = no_erosion.is_none().then_some((Beyond::Above, Ended::Holds(1, 4.0)));
        let result = Found { no_erosion, no_erosion_beyond: beyond, walks, ..Found::default() };
        Done { row: 0, network: 1, found: result }
    }

    fn doubt_of(networks: &[&[f64]]) -> Option<[u64; 2]> {
        let done: Vec<Done> = networks.iter().map(|first| network(first)).collect();
        doubt(&done.iter().collect::<Vec<_>>())
    }

    const STEADY: &[f64] = &[1.0, 5.0, 8.0, 20.0];
    const UNSTEADY: &[f64] = &[1.0, 7.5, 7.4, 20.0];
    const HOLDING: &[f64] = &[1.0, 2.0, 3.0, 4.0];

    #[test]
    fn half_of_the_networks_that_erode_are_enough() {
        assert_eq!(doubt_of(&[STEADY, STEADY, UNSTEADY]), None);
        assert_eq!(doubt_of(&[STEADY, UNSTEADY]), Some([1, 2]));
        assert_eq!(doubt_of(&[STEADY, UNSTEADY, HOLDING]), Some([1, 2]));
        assert_eq!(doubt_of(&[UNSTEADY]), Some([1, 1]));
        assert_eq!(doubt_of(&[STEADY]), None);
    }

    #[test]
    fn the_second_run_says_nothing_of_the_boundary_of_no_erosion() {
        let mut second = network(STEADY);
        for (walk, eroded) in second.found.walks.iter_mut().zip([0.0, 0.08, 0.01, 0.02]) {
            walk.2 = Some(eroded);
        }
        second.found.is_not_monotone = true;
        assert_eq!(doubt(&[&second]), None);
    }
}
