//! Why walks on given networks cannot be relied on further than they can: what nobody has checked, and what
//! the caller left open.

use super::network_walk::{NetworkOutcome, NetworkWalk};
use super::replicates::said_by_walks;
use crate::case::{Case, NOT_STUDIED, PAPER_MASS_RATIO};
use crate::network::Network;
use crate::outcome::Mistake;
use crate::outcome::confidence::{self, Judgement};
use crate::outcome::doubt::{Doubt, Way};
use crate::outcome::record::{Confidence, Statistic};
use crate::outcome::rules::{self, RuleInputs};

/// A lattice narrower than this many voids has few ways beside each other.
const FEWEST_ACROSS: u32 = 10;

/// Ranges of Cu that the model was checked for, of filter and base.
const CHECKED_CU: [[f64; 2]; 2] = [[1.2, 6.0], [1.2, 4.5]];

/// What is said of a verdict besides it.
pub struct Said {
    /// How far it can be relied on.
    pub confidence: Confidence,
    /// Why no further, the weightiest first.
    pub reasons: Vec<String>,
    /// What else a reader must know, and all doubts.
    pub warnings: Vec<String>,
}

impl NetworkOutcome {
    /// What is to be said of the verdict, on so many networks of which this is the first.
    pub fn said(&self, plan: &NetworkWalk, network: &Network, networks: usize) -> Said {
        let walked = || self.replicates.iter().map(|walked| &walked.result);
        let layers = network.layers() as u64;
        let of_walk = said_by_walks(self.verdict, walked(), &plan.base, plan.increments, layers);
        // Who walks a network by hand says in how many increments.
        let in_increments = |said: String| {
            said.replace("a smaller inject_share", "more increments, a smaller share of the base in each")
        };
        let of_walk = Doubt::all(Way::Unsafe, of_walk.into_iter().map(in_increments));
        let doubts: Vec<Doubt> = of_walk.chain(plan.doubts(network, self.replicates.len() as u64)).collect();
        let rules = plan.filter.as_ref().map_or(Vec::new(), |filter| {
            let largest: Vec<f64> =
                walked().filter_map(|w| w.replicate.runs.first()?.largest_eroded_over_d15f).collect();
            rules::apply(&RuleInputs {
                filter_is_measured: filter.is_measured,
                largest_eroded_over_d15f: (!largest.is_empty()).then(|| Statistic::of(&largest).mean),
                ..RuleInputs::of_soils(&plan.base, &filter.gradation)
            })
        });
        let mistake = plan.filter.as_ref().and_then(|f| Mistake::find(&plan.base, &f.gradation, false));
        let mut warnings: Vec<String> = mistake.map(|mistake| mistake.sentence).into_iter().collect();
        warnings.extend(doubts.iter().map(|doubt| doubt.said.clone()));
        if networks == 1 && self.replicates.len() > 1 {
            warnings.push(
                "all replicates walk one network: their spread is that of their walks, and says nothing of \
                 other networks of the same filter"
                    .into(),
            );
        }
        let Judgement { confidence, reasons, notes } = confidence::judge(self.verdict, &rules, doubts);
        let new: Vec<String> = notes.into_iter().filter(|note| !warnings.contains(note)).collect();
        warnings.extend(new);
        warnings.push(NOT_STUDIED.into());
        Said { confidence, reasons, warnings }
    }
}

impl NetworkWalk {
    /// What was not checked, or is not known, whatever comes of the walk.
    fn doubts(&self, network: &Network, replicates: u64) -> Vec<Doubt> {
        let mut open: Vec<String> = Case::fines_of(&self.base).into_iter().collect();
        open.extend(self.amount(network));
        open.push(format!(
            "the network was given as it is, {} voids; nothing of it was checked against tests",
            network.filter_voids()
        ));
        if self.filter.is_none() {
            open.push("the filter was not given; no rule of practice was asked".into());
        }
        let mut of_shape = Vec::new();
        if let Some([nx, ny, _]) = network.shape()
            && nx.min(ny) < FEWEST_ACROSS
        {
            of_shape.push(format!(
                "the lattice is only {nx} x {ny} voids across; a narrow one seals by chance, so that filters \
                 seem to hold: {FEWEST_ACROSS} x {FEWEST_ACROSS} at the least, better 40 x 40"
            ));
        }
        let layers = network.layers() as u64;
        if network.exit_rule().needs_flow() && self.increments <= layers {
            of_shape.push(format!(
                "the whole base is inserted before any of it can be through the filter; there are {} \
                 increments, and a particle needs {layers} to pass as many layers. Where water flows, all \
                 that is on its way when the filter clogs counts as retained: take {} increments or more",
                self.increments,
                10 * layers
            ));
        }
        let filter = self.filter.as_ref().map(|filter| &filter.gradation);
        for (whose, soil, [low, high]) in
            [("filter", filter, CHECKED_CU[0]), ("base", Some(&self.base), CHECKED_CU[1])]
        {
            let Some(soil) = soil else { continue };
            match soil.cu() {
                Some(cu) if cu < low - 1e-9 || cu > high + 1e-9 => open
                    .push(format!("Cu of the {whose} is {cu:.2}: the model was checked for {low} to {high}")),
                Some(_) => {}
                None => open.push(format!(
                    "Cu of the {whose} is not known, as its D10 is finer than its finest sieve: the model \
                     was checked for {low} to {high}"
                )),
            }
        }
        if self.base.pan_fraction() > 0.0 {
            open.push(format!(
                "{:.1} % of the base is finer than its finest sieve: taken as passive and counted by \
                 mass only",
                100.0 * self.base.pan_fraction()
            ));
        }
        open.extend(Case::few(replicates));
        // What is finer than every constriction has one reading.
        Doubt::all(Way::Unsafe, of_shape).chain(Doubt::all(Way::Open, open)).collect()
    }

    /// That the class follows from a number of base particles that is not the one of Eq. (2), or that nobody
    /// can compare with it.
    fn amount(&self, network: &Network) -> Option<String> {
        let n = self.n_base;
        let Some(eq2) = self.eq2(network, PAPER_MASS_RATIO).ok().flatten() else {
            return Some(format!(
                "n_base gives {n} base particles, and the class follows from their number; without the \
                 filter and its grains per void Eq. (2) cannot say whether they are enough"
            ));
        };
        let requires = format!("Eq. (2) requires {eq2} for a mass ratio of {} %", 100.0 * PAPER_MASS_RATIO);
        let given = format!("{n} base particles were walked");
        if n < eq2 {
            return Some(format!(
                "{given}; {requires}. Fewer particles are a bias, not noise; its sign depends on the case, \
                 and a filter that was offered too few to fill it seems to hold"
            ));
        }
        (n > eq2).then(|| {
            format!(
                "{given}; {requires}. Of more base a smaller share passes once the filter has filled, so \
                 that a filter may seem to hold"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::constrictions::find;
    use crate::gradation::Gradation;
    use crate::network::{ExitRule, NetworkColumns};
    use crate::run::{Callbacks, GivenFilter, walk_networks};

    fn said(n_base: Option<u64>, filter: Option<Gradation>, grains_per_void: Option<f64>) -> (u64, Said) {
        let curve = find("cu1.5-loose").unwrap().curve().unwrap().in_mm(1.0).unwrap();
        let network = Arc::new(Network::cubic([10, 10, 12], &curve, 1.0, 5).unwrap());
        let filter = filter.map(|gradation| GivenFilter { gradation, is_measured: true, grains_per_void });
        let base = Gradation::linear_from_dx(85.0, 0.25, 1.5).unwrap();
        let mut plan = NetworkWalk { replicates: 6, filter, ..NetworkWalk::new(base, 1) };
        let eq2 = plan.eq2(&network, 0.05).unwrap();
        plan.n_base = n_base.or(eq2).unwrap();
        let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
        (plan.n_base, outcome.said(&plan, &network, 1))
    }

    /// What nobody can compare with Eq. (2), what falls short of it, and what exceeds it are doubts; its own
    /// number is none.
    #[test]
    fn a_number_of_particles_that_is_not_that_of_equation_two_is_a_doubt() {
        let filter = || Gradation::linear_from_d0(1.0, 1.5).ok();
        let has = |said: &Said, part: &str| said.reasons.iter().any(|reason| reason.contains(part));
        let (n, of_eq2) = said(None, filter(), Some(0.6));
        assert!(n > 1000 && !has(&of_eq2, "base particles"), "{n} {:?}", of_eq2.reasons);
        assert!(has(
            &said(Some(1000), filter(), Some(0.6)).1,
            "1000 base particles were walked; Eq. (2) requires"
        ));
        assert!(has(&said(Some(n + 1), filter(), Some(0.6)).1, "a smaller share passes"));
        for filter in [None, filter()] {
            let unknown = said(Some(n), filter, None).1;
            assert!(has(&unknown, "Eq. (2) cannot say whether they are enough"), "{:?}", unknown.reasons);
        }
        assert!(has(&said(Some(n), None, None).1, "no rule of practice was asked"));
    }

    /// D15F 1.13 mm and D85B 0.25 mm: practice accepts the pair. A filter ten times as coarse is refused by
    /// its rules, whatever is walked; without a filter nobody is asked.
    #[test]
    fn rules_of_practice_are_asked_where_the_filter_is_known() {
        let fine = said(Some(2000), Gradation::linear_from_d0(1.0, 1.5).ok(), Some(0.6)).1;
        assert_eq!(fine.confidence, Confidence::Outside, "{:?}", fine.reasons);
        let curve = find("cu1.5-loose").unwrap().curve().unwrap().in_mm(1.0).unwrap();
        let network = Arc::new(Network::cubic([10, 10, 12], &curve, 1.0, 5).unwrap());
        let coarse = GivenFilter {
            gradation: Gradation::linear_from_d0(10.0, 1.5).unwrap(),
            is_measured: true,
            grains_per_void: None,
        };
        // Coarser than every constriction: nothing passes in the model.
        let base = Gradation::linear_from_dx(85.0, 0.9, 1.5).unwrap();
        let plan = NetworkWalk { filter: Some(coarse), ..NetworkWalk::new(base, 500) };
        let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
        let said = outcome.said(&plan, &network, 1);
        assert_eq!(said.confidence, Confidence::Contradicted, "{:?}", said.reasons);
        assert!(said.reasons[0].contains("practice allows D15F"), "{:?}", said.reasons);
    }

    /// The one constriction is closed by the first particle: what to try is said in the words of a walk
    /// without a scene.
    #[test]
    fn a_network_that_clogs_is_a_doubt() {
        let columns = NetworkColumns {
            voids: 2,
            conns: &[[0, 1]],
            diameter_mm: &[0.1],
            conductance: None,
            inlets: &[0],
            outlets: &[1],
            rule: ExitRule::Flux,
            rho: 0.0,
            unit_mm: 1.0,
        };
        let network = Arc::new(Network::from_columns(&columns).unwrap().0);
        let plan = NetworkWalk { replicates: 2, ..NetworkWalk::new(Gradation::single(0.2).unwrap(), 1000) };
        let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
        let reasons = outcome.said(&plan, &network, 1).reasons.join("\n");
        assert!(reasons.contains("clogged wholly") && reasons.contains("more increments, a smaller share"));
        assert!(!reasons.contains("inject_share"), "{reasons}");
    }
}
