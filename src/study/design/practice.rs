//! How far practice lets a row go, whatever the walk holds.

use super::judged::Judged;
use super::row::Row;
use crate::outcome::design::band::retention;
use crate::outcome::rules::{BaseSoil, RuleInputs, apply};
use crate::run::error::RunError;
use crate::verdict::FinestBase;

/// D15F/D85B from and to which the finest base that practice allows is looked for, and the step.
const SEARCH: (f64, f64, f64) = (0.2, 200.0, 1.01);

/// A hair less than a limit, so that no rounding breaks the limit itself.
const HAIR: f64 = 1.0 - 1e-9;

/// A ratio that the walk holds, or the one that practice allows where that is less.
///
/// # Errors
/// Sizes out of range.
pub(super) fn allowed(row: &Row, held: f64, finest: Option<&FinestBase>) -> Result<f64, RunError> {
    if row.inverse {
        return Ok(finest.and_then(|of| of.ratio).map_or(held, |ratio| held.min(ratio * HAIR)));
    }
    let Some(d85) = row.d85_mm else { return Ok(held) };
    let rules = Judged::new(row, held)?.rules();
    Ok(retention(&rules, held * d85).map_or(held, |(_, limit)| held.min(limit / d85 * HAIR)))
}

/// The finest base of this shape that practice allows with a filter of this size: that, and every coarser
/// one, keeps every rule of retention, without the finer part that the filter may lose, too. A rule of whose
/// limit only the most is known is not kept. `None` where the base is not scaled, sizes have no unit, or
/// every base keeps every rule.
///
/// # Errors
/// Sizes out of range.
pub(super) fn finest_base(row: &Row) -> Result<Option<FinestBase>, RunError> {
    if !row.inverse || !row.filter_has_size {
        return Ok(None);
    }
    let given = row.stated.regraded_from.as_ref().map_or(&row.stated.gradation, |(given, _)| given);
    let d85 = row.stated.gradation.d(85.0).unwrap_or(1.0);
    let (from, to, step) = SEARCH;
    let (mut ratio, mut kept) = (from, None);
    while ratio <= to {
        let base = given.scaled(row.d15f() / ratio / d85).map_err(crate::case::CaseError::from)?;
        let inputs = RuleInputs {
            base_soil: BaseSoil::of(&base, false),
            dispersive: row.stated.scene.base.dispersive == Some(true),
            ..RuleInputs::of_soils(&base, &row.case.filter)
        };
        if let Some(found) = FinestBase::at(&apply(&inputs), kept) {
            return Ok(Some(found));
        }
        (kept, ratio) = (Some(ratio), ratio * step);
    }
    Ok(None)
}
