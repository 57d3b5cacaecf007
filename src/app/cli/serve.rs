//! `voidwalk serve`: the page on this machine.

use super::args::ServeArgs;
use super::print::{plain, shown, to_stdout, whole_stdout};
use super::progress::stop_on_signals;
use super::report::page;
use super::run::command_line;
use crate::run::{PrepareOptions, RunError};
use crate::serve::{ServeOptions, Server};

/// Serves the page until a signal ends it.
pub fn serve(args: &ServeArgs) -> Result<(), RunError> {
    let stop = stop_on_signals()?;
    let server = Server::open(ServeOptions {
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
    // No other program is given the address.
    whole_stdout()?;
    server.run(&stop)
}
