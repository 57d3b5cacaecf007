//! What a page to hand in needs: whose it is, the boundaries of practice, plain words, and a style for print.

use std::path::Path;
use std::process::Command;

use voidwalk::Gradation;
use voidwalk::outcome::record::SampledBase;
use voidwalk::practice::rules::RULES;
use voidwalk::practice::{Headline, RuleQuantity, RuleRole, RuleUnit};
use voidwalk::practice::{PairOptions, PairRules};
use voidwalk::run::FolderKind;

use super::folder::{Plan, note};
use super::{made, words};

#[test]
fn the_page_says_for_whom_and_by_whom_it_is() {
    let mut plan = Plan::usual();
    let page = made(&plan).0;
    let before = words(&page);
    // A blank line on paper for what nobody stated.
    let blank =
        |page: &str, name: &str| page.contains(&format!("aria-hidden=\"true\"><dt>{name}</dt> <dd></dd>"));
    assert!(blank(&page, "Client") && blank(&page, "Author"));
    assert!(before.contains("Date 2026-11-21Program voidwalk 0.1.0 (4f2c43f)Seed 2016"));
    plan.scene.push_str(
        "[about]\nproject = \"Dam <script>alert(1)</script>\"\nclient = \"turned \u{202e} & Co\"\n",
    );
    let page = made(&plan).0;
    let header = page.split("<main").next().unwrap();
    assert!(header.contains("Dam &lt;script&gt;alert(1)&lt;/script&gt;") && blank(header, "Author"));
    // Without a number the project stands at the foot.
    assert!(page.contains("data-foot=\"Dam &lt;script&gt;alert(1)&lt;/script&gt;\""));
    assert!(header.contains("turned \u{fffd} &amp; Co"));
}

#[test]
fn soils_go_by_their_names_and_not_their_files() {
    let mut plan = Plan::usual();
    plan.outcome.inputs.base.name = "csv/tillh.csv".into();
    plan.outcome.inputs.filter.name = "lab/ring.xlsx#C33 sand".into();
    let (page, figures, _folder) = made(&plan);
    assert!(page.contains("<title>tillh on C33 sand</title>"));
    let text = words(&page);
    assert!(text.contains("Base tillh against filter C33 sand"));
    assert!(text.contains("Nametillh.csv") && !text.contains("csv/tillh"), "the file, with the inputs");
    let (_, gradations) = figures.iter().find(|(name, _)| name == "gradations.svg").unwrap();
    assert!(gradations.contains(">tillh</text>") && !gradations.contains("csv/"));
    // A name that says no more than what the soil is, is none.
    plan.outcome.inputs.base.name = "/lab/base.csv".into();
    plan.outcome.inputs.filter.name = "/lab/ring.xlsx#Filter".into();
    let (page, figures, _folder) = made(&plan);
    assert!(
        !page.contains("<p class=\"names\">") && !page.contains("/lab/"),
        "no “Base base against filter”"
    );
    assert!(page.contains("<title>Will this filter hold this soil?</title>"));
    let (_, gradations) = figures.iter().find(|(name, _)| name == "gradations.svg").unwrap();
    assert!(gradations.contains(">base</text>") && !gradations.contains(">base:</text>"));
}

#[test]
fn inches_stand_beside_mm_where_a_scene_asks_for_them() {
    let mut plan = Plan::usual();
    (plan.outcome.inputs.scale_free, plan.outcome.inputs.network.thickness_mm) = (false, Some(609.6));
    plan.outcome.inputs.filter.gradation = vec![[4.75, 0.0], [9.5, 50.0], [19.0, 100.0]];
    let rule = &mut plan.outcome.rules[0];
    (rule.id, rule.quantity, rule.unit) = ("sherard-dunnigan".into(), RuleQuantity::D15F, RuleUnit::Mm);
    (rule.applies, rule.value, rule.limit) = (true, Some(5.08), Some(2.54));
    let metric = words(&made(&plan).0);
    assert!(!metric.contains("US sieveSize"));
    plan.scene.push_str("[about]\nunits = \"metric\"\n");
    assert!(!words(&made(&plan).0).contains("US sieveSize"));
    plan.scene = plan.scene.replace("metric", "us");
    let us = words(&made(&plan).0);
    assert!(us.contains("US sieveSize (mm)") && us.contains("mm (in)") && us.contains("9.5 (0.374)"), "{us}");
    // Every length of a rule.
    for row in ["D15F5.08 mm (0.200 in)≤ 2.54 mm (0.100 in)", "= 5.08 mm (0.200 in)≤ 2.54 mm (0.100 in)"]
    {
        assert!(us.contains(row) && !metric.contains("(0.200 in)"), "{row}: {us}");
    }
    for row in ["No. 44.750", "3/8 in9.550", "3/4 in19100"] {
        assert!(us.contains(row), "{row}: {us}");
    }
}

#[test]
fn boundaries_of_practice_stand_at_the_row_of_d15f() {
    let mut plan = Plan::usual();
    let gradations = |plan: &Plan| {
        let (page, figures, _folder) = made(plan);
        let (_, figure) = figures.into_iter().find(|(name, _)| name == "gradations.svg").unwrap();
        (words(&page), figure)
    };
    let (text, figure) = gradations(&plan);
    assert!(!figure.contains(">15 %</text>") && !figure.contains(">NE</text>"));
    assert!(!text.contains("Short lines: "), "no rule has such a limit");

    for (rule, (id, limit)) in
        [("foster-fell-no-erosion", 5.5), ("foster-fell-continuing", 12.25)].into_iter().enumerate()
    {
        let rule = &mut plan.outcome.rules[rule];
        (rule.id, rule.quantity) = (id.into(), RuleQuantity::D15F);
        (rule.applies, rule.limit, rule.unit) = (true, Some(limit), RuleUnit::Mm);
    }
    let (text, figure) = gradations(&plan);
    // No name of the row runs into theirs.
    assert!(figure.contains(">NE</text>") && figure.contains(">CE</text>"), "{figure}");
    assert!(!figure.contains(">15 %</text>"), "{figure}");
    assert!(text.contains("Short lines: D15F of no erosion (NE), continuing erosion (CE)."), "{text}");

    plan.outcome.rules[0].applies = false;
    plan.outcome.rules[1].limit = None;
    let (text, figure) = gradations(&plan);
    assert!(!figure.contains(">NE</text>") && !figure.contains(">CE</text>"));
    assert!(!text.contains("Short lines: "));

    // One number of Fell et al. is both limits of a dispersive base.
    let soil = |points: &[(f64, f64)]| vec![("soil".into(), Gradation::from_lines(points).unwrap())];
    let clay = soil(&[(0.002, 30.0), (0.02, 62.0), (0.075, 88.0), (0.425, 98.0), (2.0, 100.0)]);
    let options = PairOptions { dispersive: true, ..PairOptions::default() };
    plan.outcome.rules =
        PairRules::of_envelopes(&clay, &soil(&[(0.2, 0.0), (0.3, 15.0), (2.0, 100.0)]), options).rules;
    let text = gradations(&plan).0;
    assert!(text.contains("D15F of design and no erosion, continuing erosion (CE)."), "{text}");
}

/// A rule that one curve of each soil meets says nothing of the coarsest filter and the finest base of a works.
#[test]
fn a_rule_that_is_met_was_judged_for_these_gradations_alone() {
    let mut plan = Plan::usual();
    let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
    let sand = soil(&[(0.2, 0.0), (0.6, 100.0)]);
    let said = |plan: &Plan| words(&made(plan).0).matches("Judged for these two gradations alone. ").count();
    let cases = [
        ([(1.0, 0.0), (3.0, 100.0)], Headline::Meets, 1),
        ([(8.0, 0.0), (16.0, 100.0)], Headline::DoesNotMeet, 0),
    ];
    for (filter, headline, times) in cases {
        plan.outcome.headline = Some(headline);
        plan.outcome.rules = PairRules::of(&sand, &soil(&filter)).rules;
        assert_eq!(said(&plan), times, "{filter:?}");
    }
}

#[test]
fn every_rule_is_shown_or_counted_in_short() {
    let short = |plan: &Plan| {
        let text = words(&made(plan).0);
        let begin = text.find("Rules of practice, in short").unwrap();
        text[begin..begin + text[begin..].find("The model is no proof").unwrap()].to_owned()
    };
    let mut plan = Plan::usual();
    plan.outcome.rules.iter_mut().for_each(|rule| rule.met = Some(true));
    assert!(short(&plan).contains("Others: 3 met."));
    plan.outcome.rules[0].met = None;
    assert!(short(&plan).contains("Others: 2 met, 1 no result."));
    plan.outcome.rules[0].applies = false;
    assert!(short(&plan).contains("Others: 2 met, 1 does not apply."));
    // What checks the walk is no rule of the filter.
    plan.outcome.rules[2].role = RuleRole::Walk;
    assert!(short(&plan).contains("Others: 1 met, 1 does not apply."));
    plan.outcome.rules.clear();
    assert!(short(&plan).contains("No rule was applied."));
}

/// What decides comes first, in bold; then the first of each kind that is not met; the rest is counted.
#[test]
fn the_rules_that_decide_come_first() {
    let soil = |points: &[(f64, f64)]| Gradation::from_points(points, None).unwrap();
    let base = soil(&[(0.2, 0.0), (0.6, 100.0)]);
    // Too coarse, with fines and without internal stability.
    let filter = soil(&[(0.05, 2.0), (0.075, 8.0), (6.0, 12.0), (8.0, 30.0), (100.0, 100.0)]);
    let mut plan = Plan::usual();
    plan.outcome.rules = PairRules::of(&base, &filter).rules;
    plan.outcome.rules.reverse();
    let page = made(&plan).0;
    let short = page.split("Rules of practice, in short").nth(1).unwrap().split("</section>").next().unwrap();
    let rows: Vec<&str> = short.split("</table>").next().unwrap().split("<tr><th>").skip(2).collect();
    for (row, name) in rows.iter().zip(["<b>Design", "<b>No erosion", "<b>Continuing erosion", "<b>Drainage"])
    {
        assert!(row.starts_with(name), "{name}: {row}");
    }
    let is_broken = |rule: &&voidwalk::practice::AppliedRule| rule.is_broken();
    let broken: Vec<RuleRole> = plan.outcome.rules.iter().filter(is_broken).map(|rule| rule.role).collect();
    for role in [RuleRole::Placing, RuleRole::Stability, RuleRole::Drainage] {
        assert!(broken.contains(&role), "{role:?}: {broken:?}");
    }
    assert!(rows[4..].iter().all(|row| row.contains("✗ not met") && !row.starts_with("<b>")), "{rows:?}");
    // None of those that are not met is lost.
    let shown = rows.iter().filter(|row| row.contains("✗ not met")).count();
    let counted =
        short.split("✗ ").filter_map(|rest| rest.split_once(" not met</span>")?.0.parse::<usize>().ok());
    assert_eq!(shown + counted.sum::<usize>(), broken.len(), "{short}");
}

/// Notes stand below the first sheet, once, and are counted on it.
#[test]
fn notes_are_said_once() {
    let mut plan = Plan::usual();
    plan.outcome.notes = (1..=10).map(|n| note(&format!("Note {n} of ten"))).collect();
    let text = words(&made(&plan).0);
    let place = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what}: {text}"));
    for n in 1..=10 {
        let note = format!("Note {n} of ten: a table.");
        assert_eq!(text.matches(&note).count(), 1, "{note}");
        assert!(place(&note) > place("10 notes below.") && place(&note) < place("What the model found"));
    }
}

/// The cover of a sheet, and sizes and groups of both soils.
#[test]
fn a_sheet_can_be_signed() {
    let mut plan = Plan::usual();
    plan.scene.push_str(
        "[about]\nproject = \"Dam\"\nnumber = \"D-1\"\npurpose = \"Design\"\nauthor = \"N. N.\"\nchecker = \"M. \
         M.\"\nrevision = \"A\"\ndate = \"2026-11-25\"\n",
    );
    let text = words(&made(&plan).0);
    let cover = "Project DamNumber D-1Purpose DesignClient Author N. N.Checked by M. M.Revision ADate \
                 2026-11-25Program";
    assert!(text.contains(cover), "{text}");
    assert!(text.contains("NameDateSignaturePreparedN. N.CheckedM. M.Approved"), "{text}");
    assert!(made(&plan).0.contains("<html lang=\"en\" data-foot=\"D-1\">"));
    let begin = text.find("mmFilterBase").unwrap_or_else(|| panic!("{text}"));
    let sizes = &text[begin..begin + text[begin..].find("Group by").unwrap()];
    // A straight line from 4 mm, Cu 1.5: D15 is 4 x 1.5^0.3.
    for row in ["D5", "D154.52", "D95", "Cu1.5", "Fines (%)0", "GroupGP"] {
        assert!(sizes.contains(row), "{row}: {sizes}");
    }
}

#[test]
fn both_gradations_are_in_the_appendix() {
    let mut plan = Plan::usual();
    plan.outcome.inputs.base.gradation = vec![[0.075, 12.5], [0.6, 63.25], [19.05, 100.0]];
    let text = words(&made(&plan).0);
    let appendix = &text[text.find("Appendix: the two gradations").unwrap()..];
    for expected in ["Base: Silty core fill", "19.05100", "0.663.25", "0.07512.5", "12.5 % are finer"] {
        assert!(appendix.contains(expected), "{expected}: {}", &appendix[..1200]);
    }
    assert!(appendix.find("19.05100") < appendix.find("0.663.25"), "the coarsest first");
    assert!(!appendix.contains("as it was sampled"), "{appendix}");
}

/// Permeability, Cu and fines are read from the curve as it was sampled: both stand there.
#[test]
fn a_base_that_is_regraded_is_in_the_appendix_as_sampled_too() {
    let mut plan = Plan::usual();
    let base = &mut plan.outcome.inputs.base;
    base.name = "Till".into();
    base.regraded_at_mm = Some(4.75);
    base.gradation = vec![[0.075, 25.0], [4.75, 100.0]];
    base.as_sampled = Some(SampledBase {
        d85_mm: Some(9.0),
        d95_mm: Some(15.0),
        d100_mm: 19.0,
        gradation: vec![[0.075, 20.0], [4.75, 80.0], [19.0, 100.0]],
    });
    let text = words(&made(&plan).0);
    assert!(text.contains("Base Till (regraded on 4.75 mm) against filter"), "{text}");
    let appendix = &text[text.find("Appendix: the two gradations").unwrap()..];
    for expected in [
        "and of the base as it was sampled",
        "Base, as sampled: Till",
        "4.7580",
        "Base, regraded on 4.75 mm: Till",
    ] {
        assert!(appendix.contains(expected), "{expected}: {appendix}");
    }
}

#[test]
fn headings_are_plain_words() {
    let mut plan = Plan::usual();
    plan.outcome.inputs.base.tail_mass_fraction = 0.12;
    let (page, figures, _folder) = made(&plan);
    for jargon in [
        ">Backbone",
        ">P(F)<",
        "Multiple of N_base",
        "Cu of the curve",
        "passive and counted",
        "passive, counted",
    ] {
        assert!(!page.contains(jargon), "{jargon}");
        assert!(figures.iter().all(|(_, figure)| !figure.contains(jargon)), "{jargon}");
    }
    for plain in [
        "Constrictions on an open path (backbone)",
        "Chance to move one layer on",
        "taken as too fine to block any constriction (passive)",
    ] {
        assert!(page.contains(plain), "{plain}");
    }
}

/// Words of the program and of its files, which say nothing to who signs a sheet.
const PROGRAM_WORDS: [&str; 9] =
    ["JSON", "json", "estimate = ", "replicates = ", "_mm", "N_base", "Eq. (", "--", "rattler"];

/// Sections of a scene: a key of theirs is the name of a setting.
const SECTIONS: [&str; 8] =
    ["filter.", "base.", "walk.", "network.", "record.", "about.", "memory.", "packing."];

/// Twelve soils on filters, from a clay to a gravel and from a good filter to one with a gap.
fn twelve_pairs() -> Vec<(Gradation, Gradation)> {
    let soil = |points: &[(f64, f64)]| Gradation::from_points(points, None).unwrap();
    let till = soil(&[(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)]);
    let clay = soil(&[(0.002, 30.0), (0.02, 62.0), (0.075, 88.0), (0.425, 98.0), (2.0, 100.0)]);
    let (sand, silty) =
        (soil(&[(0.2, 0.0), (0.6, 100.0)]), soil(&[(0.075, 22.0), (0.25, 80.0), (0.85, 100.0)]));
    let gravel = soil(&[(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)]);
    let medium = soil(&[(1.0, 0.0), (3.0, 100.0)]);
    let gap = soil(&[(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)]);
    let mut pairs = Vec::new();
    for base in [till, clay, sand, silty] {
        pairs.extend([&gravel, &medium, &gap].map(|filter| (base.clone(), filter.clone())));
    }
    pairs
}

/// Printed as a reader would, the first sheet holds the figure, the table of sizes and the rules that decide,
/// whatever the notes, and no word of the program; four sheets hold the rest, and every rule that is not met. Left out where Chromium is not installed.
#[test]
fn the_first_printed_sheet_is_complete() {
    let has = |name: &str, asked: &str| Command::new(name).arg(asked).output().is_ok();
    if !has("chromium", "--version") || !has("pdftotext", "-v") || !has("python3", "--version") {
        println!("left out: chromium, pdftotext or python3 is missing");
        return;
    }
    for (at, (base, filter)) in twelve_pairs().iter().enumerate() {
        let findings = (at * 10).div_ceil(11);
        let mut plan = Plan::usual();
        let pair = PairRules::of(base, filter);
        plan.outcome.rules = pair.rules;
        let long = "The answer depends on the 12 % of the base that is finer than its finest sieve, 0.075 mm; the finest \
                    constriction is 0.05 mm. A hydrometer test would decide";
        plan.outcome.notes = (1..=findings).map(|n| note(&format!("{long} ({n})"))).collect();
        let rows = |soil: &Gradation| soil.points().iter().map(|point| point.row()).collect();
        (plan.outcome.inputs.base.gradation, plan.outcome.inputs.filter.gradation) =
            (rows(base), rows(filter));
        let cover = "[about]\nproject = \"Main dam, raising, zone 2B\"\nnumber = \"D-2031\"\npurpose = \"Design of \
                     the chimney filter\"\nclient = \"Water Board\"\nauthor = \"N. N.\"\nchecker = \"M. \
                     M.\"\nrevision = \"A, issued for review\"\n";
        plan.scene.push_str(cover);
        let folder = made(&plan).2;
        let page = folder.path().join("report.html");
        // Letter is the shorter sheet: it is printed of those with the most to say.
        for paper in ["a4", "letter"].into_iter().take(if findings > 7 { 2 } else { 1 }) {
            let pdf = folder.path().join("page.pdf");
            let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/browser/look_at_report.py");
            let said = Command::new("python3").arg(script).args([&page, &pdf]).arg(paper).output().unwrap();
            assert!(said.status.success(), "{at}, {paper}: {}", String::from_utf8_lossy(&said.stderr));
            let said = Command::new("pdftotext").args(["-f", "1", "-l", "1"]).arg(&pdf).arg("-").output();
            let text = String::from_utf8(said.unwrap().stdout).unwrap();
            let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
            for part in ["Figure 1.", "D5 ", "D95 ", "Group by ASTM D2487", "it leaves out "] {
                assert!(text.contains(part), "{at}, {paper}, {findings} findings, {part}: {text}");
            }
            assert!(
                text.split(' ').count() <= 400,
                "{at}, {paper}: {} words: {text}",
                text.split(' ').count()
            );
            let whole = Command::new("pdftotext").arg(&pdf).arg("-").output().unwrap().stdout;
            let whole = String::from_utf8(whole).unwrap();
            assert!(whole.matches('\u{c}').count() <= 4, "{at}, {paper}: more than four sheets");
            let broken = plan.outcome.rules.iter().filter(|rule| rule.is_broken());
            assert!(
                whole.matches("✗ not met").count() >= broken.count(),
                "{at}: a rule not met is not printed"
            );
            for word in PROGRAM_WORDS {
                assert!(!text.contains(word), "{at}, {word}: {text}");
            }
            let is_setting = |word: &str| {
                let word = word.trim_start_matches(|c: char| !c.is_alphabetic());
                let key = SECTIONS.iter().find_map(|section| word.strip_prefix(section));
                key.is_some_and(|key| key.starts_with(|c: char| c.is_ascii_lowercase()))
            };
            let settings: Vec<&str> = text.split_whitespace().filter(|word| is_setting(word)).collect();
            assert!(settings.is_empty(), "{at}: {settings:?}");
            assert!(!cannot_be_cited(&text), "{at}: {text}");
        }
    }
}

/// Whether a text names a place that no report can cite.
fn cannot_be_cited(text: &str) -> bool {
    let places =
        ["http", "www.", ".com", ".org", ".co.", ".in/", "scribd", "Wikipedia", "second hand", "second-hand"];
    places.iter().any(|place| text.to_lowercase().contains(&place.to_lowercase()))
}

#[test]
fn every_rule_has_a_source_that_can_be_cited() {
    for rule in RULES {
        assert!(!rule.source.is_empty() && !cannot_be_cited(rule.source), "{}: {}", rule.id, rule.source);
    }
    for place in ["as scribd.com/doc/1 has it", "USBR, second hand", "https://a"] {
        assert!(cannot_be_cited(place), "{place}");
    }
}

/// The rest is looked at in a browser: `scripts/browser/look_at_report.py REPORT.html OUT.pdf`.
#[test]
fn print_opens_what_is_collapsed_and_keeps_heads_of_tables() {
    let page = made(&Plan::usual()).0;
    let style = page.split("<style>").nth(1).unwrap().split("</style>").next().unwrap();
    let (screen, print) = style.split_once("@media print{").expect("a style for print");
    for piece in [
        "details::details-content{display:block;content-visibility:visible",
        "thead{display:table-header-group}",
        "svg text{stroke:none}",
        // A box of findings is broken between two of them, so that it leaves no half of a page empty.
        "figure,.verdict,.leaves,.warnings li,.pair,tr{break-inside:avoid}",
        "@page{size:auto;",
    ] {
        assert!(print.contains(piece), "{piece}");
    }
    // A sheet of paper is as narrow as a telephone held across: what is made for that must not reach it.
    assert!(!screen.contains("@media (max-width") && screen.contains("@media screen and (max-width"));
    assert!(page.contains("<details><summary>Each replicate (10)"));
}

#[test]
fn every_figure_of_a_run_is_on_the_list_of_what_a_replaced_run_leaves() {
    let (_, figures, _folder) = made(&Plan::usual());
    let mut drawn: Vec<String> = figures.into_iter().map(|(name, _)| name.replace(".svg", "")).collect();
    // drawn of a packing, which this run has none of; tests/commands/pack.rs looks at that
    drawn.push("slice".into());
    drawn.sort();
    let mut listed = FolderKind::Run.figures().to_vec();
    listed.sort_unstable();
    assert_eq!(drawn, listed);
}
