//! Answers that are integers or formulas, compared with the walk.

use super::first_run::FirstRun;
use super::networks::given;
use super::study::{PrecisionError, Study};
use super::work::{affordable, summed};
use crate::network::Passage;
use crate::outcome::precision::ClosedRow;
use crate::walk::Engine;

/// Rows of one kind, for this budget (s).
type Kind = fn(&Study, f64) -> Result<Vec<ClosedRow>, PrecisionError>;

/// Every row that the budget pays for.
pub(super) fn rows(study: &Study, budget_s: f64) -> Result<Vec<ClosedRow>, PrecisionError> {
    let kinds: [Kind; 5] = [moves, giant, blocked_sets, coarse_base, survival];
    let all = study.side_by_side(kinds.len(), |kind| kinds[kind](study, budget_s))?;
    Ok(all.into_iter().flatten().collect())
}

/// A number that scatters with this standard error.
fn drawn(what: String, exact: f64, found: f64, error: f64, samples: u64, core_seconds: f64) -> ClosedRow {
    let z = (found - exact) / error;
    ClosedRow { what, exact, found, z: Some(z), holds: z.abs() < 4.0, samples, core_seconds }
}

/// Moves to leave 60 layers of equal constrictions: a sum of 60 geometric numbers, mean 180 and variance 360.
fn moves(study: &Study, _: f64) -> Result<Vec<ClosedRow>, PrecisionError> {
    const LAYERS: u32 = 60;
    let network = given([8, 8, LAYERS], vec![1.0; 3 * 64 * LAYERS as usize])?;
    let (mean, variance) = (f64::from(3 * LAYERS), f64::from(6 * LAYERS));
    let mut rows = Vec::new();
    for (engine, n) in [(Engine::Particles, 200_000u64), (Engine::Counts, 1_000_000_000_000)] {
        let (mut before, mut squares) = (0, 0.0);
        let run = FirstRun::of_one_size(0.5, n, 1, engine)?;
        let ended = run.walk_observed(&network, study.seed(1), &mut |state| {
            let off = state.increment as f64 - mean;
            squares += (state.tally.eroded - before) as f64 * off * off;
            before = state.tally.eroded;
        })?;
        let seconds = ended.core_seconds;
        let what = |what: &str| {
            format!("{what} of the moves through 60 layers of equal constrictions, {}", engine.name())
        };
        let found = ended.particle_moves as f64 / n as f64;
        rows.push(drawn(what("mean"), mean, found, (variance / n as f64).sqrt(), n, seconds));
        // Excess kurtosis of 60 geometric numbers with a probability of 1/3: (6 + 1/6) / 60.
        let error = variance * ((2.0 + 37.0 / 360.0) / n as f64).sqrt();
        rows.push(drawn(what("variance"), variance, squares / n as f64, error, n, seconds));
    }
    Ok(rows)
}

/// One exit with 1e12 times the area of each of the two others, which lead round: a billionth of a thousandth
/// of the moves.
fn giant(study: &Study, _: f64) -> Result<Vec<ClosedRow>, PrecisionError> {
    let network = given([1, 1, 1], vec![1.0, 1.0, 1e6])?;
    let n = 1_000_000_000_000_000u64;
    let ended = FirstRun::of_one_size(0.5, n, 1, Engine::Counts)?.walk(&network, study.seed(2))?;
    let round = (ended.particle_moves - n) as f64;
    let exact = n as f64 * 2e-12;
    let what = "moves through exits with 1e-12 of the area, of 1e15 particles, counts".to_string();
    Ok(vec![drawn(what, exact, round, exact.sqrt(), n, ended.core_seconds)])
}

/// One size without limit blocks what a breadth-first search finds: an integer, and the same constrictions.
fn blocked_sets(study: &Study, budget_s: f64) -> Result<Vec<ClosedRow>, PrecisionError> {
    let case = study.case;
    let mut rows = Vec::new();
    let walks = affordable(budget_s * 0.3, 0.4, 2, 12);
    for percent in [5.0, 25.0] {
        let d = case.curve.dc(percent).unwrap_or(case.curve.largest()) / case.unit_mm;
        let run = FirstRun::of_one_size(d, 2_000_000, 100, Engine::Auto)?;
        let (mut exact, mut found, mut same, mut seconds) = (0, 0, true, 0.0);
        for k in 1..=walks / 2 {
            let network = study.lattice([8, 8, 10], study.seed(k))?;
            let expected = network.blocked_by_one_size(d as f32);
            let ended = run.walk(&network, study.seed(k))?;
            let blocked: Vec<u32> = ended.blocked.iter_ones().map(|c| c as u32).collect();
            same &= blocked == expected;
            (exact, found, seconds) =
                (exact + expected.len(), found + blocked.len(), seconds + ended.core_seconds);
        }
        rows.push(ClosedRow {
            what: format!(
                "constrictions blocked by one size, Dc{percent}, without limit: breadth-first search"
            ),
            exact: exact as f64,
            found: found as f64,
            z: None,
            holds: same,
            samples: walks / 2,
            core_seconds: seconds,
        });
    }
    Ok(rows)
}

/// A base coarser than every constriction blocks every exit of the first layer and nothing else.
fn coarse_base(study: &Study, _: f64) -> Result<Vec<ClosedRow>, PrecisionError> {
    let network = study.lattice([20, 20, 5], study.seed(1))?;
    let d = 2.0 * study.case.curve.largest() / study.case.unit_mm;
    let ended = FirstRun::of_one_size(d, 200_000, 100, Engine::Auto)?.walk(&network, study.seed(1))?;
    let found = ended.blocked.count_ones();
    Ok(vec![ClosedRow {
        what: "constrictions blocked by a base coarser than all of them: 3 nx ny, none eroded".into(),
        exact: 1200.0,
        found: found as f64,
        z: None,
        holds: found == 1200 && ended.eroded == 0,
        samples: 1,
        core_seconds: ended.core_seconds,
    }])
}

/// A single particle passes a layer with probability s = (1 - q) / (1 + 2 q), averaged over networks.
fn survival(study: &Study, budget_s: f64) -> Result<Vec<ClosedRow>, PrecisionError> {
    let case = study.case;
    let d_mm = case.curve.dc(15.0).unwrap_or(case.curve.largest());
    let p = Passage::new(&case.curve).through(d_mm, 6);
    if !(0.02..0.98).contains(&p) {
        return Ok(Vec::new());
    }
    let n = affordable(budget_s * 0.35, 2.5e-4, 500, 100_000);
    let single = FirstRun::of_one_size(d_mm / case.unit_mm, 1, 1, Engine::Particles)?;
    let (eroded, seconds) = summed(1..=n, |k| {
        // Wide enough that few particles meet a void twice.
        let network = study.lattice([14, 14, 6], study.seed(k))?;
        Ok(single.walk(&network, study.seed(k))?.eroded)
    })?;
    let error = (p * (1.0 - p) / n as f64).sqrt();
    let what = "probability that a single particle of size Dc15 passes 6 layers, over new networks: \
                ((1 - q) / (1 + 2 q))^6";
    Ok(vec![drawn(what.into(), p, eroded as f64 / n as f64, error, n, seconds)])
}
