//! Writes a checkpoint.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::header;
use super::label::Label;
use super::section::Section;
use crate::store::StoreError;
use crate::store::whole::write_whole_with;

/// Path of the checkpoint of a generation.
pub(super) fn slot(folder: &Path, name: &str, generation: u64) -> PathBuf {
    folder.join(format!("{name}.{}", generation % 2))
}

/// Saves a checkpoint in the slot of its generation.
///
/// # Errors
/// Error of the system; the other slot is then untouched, and so is the former content of this one.
pub fn save(folder: &Path, name: &str, label: &Label, sections: &[Section]) -> Result<(), StoreError> {
    let header = header::encode(label, sections);
    write_whole_with(&slot(folder, name, label.generation), |file| {
        file.write_all(&header)?;
        let mut at = header.len() as u64;
        for section in sections {
            pad(file, &mut at, 64)?;
            for part in &section.parts {
                file.write_all(part)?;
            }
            at += section.bytes();
        }
        Ok(())
    })
}

fn pad(file: &mut dyn Write, at: &mut u64, to: u64) -> io::Result<()> {
    let gap = at.next_multiple_of(to) - *at;
    *at += gap;
    file.write_all(&[0; 4096][..gap as usize])
}
