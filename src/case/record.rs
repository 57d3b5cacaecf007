//! What went in, as a run folder records it.

use super::{Case, Input};
use crate::gradation::{CurvePoint, Gradation};
use crate::network::ExitRule;
use crate::outcome::quantity::significant;
use crate::outcome::record::{self, InputFile};
use crate::scene::{BaseGradation, CurveSource, D85, FilterGradation, NetworkSource};

impl Case {
    /// Files that were read, with their checksums.
    pub fn input_files(&self) -> Vec<InputFile> {
        self.inputs.iter().map(Input::file).collect()
    }

    /// What the user called the file of a setting.
    fn name_of(&self, setting: &str) -> String {
        self.inputs
            .iter()
            .find(|input| input.setting == setting)
            .map_or(String::new(), |input| input.name.clone())
    }

    /// What the user called each file, by its name in the folder of inputs.
    pub fn input_names(&self) -> std::collections::BTreeMap<String, String> {
        let kept = |input: &Input| input.kept_as.rsplit('/').next().unwrap_or_default().to_owned();
        self.inputs.iter().map(|input| (kept(input), input.name.clone())).collect()
    }

    /// What went in, as a run folder records it.
    pub fn record(&self) -> record::Inputs {
        let [voids, constrictions, start_nodes, layers] = self.counts;
        let cubic = |n: &[u32; 3]| format!("cubic {} x {} x {}", n[0], n[1], n[2]);
        let (kind, name) = match &self.scene.network.source() {
            NetworkSource::Cubic(n) => (record::NetworkKind::Cubic, cubic(n)),
            NetworkSource::Connected(n, wanted) => {
                let shares: Vec<String> =
                    wanted.percent().iter().map(|(k, share)| format!("{k}: {share:.1} %")).collect();
                let name = format!("{} with connectivity {}", cubic(n), shares.join(", "));
                (record::NetworkKind::Connected, name)
            }
            NetworkSource::File(_) => (record::NetworkKind::File, self.name_of("network.file")),
            NetworkSource::Graph(..) => {
                let copies = self.copies.map_or(1, |(copies, _)| copies);
                let times = if copies == 1 { String::new() } else { format!(", {copies} times") };
                let grains = match self.name_of("network.packing") {
                    none if none.is_empty() => "the filter's packing".into(),
                    name => name,
                };
                (record::NetworkKind::Graph, format!("the voids of {grains}{times}"))
            }
        };
        let shape = match self.scene.network.source().shape() {
            Some(shape) => shape.map(|n| Some(u64::from(n))),
            None => [None; 3],
        };
        let curve_name = match (&self.fixed_network, &self.scene.filter.curve) {
            (None, None) if self.packed.as_ref().is_some_and(|packed| packed.files.is_none()) => {
                "a guess, until the filter is packed".to_string()
            }
            (None, None) if self.packed.is_some() => "measured on its packing".to_string(),
            (None, None) if self.library.is_some() => "from the library of packings".to_string(),
            (None, None) if self.guessed_density.is_some() => {
                "guessed from the gradation by inscribed circles".to_string()
            }
            (Some(_), _) | (None, None) => "the network's own constrictions".to_string(),
            (None, Some(CurveSource::Shipped(name))) => name.clone(),
            (None, Some(CurveSource::File(_))) => self.name_of("filter.curve"),
        };
        record::Inputs {
            filter: record::FilterRecord {
                name: match &self.scene.filter.gradation() {
                    FilterGradation::Sieve(..) => self.name_of("filter.sieve"),
                    FilterGradation::Linear { .. } => {
                        format!("linear, Cu {}", rounded(self.filter.cu()))
                    }
                },
                attribution: match (&self.fixed_network, self.shipped) {
                    (None, Some(shipped)) => format!("{} ({})", shipped.attribution, shipped.licence),
                    _ => String::new(),
                },
                cu: self.filter.cu(),
                d0_mm: self.unit_mm,
                d15_mm: d(&self.filter, 15.0),
                d50_mm: d(&self.filter, 50.0),
                d50_by_number_mm: self.filter.d_by_number(50.0).unwrap_or(f64::NAN),
                d85_mm: d(&self.filter, 85.0),
                void_ratio: self.void_ratio(),
                gradation: rows(self.filter.points()),
                constrictions: rows(self.curve.points()),
                cu_csd: self.curve.cu(),
                curve_name,
            },
            base: record::BaseRecord {
                regraded_at_mm: self.regraded_from.as_ref().map(|(_, at)| *at),
                as_sampled: self.regraded_from.as_ref().map(|(given, _)| record::SampledBase {
                    d85_mm: given.d(85.0),
                    d95_mm: given.d(95.0),
                    d100_mm: given.largest_mm(),
                    gradation: rows(given.points()),
                }),
                ..base_record(self.base_name(), &self.base)
            },
            network: record::NetworkRecord {
                kind,
                name,
                nx: shape[0],
                ny: shape[1],
                nz: shape[2],
                voids,
                constrictions,
                start_nodes,
                layers,
                connectivity: self.connectivity.clone(),
                thickness_mm: self.thickness(),
                copies: self.copies.map(|(copies, _)| u64::from(copies)),
            },
            mass_ratio: self.mass_ratio,
            inject_share: self.scene.walk.inject_share,
            scale_free: self.is_scale_free(),
        }
    }

    /// What the user called the base, or what it is.
    fn base_name(&self) -> String {
        let name = match &self.scene.base.gradation() {
            BaseGradation::Sieve(..) => self.name_of("base.sieve"),
            BaseGradation::Single(_) => "one size".into(),
            BaseGradation::Linear { cu, .. } => format!("linear, Cu {cu}"),
        };
        let regraded = self.regraded_from.as_ref();
        name + &regraded.map_or(String::new(), |(_, at)| format!(", regraded on {} mm", significant(*at)))
    }

    /// The network that was walked, where its constrictions have no direction of their own.
    /// `k0_mm2` is the permeability of the clean filter, where it is known.
    pub fn network_summary(&self, k0_mm2: Option<f64>) -> Option<record::NetworkSummary> {
        let rule = self.scene.exit_rule();
        if rule == ExitRule::Area {
            return None;
        }
        let [voids, constrictions, inlets, layers] = self.counts;
        let k0_m2 = k0_mm2.filter(|_| !self.is_scale_free()).map(|k| k * 1e-6);
        Some(record::NetworkSummary {
            kind: match (self.copies, &self.fixed_network) {
                (Some(_), _) => "graph",
                (None, Some(_)) => "file",
                (None, None) => "lattice",
            }
            .into(),
            exit: rule.name().into(),
            voids,
            constrictions,
            inlets,
            copies: self.copies.map(|(copies, _)| u64::from(copies)),
            layers,
            thickness_mm: self.thickness(),
            k0_m2,
            k0_m_per_s: k0_m2.map(|k| k * GRAVITY / KINEMATIC_VISCOSITY),
        })
    }

    /// Modelled filter thickness: layers times D50F by number, or copies of a packing; `None` where a layer
    /// has no thickness.
    pub fn thickness(&self) -> Option<f64> {
        let d50 = self.filter.d_by_number(50.0).unwrap_or(f64::NAN);
        match (self.copies, &self.fixed_network) {
            (Some((_, thickness_mm)), _) => Some(thickness_mm),
            (None, Some(_)) => None,
            (None, None) => Some(self.counts[3] as f64 * d50),
        }
    }

    /// Whether the filter's gradation is a sieve curve, and not a straight line.
    pub fn filter_is_measured(&self) -> bool {
        matches!(self.scene.filter.gradation(), FilterGradation::Sieve(..))
    }

    /// Where the constrictions come from.
    pub fn curve_origin(&self) -> record::CurveOrigin {
        match (&self.library, self.guessed_density) {
            _ if self.packed.is_some() => record::CurveOrigin::Packed,
            (Some(_), _) => record::CurveOrigin::Library,
            (None, Some(_)) => record::CurveOrigin::Guessed,
            (None, None) => record::CurveOrigin::Given,
        }
    }

    /// Whether the curve is from the library, or a guess.
    fn is_without_packing(&self) -> bool {
        self.library.is_some() || self.guessed_density.is_some()
    }

    /// Whether lengths are in units of the smallest filter grain: a scale-free curve with d0_mm = 1.
    pub fn is_scale_free(&self) -> bool {
        matches!(self.scene.filter.gradation(), FilterGradation::Linear { d0_mm, .. } if d0_mm == 1.0)
            && (self.shipped.is_some() || self.packed.is_some() || self.is_without_packing())
            && self.fixed_network.is_none()
            && matches!(
                self.scene.base.gradation(),
                BaseGradation::Linear { d85: D85::AtDc(..) | D85::Ratio(_), .. } | BaseGradation::Single(_)
            )
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

/// A characteristic size (mm), where the gradation reaches down to it.
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
