use super::*;
use crate::constrictions::CurveUnit;
use proptest::prelude::*;

fn curve() -> Curve {
    Curve::from_points(&[(0.0, 0.15), (100.0, 0.35)], CurveUnit::D0f).unwrap()
}

fn connected(shape: [u32; 3], seed: u64, percent: &[(u32, f64)]) -> Result<Network, NetworkError> {
    Network::connected(shape, &curve(), 1.0, seed, &Connectivity::new(percent)?)
}

fn counts(network: &Network) -> [usize; MOST + 1] {
    let mut counts = [0; MOST + 1];
    network.connectivity().iter().for_each(|&k| counts[k as usize] += 1);
    counts
}

#[test]
fn table_3_is_met_to_the_void() {
    let network = connected([40, 40, 60], 1, &TABLE_3).unwrap();
    let mean = network.connectivity().iter().sum::<u32>() as f64 / 96_000.0;
    assert!((mean - 5.998).abs() < 1e-9, "{mean}");
}

/// Steps lead to x, y, z or one more, around the periodic sides; without the steps over a seam nothing is
/// cyclic, since every step then leads to a larger number.
fn check_directed(network: &Network, shape: [u32; 3]) {
    let [nx, ny, nz] = shape;
    let place = |v: u32| [v % nx, v / nx % ny, v / (nx * ny)];
    let upstream = network.upstream();
    for (c, &target) in network.targets().iter().enumerate() {
        let from = place(upstream[c]);
        if target == END {
            assert_eq!(from[2], nz - 1);
            continue;
        }
        let to = place(target);
        let step = [(to[0] + nx - from[0]) % nx, (to[1] + ny - from[1]) % ny, to[2] - from[2]];
        assert!(STEPS.contains(&step), "{from:?} {to:?}");
        let over_seam = to[0] < from[0] || to[1] < from[1];
        assert!(over_seam || target > upstream[c]);
    }
    let (begin, _) = network.entrances();
    for void in 0..network.voids() as u32 {
        let start = void < nx * ny;
        assert_eq!(network.layer_of()[void as usize], place(void)[2]);
        assert!(
            !network.exits(void).is_empty() && (start || begin[void as usize + 1] > begin[void as usize])
        );
    }
    assert_eq!(network.layers(), nz as usize);
}

#[test]
fn every_step_leads_in_a_positive_direction() {
    let network = connected([12, 9, 15], 3, &TABLE_3).unwrap();
    check_directed(&network, [12, 9, 15]);
    assert!((0..network.voids() as u32).all(|void| network.exits(void).len() >= 2));
}

#[test]
fn kept_constrictions_keep_their_diameters_and_diagonals_follow_the_curve() {
    let shape = [20, 20, 30];
    let cubic = Network::cubic(shape, &curve(), 1.0, 5).unwrap();
    let network = connected(shape, 5, &TABLE_3).unwrap();
    let (mut kept, mut sum, mut diagonals) = (0, 0.0, 0.0);
    for void in 0..network.voids() as u32 {
        for exit in network.exits(void) {
            let (target, d) = (network.targets()[exit], network.diameters()[exit]);
            let on_axis = cubic.exits(void).find(|&c| cubic.targets()[c] == target);
            match on_axis {
                Some(c) => {
                    assert_eq!(d, cubic.diameters()[c]);
                    kept += 1;
                }
                None => {
                    sum += f64::from(d);
                    diagonals += 1.0;
                }
            }
        }
    }
    // A void that goes from 6 to k takes | k - 6 | changes, and a change serves two voids: 29.8 % of the
    // voids are entrances or exits lost, 29.6 % gained. Of 36,000 constrictions 1,788 must go and 1,776
    // diagonals be made; few more do.
    let deleted = cubic.constrictions() - kept;
    assert!(
        (1788..1900).contains(&deleted) && (1776.0..1900.0).contains(&diagonals),
        "{deleted} {diagonals}"
    );
    // Mean of a uniform curve: 0.25, standard error 0.0577 / sqrt(1500) at most.
    assert!((sum / diagonals - 0.25).abs() < 5.0 * 0.0577 / f64::sqrt(diagonals));
}

#[test]
fn the_same_seed_gives_the_same_network_on_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| connected([16, 16, 20], 9, &TABLE_3).unwrap())
    };
    let one = on(1);
    assert_eq!(one, on(3));
    assert_ne!(one, connected([16, 16, 20], 10, &TABLE_3).unwrap());
}

#[test]
fn what_no_such_network_has_is_refused_with_the_nearest() {
    let error = connected([6, 6, 6], 1, &[(12, 100.0)]).unwrap_err().to_string();
    assert!(error.contains("the nearest found was") && error.contains("12 = 100"), "{error}");
    for (percent, message) in [
        (vec![(1, 100.0)], "from 2"),
        (vec![(13, 100.0)], "to 12"),
        (vec![(6, 90.0)], "a sum of 90"),
        (vec![(6, 50.0), (6, 50.0)], "every connectivity once"),
        (vec![(6, -1.0), (5, 101.0)], "not negative"),
        (vec![(6, f64::NAN)], "not negative"),
    ] {
        let error = connected([3, 3, 3], 1, &percent).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn what_one_seed_reaches_is_reached_by_others() {
    for (shape, percent) in [
        ([7, 5, 9], vec![(4, 50.0), (8, 50.0)]),
        ([4, 4, 5], vec![(4, 50.0), (8, 50.0)]),
        ([5, 5, 8], vec![(3, 20.0), (6, 60.0), (9, 20.0)]),
    ] {
        for seed in 0..20 {
            check_directed(&connected(shape, seed, &percent).unwrap(), shape);
        }
    }
}

#[test]
fn a_distribution_that_is_hard_to_draw_is_reached_along_chains() {
    let shape = [40, 40, 60];
    for percent in [vec![(5, 50.0), (7, 50.0)], TABLE_3.to_vec()] {
        let wanted = Connectivity::new(&percent).unwrap();
        let mut exits = PossibleExits { proposals_left: 0, ..PossibleExits::cubic(shape) };
        exits.change_to(&wanted, 1).unwrap();
        assert_eq!(exits.distance(), 0);
        let again = || {
            let mut exits = PossibleExits { proposals_left: 0, ..PossibleExits::cubic(shape) };
            exits.change_to(&wanted, 1).unwrap();
            exits.present
        };
        assert!(exits.present == again());
        for void in 0..96_000 {
            assert!(exits.present[void].count_ones() >= KEPT_EXITS && exits.entrances[void] > 0);
        }
    }
}

#[test]
fn a_search_makes_no_more_proposals_than_it_may() {
    let impossible = Connectivity::new(&[(12, 100.0)]).unwrap();
    let mut exits = PossibleExits { proposals_left: 1000, ..PossibleExits::cubic([6, 6, 6]) };
    assert!(exits.change_to(&impossible, 1).is_err());
    assert_eq!(exits.proposals_left, 0);
}

#[test]
fn all_six_is_the_cubic_lattice() {
    let shape = [5, 4, 6];
    let network = connected(shape, 2, &[(6, 100.0)]).unwrap();
    let cubic = Network::cubic(shape, &curve(), 1.0, 2).unwrap();
    assert_eq!((network.targets(), network.diameters()), (cubic.targets(), cubic.diameters()));
    assert_eq!(cubic.connectivity(), vec![6; 120]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// Around a mean of 5 to 7 any distribution over 3 to 9 is met.
    #[test]
    fn distributions_are_met(
        shares in proptest::array::uniform7(0.0f64..1.0), seed: u64,
        shape in [6u32..12, 6u32..12, 6u32..12],
    ) {
        let sum: f64 = shares.iter().sum();
        prop_assume!(sum > 0.5);
        let mean = shares.iter().zip(3..).map(|(s, k)| s / sum * f64::from(k)).sum::<f64>();
        prop_assume!((5.0..=7.0).contains(&mean));
        let percent: Vec<(u32, f64)> = (3..).zip(shares.map(|s| 100.0 * s / sum)).collect();
        let network = connected(shape, seed, &percent).unwrap();
        check_directed(&network, shape);
        let voids = network.voids() as f64;
        let counted = counts(&network);
        for (k, share) in percent {
            // Rounding moves a number by one, the tolerance by one more.
            prop_assert!((counted[k as usize] as f64 - share / 100.0 * voids).abs() <= 2.0);
        }
    }
}
