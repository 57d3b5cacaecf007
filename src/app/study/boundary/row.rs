//! One density and thickness, ready to be walked at any ratio.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::plan::Thickness;
use super::search::{Begun, Found, Hint, Start, holding};
use super::trials::{Trial, USUAL_ACROSS, Walker};
use crate::case::{
    Case, CaseBase, CaseError, CaseSupply, OtherCurve, ResourceLimits, StatedBase, replicate_seed,
};
use crate::outcome::Eroded;
use crate::outcome::boundary::Beyond;
use crate::outcome::verdict::THRESHOLD;
use crate::run::RunError;
use crate::run::callbacks::Callbacks;
use crate::run::replicates::plan;
use crate::scene::{Amount, BaseGradation, D85, LibraryDensity};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{Network, Passage};
use voidwalk_core::walk::{Clogged, PlainExits, SizeClasses, State, Walk, WalkControl};
use voidwalk_practice::{Mistake, Note, ordered};

/// Ratio assumed in a first guess of the layers of a thickness in mm.
const USUAL_RATIO: f64 = 5.0;

#[derive(Clone)]
pub(super) struct Row {
    pub(crate) density: String,
    pub(crate) thickness: Thickness,
    /// The filter and its network, with some base or other.
    pub(crate) case: Case,
    pub(crate) stated: StatedBase,
    /// The base in units of its D85.
    pub(crate) base: Gradation,
    /// D85B (mm), if the base has a size of its own.
    pub(crate) d85_mm: Option<f64>,
    /// True if the filter has a size of its own.
    pub(crate) filter_has_size: bool,
    pub(crate) limits: ResourceLimits,
    /// Density with this row as an end of the range of its constriction curve.
    pub(crate) end_of: Option<String>,
    /// The densities of the ends of its own range.
    pub(crate) ends: Vec<String>,
}

impl Row {
    /// Copies of this row for the ends of the range of its constriction curve.
    pub(crate) fn at_curve_ends(&self) -> Vec<Self> {
        let case = &self.case;
        let names_itself = case.filter.guessed_density.is_some() || case.filter.library.is_some();
        let at_end = |end: &OtherCurve| {
            let density = match names_itself {
                true => end.name.replace(" = ", " "),
                false => format!("{}, {}", self.density, end.name),
            };
            let end_of = Some(self.density.clone());
            let mut case = self.case.with_curve(end.curve.clone());
            case.filter.grains_per_void = case.filter.grains_per_void.map(|grains| grains * end.times_grains);
            Self { case, density, end_of, ..self.clone() }
        };
        self.case.filter.curve_ends.iter().map(at_end).collect()
    }

    /// D15F in the case's own unit.
    pub(crate) fn d15f(&self) -> f64 {
        self.case.filter.gradation.d(15.0).unwrap_or(f64::NAN)
    }

    /// Number of networks to search: 0 for an unknown density, whose ends are searched instead.
    pub(crate) fn networks(&self) -> u64 {
        let is_unknown = self.case.scene.filter.library == Some(LibraryDensity::Unknown);
        let is_between_ends = is_unknown && self.end_of.is_none() && !self.ends.is_empty();
        if is_between_ends { 0 } else { self.case.scene.walk.replicates }
    }

    /// Size of the filter at a ratio, as a multiple of its size in the case, if the base has a size.
    pub(crate) fn factor(&self, ratio: f64) -> Option<f64> {
        Some(ratio * self.d85_mm? / self.d15f())
    }

    /// Layers at a ratio, if they depend on the ratio.
    pub(crate) fn layers(&self, ratio: f64) -> Option<u64> {
        let (mm, layer) = self.thickness_and_layer(ratio)?;
        Some((mm / layer).round().clamp(1.0, f64::from(u32::MAX)) as u64)
    }

    /// Thickness that was asked for and thickness of one layer (mm), if the layers depend on the ratio.
    fn thickness_and_layer(&self, ratio: f64) -> Option<(f64, f64)> {
        let Thickness::Mm(mm) = self.thickness else { return None };
        let layer = self.case.filter.gradation.d_by_number(50.0).unwrap_or(self.case.filter.unit_mm);
        Some((mm, layer * self.factor(ratio)?))
    }

    /// Thickness (mm) of the single layer that is walked at a ratio if less than half a layer was asked for.
    pub(crate) fn thicker_than_asked(&self, ratio: f64) -> Option<f64> {
        let (mm, layer) = self.thickness_and_layer(ratio)?;
        ((mm / layer).round() < 1.0).then_some(layer)
    }

    pub(crate) fn thicker(&self, ratio: f64) -> Option<Note> {
        let layer_mm = self.thicker_than_asked(ratio)?;
        Some(Note::LayerThicker { ratio, layer_mm, thickness: self.thickness.to_string() })
    }

    pub(crate) fn at(&self, ratio: f64) -> Result<Case, CaseError> {
        let base = self.base.scaled(self.d15f() / ratio)?;
        let mut case = self.case.with_base(base, self.layers(ratio))?;
        case.place(&self.limits, rayon::current_num_threads() as u64, std::path::Path::new("."))?;
        Ok(case)
    }

    /// Refuses too many layers, or more memory than there is, at a ratio near the start of the search.
    pub(crate) fn check_room(&self, bracket: [f64; 2]) -> Result<(), RunError> {
        let ratio = self.start().clamp(bracket[0], bracket[1]);
        match self.at(ratio) {
            Err(error) if !is_of_base(&error) => {
                let row = format!("{}, {}, at D15F/D85B {ratio:.2}", self.density, self.thickness);
                Err(RunError::Refused(format!("{row}: {error}")))
            }
            _ => Ok(()),
        }
    }

    /// Side of the search on which a ratio lies that cannot be walked.
    fn side(&self, ratio: f64) -> Beyond {
        let too_few = || -> Option<bool> {
            let Amount::MassRatio(mass_ratio, _) = self.case.scene.base.amount() else { return None };
            let base = self.base.scaled(self.d15f() / ratio).ok()?;
            let per_grain =
                base.particles_per_unit_volume() / self.case.filter.gradation.particles_per_unit_volume();
            let grains = mass_ratio * self.case.filter.grains_per_void? * self.case.network.voids as f64;
            Some(grains * per_grain < 1.0)
        };
        if too_few() == Some(true) { Beyond::Below } else { Beyond::Above }
    }

    /// Boundary for a lone particle of one size, by the closed form: the start of the search.
    pub(crate) fn start(&self) -> f64 {
        let layers = self.layers(USUAL_RATIO).unwrap_or(self.case.network.layers).max(1);
        self.d15f() / Passage::new(&self.case.filter.curve).coarsest_through(layers, 1.0 - THRESHOLD)
    }

    /// Start nodes, which decide the number of ratios to try: more if walks are quick. With flow, or for a
    /// network that is not a lattice, the number of the usual lattice.
    pub(crate) fn across(&self) -> u64 {
        if self.case.scene.is_lattice_by_area() { self.case.network.start_nodes } else { USUAL_ACROSS }
    }

    /// Searches the boundary of the first run of network `number`, counted from 1. Errors: a walk that fails
    /// or was stopped.
    pub(crate) fn begun<'a>(
        &'a self,
        number: u64,
        (bracket, hint): ([f64; 2], Hint),
        callbacks: &'a Callbacks<'a>,
    ) -> Result<Begun<OneNetwork<'a>>, RunError> {
        let start = Start { ratio: self.start(), hint, across: self.across() };
        Begun::new(self.network(number, callbacks), bracket, start)
    }

    /// Result for the first network if it holds this ratio. Errors: a walk that fails or was stopped.
    pub(crate) fn holding(
        &self,
        ratio: f64,
        bracket: [f64; 2],
        callbacks: &Callbacks,
    ) -> Result<Option<Found>, RunError> {
        holding(self.network(1, callbacks), bracket, (ratio, self.across()))
    }

    fn network<'a>(&'a self, number: u64, callbacks: &'a Callbacks<'a>) -> OneNetwork<'a> {
        let seed = replicate_seed(self.case.scene.walk.seed, number);
        OneNetwork { row: self, seed, network: None, clogged: BTreeMap::new(), callbacks }
    }
}

/// True if the base itself cannot be walked: Eq. (2) gives too few or too many particles, or sizes are out of
/// range.
fn is_of_base(error: &CaseError) -> bool {
    matches!(error, CaseError::Scene(_) | CaseError::Gradation(_) | CaseError::Number(_))
}

pub(super) struct OneNetwork<'a> {
    row: &'a Row,
    seed: u64,
    /// Network of the last walk, and its exits.
    network: Option<(Arc<Network>, PlainExits)>,
    /// Constrictions after the first run, by step.
    clogged: BTreeMap<i64, Clogged>,
    callbacks: &'a Callbacks<'a>,
}

impl Walker for OneNetwork<'_> {
    fn walk(&mut self, run: u64, step: i64, ratio: f64) -> Result<Trial, RunError> {
        let case = match self.row.at(ratio) {
            Ok(case) => case,
            Err(error) if is_of_base(&error) => {
                return Ok(Trial::CannotBe(self.row.side(ratio), error.to_string()));
            }
            // A limit of this machine is no property of the filter.
            Err(error) => {
                let text = format!(
                    "at D15F/D85B {ratio:.2}: {error}; networks that are done are kept: repeat the command \
                     with more --memory"
                );
                return Err(RunError::Failed(text.into()));
            }
        };
        let (network, open) = match self.network.take().filter(|(kept, _)| case.has_layers_of(kept)) {
            Some(kept) => kept,
            None => {
                let network = Arc::new(case.network(self.seed)?);
                let open = PlainExits::unblocked(&network);
                (network, open)
            }
        };
        let before = self.clogged.remove(&step).filter(|_| run > 1);
        let clogged = before.unwrap_or_else(|| Clogged::none(&network));
        let walked = (&network, Some(&open));
        let (eroded, left) = eroded(&case, walked, (self.seed, run), clogged, self.callbacks)?;
        self.network = Some((network, open));
        if run == 1 && !eroded.below_threshold {
            self.clogged.insert(step, left);
        }
        Ok(Trial::Eroded(eroded))
    }
}

/// Number of size classes in an unused record: one or two classes serve as well as more.
const SIZE_CLASSES: usize = 2;

/// Walks run `run` (1 or 2) of a case on the network of the replicate with this seed, starting with
/// `clogged`: the same bits as in [`crate::run::walk_case`]. `open` are the network's exits, if known.
/// Returns the eroded mass and the constrictions at the end. Errors: a walk that fails or was stopped;
/// particles that do not fit.
fn eroded(
    case: &Case,
    (network, open): (&Arc<Network>, Option<&PlainExits>),
    (seed, run): (u64, u64),
    clogged: Clogged,
    callbacks: &Callbacks,
) -> Result<(Eroded, Clogged), RunError> {
    let plan = plan(case, network, &clogged.blocked, case.supply.n_base);
    let supply = plan.supply(case.supply.sampler.clone(), case.supply.n_base, case.increments(), seed, run);
    let (smallest, largest) = (case.supply.sampler.smallest(), case.supply.sampler.largest());
    let classes = SizeClasses::logarithmic(smallest, largest, SIZE_CLASSES);
    let state = State::placed(&case.placement, network, &supply, classes, clogged, seed, run);
    let mut state = state.map_err(|source| RunError::Room { particles: supply.total(), source })?;
    let mut walk = Walk::with_exits(network, &supply, &state, open.map(Cow::Borrowed));
    walk.run(&mut state, &mut |_| {
        if callbacks.is_stopped() { WalkControl::Stop } else { WalkControl::Continue }
    })?;
    walk.end(&state)?;
    Ok((Eroded::of(&state, case.pan_by_mass_only()), state.into_clogged()))
}

const FEW_NETWORKS: u64 = 5;

/// D85 (mm) above which a base gets a note.
const COARSE_BASE_MM: f64 = 10.0;

/// Note on a number of base particles, which may differ from Eq. (2) at some ratios.
fn of_amount(row: &Row) -> Option<Note> {
    match row.case.scene.base.amount() {
        Amount::Number(n) | Amount::MassRatio(_, Some(n)) => Some(Note::AmountHeld { particles: n }),
        Amount::MassRatio(_, None) => None,
    }
}

pub(super) struct Judged {
    /// Case with the sizes of filter and base at the ratio; without a unit, sizes are in units of D85B.
    pub(crate) case: Case,
    d85_mm: Option<f64>,
    pub(crate) base_name: String,
    /// Thickness of the real filter (mm), if the case has no size in mm to compare it with.
    real_thickness: Option<f64>,
}

impl Judged {
    pub(crate) fn new(row: &Row, ratio: f64) -> Result<Self, RunError> {
        let (has_size, d85) = (row.d85_mm.is_some(), row.d85_mm.unwrap_or(1.0));
        let mut stated = row.stated.clone();
        if !has_size {
            let factor = d85 / stated.base.gradation.d(85.0).unwrap_or(d85);
            let sizes = |gradation: &Gradation| gradation.scaled(factor).map_err(CaseError::from);
            let regraded_from = match &stated.base.regraded_from {
                Some((given, at)) => Some((sizes(given)?, at * factor)),
                None => None,
            };
            stated.base = CaseBase { gradation: sizes(&stated.base.gradation)?, regraded_from };
        }
        let mut case = row.case.enlarged(ratio * d85 / row.d15f(), &stated)?;
        if let Ok(walked) = row.at(ratio) {
            let CaseSupply { n_base, n_base_eq2, capped, .. } = walked.supply;
            case.network = walked.network;
            case.supply = CaseSupply { n_base, n_base_eq2, capped, ..case.supply };
        }
        let base_name = case.record().base.name;
        let mut real_thickness = None;
        if !has_size {
            real_thickness = case.scene.filter.thickness_mm.take();
            // If the size is unknown, neither soil has fines.
            (case.scene.filter.d0_mm, case.scene.base) = (Some(1.0), row.case.scene.base.clone());
        } else if let BaseGradation::Linear { d85: D85::AtDc(..) | D85::Ratio(_), .. } =
            case.scene.base.gradation()
        {
            // The filter's size decides the size of the base.
            let keys = &mut case.scene.base;
            (keys.d85_mm, keys.d85_at_dc, keys.dc_curve, keys.d15f_over_d85b) = (Some(d85), None, None, None);
        }
        let (base, filter) = (case.base.as_given(), &case.filter.gradation);
        case.mistake = Mistake::find(base, filter, case.is_scale_free()).map(|mistake| mistake.note);
        Ok(Self { case, d85_mm: row.d85_mm, base_name, real_thickness })
    }

    /// Notes on the model for a reader, including `others`.
    pub(crate) fn notes(&self, row: &Row, others: Vec<Note>) -> Vec<Note> {
        // Notes on the amount are given below for every ratio.
        let of_one = self.case.too_little_base().filter(|_| of_amount(row).is_some());
        let coarse =
            self.d85_mm.filter(|d85| *d85 > COARSE_BASE_MM).map(|d85_mm| Note::CoarseBase { d85_mm });
        let not_compared =
            self.real_thickness.map(|real_mm| Note::ThicknessWithoutUnit { real_mm, unit: "D85B".into() });
        let networks = row.case.scene.walk.replicates;
        let of_case = self.case.notes().into_iter();
        let notes = of_case.filter(|note| Some(note) != of_one.as_ref());
        let notes = notes
            .chain(self.case.unchecked_clogging())
            .chain(coarse)
            .chain(not_compared)
            .chain((networks < FEW_NETWORKS).then_some(Note::FewNetworks { networks }))
            .chain(of_amount(row))
            .chain(others);
        ordered(notes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{case_of, walk_case};

    const SMALL: [&str; 4] = ["network.nx=8", "network.ny=8", "network.nz=10", "base.n_base=30000"];

    #[test]
    fn what_erodes_is_to_the_bit_what_a_run_of_the_scene_says() {
        for base in ["base.cu=3", "base.single_mm=0.19"] {
            let case = case_of(&[&SMALL[..], &["replicates=1", "record.sensitivity=[]", base]].concat());
            let outcome = walk_case(&case, &Callbacks::default()).unwrap();
            let seed = replicate_seed(case.scene.walk.seed, 1);
            let network = Arc::new(case.network(seed).unwrap());
            let mut clogged = Clogged::none(&network);
            for run in &outcome.replicates[0].runs {
                let open = PlainExits::unblocked(&network);
                let known = (&network, (base != "base.cu=3").then_some(&open));
                let result = eroded(&case, known, (seed, run.run), clogged, &Callbacks::default()).unwrap();
                assert_eq!(result.0.mass_fraction.to_bits(), run.eroded_mass_fraction.to_bits(), "{base}");
                assert!(run.eroded_mass_fraction > 0.0);
                clogged = result.1;
            }
        }
    }

    /// Moves depend on more than the network if particles arch or leave openings.
    #[test]
    fn known_exits_are_left_alone_where_others_are_needed() {
        for (other, engines) in [
            ("walk.arching=zuriguel-2005", ["engine=counts", "engine=expected"]),
            ("walk.blocked=open", ["engine=auto", "engine=particles"]),
        ] {
            for engine in engines {
                let case = case_of(&[&SMALL[..], &[other, engine]].concat());
                assert!(!case.begins_with_plain_exits());
                let network = Arc::new(case.network(5).unwrap());
                let known = PlainExits::unblocked(&network);
                let [a, b] = [None, Some(&known)].map(|open| {
                    let clogged = Clogged::none(&network);
                    eroded(&case, (&network, open), (5, 1), clogged, &Callbacks::default()).unwrap()
                });
                assert_eq!(a.0.mass_fraction.to_bits(), b.0.mass_fraction.to_bits(), "{other} {engine}");
                assert_eq!(a.1.blocked, b.1.blocked, "{other} {engine}");
            }
        }
    }
}
