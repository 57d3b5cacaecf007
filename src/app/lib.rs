//! Application layer of voidwalk: scenes, runs, campaigns, answers and pages.
//!
//! ```
//! use voidwalk_app::{Callbacks, Case, Scene, walk_case};
//!
//! // The built-in scene on a network of 10 x 10 x 20 voids, with a wider base.
//! let changes = ["base.cu=3", "network.nx=10", "network.ny=10", "network.nz=20", "record.sensitivity=[]"];
//! let scene = Scene::built_in(&changes.map(String::from))?;
//! let case = Case::new(scene)?;
//! let outcome = walk_case(&case, &Callbacks::default())?;
//! let first = &outcome.summary[0].eroded_mass_fraction;
//! println!("{}: {:.1} % eroded in the first run", outcome.model.class.words(), 100.0 * first.mean);
//! # assert!(first.mean > 0.0 && first.mean < 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The modules are in the order in which data flows, and each uses only those before it:
//!
//! - [`outcome`]: the records of a run and its statistics; [`verdict`]: the conclusions on a case.
//! - [`words`]: the sentences of every interface.
//! - [`scene`]: the settings of a user; [`case`]: a scene resolved to filter, base and network.
//! - [`run`]: one case, its checkpoints and its folder; [`cases`]: many cases by a plan and a ledger;
//!   [`study`]: boundaries, specifications, percolation.
//! - `report`, `serve`, `cli`: pages, the page on this machine, the command line.

pub mod outcome;

pub mod verdict;

pub mod words;

pub mod scene;

#[cfg(test)]
#[path = "../practice/test_soils.rs"]
mod test_soils;

pub mod case;

pub mod run;

pub mod cases;

pub mod study;

#[cfg(feature = "report")]
pub mod report;

#[cfg(feature = "serve")]
pub mod serve;

#[cfg(feature = "cli")]
pub mod cli;

pub use case::Case;
pub use outcome::record::{Outcome, Statistic, Verdict};
pub use run::{Callbacks, RunError, RunOptions, resume, walk_case, walk_scene};
pub use scene::Scene;
