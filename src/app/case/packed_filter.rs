//! Packed filter: data for a walk, read from the folder of the packing; and the plan of a packing.
//!
//! The grains follow from the packing plan alone, so a packing is made once and stored under the
//! fingerprint of its plan. Its constrictions are measured again for each use: this takes a second, and
//! the overlap of voids may change.

use crate::outcome::packing::{PackedPart, PackingRecord, SameShape};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voidwalk_core::constrictions::{
    Constrictions, ConstrictionsError, Curve, CurveError, CurveUnit, inscribed,
};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::packing::{self, ImportError, Packing, Settings as Compression};
use voidwalk_core::store::format::{self, from_json};
use voidwalk_core::store::{StoreError, read_whole};
use voidwalk_practice::InputFile;

/// File of the packing's measurements; a folder with this file is complete.
pub(crate) const RECORD: &str = "packing.json";
pub(crate) const GRAINS: &str = "grains.csv";
/// Filter grains per void if the constrictions are a guess and no number is given: the value of loose
/// packings (`results/packing.md`).
pub(super) const GUESSED_GRAINS_PER_VOID: f64 = 0.6;
/// Grains per void of packings without friction: 0.49.
const SLIDING_GRAINS_PER_VOID: f64 = 0.49;
/// Filter grains per void at friction 0.3: 0.63 to 0.69 in linear gradations of Cu 1.5 to 6
/// (`results/packing.md`).
const ROUGH_GRAINS_PER_VOID: f64 = 0.65;
/// Relative position of the constrictions of a packing with friction between circles of three and of four
/// touching grains, from the 25th percentile on: 0.19 to 0.22 there in linear gradations and parts of C33
/// sand, 0.16 to 0.36 in gap-graded ones; 0.19 to 0.37 at the median; 0.04 to 0.14 at the first
/// percentile. Without friction it is about half as large.
const OF_FOUR: f64 = 0.2;

/// Packed filter: data for a walk.
#[derive(Clone, Debug)]
pub(crate) struct PackedFilter {
    /// Files of the curve and of the record; `None` for a placeholder.
    pub(crate) files: Option<[PathBuf; 2]>,
    /// Constriction curve (mm).
    pub(crate) curve: Curve,
    pub(crate) curve_csv: String,
    pub(crate) grains_per_void: f64,
    /// Bytes of `packing.json`.
    pub(crate) record: Vec<u8>,
    /// Volume of the voids over the volume of the grains of the filter, known if the whole was packed.
    pub(crate) void_ratio: Option<f64>,
    /// Part of the filter that was packed, if it is not the whole.
    pub(crate) part: Option<PackedPart>,
    /// Origin of the packing, if it was made for another filter of the same shape.
    pub(crate) same_shape: Option<SameShape>,
    /// Fraction of the grains, by number, that carry no load; `None` for a placeholder.
    pub(crate) rattlers: Option<f64>,
    /// Grains as CSV; `None` for a placeholder, or if a run kept only the curve.
    pub(crate) grains: Option<Vec<u8>>,
}

/// Reason why a packing's folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PackedError {
    /// The grains cannot be read.
    #[error(transparent)]
    Grains(#[from] ImportError),
    /// The record cannot be used.
    #[error("{file}: {problem}")]
    Record {
        /// Name of the file.
        file: String,
        /// Description of the problem.
        problem: String,
    },
    /// The system fails to read a file.
    #[error(transparent)]
    Read(#[from] StoreError),
    /// The constrictions cannot be measured.
    #[error(transparent)]
    Constrictions(#[from] ConstrictionsError),
    /// The constriction curve is invalid.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

impl PackedFilter {
    /// Reads a filter from the folder of its packing; `None` if it has not been packed yet. Errors: the
    /// folder is damaged or holds another filter.
    pub(crate) fn read(folder: &Path, order: &PackingPlan) -> Result<Option<Self>, PackedError> {
        let Some((record, read)) = read_record(folder)? else { return Ok(None) };
        if read.fingerprint != order.fingerprint() {
            let problem = "this is the packing of another recipe; name another folder";
            return Err(refused(&folder.join(RECORD), problem));
        }
        // Another filter may have the same finer part.
        let is_of_it = read.part == order.part && read.same_shape.is_none();
        let read = PackingRecord { part: order.part, same_shape: None, ..read };
        Self::measured(folder, order, read, 1.0, is_of_it.then_some(record)).map(Some)
    }

    /// Finds a filter in a folder of packings: its own packing, or one of the same shape; `None` if there is
    /// neither. Errors: a packing of the filter is damaged.
    pub(crate) fn find(packings: &Path, order: &PackingPlan) -> Result<Option<Self>, PackedError> {
        match Self::read(&packings.join(order.folder_name()), order)? {
            Some(filter) => Ok(Some(filter)),
            None => Self::of_same_shape(packings, order),
        }
    }

    /// Finds a packing of the same shape in a folder of packings, with all sizes scaled by one factor; `None`
    /// if there is none. If there are several, the first by name is used. Errors: a packing of the same shape
    /// is damaged.
    pub(crate) fn of_same_shape(packings: &Path, order: &PackingPlan) -> Result<Option<Self>, PackedError> {
        let Ok(entries) = std::fs::read_dir(packings) else { return Ok(None) };
        let usual_folder = packings.join(order.folder_name());
        let mut folders: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        folders.retain(|folder| *folder != usual_folder);
        folders.sort();
        for folder in folders {
            // Skips folders that hold no packing, or an unfinished one.
            let Ok(Some((_, read))) = read_record(&folder) else { continue };
            let points: Vec<(f64, f64)> = read.gradation.iter().map(|[d, percent]| (*d, *percent)).collect();
            if read.fingerprint != order.fingerprint_of(&points) {
                continue;
            }
            let Some(factor) = order.scale_from(&points) else { continue };
            let same_shape = Some(SameShape { folder: folder.display().to_string(), factor });
            let read = PackingRecord { part: order.part, same_shape, ..read.scaled(factor) };
            return Self::measured(&folder, order, read, factor, None).map(Some);
        }
        Ok(None)
    }

    /// Measures the constrictions of the grains in a folder, times `factor`; `record` is the record's own
    /// bytes, if they agree with `read`.
    fn measured(
        folder: &Path,
        order: &PackingPlan,
        read: PackingRecord,
        factor: f64,
        record: Option<Vec<u8>>,
    ) -> Result<Self, PackedError> {
        let path = folder.join(RECORD);
        let grains = folder.join(GRAINS);
        let Some(bytes) = read_if_there(&grains)? else {
            return Err(refused(&path, format!("{GRAINS} is missing")));
        };
        if format!("{:016x}", xxhash_rust::xxh3::xxh3_64(&bytes)) != read.grains_xxh3 {
            return Err(refused(
                &path,
                format!("{GRAINS} is not the file that this record was written with"),
            ));
        }
        let packing = Packing::parse(&grains.display().to_string(), &bytes)?;
        let packing = if factor == 1.0 { packing } else { packing.scaled(factor) };
        let constrictions = Constrictions::measure(&packing, order.merge_overlap)?;
        let record = match record {
            Some(record) => record,
            None => format::PACKING.json(&read).map_err(|e| refused(&path, e))?.into_bytes(),
        };
        Ok(Self {
            files: Some([folder.join("constrictions.csv"), path]),
            curve: constrictions.curve()?,
            curve_csv: constrictions.curve_csv()?,
            grains_per_void: constrictions.grains_per_void(),
            void_ratio: read.part.is_none().then_some(read.after.void_ratio),
            part: read.part,
            same_shape: read.same_shape,
            rattlers: Some(read.after.rattlers),
            record,
            grains: Some(bytes),
        })
    }

    /// Reads a filter whose curve a run kept in its folder, with `packing.json` beside it. Errors: a file is
    /// missing or damaged.
    pub(crate) fn kept(curve: &Path, grains_per_void: f64) -> Result<Self, PackedError> {
        let record = curve.with_file_name(RECORD);
        let (curve_bytes, record_bytes) = (read(curve)?, read(&record)?);
        let packing: PackingRecord = from_json(&record_bytes).map_err(|e| refused(&record, e))?;
        Ok(Self {
            curve: Curve::from_csv_text(&curve.display().to_string(), &curve_bytes)?,
            curve_csv: String::from_utf8_lossy(&curve_bytes).into_owned(),
            files: Some([curve.to_owned(), record]),
            grains_per_void,
            record: record_bytes,
            void_ratio: packing.part.is_none().then_some(packing.after.void_ratio),
            part: packing.part,
            same_shape: packing.same_shape,
            rattlers: Some(packing.after.rattlers),
            grains: None,
        })
    }

    /// Rough estimate of a filter that has not been packed yet, to estimate work and to find faults of a
    /// scene early. Errors: cannot fail for a gradation that can be packed.
    pub(crate) fn placeholder(order: &PackingPlan) -> Result<Self, CurveError> {
        // Without friction, grains settle more densely.
        let loose = (order.compression.friction / 0.3).min(1.0);
        let [dense_curve, loose_curve] = [1.0, 0.0].map(|density| inscribed(&order.gradation, density));
        let (dense_curve, loose_curve) = (dense_curve?, loose_curve?);
        let points: Vec<(f64, f64)> = [0.0, 1.0, 5.0, 15.0, 25.0, 40.0, 50.0, 60.0, 75.0, 90.0, 100.0]
            .into_iter()
            .filter_map(|percent| {
                let (of_three, of_four) = (dense_curve.dc(percent)?, loose_curve.dc(percent)?);
                let share = (0.5 + 0.5 * loose) * (OF_FOUR * (percent / 25.0).sqrt()).min(OF_FOUR);
                Some((percent, of_three + share * (of_four - of_three)))
            })
            .collect();
        Ok(Self {
            files: None,
            curve: Curve::from_points(&points, CurveUnit::Mm)?,
            curve_csv: String::new(),
            grains_per_void: SLIDING_GRAINS_PER_VOID
                + loose * (ROUGH_GRAINS_PER_VOID - SLIDING_GRAINS_PER_VOID),
            record: Vec::new(),
            void_ratio: None,
            part: order.part,
            same_shape: None,
            rattlers: None,
            grains: None,
        })
    }
}

/// Record of a packing, as bytes and parsed; `None` if it is missing.
fn read_record(folder: &Path) -> Result<Option<(Vec<u8>, PackingRecord)>, PackedError> {
    let path = folder.join(RECORD);
    let Some(record) = read_if_there(&path)? else { return Ok(None) };
    let read = from_json(&record).map_err(|e| refused(&path, e))?;
    Ok(Some((record, read)))
}

fn read(path: &Path) -> Result<Vec<u8>, StoreError> {
    read_whole(path).map_err(|source| StoreError::Io { path: path.to_owned(), action: "read", source })
}

/// Bytes of a file; `None` if it is missing.
fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match read(path) {
        Err(StoreError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => Ok(None),
        read => read.map(Some),
    }
}

fn refused(record: &Path, problem: impl ToString) -> PackedError {
    PackedError::Record { file: record.display().to_string(), problem: problem.to_string() }
}

/// Maximum relative difference between the scaled sizes of two gradations of the same shape.
const SAME_SIZE: f64 = 1e-3;
/// Maximum difference between their percentages.
const SAME_PERCENT: f64 = 1e-2;
/// Part of the definition of a packing: another number gives other grains from the same recipe.
const PROTOCOL: u32 = 2;
/// Protocol of gradations so broad that grains with many contacts are moved as heavier ones.
const WIDE_PROTOCOL: u32 = 3;

/// Plan of a packing.
#[derive(Clone, Debug)]
pub struct PackingPlan {
    /// Gradation that is packed: the filter's, or that of its finer part.
    pub(crate) gradation: Gradation,
    pub(crate) name: String,
    pub(crate) linear: bool,
    /// Part of the filter that is packed, if it is not the whole.
    pub(crate) part: Option<PackedPart>,
    /// Height of the cell over its width.
    pub(crate) aspect: f64,
    pub(crate) compression: Compression,
    /// Overlap of two inscribed spheres above which their tetrahedra form one void.
    pub(crate) merge_overlap: f64,
    pub(crate) inputs: Vec<Input>,
}

impl PackingPlan {
    /// Fingerprint of all inputs of the grains.
    pub(crate) fn fingerprint(&self) -> String {
        self.fingerprint_of(&pairs(&self.gradation))
    }

    /// Fingerprint of a gradation with these points and the same compression.
    fn fingerprint_of(&self, points: &[(f64, f64)]) -> String {
        let protocol = if packing::is_wide(&self.gradation) { WIDE_PROTOCOL } else { PROTOCOL };
        let mut text = format!("{protocol} {points:?} {:?}", self.compression);
        if self.aspect != 1.0 {
            text += &format!(" {:?} times as tall", self.aspect);
        }
        format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text.as_bytes()))
    }

    /// Factor from a gradation with these points to the plan's; `None` if no factor brings every size
    /// within a thousandth of its target.
    fn scale_from(&self, points: &[(f64, f64)]) -> Option<f64> {
        let planned = pairs(&self.gradation);
        let (coarsest, its) = (planned.last()?, points.last()?);
        let factor = coarsest.0 / its.0;
        let fits = |(planned, other): (&(f64, f64), &(f64, f64))| {
            (factor * other.0 / planned.0 - 1.0).abs() < SAME_SIZE
                && (other.1 - planned.1).abs() < SAME_PERCENT
        };
        (planned.len() == points.len() && planned.iter().zip(points).all(fits)).then_some(factor)
    }

    /// True if one packing, scaled, serves both plans.
    pub(crate) fn has_shape_of(&self, other: &Self) -> bool {
        let points = pairs(&other.gradation);
        self.scale_from(&points).is_some() && self.fingerprint_of(&points) == other.fingerprint()
    }

    /// Name of the packing's folder among others.
    pub(crate) fn folder_name(&self) -> String {
        let cu = self.gradation.cu().map_or("graded".to_string(), |cu| format!("cu{:.3}", cu));
        let cu = cu.trim_end_matches('0').trim_end_matches('.');
        format!("{cu}-friction{}-{}", self.compression.friction, &self.fingerprint()[..8])
    }
}

/// Size and percent of each point, as used in fingerprints.
fn pairs(gradation: &Gradation) -> Vec<(f64, f64)> {
    gradation.points().iter().map(|point| (point.size, point.percent)).collect()
}

/// File that was read, with its name in a run folder.
#[derive(Clone, Debug)]
pub struct Input {
    pub(crate) setting: &'static str,
    /// Path as first given by the user: a run that continues from the files in its folder reads it there.
    pub(crate) name: String,
    pub(crate) kept_as: String,
    /// Bytes of the file, shared by copies of a case.
    pub bytes: Arc<Vec<u8>>,
    /// Soil to use, if the file holds several.
    pub(crate) soil: Option<String>,
    /// Assumptions made in reading the file.
    pub(crate) notes: Vec<String>,
}

impl Input {
    pub(crate) fn file(&self) -> InputFile {
        InputFile::of(&self.name, &self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn the_fingerprint_names_the_protocol() {
        let protocols = |cu: f64, grains: usize| {
            let set = [
                format!("filter.cu={cu}"),
                "filter.density=loose".into(),
                format!("packing.grains={grains}"),
                "packing.coarsest=100".into(),
            ];
            let plan = PackingPlan::of(&Scene::built_in(&set).unwrap()).unwrap().unwrap();
            let points = pairs(&plan.gradation);
            let text = |protocol: u32| format!("{protocol} {points:?} {:?}", plan.compression);
            let [earlier, wide] = [2, 3]
                .map(|protocol| format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text(protocol).as_bytes())));
            (plan.fingerprint() == earlier, plan.fingerprint() == wide)
        };
        assert_eq!(protocols(3.0, 20_000), (true, false));
        assert_eq!(protocols(4.4, 20_000), (true, false));
        // 4.5^2 is 20.25, even if too few grains reach it.
        assert_eq!(protocols(4.5, 20_000), (false, true));
        assert_eq!(protocols(6.0, 60_000), (false, true));
    }
}
