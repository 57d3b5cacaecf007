//! Inputs of a run, as `outcome.json` has them.

use serde::{Deserialize, Serialize};

/// What went in.
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
    /// Share of `n_base` inserted in each increment.
    pub inject_share: f64,
    /// Whether sizes are multiples of D0F instead of mm.
    pub scale_free: bool,
}

/// Where a filter's constrictions come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum CurveOrigin {
    /// The library of packings.
    Library,
    /// This filter was packed, and its constrictions were measured.
    Packed,
    /// A curve, a network or a packing that was given.
    Given,
    /// The gradation alone.
    Guessed,
}

/// What is known of a filter's constrictions besides their sizes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ConstrictionsRecord {
    /// Where they come from.
    pub origin: CurveOrigin,
}

/// The filter: its gradation by mass and its constrictions by number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct FilterRecord {
    /// As the user calls it.
    pub name: String,
    /// Whom to credit for the constriction curve; empty for the user's own.
    pub attribution: String,
    /// D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    pub cu: Option<f64>,
    /// Smallest grain.
    pub d0_mm: f64,
    /// 15 % finer by mass.
    pub d15_mm: f64,
    /// 50 % finer by mass.
    pub d50_mm: f64,
    /// 50 % finer by number: the distance from void to void.
    pub d50_by_number_mm: f64,
    /// 85 % finer by mass.
    pub d85_mm: f64,
    /// Volume of voids over volume of grains, where known.
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

/// The base soil.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct BaseRecord {
    /// As the user calls it.
    pub name: String,
    /// D60 / D10 by mass; `None` where D10 lies in the pan fraction (finer than the finest sieve).
    pub cu: Option<f64>,
    /// Smallest particle.
    pub d0_mm: f64,
    /// 15 % finer by mass.
    pub d15_mm: Option<f64>,
    /// 50 % finer by mass.
    pub d50_mm: Option<f64>,
    /// 85 % finer by mass.
    pub d85_mm: f64,
    /// 95 % finer by mass.
    pub d95_mm: f64,
    /// Largest particle.
    pub d100_mm: f64,
    /// Pan fraction (finer than the finest sieve) by mass; counted as passive.
    pub tail_mass_fraction: f64,
    /// The size that it was regraded on before it was walked; `None` where it is walked as it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regraded_at_mm: Option<f64>,
    /// The base as it was sampled, where it was regraded before it was walked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_sampled: Option<SampledBase>,
    /// Rows of (size, percent finer by mass), sizes ascending.
    pub gradation: Vec<[f64; 2]>,
}

/// A base before it was regraded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SampledBase {
    /// 85 % finer by mass.
    pub d85_mm: Option<f64>,
    /// 95 % finer by mass.
    pub d95_mm: Option<f64>,
    /// Largest particle.
    pub d100_mm: f64,
    /// Rows of (size, percent finer by mass), sizes ascending.
    pub gradation: Vec<[f64; 2]>,
}

/// The void network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct NetworkRecord {
    /// Where it comes from.
    pub kind: NetworkKind,
    /// As the user calls it.
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
    /// Rows of (connectivity, percent of the voids), rising; empty where all voids have the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub connectivity: Vec<[f64; 2]>,
    /// Modelled filter thickness: layers times D50F by number, or copies of a packing; `None` where a layer
    /// has no thickness.
    pub thickness_mm: Option<f64>,
    /// Equal copies of a packing, one behind the other; `None` but for a graph.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub copies: Option<u64>,
}

/// The network that was walked, where its constrictions have no direction of their own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct NetworkSummary {
    /// `lattice`, `graph` or `file`.
    pub kind: String,
    /// How particles chose among the exits of a void: `flux`, `area-along-flow` or `height`.
    pub exit: String,
    /// Voids.
    pub voids: u64,
    /// Constrictions, each counted once.
    pub constrictions: u64,
    /// Ways in from the reservoir.
    pub inlets: u64,
    /// Equal copies of a packing, one behind the other; `None` for a lattice.
    pub copies: Option<u64>,
    /// Layers of voids.
    pub layers: u64,
    /// Modelled filter thickness (mm).
    pub thickness_mm: Option<f64>,
    /// Permeability of the clean filter (m2); `None` where no water flows, or where lengths have no unit.
    pub k0_m2: Option<f64>,
    /// Hydraulic conductivity of the clean filter for water of 10 C (m/s), likewise.
    pub k0_m_per_s: Option<f64>,
    /// Share of the inflow that may close before the flow is solved again (`walk.flow_tolerance`); `None`
    /// where no water flows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_tolerance: Option<f64>,
    /// Percentage points of eroded mass by which such walks differed at most from walks of tolerance 0, on
    /// eleven filters (graph.md); `None` where that was not measured: with arches, with openings, with exits
    /// by area, and for tolerances above 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_error_pp: Option<f64>,
}

/// How a network was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NetworkKind {
    /// Directed cubic lattice.
    Cubic,
    /// The lattice changed until its voids have a given distribution of connectivity.
    Connected,
    /// Read from a file.
    File,
    /// The voids of a packing and the constrictions between them.
    Graph,
}

/// The ratios of characteristic sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Ratios {
    /// D15F / D85B.
    pub d15f_over_d85b: f64,
    /// D15F / D95B.
    pub d15f_over_d95b: f64,
}

/// D85 of a base (mm), of the base as it is walked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct BaseSize {
    /// 85 % finer by mass.
    pub d85_mm: f64,
    /// The size that it was regraded on; `None` where it is as it was sampled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regraded_at_mm: Option<f64>,
    /// D85 before regrading, where it was regraded and a sieve tells it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_sampled_mm: Option<f64>,
}

impl BaseRecord {
    /// D85, and the base that it belongs to.
    pub fn size(&self) -> BaseSize {
        BaseSize {
            d85_mm: self.d85_mm,
            regraded_at_mm: self.regraded_at_mm,
            as_sampled_mm: self.as_sampled.as_ref().and_then(|before| before.d85_mm),
        }
    }
}

impl Inputs {
    /// D85 of the base, and the base that it belongs to; `None` where sizes have no unit.
    pub fn base_size(&self) -> Option<BaseSize> {
        (!self.scale_free).then(|| self.base.size())
    }
}
