//! `voidwalk export`: the tables of a folder for other programs.

use std::path::Path;

use super::print::{plain, shown, to_stdout};
use crate::report::export as write;
use crate::run::folder::claim;
use crate::run::{FolderKind, RunError};

/// Writes a finished folder's tables as arrays and grids.
pub fn export(folder: &Path) -> Result<(), RunError> {
    let Some(kind) = FolderKind::of(folder).filter(|kind| *kind != FolderKind::Serve) else {
        let problem = "holds no finished work; name the folder of a run, a packing, constrictions, a \
                       campaign, a batch, a study or a specification";
        return Err(RunError::Refused(format!("{}: {problem}", shown(folder))));
    };
    let claimed = claim(folder, kind, true)?;
    let into = claimed.path().join("export");
    if into.symlink_metadata().is_ok_and(|meta| !meta.is_dir()) {
        let what = if into.is_symlink() { "a symbolic link" } else { "a file" };
        return Err(RunError::Refused(format!(
            "{}: is {what}, and the tables go into a folder of that name; move it away or give it another \
             name",
            shown(&into)
        )));
    }
    let tables = write(claimed.path()).map_err(RunError::failed)?;
    let mut text: String = tables.files.iter().map(|path| shown(path) + "\n").collect();
    if !tables.words.is_empty() {
        text += &format!("columns of words are left out: {}\n", plain(&tables.words.join(", ")));
    }
    to_stdout(&text);
    Ok(())
}
