//! `serve`: every sample of a sheet walked, as `judge --each` does, with a table that grows.

use std::fs;

use serde_json::{Value, json};

use crate::program::{call, done};
use crate::served::{Served, serve};

const SMALL: [&str; 5] =
    ["network.nx=6", "network.ny=6", "network.nz=8", "record.sensitivity=[]", "replicates=2"];

/// The borrow area and two filters, and the same as files.
fn with_samples() -> Served {
    let served = serve();
    done(&call(served.root(), &["examples", "try"]));
    for name in ["borrow-area.ags", "filter.csv", "filter-fine.csv"] {
        let text = fs::read_to_string(served.root().join("try").join(name)).unwrap();
        assert_eq!(served.sheet(name, &text).0, 200);
    }
    served
}

/// Asks for the walks of these filters; status and answer.
fn ask(served: &Served, filters: &[&str], walks: &str, changes: &[&str]) -> (u16, Value) {
    let changes = [&SMALL[..], changes].concat();
    let asked = json!({ "base": "1#BH1", "filters": filters, "walks": walks, "changes": changes });
    served.post("api/batch", asked.to_string().as_bytes())
}

fn cells(table: &Value, heading: &str) -> Vec<String> {
    let at = table["headings"].as_array().unwrap().iter().position(|of| of == heading).unwrap();
    let rows = table["rows"].as_array().unwrap().iter();
    rows.map(|row| row[at].as_str().unwrap().to_owned()).collect()
}

/// Whether a rule of retention is not kept, the filter may lose its fines, or the walk erodes.
fn is_doubted(row: &Value) -> bool {
    let erodes = ["some erosion", "continuing erosion"].iter().any(|class| row["walk"]["verdict"] == *class);
    let practice = &row["walk"]["by_practice"];
    let against = practice.is_string() && practice != "no erosion";
    row["met"] == false || row["may_lose_fines"] == true || erodes || against
}

#[test]
fn the_table_is_that_of_the_command_line_and_grows_while_it_is_walked() {
    let served = with_samples();
    let (status, said) = ask(&served, &["2", "3"], "governing", &["about.units=us"]);
    assert_eq!(status, 200, "{said}");
    let id = said["id"].as_u64().unwrap();
    let job = served.until(id, |job| job["state"] != "running" && job["state"] != "waiting");
    assert_eq!((&job["state"], &job["kind"]), (&"done".into(), &"batch".into()), "{job}");
    // The result has the table, which is not sent twice.
    assert!(job["live"]["table"].is_null(), "{job}");
    let result = &job["result"];
    let walked = cells(result, "Walked");
    assert!(walked.iter().filter(|how| *how == "in full").count() == 6, "{walked:?}");
    let mut words = vec!["judge", "borrow-area.ags", "filter.csv", "filter-fine.csv", "--each", "--out", "b"];
    words.extend(SMALL.iter().chain(&["about.units=us"]).flat_map(|set| ["--set", set]));
    let told = call(&served.root().join("try"), &words);
    done(&told);
    let told = String::from_utf8(told.stdout).unwrap();
    let record = |at: &str| -> Value {
        serde_json::from_slice(&fs::read(served.root().join(at).join("batch.json")).unwrap()).unwrap()
    };
    let [page, line] = [record(&format!("served/batch-{id}")), record("try/b")];
    assert_eq!(page["rows"].as_array().unwrap().len(), 12);
    for (a, b) in page["rows"].as_array().unwrap().iter().zip(line["rows"].as_array().unwrap()) {
        assert_eq!((&a["sample"], &a["limit_mm"]), (&b["sample"], &b["limit_mm"]));
        let walk = |row: &Value| json!([row["walk"]["verdict"], row["walk"]["runs"], row["walk"]["in_full"]]);
        assert_eq!(walk(a), walk(b), "{}", a["sample"]);
    }
    // What is met and yet in doubt is marked, so that it does not stand in green.
    let rows = page["rows"].as_array().unwrap();
    for (row, class) in rows.iter().zip(result["classes"].as_array().unwrap()) {
        let is_green = row["met"] == true && row["breaks_if_dispersive"] != true && !is_doubted(row);
        assert_eq!((class == "keeps", class == "breaks"), (is_green, row["met"] == false), "{row}");
    }
    assert!(rows.iter().any(is_doubted), "{result}");
    for sentence in result["filters"][0].as_array().unwrap().iter().skip(1) {
        assert!(told.contains(&sentence.as_str().unwrap().replace('\u{202f}', " ")), "{sentence}");
    }
    assert!(cells(result, "Limit, mm").iter().all(|cell| cell.contains("in)")), "{result}");
    // Neither table nor sentences name a folder of the server.
    assert!(!result.to_string().contains("sheets") && !job["title"].as_str().unwrap().contains("sheets"));
    let (status, _, body) = served.get(job["page"].as_str().unwrap());
    assert!(
        status == 200 && String::from_utf8(body).unwrap().contains("Which samples do these filters hold?")
    );
    // A later server has the same table.
    let served = served.again();
    assert_eq!(served.job(id)["result"], *result);
}

#[test]
fn a_batch_that_is_stopped_goes_on_and_keeps_what_is_walked() {
    let served = with_samples();
    // It is stopped after the first of six walks that take as long as it.
    let long = ["replicates=60", "network.nx=8", "network.ny=8"];
    let (status, said) = ask(&served, &["2"], "look", &long);
    assert_eq!(status, 200, "{said}");
    let id = said["id"].as_u64().unwrap();
    let looks = |job: &Value| {
        let table = &job["live"]["table"];
        if table.is_null() {
            0
        } else {
            cells(table, "Walked").iter().filter(|how| *how == "first look").count()
        }
    };
    let stop = || {
        assert_eq!(served.post(&format!("api/stop?id={id}"), b"").0, 200, "it was done too soon");
        served.until(id, |job| job["state"] == "stopped")
    };
    let begun = served.until(id, |job| looks(job) > 0);
    let table = &begun["live"]["table"];
    assert_eq!((cells(table, "Sample").len(), table["classes"].as_array().unwrap().len()), (6, 6));
    let stopped = stop();
    assert!(stopped["can_continue"] == true && looks(&stopped) < 6, "{stopped}");
    let kept = looks(&stopped);
    assert_eq!(served.post(&format!("api/continue?id={id}"), b"").0, 200);
    // What is done stands in the table from the start.
    let begun = served.until(id, |job| !job["live"]["table"].is_null());
    assert!(looks(&begun) >= kept && kept > 0, "{begun}");
    served.until(id, |job| looks(job) > kept);
    stop();
}

/// Two sheets of one file name are told apart on page, table and record, and no path of the server is there.
#[test]
fn filters_of_one_file_name_are_numbered() {
    let served = with_samples();
    for file in ["filter.csv", "filter-fine.csv"] {
        let text = fs::read_to_string(served.root().join("try").join(file)).unwrap();
        assert_eq!(served.sheet("same.csv", &text).0, 200);
    }
    let (status, said) = ask(&served, &["4", "5"], "alone", &[]);
    assert_eq!(status, 200, "{said}");
    let id = said["id"].as_u64().unwrap();
    let job = served.until(id, |job| job["state"] == "done");
    assert_eq!(job["title"], "Every sample of borrow-area.ags on 1 same.csv, 2 same.csv");
    let folder = served.root().join(format!("served/batch-{id}"));
    let record: Value = serde_json::from_slice(&fs::read(folder.join("batch.json")).unwrap()).unwrap();
    assert_eq!(record["samples"], "borrow-area.ags");
    let names: Vec<&Value> = record["filters"].as_array().unwrap().iter().map(|of| &of["name"]).collect();
    assert_eq!(names, ["1 same.csv", "2 same.csv"]);
    let walked: Vec<String> = cells(&job["result"], "Filter");
    assert_eq!(
        (walked.len(), &walked[0], &walked[6]),
        (12, &names[0].to_string().replace('"', ""), &"2 same.csv".to_owned())
    );
    let page = fs::read_to_string(folder.join("batch.html")).unwrap();
    assert!(page.contains("1 same") && page.contains("2 same") && !page.contains("sheets/"), "{page}");
}

#[test]
fn a_batch_is_refused_before_anything_is_walked() {
    let served = with_samples();
    for (filters, walks, changes, says) in [
        (&[][..], "look", &[][..], "name one to 6 filters"),
        (&["2"; 7], "look", &[], "name one to 6 filters"),
        (&["2"], "all", &[], "governing, look, alone or filters"),
        (&["2", "2"], "look", &[], "is named twice"),
        (&["9"], "look", &[], "no such sheet"),
        (&["2"], "look", &["network.nx=0"], "network.nx"),
    ] {
        let (status, said) = ask(&served, filters, walks, changes);
        let said = said["problem"].as_str().unwrap_or_default().to_owned();
        assert!(status == 422 && said.contains(says) && !said.contains("sheets/"), "{says}: {status} {said}");
    }
    assert_eq!(served.json("api/state")["jobs"], json!([]));
}
