//! A sentence of judgement for each tier, from its numbers.

use super::figures::between_networks;
use crate::outcome::precision::{
    BiasRow, DecisionTier, ExactTier, PackingTier, Precision, SamplingTier, ScalingRow,
};
use crate::outcome::verdict::THRESHOLD;
use crate::report::quantity::{duration, significant};

/// Name of each tier that was measured, and what it says.
pub fn precision_judgements(study: &Precision) -> Vec<(&'static str, String)> {
    let mut all = Vec::new();
    all.extend(study.exact.as_ref().map(|of| ("exact", exact(of))));
    all.extend(study.sampling.as_ref().and_then(|of| Some(("sampling", sampling(of)?))));
    all.extend(study.bias.as_ref().and_then(|of| Some(("bias", bias(of)?))));
    all.extend(study.decision.as_ref().map(|of| ("decision", decision(of))));
    all.extend(study.scaling.as_ref().and_then(|of| Some(("scaling", scaling(of)?))));
    all.extend(study.packing.as_ref().and_then(|of| Some(("packing", packing(of)?))));
    all
}

/// `n thing` or `n things`.
fn several(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}

fn exact(exact: &ExactTier) -> String {
    let sampled: Vec<_> = exact.slopes.iter().filter(|slope| slope.engine != "expected").collect();
    let failed = exact.closed.iter().filter(|row| !row.holds).count();
    let closed = match failed {
        0 => format!("All {} integers and closed forms hold", exact.closed.len()),
        n => format!("{n} of {} integers and closed forms FAILED", exact.closed.len()),
    };
    if sampled.is_empty() {
        return format!(
            "Inconclusive: no network of this curve has a probability that a linear solve could check. \
             {closed}."
        );
    }
    let slopes = || sampled.iter().filter_map(|slope| slope.slope);
    let (flat, steep) = (slopes().fold(f64::NEG_INFINITY, f64::max), slopes().fold(f64::INFINITY, f64::min));
    let smallest = sampled.iter().map(|slope| slope.smallest_error).fold(f64::INFINITY, f64::min);
    let particles = sampled.iter().filter(|slope| slope.engine == "particles");
    let by_particles = particles.map(|slope| slope.smallest_error).fold(f64::INFINITY, f64::min);
    let z = sampled.iter().filter_map(|slope| slope.largest_z).fold(0.0, f64::max);
    let verdict = match z < 4.0 {
        true => "Every engine agrees with the exact value",
        false => "FAILED: an engine disagrees with the exact value",
    };
    format!(
        "{verdict}. The error falls with slopes of {} to {}, down to {by_particles:.0e} (particles) and \
         {smallest:.0e} (counts). None of {} networks deviates by more than {z:.1} standard errors. \
         {closed}.",
        minus(flat),
        minus(steep),
        exact.networks
    )
}

/// Two decimals with a proper sign.
fn minus(value: f64) -> String {
    format!("{value:.2}").replace('-', "−")
}

fn sampling(sampling: &SamplingTier) -> Option<String> {
    let new: Vec<_> = sampling.lines.iter().filter(|line| line.networks == "new networks").collect();
    let with_merit = new.iter().filter(|line| line.merit.is_some());
    let best = with_merit.max_by(|a, b| a.merit.unwrap_or(0.0).total_cmp(&b.merit.unwrap_or(0.0)));
    let Some(best) = best else {
        return Some("The eroded mass does not scatter: one replicate is enough.".into());
    };
    let floor = between_networks(sampling, best).map_or_else(String::new, |floor| {
        format!(" The networks alone account for {} points.", significant(100.0 * floor))
    });
    let gain = |variant: &str, networks: &str| {
        let of =
            |variant: &str| sampling.lines.iter().find(|l| l.variant == variant && l.networks == networks);
        let (plain, other) = (of("counts")?, of(variant)?);
        (other.sd > 0.0).then(|| significant((plain.sd / other.sd) * (plain.sd / other.sd)))
    };
    let mut gains = String::new();
    if let (Some(one), Some(new)) =
        (gain("counts, stratified base", "one network"), gain("counts, stratified base", "new networks"))
    {
        gains += &format!(
            " Stratified start nodes and sizes divide the variance by {one} on one network and by {new} \
             over new networks."
        );
    }
    if let Some(new) = gain("counts, stratified constrictions", "new networks") {
        gains += &format!(" Stratified constrictions divide it by {new} over new networks.");
    }
    // For half a percentage point at 95 %: 1.96 standard errors.
    let needed = (1.96 * best.sd / 0.005).powi(2).max(1.0).ceil();
    Some(format!(
        "The standard deviation of a replicate is {} percentage points, {} times that of a \
         binomial.{floor} The most efficient sampling is \"{}\": ± 0.5 points (95 %) takes {needed:.0} \
         replicates and {} of processor time.{gains}",
        significant(100.0 * best.sd),
        significant(best.sd / best.binomial),
        best.variant,
        duration(needed * best.core_seconds)
    ))
}

/// Whether the interval of a difference excludes zero.
fn is_seen(row: &BiasRow) -> bool {
    matches!((row.bias_low, row.bias_high), (Some(low), Some(high)) if low > 0.0 || high < 0.0)
}

fn bias(rows: &[BiasRow]) -> Option<String> {
    let changed: Vec<&BiasRow> = rows.iter().filter(|row| !row.reference).collect();
    let seen: Vec<&&BiasRow> = changed.iter().filter(|row| is_seen(row)).collect();
    let about = |row: &BiasRow| format!("{} ({}): {:+.2} points", row.factor, row.level, 100.0 * row.bias);
    // A longer network is a thicker filter, which is no choice of the method.
    let method = changed.iter().filter(|row| row.factor != "length" && is_seen(row));
    let largest = method.max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()));
    let small: Vec<String> = changed
        .iter()
        .filter(|row| ["precision", "blocking", "constriction sampling"].contains(&row.factor.as_str()))
        .map(|row| {
            let half = row.bias_low.zip(row.bias_high).map_or(0.0, |(low, high)| (high - low) / 2.0);
            format!("{} {:+.3} ± {:.3}", row.level, 100.0 * row.bias, 100.0 * half)
        })
        .collect();
    let mut text =
        format!("The intervals of {} of {} exclude zero.", seen.len(), several(changed.len(), "change"));
    text += &largest.map_or_else(
        || {
            " No setting but the length of the network, which is the thickness of the filter, shows a \
            difference."
                .to_owned()
        },
        |row| {
            format!(
                " Apart from the length of the network, which is the thickness of the filter, the largest \
                 difference is {}.",
                about(row)
            )
        },
    );
    if !small.is_empty() {
        text += &format!(" Differences in points: {}.", small.join("; "));
    }
    Some(text)
}

fn decision(decision: &DecisionTier) -> String {
    let mut text = String::new();
    for case in decision.cases.iter().filter(|case| case.certain) {
        let rows = || decision.rows.iter().filter(|row| row.case == case.name && row.rule == "fixed");
        let Some(first) = rows().next() else { continue };
        let enough = rows().find(|row| row.wrong <= 0.01);
        text += &format!(
            "At {:.2} points from 7.5 %, one replicate is wrong in {:.0} % of trials{}. ",
            100.0 * (case.mean - THRESHOLD).abs(),
            100.0 * first.wrong,
            enough.map_or_else(
                || "; an error rate of 1 % is not reached".to_owned(),
                |row| format!(
                    "; an error rate of 1 % takes {} of processor time",
                    duration(row.core_seconds)
                )
            )
        );
    }
    let stopped = || decision.rows.iter().filter(|row| row.rule.contains("99.9"));
    if let Some(worst) = stopped().map(|row| row.wrong).reduce(f64::max) {
        let undecided = stopped().map(|row| row.undecided).fold(0.0, f64::max);
        text += &format!(
            "Stopping once the verdict is decided at the 99.9 % confidence level is wrong in at most {:.1} \
             % of the trials of a case and leaves up to {:.0} % undecided. ",
            100.0 * worst,
            100.0 * undecided
        );
    }
    let uncertain = decision.cases.iter().filter(|case| !case.certain).count();
    text += &match uncertain {
        0 => "The reference decides every case.".to_owned(),
        n => format!("The reference itself is inconclusive in {}.", several(n, "case")),
    };
    text
}

fn scaling(rows: &[ScalingRow]) -> Option<String> {
    let most = |engine: &str| {
        let of = rows.iter().filter(|row| row.against == "base particles" && row.engine == engine);
        of.max_by_key(|row| row.n_base)
    };
    let (particles, counts) = (most("particles")?, most("counts")?);
    Some(format!(
        "Walking {:.0e} base particles one by one takes {}. Walking {:.0e} with the passive ones as counts \
         takes {}.",
        particles.n_base as f64,
        duration(particles.core_seconds),
        counts.n_base as f64,
        duration(counts.core_seconds)
    ))
}

fn packing(tier: &PackingTier) -> Option<String> {
    let reference = tier.packings.iter().find(|row| row.reference)?;
    let largest = tier
        .packings
        .iter()
        .filter(|row| !row.reference)
        .max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()))?;
    let curve = tier.packings.iter().map(|row| row.dc50_bias.abs()).fold(0.0, f64::max);
    let failed = tier.triangulations.iter().filter(|row| !row.identities_hold).count();
    let identities = match failed {
        0 => "The identities of every triangulation hold".to_owned(),
        n => format!("FAILED: the identities of {} do not hold", several(n, "triangulation")),
    };
    Some(format!(
        "{} grains come to rest in {} (friction {}). No setting changes the void ratio by more than {:.4} \
         ({} x {}, friction {}) or Dc50 by more than {:.1} %. {identities}.",
        reference.grains,
        duration(reference.core_seconds),
        reference.friction,
        largest.bias.abs(),
        largest.factor,
        largest.at,
        largest.friction,
        100.0 * curve
    ))
}
