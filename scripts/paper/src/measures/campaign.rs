//! Measures of the campaign of base-filter combinations.
//!
//! Rules that the paper states of "all" combinations are counted over all that its list of filters and bases
//! gives, which are 78, though it says 66: nothing tells which 12 it left out.

use std::collections::BTreeSet;

use crate::measured::{Measured, Of};
use crate::study::{Case, Study, times};
use voidwalk::outcome::record::{Run, Statistic, Verdict};

/// The combinations of a variant that pass a test.
fn those<'a>(study: &'a Study, plan: &str, fits: impl Fn(&Case) -> bool) -> Vec<&'a Case> {
    study.cases(plan).into_iter().filter(|case| fits(case)).collect()
}

fn find<'a>(study: &'a Study, plan: &str, of: &Of) -> Option<&'a Case> {
    study.case(plan, &of.levels())
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

pub fn voids(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    Some(Measured::exact(study.cases(plan).first()?.outcome.inputs.network.voids as f64))
}

pub fn combinations(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let all = study.cases(plan).len();
    (all > 0).then(|| Measured::exact(all as f64))
}

/// Constrictions of a void of the network, up and down the flow and to its sides.
pub fn connections(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let network = &study.cases(plan).first()?.outcome.inputs.network;
    Some(Measured::exact(2.0 * network.constrictions as f64 / network.voids as f64))
}

pub fn n_base(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    find(study, plan, of)?.line.n_base_eq2.map(|n| Measured::exact(n as f64))
}

/// Particles of both runs together, most of all combinations.
pub fn most_particles(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let most =
        study.cases(plan).into_iter().map(|case| case.line.n_base * case.line.runs.len() as u64).max()?;
    Some(Measured::exact(most as f64))
}

/// Constrictions that the second run blocks in percent of those of the first: median.
pub fn second_blocks(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let share = |case: &Case| {
        let (first, both) = (case.run(1)?.blocked_fraction.mean, case.run(2)?.blocked_fraction.mean);
        (first > 0.0).then(|| 100.0 * (both - first) / first)
    };
    let mut all: Vec<f64> = those(study, plan, |_| true).into_iter().filter_map(share).collect();
    let middle = median(&mut all)?;
    let at = |share: f64| all[((all.len() - 1) as f64 * share) as usize];
    Some(Measured::exact(middle).saying(format!("median; half of them {:.1} to {:.1}", at(0.25), at(0.75))))
}

/// Percent of all spreads (%) that keep within a limit.
fn share_within(all: &mut [f64], limit: f64) -> Option<Measured> {
    let middle = median(all)?;
    let within = all.iter().filter(|spread| **spread <= limit).count();
    let (n, largest) = (all.len(), all[all.len() - 1]);
    let words = format!("{within} of {n}; the median spread is {middle:.1} %, the largest {largest:.1} %");
    Some(Measured::exact(100.0 * within as f64 / n as f64).saying(words))
}

/// Percent of the combinations whose spread over the replicates keeps within `of.within`.
fn reruns(study: &Study, plan: &str, of: &Of, spread: impl Fn(&Case) -> Option<f64>) -> Option<Measured> {
    let mut all: Vec<f64> = study.cases(plan).into_iter().filter_map(spread).collect();
    share_within(&mut all, of.within)
}

fn spread(values: &[f64]) -> Option<f64> {
    let high = values.iter().copied().reduce(f64::max)?;
    Some(high - values.iter().copied().reduce(f64::min)?)
}

fn first_runs(case: &Case) -> impl Iterator<Item = &Run> {
    case.outcome.replicates.iter().filter_map(|replicate| replicate.runs.first())
}

/// Combinations by the spread of the largest eroded particle over new networks, in percent of its mean.
pub fn reruns_largest(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let one = |case: &Case| {
        let sizes: Vec<f64> = first_runs(case).filter_map(|run| run.largest_eroded_over_d15f).collect();
        (sizes.len() > 1).then(|| 100.0 * spread(&sizes).unwrap_or(0.0) / Statistic::of(&sizes).mean)
    };
    reruns(study, plan, of, one)
}

/// Combinations by the spread of the eroded mass over new networks, in percent of the total.
pub fn reruns_eroded(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let one = |case: &Case| {
        let eroded: Vec<f64> = first_runs(case).map(|run| 100.0 * run.eroded_mass_fraction).collect();
        (eroded.len() > 1).then(|| spread(&eroded)).flatten()
    };
    reruns(study, plan, of, one)
}

/// 1 where the case has this class, 0 where it has another.
pub fn class(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let case = find(study, plan, of)?;
    let words = format!("{}: {:.1} % then {:.1} %", case.line.verdict.words(), case.mean(1), case.mean(2));
    let measured = Measured::exact(f64::from(u8::from(case.line.verdict.words() == of.class))).saying(words);
    Some(Measured { open: case.line.verdict == Verdict::Undecided, ..measured })
}

/// Eroded mass of a case in a run, percent.
pub fn eroded(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    find(study, plan, of)?.eroded(of.run).as_ref().map(Measured::of)
}

/// Cases without the class that a rule gives them.
fn outside(cases: &[&Case], class: Verdict) -> Option<Measured> {
    let of = |test: &dyn Fn(Verdict) -> bool| cases.iter().filter(|case| test(case.line.verdict)).count();
    let open = of(&|verdict| verdict == Verdict::Undecided);
    Measured::exceptions(of(&|verdict| verdict != class) - open, open, cases.len())
}

fn is_wide(case: &Case) -> bool {
    case.level("cu_b") != "1.5"
}

pub fn loose_below_5_not_none(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    outside(&those(study, plan, |case| case.is_loose() && case.d85_ratio() < 5.0), Verdict::None)
}

pub fn uniform_above_5_not_continuing(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let uniform = |case: &Case| case.is_loose() && !is_wide(case) && case.d85_ratio() > 5.0;
    outside(&those(study, plan, uniform), Verdict::Continuing)
}

fn in_the_middle(case: &Case) -> bool {
    (5.0..6.0).contains(&case.d85_ratio())
}

pub fn wide_5_to_6_not_some(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    outside(
        &those(study, plan, |case| case.is_loose() && is_wide(case) && in_the_middle(case)),
        Verdict::Some,
    )
}

/// Greatest fall from the first run to the second of uniform bases above 5, in percent of the first.
pub fn uniform_reduction(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let uniform = |case: &Case| case.is_loose() && !is_wide(case) && case.d85_ratio() > 5.0;
    let fall = |case: &Case| 100.0 * (1.0 - case.mean(2) / case.mean(1));
    those(study, plan, uniform).into_iter().map(fall).max_by(f64::total_cmp).map(Measured::exact)
}

/// Loose filters with the finest base, D15F/D85B = 6.5, where it is widely graded.
fn wide_at_65<'a>(study: &'a Study, plan: &str) -> Vec<&'a Case> {
    those(study, plan, |case| case.is_loose() && is_wide(case) && case.level("d85b") == "dc0")
}

pub fn wide_65_not_continuing(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    outside(&wide_at_65(study, plan), Verdict::Continuing)
}

pub fn wide_65_not_less(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let cases = wide_at_65(study, plan);
    let not_less = cases.iter().filter(|case| case.mean(2) >= case.mean(1)).count();
    Measured::exceptions(not_less, 0, cases.len())
}

/// Eroded in the second run in percent of what is eroded in the first.
pub fn second_over_first(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let case = find(study, plan, of)?;
    let words = format!("{:.1} % then {:.1} %", case.mean(1), case.mean(2));
    (case.mean(1) > 0.0).then(|| Measured::exact(100.0 * case.mean(2) / case.mean(1)).saying(words))
}

/// Eroded mass of the first run against D15F/D85B for a filter and a base, by rising ratio.
fn progress(study: &Study, plan: &str, filter: &str, cu_b: &str) -> Vec<(f64, f64)> {
    let own = those(study, plan, |case| case.level("filter") == filter && case.level("cu_b") == cu_b);
    let mut points: Vec<(f64, f64)> = own.into_iter().map(|case| (case.d85_ratio(), case.mean(1))).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Of the steps from one base size to the next finer one, percent in which more erodes.
pub fn rising(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let levels = |factor: &str| -> BTreeSet<String> {
        study.cases(plan).into_iter().map(|case| case.level(factor).to_string()).collect()
    };
    let mut rises = Vec::new();
    for filter in levels("filter") {
        for cu_b in levels("cu_b") {
            rises.extend(progress(study, plan, &filter, &cu_b).windows(2).map(|two| two[1].1 - two[0].1));
        }
    }
    let more = rises.iter().filter(|rise| **rise > 0.0).count();
    let words = format!("{more} of {} steps", rises.len());
    (!rises.is_empty()).then(|| Measured::exact(100.0 * more as f64 / rises.len() as f64).saying(words))
}

/// Least rise of the eroded mass from one base size to the next finer one above 5, uniform bases on loose
/// filters, in percent of the base.
pub fn uniform_rise(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let above = |filter| -> Vec<(f64, f64)> {
        progress(study, plan, filter, "1.5").into_iter().filter(|point| point.0 > 5.0).collect()
    };
    let rises = ["cu1.5-loose", "cu3-loose"]
        .map(|filter| above(filter).windows(2).map(|two| two[1].1 - two[0].1).reduce(f64::min));
    rises.into_iter().flatten().reduce(f64::min).map(Measured::exact)
}

/// Height of a polygon of points that rise in x.
fn height(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let two = points.windows(2).find(|two| two[0].0 <= x && x <= two[1].0 && two[0].0 < two[1].0)?;
    Some(two[0].1 + (two[1].1 - two[0].1) * (x - two[0].0) / (two[1].0 - two[0].0))
}

/// Greatest difference of the eroded mass at one D15F/D85B between the loose filters with Cu 3 and Cu 1.5,
/// base with Cu 1.5, in percent of the base.
pub fn filters_unlike(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let (a, b) = (progress(study, plan, "cu1.5-loose", "1.5"), progress(study, plan, "cu3-loose", "1.5"));
    let between = |own: &[(f64, f64)], other: &[(f64, f64)]| -> Vec<(f64, f64)> {
        own.iter().filter_map(|(x, y)| Some((*x, (height(other, *x)? - y).abs()))).collect()
    };
    let all = [between(&a, &b), between(&b, &a)].concat();
    let (ratio, most) = all.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Measured::exact(most).saying(format!("at D15F/D85B {ratio:.2}, between straight lines")))
}

/// Base sizes at which the largest particle that a base with Cu 1.5 erodes, over D0F, is no larger with the
/// loose filter with Cu 3 than with that with Cu 1.5.
pub fn wider_filter_not_larger(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let wider = those(study, plan, |case| case.level("filter") == "cu3-loose" && !is_wide(case));
    let twin = |case: &Case| {
        let levels = [("filter", "cu1.5-loose"), ("cu_b", "1.5"), ("d85b", case.level("d85b"))];
        let narrower = study.case(plan, &levels)?.largest_over_d0f(1)?;
        Some((case.largest_over_d0f(1)?.mean, narrower.mean))
    };
    let twins: Vec<(f64, f64)> = wider.into_iter().filter_map(twin).collect();
    let not_larger = twins.iter().filter(|(wider, narrower)| wider <= narrower).count();
    Measured::exceptions(not_larger, 0, twins.len())
}

/// Cases on dense filters, each/// Cases on dense filters, each with its twin on the loose one.
fn twins<'a>(study: &'a Study, plan: &str, fits: impl Fn(&Case) -> bool) -> Vec<(&'a Case, &'a Case)> {
    let dense = those(study, plan, |case| !case.is_loose() && fits(case));
    let twin = |case: &&'a Case| {
        let filter = case.level("filter").replace("dense", "loose");
        let levels =
            [("filter", filter.as_str()), ("cu_b", case.level("cu_b")), ("d85b", case.level("d85b"))];
        Some((*case, study.case(plan, &levels)?))
    };
    dense.iter().filter_map(twin).collect()
}

/// Combinations above 5 that erode no less on the dense filter.
pub fn dense_not_less(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let twins = twins(study, plan, |case| case.d85_ratio() > 5.0);
    Measured::exceptions(
        twins.iter().filter(|(dense, loose)| dense.mean(1) >= loose.mean(1)).count(),
        0,
        twins.len(),
    )
}

/// Combinations above 5 in which the base with Cu 4.5 erodes no less than that with Cu 1.5.
pub fn wide_not_less(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let widest = those(study, plan, |case| case.level("cu_b") == "4.5" && case.d85_ratio() > 5.0);
    let not_less = |case: &&&Case| {
        let levels = [("filter", case.level("filter")), ("cu_b", "1.5"), ("d85b", case.level("d85b"))];
        study.case(plan, &levels).is_some_and(|uniform| case.mean(1) >= uniform.mean(1))
    };
    Measured::exceptions(widest.iter().filter(not_less).count(), 0, widest.len())
}

/// A ratio that parts two kinds of cases, the coarser kind above it.
struct Boundary {
    low: f64,
    high: f64,
    /// Cases on the wrong side.
    wrong: usize,
    all: usize,
}

impl Boundary {
    /// The best of all boundaries: between which ratios it lies, and how many cases it leaves on the wrong
    /// side. Cases of one ratio are on one side.
    fn best(cases: &[(f64, bool)]) -> Option<Self> {
        let mut sorted = cases.to_vec();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let wrong = |at: usize| {
            sorted.iter().enumerate().filter(|(index, (_, above))| *above != (*index >= at)).count()
        };
        // Ratios of bases with unlike Cu are the same but for rounding.
        let between = |at: &usize| sorted[*at].0 > sorted[at - 1].0 * (1.0 + 1e-9);
        let places: Vec<(usize, usize)> =
            (1..sorted.len()).filter(between).map(|at| (wrong(at), at)).collect();
        let (fewest, at) = *places.iter().min()?;
        // Where several neighbouring boundaries are equally good, the range spans them.
        let from_there = places.iter().skip_while(|place| place.1 < at);
        let last = from_there.take_while(|place| place.0 == fewest).last()?.1;
        Some(Self { low: sorted[at - 1].0, high: sorted[last].0, wrong: fewest, all: sorted.len() })
    }

    fn measured(&self) -> Measured {
        let words = format!("{} of {} on the wrong side", self.wrong, self.all);
        let middle = 0.5 * (self.low + self.high);
        Measured { interval: Some((self.low, self.high)), ..Measured::exact(middle).saying(words) }
    }
}

/// Loose combinations by a ratio and whether they lie above a boundary. By means: an interval cannot be on
/// one side.
fn parted(study: &Study, plan: &str, ratio: fn(&Case) -> f64, above: fn(&Case) -> bool) -> Option<Boundary> {
    let cases: Vec<(f64, bool)> =
        those(study, plan, Case::is_loose).into_iter().map(|case| (ratio(case), above(case))).collect();
    Boundary::best(&cases)
}

fn goes_on(case: &Case) -> bool {
    case.mean(1) >= 7.5 && case.mean(2) >= 7.5
}

pub fn dividing_d95(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    parted(study, plan, Case::d95_ratio, goes_on).map(|b| b.measured())
}

pub fn dividing_d85(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    parted(study, plan, Case::d85_ratio, erodes).map(|b| b.measured())
}

fn erodes(case: &Case) -> bool {
    case.mean(1) >= 7.5
}

/// By how many fewer cases the best boundary of D15F/D85B is wrong than that of D15F/D95B, for no erosion.
pub fn d85_better(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let d85 = parted(study, plan, Case::d85_ratio, erodes)?;
    let d95 = parted(study, plan, Case::d95_ratio, erodes)?;
    let words = format!("{} wrong by D85B, {} by D95B, of {}", d85.wrong, d95.wrong, d85.all);
    Some(Measured::exact(d95.wrong as f64 - d85.wrong as f64).saying(words))
}

/// By how many fewer cases the best boundary of D15F/D95B is wrong than that of D15F/D85B, for continuing
/// erosion.
pub fn d95_better(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let d85 = parted(study, plan, Case::d85_ratio, goes_on)?;
    let d95 = parted(study, plan, Case::d95_ratio, goes_on)?;
    let words = format!("{} wrong by D85B, {} by D95B, of {}", d85.wrong, d95.wrong, d95.all);
    Some(Measured::exact(d85.wrong as f64 - d95.wrong as f64).saying(words))
}

/// Largest eroded particle over D15F: mean over the cases with these levels.
pub fn largest_over_d15f(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let fits = |case: &Case| of.levels().iter().all(|(factor, level)| case.level(factor) == *level);
    let cases = those(study, plan, fits);
    let all: Vec<f64> = cases.iter().filter_map(|case| case.largest(1).map(|l| l.mean)).collect();
    let (low, high) = all.iter().fold((f64::MAX, 0.0_f64), |(low, high), &v| (low.min(v), high.max(v)));
    let own = cases.iter().filter(|case| case.erodes_its_largest(1)).count();
    let words =
        format!("{low:.3} to {high:.3} over {} bases, {own} of which erode their own largest", all.len());
    (!all.is_empty()).then(|| Measured::exact(Statistic::of(&all).mean).saying(words))
}

fn uniform_pairs<'a>(study: &'a Study, plan: &str) -> Vec<(&'a Case, &'a Case)> {
    twins(study, plan, |case| {
        case.level("filter") == "cu1.5-dense" && !is_wide(case) && case.d85_ratio() < 6.4
    })
}

/// By how many percent the largest particle eroded through the dense filter is finer: mean.
pub fn dense_largest_finer(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let finer = |(dense, loose): (&Case, &Case)| {
        Some(100.0 * (1.0 - dense.largest(1)?.mean / loose.largest(1)?.mean))
    };
    let all: Vec<f64> = uniform_pairs(study, plan).into_iter().filter_map(finer).collect();
    (!all.is_empty())
        .then(|| Measured::exact(Statistic::of(&all).mean).saying(format!("mean of {} bases", all.len())))
}

/// Combinations below 6.5 whose largest eroded particle is no finer with the dense filter.
pub fn dense_largest_not_less(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let pairs = uniform_pairs(study, plan);
    let not_less = |(dense, loose): &&(&Case, &Case)| {
        dense.largest(1).zip(loose.largest(1)).is_some_and(|(dense, loose)| dense.mean >= loose.mean)
    };
    Measured::exceptions(pairs.iter().filter(not_less).count(), 0, pairs.len())
}

/// Most that erodes in the first run of Cu 1.5 on a filter with Cu 1.5 below 5, percent.
pub fn most_eroded_below_5(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let small = |case: &Case| case.level("filter") == of.filter && !is_wide(case) && case.d85_ratio() < 5.0;
    let all = those(study, plan, small).into_iter().filter_map(|case| case.eroded(1));
    all.max_by(|a, b| a.mean.total_cmp(&b.mean)).as_ref().map(Measured::of)
}

/// Loose less dense, first run of Cu 1.5 on filters with Cu 1.5 between 5 and 6: the largest difference,
/// percent of the base.
pub fn density_effect(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let pairs = uniform_pairs(study, plan).into_iter().filter(|(dense, _)| in_the_middle(dense));
    pairs.map(|(dense, loose)| loose.mean(1) - dense.mean(1)).max_by(f64::total_cmp).map(Measured::exact)
}

/// Ranks from 1; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let of = |v: &f64| {
        let below = values.iter().filter(|other| *other < v).count();
        let equal = values.iter().filter(|other| *other == v).count();
        below as f64 + 0.5 * (equal as f64 + 1.0)
    };
    values.iter().map(of).collect()
}

/// Spearman's rank correlation.
fn rank_correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    let (x, y) = (ranks(&x), ranks(&y));
    let middle = 0.5 * (pairs.len() as f64 + 1.0);
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>();
    let (xx, yy) = (sum(&x, &x), sum(&y, &y));
    (xx > 0.0 && yy > 0.0).then(|| sum(&x, &y) / (xx * yy).sqrt())
}

/// Eroded mass, mean of both runs, percent.
pub fn of_both_runs(case: &Case) -> f64 {
    0.5 * (case.mean(1) + case.mean(2))
}

/// Percent of all constrictions, and of those of the first three layers, blocked after the second run.
pub fn blocked(case: &Case) -> Option<(f64, f64)> {
    let second = case.run(2)?;
    let percent = |s: &Statistic| times(s, 100.0).mean;
    Some((percent(&second.blocked_fraction), percent(&second.blocked_first_three_layers_fraction)))
}

/// Blocked of the first three layers over blocked of all, after the second run.
pub fn blocked_near_over_all(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let (all, near) = blocked(find(study, plan, of)?)?;
    let words = format!("{near:.1} % of the first three layers, {all:.1} % of all");
    (all > 0.0).then(|| Measured::exact(near / all).saying(words))
}

fn ranked(study: &Study, plan: &str, of: fn((f64, f64)) -> f64) -> Option<Measured> {
    let loose = those(study, plan, Case::is_loose);
    let pairs: Vec<(f64, f64)> =
        loose.into_iter().filter_map(|case| Some((of(blocked(case)?), of_both_runs(case)))).collect();
    let words = format!("Spearman’s, over {} loose combinations", pairs.len());
    rank_correlation(&pairs).map(|r| Measured::exact(r).saying(words))
}

pub fn rank_all_layers(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    ranked(study, plan, |(all, _)| all)
}

pub fn rank_three_layers(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    ranked(study, plan, |(_, three)| three)
}

/// Of the loose combinations that erode less than 7.5 %, the share with less than 7.5 % of the constrictions
/// blocked.
pub fn few_blocked(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let least = those(study, plan, |case| case.is_loose() && of_both_runs(case) < 7.5);
    let few = least.iter().filter(|case| blocked(case).is_some_and(|(all, _)| all < 7.5)).count();
    let words = format!("{few} of {}", least.len());
    (!least.is_empty()).then(|| Measured::exact(100.0 * few as f64 / least.len() as f64).saying(words))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_shared_and_correlate() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0]), [2.5, 1.0, 2.5]);
        let rising: Vec<(f64, f64)> = (0..9).map(|i| (f64::from(i), f64::from(i * i))).collect();
        assert!((rank_correlation(&rising).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(rank_correlation(&[(1.0, 2.0), (1.0, 3.0)]), None);
    }

    #[test]
    fn reruns_are_counted_by_their_share() {
        let share = share_within(&mut [9.0, 1.0, 5.0, 0.5], 5.0).unwrap();
        assert_eq!(share.value, 75.0);
        assert!(share.words.starts_with("3 of 4; the median spread is 3.0 %, the largest 9.0 %"));
        assert_eq!(share_within(&mut [], 5.0), None);
    }

    #[test]
    fn heights_lie_on_the_polygon() {
        let points = [(1.0, 10.0), (2.0, 30.0), (4.0, 20.0)];
        assert_eq!([1.0, 1.5, 3.0].map(|x| height(&points, x).unwrap()), [10.0, 20.0, 25.0]);
        assert_eq!([0.9, 4.1].map(|x| height(&points, x)), [None, None]);
    }

    #[test]
    fn the_best_boundary_is_between_the_kinds() {
        let cases = [(3.0, false), (6.0, true), (4.0, false), (5.5, true)];
        let best = Boundary::best(&cases).unwrap();
        assert_eq!((best.low, best.high, best.wrong), (4.0, 5.5, 0));
        // Two cases of one ratio are not parted, whatever their kinds.
        let tied = [(3.0, false), (5.0, false), (5.0, true), (6.0, true)];
        let best = Boundary::best(&tied).unwrap();
        assert_eq!((best.low, best.high, best.wrong), (3.0, 6.0, 1));
        assert!(Boundary::best(&tied[1..3]).is_none());
        let mixed = [(3.0, false), (4.0, true), (5.0, false), (6.0, true)];
        assert_eq!(Boundary::best(&mixed).unwrap().wrong, 1);
    }
}
