//! Scenes and campaigns: what the command line does, by the same calls.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use voidwalk::campaign::{self as campaigns, CampaignOptions, CampaignPlan, CasePart};
use voidwalk::run::folder::claim;
use voidwalk::run::machine::threads as pool;
use voidwalk::run::{self as runs, CheckpointInterval, FolderKind, PrepareOptions, RunError, RunOptions};
use voidwalk::schema::SceneError;
use voidwalk::{Outcome, Scene};

use crate::arrays::tables;
use crate::problem::{failed, of_run, refused};
use crate::work::{at_work, page};

/// What errors call settings that come from a dict.
const DICT: &str = "scene";

/// The TOML of settings that come as JSON.
fn toml_of(name: &str, json: &str) -> PyResult<String> {
    let value: serde_json::Value = serde_json::from_str(json).map_err(refused)?;
    toml::to_string(&value).map_err(|error| refused(format!("{name}: {error}")))
}

fn scene(path: Option<PathBuf>, json: Option<String>, settings: &[String]) -> PyResult<Scene> {
    let read = match (path, json) {
        (Some(path), _) => Scene::read(&path, settings),
        (None, Some(json)) => Scene::parse(toml_of(DICT, &json)?.as_bytes(), DICT, settings),
        (None, None) => Scene::built_in(settings),
    };
    read.map_err(|error: SceneError| of_run(&error.into()))
}

fn interval(text: Option<&str>) -> PyResult<Option<CheckpointInterval>> {
    let parse = |text: &str| text.parse().map_err(|error| refused(format!("checkpoint_every: {error}")));
    text.map(parse).transpose()
}

fn json(outcome: &Outcome) -> PyResult<String> {
    serde_json::to_string(outcome).map_err(failed)
}

/// The built-in scene as commented TOML, with every setting there is.
#[pyfunction]
pub fn init_text() -> String {
    Scene::init_text()
}

/// A scene with every setting that it has, as TOML.
#[pyfunction]
#[pyo3(signature = (path, json, settings))]
pub fn scene_text(path: Option<PathBuf>, json: Option<String>, settings: Vec<String>) -> PyResult<String> {
    Ok(scene(path, json, &settings)?.to_toml())
}

/// Walks a scene, into a folder or in memory: the folder, the outcome as JSON, and in memory the tables.
#[pyfunction]
#[pyo3(signature = (
    path, json, settings, out, overwrite, packings, memory, threads, checkpoint_every, command, progress
))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
pub fn run<'py>(
    py: Python<'py>,
    path: Option<PathBuf>,
    json: Option<String>,
    settings: Vec<String>,
    out: Option<PathBuf>,
    overwrite: bool,
    packings: PathBuf,
    memory: Option<u64>,
    threads: Option<usize>,
    checkpoint_every: Option<&str>,
    command: String,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Option<PathBuf>, String, Option<Bound<'py, PyDict>>)> {
    let scene = scene(path, json, &settings)?;
    let prepare = PrepareOptions { packings, memory, threads };
    let Some(out) = out else {
        let (outcome, recorded) = at_work(py, progress, |callbacks| {
            let case = runs::prepare(scene, &prepare, &callbacks.run)?;
            case.warnings().iter().for_each(|warning| (callbacks.run.warn)(warning));
            pool(threads)?.install(|| runs::walk_case_recorded(&case, &callbacks.run))
        })?;
        return Ok((None, self::json(&outcome)?, Some(tables(py, &recorded)?)));
    };
    let options = RunOptions {
        out: Some(out),
        overwrite,
        prepare,
        checkpoint_interval: interval(checkpoint_every)?,
        command,
    };
    let done = at_work(py, progress, |callbacks| runs::walk_scene(scene, &options, &callbacks.run))?;
    Ok((Some(done.folder), self::json(&done.outcome)?, None))
}

/// Continues a run that was stopped.
#[pyfunction]
#[pyo3(signature = (folder, memory, threads, checkpoint_every, command, progress))]
pub fn resume(
    py: Python<'_>,
    folder: PathBuf,
    memory: Option<u64>,
    threads: Option<usize>,
    checkpoint_every: Option<&str>,
    command: String,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let prepare = PrepareOptions { packings: folder.join("packings"), memory, threads };
    let checkpoint_interval = interval(checkpoint_every)?;
    let options = RunOptions { prepare, checkpoint_interval, command, ..RunOptions::default() };
    at_work(py, progress, |callbacks| runs::resume(&folder, &options, &callbacks.run))?;
    Ok(())
}

/// Walks the cases of a plan and collects them into a folder.
#[pyfunction]
#[pyo3(signature = (path, json, out, packings, memory, threads, checkpoint_every, command, progress))]
#[allow(clippy::too_many_arguments)]
pub fn campaign(
    py: Python<'_>,
    path: PathBuf,
    json: Option<String>,
    out: PathBuf,
    packings: Option<PathBuf>,
    memory: Option<u64>,
    threads: Option<usize>,
    checkpoint_every: Option<&str>,
    command: String,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let plan = match json {
        None => CampaignPlan::read(&path),
        Some(json) => CampaignPlan::parse(toml_of("plan", &json)?.as_bytes(), &path),
    };
    let plan = plan.map_err(|error| of_run(&error.into()))?;
    let checkpoint_interval = interval(checkpoint_every)?.unwrap_or_default();
    let part = CasePart::default();
    let options = CampaignOptions { out, part, packings, memory, threads, checkpoint_interval, command };
    at_work(py, progress, |callbacks| {
        let finished = campaigns::run(&plan, &options, callbacks)?;
        finished.problem().map_or(Ok(()), Err)
    })
}

/// Writes the page of a finished folder again.
#[pyfunction]
pub fn report(py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
    let write = |folder: &Path| {
        let Some(kind) = FolderKind::of(folder).filter(|kind| kind.has_page()) else {
            let problem = "holds no finished run, packing, campaign or study";
            return Err(RunError::Refused(format!("{}: {problem}", folder.display())));
        };
        let claimed = claim(folder, kind, true)?;
        page(kind, claimed.path()).map_err(RunError::Failed)
    };
    py.detach(|| write(&folder)).map_err(|error| of_run(&error))
}
