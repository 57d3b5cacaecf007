//! `voidwalk-paper FOLDER`: the page of the paper's reproduction. Each of its figures with our result, and
//! every number that it states in its text beside ours, judged by one rule, from the folder alone that
//! `scripts/paper/paper.sh` fills.
//!
//! The modules stand in the order in which a number goes from our results to the page; each uses only those
//! before it:
//!
//! ```text
//! study -> measured -> measures -> statements -> figures -> page
//! ```
//!
//! Exit codes, as those of voidwalk: 0 done, 1 failed, 2 refused (before any work, nothing written).

mod study;

mod measured;

mod measures;

mod statements;

mod figures;

mod page;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use voidwalk::text::plain;

/// Write the page of the paper's reproduction: report.html, figures and statements.csv
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// The folder that scripts/paper/paper.sh filled
    folder: PathBuf,
}

fn main() -> ExitCode {
    let folder = Arguments::parse().folder;
    // The plan that the page is about; any other may be missing.
    if !folder.join("paper/ledger.jsonl").is_file() {
        let shown = folder.display();
        let problem = "holds no paper/ledger.jsonl; name a folder that scripts/paper/paper.sh filled";
        return ended(2, &format!("refused: {shown}: {problem}"));
    }
    match page::write(&folder) {
        Ok(written) => {
            let _ = writeln!(std::io::stdout(), "{}", plain(&written.page.display().to_string()));
            ExitCode::SUCCESS
        }
        Err(error) => ended(1, &format!("error: {error}")),
    }
}

/// Ends with a message. A reader that has left is no fault of ours: what cannot be printed is dropped, here
/// and above.
fn ended(code: u8, message: &str) -> ExitCode {
    let _ = writeln!(std::io::stderr(), "{}", plain(message));
    ExitCode::from(code)
}
