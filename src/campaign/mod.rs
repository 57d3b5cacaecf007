//! Campaigns: many scenes, walked by as many processes as are started on one folder.
//!
//! - [`plan`] crosses factors into cases, each with a name and a seed of its own; `cases` are worked out
//!   from it.
//! - [`run()`] walks those that are not done, by `run_cases`; [`collect`] writes what came of them, the
//!   `ledger`.
//! - `cluster` hands a plan to a cluster's scheduler, by what `crate::run::cost` says that its cases
//!   take; [`check_plan`] says the same of this machine.

pub(crate) mod cases;
mod changed;
pub(crate) mod cluster;
pub(crate) mod ledger;
pub mod plan;
mod plan_check;
pub(crate) mod run;
pub(crate) mod run_cases;

pub use cases::{CasePart, FailedCase};
pub use cluster::jobs::{JobOptions, WrittenJobs, write_job_scripts};
pub use plan::CampaignPlan;
pub use plan_check::{CaseCheck, PlanCheck, check_plan};
pub use run::{CampaignOptions, FinishedCampaign, check, collect, make_packing, names, run, unsound};
pub(crate) use run::{ReadyCases, Walk, look, run_around};
pub use run_cases::{CampaignCallbacks, CaseEvent};
