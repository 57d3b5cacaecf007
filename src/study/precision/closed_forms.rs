//! Answers that are integers or formulas, held against the walk.

use bitvec::vec::BitVec;

use super::first_run::FirstRun;
use super::work::{affordable, timed};
use super::{PrecisionStudy, RunError};
use crate::gradation::{Gradation, SizeSampler};
use crate::network::{Network, Passage};
use crate::outcome::precision::ClosedRow;
use crate::walk::{Engine, Plan, Progress, Sampling, SizeClasses, State, Walk};

/// Rows of one kind, for this budget (s).
type Kind = fn(&PrecisionStudy, f64) -> Result<Vec<ClosedRow>, RunError>;

/// Every row that the budget pays for.
pub(super) fn rows(study: &PrecisionStudy, budget_s: f64) -> Result<Vec<ClosedRow>, RunError> {
    let kinds: [Kind; 5] = [moves, giant, blocked_sets, coarse_base, survival];
    let all = study.side_by_side(kinds.len(), |kind| kinds[kind](study, budget_s))?;
    Ok(all.into_iter().flatten().collect())
}

fn one_size(diameter: f64, n_base: u64, increments: u64, engine: Engine) -> Result<FirstRun, RunError> {
    let sampler = SizeSampler::new(&Gradation::single(diameter)?, 1.0)?;
    Ok(FirstRun { engine, sampler, tail: 0.0, n_base, increments, sampling: Sampling::Independent })
}

fn drawn(what: String, exact: f64, found: f64, error: f64, samples: u64, core_seconds: f64) -> ClosedRow {
    let z = (found - exact) / error;
    ClosedRow { what, exact, found, z: Some(z), holds: z.abs() < 4.0, samples, core_seconds }
}

/// Moves to leave 60 layers of equal constrictions: a sum of 60 geometric numbers, mean 180 and variance 360.
fn moves(study: &PrecisionStudy, _: f64) -> Result<Vec<ClosedRow>, RunError> {
    const LAYERS: u32 = 60;
    let network = Network::cubic_from_diameters([8, 8, LAYERS], vec![1.0; 3 * 64 * LAYERS as usize], 1.0)?;
    let mut rows = Vec::new();
    for (engine, n) in [(Engine::Particles, 200_000u64), (Engine::Counts, 1_000_000_000_000)] {
        let run = one_size(0.5, n, 1, engine)?;
        let open = BitVec::repeat(false, network.constrictions());
        let plan = Plan::new(engine, &network, &run.sampler, &open, n);
        let supply = plan.supply(run.sampler.clone(), n, 1, study.seed(1), 1);
        let mut state =
            State::new(&network, &supply, SizeClasses::logarithmic(0.5, 0.5, 1), open, study.seed(1), 1);
        let (mut before, mut squares) = (0, 0.0);
        let (walked, seconds) = timed(|| {
            Walk::new(&network, &supply, &state).run(&mut state, &mut |state| {
                let off = state.increment as f64 - f64::from(3 * LAYERS);
                squares += (state.tally.eroded - before) as f64 * off * off;
                before = state.tally.eroded;
                Progress::Continue
            })
        });
        walked?;
        let (mean, variance) = (f64::from(3 * LAYERS), f64::from(6 * LAYERS));
        let words = |what: &str| {
            format!("{what} of the moves through 60 layers of equal constrictions, {}", engine.name())
        };
        let found = state.tally.particle_moves as f64 / n as f64;
        rows.push(drawn(words("mean"), mean, found, (variance / n as f64).sqrt(), n, seconds));
        // Excess kurtosis of 60 geometric numbers with a chance of 1/3: (6 + 1/6) / 60.
        let error = variance * ((2.0 + 37.0 / 360.0) / n as f64).sqrt();
        rows.push(drawn(words("variance"), variance, squares / n as f64, error, n, seconds));
    }
    Ok(rows)
}

/// One exit with 1e12 times the area of each of the two others, which lead round: a billionth of a thousandth
/// of the moves.
fn giant(study: &PrecisionStudy, _: f64) -> Result<Vec<ClosedRow>, RunError> {
    let network = Network::cubic_from_diameters([1, 1, 1], vec![1.0, 1.0, 1e6], 1.0)?;
    let n = 1_000_000_000_000_000u64;
    let ended = one_size(0.5, n, 1, Engine::Counts)?.walk(&network, study.seed(2))?;
    let round = (ended.particle_moves - n) as f64;
    let exact = n as f64 * 2e-12;
    let what = "moves through exits with 1e-12 of the area, of 1e15 particles, counts".to_string();
    Ok(vec![drawn(what, exact, round, exact.sqrt(), n, ended.core_seconds)])
}

/// One size without limit blocks what a breadth-first search finds: an integer, and the same constrictions.
fn blocked_sets(study: &PrecisionStudy, budget_s: f64) -> Result<Vec<ClosedRow>, RunError> {
    let case = study.case;
    let mut rows = Vec::new();
    let walks = affordable(budget_s * 0.3, 0.4, 2, 12);
    for percent in [5.0, 25.0] {
        let d = case.curve.dc(percent).unwrap_or(case.curve.largest()) / case.unit_mm;
        let (mut exact, mut found, mut same, mut seconds) = (0, 0, true, 0.0);
        for k in 1..=walks / 2 {
            let network = Network::cubic([8, 8, 10], &case.curve, case.unit_mm, study.seed(k))?;
            let expected = network.blocked_by_one_size(d as f32);
            let ended = one_size(d, 2_000_000, 100, Engine::Auto)?.walk(&network, study.seed(k))?;
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
fn coarse_base(study: &PrecisionStudy, _: f64) -> Result<Vec<ClosedRow>, RunError> {
    let case = study.case;
    let network = Network::cubic([20, 20, 5], &case.curve, case.unit_mm, study.seed(1))?;
    let d = 2.0 * case.curve.largest() / case.unit_mm;
    let ended = one_size(d, 200_000, 100, Engine::Auto)?.walk(&network, study.seed(1))?;
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

/// A lone particle passes a layer with s = (1 - q) / (1 + 2 q), averaged over networks.
fn survival(study: &PrecisionStudy, budget_s: f64) -> Result<Vec<ClosedRow>, RunError> {
    let case = study.case;
    let d_mm = case.curve.dc(15.0).unwrap_or(case.curve.largest());
    let p = Passage::new(&case.curve).through(d_mm, 6);
    if !(0.02..0.98).contains(&p) {
        return Ok(Vec::new());
    }
    let n = affordable(budget_s * 0.35, 2.5e-4, 500, 100_000);
    let lone = one_size(d_mm / case.unit_mm, 1, 1, Engine::Particles)?;
    let all = || -> Result<u64, RunError> {
        let mut eroded = 0;
        for k in 1..=n {
            // Wide enough that few particles meet a void twice.
            let network = Network::cubic([14, 14, 6], &case.curve, case.unit_mm, study.seed(k))?;
            eroded += lone.walk(&network, study.seed(k))?.eroded;
        }
        Ok(eroded)
    };
    let (eroded, seconds) = timed(all);
    let error = (p * (1.0 - p) / n as f64).sqrt();
    let what =
        "chance of a lone particle of size Dc15 to pass 6 layers, over new networks: ((1 - q) / (1 + 2 q))^6"
            .to_string();
    Ok(vec![drawn(what, p, eroded? as f64 / n as f64, error, n, seconds)])
}
