//! Arguments and what they mean to a user.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};

use super::values::{
    assignment, bracket, decide, density, facets, lattice_size, millimetres, seed, target_error, threads,
    time,
};
use crate::campaign::CasePart;
use crate::constrictions::{DEFAULT_MERGE_OVERLAP, Facets};
use crate::packing::{CellOption, LengthUnit};
use crate::run::CheckpointInterval;
use crate::run::machine::bytes_from_words;
use crate::scene::Density;
use crate::study::design::Thickness;
use crate::study::precision::Tier;

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
    /// Walk a scene's base through its filter, and judge
    Run(RunArgs),
    /// Judge a base and a filter by their two sieve tables: pack or guess, walk, and write the page
    Judge(JudgeArgs),
    /// Compare filters on one base, bases on one filter, or scenes: verdicts and differences
    Compare(CompareArgs),
    /// Open a page in the browser of this machine: drop two sheets, see curves, rules, walks and verdict
    #[cfg(feature = "serve")]
    Serve(ServeArgs),
    /// Continue a run that was stopped or killed, with the same bits
    Resume(ResumeArgs),
    /// Say what a run would do: number of base particles, memory, parts that are needed
    Check(SceneArgs),
    /// Apply every rule of filter practice to two sieve tables, without a walk
    Rules(RulesArgs),
    /// Show what is understood of a file of soils: tables, sizes, class
    Soil(SoilArgs),
    /// Write the built-in scene, commented, as a start for your own
    Init {
        /// File to write; the scene goes to stdout without one
        path: Option<PathBuf>,
        /// Print every setting as JSON instead: type, default, what is allowed, what it means
        #[arg(long, conflicts_with = "path")]
        json: bool,
    },
    /// Find how coarse a filter may be for a base: where erosion begins, where it continues, and the band
    Design(DesignArgs),
    /// Walk every case of a plan that is not done, and compare them
    Campaign(CampaignArgs),
    /// Pack a filter's grains from its gradation and density, and measure the constrictions
    Pack(PackArgs),
    /// Measure the constrictions of a packing of grains
    Constrictions(ConstrictionsArgs),
    /// Find the percolation threshold of cubic lattices of several sizes
    Percolation(PercolationArgs),
    /// Measure error against run time for a scene: exact answers, scatter, bias of settings, wrong verdicts,
    /// scaling, packings
    Precision(PrecisionArgs),
    /// Write report.html and the figures of a finished run folder again
    Report {
        /// The folder
        folder: PathBuf,
    },
    /// Write the tables of a finished folder as arrays for NumPy (.npz) and grids for ParaView (.vtu)
    Export {
        /// The folder
        folder: PathBuf,
    },
    /// Print a script by which a shell completes commands and options
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
    /// The base: a sieve table, as base.sieve in a scene; several soils in it are the curves of its envelope
    pub base: PathBuf,
    /// The filter: a sieve table, as filter.sieve in a scene; several soils in it are the curves of its
    /// envelope
    pub filter: PathBuf,
    /// The base is dispersive: stricter limits where it has many fines
    #[arg(long)]
    pub dispersive: bool,
    /// Width of an open joint beside the base: the probability of continuing erosion into it
    #[arg(long, value_name = "MM", value_parser = millimetres, allow_hyphen_values = true)]
    pub joint_mm: Option<f64>,
    /// Take base and filter as they are given, though they look exchanged
    #[arg(long)]
    pub as_given: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// How a walk is done.
#[derive(Debug, Args)]
pub struct WalkArgs {
    /// Worker threads [default: one per core]; they change no bit of the result
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Save the walks this often, as 10min or 50increments, so that a run that is killed continues from
    /// there; a stop (Ctrl-C, SIGTERM) always saves them [default: 10min; for a run that is continued,
    /// what it was told first]
    #[arg(long, value_name = "TIME")]
    pub checkpoint_every: Option<CheckpointInterval>,
    /// No progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
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
    /// How it is walked.
    #[command(flatten)]
    pub walk: WalkArgs,
}

/// Which scene.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Scene (TOML); without one the built-in scene: the loose Cu 1.5 filter, a base with Cu 1.5 at Dc5
    pub scene: Option<PathBuf>,
    /// What is set in it, and how it is prepared.
    #[command(flatten)]
    pub set: SettingArgs,
}

/// What is set in a scene, and how it is prepared.
#[derive(Debug, Args)]
pub struct SettingArgs {
    /// Replace a setting, as in --set base.cu=3; can be given again
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub settings: Vec<String>,
    /// Seed; the same seed gives the same bits
    #[arg(long, value_name = "S", value_parser = seed, allow_hyphen_values = true)]
    pub seed: Option<u64>,
    /// Add replicates until the 95 % interval of the eroded mass reaches no further than this to either side,
    /// as 0.1pp (percentage points)
    #[arg(long, value_name = "ERROR", value_parser = target_error, allow_hyphen_values = true)]
    pub target_error: Option<f64>,
    /// Add replicates until the verdict is right with this probability, as 99.9%
    #[arg(long, value_name = "PERCENT", value_parser = decide, allow_hyphen_values = true)]
    pub decide: Option<f64>,
    /// Folder in which packings that scenes ask for are kept, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub packings: PathBuf,
    /// Memory that the walks may take, as 4GB: base particles that do not fit live in files in the run
    /// folder, mapped into memory [default: 80 % of what is available]; it changes no bit of the result
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Which soils.
#[derive(Debug, Args)]
pub struct SoilArgs {
    /// Sieve tables: CSV, .xlsx, .ods or AGS4; FILE#NAME for one of several soils
    pub file: PathBuf,
    /// Where an open finest tail ends (mm)
    #[arg(long, value_name = "MM")]
    pub d0_mm: Option<f64>,
    /// Draw their curves into this file, which is not there yet
    #[arg(long, value_name = "FILE.svg")]
    pub figure: Option<PathBuf>,
    /// Coarse sizes on the left of the figure, as in the United States
    #[arg(long, requires = "figure")]
    pub coarse_left: bool,
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
    /// How densely the filter lies, loose, medium (or intermediate) or dense: its grains are packed so.
    /// Without it the constrictions are guessed from the gradation, and the verdict is that of the whole
    /// range of the guess
    #[arg(long, value_name = "WORD", value_parser = density)]
    pub density: Option<Density>,
    /// A first look: four replicates, and no studies of the amount of base and of the thickness
    #[arg(long)]
    pub quick: bool,
    /// Walk the base as it was sampled: without it, as filter practice regrades it (base.regrade)
    #[arg(long)]
    pub as_sampled: bool,
    /// Take base and filter as they are given, though they look exchanged
    #[arg(long)]
    pub as_given: bool,
    /// The base is dispersive: stricter limits where it has many fines (base.dispersive)
    #[arg(long)]
    pub dispersive: bool,
    /// Width of an open joint beside the base: the probability of continuing erosion into it
    /// (filter.joint_mm)
    #[arg(long, value_name = "MM", value_parser = millimetres, allow_hyphen_values = true)]
    pub joint_mm: Option<f64>,
    /// What is set in it besides, and how it is prepared.
    #[command(flatten)]
    pub set: SettingArgs,
}

/// Which two soils are judged, and where the answer goes.
#[derive(Debug, Args)]
pub struct JudgeArgs {
    /// The base soil: CSV, .xlsx, .ods or AGS4; FILE#NAME for one of several soils
    pub base: PathBuf,
    /// The filter, likewise
    pub filter: PathBuf,
    /// How the two become a scene.
    #[command(flatten)]
    pub tables: TableArgs,
    /// Where the results go, and how it is walked.
    #[command(flatten)]
    pub results: ResultArgs,
}

/// What is compared, and where the answer goes.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Two to six filters with --base, bases with --filter, or scenes (TOML) with neither
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The base that all filters are to hold: CSV, .xlsx, .ods or AGS4; FILE#NAME for one of several soils
    #[arg(long, value_name = "FILE", conflicts_with = "filter")]
    pub base: Option<PathBuf>,
    /// The filter that is to hold all bases, likewise
    #[arg(long, value_name = "FILE")]
    pub filter: Option<PathBuf>,
    /// How tables become scenes.
    #[command(flatten)]
    pub tables: TableArgs,
    /// Folder for the results: new, empty, or with a comparison that was stopped, which continues
    #[arg(long, value_name = "DIR", default_value = "voidwalk-compare")]
    pub out: PathBuf,
    /// Replace an earlier comparison in --out; cases that are asked for again are kept
    #[arg(long)]
    pub overwrite: bool,
    /// How it is walked.
    #[command(flatten)]
    pub walk: WalkArgs,
}

/// Where the page is, and how its jobs are walked.
#[cfg(feature = "serve")]
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Port of the loopback address [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Folder for sheets and results: new, empty, or of an earlier start [default: a new one, voidwalk-serve,
    /// voidwalk-serve-2, ...]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Folder in which packings of filters are kept, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub packings: PathBuf,
    /// Memory that the walks may take, as 4GB: base particles that do not fit live in files in the run
    /// folder, mapped into memory [default: 80 % of what is available]; it changes no bit of the result
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// Worker threads [default: one per core]; they change no bit of the result
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
}

/// Which run, and how it continues.
#[derive(Debug, Args)]
pub struct ResumeArgs {
    /// The run's folder
    pub folder: PathBuf,
    /// Memory that the walks may take, as 4GB: base particles that do not fit live in files in the run
    /// folder, mapped into memory [default: 80 % of what is available]; it changes no bit of the result
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// How it is walked.
    #[command(flatten)]
    pub walk: WalkArgs,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Which base, and what shape of filter.
#[derive(Debug, Args)]
pub struct DesignArgs {
    /// The base: a sieve table, as base.sieve in a scene (FILE#NAME for one of several soils); without one
    /// the settings say it, as --set base.cu=3
    pub base: Option<PathBuf>,
    /// The filter's shape, whose size is searched: a sieve table, a Cu, or a shipped curve's name [default:
    /// shire2016-cu1.5-loose, or what --set says]
    #[arg(long, value_name = "SHAPE", allow_hyphen_values = true)]
    pub filter: Option<String>,
    /// How densely it is packed: dense, medium (or intermediate) or loose, friction=F, or estimate=D (a
    /// relative density, without a packing); can be given again [default for a table or a Cu: loose]
    #[arg(long = "density", value_name = "DENSITY", value_delimiter = ',', allow_hyphen_values = true)]
    pub densities: Vec<String>,
    /// How thick the filter is: 60layers, 500mm or 75D50F; can be given again [default: 60layers]
    #[arg(long = "thickness", value_name = "THICKNESS", value_delimiter = ',', allow_hyphen_values = true)]
    pub thicknesses: Vec<Thickness>,
    /// Walk the base as it was sampled: without it, as filter practice regrades it (base.regrade); the
    /// base of
    /// --inverse, which has no size of its own, is always taken so
    #[arg(long)]
    pub as_sampled: bool,
    /// Take base and filter as they are given, though they look exchanged
    #[arg(long)]
    pub as_given: bool,
    /// Find the finest base that the filter holds instead: the filter is as large as it is, the base's shape
    /// is scaled
    #[arg(long)]
    pub inverse: bool,
    /// Set a key of a scene, as --set filter.grains_per_void=0.43 or --set replicates=20; can be given again
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub settings: Vec<String>,
    /// Seed; the same seed gives the same bits
    #[arg(long, value_name = "S", value_parser = seed, allow_hyphen_values = true)]
    pub seed: Option<u64>,
    /// D15F/D85B between which boundaries are searched, outwards to steps of 8 %; beside an end a boundary
    /// can go unseen
    #[arg(long, value_name = "LOW,HIGH", default_value = "0.5,100", value_parser = bracket,
          allow_hyphen_values = true)]
    pub bracket: (f64, f64),
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-design")]
    pub out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Folder in which packings are kept, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub packings: PathBuf,
    /// Memory that the walks may take, as 4GB [default: 80 % of what is available]; it changes no bit of the
    /// result
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// Worker threads [default: one per core]; they change no bit of the result
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Print design.json
    #[arg(long)]
    pub json: bool,
    /// No progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Which plan, and where its results go.
#[derive(Debug, Args)]
pub struct CampaignArgs {
    /// Plan (TOML): factors that are crossed, and single cases
    pub plan: PathBuf,
    /// Folder for the results: new, empty, or with cases of this plan, which are not walked again. Several
    /// processes may work on one folder
    #[arg(long, value_name = "DIR", default_value = "voidwalk-campaign")]
    pub out: PathBuf,
    /// Walk this case only; the ledger is left to a call without it
    #[arg(long, value_name = "NAME", group = "part")]
    pub case: Option<String>,
    /// Print the names of the cases and do nothing
    #[arg(long, group = "part")]
    pub list: bool,
    /// Walk nothing: write job scripts for Slurm into --out, for the cases that are not done. Processors of a
    /// task: --threads [default: 4]; its memory and time are estimated
    #[arg(long, group = "part")]
    pub slurm: bool,
    /// With --slurm: bundle the cases into this many tasks [default: so that a task takes some ten minutes]
    #[arg(long, value_name = "N", requires = "slurm",
          value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub tasks: Option<u16>,
    /// Walk nothing: write the ledger, the table and the page of a campaign whose cases are all done; refused
    /// while one is missing
    #[arg(long, group = "part")]
    pub collect: bool,
    /// Walk the cases of task N of a list that --slurm wrote
    #[arg(long, value_name = "FILE:N", group = "part", value_parser = CasePart::task)]
    pub task: Option<CasePart>,
    /// Walk nothing: make the N-th packing that the plan needs
    #[arg(long, value_name = "N", group = "part", value_parser = clap::value_parser!(u64).range(1..))]
    pub make_packing: Option<u64>,
    /// Folder in which the packings of filters are kept [default: packings in --out]
    #[arg(long, value_name = "DIR")]
    pub packings: Option<PathBuf>,
    /// Memory that the walks may take, as 4GB: base particles that do not fit live in files in the run
    /// folder, mapped into memory [default: 80 % of what is available]; it changes no bit of the result
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// How it is walked.
    #[command(flatten)]
    pub walk: WalkArgs,
}

/// Which filter, and where its packing goes.
#[derive(Debug, Args)]
pub struct PackArgs {
    /// The filter (TOML): [filter] with cu or sieve, d0_mm, and density or friction; settings of [packing] as
    /// wanted. A scene will do
    pub filter: PathBuf,
    /// Replace a setting, as in --set packing.grains=20000; can be given again
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub settings: Vec<String>,
    /// Seed of the grains' sizes and places
    #[arg(long, value_name = "S", value_parser = seed, allow_hyphen_values = true)]
    pub seed: Option<u64>,
    /// Folder for the packing: new, empty, or with a packing that was stopped, which continues [default: one
    /// of its own in voidwalk-packings]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Begin anew where --out holds a packing
    #[arg(long)]
    pub overwrite: bool,
    /// Worker threads [default: one per core]; they change no bit of the result
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Save the state this often, so that a packing that is killed continues from there
    #[arg(long, value_name = "TIME", default_value = "1min", value_parser = time)]
    pub checkpoint_every: Duration,
    /// Print packing.json
    #[arg(long)]
    pub json: bool,
    /// No progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Which packing, and how its voids are told apart.
#[derive(Debug, Args)]
pub struct ConstrictionsArgs {
    /// Grains: CSV (x_mm,y_mm,z_mm,diameter_mm after `# cell_mm = Lx, Ly, Lz` or `# cell = none`; or points
    /// of ParaView and MFIX by their names), a text dump of LAMMPS or LIGGGHTS, Yade's export.text,
    /// MercuryDPM's .data
    pub packing: PathBuf,
    /// Unit of the file's lengths, where it does not say it: m, cm, mm, um or nm
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<LengthUnit>,
    /// Boundaries, where the file does not say them, none, bounds or Lx,Ly,Lz: none for free ones; Lx,Ly,Lz
    /// for a periodic cell with a corner at the origin, in the file's unit; bounds for one between the bounds
    /// in the file
    #[arg(long, value_name = "CELL")]
    pub cell: Option<CellOption>,
    /// Overlap of two inscribed spheres from which their tetrahedra are one void
    #[arg(long, value_name = "F", default_value_t = DEFAULT_MERGE_OVERLAP)]
    pub merge_overlap: f64,
    /// Which facets between voids the curve counts, all or on-both-hulls: the latter are those on the convex
    /// hulls of the grains of both voids
    #[arg(long, value_name = "WHICH", default_value = "all", value_parser = facets)]
    pub facets: Facets,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-constrictions")]
    pub out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Print constrictions.json
    #[arg(long)]
    pub json: bool,
}

/// Which lattices, and how many.
#[derive(Debug, Args)]
pub struct PercolationArgs {
    /// Voids along each side, one lattice size after another; of a lattice that is no cube along x, y and z,
    /// as 40x40x60
    #[arg(long, value_name = "L,L,...", value_delimiter = ',', default_value = "10,20,40,80,160",
          value_parser = lattice_size, allow_hyphen_values = true)]
    pub sizes: Vec<[u32; 3]>,
    /// Realisations of each size
    #[arg(long, value_name = "N", default_value_t = 100,
          value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub realisations: u64,
    /// Seed; the same seed gives the same bits
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_hyphen_values = true)]
    pub seed: u64,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-percolation")]
    pub out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Worker threads [default: one per core]; they change no bit of the result
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Print percolation.json
    #[arg(long)]
    pub json: bool,
    /// No summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Which scene, and how long.
#[derive(Debug, Args)]
pub struct PrecisionArgs {
    /// Which scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-precision")]
    pub out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Tiers to measure: exact, sampling, bias, decision, scaling, packing [default: all]
    #[arg(long = "tier", value_name = "NAME", num_args = 1..)]
    pub tiers: Vec<Tier>,
    /// Processor time to spend, all cores together. It decides how many replicates are walked, by counted
    /// work and not by the clock: the same seed and budget give the same errors everywhere
    #[arg(long, value_name = "TIME", default_value = "4min", value_parser = time)]
    pub budget: Duration,
    /// Runs side by side [default: one per core]; they change no bit of the result
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// No progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
}
