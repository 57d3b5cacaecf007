//! What belongs to a sheet that is handed in, on every page that has an answer: cover, date, and inches where
//! they are asked for.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::judge::SMALL;
use crate::program::{call, done, refused};

/// Three sands.
const SAMPLES: &str = "Sieve (mm),Core,Shell,Till\n10,100,100,100\n1,100,100,100\n0.5,100,80,60\n\
    0.25,40,20,10\n0.1,0,0,0\n";

/// What a user states, and the heading that it stands under.
const STATED: [(&str, &str, &str); 7] = [
    ("project", "Project", "Main dam <2B>"),
    ("number", "Number", "D-2031"),
    ("purpose", "Purpose", "Design of the chimney filter"),
    ("client", "Client", "Water Board"),
    ("author", "Author", "N. N."),
    ("checker", "Checked by", "M. M."),
    ("revision", "Revision", "A, issued for review"),
];

fn site() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("samples.csv", SAMPLES),
        ("fine.csv", "opening_mm,percent_finer\n4,100\n2,50\n1,0\n"),
        ("coarse.csv", "opening_mm,percent_finer\n8,100\n4,50\n2,0\n"),
    ] {
        fs::write(root.path().join(name), text).unwrap();
    }
    root
}

/// Every command with a page that is handed in, its folder and its page.
const PAGES: [(&str, &str, &str); 6] = [
    ("judge samples.csv#Core fine.csv --quick --out judge", "judge", "report.html"),
    ("judge samples.csv#Core fine.csv coarse.csv --quick --out filters", "filters", "batch.html"),
    ("judge samples.csv fine.csv --each --governing --out batch", "batch", "batch.html"),
    ("boundary samples.csv#Core --filter cu1.5-loose --out model", "model", "boundary.html"),
    ("design samples.csv#Core --out steps", "steps", "specification.html"),
    ("design samples.csv --each --out designs", "designs", "designs.html"),
];

/// Walks that take moments.
const FEW: [&str; 4] = ["--set", "replicates=2", "--set", "record.sensitivity=[]"];

/// The page of one of them with these settings.
fn page(at: &Path, (command, folder, page): (&str, &str, &str), more: &[&str]) -> String {
    let mut words: Vec<&str> = command.split(' ').collect();
    match command {
        practice if is_by_practice(practice) => {}
        model if model.starts_with("boundary") => {
            words.extend([&SMALL[..], &["--set", "replicates=1"]].concat())
        }
        _ => words.extend([&SMALL[..], &FEW].concat()),
    }
    words.extend(more);
    done(&call(at, &words));
    fs::read_to_string(at.join(folder).join(page)).unwrap()
}

fn is_by_practice(command: &str) -> bool {
    command.starts_with("design")
}

fn has(page: &str, name: &str, value: &str) -> bool {
    page.contains(&format!("<dt>{name}</dt> <dd><bdi>{value}</bdi></dd>"))
}

#[test]
fn every_page_has_the_cover_that_was_stated() {
    let root = site();
    let said: Vec<String> = STATED.iter().map(|(key, _, value)| format!("about.{key}={value}")).collect();
    let mut more: Vec<&str> = said.iter().flat_map(|said| ["--set", said.as_str()]).collect();
    more.extend(["--set", "about.date=1 April 2026"]);
    let mut programs = None;
    for of in PAGES {
        let (command, folder, file) = of;
        let page = &page(root.path(), of, &more);
        for (_, name, value) in STATED {
            let value = value.replace('<', "&lt;").replace('>', "&gt;");
            assert!(has(page, name, &value), "{command}: {name}");
        }
        assert!(has(page, "Date", "1 April 2026"), "{command}");
        let program = page.split("<dt>Program</dt> <dd><bdi>voidwalk ").nth(1).unwrap();
        let program = program.split('<').next().unwrap().to_owned();
        assert_eq!(program, *programs.get_or_insert(program.clone()), "{command}");
        assert_eq!(page.contains("<dt>Seed</dt>"), !is_by_practice(command), "{command}");
        can_be_signed(page, !is_by_practice(command), root.path());
        // The page that is made again from the folder alone is the same.
        done(&call(root.path(), &["report", folder]));
        assert!(fs::read_to_string(root.path().join(folder).join(file)).unwrap() == *page, "{command}");
    }
    // A cover that is changed in the record is that of the page that is made again.
    for (command, folder, file) in &PAGES[1..] {
        let record = root.path().join(folder).join(file.replace(".html", ".json"));
        let text = fs::read_to_string(&record).unwrap();
        fs::write(&record, text.replace("Water Board", "River Board")).unwrap();
        done(&call(root.path(), &["report", folder]));
        let page = fs::read_to_string(root.path().join(folder).join(file)).unwrap();
        assert!(has(&page, "Client", "River Board") && !page.contains("Water Board"), "{command}");
        fs::write(&record, text).unwrap();
    }
    // Another cover is another sheet, which replaces none unasked.
    let other = |name: &str, client: &str| {
        let each = ["judge", "samples.csv", "fine.csv", "--each", "--governing", "--out", name];
        call(root.path(), &[&each[..], &SMALL, &FEW, &["--set", client]].concat())
    };
    refused(&other("batch", "about.client=Other"), "holds another batch");
    // Where it does, walks that are kept keep their own pages, and that is said.
    let each = ["judge", "samples.csv", "fine.csv", "--each", "--governing", "--overwrite", "--out", "batch"];
    let again = call(root.path(), &[&each[..], &SMALL, &FEW, &["--set", "about.client=Other"]].concat());
    let said = String::from_utf8(again.stdout).unwrap();
    assert!(said.contains("walks were kept from an earlier call; their own pages have the cover"), "{said}");
    // What would have no effect on a specification is no setting of it.
    for other in ["base.cu=3", "about.coarse_left=true"] {
        let steps = ["design", "samples.csv", "--out", "x", "--set", other];
        let takes = "a specification walks nothing, and takes no other settings than about.project, about.number, \
                     about.purpose, about.client, about.author, about.checker, about.revision, about.date, \
                     about.units";
        refused(&call(root.path(), &steps), &format!("--set {other}: {takes}"));
    }
}

/// Three places to sign, the project's number at the foot of every printed page, what the model is where there is
/// one, and nothing of the machine.
fn can_be_signed(page: &str, is_walked: bool, at: &Path) {
    for part in ["data-foot=\"D-2031\"", "Prepared</th><td><bdi>N. N.<", "Checked</th>", "Approved</th>"] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.contains("moved through voids with the filter’s openings (constrictions)"), is_walked);
    let folder = at.to_str().unwrap();
    for machine in [folder, "Wall time", "threads", ">Machine<", "of this scene", "built-in scene"] {
        assert!(!page.contains(machine), "{machine}");
    }
}

#[test]
fn a_page_has_the_day_of_its_results_where_no_date_is_stated() {
    let root = site();
    let begun = day(root.path());
    let some = [PAGES[1], PAGES[3], PAGES[5]];
    let all = some.map(|of| page(root.path(), of, &[]));
    let ended = day(root.path());
    for (page, (command, ..)) in all.iter().zip(some) {
        assert!(has(page, "Date", &begun) || has(page, "Date", &ended), "{command}");
        assert!(page.contains("<div class=\"blank\" aria-hidden=\"true\"><dt>Project</dt>"), "{command}");
    }
    // The day of the walks that a table rests on, not of the table.
    let at = root.path().join("filters");
    for case in fs::read_dir(at.join("pairs/cases")).unwrap() {
        let manifest = case.unwrap().path().join("manifest.json");
        let text = fs::read_to_string(&manifest).unwrap().replace(&begun, "2001-02-03");
        fs::write(&manifest, text.replace(&ended, "2001-02-03")).unwrap();
    }
    fs::remove_file(at.join("batch.json")).unwrap();
    // It goes on with the table, whose walks are done.
    assert!(has(&page(root.path(), PAGES[1], &[]), "Date", "2001-02-03"));
}

/// The day on which a file is written now, as the program names days.
fn day(at: &Path) -> String {
    let file = at.join("now");
    fs::write(&file, "").unwrap();
    let moment = fs::metadata(&file).unwrap().modified().unwrap();
    humantime::format_rfc3339_seconds(moment).to_string().split('T').next().unwrap().to_owned()
}

/// That no maximum D15F has more inches than mm, and no least fewer; how many were looked at.
pub fn inches_within(page: &str) -> usize {
    let number = |text: &str| {
        let start = text.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len();
        text[start..].parse::<f64>().ok()
    };
    let page = page.replace("\u{202f}mm (", " mm (");
    let mut found = 0;
    for (at, words) in page.match_indices("up to ").chain(page.match_indices("at most ")) {
        let rest = &page[at + words.len()..];
        let Some((mm, rest)) = rest.split_once(" mm (") else { continue };
        let (Ok(mm), Some((inches, _))) = (mm.parse::<f64>(), rest.split_once("\u{202f}in")) else {
            continue;
        };
        let Some(inches) = number(inches) else { continue };
        assert!(inches * 25.4 <= mm * (1.0 + 1e-9), "{mm} mm, {inches} in");
        found += 1;
    }
    found
}

#[test]
fn both_tables_show_inches_beside_mm() {
    let root = site();
    let both = [PAGES[1], PAGES[2]];
    let pages = both.map(|of| page(root.path(), of, &["--set", "about.units=us"]));
    for (page, (command, folder, _)) in pages.iter().zip(both) {
        assert!(page.matches("\u{202f}in)").count() > 4, "{command}: {page}");
        let record = format!("{folder}/batch.json");
        let record: Value = serde_json::from_slice(&fs::read(root.path().join(record)).unwrap()).unwrap();
        assert!(record["inches"] == true, "{command}");
    }
    let [filters, batch] = &pages;
    assert!(inches_within(filters) > 0 && inches_within(batch) > 0, "{batch}");
    // The limit of a sample in the table has the inches of the sentence above it.
    let limit = batch.split("D15F up to ").nth(1).unwrap();
    let (mm, inches) = limit.split_once("\u{202f}in)").unwrap().0.split_once("\u{202f}mm (").unwrap();
    assert!(batch.contains(&format!(">{mm} ({inches}\u{202f}in)<")), "{limit}");
    // Files stay in mm, and what is printed has inches, too.
    let csv = fs::read_to_string(root.path().join("batch/batch.csv")).unwrap();
    assert!(!csv.contains("in)"), "{csv}");
    for (command, folder, _) in [PAGES[0], PAGES[1], PAGES[2]] {
        let mut words: Vec<&str> = command.split(' ').collect();
        if folder == "judge" {
            words.push("--overwrite");
        }
        let units = ["--set", "about.units=us"];
        let said = call(root.path(), &[&words[..], &SMALL, &FEW, &units].concat());
        done(&said);
        assert!(String::from_utf8(said.stdout).unwrap().contains(" in)"), "{command}");
    }
}
