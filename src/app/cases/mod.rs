//! Many cases: rows of base, filter and settings, walked by any number of processes in one folder, kept in a
//! ledger, and shown in one table.
//!
//! - `plan` is a list of cases, from a file that crosses factors; `prepared` works them out.
//! - [`run()`] walks the unfinished cases, by `walk`; `collect` writes their results, the ledger.
//! - `batch` makes a plan from samples and filters, and one table of the pairs, by practice and by walk.
//! - `cluster` hands a plan to a cluster's scheduler; `check` forecasts its cost on this machine.
//! - `kept` holds the results so far of a stopped study.

pub(crate) mod batch;
mod check;
pub(crate) mod cluster;
pub(crate) mod inputs;
pub(crate) mod kept;
pub(crate) mod plan;
pub(crate) mod prepared;
pub(crate) mod run;
pub(crate) mod walk;

pub(crate) use batch::pairs_of;
pub(crate) use batch::{BatchPlan, BatchWalks};
pub(crate) use check::{PlanCheck, check_plan};
pub(crate) use cluster::{JobOptions, Mount, WrittenJobs, write_job_scripts};
pub(crate) use inputs::numbered;
pub use plan::CasePlan;
pub use prepared::CasePart;
pub use run::{CaseOptions, run};
pub(crate) use run::{collect, make_packing, names};
pub use walk::{CaseCallbacks, CaseEvent};
