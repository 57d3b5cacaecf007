//! The table of all findings: each is declared here once.
//!
//! An entry makes a function of its name that takes its numbers. Findings stand in the order of this table,
//! the most important first.

use super::entry::{Entry, Finding, findings};
use super::quantity::FindingValue;
use crate::outcome::record::Topic;

findings! {
    /// Which class the replicates leave open.
    replicates_leave_open(): Walk;
        "replicates", "uncertainty.md",
        "The replicates do not separate the classes; more replicates may decide it.",
        to do "--decide 99% adds them until the class is that certain.";
    /// A second run that was not asked for.
    second_run_missing(): Walk;
        "second run", "uncertainty.md",
        "Some and continuing erosion differ by the second run, and only a first was asked for.",
        to do "runs = 2 walks both.";
    /// A confidence level that was not reached.
    level_missed(level: Percent, run: Text, mean: Text, distance: Points, sd: Points, more: Text):
        Walk;
        "level", "uncertainty.md",
        "Inconclusive at the {level} confidence level: the mean of the {run} run, {mean}, lies {distance} \
         from 7.5 %, and the replicates scatter by {sd}. {more}.";
    /// An unstable filter.
    loses_fines(rules: Text): Practice;
        "finer part", "rules.md",
        "The filter may lose its finer part. Rules that are not met: {rules}.";
    /// A filter too fine to drain.
    too_fine_to_drain(value: Text, asked: Text): Practice;
        "drainage", "rules.md",
        "The filter may be too fine to drain the base. D15F is {value}; {asked}. This says nothing of \
         retention.";
    /// A filter with too many fines to drain.
    fines_of_filter(rules: Text): Practice;
        "drainage", "rules.md",
        "The filter has fines and may not drain: {rules}. This says nothing of retention.";
    /// A filter that may segregate.
    may_segregate(rules: Text): Practice;
        "segregation", "rules.md",
        "The filter may segregate when it is placed: {rules}.";

    // What nobody has said of the base.
    /// A filter too coarse for the base if that is dispersive.
    dispersive_would_not_hold(limit: Text, value: Text): Practice;
        "dispersion", "rules.md",
        "If the base is dispersive, which is not stated, practice allows a D15F of at most {limit}, and this \
         is {value}.",
        to do "Say so once a test has shown it: --dispersive, or --set base.dispersive=false if it is not.";

    // What leaves a class open.
    /// A layer that is thicker than what was asked for.
    layer_thicker(ratio: Ratio, layer: Mm, asked: Text): Thickness;
        "thickness", "design.md",
        "One layer of voids is thicker than the filter asked for. At D15F/D85B {ratio} it is {layer}, and no \
         less can be walked: a filter of {asked} holds less.";
    /// A boundary at which few particles decide.
    unsteady(held: Count, eroding: Count, at: Text): Study;
        "scatter", "design.md",
        "A few particles decide where the filter begins to erode{at}. Of {eroding:network} that erode, \
         {held} held in the first run at a larger D15F/D85B than one at which they erode. With other random \
         numbers a filter may erode at a smaller D15F/D85B than the one given; a wider network is steadier.";
    /// A minimum D15F that drains above the greatest that holds.
    empty_band(least: Text, greatest: Text, set_by: Text): Study;
        "band", "design.md",
        "No filter of this shape both drains and holds this base. To drain it D15F must be at least {least}, \
         but {set_by} allows at most {greatest}.";
    /// A search in which nothing could be walked.
    nothing_walked(at: Text): Study;
        "search", "design.md",
        "No D15F/D85B of the search could be walked{at}, so that none is known to hold.";
    /// Networks that erode at every ratio.
    erodes_everywhere(eroding: Count, networks: Count, at: Text): Study;
        "search", "design.md",
        "{eroding} of {networks:network} erode 7.5 % or more at every ratio that was searched{at}. No ratio \
         is known that all but 5 % of the networks hold.";
    /// Networks that hold every ratio.
    holds_everywhere(ratio: Ratio, at: Text): Study;
        "search", "design.md",
        "Nearly all networks hold as far as was searched, to D15F/D85B {ratio}{at}. The maximum D15F is \
         therefore not known.",
        to do "A higher end of --bracket may find it.";
    /// A median beyond the search.
    median_beyond(ratio: Ratio, eroding: Count, networks: Count, at: Text): Study;
        "search", "design.md",
        "Nearly all networks hold to D15F/D85B {ratio}{at}; {eroding} of {networks} erode within the search, \
         and the median lies beyond it. The maximum D15F is therefore not known.",
        to do "A higher end of --bracket may find it.";
    /// A search that ends while the base erodes.
    erodes_to_end(ratio: Ratio, of: Text): Study;
        "search", "design.md",
        "At least 7.5 % of the base erodes down to D15F/D85B {ratio}, where the search ends{of}.";
    /// Ratios below which nothing can be walked.
    erodes_to(ratio: Ratio, of: Text, why: Text): Study;
        "search", "design.md",
        "At least 7.5 % of the base erodes down to D15F/D85B {ratio}{of}, and no smaller ratio can be \
         walked: {why}.";
    /// A search that ends while the filter holds.
    holds_to_end(run: Text, ratio: Ratio, of: Text): Study;
        "search", "design.md",
        "Less than 7.5 % of the base erodes{run} up to D15F/D85B {ratio}, where the search ends{of}.";
    /// Ratios beyond which nothing can be walked.
    not_walked(of: Text, why: Text): Study;
        "search", "design.md", "The search could go no further{of}: {why}.";
    /// A finest part of the base that is enough to erode.
    pan_erodes(share: Percent): Base;
        "finest part", "design.md",
        "{share} of the base is finer than its finest sieve. Taken as finer than every constriction it is \
         enough to count as erosion.",
        to do "Finer sieves would tell, or base.d0_mm.";

    // What walks say themselves.
    /// A verdict at a lower level than 95 %.
    decided_below_95(level: Percent): Walk;
        "level", "uncertainty.md",
        "The verdict is decided at the {level} confidence level, as asked. At 95 % these replicates leave it \
         open.";
    /// A filter that was closed before the second run.
    clogged_before(replicates: Text, smaller: Ratio): Flow;
        "clogging", "uncertainty.md",
        "No water flows in the second run{replicates}, as the filter clogged wholly in the first. Nothing \
         can erode then, and what was on its way when it clogged counts as retained. More and smaller \
         increments show whether the class stays.",
        to do "Try inject_share = {smaller}.";
    /// A filter that closed during a run.
    clogged(run: Text, replicates: Text, after: Text, on_its_way: Percent, smaller: Ratio):
        Flow;
        "clogging", "uncertainty.md",
        "The filter clogged wholly in the {run} run{replicates}{after}. No water flows then, and what was on \
         its way, at least {on_its_way} of the base, counts as retained and might have left. More and \
         smaller increments show whether the class stays.",
        to do "Try inject_share = {smaller}.";
    /// Trapped particles that could turn the class.
    trapped_could_turn(trapped: Count, inserted: Count, mass: Percent): Walk;
        "trapped", "uncertainty.md",
        "Particles trapped in closed loops could change the class. They are {trapped} of {inserted} \
         particles of a run, up to {mass} of the base by mass, and count as retained.";
    /// A second run that erodes though the first does not.
    second_run_erodes(eroded: Percent, threshold: Percent): Walk;
        "second run", "uncertainty.md",
        "The second run erodes {eroded} of its base, more than {threshold}. The class follows from the first \
         run alone, and more base may erode further.";

    // What goes in.
    /// A base whose sizes may be micrometres.
    coarse_base(d85: Mm): Base;
        "unit", "soils.md",
        "The D85 of the base is {d85}: are its sizes micrometres under a header in mm?";
    /// Fines that may be cohesive.
    cohesive_fines(fines: Percent): Base;
        "fines", "soils.md",
        "The base has {fines} fines (finer than 0.075 mm), and the model ignores cohesion.";
    /// Fines that nobody sieved.
    fines_not_sieved(fines: Percent, sieve: Mm): Base;
        "fines", "soils.md",
        "Up to {fines} of the base may be fines (finer than 0.075 mm), and the model ignores cohesion. The \
         finest sieve of the base is {sieve}.";
    /// A base that practice would regrade.
    not_regraded(at: Mm, why: Reason): Base;
        "grading", "soils.md",
        "The model errs on the unsafe side for this base. Practice regrades it on {at} ({why}), but it is \
         walked as sampled, so that a few coarse grains block for all the rest.",
        to do "base.regrade = \"practice\" walks the part that practice looks at.";
    /// A base that is broadly graded.
    broadly_graded(cu: Ratio): Base;
        "grading", "soils.md",
        "The model errs on the unsafe side for this base. It is broadly graded (Cu {cu}), so that a few \
         coarse grains block for all the rest.";
    /// A base that was regraded in another size.
    regraded_elsewhere(at: Mm): Base;
        "grading", "design.md",
        "The base was regraded on {at} in the size in which it is stated, and then scaled. Practice regrades \
         the scaled base elsewhere, or not at all.";
    /// A dispersive base.
    dispersive_base(): Base;
        "dispersion", "rules.md",
        "The base is dispersive, and the model knows its sizes alone. The rules of practice take their \
         limits for dispersive soils.";
    /// An open joint.
    open_joint(width: Mm): Base;
        "joint", "rules.md",
        "An open joint of {width} was not walked. The rules of practice say how likely erosion continues \
         into it.";
    /// A thickness that sizes without unit cannot be compared with.
    thickness_without_unit(real: Mm, unit: Text): Thickness;
        "thickness", "uncertainty.md",
        "The thickness of the filter cannot be compared. The real one is {real}, but sizes are multiples of \
         {unit}.",
        to do "Give sizes in mm, or leave filter.thickness_mm out.";
    /// A network from a file, which has no known thickness.
    thickness_of_file(real: Mm): Thickness;
        "thickness", "uncertainty.md",
        "The thickness of a network from a file is not known. The real filter is {real} thick, and is \
         compared with nothing.";
    /// A lattice thicker than the filter.
    layers_thicker(layers: Count, modelled: Text, real: Mm): Thickness;
        "thickness", "uncertainty.md",
        "The modelled filter is thicker than the real one. Its {layers:layer} of voids are {modelled} thick, \
         the real filter is {real}.",
        to do "network.nz says how many layers.";
    /// Copies of a packing thicker than the filter.
    copies_thicker(copies: Count, modelled: Text, real: Mm): Thickness;
        "thickness", "uncertainty.md",
        "The modelled filter is thicker than the real one. With {copies:copy|copies} of the packing it is \
         {modelled} thick, the real filter is {real}.",
        to do "network.copies, or network.thickness_mm, rounded up to whole copies, says how thick it is.";
    /// A cap on the base.
    capped_base(n: Count, needed: Count): Amount;
        "amount of base", "uncertainty.md",
        "The base is capped at {n} of the {needed} particles that its mass asks for. Fewer particles are a \
         bias of unknown sign, and a filter that was offered too few to fill it seems to hold.",
        to do "base.cap is the cap.";
    /// Fewer particles than asked for.
    few_particles(n: Count, needed: Count): Amount;
        "amount of base", "uncertainty.md",
        "The base has {n} of the {needed} particles with which the model was checked (5 % of the filter's \
         mass). Fewer particles are a bias of unknown sign, and a filter that was offered too few to fill it \
         seems to hold.";
    /// More particles than asked for.
    more_particles(n: Count, needed: Count): Amount;
        "amount of base", "uncertainty.md",
        "The base has {n} particles, and the model was checked with {needed} (5 % of the filter's mass). Of \
         more base a smaller share passes once the filter has filled, so that a filter may seem to hold.";
    /// A small mass of base.
    low_mass_ratio(ratio: Percent): Amount;
        "amount of base", "uncertainty.md",
        "The mass of the base is {ratio} of the filter's; the model was checked with 5 %. Fewer particles \
         are a bias of unknown sign, and a filter that was offered too few to fill it seems to hold.",
        to do "base.mass_ratio says how much.";
    /// A number of particles that is compared with nothing.
    amount_unknown(n: Count): Amount;
        "amount of base", "uncertainty.md",
        "Whether {n} base particles are enough is not known. The class follows from their number, and \
         without the filter and its grains per void nothing says how many are needed.",
        to do "filter.grains_per_void says how many grains the filter has for each void.";
    /// A number of particles that does not follow a search.
    amount_held(n: Count): Amount;
        "amount of base", "design.md",
        "The number of base particles is held at {n} or less at every ratio. Where the model asks for more, \
         more filters seem to hold.",
        to do "base.n_base and base.cap hold it.";
    /// A network that was given.
    given_network(voids: Count): Network;
        "network", "graph.md",
        "The network was given, with {voids:void}; nothing of it was checked against tests.";
    /// A network without its filter.
    no_filter(): Practice;
        "filter", "rules.md",
        "The filter was not given, so no rule of practice was applied.";
    /// A narrow lattice.
    narrow_lattice(nx: Count, ny: Count): Network;
        "network", "uncertainty.md",
        "The lattice is only {nx} x {ny} voids across. A narrow one seals by chance, so that filters seem to \
         hold. Use at least 10 x 10 voids; 40 x 40 are better.";
    /// A base that is all inserted before any can be through.
    all_on_its_way(increments: Count, layers: Count): Flow;
        "increments", "uncertainty.md",
        "The whole base is inserted before any of it can be through the filter. There are \
         {increments:increment} for {layers:layer}, and where water flows, all that is on its way when the \
         filter clogs counts as retained. With ten increments a layer at most a tenth of the base is on its \
         way.",
        to do "A smaller inject_share makes more increments.";
    /// A Cu out of the checked range.
    cu_unchecked(soil: Text, cu: Ratio, low: Ratio, high: Ratio): Base;
        "uniformity", "soils.md",
        "The Cu of the {soil} is {cu}, and the model was checked for {low} to {high}.";
    /// A Cu of which only the least is known, and that is out of the checked range.
    cu_at_least(soil: Text, cu: LeastRatio, d10: Mm, low: Ratio, high: Ratio): Base;
        "uniformity", "soils.md",
        "The Cu of the {soil} is more than {cu} (D10 is finer than {d10}), and the model was checked for \
         {low} to {high}.";
    /// A Cu that is not known.
    cu_unknown(soil: Text, low: Ratio, high: Ratio): Base;
        "uniformity", "soils.md",
        "The Cu of the {soil} is not known, and the model was checked for {low} to {high}. The D10 of the \
         {soil} is finer than its finest sieve.";
    /// A filter with a gap.
    gap_graded(within: Percent, from: Mm): Filter;
        "gap", "soils.md",
        "The filter is gap-graded: only {within} of it is between {from} and four times that. The \
         constrictions of its finer part, which it may lose, were walked.";
    /// The constriction curve of another filter.
    other_curve(cu: Ratio, curve: Text, of_cu: Ratio): Constrictions;
        "constrictions", "uncertainty.md",
        "The filter is walked with the constrictions of another filter. Its Cu is {cu}, but its curve \
         {curve} belongs to Cu {of_cu}.";
    /// Constrictions from the library, at a density that is not known.
    library_of_any_density(off_by: Percent): Constrictions;
        "density", "uncertainty.md",
        "The density of the filter is not given. Its constrictions come from packings of filters like it: \
         loose and dense are both walked, and {off_by} beyond either; the worst counts.",
        to do "filter.library says how densely it lies; filter.density packs this very filter.";
    /// Constrictions from the library.
    library_of_density(density: Text, off_by: Percent): Constrictions;
        "not packed", "uncertainty.md",
        "The constrictions come from packings of filters like this one ({density}), within {off_by} (that \
         held for 445 of 450 packings, each shape left out in turn; the error was set on these same \
         packings). Both ends of that range are walked.",
        to do "filter.density packs this very filter.";
    /// A gradation outside the library.
    like_none_of_the_library(): Constrictions;
        "constrictions", "uncertainty.md",
        "No packing of the library is like this filter, so its constrictions are guessed.",
        to do "filter.density packs it.";
    /// A guess of the constrictions.
    guessed_constrictions(): Constrictions;
        "constrictions", "uncertainty.md",
        "The constriction curve is a guess from circles inscribed between three or four grains, with 0.65 to \
         1.9 times the median that was measured on packed filters. As the densest packing it gave 0.65 to \
         0.82 times that median, as the loosest 1.6 to 1.9 times; both ends are walked, too.",
        to do "filter.density packs the grains and measures it, of a broad filter on its finer part.";
    /// A guess of the grains per void.
    guessed_grains(grains: Ratio): Amount;
        "amount of base", "uncertainty.md",
        "The number of filter grains per void is a guess: {grains}, as of loose packings (0.43 to 0.69 were \
         measured). The amount of base follows from it.",
        to do "filter.grains_per_void gives it.";
    /// A finer part that was packed.
    part_packed(percent: Percent, largest: Mm, finer_by: Percent): Filter;
        "finer part", "uncertainty.md",
        "The constrictions are those of the finer part of the filter alone: {percent} of its mass, up to \
         {largest}. They are up to {finer_by} finer than those of the whole (measured on filters that can be \
         packed whole), and both ends of that range are walked.";
    /// A finer part in which the coarse grains float.
    floating_part_packed(percent: Percent, largest: Mm, finer_by: Percent): Filter;
        "finer part", "uncertainty.md",
        "The constrictions are those of the finer part of the filter alone: {percent} of its mass, up to \
         {largest}. They are up to {finer_by} finer than those of the whole, and both ends of that range are \
         walked; the coarse grains of this gap-graded filter are taken to float in it, as they do where it \
         is 35 % of the mass or more (Skempton and Brogan 1994).";
    /// A finer part between coarse grains that carry each other.
    loose_part_packed(percent: Percent, largest: Mm, finer_by: Percent): Filter;
        "finer part", "uncertainty.md",
        "The constrictions are those of the finer part of the filter alone: {percent} of its mass, up to \
         {largest}. They are up to {finer_by} finer than those of the whole, and both ends of that range are \
         walked. Coarse grains float in 35 % of the mass or more (Skempton and Brogan 1994); here they carry \
         each other, the finer ones may lie loose between them, and wider constrictions than those that were \
         walked may be open.";
    /// Nearly all grains loose.
    skeleton(loose: Percent): Filter;
        "loose grains", "uncertainty.md",
        "The coarse grains of the filter carry each other. Nearly all finer grains ({loose} by number) lie \
         loose between them; water may wash those out, and with them the constrictions that were walked.";
    /// One replicate.
    one_replicate(): Walk;
        "replicates", "uncertainty.md",
        "There is one replicate, so the scatter is unknown. Walk more before relying on this.",
        to do "replicates = 10, say.";
    /// Few replicates.
    few_replicates(replicates: Count): Walk;
        "replicates", "uncertainty.md",
        "There are only {replicates:replicate}, whose scatter is hardly known.",
        to do "replicates = 10, say.";
    /// Few networks of a design.
    few_networks(networks: Count): Study;
        "networks", "design.md",
        "The search has only {networks:network}. A band of 5 to 95 % needs 5 at least; 20 are better.",
        to do "--set replicates=20.";

    // What was looked at and does no harm.
    /// A finest part that blocks nothing.
    pan_passive(share: Percent): Base;
        "finest part", "soils.md",
        "{share} of the base is finer than its finest sieve and than every constriction; it counts by mass \
         only.";
    /// A finest part that may block, and counts as if it did not.
    pan_counts_as_passing(share: Percent, sieve: Mm, constriction: Mm): Base;
        "finest part", "soils.md",
        "The finest {share} of the base lie below its last sieve, {sieve}, and count as passing; the finest \
         constriction is {constriction}.";
    // What else is to be known.
    /// A walk with arches.
    arches(law: Text): Walk;
        "arches", "arches.md",
        "Particles that fit a constriction jam in it together by a law of clogging ({law}) that no filter \
         test has checked.";
    /// A walk in which blocked constrictions leave openings.
    openings(): Walk;
        "openings", "arches.md",
        "A blocked constriction stays open beside the particle that blocks it. No filter test has checked \
         how wide.";
    /// A range of constriction curves, whose class and mass count.
    curve_range(low: Percent, high: Percent): Constrictions, unshown low high;
        "constrictions", "uncertainty.md",
        "Class and eroded mass cover the whole range of constriction curves that the filter may have.",
        to do "A filter that is packed whole (filter.density) has one measured curve.";

    // What a design's search says against its answer.
    /// Tables that may be exchanged, or in another unit.
    doubtful_tables(question: Text): Files;
        "tables", "soils.md", "{question}";
    /// A base that is not stable itself.
    unstable_base(index: Ratio, finer: Percent): Base;
        "internal stability of the base", "rules.md",
        "The base itself is not internally stable by Kenney and Lau: the minimum H/F is {index}, at F = \
         {finer}, and the limit is 1. That rule is for soils without cohesion. Water may move the finer part \
         through the base, so that the filter meets a soil other than the one sampled: decide whether the \
         filter is to hold that part, or have the pair tested.";
    /// A side of the band of a specification that is not stable itself.
    unstable_side(side: Text, broken: Text): Filter;
        "internal stability of the band", "design.md",
        "The {side} side of the band is not internally stable {broken}: a delivery along it may lose its \
         finer part. Judge each delivery by its own gradation.";
    /// A broadly graded base for which a filter is specified.
    broad_base(cu: Text): Base;
        "grading of the base", "design.md",
        "The base is broadly graded (Cu {cu} as sampled): its finer part may move between its coarse grains.";
    /// A base with a gap for which a filter is specified.
    gap_of_base(within: Percent, from: Mm, to: Mm): Base;
        "gap of the base", "design.md",
        "The base is gap-graded by this program's own check: only {within} of its mass lies between {from} \
         and {to}, where less than 5 % counts as a gap. Look at the curve: practice regrades such a base on \
         the size that is missing.";
    /// A base whose curve is flat somewhere, though it has no gap.
    flat_base(from: Mm, to: Mm, within: Percent, also: Text): Base;
        "gap of the base", "design.md",
        "The curve of the base is flat from {from} to {to}, with {within} of its mass: no gap by this \
         program's own check, in which less than 5 % within a factor of 4 in size counts as one. The \
         manual of the Corps (RMC-CPD-2023-04) leaves it to visual examination and judgment: look at the \
         curve{also}.";
    /// A target error that was not reached.
    target_missed(target: Points, half_width: Points, replicates: Count, needed: Count): Walk;
        "target error", "uncertainty.md",
        "The target error, {target}, was not reached. The 95 % interval reaches {half_width} to \
         either side after {replicates:replicate}; about {needed} would do.";
    /// A base that is walked regraded.
    regraded(part: Percent, at: Mm): Base;
        "grading", "soils.md",
        "The base is walked as practice regrades it: the {part} of it that is finer than {at}.";
    /// A base that was to be regraded.
    regrading_not_needed(why: Reason): Base;
        "grading", "soils.md", "Practice does not regrade this base ({why}).";
    /// How a file was read.
    read_as(file: Text, note: Text): Files;
        "file", "soils.md", "{file}: {note}.";
    /// Files of one soil with several curves.
    envelope(soil: Text, curves: Count, names: Text): Files;
        "envelope", "rules.md",
        "The {soil} has {curves:curve} ({names}), taken as the envelope of one soil.",
        to do "FILE#NAME takes one of them.";
    /// A finest part of the filter that is not counted.
    pan_of_filter(share: Percent): Filter;
        "finest part", "soils.md",
        "The finest {share} of the filter is not counted: too much base is offered, which favours holding.",
        to do "filter.d0_mm says where that part ends.";
    /// Many loose grains.
    loose_grains(loose: Percent): Filter;
        "loose grains", "uncertainty.md",
        "Most of the filter's small grains lie loose between the large ones ({loose} of all grains by \
         number). Water may move them; the model does not.";
    /// A tall cell that is narrow.
    narrow_cell(grains: Count, aspect: Ratio, width: Ratio, usual: Ratio): Filter;
        "cell", "uncertainty.md",
        "The packed cell is narrow: its {grains} grains, {aspect} times as tall as wide, leave it {width} \
         times as wide as the largest grain, where {usual} times is usual. Its voids repeat across, and \
         every layer has few of them.",
        to do "packing.grains says how many grains.";
    /// Replicates on one network.
    one_network(): Network;
        "network", "graph.md",
        "All replicates walk one network. Their spread is that of the walks, and says nothing of other \
         networks of the same filter.";
    /// Replicates on one packing.
    one_packing(copies: Count): Network;
        "packing", "graph.md",
        "All replicates walk the voids of one packing ({copies:copy|equal copies}), so that their spread is \
         that of the walk alone, not that between packings.";
    /// Loops whose way out is narrow.
    long_way_out(moves: Text): Network;
        "loops", "graph.md",
        "A base particle that nothing stops makes {moves} moves before it leaves. The network has loops \
         whose way out is very narrow, and a walk makes one move an increment, so it may not end in a \
         lifetime.",
        to do "Give those ways out a diameter of 0, so that what circles counts as trapped, or a wider one.";
    /// Ratios that hold above one that erodes.
    not_monotone(networks: Count): Study;
        "search", "design.md",
        "On {networks:network} some larger ratio was seen to hold in the first run or the second. There the \
         smallest ratio that was seen to erode counts.";
    /// Particles that circle.
    trapped(particles: Count): Walk;
        "trapped", "uncertainty.md",
        "{particles:particle} trapped in closed loops; they count as retained.";
    /// A base of which nobody has said whether it is dispersive, and a filter that practice allows then.
    dispersion_not_known(limit: Text): Practice;
        "dispersion", "rules.md",
        "If the base is dispersive, which is not stated, D15F must be {limit}.",
        to do "Say so once a test has shown it: --dispersive, or --set base.dispersive=false if it is not.";
    /// How far the permeability fell.
    permeability(run: Text, falls: Text, clean: Text): Flow;
        "permeability", "graph.md",
        "The permeability at the end of the {run} is {falls} of the clean filter's{clean}.";
    /// Voids that hold more than they have room for.
    overfull(fullest: Ratio, share: Percent): Flow;
        "full voids", "graph.md",
        "The fullest void holds {fullest} times the volume that it has between the grains, and up to {share} \
         of the voids hold more than 0.6 times: more than there is room for, which the model does not \
         know.";
    /// Particles in voids without volume.
    no_room(share: Percent): Flow;
        "full voids", "graph.md",
        "Particles rest in up to {share} of the voids that have no volume between the grains: more than \
         there is room for, which the model does not know.";
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    use super::*;

    /// Nothing that a number can be spoils a sentence.
    #[test]
    fn every_finding_reads_well_with_any_numbers() {
        let long = "a name ".repeat(200);
        for size in [0.0, 1e-300, -1.0, 12.345, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (n, text) in [(0, ""), (1, "x"), (u64::MAX, &*long), (2, "two\nlines {and} braces")] {
                for finding in all_with(size, n, text) {
                    let (id, record) = (finding.id(), finding.record());
                    for said in [&record.sentence, &record.to_do] {
                        assert!(!said.contains("NaN") && !said.contains("inf "), "{id}: {said}");
                        assert!(!said.contains("  "), "{id}: {said}");
                        assert!(text.contains('{') || !said.contains(['{', '}']), "{id}: {said}");
                    }
                    assert_eq!(record.numbers.len(), finding.values.len(), "{id}: names are unique");
                    serde_json::to_string(&record).unwrap();
                }
            }
        }
    }

    #[test]
    fn every_sentence_is_whole_and_every_number_is_used() {
        let mut ids = BTreeSet::new();
        for finding in all_with(12.5, 3, "some text") {
            let Entry { id, sentence, to_do, label, page, names, unshown, .. } = *finding.entry;
            assert!(ids.insert(id), "{id} is there twice");
            assert!(!label.is_empty() && Path::new("src/docs").join(page).exists(), "{id}: {page}");
            let first = sentence.chars().next().unwrap();
            assert!(first.is_uppercase() || first == '{', "{id}: {sentence}");
            // A file's note and a question end as they are written.
            assert!(sentence.ends_with(['.', '?', '}']), "{id}: {sentence}");
            for name in names {
                let used = [format!("{{{name}}}"), format!("{{{name}:")];
                let says = |text: &str| used.iter().any(|used| text.contains(used));
                let is_said = says(sentence) || says(to_do);
                assert_eq!(is_said, !unshown.contains(name), "{id} does not say {name}, or says it unshown");
            }
            // No words of the program where a client reads.
            for word in ["Eq. (", "base.", "filter.", "network.", "walk.", "inject_share", "--", "rattler"] {
                let said = finding.sentence();
                let is_key = |(at, _)| said[at + word.len()..].starts_with(|c: char| c.is_ascii_lowercase());
                let stands =
                    said.match_indices(word).any(is_key) || !word.ends_with('.') && said.contains(word);
                assert!(!stands, "{id}: {said}");
            }
            assert!(to_do.is_empty() || to_do.ends_with('.'), "{id}: {to_do}");
        }
        assert_eq!(ids.len(), ALL.len());
    }

    /// A dead entry would be a sentence that nobody ever reads.
    #[test]
    fn every_finding_is_reported_somewhere() {
        let mut code = String::new();
        let mut folders = vec![Path::new("src").to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("verdict/finding.rs")
                {
                    code += &fs::read_to_string(path).unwrap();
                }
            }
        }
        for entry in ALL {
            let is_used = ["finding", "found"].iter().any(|of| code.contains(&format!("{of}::{}", entry.id)));
            assert!(is_used, "{} is reported nowhere", entry.id);
        }
    }
}
