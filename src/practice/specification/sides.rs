//! Internal stability of both sides of a band, judged like filters.

use crate::Note;
use crate::design::RowNote;
use crate::design::specification::SizeBand;
use voidwalk_core::gradation::{Gradation, ShapeIndex, SoilSplit};

/// The greatest D'15/d'85 of a stable soil by Kezdi.
pub(super) const MOST_KEZDI: f64 = 4.0;

/// The least H/F of a stable soil by Kenney and Lau.
pub(super) const LEAST_SHAPE: f64 = 1.0;

/// A side of a band as a soil.
pub(super) struct Side {
    /// `fine` or `coarse`.
    pub name: &'static str,
    pub kezdi: Option<SoilSplit>,
    pub kenney_lau: Option<ShapeIndex>,
}

impl Side {
    /// Both sides; an index is `None` for a side of one size. The line drawn below D5 of the fine side is a
    /// limit of fines, and no part of a gradation.
    pub fn both(band: &SizeBand) -> [Self; 2] {
        let [fine, coarse] = band.continued();
        [("fine", fine), ("coarse", coarse)].map(|(name, points)| {
            let soil = Gradation::of_rows(&points).ok();
            let kezdi = soil.as_ref().and_then(Gradation::kezdi);
            Self { name, kezdi, kenney_lau: soil.as_ref().and_then(Gradation::kenney_lau) }
        })
    }

    /// Authors of the rules that the side does not keep.
    pub fn authorities(&self) -> Vec<String> {
        let kezdi = self.kezdi.filter(|index| index.value > MOST_KEZDI).map(|_| "Kézdi".to_owned());
        let shape =
            self.kenney_lau.filter(|index| index.value < LEAST_SHAPE).map(|_| "Kenney and Lau".to_owned());
        kezdi.into_iter().chain(shape).collect()
    }

    /// True if both indices are known.
    pub fn is_known(&self) -> bool {
        self.kezdi.is_some() && self.kenney_lau.is_some()
    }
}

/// Notes on the sides of a band.
pub(super) fn notes(band: Option<&SizeBand>) -> Vec<RowNote> {
    let row_note = |side: &Side| {
        let authorities = side.authorities();
        let note = Note::UnstableSide { side: side.name.into(), authorities: authorities.clone() };
        (!authorities.is_empty()).then_some(RowNote { row: None, note })
    };
    band.map(|band| Side::both(band).iter().filter_map(row_note).collect()).unwrap_or_default()
}
