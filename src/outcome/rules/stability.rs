//! Rules by which the filter holds its own fines.

use super::rule::{Judged, RuleInputs};
use crate::gradation::{FINES_MM, Gradation, KEZDI_RANGE, ShapeIndex};

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
        return Judged { applies: false, ..lacking(CURVE_NEEDED) };
    }
    match of(inputs.filter) {
        Some(found) => Judged::of(Some(found.value), Some(limit)).noted(note(inputs.filter, found)),
        None => lacking(
            "needs finer sieves, or filter.d0_mm: too much of the filter is finer than its finest sieve",
        ),
    }
}

/// What is said of a filter that was assumed to be a straight line.
const CURVE_NEEDED: &str = "needs the filter's sieve curve";

/// Cu from which a filter counts as broadly graded here: that of well-graded sands by ASTM D2487.
const BROAD_CU: f64 = 6.0;

/// What is said of a filter that neither rule on uniformity was tested on.
const UNIFORM: &str = "the filter is neither broadly graded (Cu of 6 and more) nor gap-graded";

/// Whether a filter is neither broadly graded nor gap-graded.
fn is_uniform(filter: &Gradation) -> bool {
    filter.cu().is_some_and(|cu| cu < BROAD_CU) && filter.gap(0.0).is_none()
}

/// Burenkova's range of uniformity, for soils such as Wan and Fell judged it on; they found it no clear
/// boundary, and uniform stones lie below it that have no fines to lose. Above it her own zone III is
/// suffusive too; Wan and Fell tested none there, and expect them to be stable.
pub fn burenkova(inputs: &RuleInputs) -> Judged {
    let filter = inputs.filter;
    if !inputs.filter_is_measured {
        return Judged::default().lacking(CURVE_NEEDED);
    }
    let Some(factors) = filter.uniformity_factors() else {
        return Judged::of(None, None).lacking("needs the filter's D15: finer sieves, or filter.d0_mm");
    };
    let [low, high] = factors.stable();
    let judged = Judged::of(Some(factors.coarse), Some(low))
        .noted(format!("h'' = D90/D15 = {:.2}; the range is {low:.2} to {high:.2}", factors.whole));
    let is_too_wide = filter.cu().is_some_and(|cu| cu > 200.0);
    if filter.largest_mm() > 100.0 && !inputs.scale_free || is_too_wide {
        return judged.not_for("for grains of up to 100 mm and a Cu of up to 200");
    }
    if is_uniform(filter) {
        return judged.not_for(UNIFORM);
    }
    match factors.coarse >= high {
        true => judged.not_for(format!(
            "h' is above {high:.2}: Burenkova's third zone, of which Wan and Fell have no tests and expect \
             no loss of fines"
        )),
        false => judged,
    }
}

/// Wan and Fell's probability of instability. They state contours and no limit.
pub fn wan_fell(inputs: &RuleInputs) -> Judged {
    let filter = inputs.filter;
    if !inputs.filter_is_measured || inputs.scale_free {
        return Judged::default().lacking(CURVE_NEEDED);
    }
    if is_uniform(filter) {
        return Judged::default().not_for(UNIFORM);
    }
    let Some(factors) = filter.uniformity_factors() else {
        return Judged::of(None, None).lacking("needs the filter's D15: finer sieves, or filter.d0_mm");
    };
    let fines = filter.percent_finer_by_mass(FINES_MM);
    let is_known = filter.pan_fraction() == 0.0 || filter.smallest_mm() <= FINES_MM;
    if !is_known && fines > 10.0 {
        return Judged::of(None, None).lacking("needs finer sieves of the filter, down to 0.075 mm");
    }
    let soil = match fines <= 10.0 {
        true => "as sand and gravel with up to 10 % of fines that are not plastic",
        false => "as silt, sand and gravel with up to 10 % of clay and a plasticity index of up to 12",
    };
    Judged::of(Some(100.0 * factors.probability_of_instability(fines <= 10.0)), None).noted(format!(
        "{soil}; the source states contours from 5 to 95 % and no limit, and is unsure of soils with less \
         than 15 % of finer fraction"
    ))
}
