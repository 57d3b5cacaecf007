//! Rules for soils with widely spaced sieves: each rule is judged with the mass between two sieves placed
//! at the finer or at the coarser one, in every combination.
//!
//! Up to [`WIDE_STEP`] the worst of these results counts. Beyond it, a rule whose answer depends on the
//! step has no result. A rule of the filter's shape has no result on any such step, since the mass that
//! the filter loses is not known. Internal stability reads a straight line where next to nothing passes,
//! because sieves of ASTM D448 stones are that far apart there.
//!
//! [`WIDE_STEP`]: voidwalk_core::gradation::WIDE_STEP

use super::all::RULES;
use super::rule::{BaseSoil, FilterRule, Judged, Pairing, RuleInputs, judged, margin};
use super::stability::MOST_HIDDEN_PERCENT;
use crate::RuleNote;
use crate::applied::RuleRole;
use std::cmp::Ordering;
use voidwalk_core::gradation::{End, Gradation, Step};

/// Maximum number of steps spread one by one, the widest first. All others go to one end together.
const MOST_STEPS: usize = 6;

/// Open question of a sieve table, with two possible answers.
#[derive(Clone, Copy, Debug)]
enum Choice {
    /// Spread of the mass of a step of the filter.
    OfFilter(Step),
    /// Spread of the mass of a step of the base.
    OfBase(Step),
    /// Reading of a flat part of the base as a gap to regrade on, or not.
    Gap,
}

impl Choice {
    fn step(self) -> Option<Step> {
        match self {
            Self::OfFilter(step) | Self::OfBase(step) => Some(step),
            Self::Gap => None,
        }
    }

    fn width(self) -> f64 {
        self.step().map_or(1.0, |step| step.ratio())
    }

    fn is_wide(self) -> bool {
        self.step().is_some_and(|step| step.is_wide())
    }
}

/// All possible curves of a base; the bits of a curve's index are its choices.
pub(crate) struct OpenBase {
    choices: Vec<Choice>,
    curves: Vec<(Gradation, BaseSoil)>,
    /// Curves with the mass inside a wide step instead of at its ends, and this step.
    hidden: Vec<(Gradation, BaseSoil, Step)>,
}

impl OpenBase {
    /// Curves of a base; empty if its table leaves nothing open. Only wide steps hide a gap.
    pub(crate) fn of(base: &Gradation, scale_free: bool) -> Self {
        if scale_free {
            return Self { choices: Vec::new(), curves: Vec::new(), hidden: Vec::new() };
        }
        let steps = base.open_steps();
        let wide = spread(base, &steps, |_, step| step.is_wide());
        let cut = |curve: &Gradation| {
            let otherwise = curve.regraded_otherwise(curve).and_then(|other| other.at_mm);
            [curve.regraded().at_mm, otherwise]
        };
        let has_narrow = steps.iter().any(|step| !step.is_wide());
        let cuts: Vec<[Option<f64>; 2]> = wide.iter().filter(|_| has_narrow).map(cut).collect();
        // The part that passes a cut within a step that is not wide is read on the straight line.
        let is_cut = |place: usize, step: &Step| cuts[place].iter().flatten().any(|at| step.holds(*at));
        let curves = spread(base, &steps, |place, step| step.is_wide() || !is_cut(place, step));
        let curves = curves.into_iter().zip(wide);
        let read = |(curve, regraded_as): (Gradation, Gradation)| {
            let (soil, otherwise) = BaseSoil::both(&curve, &regraded_as);
            (curve, soil, otherwise)
        };
        let curves: Vec<(Gradation, BaseSoil, Option<BaseSoil>)> = curves.map(read).collect();
        let mut choices: Vec<Choice> = chosen(&steps).into_iter().map(Choice::OfBase).collect();
        let mut all: Vec<(Gradation, BaseSoil)> =
            curves.iter().map(|(curve, soil, _)| (curve.clone(), soil.clone())).collect();
        if curves.iter().any(|(_, _, otherwise)| otherwise.is_some()) {
            choices.push(Choice::Gap);
            all.extend(curves.into_iter().map(|(curve, soil, otherwise)| (curve, otherwise.unwrap_or(soil))));
        }
        if choices.is_empty() {
            all.clear();
        }
        let soils = |(curve, step): (Gradation, Step)| {
            let (soil, otherwise) = BaseSoil::both(&curve, &curve);
            [Some(soil), otherwise].into_iter().flatten().map(move |soil| (curve.clone(), soil, step))
        };
        let hidden = hidden(base, &steps, |_| true).into_iter().flat_map(soils).collect();
        Self { choices, curves: all, hidden }
    }
}

/// All possible curves of a filter.
pub(crate) struct OpenFilter {
    steps: Vec<Step>,
    curves: Vec<Gradation>,
    /// Curves read as straight lines where next to nothing passes.
    stable: Vec<Gradation>,
    /// Curves with the mass inside a wide step instead of at its ends, and this step.
    hidden: Vec<(Gradation, Step)>,
}

impl OpenFilter {
    /// Curves of a filter; empty if its table leaves nothing open.
    pub(crate) fn of(filter: &Gradation, is_measured: bool) -> Self {
        let steps = if is_measured { filter.open_steps() } else { Vec::new() };
        let curves = if steps.is_empty() { Vec::new() } else { spread(filter, &steps, |_, _| true) };
        let passes = |_: usize, step: &Step| filter.percent_finer_by_mass(step.to_mm) > MOST_HIDDEN_PERCENT;
        let stable = if curves.is_empty() { Vec::new() } else { spread(filter, &steps, passes) };
        let hidden = hidden(filter, &steps, |step| passes(0, step));
        Self { steps: chosen(&steps), curves, stable, hidden }
    }
}

/// Widest steps, which are spread one by one.
fn chosen(steps: &[Step]) -> Vec<Step> {
    let mut widest = steps.to_vec();
    widest.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    widest.truncate(MOST_STEPS);
    widest.sort_by(|a, b| a.from_mm.total_cmp(&b.from_mm));
    widest
}

/// Curves with the mass of one wide step anywhere but at its ends, and the mass of the others straight,
/// at their finer sieves and at their coarser sieves.
fn hidden(curve: &Gradation, steps: &[Step], counts: impl Fn(&Step) -> bool) -> Vec<(Gradation, Step)> {
    let others = |step: Step| {
        let at = |end| {
            let others = steps.iter().filter(move |other| **other != step);
            others.map(|other| (*other, curve.mass_at(other, end))).collect::<Vec<_>>()
        };
        match steps.len() {
            1 => vec![Vec::new()],
            _ => vec![Vec::new(), at(End::Fine), at(End::Coarse)],
        }
    };
    let filled = |step: &Step| {
        let all = curve.fillings(step).into_iter();
        let all =
            all.flat_map(|points| others(*step).into_iter().map(move |others| (others, points.clone())));
        let all = all.map(|(mut steps, points)| {
            steps.push((*step, points));
            steps.sort_by(|(a, _), (b, _)| a.from_mm.total_cmp(&b.from_mm));
            (curve.filled(&steps), *step)
        });
        all.collect::<Vec<_>>()
    };
    steps.iter().filter(|step| step.is_wide() && counts(step)).flat_map(filled).collect()
}

/// Curves with the mass of each step at either end: bit `i` of an index is set if step `i` has its mass
/// at the coarser sieve. Steps that are not spread one by one follow the last of those that are. Steps
/// that are not read by their ends keep the straight line.
fn spread(curve: &Gradation, steps: &[Step], by_ends: impl Fn(usize, &Step) -> bool) -> Vec<Gradation> {
    let chosen = chosen(steps);
    let end = |place: usize, step: &Step| {
        let at = chosen.iter().position(|other| other == step).unwrap_or(chosen.len().saturating_sub(1));
        if place >> at & 1 == 1 { End::Coarse } else { End::Fine }
    };
    let at = |place: usize| {
        let by_ends = steps.iter().filter(|step| by_ends(place, step));
        let points = |step: &Step| (*step, curve.mass_at(step, end(place, step)));
        curve.filled(&by_ends.map(points).collect::<Vec<_>>())
    };
    (0..1usize << chosen.len()).map(at).collect()
}

/// Judges one rule for two soils and the open questions of their tables; `None` if it was not requested.
pub(crate) fn judged_over(
    rule: &FilterRule,
    inputs: &RuleInputs,
    base: &OpenBase,
    filter: &OpenFilter,
) -> Option<Judged> {
    let plain = judged(rule, inputs)?;
    let over = match (rule.role, rule.pairing) {
        (RuleRole::Walk, _) => return Some(plain),
        (_, Pairing::EachPair) => of_pair(rule, inputs, base, filter),
        (_, Pairing::EachFilter) => of_filter(rule, inputs, filter),
        (_, Pairing::AllFilters) => of_filters(rule, inputs),
    };
    let result = match over {
        Some((choices, results)) => combined(rule, inputs, plain, &choices, results),
        None => plain,
    };
    let hidden = match rule.pairing {
        Pairing::EachPair => breaks_in_base(rule, inputs, &result, base, filter).map(Choice::OfBase),
        _ => breaks_in_filter(rule, inputs, &result, filter).map(Choice::OfFilter),
    };
    Some(match hidden {
        Some(choice) => {
            let needs = note(rule, inputs, choice, &result, &[]);
            left_open(result, matches!(choice, Choice::OfBase(_)), needs)
        }
        None => result,
    })
}

fn widest(steps: impl Iterator<Item = Step>) -> Option<Step> {
    steps.max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
}

fn is_kept(rule: &FilterRule, result: &Judged) -> bool {
    margin(rule, result).0 >= MET
}

fn is_broken(judged: Option<Judged>) -> bool {
    judged.is_some_and(|judged| judged.met == Some(false))
}

/// Widest step of a filter in which mass may lie so that it breaks a rule that both ends keep.
fn breaks_in_filter(
    rule: &FilterRule,
    inputs: &RuleInputs,
    result: &Judged,
    filter: &OpenFilter,
) -> Option<Step> {
    let is_of_shape = matches!(rule.role, RuleRole::Stability | RuleRole::Placing);
    if !is_of_shape || rule.pairing != Pairing::EachFilter || !is_kept(rule, result) {
        return None;
    }
    let breaks =
        |(filter, _): &&(Gradation, Step)| is_broken(judged(rule, &RuleInputs { filter, ..inputs.same() }));
    widest(filter.hidden.iter().filter(breaks).map(|(_, step)| *step))
}

/// Widest step of a base in which mass may lie so that it breaks a rule that both ends keep.
fn breaks_in_base(
    rule: &FilterRule,
    inputs: &RuleInputs,
    result: &Judged,
    base: &OpenBase,
    filter: &OpenFilter,
) -> Option<Step> {
    if !is_kept(rule, result) {
        return None;
    }
    let (_, filters) = d15f_ends(inputs.filter, filter);
    let breaks = |(base, soil, _): &&(Gradation, BaseSoil, Step)| {
        let breaks_with = |filter: &&Gradation| {
            is_broken(judged(rule, &RuleInputs { filter, base, base_soil: soil.clone(), ..inputs.same() }))
        };
        filters.iter().any(breaks_with)
    };
    widest(base.hidden.iter().filter(breaks).map(|(.., step)| *step))
}

/// Open step that contains D15F, and the filters with D15F at either end of it; without such a step, the
/// filter itself.
fn d15f_ends<'a>(filter: &'a Gradation, open: &'a OpenFilter) -> (Option<Step>, Vec<&'a Gradation>) {
    let encloses = |step: &Step| filter.d(15.0).is_some_and(|d15f| step.encloses(d15f));
    let step = widest(open.steps.iter().copied().filter(encloses));
    match (step, &open.curves[..]) {
        (Some(_), [finest, .., coarsest]) => (step, vec![finest, coarsest]),
        _ => (None, vec![filter]),
    }
}

/// Removes a result that depends on a step; the known facts about a base remain.
fn left_open(plain: Judged, is_of_base: bool, needs: Option<RuleNote>) -> Judged {
    Judged {
        met: None,
        applies: true,
        value: plain.value.filter(|_| is_of_base),
        limit_at_most: is_of_base || plain.limit_at_most,
        needs,
        without_finer: None,
        ..plain
    }
}

type Over = Option<(Vec<Choice>, Vec<Judged>)>;

/// Judges a rule that reads only D15F of the filter.
fn of_pair(rule: &FilterRule, inputs: &RuleInputs, base: &OpenBase, filter: &OpenFilter) -> Over {
    let (step, filters) = d15f_ends(inputs.filter, filter);
    let choices: Vec<Choice> =
        step.map(Choice::OfFilter).into_iter().chain(base.choices.iter().copied()).collect();
    if choices.is_empty() {
        return None;
    }
    let given = [(inputs.base.clone(), inputs.base_soil.clone())];
    let bases = if base.curves.is_empty() { &given[..] } else { &base.curves[..] };
    let pairs = bases.iter().flat_map(|base| filters.iter().map(move |filter| (base, *filter)));
    let results = pairs.filter_map(|((base, soil), filter)| {
        judged(rule, &RuleInputs { filter, base, base_soil: soil.clone(), ..inputs.same() })
    });
    Some((choices, results.collect()))
}

/// Judges rules of the filter alone.
fn of_filter(rule: &FilterRule, inputs: &RuleInputs, filter: &OpenFilter) -> Over {
    let curves = match rule.role {
        RuleRole::Stability => &filter.stable,
        _ => &filter.curves,
    };
    if curves.is_empty() {
        return None;
    }
    let results = curves.iter().filter_map(|filter| judged(rule, &RuleInputs { filter, ..inputs.same() }));
    Some((filter.steps.iter().map(|step| Choice::OfFilter(*step)).collect(), results.collect()))
}

/// Judges a rule of all filters at once, with the finest and the coarsest curve of each.
fn of_filters(rule: &FilterRule, inputs: &RuleInputs) -> Over {
    let open: Vec<OpenFilter> =
        inputs.filter_curves.iter().map(|filter| OpenFilter::of(filter, true)).collect();
    let step = Choice::OfFilter(widest(open.iter().flat_map(|filter| filter.steps.iter().copied()))?);
    let ends = |(given, open): (&&'_ Gradation, &OpenFilter)| match &open.curves[..] {
        [finest, .., coarsest] => vec![finest.clone(), coarsest.clone()],
        _ => vec![(*given).clone()],
    };
    let every: Vec<Gradation> = inputs.filter_curves.iter().zip(&open).flat_map(ends).collect();
    let apart = judged(rule, &RuleInputs { filter_curves: every.iter().collect(), ..inputs.same() })?;
    Some((vec![step], vec![judged(rule, inputs)?, apart]))
}

/// Class of a rule that is kept; a rule that was not made for the soils does not count against them.
const MET: u8 = 2;

/// Combines the results that the open choices allow; bit `i` of an index is choice `i`.
fn combined(
    rule: &FilterRule,
    inputs: &RuleInputs,
    plain: Judged,
    choices: &[Choice],
    results: Vec<Judged>,
) -> Judged {
    let places = 0..results.len();
    let class = |judged: &Judged| margin(rule, judged).0.min(MET);
    let by_margin =
        |a: &&Judged, b: &&Judged| margin(rule, a).partial_cmp(&margin(rule, b)).unwrap_or(Ordering::Equal);
    let Some(worst) = results.iter().chain([&plain]).min_by(by_margin).cloned() else { return plain };
    let is_of_shape = matches!(rule.role, RuleRole::Stability | RuleRole::Placing);
    let wide: Vec<usize> = (0..choices.len()).filter(|i| is_of_shape || choices[*i].is_wide()).collect();
    let mask = wide.iter().fold(0, |mask, i| mask | 1 << i);
    // For steps that are not wide, the worst counts.
    let answer = |place: usize| {
        let same = places.clone().filter(|other| other & mask == place & mask);
        same.map(|other| class(&results[other])).min()
    };
    let flips = |i: &usize| places.clone().any(|place| answer(place) != answer(place ^ 1 << i));
    let moves = |i: &usize| places.clone().any(|place| is_moved(&results[place], &results[place ^ 1 << i]));
    // The widest step should be sieved first.
    let width = |a: &usize, b: &usize| choices[*a].width().total_cmp(&choices[*b].width());
    // Both ends may break a rule that the straight line between them keeps.
    let breaks = |i: &usize| {
        choices[*i].is_wide() && class(&plain) == MET && results.iter().all(|judged| class(judged) == 0)
    };
    if let Some(flips) = wide.iter().copied().filter(|i| flips(i) || breaks(i)).max_by(width) {
        let is_of_base = matches!(choices[flips], Choice::OfBase(_));
        return left_open(plain, is_of_base, note(rule, inputs, choices[flips], &worst, &results));
    }
    let Some(moves) = (0..choices.len()).filter(moves).max_by(width) else { return plain };
    // If all agree, numbers for widely spaced sieves come from the straight line.
    let is_plain = class(&plain) == class(&worst) && (choices[moves].is_wide() || !plain.applies);
    let lost = results.iter().chain([&plain]).filter_map(|judged| judged.without_finer);
    let lost = lost.max_by(|a, b| a.d15f.total_cmp(&b.d15f));
    let judged = if is_plain { plain } else { worst };
    let note = note(rule, inputs, choices[moves], &judged, &results);
    // If one reading leaves the limit open, the limit is at most that of another reading.
    let least = results.iter().filter_map(|judged| judged.limit).reduce(f64::min);
    let is_open = judged.met.is_none() && judged.limit_at_most && !rule.at_least && !is_plain;
    // A limit that is kept in every reading is stated by its strict end.
    let greatest = results.iter().filter_map(|judged| judged.limit).reduce(f64::max);
    let limit = match judged.met {
        Some(true) if is_plain => if rule.at_least { greatest } else { least }.or(judged.limit),
        _ if is_open => least,
        _ => judged.limit,
    };
    let without_finer = lost.filter(|_| judged.met == Some(false)).or(judged.without_finer);
    Judged { without_finer, limit, ..judged }.noted(note)
}

/// True if two results differ by more than rounding.
fn is_moved(here: &Judged, there: &Judged) -> bool {
    let apart = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() > 1e-6 * a.abs().max(b.abs()),
        _ => a != b,
    };
    apart(here.value, there.value) || apart(here.limit, there.limit) || here.met != there.met
}

/// Limit of a rule of D15F over all readings that the table of a base leaves open.
pub(crate) struct SievedLimit {
    /// Strictest limit.
    pub(crate) strictest: f64,
    /// Mildest limit.
    pub(crate) mildest: f64,
    /// Widely spaced sieves that the limit depends on.
    pub(crate) depends_on: Option<RuleNote>,
}

/// Limit of a rule of D15F for a base in mm, over all readings that its table leaves `open`; `None`
/// without a limit.
pub(crate) fn sieved_limit(
    id: &str,
    base: &Gradation,
    open: &OpenBase,
    dispersive: bool,
) -> Option<SievedLimit> {
    let rule = RULES.iter().find(|rule| rule.id == id)?;
    let filter = Gradation::linear_from_dx(15.0, 1.0, 1.5).ok()?;
    let inputs = RuleInputs { dispersive, ..RuleInputs::of_soils(base, &filter) };
    let plain = judged(rule, &inputs)?;
    let over = of_pair(rule, &inputs, open, &OpenFilter::of(&filter, false));
    let (choices, results) = over.unwrap_or_default();
    let of_hidden = |(base, soil, step): &(Gradation, BaseSoil, Step)| {
        let inputs = RuleInputs { base, base_soil: soil.clone(), ..inputs.same() };
        Some((judged(rule, &inputs)?, *step))
    };
    let hidden: Vec<(Judged, Step)> = open.hidden.iter().filter_map(of_hidden).collect();
    let all = results.iter().chain([&plain]).chain(hidden.iter().map(|(judged, _)| judged));
    let limits: Vec<f64> = all.filter_map(|judged| judged.limit).collect();
    let least = limits.iter().copied().reduce(f64::min)?;
    let most = limits.into_iter().fold(least, f64::max);
    let (strictest, mildest) = if rule.at_least { (most, least) } else { (least, most) };
    let moves = |i: &usize| {
        let places = 0..results.len();
        choices[*i].is_wide() && places.into_iter().any(|at| is_moved(&results[at], &results[at ^ 1 << i]))
    };
    let width = |a: &usize, b: &usize| choices[*a].width().total_cmp(&choices[*b].width());
    let moves = (0..choices.len()).filter(moves).max_by(width).map(|i| choices[i]);
    let hidden = hidden.iter().filter(|(judged, _)| is_moved(judged, &plain)).map(|(_, step)| *step);
    let moves = moves.or_else(|| widest(hidden).map(Choice::OfBase));
    let depends_on = moves.and_then(|choice| note(rule, &inputs, choice, &plain, &results));
    Some(SievedLimit { strictest, mildest, depends_on })
}

/// Note on a choice that a result depends on, among all results.
fn note(
    rule: &FilterRule,
    inputs: &RuleInputs,
    choice: Choice,
    judged: &Judged,
    results: &[Judged],
) -> Option<RuleNote> {
    let step = match choice {
        Choice::OfFilter(step) if rule.pairing == Pairing::EachPair => {
            return Some(RuleNote::D15FBetween(step.from_mm, step.to_mm));
        }
        Choice::OfFilter(step) => return Some(RuleNote::FilterBetween(step.from_mm, step.to_mm)),
        Choice::Gap => {
            let limits =
                results.iter().filter_map(|result| result.limit).filter(|limit| Some(*limit) != judged.limit);
            return limits.reduce(f64::max).map(RuleNote::FlatBase);
        }
        Choice::OfBase(step) => step,
    };
    let encloses = |size: Option<f64>| size.is_some_and(|size| step.encloses(size));
    let regraded = |percent| encloses(inputs.base_soil.gradation.d(percent));
    let between = match rule.role {
        RuleRole::Drainage if encloses(inputs.base.d(15.0)) => RuleNote::D15BBetween,
        RuleRole::Continuation if regraded(95.0) => RuleNote::D95BBetween,
        RuleRole::Retention if regraded(85.0) => RuleNote::D85BBetween,
        _ => RuleNote::BaseBetween,
    };
    Some(between(step.from_mm, step.to_mm))
}
