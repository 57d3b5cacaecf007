//! A filter that has been packed: what a walk needs of it, read from the folder that it was packed into.
//!
//! The grains follow from the packing plan alone, so a packing is made once and kept under the fingerprint of
//! its plan. Its constrictions are measured again for each use: that takes a second, and the overlap of voids
//! may change.

use std::path::{Path, PathBuf};

use super::PackingPlan;
use crate::constrictions::{Constrictions, ConstrictionsError, Curve, CurveError, CurveUnit};
use crate::outcome::packing::PackingRecord;
use crate::packing::{ImportError, Packing};
use crate::store::{StoreError, read_whole};

/// The packing's measures; a folder that holds it is whole.
pub const RECORD: &str = "packing.json";
/// The grains.
pub const GRAINS: &str = "grains.csv";

/// A filter that has been packed: what a walk needs of it.
#[derive(Clone, Debug)]
pub struct PackedFilter {
    /// Its files: the curve, and the record; `None` for a placeholder.
    pub files: Option<[PathBuf; 2]>,
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
    /// The grains, as CSV; `None` for a placeholder, or where a run kept the curve alone.
    pub grains: Option<Vec<u8>>,
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
    Constrictions(#[from] ConstrictionsError),
    /// The constriction curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

impl PackedFilter {
    /// Takes a filter from the folder that it was packed into; `None` where it has not been packed yet.
    ///
    /// # Errors
    /// A folder that is damaged, or that holds another filter.
    pub fn read(folder: &Path, order: &PackingPlan) -> Result<Option<Self>, PackedError> {
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
        let grains = folder.join(GRAINS);
        let bytes = match read_whole(&grains) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                return Err(problem(format!("{} is missing", GRAINS)));
            }
            Err(source) => return Err(StoreError::Io { path: grains, action: "read", source }.into()),
        };
        if format!("{:016x}", xxhash_rust::xxh3::xxh3_64(&bytes)) != read.grains_xxh3 {
            return Err(problem(format!("{} is not the file that this record was written with", GRAINS)));
        }
        let packing = Packing::parse(&grains.display().to_string(), &bytes)?;
        let found = Constrictions::measure(&packing, order.merge_overlap)?;
        Ok(Some(Self {
            files: Some([folder.join("constrictions.csv"), path]),
            curve: found.curve()?,
            curve_csv: found.curve_csv()?,
            grains_per_void: found.grains_per_void(),
            record,
            void_ratio: read.after.void_ratio,
            grains: Some(bytes),
        }))
    }

    /// The filter whose curve a run kept in its folder, with `packing.json` beside it.
    ///
    /// # Errors
    /// A file that is missing or damaged.
    pub fn kept(curve: &Path, grains_per_void: f64) -> Result<Self, PackedError> {
        let record = curve.with_file_name(RECORD);
        let read = |path: &Path| {
            let io = |source| StoreError::Io { path: path.to_owned(), action: "read", source };
            read_whole(path).map_err(io)
        };
        let (curve_bytes, record_bytes) = (read(curve)?, read(&record)?);
        let problem = |problem: String| PackedError::Record { file: record.display().to_string(), problem };
        let of: PackingRecord = serde_json::from_slice(&record_bytes).map_err(|e| problem(e.to_string()))?;
        Ok(Self {
            curve: Curve::from_csv_text(&curve.display().to_string(), &curve_bytes)?,
            curve_csv: String::from_utf8_lossy(&curve_bytes).into_owned(),
            files: Some([curve.to_owned(), record]),
            grains_per_void,
            record: record_bytes,
            void_ratio: of.after.void_ratio,
            grains: None,
        })
    }

    /// A rough guess at a filter that has not been packed yet, for estimates and for finding faults of a
    /// scene early.
    ///
    /// # Errors
    /// None for a gradation that can be packed.
    pub fn placeholder(order: &PackingPlan) -> Result<Self, CurveError> {
        let d = |percent| order.gradation.d_by_number(percent).unwrap_or(order.gradation.smallest_mm());
        let points: Vec<(f64, f64)> = [(0.0, 0.155), (50.0, 0.27), (100.0, 0.7)]
            .into_iter()
            .map(|(percent, share)| (percent, share * if percent < 100.0 { d(percent) } else { d(99.0) }))
            .collect();
        Ok(Self {
            files: None,
            curve: Curve::from_points(&points, CurveUnit::Mm)?,
            curve_csv: String::new(),
            grains_per_void: 0.6,
            record: Vec::new(),
            void_ratio: f64::NAN,
            grains: None,
        })
    }
}
