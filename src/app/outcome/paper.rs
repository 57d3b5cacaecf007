//! Results of the paper beside the walk: Table 2 on its filters, without fitting at run time, and Eq. (1)
//! on the depth that single particles reach in the clean filter.

use super::record::{Infiltration, InfiltrationSize};
use voidwalk_core::constrictions::Curve;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::Passage;

/// Row of Table 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PaperFilter {
    /// D60 / D10 by mass of the linear gradation.
    pub(crate) cu: f64,
    /// Friction between grains during compression.
    pub(crate) friction: f64,
    /// Void ratio.
    pub(crate) void_ratio: f64,
    /// D60 / D10 by number of the constrictions.
    pub(crate) cu_csd: f64,
}

/// Table 2 of Shire & O'Sullivan, *A network model to assess base-filter combinations*.
const TABLE_2: [PaperFilter; 6] = [
    PaperFilter { cu: 1.2, friction: 0.0, void_ratio: 0.558, cu_csd: 1.48 },
    PaperFilter { cu: 1.5, friction: 0.0, void_ratio: 0.531, cu_csd: 1.52 },
    PaperFilter { cu: 1.5, friction: 0.3, void_ratio: 0.658, cu_csd: 1.63 },
    PaperFilter { cu: 3.0, friction: 0.0, void_ratio: 0.382, cu_csd: 1.57 },
    PaperFilter { cu: 3.0, friction: 0.3, void_ratio: 0.455, cu_csd: 1.60 },
    PaperFilter { cu: 6.0, friction: 0.7, void_ratio: 0.340, cu_csd: 1.57 },
];

/// Filter of the paper with this linear gradation and friction, if there is one.
pub(crate) fn filter(cu: f64, friction: f64) -> Option<PaperFilter> {
    TABLE_2.into_iter().find(|f| (f.cu - cu).abs() < 1e-6 && f.friction == friction)
}

/// Percents finer by mass of the base at which sizes are followed.
const SIZES: [f64; 6] = [15.0, 50.0, 85.0, 90.0, 95.0, 100.0];

/// Number of parts of the base's mass used to sum the mass that would leave without blocking.
const PARTS: u32 = 400;

/// Evaluates Eq. (1) for this base on a cubic lattice of `layers` layers with this constriction curve (mm).
///
/// The pan fraction (finer than the finest sieve) is passive: all of it would leave.
pub(crate) fn infiltration(curve: &Curve, base: &Gradation, layers: u64) -> Infiltration {
    let passage = Passage::new(curve);
    let of_size = |percent: &f64| {
        let diameter_mm = base.d(*percent)?;
        Some(InfiltrationSize {
            name: format!("D{percent}B"),
            diameter_mm,
            downstream: passage.downstream(diameter_mm),
            layers_95: passage.layers(diameter_mm, 0.95),
            layers_99: passage.layers(diameter_mm, 0.99),
            through: passage.through(diameter_mm, layers),
        })
    };
    let pan_fraction = base.pan_fraction();
    let sized = (0..PARTS).filter_map(|part| {
        let share = (f64::from(part) + 0.5) / f64::from(PARTS);
        Some(passage.through(base.d(100.0 * (pan_fraction + (1.0 - pan_fraction) * share))?, layers))
    });
    let sized = sized.sum::<f64>() / f64::from(PARTS);
    Infiltration {
        layers,
        sizes: SIZES.iter().filter_map(of_size).collect(),
        coarsest_through_mm: passage.coarsest_through(layers, 0.95),
        eroded_without_blocking: pan_fraction + (1.0 - pan_fraction) * sized,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voidwalk_core::constrictions::CurveUnit;

    #[test]
    fn all_or_nothing_passes_a_filter_of_one_constriction_size() {
        let curve = Curve::from_points(&[(100.0, 0.2)], CurveUnit::Mm).unwrap();
        let of_base = |d0: f64| infiltration(&curve, &Gradation::linear_from_d0(d0, 1.5).unwrap(), 60);
        assert_eq!(of_base(0.05).eroded_without_blocking, 1.0);
        assert_eq!(of_base(0.3).eroded_without_blocking, 0.0);
        // Straight from 0.15 to 0.3375 on semi-log paper: the fine enough fraction of the mass is ln(0.2
        // / 0.15) / ln(2.25).
        let some = of_base(0.15);
        let expected = libm::log(0.2 / 0.15) / libm::log(2.25);
        assert!((some.eroded_without_blocking - expected).abs() < 0.5 / 400.0 + 1e-9);
        assert_eq!((some.sizes[0].layers_95, some.sizes[5].layers_95), (None, Some(0.0)));
        assert!((some.coarsest_through_mm - 0.2).abs() < 1e-12);
    }

    #[test]
    fn the_pan_fraction_would_leave() {
        let curve = Curve::from_points(&[(100.0, 0.2)], CurveUnit::Mm).unwrap();
        let base = Gradation::from_lines(&[(0.3, 40.0), (0.6, 100.0)]).unwrap();
        let result = infiltration(&curve, &base, 60);
        assert!((result.eroded_without_blocking - 0.4).abs() < 1e-12);
        assert_eq!(result.sizes[0].name, "D50B");
    }
}
