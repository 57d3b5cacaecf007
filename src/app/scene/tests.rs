use super::*;
use voidwalk_core::network::Connectivity;

fn built_in(assignments: &[&str]) -> Result<Scene, SceneError> {
    Scene::built_in(&assignments.iter().map(ToString::to_string).collect::<Vec<_>>())
}

#[test]
fn the_built_in_scene_is_what_it_says() {
    let scene = built_in(&[]).unwrap();
    assert_eq!(scene.filter.curve, Some(CurveSource::Shipped("shire2016-cu1.5-loose".into())));
    assert_eq!(scene.base.gradation(), BaseGradation::Linear { cu: 1.5, d85: D85::AtDc(5.0, None) });
    assert_eq!(scene.network.source(), NetworkSource::Cubic([40, 40, 60]));
    assert_eq!((scene.walk.seed, scene.walk.runs, scene.walk.replicates), (1, 2, 10));
    assert_eq!(scene.base.amount(), Amount::MassRatio(0.05, None));
    let text = Scene::init_text();
    assert!(text.lines().all(|line| line.len() <= 100), "{text}");
}

#[test]
fn a_length_may_have_a_unit_and_is_kept_in_mm() {
    for (name, text, mm) in [
        ("filter.thickness_mm", "2ft", "609.6"),
        ("filter.joint_mm", "\"3/8in\"", "9.525"),
        ("network.thickness_mm", "0.5m", "500"),
        ("base.d85_mm", "75um", "0.075"),
    ] {
        let [with_unit, plain] = [text, mm].map(|value| built_in(&[&format!("{name}={value}")]).unwrap());
        assert_eq!(with_unit, plain, "{name}");
        assert!(with_unit.to_toml().contains(mm), "{}", with_unit.to_toml());
    }
    let wrong = built_in(&["network.thickness_mm=24 apples"]).unwrap_err().to_string();
    assert!(
        wrong.contains("`24 apples` is not allowed; a length above 0, in mm or with its unit"),
        "{wrong}"
    );
}

#[test]
fn one_alternative_replaces_the_others() {
    let base = |set: &[&str]| built_in(set).unwrap().base.gradation();
    assert_eq!(base(&["base.single_mm=0.2"]), BaseGradation::Single(0.2));
    assert_eq!(base(&["base.sieve=b.csv"]), BaseGradation::Sieve("b.csv".into(), None));
    assert_eq!(
        base(&["base.cu=3", "base.d15f_over_d85b=6.5"]),
        BaseGradation::Linear { cu: 3.0, d85: D85::Ratio(6.5) }
    );
    assert_eq!(built_in(&["base.n_base=2e8"]).unwrap().base.amount(), Amount::Number(200_000_000));
    let network = |set: &[&str]| built_in(set).unwrap().network.source();
    assert_eq!(network(&["network.file=n.csv"]), NetworkSource::File("n.csv".into()));
    let table_3 = NetworkSource::Connected([8, 40, 60], Connectivity::table_3());
    assert_eq!(network(&["network.connectivity=table3", "network.nx=8"]), table_3);
}

/// Settings stated together do not replace each other.
#[test]
fn alternatives_that_are_set_together_are_refused() {
    for (set, message) in [
        (
            ["base.single_mm=0.2", "base.cu=3"],
            "--set: base.cu and base.single_mm both give the base: keep one",
        ),
        (
            ["base.d85_mm=1", "base.d85_at_dc=5"],
            "--set: base.d85_mm and base.d85_at_dc both set D85B: keep one",
        ),
        (
            ["base.d85_at_dc=5", "base.d85_mm=1"],
            "--set: base.d85_mm and base.d85_at_dc both set D85B: keep one",
        ),
        (
            ["network.nx=8", "network.file=n.csv"],
            "network.nx and network.file both give the network: keep one",
        ),
    ] {
        assert!(built_in(&set).unwrap_err().to_string().contains(message), "{set:?}: {:?}", built_in(&set));
    }
    // Settings of the file are still replaced, and a setting given twice counts as on any command line.
    let text = b"[filter]\ncurve = \"a.csv\"\nd0_mm = 2\n[base]\ncu = 2\nd85_mm = 1\n";
    let set = ["base.d15f_over_d85b=3", "filter.sieve=f.csv", "base.d15f_over_d85b=4"].map(String::from);
    let scene = Scene::parse(text, "s.toml", &set).unwrap();
    assert_eq!(scene.base.gradation(), BaseGradation::Linear { cu: 2.0, d85: D85::Ratio(4.0) });
    assert_eq!(scene.filter.d0_mm, None);
}

#[test]
fn what_is_written_is_the_whole_scene() {
    for set in [
        vec![],
        vec!["seed=18446744073709551615", "stop.decide_percent=99.9", "inject_share=0.02"],
        vec!["filter.density=dense", "filter.cu=3", "packing.grains=500", "packing.drag=0.04"],
        vec!["filter.friction=0.2", "filter.sieve=f.csv", "filter.d0_mm=0.1"],
        vec!["about.project=Dam, \"zone\" 2B", "about.client=Größe & Co."],
        vec!["filter.estimate=0.5", "base.sieve=b.csv", "base.regrade=practice", "record.sensitivity=[]"],
        vec!["base.n_base=1e6"],
        vec!["base.dc_curve=cu3-loose", "base.cap=2e8", "network.connectivity={5=50, 7=50}"],
        vec!["network.file=n.csv", "sampling=stratified", "engine=expected"],
    ] {
        let scene = built_in(&set).unwrap();
        let text = scene.to_toml();
        let again = Scene::parse(text.as_bytes(), &scene.name, &[]).unwrap_or_else(|e| panic!("{text}{e}"));
        assert_eq!(again, scene, "{text}");
    }
}

/// A shell removes the quotes around text that looks like a number or a date.
#[test]
fn what_a_cover_says_is_a_text_on_the_command_line_and_in_quotes_in_a_file() {
    let cover = |set: &[&str]| built_in(set).unwrap().about.cover();
    let stated = cover(&["about.date=2020-01-01", "about.revision=1", "about.number=true"]);
    let entries = [stated.date, stated.revision, stated.number];
    assert_eq!(entries.map(Option::unwrap), ["2020-01-01", "1", "true"]);
    assert_eq!(cover(&["about.revision=\"1\""]).revision.as_deref(), Some("1"));
    let of_file = Scene::parse(b"[about]\nrevision = 1\n", "s.toml", &[]).unwrap_err().to_string();
    assert!(of_file.contains("a text in quotes"), "{of_file}");
}

#[test]
fn a_distribution_of_connectivity_is_given_by_name_or_as_a_table() {
    let source = |network: &str| {
        let text = format!("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\n{network}");
        Scene::parse(text.as_bytes(), "s.toml", &[]).map(|scene| scene.network.source())
    };
    let table_3 = NetworkSource::Connected([40, 40, 60], Connectivity::table_3());
    assert_eq!(source("[network]\nconnectivity = \"table3\"").unwrap(), table_3);
    for text in [
        "[network]\nnx = 5\nconnectivity = { 5 = 50, 7 = 50.0 }",
        "[network]\nnx = 5\n[network.connectivity]\n7 = 50\n5 = 50",
    ] {
        let expected = Connectivity::new(&[(5, 50.0), (7, 50.0)]).unwrap();
        assert_eq!(source(text).unwrap(), NetworkSource::Connected([5, 40, 60], expected));
    }
    for (text, message) in [
        (
            "connectivity = \"table4\"",
            "s.toml, line 6, network.connectivity: `table4` is not allowed; \"table3\"",
        ),
        (
            "connectivity = { 6 = 90 }",
            "`{ 6 = 90 }` is not allowed; \"table3\", or percentages that sum to 100",
        ),
        ("connectivity = { six = 100 }", "`{ six = 100 }` is not allowed; \"table3\", or percent"),
        ("connectivity = { 6 = \"all\" }", "is not allowed; \"table3\", or percent"),
        ("connectivity = { 1 = 100 }", "from 2"),
        ("connectivity = [6, 100]", "is not allowed"),
        ("connectivity = \"table3\"\nfile = \"n.csv\"", "keep one"),
    ] {
        let error = source(&format!("[network]\n{text}")).unwrap_err().to_string();
        assert!(error.starts_with("s.toml") && error.contains(message), "{text}: {error}");
    }
}

#[test]
fn values_out_of_range_and_clashes_are_refused() {
    for (set, message) in [
        ("seed=-1", "a whole number from 0"),
        ("engine=warp", "\"auto\", \"particles\", \"counts\" or \"expected\""),
        ("stop.decide_percent=100", "a probability from 50 to 99.999"),
        ("stop.target_error_pp=0", "percentage points of the base"),
        ("stop.most_replicates=1", "2 to 100000"),
        ("sampling=sobol", "\"independent\" or \"stratified\""),
        ("runs=3", "a whole number from 1 to 2"),
        ("replicates=0", "from 1 to"),
        ("inject_share=0", "a whole number of equal parts"),
        ("inject_share=0.7", "a whole number of equal parts"),
        ("inject_share=1e-12", "from 0.000001"),
        ("filter.curve=3", "in quotes"),
        ("filter.grains_per_void=0", "above 0"),
        ("base.cu=0.5", "from 1 to 1000"),
        ("base.d85_at_dc=101", "from 0 to 100"),
        ("base.n_base=0", "from 1 to"),
        ("base.n_base=1.5", "whole number"),
        ("base.mass_ratio=inf", "above 0"),
        ("network.nx=0", "from 1 to"),
        ("network.nx=1e10", "from 1 to"),
        ("record.size_curves=[0]", "increments, from 1"),
        ("base.regrade=yes", "\"practice\" or \"no\""),
        ("filter.thickness_mm=0", "above 0"),
        ("base.d0_mm=1", "goes with base.sieve"),
        ("about.client=[3]", "a text in quotes, one line of at most 120 characters"),
        ("about.units=1", "\"us\""),
        ("about.client=\" \"", "a text in quotes, one line"),
        ("about.author=\"a\\nb\"", "a text in quotes, one line"),
        ("about.project=turned \u{202e}", "characters that are seen"),
        ("bas.cu=2", "did you mean `base.cu`"),
        ("filter.density=tight", "\"medium\" or \"intermediate\" (0.1), or \"loose\" (0.3)"),
        ("packing.drag=1", "packing.drag goes with filter.density or filter.friction"),
        ("filter.density=medium", "filter.cu or filter.sieve is missing"),
        ("filter.density=loose", "filter.cu or filter.sieve is missing"),
    ] {
        let error = built_in(&[set]).unwrap_err().to_string();
        assert!(error.contains(message), "{set}: {error}");
    }
    for (text, message) in [
        ("[base]\ncu = 2", "constrictions are missing: filter.density = \"loose\""),
        ("[filter]\ncurve = \"a.csv\"", "the base is missing"),
        ("[filter]\ncurve = \"a.csv\"\n[base]\ncu = 2", "needs one of base.d85_mm"),
        ("[filter]\ncurve = \"a.csv\"\n[base]\ncu = 2\nsingle_mm = 1", "keep one"),
        ("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\nd85_mm = 1", "goes with base.cu"),
        ("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\nn_base = 5\ncap = 3", "base.cap goes with"),
        ("[filter]\ncurve = \"a.csv\"\ndensity = \"loose\"", "both say what the filter's constrictions are"),
        ("[filter]\nfriction = 99\ncu = 2\n[base]\nsingle_mm = 1", "filter.friction: `99` is not allowed"),
    ] {
        let error = Scene::parse(text.as_bytes(), "s.toml", &[]).unwrap_err().to_string();
        assert!(error.starts_with("s.toml") && error.contains(message), "{text}: {error}");
    }
}
