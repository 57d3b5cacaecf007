//! The report: one page and its figures, from a finished run folder alone.
//!
//! [`write()`] reads what a run left behind (`outcome.json`, `manifest.json`, `scene.toml`, `series.csv`,
//! `layers.csv`, `retained.csv`, `eroded.csv`; see [`crate::outcome::record`]) and runs nothing;
//! [`write_packing()`] reads the folder of a packing, [`write_campaign()`] that of a campaign,
//! [`write_percolation()`] that of a percolation study, [`write_batch()`] that of many samples against
//! filters, [`write_boundary()`] that of the model's boundaries, [`write_specification()`] that of a
//! specification and [`write_designs()`] that of the specifications for many samples. They write
//! `figures/*.svg`, each a file of its own, and `report.html`.
//!
//! # Pages without a folder
//! [`write_walked()`] writes the page of a run that was walked now, and reads nothing of its folder. What was
//! walked in memory has the same page, as text: [`run_page()`] from what its files would say, and
//! [`network_walk_page()`] from the record of walks on given networks; [`run_brief()`] and
//! [`network_walk_brief()`] are the verdict alone, for a notebook.
//!
//! # Pages of others
//! A program with a page of its own over the same results, as `scripts/paper`, builds it from these:
//! [`files`] reads what lies in a folder, [`figures`] draws, [`quantity`] writes a number as the other pages
//! do, and [`shell`] is the page around it, which [`write_page()`] writes. A figure of ours that others show
//! too is public by itself: [`percolation_spread()`].
//!
//! # What the page may do
//! Nothing but show itself. Its content security policy forbids every script and every fetch and names its
//! one style by hash; figures are SVG elements without a style. Names come from users and are taken for
//! hostile: markup in them is escaped, control characters and those that turn the direction of writing are
//! replaced.
//!
//! # Order
//! An engineer reads the answer first, the gradations and the rules that decide, on one sheet; then notes,
//! what the model found and leaves out, all rules. Figures and tables of research stay on the screen; paper
//! ends with the gradations in numbers, the sources, and how to run it again.

mod about;
mod appendix;
mod batch;
mod boundaries;
mod boundary;
mod by_void;
mod campaign;
mod campaign_cases;
mod cases;
mod connectivity;
mod cover;
mod designs;
mod error;
mod export;
pub mod figures;
pub mod files;
mod first_page;
mod folder;
mod given_soils;
mod infiltration;
mod names;
mod network_walk;
mod packing;
mod page;
mod percolation;
mod results;
mod rules;
mod run_figures;
mod section;
pub mod shell;
mod shown;
mod sizes;
mod soils;
mod specification;
mod table;
mod verdict_box;
mod vtu;
mod walks;
#[cfg(feature = "xlsx")]
mod workbook;
mod written;

pub use about::about_page;
pub use batch::write_batch;
pub use boundary::write_boundary;
pub use campaign::{campaign_page, write_campaign};
pub use designs::write_designs;
pub use error::ReportError;
pub use export::{Exported, export};
pub use first_page::colour_of;
pub use network_walk::{network_walk_brief, network_walk_page};
pub use packing::write_packing;
pub use page::{run_brief, run_page, write, write_walked};
pub use percolation::{percolation_spread, write_percolation};
pub use soils::soils_figure;
pub use specification::write_specification;
pub use voidwalk_practice::quantity;
#[cfg(feature = "xlsx")]
pub use workbook::{soil_template, write_verdict_workbook};
pub use written::{Written, write_page};
