//! A plan on a cluster whose scheduler is Slurm: job scripts, the cases of each task, and the resources from
//! the scheduler.
//!
//! - [`tasks`] bundles cases into tasks of some minutes, and keeps the list of them in a file.
//! - [`scripts`] writes the jobs' scripts: an array that packs filters, an array that walks, a job that
//!   collects.
//! - [`jobs`] writes them, with the cost of the cases from [`crate::run::cost`].
//! - [`locks`] reports the reliability of locks on the file system of a folder.
//!
//! The scheduler only starts processes. Finished cases, and claims on others, are in the campaign's folder
//! ([`run_cases`](super::run_cases)), so that a task which is lost, doubled or begun again changes no result.

pub mod jobs;
pub mod locks;
pub mod scripts;
pub mod tasks;
