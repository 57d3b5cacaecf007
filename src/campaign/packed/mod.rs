//! A filter that is packed by the program itself, so that a scene needs a sieve curve and a density only.
//!
//! - [`Recipe`] is what the user states, [`Order`] the same with its files read.
//! - [`make()`] packs it into a folder; [`PackedFilter::read`] takes the constrictions from there.
//!
//! The grains follow from the recipe alone, so a packing is made once and kept under the fingerprint of its recipe. Its
//! constrictions are measured again for each use: that takes a second, and the overlap of voids may change.

mod make;
mod order;
mod recipe;

use std::path::{Path, PathBuf};

pub use make::{PackError, RECORD, STATES, Watch, make};
pub use order::Order;
pub use recipe::{DENSITIES, Recipe};

use crate::constrictions::{Constrictions, Curve, CurveUnit};
use crate::outcome::packing::PackingRecord;
use crate::packing::{ImportError, Packing};
use crate::store::{StoreError, read_whole};

/// A filter that has been packed: what a walk needs of it.
#[derive(Clone, Debug)]
pub struct PackedFilter {
    /// Where it is kept; `None` for a stand-in.
    pub folder: Option<PathBuf>,
    /// Its constriction curve (mm).
    pub curve: Curve,
    /// The same as CSV.
    pub curve_csv: String,
    /// Filter grains per void.
    pub grains_per_void: f64,
    /// `packing.json`, as it is.
    pub record: Vec<u8>,
    /// Volume of the voids by that of the grains.
    pub void_ratio: f64,
}

/// Why a packing's folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PackedError {
    /// The grains.
    #[error(transparent)]
    Grains(#[from] ImportError),
    /// The record.
    #[error("{file}: {problem}")]
    Record {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// A file that the system fails to read.
    #[error(transparent)]
    Read(#[from] StoreError),
    /// The constrictions.
    #[error(transparent)]
    Pack(#[from] PackError),
}

impl PackedFilter {
    /// Takes a filter from the folder that it was packed into; `None` where it has not been packed yet.
    ///
    /// # Errors
    /// A folder that is damaged, or that holds another filter.
    pub fn read(folder: &Path, order: &Order) -> Result<Option<Self>, PackedError> {
        let path = folder.join(RECORD);
        let problem = |problem: String| PackedError::Record { file: path.display().to_string(), problem };
        let record = match read_whole(&path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(StoreError::Io { path, action: "read", source }.into()),
        };
        let read: PackingRecord = serde_json::from_slice(&record).map_err(|e| problem(e.to_string()))?;
        if read.fingerprint != order.fingerprint() {
            return Err(problem("this is the packing of another recipe; name another folder".into()));
        }
        let grains = folder.join(make::GRAINS);
        let bytes = match read_whole(&grains) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                return Err(problem(format!("{} is missing", make::GRAINS)));
            }
            Err(source) => return Err(StoreError::Io { path: grains, action: "read", source }.into()),
        };
        if format!("{:016x}", xxhash_rust::xxh3::xxh3_64(&bytes)) != read.grains_xxh3 {
            return Err(problem(format!(
                "{} is not the file that this record was written with",
                make::GRAINS
            )));
        }
        let packing = Packing::parse(&grains.display().to_string(), &bytes)?;
        let found = Constrictions::measure(&packing, order.merge_overlap).map_err(PackError::from)?;
        Ok(Some(Self {
            folder: Some(folder.to_owned()),
            curve: found.curve().map_err(PackError::from)?,
            curve_csv: found.curve_csv().map_err(PackError::from)?,
            grains_per_void: found.grains_per_void(),
            record,
            void_ratio: read.after.void_ratio,
        }))
    }

    /// A rough guess at a filter that has not been packed yet, for estimates and for finding faults of a scene early.
    ///
    /// # Errors
    /// None for a gradation that can be packed.
    pub fn stand_in(order: &Order) -> Result<Self, PackError> {
        let d = |percent| order.gradation.d_by_number(percent).unwrap_or(order.gradation.smallest_mm());
        let points: Vec<(f64, f64)> = [(0.0, 0.155), (50.0, 0.27), (100.0, 0.7)]
            .into_iter()
            .map(|(percent, share)| (percent, share * if percent < 100.0 { d(percent) } else { d(99.0) }))
            .collect();
        Ok(Self {
            folder: None,
            curve: Curve::from_points(&points, CurveUnit::Mm)?,
            curve_csv: String::new(),
            grains_per_void: 0.6,
            record: Vec::new(),
            void_ratio: f64::NAN,
        })
    }
}
