//! What boundaries are asked for, as scenes: one for each density and thickness.

use std::path::{Path, PathBuf};

use crate::case::end_of_guess;
use crate::outcome::stopping::StopRule;
use crate::run::error::RunError;
use crate::scene::{
    Base, BaseGradation, D85, Density, Extent, LibraryDensity, NetworkSource, Regrade, Scene, keep_soils,
    quoted,
};
use crate::schema::setting_name;
use crate::walk::Engine;

use super::options::{BoundaryOptions, Thickness};

/// Voids across of a lattice whose width nobody states: as in the study of real soils.
const ACROSS: u64 = 20;

/// Networks where nobody states how many replicates there are: the fewest that give percentiles.
const NETWORKS: u64 = 5;

/// One density and thickness.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    /// The scene as it is stated, base and all.
    pub scene: Scene,
    /// The same with a base that any filter can be drafted with.
    pub of_filter: Scene,
    /// The density in words.
    pub density: String,
    /// The thickness.
    pub thickness: Thickness,
    /// Whether the finest filter grain is stated (mm).
    pub states_d0: bool,
}

/// Every density with every thickness.
///
/// # Errors
/// Settings that are refused.
pub(super) fn wanted(options: &BoundaryOptions) -> Result<Vec<Wanted>, RunError> {
    let thicknesses: Vec<Option<Thickness>> = match options.thicknesses.is_empty() {
        true => vec![None],
        false => options.thicknesses.iter().copied().map(Some).collect(),
    };
    let densities: Vec<Option<String>> = match (options.densities.is_empty(), default_density(options)) {
        (true, default) => vec![default],
        (false, _) => options.densities.iter().cloned().map(Some).collect(),
    };
    let mut all = Vec::new();
    for density in &densities {
        for &thickness in &thicknesses {
            all.push(one(options, density.as_deref(), thickness)?);
        }
    }
    let same = |a: &Wanted, b: &Wanted| a.density == b.density && a.thickness == b.thickness;
    for (index, wanted) in all.iter().enumerate() {
        if all[..index].iter().any(|before| same(before, wanted)) {
            let problem = format!("{}, {}: asked for twice", wanted.density, wanted.thickness);
            return Err(RunError::Refused(problem));
        }
    }
    Ok(all)
}

/// The density of a shape that has none of its own: any, from loose to dense; loose where it is to be packed.
fn default_density(options: &BoundaryOptions) -> Option<String> {
    let stated = |setting: &String| {
        let names =
            ["filter.density", "filter.friction", "filter.library", "filter.estimate", "filter.curve"];
        names.contains(&setting_name(setting))
    };
    let needs_one = options.filter.as_deref().is_some_and(|shape| !shape_setting(shape).0);
    (needs_one && !options.settings.iter().any(stated)).then(|| match options.pack {
        true => Density::Loose.name().to_owned(),
        false => LibraryDensity::Unknown.name().to_owned(),
    })
}

/// Whether a shape has its constrictions, and the setting that says it: a Cu, a sieve table or a shipped
/// name.
fn shape_setting(shape: &str) -> (bool, String) {
    // Or a name that reads as a number, or as anything else that is no text, would not stay one.
    let text = |name: &str| toml::Value::String(name.to_owned()).to_string();
    let file = shape.split('#').next().unwrap_or(shape);
    let is_file = shape.contains(['/', '\\', '#']) || Path::new(file).is_file();
    let ending = Path::new(file).extension().and_then(|e| e.to_str()).map(str::to_lowercase);
    let is_table = ending.is_some_and(|e| ["csv", "txt", "tsv", "xlsx", "ods", "ags"].contains(&&*e));
    match shape.trim().parse::<f64>() {
        Ok(_) => (false, format!("filter.cu={}", shape.trim())),
        Err(_) if is_file || is_table => (false, format!("filter.sieve={}", text(shape))),
        Err(_) => (true, format!("filter.curve={}", text(shape))),
    }
}

/// The setting that says a density.
fn density_setting(density: &str, pack: bool) -> Result<String, RunError> {
    if let Some((name @ ("friction" | "estimate"), value)) = density.split_once('=') {
        if pack && name == "estimate" {
            return Err(RunError::refused(
                "--pack and --density estimate say how the constrictions are found: keep one",
            ));
        }
        return Ok(format!("filter.{name}={value}"));
    }
    match Density::named(density) {
        Some(word) if pack => return Ok(format!("filter.density={}", word.name())),
        Some(word) => return Ok(format!("filter.library={}", word.name())),
        None if !pack && density == LibraryDensity::Unknown.name() => {
            return Ok(format!("filter.library={density}"));
        }
        None => {}
    }
    Err(RunError::Refused(format!(
        "--density {density}: allowed: dense, medium (or intermediate) or loose, unknown (without \
         --pack), friction=0.2 (0 to 10), or estimate=0.5 (a relative density from 0 to 1, without a packing)"
    )))
}

fn one(
    options: &BoundaryOptions,
    density: Option<&str>,
    thickness: Option<Thickness>,
) -> Result<Wanted, RunError> {
    let mut settings = options.settings.clone();
    let base = options.base.as_ref().map(|base| base.display().to_string());
    keep_soils(&settings, base.as_deref(), options.filter.as_deref())?;
    let of_base = options.base.as_deref().map(quoted).transpose()?.map(|base| format!("base.sieve={base}"));
    let of_filter = options.filter.as_deref().map(|shape| shape_setting(shape).1);
    let of_density = density.map(|density| density_setting(density, options.pack)).transpose()?;
    let of_thickness = thickness.map(|thickness| match thickness {
        Thickness::Layers(layers) => format!("network.nz={layers}"),
        Thickness::D50F(multiple) => format!("network.thickness_d50f={multiple:?}"),
        Thickness::Mm(mm) => format!("network.thickness_mm={mm:?}"),
    });
    for (whose, said) in [("BASE", of_base), ("--filter", of_filter), ("--thickness", of_thickness)] {
        refuse_twice(options, whose, said.as_deref())?;
        settings.extend(said);
    }
    // Without --density the default is none that was said.
    refuse_twice(options, "--density", of_density.as_deref().filter(|_| !options.densities.is_empty()))?;
    settings.extend(of_density);
    let mut scene = Scene::built_in(&settings)?;
    refuse(&scene)?;
    regrade(&mut scene, options)?;
    scene.is_guarded = !options.as_given;
    let thickness = thickness.or(match scene.network.extent() {
        Extent::Mm(mm) => Some(Thickness::Mm(mm)),
        Extent::D50F(multiple) => Some(Thickness::D50F(multiple)),
        Extent::Copies(_) | Extent::Usual => None,
    });
    let is_lattice = matches!(scene.network.source(), NetworkSource::Cubic(_));
    if matches!(thickness, Some(Thickness::Mm(_))) && !is_lattice {
        return Err(RunError::refused(
            "a thickness in mm goes with a lattice: of a packing's own voids the filter's size says how many \
             copies there are, and it is searched for; give network.copies or a multiple of D50F",
        ));
    }
    if matches!(thickness, Some(Thickness::Mm(_))) {
        // How many layers that is hangs on the ratio.
        scene.network.set_layers(crate::scene::USUAL_LAYERS);
    }
    let is_stated = |key: &str| {
        options.settings.iter().any(|setting| setting_name(setting).split('.').next_back() == Some(key))
    };
    if is_lattice && !["nx", "ny"].into_iter().any(is_stated) {
        scene.network.narrow_to(ACROSS);
    }
    if !is_stated("replicates") {
        scene.walk.replicates = NETWORKS;
    }
    scene.walk.runs = 2;
    if scene.walk.engine == Engine::Auto && !scene.leaves_openings() {
        // Rows that move at once take less time, and a boundary is where the expectation crosses 7.5 %.
        scene.walk.engine = Engine::Expected;
    }
    scene.record.sensitivity.clear();
    let mut of_filter = scene.clone();
    of_filter.base = Base {
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
    let layers = scene.network.source().shape().map_or(crate::scene::USUAL_LAYERS, |[_, _, nz]| nz.into());
    let density = density_words(&scene);
    let thickness = thickness.unwrap_or(Thickness::Layers(layers));
    let states_d0 = options.settings.iter().any(|setting| setting_name(setting) == "filter.d0_mm");
    Ok(Wanted { scene, of_filter, density, thickness, states_d0 })
}

/// Has a base with a size of its own walked as practice regrades it, where nothing says otherwise.
fn regrade(scene: &mut Scene, options: &BoundaryOptions) -> Result<(), RunError> {
    if let (Some(said), true) = (scene.base.regrade, options.as_sampled) {
        return Err(RunError::Refused(format!(
            "--as-sampled and --set base.regrade={} say the same thing twice: give one",
            format!("{said:?}").to_lowercase()
        )));
    }
    let has_size = match scene.base.gradation() {
        BaseGradation::Sieve(..) => true,
        BaseGradation::Linear { d85, .. } => matches!(d85, D85::Mm(_)),
        BaseGradation::Single(_) => false,
    };
    if scene.base.regrade.is_none() && has_size && !options.as_sampled {
        scene.base.regrade = Some(Regrade::Practice);
    }
    Ok(())
}

/// Refuses a setting that says again what an argument of its own has said.
fn refuse_twice(options: &BoundaryOptions, whose: &str, said: Option<&str>) -> Result<(), RunError> {
    let Some(said) = said else { return Ok(()) };
    let alike = |key: &str| match whose {
        "--thickness" => THICKNESSES.contains(&key),
        _ => key == setting_name(said),
    };
    match options.settings.iter().find(|setting| alike(setting_name(setting))) {
        Some(setting) => {
            Err(RunError::Refused(format!("{whose} and --set {setting} say the same thing twice: give one")))
        }
        None => Ok(()),
    }
}

/// Settings that say how thick a filter is.
const THICKNESSES: [&str; 4] =
    ["network.nz", "network.copies", "network.thickness_mm", "network.thickness_d50f"];

/// Refuses what a scene may say and a search of boundaries cannot do.
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

/// How densely a scene's filter is packed, in words.
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
        assert_eq!(shape_setting("3").1, "filter.cu=3");
        assert_eq!(shape_setting("soils/f.csv").1, "filter.sieve=\"soils/f.csv\"");
        assert_eq!(shape_setting("f.xlsx#Zone 2").1, "filter.sieve=\"f.xlsx#Zone 2\"");
        assert_eq!(shape_setting("cu1.5-loose"), (true, "filter.curve=\"cu1.5-loose\"".into()));
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
            let error = wanted(&options).unwrap_err();
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
            let wanted = wanted(&options).unwrap().remove(0);
            assert_eq!(wanted.scene.base.sieve.as_deref(), Some(Path::new(name)));
            assert_eq!(wanted.scene.filter.sieve, Some(PathBuf::from(format!("./{name}"))));
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
        let all = wanted(&options(&["loose", "friction=0.1"], &["500mm", "30layers"])).unwrap();
        let names: Vec<String> = all.iter().map(|w| format!("{}, {}", w.density, w.thickness)).collect();
        assert_eq!(
            names,
            ["loose, 500 mm", "loose, 30 layers", "friction 0.1, 500 mm", "friction 0.1, 30 layers"]
        );
        let plain = wanted(&options(&[], &[])).unwrap();
        assert_eq!((plain[0].density.as_str(), plain[0].thickness), ("unknown", Thickness::Layers(60)));
        for same in [["loose", "loose"], ["medium", "intermediate"]] {
            let twice = wanted(&options(&same, &[])).unwrap_err();
            assert!(twice.to_string().contains("asked for twice") && twice.exit().code() == 2);
        }
        // As a scene reads it.
        let medium = wanted(&options(&["medium"], &[])).unwrap();
        let scene = Scene::built_in(&["filter.cu=3".into(), "filter.library=medium".into()]).unwrap();
        assert_eq!(medium[0].density, "intermediate");
        assert_eq!(medium[0].scene.filter.library, scene.filter.library);
        let packed = BoundaryOptions { pack: true, ..options(&["medium"], &[]) };
        assert_eq!(wanted(&packed).unwrap()[0].scene.filter.density, Some(Density::Intermediate));
        let voids = BoundaryOptions { settings: vec!["record.voids=[1]".into()], ..options(&[], &[]) };
        let refused = wanted(&voids).unwrap_err();
        assert!(refused.to_string().contains("record.voids does not go") && refused.exit().code() == 2);
        let wrong = wanted(&options(&["2"], &[])).unwrap_err().to_string();
        assert!(wrong.contains("dense, medium (or intermediate) or loose"), "{wrong}");
        let wrong = wanted(&options(&["estimate=1.5"], &[])).unwrap_err().to_string();
        assert!(wrong.contains("relative density from 0 (loose) to 1"), "{wrong}");
    }
}
