//! Commands on finished folders, `report` and `export`, and `voidwalk serve`.

use std::path::Path;

use super::print::{plain, shown, to_stdout};
use super::progress::page;
use crate::report::{self, ReportError};
use crate::run::folder::{claim, refused};
use crate::run::{FolderKind, RunError};

#[cfg(feature = "serve")]
use super::{args::ServeArgs, print::whole_stdout, run::command_line};
#[cfg(feature = "serve")]
use crate::run::PrepareOptions;
#[cfg(feature = "serve")]
use voidwalk_core::store::platform::process::stop_on_request;

pub(crate) fn report(folder: &Path) -> Result<(), RunError> {
    let Some(kind) = FolderKind::of(folder).filter(|kind| kind.has_page()) else {
        let problem = "holds no outcome.json, packing.json, campaign.json, batch.json, percolation.json, \
            boundary.json, designs.json or specification.json; name the folder of a finished run, packing, \
            campaign, batch, study or specification";
        return Err(refused(folder, problem));
    };
    let claimed = claim(folder, kind, true)?;
    let page = page(kind, claimed.path(), None).map_err(|error| match error {
        ReportError::Form { .. } => RunError::Refused(error.to_string()),
        _ => RunError::failed(error),
    })?;
    to_stdout(&format!("{}\n", shown(&page)));
    Ok(())
}

pub(crate) fn export(folder: &Path) -> Result<(), RunError> {
    let Some(kind) = FolderKind::of(folder).filter(|kind| *kind != FolderKind::Serve) else {
        let problem = "holds no finished work; name the folder of a run, a packing, constrictions, a \
                       campaign, a batch, a study or a specification";
        return Err(refused(folder, problem));
    };
    let claimed = claim(folder, kind, true)?;
    let into = claimed.path().join("export");
    if into.symlink_metadata().is_ok_and(|meta| !meta.is_dir()) {
        let what = if into.is_symlink() { "a symbolic link" } else { "a file" };
        let problem = "and the tables go into a folder of that name; move it away or give it another name";
        return Err(refused(&into, format!("is {what}, {problem}")));
    }
    let tables = report::export(claimed.path()).map_err(RunError::failed)?;
    let mut text: String = tables.files.iter().map(|path| shown(path) + "\n").collect();
    if !tables.words.is_empty() {
        text += &format!("columns of words are left out: {}\n", plain(&tables.words.join(", ")));
    }
    to_stdout(&text);
    Ok(())
}

#[cfg(feature = "serve")]
pub(crate) fn serve(args: &ServeArgs) -> Result<(), RunError> {
    let stop = stop_on_request().map_err(RunError::failed)?;
    let server = crate::serve::Server::open(crate::serve::ServeOptions {
        port: args.port,
        folder: args.out.clone(),
        prepare: PrepareOptions {
            packings: args.packings.clone(),
            memory: args.memory,
            threads: args.threads,
        },
        on_results: |kind, folder, run| Ok(page(kind, folder, run).map(drop)?),
        command: command_line(),
    })?;
    let (address, folder) = (plain(&server.address()), shown(server.folder()));
    to_stdout(&format!(
        "open {address}\nfor this machine alone; whoever has the address can use it. Sheets and results are \
         in {folder}; Ctrl-C ends it\n"
    ));
    // The address is not passed to any other program.
    whole_stdout()?;
    server.run(&stop)
}
