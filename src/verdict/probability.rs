//! The probability that a test would show no erosion, in words, and a D15F beside the range of tests.

use crate::outcome::apart::digits_of;
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::record::Bound;

/// How near the walk's probability comes to 0 or 1: half a step of its 20 quantiles.
const WALK_SURE: f64 = 0.025;

/// How near an end of a range a D15F has no margin to it, of that end.
const AT_END: f64 = 0.005;

/// Where the range was read.
pub const SOURCE: &str = "Fell et al., Geotechnical Engineering of Dams, Table 9.2";

/// A probability is never nearer to 0 or 1 than this.
pub const SURE: f64 = 0.02;

/// Whether a filter is coarser than any that held such soils in tests, by its probability from the range that
/// they published: at its end nobody can tell the least probability from none.
pub fn is_beyond_range(by_tests: Option<f64>) -> bool {
    by_tests.is_some_and(|of| of <= SURE)
}

/// A probability of no erosion in words, with what it takes and what it is not for; the range of tests (mm),
/// where that is known.
pub fn stated(each: &str, range: Option<[f64; 2]>) -> String {
    let ends = range.map_or_else(String::new, |[low, high]| {
        format!(" of {} to {} mm", rounded_down(low), rounded_up(high))
    });
    format!(
        "Probability of no erosion in a test, not for a risk analysis: {each}; boundaries are taken as \
         log-uniform within the published range{ends} (Fell et al., Table 9.2)"
    )
}

/// Said of the one number that stands alone.
const LOWER: &str = "the lower of two; beyond the D15F for which tests saw no erosion";

/// A probability of no erosion in percent: at its caps it may be any less or more.
fn probability_in_words(probability: f64, bound: Option<Bound>) -> String {
    let shown = format!("{:.0} %", 100.0 * probability);
    let (is_most, is_least) = (probability >= 1.0 - WALK_SURE, probability <= WALK_SURE);
    match bound {
        Some(Bound::AtMost) if !is_least => format!("at most {shown}"),
        Some(Bound::AtLeast) if !is_most => format!("at least {shown}"),
        _ if is_most => format!("{shown} or more"),
        _ if is_least => format!("{shown} or less"),
        _ => shown,
    }
}

/// The probability that a test would show no erosion, in words: by the published range, and by the walk with
/// its bound; beyond the boundary that tests saw the lower of the two alone, where their order is known.
pub fn probabilities(
    (by_walk, bound): (Option<f64>, Option<Bound>),
    by_tests: Option<f64>,
    is_beyond_tests: bool,
) -> Option<String> {
    let of_walk = by_walk.map(|of| (of, format!("{} by the walk", probability_in_words(of, bound))));
    let of_tests = |of: f64| (of, format!("{} by the published range", probability_in_words(of, None)));
    let mut each: Vec<(f64, String)> = by_tests.map(of_tests).into_iter().chain(of_walk).collect();
    if is_beyond_tests && let [(by_tests, _), (by_walk, _)] = each[..] {
        let is_walk = by_walk < by_tests;
        // A bound on the far side leaves open which of the two is the lower.
        let is_open = bound == Some(if is_walk { Bound::AtLeast } else { Bound::AtMost });
        if !is_open {
            let (_, lower) = each.swap_remove(usize::from(is_walk));
            return Some(format!("{lower} ({LOWER})"));
        }
    }
    let each: Vec<String> = each.into_iter().map(|(_, said)| said).collect();
    (!each.is_empty()).then(|| each.join(", "))
}

/// Where a D15F (mm) lies beside the range of D15F in which tests on soils with such fines had their boundary
/// of no erosion: what can be said without any probability; the source stands behind the range, where it is
/// named.
pub fn beside_range(d15f_mm: f64, range: [f64; 2], source: &str) -> String {
    place_in_range("D15F", d15f_mm, range, source)
}

/// The same of a D15F that is named: of the filter at a limit, and not of one that is judged.
pub fn named_beside_range(d15f_mm: f64, range: [f64; 2], source: &str) -> String {
    // A hair below a limit reads as the limit.
    let name = format!("A D15F of {} mm", rounded_down(d15f_mm * (1.0 + 1e-8)));
    place_in_range(&name, d15f_mm, range, source)
}

fn place_in_range(name: &str, d15f_mm: f64, [low, high]: [f64; 2], source: &str) -> String {
    let is_at = |end: f64| (d15f_mm / end - 1.0).abs() <= AT_END;
    let [lower, upper] = [rounded_down(low), rounded_up(high)];
    let of = |end: f64| digits_of(d15f_mm / end, 2);
    let source = if source.is_empty() { String::new() } else { format!("; {source}") };
    let place = match d15f_mm {
        _ if is_at(low) => "is at the lower end of",
        _ if is_at(high) => "is at the upper end of",
        d15f if d15f < low => {
            return format!(
                "{name} is {} of the lowest D15F with erosion in tests on soils with such fines ({lower} \
                 mm{source})",
                of(low)
            );
        }
        d15f if d15f > high => {
            return format!(
                "{name} is {} times the highest D15F without erosion in tests on soils with such fines \
                 ({upper} mm{source})",
                of(high)
            );
        }
        _ => "lies in",
    };
    format!(
        "{name} {place} the range in which erosion began in tests on soils with such fines ({lower} to \
         {upper} mm{source})"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests of bases with 35 to 85 % fines had their boundary at 0.7 to 1.7 mm.
    #[test]
    fn a_d15f_stands_beside_the_range_of_tests_without_a_probability() {
        let said = |d15f| beside_range(d15f, [0.7, 1.7], "");
        assert_eq!(
            said(0.234),
            "D15F is 0.33 of the lowest D15F with erosion in tests on soils with such fines (0.700 mm)"
        );
        assert!(said(0.8).starts_with("D15F lies in the range in which erosion began"), "{}", said(0.8));
        assert!(said(0.8).ends_with("(0.700 to 1.70 mm)"), "{}", said(0.8));
        let coarse = said(2.21);
        assert!(coarse.starts_with("D15F is 1.3 times the highest D15F without erosion"), "{coarse}");
        assert!(coarse.ends_with("(1.70 mm)"), "{coarse}");
        assert!(beside_range(2.21, [0.7, 1.7], "Table 9.2").ends_with(" (1.70 mm; Table 9.2)"));
    }

    /// At an end of the range there is no margin, and no quotient to print: a limit is a hair below.
    #[test]
    fn at_an_end_of_the_range_the_end_is_said() {
        for (d15f, end) in [
            (0.7, "lower"),
            (0.7 * (1.0 - 1e-9), "lower"),
            (0.6966, "lower"),
            (0.703, "lower"),
            (1.705, "upper"),
        ] {
            assert_eq!(
                beside_range(d15f, [0.7, 1.7], ""),
                format!(
                    "D15F is at the {end} end of the range in which erosion began in tests on soils with \
                     such fines (0.700 to 1.70 mm)"
                )
            );
        }
        assert!(beside_range(0.69, [0.7, 1.7], "").starts_with("D15F is 0.99 of the lowest"));
        let named = named_beside_range(0.7 * (1.0 - 1e-9), [0.7, 1.7], SOURCE);
        assert!(named.starts_with("A D15F of 0.700 mm is at the lower end of the range in which"), "{named}");
    }

    #[test]
    fn a_probability_says_how_it_is_read_and_what_it_is_not_for() {
        assert_eq!(
            stated("88 % by the published range", Some([0.7, 1.7])),
            "Probability of no erosion in a test, not for a risk analysis: 88 % by the published range; \
             boundaries are taken as log-uniform within the published range of 0.700 to 1.70 mm (Fell et \
             al., Table 9.2)"
        );
        assert!(stated("88 %", None).contains("within the published range (Fell et al."));
    }

    #[test]
    fn beyond_the_boundary_of_tests_the_lower_probability_stands_alone() {
        let said = |walk, tests, beyond| probabilities((walk, None), tests, beyond).unwrap();
        assert_eq!(said(Some(0.9), Some(0.6), false), "60 % by the published range, 90 % by the walk");
        let lower =
            |of: &str| format!("{of} (the lower of two; beyond the D15F for which tests saw no erosion)");
        assert_eq!(said(Some(0.9), Some(0.6), true), lower("60 % by the published range"));
        assert_eq!(said(Some(0.3), Some(0.6), true), lower("30 % by the walk"));
        assert_eq!(said(None, Some(0.6), true), "60 % by the published range");
        assert_eq!(probabilities((None, None), None, false), None);
    }

    #[test]
    fn a_bound_that_leaves_the_order_open_leaves_both() {
        let said = |walk, bound| probabilities((Some(walk), Some(bound)), Some(0.6), true).unwrap();
        assert_eq!(said(0.9, Bound::AtMost), "60 % by the published range, at most 90 % by the walk");
        assert_eq!(said(0.3, Bound::AtLeast), "60 % by the published range, at least 30 % by the walk");
        assert!(said(0.3, Bound::AtMost).starts_with("at most 30 % by the walk (the lower of two; "));
        assert!(said(0.9, Bound::AtLeast).starts_with("60 % by the published range (the lower of two; "));
    }

    #[test]
    fn beyond_the_range_of_tests_no_probability_is_said() {
        for (by_tests, is_beyond) in [(Some(SURE), true), (Some(0.021), false), (Some(0.98), false)] {
            assert_eq!(is_beyond_range(by_tests), is_beyond, "{by_tests:?}");
        }
        assert!(!is_beyond_range(None));
    }

    #[test]
    fn a_probability_at_its_cap_is_no_value() {
        let said = probability_in_words;
        assert_eq!(
            [0.98, 0.975, 0.02, 0.025].map(|of| said(of, None)),
            ["98 % or more", "98 % or more", "2 % or less", "2 % or less"]
        );
        assert_eq!(said(0.27, None), "27 %");
        assert_eq!(said(0.93, Some(Bound::AtLeast)), "at least 93 %");
        assert_eq!(said(0.975, Some(Bound::AtLeast)), "98 % or more");
        assert_eq!(said(0.975, Some(Bound::AtMost)), "at most 98 %");
        assert_eq!(said(0.02, Some(Bound::AtMost)), "2 % or less");
    }
}
