//! Report: one page and its figures, made from a finished run folder alone.
//!
//! The `write` functions write `figures/*.svg` and the page of a folder. [`run_page()`] and
//! [`network_walk_page()`] return pages of walks in memory as text; [`run_brief()`] and
//! [`network_walk_brief()`] return the verdict alone, for a notebook.
//!
//! A page is self-contained. Its content security policy forbids every script and every fetch and names its
//! one style by hash; figures are SVG elements without a style. Names come from users and are treated as
//! hostile: markup in them is escaped; control characters and characters that change the writing direction
//! are replaced.
//!
//! An engineer first reads the answer, the gradations and the deciding rules, on one sheet; then notes,
//! results and limits of the model, and all rules. Research figures and tables appear on screen only; the
//! printed report ends with the gradations in numbers, the sources, and the commands to run it again.

mod batch;
mod boundary;
mod campaign;
mod cases;
mod export;
/// Public only for the benchmarks.
#[doc(hidden)]
pub mod figures;
pub mod files;
mod first_page;
mod folder;
mod names;
mod network_walk;
mod packing;
mod page;
mod percolation;
mod results;
mod run_figures;
mod section;
pub(crate) mod shell;
mod soils;
mod specification;
mod table;
mod walks;
#[cfg(feature = "xlsx")]
mod workbook;

pub(crate) use batch::write_batch;
pub(crate) use boundary::write_boundary;
pub use campaign::{campaign_page, write_campaign};
pub(crate) use export::export;
pub use files::ReportError;
pub(crate) use first_page::colour_of;
pub use folder::about_page;
pub use network_walk::{network_walk_brief, network_walk_page};
pub(crate) use packing::write_packing;
pub(crate) use page::write_walked;
pub use page::{run_brief, run_page, write};
pub(crate) use percolation::write_percolation;
pub(crate) use soils::soils_figure;
pub(crate) use specification::{write_designs, write_specification};
#[cfg(feature = "xlsx")]
pub(crate) use workbook::{soil_template, write_verdict_workbook};
