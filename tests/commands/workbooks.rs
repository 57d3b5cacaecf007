//! Answers as workbooks, read back by another library: every number is that of the JSON file.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use calamine::{Data, DataType, Range, Reader, Xlsx, open_workbook};
use serde_json::Value;

use crate::judge::{SMALL, soils};
use crate::program::{call, done, refused};

fn sheets(path: &Path) -> BTreeMap<String, Range<Data>> {
    let mut book: Xlsx<_> = open_workbook(path).unwrap();
    book.worksheets().into_iter().collect()
}

/// The rows of a sheet below its headings, by heading.
fn rows(sheet: &Range<Data>) -> Vec<BTreeMap<String, Data>> {
    let mut rows = sheet.rows();
    let headings: Vec<String> = rows.next().unwrap().iter().map(ToString::to_string).collect();
    rows.map(|row| headings.iter().cloned().zip(row.iter().cloned()).collect()).collect()
}

/// The value of an item of a sheet of items.
fn item(sheet: &Range<Data>, name: &str) -> Data {
    let row = rows(sheet).into_iter().find(|row| row["Item"] == name).unwrap_or_else(|| panic!("{name}"));
    row["Value"].clone()
}

fn number(data: &Data) -> Option<f64> {
    match data {
        Data::Float(number) => Some(*number),
        Data::Int(number) => Some(*number as f64),
        Data::Empty => None,
        other => panic!("{other} is no number"),
    }
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
    assert_eq!(item(verdict, "Class of the walk").to_string(), outcome["verdict"].as_str().unwrap());
    for (run, summary) in (1..).zip(outcome["summary"].as_array().unwrap()) {
        let eroded = &summary["eroded_mass_fraction"];
        for (what, key) in
            [("mean", "mean"), ("standard deviation", "sd"), ("lower end of the 95 % interval", "low")]
        {
            let found = number(&item(verdict, &format!("Mass eroded, run {run}, {what}")));
            assert_eq!(found, eroded[key].as_f64(), "{run} {what}");
        }
    }
    assert_eq!(number(&item(verdict, "D15F/D85B")), outcome["ratios"]["d15f_over_d85b"].as_f64());
    assert_eq!(number(&item(&all["Inputs"], "D15F")), outcome["inputs"]["filter"]["d15_mm"].as_f64());
    assert_eq!(number(&item(&all["Inputs"], "Base particles in each run")), outcome["n_base"].as_f64());
    // Rule by rule, with formula and source.
    let of_json: Vec<&Value> =
        outcome["rules"].as_array().unwrap().iter().filter(|rule| rule["role"] != "walk").collect();
    let of_book = rows(&all["Rules"]);
    assert_eq!(of_json.len(), of_book.len());
    for (json, book) in of_json.iter().zip(&of_book) {
        let id = &json["id"];
        assert_eq!(number(&book["Value"]), json["value"].as_f64(), "{id}");
        assert_eq!(number(&book["Limit"]), json["limit"].as_f64(), "{id}");
        for (heading, key) in [("Formula", "formula"), ("Source", "source"), ("Id", "id"), ("Rule", "name")] {
            assert_eq!(book[heading].to_string(), json[key].as_str().unwrap(), "{id}");
        }
        let met = json["met"].as_bool().map_or(Data::Empty, Data::Bool);
        assert_eq!(book["Met"], met, "{id}");
    }
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
        assert_eq!(number(eroded), json["eroded_mass_fraction"].as_f64());
        assert_eq!(number(&book["Particle moves"]), json["particle_moves"].as_f64());
    }
    // Point by point.
    let curve = |name: &str| -> Vec<[Option<f64>; 2]> {
        let all = rows(&all["Gradations"]).into_iter().filter(|row| row["Curve"] == name);
        all.map(|row| [number(&row["Size (mm, or D0F without a unit)"]), number(&row["Finer (%)"])]).collect()
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
        for cell in sheet.cells().filter_map(|(_, _, cell)| cell.as_f64().filter(|_| cell.is_float())) {
            assert!(known.contains(&cell), "{name}: {cell}");
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
    let clay = "opening_mm,percent_finer\n0.002,0\n0.075,60\n2,100\n";
    fs::write(root.path().join("core.csv"), clay).unwrap();
    done(&call(root.path(), &["design", "core.csv", "--steps", "--out", "s", "-q"]));
    let file = root.path().join("s/specification.xlsx");
    let (all, first) = (sheets(&file), fs::read(&file).unwrap());
    let text = fs::read(root.path().join("s/specification.json")).unwrap();
    let json: Value = serde_json::from_slice(&text).unwrap();
    let limits = rows(&all["Limits"]);
    assert_eq!(limits.len(), json["limits"].as_array().unwrap().len());
    for (book, json) in limits.iter().zip(json["limits"].as_array().unwrap()) {
        assert_eq!(book["Sieve"].to_string(), json["sieve"].as_str().unwrap());
        for (heading, key) in [
            ("Opening (mm)", "opening_mm"),
            ("Least finer by mass (%)", "min_percent_finer"),
            ("Greatest finer by mass (%)", "max_percent_finer"),
        ] {
            assert_eq!(number(&book[heading]), json[key].as_f64());
        }
    }
    let values = json["steps"].as_array().unwrap().iter().flat_map(|step| step["values"].as_array().unwrap());
    let of_book = rows(&all["Steps"]).into_iter().filter(|row| row["Quantity"] != Data::Empty);
    let of_book: Vec<Option<f64>> = of_book.map(|row| number(&row["Value"])).collect();
    assert_eq!(of_book, values.map(|value| value["value"].as_f64()).collect::<Vec<_>>());
    assert_eq!(number(&item(&all["Specification"], "Greatest D15F, which retains the base")), Some(0.7));
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
    refused(&call(root.path(), &["soil", "--template", "site.xlsx"]), "is there already");
    refused(&call(root.path(), &["soil", "--template", "site.csv"]), "ends in .xlsx");
    assert_eq!(call(root.path(), &["soil"]).status.code(), Some(2));
    assert_eq!(call(root.path(), &["soil", "site.xlsx", "--template", "b.xlsx"]).status.code(), Some(2));
}
