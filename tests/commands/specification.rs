//! `voidwalk design`: the specification of a filter, its tables and its workbook.

use std::fs;
use std::path::Path;

use serde_json::Value;
use voidwalk::practice::quantity::{NumberRole, significant};
use voidwalk::run::FolderKind;

use crate::program::{call, done, figures_are_listed, refused};

/// Two samples of a sand, as an envelope.
const SANDS: &str = "opening_mm,north,south\n0.075,2,1\n0.15,12,6\n0.3,45,30\n0.6,85,70\n1.18,100,100\n";

fn root() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("sands.csv"), SANDS).unwrap();
    root
}

fn json(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("specification.json")).unwrap()).unwrap()
}

#[test]
fn steps_limits_and_products_fill_a_folder() {
    let root = root();
    let output = call(root.path(), &["design", "sands.csv"]);
    done(&output);
    let said = String::from_utf8(output.stdout).unwrap();
    for words in [
        "\nPractice: D15F from ",
        "\nLimit: D15F 2.40 mm (Sherard and Dunnigan's limit of design)",
        "\nNot a complete specification: ",
        "ASTM C33 fine aggregate",
        "report: ",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let out = root.path().join("voidwalk-specification");
    let found = json(&out);
    assert_eq!(found["format"], "voidwalk-specification/1");
    // The finer sand sets the maximum D15F: 4 times its D85B, which is a sieve of its table.
    assert!((found["d15f_max_mm"].as_f64().unwrap() - 4.0 * 0.6).abs() < 1e-9, "{found}");
    // The coarser one sets the least: 5 times its D15B, between 0.15 and 0.3 mm.
    let d15b = 0.15 * 2f64.powf(9.0 / 24.0);
    assert!((found["d15f_min_mm"].as_f64().unwrap() - 5.0 * d15b).abs() < 1e-9, "{found}");
    assert_eq!(found["steps"].as_array().unwrap().len(), 12);
    let limits = fs::read_to_string(out.join("specification.csv")).unwrap();
    assert!(limits.starts_with("sieve,opening_mm,min_percent_finer,max_percent_finer\n"), "{limits}");
    assert_eq!(limits.lines().count() - 1, found["limits"].as_array().unwrap().len());
    let page = fs::read_to_string(out.join("specification.html")).unwrap();
    for words in [
        "Limits sieve by sieve",
        "Standard products",
        "Step by step",
        "limit of design, for north.",
        "The limits alone are not enough: D15F of each delivery",
        "Content-Security-Policy",
    ] {
        assert!(page.contains(words), "{words}");
    }
    figures_are_listed(FolderKind::Specification, &out);
    // The page comes of the files alone, and finished work is not replaced unasked.
    fs::remove_file(out.join("specification.html")).unwrap();
    done(&call(root.path(), &["report", "voidwalk-specification"]));
    assert_eq!(fs::read_to_string(out.join("specification.html")).unwrap(), page);
    refused(&call(root.path(), &["design", "sands.csv"]), "holds a specification already");
    let iso = ["design", "sands.csv", "--sieves", "iso", "--overwrite", "--json"];
    let output = call(root.path(), &iso);
    done(&output);
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&printed["sieves"], &printed), (&"iso".into(), &json(&out)));
    assert!(printed["limits"].as_array().unwrap().iter().any(|limit| limit["sieve"] == "0.5 mm"));
}

#[test]
fn what_needs_a_walk_or_lacks_a_base_is_refused() {
    let root = root();
    for args in [&["design"][..], &["design", "sands.csv", "--filter", "3"]] {
        assert_eq!(call(root.path(), args).status.code(), Some(2), "{args:?}");
    }
    refused(&call(root.path(), &["design", "nowhere.csv"]), "nowhere.csv");
    refused(&call(root.path(), &["design", "sands.csv", "--sieves", "bs"]), "allowed: us");
    fs::write(
        root.path().join("um.csv"),
        "opening_mm,percent_finer\n75,2\n150,12\n300,45\n600,85\n1180,100\n",
    )
    .unwrap();
    refused(&call(root.path(), &["design", "um.csv"]), "are its sizes micrometres");
    assert!(!root.path().join("voidwalk-specification").exists());
}

#[test]
fn the_soils_of_several_files_are_one_envelope() {
    let root = root();
    let at = root.path();
    fs::create_dir(at.join("lab")).unwrap();
    let sands = ["sands.csv#north", "sands.csv#south"].map(str::to_owned);
    for (place, column) in [("north.csv", 1), ("lab/south.csv", 2)] {
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{},{}\n", cells[0], cells[column])
        };
        let table: String =
            SANDS.replace("north", "Sand").replace("south", "Sand").lines().map(row).collect();
        fs::write(at.join(place), table).unwrap();
    }
    done(&call(at, &["design", "sands.csv", "--out", "one", "-q"]));
    let one = json(&at.join("one"));
    let output = call(at, &["design", "north.csv", "lab/south.csv", "--out", "two"]);
    done(&output);
    let two = json(&at.join("two"));
    for name in ["d15f_min_mm", "d15f_max_mm", "band", "limits", "products"] {
        assert_eq!(two[name], one[name], "{name}");
    }
    let texts = |list: &Value, name: &str| -> Vec<String> {
        list.as_array().unwrap().iter().map(|of| of[name].as_str().unwrap().to_owned()).collect()
    };
    // Both soils are called Sand; their files tell them apart.
    assert_eq!(texts(&two["curves"], "curve"), ["north", "south"]);
    assert_eq!(two["inputs"].as_array().unwrap().len(), 2);
    assert_eq!(two["base"], "north, south");
    assert!(String::from_utf8(output.stdout).unwrap().contains("of a filter for north, south, by the rules"));
    let page = fs::read_to_string(at.join("two/specification.html")).unwrap();
    assert!(page.contains("Base <b><bdi>north, south</bdi></b>") && !page.contains("lab/"));
    // Soils of one file, named one by one, are its envelope, and the file was read once.
    done(&call(at, &["design", &sands[0], &sands[1], "--out", "named", "-q"]));
    let named = json(&at.join("named"));
    assert_eq!((&named["curves"], &named["inputs"]), (&one["curves"], &one["inputs"]));
}

#[test]
fn files_that_are_no_envelope_together_are_refused() {
    let root = root();
    let at = root.path();
    let sand = "mm,percent finer\n0.1,0\n0.5,100\n";
    fs::create_dir(at.join("lab")).unwrap();
    for name in ["base.csv", "filter.csv", "lab/north.csv"] {
        fs::write(at.join(name), sand).unwrap();
    }
    refused(&call(at, &["design", "base.csv", "./base.csv"]), "./base.csv is named twice");
    refused(&call(at, &["design", "sands.csv", "sands.csv#north"]), "sands.csv#north is named twice");
    refused(&call(at, &["design", "base.csv", "filter.csv"]), "it holds a base and a filter");
    refused(&call(at, &["design", "base.csv", "lab"]), "lab");
    refused(&call(at, &["design", "base.csv", "nowhere.csv"]), "nowhere.csv");
    assert!(!at.join("voidwalk-specification").exists());
}

/// One band: that of the last step stands on the first sheet and on the figure.
#[test]
fn the_band_of_the_steps_is_that_of_the_sheet_and_the_figure() {
    let root = root();
    done(&call(root.path(), &["design", "sands.csv#north", "-q"]));
    let out = root.path().join("voidwalk-specification");
    let of_file = json(&out);
    let steps = of_file["steps"].as_array().unwrap();
    let of = |name: &str| {
        let values = steps.iter().rev().flat_map(|step| step["values"].as_array().unwrap());
        let mut named = values.filter(|value| value["name"] == name);
        named.next().unwrap()["value"].as_f64().unwrap()
    };
    let [least, greatest] = [
        significant(of("minimum D15F")).role(NumberRole::Least),
        significant(of("maximum D15F")).role(NumberRole::Greatest),
    ];
    let band = format!("D15F from {least} to {greatest} mm, Cu from 2 to 6");
    let headline = format!("<p class=\"word long\">{band}, by practice.</p>");
    let page = fs::read_to_string(out.join("specification.html")).unwrap().replace('\u{202f}', " ");
    assert!(page.contains(&headline), "{band}");
    assert!(page.contains(&format!("as its limits at the sieves have it: {band}.")));
    let place = |what: &str| page.find(what).unwrap();
    for size in ["D5F", "D15F", "D60F"] {
        assert!(place(&format!("<th class=\"n\">{size}</th>")) < place("Figure 1."), "{size}");
    }
    figures_are_listed(FolderKind::Specification, &out);
}
