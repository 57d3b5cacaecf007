//! Every sheet of a design says what soils it is for: their files, their gradations and their sizes.

use std::fs;
use std::path::Path;

use serde_json::Value;
use voidwalk::Gradation;

use crate::judge::SMALL;
use crate::program::{call, done};

/// A till, which the rules regrade on 4.75 mm: 70 % are finer.
const TILL: &str = "opening_mm,percent_finer\n19,100\n9.5,85\n4.75,70\n2,66.5\n0.9,63.5\n0.425,60\n0.2,42\n0.1,26\n\
                    0.075,21\n0.03,12\n0.01,0\n";

/// A sand with D15 = 0.25 mm and Cu of about 3.
const SAND: &str = "opening_mm,percent_finer\n4,100\n1,70\n0.25,15\n0.15,0\n";

fn site() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("base.csv"), TILL).unwrap();
    fs::write(root.path().join("filter.csv"), SAND).unwrap();
    root
}

fn call_of<'a>(words: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&words.split(' ').collect::<Vec<_>>()[..], more].concat()
}

fn record(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// A file as a page has it.
fn input(name: &str, text: &str) -> String {
    let sum = xxhash_rust::xxh3::xxh3_64(text.as_bytes());
    format!("<th>Input file</th><td>{name} (XXH3 {sum:016x})</td>")
}

/// The rows of a gradation, the coarsest first, as a record has them: rising.
fn rising(text: &str) -> Vec<(f64, f64)> {
    let row = |line: &str| {
        let (size, percent) = line.split_once(',').unwrap();
        (size.parse().unwrap(), percent.parse().unwrap())
    };
    let mut rows: Vec<(f64, f64)> = text.lines().skip(1).map(row).collect();
    rows.reverse();
    rows
}

/// The cells of the row of a table that this names.
fn cells<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let row = page.split(&format!("<th>{name}</th>")).nth(1).unwrap().split("</tr>").next().unwrap();
    row.split("<td class=\"n\">").skip(1).map(|cell| cell.split('<').next().unwrap()).collect()
}

#[test]
fn a_design_has_both_gradations_and_their_files() {
    // A file that is called `base` names no soil.
    for (name, named) in [("base.csv", ""), ("till.csv", ": <bdi>till</bdi>")] {
        has_both_gradations(name, named);
    }
}

fn has_both_gradations(base: &str, named: &str) {
    let root = site();
    fs::write(root.path().join(base), TILL).unwrap();
    let words = format!("design {base} --filter filter.csv --density loose --bracket 2,12 --out d");
    let output = call(root.path(), &[&call_of(&words, &SMALL)[..], &["--set", "replicates=1"]].concat());
    done(&output);
    let design = record(&root.path().join("d/design.json"));
    assert_eq!(design["base"]["gradation"], serde_json::json!(rising(TILL)));
    assert_eq!(design["filter_gradation"], serde_json::json!(rising(SAND)));
    // The part that passes 4.75 mm, as a soil of its own: 60 % of 70 % are finer than 0.425 mm.
    let regraded = design["base"]["regraded"].as_array().unwrap();
    let at = regraded.iter().find(|row| row[0] == 0.425).unwrap()[1].as_f64().unwrap();
    assert!((at - 100.0 * 60.0 / 70.0).abs() < 1e-9, "{at}");
    let page = fs::read_to_string(root.path().join("d/design.html")).unwrap().replace('\u{202f}', " ");
    let title = if named.is_empty() { base } else { "till" };
    for part in [
        &format!("Base <b><bdi>{title}, regraded on 4.75 mm</bdi></b>"),
        "filter of the shape <b><bdi>filter.csv</bdi></b> (D15F 0.250 mm, Cu ",
        ", as given)",
        "Appendix: the two gradations</h2>",
        &format!("<h3>Base, as sampled{named}</h3>"),
        &format!("<h3>Base, regraded{named}</h3>"),
        "<h3>Filter, as given</h3>",
        "checked> filter, as given</label>",
        &input(base, TILL),
        &input("filter.csv", SAND),
        "Dotted: the filter as it was given.",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // As sampled, as regraded, and of the filter.
    let of = |text: &str| Gradation::from_points(&rising(text), None).unwrap();
    let till = of(TILL);
    let d85 = [till.d(85.0), till.regraded().gradation.d(85.0), of(SAND).d(85.0)];
    for (cell, size) in cells(&page, "D85").into_iter().zip(d85) {
        let shown: f64 = cell.parse().unwrap();
        assert!((shown / size.unwrap() - 1.0).abs() < 0.01, "{cell} {size:?}");
    }
    assert_eq!(cells(&page, "D85").len(), 3);
    assert!(cells(&page, "Group").iter().all(|group| group.len() > 1));
}

/// The till again: its finer part may leave it, and the sheet that a contractor gets says so.
#[test]
fn the_box_of_a_specification_warns_of_the_base_itself() {
    let root = site();
    let gap = "opening_mm,percent_finer\n19,100\n9.5,75\n4.75,50\n2,30\n0.9,29.5\n0.425,29\n0.2,26\n0.075,20\n\
               0.03,10\n0.01,0\n";
    fs::write(root.path().join("gap.csv"), gap).unwrap();
    let said = call(root.path(), &call_of("design gap.csv --steps --out gap", &[])).stdout;
    let said = String::from_utf8(said).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
    let page = fs::read_to_string(root.path().join("gap/specification.html")).unwrap();
    let page = page.replace('\u{202f}', " ");
    let answer =
        page.split("<section class=\"verdict\">").nth(1).unwrap().split("</section>").next().unwrap();
    let found = record(&root.path().join("gap/specification.json"));
    let ids: Vec<&str> =
        found["notes"].as_array().unwrap().iter().map(|of| of["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["unstable_base", "broad_base", "gap_of_base"], "{found}");
    for words in [
        "The base is internally unstable by Kenney and Lau (H/F ",
        "The base is broadly graded (Cu ",
        "The base is gap-graded by the program",
    ] {
        assert!(answer.contains(&format!("<b>Warning</b>: {words}")), "{words}: {answer}");
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(said.contains("Not a complete specification: there is no limit above D60F"), "{said}");
    // Nor is it silent where the same soil is walked, and it says each once.
    let words =
        call_of("design gap.csv --filter filter.csv --density loose --bracket 0.5,12 --out d", &SMALL);
    let output = call(root.path(), &[&words[..], &["--set", "replicates=1"]].concat());
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    done(&output);
    let page = fs::read_to_string(root.path().join("d/design.html")).unwrap().replace('\u{202f}', " ");
    let answer =
        page.split("<section class=\"verdict\">").nth(1).unwrap().split("</section>").next().unwrap();
    for words in [
        "The base is internally unstable by Kenney and Lau",
        "The base is broadly graded (Cu ",
        "The base is gap-graded by the program",
    ] {
        assert!(answer.contains(&format!("<b>Warning</b>: {words}")), "{words}: {answer}");
        assert!(said.contains(&format!("warning: {words}")), "{words}: {said}");
        assert_eq!(page.matches(words).count(), 1, "{words}");
    }
    // A sand has nothing of this.
    done(&call(root.path(), &call_of("design filter.csv --steps --out sand", &[])));
    assert!(record(&root.path().join("sand/specification.json")).get("notes").is_none());
}

/// Two curves of a base: sizes of each, the numbers of each, and the file.
#[test]
fn a_specification_has_every_curve_of_its_base() {
    let root = site();
    let output = call(root.path(), &call_of("design base.csv --steps --out one", &[]));
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    done(&output);
    let page = fs::read_to_string(root.path().join("one/specification.html")).unwrap();
    // The option stands on the terminal alone.
    assert!(said.contains(". Design again for a dispersive base (--dispersive)"), "{said}");
    assert!(page.contains(". Design again for a dispersive base") && !page.contains("--dispersive"));
    for part in [
        "Base <b><bdi>base.csv</bdi></b>",
        "Appendix: the gradation of the base</h2>",
        "<h3>Base, as sampled</h3>",
        "<h3>Base, regraded</h3>",
        &input("base.csv", TILL),
        "Not a complete specification: there is no limit above D60F, and the maximum D90F is still to be set",
        "(National Engineering Handbook, Part 633, Chapter 26), for a minimum D10F of ",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(cells(&page, "D85").len(), 2);
    // The size that is named is that of the step.
    let found = record(&root.path().join("one/specification.json"));
    let step = found["steps"][9].as_object().unwrap();
    assert_eq!(step["does"], "keep_from_segregating");
    let least = step["values"][0]["value"].as_f64().unwrap();
    let said = format!(
        "minimum D10F of {}\u{202f}mm",
        voidwalk::report::quantity::significant(least)
            .role(voidwalk::report::quantity::NumberRole::Greatest)
            .number()
    );
    assert!(page.contains(&said), "{said}");

    let both = TILL.replace("percent_finer", "north,south").replace(",85\n", ",85,80\n");
    let both: String = both
        .lines()
        .map(|line| match line.matches(',').count() {
            1 => format!("{line},{}\n", line.split(',').nth(1).unwrap()),
            _ => format!("{line}\n"),
        })
        .collect();
    fs::write(root.path().join("both.csv"), &both).unwrap();
    done(&call(root.path(), &call_of("design both.csv --steps --out two", &[])));
    let page = fs::read_to_string(root.path().join("two/specification.html")).unwrap();
    for part in [
        "Appendix: the gradations</h2>",
        "<h3>Base, regraded: <bdi>south</bdi></h3>",
        &input("both.csv", &both),
    ] {
        assert!(page.contains(part), "{part}");
    }
    for name in ["north", "north, regraded", "south", "south, regraded"] {
        assert_eq!(cells(&page, &format!("<bdi>{name}</bdi>")).len(), 13, "{name}");
    }
}

#[test]
fn a_table_of_designs_has_every_sample() {
    let root = site();
    fs::create_dir(root.path().join("site")).unwrap();
    fs::write(root.path().join("site/till.csv"), TILL).unwrap();
    fs::write(root.path().join("site/sand.csv"), SAND).unwrap();
    done(&call(root.path(), &["design", "site", "--each", "--out", "d"]));
    let page = fs::read_to_string(root.path().join("d/designs.html")).unwrap();
    for part in ["Appendix: the soils</h2>", &input("till.csv", TILL), &input("sand.csv", SAND)] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("<th>Input file</th>").count(), 2);
    let page = page.split("Appendix: the soils</h2>").nth(1).unwrap();
    for name in ["till", "till, regraded", "sand"] {
        assert_eq!(cells(page, &format!("<bdi>{name}</bdi>")).len(), 13, "{name}");
    }
    assert!(!page.contains("sand, regraded"));
}
