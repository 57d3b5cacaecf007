//! A folder of results as one file to take away.

use std::fs::{self, File};
use std::io::{self, Seek};
use std::path::Path;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::run::checkpoints;
use voidwalk_core::store::open_regular;

/// Packs the results in `folder`, below `name`, into a file without a name in `beside`. Names that begin with
/// a dot and checkpoints are left out, and no link is followed.
///
/// # Errors
/// Errors of the system.
pub fn archive(folder: &Path, name: &str, beside: &Path) -> io::Result<File> {
    let mut writer = ZipWriter::new(tempfile::tempfile_in(beside)?);
    add(&mut writer, folder, name)?;
    let mut file = writer.finish().map_err(io::Error::other)?;
    file.rewind()?;
    Ok(file)
}

fn add(writer: &mut ZipWriter<File>, folder: &Path, name: &str) -> io::Result<()> {
    let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let (file, kind) = (entry.file_name().to_string_lossy().into_owned(), entry.file_type()?);
        let inside = format!("{name}/{file}");
        if file.starts_with('.') || file == checkpoints::FOLDER {
            continue;
        }
        if kind.is_dir() {
            add(writer, &entry.path(), &inside)?;
        } else if kind.is_file()
            && let Some(mut content) = open_regular(&entry.path())?
        {
            let options =
                SimpleFileOptions::default().large_file(entry.metadata()?.len() > u64::from(u32::MAX));
            writer.start_file(inside, options).map_err(io::Error::other)?;
            io::copy(&mut content, writer)?;
        }
    }
    Ok(())
}
