use bitvec::vec::BitVec;

use super::*;
use crate::walk::exits;
use crate::walk::openings::Ways;

/// A lattice whose constrictions all differ.
fn lattice(shape: [u32; 3]) -> Network {
    let count = Network::lattice_constrictions(shape).unwrap();
    let diameter = (0..count).map(|c| 0.3 + ((c * 7919) % 1009) as f32 / 1009.0).collect();
    Network::cubic_from_diameters(shape, diameter, 1.0).unwrap()
}

/// Walks while ever more constrictions close, by one of the two steps: the expectation after every increment,
/// and the voids that retain something.
fn walked(network: &Network, is_general: bool, isa: Isa) -> Vec<(Expected, Vec<u32>)> {
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    let mut shares = Shares::new(network, Ways::Unblocked(&blocked));
    let mut expected = Expected::new(network.voids());
    let mut flow = ExpectedFlow::new(network, &shares, &expected);
    assert!(matches!(flow.by_network, ByNetwork::Lattice(_)));
    if is_general {
        flow.by_network = ByNetwork::General(GeneralFlow::new(&shares, network.voids()));
    }
    flow.set_isa(isa);
    let mut all = Vec::new();
    for increment in 0..40 {
        if increment < 20 {
            expected.insert(network, 1000 + increment);
        }
        flow.step(network, &shares, &mut expected);
        if let ByNetwork::General(flow) = &flow.by_network {
            // It adds to the numbers that it finds there.
            assert!(flow.next.iter().all(|&n| n == 0.0));
        }
        all.push((expected.clone(), flow.holding.clone()));
        for c in (increment as usize..network.constrictions()).step_by(29) {
            blocked.set(c, true);
            let void = (c / 3) as u32;
            exits::of_each(network, Ways::Unblocked(&blocked), [void], |exits| shares.set(network, exits));
            flow.set(network, &shares, void);
        }
    }
    all
}

/// Rows are moved as voids are one by one, to the bit; sums over all voids to rounding.
#[test]
fn both_steps_move_the_same() {
    for shape in [[5, 4, 6], [8, 3, 5], [17, 2, 4], [29, 3, 4], [9, 10, 3], [1, 5, 4], [2, 2, 1]] {
        let network = lattice(shape);
        let one_by_one = walked(&network, true, Isa::Portable);
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            let rows = walked(&network, false, isa);
            for ((a, held_a), (b, held_b)) in one_by_one.iter().zip(&rows) {
                assert_eq!(
                    (&a.moving, &a.retained, held_a),
                    (&b.moving, &b.retained, held_b),
                    "{shape:?} {isa:?}"
                );
                assert_eq!(a.sums.eroded.to_bits(), b.sums.eroded.to_bits());
                assert!((a.sums.moves / b.sums.moves - 1.0).abs() < 1e-14);
            }
        }
        let (last, held) = one_by_one.last().unwrap();
        assert!(held.len() > 1 || shape[2] == 1, "{shape:?}: nothing came to rest");
        let left = last.moving.iter().chain(&last.retained).sum::<f64>() + last.sums.eroded;
        assert!((left / last.sums.inserted as f64 - 1.0).abs() < 1e-12);
    }
}

/// A lattice with a single row along y may add three numbers in a different order.
#[test]
fn one_row_moves_the_same_to_rounding() {
    for shape in [[6, 1, 4], [1, 1, 5]] {
        let network = lattice(shape);
        let [one_by_one, rows] = [true, false].map(|general| walked(&network, general, Isa::Portable));
        for ((a, _), (b, _)) in one_by_one.iter().zip(&rows) {
            for (a, b) in a.moving.iter().zip(&b.moving) {
                assert!((a - b).abs() <= 1e-12 * a, "{shape:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn every_instruction_set_sums_to_the_same_bits() {
    // Whole vectors and remainders of eight and four, one row, one void across, one layer.
    for shape in [[13, 7, 6], [1, 1, 5], [4, 1, 4], [12, 1, 3], [16, 2, 3], [31, 1, 4], [7, 3, 2], [3, 3, 1]]
    {
        let network = lattice(shape);
        let portable = walked(&network, false, Isa::Portable);
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            assert_eq!(walked(&network, false, isa), portable, "{shape:?} {isa:?}");
        }
    }
}

/// Nowhere is an expectation no number; if one were, no instruction set would go its own way.
#[test]
fn what_is_no_number_leaves_no_void_on_any_instruction_set() {
    let network = lattice([13, 2, 3]);
    let blocked: BitVec = BitVec::repeat(false, network.constrictions());
    let shares = Shares::new(&network, Ways::Unblocked(&blocked));
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        let mut expected = Expected::new(network.voids());
        let mut flow = ExpectedFlow::new(&network, &shares, &expected);
        flow.set_isa(isa);
        expected.moving[..26].fill(f64::NAN);
        flow.step(&network, &shares, &mut expected);
        assert!(expected.moving.iter().all(|n| *n == 0.0), "{isa:?}");
    }
}
