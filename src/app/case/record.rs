//! Inputs, as a run folder records them.

use super::{Case, CaseFilter, CaseNetwork, Input, RECORD};
use crate::outcome::record;
use crate::scene::{BaseGradation, CurveSource, FilterGradation, NetworkSource};
use voidwalk_core::constrictions::ShippedFilter;
use voidwalk_core::gradation::{CurvePoint, Gradation};
use voidwalk_core::network::{ExitRule, FLOW_TOLERANCE, flow_error_pp};
use voidwalk_practice::{AboutPage, InputFile};

impl Case {
    /// The page of its run.
    pub fn about_page(&self) -> AboutPage {
        self.scene.about.page(self.is_scale_free())
    }

    /// Files that were read, with their checksums.
    pub fn input_files(&self) -> Vec<InputFile> {
        self.inputs.iter().map(Input::file).collect()
    }

    /// The record of the filter's packing, if it was packed.
    pub fn packing_record(&self) -> Option<&Input> {
        self.inputs.iter().find(|input| input.kept_as.ends_with(RECORD))
    }

    /// The user's name for the file of a setting.
    fn name_of(&self, setting: &str) -> String {
        self.inputs
            .iter()
            .find(|input| input.setting == setting)
            .map_or(String::new(), |input| input.name.clone())
    }

    /// The user's name for each file, by its name in the folder of inputs.
    pub fn input_names(&self) -> std::collections::BTreeMap<String, String> {
        let kept = |input: &Input| input.kept_as.rsplit('/').next().unwrap_or_default().to_owned();
        self.inputs.iter().map(|input| (kept(input), input.name.clone())).collect()
    }

    /// Inputs, as a run folder records them.
    pub fn record(&self) -> record::Inputs {
        record::Inputs {
            filter: self.filter_record(),
            base: record::BaseRecord {
                regraded_at_mm: self.base.regraded_from.as_ref().map(|(_, at)| *at),
                as_sampled: self.base.regraded_from.as_ref().map(|(given, _)| record::SampledBase {
                    d85_mm: given.d(85.0),
                    d95_mm: given.d(95.0),
                    d100_mm: given.largest_mm(),
                    gradation: rows(given.points()),
                }),
                ..base_record(self.base_name(), &self.base.gradation)
            },
            network: self.network_record(),
            mass_ratio: self.supply.mass_ratio,
            inject_share: self.scene.walk.inject_share,
            scale_free: self.is_scale_free(),
        }
    }

    fn filter_record(&self) -> record::FilterRecord {
        let CaseFilter { gradation, curve, unit_mm, .. } = &self.filter;
        record::FilterRecord {
            name: match &self.scene.filter.gradation() {
                FilterGradation::Sieve(..) => self.name_of("filter.sieve"),
                FilterGradation::Linear { .. } => format!("linear, Cu {}", rounded(gradation.cu())),
            },
            attribution: self
                .shipped_curve()
                .map_or(String::new(), |shipped| format!("{} ({})", shipped.attribution, shipped.licence)),
            cu: gradation.cu(),
            d0_mm: *unit_mm,
            d15_mm: d(gradation, 15.0),
            d50_mm: d(gradation, 50.0),
            d50_by_number_mm: gradation.d_by_number(50.0).unwrap_or(f64::NAN),
            d85_mm: d(gradation, 85.0),
            void_ratio: self.void_ratio(),
            gradation: rows(gradation.points()),
            constrictions: rows(curve.points()),
            cu_csd: curve.cu(),
            curve_name: self.curve_name(),
        }
    }

    /// Volume of the voids of the filter over the volume of its grains, if known.
    fn void_ratio(&self) -> Option<f64> {
        match (&self.filter.packed, &self.filter.library) {
            (Some(packed), _) => packed.void_ratio,
            (None, Some(library)) => library.part.is_none().then_some(library.found.void_ratio),
            (None, None) => self.shipped_curve().map(|shipped| shipped.void_ratio),
        }
    }

    /// Name or description of the constriction curve.
    fn curve_name(&self) -> String {
        let filter = &self.filter;
        match (&self.network.fixed, &self.scene.filter.curve) {
            (None, None) if filter.packed.as_ref().is_some_and(|packed| packed.files.is_none()) => {
                "a guess, until the filter is packed".into()
            }
            (None, None) if filter.packed.is_some() => "measured on its packing".into(),
            (None, None) if filter.library.is_some() => "from the library of packings".into(),
            (None, None) if filter.guessed_density.is_some() => {
                "guessed from the gradation by inscribed circles".into()
            }
            (Some(_), _) | (None, None) => "the network's own constrictions".into(),
            (None, Some(CurveSource::Shipped(name))) => name.clone(),
            (None, Some(CurveSource::File(_))) => self.name_of("filter.curve"),
        }
    }

    fn network_record(&self) -> record::NetworkRecord {
        let (kind, name) = self.network_name();
        let [nx, ny, nz] = match self.scene.network.source().shape() {
            Some(shape) => shape.map(|n| Some(u64::from(n))),
            None => [None; 3],
        };
        let CaseNetwork { voids, constrictions, start_nodes, layers, .. } = self.network;
        record::NetworkRecord {
            kind,
            name,
            nx,
            ny,
            nz,
            voids,
            constrictions,
            start_nodes,
            layers,
            connectivity: self.network.connectivity.clone(),
            thickness_mm: self.thickness(),
            copies: self.network.copies().map(u64::from),
        }
    }

    /// Kind of the network, with a description in words.
    fn network_name(&self) -> (record::NetworkKind, String) {
        let cubic = |n: &[u32; 3]| format!("cubic {} x {} x {}", n[0], n[1], n[2]);
        match &self.scene.network.source() {
            NetworkSource::Cubic(n) => (record::NetworkKind::Cubic, cubic(n)),
            NetworkSource::Connected(n, wanted) => {
                let shares: Vec<String> =
                    wanted.percent().iter().map(|(k, share)| format!("{k}: {share:.1} %")).collect();
                let name = format!("{} with connectivity {}", cubic(n), shares.join(", "));
                (record::NetworkKind::Connected, name)
            }
            NetworkSource::File(_) => (record::NetworkKind::File, self.name_of("network.file")),
            NetworkSource::Graph(..) => {
                let copies = self.network.copies().unwrap_or(1);
                let times = if copies == 1 { String::new() } else { format!(", {copies} times") };
                let grains = match self.name_of("network.packing") {
                    none if none.is_empty() => "the filter's packing".into(),
                    name => name,
                };
                (record::NetworkKind::Graph, format!("the voids of {grains}{times}"))
            }
        }
    }

    /// Name or description of the base.
    fn base_name(&self) -> String {
        match &self.scene.base.gradation() {
            BaseGradation::Sieve(..) => self.name_of("base.sieve"),
            BaseGradation::Single(_) => "one size".into(),
            BaseGradation::Linear { cu, .. } => format!("linear, Cu {cu}"),
        }
    }

    /// The network that was walked, if its constrictions have no direction of their own. `k0_mm2` is the
    /// permeability of the clean filter, if known.
    pub fn network_summary(&self, k0_mm2: Option<f64>) -> Option<record::NetworkSummary> {
        let rule = self.scene.exit_rule();
        if rule == ExitRule::Area {
            return None;
        }
        let CaseNetwork { voids, constrictions, start_nodes: inlets, layers, .. } = self.network;
        let tolerance = self.scene.exits.flow_tolerance.unwrap_or(FLOW_TOLERANCE);
        let flow_tolerance = rule.needs_flow().then_some(tolerance);
        let is_measured =
            rule == ExitRule::Flux && self.scene.law().is_none() && !self.scene.leaves_openings();
        let k0_m2 = k0_mm2.filter(|_| !self.is_scale_free()).map(|k| k * 1e-6);
        Some(record::NetworkSummary {
            kind: match &self.network.fixed {
                Some(fixed) if fixed.packing.is_some() => "graph",
                Some(_) => "file",
                None => "lattice",
            }
            .into(),
            exit: rule.name().into(),
            voids,
            constrictions,
            inlets,
            copies: self.network.copies().map(u64::from),
            layers,
            thickness_mm: self.thickness(),
            k0_m2,
            k0_m_per_s: k0_m2.map(|k| k * GRAVITY / KINEMATIC_VISCOSITY),
            flow_tolerance,
            flow_error_pp: flow_tolerance.filter(|_| is_measured).and_then(flow_error_pp),
        })
    }

    /// Modelled filter thickness: layers times D50F by number, or copies of a packing; `None` if a layer has
    /// no thickness.
    pub fn thickness(&self) -> Option<f64> {
        match &self.network.fixed {
            Some(fixed) => Some(fixed.packing.as_ref()?.thickness_mm),
            None => {
                let d50 = self.filter.gradation.d_by_number(50.0).unwrap_or(f64::NAN);
                Some(self.network.layers as f64 * d50)
            }
        }
    }

    /// True if the filter's gradation is a sieve curve, not a straight line.
    pub fn filter_is_measured(&self) -> bool {
        matches!(self.scene.filter.gradation(), FilterGradation::Sieve(..))
    }

    /// Source of the constrictions.
    pub fn curve_origin(&self) -> record::CurveOrigin {
        match (&self.filter.library, self.filter.guessed_density) {
            _ if self.filter.packed.is_some() => record::CurveOrigin::Packed,
            (Some(_), _) => record::CurveOrigin::Library,
            (None, Some(_)) => record::CurveOrigin::Guessed,
            (None, None) => record::CurveOrigin::Given,
        }
    }

    /// The shipped filter whose constrictions and voids are walked, if they are one's.
    pub(super) fn shipped_curve(&self) -> Option<&'static ShippedFilter> {
        self.filter.shipped.filter(|_| self.network.fixed.is_none())
    }

    /// True if lengths are in units of the smallest filter grain: a scale-free curve with d0_mm = 1.
    pub fn is_scale_free(&self) -> bool {
        self.network.fixed.is_none() && self.filter.is_scale_free(&self.scene)
    }
}

/// A base, as records of results hold it.
pub fn base_record(name: String, base: &Gradation) -> record::BaseRecord {
    record::BaseRecord {
        name,
        cu: base.cu(),
        d0_mm: base.smallest_mm(),
        d15_mm: base.d(15.0),
        d50_mm: base.d(50.0),
        d85_mm: d(base, 85.0),
        d95_mm: d(base, 95.0),
        d100_mm: base.largest_mm(),
        tail_mass_fraction: base.pan_fraction(),
        regraded_at_mm: None,
        as_sampled: None,
        gradation: rows(base.points()),
    }
}

/// A characteristic size (mm), if the gradation reaches down to it.
fn d(gradation: &Gradation, percent: f64) -> f64 {
    gradation.d(percent).unwrap_or(f64::NAN)
}

fn rows(points: Vec<CurvePoint>) -> Vec<[f64; 2]> {
    points.into_iter().map(CurvePoint::row).collect()
}

/// Kinematic viscosity of water of 10 C (m2/s).
const KINEMATIC_VISCOSITY: f64 = 1.307e-6;

/// Gravity (m/s2).
const GRAVITY: f64 = 9.81;

/// A coefficient of uniformity without the digits that rounding left.
fn rounded(cu: Option<f64>) -> f64 {
    cu.map_or(f64::NAN, |cu| (cu * 1e6).round() / 1e6)
}
