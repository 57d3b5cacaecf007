//! Answer of filter practice on two soils.

use pyo3::prelude::*;
use voidwalk::practice::rules::NamedCurve;
use voidwalk::practice::{PairOptions, PairRules, Refusal};
use voidwalk::store::format;

use crate::problem::{failed, refused};
use crate::soil::Gradation;

/// Every rule of practice on the curves of a base and of a filter: the JSON of `voidwalk rules --json`.
#[pyfunction]
pub fn rules(
    bases: Vec<(String, Py<Gradation>)>,
    filters: Vec<(String, Py<Gradation>)>,
    dispersive: bool,
    joint_mm: Option<f64>,
    as_given: bool,
) -> PyResult<String> {
    if let Some(mm) = joint_mm.filter(|mm| !(*mm > 0.0 && mm.is_finite())) {
        return Err(refused(format!("joint_mm = {mm} is not allowed: a number of millimetres above 0")));
    }
    if bases.is_empty() || filters.is_empty() {
        return Err(refused("a base and a filter have one curve each at least"));
    }
    let named = |curves: Vec<(String, Py<Gradation>)>| -> Vec<NamedCurve> {
        curves.into_iter().map(|(name, curve)| (name, curve.get().inner.clone())).collect()
    };
    let options = PairOptions { dispersive, joint_mm, as_given };
    let pair = PairRules::guarded(&named(bases), &named(filters), options)
        .map_err(|mistake| refused(Refusal(&mistake, "as_given=True").to_string()))?;
    format::RULES.json(&pair).map_err(failed)
}
