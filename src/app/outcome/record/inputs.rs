//! Inputs of a run, as recorded in `outcome.json`.

use serde::{Deserialize, Serialize};

/// Inputs of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Inputs {
    /// The filter and its constrictions.
    pub filter: FilterRecord,
    /// The base soil.
    pub base: BaseRecord,
    /// The void network.
    pub network: NetworkRecord,
    /// Mass of base over mass of filter, `F_base` of Eq. (2).
    pub mass_ratio: Option<f64>,
    /// Fraction of `n_base` inserted in each increment.
    pub inject_share: f64,
    /// True if sizes are multiples of D0F instead of mm.
    pub scale_free: bool,
}

/// Origin of a filter's constrictions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum CurveOrigin {
    /// Library of packings.
    Library,
    /// Measurement of a packing of this filter.
    Packed,
    /// Given curve, network or packing.
    Given,
    /// Estimate from the gradation alone.
    Guessed,
}

/// Properties of a filter's constrictions other than their sizes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ConstrictionsRecord {
    /// Origin of the constrictions.
    pub origin: CurveOrigin,
}

/// Filter: its gradation by mass and its constrictions by number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct FilterRecord {
    /// Name given by the user.
    pub name: String,
    /// Credit for the constriction curve; empty for the user's own.
    pub attribution: String,
    /// D60 / D10 by mass; `None` if D10 lies in the pan fraction (finer than the finest sieve).
    pub cu: Option<f64>,
    /// Smallest grain.
    pub d0_mm: f64,
    /// D15 by mass.
    pub d15_mm: f64,
    /// D50 by mass.
    pub d50_mm: f64,
    /// D50 by number: the distance between voids.
    pub d50_by_number_mm: f64,
    /// D85 by mass.
    pub d85_mm: f64,
    /// Volume of voids over volume of grains, if known.
    pub void_ratio: Option<f64>,
    /// Rows of (size, percent finer by mass), sizes ascending.
    pub gradation: Vec<[f64; 2]>,
    /// Rows of (diameter, percent smaller by number), diameters ascending.
    pub constrictions: Vec<[f64; 2]>,
    /// Dc60 / Dc10 by number.
    pub cu_csd: f64,
    /// Name of the constriction curve.
    pub curve_name: String,
}

/// Base soil.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct BaseRecord {
    /// Name given by the user.
    pub name: String,
    /// D60 / D10 by mass; `None` if D10 lies in the pan fraction (finer than the finest sieve).
    pub cu: Option<f64>,
    /// Smallest particle.
    pub d0_mm: f64,
    /// D15 by mass.
    pub d15_mm: Option<f64>,
    /// D50 by mass.
    pub d50_mm: Option<f64>,
    /// D85 by mass.
    pub d85_mm: f64,
    /// D95 by mass.
    pub d95_mm: f64,
    /// Largest particle.
    pub d100_mm: f64,
    /// Pan fraction (finer than the finest sieve) by mass; counted as passive.
    pub tail_mass_fraction: f64,
    /// Size on which the base was regraded before the walk; `None` if it was walked as sampled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regraded_at_mm: Option<f64>,
    /// Base as sampled, if it was regraded before the walk.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_sampled: Option<SampledBase>,
    /// Rows of (size, percent finer by mass), sizes ascending.
    pub gradation: Vec<[f64; 2]>,
}

/// Base before regrading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SampledBase {
    /// D85 by mass.
    pub d85_mm: Option<f64>,
    /// D95 by mass.
    pub d95_mm: Option<f64>,
    /// Largest particle.
    pub d100_mm: f64,
    /// Rows of (size, percent finer by mass), sizes ascending.
    pub gradation: Vec<[f64; 2]>,
}

/// Void network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct NetworkRecord {
    /// Origin of the network.
    pub kind: NetworkKind,
    /// Name given by the user.
    pub name: String,
    /// Voids along x; `None` for a network from a file.
    pub nx: Option<u64>,
    /// Voids along y.
    pub ny: Option<u64>,
    /// Voids along z, the direction of flow.
    pub nz: Option<u64>,
    /// Number of voids.
    pub voids: u64,
    /// Number of constrictions.
    pub constrictions: u64,
    /// Number of voids in which base particles start.
    pub start_nodes: u64,
    /// Number of layers.
    pub layers: u64,
    /// Rows of (connectivity, percent of the voids), ascending; empty if all voids have the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub connectivity: Vec<[f64; 2]>,
    /// Modelled filter thickness: layers times D50F by number, or copies of a packing; `None` if a layer
    /// has no thickness.
    pub thickness_mm: Option<f64>,
    /// Number of equal copies of a packing, one behind the other; `None` unless the network is a graph.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub copies: Option<u64>,
}

/// Network that was walked, if its constrictions have no direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct NetworkSummary {
    /// `lattice`, `graph` or `file`.
    pub(crate) kind: String,
    /// Exit rule of the particles: `flux`, `area-along-flow` or `height`.
    pub(crate) exit: String,
    /// Number of voids.
    pub(crate) voids: u64,
    /// Number of constrictions, each counted once.
    pub(crate) constrictions: u64,
    /// Number of inlets from the reservoir.
    pub(crate) inlets: u64,
    /// Number of equal copies of a packing, one behind the other; `None` for a lattice.
    pub(crate) copies: Option<u64>,
    /// Number of layers of voids.
    pub(crate) layers: u64,
    /// Modelled filter thickness (mm).
    pub(crate) thickness_mm: Option<f64>,
    /// Permeability of the clean filter (m2); `None` without water or if lengths have no unit.
    pub(crate) k0_m2: Option<f64>,
    /// Hydraulic conductivity of the clean filter for water at 10 C (m/s); `None` as for `k0_m2`.
    pub(crate) k0_m_per_s: Option<f64>,
    /// Fraction of the inflow that may close before the flow is solved again (`walk.flow_tolerance`);
    /// `None` without water.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) flow_tolerance: Option<f64>,
    /// Maximum difference in eroded mass (percentage points) between such walks and walks of tolerance 0,
    /// on eleven filters (graph.md); `None` if it was not measured: with arches, with openings, with
    /// exits by area, and for tolerances above 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) flow_error_pp: Option<f64>,
}

/// Origin of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NetworkKind {
    /// Directed cubic lattice.
    Cubic,
    /// Lattice changed until its voids have a given distribution of connectivity.
    Connected,
    /// Network read from a file.
    File,
    /// Voids of a packing and the constrictions between them.
    Graph,
}

/// Ratios of characteristic sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Ratios {
    /// D15F / D85B.
    pub d15f_over_d85b: f64,
    /// D15F / D95B.
    pub d15f_over_d95b: f64,
}

/// D85 (mm) of a base as walked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct BaseSize {
    /// D85 by mass.
    pub(crate) d85_mm: f64,
    /// Size on which the base was regraded; `None` if it is as sampled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) regraded_at_mm: Option<f64>,
    /// D85 before regrading, if the base was regraded and the sieves give it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) as_sampled_mm: Option<f64>,
}

impl BaseRecord {
    /// D85, and the base that it belongs to.
    pub(crate) fn size(&self) -> BaseSize {
        BaseSize {
            d85_mm: self.d85_mm,
            regraded_at_mm: self.regraded_at_mm,
            as_sampled_mm: self.as_sampled.as_ref().and_then(|before| before.d85_mm),
        }
    }
}

impl Inputs {
    /// D85 of the base, and the base that it belongs to; `None` if sizes have no unit.
    pub(crate) fn base_size(&self) -> Option<BaseSize> {
        (!self.scale_free).then(|| self.base.size())
    }
}
