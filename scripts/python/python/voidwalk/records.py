"""The types of what voidwalk hands out as dicts: the records of its JSON files.

Made by ``scripts/python/records.py`` from the JSON Schemas, which ``voidwalk init --schema NAME`` prints.
"""

from __future__ import annotations

from typing import Dict, List, Literal, Optional, TypedDict, Union

__all__ = [
    "AppliedRule",
    "ArchingByVoidRecord",
    "ArchingRecord",
    "Band",
    "BandSize",
    "BaseRecord",
    "BaseSize",
    "BaseSizes",
    "BaseStated",
    "Boundary",
    "BoxThreshold",
    "ByConnectivity",
    "ComparedCase",
    "ComparedPair",
    "Comparison",
    "ConstrictionsRecord",
    "ConstrictionsSummary",
    "CurveEnd",
    "CurveRange",
    "Design",
    "DesignAnswer",
    "DesignFinding",
    "DesignRow",
    "Evidence",
    "FilterRecord",
    "FilterSizes",
    "Finding",
    "Fit",
    "GivenNetwork",
    "Infiltration",
    "InfiltrationSize",
    "InputFile",
    "Inputs",
    "LimitOfDesign",
    "Manifest",
    "ManyStarts",
    "Margin",
    "MarginWalk",
    "Measure",
    "NetworkBoundaries",
    "NetworkRecord",
    "NetworkSummary",
    "OfThickness",
    "OneLength",
    "Outcome",
    "PackedPart",
    "PackingRecord",
    "PairRules",
    "PanBounds",
    "PanReading",
    "PercolationStudy",
    "Practice",
    "ProductMargin",
    "Range",
    "Ratios",
    "Replicate",
    "Run",
    "RunSummary",
    "SameShape",
    "SampledBase",
    "Sensitivity",
    "SieveLimit",
    "SizeBand",
    "SizeThreshold",
    "SoilSummary",
    "Soils",
    "Specification",
    "SpecificationStep",
    "SpecifiedCurve",
    "Statistic",
    "StepValue",
    "Stopping",
    "WalkOutcome",
]


class _Finding(TypedDict):
    #: Its name for programs, as `cohesive_fines`; empty of folders of earlier versions.
    id: str
    #: What it is about.
    about: Literal["base", "filter", "constrictions", "network", "amount", "walk", "flow", "practice", "thickness", "study", "files"]
    #: Its name in a word or two.
    label: str
    #: Which way the walk errs for it.
    direction: Literal["safe", "unsafe", "open", "settled"]
    #: What it can do to the verdict.
    weight: Literal["decides", "limits", "note"]
    #: Whether it speaks against the verdict beside which it stands.
    against: bool
    #: What it says.
    sentence: str


class Finding(_Finding, total=False):
    """A finding about a verdict: what it is about, which way it points, and its sentence."""

    #: Its numbers by name, with the unit in the name.
    numbers: Dict[str, object]
    #: Which setting changes it; may be empty.
    to_do: str


class _LimitOfDesign(TypedDict):
    #: The name of its rule for programs.
    rule: str
    #: The most that D15F may be; `None` where that is not known.
    limit_mm: Optional[float]
    #: D15F.
    value_mm: Optional[float]
    #: Whether the filter keeps it; `None` where that is not known.
    met: Optional[bool]


class LimitOfDesign(_LimitOfDesign, total=False):
    """A limit of D15F, and whether the filter keeps it."""

    #: Whether the true limit is not known, and is at most `limit_mm`.
    limit_at_most: bool


class Practice(TypedDict):
    """What filter practice says of a pair, for programs."""

    #: The limit of design.
    design: LimitOfDesign
    #: What tests of Foster and Fell showed for such a pair; folders of earlier versions do not say.
    foster_fell: Literal["no erosion", "some erosion", "excessive erosion", "continuing erosion", "unknown"]


class ConstrictionsRecord(TypedDict):
    """What is known of a filter's constrictions besides their sizes."""

    #: Where they come from.
    origin: Literal["library", "packed", "given", "guessed"]


class ByConnectivity(TypedDict):
    """What the voids of one connectivity (entrances and exits) did in a run; Table 3 of the paper."""

    #: Entrances and exits; that a void is a start node counts as an entrance.
    connectivity: int
    #: Voids that have it.
    voids: int
    #: Their share of all voids.
    voids_fraction: float
    #: Their exits.
    constrictions: int
    #: Those of them that are blocked when the run ends.
    blocked: int
    #: Particles of the run stopped by them.
    retained_in_constrictions: int
    #: Particles of the run retained in these voids.
    retained_in_voids: int
    #: Particles retained either way, over these voids.
    retained_per_void: float
    #: Their share of all particles retained either way.
    retained_fraction: float


class _Run(TypedDict):
    #: 1 or 2.
    run: int
    #: Mass eroded over mass inserted.
    eroded_mass_fraction: float
    #: Particles eroded over particles inserted.
    eroded_number_fraction: float
    #: Largest particle that left the filter; `None` when none did.
    largest_eroded_mm: Optional[float]
    #: `largest_eroded_mm` over D15F.
    largest_eroded_over_d15f: Optional[float]
    #: Constrictions blocked when the run ends.
    blocked: int
    #: Their share of all constrictions.
    blocked_fraction: float
    #: Their share of the constrictions of layers 0, 1 and 2.
    blocked_first_three_layers_fraction: float
    #: Share of all constrictions that lie on an open path from start to end.
    backbone_fraction: float
    #: Particles inserted.
    inserted: int
    #: Particles that left through the last layer.
    eroded: int
    #: Particles stopped by a constriction.
    retained_in_constrictions: int
    #: Particles in voids without an open exit.
    retained_in_voids: int
    #: Particles trapped in closed loops.
    trapped: int
    #: Particles retained in any way, over voids.
    retained_per_void: float
    #: Deepest layer in which a particle of this run is retained; `None` where none is.
    deepest_retained_layer: Optional[int]
    #: The layer down to which 95 % of the particles of this run that a layer retains lie.
    retained_95_layer: Optional[int]
    #: Increments until nothing moved.
    increments: int
    #: Moves completed, the one that leaves included.
    particle_moves: int
    #: Wall time, s.
    seconds: float


class Run(_Run, total=False):
    """The end of one run."""

    #: Those of them that are in arches; `None` where there are no arches.
    retained_in_arches: Optional[int]
    #: Arches, likewise.
    arches: Optional[int]
    #: Mass in arches over the mass inserted, likewise.
    arched_mass_fraction: Optional[float]
    #: Permeability when the run ends over that of the clean filter, where water flows.
    k_over_k0: Optional[float]
    #: Permeability of the clean filter (mm2), where the network knows its lengths.
    k0_mm2: Optional[float]
    #: Volume that this run retained over void volume, of the fullest void that has a volume; where volumes are
    #: known.
    fullness_max: Optional[float]
    #: Share of the voids that are filled by more than 0.6 of their volume, likewise; a void without volume is as
    #: soon as a particle rests in it.
    overfull_fraction: Optional[float]
    #: Retained and blocked by connectivity of the void, rising; empty where all voids have one connectivity.
    by_connectivity: List[ByConnectivity]


class Replicate(TypedDict):
    """One new network, walked once or twice."""

    #: The seed that gives this replicate alone.
    seed: int
    #: The class of this replicate alone.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: One or two.
    runs: List[Run]


class Statistic(TypedDict):
    """A mean, and with two or more replicates its standard deviation and interval."""

    #: Mean over the replicates.
    mean: float
    #: Sample standard deviation.
    sd: Optional[float]
    #: Lower end of the 95 % interval of the mean.
    low: Optional[float]
    #: Upper end of the 95 % interval of the mean.
    high: Optional[float]


class RunSummary(TypedDict):
    """Statistics of one run over the replicates."""

    #: 1 or 2.
    run: int
    #: Of `Run::eroded_mass_fraction`.
    eroded_mass_fraction: Statistic
    #: Of `Run::eroded_number_fraction`.
    eroded_number_fraction: Statistic
    #: Of `Run::largest_eroded_over_d15f`, over the replicates in which something eroded; `None` if in none.
    largest_eroded_over_d15f: Optional[Statistic]
    #: Of `Run::blocked_fraction`.
    blocked_fraction: Statistic
    #: Of `Run::blocked_first_three_layers_fraction`.
    blocked_first_three_layers_fraction: Statistic
    #: Of `Run::backbone_fraction`.
    backbone_fraction: Statistic


class _Stopping(TypedDict):
    #: Target half width of the 95 % interval of the eroded mass, in every run (percentage points of the base).
    target_error_pp: Optional[float]
    #: Confidence level at which the verdict was to be decided (%), corrected for repeated looks.
    decide_percent: Optional[float]
    #: Replicates at which it stops in any case.
    most: int
    #: How often it looked at the replicates.
    looks: int
    #: Whether what was asked for is reached.
    met: bool
    #: The verdict at that confidence level, where one was asked for.
    verdict: Optional[Literal["no erosion", "some erosion", "continuing erosion", "undecided"]]
    #: Widest half of the 95 % intervals of the eroded mass (percentage points); `None` with one replicate.
    half_width_pp: Optional[float]


class Stopping(_Stopping, total=False):
    """What a rule that adds replicates until they are enough arrived at."""

    #: Why it is not reached, in folders of earlier versions.
    sentence: Optional[str]
    #: Why it is not reached.
    short_of: Optional[Union[Literal["second_run"], Dict[str, Dict[str, Union[int, float, Optional[int]]]], Dict[str, Dict[str, Union[float, int]]]]]


class _PanReading(TypedDict):
    #: Of what size its particles were walked.
    taken_as: Literal["continued", "passive", "finest sieve"]
    #: Base particles inserted in each run; all readings insert the same mass, where no cap bites.
    n_base: int
    #: How many replicates were walked.
    replicates: int
    #: Their class.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: Eroded mass fraction, one per run.
    runs: List[Statistic]


class PanReading(_PanReading, total=False):
    """One reading of a pan fraction, walked."""

    #: Whether it was clear before all replicates of a study were walked: its intervals then take twice the
    #: scatter of the scene's own replicates, or its own where that is wider (`crate::outcome::early_stop`).
    stopped_when_clear: bool
    #: Why there are so many replicates, where a rule added them.
    stopping: Optional[Stopping]


class PanBounds(TypedDict):
    """The readings of a pan fraction that need not be passive: its sizes are not known, but they lie between two
    bounds, and go on in a likely way."""

    #: Share of the base's mass that is finer than its finest sieve.
    mass_fraction: float
    #: The finest sieve.
    finest_sieve_mm: float
    #: The finest constriction: what is finer is passive.
    finest_constriction_mm: float
    #: The readings; the rest of `outcome.json` is of the first, its verdict of all. Folders of earlier versions
    #: have the bounds alone.
    readings: List[PanReading]


class FilterRecord(TypedDict):
    """The filter: its gradation by mass and its constrictions by number."""

    #: As the user calls it.
    name: str
    #: Whom to credit for the constriction curve; empty for the user's own.
    attribution: str
    #: D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    cu: Optional[float]
    #: Smallest grain.
    d0_mm: float
    #: 15 % finer by mass.
    d15_mm: float
    #: 50 % finer by mass.
    d50_mm: float
    #: 50 % finer by number: the distance from void to void.
    d50_by_number_mm: float
    #: 85 % finer by mass.
    d85_mm: float
    #: Volume of voids over volume of grains, where known.
    void_ratio: Optional[float]
    #: Rows of (size, percent finer by mass), sizes ascending.
    gradation: List[List[float]]
    #: Rows of (diameter, percent smaller by number), diameters ascending.
    constrictions: List[List[float]]
    #: Dc60 / Dc10 by number.
    cu_csd: float
    #: Name of the constriction curve.
    curve_name: str


class SampledBase(TypedDict):
    """A base before it was regraded."""

    #: 85 % finer by mass.
    d85_mm: Optional[float]
    #: 95 % finer by mass.
    d95_mm: Optional[float]
    #: Largest particle.
    d100_mm: float
    #: Rows of (size, percent finer by mass), sizes ascending.
    gradation: List[List[float]]


class _BaseRecord(TypedDict):
    #: As the user calls it.
    name: str
    #: D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    cu: Optional[float]
    #: Smallest particle.
    d0_mm: float
    #: 15 % finer by mass.
    d15_mm: Optional[float]
    #: 50 % finer by mass.
    d50_mm: Optional[float]
    #: 85 % finer by mass.
    d85_mm: float
    #: 95 % finer by mass.
    d95_mm: float
    #: Largest particle.
    d100_mm: float
    #: Pan fraction (finer than the finest sieve) by mass; counted as passive.
    tail_mass_fraction: float
    #: Rows of (size, percent finer by mass), sizes ascending.
    gradation: List[List[float]]


class BaseRecord(_BaseRecord, total=False):
    """The base soil."""

    #: The size that it was regraded on before it was walked; `None` where it is walked as it is.
    regraded_at_mm: Optional[float]
    #: The base as it was sampled, where it was regraded before it was walked.
    as_sampled: Optional[SampledBase]


class _NetworkRecord(TypedDict):
    #: Where it comes from.
    kind: Literal["cubic", "connected", "file", "graph"]
    #: As the user calls it.
    name: str
    #: Voids along x; `None` for a network from a file.
    nx: Optional[int]
    #: Voids along y.
    ny: Optional[int]
    #: Voids along z, the direction of flow.
    nz: Optional[int]
    #: Number of voids.
    voids: int
    #: Number of constrictions.
    constrictions: int
    #: Number of voids in which base particles start.
    start_nodes: int
    #: Number of layers.
    layers: int
    #: Modelled filter thickness: layers times D50F by number, or copies of a packing; `None` where a layer has
    #: no thickness.
    thickness_mm: Optional[float]


class NetworkRecord(_NetworkRecord, total=False):
    """The void network."""

    #: Rows of (connectivity, percent of the voids), rising; empty where all voids have the same.
    connectivity: List[List[float]]
    #: Equal copies of a packing, one behind the other; `None` but for a graph.
    copies: Optional[int]


class Inputs(TypedDict):
    """What went in."""

    #: The filter and its constrictions.
    filter: FilterRecord
    #: The base soil.
    base: BaseRecord
    #: The void network.
    network: NetworkRecord
    #: Mass of base over mass of filter, `F_base` of Eq. (2).
    mass_ratio: Optional[float]
    #: Share of `n_base` inserted in each increment.
    inject_share: float
    #: Whether sizes are multiples of D0F instead of mm.
    scale_free: bool


class NetworkSummary(TypedDict):
    """The network that was walked, where its constrictions have no direction of their own."""

    #: `lattice`, `graph` or `file`.
    kind: str
    #: How particles chose among the exits of a void: `flux`, `area-along-flow` or `height`.
    exit: str
    #: Voids.
    voids: int
    #: Constrictions, each counted once.
    constrictions: int
    #: Ways in from the reservoir.
    inlets: int
    #: Equal copies of a packing, one behind the other; `None` for a lattice.
    copies: Optional[int]
    #: Layers of voids.
    layers: int
    #: Modelled filter thickness (mm).
    thickness_mm: Optional[float]
    #: Permeability of the clean filter (m2); `None` where no water flows, or where lengths have no unit.
    k0_m2: Optional[float]
    #: Hydraulic conductivity of the clean filter for water of 10 C (m/s), likewise.
    k0_m_per_s: Optional[float]


class Ratios(TypedDict):
    """The ratios of characteristic sizes."""

    #: D15F / D85B.
    d15f_over_d85b: float
    #: D15F / D95B.
    d15f_over_d95b: float


class _AppliedRule(TypedDict):
    #: Its name for programs, as `sherard-dunnigan`.
    id: str
    #: Whose rule it is, and what it says.
    name: str
    #: What it is a rule of.
    role: Literal["retention", "continuation", "drainage", "placing", "stability", "walk"]
    #: Whether it was made for these soils.
    applies: bool
    #: What it limits, as `D15F/D85B`.
    quantity: Union[Literal["D15F", "D15F/D85B", "D15F/D95B"], str]
    #: Its value for these inputs; `None` where they do not give it.
    value: Optional[float]
    #: The most, or the least, that the rule allows; `None` where no number is known.
    limit: Optional[float]
    #: Unit of value and limit: `mm`, `D0F`, `%`; empty for a ratio.
    unit: str
    #: Whether `limit` is the least that the rule allows instead of the most.
    at_least: bool
    #: Whether the value keeps the limit; `None` where the rule has no result.
    met: Optional[bool]
    #: What is missing for a result; may be empty.
    needs: str
    #: Where the value is, why the rule was not made for these soils; may be empty.
    note: str
    #: What the rule was made for.
    applies_to: str
    #: Its limit in words.
    formula: str
    #: Where the rule is published.
    source: str
    #: Which verdicts it speaks against where it is not kept.
    speaks_against: str


class AppliedRule(_AppliedRule, total=False):
    """A filter rule, applied."""

    #: Whose rule it is; empty where nobody is cited, and in files of earlier versions.
    authority: str
    #: Whether the true limit is not known, and is at most `limit`.
    limit_at_most: bool
    #: Which curve of the filter it read, where that is an envelope of several.
    filter_curve: str
    #: Which curve of the base it read, where that is an envelope of several.
    base_curve: str


class InfiltrationSize(TypedDict):
    """One size of the base in the clean filter."""

    #: As `D85B`.
    name: str
    #: Its size.
    diameter_mm: float
    #: P(F): probability that it moves one layer downstream.
    downstream: float
    #: Layers that it does not pass, with a confidence of 95 %; `None` where nothing stops it.
    layers_95: Optional[float]
    #: Layers that it does not pass, with a confidence of 99 %.
    layers_99: Optional[float]
    #: Probability that it passes all layers.
    through: float


class Infiltration(TypedDict):
    """Eq. (1) of the paper: how far single particles come in the clean filter."""

    #: Layers of the network.
    layers: int
    #: Sizes of the base, ascending.
    sizes: List[InfiltrationSize]
    #: The coarsest size that passes all layers with a probability of 5 %.
    coarsest_through_mm: float
    #: Share of the base's mass that would leave if nothing were ever blocked.
    eroded_without_blocking: float


class _CurveEnd(TypedDict):
    #: Which curve it is, in words.
    curve: str
    #: Its median constriction by that of the curve itself.
    dc50_factor: float
    #: How many replicates were walked.
    replicates: int
    #: Their class.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: Eroded mass fraction, one per run.
    runs: List[Statistic]


class CurveEnd(_CurveEnd, total=False):
    """The replicates walked with another constriction curve, all else and all random numbers the same."""

    #: Whether it was clear before all replicates of a study were walked: its intervals then take twice the
    #: scatter of the scene's own replicates, or its own where that is wider (`crate::outcome::early_stop`).
    stopped_when_clear: bool


class _CurveRange(TypedDict):
    #: The class by the curve itself.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: The other curves of the range: its ends.
    ends: List[CurveEnd]
    #: Least and most eroded over the whole range, one pair per run: the ends of the 95 % intervals, or the means
    #: of a single replicate (fraction of the mass).
    eroded_mass_fraction: List[List[float]]


class CurveRange(_CurveRange, total=False):
    """The walks at the ends of the range of a constriction curve."""

    #: Whether the worst class of the range is the verdict, as for a filter of which loose and dense are walked;
    #: elsewhere ends that differ leave it undecided.
    worst_counts: bool


class MarginWalk(TypedDict):
    """One size of the filter."""

    #: Times as large as the filter itself.
    factor: float
    #: Eroded part of the base's mass.
    eroded_mass_fraction: float
    #: Whether that is less than the threshold.
    holds: bool


class Margin(TypedDict):
    """How much coarser the filter could be before the base begins to erode: its first replicate's first run, walked
    with the filter larger or smaller."""

    #: What was walked, by rising size.
    walks: List[MarginWalk]


class _Evidence(TypedDict):
    #: Group of soils by fines after regrading and by D85B/D50B, and of filters by Cu.
    group: str
    #: Soils that it rests on.
    soils: int
    #: Median over these soils of the walk's D15F of no erosion by that of tests.
    ratio_median: float
    #: The ratio below which 5 % of the soils lie.
    ratio_low: float
    #: The ratio below which 95 % of the soils lie.
    ratio_high: float
    #: Whether there are at least 30 soils, nine in ten lie within a factor of 2 of the median, and that is at
    #: most 1.
    narrow: bool
    #: D15F from which the walk erodes this base (mm); beyond it or below it where `bound` says so; `None` where
    #: the group is not narrow, and it was not looked for.
    boundary_d15f_mm: Optional[float]
    #: The probability that a test of this pair would show no erosion, by the walk; `None` where the group is not
    #: narrow.
    probability_no_erosion: Optional[float]
    #: The same by the range of tests alone: the part of it that lies beyond the filter's D15F.
    probability_by_tests: Optional[float]


class Evidence(_Evidence, total=False):
    """The evidence for a pair."""

    #: Where the walk's boundary was not found: on which side of its number, and of the probability, it lies.
    bound: Optional[Literal["at_least", "at_most"]]


class ArchingByVoidRecord(TypedDict):
    """How the concentration of each void is worked out."""

    #: Diameter of a sphere with the volume of a void, mm.
    void_mm: float
    #: Which size counts: "own" or "void-mean".
    size: str


class _ArchingRecord(TypedDict):
    #: Its name in a scene.
    law: str
    #: Where it was published.
    source: str
    #: What of the source was read, and what was assumed.
    basis: str
    #: Sizes of a constriction by that of a particle between which arches form.
    range_of_ratio: List[float]
    #: Volume of particles by volume of voids with which the base arrives; `None` where the law is of dense flow,
    #: or where each void has its own.
    concentration: Optional[float]


class ArchingRecord(_ArchingRecord, total=False):
    """A law by which particles arch in a constriction that they fit."""

    #: How the concentration of each void is worked out, where it is.
    by_void: Optional[ArchingByVoidRecord]


class _Sensitivity(TypedDict):
    #: Multiple of the outcome's own `n_base`.
    factor: float
    #: Base particles inserted in each run.
    n_base: int
    #: Grains per void to which this factor corresponds at the scene's mass ratio.
    grains_per_void: Optional[float]
    #: Mass ratio to which this factor corresponds at the scene's grains per void.
    mass_ratio: Optional[float]
    #: How many replicates were walked.
    replicates: int
    #: Their class.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: Eroded mass fraction, one per run.
    runs: List[Statistic]


class Sensitivity(_Sensitivity, total=False):
    """The outcome with another number of base particles. `N_base` holds grains per void and mass ratio only as a
    product (Eq. 2), so one factor answers for both."""

    #: Whether it was clear before all replicates of a study were walked: its intervals then take twice the
    #: scatter of the scene's own replicates, or its own where that is wider (`crate::outcome::early_stop`).
    stopped_when_clear: bool


class _OfThickness(TypedDict):
    #: Multiple of the outcome's own thickness.
    factor: float
    #: Layers of voids along the flow.
    layers: int
    #: Modelled thickness (mm, or D0F as all its sizes); `None` where a layer has none.
    thickness_mm: Optional[float]
    #: Base particles inserted in each run.
    n_base: int
    #: How many replicates were walked.
    replicates: int
    #: Their class.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: Eroded mass fraction, one per run.
    runs: List[Statistic]


class OfThickness(_OfThickness, total=False):
    """The same case with a filter of this thickness."""

    #: Whether it was clear before all replicates of a study were walked: its intervals then take twice the
    #: scatter of the scene's own replicates, or its own where that is wider (`crate::outcome::early_stop`).
    stopped_when_clear: bool


class _Outcome(TypedDict):
    #: The form of this file.
    format: Literal["voidwalk-outcome/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: The class that the replicates together support.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: How far it can be relied on; folders of earlier versions do not say, and are outside.
    confidence: Literal["within checked range", "may segregate", "outside checked range", "may not drain", "may lose its own fines", "contradicted by practice"]
    #: What was found about the verdict: what speaks against it first, of which the first sets the label.
    findings: List[Finding]
    #: The sentences of those that speak against it, in the same order.
    reasons: List[str]
    #: The user's seed.
    seed: int
    #: Base particles inserted in each run.
    n_base: int
    #: Base particles by Eq. (2), before any cap or user's number; `None` where the grains per void are not
    #: given.
    n_base_eq2: Optional[int]
    #: Whether a cap made `n_base` smaller than `n_base_eq2`.
    capped: bool
    #: Filter grains per void, `N_p / N_voids` of Eq. (2), where given.
    grains_per_void: Optional[float]
    #: Name of the engine that walked.
    engine: str
    #: One per replicate, in order.
    replicates: List[Replicate]
    #: One per run, in order: statistics over the replicates.
    summary: List[RunSummary]
    #: Eroded mass fraction that divides the classes: 0.075.
    threshold: float
    #: Parts of the program that this scene did not need.
    left_out: List[str]
    #: What the model does not contain, for any scene.
    model_leaves_out: List[str]
    #: What went in, resolved.
    inputs: Inputs
    #: The ratios that filter rules use.
    ratios: Ratios
    #: Empirical filter rules applied to the same two curves.
    rules: List[AppliedRule]
    #: How the verdict moves with the number of base particles; empty when it was not asked for.
    sensitivity: List[Sensitivity]
    #: Wall time of everything, s.
    seconds: float


class Outcome(_Outcome, total=False):
    """The whole of `outcome.json`."""

    #: What folders of earlier versions say besides; now in `findings`.
    notes: List[str]
    #: What filter practice says of the pair; folders of earlier versions have it in `rules` alone.
    practice: Optional[Practice]
    #: Where the constrictions come from; folders of earlier versions do not say.
    constrictions: Optional[ConstrictionsRecord]
    #: Why there are so many replicates, where a rule added them.
    stopping: Optional[Stopping]
    #: Both readings of a pan fraction that need not be passive.
    pan_bounds: Optional[PanBounds]
    #: What folders of earlier versions say of their inputs; now in `findings`.
    warnings: List[str]
    #: The network, where its constrictions have no direction of their own.
    network: Optional[NetworkSummary]
    #: Eq. (1) for single particles; `None` where the network is no cubic lattice.
    infiltration: Optional[Infiltration]
    #: What comes of the other constriction curves that the filter may have; `None` where its curve was given, or
    #: measured on the whole filter.
    curve_range: Optional[CurveRange]
    #: How much coarser the filter could be before the base begins to erode; `None` where that was not asked for.
    margin: Optional[Margin]
    #: What soils of its kind say of the walk's boundary; `None` where no margin was asked for, or for a base of
    #: no group.
    evidence: Optional[Evidence]
    #: The law by which particles arched; `None` where they did not.
    arching: Optional[ArchingRecord]
    #: How the verdict moves with the thickness of the filter, itself included; empty when it was not asked for.
    thickness: List[OfThickness]
    #: Whether both studies are still being walked, or their walk was ended: `voidwalk resume` goes on.
    studies_to_come: bool


class GivenNetwork(TypedDict):
    """Networks that were given; where there are several, the numbers are those of the first."""

    #: Networks that the replicates took in turn.
    networks: int
    #: How particles chose among the exits of a void.
    exit: str
    #: Voids.
    voids: int
    #: Constrictions, each counted once.
    constrictions: int
    #: Layers of voids.
    layers: int
    #: Rows of (diameter, percent smaller by number) of its open constrictions, diameters ascending (mm).
    diameters: List[List[float]]


class _WalkOutcome(TypedDict):
    #: The class that the replicates together support.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: How far the verdict can be relied on.
    confidence: Literal["within checked range", "may segregate", "outside checked range", "may not drain", "may lose its own fines", "contradicted by practice"]
    #: What was found about the verdict: what speaks against it first, of which the first sets the label.
    findings: List[Finding]
    #: The sentences of those that speak against it, in the same order.
    reasons: List[str]
    #: The user's seed.
    seed: int
    #: Base particles inserted in each run.
    n_base: int
    #: Those that Eq. (2) gives, where the filter and its grains per void are known.
    n_base_eq2: Optional[int]
    #: Filter grains per void, where they are known.
    grains_per_void: Optional[float]
    #: Mass of the base over that of the filter, of Eq. (2).
    mass_ratio: float
    #: Equal parts in which they were inserted.
    increments: int
    #: Name of the engine that walked.
    engine: str
    #: One per replicate, in order.
    replicates: List[Replicate]
    #: One per run, in order: statistics over the replicates.
    summary: List[RunSummary]
    #: Eroded mass fraction that divides the classes: 0.075.
    threshold: float
    #: Parts of the program that this walk did not need.
    left_out: List[str]
    #: What the model does not contain.
    model_leaves_out: List[str]
    #: The base.
    base: BaseRecord
    #: 15 % of the filter finer by mass (mm), where the filter is known.
    d15f_mm: Optional[float]
    #: What was walked through.
    network: GivenNetwork
    #: Version of the program.
    version: str


class WalkOutcome(_WalkOutcome, total=False):
    """The results of `crate::run::walk_networks`; the names are those of `outcome.json` where both have them."""

    #: What records of earlier versions say besides; now in `findings`.
    warnings: List[str]


class _DesignAnswer(TypedDict):
    #: Greatest D15F (mm) that both walk and practice allow; `None` where none is known, where the base has no
    #: size, and for the inverse.
    d15f_max_mm: Optional[float]
    #: The same as D15F/D85B, of the base as it was walked.
    d15f_over_d85b: Optional[float]
    #: Which of the two is the stricter.
    set_by: Literal["practice", "walk"]
    #: Name of the rule for programs, where practice set it.
    rule: Optional[str]
    #: The same in a sentence without its full stop.
    said: str


class DesignAnswer(_DesignAnswer, total=False):
    """How coarse the filter may be; for the inverse, how fine the base."""

    #: Finest D85B (mm) that both allow, for the inverse.
    d85b_min_mm: Optional[float]


class Range(TypedDict):
    """Median and band of a size (mm)."""

    #: Median over networks.
    median: float
    #: 5 percentile.
    low: Optional[float]
    #: 95 percentile.
    high: Optional[float]


class _Boundary(TypedDict):
    #: Median over networks.
    median: float
    #: 5 % of networks lie below; `None` where that hangs on networks beyond the search, and of one network.
    low: Optional[float]
    #: 5 % of networks lie above; `None` likewise.
    high: Optional[float]
    #: D15F (mm) of the filter, where the base has a size.
    d15f_mm: Optional[Range]


class Boundary(_Boundary, total=False):
    """A boundary over networks: D15F/D85B, and the same in mm."""

    #: On which side of the search the 5 percentile lies, where it lies beyond: below, networks erode at every
    #: ratio that was searched.
    low_beyond: Optional[Literal["below", "above"]]
    #: D85B (mm) of the base, for the inverse, where the filter has a size.
    d85b_mm: Optional[Range]


class NetworkBoundaries(TypedDict):
    """What one network says; `None` where its boundary lies beyond the search."""

    #: Network, counted from 1.
    network: int
    #: D15F/D85B from which its first run erodes.
    no_erosion: Optional[float]
    #: D15F/D85B from which its second run does.
    continuing: Optional[float]


class _Band(TypedDict):
    #: Least D15F, of the rule of permeability.
    least: float
    #: Greatest D15F that both allow: the walk, which erodes less than 7.5 % in the first run on all but 5 % of
    #: networks, and practice. Files of earlier versions hold that of the walk alone.
    greatest: float
    #: Greatest D15F that the strictest rule of retention allows, which was made for this base.
    practice: Optional[float]
    #: Name of that rule.
    practice_rule: str
    #: Unit: `mm`, or `D85B`.
    unit: str
    #: Whether nothing lies between the least and what both the walk and practice allow.
    is_empty: bool
    #: The same in a sentence; of an empty one why it is.
    said: str


class Band(_Band, total=False):
    """Between which D15F a filter both drains and holds."""

    #: Which of the two set it; `None` in files of earlier versions.
    set_by: Optional[Literal["practice", "walk"]]
    #: Its name for programs; `None` without one, and in files of earlier versions.
    practice_rule_id: Optional[str]


class _DesignRow(TypedDict):
    #: How densely the filter is packed.
    density: str
    #: The thickness that was asked for, in words.
    thickness: str
    #: Layers of voids, at the no-erosion boundary where the thickness is in mm.
    layers: int
    #: Thickness (mm), at the no-erosion boundary where it is in layers; `None` where sizes have no unit.
    thickness_mm: Optional[float]
    #: Filter grains per void, Eq. (2).
    grains_per_void: Optional[float]
    #: Where no erosion turns into some; `None` where that lies beyond what can be walked.
    no_erosion: Optional[Boundary]
    #: Where some erosion turns into continuing.
    continuing: Optional[Boundary]
    #: Networks on which a larger ratio was seen to hold than one that erodes, in either run: their smallest that
    #: erodes counts.
    not_monotone: int
    #: What each network says.
    networks: List[NetworkBoundaries]
    #: The band of a specification, up to what holds over the whole range of its curve; `None` for the inverse,
    #: where nothing limits it, and where no ratio is known that all but 5 % of networks hold.
    band: Optional[Band]


class DesignRow(_DesignRow, total=False):
    """The boundaries of one density and thickness."""

    #: Why there is none, or what else is to be said of it.
    no_erosion_note: Optional[str]
    #: D15F/D85B to which nearly all networks hold where more than half of them hold all that was searched, so
    #: that there is no boundary.
    holds_to: Optional[float]
    #: Why there is none, or what else is to be said of it.
    continuing_note: Optional[str]
    #: Why the walks themselves put the boundary of no erosion in doubt: a few particles decide.
    unsteady: Optional[str]
    #: Why there is no band, where networks erode at every ratio that was searched.
    band_note: Optional[str]
    #: The end of its range whose boundaries these are: the one that holds least. A filter of unknown density is
    #: searched at its ends only, loose and dense.
    as_end: Optional[str]
    #: The density of which this is an end of the range in which its constriction curve is known: its band is
    #: that of the whole range, and this row has none.
    end_of: Optional[str]


class _BaseStated(TypedDict):
    #: Its name.
    name: str
    #: D60/D10.
    cu: Optional[float]
    #: D15 (mm) before regrading; `None` without a size of its own.
    d15_mm: Optional[float]
    #: D85 (mm) as walked; `None` without a size of its own.
    d85_mm: Optional[float]
    #: D95/D85.
    d95_over_d85: Optional[float]
    #: The part of its mass that is finer than its finest sieve, as it was walked.
    tail_mass_fraction: float


class BaseStated(_BaseStated, total=False):
    """What is known of the base."""

    #: The size (mm) that it was regraded on before it was walked; `None` where it was walked as sampled.
    regraded_at_mm: Optional[float]
    #: D85 (mm) before regrading, where it was regraded.
    d85_as_sampled_mm: Optional[float]


class _DesignFinding(TypedDict):
    #: Its name for programs, as `cohesive_fines`; empty of folders of earlier versions.
    id: str
    #: What it is about.
    about: Literal["base", "filter", "constrictions", "network", "amount", "walk", "flow", "practice", "thickness", "study", "files"]
    #: Its name in a word or two.
    label: str
    #: Which way the walk errs for it.
    direction: Literal["safe", "unsafe", "open", "settled"]
    #: What it can do to the verdict.
    weight: Literal["decides", "limits", "note"]
    #: Whether it speaks against the verdict beside which it stands.
    against: bool
    #: What it says.
    sentence: str


class DesignFinding(_DesignFinding, total=False):
    """A finding about the rows of a design."""

    #: The row that it is of, in words; `None` where it is of all.
    row: Optional[str]
    #: Its numbers by name, with the unit in the name.
    numbers: Dict[str, object]
    #: Which setting changes it; may be empty.
    to_do: str


class Fit(TypedDict):
    """A product beside a band."""

    #: Its name.
    name: str
    #: D15 (mm) of its fine and of its coarse side.
    d15_mm: List[float]
    #: Whether its fine side drains.
    drains: bool
    #: Whether its coarse side is within what both walk and practice allow.
    holds: bool
    #: Whether its coarse side keeps the strictest rule of retention; `None` where there is none.
    practice: Optional[bool]
    #: Where its limits were read.
    source: str


class _SpecifiedCurve(TypedDict):
    #: Its name.
    curve: str
    #: Size (mm) and percent finer by mass, as sampled.
    gradation: List[List[float]]
    #: D15 (mm) before regrading; `None` where it is finer than the finest sieve.
    d15_mm: Optional[float]
    #: The size on which it was regraded (mm).
    regraded_at_mm: Optional[float]
    #: D85 (mm) after regrading.
    d85_mm: Optional[float]
    #: Percent finer than 0.075 mm after regrading.
    fines_percent: Optional[float]
    #: Category of NRCS, 1 to 4.
    category: Optional[int]
    #: Greatest D15F (mm) that retains it; `None` where it is not known.
    d15f_max_mm: Optional[float]
    #: The rule that sets it.
    d15f_max_rule: str
    #: Least D15F (mm) that drains it.
    d15f_min_mm: Optional[float]


class SpecifiedCurve(_SpecifiedCurve, total=False):
    """A curve of the base, and the limits of D15F that follow from it."""

    #: The same after regrading; empty where it is not regraded.
    regraded: List[List[float]]


class StepValue(TypedDict):
    """A number of a step."""

    #: What it is, as `greatest D15F`.
    name: str
    #: The number; `None` where it is not known.
    value: Optional[float]
    #: Its unit: `mm`, `%`; empty for a ratio or a count.
    unit: str


class SpecificationStep(TypedDict):
    """A step of the procedure."""

    #: Its number, from 1.
    step: int
    #: What is done.
    does: str
    #: The formula, in words; empty where nothing is worked out.
    formula: str
    #: Its numbers.
    values: List[StepValue]
    #: What else a reader must know; may be empty.
    note: str
    #: Where formula and numbers were read; empty where nothing is worked out.
    source: str


class BandSize(TypedDict):
    """A size of both sides of a band."""

    #: Percent finer.
    percent: float
    #: Least size (mm), of the fine side.
    min_mm: float
    #: Greatest size (mm), of the coarse side.
    max_mm: float


class SizeBand(TypedDict):
    """The two sides of a band as sizes."""

    #: D5, D15, D60, D90 and D100 of both sides.
    sizes: List[BandSize]
    #: The fine side: size (mm) and percent finer, rising.
    fine_side: List[List[float]]
    #: The coarse side.
    coarse_side: List[List[float]]


class SieveLimit(TypedDict):
    """What a delivery may have finer than a sieve. A row of `specification.csv`."""

    #: Name of the sieve.
    sieve: str
    #: Its opening (mm).
    opening_mm: float
    #: Least percent finer, of the coarse side: a whole percent within the band; tenths or hundredths where no
    #: whole percent lies within.
    min_percent_finer: float
    #: Greatest percent finer, of the fine side, likewise.
    max_percent_finer: float


class ProductMargin(TypedDict):
    """A standard product beside a specification. A row of `specification_products.csv`."""

    #: Its name.
    product: str
    #: D15 (mm) of its fine side.
    d15_fine_mm: float
    #: D15 (mm) of its coarse side.
    d15_coarse_mm: float
    #: D15 of its fine side over the least that drains: at least 1 where it drains.
    drains_by: Optional[float]
    #: The greatest D15F over D15 of its coarse side: at least 1 where it holds.
    holds_by: Optional[float]
    #: The sieve (mm) at which its limits leave the band by most; `None` without a band, and where they stay
    #: within it.
    worst_sieve_mm: Optional[float]
    #: By how much they leave it there (percentage points finer); 0 where they stay within.
    leaves_band_by: Optional[float]
    #: Where its limits were read.
    source: str


class _Specification(TypedDict):
    #: Version of voidwalk.
    version: str
    #: Name of the base.
    base: str
    #: Whether it was said to be dispersive.
    dispersive: bool
    #: The sieves at which the limits are stated.
    sieves: Literal["us", "iso"]
    #: The curves of the base, in the order of the file.
    curves: List[SpecifiedCurve]
    #: Every step, with its numbers.
    steps: List[SpecificationStep]
    #: Least D15F (mm) that drains the base; `None` where it is not known.
    d15f_min_mm: Optional[float]
    #: Greatest D15F (mm) that is allowed; `None` where it is not known.
    d15f_max_mm: Optional[float]
    #: The band; `None` where there is none.
    band: Optional[SizeBand]
    #: Percent finer at each sieve, the coarsest first; empty without a band.
    limits: List[SieveLimit]
    #: Standard products beside it; empty where neither limit of D15F is known.
    products: List[ProductMargin]


class Specification(_Specification, total=False):
    """The whole of `specification.json`."""

    #: Why there is no band.
    no_band: Optional[str]


class _Design(TypedDict):
    #: The form of this file.
    format: Literal["voidwalk-design/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: Version of voidwalk.
    version: str
    #: One per density and thickness, in the order in which they were asked for.
    boundaries: List[DesignRow]
    #: Whether the base was scaled against a filter of given size, to find the finest base that it holds.
    inverse: bool
    #: The base.
    base: BaseStated
    #: The filter's shape in words.
    filter: str
    #: Cu of the filter.
    filter_cu: Optional[float]
    #: The filter's own D15F (mm), where its sizes are given; only the inverse hangs on it.
    filter_d15_mm: Optional[float]
    #: Unit of the sizes in `rules`, `band` and `products`: `mm`, or `D85B` where the base has no size of its
    #: own.
    unit: str
    #: Mass eroded from which a run erodes.
    threshold: float
    #: Networks of each boundary.
    replicates: int
    #: The user's seed.
    seed: int
    #: Engine that walked; `expected` moves the base particles that can block nothing as their expectation. Empty
    #: in files of earlier versions.
    engine: str
    #: D15F/D85B between which boundaries were searched.
    bracket: List[float]
    #: Steps of the search, as a part of D15F/D85B.
    step: float
    #: How far "no erosion" at the coarsest filter that holds can be relied on, of the row that can be relied on
    #: least; never within the checked range where a row has no such filter, or an empty band.
    confidence: Literal["within checked range", "may segregate", "outside checked range", "may not drain", "may lose its own fines", "contradicted by practice"]
    #: The sentences of those that speak against it, in order.
    reasons: List[str]
    #: Every rule of practice, of the coarsest filter that holds; of another where none is known.
    rules: List[AppliedRule]
    #: D15F/D85B that the rules are read at.
    rules_at: float
    #: Standard products beside the narrowest band.
    products: List[Fit]
    #: The sentences of all others.
    warnings: List[str]
    #: What the model does not contain.
    model_leaves_out: List[str]
    #: Settings that were given, as on the command line.
    settings: List[str]
    #: Wall time (s).
    seconds: float


class Design(_Design, total=False):
    """The whole of `design.json`."""

    #: How coarse the filter may be: the least of what walk and practice allow; `None` in files of earlier
    #: versions, of which `Design::answer()` works it out.
    answer: Optional[DesignAnswer]
    #: What was found about "no erosion" there, the weightiest first; empty in files of earlier versions.
    findings: List[DesignFinding]
    #: How far it can be relied on that a product fits: as `confidence`, but at the greatest D15F that walk and
    #: practice both allow; `None` without products.
    products_confidence: Optional[Literal["within checked range", "may segregate", "outside checked range", "may not drain", "may lose its own fines", "contradicted by practice"]]
    #: The specification of a filter that walk and practice allow, step by step; `None` without an answer in mm,
    #: and in files of earlier versions.
    specification: Optional[Specification]


class _BaseSize(TypedDict):
    #: 85 % finer by mass.
    d85_mm: float


class BaseSize(_BaseSize, total=False):
    """D85 of a base (mm), of the base as it is walked."""

    #: The size that it was regraded on; `None` where it is as it was sampled.
    regraded_at_mm: Optional[float]
    #: D85 before regrading, where it was regraded; `None` where records of earlier versions do not say it.
    as_sampled_mm: Optional[float]


class _ComparedCase(TypedDict):
    #: Its name.
    name: str
    #: Folder of its results, inside the comparison's.
    folder: str
    #: The class that its replicates together support.
    verdict: Literal["no erosion", "some erosion", "continuing erosion", "undecided"]
    #: How far it can be relied on.
    confidence: Literal["within checked range", "may segregate", "outside checked range", "may not drain", "may lose its own fines", "contradicted by practice"]
    #: Why no further: sentences, the weightiest first.
    reasons: List[str]
    #: The rules of practice that were made for these soils and are not kept, by name.
    rules_not_kept: List[str]
    #: Replicates.
    replicates: int
    #: Thickness of the filter along the flow (mm); `None` where the network does not say.
    thickness_mm: Optional[float]
    #: Whether sizes are multiples of D0F instead of mm.
    scale_free: bool
    #: Base particles of each run.
    n_base: int
    #: Filter grains per void, where given.
    grains_per_void: Optional[float]
    #: D15F over D85B and D95B.
    ratios: Ratios
    #: Eroded mass fraction of each run.
    runs: List[Statistic]


class ComparedCase(_ComparedCase, total=False):
    """A case of a comparison."""

    #: What filter practice says of the pair, in a line; records of earlier versions do not say.
    practice: str
    #: Whether the filter holds, in a line; records of earlier versions do not say.
    headline: str
    #: What the walk says, in a line.
    walk: str
    #: What to do next.
    next: str
    #: What else stands beside every verdict, in sentences.
    beside: List[str]
    #: D85B and which base it is of; `None` without a unit, and in records of earlier versions.
    base: Optional[BaseSize]
    #: Least and most eroded over the range of the constriction curve, one pair per run; empty where the curve is
    #: no range.
    curve_range: List[List[float]]


class ComparedPair(TypedDict):
    """How much two cases differ in one run."""

    #: The one.
    first: str
    #: The other.
    second: str
    #: 1 or 2.
    run: int
    #: Pairs of replicates.
    replicates: int
    #: Eroded mass fraction of the one less that of the other, with the 95 % interval of this difference.
    difference: Statistic
    #: Interval that holds for all differences of the comparison at once with 95 % (Bonferroni); `None` with one
    #: pair of replicates.
    joint: Optional[List[float]]
    #: Whether that interval leaves 0 out; `None` with one pair of replicates.
    differ: Optional[bool]


class Comparison(TypedDict):
    """The whole of `compare.json`."""

    #: The form of this file.
    format: Literal["voidwalk-comparison/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: What is compared: `filters`, `bases` or `scenes`.
    of: str
    #: What all cases have in common, as the base of several filters; empty where they are scenes.
    common: str
    #: Seed of every case.
    seed: int
    #: Version of the program.
    version: str
    #: The cases, in the order in which they were named.
    cases: List[ComparedCase]
    #: Every two cases, in that order, for each run that both have.
    pairs: List[ComparedPair]
    #: Eroded mass fraction that divides the classes: 0.075.
    threshold: float
    #: What no case contains; records of earlier versions do not say.
    model_leaves_out: List[str]


class SizeThreshold(TypedDict):
    """The thresholds of one size."""

    #: Voids along each side.
    size: int
    #: Share of constrictions that is open at the threshold.
    threshold: Statistic
    #: Standard error of the standard deviation, for normal thresholds: sd / sqrt(2 (n - 1)).
    sd_error: Optional[float]


class BoxThreshold(TypedDict):
    """The thresholds of a lattice that is no cube."""

    #: Voids along x and y, and layers.
    shape: List[int]
    #: Share of constrictions that is open at the threshold.
    threshold: Statistic
    #: Standard error of the standard deviation, as that of a size.
    sd_error: Optional[float]


class OneLength(TypedDict):
    """A fit of `p(L) = threshold - amplitude L^(-1 / NU_PARALLEL)`."""

    #: Threshold of the infinite lattice.
    threshold: float
    #: Its standard error, if the relation holds.
    threshold_error: float
    #: Amplitude.
    amplitude: float
    #: Sum of squared deviations, each over its standard error.
    chi_squared: float
    #: Degrees of freedom.
    degrees: int


class ManyStarts(TypedDict):
    """A fit of `L d^nu = offset + slope ln(L d^(nu / z))`, `d = threshold - p(L)`."""

    #: Threshold of the infinite lattice.
    threshold: float
    #: Lower end of its 68 % interval.
    threshold_low: float
    #: Upper end of its 68 % interval.
    threshold_high: float
    #: Offset.
    offset: float
    #: Slope.
    slope: float
    #: Sum of squared deviations, each over its standard error.
    chi_squared: float
    #: Degrees of freedom.
    degrees: int


class _PercolationStudy(TypedDict):
    #: The form of this file.
    format: Literal["voidwalk-percolation/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: Version of voidwalk.
    version: str
    #: The user's seed.
    seed: int
    #: Realisations of each size.
    realisations: int
    #: One per size, ascending.
    sizes: List[SizeThreshold]
    #: The relation of one length; `None` with fewer than two sizes or realisations.
    one_length: Optional[OneLength]
    #: The relation of many starts; `None` with fewer than four sizes, or where no threshold fits.
    many_starts: Optional[ManyStarts]
    #: Slope of ln(standard deviation) against ln(size); `None` as for `one_length`.
    sd_exponent: Optional[float]
    #: `INFINITE_LATTICE`.
    infinite_lattice: float
    #: Wall time, s.
    seconds: float


class PercolationStudy(_PercolationStudy, total=False):
    """The whole of `percolation.json`."""

    #: One per lattice that is no cube, in order of its lengths; no relation is fitted to these.
    boxes: List[BoxThreshold]


class _FilterSizes(TypedDict):
    #: The curve that these sizes are of.
    curve: str
    #: 15 % finer.
    d15_mm: Optional[float]
    #: 50 % finer.
    d50_mm: Optional[float]
    #: 85 % finer.
    d85_mm: Optional[float]
    #: D60 / D10.
    cu: Optional[float]
    #: D30^2 / (D10 D60).
    cc: Optional[float]


class FilterSizes(_FilterSizes, total=False):
    """Sizes of a filter (mm), of its coarsest curve where it is an envelope; `None` where they lie in a finest tail
    of unknown size."""

    #: Its curves, where there are several.
    curves: List[str]


class _BaseSizes(TypedDict):
    #: The curve that these sizes are of.
    curve: str
    #: Whether it was said to be dispersive.
    dispersive: bool
    #: Category of NRCS, 1 to 4; `None` where the fines are not known closely enough.
    category: Optional[int]
    #: Percent finer than 0.075 mm after regrading.
    fines_percent: Optional[float]
    #: Whether it was regraded.
    regraded: bool
    #: The size on which it was regraded.
    regraded_at_mm: Optional[float]
    #: Why it was regraded, or not.
    why: str
    #: 15 % finer, before regrading.
    d15_mm: Optional[float]
    #: 85 % finer, after regrading.
    d85_mm: Optional[float]
    #: 85 % finer, before regrading.
    d85_as_sampled_mm: Optional[float]
    #: 95 % finer, after regrading.
    d95_mm: Optional[float]
    #: D60 / D10, before regrading.
    cu: Optional[float]
    #: D30^2 / (D10 D60), before regrading.
    cc: Optional[float]


class BaseSizes(_BaseSizes, total=False):
    """A base as practice describes it (mm), its finest curve where it is an envelope; `None` where a size lies in a
    finest tail of unknown size."""

    #: Its curves, where there are several.
    curves: List[str]


class PairRules(TypedDict):
    """What is said of two sieve curves by the rules of practice alone."""

    #: The form of this file.
    format: Literal["voidwalk-rules/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: The filter.
    filter: FilterSizes
    #: The base after regrading.
    base: BaseSizes
    #: Every rule.
    rules: List[AppliedRule]
    #: What may be wrong with the two tables, and what was taken for what.
    warnings: List[str]


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
    """The soils of a file."""

    #: The form of this file.
    format: Literal["voidwalk-soils/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    soils: List[SoilSummary]


class _ConstrictionsSummary(TypedDict):
    #: The form of this file.
    format: Literal["voidwalk-constrictions/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: Grains, hidden ones left out.
    grains: int
    #: Voids.
    voids: int
    #: Grains per void, N_p / N_voids of Eq. (2).
    grains_per_void: float
    #: Tetrahedra.
    tetrahedra: int
    #: Constrictions.
    constrictions: int
    #: Volume of voids over volume of grains.
    void_ratio: float
    #: D_c60 / D_c10.
    cu_csd: float
    #: Smallest grain (mm).
    d0_mm: float
    #: Diameter (mm) that a percentage by number is no larger than, by that percentage.
    dc_mm: Dict[str, object]
    #: Mean number of constrictions of a void.
    mean_connectivity: float
    #: Voids by number of their constrictions, from 0.
    connectivity: List[int]
    #: Overlap from which two tetrahedra share a void.
    merge_overlap: float
    #: Which facets between voids were counted.
    counted_facets: Literal["all", "on_both_hulls"]
    #: Constrictions whose disc a fourth grain shortened.
    cut_constrictions: int
    #: Facets between voids that the grains close.
    closed_facets: int
    #: Grains that lie inside others, counted from 0.
    hidden_grains: List[int]
    #: Pairs of grains with the same centre.
    duplicate_grains: List[List[int]]


class ConstrictionsSummary(_ConstrictionsSummary, total=False):
    """The figures of a packing's constrictions, as in `constrictions.json`."""

    #: What a reader must know of these grains.
    warnings: List[str]
    #: Permeability along z over the square of the grains' Sauter mean d32; none without a periodic cell.
    k_over_d32_squared: Optional[float]
    #: The same by Kozeny and Carman, (1 - c)^3 / (180 c^2) with c the solid fraction.
    kozeny_carman_over_d32_squared: Optional[float]


class PackedPart(TypedDict):
    """The finer part of a filter that was packed, where the whole was not."""

    #: Percent of the filter's mass that is in it.
    percent: float
    #: Its largest grain (mm).
    largest_mm: float
    #: Share of the surface of all grains that the grains left out have.
    surface_left_out: float
    #: Its constrictions are finer than those of the whole by up to this share of their size.
    finer_by: float
    #: Whether the filter has next to no grains up to half as large again as the largest.
    sizes_missing_above: bool


class SameShape(TypedDict):
    """Where a packing was taken from that another scene's filter of the same shape had been packed into."""

    #: Its folder.
    folder: str
    #: What its sizes were multiplied with.
    factor: float


class Measure(TypedDict):
    """Observables of one instant."""

    #: Volume of the voids by that of the grains.
    void_ratio: float
    #: Mean contact pressure (kPa).
    pressure_kpa: float
    #: Mean coordination number `2 N_c / N_p`, over all grains.
    coordination: float
    #: Mean coordination number among the grains that are held: with at least two contacts (four without
    #: friction) with held grains.
    coordination_held: float
    #: Rattler fraction: grains that are not held, by all grains.
    rattlers: float
    #: Kinetic by elastic energy.
    kinetic_ratio: float
    #: Root mean square unbalanced force of a grain by the mean normal contact force.
    unbalanced: float
    #: Largest overlap by the smaller diameter of its two grains.
    largest_overlap: float


class _PackingRecord(TypedDict):
    #: The form of this file.
    format: Literal["voidwalk-packing/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: Fingerprint of everything that the grains follow from: gradation, settings and protocol.
    fingerprint: str
    #: XXH3 of `grains.csv`.
    grains_xxh3: str
    #: The gradation in words.
    name: str
    #: Whether the gradation is linear on semi-log paper.
    linear: bool
    #: D60 / D10 by mass, where known.
    cu: Optional[float]
    #: Rows of size (mm) and percent finer by mass of what was packed, ascending.
    gradation: List[List[float]]
    #: Grains.
    grains: int
    #: Seed of sizes and start positions.
    seed: int
    #: Friction between grains during compression, which sets the density.
    friction: float
    #: Friction in the final state.
    final_friction: float
    #: Mean pressure that was held (kPa).
    pressure_kpa: float
    #: Every other setting of the compression, by name.
    settings: Dict[str, object]
    #: At rest with the friction of the compression.
    before: Measure
    #: At rest with the final friction: the state of the grains.
    after: Measure
    #: Steps of the compression.
    steps: int
    #: Simulated time (s).
    simulated_s: float
    #: Wall time, s, over all starts of the program.
    seconds: float
    #: Edge of the periodic cell (mm), or its width where it is taller.
    cell_mm: float
    #: Rows of diameter (mm) and percent smaller by number of the curves estimated by inscribed circles: dense,
    #: loose.
    inscribed: List[List[List[float]]]
    #: Grains cut by the plane through the middle of the cell: x, y of the centre, diameter of the cut, diameter
    #: of the grain (mm).
    slice: List[List[float]]


class PackingRecord(_PackingRecord, total=False):
    """The whole of `packing.json`."""

    #: What part of the filter was packed, where it is not the whole.
    part: Optional[PackedPart]
    #: Where the packing was taken from, where it was made for another filter of the same shape.
    same_shape: Optional[SameShape]
    #: Height (mm) of a cell that is taller than wide.
    height_mm: Optional[float]


class InputFile(TypedDict):
    """A file that was read."""

    #: Its name as given.
    name: str
    #: XXH3 of its bytes, hexadecimal. Finds accidents, not attackers.
    xxh3: str


class Manifest(TypedDict):
    """The whole of `manifest.json`: what made the folder."""

    #: The form of this file.
    format: Literal["voidwalk-manifest/1"]
    #: Version of the program that wrote it.
    voidwalk: str
    #: Version of voidwalk.
    version: str
    #: Commit it was built from, where known.
    commit: Optional[str]
    #: The user's seed.
    seed: int
    #: Every file that was read.
    inputs: List[InputFile]
    #: Worker threads.
    threads: int
    #: Name of the machine.
    host: str
    #: Kind of machine: system, processor, memory.
    machine: str
    #: When the work began, RFC 3339.
    started: str
    #: When it ended, RFC 3339.
    finished: str
    #: The command line.
    command: str
