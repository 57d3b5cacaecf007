//! Arguments of the commands that design, plan, pack and study.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::setting_options::{OfBoundary, OfPacking, OfSpecification, SettingOptions};
use super::shared_args::WalkArgs;
use super::values::{facets, lattice_size, seed, threads, time};
use crate::cases::CasePart;
use crate::run::machine::bytes_from_words;
use crate::study::boundary::ThicknessList;
use voidwalk_core::constrictions::{DEFAULT_MERGE_OVERLAP, Facets};
use voidwalk_core::packing::{CellOption, LengthUnit};
use voidwalk_practice::design::SieveSeries;

/// For which base, and where the specification goes.
#[derive(Debug, Args)]
pub struct DesignArgs {
    /// The base: sieve tables (FILE#NAME for one of several soils); several soils are the curves of an
    /// envelope; with --each also folders of tables
    #[arg(value_name = "BASE", required = true)]
    pub bases: Vec<PathBuf>,
    /// Take every soil of BASE as a sample of its own, from files, workbooks, AGS files or folders: what
    /// practice specifies for each, one table and the samples that govern
    #[arg(long)]
    pub each: bool,
    /// Place the band at the finer end of what is allowed: its maximum D15F is lowered, not its minimum
    /// raised
    #[arg(long, conflicts_with = "each")]
    pub finer: bool,
    /// Sieves at which the limits are stated: us (ASTM E11) or iso (mm)
    #[arg(long, value_name = "SERIES", default_value = "us")]
    pub sieves: SieveSeries,
    /// Settings of the base and of the page.
    #[command(flatten)]
    pub settings: SettingOptions<OfSpecification>,
    /// Folder for the results [default: voidwalk-specification; with --each voidwalk-designs]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Print specification.json; with --each designs.json
    #[arg(long)]
    pub json: bool,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Which base, and what shape of filter.
#[derive(Debug, Args)]
pub struct BoundaryArgs {
    /// The base: a sieve table, as base.sieve in a scene (FILE#NAME for one of several soils) [default: from
    /// the settings, for example --set base.cu=3]
    pub base: Option<PathBuf>,
    /// The shape of the filter, whose size is searched: a sieve table, a Cu, or a shipped curve [default:
    /// shire2016-cu1.5-loose, or from --set]
    #[arg(long, value_name = "SHAPE", allow_hyphen_values = true)]
    pub filter: Option<String>,
    /// Density of the filter: dense, medium (or intermediate) or loose, from the library of packings, or
    /// unknown, for anything from loose to dense; friction=F packs the grains with that friction, estimate=D
    /// guesses the constrictions at that relative density; can be repeated [default for a table or a Cu:
    /// unknown]
    #[arg(long = "density", value_name = "DENSITY", value_delimiter = ',', allow_hyphen_values = true)]
    pub densities: Vec<String>,
    /// Pack the grains of this very filter and measure its constrictions [density: loose]
    #[arg(long)]
    pub pack: bool,
    /// Thickness of the filter: 60layers, 500mm, 24in, 2ft or 75D50F; can be repeated, or listed with commas
    /// [default: 60layers]
    #[arg(long = "thickness", value_name = "THICKNESS", allow_hyphen_values = true)]
    pub thicknesses: Vec<ThicknessList>,
    /// Walk the base as sampled, not as filter practice regrades it (base.regrade)
    #[arg(long)]
    pub as_sampled: bool,
    /// Accept base and filter as named, even if they look exchanged
    #[arg(long)]
    pub as_given: bool,
    /// Settings of the walks.
    #[command(flatten)]
    pub settings: SettingOptions<OfBoundary>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-boundary")]
    pub out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Folder that keeps packings, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub packings: PathBuf,
    /// Memory limit, such as 4GB; the result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Print boundary.json
    #[arg(long)]
    pub json: bool,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Which plan, and where its results go.
#[derive(Debug, Args)]
pub struct CampaignArgs {
    /// Plan (TOML): crossed factors, and single cases
    pub plan: PathBuf,
    /// Folder for the results: new, empty, or with finished cases of this plan. Several processes may share
    /// it
    #[arg(long, value_name = "DIR", default_value = "voidwalk-campaign")]
    pub out: PathBuf,
    /// Walk this case only, without the ledger
    #[arg(long, value_name = "NAME", group = "part")]
    pub case: Option<String>,
    /// Print the names of the cases and do nothing
    #[arg(long, group = "part")]
    pub list: bool,
    /// Walk nothing: write Slurm job scripts for the unfinished cases into --out. Processors of a task:
    /// --threads [default: 4]; memory and time are estimated
    #[arg(long, group = "part")]
    pub slurm: bool,
    /// With --slurm: number of tasks [default: enough that each takes about ten minutes]
    #[arg(long, value_name = "N", requires = "slurm",
          value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub tasks: Option<u16>,
    /// Walk nothing: write ledger, table and page of a campaign whose cases are all finished
    #[arg(long, group = "part")]
    pub collect: bool,
    /// Walk the cases of task N of a list that --slurm wrote
    #[arg(long, value_name = "FILE:N", group = "part", value_parser = CasePart::task)]
    pub task: Option<CasePart>,
    /// Walk nothing: make the N-th packing that the plan needs
    #[arg(long, value_name = "N", group = "part", value_parser = clap::value_parser!(u64).range(1..))]
    pub make_packing: Option<u64>,
    /// Folder that keeps packings [default: packings in --out]
    #[arg(long, value_name = "DIR")]
    pub packings: Option<PathBuf>,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub memory: Option<u64>,
    /// How it is walked.
    #[command(flatten)]
    pub walk: WalkArgs,
}

/// Which filter, and where its packing goes.
#[derive(Debug, Args)]
pub struct PackArgs {
    /// The filter (TOML): [filter] with cu or sieve, d0_mm, and density or friction; optionally [packing]. A
    /// scene works too
    pub filter: PathBuf,
    /// Its settings.
    #[command(flatten)]
    pub settings: SettingOptions<OfPacking>,
    /// Folder for the packing: new, empty, or with a stopped packing, which continues [default: one of its
    /// own in voidwalk-packings]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an earlier packing in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Save a checkpoint this often
    #[arg(long, value_name = "TIME", default_value = "1min", value_parser = time)]
    pub checkpoint_every: Duration,
    /// Print packing.json
    #[arg(long)]
    pub json: bool,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// Which packing, and how its voids are told apart.
#[derive(Debug, Args)]
pub struct ConstrictionsArgs {
    /// Grains: CSV (x_mm,y_mm,z_mm,diameter_mm after `# cell_mm = Lx, Ly, Lz` or `# cell = none`; or points
    /// of ParaView and MFIX by their names), a text dump of LAMMPS or LIGGGHTS, Yade's export.text,
    /// MercuryDPM's .data, or points of VTK with a diameter or radius (.vtk, .vtp, .vtu); each also by gzip
    pub packing: PathBuf,
    /// Unit of lengths, if the file does not state it: m, cm, mm, um or nm
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<LengthUnit>,
    /// Boundaries, if the file does not state them: none (free), Lx,Ly,Lz (a periodic cell with a corner at
    /// the origin, in the file's unit) or bounds (a periodic cell between the bounds in the file)
    #[arg(long, value_name = "CELL")]
    pub cell: Option<CellOption>,
    /// Overlap of two inscribed spheres above which their tetrahedra form one void
    #[arg(long, value_name = "F", default_value_t = DEFAULT_MERGE_OVERLAP)]
    pub merge_overlap: f64,
    /// Facets counted in the curve: all, or on-both-hulls (on the convex hulls of the grains of both voids)
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
    /// Lattice sizes: voids along each side, or along x, y and z, such as 40x40x60
    #[arg(long, value_name = "L,L,...", value_delimiter = ',', default_value = "10,20,40,80,160",
          value_parser = lattice_size, allow_hyphen_values = true)]
    pub sizes: Vec<[u32; 3]>,
    /// Realisations of each size
    #[arg(long, value_name = "N", default_value_t = 100,
          value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub realisations: u64,
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_hyphen_values = true)]
    pub seed: u64,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "voidwalk-percolation")]
    pub out: PathBuf,
    /// Replace the results of an earlier call in --out
    #[arg(long)]
    pub overwrite: bool,
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Print percolation.json
    #[arg(long)]
    pub json: bool,
    /// Print no summary
    #[arg(long, short)]
    pub quiet: bool,
}
