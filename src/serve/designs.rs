//! How coarse may the filter be, as the page asks: what it may say, and what it is shown.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::sheets::Sheets;
use crate::constrictions;
use crate::outcome::design::band::Band;
use crate::outcome::design::{Design, DesignFinding, share_of_networks};
use crate::run::{PrepareOptions, RunError};
use crate::study::design::{DesignOptions, ThicknessList};

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
    pub inverse: bool,
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
    inverse: bool,
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
            inverse: self.inverse,
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
            inverse: self.inverse,
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
        match self.inverse {
            false => format!("How coarse may a filter as of {filter} be for {}?", named(&self.base)),
            true => format!("How fine may a base as of {} be for {filter}?", named(&self.base)),
        }
    }
}

/// What stands between commas.
fn listed(text: &str) -> Vec<String> {
    text.split(',').map(str::trim).filter(|one| !one.is_empty()).map(str::to_owned).collect()
}

/// What the page shows of a design: its boundaries as they stand in `design.json`, without each network.
///
/// # Errors
/// A number that is none.
pub fn of_design(design: &Design) -> Result<Value, serde_json::Error> {
    let mut boundaries = serde_json::to_value(&design.boundaries)?;
    let rows = boundaries.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut);
    for (row, of) in rows.zip(&design.boundaries) {
        row.shift_remove("networks");
        for (name, shown) in ["no_erosion", "continuing"].into_iter().zip(of.shown()) {
            row.insert(name.into(), serde_json::to_value(shown)?);
        }
        // A limit is rounded inward, which no script of the page does.
        let practice = of.band.as_ref().and_then(Band::practice_in_words);
        row.insert("practice".into(), practice.into());
    }
    Ok(json!({
        "inverse": design.inverse,
        "answer": design.answer(),
        "base": design.base.name,
        "d85b": design.base.size().map(|base| base.words()),
        "filter": design.filter,
        "boundaries": boundaries,
        "share_of_networks": share_of_networks(design.replicates),
        "replicates": design.replicates,
        "fits_by_practice": design.fits_by_practice(),
        "cautions": design.cautions().iter().map(DesignFinding::words).collect::<Vec<_>>(),
        "warnings": design.findings_beside_cautions(),
        "products": design.products_in_words(),
        "model_leaves_out": design.model_leaves_out,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::design::band::SetBy;
    use crate::outcome::design::{Boundary, Specification};
    use crate::verdict::SpecificationOptions;

    /// The limit of practice is 0.8069 mm, and its base is not stable itself.
    #[test]
    fn limits_are_rounded_inward_and_the_base_is_warned_of_once() {
        let gap = [(0.01, 0.0), (0.075, 20.0), (0.425, 29.0), (2.0, 30.0), (4.75, 50.0), (19.0, 100.0)];
        let gap = Gradation::from_lines(&gap).unwrap();
        let of = Specification::of("gap", &[("gap".into(), gap)], SpecificationOptions::default());
        let unstable = of.findings.iter().find(|of| of.finding.id == "unstable_base").unwrap().clone();
        let text = json!({
            "version": "1", "inverse": false, "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
            "unit": "mm",
            "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": 0.2, "d95_over_d85": null,
                "tail_mass_fraction": 0.0},
            "threshold": 0.075, "replicates": 2, "seed": 1, "engine": "expected", "bracket": [0.5, 100.0],
            "step": 0.005,
            "rules": [], "rules_at": 1.75,
            "products": [], "findings": [unstable.clone()],
            "model_leaves_out": [], "settings": [], "seconds": 1.0, "specification": of,
            "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
                "grains_per_void": 0.6, "no_erosion": null, "continuing": null, "not_monotone": 0,
                "networks": [], "band": null}],
        });
        let mut design: Design = serde_json::from_value(text).unwrap();
        let band = Band {
            least: 0.7,
            least_at_most: false,
            greatest: 0.75,
            set_by: SetBy::Walk,
            practice: Some(0.8069),
            practice_rule: "r".into(),
            practice_rule_id: None,
            unit: "mm".into(),
            is_empty: false,
            said: "D15F from 0.700 to 0.750 mm".into(),
        };
        design.boundaries[0].band = Some(band);
        let shown = of_design(&design).unwrap();
        assert_eq!(shown["boundaries"][0]["practice"], "practice allows up to 0.806 mm");
        assert_eq!(shown["cautions"][0], unstable.words());
        // The page shows the answer part by part.
        assert_eq!(shown["answer"]["limit"], design.answer().limit);
        assert!(!design.answer().limit.is_empty());
        assert_eq!(shown["warnings"], json!([]));
        // Without a specification the warning stays where it was.
        let alone = Design { specification: None, ..design };
        assert_eq!(of_design(&alone).unwrap()["warnings"].as_array().unwrap().len(), 1);
    }

    /// Five networks: the ends on the page are the least and the most of them.
    #[test]
    fn of_few_networks_the_page_has_least_and_most() {
        let ratios = [4.0, 4.4, 4.8, 5.0, 6.0];
        let boundary = Boundary::of(&ratios.map(Ok), Some(0.5)).unwrap();
        let networks = ratios.map(|ratio| json!({"network": 1, "no_erosion": ratio, "continuing": null}));
        let text = json!({
            "version": "1", "inverse": false, "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
            "unit": "mm",
            "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": 0.5, "d95_over_d85": null,
                "tail_mass_fraction": 0.0},
            "threshold": 0.075, "replicates": 5, "seed": 1, "engine": "expected", "bracket": [0.5, 100.0],
            "step": 0.005,
            "rules": [], "rules_at": 1.75,
            "products": [], "findings": [],
            "model_leaves_out": [], "settings": [], "seconds": 1.0, "specification": null,
            "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
                "grains_per_void": 0.6, "no_erosion": boundary, "continuing": null, "not_monotone": 0,
                "networks": networks, "band": null}],
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
            inverse: false,
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
