//! `voidwalk judge`: two sieve tables in, the whole answer out.

use super::args::{JudgeArgs, TableArgs};
use super::judge_each::judge_each;
use super::print::{shown, to_stdout};
use super::progress::followed;
use crate::run::{self, RunError};
use crate::scene::{Scene, TableOptions};

impl TableArgs {
    /// Options of a scene of two tables.
    pub fn options(&self) -> TableOptions {
        TableOptions {
            density: self.density,
            pack: self.pack,
            quick: self.quick,
            as_sampled: self.as_sampled,
            as_given: self.as_given,
            changes: self.set.settings.assignments.clone(),
        }
    }
}

/// Judges a base and a filter.
pub fn judge(args: &JudgeArgs) -> Result<(), RunError> {
    let filter = match &args.filters[..] {
        [filter] if !args.each => filter,
        _ => return judge_each(args),
    };
    let (tables, quiet) = (&args.tables, args.results.walk.quiet);
    let scene = Scene::of_tables(&args.base, filter, &tables.options())?;
    let options = args.results.options(&tables.set);
    let run = followed(quiet, |callbacks| run::walk_scene(scene, &options, callbacks))?;
    if !tables.set.json && !quiet {
        to_stdout(&format!("base {}, filter {}\n", shown(&args.base), shown(filter)));
    }
    args.results.finish(&run, tables.set.json)
}
