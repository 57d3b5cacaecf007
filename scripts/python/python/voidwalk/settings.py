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
    `replicates` is where it first looks.

    Keys
    ----
    target_error_pp
        Half width of the 95 % interval of the eroded mass, in every run: percentage points of the base (or
        --target-error 0.1pp).
    decide_percent
        Confidence level (%) at which the verdict is to be decided, corrected for repeated looks (or --decide
        99.9%).
    most_replicates
        Where it gives up, and says what it would take.
    """

    target_error_pp: float
    decide_percent: float
    most_replicates: int


class FilterSettings(TypedDict, total=False):
    """The filter: its constrictions and its gradation by mass.

    Keys
    ----
    curve
        The constriction curve, by number: a shipped name, or a CSV file with the columns percent_smaller and
        diameter_mm (or diameter_over_d0f). `voidwalk check` lists the shipped names.
    density
        Instead of a curve: density of the filter. Its grains are packed first and the constrictions measured
        (seconds to minutes, once).
    friction
        Instead of a density: friction between grains during compression.
    measured
        Written by a run whose filter was packed: its measured constriction curve.
    library
        Instead of a density: constrictions from the library of packings, which takes no time. Where the density
        is unknown, the filter is taken as loose, and walked as dense besides. A gradation like none of the
        library has its constrictions guessed.
    estimate
        Instead of a curve or a density: constrictions guessed from the gradation by inscribed circles, at a
        relative density from 0 (loose) to 1 (dense).
    d0_mm
        Finest size (mm) of a gradation that is linear on semi-log paper; 1 means lengths in units of D0F. With
        a sieve table: its finest size, if its finest percent is not 0.
    cu
        Cu of a linear gradation (a shipped curve has its own).
    sieve
        Instead of a linear gradation: a sieve table (CSV, .xlsx, .ods or AGS4: openings and percent finer by
        mass; FILE#NAME for one of several soils; see `voidwalk soil`).
    thickness_mm
        Thickness of the real filter layer (mm). A warning appears if the modelled one is thicker.
    joint_mm
        Width of an open joint at the exit (mm). The rules of practice give the probability of continuing
        erosion into it. The walk ignores joints, so the verdict is in doubt.
    grains_per_void
        Filter grains per void, N_p / N_voids of Eq. (2) (a shipped curve or a packing has its own).
    """

    curve: str
    density: str
    friction: float
    measured: str
    library: str
    estimate: float
    d0_mm: float
    cu: float
    sieve: str
    thickness_mm: float
    joint_mm: float
    grains_per_void: float


class PackingSettings(TypedDict, total=False):
    """How the filter is packed, with filter.density or filter.friction.

    Keys
    ----
    grains
        Number of grains. Default: enough for a cell 5.4 times as wide as the largest grain, 9,000 to 60,000.
    aspect
        Height of the cell along the flow over its width. Default: 1. A tall cell has as many times the grains,
        unless packing.grains is set. A filter no thicker than the cell needs no copies.
    coarsest
        Percent of the filter's mass to pack, from its finest grain on. Default: all, or for a broad filter as
        much as packing.grains allow. Warnings and the range of the verdict show the error.
    merge_overlap
        Overlap of two inscribed spheres above which their tetrahedra form one void.
    seed
        Seed of sizes and start positions.
    final_friction
        Friction set once the pressure is held; the packing then settles again.
    pressure_kpa
        Mean pressure (kPa).
    shear_modulus_gpa
        Shear modulus of the grains (GPa).
    poisson_ratio
        Poisson's ratio of the grains.
    stiffness_ratio
        Factor on the shear modulus; below 1 trades stiffness for time.
    density_kg_m3
        Density of the grains (kg/m3): only the reported time depends on it.
    restitution
        Coefficient of restitution, at every speed.
    drag
        Drag on every grain by its mass and velocity relative to the deforming cell, in reduced units.
    settling_drag
        Drag once the pressure has first come within 2 %: it stops rattlers, which no contact would.
    local_damping
        Cundall's local damping: each component of the unbalanced force is reduced by this part of itself where
        it drives the motion, raised where it resists.
    start_fraction
        Packing fraction of the random placement.
    compression_target_fraction
        Part of the expected final packing fraction up to which the cell shrinks at `squeeze_rate`.
    squeeze_rate
        Linear strain rate of that first compression, in reduced units.
    servo_rate
        Largest linear strain rate of the servo, in reduced units.
    servo_gain
        Linear strain rate of the servo per relative lack of pressure, in reduced units.
    mass_exponent
        Mass of a grain grows with diameter to the power of three less this: 0 is the true mass, more lets small
        grains govern the time step less. At rest masses do not matter.
    step_fraction
        Time step as part of the critical one; a low restitution lowers it further.
    hold_steps
        Held steps that end a stage, as many as the grains' own masses would take where some are moved as
        heavier ones (gradations of a size ratio of 20 or more).
    max_steps
        Give up after this many steps.
    """

    grains: int
    aspect: float
    coarsest: float
    merge_overlap: float
    seed: int
    final_friction: float
    pressure_kpa: float
    shear_modulus_gpa: float
    poisson_ratio: float
    stiffness_ratio: float
    density_kg_m3: float
    restitution: float
    drag: float
    settling_drag: float
    local_damping: float
    start_fraction: float
    compression_target_fraction: float
    squeeze_rate: float
    servo_rate: float
    servo_gain: float
    mass_exponent: float
    step_fraction: float
    hold_steps: int
    max_steps: int


class BaseSettings(TypedDict, total=False):
    """The base soil: its gradation by mass, and how much of it.

    Keys
    ----
    cu
        Cu of a gradation that is linear on semi-log paper. One of d85_at_dc, d85_mm and d15f_over_d85b sets its
        size.
    d85_at_dc
        D85B equals the size that this percent of the filter's constrictions is smaller than.
    dc_curve
        Constriction curve for d85_at_dc. Default: the filter's own.
    d85_mm
        D85B (mm).
    d15f_over_d85b
        D15F over D85B.
    sieve
        Instead of a linear gradation: a sieve table (CSV, .xlsx, .ods or AGS4: openings and percent finer by
        mass; FILE#NAME for one of several soils; see `voidwalk soil`).
    d0_mm
        With a sieve table: its finest size (mm), if its finest percent is not 0.
    regrade
        "practice": walk the base as filter practice regrades it (to 100 % finer than 4.75 mm or a gap); needs
        sizes in mm. "no": walk it as sampled. Default: "no" in a scene, "practice" for tables (`voidwalk
        judge`, `design`, `serve`) without --as-sampled.
    dispersive
        Whether the base is a dispersive clay or silt. The rules of practice take stricter limits. The walk
        ignores dispersion, so the verdict is in doubt.
    single_mm
        Instead of a gradation: one size (mm).
    mass_ratio
        Amount of base: mass of base over mass of filter, Eq. (2).
    cap
        Cap on the number of base particles by Eq. (2). Default: none (the paper's is 2e8). The report says if
        it applies.
    n_base
        Instead of a mass ratio: the number of base particles.
    """

    cu: float
    d85_at_dc: float
    dc_curve: str
    d85_mm: float
    d15f_over_d85b: float
    sieve: str
    d0_mm: float
    regrade: str
    dispersive: bool
    single_mm: float
    mass_ratio: float
    cap: int
    n_base: int


class WalkSettings(TypedDict, total=False):
    """How particles choose their way.

    Keys
    ----
    exit
        How a particle chooses among the open exits of its void: in proportion to "area" (the paper's, on a
        directed network), to the "flux" of water, to area among the exits with outflow ("area-along-flow"), or
        to area among exits to voids further along ("height"). Default: "area" on a lattice, "flux" on a graph
        and on an .npz of arrays.
    rho
        Part of its conductance that a blocked constriction keeps, with water.
    conductance_exponent
        On a lattice, conductance is proportional to this power of the diameter. Default: 4.
    arching
        Arches: particles that fit through a constriction jam in it together, by a published law of clogging.
        Default: "none". No law has been checked with filter tests; the report says its source.
    concentration
        How densely the base arrives, for a law that depends on it: volume of particles by volume of voids.
        Default: what an increment brings into the first layer of voids. "by-void", on a lattice: what the walk
        brings into each void in each increment.
    arch_size
        Which size counts where the concentration is "by-void": the particle's "own", that of the mean volume of
        the particles in its void ("void-mean"), or D85 of them ("void-d85"). Default: "own".
    blocked
        What a blocked constriction is to those that follow: "closed", or "open" beside the particle that blocks
        it, for finer particles and water. Default: "closed". Openings need every particle walked one by one, so
        that fine bases take longer.
    """

    exit: str
    rho: float
    conductance_exponent: float
    arching: str
    concentration: float
    arch_size: str
    blocked: str


class NetworkSettings(TypedDict, total=False):
    """The network: a directed cubic lattice, z being the direction of flow, one from a file, or the voids of a
    packing themselves.

    Keys
    ----
    kind
        "lattice", or "graph": the voids of the filter's own packing and the constrictions between them.
    packing
        A packing of your own whose voids are walked: grains in a periodic cell (CSV, VTK, and files of LAMMPS,
        LIGGGHTS, Yade, MercuryDPM).
    unit
        Unit of lengths in network.packing, or of diameters in an .npz of network.file. Files that do not state
        theirs need it.
    cell
        Periodic cell of network.packing, if the file does not state it: "Lx, Ly, Lz" in its unit, with a corner
        at the origin, or "bounds" for the bounds in the file (MercuryDPM).
    copies
        Equal copies of the packing along the flow. Default: as many as 60 layers of voids need.
    thickness_mm
        Thickness of the filter (mm): layers of a lattice, each D50F by number thick, or copies of a packing,
        rounded up.
    thickness_d50f
        Thickness of the filter in multiples of D50F by mass.
    nx
        Voids across.
    ny
        Voids across, the other way.
    nz
        Voids along the flow: layers.
    connectivity
        Connectivity of the voids: as in Table 3 of the paper ("table3", 4 to 8 entrances and exits), or percent
        of the voids by connectivity, as { 5 = 25, 6 = 50, 7 = 25 }. Diagonals are added and constrictions
        deleted.
    file
        Instead of a lattice: a directed network (CSV with from,to,diameter_mm, rows `start,ID,`, and `to` =
        end), or an .npz of arrays as OpenPNM and PoreSpy name them, whose constrictions can be passed both ways
        (throat.conns, throat.diameter, pore.inlets, pore.outlets).
    """

    kind: str
    packing: str
    unit: str
    cell: str
    copies: int
    thickness_mm: float
    thickness_d50f: float
    nx: int
    ny: int
    nz: int
    connectivity: Union[str, Dict[str, object]]
    file: str


class RecordSettings(TypedDict, total=False):
    """What to record of the walks.

    Keys
    ----
    series_every
        Record the sums every so many increments; 0 records the last only.
    size_curves
        Increments whose retained and eroded size curves are recorded, besides the last.
    size_classes
        Number of size classes of those curves.
    voids
        Increments after which the content of each void of the first replicate is recorded, besides the last of
        each run, with its voids, its constrictions and when each was blocked, for `voidwalk export` and
        ParaView. [] records the last only. Default: nothing.
    sensitivity
        Multiples of the number of base particles that are walked too, to show how the verdict changes; [] skips
        this study.
    thickness
        Multiples of the filter's thickness that are walked too, to show how the verdict changes; [] skips this
        study. Default: half and twice, if `sensitivity` is walked.
    sensitivity_replicates
        Most replicates of each point of both studies; a clear point stops after one or two.
    """

    series_every: int
    size_curves: List[int]
    size_classes: int
    voids: List[int]
    sensitivity: List[float]
    thickness: List[float]
    sensitivity_replicates: int


class AboutSettings(TypedDict, total=False):
    """Names on the first page of the report. They change no result.

    Keys
    ----
    project
        The project.
    number
        The number of the project.
    purpose
        What the sheet is for.
    client
        The client.
    author
        The author.
    checker
        Who checked it.
    revision
        The revision of the sheet.
    date
        The date on the sheet; that of the run otherwise.
    coarse_left
        Coarse sizes on the left of the figure of the gradations, as in the United States.
    units
        "us": sizes on the first sheet in inches too, and the names of US sieves in the appendix. Files stay in
        mm.
    """

    project: str
    number: str
    purpose: str
    client: str
    author: str
    checker: str
    revision: str
    date: str
    coarse_left: bool
    units: str


class SceneSettings(TypedDict, total=False):
    """A base-filter combination for voidwalk: `voidwalk run scene.toml`, or `voidwalk check scene.toml` first. Sizes
    are diameters. Every setting can also be given on the command line, as `--set filter.cu=3`.

    Keys
    ----
    seed
        Seed: the same seed gives the same bits, for any number of threads.
    engine
        How passive particles, which can block nothing, move: "counts" (exact counts per void), "particles" (one
        by one), "expected" (their expectation), or "auto": particles if fewer than 6.5 passive ones are
        inserted on a start node in an increment, else counts; expected in `voidwalk design`. `judge` and
        `serve` set "expected".
    runs
        Number of runs: 1 or 2. The second offers fresh base to the filter as the first left it.
    replicates
        Number of replicates, each with a new network; their scatter is the uncertainty of the verdict.
    inject_share
        Share of the base inserted in each increment (paper: 1 %).
    sampling
        Sampling of sizes and start nodes: "independent" (the paper's) or "stratified" (spread evenly, so that
        replicates scatter less). The distribution of each particle is the same.
    stop
        Its section [stop].
    filter
        Its section [filter].
    packing
        Its section [packing].
    base
        Its section [base].
    walk
        Its section [walk].
    network
        Its section [network].
    record
        Its section [record].
    about
        Its section [about].
    """

    seed: int
    engine: str
    runs: int
    replicates: int
    inject_share: float
    sampling: str
    stop: StopSettings
    filter: FilterSettings
    packing: PackingSettings
    base: BaseSettings
    walk: WalkSettings
    network: NetworkSettings
    record: RecordSettings
    about: AboutSettings
