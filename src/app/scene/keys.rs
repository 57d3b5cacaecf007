//! Settings of a scene by section, each declared once with its meaning and allowed values, and the
//! settings that exclude each other.

use super::values::{
    CurveSource, Density, LibraryDensity, NetworkMadeOf, Regrade, SheetUnits, VoidConnectivity,
};
use serde::Serialize;
use std::path::PathBuf;
use voidwalk_core::constrictions::{DEFAULT_MERGE_OVERLAP, shipped};
use voidwalk_core::network::ExitRule;
use voidwalk_core::packing::{self, CellOption, LengthUnit};
use voidwalk_core::schema::{
    Allowed, Alternative, GivenSettings, Group, SceneError, above_zero, any, length, only, section, whole,
    within, words,
};
use voidwalk_core::text::is_hidden;
use voidwalk_core::walk::{BlockedAs, DENSEST, Engine, LawName, Sampling};
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{AboutPage, SheetCover};

section! {
    /// A base-filter combination for voidwalk: `voidwalk run scene.toml`, or `voidwalk check scene.toml`
    /// first. Sizes are diameters. Every setting can also be given on the command line, as `--set
    /// filter.cu=3`.
    pub struct WalkKeys in "" {
        /// Seed: the same seed gives the same bits, for any number of threads.
        pub seed: u64 = 1, set, whole(0..=u64::MAX);
        /// How passive particles, which can block nothing, move: "counts" (exact counts per void),
        /// "particles" (one by one), "expected" (their expectation), or "auto": particles if fewer than 6.5
        /// passive ones are inserted on a start node in an increment, else counts; expected in `voidwalk
        /// boundary`. `judge` and `serve` set "expected".
        pub engine: Engine = Engine::Auto, set, words(&Engine::ALL.map(Engine::name));
        /// Number of runs: 1 or 2. The second offers fresh base to the filter as the first left it.
        pub runs: u64 = 2, set, whole(1..=2);
        /// Number of replicates, each with a new network; their scatter is the uncertainty of the verdict.
        pub replicates: u64 = 10, set, whole(1..=100_000);
        /// Fraction of the base inserted in each increment (paper: 1 %).
        pub inject_share: f64 = 0.01, set, only(
            "one part of a whole number of equal parts, from 0.000001 to 1, as 0.01 or 0.02",
            |share| is_whole_part(*share),
        );
        /// Sampling of sizes and start nodes: "independent" (the paper's) or "stratified" (spread evenly, so
        /// that replicates scatter less). The distribution of each particle is the same.
        pub sampling: Sampling = Sampling::Independent, set, words(&Sampling::ALL.map(Sampling::name));
    }
}

/// True if 1 is a whole multiple of the fraction, within a thousandth.
fn is_whole_part(share: f64) -> bool {
    let parts = 1.0 / share;
    (1e-6..=1.0).contains(&share) && (parts - parts.round()).abs() < 1e-3 * parts
}

section! {
    /// The filter: its constrictions and its gradation by mass.
    pub struct Filter in "filter" {
        /// The constriction curve, by number: a shipped name, or a CSV file with the columns percent_smaller
        /// and diameter_mm (or diameter_over_d0f). `voidwalk check` lists the shipped names.
        pub curve: Option<CurveSource> = None, set "\"shire2016-cu1.5-loose\"",
            any("a shipped curve or a file name, in quotes").offering(&shipped_names());
        /// Instead of a curve: density of the filter. Its grains are packed first and the constrictions
        /// measured (seconds to minutes, once).
        pub density: Option<Density> = None, off "\"loose\"",
            any("\"dense\" (friction 0), \"medium\" or \"intermediate\" (0.1), or \"loose\" (0.3)")
                .offering(&Density::ALL.map(Density::name));
        /// Instead of a density: friction between grains during compression.
        pub friction: Option<f64> = None, off "0.3", within(0.0..=10.0, "a number from 0 to 10");
        /// Measured constriction curve of a packed filter, written by its run.
        pub measured: Option<PathBuf> = None, off "\"inputs/filter-curve.csv\"", any("a file name in quotes");
        /// Instead of a density: constrictions from the library of packings, which takes no time. If the
        /// density is unknown, the filter is taken as loose, and also walked as dense. Constrictions are
        /// guessed if no gradation of the library is similar.
        pub library: Option<LibraryDensity> = None, off "\"unknown\"",
            any("\"dense\", \"medium\" or \"intermediate\", \"loose\", or \"unknown\"")
                .offering(&LibraryDensity::ALL.map(LibraryDensity::name));
        /// Instead of a curve or a density: constrictions guessed from the gradation by inscribed circles, at
        /// a relative density from 0 (loose) to 1 (dense).
        pub estimate: Option<f64> = None, off "0.5", within(0.0..=1.0, "a relative density from 0 (loose) \
         to 1 (dense)");
        /// Finest size (mm) of a gradation that is linear on semi-log paper; 1 means lengths in units of D0F.
        /// With a sieve table: its finest size, if its finest percent is not 0.
        pub d0_mm: Option<f64> = None, set "1.0", length();
        /// Cu of a linear gradation (a shipped curve has its own).
        pub cu: Option<f64> = None, off "1.5", within(1.0..=1000.0, "a number from 1 to 1000");
        /// Instead of a linear gradation: a sieve table (CSV, .xlsx, .ods or AGS4: openings and percent finer
        /// by mass; FILE#NAME for one of several soils; see `voidwalk soil`).
        pub sieve: Option<PathBuf> = None, off "\"filter.csv\"", any("a file name in quotes");
        /// Thickness of the real filter layer (mm). A warning appears if the modelled one is thicker.
        pub thickness_mm: Option<f64> = None, off "500.0", length();
        /// Width of an open joint at the exit (mm). The rules of practice give the probability of continuing
        /// erosion into it. The walk ignores joints, so the verdict is in doubt.
        pub joint_mm: Option<f64> = None, off "5.0", length();
        /// Filter grains per void, N_p / N_voids of Eq. (2) (a shipped curve or a packing has its own).
        pub grains_per_void: Option<f64> = None, off "0.61", above_zero();
    }
}

section! {
    /// Packing of the filter, with filter.density or filter.friction.
    pub struct FilterPacking in "packing" {
        /// Number of grains. Default: enough for a cell 5.4 times as wide as the largest grain, 9,000 to
        /// 60,000.
        pub grains: Option<u64> = None, off "10000", whole(10..=10_000_000);
        /// Height of the cell along the flow over its width. Default: 1. A tall cell has as many times the
        /// grains, unless packing.grains is set. A filter no thicker than the cell needs no copies.
        pub aspect: Option<f64> = None, off "4.0", within(1.0..=100.0, "a number from 1 to 100");
        /// Percent of the filter's mass to pack, from its finest grain on. Default: all, or for a broad
        /// filter as much as packing.grains allow. Warnings and the range of the verdict show the error.
        pub coarsest: Option<f64> = None, off "90", within(1.0..=100.0, "a percentage from 1 to 100");
        /// Overlap of two inscribed spheres above which their tetrahedra form one void.
        pub merge_overlap: f64 = DEFAULT_MERGE_OVERLAP, off, only("a number from 0", |f| *f >= 0.0);
    }
}

section! {
    /// The base soil: its gradation by mass, and its amount.
    pub struct Base in "base" {
        /// Cu of a gradation that is linear on semi-log paper. One of d85_at_dc, d85_mm and d15f_over_d85b
        /// sets its size.
        pub cu: Option<f64> = None, set "1.5", within(1.0..=1000.0, "a number from 1 to 1000");
        /// Percent of the filter's constrictions that are smaller than D85B.
        pub d85_at_dc: Option<f64> = None, set "5", within(0.0..=100.0, "a percentage from 0 to 100");
        /// Constriction curve for d85_at_dc. Default: the filter's own.
        pub dc_curve: Option<CurveSource> = None, off "\"cu3-loose\"", any("a shipped curve or a file name, \
         in quotes").offering(&shipped_names());
        /// D85B (mm).
        pub d85_mm: Option<f64> = None, off "0.2", length();
        /// D15F over D85B.
        pub d15f_over_d85b: Option<f64> = None, off "6.5", above_zero();
        /// Instead of a linear gradation: a sieve table (CSV, .xlsx, .ods or AGS4: openings and percent finer
        /// by mass; FILE#NAME for one of several soils; see `voidwalk soil`).
        pub sieve: Option<PathBuf> = None, off "\"base.csv\"", any("a file name in quotes");
        /// With a sieve table: its finest size (mm), if its finest percent is not 0.
        pub d0_mm: Option<f64> = None, off "0.01", length();
        /// "practice": walk the base as filter practice regrades it (to 100 % finer than 4.75 mm or a gap);
        /// needs sizes in mm. "no": walk it as sampled. Default: "no" in a scene, "practice" for tables
        /// (`voidwalk judge`, `boundary`, `serve`) without --as-sampled.
        pub regrade: Option<Regrade> = None, off "\"practice\"",
            any("\"practice\" or \"no\"").offering(&["practice", "no"]);
        /// True if the base is a dispersive clay or silt. The rules of practice take stricter limits. The
        /// walk ignores dispersion, so the verdict is in doubt.
        pub dispersive: Option<bool> = None, off "true", any("true or false").offering(&["true", "false"]);
        /// Instead of a gradation: one size (mm).
        pub single_mm: Option<f64> = None, off "0.18", length();
        /// Amount of base: mass of base over mass of filter, Eq. (2).
        pub mass_ratio: Option<f64> = None, set "0.05", above_zero();
        /// Cap on the number of base particles by Eq. (2). Default: none (the paper's is 2e8). The report
        /// says if it applies.
        pub cap: Option<u64> = None, off "2e8", whole(1..=u64::MAX);
        /// Instead of a mass ratio: the number of base particles.
        pub n_base: Option<u64> = None, off "1000000", whole(1..=u64::MAX);
    }
}

section! {
    /// Choice of exits by particles.
    pub struct ExitKeys in "walk" {
        /// How a particle chooses among the open exits of its void: in proportion to "area" (the paper's, on
        /// a directed network), to the "flux" of water, to area among the exits with outflow
        /// ("area-along-flow"), or to area among exits to voids further along ("height"). Default: "area" on
        /// a lattice, "flux" on a graph and on an .npz of arrays.
        pub exit: Option<ExitRule> = None, off "\"flux\"", words(&ExitRule::ALL.map(ExitRule::name));
        /// Fraction of its conductance that a blocked constriction keeps, with water.
        pub rho: Option<f64> = None, off "0.0", within(0.0..=1.0, "a fraction from 0 to 1");
        /// The flow is solved again once the constrictions closed since the last solution carried this
        /// fraction of the inflow, summed over the filter: their mean number on a particle's way. 0: after
        /// every closure. Default: 0.03.
        pub flow_tolerance: Option<f64> = None, off "0.03", within(0.0..=10.0, "a number from 0 to 10");
        /// On a lattice, conductance is proportional to this power of the diameter. Default: 4.
        pub conductance_exponent: Option<f64> = None, off "4.0", within(0.0..=10.0, "a number from 0 to 10");
        /// Arches: particles that fit through a constriction jam in it together, by a published law of
        /// clogging. Default: "none". No law has been checked with filter tests; the report says its source.
        pub arching: Option<LawName> = None, off "\"zuriguel-2005\"",
            words(&LawName::ALL.map(LawName::name));
        /// Solids fraction of the suspension that enters the filter: volume of particles by volume of
        /// suspension, the same at every depth as long as particles go with the water. "marin-2018" needs
        /// it.
        pub concentration: Option<f64> = None, off "0.02",
            only(concentrations(), |part| *part > 0.0 && *part <= DENSEST);
        /// State of a blocked constriction for later particles: "closed", or "open" beside the particle
        /// that blocks it, for finer particles and water. Default: "closed". Openings require every
        /// particle to be walked one by one, so fine bases take longer.
        pub blocked: Option<BlockedAs> = None, off "\"open\"", words(&BlockedAs::ALL.map(BlockedAs::name));
    }
}

section! {
    /// The network: a directed cubic lattice with flow along z, a network from a file, or the voids of a
    /// packing.
    pub struct NetworkKeys in "network" {
        /// "lattice", or "graph": the voids of the filter's own packing and the constrictions between them.
        pub kind: Option<NetworkMadeOf> = None, off "\"graph\"",
            words(&NetworkMadeOf::ALL.map(NetworkMadeOf::name));
        /// A packing of your own whose voids are walked: grains in a periodic cell (CSV, VTK, and files of
        /// LAMMPS, LIGGGHTS, Yade, MercuryDPM).
        pub packing: Option<PathBuf> = None, off "\"grains.csv\"", any("a file name in quotes");
        /// Unit of lengths in network.packing, or of diameters in an .npz of network.file. Files that do not
        /// state theirs need it.
        pub unit: Option<LengthUnit> = None, off "\"m\"", words(&LengthUnit::ALL.map(LengthUnit::name));
        /// Periodic cell of network.packing, if the file does not state it: "Lx, Ly, Lz" in its unit, with a
        /// corner at the origin, or "bounds" for the bounds in the file (MercuryDPM).
        pub cell: Option<CellOption> = None, off "\"bounds\"",
            any("\"bounds\", or \"Lx, Ly, Lz\" in the unit of the file");
        /// Equal copies of the packing along the flow. Default: as many as 60 layers of voids need.
        pub copies: Option<u64> = None, off "3", whole(1..=1_000_000);
        /// Thickness of the filter (mm): layers of a lattice, each D50F by number thick, or copies of a
        /// packing, rounded up.
        pub thickness_mm: Option<f64> = None, off "500.0", length();
        /// Thickness of the filter in multiples of D50F by mass.
        pub thickness_d50f: Option<f64> = None, off "75.0", above_zero();
        /// Voids across, along x.
        pub nx: Option<u64> = None, set "40", whole(1..=u64::from(u32::MAX));
        /// Voids across, along y.
        pub ny: Option<u64> = None, set "40", whole(1..=u64::from(u32::MAX));
        /// Voids along the flow, along z: layers.
        pub nz: Option<u64> = None, set "60", whole(1..=u64::from(u32::MAX));
        /// Connectivity of the voids: as in Table 3 of the paper ("table3", 4 to 8 entrances and exits), or
        /// percent of the voids by connectivity, as { 5 = 25, 6 = 50, 7 = 25 }. Diagonals are added and
        /// constrictions deleted.
        pub connectivity: Option<VoidConnectivity> = None, off "\"table3\"", any(
            "\"table3\", or percentages that sum to 100 of the voids by connectivity, each a whole number \
             from 2 to 12, as { 4 = 10, 5 = 20, 6 = 40, 7 = 20, 8 = 10 }",
        );
        /// Instead of a lattice: a directed network (CSV with from,to,diameter_mm, rows `start,ID,`, and `to`
        /// = end), or an .npz of arrays as OpenPNM and PoreSpy name them, whose constrictions can be passed
        /// both ways (throat.conns, throat.diameter, pore.inlets, pore.outlets).
        pub file: Option<PathBuf> = None, off "\"network.csv\"", any("a file name in quotes");
    }
}

section! {
    /// Data to record of the walks.
    pub struct Record in "record" {
        /// Interval of the recorded sums, in increments; 0 records only the last.
        pub series_every: u64 = 1, set, whole(0..=u64::MAX);
        /// Increments whose retained and eroded size curves are recorded, besides the last.
        pub size_curves: Vec<u64> = vec![1, 10, 50, 100], set,
            only("a list of increments, from 1", |list: &Vec<u64>| !list.contains(&0));
        /// Number of size classes of those curves.
        pub size_classes: u64 = 64, set, whole(1..=4096);
        /// Increments after which the content of each void of the first replicate is recorded, besides the
        /// last of each run, with its voids, its constrictions and when each was blocked, for `voidwalk
        /// export` and ParaView. [] records the last only. Default: nothing.
        pub voids: Option<Vec<u64>> = None, off "[1, 10, 50, 100]",
            only(
                format!("a list of at most {MOST_MOMENTS} increments, from 1"),
                |list: &Vec<u64>| !list.contains(&0) && list.len() <= MOST_MOMENTS,
            );
        /// Multiples of the number of base particles that are walked too, to show how the verdict changes; []
        /// skips this study.
        pub sensitivity: Vec<f64> = vec![0.25, 0.5, 2.0, 4.0], set,
            only("a list of numbers above 0", |list: &Vec<f64>| list.iter().all(|factor| *factor > 0.0));
        /// Multiples of the filter's thickness that are walked too, to show how the verdict changes; [] skips
        /// this study. Default: half and twice, if `sensitivity` is walked.
        pub thickness: Option<Vec<f64>> = None, off "[0.5, 2.0]",
            only("a list of numbers above 0", |list: &Vec<f64>| list.iter().all(|factor| *factor > 0.0));
        /// Maximum number of replicates of each point of both studies; a clear point stops after one or two.
        pub sensitivity_replicates: u64 = 3, set, whole(1..=1000);
    }
}

section! {
    /// Names on the first page of the report. They change no result.
    pub struct About in "about" {
        /// The project.
        pub project: Option<String> = None, off "\"Main dam, zone 2B\"", line();
        /// The number of the project.
        pub number: Option<String> = None, off "\"D-2031\"", line();
        /// Purpose of the sheet.
        pub purpose: Option<String> = None, off "\"Design of the chimney filter\"", line();
        /// The client.
        pub client: Option<String> = None, off "\"Water Board\"", line();
        /// The author.
        pub author: Option<String> = None, off "\"N. N.\"", line();
        /// Name of the checker.
        pub checker: Option<String> = None, off "\"M. M.\"", line();
        /// The revision of the sheet.
        pub revision: Option<String> = None, off "\"A, issued for review\"", line();
        /// Date on the sheet. Default: the day of the run.
        pub date: Option<String> = None, off "\"2026-11-25\"", line();
        /// Coarse sizes on the left of the figure of the gradations, as in the United States.
        pub coarse_left: Option<bool> = None, off "true", any("true or false").offering(&["true", "false"]);
        /// "us": sizes on the first sheet in inches too, and the names of US sieves in the appendix. Files
        /// stay in mm.
        pub units: Option<SheetUnits> = None, off "\"us\"", words(&SheetUnits::ALL.map(SheetUnits::name));
    }
}

/// Maximum number of increments after which the contents of each void are recorded.
const MOST_MOMENTS: usize = 100;

/// Names of the shipped curves.
fn shipped_names() -> Vec<&'static str> {
    shipped().iter().map(|filter| filter.name.as_str()).collect()
}

/// Maximum characters of a line.
const LINE: usize = 120;

/// Text that fits into one line of a page.
fn line() -> Allowed<String> {
    let fits =
        |text: &String| (1..=LINE).contains(&text.trim().chars().count()) && !text.chars().any(is_hidden);
    only(format!("a text in quotes, one line of at most {LINE} characters that are seen"), fits)
}

/// Concentrations that a scene may state, in words.
pub(super) fn concentrations() -> String {
    format!("a number above 0 and up to {DENSEST}")
}

/// Settings of the sheet that are not texts on the cover.
const NO_COVER: [&str; 2] = ["coarse_left", "units"];

impl About {
    /// True if inches are shown beside mm.
    pub(crate) fn shows_inches(&self) -> bool {
        self.units == Some(SheetUnits::Us)
    }

    /// Full names of the settings of the cover that are texts.
    pub(crate) fn texts() -> Vec<String> {
        let of_cover = Self::keys().into_iter().filter(|key| !NO_COVER.contains(&key.name));
        of_cover.map(|key| key.full_name()).collect()
    }

    /// Page of a run, whose sizes may be multiples of D0F.
    pub(crate) fn page(&self, scale_free: bool) -> AboutPage {
        let unit = SizeUnit::of(scale_free, self.shows_inches());
        AboutPage { cover: self.cover(), coarse_left: self.coarse_left == Some(true), unit }
    }

    /// Cover of the sheet, without a date if the scene states none.
    pub(crate) fn cover(&self) -> SheetCover {
        let Self { project, number, purpose, client, author, checker, revision, date, .. } = self.clone();
        SheetCover { project, number, purpose, client, author, checker, revision, date }
    }
}

/// Section `packing`: settings of the measured packing, and of the compression of its grains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct PackingKeys {
    /// Settings of grains and voids.
    #[serde(flatten)]
    pub(crate) filter: FilterPacking,
    /// Settings of the compression; friction and number of grains are not set here.
    #[serde(flatten)]
    pub(crate) compression: packing::Settings,
}

/// Section `packing`, if density or friction requires a packing.
pub(super) fn packing_keys(s: &GivenSettings) -> Result<Option<PackingKeys>, SceneError> {
    let stated = s.has("filter.density") || s.has("filter.friction");
    match s.first_in("packing.") {
        Some(name) if !stated => Err(s.clash(format!(
            "{name} goes with filter.density or filter.friction: nothing is packed without one of them"
        ))),
        _ if !stated => Ok(None),
        _ => Ok(Some(PackingKeys {
            filter: FilterPacking::read(s)?,
            compression: packing::Settings::read(s)?,
        })),
    }
}

/// Settings that state one fact in different ways.
pub(super) const GROUPS: &[Group] = &[
    // Measurements on one packing do not apply to another.
    Group {
        says: "say what is packed",
        alternatives: &[Alternative {
            resets: &["filter.measured"],
            ..Alternative::by(&["filter.density", "filter.friction", "filter.cu", "filter.sieve", "packing."])
        }],
    },
    Group {
        says: "say what the filter's constrictions are",
        alternatives: &[
            Alternative::by(&["filter.curve"]),
            Alternative::by(&["filter.density"]),
            Alternative::by(&["filter.friction"]),
            Alternative::by(&["filter.library"]),
            Alternative::by(&["filter.estimate"]),
        ],
    },
    // A network from a file contains its constrictions; a curve may still define D85B.
    Group {
        says: "say what the filter's constrictions are",
        alternatives: &[
            Alternative::by(&["filter.density", "filter.friction", "filter.library", "filter.estimate"]),
            Alternative::by(&["network.file"]),
        ],
    },
    Group {
        says: "give the filter's gradation",
        alternatives: &[
            Alternative::by(&["filter.cu"]),
            // With a sieve table, d0_mm is the end of its tail, not the start of the gradation.
            Alternative { resets: &["filter.d0_mm"], ..Alternative::by(&["filter.sieve"]) },
        ],
    },
    Group {
        says: "give the base",
        alternatives: &[
            Alternative {
                with_chooses: true,
                ..Alternative::by(&["base.cu"]).with(&[
                    "base.d85_mm",
                    "base.d85_at_dc",
                    "base.d15f_over_d85b",
                    "base.dc_curve",
                ])
            },
            Alternative::by(&["base.sieve"]).with(&["base.d0_mm"]),
            Alternative::by(&["base.single_mm"]),
        ],
    },
    Group {
        says: "set D85B",
        alternatives: &[
            Alternative::by(&["base.d85_mm"]),
            Alternative::by(&["base.d85_at_dc"]).with(&["base.dc_curve"]),
            Alternative::by(&["base.d15f_over_d85b"]),
        ],
    },
    Group {
        says: "say how much base",
        alternatives: &[
            Alternative::by(&["base.mass_ratio"]).with(&["base.cap"]),
            Alternative::by(&["base.n_base"]),
        ],
    },
    Group {
        says: "give the network",
        alternatives: &[
            Alternative::by(&["network.nx", "network.ny", "network.nz", "network.connectivity"]),
            Alternative::by(&["network.file"]),
            Alternative {
                resets: &["filter.curve", "filter.library", "filter.estimate"],
                ..Alternative::by(&["network.packing", "network.copies"])
            },
        ],
    },
    Group {
        says: "say what the network is made of",
        alternatives: &[Alternative {
            resets: &["network.nx", "network.ny", "network.nz", "network.connectivity", "network.file"],
            ..Alternative::by(&["network.kind"])
        }],
    },
    Group {
        says: "say how thick the filter is",
        alternatives: &[
            Alternative::by(&["network.nz"]),
            Alternative::by(&["network.copies"]),
            Alternative::by(&["network.thickness_mm"]),
            Alternative::by(&["network.thickness_d50f"]),
        ],
    },
];
