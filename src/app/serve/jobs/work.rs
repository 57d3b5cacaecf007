//! Work of a job: a call of the library into a folder of its own.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use serde_json::{Value, json};

use crate::cases::{BatchPlan, batch};
use crate::cases::{CaseCallbacks, CaseEvent, CaseOptions, CasePart};
use crate::outcome::record::Outcome;
use crate::report::colour_of;
use crate::run::callbacks::Callbacks;
use crate::run::checkpoints::CheckpointInterval;
use crate::run::error::AnyError;
use crate::run::{self, FolderKind, PrepareOptions, RunError, RunOptions};
use crate::scene::Scene;
use crate::serve::batches::of_batch;
use crate::serve::live::Live;
use crate::verdict::RunFiles;
use crate::words::{first_lines, sentence};
use voidwalk_practice::Decision;
use voidwalk_practice::quantity::SizeUnit;

/// Action on finished results.
pub type OnResults = fn(FolderKind, &Path, Option<RunFiles>) -> Result<(), AnyError>;

/// Work of a job.
#[derive(Clone)]
pub enum Work {
    /// Walks a scene.
    Judge(Box<Scene>),
    /// Walks every sample against filters.
    Batch(Box<BatchPlan>),
    /// Work that its folder describes: it is planned again when the job continues.
    Kept,
    /// Continues a run whose folder does not keep the request.
    Resume,
    /// Nothing: the request is unknown.
    Nothing,
}

impl Work {
    /// Beginning of the name of its folder.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Batch(_) => "batch",
            _ => "run",
        }
    }
}

/// Settings that all jobs of a server share.
pub struct WorkContext {
    /// The server's folder.
    pub root: PathBuf,
    /// Threads, memory and the folder of packings.
    pub prepare: PrepareOptions,
    /// Command in a folder that started it.
    pub command: String,
    /// Action on finished results.
    pub on_results: OnResults,
}

impl WorkContext {
    /// Does a job, and returns the JSON of its result for the page.
    ///
    /// # Errors
    /// Errors of the call.
    pub fn work(
        &self,
        folder: &Path,
        work: &Work,
        live: &Mutex<Live>,
        stop: &AtomicBool,
    ) -> Result<Value, RunError> {
        let live = || live.lock().unwrap_or_else(PoisonError::into_inner);
        let callbacks = Callbacks {
            on_event: &|event| {
                // An increment changes nothing that is shown, and there are many.
                if !matches!(event, run::Event::Increment { .. }) {
                    live().tell(event);
                }
            },
            stop,
            warn: &|warning| live().warn(warning),
            on_results: &self.on_results,
        };
        let options = RunOptions {
            out: Some(folder.to_owned()),
            overwrite: false,
            prepare: self.prepare.clone(),
            checkpoint_interval: Some(often()),
            command: self.command.clone(),
        };
        match work {
            Work::Judge(scene) => run::walk_scene((**scene).clone(), &options, &callbacks)
                .map(|run| of_run(&run.outcome, &run.decision)),
            Work::Resume => {
                run::resume(folder, &options, &callbacks).map(|run| of_run(&run.outcome, &run.decision))
            }
            Work::Batch(plan) => {
                // Outcomes are read before the page is kept waiting.
                let rows = plan.so_far(folder);
                live().batch(rows, plan.shows_inches());
                let options = of_cases(folder, &self.prepare, &self.command);
                let callbacks = CaseCallbacks {
                    run: callbacks,
                    on_cases: &|all, done| live().cases(all, done),
                    on_case: &|case, event| {
                        if let CaseEvent::Done(line) = event
                            && let Some((at, row)) = plan.walked_row(folder, line)
                        {
                            live().walked_pair(at, row);
                        }
                        live().tell_case(case, event);
                    },
                };
                Ok(of_batch(&batch::run(plan, &options, false, &callbacks)?))
            }
            Work::Kept | Work::Nothing => Ok(Value::Null),
        }
    }
}

/// Options of walking the cases of a study in this folder.
pub fn of_cases(folder: &Path, prepare: &PrepareOptions, command: &str) -> CaseOptions {
    CaseOptions {
        out: folder.to_owned(),
        part: CasePart::All,
        packings: Some(prepare.packings.clone()),
        memory: prepare.memory,
        threads: prepare.threads,
        checkpoint_interval: often(),
        command: command.to_owned(),
    }
}

/// Greatest loss if a server is killed.
fn often() -> CheckpointInterval {
    "1min".parse().unwrap_or_default()
}

/// JSON of an outcome for the page.
pub fn of_run(outcome: &Outcome, decision: &Decision) -> Value {
    let unit = SizeUnit::of(outcome.inputs.scale_free, false);
    let lines = first_lines(outcome, decision, unit);
    json!({
        "lines": lines.iter().map(|(line, words)| (line.name(), words)).collect::<Vec<_>>(),
        "model": outcome.model.class.words(),
        "colour": colour_of(outcome),
        "notes": outcome.notes.iter().map(|note| sentence(note, unit)).collect::<Vec<_>>(),
        "replicates": outcome.replicates.len(),
        "runs": outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect::<Vec<_>>(),
    })
}
