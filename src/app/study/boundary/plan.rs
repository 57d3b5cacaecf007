//! Options of a search for boundaries, and its plan: one case for each density and thickness.

use std::path::{Path, PathBuf};

use crate::case::end_of_guess;
use crate::cases::plan::{CasePlan, PlannedCase, crossed};
use crate::outcome::stopping::StopRule;
use crate::run::RunError;
use crate::run::prepare::PrepareOptions;
use crate::scene::{
    Base, BaseGradation, CurveSource, D85, Density, Extent, LibraryDensity, NetworkKeys, NetworkSource,
    Regrade, Scene, TableOptions, USUAL_LAYERS, keep_soils, quoted,
};
use voidwalk_core::schema::length::{LENGTHS, millimetres};
use voidwalk_core::schema::setting_name;
use voidwalk_core::walk::Engine;

/// Default number of voids across a lattice, as in the study of real soils.
const ACROSS: u64 = 20;

/// Default number of networks: the minimum for percentiles.
const NETWORKS: u64 = 5;

const THICKNESSES: [&str; 4] =
    ["network.nz", "network.copies", "network.thickness_mm", "network.thickness_d50f"];

/// Options of a search for boundaries, and the folder of its results.
#[derive(Clone, Debug)]
pub struct BoundaryOptions {
    /// Sieve table of the base; without it the settings define the base.
    pub base: Option<PathBuf>,
    /// Shape of the filter: a sieve table, a Cu or a shipped curve's name; by default from the settings.
    pub filter: Option<String>,
    /// Densities: a word, `friction=F` or `estimate=D`.
    pub densities: Vec<String>,
    /// True if this very filter is packed; otherwise its constrictions come from the library of packings.
    pub pack: bool,
    /// Thicknesses.
    pub thicknesses: Vec<Thickness>,
    /// Settings of the built-in scene, such as `base.cu=3`.
    pub settings: Vec<String>,
    /// True if the base is walked as it was sampled. Otherwise a base with a size of its own is regraded as
    /// in filter practice, unless `settings` contain `base.regrade`.
    pub as_sampled: bool,
    /// True if base and filter are taken as given even if their sizes look exchanged.
    pub as_given: bool,
    /// Folder for the results.
    pub out: PathBuf,
    /// True if earlier results there are replaced.
    pub overwrite: bool,
    /// Threads, memory and the folder of packings.
    pub prepare: PrepareOptions,
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        Self {
            base: None,
            filter: None,
            densities: Vec::new(),
            pack: false,
            thicknesses: Vec::new(),
            settings: Vec::new(),
            as_sampled: false,
            as_given: false,
            out: "voidwalk-boundary".into(),
            overwrite: false,
            prepare: PrepareOptions::default(),
        }
    }
}

/// Unit of a filter's thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thickness {
    /// Layers of voids.
    Layers(u64),
    /// Millimetres.
    Mm(f64),
    /// Multiples of D50F by mass.
    D50F(f64),
}

impl Thickness {
    pub(super) fn of(network: &NetworkKeys) -> Self {
        match network.extent() {
            Extent::Mm(mm) => Self::Mm(mm),
            Extent::D50F(multiple) => Self::D50F(multiple),
            Extent::Copies(_) | Extent::Usual => {
                Self::Layers(network.source().shape().map_or(USUAL_LAYERS, |[_, _, nz]| nz.into()))
            }
        }
    }

    pub(super) fn setting(self) -> String {
        match self {
            Self::Layers(layers) => format!("network.nz={layers}"),
            Self::D50F(multiple) => format!("network.thickness_d50f={multiple:?}"),
            Self::Mm(mm) => format!("network.thickness_mm={mm:?}"),
        }
    }
}

impl std::str::FromStr for Thickness {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.trim().to_lowercase();
        let refused = || {
            format!(
                "--thickness {text}: allowed: layers of voids as 60layers, a multiple of D50F as 75D50F, or \
                 {LENGTHS}"
            )
        };
        let number = |rest: &str| rest.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
        if let Some(rest) = lower.strip_suffix("d50f") {
            return number(rest).map(Self::D50F).ok_or_else(refused);
        }
        if let Some(rest) = lower.strip_suffix("layers") {
            let layers = rest.trim().parse().ok().filter(|n| (1..=1_000_000).contains(n));
            return layers.map(Self::Layers).ok_or_else(refused);
        }
        millimetres(&lower).map(Self::Mm).ok_or_else(refused)
    }
}

/// Thicknesses separated by commas.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ThicknessList(pub(crate) Vec<Thickness>);

impl std::str::FromStr for ThicknessList {
    type Err = String;

    /// Reads a list. `1,5m` may be one thickness with a decimal comma: in a list, all numbers have a unit or
    /// no number has one.
    fn from_str(text: &str) -> Result<Self, String> {
        let items: Vec<&str> = text.split(',').collect();
        let is_bare = |item: &&str| item.trim().parse::<f64>().is_ok();
        if let Some(at) = items.iter().position(&is_bare)
            && !items.iter().all(is_bare)
        {
            let bare = items[at].trim();
            let follows = items.get(at + 1).map(|next| next.trim());
            let follows = follows.filter(|next| next.starts_with(|c: char| c.is_ascii_digit()));
            let point = follows
                .map_or(String::new(), |next| format!("; or a decimal point, not a comma: {bare}.{next}"));
            return Err(format!(
                "--thickness {text}: {bare} has no unit, though another of the list has one; allowed: \
                 {bare}mm or {bare}layers{point}"
            ));
        }
        items.into_iter().map(str::parse).collect::<Result<_, _>>().map(Self)
    }
}

impl std::fmt::Display for Thickness {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Layers(n) => write!(f, "{n} layers"),
            Self::Mm(mm) => write!(f, "{mm} mm"),
            Self::D50F(multiple) => write!(f, "{multiple} D50F"),
        }
    }
}

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
        let levels = [density_name(&scene), Thickness::of(&scene.network).to_string()];
        let name = levels.join(", ");
        if plan.case(&name).is_some() {
            return Err(RunError::Refused(format!("{name}: asked for twice")));
        }
        let levels = plan.factors.iter().cloned().zip(levels).collect();
        plan.cases.push(PlannedCase { name, levels, scene });
    }
    Ok(plan)
}

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
    if options.thicknesses.is_empty() {
        return Ok(vec![None]);
    }
    let setting =
        |thickness: &Thickness| stated(&options.settings, "--thickness", thickness.setting()).map(Some);
    options.thicknesses.iter().map(setting).collect()
}

/// Setting that an option states, unless `settings` state it again.
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

/// Setting that states a shape: a Cu, a sieve table or the name of a shipped curve.
fn shape_setting(shape: &str) -> String {
    // In quotes, a name that reads as a number or the like stays text.
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
            "a thickness in mm needs a lattice: for a packing's own voids it gives a number of copies only \
             with the filter's size, which is searched for; give network.copies or a multiple of D50F",
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
        // Rows that move together take less time, and a boundary is the ratio at which the expected mass
        // crosses 7.5 %.
        scene.walk.engine = Engine::Expected;
    }
    scene.record.sensitivity.clear();
    Ok(scene)
}

/// Scene with a base for which any filter can be drafted, and with a number of layers if a ratio decides it.
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

fn refuse(scene: &Scene) -> Result<(), RunError> {
    Err(RunError::refused(if scene.stop != StopRule::default() {
        "stop.target_error_pp and stop.decide_percent do not go with `boundary`: replicates says how many \
         networks its bands are taken over"
    } else if scene.record.voids.is_some() {
        "record.voids does not go with `boundary`, which keeps no walk: set it in the scene of a run"
    } else if scene.walk.runs != 2 {
        "runs = 1 does not go with `boundary`: continuing erosion is what the second run erodes"
    } else {
        return Ok(());
    }))
}

fn density_name(scene: &Scene) -> String {
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
        (.., Some(CurveSource::Shipped(name))) => name.rsplit('-').next().unwrap_or(name).to_owned(),
        (.., Some(CurveSource::File(path))) => {
            format!("of the curve {}", path.file_name().map_or_else(PathBuf::new, PathBuf::from).display())
        }
        _ => "as given".into(),
    }
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
        let options = |densities: &[&str]| {
            let densities = densities.iter().map(ToString::to_string).collect();
            BoundaryOptions { filter: Some("3".into()), densities, ..BoundaryOptions::default() }
        };
        let names = |densities: &[&str], thicknesses: &[&str]| -> Vec<String> {
            let thicknesses = thicknesses.iter().map(|text| text.parse().unwrap()).collect();
            let cases = plan(&BoundaryOptions { thicknesses, ..options(densities) }).unwrap().cases;
            cases.into_iter().map(|case| case.name).collect()
        };
        assert_eq!(
            names(&["loose", "friction=0.1"], &["500mm", "30layers"]),
            ["loose, 500 mm", "loose, 30 layers", "friction 0.1, 500 mm", "friction 0.1, 30 layers"]
        );
        assert_eq!(names(&[], &[]), ["unknown, 60 layers"]);
        for same in [["loose", "loose"], ["medium", "intermediate"]] {
            let twice = plan(&options(&same)).unwrap_err();
            assert!(twice.to_string().contains("asked for twice") && twice.exit().code() == 2);
        }
        // Reads the options like a scene.
        let first = |options: &BoundaryOptions| plan(options).unwrap().cases.remove(0);
        let medium = first(&options(&["medium"]));
        let scene = Scene::built_in(&["filter.cu=3".into(), "filter.library=medium".into()]).unwrap();
        assert_eq!(medium.levels[0], ("density".into(), "intermediate".into()));
        assert_eq!(medium.scene.filter.library, scene.filter.library);
        let packed = BoundaryOptions { pack: true, ..options(&["medium"]) };
        assert_eq!(first(&packed).scene.filter.density, Some(Density::Intermediate));
    }

    #[test]
    fn a_thickness_says_what_it_is_in() {
        let read = |text: &str| text.parse::<Thickness>();
        assert_eq!(read("60layers"), Ok(Thickness::Layers(60)));
        assert_eq!((read("500mm"), read("500")), (Ok(Thickness::Mm(500.0)), Ok(Thickness::Mm(500.0))));
        assert_eq!((read("2ft"), read("24in")), (Ok(Thickness::Mm(609.6)), Ok(Thickness::Mm(609.6))));
        assert_eq!(read("75 D50F"), Ok(Thickness::D50F(75.0)));
        for wrong in ["0", "0mm", "-3mm", "0layers", "2.5layers", "nanmm", "inf", "thick", ""] {
            assert!(read(wrong).unwrap_err().contains("or a length above 0"), "{wrong}");
        }
    }

    #[test]
    fn a_decimal_comma_is_no_list_of_two_thicknesses() {
        let read = |text: &str| text.parse::<ThicknessList>();
        let two = ThicknessList(vec![Thickness::Layers(12), Thickness::Mm(15.0)]);
        assert_eq!(read("12layers,15mm"), Ok(two.clone()));
        assert_eq!(read("12layers, 1.5cm"), Ok(two));
        assert_eq!(read("100,200"), Ok(ThicknessList(vec![Thickness::Mm(100.0), Thickness::Mm(200.0)])));
        assert!(read("1,5m").unwrap_err().contains("; or a decimal point, not a comma: 1.5m"));
        assert!(read("60layers,500").unwrap_err().ends_with("allowed: 500mm or 500layers"));
        assert!(read("12layers,thick").unwrap_err().contains("--thickness thick: allowed: "));
    }
}
