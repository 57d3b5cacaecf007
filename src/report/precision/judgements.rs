//! A sentence of judgement for each tier, from its numbers.

use super::figures::between_networks;
use crate::outcome::precision::{BiasRow, Decision, Exact, PackingTier, Precision, Sampling, ScalingRow};
use crate::report::numbers::{duration, significant};

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

fn exact(exact: &Exact) -> String {
    let sampled: Vec<_> = exact.slopes.iter().filter(|slope| slope.engine != "expected").collect();
    let closed_broken = exact.closed.iter().filter(|row| !row.holds).count();
    let closed = match closed_broken {
        0 => format!("all {} integers and closed forms hold", exact.closed.len()),
        n => format!("{n} of {} integers and closed forms are BROKEN", exact.closed.len()),
    };
    if sampled.is_empty() {
        return format!("No network of this curve has a chance that is worth a linear solve; {closed}.");
    }
    let slopes = || sampled.iter().filter_map(|slope| slope.slope);
    let (flat, steep) = (slopes().fold(f64::NEG_INFINITY, f64::max), slopes().fold(f64::INFINITY, f64::min));
    let smallest = sampled.iter().map(|slope| slope.smallest_error).fold(f64::INFINITY, f64::min);
    let particles = sampled.iter().filter(|slope| slope.engine == "particles");
    let by_particles = particles.map(|slope| slope.smallest_error).fold(f64::INFINITY, f64::min);
    let z = sampled.iter().filter_map(|slope| slope.largest_z).fold(0.0, f64::max);
    let verdict = if z < 4.0 { "Every engine gives the exact answer" } else { "AN ENGINE IS OFF" };
    format!(
        "{verdict}: the error falls with slopes of {flat:.2} to {steep:.2} down to {by_particles:.0e} (particles) and {smallest:.0e} (counts), and none of {} networks is off by more than \
         {z:.1} standard errors; {closed}.",
        exact.networks
    )
}

fn sampling(sampling: &Sampling) -> Option<String> {
    let new: Vec<_> = sampling.lines.iter().filter(|line| line.networks == "new networks").collect();
    let with_merit = new.iter().filter(|line| line.merit.is_some());
    let best = with_merit.max_by(|a, b| a.merit.unwrap_or(0.0).total_cmp(&b.merit.unwrap_or(0.0)));
    let Some(best) = best else {
        return Some("The eroded mass does not scatter: one replicate is enough.".into());
    };
    let floor = between_networks(sampling, best).map_or_else(String::new, |floor| {
        format!(", of which {} come from the networks alone", significant(100.0 * floor))
    });
    // For half a percentage point at 95 %: 1.96 standard errors.
    let needed = (1.96 * best.sd / 0.005).powi(2).max(1.0).ceil();
    Some(format!(
        "A replicate scatters by {} percentage points{floor}, {} times what a binomial of its particles would say. {} buys most: ± 0.5 points (95 %) take {needed:.0} replicates, {} of processor \
         time.",
        significant(100.0 * best.sd),
        significant(best.sd / best.binomial),
        best.variant,
        duration(needed * best.core_seconds)
    ))
}

/// Whether the interval of a difference keeps it apart from zero.
fn is_seen(row: &BiasRow) -> bool {
    matches!((row.bias_low, row.bias_high), (Some(low), Some(high)) if low > 0.0 || high < 0.0)
}

fn bias(rows: &[BiasRow]) -> Option<String> {
    let changed: Vec<&BiasRow> = rows.iter().filter(|row| !row.reference).collect();
    let seen: Vec<&&BiasRow> = changed.iter().filter(|row| is_seen(row)).collect();
    let words = |row: &BiasRow| format!("{} ({}): {:+.2} points", row.factor, row.level, 100.0 * row.bias);
    let largest = changed.iter().max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()))?;
    let small: Vec<String> = changed
        .iter()
        .filter(|row| ["precision", "blocking", "constriction sampling"].contains(&row.factor.as_str()))
        .map(|row| {
            let half = row.bias_low.zip(row.bias_high).map_or(0.0, |(low, high)| (high - low) / 2.0);
            format!("{} {:+.3} ± {:.3}", row.level, 100.0 * row.bias, 100.0 * half)
        })
        .collect();
    let mut text = format!(
        "Of {} {} keep apart from zero; the largest is {}.",
        several(changed.len(), "change"),
        seen.len(),
        words(largest)
    );
    if !small.is_empty() {
        text += &format!(" In points: {}.", small.join("; "));
    }
    Some(text)
}

fn decision(decision: &Decision) -> String {
    let fixed = |k: f64| decision.rows.iter().filter(move |row| row.rule == "fixed" && row.replicates == k);
    let worst = |k: f64| fixed(k).map(|row| row.wrong).fold(0.0, f64::max);
    let most =
        decision.rows.iter().filter(|row| row.rule == "fixed").map(|row| row.replicates).fold(1.0, f64::max);
    let uncertain = decision.cases.iter().filter(|case| !case.certain).count();
    let mut text = format!(
        "In the worst of {} one replicate gives the wrong class in {:.0} % of trials, {most:.0} in {:.1} %.",
        several(decision.cases.len(), "case"),
        100.0 * worst(1.0),
        100.0 * worst(most)
    );
    if uncertain > 0 {
        text += &format!(" The reference itself leaves {} open.", several(uncertain, "case"));
    }
    text
}

fn scaling(rows: &[ScalingRow]) -> Option<String> {
    let most = |engine: &str| {
        let of = rows.iter().filter(|row| row.against == "base particles" && row.engine == engine);
        of.max_by_key(|row| row.n_base)
    };
    let (particles, counts) = (most("particles")?, most("counts")?);
    Some(format!(
        "{:.0e} base particles take {} one by one, {:.0e} take {} with the passive ones as counts.",
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
    let broken = tier.triangulations.iter().filter(|row| !row.identities_hold).count();
    let identities = match broken {
        0 => "every triangulation keeps its identities".to_owned(),
        n => format!("{n} triangulations BREAK their identities"),
    };
    Some(format!(
        "{} grains settle in {} (friction {}); no setting moves the void ratio by more than {:.4} ({} x {}, friction {}), nor Dc50 by more than {:.1} %; {identities}.",
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
