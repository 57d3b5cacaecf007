//! Soils as laboratories record them: from the bytes of a file to tables of openings and percents finer.
//!
//! Bytes become text (`text`, `ags`) or sheets (`workbook`, with `xlsx` and `ods`). Both become rows of
//! cells (`grid`), which are cut into parts with one table each (`blocks`; `across` turns a table that
//! lies on its side). In each part the table is located (`layout`, by `heading` and `languages`;
//! `extent` gives its end) and read (`points`, `size`, `units`, `roles`, `retained`). `names` joins a
//! table that continues another and names the soils. `read` runs all steps. An assumption about
//! something that the file does not state becomes a note; an ambiguity is refused. A function that reads
//! a file has the errors of [`read_gradation`].

mod across;
mod ags;
mod blocks;
mod content;
mod extent;
mod grid;
mod heading;
mod languages;
mod layout;
mod names;
mod ods;
mod points;
mod read;
mod retained;
mod roles;
mod size;
mod soil;
mod text;
mod units;
mod workbook;
mod xlsx;

pub use read::{SoilSample, curves_in_file, envelope_in, file_and_soil, named_soils_in, notes_in_file};
pub use read::{parse_gradation, read_gradation, samples_in, soils_in_file};
pub use size::us_sieve;
pub use soil::{Soil, SoilSummary};
