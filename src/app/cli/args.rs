//! Arguments of the command line, with their meaning for a user.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};

use super::options::{
    AcceptArgs, OfBoundary, OfPacking, OfRules, OfSpecification, ResultArgs, SceneArgs, SettingArgs,
    SettingOptions, WalkArgs, density, facets, lattice_size, length, schema_of, seed, threads, time,
};
use crate::cases::CasePart;
use crate::run::machine::bytes_from_words;
use crate::scene::Density;
use crate::study::boundary::ThicknessList;
use voidwalk_core::constrictions::{DEFAULT_MERGE_OVERLAP, Facets};
use voidwalk_core::packing::{CellOption, LengthUnit};
use voidwalk_practice::design::SieveSeries;

/// Will this filter hold this soil? A random-walk network model of base-filter combinations.
#[derive(Parser)]
#[command(name = "voidwalk", version, about, propagate_version = true)]
pub(crate) struct Arguments {
    /// Command to run.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Commands of the program.
#[derive(Subcommand)]
pub(crate) enum Command {
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

#[derive(Args)]
pub(crate) struct RulesArgs {
    /// The base: a sieve table, as base.sieve in a scene; several soils are the curves of an envelope. With
    /// --each also a folder of tables
    pub(crate) base: PathBuf,
    /// The filter: a sieve table, as filter.sieve in a scene; several soils are the curves of an envelope.
    /// Several filters make one table
    #[arg(required = true, value_name = "FILTER")]
    pub(crate) filters: Vec<PathBuf>,
    /// Take every soil of BASE as a sample of its own, from a file, a workbook, an AGS file or a folder: one
    /// table, and the samples that govern
    #[arg(long, conflicts_with = "json")]
    pub(crate) each: bool,
    /// With --each or several filters: write the table into this new file
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) settings: SettingOptions<OfRules>,
    /// Accept base and filter as named, even if they look exchanged
    #[arg(long)]
    pub(crate) as_given: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct SoilArgs {
    /// Sieve tables: CSV, .xlsx, .ods or AGS4; FILE#NAME for one of several soils
    #[cfg_attr(feature = "xlsx", arg(required_unless_present = "template"))]
    #[cfg_attr(not(feature = "xlsx"), arg(required = true))]
    pub(crate) file: Option<PathBuf>,
    /// Write a workbook to fill in into this new file, and read nothing: a base and a filter as examples
    #[cfg(feature = "xlsx")]
    #[arg(long, value_name = "FILE.xlsx", conflicts_with_all = ["file", "d0_mm", "figure", "names",
          "json"])]
    pub(crate) template: Option<PathBuf>,
    /// Finest size of a table whose finest percent is not 0
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub(crate) d0_mm: Option<f64>,
    /// Draw the curves into this new file
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// Coarse sizes on the left of the figure, as in the United States
    #[arg(long, requires = "figure")]
    pub(crate) coarse_left: bool,
    /// Print the names alone, one a line, as a command line takes them: FILE#NAME of one of several soils
    #[arg(long, conflicts_with_all = ["d0_mm", "figure", "json"])]
    pub(crate) names: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) results: ResultArgs,
}

#[derive(Args)]
pub(crate) struct TableArgs {
    /// Density of the filter: loose, medium (or intermediate) or dense. The constrictions come from the
    /// library of packings. Without a density loose and dense are both walked
    #[arg(long, value_name = "WORD", value_parser = density)]
    pub(crate) density: Option<Density>,
    /// Pack the grains of this very filter and measure its constrictions [density: loose]
    #[arg(long)]
    pub(crate) pack: bool,
    /// A first look: five replicates
    #[arg(long)]
    pub(crate) quick: bool,
    /// Walk the base as sampled, not as filter practice regrades it (base.regrade)
    #[arg(long)]
    pub(crate) as_sampled: bool,
    /// Accept base and filter as named, even if they look exchanged
    #[arg(long)]
    pub(crate) as_given: bool,
    #[command(flatten)]
    pub(crate) set: SettingArgs,
}

#[derive(Args)]
pub(crate) struct JudgeArgs {
    /// The base soil: CSV, .xlsx, .ods or AGS4; FILE#NAME for one of several soils. With --each also a
    /// folder of tables
    pub(crate) base: PathBuf,
    /// The filter, in the same form. Several filters are walked one by one into one table, in --out
    /// [default: voidwalk-batch]
    #[arg(required = true, value_name = "FILTER")]
    pub(crate) filters: Vec<PathBuf>,
    /// Take every soil of BASE as a sample of its own: a first look at each, the three samples that govern
    /// each filter in full, one table in --out [default: voidwalk-batch]. The same command continues what
    /// was stopped or killed; a folder with other samples or filters is refused. With --quick nothing is
    /// walked in full
    #[arg(long)]
    #[cfg_attr(feature = "xlsx", arg(conflicts_with = "xlsx"))]
    pub(crate) each: bool,
    /// With --each: walk the three samples that govern each filter, and no other
    #[arg(long, requires = "each", conflicts_with = "quick")]
    pub(crate) governing: bool,
    #[command(flatten)]
    pub(crate) tables: TableArgs,
    #[command(flatten)]
    pub(crate) results: ResultArgs,
}

#[cfg(feature = "serve")]
#[derive(Args)]
pub(crate) struct ServeArgs {
    /// Port of the loopback address [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Folder for sheets and results: new, empty, or from an earlier session [default: a new one,
    /// voidwalk-serve, voidwalk-serve-2, ...]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Folder that keeps packings, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub(crate) packings: PathBuf,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub(crate) memory: Option<u64>,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub(crate) threads: Option<usize>,
}

#[derive(Args)]
pub(crate) struct ResumeArgs {
    /// The run's folder
    pub(crate) folder: PathBuf,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub(crate) memory: Option<u64>,
    #[command(flatten)]
    pub(crate) accept: AcceptArgs,
    #[command(flatten)]
    pub(crate) walk: WalkArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct DesignArgs {
    /// The base: sieve tables (FILE#NAME for one of several soils); several soils are the curves of an
    /// envelope; with --each also folders of tables
    #[arg(value_name = "BASE", required = true)]
    pub(crate) bases: Vec<PathBuf>,
    /// Take every soil of BASE as a sample of its own, from files, workbooks, AGS files or folders: what
    /// practice specifies for each, one table and the samples that govern
    #[arg(long)]
    pub(crate) each: bool,
    /// Place the band at the finer end of what is allowed: its maximum D15F is lowered, not its minimum
    /// raised
    #[arg(long, conflicts_with = "each")]
    pub(crate) finer: bool,
    /// Sieves at which the limits are stated: us (ASTM E11) or iso (mm)
    #[arg(long, value_name = "SERIES", default_value = "us")]
    pub(crate) sieves: SieveSeries,
    #[command(flatten)]
    pub(crate) settings: SettingOptions<OfSpecification>,
    /// Folder for the results [default: voidwalk-specification; with --each voidwalk-designs]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print specification.json; with --each designs.json
    #[arg(long)]
    pub(crate) json: bool,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct BoundaryArgs {
    /// The base: a sieve table, as base.sieve in a scene (FILE#NAME for one of several soils) [default: from
    /// the settings, for example --set base.cu=3]
    pub(crate) base: Option<PathBuf>,
    /// The shape of the filter, whose size is searched: a sieve table, a Cu, or a shipped curve [default:
    /// shire2016-cu1.5-loose, or from --set]
    #[arg(long, value_name = "SHAPE", allow_hyphen_values = true)]
    pub(crate) filter: Option<String>,
    /// Density of the filter: dense, medium (or intermediate) or loose, from the library of packings, or
    /// unknown, for anything from loose to dense; friction=F packs the grains with that friction, estimate=D
    /// guesses the constrictions at that relative density; can be repeated [default for a table or a Cu:
    /// unknown]
    #[arg(long = "density", value_name = "DENSITY", value_delimiter = ',', allow_hyphen_values = true)]
    pub(crate) densities: Vec<String>,
    /// Pack the grains of this very filter and measure its constrictions [density: loose]
    #[arg(long)]
    pub(crate) pack: bool,
    /// Thickness of the filter: 60layers, 500mm, 24in, 2ft or 75D50F; can be repeated, or listed with commas
    /// [default: 60layers]
    #[arg(long = "thickness", value_name = "THICKNESS", allow_hyphen_values = true)]
    pub(crate) thicknesses: Vec<ThicknessList>,
    /// Walk the base as sampled, not as filter practice regrades it (base.regrade)
    #[arg(long)]
    pub(crate) as_sampled: bool,
    /// Accept base and filter as named, even if they look exchanged
    #[arg(long)]
    pub(crate) as_given: bool,
    #[command(flatten)]
    pub(crate) settings: SettingOptions<OfBoundary>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-boundary")]
    pub(crate) out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Folder that keeps packings, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub(crate) packings: PathBuf,
    /// Memory limit, such as 4GB; the result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub(crate) memory: Option<u64>,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub(crate) threads: Option<usize>,
    /// Print boundary.json
    #[arg(long)]
    pub(crate) json: bool,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct CampaignArgs {
    /// Plan (TOML): crossed factors, and single cases
    pub(crate) plan: PathBuf,
    /// Folder for the results: new, empty, or with finished cases of this plan. Several processes may share
    /// it
    #[arg(long, value_name = "DIR", default_value = "voidwalk-campaign")]
    pub(crate) out: PathBuf,
    /// Walk this case only, without the ledger
    #[arg(long, value_name = "NAME", group = "part")]
    pub(crate) case: Option<String>,
    /// Print the names of the cases and do nothing
    #[arg(long, group = "part")]
    pub(crate) list: bool,
    /// Walk nothing: write Slurm job scripts for the unfinished cases into --out. Processors of a task:
    /// --threads [default: 4]; memory and time are estimated
    #[arg(long, group = "part")]
    pub(crate) slurm: bool,
    /// With --slurm: number of tasks [default: enough that each takes about ten minutes]
    #[arg(long, value_name = "N", requires = "slurm",
          value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(crate) tasks: Option<u16>,
    /// Walk nothing: write ledger, table and page of a campaign whose cases are all finished
    #[arg(long, group = "part")]
    pub(crate) collect: bool,
    /// Walk the cases of task N of a list that --slurm wrote
    #[arg(long, value_name = "FILE:N", group = "part", value_parser = CasePart::task)]
    pub(crate) task: Option<CasePart>,
    /// Walk nothing: make the N-th packing that the plan needs
    #[arg(long, value_name = "N", group = "part", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) make_packing: Option<u64>,
    /// Folder that keeps packings [default: packings in --out]
    #[arg(long, value_name = "DIR")]
    pub(crate) packings: Option<PathBuf>,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub(crate) memory: Option<u64>,
    #[command(flatten)]
    pub(crate) walk: WalkArgs,
}

#[derive(Args)]
pub(crate) struct PackArgs {
    /// The filter (TOML): [filter] with cu or sieve, d0_mm, and density or friction; optionally [packing]. A
    /// scene works too
    pub(crate) filter: PathBuf,
    #[command(flatten)]
    pub(crate) settings: SettingOptions<OfPacking>,
    /// Folder for the packing: new, empty, or with a stopped packing, which continues [default: one of its
    /// own in voidwalk-packings]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace an earlier packing in --out
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub(crate) threads: Option<usize>,
    /// Save a checkpoint this often
    #[arg(long, value_name = "TIME", default_value = "1min", value_parser = time)]
    pub(crate) checkpoint_every: Duration,
    /// Print packing.json
    #[arg(long)]
    pub(crate) json: bool,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct ConstrictionsArgs {
    /// Grains: CSV (x_mm,y_mm,z_mm,diameter_mm after `# cell_mm = Lx, Ly, Lz` or `# cell = none`; or points
    /// of ParaView and MFIX by their names), a text dump of LAMMPS or LIGGGHTS, Yade's export.text,
    /// MercuryDPM's .data, or points of VTK with a diameter or radius (.vtk, .vtp, .vtu); each also by gzip
    pub(crate) packing: PathBuf,
    /// Unit of lengths, if the file does not state it: m, cm, mm, um or nm
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<LengthUnit>,
    /// Boundaries, if the file does not state them: none (free), Lx,Ly,Lz (a periodic cell with a corner at
    /// the origin, in the file's unit) or bounds (a periodic cell between the bounds in the file)
    #[arg(long, value_name = "CELL")]
    pub(crate) cell: Option<CellOption>,
    /// Overlap of two inscribed spheres above which their tetrahedra form one void
    #[arg(long, value_name = "F", default_value_t = DEFAULT_MERGE_OVERLAP)]
    pub(crate) merge_overlap: f64,
    /// Facets counted in the curve: all, or on-both-hulls (on the convex hulls of the grains of both voids)
    #[arg(long, value_name = "WHICH", default_value = "all", value_parser = facets)]
    pub(crate) facets: Facets,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-constrictions")]
    pub(crate) out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print constrictions.json
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct PercolationArgs {
    /// Lattice sizes: voids along each side, or along x, y and z, such as 40x40x60
    #[arg(long, value_name = "L,L,...", value_delimiter = ',', default_value = "10,20,40,80,160",
          value_parser = lattice_size, allow_hyphen_values = true)]
    pub(crate) sizes: Vec<[u32; 3]>,
    /// Realisations of each size
    #[arg(long, value_name = "N", default_value_t = 100,
          value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(crate) realisations: u64,
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-percolation")]
    pub(crate) out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub(crate) threads: Option<usize>,
    /// Print percolation.json
    #[arg(long)]
    pub(crate) json: bool,
    /// Print no summary
    #[arg(long, short)]
    pub(crate) quiet: bool,
}
