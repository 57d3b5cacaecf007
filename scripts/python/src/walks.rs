//! Walks of given networks.

use std::sync::Arc;

use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voidwalk::case;
use voidwalk::outcome::{Recorded, Wanted};
use voidwalk::practice::{Mistake, Refusal};
use voidwalk::run::machine::threads as pool;
use voidwalk::run::{GivenFilter, NetworkWalk, walk_networks};
use voidwalk::walk::{Engine, Sampling};

use crate::network::Network;
use crate::problem::refused;
use crate::soil::Gradation;
use crate::tables::of_recorded;
use crate::work::at_work;

/// The seed of a replicate, counted from 1.
#[pyfunction]
pub fn replicate_seed(seed: u64, replicate: u64) -> u64 {
    case::replicate_seed(seed, replicate)
}

/// Walks networks; their record as JSON, the tables of a run, and which throats were blocked by replicate and run.
#[pyfunction]
pub fn walk<'py>(
    py: Python<'py>,
    networks: Vec<PyRef<'py, Network>>,
    base: &Gradation,
    n_base: Option<u64>,
    increments: u64,
    engine: &str,
    sampling: &str,
    seed: u64,
    runs: u64,
    replicates: u64,
    series_every: u64,
    size_curves: Vec<u64>,
    size_classes: usize,
    filter: Option<(PyRef<'py, Gradation>, bool)>,
    grains_per_void: Option<f64>,
    mass_ratio: f64,
    as_given: bool,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(String, Bound<'py, PyDict>, Bound<'py, PyAny>)> {
    let word = |name: &str, given: &str, words: String| {
        refused(format!("{name} = {given} is not allowed; one of {words}"))
    };
    let engines = || word("engine", engine, Engine::ALL.map(Engine::name).join(", "));
    let samplings = || word("sampling", sampling, Sampling::ALL.map(Sampling::name).join(", "));
    let mut plan = NetworkWalk {
        base: base.inner.clone(),
        n_base: n_base.unwrap_or(0),
        increments,
        engine: Engine::ALL.into_iter().find(|known| known.name() == engine).ok_or_else(engines)?,
        sampling: Sampling::ALL.into_iter().find(|known| known.name() == sampling).ok_or_else(samplings)?,
        seed,
        runs,
        replicates,
        wanted: Wanted { series_every, size_curves, size_classes, voids: None },
        filter: filter.map(|(soil, is_measured)| GivenFilter {
            gradation: soil.inner.clone(),
            is_measured,
            grains_per_void,
        }),
        mass_ratio,
    };
    let given: Vec<Arc<voidwalk::Network>> = networks.iter().map(|network| network.inner.clone()).collect();
    // A filter that the network itself knows is not a table that could be exchanged.
    let exchanged = |filter: &GivenFilter| {
        Mistake::find(&plan.base, &filter.gradation, false).filter(|_| filter.is_measured && !as_given)
    };
    if let Some(mistake) = plan.filter.as_ref().and_then(exchanged).filter(Mistake::is_refused) {
        return Err(refused(Refusal(&mistake, "as_given=True").to_string()));
    }
    if n_base.is_none() {
        let eq2 = given.first().map_or(Ok(None), |network| plan.eq2(network, mass_ratio)).map_err(refused)?;
        plan.n_base = eq2.ok_or_else(|| refused("n_base is missing"))?;
        if plan.n_base == 0 {
            return Err(refused("Eq. (2) gives no base particle on so small a network; give n_base"));
        }
    }
    let throats = networks.first().map_or(0, |network| network.throat_count());
    if networks.iter().any(|network| network.throat_count() != throats) {
        return Err(refused("the networks of the replicates differ in their number of throats"));
    }
    let (outcome, record) = at_work(py, progress, |callbacks| {
        pool(threads)?.install(|| {
            let outcome = walk_networks(&given, &plan, &callbacks.run)?;
            let record = given.first().map(|network| outcome.record(&plan, network, given.len()));
            Ok((outcome, serde_json::to_string(&record)?))
        })
    })?;
    let mut blocked = Vec::with_capacity(replicates as usize * runs as usize * throats);
    for (i, walked) in outcome.replicates.iter().enumerate() {
        let network = &networks[i % networks.len()];
        walked.blocked.iter().for_each(|exits| blocked.extend(network.blocked(exits)));
    }
    let blocked =
        blocked.into_pyarray(py).call_method1("reshape", ((replicates as usize, runs as usize, throats),))?;
    let mut recorded = Recorded::default();
    outcome.replicates.into_iter().for_each(|walked| recorded.append(walked.result.recorded));
    Ok((record, of_recorded(py, &recorded)?, blocked))
}
