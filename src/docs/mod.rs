//! Pages for users: what the front page of the repository has no room for.

#[doc = include_str!("soils.md")]
pub mod soils {}

#[doc = include_str!("serve.md")]
pub mod serve {}

#[doc = include_str!("graph.md")]
pub mod graph {}

#[doc = include_str!("arches.md")]
pub mod arches {}

#[doc = include_str!("rules.md")]
pub mod rules {}

#[doc = include_str!("design.md")]
pub mod design {}

#[doc = include_str!("boundary.md")]
pub mod boundary {}

#[doc = include_str!("campaigns.md")]
pub mod campaigns {}

#[doc = include_str!("uncertainty.md")]
pub mod uncertainty {}

#[doc = include_str!("long_runs.md")]
pub mod long_runs {}

#[doc = include_str!("python.md")]
pub mod python {}

#[doc = include_str!("files.md")]
pub mod files {}

#[doc = include_str!("stability.md")]
pub mod stability {}
