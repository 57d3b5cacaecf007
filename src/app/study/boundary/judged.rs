//! A row at one ratio with its sizes, and notes on the model there for a reader.

use super::row::Row;
use crate::case::{Case, CaseBase, CaseSupply, StatedBase};
use crate::run::error::RunError;
use crate::scene::{Amount, BaseGradation, D85};
use voidwalk_practice::Note;
use voidwalk_practice::{Mistake, ordered};

/// Fewer networks than these give no percentiles.
const FEW_NETWORKS: u64 = 5;

/// A base coarser than this (D85, mm) gets a note.
const COARSE_BASE_MM: f64 = 10.0;

/// Notes on the search itself: a band over so few networks says little, and a number of base particles may
/// differ from Eq. (2) at some ratios.
fn of_search(row: &Row) -> Vec<Note> {
    let networks = row.case.scene.walk.replicates;
    let few = (networks < FEW_NETWORKS).then_some(Note::FewNetworks { networks });
    few.into_iter().chain(of_amount(row)).collect()
}

fn of_amount(row: &Row) -> Option<Note> {
    match row.case.scene.base.amount() {
        Amount::Number(n) | Amount::MassRatio(_, Some(n)) => Some(Note::AmountHeld { particles: n }),
        Amount::MassRatio(_, None) => None,
    }
}

/// A row at one ratio with the sizes that it has there.
pub(super) struct Judged {
    /// The case with the sizes that filter and base have there; without a unit, sizes in units of D85B.
    pub case: Case,
    /// D85B (mm).
    d85_mm: Option<f64>,
    /// The base that was stated.
    pub base_name: String,
    /// Thickness of the real filter (mm), if nothing here has a size to compare it with.
    real_thickness: Option<f64>,
}

impl Judged {
    pub fn new(row: &Row, ratio: f64) -> Result<Self, RunError> {
        let (has_size, d85) = (row.d85_mm.is_some(), row.d85_mm.unwrap_or(1.0));
        let scaled = |stated: &StatedBase| -> Result<StatedBase, RunError> {
            let factor = d85 / row.stated.base.gradation.d(85.0).unwrap_or(d85);
            let sizes = |gradation: &voidwalk_core::gradation::Gradation| {
                gradation.scaled(factor).map_err(crate::case::CaseError::from)
            };
            let regraded_from = match &stated.base.regraded_from {
                Some((given, at)) => Some((sizes(given)?, at * factor)),
                None => None,
            };
            let base = CaseBase { gradation: sizes(&stated.base.gradation)?, regraded_from };
            Ok(StatedBase { base, ..stated.clone() })
        };
        let stated = if has_size { row.stated.clone() } else { scaled(&row.stated)? };
        let mut case = row.case.enlarged(ratio * d85 / row.d15f(), &stated)?;
        if let Ok(walked) = row.at(ratio) {
            let CaseSupply { n_base, n_base_eq2, capped, .. } = walked.supply;
            case.network = walked.network;
            case.supply = CaseSupply { n_base, n_base_eq2, capped, ..case.supply };
        }
        let base_name = case.record().base.name;
        let mut real_thickness = None;
        if !has_size {
            real_thickness = case.scene.filter.thickness_mm.take();
            // In multiples of an unknown size, neither soil has fines.
            (case.scene.filter.d0_mm, case.scene.base) = (Some(1.0), row.case.scene.base.clone());
        } else if let BaseGradation::Linear { d85: D85::AtDc(..) | D85::Ratio(_), .. } =
            case.scene.base.gradation()
        {
            // The filter's size decides the base's.
            let keys = &mut case.scene.base;
            (keys.d85_mm, keys.d85_at_dc, keys.dc_curve, keys.d15f_over_d85b) = (Some(d85), None, None, None);
        }
        let (base, filter) = (case.base.as_given(), &case.filter.gradation);
        case.mistake = Mistake::find(base, filter, case.is_scale_free()).map(|mistake| mistake.note);
        Ok(Self { case, d85_mm: row.d85_mm, base_name, real_thickness })
    }

    /// Notes on the model for a reader, with `others`.
    pub fn notes(&self, row: &Row, others: Vec<Note>) -> Vec<Note> {
        // Repeated for every ratio below.
        let of_one = self.case.too_little_base().filter(|_| of_amount(row).is_some());
        let coarse =
            self.d85_mm.filter(|d85| *d85 > COARSE_BASE_MM).map(|d85_mm| Note::CoarseBase { d85_mm });
        let not_compared =
            self.real_thickness.map(|real_mm| Note::ThicknessWithoutUnit { real_mm, unit: "D85B".into() });
        let of_case = self.case.notes().into_iter();
        let notes = of_case.filter(|note| Some(note) != of_one.as_ref());
        let notes = notes
            .chain(self.case.unchecked_clogging())
            .chain(coarse)
            .chain(not_compared)
            .chain(of_search(row))
            .chain(others);
        ordered(notes)
    }
}
