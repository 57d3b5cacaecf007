//! *Will this filter hold this soil?* Two sieve curves in; packing, constrictions, void network and
//! walking base particles in between; a verdict with its uncertainty out.
//!
//! ```
//! use voidwalk::{Callbacks, Case, Scene, walk_case};
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
//! The rooms stand in the order in which data flows, and each uses only those before it:
//!
//! ```text
//! sieve curves -> Packing -> Constrictions -> Network -> Walk -> Outcome      the stages, each usable alone
//! Scene -> Case -> run, cases, study                                          the application
//! words, report, serve, cli                                                   its faces
//! ```
//!
//! [`docs`] has the pages for users, `CONTRIBUTING.md` the map for those who extend it. The model is that of
//! Shire & O'Sullivan, *A network model to assess base-filter combinations*.
//!
//! # Features
//! `report`: pages and figures. `serve`: the page on this machine. `cli`: the command line. All are on by
//! default; the rest is the library that every face calls.

pub mod text;

pub mod stream;

pub mod store;

pub mod schema;

pub mod gradation;

pub mod packing;

pub mod constrictions;

pub mod network;

pub mod walk;

pub mod outcome;

pub mod verdict;

pub mod words;

pub mod scene;

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

pub mod docs;

pub use case::Case;
pub use constrictions::Constrictions;
pub use gradation::Gradation;
pub use network::Network;
pub use outcome::record::{Outcome, Statistic, Verdict};
pub use packing::Packing;
pub use run::{Callbacks, RunError, RunOptions, resume, walk_case, walk_scene};
pub use scene::Scene;
pub use walk::Walk;
