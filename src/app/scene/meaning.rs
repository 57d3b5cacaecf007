//! Combined meaning of the settings of a scene: settings that exclude each other form one enum.

use std::path::PathBuf;

use super::keys::{Base, Filter, NetworkKeys, Record};
use super::values::{CurveSource, NetworkMadeOf};
use super::{PackingKeys, SceneError};
use crate::outcome::Wanted;
use voidwalk_core::network::Connectivity;
use voidwalk_core::packing;

/// Gradation of the filter by mass.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FilterGradation {
    /// Linear on semi-log paper from `d0_mm`; without `cu`, the value of the shipped curve.
    Linear { d0_mm: f64, cu: Option<f64> },
    /// Sieve table, and the lower end of its open tail (mm).
    Sieve(PathBuf, Option<f64>),
}

/// Gradation of the base by mass.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BaseGradation {
    /// Linear on semi-log paper with a given D85B.
    Linear { cu: f64, d85: D85 },
    /// Sieve table, and the lower end of its open tail (mm).
    Sieve(PathBuf, Option<f64>),
    /// One size (mm).
    Single(f64),
}

/// Setting that defines D85B.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum D85 {
    Mm(f64),
    /// Constriction size at this percent of the filter's curve, or of another one.
    AtDc(f64, Option<CurveSource>),
    /// D15F over this ratio.
    Ratio(f64),
}

/// Number of base particles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Amount {
    /// Mass of base over mass of filter, Eq. (2), and a cap.
    MassRatio(f64, Option<u64>),
    Number(u64),
}

/// Source of a scene's network.
#[derive(Clone, Debug, PartialEq)]
pub enum NetworkSource {
    /// Directed cubic lattice with this many voids along x, y, z.
    Cubic([u32; 3]),
    /// Lattice changed until its voids have this distribution of connectivity.
    Connected([u32; 3], Connectivity),
    /// A CSV file.
    File(PathBuf),
    /// Voids of a packing: of the packed filter, or of a file of grains.
    Graph(Option<PathBuf>, Extent),
}

/// Thickness of a filter along the flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Usual number of layers of voids, as in the lattice of the paper.
    Usual,
    Copies(u32),
    Mm(f64),
    /// Thickness over D50F by mass.
    D50F(f64),
}

impl Extent {
    /// Thickness (mm) of the filter, if the scene states one.
    pub(crate) fn thickness_mm(self, d50f_mm: f64) -> Option<f64> {
        match self {
            Self::Mm(mm) => Some(mm),
            Self::D50F(multiple) => Some(multiple * d50f_mm),
            Self::Usual | Self::Copies(_) => None,
        }
    }
}

/// Default mass of base over mass of filter: the paper's value.
const MASS_RATIO: f64 = 0.05;
/// Default number of voids along x, y, z: the paper's values.
const VOIDS: [u64; 3] = [40, 40, USUAL_LAYERS];
pub(crate) const USUAL_LAYERS: u64 = 60;

impl Filter {
    pub(super) fn fill_in(&mut self) {
        if self.sieve.is_none() {
            self.d0_mm.get_or_insert(1.0);
        }
    }

    pub(crate) fn gradation(&self) -> FilterGradation {
        match &self.sieve {
            Some(path) => FilterGradation::Sieve(path.clone(), self.d0_mm),
            None => FilterGradation::Linear { d0_mm: self.d0_mm.unwrap_or(1.0), cu: self.cu },
        }
    }
}

impl Base {
    pub(super) fn fill_in(&mut self) {
        if self.n_base.is_none() {
            self.mass_ratio.get_or_insert(MASS_RATIO);
        }
    }

    pub(crate) fn gradation(&self) -> BaseGradation {
        if let Some(path) = &self.sieve {
            return BaseGradation::Sieve(path.clone(), self.d0_mm);
        }
        match self.single_mm {
            Some(size) => BaseGradation::Single(size),
            // A scene without any of the three settings of D85B was refused.
            None => BaseGradation::Linear {
                cu: self.cu.unwrap_or(1.0),
                d85: self.d85().unwrap_or(D85::Ratio(1.0)),
            },
        }
    }

    /// Setting that defines D85B of a linear gradation.
    pub(crate) fn d85(&self) -> Option<D85> {
        let at_dc = self.d85_at_dc.map(|percent| D85::AtDc(percent, self.dc_curve.clone()));
        self.d85_mm.map(D85::Mm).or(at_dc).or(self.d15f_over_d85b.map(D85::Ratio))
    }

    pub(crate) fn amount(&self) -> Amount {
        match self.n_base {
            Some(n) => Amount::Number(n),
            None => Amount::MassRatio(self.mass_ratio.unwrap_or(MASS_RATIO), self.cap),
        }
    }
}

impl NetworkKeys {
    /// True for a file of arrays, whose constrictions can be passed both ways.
    pub(crate) fn is_of_arrays(&self) -> bool {
        let ending = |path: &PathBuf| path.extension().map(|ending| ending.to_ascii_lowercase());
        self.file.as_ref().and_then(ending).is_some_and(|ending| ending == "npz")
    }

    pub(super) fn fill_in(&mut self) {
        if self.file.is_some() || self.kind == Some(NetworkMadeOf::Graph) {
            return;
        }
        for (given, usual) in [&mut self.nx, &mut self.ny].into_iter().zip(VOIDS) {
            given.get_or_insert(usual);
        }
        if self.extent() == Extent::Usual {
            self.nz.get_or_insert(VOIDS[2]);
        }
    }

    pub(crate) fn extent(&self) -> Extent {
        let copies = self.copies.map(|copies| Extent::Copies(copies as u32));
        let thickness = self.thickness_mm.map(Extent::Mm).or(self.thickness_d50f.map(Extent::D50F));
        copies.or(thickness).unwrap_or(Extent::Usual)
    }

    /// Sets the number of layers of a lattice of this thickness.
    pub(crate) fn set_layers(&mut self, layers: u64) {
        self.nz = Some(layers);
        (self.thickness_mm, self.thickness_d50f) = (None, None);
    }

    /// Limits the width of a lattice to this many voids in both directions.
    pub(crate) fn narrow_to(&mut self, across: u64) {
        let narrow = |width: Option<u64>, usual: u64| Some(width.unwrap_or(usual).min(across));
        (self.nx, self.ny) = (narrow(self.nx, VOIDS[0]), narrow(self.ny, VOIDS[1]));
    }

    /// Sets the number of copies of a packing in its graph.
    pub(crate) fn set_copies(&mut self, copies: u64) {
        self.copies = Some(copies);
        (self.thickness_mm, self.thickness_d50f) = (None, None);
    }

    /// Source of the network.
    pub fn source(&self) -> NetworkSource {
        if self.kind == Some(NetworkMadeOf::Graph) {
            return NetworkSource::Graph(self.packing.clone(), self.extent());
        }
        if let Some(path) = &self.file {
            return NetworkSource::File(path.clone());
        }
        let given = [self.nx, self.ny, self.nz];
        let shape = std::array::from_fn(|axis| given[axis].unwrap_or(VOIDS[axis]) as u32);
        match &self.connectivity {
            Some(wanted) => NetworkSource::Connected(shape, wanted.0.clone()),
            None => NetworkSource::Cubic(shape),
        }
    }
}

impl NetworkSource {
    /// Number of voids along x, y, z, if the network is a lattice.
    pub fn shape(&self) -> Option<[u32; 3]> {
        match self {
            Self::Cubic(shape) | Self::Connected(shape, _) => Some(*shape),
            Self::File(_) | Self::Graph(..) => None,
        }
    }
}

impl Record {
    /// Data to record of a run.
    pub(crate) fn wanted(&self) -> Wanted {
        let Self { series_every, size_curves, size_classes, voids, .. } = self.clone();
        Wanted { series_every, size_curves, size_classes: size_classes as usize, voids }
    }
}

/// Specification of the packing of a filter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PackingSpec {
    /// A linear one has a `cu`.
    pub(crate) gradation: FilterGradation,
    /// Number of grains, if given by the user.
    pub(crate) grains: Option<usize>,
    /// Height of the cell over its width.
    pub(crate) aspect: f64,
    /// Percent by mass to pack, from the finest grain up, if given by the user.
    pub(crate) coarsest: Option<f64>,
    /// Its number of grains counts only if given by the user.
    pub(crate) compression: packing::Settings,
    /// See [`PackingKeys`].
    pub(crate) merge_overlap: f64,
    /// Name of the file in errors.
    pub(crate) file: String,
}

impl PackingSpec {
    /// Collects the settings of a filter and its packing; errors call them `file`. Errors: the gradation is
    /// missing, or the settings of the compression cannot be used together.
    pub(crate) fn new(filter: &Filter, packing: &PackingKeys, file: &str) -> Result<Self, SceneError> {
        let clash = |problem: String| SceneError::Clash { file: file.to_owned(), problem };
        let gradation = filter.gradation();
        if matches!(gradation, FilterGradation::Linear { cu: None, .. }) {
            let problem =
                "filter.cu or filter.sieve is missing: a filter that is to be packed needs its gradation";
            return Err(clash(problem.into()));
        }
        let mut compression = packing.compression.clone();
        compression.friction =
            filter.friction.or(filter.density.map(|d| d.friction())).unwrap_or(compression.friction);
        let grains = packing.filter.grains.map(|n| n as usize);
        compression.grains = grains.unwrap_or(compression.grains);
        compression.check().map_err(|e| clash(format!("packing.{e}")))?;
        let merge_overlap = packing.filter.merge_overlap;
        let (coarsest, aspect) = (packing.filter.coarsest, packing.filter.aspect.unwrap_or(1.0));
        Ok(Self { gradation, grains, aspect, coarsest, compression, merge_overlap, file: file.to_owned() })
    }
}
