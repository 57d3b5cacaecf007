//! What the walks of a row say against its no-erosion boundary: that a few particles decide.

use crate::outcome::verdict::THRESHOLD;

use super::search::Done;

/// Why the no-erosion boundary of these networks is in doubt: half of those that erode, or more, hold a ratio
/// above one at which they do.
pub(super) fn doubt(done: &[&Done]) -> Option<String> {
    let eroding: Vec<&&Done> = done.iter().filter(|of| of.found.no_erosion.is_some()).collect();
    let unsteady = eroding.iter().filter(|of| comes_and_goes(&of.found.walks)).count();
    (unsteady > 0 && 2 * unsteady >= eroding.len()).then(|| {
        format!(
            "of {} networks that erode, {unsteady} were seen to hold in the first run at a larger D15F/D85B \
             than one at which they erode: a few particles decide there, and with other random numbers a \
             filter may erode at a smaller D15F/D85B than is said here. A wider network is steadier",
            eroding.len()
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

    fn said(networks: &[&[f64]]) -> String {
        let done: Vec<Done> = networks.iter().map(|first| network(first)).collect();
        doubt(&done.iter().collect::<Vec<_>>()).unwrap_or_default()
    }

    const STEADY: &[f64] = &[1.0, 5.0, 8.0, 20.0];
    const UNSTEADY: &[f64] = &[1.0, 7.5, 7.4, 20.0];
    const HOLDING: &[f64] = &[1.0, 2.0, 3.0, 4.0];

    #[test]
    fn half_of_the_networks_that_erode_are_enough() {
        assert_eq!(said(&[STEADY, STEADY, UNSTEADY]), "");
        assert!(said(&[STEADY, UNSTEADY]).starts_with("of 2 networks that erode, 1 were"));
        assert!(said(&[STEADY, UNSTEADY, HOLDING]).starts_with("of 2 networks that erode, 1 were"));
        assert!(said(&[UNSTEADY]).starts_with("of 1 networks that erode, 1 were"));
        assert_eq!(said(&[STEADY]), "");
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
