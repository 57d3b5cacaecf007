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
//! The library is four crates, and each uses only those before it:
//!
//! ```text
//! voidwalk-core       gradation -> packing -> constrictions -> network -> walk
//! voidwalk-sheets     sieve tables as laboratories write them -> gradations
//! voidwalk-practice   gradations -> rules, decision, specification
//! voidwalk-app        Scene -> Case -> run, cases, study -> words, report, serve, cli
//! ```
//!
//! [`docs`] holds the pages for users, `CONTRIBUTING.md` the map for developers. The model follows Shire &
//! O'Sullivan, *A network model to assess base-filter combinations*.
//!
//! # Features
//! `report`: pages and figures. `serve`: the page on this machine. `cli`: the command line. All are on by
//! default; without them the crate is the library that every interface calls.

pub mod docs;

pub use voidwalk_app::{case, cases, outcome, run, scene, study, verdict, words};
pub use voidwalk_core::{constrictions, gradation, network, packing, schema, store, stream, text, walk};
pub use voidwalk_practice as practice;
pub use voidwalk_sheets as sheets;

#[cfg(feature = "cli")]
pub use voidwalk_app::cli;
#[cfg(feature = "report")]
pub use voidwalk_app::report;
#[cfg(feature = "serve")]
pub use voidwalk_app::serve;

pub use voidwalk_app::{
    Callbacks, Case, Outcome, RunError, RunOptions, Scene, Statistic, Verdict, resume, walk_case, walk_scene,
};
pub use voidwalk_core::{Constrictions, Gradation, Network, Packing, Walk};
