//! `voidwalk judge`: two sieve tables in, the whole answer out.

use super::args::{JudgeArgs, TableArgs};
use super::judge_each::judge_each;
use super::print::{shown, to_stdout};
use super::progress::followed;
use super::run::show;
use super::values::{of_soils, with_options};
use crate::run::{self, RunError};
use crate::scene::{Scene, TableOptions};

impl TableArgs {
    /// What a scene of two tables is given besides them.
    ///
    /// # Errors
    /// A setting is given by an option of its own and by --set, too.
    pub fn options(&self) -> Result<TableOptions, RunError> {
        let [dispersive, joint] = of_soils(self.dispersive, self.joint_mm);
        let options = [dispersive, joint];
        let changes = with_options(&self.set.settings()?, options)?;
        let (as_sampled, as_given) = (self.as_sampled, self.as_given);
        Ok(TableOptions {
            density: self.density,
            pack: self.pack,
            quick: self.quick,
            as_sampled,
            as_given,
            changes,
        })
    }
}

/// Judges a base and a filter.
pub fn judge(args: &JudgeArgs) -> Result<(), RunError> {
    let filter = match &args.filters[..] {
        [filter] if !args.each => filter,
        _ => return judge_each(args),
    };
    let (tables, quiet) = (&args.tables, args.results.walk.quiet);
    let scene = Scene::of_tables(&args.base, filter, &tables.options()?)?;
    let options = args.results.options(&tables.set);
    let run = followed(quiet, |callbacks| run::walk_scene(scene, &options, callbacks))?;
    if !tables.set.json && !quiet {
        to_stdout(&format!("base {}, filter {}\n", shown(&args.base), shown(filter)));
    }
    show(&run, tables.set.json, quiet)?;
    args.results.workbook(&run)?;
    args.results.accept.judged(&run)
}
