//! Every sheet of a specification says what soils it is for: their files, their gradations and their sizes.

use std::fs;
use std::path::Path;

use serde_json::Value;

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

/// The cells of the row of a table that this names.
fn cells<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let row = page.split(&format!("<th>{name}</th>")).nth(1).unwrap().split("</tr>").next().unwrap();
    row.split("<td class=\"n\">").skip(1).map(|cell| cell.split('<').next().unwrap()).collect()
}

/// The till again: its finer part may leave it, and the sheet that a contractor gets says so.
#[test]
fn the_box_of_a_specification_warns_of_the_base_itself() {
    let root = site();
    let gap = "opening_mm,percent_finer\n19,100\n9.5,75\n4.75,50\n2,30\n0.9,29.5\n0.425,29\n0.2,26\n0.075,20\n\
               0.03,10\n0.01,0\n";
    fs::write(root.path().join("gap.csv"), gap).unwrap();
    let said = call(root.path(), &call_of("design gap.csv --out gap", &[])).stdout;
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
    // A sand has nothing of this.
    done(&call(root.path(), &call_of("design filter.csv --out sand", &[])));
    assert!(record(&root.path().join("sand/specification.json")).get("notes").is_none());
}

/// Two curves of a base: sizes of each, the numbers of each, and the file.
#[test]
fn a_specification_has_every_curve_of_its_base() {
    let root = site();
    let output = call(root.path(), &call_of("design base.csv --out one", &[]));
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
        voidwalk::practice::quantity::significant(least)
            .role(voidwalk::practice::quantity::NumberRole::Greatest)
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
    done(&call(root.path(), &call_of("design both.csv --out two", &[])));
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
