//! `serve`: jobs one after another, and those that outlive their server.

use std::fs;
use std::os::unix::fs::symlink;

use serde_json::{Value, json};

use crate::full_disk::Disk;
use crate::judge::COARSE;
use crate::program::{call, done, refused};
use crate::served::{serve, serve_in, written};

#[test]
fn jobs_are_walked_one_at_a_time_and_both_tabs_see_them() {
    let served = serve();
    served.two_sheets();
    assert_eq!(served.sheet("coarse.csv", COARSE).0, 200);
    let long = served.judge(&["replicates=5000"]).1["id"].as_u64().unwrap();
    let quick = json!({ "base": "1", "filters": ["2", "3"], "walks": "filters", "quick": true,
        "changes": ["network.nx=6", "network.ny=6", "network.nz=8"] });
    let (status, said) = served.post("api/batch", quick.to_string().as_bytes());
    let table = said["id"].as_u64().unwrap();
    assert_eq!(status, 200);
    let walking = served.until(long, |job| job["live"]["so_far"]["replicates"].as_u64() >= Some(5));
    assert_eq!(walking["state"], "running");
    let so_far = &walking["live"]["so_far"];
    assert!(so_far["class"].is_string() && so_far["runs"][0]["low"].is_number(), "{so_far}");
    assert!(walking["page"].is_null() && walking["result"].is_null(), "no verdict before the end");
    assert_eq!(served.job(table)["state"], "waiting");
    assert_eq!(served.post(&format!("api/stop?id={long}"), b"").0, 200);
    let stopped = served.until(long, |job| job["state"] == "stopped");
    assert!(stopped["message"].as_str().unwrap().contains("voidwalk resume"), "{stopped}");
    let done = served.until(table, |job| job["state"] == "done");
    assert_eq!(done["result"]["rows"].as_array().unwrap().len(), 2);
    let page = done["page"].as_str().unwrap();
    let (status, head, body) = served.get(page);
    assert!(status == 200 && head.contains("sha256-") && !head.contains("unsafe"), "{head}");
    assert!(String::from_utf8(body).unwrap().contains("Which of these filters hold this base?"));
    let (status, head, zip) = served.get(&format!("zip/batch-{table}.zip"));
    assert!(status == 200 && head.contains("attachment") && zip.starts_with(b"PK"), "{head}");
    // It continues from where it was: what was saved of replicates that are done is not written again.
    let checkpoint = served.root().join(format!("served/run-{long}/checkpoint"));
    let saved = written(&checkpoint, "");
    let finished = so_far["replicates"].as_u64().unwrap() as usize;
    assert!(saved.len() >= finished, "{saved:?}");
    assert_eq!(served.post(&format!("api/continue?id={long}"), b"").0, 200);
    assert_eq!(served.post(&format!("api/continue?id={long}"), b"").0, 409);
    let more = served.until(long, |job| job["live"]["so_far"]["replicates"].as_u64() >= Some(5));
    assert_eq!(more["state"], "running");
    let now = written(&checkpoint, "");
    let kept = saved.iter().filter(|file| now.contains(file)).count();
    assert!(kept >= finished, "{finished} were done, {kept} of them kept");
}

/// A server that is killed takes no run with it.
#[test]
fn what_a_killed_server_had_begun_continues() {
    let mut served = serve();
    served.two_sheets();
    let id = served.judge(&["replicates=300"]).1["id"].as_u64().unwrap();
    served.until(id, |job| job["live"]["so_far"]["replicates"].as_u64() >= Some(2));
    refused(&call(served.root(), &["serve", "--out", "served"]), "served");
    served.child.kill().unwrap();
    served.child.wait().unwrap();
    let run = format!("served/run-{id}");
    done(&call(served.root(), &["resume", &run, "-q"]));
    let outcome = fs::read(served.root().join(&run).join("outcome.json")).unwrap();
    let outcome: Value = serde_json::from_slice(&outcome).unwrap();
    assert_eq!(outcome["replicates"].as_array().unwrap().len(), 300);
    // The next server on this folder has it.
    let at = std::mem::replace(&mut served.at, tempfile::tempdir().unwrap());
    let next = serve_in(at);
    let job = next.job(id);
    assert_eq!((&job["state"], &job["result"]["model"]), (&"done".into(), &outcome["model"]["class"]));
    assert!(!job["result"]["notes"].as_array().unwrap().is_empty(), "{job}");
    let (page, zip) = (job["page"].as_str().unwrap(), format!("zip/run-{id}.zip"));
    assert_eq!((next.get(page).0, next.get(&zip).0), (200, 200));
    // In place of its folder a link to another is not followed.
    let (run, elsewhere) = (next.root().join(&run), next.root().join("elsewhere"));
    fs::rename(&run, &elsewhere).unwrap();
    symlink(&elsewhere, &run).unwrap();
    assert_eq!((next.get(page).0, next.get(&zip).0), (404, 404));
}

/// A table that was stopped with its server, and one that waited, are done by the next.
#[test]
fn what_waited_or_was_begun_when_the_server_ended_is_done_by_the_next() {
    let served = serve();
    served.two_sheets();
    for name in ["a.csv", "b.csv"] {
        assert_eq!(served.sheet(name, COARSE).0, 200);
    }
    let request = json!({ "base": "1", "filters": ["2", "3", "4"], "walks": "filters", "quick": true,
        "changes": ["network.nx=10", "network.ny=10", "network.nz=20", "replicates=40"] });
    let (_, said) = served.post("api/batch", request.to_string().as_bytes());
    let table = said["id"].as_u64().unwrap();
    let waits = served.judge(&["replicates=4"]).1["id"].as_u64().unwrap();
    served.until(table, |job| job["live"]["cases_done"].as_u64() >= Some(1));
    let title = served.job(table)["title"].clone();
    let (code, said, at) = served.end();
    assert_eq!(code, Some(3), "{said}");
    for words in [&format!("batch-{table}"), &format!("run-{waits}"), "voidwalk serve --out served"] {
        assert!(said.contains(words), "{said}");
    }
    let next = serve_in(at);
    let state = next.json("api/state");
    let names: Vec<&Value> = state["sheets"].as_array().unwrap().iter().map(|sheet| &sheet["name"]).collect();
    assert_eq!(names, ["base.csv", "fine.csv", "a.csv", "b.csv"]);
    let job = next.job(table);
    assert_eq!((&job["state"], &job["can_continue"]), (&"stopped".into(), &true.into()), "{job}");
    assert_eq!((&job["title"], &job["asked"]["base"]), (&title, &"1".into()));
    assert_eq!(next.job(waits)["can_continue"], true);
    let folder = next.root().join(format!("served/batch-{table}"));
    let cases = written(&folder, "case.json");
    assert!(!cases.is_empty() && cases.len() < 3, "{cases:?}");
    for id in [table, waits] {
        assert_eq!(next.post(&format!("api/continue?id={id}"), b"").0, 200);
    }
    let job = next.until(table, |job| job["state"] == "done");
    assert_eq!(job["result"]["rows"].as_array().unwrap().len(), 3);
    assert_eq!(next.get(job["page"].as_str().unwrap()).0, 200);
    let now = written(&folder, "case.json");
    assert!(now.len() == 3 && cases.iter().all(|case| now.contains(case)), "{cases:?} {now:?}");
    assert_eq!(next.until(waits, |job| job["state"] == "done")["result"]["replicates"], 4);
    // Nothing is left to be said.
    assert_eq!(next.end().0, Some(0));
}

/// Of a run that is being packed there is no scene yet for `voidwalk resume`, and nobody says so.
#[test]
fn a_run_that_was_stopped_while_its_filter_was_packed_continues() {
    let served = serve();
    served.two_sheets();
    let request = json!({ "base": "1", "filter": "2", "density": "dense", "pack": true, "quick": true });
    let (status, said) = served.post("api/judge", request.to_string().as_bytes());
    assert_eq!(status, 200, "{said}");
    let packing = |job: &Value| job["live"]["packing"]["steps"].as_u64() >= Some(1);
    served.until(1, packing);
    let (code, said, at) = served.end();
    assert!(code == Some(3) && !said.contains("voidwalk resume"), "{said}");
    let next = serve_in(at);
    let job = next.job(1);
    assert!(job["can_continue"] == true && !job["message"].as_str().unwrap().contains("resume"), "{job}");
    assert_eq!(next.post("api/continue?id=1", b"").0, 200);
    next.until(1, packing);
}

/// A job that has no room to begin leaves nothing behind; one that ran out of it goes on once there is some, as its
/// message says and as `voidwalk resume` would.
#[test]
fn a_full_disk_ends_no_job_for_good() {
    let at = tempfile::tempdir().unwrap();
    fs::create_dir(at.path().join("served")).unwrap();
    let disk = match Disk::on(&at.path().join("served")) {
        Ok(disk) => disk,
        Err(problem) => return println!("not tested, as no small disk is to be had: {problem}"),
    };
    let served = serve_in(at);
    served.two_sheets();
    disk.leave(0);
    let (status, said) = served.judge(&[]);
    assert_eq!(status, 500, "{said}");
    assert!(!served.root().join("served/run-1").exists(), "{said}");
    disk.free();
    disk.leave(60 << 10);
    let (status, said) = served.judge(&["replicates=4", "base.n_base=2000"]);
    assert_eq!((status, &said["id"]), (200, &json!(1)), "{said}");
    let is_over = |job: &Value| !["waiting", "running"].contains(&job["state"].as_str().unwrap());
    let job = served.until(1, is_over);
    assert_eq!((&job["state"], &job["can_continue"]), (&json!("failed"), &json!(true)), "{job}");
    disk.free();
    assert_eq!(served.post("api/continue?id=1", b"").0, 200);
    let job = served.until(1, is_over);
    assert_eq!((&job["state"], &job["can_continue"]), (&json!("done"), &json!(false)), "{job}");
    let (_, _, at) = served.end();
    drop(disk);
    drop(at);
}
