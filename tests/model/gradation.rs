//! Sieve curves and drawing from them: the paper's identities, numbers against slow integrals, exact
//! thresholds, and readers that never panic.

use proptest::prelude::*;
use rand::Rng;
use voidwalk::constrictions::{Curve, CurveUnit};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::sheets::parse_gradation;
use voidwalk::stream::{Key, Purpose};

const ALL: u128 = 1 << 64;

fn close(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() <= relative, "{found} against {expected}");
}

/// A gap-graded soil with ten segments, one of them empty.
fn gap_graded() -> Gradation {
    let points = [
        (0.063, 0.0),
        (0.09, 3.0),
        (0.125, 9.0),
        (0.18, 16.0),
        (0.25, 26.0),
        (0.5, 26.0),
        (1.0, 40.0),
        (2.0, 62.0),
        (4.0, 80.0),
        (8.0, 97.0),
        (16.0, 100.0),
    ];
    Gradation::from_points(&points, None).unwrap()
}

/// Gradations of every kind: one segment, one size, few segments, many, a tail, a wide one.
fn kinds() -> Vec<Gradation> {
    vec![
        Gradation::linear_from_d0(0.1, 3.0).unwrap(),
        Gradation::single(0.37).unwrap(),
        Gradation::from_points(&[(0.2, 0.0), (0.3, 50.0), (1.0, 100.0)], None).unwrap(),
        gap_graded(),
        Gradation::from_points(&[(0.075, 12.0), (0.2, 55.0), (0.6, 100.0)], None).unwrap(),
        Gradation::linear_from_d0(1e-6, 1e5).unwrap(),
        Gradation::linear_from_d0(1.0, 1.0 + 1e-14).unwrap(),
    ]
}

/// `D_x = D_0 Cu^(x/50)`, so `D_60/D_10 = Cu` and `D_100/D_0 = Cu^2`.
#[test]
fn linear_is_straight_on_semi_log_paper() {
    for cu in [1.2, 1.5, 3.0, 4.5, 6.0] {
        let g = Gradation::linear_from_d0(0.2, cu).unwrap();
        for x in [0.0, 5.0, 10.0, 15.0, 50.0, 60.0, 85.0, 95.0, 100.0] {
            close(g.d(x).unwrap(), 0.2 * libm::pow(cu, x / 50.0), 1e-13);
            assert!((g.percent_finer_by_mass(g.d(x).unwrap()) - x).abs() < 1e-11);
        }
        close(g.cu().unwrap(), cu, 1e-13);
        close(g.largest_mm() / g.smallest_mm(), cu * cu, 1e-15);
        let through = Gradation::linear_from_dx(85.0, g.d(85.0).unwrap(), cu).unwrap();
        close(through.smallest_mm(), 0.2, 1e-13);
    }
    assert_eq!(Gradation::linear_from_d0(0.2, 1.0).unwrap(), Gradation::single(0.2).unwrap());
    assert_eq!(Gradation::linear_from_dx(85.0, 0.2, 1.0).unwrap().cu(), Some(1.0));
}

#[test]
fn what_no_gradation_can_be_is_refused() {
    for (result, text) in [
        (
            Gradation::linear_from_d0(1.0, 0.9),
            "cu = 0.9 is not allowed; allowed: a finite number, 1 (a single size) or more",
        ),
        (
            Gradation::linear_from_d0(1.0, f64::INFINITY),
            "cu = inf is not allowed; allowed: a finite number, 1 (a single size) or more",
        ),
        (
            Gradation::linear_from_d0(0.0, 2.0),
            "d0_mm = 0.0 is not allowed; allowed: a number from 1e-12 to 1e12",
        ),
        (
            Gradation::linear_from_d0(1.0, 1e7),
            "d100_mm = 100000000000000.0 is not allowed; allowed: a number from 1e-12 to 1e12",
        ),
        (
            Gradation::linear_from_dx(101.0, 1.0, 2.0),
            "percent = 101.0 is not allowed; allowed: a number from 0 to 100",
        ),
        (
            Gradation::linear_from_dx(85.0, f64::NAN, 2.0),
            "dx_mm = NaN is not allowed; allowed: a number from 1e-12 to 1e12",
        ),
        (Gradation::single(-1.0), "d_mm = -1.0 is not allowed; allowed: a number from 1e-12 to 1e12"),
        (
            gap_graded().scaled(f64::INFINITY),
            "factor = inf is not allowed; allowed: a positive finite number",
        ),
        (
            gap_graded().scaled(1e12),
            "scaled size = 2000000000000.0 is not allowed; allowed: a number from 1e-12 to 1e12",
        ),
        (
            Gradation::from_points(&[(1.0, f64::NAN)], None),
            "points, line 1, percent_finer: \"NaN\" is not allowed; allowed: a number from 0 to 100",
        ),
        (
            Gradation::from_points(&[], None),
            "points has no row of numbers; allowed: at least one row of two numbers",
        ),
    ] {
        assert_eq!(result.unwrap_err().to_string(), text);
    }
    let refused = SizeSampler::new(&gap_graded(), 0.0).unwrap_err().to_string();
    assert_eq!(refused, "reference_mm = 0.0 is not allowed; allowed: a positive finite number");
    assert!(SizeSampler::new(&gap_graded(), 1e-30).is_err());
}

#[test]
fn a_gap_holds_nothing() {
    let g = gap_graded();
    assert_eq!(g.d(26.0), Some(0.25));
    assert_eq!(g.percent_finer_by_mass(0.4), 26.0);
    assert_eq!(g.number_fraction_in(0.25, 0.5), 0.0);
    let limit = |d| SizeSampler::new(&g, 1.0).unwrap().word_limit(d);
    assert_eq!(limit(0.26), limit(0.49));
}

#[test]
fn a_tail_is_in_the_mass_and_not_in_the_number() {
    let table = [(0.1, 20.0), (0.4, 100.0)];
    let open = Gradation::from_points(&table, None).unwrap();
    assert_eq!((open.pan_fraction(), open.d(10.0), open.cu()), (0.2, None, None));
    assert_eq!((open.d(20.0), open.percent_finer_by_mass(0.01)), (Some(0.1), 20.0));
    assert_eq!((open.percent_finer_by_number(0.0999), open.percent_finer_by_number(0.4)), (0.0, 100.0));
    let ended = Gradation::from_points(&table, Some(0.05)).unwrap();
    assert_eq!((ended.pan_fraction(), ended.smallest_mm()), (0.0, 0.05));
    close(ended.d(10.0).unwrap(), 0.05 * 2.0f64.sqrt(), 1e-14);
    // The sized part is the same in both.
    let coarse = |g: &Gradation| g.number_fraction_in(0.1, 0.4) * g.particles_per_unit_volume();
    close(coarse(&open), coarse(&ended), 1e-12);
}

/// Numbers against a midpoint sum of `6 / (pi D^3)` over a million slices of the mass.
#[test]
fn numbers_agree_with_a_slow_integral() {
    for g in kinds() {
        let tail = 100.0 * g.pan_fraction();
        let slices = 1_000_000;
        let limit = g.d(0.5 * (100.0 + tail)).unwrap();
        let (mut all, mut fine) = (0.0, 0.0);
        for i in 0..slices {
            let d = g.d(tail + (100.0 - tail) * (f64::from(i) + 0.5) / f64::from(slices)).unwrap();
            let n = 6.0 / (std::f64::consts::PI * d * d * d);
            all += n;
            if d <= limit {
                fine += n;
            }
        }
        let volume = (1.0 - tail / 100.0) / f64::from(slices);
        close(g.particles_per_unit_volume(), all * volume, 1e-8);
        // A range of sizes too narrow for the slices to tell its halves apart is left out.
        if g.largest_mm() / g.smallest_mm() > 1.001 {
            close(g.number_fraction_in(0.0, limit), fine / all, 1e-5);
        }
    }
}

#[test]
fn sizes_by_number_invert_the_share_by_number() {
    for g in kinds() {
        assert_eq!(g.d_by_number(0.0), Some(g.smallest_mm()));
        assert_eq!((g.d_by_number(-1.0), g.d_by_number(f64::NAN)), (None, None));
        for percent in [1.0, 10.0, 50.0, 90.0, 99.0, 100.0] {
            let d = g.d_by_number(percent).unwrap();
            if g.largest_mm() / g.smallest_mm() > 1.001 {
                assert!((g.percent_finer_by_number(d) - percent).abs() < 1e-8, "{percent} {d}");
            }
        }
    }
}

/// Kolmogorov-Smirnov distance of 200,000 draws from the share by number. The limit, 2.226 / sqrt(n) =
/// 0.005, is passed by chance once in 10,000 draws of the test; a sampler whose distribution is off
/// by more than 0.01 at any size fails with a probability above 0.999, one off by less than 0.003
/// usually passes.
#[test]
fn draws_follow_the_distribution_by_number() {
    let n = 200_000;
    for (kind, g) in kinds().iter().enumerate() {
        if g.largest_mm() / g.smallest_mm() < 1.001 {
            continue;
        }
        let sampler = SizeSampler::new(g, 2.5).unwrap();
        let chunk = kind as u64;
        let mut generator =
            Key { seed: 11, purpose: Purpose::Insertion, run: 1, increment: 1, chunk }.generator();
        let words: Vec<u64> = (0..n).map(|_| generator.next_u64()).collect();
        let mut drawn = vec![0.0; n];
        sampler.fill(&words, &mut drawn);
        assert!(words.iter().zip(&drawn).all(|(&w, &d)| sampler.diameter(w) == d));
        drawn.sort_by(f32::total_cmp);
        let mut distance: f64 = 0.0;
        for (i, &d) in drawn.iter().enumerate() {
            let share = g.percent_finer_by_number(f64::from(d) * 2.5) / 100.0;
            let (below, above) = (i as f64 / n as f64, (i + 1) as f64 / n as f64);
            distance = distance.max((share - below).abs()).max((share - above).abs());
        }
        // Rounding to f32 puts draws on either side of a point by at most a few of them.
        assert!(distance < 2.226 / (n as f64).sqrt(), "kind {kind}: {distance}");
    }
}

#[test]
fn a_factor_of_two_on_every_length_changes_no_bit() {
    for g in kinds() {
        let sampler = SizeSampler::new(&g, 0.7).unwrap();
        for factor in [2.0, 0.5, 1024.0] {
            let scaled = g.scaled(factor).unwrap();
            assert_eq!(SizeSampler::new(&scaled, 0.7 * factor).unwrap(), sampler);
        }
    }
    let through = |f: f64| Gradation::linear_from_dx(85.0, 0.3 * f, 3.0).unwrap();
    assert_eq!(through(1.0).scaled(4.0).unwrap(), through(4.0));
    let sieve =
        |f: f64| Gradation::from_points(&[(0.1 * f, 20.0), (0.4 * f, 100.0)], Some(0.03 * f)).unwrap();
    assert_eq!(sieve(1.0).scaled(4.0).unwrap(), sieve(4.0));
}

/// The ends are the ends of the gradation, and a single size is that size exactly.
#[test]
fn draws_stay_within_the_gradation() {
    for g in kinds() {
        let sampler = SizeSampler::new(&g, 1.0).unwrap();
        assert_eq!(sampler.smallest(), g.smallest_mm() as f32);
        assert!(sampler.largest() <= g.largest_mm() as f32);
        assert_eq!(sampler.word_limit(sampler.largest()), ALL);
        assert_eq!(sampler.word_limit(sampler.smallest().next_down()), 0);
        assert_eq!(sampler.word_limit(f32::NAN), 0);
        assert_eq!(sampler.word_limit(f32::INFINITY), ALL);
    }
    let single = SizeSampler::new(&Gradation::single(0.37).unwrap(), 1.0).unwrap();
    assert_eq!((single.diameter(12345), single.largest()), (0.37, 0.37));
    let wide = SizeSampler::new(&Gradation::linear_from_d0(1.0, 4.5).unwrap(), 1.0).unwrap();
    assert_eq!(wide.largest(), 20.25);
}

/// The numbers themselves, so that no change of the arithmetic goes unnoticed.
#[test]
fn draws_are_pinned() {
    let words = [0, 1 << 62, 1 << 63, 0xc123_4567_89ab_cdef, 0xffff_ffff_0000_0000, u64::MAX];
    let bits = |g: &Gradation| {
        let sampler = SizeSampler::new(g, 1.0).unwrap();
        words.map(|w| sampler.diameter(w).to_bits())
    };
    assert_eq!(bits(&Gradation::linear_from_d0(0.1, 3.0).unwrap()), PINNED_LINEAR);
    assert_eq!(bits(&gap_graded()), PINNED_GAP);
}

const PINNED_LINEAR: [u32; 6] = [1036831949, 1038180498, 1040250108, 1042500526, 1063675494, 1063675494];
const PINNED_GAP: [u32; 6] = [1031865893, 1033197429, 1035792292, 1039253698, 1098849176, 1098907648];

#[test]
fn parts_add_up_to_the_whole() {
    for g in kinds() {
        // Mass and number of the particles up to a size say the mean of their cubes.
        let mean_cube_to = |mm: f64| {
            let mass = g.percent_finer_by_mass(mm) / 100.0 - g.pan_fraction();
            6.0 / std::f64::consts::PI * mass
                / (g.number_fraction_in(0.0, mm) * g.particles_per_unit_volume())
        };
        let sampler = SizeSampler::new(&g, 0.5).unwrap();
        let whole = sampler.whole();
        close(whole.mean_cube().unwrap(), mean_cube_to(1e12) * 8.0, 1e-9);
        let threshold = sampler.word_limit((2.0 * g.d_by_number(70.0).unwrap()) as f32);
        let (fine, coarse) = (sampler.part(0..threshold), sampler.part(threshold..ALL));
        let mass =
            |p: &voidwalk::gradation::SizeRange| p.mean_cube().map_or(0.0, |m| m * p.number_fraction());
        close(mass(&fine) + mass(&coarse), mass(&whole), 1e-12);
        if g.largest_mm() / g.smallest_mm() > 1.001 {
            // f32 moved the limit by up to 6e-8 of itself.
            let limit = g.d_by_number(70.0).unwrap();
            close(fine.mean_cube().unwrap(), 8.0 * mean_cube_to(limit), 1e-6);
            for (part, finer) in [(&fine, 0.0), (&coarse, fine.number_fraction()), (&whole, 0.0)] {
                for share in [0.0, 0.01, 0.4, 0.99, 1.0] {
                    let up_to = g.number_fraction_in(0.0, part.d_by_number(share).unwrap() / 2.0);
                    assert!(((up_to - finer) / part.number_fraction() - share).abs() < 1e-7, "{share}");
                }
            }
        }
        let none = sampler.part(5..5);
        assert_eq!((none.mean_cube(), none.largest_of(3, 1), whole.largest_of(0, 1)), (None, None, None));
        assert_eq!((none.d_by_number(0.5), whole.d_by_number(1.5)), (None, None));
    }
}

/// The largest of n by one draw against the largest of n draws: the mean share finer is n / (n + 1).
/// With 20,000 draws its standard error is 6e-4 for n = 9; an error below 0.003 would pass.
#[test]
fn the_largest_of_n_is_distributed_like_the_largest_of_n() {
    let g = Gradation::linear_from_d0(0.1, 3.0).unwrap();
    let sampler = SizeSampler::new(&g, 1.0).unwrap();
    let mut generator =
        Key { seed: 5, purpose: Purpose::PassiveSize, run: 1, increment: 1, chunk: 0 }.generator();
    let draws = 20_000;
    let mut mean = 0.0;
    for _ in 0..draws {
        let d = sampler.whole().largest_of(9, generator.next_u64()).unwrap();
        mean += g.percent_finer_by_number(f64::from(d)) / 100.0 / f64::from(draws);
    }
    assert!((mean - 0.9).abs() < 0.003, "{mean}");
    let most = sampler.whole().largest_of(u64::MAX, generator.next_u64()).unwrap();
    assert!(most > 0.8999, "{most}");
    assert_eq!(sampler.part(7..8).largest_of(1 << 40, 3), Some(sampler.diameter(7)));
}

/// A random table of up to 24 rows; percent may repeat (gaps), and may leave a tail.
fn any_gradation() -> impl Strategy<Value = Gradation> {
    let row = (1e-12f64..0.8, prop_oneof![Just(0.0), 0.0f64..10.0]);
    (1e-6f64..1e3, prop::collection::vec(row, 1..24), 0.0f64..5.0).prop_map(|(start, rows, tail)| {
        let total: f64 = rows.iter().map(|r| r.1).sum::<f64>() + tail + 1.0;
        let (mut size, mut percent) = (start, tail / total * 100.0);
        let mut points = vec![(size, percent)];
        for (log_ratio, mass) in rows {
            size *= libm::exp(log_ratio);
            percent = (percent + mass / total * 100.0).min(100.0);
            points.push((size, percent));
        }
        points.push((size * 1.5, 100.0));
        Gradation::from_points(&points, None).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Never falls from one word to the next that differs, near any word and across the whole range.
    #[test]
    fn diameters_never_fall_as_the_word_rises(g in any_gradation(), word: u64, steps in 1u64..1 << 40) {
        let sampler = SizeSampler::new(&g, 1.0).unwrap();
        let mut last = sampler.diameter(word);
        for i in 1..512u64 {
            let next = sampler.diameter(word.saturating_add(i << 12));
            prop_assert!(next >= last);
            last = next;
        }
        prop_assert!(sampler.diameter(word.saturating_add(steps << 12)) >= sampler.diameter(word));
        prop_assert!(sampler.smallest() >= g.smallest_mm() as f32);
        prop_assert!(sampler.largest() <= g.largest_mm() as f32);
    }

    /// `diameter(word) <= limit` exactly where the word is below the threshold, for limits that are
    /// drawn diameters, their neighbours, and any number.
    #[test]
    fn the_word_limit_is_exact(g in any_gradation(), words: [u64; 8], other in 0.0f32..10.0) {
        let sampler = SizeSampler::new(&g, 1.0).unwrap();
        for word in words {
            let d = sampler.diameter(word);
            for limit in [d, d.next_down(), d.next_up(), other] {
                let threshold = sampler.word_limit(limit);
                prop_assert!(threshold == ALL || sampler.diameter(threshold as u64) > limit);
                prop_assert!(threshold == 0 || sampler.diameter((threshold - 1) as u64) <= limit);
                for word in words {
                    prop_assert_eq!(sampler.diameter(word) <= limit, u128::from(word) < threshold);
                }
            }
        }
    }

    #[test]
    fn percent_and_size_are_inverse(g in any_gradation(), percent in 0.0f64..=100.0) {
        match g.d(percent) {
            None => prop_assert!(percent < 100.0 * g.pan_fraction() * (1.0 + 1e-12)),
            Some(d) => {
                // A gap in the sizes makes the share at least that percent, and nowhere less.
                prop_assert!(g.percent_finer_by_mass(d) >= percent - 1e-9);
                prop_assert!(g.percent_finer_by_mass(d * (1.0 - 1e-9)) <= percent + 1e-6);
            }
        }
    }

    /// Readers refuse or read; they never panic, whatever the bytes.
    #[test]
    fn readers_never_panic_on_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300), d0: Option<f64>) {
        let _ = parse_gradation("any", &bytes, d0);
        let _ = Curve::from_csv_text("any", &bytes);
    }

    /// The same on text that looks like a table.
    #[test]
    fn readers_never_panic_on_tables(
        header in prop::sample::select(vec!["", "opening_mm,percent_finer\n", "percent_smaller,diameter_mm\n",
            "diameter_over_d0f;percent_smaller\r\n", "\u{feff}#x\n"]),
        body in "([0-9]{1,3}[.,;\t][0-9]{0,3}[,;\t]?[-+0-9nafie%\" #]{0,6}\r?\n){0,12}",
        d0 in prop::option::of(-1.0f64..1.0),
    ) {
        let text = format!("{header}{body}");
        if let Ok(g) = parse_gradation("any", text.as_bytes(), d0) {
            let sampler = SizeSampler::new(&g, g.largest_mm()).unwrap();
            prop_assert!(sampler.largest() <= 1.0 && sampler.smallest() > 0.0);
        }
        if let Ok(c) = Curve::from_csv_text("any", text.as_bytes()) {
            prop_assert!(c.smallest() <= c.largest());
        }
    }

    /// Any curve: the quantile never falls, stays between the ends and inverts the share smaller.
    #[test]
    fn quantiles_never_fall(
        steps in prop::collection::vec((prop_oneof![Just(0.0), 0.0f64..1.0], prop_oneof![Just(0.0), 0.0f64..1.0]), 0..20),
        units in prop::collection::vec(0.0f64..=1.0, 2..40),
    ) {
        let total: f64 = steps.iter().map(|s| s.0).sum::<f64>() + 1.0;
        let (mut percent, mut d) = (0.0, 0.1);
        let mut points = vec![(0.0, 0.1)];
        for (mass, width) in steps {
            percent = f64::min(percent + mass / total * 100.0, 100.0);
            d += width;
            points.push((percent, d));
        }
        points.push((100.0, d));
        let curve = Curve::from_points(&points, CurveUnit::Mm).unwrap();
        let mut units = units;
        units.sort_by(f64::total_cmp);
        for pair in units.windows(2) {
            prop_assert!(curve.quantile(pair[0]) <= curve.quantile(pair[1]));
        }
        for unit in units {
            let d = curve.quantile(unit);
            prop_assert!((curve.smallest()..=curve.largest()).contains(&d));
            prop_assert!(curve.percent_smaller(d) >= 100.0 * unit - 1e-6);
            prop_assert!(curve.percent_smaller(d * (1.0 - 1e-9)) <= 100.0 * unit + 1e-3);
        }
        let doubled = curve.scaled(2.0).unwrap();
        prop_assert_eq!(doubled.quantile(0.3), 2.0 * curve.quantile(0.3));
    }
}
