//! A granular filter as a network of voids, and the base particles that walk through it.
//!
//! Data flows one way:
//!
//! ```text
//! gradation -> packing -> constrictions -> network -> walk
//! ```
//!
//! ```
//! use bitvec::vec::BitVec;
//! use voidwalk_core::walk::{SizeClasses, State, Supply, WalkControl};
//! use voidwalk_core::{Gradation, Network, Walk, constrictions::find, gradation::SizeSampler};
//!
//! let (seed, particles, increments) = (1, 20_000, 100);
//! let curve = find("cu1.5-loose")?.curve()?.in_mm(1.0)?;
//! let network = Network::cubic([10, 10, 20], &curve, 1.0, seed)?;
//! let base = Gradation::linear_from_dx(85.0, curve.dc(5.0).unwrap(), 3.0)?;
//! let sampler = SizeSampler::new(&base, 1.0)?;
//! let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 64);
//! let supply = Supply::new(sampler, particles, increments);
//! let open = BitVec::repeat(false, network.constrictions());
//! let mut state = State::new(&network, &supply, classes, open, seed, 1);
//! Walk::new(&network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue)?;
//! println!("{} of {} particles eroded", state.tally.eroded, state.tally.inserted);
//! # assert!(state.tally.inserted == particles);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`gradation`]: sieve curves by mass and by number, and particles drawn from them.
//! - [`packing`]: spheres of a gradation in a periodic cell, loose or dense.
//! - [`constrictions`]: Delaunay triangulation, constriction sizes, voids, and the library of filters.
//! - [`network`]: voids and constrictions as arrays, the flow of water through them, percolation.
//! - [`walk`]: increments of moving particles, singly or as counts, merged deterministically.
//! - [`stream`]: all random numbers, by key. One seed gives the same bits for any thread count.
//! - [`store`]: folders, columns in memory or mapped files, and checkpoints that survive a kill.
//! - [`schema`]: settings, each declared once with its type, default and allowed values.
//!
//! The model is by Shire & O'Sullivan, *A network model to assess base-filter combinations*.

extern crate self as voidwalk_core;

pub mod text;

pub mod stream;

pub mod store;

pub mod schema;

pub mod gradation;

pub mod packing;

pub mod constrictions;

pub mod network;

pub mod walk;

pub use constrictions::Constrictions;
pub use gradation::Gradation;
pub use network::Network;
pub use packing::Packing;
pub use walk::Walk;
