//! The plan of the boundaries that are asked for: a case for each density and thickness.

use std::path::{Path, PathBuf};

use super::options::{BoundaryOptions, Thickness};
use crate::case::end_of_guess;
use crate::cases::plan::{CasePlan, PlannedCase, crossed};
use crate::outcome::stopping::StopRule;
use crate::run::error::RunError;
use crate::scene::{
    Base, BaseGradation, D85, Density, Extent, LibraryDensity, NetworkSource, Regrade, Scene, TableOptions,
    USUAL_LAYERS, keep_soils, quoted,
};
use voidwalk_core::schema::setting_name;
use voidwalk_core::walk::Engine;

/// Default number of voids across a lattice: the same as in the study of real soils.
const ACROSS: u64 = 20;

/// Default number of networks: the fewest that give percentiles.
const NETWORKS: u64 = 5;

/// Settings that state how thick a filter is.
const THICKNESSES: [&str; 4] =
    ["network.nz", "network.copies", "network.thickness_mm", "network.thickness_d50f"];

/// Every density with every thickness.
///
/// # Errors
/// Settings that are refused.
pub(super) fn plan(options: &BoundaryOptions) -> Result<CasePlan, RunError> {
    let common = common(options)?;
    let (densities, thicknesses) = (densities(options)?, thicknesses(options)?);
    let mut plan = CasePlan {
        file: "boundary".into(),
        title: String::new(),
        factors: vec!["density".into(), "thickness".into()],
        cases: Vec::new(),
    };
    for chosen in crossed(&[&densities[..], &thicknesses]) {
        let settings: Vec<String> = common.iter().chain(chosen.into_iter().flatten()).cloned().collect();
        let scene = scene(&settings, options.as_given)?;
        let levels = [density_words(&scene), Thickness::of(&scene.network).to_string()];
        let name = levels.join(", ");
        if plan.case(&name).is_some() {
            return Err(RunError::Refused(format!("{name}: asked for twice")));
        }
        let levels = plan.factors.iter().cloned().zip(levels).collect();
        plan.cases.push(PlannedCase { name, levels, scene });
    }
    Ok(plan)
}

/// The settings of every case.
fn common(options: &BoundaryOptions) -> Result<Vec<String>, RunError> {
    let BoundaryOptions { base, filter, settings, .. } = options;
    let base_name = base.as_ref().map(|base| base.display().to_string());
    keep_soils(settings, base_name.as_deref(), filter.as_deref())?;
    let mut all = settings.clone();
    if let Some(base) = base {
        all.push(format!("base.sieve={}", quoted(base)?));
    }
    if let Some(shape) = filter {
        all.push(stated(settings, "--filter", shape_setting(shape))?);
    }
    if options.as_sampled {
        all.push(stated(settings, "--as-sampled", TableOptions::AS_SAMPLED.into())?);
    }
    Ok(all)
}

fn densities(options: &BoundaryOptions) -> Result<Vec<Option<String>>, RunError> {
    let BoundaryOptions { pack, settings, .. } = options;
    if options.densities.is_empty() {
        let changes = settings.iter().cloned().chain(options.filter.as_deref().map(shape_setting)).collect();
        let tables = TableOptions { pack: *pack, changes, ..TableOptions::default() };
        return Ok(vec![options.filter.as_ref().and_then(|_| tables.density_setting())]);
    }
    let setting = |density: &String| {
        let setting = density_setting(density, *pack)?;
        setting.map(|setting| stated(settings, "--density", setting)).transpose()
    };
    options.densities.iter().map(setting).collect()
}

fn thicknesses(options: &BoundaryOptions) -> Result<Vec<Option<String>>, RunError> {
    let setting =
        |thickness: &Thickness| stated(&options.settings, "--thickness", thickness.setting()).map(Some);
    match options.thicknesses.is_empty() {
        true => Ok(vec![None]),
        false => options.thicknesses.iter().map(setting).collect(),
    }
}

/// The setting that an option states, unless `settings` state it again.
fn stated(settings: &[String], option: &str, setting: String) -> Result<String, RunError> {
    let is_again = |name: &str| match option {
        "--thickness" => THICKNESSES.contains(&name),
        _ => name == setting_name(&setting),
    };
    match settings.iter().find(|again| is_again(setting_name(again))) {
        Some(again) => {
            Err(RunError::Refused(format!("{option} and --set {again} say the same thing twice: give one")))
        }
        None => Ok(setting),
    }
}

/// The setting that states a shape: a Cu, a sieve table or a shipped name.
fn shape_setting(shape: &str) -> String {
    // Otherwise a name that reads as a number, or as anything else but text, would not stay text.
    let text = |name: &str| toml::Value::String(name.to_owned()).to_string();
    let file = shape.split('#').next().unwrap_or(shape);
    let is_file = shape.contains(['/', '\\', '#']) || Path::new(file).is_file();
    let ending = Path::new(file).extension().and_then(|e| e.to_str()).map(str::to_lowercase);
    let is_table = ending.is_some_and(|e| ["csv", "txt", "tsv", "xlsx", "ods", "ags"].contains(&&*e));
    match shape.trim().parse::<f64>() {
        Ok(_) => format!("filter.cu={}", shape.trim()),
        Err(_) if is_file || is_table => format!("filter.sieve={}", text(shape)),
        Err(_) => format!("filter.curve={}", text(shape)),
    }
}

/// The setting that states a density.
fn density_setting(density: &str, pack: bool) -> Result<Option<String>, RunError> {
    let word = Density::named(density);
    match density.split_once('=') {
        Some(("estimate", _)) if pack => Err(RunError::refused(
            "--pack and --density estimate say how the constrictions are found: keep one",
        )),
        Some((name @ ("friction" | "estimate"), value)) => Ok(Some(format!("filter.{name}={value}"))),
        None if word.is_some() || (!pack && density == LibraryDensity::Unknown.name()) => {
            Ok(TableOptions { density: word, pack, ..TableOptions::default() }.density_setting())
        }
        _ => Err(RunError::Refused(format!(
            "--density {density}: allowed: dense, medium (or intermediate) or loose, unknown (without \
             --pack), friction=0.2 (0 to 10), or estimate=0.5 (a relative density from 0 to 1, without a \
             packing)"
        ))),
    }
}

fn scene(settings: &[String], as_given: bool) -> Result<Scene, RunError> {
    let mut scene = Scene::built_in(settings)?;
    refuse(&scene)?;
    let has_size = match scene.base.gradation() {
        BaseGradation::Sieve(..) => true,
        BaseGradation::Linear { d85, .. } => matches!(d85, D85::Mm(_)),
        BaseGradation::Single(_) => false,
    };
    if scene.base.regrade.is_none() && has_size {
        scene.base.regrade = Some(Regrade::Practice);
    }
    scene.is_guarded = !as_given;
    let is_lattice = matches!(scene.network.source(), NetworkSource::Cubic(_));
    if matches!(scene.network.extent(), Extent::Mm(_)) && !is_lattice {
        return Err(RunError::refused(
            "a thickness in mm goes with a lattice: of a packing's own voids the filter's size says how many \
             copies there are, and it is searched for; give network.copies or a multiple of D50F",
        ));
    }
    let is_stated =
        |key: &str| settings.iter().any(|setting| setting_name(setting).split('.').next_back() == Some(key));
    if is_lattice && !["nx", "ny"].into_iter().any(is_stated) {
        scene.network.narrow_to(ACROSS);
    }
    if !is_stated("replicates") {
        scene.walk.replicates = NETWORKS;
    }
    if scene.walk.engine == Engine::Auto && !scene.leaves_openings() {
        // Rows that move at once take less time, and a boundary is the ratio at which the expectation crosses
        // 7.5 %.
        scene.walk.engine = Engine::Expected;
    }
    scene.record.sensitivity.clear();
    Ok(scene)
}

/// A scene with a base that any filter can be drafted with, and with layers if a ratio decides them.
pub(super) fn with_any_base(scene: &Scene) -> Scene {
    let mut drafted = scene.clone();
    if matches!(scene.network.extent(), Extent::Mm(_)) {
        drafted.network.set_layers(USUAL_LAYERS);
    }
    drafted.base = Base {
        cu: Some(1.5),
        d15f_over_d85b: Some(5.0),
        d85_at_dc: None,
        d85_mm: None,
        dc_curve: None,
        sieve: None,
        d0_mm: None,
        single_mm: None,
        regrade: None,
        ..scene.base.clone()
    };
    drafted
}

/// Refuses settings of a scene that a search of boundaries cannot use.
fn refuse(scene: &Scene) -> Result<(), RunError> {
    if scene.stop != StopRule::default() {
        let problem = "stop.target_error_pp and stop.decide_percent do not go with `boundary`: replicates \
                       says how many networks its bands are taken over";
        return Err(RunError::refused(problem));
    }
    if scene.record.voids.is_some() {
        let problem =
            "record.voids does not go with `boundary`, which keeps no walk: set it in the scene of a run";
        return Err(RunError::refused(problem));
    }
    if scene.walk.runs != 2 {
        let problem =
            "runs = 1 does not go with `boundary`: continuing erosion is what the second run erodes";
        return Err(RunError::refused(problem));
    }
    Ok(())
}

/// Density of the packing of a scene's filter, in words.
fn density_words(scene: &Scene) -> String {
    let filter = &scene.filter;
    if let Some(density) = filter.library {
        return density.name().to_owned();
    }
    match (filter.density, filter.friction, filter.estimate, &filter.curve) {
        (Some(word), ..) => word.name().to_owned(),
        (None, Some(friction), ..) => format!("friction {friction}"),
        (.., Some(estimate), _) => {
            end_of_guess(estimate).map_or_else(|| format!("estimate {estimate}"), str::to_owned)
        }
        (.., Some(crate::scene::CurveSource::Shipped(name))) => {
            name.rsplit('-').next().unwrap_or(name).to_owned()
        }
        (.., Some(crate::scene::CurveSource::File(path))) => file_words("of the curve", path),
        _ => "as given".into(),
    }
}

fn file_words(what: &str, path: &Path) -> String {
    format!("{what} {}", path.file_name().map_or_else(PathBuf::new, PathBuf::from).display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_is_a_cu_a_file_or_a_shipped_name() {
        assert_eq!(shape_setting("3"), "filter.cu=3");
        assert_eq!(shape_setting("soils/f.csv"), "filter.sieve=\"soils/f.csv\"");
        assert_eq!(shape_setting("f.xlsx#Zone 2"), "filter.sieve=\"f.xlsx#Zone 2\"");
        assert_eq!(shape_setting("cu1.5-loose"), "filter.curve=\"cu1.5-loose\"");
    }

    #[test]
    fn no_setting_replaces_a_soil_that_is_named() {
        let refused = |filter: &str, setting: &str| {
            let options = BoundaryOptions {
                base: Some("b.csv".into()),
                filter: Some(filter.into()),
                settings: vec![setting.into()],
                ..BoundaryOptions::default()
            };
            let error = plan(&options).unwrap_err();
            assert_eq!(error.exit().code(), 2);
            error.to_string()
        };
        for (filter, setting, said) in [
            ("3", "base.sieve=other.csv", "in the place of the base, b.csv"),
            ("3", "filter.cu=1.5", "in the place of the filter, 3"),
            ("f.csv", "filter.sieve=g.csv", "in the place of the filter, f.csv"),
            ("cu3-loose", "filter.curve=cu6-loose", "say the same thing twice"),
        ] {
            let error = refused(filter, setting);
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn a_file_whose_name_reads_as_a_number_is_one() {
        for name in ["7", "1e5", "true", "7#Zone 2"] {
            let options = BoundaryOptions {
                base: Some(name.into()),
                filter: Some(format!("./{name}")),
                ..BoundaryOptions::default()
            };
            let scene = plan(&options).unwrap().cases.remove(0).scene;
            assert_eq!(scene.base.sieve.as_deref(), Some(Path::new(name)));
            assert_eq!(scene.filter.sieve, Some(PathBuf::from(format!("./{name}"))));
        }
    }

    #[test]
    fn every_density_goes_with_every_thickness() {
        let options = |densities: &[&str], thicknesses: &[&str]| BoundaryOptions {
            filter: Some("3".into()),
            densities: densities.iter().map(ToString::to_string).collect(),
            thicknesses: thicknesses.iter().map(|text| text.parse().unwrap()).collect(),
            ..BoundaryOptions::default()
        };
        let names = |densities: &[&str], thicknesses: &[&str]| -> Vec<String> {
            let cases = plan(&options(densities, thicknesses)).unwrap().cases;
            cases.into_iter().map(|case| case.name).collect()
        };
        assert_eq!(
            names(&["loose", "friction=0.1"], &["500mm", "30layers"]),
            ["loose, 500 mm", "loose, 30 layers", "friction 0.1, 500 mm", "friction 0.1, 30 layers"]
        );
        assert_eq!(names(&[], &[]), ["unknown, 60 layers"]);
        for same in [["loose", "loose"], ["medium", "intermediate"]] {
            let twice = plan(&options(&same, &[])).unwrap_err();
            assert!(twice.to_string().contains("asked for twice") && twice.exit().code() == 2);
        }
        // Reads the options like a scene.
        let first = |options: &BoundaryOptions| plan(options).unwrap().cases.remove(0);
        let medium = first(&options(&["medium"], &[]));
        let scene = Scene::built_in(&["filter.cu=3".into(), "filter.library=medium".into()]).unwrap();
        assert_eq!(medium.levels[0], ("density".into(), "intermediate".into()));
        assert_eq!(medium.scene.filter.library, scene.filter.library);
        let packed = BoundaryOptions { pack: true, ..options(&["medium"], &[]) };
        assert_eq!(first(&packed).scene.filter.density, Some(Density::Intermediate));
        let voids = BoundaryOptions { settings: vec!["record.voids=[1]".into()], ..options(&[], &[]) };
        let refused = plan(&voids).unwrap_err();
        assert!(refused.to_string().contains("record.voids does not go") && refused.exit().code() == 2);
        let wrong = plan(&options(&["2"], &[])).unwrap_err().to_string();
        assert!(wrong.contains("dense, medium (or intermediate) or loose"), "{wrong}");
        let wrong = plan(&options(&["estimate=1.5"], &[])).unwrap_err().to_string();
        assert!(wrong.contains("relative density from 0 (loose) to 1"), "{wrong}");
    }
}
