//! A server in a folder of its own, for tests to ask.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::judge::{BASE, FINE};
use crate::program::voidwalk;
use crate::schemas::keep_to_schema;

/// A server in a folder of its own.
pub struct Served {
    pub child: Child,
    pub port: u16,
    /// `/SECRET/`.
    pub path: String,
    pub at: tempfile::TempDir,
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

pub fn serve_in(at: tempfile::TempDir) -> Served {
    let mut child = voidwalk(at.path(), &["serve", "--out", "served"]).spawn().unwrap();
    let mut text = String::new();
    let out = child.stdout.as_mut().unwrap();
    while !text.ends_with('\n') {
        let mut byte = [0];
        assert_eq!(out.read(&mut byte).unwrap(), 1, "it has ended: {text}");
        text.push(char::from(byte[0]));
    }
    // Written before it says its address.
    let record = at.path().join("served/serve.json");
    keep_to_schema(&fs::read_to_string(&record).unwrap(), "serve.json");
    let address = text.trim().strip_prefix("open http://127.0.0.1:").unwrap();
    let (port, path) = address.split_once('/').unwrap();
    Served { port: port.parse().unwrap(), path: format!("/{path}"), child, at }
}

/// Status, head and body of an answer.
pub type Said = (u16, String, Vec<u8>);

impl Served {
    /// The same folder after a kill.
    pub fn again(mut self) -> Self {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        serve_in(std::mem::replace(&mut self.at, tempfile::tempdir().unwrap()))
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    pub fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// Sends these very bytes.
    pub fn raw(&self, bytes: &[u8]) -> Said {
        let mut stream = self.connect();
        // A refusal may come before all is sent.
        let _ = stream.write_all(bytes);
        answer(&mut stream)
    }

    pub fn ask(&self, method: &str, path: &str, fields: &str, body: &[u8]) -> Said {
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

    pub fn two_sheets(&self) {
        assert_eq!(self.sheet("base.csv", BASE).0, 200);
        assert_eq!(self.sheet("fine.csv", FINE).0, 200);
    }

    pub fn judge(&self, changes: &[&str]) -> (u16, Value) {
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
    pub fn end(mut self) -> (Option<i32>, String, tempfile::TempDir) {
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
    pub fn peak(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        line.trim().trim_end_matches(" kB").parse().unwrap()
    }
}

/// Files of a folder, each with what changes when it is written again.
pub fn written(folder: &Path, name: &str) -> Vec<(PathBuf, u64, i64, i64)> {
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

pub fn answer(stream: &mut TcpStream) -> Said {
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let at = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("an answer");
    let head = String::from_utf8(bytes[..at].to_vec()).unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    (status, head, bytes[at + 4..].to_vec())
}
