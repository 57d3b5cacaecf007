//! Soils as laboratories write them down: from the bytes of a file to tables of openings and percents finer.
//!
//! Bytes become text or sheets (`text`, `csv`; `workbook` with `xlsx` and `ods`; `ags`), those become rows of
//! cells (`grid`), in which the table is found (`layout`, by `heading`) and read (`points`, `size`,
//! `retained`). `read` is the way through. What is taken for something that the file does not spell out
//! becomes a note; what could be two things is refused.

mod ags;
mod cells;
mod csv;
mod grid;
mod heading;
mod layout;
mod ods;
mod points;
mod read;
mod retained;
mod size;
mod summary;
mod table;
mod text;
mod workbook;
mod xlsx;
mod zipped;

pub(crate) use read::file_and_soil;
pub use read::{curves_in_file, soils_in_file};
pub use summary::{FINES_MM, GRAVEL_MM, SoilSummary};
pub use table::Soil;
