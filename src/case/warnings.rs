//! Where a case leaves the range in which the model was checked, and what else a reader must know.

use super::{Case, Input, replicate_seed};
use crate::gradation::{FEW_FINES, FINES_MM};
use crate::network::ExitRule;
use crate::outcome::Mistake;

/// More moves than these of a particle that nothing stops are worth a word.
const MANY_MOVES: f64 = 1e5;

/// Constrictions that are looked at to find that out, each as often as it is looked at.
const LOOKED_AT: u64 = 50_000_000;

impl Case {
    /// Where the inputs leave the range in which the model was checked: no verdict on them stands in green.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = Vec::new();
        doubts.extend(self.fines());
        doubts.extend(self.errs_unsafe());
        doubts.extend(self.too_thick());
        for (whose, soil, low, high) in [("filter", &self.filter, 1.2, 6.0), ("base", &self.base, 1.2, 4.5)] {
            match soil.cu() {
                Some(cu) if cu < low - 1e-9 || cu > high + 1e-9 => doubts
                    .push(format!("Cu of the {whose} is {cu:.2}: the model was checked for {low} to {high}")),
                Some(_) => {}
                None => doubts.push(format!(
                    "Cu of the {whose} is not known, as its D10 is finer than its finest sieve: the model \
                     was checked for {low} to {high}"
                )),
            }
        }
        if let Some(gap) = self.filter.gap(0.0).filter(|_| self.filter_is_measured()) {
            doubts.push(format!(
                "the filter is gap-graded: only {:.1} % of it is between {:.3} mm and four times that. The \
                 constrictions between its fines, which it may lose, were walked",
                gap.within, gap.from_mm
            ));
        }
        if self.base.pan_fraction() > 0.0 {
            doubts.push(format!(
                "{:.1} % of the base is finer than its finest sieve: taken as passive and counted by mass \
                 only",
                100.0 * self.base.pan_fraction()
            ));
        }
        if let Some(shipped) = self.shipped.filter(|_| self.fixed_network.is_none())
            && let Some(cu) = self.filter.cu()
            && (cu / shipped.cu - 1.0).abs() > 0.05
        {
            doubts.push(format!(
                "the filter's Cu is {cu:.2}, but its constriction curve {} belongs to Cu {}: constrictions \
                 of another filter",
                shipped.name, shipped.cu
            ));
        }
        if self.scene.filter.estimate.is_some() {
            doubts.push(
                "the constriction curve is a guess from circles inscribed between three or four grains; the \
                 wider the filter's gradation, the more it is off. filter.density packs the grains and \
                 measures it"
                    .into(),
            );
        }
        doubts
    }

    /// A real filter layer that is thinner than the modelled one.
    fn too_thick(&self) -> Option<String> {
        let (real, modelled) = (self.scene.filter.thickness_mm?, self.thickness()?);
        let unit = if self.is_scale_free() { "D0F" } else { "mm" };
        (modelled > real).then(|| {
            format!(
                "the modelled filter is thicker than the real one; {} layers of D50F by number are \
                 {modelled:.1} {unit}, filter.thickness_mm is {real}: network.nz says how many layers",
                self.counts[3]
            )
        })
    }

    /// Fines of the base that may be cohesive, or that are not known.
    fn fines(&self) -> Option<String> {
        if self.is_scale_free() {
            return None;
        }
        let base = &self.base;
        let fines = base.percent_finer_by_mass(FINES_MM);
        if fines <= FEW_FINES {
            return None;
        }
        Some(match base.smallest_mm() <= FINES_MM || base.pan_fraction() == 0.0 {
            true => format!(
                "{fines:.0} % of the base is finer than 0.075 mm: cohesion may govern, which the model does \
                 not know"
            ),
            false => format!(
                "up to {fines:.0} % of the base may be finer than 0.075 mm, as its finest sieve is {} mm: \
                 cohesion may govern, which the model does not know",
                base.smallest_mm()
            ),
        })
    }

    /// Where the inputs leave the range in which the model was checked, and what else a reader must know.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.doubts();
        warnings.extend(self.regrading());
        let of_file = |input: &Input| -> Vec<String> {
            input.notes.iter().map(|note| format!("{}: {note}", input.name)).collect()
        };
        warnings.extend(self.inputs.iter().flat_map(of_file));
        if let Some(mistake) = Mistake::find(&self.filter, &self.base, self.is_scale_free()) {
            warnings.insert(0, mistake.sentence);
        }
        if self.filter.pan_fraction() > 0.0 {
            warnings.push(format!(
                "{:.1} % of the filter is finer than its finest sieve: its grains are not in Eq. (2), which \
                 then asks for too much base; filter.d0_mm says where that tail ends",
                100.0 * self.filter.pan_fraction()
            ));
        }
        if let Some(eq2) = self.n_base_eq2.filter(|_| self.capped) {
            warnings.push(format!(
                "capped at {} base particles; Eq. (2) requires {eq2}. Fewer particles are a bias, not \
                 noise, and its sign depends on the case",
                self.n_base
            ));
        }
        if let Some((copies, _)) = self.copies {
            let equal = if copies > 1 { format!(", {copies} equal copies of it,") } else { String::new() };
            warnings.push(format!(
                "all replicates walk the voids of one packing{equal} so that their spread is that of the walk \
                 alone, not that between packings"
            ));
        }
        if let Some(moves) = self.moves_to_an_end().filter(|moves| *moves > MANY_MOVES) {
            let about = if moves < 1e15 { format!("about {moves:.1e}") } else { "more than 1e15".into() };
            warnings.push(format!(
                "a base particle that nothing stops makes {about} moves before it leaves: the network has \
                 loops whose way out is very narrow, and a walk makes one move an increment, so it may not \
                 end in a lifetime. Give those ways out a diameter of 0, so that what circles counts as \
                 trapped, or a wider one"
            ));
        }
        warnings
    }

    /// About how many moves a particle makes that nothing stops, where loops may hold it for long: on a given
    /// network, or where one constriction is very much wider than another.
    fn moves_to_an_end(&self) -> Option<f64> {
        let widest = self.curve.largest() / self.curve.smallest();
        match &self.fixed_network {
            // Down the pressure there are no loops.
            Some(network) if network.reservoir().is_some() => None,
            Some(network) => Some(network.moves_to_an_end(LOOKED_AT)),
            None if widest * widest > MANY_MOVES && self.scene.exit_rule() == ExitRule::Area => {
                let network = self.network(replicate_seed(self.scene.walk.seed, 1)).ok()?;
                Some(network.moves_to_an_end(LOOKED_AT))
            }
            None => None,
        }
    }
}
