//! Arguments and their meaning for a user: the commands, and options of one pair or several.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::setting_options::{OfRules, SettingOptions};
pub use super::shared_args::{AcceptArgs, ResultArgs, SceneArgs, SettingArgs, WalkArgs};
pub use super::study_args::{
    BoundaryArgs, CampaignArgs, ConstrictionsArgs, DesignArgs, PackArgs, PercolationArgs,
};
use super::values::{density, length, schema_of, threads};
use crate::run::machine::bytes_from_words;
use crate::scene::Density;

/// Will this filter hold this soil? A random-walk network model of base-filter combinations.
#[derive(Debug, Parser)]
#[command(name = "voidwalk", version, about, propagate_version = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Walk the base of a scene through its filter, and judge it
    Run(RunArgs),
    /// Judge a base and a filter by their sieve tables: find the constrictions, walk, and write the page
    Judge(JudgeArgs),
    /// Open a page in the browser of this machine: curves, rules, walks and verdicts of dropped sheets
    #[cfg(feature = "serve")]
    Serve(ServeArgs),
    /// Continue a run that was stopped or killed, with the same bits
    Resume(ResumeArgs),
    /// Estimate a run before it starts: number of base particles, memory, time, packings to make
    Check(SceneArgs),
    /// Apply every rule of filter practice to two sieve tables, without a walk
    Rules(RulesArgs),
    /// Show what voidwalk reads from a file of soils: tables, sizes, class
    Soil(SoilArgs),
    /// Write the built-in scene, commented, to start your own from
    Init {
        /// File to write [default: stdout]
        path: Option<PathBuf>,
        /// The plan of a campaign instead of a scene, every key explained
        #[arg(long, conflicts_with_all = ["json", "schema"])]
        plan: bool,
        /// Print every setting as JSON instead: type, default, allowed values, meaning
        #[arg(long, conflicts_with = "path")]
        json: bool,
        /// Print the JSON Schema of a file that the program writes instead, such as outcome for outcome.json
        #[arg(long, value_name = "NAME", conflicts_with_all = ["path", "json"], value_parser = schema_of)]
        schema: Option<String>,
    },
    /// Write example files to try the program with: sheets, a scene, a plan and a notebook
    Examples {
        /// Folder for the files: a new one, or one that has none of them
        folder: PathBuf,
    },
    /// Specify a filter for a base by the rules of practice, without a walk: steps, band, limits, products
    Design(DesignArgs),
    /// Find the boundaries of the model, for research: D15F/D85B from which it erodes, once and twice
    Boundary(BoundaryArgs),
    /// Walk the cases of a plan that are not finished, and compare them all
    Campaign(CampaignArgs),
    /// Pack a filter's grains from its gradation and density, and measure the constrictions
    Pack(PackArgs),
    /// Measure the constrictions of a packing of grains
    Constrictions(ConstrictionsArgs),
    /// Find the percolation threshold of cubic lattices of several sizes
    Percolation(PercolationArgs),
    /// Write report.html and the figures of a finished run folder again
    Report {
        /// The folder
        folder: PathBuf,
    },
    /// Write a finished folder's tables as arrays (.npz), grids (.vtu) and a workbook (.xlsx)
    Export {
        /// The folder
        folder: PathBuf,
    },
    /// Print the completion script of a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Write a manual page of every command
    Man {
        /// Folder for the pages
        folder: PathBuf,
    },
}

/// Which two soils.
#[derive(Debug, Args)]
pub struct RulesArgs {
    /// The base: a sieve table, as base.sieve in a scene; several soils are the curves of an envelope. With
    /// --each also a folder of tables
    pub base: PathBuf,
    /// The filter: a sieve table, as filter.sieve in a scene; several soils are the curves of an envelope.
    /// Several filters make one table
    #[arg(required = true, value_name = "FILTER")]
    pub filters: Vec<PathBuf>,
    /// Take every soil of BASE as a sample of its own, from a file, a workbook, an AGS file or a folder: one
    /// table, and the samples that govern
    #[arg(long, conflicts_with = "json")]
    pub each: bool,
    /// With --each or several filters: write the table into this new file
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// What the sheets do not say of the two.
    #[command(flatten)]
    pub settings: SettingOptions<OfRules>,
    /// Accept base and filter as named, even if they look exchanged
    #[arg(long)]
    pub as_given: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Which soils.
#[derive(Debug, Args)]
pub struct SoilArgs {
    /// Sieve tables: CSV, .xlsx, .ods or AGS4; FILE#NAME for one of several soils
    #[cfg_attr(feature = "xlsx", arg(required_unless_present = "template"))]
    #[cfg_attr(not(feature = "xlsx"), arg(required = true))]
    pub file: Option<PathBuf>,
    /// Write a workbook to fill in into this new file, and read nothing: a base and a filter as examples
    #[cfg(feature = "xlsx")]
    #[arg(long, value_name = "FILE.xlsx", conflicts_with_all = ["file", "d0_mm", "figure", "names",
          "json"])]
    pub template: Option<PathBuf>,
    /// Finest size of a table whose finest percent is not 0
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub d0_mm: Option<f64>,
    /// Draw the curves into this new file
    #[arg(long, value_name = "FILE.svg")]
    pub figure: Option<PathBuf>,
    /// Coarse sizes on the left of the figure, as in the United States
    #[arg(long, requires = "figure")]
    pub coarse_left: bool,
    /// Print the names alone, one a line, as a command line takes them: FILE#NAME of one of several soils
    #[arg(long, conflicts_with_all = ["d0_mm", "figure", "json"])]
    pub names: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// How to run it.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// Which scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Where the results go, and how it is walked.
    #[command(flatten)]
    pub results: ResultArgs,
}

/// How two sieve tables become a scene.
#[derive(Debug, Args)]
pub struct TableArgs {
    /// Density of the filter: loose, medium (or intermediate) or dense. The constrictions come from the
    /// library of packings. Without a density loose and dense are both walked
    #[arg(long, value_name = "WORD", value_parser = density)]
    pub density: Option<Density>,
    /// Pack the grains of this very filter and measure its constrictions [density: loose]
    #[arg(long)]
    pub pack: bool,
    /// A first look: five replicates
    #[arg(long)]
    pub quick: bool,
    /// Walk the base as sampled, not as filter practice regrades it (base.regrade)
    #[arg(long)]
    pub as_sampled: bool,
    /// Accept base and filter as named, even if they look exchanged
    #[arg(long)]
    pub as_given: bool,
    /// What is set in it besides, and how it is prepared.
    #[command(flatten)]
    pub set: SettingArgs,
}

/// Which two soils are judged, and where the answer goes.
#[derive(Debug, Args)]
pub struct JudgeArgs {
    /// The base soil: CSV, .xlsx, .ods or AGS4; FILE#NAME for one of several soils. With --each also a
    /// folder of tables
    pub base: PathBuf,
    /// The filter, in the same form. Several filters are walked one by one into one table, in --out
    /// [default: voidwalk-batch]
    #[arg(required = true, value_name = "FILTER")]
    pub filters: Vec<PathBuf>,
    /// Take every soil of BASE as a sample of its own: a first look at each, the three samples that govern
    /// each filter in full, one table in --out [default: voidwalk-batch]. The same command continues what
    /// was stopped or killed; a folder with other samples or filters is refused. With --quick nothing is
    /// walked in full
    #[arg(long)]
    #[cfg_attr(feature = "xlsx", arg(conflicts_with = "xlsx"))]
    pub each: bool,
    /// With --each: walk the three samples that govern each filter, and no other
    #[arg(long, requires = "each", conflicts_with = "quick")]
    pub governing: bool,
    /// How the two become a scene.
    #[command(flatten)]
    pub tables: TableArgs,
    /// Where the results go, and how it is walked.
    #[command(flatten)]
    pub results: ResultArgs,
}

/// Where the page is, and how its jobs are walked.
#[cfg(feature = "serve")]
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Port of the loopback address [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Folder for sheets and results: new, empty, or from an earlier session [default: a new one,
    /// voidwalk-serve, voidwalk-serve-2, ...]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Folder that keeps packings, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub packings: PathBuf,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
}

/// Which run, and how it continues.
#[derive(Debug, Args)]
pub struct ResumeArgs {
    /// The run's folder
    pub folder: PathBuf,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// Which verdicts are not accepted.
    #[command(flatten)]
    pub accept: AcceptArgs,
    /// How it is walked.
    #[command(flatten)]
    pub walk: WalkArgs,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}
