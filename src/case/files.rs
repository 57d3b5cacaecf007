//! The files of a scene: each is read once, and what was read is kept for the run folder.

use std::path::{Path, PathBuf};

use super::CaseError;
use super::packed_filter::{PackedFilter, RECORD};
use crate::constrictions::{Curve, ShippedFilter, find};
use crate::gradation::Gradation;
use crate::network::Network;
use crate::scene::CurveSource;
use crate::scene::SceneError;

/// A file that was read, and the name under which a run folder keeps it.
#[derive(Clone, Debug)]
pub struct Input {
    /// The setting that names it.
    pub setting: &'static str,
    /// Its path as given.
    pub path: PathBuf,
    /// Name inside the run folder.
    pub kept_as: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// A larger sieve table or curve is refused before it is read (bytes).
const LARGEST_TABLE: u64 = 16 << 20;
/// Likewise a network.
const LARGEST_NETWORK: u64 = 1 << 36;

/// Reads the files of a scene, and remembers them.
#[derive(Default)]
pub struct Files(pub Vec<Input>);

impl Files {
    /// Reads a regular file once, and keeps what was read.
    fn read(
        &mut self,
        setting: &'static str,
        path: &Path,
        kept_as: &str,
        largest: u64,
    ) -> Result<(String, &[u8]), CaseError> {
        let file = path.display().to_string();
        let io = |source| SceneError::File { file: file.clone(), source };
        let meta = std::fs::metadata(path).map_err(io)?;
        if !meta.is_file() || meta.len() > largest {
            let problem = format!("must be a regular file of at most {largest} bytes");
            return Err(SceneError::Syntax { file, at: String::new(), problem }.into());
        }
        let bytes = std::fs::read(path).map_err(io)?;
        let input = Input { setting, path: path.to_owned(), kept_as: format!("inputs/{kept_as}"), bytes };
        self.0.push(input);
        Ok((file, &self.0[self.0.len() - 1].bytes))
    }

    pub fn curve(
        &mut self,
        source: &CurveSource,
        setting: &'static str,
        kept_as: &str,
    ) -> Result<(Curve, Option<&'static ShippedFilter>), CaseError> {
        match source {
            CurveSource::Shipped(name) => {
                let shipped = find(name)?;
                Ok((shipped.curve()?, Some(shipped)))
            }
            CurveSource::File(path) => {
                let (name, bytes) = self.read(setting, path, kept_as, LARGEST_TABLE)?;
                Ok((Curve::from_csv_text(&name, bytes)?, None))
            }
        }
    }

    /// The curve of a filter that was packed; kept as if it had been given.
    pub fn packed(&mut self, packed: &PackedFilter) -> Curve {
        if let Some(folder) = &packed.folder {
            for (setting, name, kept_as, bytes) in [
                ("filter.curve", "constrictions.csv", "filter-curve.csv", packed.curve_csv.as_bytes()),
                ("filter.density", RECORD, RECORD, &packed.record),
            ] {
                let (path, bytes) = (folder.join(name), bytes.to_vec());
                self.0.push(Input { setting, path, kept_as: format!("inputs/{kept_as}"), bytes });
            }
        }
        packed.curve.clone()
    }

    pub fn sieve(
        &mut self,
        path: &Path,
        d0_mm: Option<f64>,
        setting: &'static str,
        kept_as: &str,
    ) -> Result<Gradation, CaseError> {
        let (name, bytes) = self.read(setting, path, kept_as, LARGEST_TABLE)?;
        Ok(Gradation::from_sieve_text(&name, bytes, d0_mm)?)
    }

    pub fn network(&mut self, path: &Path, unit_mm: f64) -> Result<Network, CaseError> {
        let (name, bytes) = self.read("network.file", path, "network.csv", LARGEST_NETWORK)?;
        Ok(Network::from_csv(bytes, &name, unit_mm)?)
    }
}
