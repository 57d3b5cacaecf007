//! `voidwalk rules`, and tables that cannot be a filter and its base.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn voidwalk(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk")).args(args).output().unwrap()
}

/// A sieve table as a file.
fn table(folder: &Path, name: &str, rows: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, format!("opening_mm,percent_finer\n{rows}")).unwrap();
    path.display().to_string()
}

/// The names of `voidwalk rules --json`, and its table.
#[test]
fn rules_are_applied_without_a_walk_under_the_names_of_the_contract() {
    let root = tempfile::tempdir().unwrap();
    let sieve = |name: &str, rows: &str| table(root.path(), name, rows);
    let filter = sieve("gravel.csv", "5,0\n6.5,15\n20,100\n");
    let till = sieve("till.csv", "19,100\n4.75,92\n2,82\n0.425,60\n0.075,35\n");
    let output = voidwalk(&["rules", &till, &filter, "--json"]);
    assert!(output.status.success());
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let base = &value["base"];
    assert_eq!((base["category"].as_u64(), base["regraded"].as_bool()), (Some(3), Some(true)));
    assert!((base["fines_percent"].as_f64().unwrap() - 35.0 / 0.92).abs() < 1e-9);
    assert!((base["d85_mm"].as_f64().unwrap() - 1.5305).abs() < 1e-3);
    let rules = value["rules"].as_array().unwrap();
    for id in [
        "sherard-dunnigan",
        "foster-fell-no-erosion",
        "foster-fell-continuing",
        "permeability",
        "terzaghi",
        "kezdi",
        "kenney-lau",
    ] {
        let rule = rules.iter().find(|rule| rule["id"] == id).unwrap_or_else(|| panic!("{id}"));
        for name in ["applies", "value", "limit", "unit", "met", "needs", "source"] {
            assert!(rule.get(name).is_some(), "{id}: {name}");
        }
    }
    let met = |id: &str| rules.iter().find(|rule| rule["id"] == id).unwrap()["met"].clone();
    assert_eq!(met("sherard-dunnigan"), false);
    assert_eq!(met("terzaghi"), serde_json::Value::Null);
    let words = String::from_utf8(voidwalk(&["rules", &till, &filter]).stdout).unwrap();
    assert!(words.contains("NOT MET") && words.contains("category 3, 38.0 % fines"), "{words}");
    // Exchanged files, and micrometres under a header in mm.
    let output = voidwalk(&["rules", &filter, &till]);
    let exchanged = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{exchanged}");
    for said in ["are the two files exchanged?", "exchange the two", "--as-given"] {
        assert!(exchanged.contains(said), "{exchanged}");
    }
    let output = voidwalk(&["rules", &filter, &till, "--as-given"]);
    let as_given = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && as_given.contains("exchanged"), "{as_given}");
    let micrometres = sieve("um.csv", "75,0\n318,85\n600,100\n");
    let output = voidwalk(&["rules", &micrometres, &filter]);
    assert!(output.status.code() == Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("micrometres under a header in mm"));
}

/// Several soils in a sheet are the curves of one envelope; every number names its curve.
#[test]
fn envelopes_dispersive_soils_and_joints_by_the_command() {
    let root = tempfile::tempdir().unwrap();
    let sheet = |name: &str, text: &str| {
        let path = root.path().join(name);
        fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let filter =
        sheet("filter.csv", "opening_mm,fine side,coarse side\n0.5,15,0\n1,60,15\n2,100,60\n5,100,100\n");
    let base = sheet("base.csv", "opening_mm,fine,coarse\n0.001,0,0\n0.075,90,60\n0.2,98,85\n1,100,100\n");
    let json = |more: &[&str]| -> serde_json::Value {
        let output = voidwalk(&[&["rules", &base, &filter, "--json"], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let rule = |value: &serde_json::Value, id: &str| {
        value["rules"].as_array().unwrap().iter().find(|rule| rule["id"] == id).cloned()
    };
    let value = json(&[]);
    assert_eq!(
        (value["base"]["curve"].as_str(), value["base"]["category"].as_u64()),
        (Some("fine"), Some(1))
    );
    let retains = rule(&value, "sherard-dunnigan").unwrap();
    assert_eq!((&retains["filter_curve"], &retains["base_curve"]), (&"coarse side".into(), &"fine".into()));
    // 90 % at 0.075 mm, 0 % at 0.001 mm: D85B = 0.001 x 75^(85/90) = 0.05900 mm, 9 times that 0.5310 mm.
    assert!((retains["limit"].as_f64().unwrap() - 0.009 * 75f64.powf(85.0 / 90.0)).abs() < 1e-9);
    let drains = rule(&value, "permeability").unwrap();
    assert_eq!((&drains["filter_curve"], &drains["base_curve"]), (&"fine side".into(), &"coarse".into()));
    // 15 % of the fine side are finer than its sieves, so that the band may be wider.
    let band = rule(&value, "filter-band").unwrap();
    assert_eq!((&band["met"], &band["value_bound"]), (&serde_json::Value::Null, &"at least".into()));
    assert!(rule(&value, "constricted-exit").is_none());
    let dispersive = json(&["--dispersive", "--joint-mm", "1e-9"]);
    let limit = rule(&dispersive, "sherard-dunnigan").unwrap()["limit"].as_f64().unwrap();
    assert!((limit - 0.0064 * 75f64.powf(85.0 / 90.0)).abs() < 1e-9);
    assert_eq!(rule(&dispersive, "constricted-exit").unwrap()["value"], 0.0);
    let words = String::from_utf8(voidwalk(&["rules", &base, &filter, "--joint-mm", "5"]).stdout).unwrap();
    assert!(words.contains("filter curve coarse side, base curve fine"), "{words}");
    // One curve of each by its name.
    let one = voidwalk(&["rules", &format!("{base}#coarse"), &format!("{filter}#fine side"), "--json"]);
    let one: serde_json::Value = serde_json::from_slice(&one.stdout).unwrap();
    assert!(one["base"].get("curves").is_none() && rule(&one, "filter-band").is_none());
    for joint in ["0", "-1", "wide"] {
        let output = voidwalk(&["rules", &base, &filter, "--joint-mm", joint]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && stderr.contains("a length above 0"), "{stderr}");
    }
}

/// The till of the first trial: 92 % of it are finer than 4.75 mm, 35 % than 0.075 mm.
#[test]
fn the_base_is_walked_regraded_where_the_scene_says_so() {
    let root = tempfile::tempdir().unwrap();
    let sieve = |name: &str, rows: &str| table(root.path(), name, rows);
    let filter = format!("filter.sieve={}", sieve("gravel.csv", "5,0\n6.5,15\n20,100\n"));
    let till =
        format!("base.sieve={}", sieve("till.csv", "19,100\n4.75,92\n2,82\n0.425,60\n0.075,35\n0.01,0\n"));
    let check = |more: &[&str]| {
        let set = ["check", "--json", "--set", &filter, "--set", &till, "--set", "base.n_base=1000"];
        let output = voidwalk(&[&set, more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let warned = |value: &serde_json::Value, said: &str| {
        value["notes"].as_array().unwrap().iter().any(|note| note["id"] == said)
    };
    let as_it_is = check(&[]);
    let base = &as_it_is["inputs"]["base"];
    assert!(base["d100_mm"] == 19.0 && base.get("regraded_at_mm").is_none());
    assert!(warned(&as_it_is, "not_regraded"), "{as_it_is}");
    assert_eq!(check(&["--set", "base.regrade=no"])["inputs"], as_it_is["inputs"]);
    let regraded = check(&["--set", "base.regrade=practice"]);
    let base = &regraded["inputs"]["base"];
    assert!(base["d100_mm"] == 4.75 && base["regraded_at_mm"] == 4.75, "{base}");
    assert!((base["d85_mm"].as_f64().unwrap() - 1.5305).abs() < 1e-3);
    assert!(base["name"].as_str().unwrap().ends_with("till.csv"), "{base}");
    assert!(warned(&regraded, "regraded"), "{regraded}");
    assert!(!warned(&regraded, "not_regraded"), "{regraded}");
    // A broad sand that practice leaves as it is: Cu 9.8.
    let broad = format!("base.sieve={}", sieve("broad.csv", "0.03,0\n0.1,20\n0.6,60\n4,100\n"));
    assert!(warned(&check(&["--set", &broad]), "broadly_graded"), "{}", check(&["--set", &broad]));
    // What practice leaves as it is, is left and said; what has no unit is refused.
    let sand = format!("base.sieve={}", sieve("sand.csv", "0.1,0\n0.5,85\n1,100\n"));
    let left = check(&["--set", &sand, "--set", "base.regrade=practice"]);
    assert!(!warned(&left, "regrading_not_needed") && left["inputs"]["base"]["d100_mm"] == 1.0, "{left}");
    let stone = format!("base.sieve={}", sieve("stone.csv", "2,0\n4,60\n5.5,100\n"));
    let left = check(&["--set", &stone, "--set", "base.regrade=practice"]);
    assert!(warned(&left, "regrading_not_needed"), "{left}");
    let output = voidwalk(&["check", "--set", "base.regrade=practice"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("needs sizes in mm"));
    // The modelled layer and the real one.
    let thin = check(&["--set", "filter.thickness_mm=300"]);
    assert!(warned(&thin, "layers_thicker"), "{thin}");
    assert!(!warned(&check(&["--set", "filter.thickness_mm=3000"]), "layers_thicker"));
}

/// Exchanged tables and micrometres are recognised before Eq. (2) is blamed.
#[test]
fn tables_that_cannot_be_are_refused_by_what_is_wrong_with_them() {
    let root = tempfile::tempdir().unwrap();
    let sieve = |name: &str, rows: &str| table(root.path(), name, rows);
    let sand = sieve("sand.csv", "1,0\n2,50\n4,100\n");
    let refused_with = |filter: &str, base: &str, said: &str| {
        let (filter, base) = (format!("filter.sieve={filter}"), format!("base.sieve={base}"));
        let out = root.path().join("none");
        let args = ["run", "--out", out.to_str().unwrap(), "--set", &filter, "--set", &base];
        let output = voidwalk(&args);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && stderr.contains(said), "{stderr}");
        assert!(!out.exists());
    };
    let micrometres = sieve("um.csv", "75,0\n318,85\n600,100\n");
    refused_with(&sand, &micrometres, "are its sizes micrometres under a header in mm");
    // Where Eq. (2) still gives particles it is a warning, said before any work.
    let gravel = sieve("gravel.csv", "20,0\n30,50\n60,100\n");
    let (filter, base) = (format!("filter.sieve={sand}"), format!("base.sieve={gravel}"));
    let output = voidwalk(&["check", "--set", &filter, "--set", &base]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("are the two files exchanged?"));
}

/// 7 D85B and 9 D95B of this sand are 3.14 and 4.33 mm: excessive erosion damages a dam, and is not judged.
#[test]
fn a_boundary_of_continuing_erosion_that_is_not_reached_is_no_good_news() {
    let root = tempfile::tempdir().unwrap();
    let base = table(root.path(), "base.csv", "0.18,0\n0.3,30\n0.5,100\n");
    let of = |filter: &str| {
        let filter = table(root.path(), "filter.csv", filter);
        let output = voidwalk(&["rules", &base, &filter]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let row = "Foster and Fell: boundary of continuing erosion: D15F = ";
    let line = |said: &str| {
        let at = said.lines().position(|line| line.contains(row)).unwrap();
        said.lines().skip(at).take(2).map(str::to_owned).collect::<Vec<_>>()
    };
    let between = line(&of("3,0\n4,15\n8,100\n"));
    assert!(between[0].starts_with("  not reached Foster and Fell: ") && !between[0].contains("<="));
    assert!(between[0].ends_with(" mm, continuing beyond 4.33 mm"), "{between:?}");
    assert!(
        between[1].trim() == "continuing erosion not reached; excessive erosion not judged",
        "{between:?}"
    );
    let fine = line(&of("1,0\n1.5,15\n3,100\n"));
    assert!(fine[0].starts_with("  not reached ") && !fine[1].contains("excessive"), "{fine:?}");
    assert!(line(&of("5,0\n6,15\n12,100\n"))[0].starts_with("  NOT MET "));
}

#[test]
fn every_rule_is_listed_with_its_authorities() {
    let root = tempfile::tempdir().unwrap();
    let filter = table(root.path(), "filter.csv", "2.24,0\n3.15,28\n6.3,100\n");
    let base = table(root.path(), "base.csv", "0.18,0\n0.3,30\n0.5,100\n");
    let words = String::from_utf8(voidwalk(&["rules", &base, &filter]).stdout).unwrap();
    let authorities = |rule: &str| {
        let below = words.split(rule).nth(1).unwrap_or_else(|| panic!("{rule}: {words}"));
        below.lines().find_map(|line| line.trim().strip_prefix("authority: ")).unwrap().to_owned()
    };
    assert_eq!(authorities("Sherard and Dunnigan: "), "Sherard and Dunnigan, NRCS, USBR, USACE");
    assert_eq!(authorities("boundary of continuing erosion"), "Foster and Fell, USACE");
    assert_eq!(authorities("Permeability: "), "NRCS, USBR, USACE");
    let refused = voidwalk(&["rules", &base, &filter, "--authority", "nrcs"]);
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn fifty_samples_of_an_ags_file_are_one_table_and_the_strictest_govern() {
    let root = tempfile::tempdir().unwrap();
    let mut ags = String::from(
        "\"GROUP\",\"PROJ\"\n\"HEADING\",\"PROJ_ID\"\n\"DATA\",\"P1\"\n\n\"GROUP\",\"GRAT\"\n\"HEADING\",\"LOCA_ID\",\
         \"SAMP_TOP\",\"SPEC_DPTH\",\"GRAT_SIZE\",\"GRAT_PERP\",\"GRAT_TYPE\"\n\"UNIT\",\"\",\"m\",\"m\",\"mm\",\"%\",\"\"\n\
         \"TYPE\",\"ID\",\"2DP\",\"2DP\",\"3SF\",\"0DP\",\"PA\"\n",
    );
    for sample in 1..=50 {
        // Sands without fines; the first is the finest.
        let largest = 0.4 + 0.01 * f64::from(sample);
        for (part, percent) in [(1.0, 100), (0.6, 50), (0.3, 5), (0.2, 0)] {
            let size = part * largest;
            ags += &format!("\"DATA\",\"TP{sample}\",\"1.00\",\"1.00\",\"{size:.5}\",\"{percent}\",\"WS\"\n");
        }
    }
    let site = root.path().join("site.ags").display().to_string();
    fs::write(&site, ags).unwrap();
    let filters = [("fine", 0.6), ("usual", 1.0), ("coarse", 4.0)].map(|(name, scale): (&str, f64)| {
        let rows =
            [(1.0, 0), (2.0, 60), (4.0, 100)].map(|(size, percent)| format!("{},{percent}\n", scale * size));
        table(root.path(), &format!("{name}.csv"), &rows.concat())
    });
    let csv = root.path().join("table.csv").display().to_string();
    let words =
        [&["rules", &site], &filters.each_ref().map(String::as_str)[..], &["--each", "--csv", &csv]].concat();
    let output = voidwalk(&words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    let rows = fs::read_to_string(&csv).unwrap();
    assert_eq!(rows.lines().count(), 151);
    assert!(rows.lines().nth(1).unwrap().contains(",Sherard and Dunnigan,"), "{rows}");
    assert!(said.contains("coarse.csv: of 50 samples 0 met, 50 not met, 0 without a result"), "{said}");
    let of_fine = said.split("fine.csv: of 50 samples").nth(1).unwrap();
    let of_fine: Vec<&str> = of_fine.lines().collect();
    assert!(of_fine[1].starts_with("  governing sample TP1 1.00 1.00: D15F up to "), "{of_fine:?}");
    assert!(of_fine[2].starts_with("  then TP2 ") && of_fine[3].starts_with("  then TP3 "), "{of_fine:?}");
    let walk = of_fine.iter().find(|line| line.starts_with("  Nothing was walked."));
    assert!(walk.is_some_and(|line| line.contains(" --each --governing")), "{of_fine:?}");
    // A row says what the rules say of that pair alone.
    let one = voidwalk(&["rules", &format!("{site}#TP7 1.00 1.00"), &filters[1], "--json"]);
    let one: serde_json::Value = serde_json::from_slice(&one.stdout).unwrap();
    let design = &one["rules"].as_array().unwrap()[0];
    let row = rows.lines().find(|row| row.starts_with("TP7 ") && row.contains("usual.csv")).unwrap();
    let limit = format!(",{:.4},false,", design["limit"].as_f64().unwrap());
    assert!(row.contains(&limit), "{row}: {limit}");
    // The same table may stay, and another file is not written over; several filters need the samples one by one.
    assert!(voidwalk(&words).status.success());
    fs::write(&csv, "mine").unwrap();
    let again = voidwalk(&words);
    assert!(
        again.status.code() == Some(2) && String::from_utf8_lossy(&again.stderr).contains("exists already")
    );
    let envelope = voidwalk(&["rules", &site, &filters[0], &filters[1]]);
    let refused = String::from_utf8_lossy(&envelope.stderr);
    assert!(
        envelope.status.code() == Some(2) && refused.contains("holds 50 soils; name one of"),
        "{refused}"
    );
    let one = voidwalk(&["rules", &format!("{site}#TP7 1.00 1.00"), &filters[0], &filters[1]]);
    let said = String::from_utf8(one.stdout).unwrap();
    assert!(said.contains("fine.csv: of 1 sample") && said.contains("usual.csv: of 1 sample"), "{said}");
}

#[test]
fn the_samples_of_a_folder_are_those_of_its_tables() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("lab");
    fs::create_dir(&folder).unwrap();
    table(&folder, "b.csv", "2,100\n0.5,40\n0.1,0\n");
    table(&folder, "a.csv", "1,100\n0.25,40\n0.08,0\n");
    table(&folder, "gravel.csv", "60,100\n30,40\n20,0\n");
    let filter = table(root.path(), "filter.csv", "2,100\n1,50\n0.5,0\n");
    let folder = folder.display().to_string();
    let output = voidwalk(&["rules", &folder, &filter, "--each"]);
    let said = String::from_utf8(output.stdout).unwrap();
    let names: Vec<&str> =
        said.lines().skip(1).take(3).map(|l| l.split_whitespace().next().unwrap()).collect();
    assert_eq!(names, ["a", "b", "gravel"]);
    assert!(
        said.contains("nothing applied, as base and filter look exchanged: gravel")
            && !said.contains("may govern"),
        "{said}"
    );
    assert_eq!(voidwalk(&["rules", &folder, &filter]).status.code(), Some(2));
    let twice = voidwalk(&["rules", &folder, &filter, &filter, "--each"]);
    assert!(
        twice.status.code() == Some(2) && String::from_utf8_lossy(&twice.stderr).contains("is named twice")
    );
    // What was assumed of a file stands below the table once; joint and envelope are named.
    let sheet = root.path().join("lab/k.csv");
    fs::write(&sheet, "Sieve (mm),Core,Shell\n1,1,1\n0.25,0.4,0.3\n0.08,0,0\n").unwrap();
    let band = root.path().join("band.csv").display().to_string();
    fs::write(&band, "opening_mm,fine side,coarse side\n0.5,15,0\n1,60,15\n2,100,60\n5,100,100\n").unwrap();
    let output = voidwalk(&["rules", &folder, &band, "--each", "--joint-mm", "9"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("an envelope of 2 curves (fine side, coarse side)"), "{said}");
    assert!(said.matches("joint: 90 % continuing").count() == 4, "{said}");
    let notes: Vec<&str> = said.lines().filter(|line| line.starts_with("note  ")).collect();
    assert!(
        notes.len() == 1 && notes[0].ends_with("k.csv: values from 0 to 1 read as fractions: 1 is 100 %")
    );
    fs::write(root.path().join("lab/c.csv"), "nothing").unwrap();
    let refused = voidwalk(&["rules", &folder, &filter, "--each"]);
    assert!(refused.status.code() == Some(2) && String::from_utf8_lossy(&refused.stderr).contains("c.csv"));
}
