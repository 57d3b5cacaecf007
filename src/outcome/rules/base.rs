//! The base as practice describes it: regraded where it is broad, and its category by fines.

use crate::gradation::{FINES_MM, Gap, Gradation};

/// Largest size of sand (mm): the No. 4 sieve.
pub const SAND_MM: f64 = 4.75;

/// Percent of fines below which a base is of category 4.
pub const FEW_FINES: f64 = 15.0;

/// A base soil as practice describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseSoil {
    /// The soil after regrading; as it was where it is not regraded.
    pub gradation: Gradation,
    /// Whether it was regraded.
    pub regraded: bool,
    /// The size on which it was regraded (mm).
    pub regraded_at_mm: Option<f64>,
    /// Why it was regraded, or not.
    pub why: String,
    /// Percent finer than 0.075 mm after regrading; `None` where the finest sieve is coarser and leaves a
    /// tail.
    pub fines_percent: Option<f64>,
    /// Category of NRCS after regrading, 1 to 4: more than 85 %, 40 to 85 %, 15 to 40 %, less than 15 %
    /// fines; `None` where the fines are not known closely enough.
    pub category: Option<u8>,
}

impl BaseSoil {
    /// Describes a base. Sizes that are multiples of D0F have no No. 4 and no No. 200 sieve: such a base is
    /// left as it is, without a category.
    ///
    /// Regrading is that of the U.S. Army Corps of Engineers' Filter Evaluation manual (chapter Base
    /// Gradation), after Sherard and Dunnigan (1989): a gap-graded soil at its gap; a soil with grains
    /// coarser than No. 4 to 100 % passing No. 4, unless it has less than 15 % fines and is not broadly
    /// graded.
    pub fn of(base: &Gradation, scale_free: bool) -> Self {
        if scale_free {
            return Self {
                gradation: base.clone(),
                regraded: false,
                regraded_at_mm: None,
                why: "sizes are multiples of D0F".into(),
                fines_percent: None,
                category: None,
            };
        }
        let (at, why) = regrading(base);
        let passing = at.and_then(|at| base.passing(at));
        let why = match (at, &passing) {
            (Some(_), None) => format!("{why}; but no known size of it passes that sieve: left as it is"),
            _ => why,
        };
        let regraded_at_mm = at.filter(|_| passing.is_some());
        let gradation = passing.unwrap_or_else(|| base.clone());
        let (fines_percent, at_most) = fines(&gradation);
        let category = match fines_percent {
            Some(percent) if percent > 85.0 => Some(1),
            Some(percent) if percent >= 40.0 => Some(2),
            Some(percent) if percent >= FEW_FINES => Some(3),
            Some(_) => Some(4),
            None => (at_most < FEW_FINES).then_some(4),
        };
        Self { gradation, regraded: regraded_at_mm.is_some(), regraded_at_mm, why, fines_percent, category }
    }
}

/// Percent finer than 0.075 mm, where it is known, and the most that it can be.
fn fines(soil: &Gradation) -> (Option<f64>, f64) {
    let percent = soil.percent_finer_by_mass(FINES_MM);
    (known_at(soil, FINES_MM).then_some(percent), percent)
}

/// Whether the percent finer than this size is known.
fn known_at(soil: &Gradation, size_mm: f64) -> bool {
    soil.pan_fraction() == 0.0 || soil.smallest_mm() <= size_mm
}

/// The size on which practice regrades this base, and why.
fn regrading(base: &Gradation) -> (Option<f64>, String) {
    if let Some(Gap { from_mm, .. }) = base.gap(FINES_MM) {
        return (
            Some(from_mm),
            format!("gap-graded: next to nothing between {from_mm:.3} mm and four times that"),
        );
    }
    if base.largest_mm() <= SAND_MM {
        return (None, "nothing is coarser than No. 4 (4.75 mm)".into());
    }
    let broad = is_broad(base);
    if fines(base).1 < FEW_FINES && broad == Some(false) {
        return (None, "less than 15 % fines and not broadly graded".into());
    }
    let why = match broad {
        _ if fines(base).1 >= FEW_FINES => "grains coarser than No. 4 (4.75 mm) and 15 % fines or more",
        Some(true) => "broadly graded, with grains coarser than No. 4 (4.75 mm)",
        _ => "grains coarser than No. 4 (4.75 mm), and Cu is not known: taken as broadly graded",
    };
    (Some(SAND_MM), why.into())
}

/// Whether a soil is broadly graded by ASTM D2487: Cc of 1 to 3 with a Cu of at least 6 for sands, 4 for
/// gravels; `None` where D10 is not known.
fn is_broad(soil: &Gradation) -> Option<bool> {
    let coarse = 100.0 - soil.percent_finer_by_mass(FINES_MM);
    let gravel = 100.0 - soil.percent_finer_by_mass(SAND_MM);
    let least_cu = if gravel > coarse / 2.0 { 4.0 } else { 6.0 };
    Some((1.0..=3.0).contains(&soil.cc()?) && soil.cu()? >= least_cu)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soil(points: &[(f64, f64)]) -> BaseSoil {
        BaseSoil::of(&Gradation::from_points(points, None).unwrap(), false)
    }

    /// The till of the first trial: 35 % finer than 0.075 mm of the whole, 92 % finer than 4.75 mm.
    #[test]
    fn a_till_is_regraded_on_no_4_by_hand() {
        let till = soil(&[(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)]);
        assert!(till.regraded && till.regraded_at_mm == Some(4.75));
        assert!((till.fines_percent.unwrap() - 35.0 / 0.92).abs() < 1e-9);
        assert_eq!(till.category, Some(3));
        // 85 % of 92 % is 78.2 % of the whole: between 0.425 mm (60 %) and 2 mm (82 %).
        let d85 = 0.425 * (2.0f64 / 0.425).powf(18.2 / 22.0);
        assert!((till.gradation.d(85.0).unwrap() - d85).abs() < 1e-9);
    }

    #[test]
    fn each_question_of_the_manual_has_its_answer() {
        // Nothing coarser than No. 4.
        assert!(!soil(&[(0.1, 0.0), (0.5, 60.0), (4.75, 100.0)]).regraded);
        // Coarser, less than 15 % fines, Cu 3.2: left.
        let gravel = soil(&[(2.0, 0.0), (9.5, 60.0), (19.0, 100.0)]);
        assert!(!gravel.regraded && gravel.why.contains("not broadly graded"));
        // Coarser and broadly graded: Cu 15.0, Cc 1.01.
        let broad = soil(&[(0.1, 0.0), (0.5, 20.0), (2.0, 45.0), (4.75, 70.0), (19.0, 100.0)]);
        assert!(broad.regraded && broad.why.starts_with("broadly graded"), "{}", broad.why);
        // Coarser, and D10 in a tail: on the safe side.
        let tail = soil(&[(0.3, 12.0), (1.0, 40.0), (4.75, 80.0), (9.5, 100.0)]);
        assert!(tail.regraded && tail.why.contains("not known") && tail.fines_percent.is_none());
        assert_eq!(tail.category, None, "12 % of 80 % is 15 %");
        // A gap: the part finer than it.
        let gap = soil(&[(0.1, 0.0), (0.5, 40.0), (5.0, 40.0), (20.0, 100.0)]);
        assert_eq!((gap.regraded_at_mm, gap.gradation.largest_mm()), (Some(0.5), 0.5));
    }

    #[test]
    fn categories_are_by_fines_after_regrading() {
        for (fines, category) in [(90.0, 1), (85.0, 2), (40.0, 2), (39.9, 3), (15.0, 3), (14.9, 4)] {
            let base = soil(&[(0.001, 0.0), (0.075, fines), (0.5, 100.0)]);
            assert_eq!(base.category, Some(category), "{fines}");
        }
        // A table that ends at 0.075 mm knows its fines; one that ends above knows at most.
        assert_eq!(soil(&[(0.075, 38.0), (0.5, 100.0)]).fines_percent, Some(38.0));
        let few = soil(&[(0.2, 10.0), (0.5, 100.0)]);
        assert_eq!((few.fines_percent, few.category), (None, Some(4)));
    }

    #[test]
    fn gravel_alone_has_nothing_to_regrade() {
        let broad = soil(&[(5.0, 0.0), (10.0, 10.0), (30.0, 40.0), (60.0, 60.0), (80.0, 100.0)]);
        assert!(!broad.regraded, "{}", broad.why);
        assert_eq!(broad.category, Some(4));
    }
}
