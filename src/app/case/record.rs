//! Inputs as recorded in a run folder, and positions of voids.

use super::{Case, CaseFilter, CaseNetwork, Input, RECORD};
use crate::outcome::record;
use crate::outcome::recorder::Places;
use crate::scene::{BaseGradation, CurveSource, FilterGradation, NetworkSource};
use voidwalk_core::constrictions::ShippedFilter;
use voidwalk_core::gradation::{CurvePoint, Gradation};
use voidwalk_core::network::{ExitRule, FLOW_TOLERANCE, flow_error_pp};
use voidwalk_practice::{AboutPage, InputFile};

/// Kinematic viscosity of water at 10 C (m2/s).
const KINEMATIC_VISCOSITY: f64 = 1.307e-6;
/// Gravity (m/s2).
const GRAVITY: f64 = 9.81;

impl Case {
    pub(crate) fn about_page(&self) -> AboutPage {
        self.scene.about.page(self.is_scale_free())
    }

    /// Files that were read, with checksums.
    pub(crate) fn input_files(&self) -> Vec<InputFile> {
        self.inputs.iter().map(Input::file).collect()
    }

    /// Record of the filter's packing, if it was packed.
    pub fn packing_record(&self) -> Option<&Input> {
        self.inputs.iter().find(|input| input.kept_as.ends_with(RECORD))
    }

    /// Name given by the user to the file of a setting.
    fn name_of(&self, setting: &str) -> String {
        let input = self.inputs.iter().find(|input| input.setting == setting);
        input.map_or(String::new(), |input| input.name.clone())
    }

    /// Name given by the user to each file, by its name in the folder of inputs.
    pub(crate) fn input_names(&self) -> std::collections::BTreeMap<String, String> {
        let kept = |input: &Input| input.kept_as.rsplit('/').next().unwrap_or_default().to_owned();
        self.inputs.iter().map(|input| (kept(input), input.name.clone())).collect()
    }

    /// Inputs as recorded in a run folder.
    pub(crate) fn record(&self) -> record::Inputs {
        let base_name = match &self.scene.base.gradation() {
            BaseGradation::Sieve(..) => self.name_of("base.sieve"),
            BaseGradation::Single(_) => "one size".into(),
            BaseGradation::Linear { cu, .. } => format!("linear, Cu {cu}"),
        };
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
                ..base_record(base_name, &self.base.gradation)
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
        let shape = self.scene.network.source().shape();
        let [nx, ny, nz] = shape.map_or([None; 3], |shape| shape.map(|n| Some(u64::from(n))));
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

    /// Kind of the network, and its description.
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

    /// Summary of the network, if its constrictions have no direction. `k0_mm2` is the permeability of
    /// the clean filter, if known.
    pub(crate) fn network_summary(&self, k0_mm2: Option<f64>) -> Option<record::NetworkSummary> {
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
    pub(crate) fn thickness(&self) -> Option<f64> {
        match &self.network.fixed {
            Some(fixed) => Some(fixed.packing.as_ref()?.thickness_mm),
            None => {
                let d50 = self.filter.gradation.d_by_number(50.0).unwrap_or(f64::NAN);
                Some(self.network.layers as f64 * d50)
            }
        }
    }

    /// True for a sieve curve of the filter, false for an assumed straight line.
    pub(crate) fn filter_is_measured(&self) -> bool {
        matches!(self.scene.filter.gradation(), FilterGradation::Sieve(..))
    }

    /// Source of the constrictions.
    pub(crate) fn curve_origin(&self) -> record::CurveOrigin {
        match (&self.filter.library, self.filter.guessed_density) {
            _ if self.filter.packed.is_some() => record::CurveOrigin::Packed,
            (Some(_), _) => record::CurveOrigin::Library,
            (None, Some(_)) => record::CurveOrigin::Guessed,
            (None, None) => record::CurveOrigin::Given,
        }
    }

    /// Shipped filter whose constrictions and voids are walked, if any.
    pub(super) fn shipped_curve(&self) -> Option<&'static ShippedFilter> {
        self.filter.shipped.filter(|_| self.network.fixed.is_none())
    }

    /// True if lengths are in units of the smallest filter grain: a scale-free curve with d0_mm = 1.
    pub fn is_scale_free(&self) -> bool {
        self.network.fixed.is_none() && self.filter.is_scale_free(&self.scene)
    }

    /// Positions of the voids of its network; `None` for a network from a file, which has no positions,
    /// and for a packing that does not exist yet.
    pub(crate) fn places(&self) -> Option<Places> {
        if let Some([nx, ny, nz]) = self.scene.network.source().shape() {
            let layer_mm = self.filter.gradation.d_by_number(50.0).unwrap_or(self.filter.unit_mm);
            let middle = |at: u32| (f64::from(at) + 0.5) * layer_mm;
            let row = |z: u32, y: u32| (0..nx).map(move |x| [middle(x), middle(y), middle(z)]);
            return Some(Places {
                point_mm: (0..nz).flat_map(|z| (0..ny).flat_map(move |y| row(z, y))).collect(),
                period_mm: [nx, ny].map(|n| f64::from(n) * layer_mm),
                layer_mm,
            });
        }
        let packing = self.network.packing()?;
        let graph = &packing.graph.graph;
        let [x_mm, y_mm, z_mm] = graph.cell_mm;
        let lifted = |copy: u32| {
            let by = f64::from(copy) * z_mm;
            graph.point_mm.iter().map(move |&[x, y, z]| [x, y, z + by])
        };
        Some(Places {
            point_mm: (0..packing.copies).flat_map(lifted).collect(),
            period_mm: [x_mm, y_mm],
            layer_mm: graph.spacing_mm(),
        })
    }
}

/// Base as recorded in results.
pub(crate) fn base_record(name: String, base: &Gradation) -> record::BaseRecord {
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

/// Size at a percent finer (mm), if the gradation reaches it.
fn d(gradation: &Gradation, percent: f64) -> f64 {
    gradation.d(percent).unwrap_or(f64::NAN)
}

fn rows(points: Vec<CurvePoint>) -> Vec<[f64; 2]> {
    points.into_iter().map(CurvePoint::row).collect()
}

/// Coefficient of uniformity without the last digits left by rounding.
fn rounded(cu: Option<f64>) -> f64 {
    cu.map_or(f64::NAN, |cu| (cu * 1e6).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the layers in the network and with its constrictions, which lead to neighbours.
    #[test]
    fn the_voids_of_a_lattice_lie_in_their_layers_beside_their_neighbours() {
        let case = Case::built_in(&["network.nx=3", "network.ny=4", "network.nz=5"]).unwrap();
        let (network, places) = (case.network(1).unwrap(), case.places().unwrap());
        assert_eq!(places.point_mm.len(), network.voids());
        for void in 0..network.voids() {
            let [x, y, z] = places.point_mm[void];
            assert_eq!((z / places.layer_mm) as u32, network.layer_of()[void]);
            for c in network.exits(void as u32) {
                let Some(&[other_x, other_y, other_z]) = places.point_mm.get(network.targets()[c] as usize)
                else {
                    continue;
                };
                let across = |from: f64, to: f64, period: f64| {
                    let by = to - from;
                    by - period * (by / period).round()
                };
                let by = [
                    across(x, other_x, places.period_mm[0]),
                    across(y, other_y, places.period_mm[1]),
                    other_z - z,
                ];
                let steps: f64 = by.iter().sum::<f64>() / places.layer_mm;
                assert!((steps - 1.0).abs() < 1e-9, "{by:?}");
            }
        }
    }
}
