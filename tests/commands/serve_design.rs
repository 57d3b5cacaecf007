//! `serve`: a design, how it is refused, stopped and continued.

use std::fs;

use serde_json::{Value, json};

use crate::program::{call, done};
use crate::served::{Served, serve};

/// A base of Cu 1.5.
const NARROW: &str = "size_mm,percent\n0.2,0\n0.45,100\n";

const SMALL_DESIGN: [&str; 3] = ["network.nx=5", "network.ny=5", "network.nz=8"];

impl Served {
    fn design(&self, changes: &[&str], more: Value) -> (u16, Value) {
        let changes = [&SMALL_DESIGN[..], changes].concat();
        let mut asked = json!({ "base": "1", "shape": "shire2016-cu1.5-loose", "changes": changes });
        asked.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        self.post("api/design", asked.to_string().as_bytes())
    }
}

#[test]
fn a_design_finds_the_boundaries_of_the_command_line() {
    let served = serve();
    assert_eq!(served.sheet("narrow.csv", NARROW).0, 200);
    let (status, said) = served.design(&["replicates=3"], json!({}));
    assert_eq!(status, 200, "{said}");
    let id = said["id"].as_u64().unwrap();
    let job = served.until(id, |job| job["state"] == "done" || job["state"] == "failed");
    assert_eq!((&job["kind"], &job["state"]), (&"design".into(), &"done".into()), "{job}");
    let lines = job["live"]["lines"].as_array().unwrap();
    assert!(lines.iter().any(|line| line.as_str().unwrap().contains("network 3 of 3")), "{lines:?}");
    fs::write(served.root().join("narrow.csv"), NARROW).unwrap();
    let sets = SMALL_DESIGN.iter().chain(&["replicates=3"]).flat_map(|set| ["--set", *set]);
    let args = ["design", "narrow.csv", "--filter", "shire2016-cu1.5-loose", "-q"];
    done(&call(served.root(), &args.into_iter().chain(sets).collect::<Vec<_>>()));
    let told = fs::read(served.root().join("voidwalk-design/design.json")).unwrap();
    let told: Value = serde_json::from_slice(&told).unwrap();
    let (rows, expected) = (&job["result"]["boundaries"], &told["boundaries"]);
    assert_eq!(rows.as_array().unwrap().len(), 1);
    for name in ["density", "thickness", "layers", "no_erosion_note"] {
        assert_eq!(rows[0][name], expected[0][name], "{name}");
    }
    // Of three networks the page has the least and the most, the file the 5 and 95 percentiles.
    for name in ["no_erosion", "continuing"] {
        let [shown, written] = [rows, expected].map(|rows| &rows[0][name]);
        assert_eq!(shown["median"], written["median"], "{name}");
        let [least, low] = [shown, written].map(|of| of["low"].as_f64());
        let [most, high] = [shown, written].map(|of| of["high"].as_f64());
        assert!(least.is_some() && least <= low && most >= high, "{name}: {shown} {written}");
    }
    assert!(rows[0]["no_erosion"]["d15f_mm"]["median"].as_f64().unwrap() > 0.1, "{rows}");
    let names: Vec<&Value> = job["result"]["lines"].as_array().unwrap().iter().map(|line| &line[0]).collect();
    assert_eq!(names, ["Practice", "Limit", "Model (research)"]);
    assert_eq!(job["result"]["base"], "narrow.csv", "no folder");
    let (status, head, zip) = served.get(&format!("zip/design-{id}.zip"));
    assert!(status == 200 && head.contains("attachment") && zip.starts_with(b"PK"), "{head}");
    // The next server on this folder shows the same.
    let next = served.again();
    let same = next.job(id);
    assert_eq!((&same["kind"], &same["state"]), (&"design".into(), &"done".into()));
    assert_eq!((&same["result"], &same["page"]), (&job["result"], &job["page"]));
    let (status, _, page) = next.get(same["page"].as_str().unwrap());
    assert!(status == 200 && String::from_utf8(page).unwrap().contains("Boundaries of the model"));
}

#[test]
fn a_design_that_was_stopped_or_killed_keeps_its_networks() {
    let served = serve();
    assert_eq!(served.sheet("narrow.csv", NARROW).0, 200);
    let id = served.design(&["replicates=400"], json!({})).1["id"].as_u64().unwrap();
    let says = |words: &'static str| {
        move |job: &Value| {
            let lines = job["live"]["lines"].as_array().unwrap();
            lines.iter().any(|line| line.as_str().unwrap().contains(words))
        }
    };
    served.until(id, says("network 2 of 400"));
    assert_eq!(served.post(&format!("api/stop?id={id}"), b"").0, 200);
    let stopped = served.until(id, |job| job["state"] == "stopped");
    assert!(stopped["message"].as_str().unwrap().contains("of 400 networks, which are kept"), "{stopped}");
    assert_eq!(served.post(&format!("api/continue?id={id}"), b"").0, 200);
    served.until(id, says("of 400 networks are done already"));
    let next = served.again();
    let left = next.job(id);
    assert_eq!((&left["state"], &left["can_continue"]), (&"stopped".into(), &true.into()), "{left}");
    assert_eq!(next.post(&format!("api/continue?id={id}"), b"").0, 200);
    next.until(id, says("of 400 networks are done already"));
}

#[test]
fn a_design_is_refused_in_the_words_of_the_command_line() {
    let served = serve();
    assert_eq!(served.sheet("narrow.csv", NARROW).0, 200);
    fs::write(served.root().join("narrow.csv"), NARROW).unwrap();
    for (more, args) in [
        (json!({ "shape": "nosuch" }), ["--filter", "nosuch"]),
        (json!({ "shape": "-3" }), ["--filter", "-3"]),
        (json!({ "shape": "3", "density": "x" }), ["--filter=3", "--density=x"]),
        (json!({ "density": "loose" }), ["--filter=shire2016-cu1.5-loose", "--density=loose"]),
        (json!({ "thickness": "0" }), ["--thickness", "0"]),
        (json!({ "changes": ["base.uc=3"] }), ["--set", "base.uc=3"]),
        (json!({ "changes": ["base.cu=3"] }), ["--set", "base.cu=3"]),
    ] {
        let (status, said) = served.design(&[], more);
        let told = call(served.root(), &[&["design", "narrow.csv"], &args[..]].concat());
        assert_eq!((status, told.status.code()), (422, Some(2)), "{said}");
        let (told, said) = (String::from_utf8(told.stderr).unwrap(), said["problem"].as_str().unwrap());
        assert!(told.contains(said) && said.len() > 20, "{told} {said}");
    }
    // Exchanged sheets are refused by every kind of work, and by the rules, unless they are as given.
    assert_eq!(served.sheet("stone.csv", "size_mm,percent\n5,0\n20,100\n").0, 200);
    let exchanged = json!({ "base": "2", "filter": "1", "changes": [] });
    for kind in ["judge", "check"] {
        let (status, said) = served.post(&format!("api/{kind}"), exchanged.to_string().as_bytes());
        let said = said["problem"].as_str().unwrap();
        assert!(
            status == 422 && said.starts_with("base stone.csv, filter narrow.csv: the base is"),
            "{said}"
        );
        assert!(said.ends_with("as given (the tick \"base and filter are as given\")"), "{said}");
    }
    let (status, said) = served.design(&[], json!({ "base": "2", "filter": "1", "shape": "" }));
    assert!(status == 422 && said.to_string().contains("are the two files exchanged?"), "{said}");
    let (status, _, said) = served.get("api/rules?base=2&filter=1");
    assert!(status == 422 && String::from_utf8(said).unwrap().contains("are the two files exchanged?"));
    assert_eq!(served.get("api/rules?base=2&filter=1&as_given=1").0, 200);
    let pair = served.json("api/rules?base=1&filter=2");
    assert_eq!(pair["base"]["d85_mm"], pair["base"]["d85_as_sampled_mm"]);
    // A limit that is just reached reads as kept, in the texts of the program.
    let base = "size_mm,percent_finer\n0.08,0\n0.299,85\n0.4,100\n";
    let filter = "size_mm,percent_finer\n0.9,0\n1.196,15\n3,100\n";
    let [base, filter] = [("b.csv", base), ("f.csv", filter)].map(|(name, text)| {
        let (status, sheet) = served.sheet(name, text);
        assert_eq!(status, 200, "{sheet}");
        sheet["id"].clone()
    });
    let pair = served.json(&format!("api/rules?base={base}&filter={filter}"));
    let rules = pair["rules"].as_array().unwrap().iter().zip(pair["shown"].as_array().unwrap());
    let number = |text: &Value| -> f64 {
        text.as_str().unwrap().split(['\u{202f}', ' ']).next().unwrap().parse().unwrap()
    };
    let mut reached = 0;
    for (rule, shown) in rules {
        assert_eq!(
            (rule["value"].is_null(), rule["limit"].is_null()),
            (shown[0].is_null(), shown[1].is_null())
        );
        let (Some(value), Some(limit)) = (rule["value"].as_f64(), rule["limit"].as_f64()) else { continue };
        reached += usize::from(value == limit);
        assert_eq!(
            number(&shown[0]).total_cmp(&number(&shown[1])),
            value.total_cmp(&limit),
            "{rule} {shown}"
        );
    }
    assert!(reached > 0, "{pair}");
    // The page works out no result itself, and a boundary that is not reached is not met.
    let all = pair["rules"].as_array().unwrap();
    let found = pair["results"].as_array().unwrap();
    let begins = pair["limit_begins"].as_array().unwrap();
    assert_eq!([found.len(), begins.len()], [all.len(); 2]);
    let [listed, values] = ["listed", "value_begins"].map(|name| pair[name].as_array().unwrap());
    assert_eq!([listed.len(), values.len()], [all.len(); 2]);
    assert_eq!((&listed[0][0], &values[0]), (&all[0]["name"], &"=".into()));
    assert!(pair["practice"].as_str().unwrap().starts_with("meets "), "{pair}");
    for ((rule, found), begin) in all.iter().zip(found).zip(begins) {
        let is_boundary = rule["role"] == "continuation";
        match rule["met"].as_bool() {
            Some(true) if is_boundary => assert_eq!(found, "not reached", "{rule}"),
            Some(met) => assert_eq!(found, if met { "met" } else { "not met" }, "{rule}"),
            None => assert!(!found.as_str().unwrap().contains("met"), "{rule} {found}"),
        }
        assert_eq!(begin == "continuing beyond", is_boundary, "{rule}");
    }
    // A path is no shape, a soil that is none no base, and nothing is left of either.
    for shape in ["narrow.csv", "./narrow.csv", "/etc/passwd", "../x", "sheets/1/narrow.csv"] {
        let (status, said) = served.design(&[], json!({ "shape": shape }));
        assert!(status == 422 && said.to_string().contains("no shipped filter is called"), "{said}");
    }
    assert_eq!(served.design(&[], json!({ "base": "../1" })).0, 422);
    assert_eq!(served.design(&[], json!({ "base": "1", "out": "x" })).0, 400);
    assert!(served.json("api/state")["jobs"].as_array().unwrap().is_empty());
    assert!(!served.root().join("served/design-1").exists());
}
