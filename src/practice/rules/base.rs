//! The base as practice describes it: regraded where it is broad, and its category by fines.

use voidwalk_core::gradation::{FEW_FINES, FINES_MM, Gradation, RegradeCause, RegradeReason, Regraded, TIE};

/// A base soil as practice describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseSoil {
    /// The soil after regrading, or the soil itself without regrading.
    pub gradation: Gradation,
    /// True if the soil was regraded.
    pub regraded: bool,
    /// Size on which the soil was regraded (mm).
    pub regraded_at_mm: Option<f64>,
    /// Reason for regrading or not.
    pub why: RegradeReason,
    /// Size (mm) below which practice looks at the soil, if no sieve gives the sizes there: they are at most
    /// this.
    pub hidden_below_mm: Option<f64>,
    /// Percent finer than 0.075 mm after regrading; `None` if the finest sieve is coarser and leaves a tail.
    pub fines_percent: Option<f64>,
    /// Category of NRCS after regrading, 1 to 4: more than 85 %, 40 to 85 %, 15 to 40 %, less than 15 %
    /// fines; `None` if the fines are not known closely enough.
    pub category: Option<u8>,
}

impl BaseSoil {
    /// Describes a base. Sizes that are multiples of D0F have no No. 4 and no No. 200 sieve: such a base
    /// remains as it is, without a category. Others are regraded by [`Gradation::regraded`].
    pub fn of(base: &Gradation, scale_free: bool) -> Self {
        if scale_free {
            return Self {
                gradation: base.clone(),
                regraded: false,
                regraded_at_mm: None,
                why: RegradeReason { cause: RegradeCause::NoUnit, nothing_passes: false },
                hidden_below_mm: None,
                fines_percent: None,
                category: None,
            };
        }
        Self::regraded(base.regraded())
    }

    /// Describes a base regraded like another curve of it, and, for a flat curve, the other reading.
    pub(super) fn both(base: &Gradation, as_of: &Gradation) -> (Self, Option<Self>) {
        let otherwise = base.regraded_otherwise(as_of).map(Self::regraded);
        (Self::regraded(base.regraded_as(as_of)), otherwise)
    }

    fn regraded(regraded: Regraded) -> Self {
        let Regraded { gradation, at_mm, why, hidden_below_mm } = regraded;
        let at_most = match hidden_below_mm {
            Some(_) => 100.0,
            None => whole(gradation.percent_finer_by_mass(FINES_MM)),
        };
        let is_known = match hidden_below_mm {
            Some(below) => below <= FINES_MM,
            None => gradation.pan_fraction() == 0.0 || gradation.smallest_mm() <= FINES_MM,
        };
        let fines_percent = is_known.then_some(at_most);
        let category = match fines_percent {
            Some(percent) if percent > 85.0 => Some(1),
            Some(percent) if percent >= 40.0 => Some(2),
            Some(percent) if percent >= FEW_FINES => Some(3),
            Some(_) => Some(4),
            None => (at_most < FEW_FINES).then_some(4),
        };
        Self {
            gradation,
            regraded: at_mm.is_some(),
            regraded_at_mm: at_mm,
            why,
            hidden_below_mm,
            fines_percent,
            category,
        }
    }
}

/// A percent without last digits that depend on how its curve was written.
fn whole(percent: f64) -> f64 {
    let whole = percent.round();
    if (percent - whole).abs() <= 100.0 * TIE { whole } else { percent }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soil(points: &[(f64, f64)]) -> BaseSoil {
        BaseSoil::of(&Gradation::from_lines(points).unwrap(), false)
    }

    /// The till of the first trial: 35 % finer than 0.075 mm of the whole, 92 % finer than 4.75 mm.
    #[test]
    fn fines_are_those_of_the_regraded_base() {
        let till = soil(&[(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)]);
        assert!(till.regraded && till.regraded_at_mm == Some(4.75));
        assert!((till.fines_percent.unwrap() - 35.0 / 0.92).abs() < 1e-9);
        assert_eq!(till.category, Some(3));
        // 12 % of the 80 % that pass No. 4 are 15 %: too many to count as few for certain.
        let tail = soil(&[(0.3, 12.0), (1.0, 40.0), (4.75, 80.0), (9.5, 100.0)]);
        assert_eq!((tail.fines_percent, tail.category), (None, None));
    }

    #[test]
    fn categories_are_by_fines_after_regrading() {
        for (fines, category) in [(90.0, 1), (85.0, 2), (40.0, 2), (39.9, 3), (15.0, 3), (14.9, 4)] {
            let base = soil(&[(0.001, 0.0), (0.075, fines), (0.5, 100.0)]);
            assert_eq!(base.category, Some(category), "{fines}");
        }
        // A table that ends at 0.075 mm gives its fines; one that ends above gives an upper bound.
        assert_eq!(soil(&[(0.075, 38.0), (0.5, 100.0)]).fines_percent, Some(38.0));
        let few = soil(&[(0.2, 10.0), (0.5, 100.0)]);
        assert_eq!((few.fines_percent, few.category), (None, Some(4)));
        // Gravel alone.
        let broad = soil(&[(5.0, 0.0), (10.0, 10.0), (30.0, 40.0), (60.0, 60.0), (80.0, 100.0)]);
        assert_eq!((broad.regraded, broad.category), (false, Some(4)));
    }
}
