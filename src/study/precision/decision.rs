//! How often the class is wrong, against the time that is spent on it.
//!
//! Cases near the 7.5 % of the first run, which divide "no erosion" from the rest, are made of the scene by a
//! factor on every size of its base (the number of particles follows by Eq. 2). Each replicate walks the
//! scene's runs. The class of all replicates of a case is the reference; rules that stop earlier are tried on
//! random subsets of them.

use rand::Rng;

use super::first_run::{FirstRun, ScaledScene, clean, nominal};
use super::study::{PrecisionError, Study};
use super::work::affordable;
use crate::gradation::SizeSampler;
use crate::outcome::precision::{DecisionCase, DecisionRow, DecisionTier, wilson};
use crate::outcome::record::{Statistic, Verdict};
use crate::outcome::stopping::{Look, StopRule};
use crate::outcome::verdict::{THRESHOLD, classify};
use crate::stream::{Key, Purpose, below};

/// Eroded mass fractions that the cases aim at.
const WANTED: [f64; 5] = [0.063, 0.071, 0.079, 0.087, 0.1];

/// Replicates of the reference, at least and at most.
const REPLICATES: (u64, u64) = (64, 1024);

/// Random subsets on which a rule is tried.
const TRIALS: u64 = 1000;

/// Steps of the search for the factor on the base's sizes.
const STEPS: u32 = 14;

/// When to stop.
#[derive(Clone, Copy)]
enum Rule {
    /// After so many replicates.
    Fixed(u64),
    /// Where the verdict is decided at this confidence level (%), or at the end of the reference.
    Decided(f64),
}

/// Confidence levels (%).
const LEVELS: [f64; 2] = [95.0, 99.9];

impl Rule {
    fn all(replicates: u64) -> Vec<Rule> {
        let powers = (0..).map(|power| 1u64 << power);
        let fixed = powers.take_while(|&k| 4 * k <= replicates).map(Rule::Fixed);
        fixed.chain(LEVELS.map(Rule::Decided)).collect()
    }

    fn name(self) -> String {
        match self {
            Rule::Fixed(_) => "fixed".into(),
            Rule::Decided(percent) => format!("decided at {percent} %"),
        }
    }

    /// The class by the replicates that it takes of these, in order, and how many that are.
    fn class(self, eroded: &[&[f64]]) -> (Verdict, u64) {
        match self {
            Rule::Fixed(k) => (class_of(&eroded[..k as usize]), k),
            Rule::Decided(percent) => sequential(percent, eroded),
        }
    }
}

/// The class of the rule that `--decide` follows, and the replicates that it takes of these.
fn sequential(percent: f64, eroded: &[&[f64]]) -> (Verdict, u64) {
    let most = eroded.len() as u64;
    let rule = StopRule { target_error_pp: None, decide_percent: Some(percent), most_replicates: most };
    let runs = eroded[0].len();
    let mut wanted = rule.replicates_at(0, 1);
    loop {
        let of_run = |run: usize| {
            eroded[..wanted as usize].iter().map(|runs| (runs[run], runs[run] < THRESHOLD)).collect()
        };
        match rule.look(0, &(0..runs).map(of_run).collect::<Vec<_>>()) {
            Look::Until(next) => wanted = next,
            Look::Stop(stopping) => return (stopping.verdict.unwrap_or(Verdict::Undecided), wanted),
        }
    }
}

/// The class by the means of replicates; `eroded[replicate][run]`.
fn class_of(eroded: &[&[f64]]) -> Verdict {
    let below = |run: usize| {
        let of_run = eroded.iter().map(|runs| runs.get(run)).collect::<Option<Vec<_>>>()?;
        Some(of_run.into_iter().sum::<f64>() / (eroded.len() as f64) < THRESHOLD)
    };
    classify(below(0), below(1))
}

/// The scene with its base's sizes multiplied.
struct Near<'a>(ScaledScene<'a>);

impl Near<'_> {
    fn run(&self, size_factor: f64) -> Result<FirstRun, PrecisionError> {
        let case = self.0.study.case;
        // By Eq. (2) a base of grains half as large is eight times as many.
        let whole = case.n_base_eq2.filter(|_| case.capped).unwrap_or(case.n_base) as f64;
        let wanted = whole / (size_factor * size_factor * size_factor);
        let n = if case.capped { wanted.min(case.n_base as f64) } else { wanted };
        let sampler = SizeSampler::new(&case.base.scaled(size_factor)?, case.unit_mm)?;
        let n_base = ((n * self.0.by_voids()).round() as u64).max(1);
        Ok(FirstRun { sampler, n_base, ..self.0.run() })
    }

    /// Eroded mass fraction of each of `runs` runs and processor time, of so many replicates.
    fn replicates(
        &self,
        size_factor: f64,
        runs: u64,
        count: u64,
    ) -> Result<Vec<(Vec<f64>, f64)>, PrecisionError> {
        let of_run = self.run(size_factor)?;
        self.0.study.side_by_side(count as usize, |i| {
            let seed = self.0.study.seed(1 + i as u64);
            let network = self.0.network(seed)?;
            let mut blocked = clean(&network);
            let (mut eroded, mut core_seconds) = (Vec::new(), 0.0);
            for run in 1..=runs {
                let ended = of_run.walk_from(&network, blocked, seed, run)?;
                eroded.push(ended.eroded_mass_fraction);
                core_seconds += ended.core_seconds;
                blocked = ended.blocked;
            }
            Ok((eroded, core_seconds))
        })
    }
}

/// The tier; `None` where no factor on the base's sizes brings its erosion near 7.5 %.
pub(super) fn tier(study: &Study, budget_s: f64) -> Result<Option<DecisionTier>, PrecisionError> {
    let narrow = study.shape().map(|[nx, ny, nz]| [nx.min(10), ny.min(10), nz]);
    let search = Near(ScaledScene { study, shape: narrow });
    let Some(factors) = factors(&search)? else {
        (study.tell)("decision: no factor on the base's sizes brings its erosion near 7.5 %");
        return Ok(None);
    };
    let runs = study.case.scene.walk.runs;
    // The cases erode less than the scene, and take about as long.
    let replicates = factors.len() as u64 * REPLICATES.0 * runs;
    let near = Near(ScaledScene::affordable(study, replicates, 0.9 * budget_s)?);
    let (mut cases, mut rows) = (Vec::new(), Vec::new());
    let network = near.0.network(study.seed(1))?;
    let pilot = near.run(factors[2])?.walk(&network, study.seed(1))?;
    let case_s = 0.9 * budget_s / factors.len() as f64;
    let replicates = affordable(case_s, runs as f64 * nominal(&pilot, &network), REPLICATES.0, REPLICATES.1);
    let on = near.0.words();
    for factor in factors {
        (study.tell)(&format!("decision: sizes x {factor:.3}, {replicates} replicates on {on}"));
        let walked = near.replicates(factor, runs, replicates)?;
        let first: Vec<f64> = walked.iter().map(|w| w.0[0]).collect();
        let of = Statistic::of_fraction(&first);
        let eroded: Vec<&[f64]> = walked.iter().map(|w| w.0.as_slice()).collect();
        let (low, high) = (of.low.unwrap_or(of.mean), of.high.unwrap_or(of.mean));
        let case = DecisionCase {
            name: format!("{:.2} % eroded", 100.0 * of.mean),
            size_factor: factor,
            n_base: near.run(factor)?.n_base,
            replicates,
            mean: of.mean,
            low,
            high,
            sd: of.sd.unwrap_or(0.0),
            class: class_of(&eroded),
            certain: high < THRESHOLD || low >= THRESHOLD,
            core_seconds: walked.iter().map(|w| w.1).sum::<f64>() / replicates as f64,
        };
        for rule in Rule::all(replicates) {
            rows.push(tried(study, &case, rule, &eroded));
        }
        cases.push(case);
    }
    Ok(Some(DecisionTier { on, cases, rows }))
}

/// Factors on the base's sizes at which the wanted fractions erode, about: coarser grains erode less.
fn factors(near: &Near) -> Result<Option<Vec<f64>>, PrecisionError> {
    let eroded = |factor: f64| -> Result<f64, PrecisionError> {
        let walked = near.replicates(factor, 1, 4)?;
        Ok(walked.iter().map(|w| w.0[0]).sum::<f64>() / walked.len() as f64)
    };
    // Factor and eroded mass, eroded mass falling.
    let mut known = vec![(1.0, eroded(1.0)?)];
    let (most, least) = (WANTED[WANTED.len() - 1], WANTED[0]);
    for _ in 0..STEPS {
        let (first, last) = (known[0], known[known.len() - 1]);
        if first.1 < most {
            known.insert(0, (first.0 / 1.06, eroded(first.0 / 1.06)?));
        } else if last.1 > least {
            // Far from it larger steps do.
            let step = if last.1 > 3.0 * most { 1.15 } else { 1.06 };
            known.push((last.0 * step, eroded(last.0 * step)?));
        } else {
            break;
        }
    }
    let at = |wanted: f64| {
        let pair = known.windows(2).find(|pair| pair[0].1 >= wanted && wanted > pair[1].1)?;
        let part = (pair[0].1 - wanted) / (pair[0].1 - pair[1].1);
        Some(pair[0].0 + part * (pair[1].0 - pair[0].0))
    };
    Ok(WANTED.into_iter().map(at).collect())
}

/// A rule, tried on random subsets of the replicates.
fn tried(study: &Study, case: &DecisionCase, rule: Rule, eroded: &[&[f64]]) -> DecisionRow {
    let key = Key {
        seed: study.case.scene.walk.seed,
        purpose: Purpose::Resampling,
        run: 0,
        increment: 0,
        chunk: case.size_factor.to_bits(),
    };
    let mut draws = key.generator();
    let mut order: Vec<&[f64]> = eroded.to_vec();
    let (mut wrong, mut undecided, mut used) = (0u64, 0u64, 0u64);
    for _ in 0..TRIALS {
        for i in (1..order.len()).rev() {
            order.swap(i, below(draws.next_u64(), i as u64 + 1) as usize);
        }
        let (class, taken) = rule.class(&order);
        used += taken;
        // One run alone leaves the class open for all: then that is the class.
        match class {
            Verdict::Undecided if case.class != class => undecided += 1,
            class => wrong += u64::from(class != case.class),
        }
    }
    let of = |count: u64| count as f64 / TRIALS as f64;
    let replicates = used as f64 / TRIALS as f64;
    // Subsets overlap: only as many as have no replicate in common count as independent.
    let interval = wilson(of(wrong), (eroded.len() as f64 / replicates).max(1.0));
    DecisionRow {
        case: case.name.clone(),
        rule: rule.name(),
        replicates,
        wrong: of(wrong),
        wrong_low: interval.low,
        wrong_high: interval.high,
        undecided: of(undecided),
        core_seconds: replicates * case.core_seconds,
    }
}
