//! Where a case leaves the range in which the model was checked, and what else a reader must know.

use super::packed_filter::GUESSED_GRAINS_PER_VOID;
use super::{Case, Input, PackingPlan, guesses_grains_per_void, replicate_seed};
use crate::gradation::{FEW_FINES, FINES_MM, Gradation};
use crate::network::ExitRule;
use crate::outcome::Mistake;
use crate::outcome::doubt::{Doubt, Way};

/// More moves than these of a particle that nothing stops are worth a word.
const MANY_MOVES: f64 = 1e5;

/// A larger share of grains without load is worth a word ...
const MANY_LOOSE: f64 = 0.5;
/// ... and where it is as large as this, coarse grains carry each other: of two sizes far apart 98 % were
/// without load with 30 % of the mass in the finer one, 19 % with 40 % (`results/cuts.md`).
const SKELETON: f64 = 0.9;

/// With fewer replicates than these their number is said beside the verdict: their scatter is hardly known.
const FEW_REPLICATES: u64 = 5;

/// What a first look leaves out.
pub const NOT_STUDIED: &str =
    "how the verdict moves with the amount of base and with thickness was not studied";

/// What says how thick the graph of a packing is.
const GRAPH_THICKNESS: &str =
    "network.copies, or network.thickness_mm, which is rounded up to whole copies, says how thick it is";

/// Constrictions that are looked at to find that out, each as often as it is looked at.
const LOOKED_AT: u64 = 50_000_000;

impl Case {
    /// Where the inputs leave the range in which the model was checked, each with the way in which the walk
    /// errs for it.
    pub fn doubts(&self) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        doubts.extend(Doubt::all(Way::Open, self.fines()));
        doubts.extend(Doubt::all(Way::Unsafe, self.errs_unsafe()));
        doubts.extend(Doubt::all(Way::Unsafe, self.not_walked()));
        doubts.extend(self.too_thick());
        doubts.extend(Doubt::all(Way::Open, self.too_little_base()));
        doubts.extend(self.network_doubts());
        doubts.extend(Doubt::all(Way::Open, self.not_as_uniform()));
        if let Some(gap) = self.filter.gap(0.0).filter(|_| self.filter_is_measured()) {
            let said = format!(
                "the filter is gap-graded: only {:.1} % of it is between {:.3} mm and four times that. The \
                 constrictions between its fines, which it may lose, were walked",
                gap.within, gap.from_mm
            );
            doubts.push(Doubt { said, way: Way::Unsafe });
        }
        // Finer than every constriction it is passive for certain.
        let way = if self.pan_size.is_some() { Way::Open } else { Way::Settled };
        doubts.extend(Doubt::all(way, self.pan_doubt()));
        doubts.extend(Doubt::all(Way::Open, self.other_filter()));
        doubts.extend(Doubt::all(Way::Open, self.guesses()));
        // The grains that were left out can only make constrictions coarser than those that were walked.
        let part = self.packed.as_ref().and_then(|packed| packed.part.as_ref());
        doubts.extend(Doubt::all(Way::Unsafe, part.map(|part| part.sentence())));
        let loose = self.packed.as_ref().and_then(|packed| packed.rattlers);
        if let Some(loose) = loose.filter(|loose| *loose > SKELETON) {
            let said = format!(
                "{:.0} % of the packed grains, by number, carry no load: the coarse grains carry each other, \
                 and nearly all finer ones lie loose between them. Water may wash those out, and with them \
                 the constrictions that were walked",
                100.0 * loose
            );
            doubts.push(Doubt { said, way: Way::Unsafe });
        }
        doubts.extend(Doubt::all(Way::Open, self.few_replicates()));
        doubts
    }

    /// That a soil is more or less uniform than those for which the model was checked.
    fn not_as_uniform(&self) -> Vec<String> {
        let mut said = Vec::new();
        let mut compare = |whose: &str, cu: Option<[f64; 2]>, low: f64, high: f64| {
            let is_within = |cu: f64| (low - 1e-9..=high + 1e-9).contains(&cu);
            let checked = format!("the model was checked for {low} to {high}");
            match cu {
                Some([least, most]) if is_within(least) && is_within(most) => {}
                Some([least, most]) if most - least < 0.005 => {
                    said.push(format!("Cu of the {whose} is {least:.2}: {checked}"));
                }
                Some([least, most]) => said.push(format!(
                    "Cu of the {whose} is between {least:.2} and {most:.2}, as its D10 is finer than its \
                     finest sieve: {checked}"
                )),
                None => said.push(format!(
                    "Cu of the {whose} is not known, as its D10 is finer than its finest sieve: {checked}"
                )),
            }
        };
        compare("filter", self.filter.cu().map(|cu| [cu, cu]), 1.2, 6.0);
        compare("base", self.cu_of_base(), 1.2, 4.5);
        said
    }

    /// Cu of the base between its two readings where D10 lies in an open tail.
    fn cu_of_base(&self) -> Option<[f64; 2]> {
        if let Some(cu) = self.base.cu() {
            return Some([cu, cu]);
        }
        let [fine, coarse] = self.tail_as()?.map(|reading| reading.cu());
        Some([coarse?, fine?])
    }

    /// A shipped constriction curve of another filter.
    fn other_filter(&self) -> Option<String> {
        let shipped = self.shipped.filter(|_| self.fixed_network.is_none())?;
        let cu = self.filter.cu().filter(|cu| (cu / shipped.cu - 1.0).abs() > 0.05)?;
        Some(format!(
            "the filter's Cu is {cu:.2}, but its constriction curve {} belongs to Cu {}: constrictions of \
             another filter",
            shipped.name, shipped.cu
        ))
    }

    /// What is guessed where nobody packed the filter.
    fn guesses(&self) -> Vec<String> {
        if self.scene.filter.estimate.is_none() {
            return Vec::new();
        }
        let curve = "the constriction curve is a guess from circles inscribed between three or four grains: \
                     on packed filters its Dc50 was 0.65 to 0.82 times the measured one at 1, and 1.6 to 1.9 \
                     times at 0, so both are walked besides. filter.density packs the grains and measures \
                     it, of a broad filter on its finer part";
        let grains = guesses_grains_per_void(&self.scene).then(|| {
            format!(
                "filter.grains_per_void is not given, and a guess knows none: {GUESSED_GRAINS_PER_VOID} was \
                 taken, as of loose packings (0.43 to 0.69 were measured); the base that Eq. (2) gives goes \
                 with it"
            )
        });
        std::iter::once(curve.to_owned()).chain(grains).collect()
    }

    /// What the scene says of the soils that the model does not know.
    fn not_walked(&self) -> Vec<String> {
        let dispersive = self.scene.base.dispersive == Some(true);
        let dispersive = dispersive.then(|| {
            "the base is dispersive: the model knows its sizes alone; the rules of practice take their \
             limits for dispersive soils"
                .to_owned()
        });
        let joint = self.scene.filter.joint_mm.map(|joint| {
            format!(
                "an open joint of {joint} mm was not walked: the rules of practice say how likely erosion \
                 continues into it"
            )
        });
        dispersive.into_iter().chain(joint).collect()
    }

    /// That the replicates say little of their own scatter.
    fn few_replicates(&self) -> Option<String> {
        let walk = &self.scene.walk;
        // Where a rule adds replicates, it says itself whether they are enough, unless it may add none.
        let least = match self.scene.stop.is_set() {
            true => self.scene.stop.replicates_at(walk.replicates, 1),
            false => walk.replicates,
        };
        Self::few(least)
    }

    /// The same of any number of replicates.
    pub fn few(replicates: u64) -> Option<String> {
        match replicates {
            1 => Some(
                "one replicate: the scatter is unknown; walk more before relying on this (replicates = 10)"
                    .to_owned(),
            ),
            few if few < FEW_REPLICATES => Some(format!("only {few} replicates")),
            _ => None,
        }
    }

    /// That neither study was asked for. It says nothing against the range in which the model was checked,
    /// and stands beside the verdict all the same.
    pub fn not_studied(&self) -> Option<&'static str> {
        let record = &self.scene.record;
        // Without a list of its own the study of the thickness goes with the other.
        let studied = |list: &[f64]| list.iter().any(|factor| *factor != 1.0);
        let is_studied =
            studied(&record.sensitivity) || studied(record.thickness.as_deref().unwrap_or_default());
        (!is_studied).then_some(NOT_STUDIED)
    }

    /// A real filter layer that is thinner than the modelled one by more than half a layer of voids, to which
    /// a thickness is rounded.
    fn too_thick(&self) -> Option<Doubt> {
        let real = self.scene.filter.thickness_mm?;
        if self.is_scale_free() {
            return Some(Doubt { said: Self::thickness_without_unit(real, "D0F"), way: Way::Open });
        }
        let Some(modelled) = self.thickness() else {
            let said = format!(
                "how thick a network from a file is, is not known: filter.thickness_mm, {real}, is compared \
                 with nothing"
            );
            return Some(Doubt { said, way: Way::Open });
        };
        let half = 0.5 * self.filter.d_by_number(50.0).unwrap_or(0.0);
        let (what, key) = match self.copies {
            Some((1, _)) => ("one copy of the packing is".into(), GRAPH_THICKNESS),
            Some((copies, _)) => (format!("{copies} copies of the packing are"), GRAPH_THICKNESS),
            None => (
                format!("{} layers of D50F by number are", self.counts[3]),
                "network.nz says how many layers",
            ),
        };
        let said = format!(
            "the modelled filter is thicker than the real one; {what} {modelled:.1} mm, filter.thickness_mm \
             is {real}: {key}"
        );
        (modelled > real + half * (1.0 + 1e-9)).then_some(Doubt { said, way: Way::Unsafe })
    }

    /// That a real thickness says nothing where sizes are multiples of another.
    pub fn thickness_without_unit(real: f64, unit: &str) -> String {
        format!(
            "whether the modelled filter is thicker than the real one is not known: filter.thickness_mm is \
             {real} mm, but sizes are multiples of {unit}; give them in mm, or leave it out"
        )
    }

    /// What is not known of the base's finest part.
    pub fn pan_doubt(&self) -> Option<String> {
        let percent = 100.0 * self.base.pan_fraction();
        if self.pan_size.is_some() {
            return Some(format!(
                "{percent:.1} % of the base is finer than its finest sieve, {} mm, and may be coarser than \
                 the finest constriction, {:.3} mm: walked twice, as finer than every constriction and as \
                 all of that sieve's size",
                self.base.smallest_mm(),
                self.finest_mm
            ));
        }
        (percent > 0.0).then(|| {
            format!(
                "{percent:.1} % of the base is finer than its finest sieve: taken as passive and counted by \
                 mass only"
            )
        })
    }

    /// Fines of the base that may be cohesive, or that are not known.
    fn fines(&self) -> Option<String> {
        if self.is_scale_free() { None } else { Self::fines_of(&self.base) }
    }

    /// The same of any base in mm.
    pub fn fines_of(base: &Gradation) -> Option<String> {
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
        let mut warnings: Vec<String> = self.doubts().into_iter().map(|doubt| doubt.said).collect();
        warnings.extend(self.regrading());
        let of_file = |input: &Input| -> Vec<String> {
            input.notes.iter().map(|note| format!("{}: {note}", input.name)).collect()
        };
        warnings.extend(self.inputs.iter().flat_map(of_file));
        if let Some(mistake) = Mistake::find(self.base_as_given(), &self.filter, self.is_scale_free()) {
            warnings.insert(0, mistake.sentence);
        }
        if self.filter.pan_fraction() > 0.0 {
            warnings.push(format!(
                "{:.1} % of the filter is finer than its finest sieve: its grains are not in Eq. (2), which \
                 then asks for too much base; filter.d0_mm says where that tail ends",
                100.0 * self.filter.pan_fraction()
            ));
        }
        let loose = self.packed.as_ref().and_then(|packed| packed.rattlers);
        if let Some(loose) = loose.filter(|loose| (MANY_LOOSE..=SKELETON).contains(loose)) {
            warnings.push(format!(
                "{:.0} % of the packed grains, by number, carry no load (rattlers): most small grains float \
                 in the voids of others, as in broad filters that are not dense. The model holds them where \
                 they lie; water may move them",
                100.0 * loose
            ));
        }
        warnings.extend(self.narrow_cell());
        if let Some((copies, _)) = self.copies {
            let equal = if copies > 1 { format!(", {copies} equal copies of it,") } else { String::new() };
            warnings.push(format!(
                "all replicates walk the voids of one packing{equal} so that their spread is that of the \
                 walk \
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

    /// A tall cell whose number of grains leaves it narrow.
    fn narrow_cell(&self) -> Option<String> {
        let plan = PackingPlan::new(&self.scene.packing_spec().ok()??).ok()?;
        let (width, usual) = plan.narrow_and_tall()?;
        Some(format!(
            "{} grains in a cell {} times as tall as wide leave it about {width:.1} times as wide as the \
             largest grain, where {usual} times is usual: it is periodic, so that its voids repeat across, \
             and every layer has few of them; packing.grains says how many",
            plan.compression.grains, plan.aspect
        ))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn case(changes: &[&str]) -> Result<Case, String> {
        let changes: Vec<String> = changes.iter().map(|c| c.to_string()).collect();
        Case::new(Scene::built_in(&changes).unwrap()).map_err(|error| error.to_string())
    }

    fn said(changes: &[&str]) -> String {
        let doubts = case(changes).unwrap().doubts();
        doubts
            .into_iter()
            .map(|doubt| doubt.said)
            .filter(|said| said.contains("thicker than the real one"))
            .collect()
    }

    #[test]
    fn a_real_thickness_is_compared_in_mm_and_to_half_a_layer() {
        let said_of = said(&["filter.thickness_mm=50"]);
        assert!(said_of.contains("is 50 mm, but sizes are multiples of D0F"), "{said_of}");
        let sized = |real: &str| said(&["filter.d0_mm=2.1", "network.thickness_mm=100", real]);
        let case = case(&["filter.d0_mm=2.1", "network.thickness_mm=100"]).unwrap();
        let (layer, modelled) = (case.filter.d_by_number(50.0).unwrap(), case.thickness().unwrap());
        assert!(modelled != 100.0 && sized("filter.thickness_mm=100").is_empty());
        assert!(sized(&format!("filter.thickness_mm={}", modelled - 0.49 * layer)).is_empty());
        let thinner = sized(&format!("filter.thickness_mm={}", modelled - 0.51 * layer));
        assert!(
            thinner.contains("layers of D50F by number are") && thinner.contains("network.nz"),
            "{thinner}"
        );
    }

    #[test]
    fn a_network_is_no_thinner_than_half_a_layer() {
        for thin in ["network.thickness_mm=0.5", "network.thickness_d50f=0.3"] {
            let error = case(&["filter.d0_mm=2.1", thin]).err().unwrap();
            assert!(error.contains("allowed: half a layer or more"), "{error}");
        }
        assert_eq!(case(&["filter.d0_mm=2.1", "network.thickness_mm=1.5"]).unwrap().counts[3], 1);
    }
}
