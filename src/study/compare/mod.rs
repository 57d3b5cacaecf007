//! Compares filters on one base, bases on one filter, or scenes: each case walked with the same seed, so that
//! their replicates are pairs.
//!
//! The cases are those of a [`campaign`] inside the comparison's folder: each has a run folder
//! of its own, those that are done are kept, and what was stopped continues.

mod plan;

use std::path::{Path, PathBuf};

pub use plan::{ComparePlan, Compared};

use crate::campaign::cases::PreparedCase;
use crate::campaign::ledger::inert;
use crate::campaign::{self, CampaignCallbacks, CampaignOptions, CasePart, ReadyCases};
use crate::outcome::comparison::Comparison;
use crate::outcome::record::{Outcome, Statistic};
use crate::run::checkpoints::CheckpointInterval;
use crate::run::error::{Exit, RunError};
use crate::run::folder::{FolderKind, claim, clear, shown};
use crate::run::results::json;
use crate::run::unfinished::Unfinished;
use crate::store::{Folder, read_whole};

/// Folder of the campaign, inside the comparison's.
const WALKS: &str = "walks";

/// One row a case.
const CASES: &str = "compare.csv";

/// One row a difference.
const PAIRS: &str = "compare_pairs.csv";

/// How a comparison is walked; no setting changes a result.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// Folder for the results.
    pub out: PathBuf,
    /// Whether an earlier comparison there is replaced; its cases that are asked for again are kept.
    pub overwrite: bool,
    /// Folder in which the packings of filters are kept.
    pub packings: PathBuf,
    /// Memory that the walks may take (bytes); 80 % of what is available without it.
    pub memory: Option<u64>,
    /// Worker threads; without a number as many as a cluster's job has, else one per core.
    pub threads: Option<usize>,
    /// How often a case that is being walked is saved.
    pub checkpoint_interval: CheckpointInterval,
    /// What a case's `manifest.json` says that it was started with.
    pub command: String,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            out: "voidwalk-compare".into(),
            overwrite: false,
            packings: "voidwalk-packings".into(),
            memory: None,
            threads: None,
            checkpoint_interval: CheckpointInterval::default(),
            command: String::new(),
        }
    }
}

/// Walks every case that is not done, and writes `compare.csv`, `compare_pairs.csv` and, last,
/// `compare.json`.
///
/// # Errors
/// A case that is wrong and a folder that cannot be claimed are refused before any work; then as
/// [`campaign::run()`], and a case that cannot be walked leaves nothing to compare. After a stop, the same
/// call continues.
pub fn run(
    plan: &ComparePlan,
    options: &CompareOptions,
    callbacks: &CampaignCallbacks,
) -> Result<Comparison, RunError> {
    let kind = FolderKind::Comparison;
    let of_campaign = CampaignOptions {
        out: options.out.join(WALKS),
        part: CasePart::All,
        packings: Some(options.packings.clone()),
        memory: options.memory,
        threads: options.threads,
        checkpoint_interval: options.checkpoint_interval,
        command: options.command.clone(),
    };
    let stopped = |error: RunError| match error.exit() {
        Exit::Stopped => RunError::Stopped(format!(
            "progress saved; continue with the same command on {}",
            shown(&options.out)
        )),
        _ => error,
    };
    campaign::check(&plan.campaign, &of_campaign)?;
    let folder = claim(&options.out, kind, options.overwrite)?;
    // What is there stays until every case is known to have what it needs.
    let ready = |cases: ReadyCases| begin(&folder, plan, cases?, options.overwrite);
    let of_campaign = CampaignOptions { out: folder.path().join(WALKS), ..of_campaign };
    let walked = campaign::run_after(&plan.campaign, &of_campaign, callbacks, ready).map_err(stopped)?;
    if let Some(problem) = walked.problem() {
        return Err(problem);
    }
    let mut outcomes = Vec::new();
    for line in walked.lines.iter().flatten() {
        let case = format!("{WALKS}/{}", line.folder);
        let outcome = outcome(&folder.path().join(&case))?;
        outcomes.push((line.case.clone(), case, outcome));
    }
    let mut comparison = Comparison::new(plan.of, &plan.common, plan.seed, &outcomes);
    for (case, (.., outcome)) in comparison.cases.iter_mut().zip(&outcomes) {
        (case.practice, case.beside) = (outcome.practice_in_words(), outcome.beside_the_verdict());
    }
    write(&folder, &comparison)?;
    callbacks.run.finish(kind, &folder)?;
    Ok(comparison)
}

/// Clears a claimed folder of an earlier comparison, and marks it as begun with this one.
fn begin(
    folder: &Folder,
    plan: &ComparePlan,
    cases: &[PreparedCase],
    overwrite: bool,
) -> Result<(), RunError> {
    let kind = FolderKind::Comparison;
    let of_case = |case: &PreparedCase| format!("{} {}", case.planned.name, case.fingerprint);
    let all: Vec<String> = cases.iter().map(of_case).collect();
    // Not the path of what is common: the cases know its bytes.
    let text = format!("{} {all:?}", plan.of);
    let work = format!("{:032x}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()));
    match Unfinished::read(folder)? {
        // Of a corrupt mark, or one of an earlier version, nothing is known.
        Some(begun) if !overwrite && !begun.work.is_empty() && begun.work != work => {
            return Err(RunError::Refused(format!(
                "{}: holds another comparison that is unfinished, or was begun by another version of \
                 voidwalk; continue that one with its own command, name another folder or add --overwrite",
                shown(folder.path())
            )));
        }
        // At no moment is this one without its mark.
        Some(begun) if begun.work == work => return Ok(()),
        _ => {}
    }
    clear(folder, kind)?;
    Ok(Unfinished { kind: kind.name().into(), work, ..Unfinished::default() }.begin(folder)?)
}

/// The outcome of a case that is done.
fn outcome(case: &Path) -> Result<Outcome, RunError> {
    let path = case.join(FolderKind::Run.record());
    let failed = |error: &dyn std::fmt::Display| RunError::failed(format!("{}: {error}", shown(&path)));
    let bytes = read_whole(&path).map_err(|error| failed(&error))?;
    serde_json::from_slice(&bytes).map_err(|error| failed(&error))
}

fn write(folder: &Folder, comparison: &Comparison) -> Result<(), RunError> {
    let number = |value: Option<f64>| value.map_or(String::new(), |v| format!("{:.4}", 100.0 * v));
    let of = |s: Option<&Statistic>| [s.map(|s| s.mean), s.and_then(|s| s.low), s.and_then(|s| s.high)];
    let header = "case,verdict,confidence,rules_not_kept,replicates,n_base,d15f_over_d85b,d15f_over_d95b,\
        d85b_of,first_eroded_mass_percent,first_low,first_high,second_eroded_mass_percent,second_low,\
        second_high,grains_per_void,thickness_mm,folder";
    let rows = comparison.cases.iter().map(|case| {
        let words = [case.name.clone(), case.verdict.words().into(), case.confidence.words().into()];
        let counts = [case.rules_not_kept.len() as u64, case.replicates, case.n_base].map(|n| n.to_string());
        let ratios = [case.ratios.d15f_over_d85b, case.ratios.d15f_over_d95b].map(|r| format!("{r:.6}"));
        let of_base = [case.base.map_or(String::new(), |base| base.grading())];
        let eroded = [of(case.runs.first()), of(case.runs.get(1))].concat().into_iter().map(number);
        let thickness_mm = case.thickness_mm.filter(|_| !case.scale_free);
        let given = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.5}"));
        let sizes = [case.grains_per_void, thickness_mm].map(given);
        let folder = [case.folder.clone()];
        words
            .into_iter()
            .chain(counts)
            .chain(ratios)
            .chain(of_base)
            .chain(eroded)
            .chain(sizes)
            .chain(folder)
            .collect()
    });
    folder.write(CASES, &table(CASES, header, rows)?)?;
    let header = "first,second,run,replicates,difference_percentage_points,low,high,joint_low,joint_high,\
        differ";
    let rows = comparison.pairs.iter().map(|pair| {
        let words = [pair.first.clone(), pair.second.clone()];
        let counts = [pair.run, pair.replicates].map(|n| n.to_string());
        let joint = [pair.joint.map(|j| j[0]), pair.joint.map(|j| j[1])];
        let numbers = of(Some(&pair.difference)).into_iter().chain(joint).map(number);
        let differ = [pair.differ.map_or(String::new(), |differ| differ.to_string())];
        words.into_iter().chain(counts).chain(numbers).chain(differ).collect()
    });
    folder.write(PAIRS, &table(PAIRS, header, rows)?)?;
    let name = FolderKind::Comparison.record();
    Ok(folder.write(name, &json(name, comparison)?)?)
}

/// A CSV file; no cell of it is a formula.
fn table(
    file: &'static str,
    header: &str,
    rows: impl Iterator<Item = Vec<String>>,
) -> Result<Vec<u8>, RunError> {
    let failed = |error: csv::Error| RunError::Format { file, source: error.into() };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header.split(',')).map_err(failed)?;
    for row in rows {
        writer.write_record(row.iter().map(|cell| inert(cell))).map_err(failed)?;
    }
    writer.into_inner().map_err(|error| RunError::Format { file, source: error.to_string().into() })
}
