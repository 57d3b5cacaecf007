//! Scenes and campaigns: the only place that knows all stages.
//!
//! - [`scene`] is one base-filter combination as the user states it ([`settings`] reads and checks it).
//! - [`packed`] makes the packing of a scene that gives a sieve curve and a density instead of constrictions.
//! - [`case`] is a scene with its files read and every number worked out.
//! - [`walks`] walks its replicates, [`keeper`] keeps them so that a stopped run goes on.
//! - [`results`] writes what came of it into a run folder.
//! - [`plan`] is many scenes, [`conduct`] walks those that are not done, [`ledger`] collects what came of them.
//! - [`cluster`] hands a plan to a cluster's scheduler, by what [`effort`] says that its cases take.
//! - [`percolation`] is a study of its own: the percolation threshold against the size of the lattice.
//! - [`precision`] is another: error against run time.

pub mod case;
pub mod cluster;
pub mod conduct;
pub mod effort;
pub mod keeper;
pub mod ledger;
pub mod machine;
mod names;
mod network_source;
pub mod packed;
pub mod percolation;
pub mod plan;
pub mod precision;
pub mod results;
pub mod scene;
pub mod settings;
pub mod walks;
