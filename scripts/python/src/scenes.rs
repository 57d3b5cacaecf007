//! Scenes and campaigns: the work of the command line, by the same calls.

use std::path::PathBuf;
use std::time::SystemTime;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use voidwalk::Outcome;
use voidwalk::cases::{self as campaigns, CaseOptions, CasePart, CasePlan};
use voidwalk::practice::ordered;
use voidwalk::practice::quantity::SizeUnit;
use voidwalk::run::machine::threads as pool;
use voidwalk::run::{self as runs, CheckpointInterval, Event, PrepareOptions, RunOptions, results};
use voidwalk::scene::TableOptions;
use voidwalk::schema::SceneError;
use voidwalk::store::format;

use crate::problem::{failed, of_run, refused};
use crate::soil::density_named;
use crate::tables::of_recorded;
use crate::work::at_work;

/// Name in errors of settings that come from a dict.
const DICT: &str = "scene";

/// Options of a long call, which change no result: memory (bytes), threads, interval between saves of
/// progress, and the command for the manifest.
#[derive(FromPyObject)]
pub struct Manner(Option<u64>, Option<usize>, Option<String>, String);

impl Manner {
    fn interval(&self) -> PyResult<Option<CheckpointInterval>> {
        let parse = |text: &String| text.parse().map_err(|e| refused(format!("checkpoint_every: {e}")));
        self.2.as_ref().map(parse).transpose()
    }

    pub fn prepare(&self, packings: PathBuf) -> PrepareOptions {
        PrepareOptions { packings, memory: self.0, threads: self.1 }
    }

    fn run(&self, out: Option<PathBuf>, overwrite: bool, packings: PathBuf) -> PyResult<RunOptions> {
        Ok(RunOptions {
            out,
            overwrite,
            prepare: self.prepare(packings),
            checkpoint_interval: self.interval()?,
            command: self.3.clone(),
        })
    }

    pub fn campaign(self, out: PathBuf, packings: Option<PathBuf>) -> PyResult<CaseOptions> {
        let checkpoint_interval = self.interval()?.unwrap_or_default();
        let Self(memory, threads, _, command) = self;
        let part = CasePart::default();
        Ok(CaseOptions { out, part, packings, memory, threads, checkpoint_interval, command })
    }
}

/// Options of a scene of two tables: density, then true if it is packed, is quick, is as sampled, is as
/// given, and settings as `name=value`.
#[derive(FromPyObject)]
pub struct Tables(Option<String>, bool, bool, bool, bool, Vec<String>);

impl Tables {
    pub fn options(self) -> PyResult<TableOptions> {
        let Self(density, pack, quick, as_sampled, as_given, changes) = self;
        let density = density.map(|word| density_named(&word)).transpose()?;
        Ok(TableOptions { density, pack, quick, as_sampled, as_given, changes })
    }
}

/// The TOML of settings that come as JSON.
fn toml_of(name: &str, json: &str) -> PyResult<String> {
    let value: serde_json::Value = serde_json::from_str(json).map_err(refused)?;
    toml::to_string(&value).map_err(|error| refused(format!("{name}: {error}")))
}

fn json(outcome: &Outcome) -> PyResult<String> {
    format::OUTCOME.json(outcome).map_err(failed)
}

/// A scene of the library.
#[pyclass(frozen, module = "voidwalk._voidwalk")]
pub struct Scene {
    inner: voidwalk::Scene,
}

impl Scene {
    fn of(read: Result<voidwalk::Scene, SceneError>) -> PyResult<Self> {
        Ok(Self { inner: read.map_err(|error| of_run(&error.into()))? })
    }
}

#[pymethods]
impl Scene {
    /// The built-in scene.
    #[staticmethod]
    fn built_in(settings: Vec<String>) -> PyResult<Self> {
        Self::of(voidwalk::Scene::built_in(&settings))
    }

    /// The scene of two sieve tables.
    #[staticmethod]
    fn of_tables(base: PathBuf, filter: PathBuf, tables: Tables) -> PyResult<Self> {
        Self::of(voidwalk::Scene::of_tables(&base, &filter, &tables.options()?))
    }

    #[staticmethod]
    fn from_file(path: PathBuf, settings: Vec<String>) -> PyResult<Self> {
        Self::of(voidwalk::Scene::read(&path, &settings))
    }

    #[staticmethod]
    fn from_json(text: &str, settings: Vec<String>) -> PyResult<Self> {
        Self::of(voidwalk::Scene::parse(toml_of(DICT, text)?.as_bytes(), DICT, &settings))
    }

    #[staticmethod]
    fn from_toml(text: &str, name: &str, settings: Vec<String>) -> PyResult<Self> {
        Self::of(voidwalk::Scene::parse(text.as_bytes(), name, &settings))
    }

    /// Name in errors.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    fn to_toml(&self) -> String {
        self.inner.to_toml()
    }

    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.inner).map_err(failed)
    }
}

/// The built-in scene as commented TOML, with every setting there is.
#[pyfunction]
pub fn init_text() -> String {
    voidwalk::Scene::init_text()
}

/// Walks a scene into a folder: the folder.
#[pyfunction]
pub fn run(
    py: Python<'_>,
    scene: &Scene,
    out: PathBuf,
    overwrite: bool,
    packings: PathBuf,
    manner: Manner,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<PathBuf> {
    let (scene, options) = (scene.inner.clone(), manner.run(Some(out), overwrite, packings)?);
    let done = at_work(py, progress, |callbacks| runs::walk_scene(scene, &options, &callbacks.run))?;
    Ok(done.folder)
}

/// Texts of a run's page besides outcome and tables: manifest, scene, the record of the packing.
type Texts = (String, String, Option<String>);

/// Walks a scene in memory: the outcome as JSON, the tables, and the further texts of its page.
#[pyfunction]
pub fn run_in_memory<'py>(
    py: Python<'py>,
    scene: &Scene,
    packings: PathBuf,
    manner: Manner,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(String, Bound<'py, PyDict>, Texts)> {
    let (scene, options) = (scene.inner.clone(), manner.run(None, false, packings)?);
    let started = SystemTime::now();
    let (outcome, recorded, texts) = at_work(py, progress, |callbacks| {
        let case = runs::prepare(scene, &options.prepare, &callbacks.run)?;
        let unit = SizeUnit::of(case.is_scale_free(), false);
        (callbacks.run.on_event)(Event::Noted { notes: &ordered(case.notes()), unit });
        let pool = pool(options.prepare.threads)?;
        let (outcome, recorded) = pool.install(|| runs::walk_case_recorded(&case, &callbacks.run))?;
        let threads = pool.current_num_threads() as u64;
        let manifest = results::manifest(&case, threads, started, options.command.clone());
        let packing = case.packing_record().and_then(|kept| String::from_utf8(kept.bytes.to_vec()).ok());
        let texts = (serde_json::to_string(&manifest)?, case.resolved().to_toml(), packing);
        Ok((outcome, recorded, texts))
    })?;
    Ok((json(&outcome)?, of_recorded(py, &recorded)?, texts))
}

/// Continues a run that was stopped.
#[pyfunction]
pub fn resume(
    py: Python<'_>,
    folder: PathBuf,
    manner: Manner,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let options = manner.run(None, false, folder.join("packings"))?;
    at_work(py, progress, |callbacks| runs::resume(&folder, &options, &callbacks.run))?;
    Ok(())
}

/// Walks the cases of a plan and collects them into a folder.
#[pyfunction]
pub fn campaign(
    py: Python<'_>,
    path: PathBuf,
    json: Option<String>,
    out: PathBuf,
    packings: Option<PathBuf>,
    manner: Manner,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let plan = match json {
        None => CasePlan::read(&path),
        Some(json) => CasePlan::parse(toml_of("plan", &json)?.as_bytes(), &path),
    };
    let plan = plan.map_err(|error| of_run(&error.into()))?;
    let options = manner.campaign(out, packings)?;
    at_work(py, progress, |callbacks| {
        let finished = campaigns::run(&plan, &options, callbacks)?;
        finished.problem().map_or(Ok(()), Err)
    })
}
