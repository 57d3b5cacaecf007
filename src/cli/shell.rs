//! `voidwalk completions` and `voidwalk man`: what a shell and `man` want to know of the program.

use std::path::Path;

use clap_complete::{Shell, generate};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};

use super::examples::command;
use super::exit::EXIT_CODES;
use super::print::{shown, to_stdout};
use crate::run::RunError;
use crate::store::{StoreError, write_whole};

/// Prints a script that completes commands and options.
pub fn completions(shell: Shell) {
    let mut script = Vec::new();
    generate(shell, &mut command(), "voidwalk", &mut script);
    to_stdout(&String::from_utf8_lossy(&script));
}

/// Writes a manual page of the program and of each of its commands.
pub fn man(folder: &Path) -> Result<(), RunError> {
    if let Some(file) = folder.ancestors().find(|part| part.exists() && !part.is_dir()) {
        let problem = "is a file; name a folder for the pages, a new one or one that is there";
        return Err(RunError::Refused(format!("{}: {problem}", shown(file))));
    }
    let mut whole = command();
    whole.build();
    let mut pages = vec![("voidwalk.1".to_owned(), page(whole.clone().after_help(None))?)];
    for sub in whole.get_subcommands().filter(|sub| sub.get_name() != "help") {
        pages.push((format!("voidwalk-{}.1", sub.get_name()), page(sub.clone())?));
    }
    let io = |source| StoreError::Io { path: folder.to_owned(), action: "make the folder", source };
    std::fs::create_dir_all(folder).map_err(io).map_err(RunError::Claim)?;
    for (name, text) in &pages {
        write_whole(&folder.join(name), text).map_err(RunError::Claim)?;
    }
    to_stdout(&format!("{} pages in {}\n", pages.len(), shown(folder)));
    Ok(())
}

fn page(command: clap::Command) -> Result<Vec<u8>, RunError> {
    let mut text = Vec::new();
    Man::new(command).render(&mut text).map_err(RunError::failed)?;
    let mut codes = Roff::default();
    codes.control("SH", ["EXIT STATUS"]);
    for (code, meaning) in EXIT_CODES {
        codes.control("TP", []).text([bold(code.to_string())]).text([roman(meaning)]);
    }
    codes.to_writer(&mut text).map_err(RunError::failed)?;
    Ok(text)
}
