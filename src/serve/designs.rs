//! How coarse may the filter be, as the page asks: what it may say, and what it is shown.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::sheets::Sheets;
use crate::constrictions;
use crate::outcome::design::{Design, RowNote};
use crate::outcome::quantity::SizeUnit;
use crate::run::{PrepareOptions, RunError};
use crate::study::design::{DesignOptions, ThicknessList};
use crate::words::base_size;
use crate::words::design::{design_lines, share_of_networks};
use crate::words::left_out::model_limit;
use crate::words::products::products;
use crate::words::specification::{DESIGN_AGAIN, if_dispersive, without_margin};
use crate::words::{row_note, sentence};

/// What the page asks for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AskedDesign {
    /// The sheet of the base, by its number.
    pub base: String,
    /// The sheet whose form the filter has, by its number; empty where `shape` says it.
    #[serde(default)]
    pub filter: String,
    /// A Cu, or the name of a shipped curve; empty where the settings say it.
    #[serde(default)]
    pub shape: String,
    /// Densities and thicknesses as on the command line, with commas between them.
    #[serde(default)]
    pub density: String,
    /// This very filter is packed.
    #[serde(default)]
    pub pack: bool,
    #[serde(default)]
    pub thickness: String,
    #[serde(default)]
    pub as_sampled: bool,
    #[serde(default)]
    pub as_given: bool,
    #[serde(default)]
    pub changes: Vec<String>,
}

/// The same with its sheets found. Paths are below the server's folder, which may be moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptDesign {
    base: PathBuf,
    filter: FilterShape,
    densities: Vec<String>,
    #[serde(default)]
    pack: bool,
    thicknesses: Vec<String>,
    #[serde(default)]
    as_sampled: bool,
    #[serde(default)]
    as_given: bool,
    settings: Vec<String>,
}

/// Where a filter's form comes from. What a browser writes is never the name of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum FilterShape {
    /// A sheet.
    Sheet(PathBuf),
    /// A Cu or the name of a shipped curve.
    Named(String),
    /// The settings say it.
    Settings,
}

impl AskedDesign {
    /// Finds the sheets, and that a shape in words is no file.
    ///
    /// # Errors
    /// There is no such sheet, or no such shape.
    pub fn found(self, sheets: &Sheets, root: &Path) -> Result<KeptDesign, String> {
        let path = |sheet: &str| -> Result<PathBuf, String> {
            let path = sheets.path(sheet)?;
            Ok(path.strip_prefix(root).map(Path::to_owned).unwrap_or(path))
        };
        let shape = self.shape.trim();
        let filter = match (self.filter.is_empty(), shape.is_empty()) {
            (false, true) => FilterShape::Sheet(path(&self.filter)?),
            (true, true) => FilterShape::Settings,
            (true, false) => {
                if shape.parse::<f64>().is_err() {
                    constrictions::find(shape).map_err(|error| error.to_string())?;
                }
                FilterShape::Named(shape.to_owned())
            }
            (false, false) => return Err("a sheet and a shape both say the filter's form: keep one".into()),
        };
        Ok(KeptDesign {
            base: path(&self.base)?,
            filter,
            densities: listed(&self.density),
            pack: self.pack,
            thicknesses: listed(&self.thickness),
            as_sampled: self.as_sampled,
            as_given: self.as_given,
            settings: self.changes,
        })
    }
}

impl KeptDesign {
    /// As the library is asked for it, with its results in `out`.
    ///
    /// # Errors
    /// A thickness that is none.
    pub fn options(
        &self,
        root: &Path,
        out: &Path,
        prepare: &PrepareOptions,
    ) -> Result<DesignOptions, RunError> {
        // As a whole: a decimal comma makes no two of one.
        let ThicknessList(thicknesses) = match &self.thicknesses[..] {
            [] => ThicknessList(Vec::new()),
            all => all.join(",").parse().map_err(RunError::Refused)?,
        };
        let filter = match &self.filter {
            FilterShape::Sheet(path) => Some(root.join(path).display().to_string()),
            FilterShape::Named(shape) => Some(shape.clone()),
            FilterShape::Settings => None,
        };
        Ok(DesignOptions {
            base: Some(root.join(&self.base)),
            filter,
            densities: self.densities.clone(),
            pack: self.pack,
            thicknesses,
            settings: self.settings.clone(),
            as_sampled: self.as_sampled,
            as_given: self.as_given,
            out: out.to_owned(),
            prepare: prepare.clone(),
            ..DesignOptions::default()
        })
    }

    /// What it is called in the list of jobs.
    pub fn title(&self) -> String {
        let named = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let filter = match &self.filter {
            FilterShape::Sheet(path) => named(path),
            FilterShape::Named(shape) if shape.parse::<f64>().is_ok() => format!("Cu {shape}"),
            FilterShape::Named(shape) => shape.clone(),
            FilterShape::Settings => "its settings".into(),
        };
        format!("How coarse may a filter as of {filter} be for {}?", named(&self.base))
    }
}

/// What stands between commas.
fn listed(text: &str) -> Vec<String> {
    text.split(',').map(str::trim).filter(|one| !one.is_empty()).map(str::to_owned).collect()
}

/// The lines of practice and model of a design, and its boundaries as they stand in `design.json`, without
/// each network.
///
/// # Errors
/// A number that is none.
pub fn of_design(design: &Design) -> Result<Value, serde_json::Error> {
    let unit = SizeUnit::of(false, design.inches);
    let mut boundaries = serde_json::to_value(&design.boundaries)?;
    let rows = boundaries.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut);
    for (row, of) in rows.zip(&design.boundaries) {
        row.shift_remove("networks");
        for (name, shown) in ["no_erosion", "continuing"].into_iter().zip(of.shown()) {
            row.insert(name.into(), serde_json::to_value(shown)?);
        }
        for (name, notes) in [("no_erosion", &of.no_erosion_notes), ("continuing", &of.continuing_notes)] {
            let words: Vec<String> = notes.iter().map(|note| sentence(note, unit)).collect();
            row.insert(format!("{name}_notes"), words.into());
        }
    }
    let practice = design.specification.as_ref();
    let words = |notes: &[RowNote]| notes.iter().map(|row| row_note(row, unit)).collect::<Vec<_>>();
    Ok(json!({
        "lines": design_lines(design, unit),
        "beside": practice.map(|of| [without_margin(of, unit), if_dispersive(of, DESIGN_AGAIN, unit)]),
        "base": design.base.name,
        "d85b": design.base.size().map(|base| base_size(&base, unit)),
        "filter": design.filter,
        "boundaries": boundaries,
        "share_of_networks": share_of_networks(design.replicates),
        "replicates": design.replicates,
        "cautions": practice.map(|of| words(&of.notes)),
        "warnings": words(&design.notes),
        "products": practice.map(products),
        "model_leaves_out":
            design.model_leaves_out.iter().map(|limit| model_limit(*limit)).collect::<Vec<_>>(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::design::Boundary;

    /// Five networks: the ends on the page are the least and the most of them.
    #[test]
    fn of_few_networks_the_page_has_least_and_most() {
        let ratios = [4.0, 4.4, 4.8, 5.0, 6.0];
        let boundary = Boundary::of(&ratios.map(Ok), Some(0.5)).unwrap();
        let networks = ratios.map(|ratio| json!({"network": 1, "no_erosion": ratio, "continuing": null}));
        let text = json!({
            "version": "1", "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
            "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": 0.5, "d95_over_d85": null,
                "tail_mass_fraction": 0.0},
            "threshold": 0.075, "replicates": 5, "seed": 1, "engine": "expected", "bracket": [0.5, 100.0],
            "step": 0.005,
            "notes": [], "model_leaves_out": [], "settings": [], "seconds": 1.0, "specification": null,
            "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
                "grains_per_void": 0.6, "no_erosion": boundary, "continuing": null, "not_monotone": 0,
                "networks": networks}],
        });
        let shown = of_design(&serde_json::from_value(text).unwrap()).unwrap();
        let no_erosion = &shown["boundaries"][0]["no_erosion"];
        assert_eq!((&no_erosion["low"], &no_erosion["high"]), (&json!(4.0), &json!(6.0)));
        assert_eq!(no_erosion["d15f_mm"]["high"], 3.0);
        assert!(shown["boundaries"][0]["continuing"].is_null());
        assert_eq!(shown["share_of_networks"], "least and most");
    }

    fn asked(filter: &str, shape: &str) -> AskedDesign {
        let [filter, shape] = [filter, shape].map(str::to_owned);
        AskedDesign {
            base: "1".into(),
            filter,
            shape,
            density: "loose, dense,".into(),
            thickness: "8layers".into(),
            pack: false,
            as_sampled: false,
            as_given: false,
            changes: Vec::new(),
        }
    }

    #[test]
    fn a_shape_is_a_sheet_a_number_or_a_shipped_name_and_never_a_file() {
        let root = tempfile::tempdir().unwrap();
        let sheets = Sheets::new(root.path());
        sheets.add("base.csv", b"size_mm,percent\n1,0\n2,100\n").unwrap();
        let outside = root.path().join("outside.csv").display().to_string();
        std::fs::write(&outside, "size_mm,percent\n1,0\n2,100\n").unwrap();
        let found = |filter: &str, shape: &str| asked(filter, shape).found(&sheets, root.path());
        for wrong in [&outside, "sheets/1/base.csv", "outside.csv", "cu1.5-lose", "Cargo.toml"] {
            assert!(found("", wrong).unwrap_err().contains("no shipped filter is called"), "{wrong}");
        }
        assert!(found("7", "").is_err() && found("../1", "").is_err() && found("1", "3").is_err());
        for (filter, shape) in [("1", ""), ("", "3"), ("", "cu1.5-loose"), ("", "")] {
            let kept = found(filter, shape).unwrap();
            assert_eq!(kept.base, Path::new("sheets/1/base.csv"), "below the folder, which may be moved");
            assert_eq!(kept.densities, ["loose", "dense"]);
        }
    }
}
