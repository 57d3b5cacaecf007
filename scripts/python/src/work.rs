//! Long calls: without the interpreter's lock, on threads of their own, stopped by Ctrl-C.
//!
//! A call works on a thread of its own, and the thread that called waits for it: every twentieth of a second
//! it looks for signals and tells the progress callback how far the work is. So no worker ever waits for the
//! interpreter, a callback may do anything, and nothing of a call outlives it: a process may fork between two
//! calls.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pyo3::exceptions::{PyKeyboardInterrupt, PyUserWarning};
use pyo3::prelude::*;
use voidwalk::cases::{CaseCallbacks, CaseEvent};
use voidwalk::cli::page;
use voidwalk::run::{Callbacks, Event, Exit, RunError};

use crate::notes::with_setting;
use crate::problem::of_run;

/// Between two looks for signals and news.
const TICK: Duration = Duration::from_millis(50);

/// Progress of a call, for a progress callback: some twenty times a second at most, and once at the end.
#[pyclass(frozen, get_all, module = "voidwalk")]
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// Kind of work: "packing", "walking" or "cases".
    stage: String,
    /// Runs, or cases, that are done.
    done: u64,
    /// Runs, or cases, there are to do, as far as is known.
    total: u64,
    /// Replicate of the last increment, counted from 1.
    replicate: u64,
    /// Its run, counted from 1.
    run: u64,
    /// The increment; of a packing the steps.
    increment: u64,
    /// Base particles that were moving after it.
    moving: u64,
    /// True if the work has ended.
    finished: bool,
}

#[pymethods]
impl Progress {
    fn __repr__(&self) -> String {
        let Self { stage, done, total, replicate, run, increment, moving, .. } = self;
        format!(
            "Progress(stage='{stage}', done={done}, total={total}, replicate={replicate}, run={run}, \
             increment={increment}, moving={moving})"
        )
    }
}

/// State that the worker and the waiting thread share.
struct Shared<T> {
    progress: Progress,
    /// True if there is news for the callback.
    is_new: bool,
    /// The waiting thread is to look at once.
    wake: bool,
    warnings: Vec<String>,
    ended: Option<Result<Result<T, RunError>, Box<dyn Any + Send>>>,
}

struct Desk<T> {
    shared: Mutex<Shared<T>>,
    bell: Condvar,
    stop: AtomicBool,
}

impl<T> Desk<T> {
    fn shared(&self) -> MutexGuard<'_, Shared<T>> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, wake: bool, change: impl FnOnce(&mut Progress)) {
        let mut shared = self.shared();
        change(&mut shared.progress);
        shared.is_new = true;
        shared.wake |= wake;
        if wake {
            self.bell.notify_one();
        }
    }

    fn tell(&self, event: Event) {
        match event {
            Event::PackingBegun(_) => self.change(true, |p| p.stage = "packing".into()),
            Event::Packing(at) => self.change(false, |p| p.increment = at.steps),
            Event::WalkBegun { runs } => self.change(true, |p| {
                *p = Progress { stage: "walking".into(), total: runs, ..Progress::default() };
            }),
            Event::Increment { replicate, run, increment, moving } => self.change(false, |p| {
                (p.replicate, p.run, p.increment, p.moving) = (replicate, run, increment, moving);
            }),
            Event::RunDone => self.change(true, |p| p.done += 1),
            Event::MoreRuns { runs } => self.change(false, |p| p.total += runs),
            Event::Noted { notes, unit } => {
                notes.iter().for_each(|note| self.warn(&with_setting(note, unit)))
            }
            Event::PackingElsewhere { .. }
            | Event::PackingEnded
            | Event::Studying(_)
            | Event::VerdictNeeds { .. }
            | Event::VerdictStands { .. }
            | Event::RunWalked { .. } => {}
        }
    }

    /// News of a campaign, whose unit is the case.
    fn tell_of_case(&self, event: CaseEvent) {
        if matches!(event, CaseEvent::Done(_) | CaseEvent::Failed(_)) {
            self.change(true, |p| p.done += 1);
        }
    }

    fn warn(&self, warning: &str) {
        self.shared().warnings.push(warning.to_owned());
    }
}

/// Does a call's work without the interpreter's lock.
pub fn at_work<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&CaseCallbacks) -> Result<T, RunError> + Send,
) -> PyResult<T> {
    let desk = Desk {
        shared: Mutex::new(Shared {
            progress: Progress::default(),
            is_new: false,
            wake: false,
            warnings: Vec::new(),
            ended: None,
        }),
        bell: Condvar::new(),
        stop: AtomicBool::new(false),
    };
    let mut raised: Option<PyErr> = None;
    let ended = std::thread::scope(|scope| {
        scope.spawn(|| {
            let run = Callbacks {
                on_event: &|event| desk.tell(event),
                stop: &desk.stop,
                warn: &|warning| desk.warn(warning),
                on_results: &|kind, folder, run| Ok(page(kind, folder, run).map(drop)?),
            };
            let callbacks = CaseCallbacks {
                run,
                on_cases: &|total, done| {
                    let (total, done) = (total as u64, done as u64);
                    desk.change(true, |p| *p = Progress { stage: "cases".into(), total, done, ..p.clone() });
                },
                on_case: &|_, event| desk.tell_of_case(event),
            };
            let ended = catch_unwind(AssertUnwindSafe(|| work(&callbacks)));
            let mut shared = desk.shared();
            (shared.ended, shared.wake) = (Some(ended), true);
            desk.bell.notify_one();
        });
        loop {
            let (ended, news) = py.detach(|| {
                let waited = desk.bell.wait_timeout_while(desk.shared(), TICK, |shared| !shared.wake);
                let (mut shared, _) = waited.unwrap_or_else(PoisonError::into_inner);
                shared.wake = false;
                let ended = shared.ended.take();
                shared.progress.finished = ended.is_some();
                let is_new = std::mem::take(&mut shared.is_new) || ended.is_some();
                (ended, is_new.then(|| shared.progress.clone()))
            });
            if raised.is_none() {
                raised = look(py, progress, news).err();
                desk.stop.store(raised.is_some(), Ordering::Relaxed);
            }
            if let Some(ended) = ended {
                return ended;
            }
        }
    });
    let ended = ended.unwrap_or_else(|panic| resume_unwind(panic));
    match (raised, ended) {
        // Saved work, and the way to continue, unless the exception has a message of its own.
        (Some(raised), Err(error)) if error.exit() == Exit::Stopped && is_bare_interrupt(py, &raised) => {
            Err(PyKeyboardInterrupt::new_err(error.to_string()))
        }
        (Some(raised), _) => Err(raised),
        (None, Err(error)) => Err(of_run(&error)),
        (None, Ok(done)) => {
            let warnings = std::mem::take(&mut desk.shared().warnings);
            let category = py.get_type::<PyUserWarning>();
            for text in warnings {
                let text = std::ffi::CString::new(text.replace('\0', "?")).unwrap_or_default();
                PyErr::warn(py, &category, &text, 2)?;
            }
            Ok(done)
        }
    }
}

/// Looks for signals, and tells the news.
fn look(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>, news: Option<Progress>) -> PyResult<()> {
    py.check_signals()?;
    if let (Some(progress), Some(news)) = (progress, news) {
        progress.call1((news,))?;
    }
    Ok(())
}

fn is_bare_interrupt(py: Python<'_>, error: &PyErr) -> bool {
    error.is_instance_of::<PyKeyboardInterrupt>(py)
        && error.value(py).getattr("args").and_then(|args| args.len()).is_ok_and(|len| len == 0)
}
