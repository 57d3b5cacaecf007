//! Answers as workbooks, read back part by part: every number is that of the JSON file.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use serde_json::Value;

use crate::judge::{SMALL, soils};
use crate::program::{call, done, refused};

/// What a cell holds.
#[derive(Clone, Debug, PartialEq)]
enum Cell {
    Empty,
    Number(f64),
    Truth(bool),
    Words(String),
}

impl Cell {
    fn words(&self) -> &str {
        match self {
            Self::Words(words) => words,
            Self::Empty => "",
            other => panic!("{other:?} are no words"),
        }
    }

    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Empty => None,
            other => panic!("{other:?} is no number"),
        }
    }
}

/// The rows of a sheet, headings first.
type Rows = Vec<Vec<Cell>>;

fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let found = element.attributes().flatten().find(|of| of.key.as_ref() == name)?;
    Some(quick_xml::escape::unescape(&found.value).unwrap().into_owned())
}

/// Calls `at` for each element, by its name, with the text within it; of nested ones the inner first.
fn elements(text: &str, mut at: impl FnMut(&str, &BytesStart, &str)) {
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut open: Vec<(BytesStart, String)> = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(element) => open.push((element.into_owned(), String::new())),
            Event::End(_) => {
                let (element, text) = open.pop().unwrap();
                at(element.name().as_ref(), &element, &text);
                if let Some(outer) = open.last_mut() {
                    outer.1.push_str(&text);
                }
            }
            Event::Text(text) => open.last_mut().into_iter().for_each(|of| of.1.push_str(&text)),
            Event::GeneralRef(name) => {
                let written = format!("&{};", &*name);
                let character = quick_xml::escape::unescape(&written).unwrap();
                open.last_mut().into_iter().for_each(|of| of.1.push_str(&character));
            }
            Event::Eof => return,
            _ => {}
        }
    }
}

fn sheets(path: &Path) -> BTreeMap<String, Rows> {
    let mut zipped = zip::ZipArchive::new(fs::File::open(path).unwrap()).unwrap();
    let mut part = |name: &str| {
        let mut text = String::new();
        zipped.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    };
    let mut strings = Vec::new();
    elements(&part("xl/sharedStrings.xml"), |name, _, text| {
        if name == "si" {
            strings.push(text.to_owned());
        }
    });
    let mut names = Vec::new();
    elements(&part("xl/workbook.xml"), |name, element, _| {
        names.extend(Some(element).filter(|_| name == "sheet").and_then(|of| attribute(of, "name")));
    });
    let mut found = BTreeMap::new();
    for (number, sheet) in (1..).zip(names) {
        let (mut rows, mut row): (Rows, Vec<Cell>) = (Vec::new(), Vec::new());
        elements(&part(&format!("xl/worksheets/sheet{number}.xml")), |name, element, text| match name {
            "c" => {
                let place = attribute(element, "r").unwrap();
                let letters = place.bytes().take_while(u8::is_ascii_alphabetic);
                let column = letters.fold(0, |at, letter| 26 * at + usize::from(letter - b'A') + 1) - 1;
                row.resize(column, Cell::Empty);
                row.push(match attribute(element, "t").as_deref() {
                    Some("s") => Cell::Words(strings[text.parse::<usize>().unwrap()].clone()),
                    Some("b") => Cell::Truth(text == "1"),
                    Some(other) => panic!("a cell of type {other}"),
                    None if text.is_empty() => Cell::Empty,
                    None => Cell::Number(text.parse().unwrap()),
                });
            }
            "row" => rows.push(std::mem::take(&mut row)),
            _ => {}
        });
        found.insert(sheet, rows);
    }
    found
}

/// The rows of a sheet below its headings, by heading.
fn rows(sheet: &Rows) -> Vec<BTreeMap<String, Cell>> {
    let headings: Vec<String> = sheet[0].iter().map(|cell| cell.words().to_owned()).collect();
    let filled = |row: &Vec<Cell>| {
        let cells = row.iter().cloned().chain(std::iter::repeat(Cell::Empty));
        headings.iter().cloned().zip(cells).collect()
    };
    sheet[1..].iter().map(filled).collect()
}

/// The value of an item of a sheet of items.
fn item(sheet: &Rows, name: &str) -> Cell {
    let row = rows(sheet).into_iter().find(|row| row["Item"].words() == name);
    row.unwrap_or_else(|| panic!("{name}"))["Value"].clone()
}

/// Every number of a JSON value.
fn numbers_of(value: &Value, found: &mut Vec<f64>) {
    match value {
        Value::Number(number) => found.extend(number.as_f64()),
        Value::Array(all) => all.iter().for_each(|one| numbers_of(one, found)),
        Value::Object(all) => all.values().for_each(|one| numbers_of(one, found)),
        _ => {}
    }
}

#[test]
fn the_workbook_of_a_verdict_has_the_numbers_of_its_outcome() {
    let (_root, at) = soils();
    let judged = ["judge", "base.csv", "coarse.csv", "--quick", "--out", "r", "--xlsx", "-q"];
    done(&call(&at, &[&judged[..], &SMALL].concat()));
    let book = at.join("r/verdict.xlsx");
    let outcome: Value = serde_json::from_slice(&fs::read(at.join("r/outcome.json")).unwrap()).unwrap();
    let all = sheets(&book);
    let names = ["Gradations", "Inputs", "Provenance", "Rules", "Runs", "Verdict"];
    assert_eq!(all.keys().collect::<Vec<_>>(), names);
    // Item by item.
    let verdict = &all["Verdict"];
    assert_eq!(item(verdict, "Class of the model").words(), outcome["model"]["class"].as_str().unwrap());
    for (run, summary) in (1..).zip(outcome["summary"].as_array().unwrap()) {
        let eroded = &summary["eroded_mass_fraction"];
        for (what, key) in
            [("mean", "mean"), ("standard deviation", "sd"), ("lower end of the 95 % interval", "low")]
        {
            let found = item(verdict, &format!("Mass eroded, run {run}, {what}")).number();
            assert_eq!(found, eroded[key].as_f64(), "{run} {what}");
        }
    }
    assert_eq!(item(verdict, "D15F/D85B").number(), outcome["ratios"]["d15f_over_d85b"].as_f64());
    assert_eq!(item(&all["Inputs"], "D15F").number(), outcome["inputs"]["filter"]["d15_mm"].as_f64());
    assert_eq!(item(&all["Inputs"], "Base particles in each run").number(), outcome["n_base"].as_f64());
    // Rule by rule, with formula and source.
    let of_json: Vec<&Value> =
        outcome["rules"].as_array().unwrap().iter().filter(|rule| rule["role"] != "walk").collect();
    let of_book = rows(&all["Rules"]);
    assert_eq!(of_json.len(), of_book.len());
    for (json, book) in of_json.iter().zip(&of_book) {
        let id = &json["id"];
        assert_eq!(book["Value"].number(), json["value"].as_f64(), "{id}");
        assert_eq!(book["Limit"].number(), json["limit"].as_f64(), "{id}");
        for (heading, key) in [("Formula", "formula"), ("Source", "source"), ("Id", "id"), ("Rule", "name")] {
            assert_eq!(book[heading].words(), json[key].as_str().unwrap(), "{id}");
        }
        // A boundary that is not reached is no limit that is met.
        let met = json["met"].as_bool().filter(|met| json["role"] != "continuation" || !met);
        assert_eq!(book["Met"], met.map_or(Cell::Empty, Cell::Truth), "{id}");
        let words = [(Some(true), "met"), (Some(false), "not met")];
        let said = words.iter().find(|(of, _)| *of == met);
        assert!(said.is_none_or(|(_, words)| book["Result"].words() == *words), "{id}");
        assert!(!book["Result"].words().is_empty(), "{id}");
        // Nor is it the most that is allowed.
        let is_boundary = json["role"] == "continuation" && json["limit"].is_number();
        let beyond = book["The limit is"] == Cell::Words("a boundary: continuing erosion beyond it".into());
        assert_eq!(beyond, is_boundary, "{id}");
    }
    assert!(of_json.iter().any(|of| of["role"] == "continuation" && of["limit"].is_number()));
    // Run by run.
    let runs: Vec<&Value> = outcome["replicates"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|replicate| replicate["runs"].as_array().unwrap())
        .collect();
    let of_book = rows(&all["Runs"]);
    assert_eq!(runs.len(), of_book.len());
    for (json, book) in runs.iter().zip(&of_book) {
        let eroded = &book["Mass eroded (fraction of the mass inserted)"];
        assert_eq!(eroded.number(), json["eroded_mass_fraction"].as_f64());
        assert_eq!(book["Particle moves"].number(), json["particle_moves"].as_f64());
    }
    // Point by point.
    let curve = |name: &str| -> Vec<[Option<f64>; 2]> {
        let all = rows(&all["Gradations"]).into_iter().filter(|row| row["Curve"].words() == name);
        all.map(|row| [row["Size (mm, or D0F without a unit)"].number(), row["Finer (%)"].number()]).collect()
    };
    let of = |value: &Value| -> Vec<[Option<f64>; 2]> {
        value.as_array().unwrap().iter().map(|row| [row[0].as_f64(), row[1].as_f64()]).collect()
    };
    assert_eq!(curve("filter"), of(&outcome["inputs"]["filter"]["gradation"]));
    assert_eq!(curve("constrictions of the filter"), of(&outcome["inputs"]["filter"]["constrictions"]));
    assert_eq!(curve("base as walked"), of(&outcome["inputs"]["base"]["gradation"]));
    // No sheet has a number that the outcome has not; a replicate and its number are counted here.
    let mut known = Vec::new();
    numbers_of(&outcome, &mut known);
    known.extend((0..=outcome["replicates"].as_array().unwrap().len()).map(|count| count as f64));
    for (name, sheet) in &all {
        for cell in sheet.iter().flatten() {
            if let Cell::Number(number) = cell {
                assert!(known.contains(number), "{name}: {number}");
            }
        }
    }
    // The same bytes again, by the command for finished folders, and gone with the results.
    let exported = call(&at, &["export", "r"]);
    done(&exported);
    assert!(String::from_utf8(exported.stdout).unwrap().contains("r/export/verdict.xlsx\n"));
    assert_eq!(fs::read(&book).unwrap(), fs::read(at.join("r/export/verdict.xlsx")).unwrap());
    let again = ["judge", "base.csv", "coarse.csv", "--quick", "--out", "r", "--overwrite", "-q"];
    done(&call(&at, &[&again[..], &SMALL].concat()));
    assert!(!book.exists() && !at.join("r/export").exists());
}

#[test]
fn the_workbook_of_a_specification_has_its_limits_and_steps() {
    let root = tempfile::tempdir().unwrap();
    let clay = "opening_mm,percent_finer\n0.002,15\n0.006,30\n0.02,45\n0.075,60\n0.2,80\n0.6,92\n2,100\n";
    fs::write(root.path().join("core.csv"), clay).unwrap();
    done(&call(root.path(), &["design", "core.csv", "--out", "s", "-q"]));
    let file = root.path().join("s/specification.xlsx");
    let (all, first) = (sheets(&file), fs::read(&file).unwrap());
    let text = fs::read(root.path().join("s/specification.json")).unwrap();
    let json: Value = serde_json::from_slice(&text).unwrap();
    let limits = rows(&all["Limits"]);
    assert_eq!(limits.len(), json["limits"].as_array().unwrap().len());
    for (book, json) in limits.iter().zip(json["limits"].as_array().unwrap()) {
        assert_eq!(book["Sieve"].words(), json["sieve"].as_str().unwrap());
        for (heading, key) in [
            ("Opening (mm)", "opening_mm"),
            ("Least finer (%)", "min_percent_finer"),
            ("Greatest finer (%)", "max_percent_finer"),
        ] {
            assert_eq!(book[heading].number(), json[key].as_f64());
        }
    }
    let values = json["steps"].as_array().unwrap().iter().flat_map(|step| step["values"].as_array().unwrap());
    let of_book = rows(&all["Steps"]).into_iter().filter(|row| row["Quantity"] != Cell::Empty);
    let of_book: Vec<Option<f64>> = of_book.map(|row| row["Value"].number()).collect();
    assert_eq!(of_book, values.map(|value| value["value"].as_f64()).collect::<Vec<_>>());
    assert_eq!(item(&all["Specification"], "Maximum D15F, which retains the base").number(), Some(0.7));
    let first_sheet = &all["Specification"];
    let d15 =
        ["D15F of the band, fine side", "D15F of the band, coarse side"].map(|of| item(first_sheet, of));
    assert_eq!(d15.map(|cell| cell.number()), [Some(0.7 / 5.0), Some(0.7)]);
    assert_eq!(
        item(first_sheet, "Maximum D15F set by").words(),
        json["curves"][0]["d15f_max_rule"].as_str().unwrap()
    );
    assert_eq!(item(first_sheet, "Basis").words(), "By the rules of practice alone, without a walk.");
    assert!(item(first_sheet, "Segregation").words().contains("not checked"));
    assert!(limits[0]["Note"].words().contains("0.140 to 0.700\u{202f}mm"));
    assert!(limits[1..].iter().all(|row| row["Note"] == Cell::Empty));
    let sand = &rows(&all["Products"])[0];
    assert_eq!(sand["Fits"], Cell::Truth(true));
    assert_eq!(sand["Result"].words(), "fits");
    assert!(item(first_sheet, "Margin").words().starts_with("This limit has no margin: it is the lower end"));
    done(&call(root.path(), &["report", "s"]));
    assert_eq!(fs::read(&file).unwrap(), first);
}

#[test]
fn the_template_is_read_back_as_soils() {
    let root = tempfile::tempdir().unwrap();
    let output = call(root.path(), &["soil", "--template", "site.xlsx"]);
    done(&output);
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "site.xlsx\n");
    let read = call(root.path(), &["soil", "site.xlsx", "--json"]);
    done(&read);
    let read: Value = serde_json::from_slice(&read.stdout).unwrap();
    let soils = read["soils"].as_array().unwrap();
    let names: Vec<&str> = soils.iter().map(|soil| soil["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["Base", "Filter"]);
    assert_eq!(soils[0]["fines_percent"].as_f64(), Some(38.0));
    // And as the two sides of a pair.
    done(&call(root.path(), &["rules", "site.xlsx#Base", "site.xlsx#Filter"]));
    // But not as an envelope of the base.
    let steps = ["design", "site.xlsx"];
    refused(&call(root.path(), &steps), "name one: site.xlsx#Base");
    assert!(!root.path().join("voidwalk-specification").exists());
    done(&call(root.path(), &["design", "site.xlsx#Base", "-q"]));
    refused(&call(root.path(), &["soil", "--template", "site.xlsx"]), "exists already");
    refused(&call(root.path(), &["soil", "--template", "site.csv"]), "ends in .xlsx");
    assert_eq!(call(root.path(), &["soil"]).status.code(), Some(2));
    assert_eq!(call(root.path(), &["soil", "site.xlsx", "--template", "b.xlsx"]).status.code(), Some(2));
}
