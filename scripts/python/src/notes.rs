//! Notes in words.

use pyo3::prelude::*;
use voidwalk::outcome::note::Note;
use voidwalk::outcome::numbers::SizeUnit;
use voidwalk::words::{sentence, setting};

use crate::problem::refused;

/// The sentences of a JSON list of notes, in its order.
#[pyfunction]
pub fn note_sentences(notes: &str) -> PyResult<Vec<String>> {
    let notes: Vec<Note> = serde_json::from_str(notes).map_err(refused)?;
    Ok(notes.iter().map(|note| sentence(note, SizeUnit::Mm)).collect())
}

/// A note as a warning: its sentence, and the setting that changes it.
pub fn with_setting(note: &Note) -> String {
    format!("{} {}", sentence(note, SizeUnit::Mm), setting(note)).trim_end().to_owned()
}
