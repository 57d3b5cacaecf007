use super::few::FEW_EXITS;
use super::*;
use bitvec::prelude::*;

fn thresholds_of(diameters: [f32; 3], blocked: [bool; 3]) -> (Vec<u64>, Option<usize>) {
    let network = Network::cubic_from_diameters([1, 1, 1], diameters.to_vec(), 1.0).unwrap();
    let blocked: BitVec = blocked.into_iter().collect();
    let mut out = Vec::new();
    let last = thresholds(&network, Ways::Unblocked(&blocked), 0, &mut out);
    (out, last)
}

#[test]
fn widths_are_areas() {
    let (t, last) = thresholds_of([1.0, 1.0, f32::sqrt(2.0)], [false; 3]);
    assert_eq!(last, Some(2));
    assert!((t[0] as f64 / TWO_TO_64 - 0.25).abs() < 1e-7);
    assert!((t[1] as f64 / TWO_TO_64 - 0.5).abs() < 1e-7);
}

#[test]
fn a_closed_exit_has_no_width() {
    assert_eq!(thresholds_of([0.0, 1.0, 1.0], [false; 3]).0[0], 0);
    assert_eq!(thresholds_of([1.0, 1.0, 1.0], [true, true, false]), (vec![0, 0, u64::MAX], Some(2)));
    assert_eq!(thresholds_of([1.0, 1.0, 1.0], [false, true, true]), (vec![u64::MAX; 3], Some(0)));
    assert_eq!(thresholds_of([0.0, 1.0, 1.0], [false, true, true]).1, None);
}

/// Exits of very different widths, any of them blocked: a plain word tells if a void has no way out.
#[test]
fn a_word_tells_whether_an_exit_is_open() {
    let mut seen = [0; 2];
    for widths in 0..4usize.pow(3) {
        let diameters = [0, 1, 2].map(|exit| [0.0, 1e-4, 1.0, 1e4][widths / 4usize.pow(exit) % 4]);
        for blocked in 0..8 {
            let blocked = [0, 1, 2].map(|exit| blocked >> exit & 1 == 1);
            let (thresholds, last_open) = thresholds_of(diameters, blocked);
            let mut lattice = Lattice::new(1, 1, 1, 0);
            lattice.set_plain(0, &thresholds, last_open);
            assert_eq!(
                Lattice::has_no_exit(lattice.plain[0]),
                last_open.is_none(),
                "{diameters:?} {blocked:?}"
            );
            seen[usize::from(last_open.is_none())] += 1;
        }
    }
    assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
}

/// Any number of exits, closed ones among them, and every sixteen-bit draw: the exit by the definition,
/// whatever the other bits, or no exit if these decide.
#[test]
fn few_exits_are_chosen_as_by_the_definition() {
    let mut word = 1u64;
    let mut next = || {
        word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        word >> 33
    };
    for _ in 0..300 {
        let exits = 1 + next() % 14;
        let weight_by = |next: u64| match next % 5 {
            0 | 1 => 0.0,
            2 => 1e-9,
            _ => (next % 97) as f64,
        };
        let weight: Vec<f64> = (0..exits).map(|_| weight_by(next())).collect();
        let Some(last) = weight.iter().rposition(|&w| w > 0.0) else { continue };
        let total: f64 = weight.iter().sum();
        let mut sum = 0.0;
        let mut add = |w: &f64| {
            sum += w;
            (sum / total * TWO_TO_64) as u64
        };
        let thresholds: Vec<u64> = weight.iter().map(&mut add).collect();
        let few = FewExits::new(100, &thresholds, last);
        let open = weight.iter().filter(|&&w| w > 0.0).count();
        assert!(few.is_few || open > FEW_EXITS, "{weight:?}");
        for draw in (0..=u16::MAX).filter(|_| few.is_few) {
            let by = |low: u64| {
                let draw = u64::from(draw) << 48 | low;
                100 + thresholds.iter().position(|&t| draw < t).unwrap_or(last)
            };
            match few.chosen(draw) {
                Some(exit) => assert_eq!([exit; 2], [by(0), by((1 << 48) - 1)], "{weight:?} {draw}"),
                None => assert!(
                    draw == u16::MAX || thresholds.iter().any(|&t| (t >> 48) as u16 == draw),
                    "{weight:?} {draw}"
                ),
            }
        }
    }
}

/// Many exits, some of them closed, at the end too: the exit that the definition picks for every draw whose
/// upper bits decide; other draws, and voids of more exits than can be counted, are left to the long way.
#[test]
fn many_exits_are_chosen_as_by_looking_at_each() {
    let mut word = 5u64;
    let mut next = || {
        word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        word >> 33
    };
    for exits in [9, 40, 64, 65, 300, 3000, 65_535, 65_536] {
        let weight: Vec<f64> = (0..exits)
            .map(|e| if e + 3 > exits || next() % 4 == 0 { 0.0 } else { (1 + next() % 97) as f64 })
            .collect();
        let last = weight.iter().rposition(|&w| w > 0.0).unwrap();
        let total: f64 = weight.iter().sum();
        let sums = weight.iter().scan(0.0, |sum, w| {
            *sum += w;
            Some(*sum)
        });
        let thresholds: Vec<u64> = sums.map(|sum| (sum / total * TWO_TO_64) as u64).collect();
        let few = FewExits::new(7, &thresholds, last);
        if few.is_few {
            continue;
        }
        // Seven exits of other voids come before.
        let tops: Vec<u16> = [9; 7].into_iter().chain(thresholds.iter().map(|t| (t >> 48) as u16)).collect();
        let mut decided = 0;
        for draw in 0..=u16::MAX {
            let by = |low: u64| {
                let draw = u64::from(draw) << 48 | low;
                7 + thresholds.iter().position(|&t| draw < t).unwrap_or(last)
            };
            match few.chosen_of(&tops, draw) {
                Some(exit) if exits <= 300 || draw % 61 == 0 => {
                    assert_eq!([exit; 2], [by(0), by((1 << 48) - 1)], "{exits} {draw}");
                    decided += 1;
                }
                Some(_) => decided += 1,
                None => {
                    assert!(exits > 65_535 || draw == u16::MAX || tops[7..].contains(&draw), "{exits} {draw}")
                }
            }
        }
        let all = 1 << 16;
        match exits {
            65_536 => assert_eq!(decided, 0),
            65_535 => assert!(decided > all / 8, "{decided}"),
            _ => assert!(decided > all - 2 * exits, "{exits}: {decided}"),
        }
    }
    assert_eq!(FewExits::NONE.chosen_of(&[], 9), None);
}

/// Exits too far from the first for a byte are not few; exits in reach of one are.
#[test]
fn exits_beyond_a_byte_are_not_few() {
    for (last, is_few) in [(255, true), (256, false), (299, false)] {
        let thresholds: Vec<u64> = (0..300).map(|e| if e < last { 1 << 62 } else { u64::MAX }).collect();
        let few = FewExits::new(7, &thresholds, last);
        assert_eq!(
            (few.is_few, few.chosen(1 << 15).filter(|_| is_few)),
            (is_few, is_few.then_some(7 + last))
        );
        assert_eq!(few.chosen(1), Some(7));
    }
}

/// Once the exit with nearly all the area is blocked, the others keep their exact ratio.
#[test]
fn nothing_is_left_of_a_blocked_giant() {
    let (giant, _) = thresholds_of([1e6, 1.0, 1.0], [false; 3]);
    assert!(((u64::MAX - giant[0]) as f64 / TWO_TO_64 / 2e-12 - 1.0).abs() < 1e-3);
    assert_eq!(thresholds_of([1e6, 1.0, 1.0], [true, false, false]).0[1], 1 << 63);
    for scale in [1e-6, 1e6] {
        let (t, last) = thresholds_of([scale, 1.0, scale], [false; 3]);
        assert!(t[0] <= t[1] && last == Some(2));
    }
}

/// A table whose voids were renewed one after another as constrictions closed, with classes recomputed,
/// equals the table made of the constrictions left open.
#[test]
fn a_table_that_a_run_leaves_is_that_of_the_next() {
    let shape = [7, 5, 4];
    let count = Network::lattice_constrictions(shape).unwrap();
    let diameters =
        (0..count).map(|c| if c % 41 == 0 { 0.0 } else { 0.2 + (c * 7919 % 1009) as f32 / 100.0 });
    let network = Network::cubic_from_diameters(shape, diameters.collect(), 1.0).unwrap();
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    let mut table = ExitTable::new(&network, &blocked);
    let mut classes = [0; 2];
    for coarsest in [0.25, 1.0, 4.0, 20.0] {
        for c in (0..count).filter(|&c| network.diameters()[c] < coarsest && c % 17 > 0 || c % 29 == 0) {
            if !blocked.replace(c, true) {
                let ways = Ways::Unblocked(&blocked);
                of_each(&network, ways, [(c / 3) as u32], |exits| table.set(&network, ways, exits));
            }
        }
        let fresh = ExitTable::new(&network, &blocked);
        let words = |table: &ExitTable| match &table.form {
            Form::Lattice(lattice) => (lattice.plain.clone(), lattice.classed.clone(), lattice.finest),
            Form::General(_) => unreachable!("a lattice"),
        };
        classes[0] += usize::from(words(&table) != words(&fresh));
        table.class_anew(&network, &blocked);
        assert_eq!(words(&table), words(&fresh), "{coarsest}");
        classes[1] += 1;
    }
    assert!(classes[0] > 0 && classes[1] == 4, "{classes:?}");
}
