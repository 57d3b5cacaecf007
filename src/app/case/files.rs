//! Files of a scene: each is read once, and its contents are kept for the run folder.

use super::error::CaseError;
use super::packed_filter::{GRAINS, Input, PackedError, PackedFilter, RECORD};
use crate::scene::{BUILT_IN_NAME, CurveSource, Scene, SceneError};
use crate::words;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use voidwalk_core::constrictions::{Curve, ShippedFilter, find};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{ArrayOptions, Network, NetworkError};
use voidwalk_core::packing::{PACKING_FILE_LIMIT_BYTES, Packing, ReadOptions};
use voidwalk_core::schema::read_file;
use voidwalk_core::store::read_regular;
use voidwalk_sheets::{Soil, file_and_soil};

/// Maximum size of a sieve table or curve (bytes); a larger one is refused before it is read.
const LARGEST_TABLE: u64 = 16 << 20;
/// Maximum size of a network file (bytes).
const LARGEST_NETWORK: u64 = 1 << 36;
/// Folder of the input files inside a run folder.
const INPUTS: &str = "inputs";
/// File with the user's names for the files in that folder, by their names there.
pub(crate) const INPUT_NAMES: &str = "inputs/names.json";

/// All files that may be kept there.
pub(crate) const INPUT_FILES: [&str; 15] = [
    RECORD,
    "filter-curve.csv",
    "filter-sieve.csv",
    "filter-sieve.xlsx",
    "filter-sieve.ods",
    "filter-sieve.ags",
    "base-sieve.csv",
    "base-sieve.xlsx",
    "base-sieve.ods",
    "base-sieve.ags",
    "base-dc-curve.csv",
    "network.csv",
    "network.npz",
    "network-packing.csv",
    "names.json",
];

/// Name given by the user to a file: from the list beside it in a run folder, or else its path.
fn first_name(path: &Path, soil: Option<&str>) -> Result<String, CaseError> {
    let part = soil.map(|soil| format!("#{soil}")).unwrap_or_default();
    let path_name = format!("{}{part}", path.display());
    let folder = path.parent().filter(|folder| folder.ends_with(INPUTS)).and_then(Path::parent);
    let Some(file) = folder.map(|folder| folder.join(INPUT_NAMES)) else { return Ok(path_name) };
    let Ok(Some(text)) = read_regular(&file, LARGEST_TABLE) else { return Ok(path_name) };
    let names = serde_json::from_slice(&text).map_err(|error| SceneError::Syntax {
        file: file.display().to_string(),
        at: String::new(),
        problem: format!(
            "does not name the files beside it as a run writes it ({error}); remove it, and they \
                          are called by their names there"
        ),
    });
    let mut names: BTreeMap<String, String> = names?;
    Ok(path.file_name().and_then(|name| names.remove(name.to_str()?)).unwrap_or(path_name))
}

/// Name under which a run keeps the file of a setting: workbooks and arrays keep their ending.
fn kept_name(setting: &str, path: &Path) -> String {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match setting {
        "filter.density" => RECORD.into(),
        "network.file" => format!("network.{}", if ending == "npz" { "npz" } else { "csv" }),
        _ => {
            let is_workbook = SIEVES.contains(&setting) && ["xlsx", "ods", "ags"].contains(&&*ending);
            let ending = if is_workbook { &ending } else { "csv" };
            format!("{}.{ending}", setting.replace(['.', '_'], "-"))
        }
    }
}

/// Hint for a path with a backslash as separator on a system that does not use it, or with a character
/// formed by a backslash and the next letter in double quotes.
fn of_windows(path: &Path) -> &'static str {
    let text = path.to_string_lossy();
    let escaped = text.contains(['\t', '\n', '\r', '\u{8}', '\u{c}', '\u{1b}']);
    match escaped || text.contains('\\') && !std::path::is_separator('\\') {
        true => " (write / between folders, not a backslash)",
        false => "",
    }
}

/// Settings that name a soil.
const SIEVES: [&str; 2] = ["base.sieve", "filter.sieve"];

/// Reads and remembers the files of a scene.
#[derive(Default)]
pub(crate) struct Files {
    /// Files that were read, in order.
    pub(crate) inputs: Vec<Input>,
    /// Files read before for the same settings, which are not read again.
    pub(crate) known: Vec<Input>,
}

impl Files {
    /// Reads a regular file once and keeps its contents.
    fn read(
        &mut self,
        setting: &'static str,
        path: &Path,
        largest: u64,
        scene: &str,
    ) -> Result<(String, &[u8]), CaseError> {
        let file = path.display().to_string();
        if let Some(at) = self.known.iter().position(|input| input.setting == setting) {
            self.inputs.push(self.known.swap_remove(at));
            return Ok((file, &self.inputs[self.inputs.len() - 1].bytes));
        }
        // A soil of the built-in scene was named on the command line, usually without its setting.
        let is_plain = scene == BUILT_IN_NAME && SIEVES.contains(&setting);
        let by = if is_plain { String::new() } else { format!(", named by {setting}") };
        let named = format!("{file}{by}{}", of_windows(path));
        self.keep(setting, path, read_file(path, &named, largest)?)?;
        Ok((file, &self.inputs[self.inputs.len() - 1].bytes))
    }

    fn keep(&mut self, setting: &'static str, path: &Path, bytes: Vec<u8>) -> Result<(), CaseError> {
        let kept_as = kept_name(setting, path);
        debug_assert!(INPUT_FILES.contains(&&*kept_as), "{kept_as} would outlive its run");
        let (name, kept_as, bytes) =
            (first_name(path, None)?, format!("{INPUTS}/{kept_as}"), Arc::new(bytes));
        self.inputs.push(Input { setting, name, kept_as, bytes, soil: None, notes: Vec::new() });
        Ok(())
    }

    pub(crate) fn curve(
        &mut self,
        source: &CurveSource,
        setting: &'static str,
        scene: &str,
    ) -> Result<(Curve, Option<&'static ShippedFilter>), CaseError> {
        match source {
            CurveSource::Shipped(name) => {
                let shipped = find(name).map_err(|error| SceneError::Clash {
                    file: format!("{scene}, {setting}"),
                    problem: error.to_string(),
                })?;
                Ok((shipped.curve()?, Some(shipped)))
            }
            CurveSource::File(path) => {
                let (name, bytes) = self.read(setting, path, LARGEST_TABLE, scene)?;
                Ok((Curve::from_csv_text(&name, bytes)?, None))
            }
        }
    }

    /// Curve of a packed filter; kept as if it had been given, with the packing's record.
    pub(crate) fn packed(&mut self, packed: &PackedFilter) -> Result<Curve, CaseError> {
        if let Some([curve, record]) = &packed.files {
            self.keep("filter.curve", curve, packed.curve_csv.clone().into_bytes())?;
            self.keep("filter.density", record, packed.record.clone())?;
        }
        Ok(packed.curve.clone())
    }

    pub(crate) fn sieve(
        &mut self,
        path: &Path,
        d0_mm: Option<f64>,
        setting: &'static str,
        scene: &str,
    ) -> Result<Gradation, CaseError> {
        let (path, soil) = file_and_soil(path);
        let (name, bytes) = self.read(setting, &path, LARGEST_TABLE, scene)?;
        let read = Soil::one(&name, bytes, soil.as_deref())?;
        let gradation = read.gradation(d0_mm)?;
        if let Some(input) = self.inputs.last_mut() {
            input.name = first_name(&path, soil.as_deref())?;
            input.soil = soil;
            input.notes = read.notes().to_vec();
        }
        Ok(gradation)
    }

    /// Grains of a file, and its name for users.
    pub(crate) fn packing(&mut self, path: &Path, scene: &Scene) -> Result<(String, Packing), CaseError> {
        let (name, bytes) = self.read("network.packing", path, PACKING_FILE_LIMIT_BYTES, &scene.name)?;
        let options = ReadOptions { unit: scene.network.unit, cell: scene.network.cell };
        let read = Packing::parse_as(&name, bytes, &options);
        let (packing, notes) = read.map_err(PackedError::from)?;
        if let Some(input) = self.inputs.last_mut() {
            input.notes = notes.iter().map(|note| words::reading(note, &name)).collect();
        }
        Ok((name, packing))
    }

    /// Grains of a packed filter; kept as if they had been given.
    pub(crate) fn packed_grains(&mut self, grains: &[u8]) -> Result<(String, Packing), CaseError> {
        self.keep("network.packing", Path::new(GRAINS), grains.to_vec())?;
        Ok((GRAINS.into(), Packing::parse(GRAINS, grains).map_err(PackedError::from)?))
    }

    pub(crate) fn network(&mut self, path: &Path, scene: &Scene, unit_mm: f64) -> Result<Network, CaseError> {
        let (name, bytes) = self.read("network.file", path, LARGEST_NETWORK, &scene.name)?;
        if !scene.network.is_of_arrays() {
            let network = Network::from_csv(bytes, &name, unit_mm)?;
            if !network.leads_out() {
                let problem = "no open way leads from a start node to an outlet: rows with diameters above 0 \
                               must lead from a `start,ID,` to a `FROM,end,DIAMETER`";
                return Err(NetworkError::Whole { file: name, problem: problem.into() }.into());
            }
            return Ok(network);
        }
        let unit = scene.network.unit.ok_or_else(|| {
            scene.clash(format!(
                "{name} does not say the unit of its diameters, and a guess may be wrong by a factor \
                 of 1000; give it: network.unit = \"m\" (or \"cm\", \"mm\", \"um\", \
                 \"nm\"; OpenPNM has metres)"
            ))
        })?;
        let (rule, rho) = (scene.exit_rule(), scene.exits.rho.unwrap_or(0.0));
        Ok(Network::from_npz(bytes, &name, &ArrayOptions { unit, rule, rho, unit_mm })?)
    }
}
