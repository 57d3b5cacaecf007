//! `serve`: who may ask, what is too large, and that jobs outlive their server.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::unix::fs::{MetadataExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::full_disk::Disk;
use crate::judge::{BASE, COARSE, FINE};
use crate::program::{call, done, refused, voidwalk};

/// A server in a folder of its own.
pub struct Served {
    child: Child,
    port: u16,
    /// `/SECRET/`.
    path: String,
    at: tempfile::TempDir,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub fn serve() -> Served {
    serve_in(tempfile::tempdir().unwrap())
}

fn serve_in(at: tempfile::TempDir) -> Served {
    let mut child = voidwalk(at.path(), &["serve", "--out", "served"]).spawn().unwrap();
    let mut text = String::new();
    let out = child.stdout.as_mut().unwrap();
    while !text.ends_with('\n') {
        let mut byte = [0];
        assert_eq!(out.read(&mut byte).unwrap(), 1, "it has ended: {text}");
        text.push(char::from(byte[0]));
    }
    let address = text.trim().strip_prefix("open http://127.0.0.1:").unwrap();
    let (port, path) = address.split_once('/').unwrap();
    Served { port: port.parse().unwrap(), path: format!("/{path}"), child, at }
}

/// Status, head and body of an answer.
pub type Said = (u16, String, Vec<u8>);

impl Served {
    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// Sends these very bytes.
    fn raw(&self, bytes: &[u8]) -> Said {
        let mut stream = self.connect();
        // A refusal may come before all is sent.
        let _ = stream.write_all(bytes);
        answer(&mut stream)
    }

    fn ask(&self, method: &str, path: &str, fields: &str, body: &[u8]) -> Said {
        let length =
            if method == "POST" { format!("Content-Length: {}\r\n", body.len()) } else { String::new() };
        let head = format!("{method} {path} HTTP/1.1\r\nHost: {}\r\n{fields}{length}\r\n", self.host());
        self.raw(&[head.as_bytes(), body].concat())
    }

    pub fn get(&self, path: &str) -> Said {
        self.ask("GET", &format!("{}{path}", self.path), "", b"")
    }

    pub fn post(&self, path: &str, body: &[u8]) -> (u16, Value) {
        let (status, _, body) = self.ask("POST", &format!("{}{path}", self.path), "", body);
        (status, serde_json::from_slice(&body).unwrap())
    }

    pub fn json(&self, path: &str) -> Value {
        serde_json::from_slice(&self.get(path).2).unwrap()
    }

    pub fn sheet(&self, name: &str, text: &str) -> (u16, Value) {
        self.post(&format!("api/sheet?name={name}"), text.as_bytes())
    }

    fn two_sheets(&self) {
        assert_eq!(self.sheet("base.csv", BASE).0, 200);
        assert_eq!(self.sheet("fine.csv", FINE).0, 200);
    }

    fn judge(&self, changes: &[&str]) -> (u16, Value) {
        let small = ["network.nx=6", "network.ny=6", "network.nz=8", "record.sensitivity=[]"];
        let changes = [&small[..], changes].concat();
        self.post(
            "api/judge",
            json!({ "base": "1", "filter": "2", "changes": changes }).to_string().as_bytes(),
        )
    }

    pub fn job(&self, id: u64) -> Value {
        let state = self.json("api/state");
        state["jobs"].as_array().unwrap().iter().find(|job| job["id"] == id).unwrap().clone()
    }

    pub fn until(&self, id: u64, what: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            let job = self.job(id);
            if what(&job) {
                return job;
            }
            assert!(begun.elapsed() < Duration::from_secs(120), "{job}");
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Ends it as Ctrl-C does; its exit code, what it said, and the folder that it was in.
    fn end(mut self) -> (Option<i32>, String, tempfile::TempDir) {
        let signal = Command::new("kill").args(["-TERM", &self.child.id().to_string()]).status().unwrap();
        assert!(signal.success());
        let mut said = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        let code = self.child.wait().unwrap().code();
        (code, said, std::mem::replace(&mut self.at, tempfile::tempdir().unwrap()))
    }

    pub fn root(&self) -> &Path {
        self.at.path()
    }

    /// Largest memory that it has had (kB).
    fn peak(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        line.trim().trim_end_matches(" kB").parse().unwrap()
    }
}

/// Files of a folder, each with what changes when it is written again.
fn written(folder: &Path, name: &str) -> Vec<(PathBuf, u64, i64, i64)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, meta) = (entry.path(), entry.metadata().unwrap());
        match meta.is_dir() {
            true => all.extend(written(&path, name)),
            false if path.ends_with(name) || name.is_empty() => {
                all.push((path, meta.ino(), meta.mtime(), meta.mtime_nsec()));
            }
            false => {}
        }
    }
    all
}

fn answer(stream: &mut TcpStream) -> Said {
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let at = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("an answer");
    let head = String::from_utf8(bytes[..at].to_vec()).unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    (status, head, bytes[at + 4..].to_vec())
}

#[test]
fn only_the_browser_of_whoever_has_the_address_is_answered() {
    let served = serve();
    let (status, head, page) = served.get("");
    assert_eq!(status, 200);
    assert!(head.contains("script-src 'self'") && !head.contains("unsafe"), "{head}");
    let page = String::from_utf8(page).unwrap();
    assert!(
        !page.contains("http:") && !page.contains("https:") && !page.contains("style="),
        "nothing from outside"
    );
    let (host, path) = (served.host(), served.path.clone());
    let same_length = format!("/{}/", "0".repeat(path.len() - 2));
    let port = served.port;
    let with = |path: &str, host: &str, more: &str| {
        served.raw(format!("GET {path} HTTP/1.1\r\n{host}{more}\r\n").as_bytes()).0
    };
    let own = format!("Host: {host}\r\n");
    assert_eq!(with(&path, &own, ""), 200);
    assert_eq!(
        with(&path, &format!("Host: localhost:{port}\r\n"), &format!("Origin: http://{host}\r\n")),
        200
    );
    for (path, host, more) in [
        // No secret, or a wrong one.
        ("/", own.clone(), ""),
        ("/page.js", own.clone(), ""),
        ("/api/state", own.clone(), ""),
        (same_length.as_str(), own.clone(), ""),
        (&path[..path.len() - 1], own.clone(), ""),
        // Another name for this machine, as of DNS rebinding; none; two.
        (path.as_str(), format!("Host: evil.example:{port}\r\n"), ""),
        (&path, "Host: 127.0.0.1\r\n".into(), ""),
        (&path, String::new(), ""),
        (&path, format!("{own}Host: evil.example\r\n"), ""),
        // A page of another origin.
        (&path, own.clone(), "Origin: https://evil.example\r\n"),
        (&path, own.clone(), "Origin: null\r\n"),
        (&path, own.clone(), "Origin: http://127.0.0.1:1\r\n"),
        (&path, own.clone(), "Sec-Fetch-Site: cross-site\r\n"),
    ] {
        assert_eq!(with(path, &host, more), 403, "{path} {host} {more}");
    }
    let (status, _, body) = served.ask("POST", "/api/judge", "", b"{}");
    assert_eq!((status, String::from_utf8(body).unwrap().contains("not allowed")), (403, true));
    assert_eq!(served.ask("PUT", &path, "", b"").0, 405);
}

#[test]
fn what_is_too_large_or_no_request_costs_no_memory() {
    let served = serve();
    let before = served.peak();
    let head = |length: &str| {
        let (path, host) = (&served.path, served.host());
        format!("POST {path}api/sheet?name=a.csv HTTP/1.1\r\nHost: {host}\r\n{length}\r\n")
    };
    // A gigabyte is said, and as much of it sent as is taken.
    let mut stream = served.connect();
    stream.write_all(head("Content-Length: 1073741824\r\n").as_bytes()).unwrap();
    let piece = vec![b'1'; 1 << 20];
    let sent = (0..1024).take_while(|_| stream.write_all(&piece).is_ok()).count();
    assert!(sent < 1024, "the connection ends before a gigabyte is through");
    let (status, _, body) = served.raw(head("Content-Length: 1073741824\r\n").as_bytes());
    assert_eq!(status, 413);
    assert!(String::from_utf8(body).unwrap().contains("at most 32 MB"));
    // What is larger than any soil and not too large is what the reader of soils says.
    let large = "1".repeat(20 << 20);
    let (status, said) = served.sheet("large.csv", &large);
    assert_eq!(status, 422, "{said}");
    assert_eq!(served.raw(head("Transfer-Encoding: chunked\r\n").as_bytes()).0, 411);
    assert_eq!(served.raw(head("").as_bytes()).0, 411);
    assert_eq!(served.raw(head("Content-Length: -1\r\n").as_bytes()).0, 400);
    assert_eq!(served.raw(head("Content-Length: 1\r\nContent-Length: 2\r\n").as_bytes()).0, 400);
    let endless = format!("GET /{} HTTP/1.1\r\n", "a".repeat(1 << 20));
    assert_eq!(served.raw(endless.as_bytes()).0, 431);
    assert_eq!(served.raw(b"\x16\x03\x01\x02\x00\x01\x00 no http at all\r\n\r\n").0, 400);
    let grown = served.peak().saturating_sub(before);
    assert!(grown < 120_000, "{grown} kB more");
    assert_eq!(served.get("").0, 200);
}

/// The library knows them in milliseconds, before anything is walked.
#[test]
fn a_filters_constrictions_are_drawn_as_soon_as_its_sheet_is_there() {
    let served = serve();
    assert_eq!(served.sheet("fine.csv", FINE).0, 200);
    let drawn = |path: &str| String::from_utf8(served.get(path).2).unwrap();
    let of_filter = drawn("api/curves.svg?filter=1");
    for density in ["loose", "dense"] {
        assert!(of_filter.contains(&format!(">constrictions, {density}, by number<")), "{density}");
    }
    assert!(!drawn("api/curves.svg?base=1").contains("constrictions"));
}

/// What is there to try the page with is what `voidwalk examples` and `voidwalk soil --template` write.
#[test]
fn examples_and_the_template_are_those_of_the_command_line() {
    let served = serve();
    done(&call(served.root(), &["examples", "try"]));
    for name in ["base.csv", "filter.csv", "filter-fine.csv", "borrow-area.ags"] {
        let (status, _, text) = served.get(&format!("examples/{name}"));
        assert_eq!((status, text), (200, fs::read(served.root().join("try").join(name)).unwrap()), "{name}");
    }
    for name in ["none.csv", "../try/base.csv", "", "%2e%2e/base.csv"] {
        assert_eq!(served.get(&format!("examples/{name}")).0, 404, "{name}");
    }
    assert_eq!(served.json("api/state")["has_template"], cfg!(feature = "xlsx"));
    #[cfg(feature = "xlsx")]
    {
        done(&call(served.root(), &["soil", "--template", "t.xlsx"]));
        let (status, head, template) = served.get("voidwalk-soils.xlsx");
        assert!(status == 200 && head.contains("filename=\"voidwalk-soils.xlsx\""), "{head}");
        assert!(template == fs::read(served.root().join("t.xlsx")).unwrap());
        let (status, sheet) = served.post("api/sheet?name=t.xlsx", &template);
        assert!(status == 200 && sheet["soils"].as_array().unwrap().len() == 2, "{sheet}");
    }
}

/// The table of the page and its file are those of `voidwalk rules --each`, and name no folder.
#[test]
fn every_sample_of_a_sheet_has_its_rules() {
    let served = serve();
    done(&call(served.root(), &["examples", "try"]));
    let text = |name: &str| fs::read_to_string(served.root().join("try").join(name)).unwrap();
    for name in ["borrow-area.ags", "filter.csv", "filter-fine.csv"] {
        assert_eq!(served.sheet(name, &text(name)).0, 200);
    }
    // Of whichever soil is taken, its whole sheet counts; further filters are behind a line's end.
    let query = "base=1%23BH1&filter=2%0A3";
    let words = ["rules", "borrow-area.ags", "filter.csv", "filter-fine.csv", "--each", "--csv", "../t.csv"];
    let told = call(&served.root().join("try"), &words);
    done(&told);
    let (status, head, csv) = served.get(&format!("samples.csv?{query}"));
    assert!(status == 200 && head.contains("voidwalk-samples.csv"), "{head}");
    assert_eq!(String::from_utf8(csv).unwrap(), fs::read_to_string(served.root().join("t.csv")).unwrap());
    let table = served.json(&format!("api/samples?{query}"));
    let rows = table["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &table["headings"][0]), (12, &Value::from("Sample")));
    let told = String::from_utf8(told.stdout).unwrap();
    for (at, sentences) in table["filters"].as_array().unwrap().iter().enumerate() {
        let first = sentences[0].as_str().unwrap();
        assert!(
            told.contains(&format!("{first}\n")) && first.starts_with(["filter.csv", "filter-fine.csv"][at])
        );
        assert!(told.contains(sentences[1].as_str().unwrap()), "{sentences}");
    }
    assert!(!table.to_string().contains("sheets"), "{table}");
    for wrong in ["base=1", "base=9&filter=2", "base=1&filter=9", "base=1&filter=2&joint_mm=wide"] {
        let (status, _, said) = served.get(&format!("api/samples?{wrong}"));
        assert_eq!(status, 422, "{wrong}: {}", String::from_utf8_lossy(&said));
    }
    let (status, _, said) = served.get("api/samples?base=1&filter=2%0A2");
    assert!(status == 422 && String::from_utf8_lossy(&said).contains("is named twice"));
    // Two sheets of one name are two filters.
    assert_eq!(served.sheet("filter.csv", &text("filter-fine.csv")).0, 200);
    let both = served.json("api/samples?base=1&filter=2%0A4");
    for (at, name) in ["1 filter.csv: of 6 samples", "2 filter.csv: of 6 samples"].iter().enumerate() {
        assert!(both["filters"][at][0].as_str().unwrap().starts_with(name), "{both}");
    }
    assert_eq!(both["unstable"].as_array().unwrap().len(), 12);
    let seven = ["2"; 7].join("%0A");
    assert_eq!(served.get(&format!("api/samples?base=1&filter={seven}")).0, 422);
    // Stricter where the soils are dispersive.
    assert_eq!(served.get(&format!("api/samples?{query}&dispersive=1&joint_mm=2")).0, 200);
}

#[test]
fn a_hundred_at_once_are_answered() {
    let served = serve();
    served.two_sheets();
    let paths = ["", "page.js", "api/state", "api/rules?base=1&filter=2", "api/curves.svg?base=1&filter=2"];
    // More than are answered at a time, of somebody who has no secret to show.
    let silent: Vec<TcpStream> = (0..100).map(|_| served.connect()).collect();
    let begun = Instant::now();
    let statuses: Vec<u16> = std::thread::scope(|scope| {
        let (served, paths) = (&served, &paths);
        let ask = |n: usize| scope.spawn(move || served.get(paths[n % paths.len()]).0);
        let asking: Vec<_> = (0..100).map(ask).collect();
        asking.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert_eq!(statuses, vec![200; 100]);
    assert!(begun.elapsed() < Duration::from_secs(9), "a silent connection has 10 s: {:?}", begun.elapsed());
    drop(silent);
}

#[test]
fn names_do_no_harm_and_mistakes_have_the_words_of_the_command_line() {
    let served = serve();
    for (name, harmless) in [
        ("..%2F..%2Fx", "x.csv"),
        ("%3Cscript%3Ealert(1)%3C%2Fscript%3E", "script.csv"),
        ("a%E2%80%AEvsc.csv", "avsc.csv"),
        ("%00", "sheet.csv"),
        ("", "sheet.csv"),
    ] {
        let (status, sheet) = served.sheet(name, BASE);
        assert_eq!((status, &sheet["name"]), (200, &harmless.into()), "{name}");
    }
    let outside: Vec<_> =
        fs::read_dir(served.root()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(outside, ["served"]);
    for (name, text) in [
        ("bad.csv", "size_mm,percent\n0.1,10\n0.2,x\n"),
        ("empty.csv", ""),
        ("falls.csv", "size_mm,percent\n0.1,50\n0.2,20\n0.3,100\n"),
        ("noise.csv", "PK\u{3}\u{4}\u{202e}"),
    ] {
        fs::write(served.root().join(name), text).unwrap();
        let told: Output = call(served.root(), &["soil", name]);
        let told = String::from_utf8(told.stderr).unwrap();
        let (status, said) = served.sheet(name, text);
        assert_eq!(status, 422);
        assert_eq!(told.trim_end(), format!("refused: {}", said["problem"].as_str().unwrap()));
    }
    let (status, said) = served.judge(&["base.uc=3"]);
    assert_eq!(status, 422);
    assert_eq!(said["problem"], "--set: there is no setting `base.uc`; did you mean `base.cu`?");
    for path in [
        "files/run-1/../../x",
        "files/run-1/..%2F..%2Fx",
        "files//etc/passwd",
        "files/sheets/1/x.csv",
        "zip/..",
        "x",
    ] {
        assert_eq!(served.get(path).0, 404, "{path}");
    }
    for sheet in ["99", "1#..%2Fx", "../1", ""] {
        assert_eq!(served.get(&format!("api/rules?base={sheet}&filter=1")).0, 422, "{sheet}");
    }
    for (joint, status) in [("2.5", 200), ("0", 422), ("nan", 422), ("x", 422)] {
        assert_eq!(
            served.get(&format!("api/rules?base=1&filter=1&dispersive=1&joint_mm={joint}")).0,
            status,
            "{joint}"
        );
    }
    assert_eq!(served.post("api/judge", b"{\"base\":1}").0, 400);
    let (status, said) = served.post("api/judge", br#"{"base":"1","filter":"1","density":"tight"}"#);
    assert_eq!((status, &said["problem"]), (422, &json!("density: dense, medium (or intermediate), loose")));
    assert_eq!(served.post("api/stop?id=7", b"").0, 409);
}

#[test]
fn jobs_are_walked_one_at_a_time_and_both_tabs_see_them() {
    let served = serve();
    served.two_sheets();
    assert_eq!(served.sheet("coarse.csv", COARSE).0, 200);
    let long = served.judge(&["replicates=5000"]).1["id"].as_u64().unwrap();
    let quick = json!({ "base": "1", "filter": "2", "filters": ["3"], "quick": true,
        "changes": ["network.nx=6", "network.ny=6", "network.nz=8"] });
    let (status, said) = served.post("api/compare", quick.to_string().as_bytes());
    let compared = said["id"].as_u64().unwrap();
    assert_eq!(status, 200);
    let walking = served.until(long, |job| job["live"]["so_far"]["replicates"].as_u64() >= Some(5));
    assert_eq!(walking["state"], "running");
    let so_far = &walking["live"]["so_far"];
    assert!(so_far["class"].is_string() && so_far["runs"][0]["low"].is_number(), "{so_far}");
    assert!(walking["page"].is_null() && walking["result"].is_null(), "no verdict before the end");
    assert_eq!(served.job(compared)["state"], "waiting");
    assert_eq!(served.post(&format!("api/stop?id={long}"), b"").0, 200);
    let stopped = served.until(long, |job| job["state"] == "stopped");
    assert!(stopped["message"].as_str().unwrap().contains("voidwalk resume"), "{stopped}");
    let done = served.until(compared, |job| job["state"] == "done");
    assert_eq!(done["result"]["cases"].as_array().unwrap().len(), 2);
    let page = done["page"].as_str().unwrap();
    let (status, head, body) = served.get(page);
    assert!(status == 200 && head.contains("sha256-") && !head.contains("unsafe"), "{head}");
    assert!(String::from_utf8(body).unwrap().contains("Which of these filters hold this base?"));
    let (status, head, zip) = served.get(&format!("zip/compare-{compared}.zip"));
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

    /// The same folder after a kill.
    pub fn again(mut self) -> Self {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        serve_in(std::mem::replace(&mut self.at, tempfile::tempdir().unwrap()))
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
    for name in ["density", "thickness", "layers", "no_erosion", "continuing", "no_erosion_note", "band"] {
        assert_eq!(rows[0][name], expected[0][name], "{name}");
    }
    assert!(rows[0]["no_erosion"]["d15f_mm"]["median"].as_f64().unwrap() > 0.1, "{rows}");
    assert_eq!(job["result"]["confidence"], told["confidence"]);
    assert_eq!(job["result"]["reasons"], told["reasons"]);
    assert_eq!(job["result"]["base"], "narrow.csv", "no folder");
    let (status, head, zip) = served.get(&format!("zip/design-{id}.zip"));
    assert!(status == 200 && head.contains("attachment") && zip.starts_with(b"PK"), "{head}");
    // The next server on this folder shows the same.
    let next = served.again();
    let same = next.job(id);
    assert_eq!((&same["kind"], &same["state"]), (&"design".into(), &"done".into()));
    assert_eq!((&same["result"], &same["page"]), (&job["result"], &job["page"]));
    let (status, _, page) = next.get(same["page"].as_str().unwrap());
    assert!(status == 200 && String::from_utf8(page).unwrap().contains("The band"));
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
    let number =
        |text: &Value| -> f64 { text.as_str().unwrap().split('\u{202f}').next().unwrap().parse().unwrap() };
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
    assert_eq!((&job["state"], &job["result"]["verdict"]), (&"done".into(), &outcome["verdict"]));
    assert!(job["result"]["findings"].to_string().contains("The modelled filter is "), "{job}");
    let (page, zip) = (job["page"].as_str().unwrap(), format!("zip/run-{id}.zip"));
    assert_eq!((next.get(page).0, next.get(&zip).0), (200, 200));
    // In place of its folder a link to another is not followed.
    let (run, elsewhere) = (next.root().join(&run), next.root().join("elsewhere"));
    fs::rename(&run, &elsewhere).unwrap();
    symlink(&elsewhere, &run).unwrap();
    assert_eq!((next.get(page).0, next.get(&zip).0), (404, 404));
}

/// A comparison that was stopped with its server, and one that waited, are done by the next.
#[test]
fn what_waited_or_was_compared_when_the_server_ended_is_done_by_the_next() {
    let served = serve();
    served.two_sheets();
    for name in ["a.csv", "b.csv"] {
        assert_eq!(served.sheet(name, COARSE).0, 200);
    }
    let request = json!({ "base": "1", "filter": "2", "filters": ["3", "4"], "quick": true,
        "changes": ["network.nx=10", "network.ny=10", "network.nz=20", "replicates=40"] });
    let (_, said) = served.post("api/compare", request.to_string().as_bytes());
    let compared = said["id"].as_u64().unwrap();
    let waits = served.judge(&["replicates=4"]).1["id"].as_u64().unwrap();
    served.until(compared, |job| job["live"]["cases_done"].as_u64() >= Some(1));
    let title = served.job(compared)["title"].clone();
    let (code, said, at) = served.end();
    assert_eq!(code, Some(3), "{said}");
    for words in [&format!("compare-{compared}"), &format!("run-{waits}"), "voidwalk serve --out served"] {
        assert!(said.contains(words), "{said}");
    }
    let next = serve_in(at);
    let state = next.json("api/state");
    let names: Vec<&Value> = state["sheets"].as_array().unwrap().iter().map(|sheet| &sheet["name"]).collect();
    assert_eq!(names, ["base.csv", "fine.csv", "a.csv", "b.csv"]);
    let job = next.job(compared);
    assert_eq!((&job["state"], &job["can_continue"]), (&"stopped".into(), &true.into()), "{job}");
    assert_eq!((&job["title"], &job["asked"]["base"]), (&title, &"1".into()));
    assert_eq!(next.job(waits)["can_continue"], true);
    let folder = next.root().join(format!("served/compare-{compared}"));
    let cases = written(&folder, "case.json");
    assert!(!cases.is_empty() && cases.len() < 3, "{cases:?}");
    for id in [compared, waits] {
        assert_eq!(next.post(&format!("api/continue?id={id}"), b"").0, 200);
    }
    let job = next.until(compared, |job| job["state"] == "done");
    assert_eq!(job["result"]["cases"].as_array().unwrap().len(), 3);
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

#[test]
fn a_foreign_folder_and_a_port_that_is_taken_are_refused() {
    let served = serve();
    fs::create_dir(served.root().join("mine")).unwrap();
    fs::write(served.root().join("mine/thesis.txt"), "mine").unwrap();
    refused(&call(served.root(), &["serve", "--out", "mine"]), "was not made by voidwalk");
    fs::create_dir(served.root().join("run")).unwrap();
    for (name, text) in [(".voidwalk.lock", ""), ("scene.toml", ""), ("outcome.json", "{}")] {
        fs::write(served.root().join("run").join(name), text).unwrap();
    }
    refused(&call(served.root(), &["serve", "--out", "run"]), "holds a run; name another folder");
    let port = served.port.to_string();
    refused(&call(served.root(), &["serve", "--out", "other", "--port", &port]), "name another by --port");
    assert!(!served.root().join("other").exists());
    fs::write(served.root().join("base.csv"), BASE).unwrap();
    fs::write(served.root().join("fine.csv"), FINE).unwrap();
    let (code, said, at) = served.end();
    assert_eq!(code, Some(0), "{said}");
    for args in [&["judge", "base.csv", "fine.csv"][..], &["percolation", "--sizes", "4"]] {
        let out = call(at.path(), &[args, &["--out", "served"]].concat());
        refused(&out, "served: holds a page's sheets and jobs; name another folder");
    }
    refused(&call(at.path(), &["report", "served"]), "name the folder of a finished run");
    assert_eq!(fs::read_dir(at.path().join("served")).unwrap().count(), 2);
}

/// A pipe with nobody at its other end would hold the connection for ever.
#[test]
fn a_pipe_in_a_folder_is_no_file() {
    let served = serve();
    served.two_sheets();
    let (status, asked) = served.judge(&["base.n_base=100", "replicates=1"]);
    assert_eq!(status, 200, "{asked}");
    let done = served.until(1, |job| job["state"] == "done");
    assert_eq!(done["folder"], "run-1");
    let pipe = served.root().join("served/run-1/pipe.txt");
    assert!(Command::new("mkfifo").arg(pipe).status().unwrap().success());
    assert_eq!(served.get("files/run-1/pipe.txt").0, 404);
    assert_eq!(served.get("files/run-1/outcome.json").0, 200);
    assert_eq!(served.get("zip/run-1.zip").0, 200);
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
