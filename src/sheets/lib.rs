//! Soils as laboratories write them down: from the bytes of a file to tables of openings and percents finer.
//!
//! Bytes become text or sheets (`text`, `csv`; `workbook` with `xlsx` and `ods`, their `runs` and `literals`;
//! `ags`). Text and sheets become rows of cells (`grid`), which are cut into parts with one table each
//! (`blocks`, `tidy`; `across` turns a table that lies on its side, by `heads` and `labels`). In each part
//! the table is located (`layout`, by `heading` and `languages`; `extent` gives its end) and read (`points`,
//! `size`, `units`, `stated`, `roles`, `retained`). A table that continues another is joined to it
//! (`joined`); `names` names the soils. `read` runs all steps. An assumption about something that the file
//! does not spell out becomes a note; an ambiguity is refused.

mod account;
mod across;
mod agreement;
mod ags;
mod blocks;
mod bounds;
mod cells;
mod columns;
mod commas;
mod content;
mod contradiction;
mod csv;
mod extent;
mod grid;
mod heading;
mod heads;
mod joined;
mod labels;
mod languages;
mod layout;
mod lines;
mod literals;
mod marks;
mod names;
mod ods;
mod points;
mod read;
mod retained;
mod roles;
mod runs;
mod samples;
mod size;
mod stated;
mod summary;
mod table;
mod text;
mod tidy;
mod torn;
mod units;
mod workbook;
mod xlsx;
mod zipped;

pub use read::{
    curves_in_file, file_and_soil, notes_in_file, parse_gradation, read_gradation, soils_in_file,
};
pub use samples::{SoilSample, envelope_in, named_soils_in, samples_in};
pub use size::us_sieve;
pub use summary::SoilSummary;
pub use table::Soil;
