//! Notes in words.

use pyo3::prelude::*;
use voidwalk::practice::note::Note;
use voidwalk::practice::quantity::{SizeUnit, THIN};
use voidwalk::words::{sentence, setting};

use crate::problem::refused;

/// The sentences of a JSON list of notes, in its order; sizes are in mm, or multiples of D0F.
#[pyfunction]
#[pyo3(signature = (notes, scale_free=false))]
pub fn note_sentences(notes: &str, scale_free: bool) -> PyResult<Vec<String>> {
    let notes: Vec<Note> = serde_json::from_str(notes).map_err(refused)?;
    Ok(notes.iter().map(|note| plain(&sentence(note, SizeUnit::of(scale_free, false)))).collect())
}

/// A note as a warning: its sentence, and the setting that changes it.
pub fn with_setting(note: &Note, unit: SizeUnit) -> String {
    plain(format!("{} {}", sentence(note, unit), setting(note)).trim_end())
}

/// Words as a terminal shows them, with plain spaces.
pub fn plain(words: &str) -> String {
    words.replace(THIN, " ")
}
