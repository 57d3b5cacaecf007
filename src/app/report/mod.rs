//! The report: one page and its figures, from a finished run folder alone.
//!
//! [`write()`] reads the files of a run (`outcome.json`, `manifest.json`, `scene.toml`, `series.csv`,
//! `layers.csv`, `retained.csv`, `eroded.csv`; see [`crate::outcome::record`]) and runs nothing. Other
//! functions read other folders: [`write_packing()`] a packing, [`write_campaign()`] a campaign,
//! [`write_percolation()`] a percolation study, [`write_batch()`] many samples against filters,
//! [`write_boundary()`] the model's boundaries, [`write_specification()`] a specification and
//! [`write_designs()`] the specifications for many samples. They write `figures/*.svg`, each a file of its
//! own, and `report.html`.
//!
//! # Pages without a folder
//! [`write_walked()`] writes the page of a run that was just walked, and reads nothing of its folder. A walk
//! in memory has the same page, as text: [`run_page()`] makes it from the contents that its files would have,
//! and [`network_walk_page()`] from the record of walks on given networks; [`run_brief()`] and
//! [`network_walk_brief()`] give the verdict alone, for a notebook.
//!
//! # What the page may do
//! A page can only show itself. Its content security policy forbids every script and every fetch and names
//! its one style by hash; figures are SVG elements without a style. Names come from users and are treated as
//! hostile: markup in them is escaped, control characters and those that change the direction of writing are
//! replaced.
//!
//! # Order
//! An engineer reads the answer first, the gradations and the deciding rules, on one sheet; then notes,
//! results and limits of the model, and all rules. Figures and tables of research stay on the screen; paper
//! ends with the gradations in numbers, the sources, and the commands to run it again.

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
pub(crate) mod shell;
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
pub use percolation::write_percolation;
pub use soils::soils_figure;
pub use specification::write_specification;
use voidwalk_practice::quantity;
#[cfg(feature = "xlsx")]
pub use workbook::{soil_template, write_verdict_workbook};
pub use written::Written;
