//! Rules by which the filter holds its own fines.

use super::rule::{Judged, RuleInputs};
use crate::gradation::{Gradation, KEZDI_RANGE, ShapeIndex};

/// Kezdi's ratio over sensible splits.
pub fn kezdi(inputs: &RuleInputs) -> Judged {
    let [from, to] = KEZDI_RANGE;
    index(inputs, 4.0, Gradation::kezdi, |filter, found| {
        let hidden = match 100.0 * filter.pan_fraction() {
            tail if tail > from => {
                format!("; what its {tail:.0} % finer than the finest sieve hide is not known")
            }
            _ => String::new(),
        };
        format!("at F = {:.0} %, judged from F = {from} to {to} %{hidden}", 0.85 * found.percent)
    })
}

/// Kenney and Lau's shape curve.
pub fn kenney_lau(inputs: &RuleInputs) -> Judged {
    index(inputs, 1.0, Gradation::kenney_lau, at_f)
}

/// Li and Fannin: both together.
pub fn li_fannin(inputs: &RuleInputs) -> Judged {
    index(inputs, 1.0, Gradation::li_fannin, at_f)
}

fn at_f(filter: &Gradation, found: ShapeIndex) -> String {
    let most = filter.loose_percent().unwrap_or(f64::NAN);
    format!("at F = {:.1} %, judged up to F = {most} %", found.percent)
}

/// An index of the filter's shape, with where it is.
fn index(
    inputs: &RuleInputs,
    limit: f64,
    of: impl Fn(&Gradation) -> Option<ShapeIndex>,
    note: impl Fn(&Gradation, ShapeIndex) -> String,
) -> Judged {
    let lacking = |needs: &str| Judged::of(None, Some(limit)).lacking(needs);
    if !inputs.filter_is_measured {
        return Judged { applies: false, ..lacking("needs the filter's sieve curve") };
    }
    match of(inputs.filter) {
        Some(found) => Judged::of(Some(found.value), Some(limit)).noted(note(inputs.filter, found)),
        None => lacking(
            "needs finer sieves, or filter.d0_mm: too much of the filter is finer than its finest sieve",
        ),
    }
}
