//! One density and thickness, ready to be walked at any ratio.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::options::Thickness;
use super::search::{Begun, Found, Hint, Start, Trial, USUAL_ACROSS, Walker, holding, search};
use crate::case::{Case, CaseError, OtherCurve, ResourceLimits, StatedBase, replicate_seed};
use crate::outcome::boundary::Beyond;
use crate::outcome::verdict::THRESHOLD;
use crate::run::callbacks::Callbacks;
use crate::run::erosion::eroded;
use crate::run::error::RunError;
use crate::scene::{Amount, LibraryDensity};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{Network, Passage};
use voidwalk_core::walk::{Clogged, PlainExits};
use voidwalk_practice::Note;

/// Ratio at which a first guess takes the layers of a thickness in mm.
const USUAL_RATIO: f64 = 5.0;

/// One density and thickness with its filter packed.
#[derive(Clone)]
pub(super) struct Row {
    /// The density in words.
    pub density: String,
    /// The thickness.
    pub thickness: Thickness,
    /// The filter and its network, with some base.
    pub case: Case,
    /// The base as it is stated.
    pub stated: StatedBase,
    /// The base in units of its D85.
    pub base: Gradation,
    /// D85B (mm), if the base has a size of its own.
    pub d85_mm: Option<f64>,
    /// True if the filter has a size of its own.
    pub filter_has_size: bool,
    /// Limits of the walks.
    pub limits: ResourceLimits,
    /// The density whose constriction curve is known only within a range with this row as an end.
    pub end_of: Option<String>,
    /// The densities of the ends of its own range.
    pub ends: Vec<String>,
}

impl Row {
    /// This row at the ends of the range in which the constriction curve is known.
    pub fn at_curve_ends(&self) -> Vec<Self> {
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
    pub fn d15f(&self) -> f64 {
        self.case.filter.gradation.d(15.0).unwrap_or(f64::NAN)
    }

    /// Number of networks that are searched: 0 with an unknown density, whose ends are searched instead.
    pub fn networks(&self) -> u64 {
        let is_unknown = self.case.scene.filter.library == Some(LibraryDensity::Unknown);
        let is_between_ends = is_unknown && self.end_of.is_none() && !self.ends.is_empty();
        if is_between_ends { 0 } else { self.case.scene.walk.replicates }
    }

    /// Size of the filter at a ratio as a multiple of its size in the case, if the base has a size.
    pub fn factor(&self, ratio: f64) -> Option<f64> {
        Some(ratio * self.d85_mm? / self.d15f())
    }

    /// Layers at a ratio, if they depend on it.
    pub fn layers(&self, ratio: f64) -> Option<u64> {
        let (mm, layer) = self.thickness_and_layer(ratio)?;
        Some((mm / layer).round().clamp(1.0, f64::from(u32::MAX)) as u64)
    }

    /// The thickness that was asked for and the thickness of one layer (mm), if the layers depend on the
    /// ratio.
    fn thickness_and_layer(&self, ratio: f64) -> Option<(f64, f64)> {
        let Thickness::Mm(mm) = self.thickness else { return None };
        let layer = self.case.filter.gradation.d_by_number(50.0).unwrap_or(self.case.filter.unit_mm);
        Some((mm, layer * self.factor(ratio)?))
    }

    /// Thickness (mm) of the one layer that is walked at a ratio if less than half of one was asked for.
    pub fn thicker_than_asked(&self, ratio: f64) -> Option<f64> {
        let (mm, layer) = self.thickness_and_layer(ratio)?;
        ((mm / layer).round() < 1.0).then_some(layer)
    }

    /// Note on a layer that is thicker than the thickness asked for.
    pub fn thicker(&self, ratio: f64) -> Option<Note> {
        let layer_mm = self.thicker_than_asked(ratio)?;
        Some(Note::LayerThicker { ratio, layer_mm, thickness: self.thickness.to_string() })
    }

    /// The case at a ratio.
    ///
    /// # Errors
    /// It cannot be walked.
    pub fn at(&self, ratio: f64) -> Result<Case, CaseError> {
        let base = self.base.scaled(self.d15f() / ratio)?;
        let mut case = self.case.with_base(base, self.layers(ratio))?;
        case.place(&self.limits, rayon::current_num_threads() as u64, std::path::Path::new("."))?;
        Ok(case)
    }

    /// Refuses more layers, or more memory, than there is, at a ratio near which the search begins.
    ///
    /// # Errors
    /// The number that is too large.
    pub fn check_room(&self, bracket: [f64; 2]) -> Result<(), RunError> {
        let ratio = self.start().clamp(bracket[0], bracket[1]);
        match self.at(ratio) {
            Err(error) if !is_of_base(&error) => Err(RunError::Refused(format!(
                "{}, {}, at D15F/D85B {ratio:.2}: {error}",
                self.density, self.thickness
            ))),
            _ => Ok(()),
        }
    }

    /// Side of the search of a ratio that cannot be walked.
    fn side(&self, ratio: f64) -> Beyond {
        let too_few = || -> Option<bool> {
            let Amount::MassRatio(mass_ratio, _) = self.case.scene.base.amount() else { return None };
            let base = self.base.scaled(self.d15f() / ratio).ok()?;
            let per_grain =
                base.particles_per_unit_volume() / self.case.filter.gradation.particles_per_unit_volume();
            Some(
                mass_ratio * self.case.filter.grains_per_void? * self.case.network.voids as f64 * per_grain
                    < 1.0,
            )
        };
        if too_few() == Some(true) { Beyond::Below } else { Beyond::Above }
    }

    /// Boundary of a lone particle of one size, by the closed form: a start for the search.
    pub fn start(&self) -> f64 {
        let layers = self.layers(USUAL_RATIO).unwrap_or(self.case.network.layers).max(1);
        self.d15f() / Passage::new(&self.case.filter.curve).coarsest_through(layers, 1.0 - THRESHOLD)
    }

    /// Start nodes, which decide the number of ratios to try: more if walks are quick. The number of the
    /// usual lattice if water flows, or for a network that is not a lattice.
    pub fn across(&self) -> u64 {
        if self.case.scene.is_lattice_by_area() { self.case.network.start_nodes } else { USUAL_ACROSS }
    }

    /// Searches the boundaries of network `number`, counted from 1.
    ///
    /// # Errors
    /// A walk that goes wrong, or was stopped.
    pub fn search(
        &self,
        number: u64,
        (bracket, hint): ([f64; 2], Hint),
        callbacks: &Callbacks,
    ) -> Result<Found, RunError> {
        search(self.network(number, callbacks), bracket, self.from(hint))
    }

    /// Searches the boundary of the first run of network `number`, counted from 1.
    ///
    /// # Errors
    /// A walk that goes wrong, or was stopped.
    pub fn begun<'a>(
        &'a self,
        number: u64,
        (bracket, hint): ([f64; 2], Hint),
        callbacks: &'a Callbacks<'a>,
    ) -> Result<Begun<OneNetwork<'a>>, RunError> {
        Begun::new(self.network(number, callbacks), bracket, self.from(hint))
    }

    /// The first network, if it holds this ratio.
    ///
    /// # Errors
    /// A walk that goes wrong, or was stopped.
    pub fn holding(
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

    fn from(&self, hint: Hint) -> Start {
        Start { ratio: self.start(), hint, across: self.across() }
    }
}

/// True if the base itself cannot be walked: Eq. (2) gives too few particles or too many, or sizes are out of
/// range.
fn is_of_base(error: &CaseError) -> bool {
    matches!(error, CaseError::Scene(_) | CaseError::Gradation(_) | CaseError::Number(_))
}

/// One network, walked at one ratio after another.
pub(super) struct OneNetwork<'a> {
    row: &'a Row,
    seed: u64,
    /// The network that was walked last, and its exits.
    network: Option<(Arc<Network>, PlainExits)>,
    /// Constrictions after the first run, by step.
    clogged: BTreeMap<i64, Clogged>,
    callbacks: &'a Callbacks<'a>,
}

impl OneNetwork<'_> {
    /// Run `run` at a ratio.
    fn walk(&mut self, run: u64, step: i64, ratio: f64) -> Result<Trial, RunError> {
        let case = match self.row.at(ratio) {
            Ok(case) => case,
            Err(error) if is_of_base(&error) => {
                return Ok(Trial::CannotBe(self.row.side(ratio), error.to_string()));
            }
            // A limit of this machine says nothing about the filter.
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

impl Walker for OneNetwork<'_> {
    fn first(&mut self, step: i64, ratio: f64) -> Result<Trial, RunError> {
        self.walk(1, step, ratio)
    }

    fn second(&mut self, step: i64, ratio: f64) -> Result<Trial, RunError> {
        self.walk(2, step, ratio)
    }
}
