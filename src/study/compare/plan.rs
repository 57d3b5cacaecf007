//! What is compared, as the cases of a campaign that share one seed.

use std::path::PathBuf;

use super::super::file_names::{names, refuse_twice};
use crate::campaign::CampaignPlan;
use crate::campaign::plan::PlannedCase;
use crate::outcome::record::SheetCover;
use crate::run::error::RunError;
use crate::run::folder::shown;
use crate::scene::{Scene, TableOptions};

/// Fewer cases have no difference; more have no page that anybody reads, and are a campaign.
const CASES: std::ops::RangeInclusive<usize> = 2..=6;

/// What is compared.
#[derive(Clone, Debug, PartialEq)]
pub enum Compared {
    /// Filters on one base.
    Filters {
        /// The base: a sieve table.
        base: PathBuf,
        /// The filters, likewise.
        filters: Vec<PathBuf>,
    },
    /// Bases on one filter.
    Bases {
        /// The filter: a sieve table.
        filter: PathBuf,
        /// The bases, likewise.
        bases: Vec<PathBuf>,
    },
    /// Scenes as they are, but for their seed.
    Scenes(Vec<PathBuf>),
}

/// A comparison, its cases worked out.
#[derive(Clone, Debug)]
pub struct ComparePlan {
    /// What is compared: `filters`, `bases` or `scenes`.
    pub of: &'static str,
    /// What the cases have in common; empty where they are scenes.
    pub common: String,
    /// The seed of all cases.
    pub seed: u64,
    /// Whether scenes had seeds of their own, which are not taken.
    pub seeds_differed: bool,
    /// What the scenes say alike of the sheet.
    pub(super) cover: SheetCover,
    /// Whether all of them show inches beside mm.
    pub(super) inches: bool,
    /// The cases.
    pub(super) campaign: CampaignPlan,
}

impl ComparePlan {
    /// The cases of a comparison, with the same settings for all.
    ///
    /// # Errors
    /// Fewer than two cases or more than six; the same file twice; a scene that is refused.
    pub fn new(compared: &Compared, options: &TableOptions) -> Result<Self, RunError> {
        let (of, common, files) = match compared {
            Compared::Filters { base, filters } => ("filters", Some(base), filters),
            Compared::Bases { filter, bases } => ("bases", Some(filter), bases),
            Compared::Scenes(scenes) => ("scenes", None, scenes),
        };
        if !CASES.contains(&files.len()) {
            return Err(RunError::Refused(format!(
                "{of} named: {}; compare {} to {}, or walk a plan of many by `voidwalk campaign`",
                files.len(),
                CASES.start(),
                CASES.end()
            )));
        }
        refuse_twice(files)?;
        let mut cases = Vec::new();
        for (name, file) in names(files).into_iter().zip(files) {
            let scene = match compared {
                Compared::Filters { base, .. } => Scene::of_tables(base, file, options)?,
                Compared::Bases { filter, .. } => Scene::of_tables(file, filter, options)?,
                Compared::Scenes(_) => Scene::read(file, &options.settings()?)?,
            };
            cases.push(PlannedCase { name, levels: Vec::new(), scene });
        }
        let seed = cases[0].scene.walk.seed;
        let seeds_differed = cases.iter().any(|case| case.scene.walk.seed != seed);
        cases.iter_mut().for_each(|case| case.scene.walk.seed = seed);
        let cover = SheetCover::in_common(cases.iter().map(|case| case.scene.about.cover()));
        let inches = cases.iter().all(|case| case.scene.about.shows_inches());
        let title = format!("comparison of {of}");
        let campaign = CampaignPlan { file: title.clone(), title, factors: Vec::new(), cases };
        let common = common.map_or(String::new(), |path| shown(path));
        Ok(Self { of, common, seed, seeds_differed, cover, inches, campaign })
    }

    /// The names of the cases.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.campaign.cases.iter().map(|case| case.name.as_str())
    }

    /// What the constrictions of each case come from, in sentences, each once.
    pub fn constrictions_in_words(&self) -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for said in self.campaign.cases.iter().map(|case| case.scene.constrictions_in_words()) {
            if !all.contains(&said) {
                all.push(said);
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_under_two_names_is_named_twice() {
        let at = tempfile::tempdir().unwrap();
        let name = |text: &str| at.path().join(text);
        std::fs::write(name("f.csv"), "").unwrap();
        std::fs::create_dir(name("d")).unwrap();
        for (one, other) in [("f.csv", "./f.csv"), ("f.csv#A", "d/../f.csv#A"), ("none.csv", "./none.csv")] {
            let bases = vec![name(one), name(other)];
            let twice = Compared::Bases { filter: name("g.csv"), bases };
            let said = ComparePlan::new(&twice, &TableOptions::default()).unwrap_err().to_string();
            assert!(said.contains("is named twice"), "{said}");
        }
    }

    #[test]
    fn cases_share_a_seed_and_their_number_is_bounded() {
        let filters = |n: usize| Compared::Filters {
            base: "b.csv".into(),
            filters: (0..n).map(|n| format!("f{n}.csv").into()).collect(),
        };
        let options = TableOptions { changes: vec!["seed=7".into()], ..Default::default() };
        let plan = ComparePlan::new(&filters(3), &options).unwrap();
        assert!(plan.campaign.cases.iter().all(|case| case.scene.walk.seed == 7));
        assert_eq!((plan.names().collect::<Vec<_>>(), plan.seed), (vec!["f0", "f1", "f2"], 7));
        for n in [0, 1, 7] {
            let error = ComparePlan::new(&filters(n), &options).unwrap_err();
            assert!(error.to_string().contains("compare 2 to 6"), "{error}");
        }
        let twice = Compared::Bases { filter: "f".into(), bases: vec!["b".into(), "b".into()] };
        assert!(ComparePlan::new(&twice, &options).unwrap_err().to_string().contains("named twice"));
    }
}
