//! The page of a made-up campaign.

use super::folder::note;
use super::{folder, words};
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use voidwalk::outcome::ledger::{Campaign, LedgerLine, Made, leaves_out};
use voidwalk::outcome::record::{Classed, CurveEnd, CurveRange, ModelLimit, Outcome, Stopping, Verdict};
use voidwalk::outcome::verdict::UndecidedBy;
use voidwalk::practice::Note;
use voidwalk::report;
use voidwalk::store::format::CAMPAIGN;

fn line(case: &str, place: &str, outcome: &Outcome) -> LedgerLine {
    let made = Made {
        host: "here".into(),
        threads: 1,
        job: None,
        started: "2026-11-21T09:12:04Z".into(),
        seconds: 1.0,
    };
    let levels = [("filter".to_owned(), case.to_owned())];
    LedgerLine::new(case, &levels, place.into(), "0".into(), outcome, made)
}

fn page(lines: &[LedgerLine], root: &Path) -> String {
    let about = Campaign {
        title: "Two <b>filters</b>".into(),
        plan: "plan.toml".into(),
        factors: vec!["filter".into()],
        cases: lines.len() as u64,
        missing: Vec::new(),
    };
    let ledger: Vec<String> = lines.iter().map(|line| serde_json::to_string(line).unwrap()).collect();
    fs::write(root.join("campaign.json"), CAMPAIGN.json(&about).unwrap()).unwrap();
    fs::write(root.join("ledger.jsonl"), ledger.join("\n") + "\n").unwrap();
    fs::read_to_string(report::write_campaign(root).unwrap().page).unwrap()
}

#[test]
fn the_class_comes_first_and_leads_to_the_page_of_its_case() {
    let root = TempDir::new().unwrap();
    for there in ["cases/fine,cu=1.5", "cases/.hidden", "cases/a\"b"] {
        fs::create_dir_all(root.path().join(there)).unwrap();
        fs::write(root.path().join(there).join("report.html"), "").unwrap();
    }
    let outcome = folder::outcome(3);
    let lines = [
        line("fine", "cases/fine,cu=1.5", &outcome),
        line("gone", "cases/gone", &outcome),
        line("above", "../cases", &outcome),
        line("hidden", "cases/.hidden", &outcome),
        line("quoted", "cases/a\"b", &outcome),
    ];
    let page = page(&lines, root.path());
    let links = page.matches("href=").count() - page.matches("href=\"#").count();
    assert_eq!(links, 1, "only to a page that is there, inside the folder");
    assert!(page.contains("<th><a href=\"cases/fine,cu=1.5/report.html\"><b>some erosion</b></a>"), "{page}");
    assert!(page.contains("Two &lt;b&gt;filters&lt;/b&gt;") && !page.contains("<b>filters"));
    assert!(words(&page).contains("ClassfilterRules not metNotes"));
}

#[test]
fn doubts_are_counted_and_said_once() {
    let root = TempDir::new().unwrap();
    let mut outcome = folder::outcome(3);
    outcome.notes = vec![note("<i>odd</i>")];
    outcome.rules[0].id = "terzaghi".into();
    (outcome.rules[0].applies, outcome.rules[0].met) = (true, Some(false));
    outcome.rules[1].id = "a-rule-of-tomorrow".into();
    (outcome.rules[1].applies, outcome.rules[1].met) = (true, Some(false));
    outcome.rules[2].met = Some(true);
    let first = line("one", "cases/one", &outcome);
    let kept = LedgerLine { rules_not_met: Vec::new(), ..line("two", "cases/two", &outcome) };
    let page = page(&[first, kept], root.path());
    assert!(page.contains("<td class=\"n\"><span class=\"amber\">2</span></td>"));
    let text = words(&page);
    assert!(text.contains("Terzaghi: the filter retains the base (1 case)"));
    assert!(text.contains("a-rule-of-tomorrow (1 case)"));
    assert!(page.contains("&lt;i&gt;odd&lt;/i&gt;") && !page.contains("<i>odd"));
    assert!(page.contains(" (2 cases)"));
}

/// More replicates do not decide what the curve leaves open.
#[test]
fn why_cases_are_undecided_is_said_of_each() {
    let root = TempDir::new().unwrap();
    let mut outcome = folder::outcome(3);
    let more = "more replicates may decide it";
    let decided = line("decided", "cases/decided", &outcome);
    assert!(!words(&page(&[decided], root.path())).contains(more));
    outcome.model.class = Verdict::Undecided;
    let by_replicates = line("one", "cases/one", &outcome);
    let text = words(&page(std::slice::from_ref(&by_replicates), root.path()));
    assert!(
        text.contains(&format!("Undecided, 1 case: the replicates do not separate the classes; {more}."))
    );
    let runs: Vec<_> = outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect();
    let end = CurveEnd {
        curve: "the loosest".into(),
        dc50_factor: 1.6,
        walked: Classed {
            replicates: 3,
            stopped_when_clear: false,
            verdict: Verdict::Continuing,
            runs: runs.clone(),
        },
    };
    outcome.curve_range = CurveRange::new(Verdict::None, &runs, vec![end], false, None);
    let by_curve = line("two", "cases/two", &outcome);
    assert_eq!(by_curve.undecided_by, Some(UndecidedBy::Curve));
    let text = words(&page(std::slice::from_ref(&by_curve), root.path()));
    assert!(
        !text.contains(more) && text.contains("Undecided, 1 case: the constriction curve is known"),
        "{text}"
    );
}

/// What some case of a ledger contains is not said to be left out.
#[test]
fn openings_of_a_case_are_in_its_line() {
    let outcome = folder::outcome(3);
    let closed = line("closed", "cases/closed", &outcome);
    let mut with = outcome.clone();
    with.notes.push(Note::Openings {});
    let open = line("open", "cases/open", &with);
    assert_eq!((closed.with_openings, open.with_openings), (false, true));
    let says = |lines: &[LedgerLine]| leaves_out(lines).contains(&ModelLimit::PartialClogging);
    assert!(says(std::slice::from_ref(&closed)) && !says(&[closed, open]));
}

/// A rule that added replicates until the error was small says nothing of the verdict.
#[test]
fn what_would_decide_is_said_after_a_target_error_was_met() {
    let mut outcome = folder::outcome(3);
    outcome.model.class = Verdict::Undecided;
    let met = Stopping {
        target_error_pp: Some(5.0),
        decide_percent: None,
        most: 1000,
        looks: 1,
        met: true,
        verdict: None,
        half_width_pp: Some(4.0),
        short_of: None,
    };
    outcome.stopping = Some(met.clone());
    let says = |outcome: &Outcome| outcome.notes_of_results().contains(&Note::ReplicatesLeaveOpen {});
    assert!(says(&outcome));
    outcome.stopping = Some(Stopping { met: false, decide_percent: Some(99.0), ..met });
    assert!(!says(&outcome));
}
