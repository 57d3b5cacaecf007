//! A plan on a cluster whose scheduler is Slurm: job scripts, which cases each task walks, and what the
//! scheduler has given.
//!
//! - [`tasks`] bundles cases into tasks of some minutes, and keeps which is which in a file.
//! - [`scripts`] writes the jobs' scripts: an array that packs filters, an array that walks, a job that
//!   collects.
//! - [`jobs`] writes them, by what [`crate::run::cost`] says that the cases take.
//! - [`locks`] says what is known of locks on the file system of a folder.
//!
//! The scheduler only starts processes. What is done, and who is at what, is in the campaign's folder
//! ([`run_cases`](super::run_cases)), so that a task which is lost, doubled or begun again changes no result.

pub mod jobs;
pub mod locks;
pub mod scripts;
pub mod tasks;
