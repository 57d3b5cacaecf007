//! Measures of the parts: filters, percolation, the checks with one size and with Kenney's bases, Table 3,
//! progress.

use crate::measured::{Measured, Of};
use crate::study::{Case, Curves, Study, size_at, times, variant_of};
use voidwalk::outcome::by_connectivity::of_replicates;
use voidwalk::outcome::record::{ByConnectivity, FilterRecord, Replicate, SizeRow, Statistic};

/// A filter of a plan; those that only Kenney's tests need are in the plan of that name.
fn filter<'a>(study: &'a Study, plan: &str, name: &str) -> Option<&'a FilterRecord> {
    let elsewhere = || if plan == "paper" { study.filter("kenney", name) } else { None };
    study.filter(plan, name).or_else(elsewhere)
}

pub fn void_ratio(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    // The published curves come with the paper's own void ratios.
    variant_of(plan).filter(|variant| variant.curves != Curves::Published)?;
    filter(study, plan, &of.filter)?.void_ratio.map(Measured::exact)
}

pub fn cu_csd(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    Some(Measured::exact(filter(study, plan, &of.filter)?.cu_csd))
}

pub fn dc0_over_d0f(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let filter = filter(study, plan, &of.filter)?;
    Some(Measured::exact(size_at(&filter.constrictions, 0.0)? / filter.d0_mm))
}

/// Percents of a constriction curve that two curves are compared at.
const COMPARED: [f64; 7] = [5.0, 10.0, 25.0, 50.0, 75.0, 90.0, 95.0];

/// Ratios of two constriction curves in units of a size each.
fn curve_ratios(a: &FilterRecord, b: &FilterRecord, unit: fn(&FilterRecord) -> f64) -> Option<Vec<f64>> {
    let at = |f: &FilterRecord, percent| size_at(&f.constrictions, percent).map(|d| d / unit(f));
    COMPARED.iter().map(|&percent| Some(at(a, percent)? / at(b, percent)?)).collect()
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)))
}

/// By how many percent the dense curve of `of.filter` (`cu1.5`) is finer than the loose one.
pub fn dense_finer(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let named = |density: &str| study.filter(plan, &format!("{}-{density}", of.filter));
    let finer: Vec<f64> = curve_ratios(named("dense")?, named("loose")?, |f| f.d0_mm)?
        .into_iter()
        .map(|ratio| 100.0 * (1.0 - ratio))
        .collect();
    let (low, high) = range(&finer);
    let mean = Statistic::of(&finer).mean;
    Some(Measured::exact(mean).saying(format!("{low:.1} to {high:.1} from Dc5 to Dc95")))
}

/// Loose Cu 3 over loose Cu 1.5 curve, each in units of its D15F.
pub fn csd_over_d15f(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let named = |name| study.filter(plan, name);
    let ratios = curve_ratios(named("cu3-loose")?, named("cu1.5-loose")?, |f| f.d15_mm)?;
    let (low, high) = range(&ratios);
    Some(
        Measured::exact(Statistic::of(&ratios).mean)
            .saying(format!("{low:.2} to {high:.2} from Dc5 to Dc95")),
    )
}

/// Constrictions of a void of a packing: each is counted by both of its voids.
pub fn mean_connectivity(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let curves = variant_of(plan)?.curves;
    let (_, found) = study.packed.iter().find(|(by, _)| *by == curves)?;
    let words = format!("{} grains, voids merged at an overlap of {}", found.grains, found.merge_overlap);
    Some(Measured::exact(found.mean_connectivity).saying(words))
}

/// Fall of the standard deviation of the threshold per void of side from 40 to 80, over that from 10 to 40.
pub fn spread_slows(study: &Study, _: &str, _: &Of) -> Option<Measured> {
    let percolation = study.percolation.as_ref()?;
    let sd = |size| percolation.sizes.iter().find(|s| s.size == size).and_then(|s| s.threshold.sd);
    let (ten, forty, eighty) = (sd(10)?, sd(40)?, sd(80)?);
    let mut words = percolation.sd_exponent.map_or(String::new(), |slope| {
        format!("it falls as L to the {slope:.2} throughout, without a bend at 40")
    });
    for of_box in &percolation.boxes {
        let ([nx, ny, nz], mean) = (of_box.shape, of_box.threshold.mean);
        words += &format!(
            "; {nx} × {ny} × {nz} voids percolate with {:.1} % of their constrictions open",
            100.0 * mean
        );
    }
    Some(Measured::exact(((forty - eighty) / 40.0) / ((ten - forty) / 30.0)).saying(words))
}

pub fn blocked_by_one_size(study: &Study, _: &str, of: &Of) -> Option<Measured> {
    let run = study.named("one-size", &of.case)?.run(1)?;
    Some(Measured::of(&times(&run.blocked_fraction, 100.0)))
}

/// Cases of Kenney's tests on a filter.
fn kenney<'a>(study: &'a Study, filter: &str) -> Vec<&'a Case> {
    study.cases("kenney").into_iter().filter(|case| case.level("filter") == filter).collect()
}

/// Largest eroded particle over D0F: the largest of the means of all bases whose own largest does not erode.
/// Where there is no such base, what erodes is only known to be at least so large.
pub fn kenney_largest(study: &Study, _: &str, of: &Of) -> Option<Measured> {
    let all =
        kenney(study, &of.filter).into_iter().filter_map(|case| Some((case.largest_over_d0f(1)?, case)));
    let (own, others): (Vec<_>, Vec<_>) = all.partition(|(_, case)| case.erodes_its_largest(1));
    let open = others.is_empty();
    let counted = if open { &own } else { &others };
    let (largest, case) = counted.iter().max_by(|a, b| a.0.mean.total_cmp(&b.0.mean))?;
    let at = format!("at D50B/D0F {}", case.level("d50b_over_d0f"));
    let words = match (open, own.len()) {
        (true, _) => format!("{at}: at least so large, as every base that erodes erodes its own largest"),
        (false, 0) => at,
        (false, n) => format!("{at}; left out, as they erode their own largest: {n} finer bases"),
    };
    Some(Measured { open, ..Measured::of(largest).saying(words) })
}

fn kenney_at<'a>(study: &'a Study, of: &Of, at: &str) -> Option<&'a Case> {
    study.case("kenney", &[("filter", of.filter.as_str()), ("d50b_over_d0f", at)])
}

/// Eroded at one base size in percent of what is eroded at a finer one.
pub fn kenney_drop(study: &Study, _: &str, of: &Of) -> Option<Measured> {
    let (fine, coarse) = (kenney_at(study, of, &of.at)?, kenney_at(study, of, &of.to)?);
    let words = format!("{:.1} % against {:.1} %", coarse.mean(1), fine.mean(1));
    (fine.mean(1) > 0.0).then(|| Measured::exact(100.0 * coarse.mean(1) / fine.mean(1)).saying(words))
}

pub fn kenney_eroded(study: &Study, _: &str, of: &Of) -> Option<Measured> {
    kenney_at(study, of, &of.at)?.eroded(1).as_ref().map(Measured::of)
}

const TABLE_3: [(&str, &str); 3] = [("filter", "cu1.5-loose"), ("cu_b", "1.5"), ("d85b", "dc5")];

/// The case of Table 3 on the modified network, for as many grains per void as the plan has.
fn modified<'a>(study: &'a Study, plan: &str) -> Option<&'a Case> {
    match plan {
        "paper" => study.case("table3", &TABLE_3),
        "paper-2.5" => study.named("table3", "table3-2.5"),
        "paper-inverse" => study.named("table3", "table3-inverse"),
        _ => None,
    }
}

fn rows(study: &Study, plan: &str) -> Option<Vec<ByConnectivity>> {
    let rows = of_replicates(&modified(study, plan)?.outcome.replicates, 1);
    (!rows.is_empty()).then_some(rows)
}

/// Share of the retained particles that the voids of a connectivity hold.
pub fn table3_share(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let rows = rows(study, plan)?;
    let row = rows.iter().find(|row| row.connectivity == of.connectivity)?;
    Some(Measured::exact(100.0 * row.retained_fraction))
}

/// The same for all voids with fewer than six.
pub fn table3_few(study: &Study, plan: &str, _: &Of) -> Option<Measured> {
    let rows = rows(study, plan)?;
    let few = rows.iter().filter(|row| row.connectivity < 6);
    Some(Measured::exact(100.0 * few.map(|row| row.retained_fraction).sum::<f64>()))
}

pub fn table3_per_void(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let rows = rows(study, plan)?;
    Some(Measured::exact(rows.iter().find(|row| row.connectivity == of.connectivity)?.retained_per_void))
}

/// Particles retained per void in the first `runs` runs together; what the first retains is gone before the
/// second.
fn per_void(case: &Case, runs: usize) -> Statistic {
    let both =
        |replicate: &Replicate| replicate.runs.iter().take(runs).map(|run| run.retained_per_void).sum();
    Statistic::of(&case.outcome.replicates.iter().map(both).collect::<Vec<f64>>())
}

pub fn table3_all(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    Some(Measured::of(&per_void(modified(study, plan)?, of.runs)))
}

pub fn cubic_per_void(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    Some(Measured::of(&per_void(study.case(plan, &TABLE_3)?, of.runs)))
}

pub fn table3_over_cubic(study: &Study, plan: &str, of: &Of) -> Option<Measured> {
    let (over, under) = (table3_all(study, plan, of)?, cubic_per_void(study, plan, of)?);
    Some(Measured::exact(over.value / under.value))
}

/// Cases on the modified network, each with its twin on the cubic one.
pub fn twins(study: &Study) -> Vec<(&Case, &Case)> {
    let crossed = study.cases("table3").into_iter().filter(|case| !case.line.levels.is_empty());
    crossed.filter_map(|case| Some((case, study.named("paper", &case.line.case)?))).collect()
}

/// Greatest difference of the largest eroded particle, in percent.
pub fn table3_largest_shift(study: &Study, _: &str, _: &Of) -> Option<Measured> {
    let shift = |(modified, cubic): (&Case, &Case)| {
        let (modified, cubic) = (modified.largest(1)?.mean, cubic.largest(1)?.mean);
        Some(100.0 * (modified / cubic - 1.0).abs())
    };
    twins(study).into_iter().filter_map(shift).max_by(f64::total_cmp).map(Measured::exact)
}

/// Cases that erode no less on the modified network.
pub fn table3_not_less(study: &Study, _: &str, _: &Of) -> Option<Measured> {
    let twins = twins(study);
    let not_less = twins.iter().filter(|(modified, cubic)| modified.mean(1) >= cubic.mean(1)).count();
    let falls: Vec<f64> = twins
        .iter()
        .filter(|(_, cubic)| cubic.mean(1) >= 7.5)
        .map(|(modified, cubic)| 100.0 * (1.0 - modified.mean(1) / cubic.mean(1)))
        .collect();
    let (low, high) = range(&falls);
    let words = match falls.is_empty() {
        true => String::new(),
        false => format!("; where 7.5 % or more erode on the cubic one, {low:.1} to {high:.1} % less"),
    };
    Measured::exceptions(not_less, 0, twins.len())
        .map(|measured| Measured { words: measured.words.clone() + &words, ..measured })
}

/// What the case of Fig. 18 retains after an increment of the first run: one curve a replicate.
fn retained_after(rows: &[SizeRow], increment: u64) -> Vec<Vec<[f64; 2]>> {
    let of_one = |replicate: u64| {
        let own =
            rows.iter().filter(|row| (row.replicate, row.run, row.increment) == (replicate, 1, increment));
        own.map(|row| [row.diameter_mm, row.percent_finer_by_mass]).collect::<Vec<_>>()
    };
    let last = rows.iter().map(|row| row.replicate).max().unwrap_or(0);
    (1..=last).map(of_one).filter(|curve| curve.len() > 1).collect()
}

/// Median size by mass of what is retained, one a replicate.
fn medians(study: &Study, increment: u64) -> Vec<f64> {
    let curves = retained_after(&study.retained, increment);
    curves.iter().filter_map(|curve| size_at(curve, 50.0)).collect()
}

/// Finest particle retained in the first increment over the finest constriction.
pub fn first_retained_over_dc0(study: &Study, _: &str, _: &Of) -> Option<Measured> {
    let filter = &study.named("progress", "fig18")?.outcome.inputs.filter;
    let dc0 = size_at(&filter.constrictions, 0.0)?;
    // The first row above 0 % is the upper edge of the first size class that holds anything.
    let finest = |curve: &Vec<[f64; 2]>| curve.iter().find(|row| row[1] > 0.0).map(|row| row[0] / dc0);
    let all: Vec<f64> = retained_after(&study.retained, 1).iter().filter_map(finest).collect();
    (!all.is_empty()).then(|| Measured::of(&Statistic::of(&all)))
}

/// Median size retained when the run ends over that after the first increment.
pub fn retained_finer(study: &Study, _: &str, _: &Of) -> Option<Measured> {
    let last = study.retained.iter().filter(|row| row.run == 1).map(|row| row.increment).max()?;
    let (first, last) = (medians(study, 1), medians(study, last));
    let (first, last) = (first.iter().copied().reduce(f64::min)?, last.iter().copied().reduce(f64::max)?);
    Some(
        Measured::exact(last / first)
            .saying("largest median at the end over smallest after the first increment"),
    )
}
