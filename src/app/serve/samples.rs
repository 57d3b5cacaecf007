//! Every sample of a sheet against filters: the table of rules, for the page and as a file.

use serde_json::{Value, json};

use super::batches::{class_of, filter_names, filter_paths, table, whole_sheet};
use super::sheets::Sheets;
use crate::cases::pairs_of;
use crate::words::batch::{columns, of_filter};
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{BatchTable, PairOptions};

/// Most rows that a page shows.
const MOST_SHOWN: usize = 1000;

/// The table of all samples of the sheet in which a base is, against filters.
pub struct SampleTable(BatchTable);

impl SampleTable {
    /// Applies the rules.
    ///
    /// # Errors
    /// There is no such sheet; a sheet that cannot be read; no filter, or too many of them.
    pub fn new(sheets: &Sheets, base: &str, filters: &[&str], options: PairOptions) -> Result<Self, String> {
        let paths = filter_paths(sheets, filters)?;
        let table = pairs_of(&sheets.path(whole_sheet(base))?, &paths, options, true);
        let mut table = table.map_err(|problem| sheets.as_named(&problem.to_string()))?;
        // Sheets have their own names here, which may repeat, and no folder.
        let names = filter_names(sheets, &paths);
        let of_filter = (table.rows.len() / table.filters.len()).max(1);
        for (at, row) in table.rows.iter_mut().enumerate() {
            row.filter.clone_from(&names[at / of_filter]);
        }
        table.filters.iter_mut().zip(names).for_each(|(filter, name)| filter.name = name);
        table.notes.iter_mut().for_each(|note| *note = sheets.as_named(note));
        Ok(Self(table))
    }

    /// JSON for the page, with sentences on each filter.
    pub fn json(&self) -> Value {
        let rows = &self.0.rows[..self.0.rows.len().min(MOST_SHOWN)];
        let cut = (rows.len() < self.0.rows.len())
            .then(|| format!("the first {MOST_SHOWN} of {} rows; the file has all", self.0.rows.len()));
        let notes = self.0.notes.iter().cloned().chain(cut);
        let mut value = table(columns(SizeUnit::Mm), rows, |row| class_of(row, row.may_lose_fines));
        let of_filters = self.0.filters.iter().map(|filter| of_filter(filter, &self.0.rows, SizeUnit::Mm));
        value["filters"] = json!(of_filters.collect::<Vec<_>>());
        value["notes"] = json!(notes.collect::<Vec<_>>());
        value
    }

    /// CSV file.
    pub fn csv(&self) -> Vec<u8> {
        columns(SizeUnit::Mm).csv(&self.0.rows)
    }
}
