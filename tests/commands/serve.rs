//! `serve`: who may ask, what is too large, and what a sheet tells at once.

use std::fs;
use std::io::Write;
use std::net::TcpStream;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::judge::{BASE, FINE};
use crate::program::{call, done, refused};
use crate::served::serve;

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
        let on_terminal = |at: usize| sentences[at].as_str().unwrap().replace('\u{202f}', " ");
        let first = on_terminal(0);
        assert!(
            told.contains(&format!("{first}\n")) && first.starts_with(["filter.csv", "filter-fine.csv"][at])
        );
        assert!(told.contains(&on_terminal(1)), "{sentences}");
    }
    assert!(!table.to_string().contains("sheets"), "{table}");
    for wrong in
        ["base=1", "base=9&filter=2", "base=1&filter=9", "base=1&filter=2&changes=filter.joint_mm=wide"]
    {
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
    assert_eq!(both["classes"].as_array().unwrap().len(), 12);
    let seven = ["2"; 7].join("%0A");
    assert_eq!(served.get(&format!("api/samples?base=1&filter={seven}")).0, 422);
    // Stricter where the soils are dispersive.
    assert_eq!(
        served.get(&format!("api/samples?{query}&changes=base.dispersive=true%0Afilter.joint_mm=2")).0,
        200
    );
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
    assert_eq!(said["problem"], "there is no setting `base.uc`; did you mean `base.cu`?");
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
            served.get(&format!("api/rules?base=1&filter=1&changes=filter.joint_mm={joint}")).0,
            status,
            "{joint}"
        );
    }
    assert_eq!(served.post("api/judge", b"{\"base\":1}").0, 400);
    for request in
        [&br#"{"base":"1","filter":"1","walks":"look"}"#[..], br#"{"base":"1","filter":"1","tight":true}"#]
    {
        assert_eq!(served.post("api/judge", request).0, 400, "{request:?}");
    }
    let (status, said) = served.post("api/judge", br#"{"base":"1","filter":"1","density":"tight"}"#);
    assert_eq!((status, &said["problem"]), (422, &json!("density: dense, medium (or intermediate), loose")));
    assert_eq!(served.post("api/stop?id=7", b"").0, 409);
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
