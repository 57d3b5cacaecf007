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

/// 29 combinations: of the loose filters, those below D15F/D85B = 5 are six times Dc15 and six times Dc50.
const CROSS: &str = "[[factor]]\nname = \"filter\"\n[factor.levels]\n\
    \"cu1.5-loose\" = { \"filter.curve\" = \"cu1.5-loose\" }\n\
    \"cu1.5-dense\" = { \"filter.curve\" = \"cu1.5-dense\", \"base.dc_curve\" = \"cu1.5-loose\" }\n\
    \"cu3-loose\" = { \"filter.curve\" = \"cu3-loose\" }\n\
    [[factor]]\nname = \"cu_b\"\nsetting = \"base.cu\"\nvalues = [1.5, 3, 4.5]\n\
    [[factor]]\nname = \"d85b\"\n[factor.levels]\n\
    dc0 = { \"base.d15f_over_d85b\" = 6.5 }\ndc5 = { \"base.d85_at_dc\" = 5 }\n\
    dc15 = { \"base.d85_at_dc\" = 15 }\ndc50 = { \"base.d85_at_dc\" = 50 }\n\
    [[leave_out]]\nfilter = \"cu3-loose\"\nd85b = \"dc0\"\n\
    [[leave_out]]\nfilter = \"cu1.5-dense\"\ncu_b = \"4.5\"\n";

/// The finest base erodes whole through either filter; the coarsest is stopped by the wider one.
const KENNEY: &str = "[[factor]]\nname = \"filter\"\nsetting = \"filter.curve\"\n\
    values = [\"cu1.2-dense\", \"cu3-loose\"]\n\
    [[factor]]\nname = \"d50b_over_d0f\"\n[factor.levels]\n\
    \"0.1\" = { \"base.d85_mm\" = 0.113613 }\n\"0.4\" = { \"base.d85_mm\" = 0.454451 }\n\
    [[leave_out]]\nfilter = \"cu1.2-dense\"\nd50b_over_d0f = \"0.4\"\n";

/// Of a packing with 5.5 constrictions a void.
const PACKED: &str = r#"{ "format": "voidwalk-constrictions/1", "voidwalk": "0.1.0", "grains": 8, "voids": 4, "grains_per_void": 2.0, "tetrahedra": 20,
    "constrictions": 11, "void_ratio": 0.6, "cu_csd": 1.5, "d0_mm": 1.0, "dc_mm": {},
    "mean_connectivity": 5.5, "connectivity": [], "merge_overlap": 0.1, "counted_facets": "all",
    "cut_constrictions": 0, "closed_facets": 0, "hidden_grains": [], "duplicate_grains": [] }"#;

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
    walk(at, "kenney", &format!("{KENNEY}[set.base]\ncu = 1.2\n"));
    fs::create_dir(at.join("out/constrictions")).unwrap();
    fs::write(at.join("out/constrictions/constrictions.json"), PACKED).unwrap();
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
    // The network is small, which is a setting, and what was not walked cannot be told.
    assert_eq!(&of("combinations", "paper").unwrap()[9], "29");
    let voids = of("voids", "paper").unwrap();
    assert_eq!((&voids[9], &voids[13]), ("288", "by construction"));
    assert_eq!(&of("kenney-test-cu6-friction0.7", "paper").unwrap()[13], "inconclusive");
    assert!(of("second-blocks", "paper-2.5").is_some() && of("second-blocks", "paper-published").is_none());
    // The void ratio is that of the shipped filter, and the judgement follows from it.
    let e: f64 = of("e-cu1.5-loose", "paper").unwrap()[9].parse().unwrap();
    assert_eq!((e - 0.658).abs() <= 0.02, &of("e-cu1.5-loose", "paper").unwrap()[13] == "agrees");

    // Rows over all cases have Dc15 too.
    assert!(of("loose-below-5", "paper").unwrap()[12].starts_with("of 12"));
    for id in [
        "rising",
        "uniform-rise",
        "wide-6.5",
        "wide-6.5-less",
        "fig13-some",
        "fig13-no",
        "d85-better",
        "fig16-wider",
        "fig16-alike",
        "fig19-6.5-3",
        "fig19-6.5-4.5",
        "reruns-eroded",
        "reruns-largest",
    ] {
        assert!(!of(id, "paper").unwrap()[9].is_empty(), "{id}");
    }
    let value = |id: &str| -> f64 { of(id, "paper").unwrap()[9].parse().unwrap() };
    assert_eq!(value("connections"), 6.0);
    assert_eq!(value("connections-packed"), 5.5);
    assert!(value("per-void-cubic-both") > value("per-void-cubic"));
    a_largest_that_is_the_bases_own_decides_nothing(&rows);
    what_does_not_count_is_left_out_of_the_counts(&page, &rows);
}

/// Rows of Kenney's tests: no base of the first filter is coarser than what gets through, one of the second
/// is.
fn a_largest_that_is_the_bases_own_decides_nothing(rows: &[csv::StringRecord]) {
    let of = |id: &str| rows.iter().find(|row| &row[0] == id).unwrap();
    let own = of("kenney-model-cu1.2-dense");
    assert_eq!(&own[13], "inconclusive");
    assert!(own[12].contains("at least so large"), "{}", &own[12]);
    let filter = of("kenney-model-cu3-loose");
    assert_eq!(&filter[12], "at D50B/D0F 0.4; left out, as they erode their own largest: 1 finer bases");
    let largest: f64 = filter[9].parse().unwrap();
    assert!(0.12 < largest && largest < 0.48, "{largest}");
}

/// The page counts the rows of the first variant that say no more than a judgement.
fn what_does_not_count_is_left_out_of_the_counts(page: &str, rows: &[csv::StringRecord]) {
    let first = || rows.iter().filter(|row| &row[8] == "paper");
    let judged = |word: &str| first().filter(|row| &row[13] == word).count();
    let (agree, differ, open) = (judged("agrees"), judged("differs"), judged("inconclusive"));
    let lead = format!(
        "Of {} statements, <b>{agree} agree</b>, <b>{differ} differ</b>, and <b>{open}</b> inconclusive.",
        agree + differ + open
    );
    assert!(page.contains(&lead), "{lead}");
    let begins = |word: &str| first().filter(|row| row[13].starts_with(word)).count();
    let [set, always, fitted, readings] = ["by construction", "always", "fitted", "reading"].map(begins);
    assert!(set >= 4 && always >= 1 && fitted >= 6 && readings >= 2, "{set} {always} {fitted} {readings}");
    assert_eq!(agree + differ + open + set + always + fitted + readings, first().count());
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
