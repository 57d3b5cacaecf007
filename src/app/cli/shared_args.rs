//! Arguments that several commands share: the scene, options of its walk, and the folder of its results.

use std::path::PathBuf;

use clap::Args;

use super::exit::FailOn;
use super::setting_options::{OfScene, SettingOptions};
use super::values::threads;
use crate::run::CheckpointInterval;
use crate::run::machine::bytes_from_words;

/// How a walk is done.
#[derive(Debug, Args)]
pub struct WalkArgs {
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Save a checkpoint this often, such as 10min or 50increments; a stop (Ctrl-C, SIGTERM) always saves
    /// one [default: 10min; for a resumed run, its first setting]
    #[arg(long, value_name = "TIME")]
    pub checkpoint_every: Option<CheckpointInterval>,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Which verdicts the caller does not accept.
#[derive(Debug, Args)]
pub struct AcceptArgs {
    /// Exit with code 4 if the worse of practice and model is at least this bad: some or continuing erosion.
    /// Practice that is not met counts as some erosion, or as continuing where that is not excluded.
    /// Undecided counts as bad, as does practice that is not known. Results are written as usual
    #[arg(long, value_name = "VERDICT")]
    pub fail_on: Option<FailOn>,
}

/// Where a run's results go, and how it is walked.
#[derive(Debug, Args)]
pub struct ResultArgs {
    /// Folder for the results: new, empty, or made by voidwalk [default: the first free of voidwalk-run,
    /// voidwalk-run-2, ...]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace the results of an earlier run in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Write verdict.xlsx, too: verdict, inputs, rules, runs, gradations, provenance
    #[cfg(feature = "xlsx")]
    #[arg(long)]
    pub xlsx: bool,
    /// Which verdicts are not accepted.
    #[command(flatten)]
    pub accept: AcceptArgs,
    /// How it is walked.
    #[command(flatten)]
    pub walk: WalkArgs,
}

/// Which scene.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Scene (TOML), for check also the plan of a campaign [default: the built-in scene, a loose filter of Cu
    /// 1.5 and a base of Cu 1.5 at Dc5]
    pub scene: Option<PathBuf>,
    /// What is set in it, and how it is prepared.
    #[command(flatten)]
    pub set: SettingArgs,
}

/// What is set in a scene, and how it is prepared.
#[derive(Debug, Args)]
pub struct SettingArgs {
    /// Its settings.
    #[command(flatten)]
    pub settings: SettingOptions<OfScene>,
    /// Folder that keeps packings, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub packings: PathBuf,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}
