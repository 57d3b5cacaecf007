"""The types of what voidwalk hands out as dicts: the records of its JSON files.

Made by ``scripts/python/records.py`` from the JSON Schemas, which ``voidwalk init --schema NAME`` prints.
"""

from __future__ import annotations

from typing import Dict, List, Literal, Optional, TypedDict, Union

__all__ = [
    "AppliedRule",
    "ArchingByVoidRecord",
    "ArchingRecord",
    "BandSize",
    "BaseRecord",
    "BaseSizes",
    "BaseStated",
    "Boundaries",
    "Boundary",
    "BoundaryRow",
    "BoxThreshold",
    "ByConnectivity",
    "ConstrictionsRecord",
    "ConstrictionsSummary",
    "CurveEnd",
    "CurveRange",
    "FilterRecord",
    "FilterSizes",
    "GivenNetwork",
    "Headline",
    "IfDispersive",
    "Infiltration",
    "InfiltrationSize",
    "InputFile",
    "Inputs",
    "LeftOut",
    "Manifest",
    "ManyStarts",
    "Measure",
    "Model",
    "NetworkBoundaries",
    "NetworkRecord",
    "NetworkSummary",
    "NoBand",
    "NotKept",
    "Note",
    "NoteId",
    "OfThickness",
    "OneLength",
    "Outcome",
    "PackedPart",
    "PackingRecord",
    "PairRules",
    "PercolationStudy",
    "Practice",
    "ProductMargin",
    "Range",
    "Ratios",
    "RegradeCause",
    "RegradeReason",
    "Replicate",
    "RowNote",
    "RuleNote",
    "RuleNoteId",
    "Run",
    "RunSummary",
    "SameShape",
    "SampledBase",
    "Sensitivity",
    "SheetCover",
    "SieveLimit",
    "SizeBand",
    "SizeThreshold",
    "SoilSummary",
    "Soils",
    "Specification",
    "SpecificationStep",
    "SpecifiedCurve",
    "Statistic",
    "StepNote",
    "StepValue",
    "Stopping",
    "WalkOutcome",
    "WithoutFiner",
]


#: The answer of filter practice, with which every face begins.
Headline = Literal[
    "meets the rules checked",
    "meets the rules checked unless the base is dispersive",
    "meets the limit of retention, drainage not known",
    "meets the limit of retention, but may not drain",
    "meets the limit of retention, but may segregate",
    "does not meet the limit of design",
    "does not meet practice",
    "does not meet practice: it may lose its finer part, and is too coarse without it",
    "not known: the filter may lose its finer part",
    "not known: sieves are missing",
    "not known: a test is missing",
]


_Practice = TypedDict(
    "_Practice",
    {
        "class": Literal["meets", "does not meet", "not known"],
        "d15f_mm": Optional[List[float]],
        "limit_mm": Optional[float],
        "tests": Literal["no erosion", "some erosion", "excessive erosion", "continuing erosion", "unknown"],
        "range_of_tests_mm": Optional[List[float]],
    },
)


class Practice(_Practice, total=False):
    """What filter practice says of a pair, for programs.

    Keys
    ----
    class
        All of it, as the headline has it.
    d15f_mm
        D15F (mm), twice; of one that lies between two sieves that stand far apart their openings. `None` where
        it lies in the filter's finest part.
    limit_mm
        The limit of design (mm): the most that D15F may be; `None` where that is not known.
    limit_at_most
        Whether the true limit is not known, and is at most `limit_mm`.
    tests
        Class of such pairs in tests, by the boundaries of Foster and Fell.
    range_of_tests_mm
        D15F (mm) between which tests of bases with such fines began to erode (Fell et al., Table 9.2); `None`
        of a dispersive base, which had other tests, and where fines or D85B are not known.
    """

    limit_at_most: bool


#: What the walks say together.
Model = TypedDict(
    "Model",
    {
        "class": Literal["no erosion", "some erosion", "continuing erosion", "undecided"],
        "eroded_percent": List[List[float]],
        "replicates": int,
        "network": Literal["cubic", "connected", "file", "graph"],
    },
)


#: The name of a note.
NoteId = Literal[
    "replicates_leave_open",
    "second_run_missing",
    "level_missed",
    "loses_fines",
    "too_fine_to_drain",
    "fines_of_filter",
    "may_segregate",
    "dispersion_not_known",
    "dispersive_limit_not_known",
    "limit_without_margin",
    "unstable_base",
    "layer_thicker",
    "unsteady",
    "nothing_walked",
    "erodes_everywhere",
    "holds_everywhere",
    "median_beyond",
    "erodes_to_end",
    "erodes_to",
    "holds_to_end",
    "not_walked",
    "spared_end",
    "pan_erodes",
    "decided_below95",
    "clogged_before",
    "clogged",
    "trapped_could_turn",
    "second_run_erodes",
    "second_run_may_erode",
    "coarse_base",
    "cohesive_fines",
    "fines_not_sieved",
    "not_regraded",
    "broadly_graded",
    "not_studied",
    "dispersive_base",
    "open_joint",
    "thickness_without_unit",
    "thickness_of_file",
    "layers_thicker",
    "copies_thicker",
    "thinner_than_grain",
    "capped_base",
    "few_particles",
    "more_particles",
    "low_mass_ratio",
    "amount_unknown",
    "amount_held",
    "given_network",
    "no_filter",
    "narrow_lattice",
    "all_on_its_way",
    "cu_unchecked",
    "cu_at_least",
    "cu_unknown",
    "gap_graded",
    "other_curve",
    "library_of_any_density",
    "library_of_density",
    "like_none_of_the_library",
    "guessed_constrictions",
    "guessed_grains",
    "part_packed",
    "floating_part_packed",
    "loose_part_packed",
    "skeleton",
    "one_replicate",
    "few_replicates",
    "few_networks",
    "pan_passive",
    "pan_counts_as_passing",
    "arches",
    "openings",
    "curve_range",
    "curve_decides",
    "unit_doubtful",
    "files_exchanged",
    "filter_of_boulders",
    "unstable_side",
    "broad_base",
    "broad_base_at_least",
    "gap_of_base",
    "flat_base",
    "target_missed",
    "regraded",
    "regrading_not_needed",
    "read_as",
    "envelope",
    "pan_of_filter",
    "loose_grains",
    "narrow_cell",
    "one_network",
    "one_packing",
    "long_way_out",
    "not_monotone",
    "trapped",
    "permeability",
    "overfull",
    "no_room",
]


class Note(TypedDict):
    """A note with its numbers, in the order of every face.

    Keys
    ----
    id
        Its name.
    numbers
        Its numbers by name, with the unit in the name.
    """

    id: NoteId
    numbers: Dict[str, object]


class _IfDispersive(TypedDict):
    d15f_max_mm: float


class IfDispersive(_IfDispersive, total=False):
    """What practice allows if a base is dispersive, of which nobody has said whether it is.

    Keys
    ----
    d15f_max_mm
        The most that D15F (mm) may be then.
    at_most
        Whether the true limit is not known, and is at most that.
    lacks
        Why it is not known; `None` where it is.
    """

    at_most: bool
    lacks: Optional[Literal["limit of design", "any limit", "D85B"]]


class ConstrictionsRecord(TypedDict):
    """What is known of a filter's constrictions besides their sizes.

    Keys
    ----
    origin
        Where they come from.
    """

    origin: Literal["library", "packed", "given", "guessed"]


class ByConnectivity(TypedDict):
    """What the voids of one connectivity (entrances and exits) did in a run; Table 3 of the paper.

    Keys
    ----
    connectivity
        Entrances and exits; that a void is a start node counts as an entrance.
    voids
        Voids that have it.
    voids_fraction
        Their share of all voids.
    constrictions
        Their exits.
    blocked
        Those of them that are blocked when the run ends.
    retained_in_constrictions
        Particles of the run stopped by them.
    retained_in_voids
        Particles of the run retained in these voids.
    retained_per_void
        Particles retained either way, over these voids.
    retained_fraction
        Their share of all particles retained either way.
    """

    connectivity: int
    voids: int
    voids_fraction: float
    constrictions: int
    blocked: int
    retained_in_constrictions: int
    retained_in_voids: int
    retained_per_void: float
    retained_fraction: float


class _Run(TypedDict):
    run: int
    eroded_mass_fraction: float
    eroded_number_fraction: float
    largest_eroded_mm: Optional[float]
    largest_eroded_over_d15f: Optional[float]
    blocked: int
    blocked_fraction: float
    blocked_first_three_layers_fraction: float
    backbone_fraction: float
    inserted: int
    eroded: int
    retained_in_constrictions: int
    retained_in_voids: int
    trapped: int
    retained_per_void: float
    deepest_retained_layer: Optional[int]
    retained_95_layer: Optional[int]
    increments: int
    particle_moves: int
    seconds: float


class Run(_Run, total=False):
    """The end of one run.

    Keys
    ----
    run
        1 or 2.
    eroded_mass_fraction
        Mass eroded over mass inserted.
    eroded_number_fraction
        Particles eroded over particles inserted.
    largest_eroded_mm
        Largest particle that left the filter; `None` when none did.
    largest_eroded_over_d15f
        `largest_eroded_mm` over D15F.
    blocked
        Constrictions blocked when the run ends.
    blocked_fraction
        Their share of all constrictions.
    blocked_first_three_layers_fraction
        Their share of the constrictions of layers 0, 1 and 2.
    backbone_fraction
        Share of all constrictions that lie on an open path from start to end.
    inserted
        Particles inserted.
    eroded
        Particles that left through the last layer.
    retained_in_constrictions
        Particles stopped by a constriction.
    retained_in_arches
        Those of them that are in arches; `None` where there are no arches. No physical number: it depends on
        what an increment brings to one constriction (arches.md).
    arches
        Arches, likewise.
    arched_mass_fraction
        Mass in arches over the mass inserted, likewise.
    retained_in_voids
        Particles in voids without an open exit.
    trapped
        Particles trapped in closed loops.
    retained_per_void
        Particles retained in any way, over voids.
    deepest_retained_layer
        Deepest layer in which a particle of this run is retained; `None` where none is.
    retained_95_layer
        The layer down to which 95 % of the particles of this run that a layer retains lie.
    increments
        Increments until nothing moved.
    particle_moves
        Moves completed, the one that leaves included.
    k_over_k0
        Permeability when the run ends over that of the clean filter, where water flows.
    k0_mm2
        Permeability of the clean filter (mm2), where the network knows its lengths.
    fullness_max
        Volume that this run retained over void volume, of the fullest void that has a volume; where volumes are
        known.
    overfull_fraction
        Share of the voids that are filled by more than 0.6 of their volume, likewise; a void without volume is
        as soon as a particle rests in it.
    by_connectivity
        Retained and blocked by connectivity of the void, rising; empty where all voids have one connectivity.
    seconds
        Wall time from start to end, s, beside what else is walked on the same threads.
    """

    retained_in_arches: Optional[int]
    arches: Optional[int]
    arched_mass_fraction: Optional[float]
    k_over_k0: Optional[float]
    k0_mm2: Optional[float]
    fullness_max: Optional[float]
    overfull_fraction: Optional[float]
    by_connectivity: List[ByConnectivity]


class Replicate(TypedDict):
    """One new network, walked once or twice.

    Keys
    ----
    seed
        The seed that gives this replicate alone.
    verdict
        The class of this replicate alone.
    runs
        One or two.
    """

    seed: int
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    runs: List[Run]


class Statistic(TypedDict):
    """A mean, and with two or more replicates its standard deviation and interval.

    Keys
    ----
    mean
        Mean over the replicates.
    sd
        Sample standard deviation.
    low
        Lower end of the 95 % interval of the mean.
    high
        Upper end of the 95 % interval of the mean.
    """

    mean: float
    sd: Optional[float]
    low: Optional[float]
    high: Optional[float]


class RunSummary(TypedDict):
    """Statistics of one run over the replicates.

    Keys
    ----
    run
        1 or 2.
    eroded_mass_fraction
        Of `Run::eroded_mass_fraction`.
    eroded_number_fraction
        Of `Run::eroded_number_fraction`.
    largest_eroded_over_d15f
        Of `Run::largest_eroded_over_d15f`, over the replicates in which something eroded; `None` if in none.
    blocked_fraction
        Of `Run::blocked_fraction`.
    blocked_first_three_layers_fraction
        Of `Run::blocked_first_three_layers_fraction`.
    backbone_fraction
        Of `Run::backbone_fraction`.
    """

    run: int
    eroded_mass_fraction: Statistic
    eroded_number_fraction: Statistic
    largest_eroded_over_d15f: Optional[Statistic]
    blocked_fraction: Statistic
    blocked_first_three_layers_fraction: Statistic
    backbone_fraction: Statistic


class _Stopping(TypedDict):
    target_error_pp: Optional[float]
    decide_percent: Optional[float]
    most: int
    looks: int
    met: bool
    verdict: Optional[Literal["no erosion", "some erosion", "continuing erosion", "undecided"]]
    half_width_pp: Optional[float]


class Stopping(_Stopping, total=False):
    """What a rule that adds replicates until they are enough arrived at.

    Keys
    ----
    target_error_pp
        Target half width of the 95 % interval of the eroded mass, in every run (percentage points of the base).
    decide_percent
        Confidence level at which the verdict was to be decided (%), corrected for repeated looks.
    most
        Replicates at which it stops in any case.
    looks
        How often it looked at the replicates.
    met
        Whether what was asked for is reached.
    verdict
        The verdict at that confidence level, where one was asked for.
    half_width_pp
        Widest half of the 95 % intervals of the eroded mass (percentage points); `None` with one replicate.
    short_of
        Why it is not reached.
    """

    short_of: Optional[Union[Literal["second_run"], Dict[str, Dict[str, Union[int, float, Optional[int]]]], Dict[str, Dict[str, Union[float, int]]]]]


class _LeftOut(TypedDict):
    id: str


class LeftOut(_LeftOut, total=False):
    """A part of the program that a scene does not need, or a study of which nothing is walked.

    Keys
    ----
    id
        Its name.
    numbers
        Its numbers; missing without any.
    """

    numbers: object


class FilterRecord(TypedDict):
    """The filter: its gradation by mass and its constrictions by number.

    Keys
    ----
    name
        As the user calls it.
    attribution
        Whom to credit for the constriction curve; empty for the user's own.
    cu
        D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    d0_mm
        Smallest grain.
    d15_mm
        15 % finer by mass.
    d50_mm
        50 % finer by mass.
    d50_by_number_mm
        50 % finer by number: the distance from void to void.
    d85_mm
        85 % finer by mass.
    void_ratio
        Volume of voids over volume of grains, where known.
    gradation
        Rows of (size, percent finer by mass), sizes ascending.
    constrictions
        Rows of (diameter, percent smaller by number), diameters ascending.
    cu_csd
        Dc60 / Dc10 by number.
    curve_name
        Name of the constriction curve.
    """

    name: str
    attribution: str
    cu: Optional[float]
    d0_mm: float
    d15_mm: float
    d50_mm: float
    d50_by_number_mm: float
    d85_mm: float
    void_ratio: Optional[float]
    gradation: List[List[float]]
    constrictions: List[List[float]]
    cu_csd: float
    curve_name: str


class SampledBase(TypedDict):
    """A base before it was regraded.

    Keys
    ----
    d85_mm
        85 % finer by mass.
    d95_mm
        95 % finer by mass.
    d100_mm
        Largest particle.
    gradation
        Rows of (size, percent finer by mass), sizes ascending.
    """

    d85_mm: Optional[float]
    d95_mm: Optional[float]
    d100_mm: float
    gradation: List[List[float]]


class _BaseRecord(TypedDict):
    name: str
    cu: Optional[float]
    d0_mm: float
    d15_mm: Optional[float]
    d50_mm: Optional[float]
    d85_mm: float
    d95_mm: float
    d100_mm: float
    tail_mass_fraction: float
    gradation: List[List[float]]


class BaseRecord(_BaseRecord, total=False):
    """The base soil.

    Keys
    ----
    name
        As the user calls it.
    cu
        D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    d0_mm
        Smallest particle.
    d15_mm
        15 % finer by mass.
    d50_mm
        50 % finer by mass.
    d85_mm
        85 % finer by mass.
    d95_mm
        95 % finer by mass.
    d100_mm
        Largest particle.
    tail_mass_fraction
        Pan fraction (finer than the finest sieve) by mass; counted as passive.
    regraded_at_mm
        The size that it was regraded on before it was walked; `None` where it is walked as it is.
    as_sampled
        The base as it was sampled, where it was regraded before it was walked.
    gradation
        Rows of (size, percent finer by mass), sizes ascending.
    """

    regraded_at_mm: Optional[float]
    as_sampled: Optional[SampledBase]


class _NetworkRecord(TypedDict):
    kind: Literal["cubic", "connected", "file", "graph"]
    name: str
    nx: Optional[int]
    ny: Optional[int]
    nz: Optional[int]
    voids: int
    constrictions: int
    start_nodes: int
    layers: int
    thickness_mm: Optional[float]


class NetworkRecord(_NetworkRecord, total=False):
    """The void network.

    Keys
    ----
    kind
        Where it comes from.
    name
        As the user calls it.
    nx
        Voids along x; `None` for a network from a file.
    ny
        Voids along y.
    nz
        Voids along z, the direction of flow.
    voids
        Number of voids.
    constrictions
        Number of constrictions.
    start_nodes
        Number of voids in which base particles start.
    layers
        Number of layers.
    connectivity
        Rows of (connectivity, percent of the voids), rising; empty where all voids have the same.
    thickness_mm
        Modelled filter thickness: layers times D50F by number, or copies of a packing; `None` where a layer has
        no thickness.
    copies
        Equal copies of a packing, one behind the other; `None` but for a graph.
    """

    connectivity: List[List[float]]
    copies: Optional[int]


class Inputs(TypedDict):
    """What went in.

    Keys
    ----
    filter
        The filter and its constrictions.
    base
        The base soil.
    network
        The void network.
    mass_ratio
        Mass of base over mass of filter, `F_base` of Eq. (2).
    inject_share
        Share of `n_base` inserted in each increment.
    scale_free
        Whether sizes are multiples of D0F instead of mm.
    """

    filter: FilterRecord
    base: BaseRecord
    network: NetworkRecord
    mass_ratio: Optional[float]
    inject_share: float
    scale_free: bool


class NetworkSummary(TypedDict):
    """The network that was walked, where its constrictions have no direction of their own.

    Keys
    ----
    kind
        `lattice`, `graph` or `file`.
    exit
        How particles chose among the exits of a void: `flux`, `area-along-flow` or `height`.
    voids
        Voids.
    constrictions
        Constrictions, each counted once.
    inlets
        Ways in from the reservoir.
    copies
        Equal copies of a packing, one behind the other; `None` for a lattice.
    layers
        Layers of voids.
    thickness_mm
        Modelled filter thickness (mm).
    k0_m2
        Permeability of the clean filter (m2); `None` where no water flows, or where lengths have no unit.
    k0_m_per_s
        Hydraulic conductivity of the clean filter for water of 10 C (m/s), likewise.
    """

    kind: str
    exit: str
    voids: int
    constrictions: int
    inlets: int
    copies: Optional[int]
    layers: int
    thickness_mm: Optional[float]
    k0_m2: Optional[float]
    k0_m_per_s: Optional[float]


class Ratios(TypedDict):
    """The ratios of characteristic sizes.

    Keys
    ----
    d15f_over_d85b
        D15F / D85B.
    d15f_over_d95b
        D15F / D95B.
    """

    d15f_over_d85b: float
    d15f_over_d95b: float


#: The name of what a rule says.
RuleNoteId = Literal[
    "needs_fines_of_base",
    "needs_d85_b",
    "needs_d95_b",
    "needs_d15_b",
    "needs_d15_f",
    "needs_d15_f_sieved",
    "needs_d10_f",
    "needs_fines_of_filter",
    "needs_sieves_of_filter",
    "needs_finest_part_of_filter",
    "needs_curve_of_filter",
    "needs_curve_of_filter_in_mm",
    "needs_test_of_dispersive",
    "needs_erosion",
    "d15_f_between",
    "d15_b_between",
    "d85_b_between",
    "d95_b_between",
    "filter_between",
    "base_between",
    "flat_base",
    "dispersive",
    "category",
    "regraded_on",
    "before_regrading",
    "taken_as_sand",
    "result_of_model",
    "beyond_any_limit",
    "no_clear_boundary",
    "beyond_unclear_boundary",
    "excessive_not_judged",
    "by_fines",
    "floor_governs",
    "least_governs",
    "d15_f_at_most",
    "limit_at_most",
    "limit_at_least",
    "cu_at_least",
    "finest_sieve_of_filter",
    "at_percent_finer",
    "band_from",
    "joint",
    "less_than_source",
    "checks_walk",
    "far_finer_than_tests",
    "kezdi_at",
    "kezdi_splits",
    "kezdi_hidden",
    "shape_at",
    "shape_above_pan",
    "burenkova_range",
    "wan_fell_sand",
    "wan_fell_silt",
    "wan_fell_contours",
    "limits_by_fines",
    "burenkova_soils",
    "burenkova_third_zone",
    "uniform_filter",
]


class _RuleNote(TypedDict):
    id: RuleNoteId


class RuleNote(_RuleNote, total=False):
    """What a rule says beside its result.

    Keys
    ----
    id
        Its name.
    numbers
        Its number, or its numbers in order; missing without any.
    """

    numbers: object


class WithoutFiner(TypedDict):
    """What is left of a filter without its finer part.

    Keys
    ----
    percent
        The part that is taken out (% of the filter's mass).
    d15f
        15 % finer of what is left (mm, or D0F where sizes have no unit).
    """

    percent: float
    d15f: float


class _AppliedRule(TypedDict):
    id: str
    name: str
    role: Literal["retention", "continuation", "drainage", "placing", "stability", "walk"]
    applies: bool
    quantity: Union[Literal["D15F", "D15F/D85B", "D15F/D95B"], str]
    value: Optional[float]
    limit: Optional[float]
    unit: str
    at_least: bool
    met: Optional[bool]
    needs: List[RuleNote]
    notes: List[RuleNote]
    applies_to: str
    formula: str
    source: str


class AppliedRule(_AppliedRule, total=False):
    """A filter rule, applied.

    Keys
    ----
    id
        Its name for programs, as `sherard-dunnigan`.
    name
        Whose rule it is, and what it says.
    authority
        Whose rule it is; empty where nobody is cited.
    stated_by
        Authorities whose texts state it besides; may be empty.
    role
        What it is a rule of.
    applies
        Whether it was made for these soils.
    quantity
        What it limits, as `D15F/D85B`.
    value
        Its value for these inputs; `None` where they do not give it.
    value_bound
        On which side of `value` the true one lies, where sieves give only a bound; `None` where it is the value
        itself.
    limit
        The most, or the least, that the rule allows; `None` where no number is known.
    unit
        Unit of value and limit: `mm`, `D0F`, `%`; empty for a ratio.
    at_least
        Whether `limit` is the least that the rule allows instead of the most.
    limit_at_most
        Whether the true limit is not known, and is at most `limit`; on either side of it where `needs` names
        sieves that stand far apart.
    met
        Whether the value keeps the limit; `None` where the rule has no result. Of a rule of continuing erosion
        `true` says only that this is not reached: some or excessive erosion is not excluded.
    needs
        What is missing for a result; may be empty.
    notes
        Where the value is, why the rule was not made for these soils; may be empty.
    applies_to
        What the rule was made for.
    formula
        Its limit in words.
    source
        Where the rule is published.
    without_finer
        What is left of the filter without the greatest part that it may lose by a rule of internal stability;
        `None` of other rules.
    filter_curve
        Which curve of the filter it read, where that is an envelope of several.
    base_curve
        Which curve of the base it read, where that is an envelope of several.
    """

    authority: str
    stated_by: List[str]
    value_bound: Optional[Literal["at most", "at least"]]
    limit_at_most: bool
    without_finer: Optional[WithoutFiner]
    filter_curve: str
    base_curve: str


class InfiltrationSize(TypedDict):
    """One size of the base in the clean filter.

    Keys
    ----
    name
        As `D85B`.
    diameter_mm
        Its size.
    downstream
        P(F): probability that it moves one layer downstream.
    layers_95
        Layers that it does not pass, with a confidence of 95 %; `None` where nothing stops it.
    layers_99
        Layers that it does not pass, with a confidence of 99 %.
    through
        Probability that it passes all layers.
    """

    name: str
    diameter_mm: float
    downstream: float
    layers_95: Optional[float]
    layers_99: Optional[float]
    through: float


class Infiltration(TypedDict):
    """Eq. (1) of the paper: how far single particles come in the clean filter.

    Keys
    ----
    layers
        Layers of the network.
    sizes
        Sizes of the base, ascending.
    coarsest_through_mm
        The coarsest size that passes all layers with a probability of 5 %.
    eroded_without_blocking
        Share of the base's mass that would leave if nothing were ever blocked.
    """

    layers: int
    sizes: List[InfiltrationSize]
    coarsest_through_mm: float
    eroded_without_blocking: float


class _CurveEnd(TypedDict):
    curve: str
    dc50_factor: float
    replicates: int
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    runs: List[Statistic]


class CurveEnd(_CurveEnd, total=False):
    """The replicates walked with another constriction curve, all else and all random numbers the same.

    Keys
    ----
    curve
        Which curve it is, in words.
    dc50_factor
        Its median constriction by that of the curve itself.
    replicates
        How many replicates were walked.
    stopped_when_clear
        Whether it was clear before all replicates of a study were walked: its intervals then take twice the
        scatter of the scene's own replicates, or its own where that is wider (`crate::outcome::early_stop`).
    verdict
        Their class.
    runs
        Eroded mass fraction, one per run.
    """

    stopped_when_clear: bool


class _CurveRange(TypedDict):
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    ends: List[CurveEnd]
    eroded_mass_fraction: List[List[float]]


class CurveRange(_CurveRange, total=False):
    """The walks at the ends of the range of a constriction curve.

    Keys
    ----
    verdict
        The class by the curve itself.
    ends
        The other curves of the range: its ends.
    worst_counts
        Whether the worst class of the range is the verdict, as for a filter of which loose and dense are
        walked; elsewhere ends that differ leave it undecided.
    could_be
        The worst class that the walks of the range allow, at the confidence level of the verdict, where one was
        asked for; without one it follows from the 95 % intervals.
    eroded_mass_fraction
        Least and most eroded over the whole range, one pair per run: the ends of the 95 % intervals, or the
        means of a single replicate (fraction of the mass).
    """

    worst_counts: bool
    could_be: Optional[Literal["no erosion", "some erosion", "continuing erosion", "undecided"]]


class ArchingByVoidRecord(TypedDict):
    """How the concentration of each void is worked out.

    Keys
    ----
    void_mm
        Diameter of a sphere with the volume of a void, mm.
    size
        Which size counts: "own", "void-mean" or "void-d85".
    """

    void_mm: float
    size: str


class _ArchingRecord(TypedDict):
    law: str
    source: str
    basis: str
    range_of_ratio: List[float]
    concentration: Optional[float]


class ArchingRecord(_ArchingRecord, total=False):
    """A law by which particles arch in a constriction that they fit.

    Keys
    ----
    law
        Its name in a scene.
    source
        Where it was published.
    basis
        What of the source was read, and what was assumed.
    range_of_ratio
        Sizes of a constriction by that of a particle between which arches form.
    concentration
        Volume of particles by volume of voids with which the base arrives; `None` where the law is of dense
        flow, or where each void has its own.
    by_void
        How the concentration of each void is worked out, where it is.
    """

    by_void: Optional[ArchingByVoidRecord]


class _Sensitivity(TypedDict):
    factor: float
    n_base: int
    grains_per_void: Optional[float]
    mass_ratio: Optional[float]
    replicates: int
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    runs: List[Statistic]


class Sensitivity(_Sensitivity, total=False):
    """The outcome with another number of base particles. `N_base` holds grains per void and mass ratio only as a
    product (Eq. 2), so one factor answers for both.

    Keys
    ----
    factor
        Multiple of the outcome's own `n_base`.
    n_base
        Base particles inserted in each run.
    grains_per_void
        Grains per void to which this factor corresponds at the scene's mass ratio.
    mass_ratio
        Mass ratio to which this factor corresponds at the scene's grains per void.
    replicates
        How many replicates were walked.
    stopped_when_clear
        Whether it was clear before all replicates of a study were walked: its intervals then take twice the
        scatter of the scene's own replicates, or its own where that is wider (`crate::outcome::early_stop`).
    verdict
        Their class.
    runs
        Eroded mass fraction, one per run.
    """

    stopped_when_clear: bool


class _OfThickness(TypedDict):
    factor: float
    layers: int
    thickness_mm: Optional[float]
    n_base: int
    replicates: int
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    runs: List[Statistic]


class OfThickness(_OfThickness, total=False):
    """The same case with a filter of this thickness.

    Keys
    ----
    factor
        Multiple of the outcome's own thickness.
    layers
        Layers of voids along the flow.
    thickness_mm
        Modelled thickness (mm, or D0F as all its sizes); `None` where a layer has none.
    n_base
        Base particles inserted in each run.
    replicates
        How many replicates were walked.
    stopped_when_clear
        Whether it was clear before all replicates of a study were walked: its intervals then take twice the
        scatter of the scene's own replicates, or its own where that is wider (`crate::outcome::early_stop`).
    verdict
        Their class.
    runs
        Eroded mass fraction, one per run.
    """

    stopped_when_clear: bool


class _Outcome(TypedDict):
    format: Literal["voidwalk-outcome/1"]
    voidwalk: str
    model: Model
    notes: List[Note]
    constrictions: ConstrictionsRecord
    seed: int
    n_base: int
    n_base_eq2: Optional[int]
    capped: bool
    grains_per_void: Optional[float]
    engine: str
    replicates: List[Replicate]
    summary: List[RunSummary]
    threshold: float
    left_out: List[LeftOut]
    model_leaves_out: List[Literal["hydraulics", "hydraulics_elsewhere", "gradient", "gradient_there", "bridging", "partial_clogging", "supply", "excessive", "cohesion"]]
    inputs: Inputs
    ratios: Ratios
    rules: List[AppliedRule]
    sensitivity: List[Sensitivity]
    digest: str
    seconds: float


class Outcome(_Outcome, total=False):
    """The whole of `outcome.json`.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    headline
        The answer of filter practice; `None` without two sieve curves in mm.
    practice
        What filter practice says of the pair, without the walk; `None` likewise.
    model
        What the walk says, without practice.
    notes
        What else to know, in the order of every face.
    if_dispersive
        What practice allows if the base is dispersive; `None` where somebody has said whether it is, and where
        it has few fines.
    constrictions
        Where the constrictions come from.
    seed
        The user's seed.
    n_base
        Base particles inserted in each run.
    n_base_eq2
        Base particles by Eq. (2), before any cap or user's number; `None` where the grains per void are not
        given.
    capped
        Whether a cap made `n_base` smaller than `n_base_eq2`.
    grains_per_void
        Filter grains per void, `N_p / N_voids` of Eq. (2), where given.
    engine
        Name of the engine that walked.
    replicates
        One per replicate, in order.
    summary
        One per run, in order: statistics over the replicates.
    stopping
        Why there are so many replicates, where a rule added them.
    threshold
        Eroded mass fraction that divides the classes: 0.075.
    left_out
        Parts of the program that this scene did not need.
    model_leaves_out
        What the model does not contain, for any scene.
    inputs
        What went in, resolved.
    network
        The network, where its constrictions have no direction of their own.
    ratios
        The ratios that filter rules use.
    rules
        Empirical filter rules applied to the same two curves.
    infiltration
        Eq. (1) for single particles; `None` where the network is no cubic lattice.
    curve_range
        What comes of the other constriction curves that the filter may have; `None` where its curve was given,
        or measured on the whole filter.
    arching
        The law by which particles arched; `None` where they did not.
    sensitivity
        How the verdict moves with the number of base particles; empty when it was not asked for.
    thickness
        How the verdict moves with the thickness of the filter, itself included; empty when it was not asked
        for.
    studies_to_come
        Whether both studies are still being walked, or their walk was ended: `voidwalk resume` goes on.
    digest
        Digest of its numbers, equal wherever a scene and seed give the same numbers: XXH3 with 128 bits, in
        hexadecimal, of every number, `true`, `false` and `null` with its place. Left out are text, `seconds`
        and `studies_to_come`.
    seconds
        Wall time of everything, s; in a campaign beside other cases on the same threads.
    """

    headline: Optional[Headline]
    practice: Optional[Practice]
    if_dispersive: Optional[IfDispersive]
    stopping: Optional[Stopping]
    network: Optional[NetworkSummary]
    infiltration: Optional[Infiltration]
    curve_range: Optional[CurveRange]
    arching: Optional[ArchingRecord]
    thickness: List[OfThickness]
    studies_to_come: bool


class GivenNetwork(TypedDict):
    """Networks that were given; where there are several, the numbers are those of the first.

    Keys
    ----
    networks
        Networks that the replicates took in turn.
    exit
        How particles chose among the exits of a void.
    voids
        Voids.
    constrictions
        Constrictions, each counted once.
    layers
        Layers of voids.
    diameters
        Rows of (diameter, percent smaller by number) of its open constrictions, diameters ascending (mm).
    """

    networks: int
    exit: str
    voids: int
    constrictions: int
    layers: int
    diameters: List[List[float]]


class WalkOutcome(TypedDict):
    """The results of `crate::run::walk_networks`; the names are those of `outcome.json` where both have them.

    Keys
    ----
    verdict
        The class that the replicates together support.
    notes
        What else to know, in the order of every face.
    seed
        The user's seed.
    n_base
        Base particles inserted in each run.
    n_base_eq2
        Those that Eq. (2) gives, where the filter and its grains per void are known.
    grains_per_void
        Filter grains per void, where they are known.
    mass_ratio
        Mass of the base over that of the filter, of Eq. (2).
    increments
        Equal parts in which they were inserted.
    engine
        Name of the engine that walked.
    replicates
        One per replicate, in order.
    summary
        One per run, in order: statistics over the replicates.
    threshold
        Eroded mass fraction that divides the classes: 0.075.
    left_out
        Parts of the program that this walk did not need.
    model_leaves_out
        What the model does not contain.
    base
        The base.
    d15f_mm
        15 % of the filter finer by mass (mm), where the filter is known.
    network
        What was walked through.
    version
        Version of the program.
    """

    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    notes: List[Note]
    seed: int
    n_base: int
    n_base_eq2: Optional[int]
    grains_per_void: Optional[float]
    mass_ratio: float
    increments: int
    engine: str
    replicates: List[Replicate]
    summary: List[RunSummary]
    threshold: float
    left_out: List[LeftOut]
    model_leaves_out: List[Literal["hydraulics", "hydraulics_elsewhere", "gradient", "gradient_there", "bridging", "partial_clogging", "supply", "excessive", "cohesion"]]
    base: BaseRecord
    d15f_mm: Optional[float]
    network: GivenNetwork
    version: str


class SheetCover(TypedDict, total=False):
    """The cover of a sheet, as its author states it.

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
        The date on the sheet: the one that is stated, else the day of its results.
    """

    project: Optional[str]
    number: Optional[str]
    purpose: Optional[str]
    client: Optional[str]
    author: Optional[str]
    checker: Optional[str]
    revision: Optional[str]
    date: Optional[str]


class InputFile(TypedDict):
    """A file that was read.

    Keys
    ----
    name
        Its name as given.
    xxh3
        XXH3 of its bytes, hexadecimal. Finds accidents, not attackers.
    """

    name: str
    xxh3: str


class _SpecifiedCurve(TypedDict):
    curve: str
    gradation: List[List[float]]
    d15_mm: Optional[float]
    regraded_at_mm: Optional[float]
    d85_mm: Optional[float]
    fines_percent: Optional[float]
    category: Optional[int]
    d15f_max_mm: Optional[float]
    d15f_max_rule: str
    d15f_min_mm: Optional[float]


class SpecifiedCurve(_SpecifiedCurve, total=False):
    """A curve of the base, and the limits of D15F that follow from it.

    Keys
    ----
    curve
        Its name.
    gradation
        Size (mm) and percent finer by mass, as sampled.
    regraded
        The same after regrading; empty where it is not regraded.
    d15_mm
        D15 (mm) before regrading; `None` where it is finer than the finest sieve.
    regraded_at_mm
        The size on which it was regraded (mm).
    d85_mm
        D85 (mm) after regrading.
    fines_percent
        Percent finer than 0.075 mm after regrading.
    category
        Category of NRCS, 1 to 4.
    d15f_max_mm
        Maximum D15F (mm) that retains it; `None` where it is not known.
    d15f_max_rule
        The rule that sets it.
    without_margin
        Whether that maximum has no margin: tests showed no erosion up to it and no further, or erosion below
        it.
    d15f_min_mm
        Minimum D15F (mm) that drains it.
    """

    regraded: List[List[float]]
    without_margin: bool


class _RowNote(TypedDict):
    id: NoteId
    numbers: Dict[str, object]


class RowNote(_RowNote, total=False):
    """A note on a row of a design, or on a curve of the base for which a filter is specified.

    Keys
    ----
    row
        The row or the curve that it is of, in words; `None` where it is of all.
    id
        Its name.
    numbers
        Its numbers by name, with the unit in the name.
    """

    row: Optional[str]


class StepValue(TypedDict):
    """A number of a step.

    Keys
    ----
    name
        What it is, as `maximum D15F`.
    value
        The number; `None` where it is not known.
    unit
        Its unit: `mm`, `%`; empty for a ratio or a count.
    """

    name: str
    value: Optional[float]
    unit: str


class _RegradeCause(TypedDict):
    id: Literal["gap", "gap_among_gravel", "gravel_and_fines", "broad_gravel", "gravel_of_unknown_cu", "narrow_gravel", "no_gravel", "no_unit"]


class RegradeCause(_RegradeCause, total=False):
    """What of a soil has it regraded, or not.

    Keys
    ----
    id
        `gap`: It has a gap that begins at this size (mm). `gap_among_gravel`: It has a gap that begins at this
        size (mm), and what is finer would be regraded for its gravel. `gravel_and_fines`: It has gravel and
        many fines. `broad_gravel`: It has gravel and is broadly graded. `gravel_of_unknown_cu`: It has gravel,
        and Cu is not known. `narrow_gravel`: It has gravel, few fines, and is not broadly graded. `no_gravel`:
        It has no gravel. `no_unit`: Its sizes have no unit.
    from_mm
        It has a gap that begins at this size (mm).
    """

    from_mm: float


class RegradeReason(TypedDict):
    """Why practice regrades a base, or leaves it as it is.

    Keys
    ----
    cause
        What practice asks of the soil.
    nothing_passes
        Whether it was to be regraded and is left as it is, as none of its known sizes passes the sieve.
    """

    cause: RegradeCause
    nothing_passes: bool


class _StepNote(TypedDict):
    id: Literal["curves", "gravel", "not_regraded", "set_by", "limit_not_known", "drainage_at_most", "of_rule", "raised", "lowered", "stability"]


class StepNote(_StepNote, total=False):
    """What else to know of a step.

    Keys
    ----
    id
        `curves`: Curves of the base. `gravel`: Gravel and gaps of a curve. `not_regraded`: No curve is
        regraded. `set_by`: The rule, and of several curves the one, that sets a limit. `limit_not_known`: The
        limit of a curve is not known. `drainage_at_most`: D15B is finer than the finest sieve, and the minimum
        D15F at most the one given. `of_rule`: What the rule says besides. `raised`: The minimum D15F is raised.
        `lowered`: The maximum D15F is lowered. `stability`: Internal stability of a side.
    curves
        How many.
    curve
        Its name, where there are several.
    why
        Why it is regraded, or not.
    flattest
        Size (mm) from which the least mass lies within a factor of 4, and that mass (%); `None` where its
        sieves do not tell.
    rule
        The rule; `None` where the step has one alone.
    needs
        What is missing.
    notes
        Its notes.
    side
        `fine` or `coarse`.
    is_known
        Whether both indices are known.
    not_kept
        Whose rules it does not keep.
    """

    curves: int
    curve: Optional[str]
    why: RegradeReason
    flattest: Optional[List[float]]
    rule: Optional[str]
    needs: List[RuleNote]
    notes: List[RuleNote]
    side: str
    is_known: bool
    not_kept: List[str]


class _SpecificationStep(TypedDict):
    step: int
    does: Literal["plot", "find_gravel", "regrade", "place", "retain", "drain", "narrow", "keep_uniform", "limit_ends", "keep_from_segregating", "draw", "check_stability"]
    formula: str
    values: List[StepValue]
    source: str


class SpecificationStep(_SpecificationStep, total=False):
    """A step of the procedure.

    Keys
    ----
    step
        Its number, from 1.
    does
        What is done.
    formula
        The formula; empty where nothing is worked out.
    values
        Its numbers.
    notes
        What else to know.
    source
        Where formula and numbers were read; empty where nothing is worked out.
    """

    notes: List[StepNote]


class BandSize(TypedDict):
    """A size of both sides of a band.

    Keys
    ----
    percent
        Percent finer.
    min_mm
        Least size (mm), of the fine side.
    max_mm
        Greatest size (mm), of the coarse side.
    """

    percent: float
    min_mm: float
    max_mm: float


class SizeBand(TypedDict):
    """The two sides of a band as sizes.

    Keys
    ----
    sizes
        D5, D15 and D60 of both sides.
    fine_side
        The fine side up to its D60: size (mm) and percent finer, rising. No text was read for what lies above.
    coarse_side
        The coarse side, likewise.
    """

    sizes: List[BandSize]
    fine_side: List[List[float]]
    coarse_side: List[List[float]]


class _NoBand(TypedDict):
    id: Literal["drainage_not_known", "none_drains_and_retains", "too_many_fines", "too_coarse", "limit_not_known", "no_rule"]


class NoBand(_NoBand, total=False):
    """Why there is no band.

    Keys
    ----
    id
        `drainage_not_known`: Of the minimum D15F only the most is known, and it is above the maximum.
        `none_drains_and_retains`: The minimum D15F is above the maximum. `too_many_fines`: The coarse side
        would have too many fines. `too_coarse`: The maximum D60F lies beyond the greatest size.
        `limit_not_known`: The maximum D15F of a curve is not known. `no_rule`: No rule of retention covers the
        base.
    most_drains_mm
        The most that the minimum can be (mm).
    most_mm
        The maximum (mm).
    least_mm
        The minimum (mm).
    most_d60f_mm
        The maximum D60F (mm).
    curve
        The curve of the base.
    needs
        What is missing.
    """

    most_drains_mm: float
    most_mm: float
    least_mm: float
    most_d60f_mm: float
    curve: str
    needs: List[RuleNote]


class SieveLimit(TypedDict):
    """What a delivery may have finer than a sieve. A row of `specification.csv`.

    Keys
    ----
    sieve
        Name of the sieve.
    opening_mm
        Its opening (mm).
    min_percent_finer
        Least percent finer, of the coarse side: a whole percent within the band; tenths or hundredths where no
        whole percent lies within.
    max_percent_finer
        Greatest percent finer, of the fine side, likewise; `None` above its D60.
    """

    sieve: str
    opening_mm: float
    min_percent_finer: float
    max_percent_finer: Optional[float]


class _NotKept(TypedDict):
    id: Literal["cu_of_fine_side", "cu_of_coarse_side", "width", "fines", "greatest_size"]


class NotKept(_NotKept, total=False):
    """What a product does not keep of what a band is asked for beside D15F.

    Keys
    ----
    id
        `cu_of_fine_side`: Cu of its fine side. `cu_of_coarse_side`: Cu of its coarse side. `width`: Its sides
        lie too far apart. `fines`: It may have too many fines. `greatest_size`: It may have grains that are too
        coarse.
    cu
        That Cu.
    ratio
        Coarse over fine side at the same percent finer, at most.
    percent
        Percent finer than 0.075 mm, at most.
    """

    cu: float
    ratio: float
    percent: float


class ProductMargin(TypedDict):
    """A standard product beside a specification. A row of `specification_products.csv`.

    Keys
    ----
    product
        Its name.
    d15_fine_mm
        D15 (mm) of its fine side.
    d15_coarse_mm
        D15 (mm) of its coarse side.
    drains_by
        D15 of its fine side over the least that drains: at least 1 where it drains. `None` where it is not
        known whether it drains.
    holds_by
        The maximum D15F over D15 of its coarse side: at least 1 where it holds.
    not_kept
        What its two sides do not keep of the other requirements: Cu, width of the band, fines, greatest size;
        empty where they keep all.
    source
        Where its limits were read.
    """

    product: str
    d15_fine_mm: float
    d15_coarse_mm: float
    drains_by: Optional[float]
    holds_by: Optional[float]
    not_kept: List[NotKept]
    source: str


class _Specification(TypedDict):
    format: Literal["voidwalk-specification/1"]
    voidwalk: str
    version: str
    base: str
    dispersive: bool
    sieves: Literal["us", "iso"]
    curves: List[SpecifiedCurve]
    steps: List[SpecificationStep]
    d15f_min_mm: Optional[float]
    d15f_max_mm: Optional[float]
    band: Optional[SizeBand]
    limits: List[SieveLimit]
    products: List[ProductMargin]


class Specification(_Specification, total=False):
    """The whole of `specification.json`.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    version
        Version of voidwalk.
    commit
        The commit that it was built from; `None` where that is not known.
    base
        Name of the base.
    dispersive
        Whether it was said to be dispersive.
    sieves
        The sieves at which the limits are stated.
    cover
        What its sheet says of itself; nothing as a part of a design.
    inches
        Whether inches stand beside mm on its page.
    inputs
        Every file that was read; empty as a part of a design, which has them itself.
    curves
        The curves of the base, in the order of the file.
    notes
        What a reader must know of the base itself, each of its curve where there are several, and of a side of
        the band that is not stable.
    steps
        Every step, with its numbers.
    d15f_min_mm
        Minimum D15F (mm) that drains the base; `None` where it is not known.
    d15f_min_at_most
        Whether the true least is not known, and is at most that.
    finer
        Whether the band lies at the finer end of what is allowed, and not at the coarser.
    d15f_max_mm
        Maximum D15F (mm) that is allowed; `None` where it is not known.
    if_dispersive
        What practice allows if the base is dispersive; `None` where somebody has said whether it is, and where
        it has few fines.
    band
        The band; `None` where there is none.
    no_band
        Why there is no band.
    limits
        Percent finer at each sieve, the coarsest first; empty without a band.
    products
        Standard products beside it; empty where neither limit of D15F is known.
    """

    commit: Optional[str]
    cover: SheetCover
    inches: bool
    inputs: List[InputFile]
    notes: List[RowNote]
    d15f_min_at_most: bool
    finer: bool
    if_dispersive: Optional[IfDispersive]
    no_band: Optional[NoBand]


class Range(TypedDict):
    """Median and band of a size (mm).

    Keys
    ----
    median
        Median over networks.
    low
        5 percentile.
    high
        95 percentile.
    """

    median: float
    low: Optional[float]
    high: Optional[float]


class _Boundary(TypedDict):
    median: float
    low: Optional[float]
    high: Optional[float]
    d15f_mm: Optional[Range]


class Boundary(_Boundary, total=False):
    """A boundary over networks: D15F/D85B, and the same in mm.

    Keys
    ----
    median
        Median over networks.
    low
        5 % of networks lie below; `None` where that hangs on networks beyond the search, and of one network.
    high
        5 % of networks lie above; `None` likewise.
    low_beyond
        On which side of the search the 5 percentile lies, where it lies beyond: below, networks erode at every
        ratio that was searched.
    d15f_mm
        D15F (mm) of the filter, where the base has a size.
    """

    low_beyond: Optional[Literal["below", "above"]]


class NetworkBoundaries(TypedDict):
    """What one network says; `None` where its boundary lies beyond the search.

    Keys
    ----
    network
        Network, counted from 1.
    no_erosion
        D15F/D85B from which its first run erodes.
    continuing
        D15F/D85B from which its second run does.
    """

    network: int
    no_erosion: Optional[float]
    continuing: Optional[float]


class _BoundaryRow(TypedDict):
    density: str
    thickness: str
    layers: int
    thickness_mm: Optional[float]
    grains_per_void: Optional[float]
    no_erosion: Optional[Boundary]
    continuing: Optional[Boundary]
    not_monotone: int
    networks: List[NetworkBoundaries]


class BoundaryRow(_BoundaryRow, total=False):
    """The boundaries of one density and thickness.

    Keys
    ----
    density
        How densely the filter is packed.
    thickness
        The thickness that was asked for, in words.
    layers
        Layers of voids, at the no-erosion boundary where the thickness is in mm.
    thickness_mm
        Thickness (mm), at the no-erosion boundary where it is in layers; `None` where sizes have no unit.
    grains_per_void
        Filter grains per void, Eq. (2).
    no_erosion
        Where no erosion turns into some; `None` where that lies beyond what can be walked.
    no_erosion_notes
        Why there is none, or what else is to be said of it.
    holds_to
        D15F/D85B to which nearly all networks hold where more than half of them hold all that was searched, so
        that there is no boundary.
    continuing
        Where some erosion turns into continuing.
    continuing_notes
        Why there is none, or what else is to be said of it.
    unsteady
        The note on a boundary that few particles decide.
    not_monotone
        Networks on which a larger ratio was seen to hold than one that erodes, in either run: their smallest
        that erodes counts.
    networks
        What each network says.
    as_end
        The end of its range whose boundaries these are: the one that holds least. A filter of unknown density
        is searched at its ends only, loose and dense.
    end_of
        The density of which this is an end of the range in which its constriction curve is known.
    """

    no_erosion_notes: List[Note]
    holds_to: Optional[float]
    continuing_notes: List[Note]
    unsteady: Optional[Note]
    as_end: Optional[str]
    end_of: Optional[str]


class _BaseStated(TypedDict):
    name: str
    cu: Optional[float]
    d15_mm: Optional[float]
    d85_mm: Optional[float]
    d95_over_d85: Optional[float]
    tail_mass_fraction: float


class BaseStated(_BaseStated, total=False):
    """What is known of the base.

    Keys
    ----
    name
        Its name.
    cu
        D60/D10.
    d15_mm
        D15 (mm) before regrading; `None` without a size of its own.
    d85_mm
        D85 (mm) as walked; `None` without a size of its own.
    d95_over_d85
        D95/D85.
    regraded_at_mm
        The size (mm) that it was regraded on before it was walked; `None` where it was walked as sampled.
    tail_mass_fraction
        The part of its mass that is finer than its finest sieve, as it was walked.
    d85_as_sampled_mm
        D85 (mm) before regrading, where it was regraded.
    """

    regraded_at_mm: Optional[float]
    d85_as_sampled_mm: Optional[float]


class _Boundaries(TypedDict):
    format: Literal["voidwalk-boundary/1"]
    voidwalk: str
    version: str
    boundaries: List[BoundaryRow]
    base: BaseStated
    filter: str
    filter_cu: Optional[float]
    filter_d15_mm: Optional[float]
    threshold: float
    replicates: int
    seed: int
    engine: str
    bracket: List[float]
    step: float
    model_leaves_out: List[Literal["hydraulics", "hydraulics_elsewhere", "gradient", "gradient_there", "bridging", "partial_clogging", "supply", "excessive", "cohesion"]]
    settings: List[str]
    seconds: float


class Boundaries(_Boundaries, total=False):
    """The whole of `boundary.json`.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    version
        Version of voidwalk.
    commit
        The commit that it was built from; `None` where that is not known.
    boundaries
        The boundaries of the model, one row per density and thickness, in the order in which they were asked
        for.
    base
        The base.
    filter
        The filter's shape in words.
    filter_cu
        Cu of the filter.
    filter_d15_mm
        The filter's own D15F (mm), where its sizes are given.
    inputs
        Every file that was read.
    threshold
        Mass eroded from which a run erodes.
    replicates
        Networks of each boundary.
    seed
        The user's seed.
    engine
        Engine that walked; `expected` moves the base particles that can block nothing as their expectation.
    bracket
        D15F/D85B between which boundaries were searched.
    step
        Steps of the search, as a part of D15F/D85B.
    notes
        What a reader must know of the model's boundaries, the weightiest first.
    model_leaves_out
        What the model does not contain.
    settings
        Settings that were given, as on the command line.
    cover
        What the sheet says of itself.
    inches
        Whether inches stand beside mm on its page.
    seconds
        Wall time (s).
    """

    commit: Optional[str]
    inputs: List[InputFile]
    notes: List[RowNote]
    cover: SheetCover
    inches: bool


class SizeThreshold(TypedDict):
    """The thresholds of one size.

    Keys
    ----
    size
        Voids along each side.
    threshold
        Share of constrictions that is open at the threshold.
    sd_error
        Standard error of the standard deviation, for normal thresholds: sd / sqrt(2 (n - 1)).
    """

    size: int
    threshold: Statistic
    sd_error: Optional[float]


class BoxThreshold(TypedDict):
    """The thresholds of a lattice that is no cube.

    Keys
    ----
    shape
        Voids along x and y, and layers.
    threshold
        Share of constrictions that is open at the threshold.
    sd_error
        Standard error of the standard deviation, as that of a size.
    """

    shape: List[int]
    threshold: Statistic
    sd_error: Optional[float]


class OneLength(TypedDict):
    """A fit of `p(L) = threshold - amplitude L^(-1 / NU_PARALLEL)`.

    Keys
    ----
    threshold
        Threshold of the infinite lattice.
    threshold_error
        Its standard error, if the relation holds.
    amplitude
        Amplitude.
    chi_squared
        Sum of squared deviations, each over its standard error.
    degrees
        Degrees of freedom.
    """

    threshold: float
    threshold_error: float
    amplitude: float
    chi_squared: float
    degrees: int


class ManyStarts(TypedDict):
    """A fit of `L d^nu = offset + slope ln(L d^(nu / z))`, `d = threshold - p(L)`.

    Keys
    ----
    threshold
        Threshold of the infinite lattice.
    threshold_low
        Lower end of its 68 % interval.
    threshold_high
        Upper end of its 68 % interval.
    offset
        Offset.
    slope
        Slope.
    chi_squared
        Sum of squared deviations, each over its standard error.
    degrees
        Degrees of freedom.
    """

    threshold: float
    threshold_low: float
    threshold_high: float
    offset: float
    slope: float
    chi_squared: float
    degrees: int


class _PercolationStudy(TypedDict):
    format: Literal["voidwalk-percolation/1"]
    voidwalk: str
    version: str
    seed: int
    realisations: int
    sizes: List[SizeThreshold]
    one_length: Optional[OneLength]
    many_starts: Optional[ManyStarts]
    sd_exponent: Optional[float]
    infinite_lattice: float
    seconds: float


class PercolationStudy(_PercolationStudy, total=False):
    """The whole of `percolation.json`.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    version
        Version of voidwalk.
    seed
        The user's seed.
    realisations
        Realisations of each size.
    sizes
        One per size, ascending.
    boxes
        One per lattice that is no cube, in order of its lengths; no relation is fitted to these.
    one_length
        The relation of one length; `None` with fewer than two sizes or realisations.
    many_starts
        The relation of many starts; `None` with fewer than four sizes, or where no threshold fits.
    sd_exponent
        Slope of ln(standard deviation) against ln(size); `None` as for `one_length`.
    infinite_lattice
        `INFINITE_LATTICE`.
    seconds
        Wall time, s.
    """

    boxes: List[BoxThreshold]


class _FilterSizes(TypedDict):
    curve: str
    d15_mm: Optional[float]
    d50_mm: Optional[float]
    d85_mm: Optional[float]
    cu: Optional[float]
    cc: Optional[float]


class FilterSizes(_FilterSizes, total=False):
    """Sizes of a filter (mm), of the curve that keeps the limit of design worst where it is an envelope; `None`
    where they lie in a finest tail of unknown size.

    Keys
    ----
    curves
        Its curves, where there are several.
    curve
        The curve that these sizes are of.
    d15_mm
        15 % finer.
    d50_mm
        50 % finer.
    d85_mm
        85 % finer.
    cu
        D60 / D10.
    cc
        D30^2 / (D10 D60).
    """

    curves: List[str]


class _BaseSizes(TypedDict):
    curve: str
    dispersive: bool
    category: Optional[int]
    fines_percent: Optional[float]
    regraded: bool
    regraded_at_mm: Optional[float]
    why: RegradeReason
    d15_mm: Optional[float]
    d85_mm: Optional[float]
    d85_as_sampled_mm: Optional[float]
    d95_mm: Optional[float]
    cu: Optional[float]
    cc: Optional[float]


class BaseSizes(_BaseSizes, total=False):
    """A base as practice describes it (mm), of the curve that keeps the limit of design worst where it is an
    envelope; `None` where a size lies in a finest tail of unknown size.

    Keys
    ----
    curves
        Its curves, where there are several.
    curve
        The curve that these sizes are of.
    dispersive
        Whether it was said to be dispersive.
    category
        Category of NRCS, 1 to 4; `None` where the fines are not known closely enough.
    fines_percent
        Percent finer than 0.075 mm after regrading.
    regraded
        Whether it was regraded.
    regraded_at_mm
        The size on which it was regraded.
    why
        Why it was regraded, or not.
    d15_mm
        15 % finer, before regrading.
    d85_mm
        85 % finer, after regrading.
    d85_as_sampled_mm
        85 % finer, before regrading.
    d95_mm
        95 % finer, after regrading.
    cu
        D60 / D10, before regrading.
    cc
        D30^2 / (D10 D60), before regrading.
    """

    curves: List[str]


class _PairRules(TypedDict):
    format: Literal["voidwalk-rules/1"]
    voidwalk: str
    filter: FilterSizes
    base: BaseSizes
    rules: List[AppliedRule]
    headline: Optional[Headline]
    practice: Optional[Practice]
    notes: List[Note]


class PairRules(_PairRules, total=False):
    """What is said of two sieve curves by the rules of practice alone.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    filter
        The filter.
    base
        The base after regrading.
    rules
        Every rule.
    headline
        The answer of practice; `None` where the limit of design was not applied.
    practice
        What practice says of the pair; `None` likewise.
    if_dispersive
        The limit of D15F if the base is dispersive, where it was not said to be and has fines enough.
    notes
        What may be wrong with the two tables, and what was taken for what.
    """

    if_dispersive: Optional[IfDispersive]


#: What was understood of a soil, and what follows from its curve.
SoilSummary = TypedDict(
    "SoilSummary",
    {
        "name": str,
        "points": List[List[float]],
        "d5_mm": Optional[float],
        "d10_mm": Optional[float],
        "d15_mm": Optional[float],
        "d30_mm": Optional[float],
        "d50_mm": Optional[float],
        "d60_mm": Optional[float],
        "d85_mm": Optional[float],
        "d90_mm": Optional[float],
        "d95_mm": Optional[float],
        "d100_mm": Optional[float],
        "cu": Optional[float],
        "cc": Optional[float],
        "fines_percent": Optional[float],
        "gravel_percent": Optional[float],
        "class": Optional[str],
        "notes": List[str],
    },
)


class Soils(TypedDict):
    """The soils of a file.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    soils
        Each soil, in the order of the file.
    """

    format: Literal["voidwalk-soils/1"]
    voidwalk: str
    soils: List[SoilSummary]


class _ConstrictionsSummary(TypedDict):
    format: Literal["voidwalk-constrictions/1"]
    voidwalk: str
    grains: int
    voids: int
    grains_per_void: float
    tetrahedra: int
    constrictions: int
    void_ratio: float
    cu_csd: float
    d0_mm: float
    dc_mm: Dict[str, object]
    mean_connectivity: float
    connectivity: List[int]
    merge_overlap: float
    counted_facets: Literal["all", "on_both_hulls"]
    cut_constrictions: int
    closed_facets: int
    hidden_grains: List[int]
    duplicate_grains: List[List[int]]


class ConstrictionsSummary(_ConstrictionsSummary, total=False):
    """The figures of a packing's constrictions, as in `constrictions.json`.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    grains
        Grains, hidden ones left out.
    voids
        Voids.
    grains_per_void
        Grains per void, N_p / N_voids of Eq. (2).
    tetrahedra
        Tetrahedra.
    constrictions
        Constrictions.
    void_ratio
        Volume of voids over volume of grains.
    cu_csd
        D_c60 / D_c10.
    d0_mm
        Smallest grain (mm).
    dc_mm
        Diameter (mm) that a percentage by number is no larger than, by that percentage.
    mean_connectivity
        Mean number of constrictions of a void.
    connectivity
        Voids by number of their constrictions, from 0.
    merge_overlap
        Overlap from which two tetrahedra share a void.
    counted_facets
        Which facets between voids were counted.
    cut_constrictions
        Constrictions whose disc a fourth grain shortened.
    closed_facets
        Facets between voids that the grains close.
    hidden_grains
        Grains that lie inside others, counted from 0.
    duplicate_grains
        Pairs of grains with the same centre.
    warnings
        What a reader must know of these grains.
    k_over_d32_squared
        Permeability along z over the square of the grains' Sauter mean d32; none without a periodic cell.
    kozeny_carman_over_d32_squared
        The same by Kozeny and Carman, (1 - c)^3 / (180 c^2) with c the solid fraction.
    """

    warnings: List[str]
    k_over_d32_squared: Optional[float]
    kozeny_carman_over_d32_squared: Optional[float]


class PackedPart(TypedDict):
    """The finer part of a filter that was packed, where the whole was not.

    Keys
    ----
    percent
        Percent of the filter's mass that is in it.
    largest_mm
        Its largest grain (mm).
    surface_left_out
        Share of the surface of all grains that the grains left out have.
    finer_by
        Its constrictions are finer than those of the whole by up to this share of their size.
    sizes_missing_above
        Whether the filter has next to no grains up to half as large again as the largest.
    """

    percent: float
    largest_mm: float
    surface_left_out: float
    finer_by: float
    sizes_missing_above: bool


class SameShape(TypedDict):
    """Where a packing was taken from that another scene's filter of the same shape had been packed into.

    Keys
    ----
    folder
        Its folder.
    factor
        What its sizes were multiplied with.
    """

    folder: str
    factor: float


class Measure(TypedDict):
    """Observables of one instant.

    Keys
    ----
    void_ratio
        Volume of the voids by that of the grains.
    pressure_kpa
        Mean contact pressure (kPa).
    coordination
        Mean coordination number `2 N_c / N_p`, over all grains.
    coordination_held
        Mean coordination number among the grains that are held: with at least two contacts (four without
        friction) with held grains.
    rattlers
        Rattler fraction: grains that are not held, by all grains.
    kinetic_ratio
        Kinetic by elastic energy.
    unbalanced
        Root mean square unbalanced force of a grain by the mean normal contact force.
    largest_overlap
        Largest overlap by the smaller diameter of its two grains.
    """

    void_ratio: float
    pressure_kpa: float
    coordination: float
    coordination_held: float
    rattlers: float
    kinetic_ratio: float
    unbalanced: float
    largest_overlap: float


class _PackingRecord(TypedDict):
    format: Literal["voidwalk-packing/1"]
    voidwalk: str
    fingerprint: str
    grains_xxh3: str
    name: str
    linear: bool
    cu: Optional[float]
    gradation: List[List[float]]
    grains: int
    seed: int
    friction: float
    final_friction: float
    pressure_kpa: float
    settings: Dict[str, object]
    before: Measure
    after: Measure
    steps: int
    simulated_s: float
    seconds: float
    cell_mm: float
    inscribed: List[List[List[float]]]
    slice: List[List[float]]


class PackingRecord(_PackingRecord, total=False):
    """The whole of `packing.json`.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    fingerprint
        Fingerprint of everything that the grains follow from: gradation, settings and protocol.
    grains_xxh3
        XXH3 of `grains.csv`.
    name
        The gradation in words.
    linear
        Whether the gradation is linear on semi-log paper.
    cu
        D60 / D10 by mass, where known.
    part
        What part of the filter was packed, where it is not the whole.
    same_shape
        Where the packing was taken from, where it was made for another filter of the same shape.
    gradation
        Rows of size (mm) and percent finer by mass of what was packed, ascending.
    grains
        Grains.
    seed
        Seed of sizes and start positions.
    friction
        Friction between grains during compression, which sets the density.
    final_friction
        Friction in the final state.
    pressure_kpa
        Mean pressure that was held (kPa).
    settings
        Every other setting of the compression, by name.
    before
        At rest with the friction of the compression.
    after
        At rest with the final friction: the state of the grains.
    steps
        Steps of the compression.
    simulated_s
        Simulated time (s).
    seconds
        Wall time, s, over all starts of the program.
    cell_mm
        Edge of the periodic cell (mm), or its width where it is taller.
    height_mm
        Height (mm) of a cell that is taller than wide.
    inscribed
        Rows of diameter (mm) and percent smaller by number of the curves estimated by inscribed circles: dense,
        loose.
    slice
        Grains cut by the plane through the middle of the cell: x, y of the centre, diameter of the cut,
        diameter of the grain (mm).
    """

    part: Optional[PackedPart]
    same_shape: Optional[SameShape]
    height_mm: Optional[float]


class Manifest(TypedDict):
    """The whole of `manifest.json`: what made the folder.

    Keys
    ----
    format
        The form of this file.
    voidwalk
        Version of the program that wrote it.
    version
        Version of voidwalk.
    commit
        Commit it was built from, where known.
    seed
        The user's seed.
    inputs
        Every file that was read.
    threads
        Worker threads.
    host
        Name of the machine.
    machine
        Kind of machine: system, processor, memory.
    started
        When the work began, RFC 3339.
    finished
        When it ended, RFC 3339.
    command
        The command line.
    """

    format: Literal["voidwalk-manifest/1"]
    voidwalk: str
    version: str
    commit: Optional[str]
    seed: int
    inputs: List[InputFile]
    threads: int
    host: str
    machine: str
    started: str
    finished: str
    command: str
