//! `scripts/checks/trial.py` on a few pairs of soils.

use std::path::Path;
use std::process::Command;

#[test]
fn the_trial_finds_no_green_page_where_a_rule_of_practice_is_not_met() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/checks/trial.py");
    let output = Command::new("python3")
        .arg(script)
        .args(["--small", "--binary", env!("CARGO_BIN_EXE_voidwalk")])
        .output()
        .expect("python3 is there");
    let (text, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{text}{errors}");
    let rows: Vec<&str> =
        text.lines().filter(|line| line.starts_with("| ASTM") || line.starts_with("| gravel")).collect();
    assert_eq!(rows.len(), 4, "{text}");
    // A till on a gravel six times too coarse for it.
    let till = rows.iter().find(|row| row.contains("D15 6.3 mm | till")).unwrap();
    assert!(till.contains("sherard-dunnigan") && !till.contains("green"), "{till}");
}
