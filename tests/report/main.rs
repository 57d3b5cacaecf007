//! The report of a made-up run folder: what it says, what it may not do, and what it refuses.

mod campaign;
mod first_page;
mod folder;
mod in_memory;
mod walk;

use std::fs;
use std::path::Path;

use folder::Plan;
use tempfile::TempDir;
use voidwalk::outcome::record::{Outcome, Statistic, Verdict};
use voidwalk::practice::{RuleNote, RuleQuantity};
use voidwalk::report::{self, ReportError};
use voidwalk::store::format::OUTCOME;

/// Writes a folder and its report; the page, the figures, and the folder that holds them.
fn made(plan: &Plan) -> (String, Vec<(String, String)>, TempDir) {
    let folder = TempDir::new().unwrap();
    plan.write(folder.path());
    let written = report::write(folder.path()).unwrap();
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    let figures =
        written.figures.iter().map(|path| (name(path), fs::read_to_string(path).unwrap())).collect();
    (fs::read_to_string(written.page).unwrap(), figures, folder)
}

/// Text of a page without its markup and its list of headings.
fn words(page: &str) -> String {
    let list =
        page.split_once("<nav").and_then(|(before, rest)| Some((before, rest.split_once("</nav>")?.1)));
    let page = &list.map_or_else(|| page.to_owned(), |(before, after)| before.to_owned() + after);
    let mut inside = false;
    let text: String = page
        .chars()
        .filter(|c| {
            let shown = !inside && *c != '<';
            inside = (inside || *c == '<') && *c != '>';
            shown
        })
        .collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('\u{202f}', " ")
}

#[test]
fn the_page_says_what_an_engineer_reads_first() {
    let plan = Plan::usual();
    let (page, ..) = made(&plan);
    let text = words(&page);
    let place = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what:?} is not on the page"));
    let order = [
        "Model (research): some erosion; ",
        "Figure 1.",
        "Rules of practice, in short",
        "it leaves out hydraulics, ",
        "Group by ASTM D2487",
        "What the model found",
        "Model (“the walk”): base particles are moved through voids",
        "What the model leaves out",
        "Limits are rounded to the safe side",
        "Figure 2.",
        "Figure 4.",
        "Largest particle eroded, over D15F",
        "Inputs",
        "21 443 871 (Eq. 2)",
        "Appendix: the two gradations",
        "Sources",
        "0.1.0 (commit 4f2c43f)",
        "curve = \"shire2016-cu1.5-loose\"".replace('"', "&quot;").as_str(),
        "How to cite",
        "A network model to assess base-filter combinations",
    ]
    .map(place);
    // the title of the page comes before everything; the first figure's title may repeat a word
    assert!(order.windows(2).all(|pair| pair[0] < pair[1]), "{order:?}");
    for unit in [
        "Size (mm)",
        "Percent finer (%)",
        "Base eroded, by mass (%)",
        "Constrictions blocked (% of the layer’s)",
    ] {
        place(unit);
    }
    assert_eq!(
        text.matches("doi:10.1680/jgeot.15.P.215").count(),
        2,
        "with the inputs and with the citation"
    );
    let first = &plan.outcome.summary[0].eroded_mass_fraction;
    place(&format!("{:.1} %", first.mean * 100.0));
    place(&format!("{:.1} to {:.1} %", first.low.unwrap() * 100.0, first.high.unwrap() * 100.0));
    place("10 replicates, each a new network and a new walk: some erosion in all");
}

#[test]
fn every_class_has_its_words() {
    let cases = [
        (Verdict::None, "less than 7.5 % of its mass passes in the first run"),
        (Verdict::Some, "the filter seals after some erosion"),
        (Verdict::Continuing, "does not hold this base"),
        (Verdict::Undecided, "Inconclusive: these replicates do not separate the classes"),
    ];
    for (verdict, expected) in cases {
        let mut plan = Plan::usual();
        plan.outcome.model.class = verdict;
        assert!(words(&made(&plan).0).contains(expected), "{verdict:?}");
    }
    let mut plan = Plan::usual();
    plan.outcome.model.class = Verdict::Undecided;
    plan.outcome.summary[1].eroded_mass_fraction =
        Statistic { mean: 0.074, sd: Some(0.01), low: Some(0.066), high: Some(0.082) };
    let rule = "to decide the verdict at the 99.9 % confidence level, corrected for repeated looks. That was \
                reached.";
    assert!(words(&made(&plan).0).contains(rule));
    assert!(words(&made(&plan).0).contains("Inconclusive: the interval of the second run includes 7.5 %"));
    let next = "The replicates do not separate the classes";
    assert!(!words(&made(&plan).0).contains(next), "they were added already");
    plan.outcome.stopping = None;
    plan.outcome.notes = plan.outcome.notes_of_results();
    assert!(words(&made(&plan).0).contains(next));
    plan.outcome.summary.truncate(1);
    plan.outcome.replicates.iter_mut().for_each(|replicate| replicate.runs.truncate(1));
    assert!(words(&made(&plan).0).contains("and only a first was asked for"));
    assert!(words(&made(&plan).0).contains("only a first was asked for"));
}

#[test]
fn nothing_may_run_or_be_fetched() {
    let (page, figures, _folder) = made(&Plan::usual());
    let head = page.split("</head>").next().unwrap();
    let policy = head.find("Content-Security-Policy").expect("a policy");
    assert!(policy < head.find("<style").unwrap(), "the policy must stand before what it governs");
    // Light paper and dark screens.
    assert!(
        head.contains("@media screen and (prefers-color-scheme:dark)") && head.contains("color-scheme:light")
    );
    let part = page.split("\">Figures</a>").next().unwrap().rsplit("href=\"#").next().unwrap();
    assert!(page.contains(&format!("<h2 id=\"{part}\">Figures</h2>")), "{part}");
    assert!(head.contains("default-src 'none'; style-src 'sha256-"));
    assert!(!page.contains("unsafe-inline"));
    // Links lead to headings of the page itself.
    let page = page.replace("<a href=\"#part-", "<a ");
    for forbidden in ["<script", "style=\"", "src=", "href=", "@import", "url(http", "http://", "https://"] {
        assert!(!page.contains(forbidden), "{forbidden}");
    }
    assert_eq!(figures.len(), 5);
    for (name, figure) in figures {
        assert!(
            figure.starts_with("<?xml") && figure.contains("viewBox=") && figure.contains("<title"),
            "{name}"
        );
        assert_eq!(figure.matches("http").count(), 1, "{name}: the namespace alone");
        assert!(!figure.contains("NaN") && !figure.contains("inf"), "{name}");
    }
}

#[test]
fn hostile_names_are_inert() {
    const EVIL: &str = "\"><script>alert(1)</script><img src=x onerror=alert(2)>&\u{0}\u{202e}";
    let mut plan = Plan::usual();
    // No TOML has U+0000.
    plan.scene = format!("# </pre>{}\nseed = 1\n", EVIL.replace('\0', ""));
    let outcome = &mut plan.outcome;
    outcome.notes = vec![folder::note(EVIL)];
    let (inputs, rule) = (&mut outcome.inputs, &mut outcome.rules[0]);
    for text in [
        &mut inputs.filter.name,
        &mut inputs.filter.curve_name,
        &mut inputs.filter.attribution,
        &mut inputs.base.name,
        &mut inputs.network.name,
        &mut outcome.engine,
        &mut rule.name,
        &mut rule.source,
    ] {
        *text = EVIL.to_owned();
    }
    rule.quantity = RuleQuantity::Named(EVIL.into());
    let (page, figures, _folder) = made(&plan);
    for text in figures.iter().map(|(_, text)| text).chain([&page]) {
        for live in ["<script", "<img", "</pre>\"", "\u{0}", "\u{202e}"] {
            assert!(!text.contains(live), "{live:?}");
        }
    }
    assert!(page.contains("<title>&quot;&gt;&lt;script&gt;"));
    assert!(figures.iter().any(|(name, text)| name == "gradations.svg" && text.contains("&lt;script&gt;")));
}

#[test]
fn without_a_scale_every_size_says_so() {
    let mut plan = Plan::usual();
    plan.outcome.inputs.scale_free = true;
    plan.outcome.notes.clear();
    let (page, figures, _folder) = made(&plan);
    let text = words(&page);
    assert!(text.contains("Size / D0F (–)") && text.contains("296 D0F") && text.contains("largest (D0F)"));
    assert!(!text.contains(" mm") && !text.contains("(mm)"), "a length in mm in a scene without a scale");
    assert!(figures.iter().all(|(_, figure)| !figure.contains("mm")));
}

#[test]
fn the_outcome_itself_stands_among_its_variations() {
    let mut plan = Plan::usual();
    plan.outcome.sensitivity.retain(|case| case.factor != 1.0);
    let rows = |plan: &Plan| words(&made(plan).0).matches("Amount of base×").count();
    assert_eq!(rows(&plan), plan.outcome.sensitivity.len() + 1);
    plan.outcome.sensitivity.clear();
    assert_eq!(rows(&plan), 0);
}

#[test]
fn one_replicate_has_no_interval_and_says_so() {
    let mut plan = Plan::usual();
    plan.outcome = folder::outcome(1);
    plan.outcome.sensitivity.clear();
    plan.outcome.notes.clear();
    let text = words(&made(&plan).0);
    assert!(text.contains("One replicate: the scatter is unknown"));
    assert!(!text.contains("Notes") && !text.contains("notes below"));
    // Ended before the studies were walked.
    plan.outcome.thickness.clear();
    plan.outcome.studies_to_come = true;
    let text = words(&made(&plan).0);
    assert!(text.contains("Amount of base and thickness: not walked yet; voidwalk resume goes on with them"));
}

#[test]
fn a_run_in_which_nothing_erodes_or_is_retained_has_a_page() {
    let mut plan = Plan::usual();
    plan.outcome.inputs.base.gradation = vec![[0.5, 0.0], [0.5, 100.0]];
    plan.outcome.summary.iter_mut().for_each(|summary| summary.largest_eroded_over_d15f = None);
    let folder = TempDir::new().unwrap();
    plan.write(folder.path());
    for name in ["series.csv", "layers.csv", "retained.csv", "eroded.csv"] {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name), text.lines().next().unwrap()).unwrap();
    }
    let written = report::write(folder.path()).unwrap();
    let text = words(&fs::read_to_string(written.page).unwrap());
    assert!(text.contains("nothing eroded") && text.contains("series.csv has no rows"));
    assert_eq!(written.figures.len(), 2);
}

#[test]
fn long_series_give_a_small_page() {
    let mut plan = Plan::usual();
    plan.increments = 5000; // 1e5 rows
    let (page, ..) = made(&plan);
    assert!(page.len() < 500_000, "{} bytes", page.len());
}

#[test]
fn the_report_is_written_twice_alike_and_leaves_no_other_file() {
    let (page, figures, folder) = made(&Plan::usual());
    let written = report::write(folder.path()).unwrap();
    assert_eq!(page, fs::read_to_string(&written.page).unwrap());
    for ((_, before), path) in figures.iter().zip(&written.figures) {
        assert_eq!(*before, fs::read_to_string(path).unwrap());
    }
    let mut names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = [
        "eroded.csv",
        "figures",
        "layers.csv",
        "manifest.json",
        "outcome.json",
        "report.html",
        "retained.csv",
        "scene.toml",
        "series.csv",
    ];
    assert_eq!(names, expected);
}

#[test]
fn a_missing_file_is_named_and_nothing_is_written() {
    for name in [
        "outcome.json",
        "manifest.json",
        "scene.toml",
        "series.csv",
        "layers.csv",
        "retained.csv",
        "eroded.csv",
    ] {
        let folder = TempDir::new().unwrap();
        Plan::usual().write(folder.path());
        fs::remove_file(folder.path().join(name)).unwrap();
        let error = report::write(folder.path()).unwrap_err();
        assert!(matches!(&error, ReportError::Read { path, .. } if path.ends_with(name)), "{error}");
        assert!(!folder.path().join("report.html").exists() && !folder.path().join("figures").exists());
    }
}

#[test]
fn a_malformed_file_is_named_with_its_line() {
    let header = "replicate,run,layer,constrictions,blocked,retained_in_constrictions,retained_in_voids\n";
    let sizes = "replicate,run,increment,diameter_mm,percent_finer_by_mass,percent_finer_by_number\n";
    let series = "replicate,run,increment,inserted,moving,eroded,retained_in_constrictions,\
                 retained_in_voids,trapped,blocked,eroded_mass_fraction\n";
    let cases = [
        (
            "outcome.json",
            "{\"format\": \"voidwalk-outcome/1\", \"headline\": \"perhaps\"}".to_owned(),
            "outcome.json:1: unknown variant `perhaps`",
        ),
        ("manifest.json", "{}".to_owned(), "manifest.json:1: this file does not begin with"),
        ("layers.csv", format!("{header}1,1,0,10,11,0,0\n"), "layers.csv:2: blocked is 11, allowed: at most"),
        ("layers.csv", format!("{header}1,1,0,10,x,0,0\n"), "layers.csv:2: column 5"),
        (
            "layers.csv",
            format!("{header}11,1,0,10,1,0,0\n"),
            "layers.csv:2: replicate 11, run 1: outcome.json holds",
        ),
        ("layers.csv", "replicate,run\n1,1\n".to_owned(), "layers.csv:2: missing field `layer`"),
        ("retained.csv", format!("{sizes}1,1,1,nan,0,0\n"), "retained.csv:2: diameter_mm is NaN"),
        (
            "eroded.csv",
            format!("{sizes}1,1,1,0.1,0,0\n1,1,1,0.2,101,0\n"),
            "eroded.csv:3: percent_finer_by_mass is 101",
        ),
        (
            "series.csv",
            format!("{series}1,1,2,1,0,1,0,0,0,0,0\n1,1,2,1,0,1,0,0,0,0,0\n"),
            "series.csv:3: increment is 2",
        ),
        (
            "series.csv",
            format!("{series}1,1,1,1,0,1,0,0,0,0,inf\n"),
            "series.csv:2: eroded_mass_fraction is inf",
        ),
    ];
    for (name, content, expected) in cases {
        let folder = TempDir::new().unwrap();
        Plan::usual().write(folder.path());
        fs::write(folder.path().join(name), content).unwrap();
        let error = report::write(folder.path()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\ndoes not contain\n{expected}");
    }
}

/// One mistyped value would leave a cover without client and project.
#[test]
fn a_scene_whose_cover_cannot_be_read_is_named_with_its_line_and_setting() {
    for (added, expected) in [
        ("[about]\nclient = \"W. B.\"\nunits = 3\n", "scene.toml:19: `units = 3`: "),
        ("[about]\ndate = 2026-11-25\n", "scene.toml:18: `date = 2026-11-25`: "),
        (
            "[about]\nunits = \"uss\"\n",
            "scene.toml:18: `units = \"uss\"`: unknown variant `uss`, expected `metric` or `us`",
        ),
        ("no scene at all\n", "scene.toml:17: `no scene at all`: "),
    ] {
        let (folder, mut plan) = (TempDir::new().unwrap(), Plan::usual());
        plan.scene.push_str(added);
        plan.write(folder.path());
        let error = report::write(folder.path()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\ndoes not contain\n{expected}");
        assert!(!folder.path().join("report.html").exists(), "{added}");
    }
}

#[test]
fn an_outcome_that_contradicts_itself_is_refused() {
    type Spoil = fn(&mut Outcome);
    let cases: [(&str, Spoil); 5] = [
        ("replicates is empty", |outcome| outcome.replicates.clear()),
        ("replicates[3].runs is 1 runs", |outcome| outcome.replicates[3].runs.truncate(1)),
        ("summary[].eroded_mass_fraction.mean is 1.5", |outcome| {
            outcome.summary[0].eroded_mass_fraction.mean = 1.5
        }),
        ("inputs.base.gradation is empty", |outcome| outcome.inputs.base.gradation.clear()),
        ("threshold is 7.5", |outcome| outcome.threshold = 7.5),
    ];
    for (expected, spoil) in cases {
        let mut plan = Plan::usual();
        let folder = TempDir::new().unwrap();
        plan.write(folder.path());
        spoil(&mut plan.outcome);
        fs::write(folder.path().join("outcome.json"), OUTCOME.json(&plan.outcome).unwrap()).unwrap();
        let error = report::write(folder.path()).unwrap_err().to_string();
        assert!(error.contains("outcome.json") && error.contains(expected), "{error}");
    }
}

#[test]
fn the_names_of_the_folder_are_a_contract() {
    let value = serde_json::to_value(folder::outcome(2)).unwrap();
    assert_eq!(value["model"]["class"], "some erosion");
    assert_eq!(value["inputs"]["network"]["kind"], "cubic");
    assert!(value["replicates"][1]["runs"][0]["blocked_first_three_layers_fraction"].is_f64());
    assert!(value["summary"][0]["eroded_mass_fraction"]["low"].is_f64());
    assert_eq!(serde_json::from_value::<Outcome>(value).unwrap(), folder::outcome(2));
}

#[test]
fn a_rule_says_what_it_is_for_and_what_it_needs() {
    let mut plan = Plan::usual();
    plan.outcome.rules[0].value = None;
    plan.outcome.rules[0].met = None;
    plan.outcome.rules[0].needs = vec![RuleNote::NeedsCurveOfFilter];
    plan.outcome.rules[1].at_least = true;
    plan.outcome.rules[2].limit = None;
    let (page, ..) = made(&plan);
    assert!(page.contains("needs the filter's sieve curve"));
    let text = words(&page);
    for expected in ["For bases in general.", "no result", "≥ 7", "D15F/D95B = "] {
        assert!(text.contains(expected), "{expected}");
    }
}

#[test]
fn equation_one_stands_beside_the_walk() {
    let mut plan = Plan::usual();
    let text = words(&made(&plan).0);
    for expected in [
        "Infiltration depth without blocking",
        "D85B",
        "73.4",
        "no end",
        "If nothing were ever blocked, 87.3 % of the base’s mass would leave",
        "down to 59.0, 95 % of them down to 11.0 (first run)",
        "The difference is due to blocking",
    ] {
        assert!(text.contains(expected), "{expected}");
    }
    for (alone, expected) in
        [(0.1, "More left than a clean filter lets pass"), (0.19, "Blocking changes little here")]
    {
        plan.outcome.infiltration.as_mut().unwrap().eroded_without_blocking = alone;
        plan.outcome.summary[0].eroded_mass_fraction.mean = 0.19;
        assert!(words(&made(&plan).0).contains(expected), "{expected}");
    }
    plan.outcome.infiltration = None;
    assert!(words(&made(&plan).0).contains("Not given: the closed form holds for a regular cubic lattice"));
}

#[test]
fn results_by_connectivity_add_the_replicates_up() {
    let mut plan = Plan::usual();
    assert!(!made(&plan).0.contains("By connectivity"));
    for replicate in &mut plan.outcome.replicates {
        let row = |connectivity, voids, retained: u64| voidwalk::outcome::record::ByConnectivity {
            connectivity,
            voids,
            voids_fraction: 0.0,
            constrictions: 3 * voids,
            blocked: voids,
            retained_in_constrictions: retained / 2,
            retained_in_voids: retained / 2,
            retained_per_void: 0.0,
            retained_fraction: 0.0,
        };
        replicate.runs[0].by_connectivity = vec![row(5, 25, 10_000), row(6, 75, 2500)];
    }
    // a blank between cells
    let text = words(&made(&plan).0.replace("</t", " </t"));
    for expected in
        ["5 25.0 % 400 80.0 % 33.3 %", "6 75.0 % 33.3 20.0 % 33.3 %", "All (1000 voids) 100.0 % 125"]
    {
        assert!(text.contains(expected), "{expected}");
    }
}
