//! *Will this filter hold this soil?* Two sieve curves in; packing, constrictions, void network and
//! walking base particles in between; a verdict with its uncertainty out.
//!
//! The modules stand in the order in which data flows, and each uses only those before it:
//!
//! ```text
//! sieve curves -> Packing -> Constrictions -> Network -> Walk -> Outcome -> Report
//! ```
//!
//! The model is that of Shire & O'Sullivan, *A network model to assess base-filter combinations*.

pub mod stream;

pub mod store;

pub mod schema;

pub mod gradation;

pub mod packing;

pub mod constrictions;

pub mod network;

pub mod walk;

pub mod outcome;

pub mod scene;

pub mod case;

pub mod run;

pub mod campaign;

pub mod study;

pub mod report;

pub mod cli;
