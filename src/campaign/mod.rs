//! Campaigns: many scenes, walked by as many processes as are started on one folder.
//!
//! - [`plan`] crosses factors into cases, each with a name and a seed of its own.
//! - [`run_cases`] walks those that are not done, [`ledger`] collects what came of them.
//! - [`cluster`] hands a plan to a cluster's scheduler, by what [`crate::run::cost`] says that its cases take.

pub mod cluster;
pub mod ledger;
pub mod plan;
pub mod run_cases;
