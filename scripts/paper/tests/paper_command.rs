//! `voidwalk-paper` on the folder of a reproduction: a small one gives the whole page, what is missing is
//! said, and what is no reproduction is refused.
//!
//! This program has a `main` of its own because it starts itself again: with the variable [`AS_VOIDWALK`] it
//! is voidwalk, which walks what the page is about.

use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode, Output};

/// Set where this program is to be voidwalk.
const AS_VOIDWALK: &str = "VOIDWALK_PAPER_TEST_AS_VOIDWALK";

fn main() -> ExitCode {
    if std::env::var_os(AS_VOIDWALK).is_some() {
        return voidwalk::cli::main();
    }
    let tests: [(&str, fn()); 3] = [
        ("a_small_reproduction_gives_the_whole_page", a_small_reproduction_gives_the_whole_page),
        ("a_ledger_that_is_not_of_its_cases_is_refused", a_ledger_that_is_not_of_its_cases_is_refused),
        ("a_folder_without_the_campaign_is_refused", a_folder_without_the_campaign_is_refused),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    for (name, test) in tests {
        if wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str())) {
            println!("test {name} ...");
            test();
            println!("test {name} ... ok");
        }
    }
    ExitCode::SUCCESS
}

const SMALL: &str = "[set]\nreplicates = 2\nnetwork = { nx = 6, ny = 6, nz = 8 }\n\
    record = { sensitivity = [], series_every = 1, size_curves = [1, 10] }\n";

const CROSS: &str = "[[factor]]\nname = \"filter\"\n[factor.levels]\n\
    \"cu1.5-loose\" = { \"filter.curve\" = \"cu1.5-loose\" }\n\
    \"cu1.5-dense\" = { \"filter.curve\" = \"cu1.5-dense\", \"base.dc_curve\" = \"cu1.5-loose\" }\n\
    [[factor]]\nname = \"cu_b\"\nsetting = \"base.cu\"\nvalues = [1.5, 4.5]\n\
    [[factor]]\nname = \"d85b\"\n[factor.levels]\n\
    dc5 = { \"base.d85_at_dc\" = 5 }\ndc15 = { \"base.d85_at_dc\" = 15 }\n\
    dc50 = { \"base.d85_at_dc\" = 50 }\n";

fn page(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk-paper")).current_dir(folder).args(args).output().unwrap()
}

fn walk(folder: &Path, name: &str, cases: &str) {
    fs::write(folder.join(format!("{name}.toml")), format!("{SMALL}{cases}")).unwrap();
    let output = Command::new(std::env::current_exe().unwrap())
        .env(AS_VOIDWALK, "")
        .current_dir(folder)
        .args(["campaign", &format!("{name}.toml"), "--out", &format!("out/{name}"), "--quiet"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Rows of statements.csv by column name.
fn statements(folder: &Path) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(folder.join("out/statements.csv")).unwrap();
    reader.records().map(Result::unwrap).collect()
}

fn a_small_reproduction_gives_the_whole_page() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::create_dir(at.join("out")).unwrap();
    walk(at, "paper", CROSS);
    walk(at, "paper-2.5", &format!("{CROSS}[[leave_out]]\nfilter = \"cu1.5-dense\"\n"));
    walk(
        at,
        "progress",
        "[[case]]\nname = \"fig18\"\n[[case]]\nname = \"fig13-some\"\nset = { \"base.cu\" = 3 }\n",
    );
    let output = page(at, &["out"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "out/report.html\n");
    let page = fs::read_to_string(at.join("out/report.html")).unwrap();
    for heading in ["Fig. 6", "Table 2", "Fig. 10", "Fig. 14", "Table 3", "Fig. 20", "Every combination"] {
        assert!(page.contains(heading), "{heading}");
    }
    assert!(page.contains("inconclusive: not walked") && page.contains("Foster and Fell"));
    for figure in ["fig7b", "fig13", "fig14a", "fig14b", "fig17b", "fig18", "fig19b"] {
        assert!(at.join(format!("out/figures/{figure}.svg")).is_file(), "{figure}");
    }
    let rows = statements(at);
    let of = |id: &str, variant: &str| rows.iter().find(|row| &row[0] == id && &row[8] == variant);
    // 8 of the 12 combinations are marked; the network is small, and what was not walked cannot be told.
    assert_eq!(&of("combinations", "paper").unwrap()[9], "8");
    assert_eq!((&of("voids", "paper").unwrap()[9], &of("voids", "paper").unwrap()[13]), ("288", "differs"));
    assert_eq!(&of("kenney-test-cu3-loose", "paper").unwrap()[13], "inconclusive");
    assert!(of("second-blocks", "paper-2.5").is_some() && of("second-blocks", "paper-published").is_none());
    // The void ratio is that of the shipped filter, and the judgement follows from it.
    let e: f64 = of("e-cu1.5-loose", "paper").unwrap()[9].parse().unwrap();
    assert_eq!((e - 0.658).abs() <= 0.02, &of("e-cu1.5-loose", "paper").unwrap()[13] == "agrees");
}

fn a_ledger_that_is_not_of_its_cases_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::create_dir(at.join("out")).unwrap();
    walk(at, "paper", "[[case]]\nname = \"one\"\nset = { seed = 1 }\n");
    let path = at.join("out/paper/cases/one/outcome.json");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replacen("\"seed\": 1,", "\"seed\": 2,", 1)).unwrap();
    let output = page(at, &["out"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("not what ledger.jsonl says"), "{error}");
    assert!(!at.join("out/report.html").exists());
}

fn a_folder_without_the_campaign_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::create_dir(at.join("empty")).unwrap();
    for (args, told) in
        [(["empty"].as_slice(), "holds no paper/ledger.jsonl"), (&["a", "b"], "Usage"), (&[], "Usage")]
    {
        let output = page(at, args);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
        assert!(error.contains(told), "{args:?}: {error}");
    }
    assert_eq!(fs::read_dir(at.join("empty")).unwrap().count(), 0);
}
