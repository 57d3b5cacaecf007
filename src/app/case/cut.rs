//! The finer part of a filter, which is packed if the whole cannot be.
//!
//! A cell must be wider than two of its largest grains, so that a broad gradation asks for millions of
//! grains, most of them of the finest sizes. The constrictions are those between the finer grains; coarser
//! ones are walls to them. The effect of leaving the coarser ones out was measured on filters that can be
//! packed whole (`results/packing.md`): all constrictions become finer, from Dc5 to Dc90 by at most 0.6 times
//! the share of the grains' surface that is left out.

use crate::outcome::packing::{FLOATING_PERCENT, PackedPart};
use voidwalk_core::gradation::Gradation;

/// Width of a cell over the largest grain that is packed, if the program chooses it.
const CELLS_WIDTH: f64 = 2.5;
/// Relative error of the constrictions, which come out finer than in the whole, per surface share left out.
const ERROR_BY_SURFACE: f64 = 0.6;
/// A part that leaves more in doubt than this is not chosen.
const LARGEST_ERROR: f64 = 0.05;

/// The finer part of a filter, as a gradation of its own, with its description.
pub(super) fn finer_part(whole: &Gradation, percent: f64) -> Option<(Gradation, PackedPart)> {
    let largest_mm = whole.d(percent)?;
    let part = whole.passing(largest_mm)?;
    let surface_left_out = whole.surface_coarser_than(part.largest_mm());
    let packed = PackedPart {
        percent,
        largest_mm: part.largest_mm(),
        surface_left_out,
        finer_by: ERROR_BY_SURFACE * surface_left_out,
        sizes_missing_above: whole.percent_finer_by_mass(1.5 * part.largest_mm()) <= percent + 0.5,
    };
    Some((part, packed))
}

/// The largest finer part of which this many grains make a wide enough cell; `None` if it leaves out so much
/// that the result is in doubt.
pub(super) fn that_can_be_packed(
    whole: &Gradation,
    width: impl Fn(&Gradation) -> f64,
) -> Option<(Gradation, PackedPart)> {
    let (mut fits, mut too_wide) = (whole.pan_fraction() * 100.0, 100.0);
    for _ in 0..40 {
        let percent = 0.5 * (fits + too_wide);
        match finer_part(whole, percent) {
            Some((part, _)) if width(&part) < CELLS_WIDTH => too_wide = percent,
            _ => fits = percent,
        }
    }
    // Percent rounded down to a tenth.
    let percent = libm::floor(10.0 * fits + 1e-6) / 10.0;
    finer_part(whole, percent)
        .filter(|(_, packed)| packed.finer_by <= LARGEST_ERROR && packed.percent >= FLOATING_PERCENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::beside::packed_part;
    use voidwalk_practice::Note;

    /// ASTM C33 fine aggregate, the middle of its band.
    fn c33() -> Gradation {
        let table = [(0.15, 6.0), (0.3, 20.0), (0.6, 42.5), (1.18, 67.5), (2.36, 90.0), (4.75, 97.5)];
        Gradation::from_lines(&[&table[..], &[(9.5, 100.0)]].concat()).unwrap()
    }

    #[test]
    fn a_part_says_what_it_leaves_out() {
        let (part, packed) = finer_part(&c33(), 90.0).unwrap();
        assert!((part.largest_mm() - 2.36).abs() < 1e-9 && packed.percent == 90.0);
        assert!((part.percent_finer_by_mass(1.18) - 75.0).abs() < 1e-9);
        // By hand: percent / ln(b/a) (1/a - 1/b) of each row.
        assert!((packed.surface_left_out - 0.015855).abs() < 1e-6, "{packed:?}");
        assert!((packed.finer_by - 0.6 * packed.surface_left_out).abs() < 1e-15);
        assert!(!packed.sizes_missing_above);
        let Note::PartPacked { part_percent, largest_mm, .. } = packed_part(&packed) else {
            panic!("{packed:?}")
        };
        assert!((part_percent - 90.0).abs() < 0.05 && (largest_mm - 2.36).abs() < 0.005, "{packed:?}");
        // All of it leaves nothing out.
        let (all, packed) = finer_part(&c33(), 100.0).unwrap();
        assert_eq!((all, packed.surface_left_out), (c33(), 0.0));
    }

    #[test]
    fn what_is_chosen_makes_a_wide_cell_and_no_more() {
        // A cell of 8 mm, whatever is packed.
        let width = |part: &Gradation| 8.0 / part.largest_mm();
        let (part, packed) = that_can_be_packed(&c33(), width).unwrap();
        assert!((width(&part) - CELLS_WIDTH).abs() < 0.02, "{packed:?}");
        // In a gap the part ends with the sizes below it.
        let gap_at = |percent| {
            let table = [(0.2, 0.0), (0.5, percent), (5.0, percent), (10.0, 100.0)];
            Gradation::from_lines(&table).unwrap()
        };
        let gap = gap_at(40.0);
        let (part, packed) = that_can_be_packed(&gap, width).unwrap();
        assert!(part.largest_mm() <= 0.5 && packed.percent > 39.8, "{packed:?}");
        assert!(packed.sizes_missing_above);
        assert!(matches!(packed_part(&packed), Note::FloatingPartPacked { .. }));
        // Too few grains for a part that represents the whole, and fines that coarse grains do not float in.
        assert_eq!(that_can_be_packed(&c33(), |part| 1.0 / part.largest_mm()), None);
        assert_eq!(that_can_be_packed(&gap_at(20.0), width), None);
    }
}
