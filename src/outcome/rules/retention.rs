//! Rules by which a filter retains its base, and the boundaries of coarser filters.

use super::rule::{Fines, Judged, RuleInputs};
use crate::gradation::FEW_FINES;

/// What is said where the fines are not known.
const FINES_NEEDED: &str = "needs finer sieves of the base: whether it has 15 % fines or more is not known";

/// What is said of sizes without a unit.
const ASSUMED: &str = "sizes are multiples of D0F: taken as a sand without fines";

/// Largest D15F of a base with between `few` and `many` percent of fines: from 4 D85B down to 0.7 mm.
fn between(few: f64, many: f64, fines: f64, d85b: f64) -> f64 {
    (many - fines) / (many - few) * (4.0 * d85b - 0.7) + 0.7
}

/// Sherard and Dunnigan's limit of design; with the limits for dispersive soils where the base is one.
pub fn sherard_dunnigan(inputs: &RuleInputs) -> Judged {
    let limit = |fines: f64, d85b: f64| match (inputs.dispersive, fines) {
        (false, fines) if fines > 85.0 => Some((9.0 * d85b).max(0.2)),
        (true, fines) if fines > 85.0 => Some((6.5 * d85b).max(0.2)),
        (false, fines) if fines >= 40.0 => Some(0.7),
        (true, fines) if fines >= 40.0 => Some(0.5),
        (true, fines) if fines >= 15.0 => None,
        (_, fines) if fines >= 15.0 => Some(between(15.0, 40.0, fines, d85b)),
        _ => Some(4.0 * d85b),
    };
    by_fines(inputs, limit, |category| format!("base category {category}"))
}

/// Foster and Fell's boundary of no erosion; with their limits for dispersive soils where the base is one.
pub fn no_erosion(inputs: &RuleInputs) -> Judged {
    let limit = |fines: f64, d85b: f64| match (inputs.dispersive, fines) {
        (false, fines) if fines > 85.0 => Some(9.0 * d85b),
        (true, fines) if fines > 85.0 => Some(6.4 * d85b),
        (false, fines) if fines >= 35.0 => Some(0.7),
        (true, fines) if fines >= 35.0 => Some(0.5),
        (true, fines) if fines >= 15.0 => None,
        (_, fines) if fines >= 15.0 => Some(1.6 * between(15.0, 35.0, fines, d85b)),
        _ => Some(7.0 * d85b),
    };
    by_fines(inputs, limit, |_| String::new())
}

/// A limit of D15F that follows from fines and D85B of the regraded base; `None` where no source gives it.
fn by_fines(
    inputs: &RuleInputs,
    limit: impl Fn(f64, f64) -> Option<f64>,
    note: impl Fn(u8) -> String,
) -> Judged {
    let (d15f, d85b) = (inputs.d15f(), inputs.d85b());
    let (fines, said) = match inputs.fines() {
        Fines::Percent(percent) => (percent, regraded(inputs, note(inputs.base_soil.category.unwrap_or(4)))),
        Fines::Few => (0.0, regraded(inputs, note(4))),
        Fines::Assumed => (0.0, ASSUMED.to_owned()),
        Fines::Unknown => return Judged::of(d15f, None).lacking(FINES_NEEDED),
    };
    let said = match inputs.dispersive && fines >= FEW_FINES {
        true => format!("dispersive; {said}").trim_end_matches("; ").to_owned(),
        false => said,
    };
    let limit = d85b.map(|d85b| limit(fines, d85b));
    let judged = Judged::of(d15f, limit.flatten()).noted(said);
    match (d15f, limit) {
        (None, _) => judged.lacking("needs the filter's D15: finer sieves, or filter.d0_mm"),
        (_, None) => judged.lacking("needs the base's D85: finer sieves, or base.d0_mm"),
        (_, Some(None)) => judged.lacking(
            "needs a test of this soil: no source that was read gives a limit for dispersive soils with so \
                          few fines",
        ),
        _ => judged,
    }
}

/// A note, and whether the base was regraded.
fn regraded(inputs: &RuleInputs, note: String) -> String {
    let at = inputs.base_soil.regraded_at_mm;
    let parts = [Some(note), at.map(|at| format!("base regraded on {at:.3} mm"))];
    let parts: Vec<String> = parts.into_iter().flatten().filter(|part| !part.is_empty()).collect();
    parts.join("; ")
}

/// Terzaghi's ratio, for bases with few fines.
pub fn terzaghi(inputs: &RuleInputs) -> Judged {
    let value = inputs.d15f().zip(inputs.d85b()).map(|(d15f, d85b)| d15f / d85b);
    let judged = Judged::of(value, Some(4.0));
    match inputs.fines() {
        Fines::Percent(percent) if percent >= 15.0 => {
            judged.not_for(format!("{percent:.0} % of the base is fines: limits by fines stand in its place"))
        }
        Fines::Unknown => Judged { limit: Some(4.0), ..judged }.noted(FINES_NEEDED),
        Fines::Assumed => judged.noted(ASSUMED),
        _ => judged.noted(regraded(inputs, String::new())),
    }
}

/// Foster and Fell's boundary of continuing erosion.
pub fn continuing(inputs: &RuleInputs) -> Judged {
    let d95b = inputs.base_soil.gradation.d(95.0);
    let judged = Judged::of(inputs.d15f(), d95b.map(|d95b| 9.0 * d95b));
    match (inputs.fines(), d95b) {
        (Fines::Percent(percent), Some(d95b)) if percent >= 15.0 && d95b > 2.0 => {
            judged.noted("for bases with 15 to 85 % fines and D95B above 2 mm tests found no clear boundary")
        }
        (Fines::Assumed, _) => judged.noted(ASSUMED),
        _ => judged.noted(regraded(inputs, String::new())),
    }
}

/// Foster and Fell's boundary of excessive erosion: its numbers stand in figures that could not be read.
pub fn excessive(inputs: &RuleInputs) -> Judged {
    Judged { applies: false, value: inputs.d15f(), ..Judged::default() }.lacking(
        "needs the numbers of this boundary: they stand in figures, and no text that was read gives them",
    )
}
