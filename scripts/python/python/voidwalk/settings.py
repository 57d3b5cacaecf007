"""The types of a scene's settings, as :attr:`voidwalk.Scene.settings` gives them: lengths in mm, as numbers.

Made by ``scripts/python/records.py --settings`` from what ``voidwalk init --json`` prints. A setting that a scene
does not have is not there.
"""

from __future__ import annotations

from typing import Dict, List, TypedDict, Union

__all__ = [
    "AboutSettings",
    "BaseSettings",
    "FilterSettings",
    "NetworkSettings",
    "PackingSettings",
    "RecordSettings",
    "SceneSettings",
    "StopSettings",
    "WalkSettings",
]


class StopSettings(TypedDict, total=False):
    """Replicates are added until the eroded mass is known closely enough, or the verdict is decided; then
    `replicates` is where it first looks."""

    #: Half width of the 95 % interval of the eroded mass, in every run: percentage points of the base (or
    #: --target-error 0.1pp).
    target_error_pp: float
    #: Confidence level (%) at which the verdict is to be decided, corrected for repeated looks (or --decide
    #: 99.9%).
    decide_percent: float
    #: Where it gives up, and says what it would take.
    most_replicates: int


class FilterSettings(TypedDict, total=False):
    """The filter: its constrictions and its gradation by mass."""

    #: The constriction curve, by number: a shipped name, or a CSV file with the columns percent_smaller and
    #: diameter_mm (or diameter_over_d0f). `voidwalk check` lists the shipped names.
    curve: str
    #: Instead of a curve: density of the filter. Its grains are packed first and the constrictions measured
    #: (seconds to minutes, once).
    density: str
    #: Instead of a density: friction between grains during compression.
    friction: float
    #: Written by a run whose filter was packed: its measured constriction curve.
    measured: str
    #: Instead of a density: constrictions from the library of packings, which takes no time. Where the density
    #: is unknown, the filter is taken as loose, and walked as dense besides. A gradation like none of the
    #: library has its constrictions guessed.
    library: str
    #: Instead of a curve or a density: constrictions guessed from the gradation by inscribed circles, at a
    #: relative density from 0 (loose) to 1 (dense).
    estimate: float
    #: Finest size (mm) of a gradation that is linear on semi-log paper; 1 means lengths in units of D0F. With a
    #: sieve table: its finest size, if its finest percent is not 0.
    d0_mm: float
    #: Cu of a linear gradation (a shipped curve has its own).
    cu: float
    #: Instead of a linear gradation: a sieve table (CSV, .xlsx, .ods or AGS4: openings and percent finer by
    #: mass; FILE#NAME for one of several soils; see `voidwalk soil`).
    sieve: str
    #: Thickness of the real filter layer (mm). A warning appears if the modelled one is thicker.
    thickness_mm: float
    #: Width of an open joint at the exit (mm). The rules of practice give the probability of continuing erosion
    #: into it. The walk ignores joints, so the verdict is in doubt.
    joint_mm: float
    #: Filter grains per void, N_p / N_voids of Eq. (2) (a shipped curve or a packing has its own).
    grains_per_void: float


class PackingSettings(TypedDict, total=False):
    """How the filter is packed, with filter.density or filter.friction."""

    #: Number of grains. Default: enough for a cell 5.4 times as wide as the largest grain, 9,000 to 60,000.
    grains: int
    #: Height of the cell along the flow over its width. Default: 1. A tall cell has as many times the grains,
    #: unless packing.grains is set. A filter no thicker than the cell needs no copies.
    aspect: float
    #: Percent of the filter's mass to pack, from its finest grain on. Default: all, or for a broad filter as
    #: much as packing.grains allow. Warnings and the range of the verdict show the error.
    coarsest: float
    #: Overlap of two inscribed spheres above which their tetrahedra form one void.
    merge_overlap: float
    #: Seed of sizes and start positions.
    seed: int
    #: Friction set once the pressure is held; the packing then settles again.
    final_friction: float
    #: Mean pressure (kPa).
    pressure_kpa: float
    #: Shear modulus of the grains (GPa).
    shear_modulus_gpa: float
    #: Poisson's ratio of the grains.
    poisson_ratio: float
    #: Factor on the shear modulus; below 1 trades stiffness for time.
    stiffness_ratio: float
    #: Density of the grains (kg/m3): only the reported time depends on it.
    density_kg_m3: float
    #: Coefficient of restitution, at every speed.
    restitution: float
    #: Drag on every grain by its mass and velocity relative to the deforming cell, in reduced units.
    drag: float
    #: Drag once the pressure has first come within 2 %: it stops rattlers, which no contact would.
    settling_drag: float
    #: Cundall's local damping: each component of the unbalanced force is reduced by this part of itself where it
    #: drives the motion, raised where it resists.
    local_damping: float
    #: Packing fraction of the random placement.
    start_fraction: float
    #: Part of the expected final packing fraction up to which the cell shrinks at `squeeze_rate`.
    compression_target_fraction: float
    #: Linear strain rate of that first compression, in reduced units.
    squeeze_rate: float
    #: Largest linear strain rate of the servo, in reduced units.
    servo_rate: float
    #: Linear strain rate of the servo per relative lack of pressure, in reduced units.
    servo_gain: float
    #: Mass of a grain grows with diameter to the power of three less this: 0 is the true mass, more lets small
    #: grains govern the time step less. At rest masses do not matter.
    mass_exponent: float
    #: Time step as part of the critical one; a low restitution lowers it further.
    step_fraction: float
    #: Held steps that end a stage, as many as the grains' own masses would take where some are moved as heavier
    #: ones (gradations of a size ratio of 20 or more).
    hold_steps: int
    #: Give up after this many steps.
    max_steps: int


class BaseSettings(TypedDict, total=False):
    """The base soil: its gradation by mass, and how much of it."""

    #: Cu of a gradation that is linear on semi-log paper. One of d85_at_dc, d85_mm and d15f_over_d85b sets its
    #: size.
    cu: float
    #: D85B equals the size that this percent of the filter's constrictions is smaller than.
    d85_at_dc: float
    #: Constriction curve for d85_at_dc. Default: the filter's own.
    dc_curve: str
    #: D85B (mm).
    d85_mm: float
    #: D15F over D85B.
    d15f_over_d85b: float
    #: Instead of a linear gradation: a sieve table (CSV, .xlsx, .ods or AGS4: openings and percent finer by
    #: mass; FILE#NAME for one of several soils; see `voidwalk soil`).
    sieve: str
    #: With a sieve table: its finest size (mm), if its finest percent is not 0.
    d0_mm: float
    #: "practice": walk the base as filter practice regrades it (to 100 % finer than 4.75 mm or a gap); needs
    #: sizes in mm. "no": walk it as sampled. Default: "no" in a scene, "practice" for tables (`voidwalk judge`,
    #: `compare`, `design`, `serve`) without --as-sampled.
    regrade: str
    #: Whether the base is a dispersive clay or silt. The rules of practice take stricter limits. The walk
    #: ignores dispersion, so the verdict is in doubt.
    dispersive: bool
    #: Instead of a gradation: one size (mm).
    single_mm: float
    #: Amount of base: mass of base over mass of filter, Eq. (2).
    mass_ratio: float
    #: Cap on the number of base particles by Eq. (2). Default: none (the paper's is 2e8). The report says if it
    #: applies.
    cap: int
    #: Instead of a mass ratio: the number of base particles.
    n_base: int


class WalkSettings(TypedDict, total=False):
    """How particles choose their way."""

    #: How a particle chooses among the open exits of its void: in proportion to "area" (the paper's, on a
    #: directed network), to the "flux" of water, to area among the exits with outflow ("area-along-flow"), or to
    #: area among exits to voids further along ("height"). Default: "area" on a lattice, "flux" on a graph and on
    #: an .npz of arrays.
    exit: str
    #: Part of its conductance that a blocked constriction keeps, with water.
    rho: float
    #: On a lattice, conductance is proportional to this power of the diameter. Default: 4.
    conductance_exponent: float
    #: Arches: particles that fit through a constriction jam in it together, by a published law of clogging.
    #: Default: "none". No law has been checked with filter tests; the report says its source.
    arching: str
    #: How densely the base arrives, for a law that depends on it: volume of particles by volume of voids.
    #: Default: what an increment brings into the first layer of voids.
    concentration: float
    #: What a blocked constriction is to those that follow: "closed", or "open" beside the particle that blocks
    #: it, for finer particles and water. Default: "closed". Openings need every particle walked one by one, so
    #: that fine bases take longer.
    blocked: str


class NetworkSettings(TypedDict, total=False):
    """The network: a directed cubic lattice, z being the direction of flow, one from a file, or the voids of a
    packing themselves."""

    #: "lattice", or "graph": the voids of the filter's own packing and the constrictions between them.
    kind: str
    #: A packing of your own whose voids are walked: grains in a periodic cell (CSV, VTK, and files of LAMMPS,
    #: LIGGGHTS, Yade, MercuryDPM).
    packing: str
    #: Unit of lengths in network.packing, or of diameters in an .npz of network.file. Files that do not state
    #: theirs need it.
    unit: str
    #: Periodic cell of network.packing, if the file does not state it: "Lx, Ly, Lz" in its unit, with a corner
    #: at the origin, or "bounds" for the bounds in the file (MercuryDPM).
    cell: str
    #: Equal copies of the packing along the flow. Default: as many as 60 layers of voids need.
    copies: int
    #: Thickness of the filter (mm): layers of a lattice, each D50F by number thick, or copies of a packing,
    #: rounded up.
    thickness_mm: float
    #: Thickness of the filter in multiples of D50F by mass.
    thickness_d50f: float
    #: Voids across.
    nx: int
    #: Voids across, the other way.
    ny: int
    #: Voids along the flow: layers.
    nz: int
    #: Connectivity of the voids: as in Table 3 of the paper ("table3", 4 to 8 entrances and exits), or percent
    #: of the voids by connectivity, as { 5 = 25, 6 = 50, 7 = 25 }. Diagonals are added and constrictions
    #: deleted.
    connectivity: Union[str, Dict[str, object]]
    #: Instead of a lattice: a directed network (CSV with from,to,diameter_mm, rows `start,ID,`, and `to` = end),
    #: or an .npz of arrays as OpenPNM and PoreSpy name them, whose constrictions can be passed both ways
    #: (throat.conns, throat.diameter, pore.inlets, pore.outlets).
    file: str


class RecordSettings(TypedDict, total=False):
    """What to record of the walks."""

    #: Record the sums every so many increments; 0 records the last only.
    series_every: int
    #: Increments whose retained and eroded size curves are recorded, besides the last.
    size_curves: List[int]
    #: Number of size classes of those curves.
    size_classes: int
    #: Increments after which the content of each void of the first replicate is recorded, besides the last of
    #: each run, with its voids, its constrictions and when each was blocked, for `voidwalk export` and ParaView.
    #: [] records the last only. Default: nothing.
    voids: List[int]
    #: Multiples of the number of base particles that are walked too, to show how the verdict changes; [] skips
    #: this study.
    sensitivity: List[float]
    #: Multiples of the filter's thickness that are walked too, to show how the verdict changes; [] skips this
    #: study. Default: half and twice, if `sensitivity` is walked.
    thickness: List[float]
    #: Walk how much coarser the filter could be before the base begins to erode, on the first replicate's
    #: network. Default: only where base and filter are sieve tables of `voidwalk judge` and its like.
    margin: bool
    #: Most replicates of each point of both studies; a clear point stops after one or two.
    sensitivity_replicates: int


class AboutSettings(TypedDict, total=False):
    """Names on the first page of the report. They change no result."""

    #: The project.
    project: str
    #: The number of the project.
    number: str
    #: What the sheet is for.
    purpose: str
    #: The client.
    client: str
    #: The author.
    author: str
    #: Who checked it.
    checker: str
    #: The revision of the sheet.
    revision: str
    #: The date on the sheet; that of the run otherwise.
    date: str
    #: Coarse sizes on the left of the figure of the gradations, as in the United States.
    coarse_left: bool
    #: Whose rules the first sheet lists: "all", or those of one authority, with what it leaves out. The verdict
    #: rests on all of them.
    authority: str
    #: "us": sizes on the first sheet in inches too, and the names of US sieves in the appendix. Files stay in
    #: mm.
    units: str


class SceneSettings(TypedDict, total=False):
    """A base-filter combination for voidwalk: `voidwalk run scene.toml`, or `voidwalk check scene.toml` first. Sizes
    are diameters. Every setting can also be given on the command line, as `--set filter.cu=3`."""

    #: Seed: the same seed gives the same bits, for any number of threads.
    seed: int
    #: How passive particles, which can block nothing, move: "counts" (exact counts per void), "particles" (one
    #: by one), "expected" (their expectation), or "auto": particles if fewer than 6.5 passive ones are inserted
    #: on a start node in an increment, else counts; expected in `voidwalk design`. `judge`, `compare` of tables
    #: and `serve` set "expected".
    engine: str
    #: Number of runs: 1 or 2. The second offers fresh base to the filter as the first left it.
    runs: int
    #: Number of replicates, each with a new network; their scatter is the uncertainty of the verdict.
    replicates: int
    #: Share of the base inserted in each increment (paper: 1 %).
    inject_share: float
    #: Sampling of sizes and start nodes: "independent" (the paper's) or "stratified" (spread evenly, so that
    #: replicates scatter less). The distribution of each particle is the same.
    sampling: str
    #: Section [stop].
    stop: StopSettings
    #: Section [filter].
    filter: FilterSettings
    #: Section [packing].
    packing: PackingSettings
    #: Section [base].
    base: BaseSettings
    #: Section [walk].
    walk: WalkSettings
    #: Section [network].
    network: NetworkSettings
    #: Section [record].
    record: RecordSettings
    #: Section [about].
    about: AboutSettings
