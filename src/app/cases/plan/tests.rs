use super::*;

fn plan(text: &str) -> Result<CasePlan, SceneError> {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("plan.toml");
    std::fs::write(&path, text).unwrap();
    CasePlan::read(&path)
}

const TWO_BY_TWO: &str = "[[factor]]\nname = \"cu_b\"\nsetting = \"base.cu\"\nvalues = [1.5, 3]\n\
    [[factor]]\nname = \"filter\"\n[factor.levels]\n\
    a = { \"filter.curve\" = \"shire2016-cu1.5-loose\" }\n\
    b = { filter = { curve = \"shire2016-cu1.5-dense\" } }\n";

#[test]
fn factors_are_crossed_with_the_last_running_fastest() {
    let plan = plan(TWO_BY_TWO).unwrap();
    let names: Vec<&str> = plan.cases.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["cu_b=1.5,filter=a", "cu_b=1.5,filter=b", "cu_b=3,filter=a", "cu_b=3,filter=b"]);
    let seeds: std::collections::BTreeSet<u64> = plan.cases.iter().map(|c| c.scene.walk.seed).collect();
    assert_eq!(seeds.len(), 4);
}

/// Checks the printed plan, and the plan with every key that is commented out.
#[test]
fn the_plan_to_start_from_is_one_and_names_every_key() {
    let text = CasePlan::INIT_TEXT;
    assert_eq!(plan(text).unwrap().cases.len(), 4);
    let uncommented = |line: &str| match line.strip_prefix("# ") {
        Some(rest) if rest.starts_with("[[") || rest.contains(" = ") && !rest.starts_with("scene") => {
            rest.to_owned()
        }
        _ => line.to_owned(),
    };
    let whole: Vec<String> = text.lines().map(uncommented).collect();
    let whole = plan(&whole.join("\n")).unwrap();
    // Without the combination that is left out, and with the case outside the cross.
    assert_eq!((whole.cases.len(), whole.cases[3].name.as_str()), (4, "wide base"));
    assert!(whole.cases.iter().all(|case| case.scene.walk.seed == 1), "common seeds");
    let known = plan("no = 1").unwrap_err().to_string();
    for key in ["title", "seed", "seeds", "scene", "set", "factor", "leave_out", "case"] {
        let is_there = [format!("{key} = "), format!("[{key}]")].iter().any(|form| text.contains(form));
        assert!(is_there && known.contains(key), "{key}: {known}");
    }
}

#[test]
fn a_level_may_be_a_length_with_its_unit() {
    let factor = "[[factor]]\nname = \"thickness\"\nsetting = \"network.thickness_mm\"\n";
    let plan = plan(&format!("{factor}values = [\"2ft\", \"0.5m\", 500]\n")).unwrap();
    let names: Vec<&str> = plan.cases.iter().map(|case| case.name.as_str()).collect();
    assert_eq!(names, ["thickness=2ft", "thickness=0.5m", "thickness=500"]);
    let mm = plan.cases.iter().map(|case| case.scene.network.thickness_mm);
    assert_eq!(mm.collect::<Vec<_>>(), [Some(609.6), Some(500.0), Some(500.0)]);
}

#[test]
fn a_range_is_even_and_has_both_ends() {
    let levels = |range: &str| {
        let text = format!("[[factor]]\nname = \"cu\"\nsetting = \"base.cu\"\nrange = {range}\n");
        plan(&text).map(|plan| plan.cases.into_iter().map(|case| case.name).collect::<Vec<_>>())
    };
    let names = levels("{ from = 2.1, to = 3, count = 4 }").unwrap();
    assert_eq!(names, ["cu=2.1", "cu=2.4", "cu=2.7", "cu=3"]);
    assert_eq!(levels("{ from = 6, to = 2, count = 3 }").unwrap(), ["cu=6", "cu=4", "cu=2"]);
    for (range, message) in [
        ("{ from = 2, to = 3, count = 1 }", "a `count` from 2 to 1000"),
        ("{ from = 2, to = inf, count = 3 }", "has two numbers"),
        ("{ from = 2, to = 3 }", "missing field `count`"),
        ("{ from = 2, to = 2, count = 3 }", "level `2` twice"),
        ("{ from = 2, to = 3, count = 2 }\nvalues = [4]", "either `values` or `range`"),
    ] {
        let error = levels(range).unwrap_err().to_string();
        assert!(error.contains(message), "{range}: {error}");
    }
}

#[test]
fn a_case_keeps_its_seed_when_others_come_and_go() {
    let all = plan(TWO_BY_TWO).unwrap();
    let fewer =
        plan(&format!("{TWO_BY_TWO}[[leave_out]]\ncu_b = \"1.5\"\n[[case]]\nname = \"x\"\n")).unwrap();
    assert_eq!(fewer.cases.len(), 3);
    for case in &fewer.cases[..2] {
        assert_eq!(all.case(&case.name).unwrap().scene.walk.seed, case.scene.walk.seed);
    }
    let common = plan(&format!("seeds = \"common\"\nseed = 7\n{TWO_BY_TWO}")).unwrap();
    assert!(common.cases.iter().all(|c| c.scene.walk.seed == 7));
}

#[test]
fn mistakes_are_named() {
    for (text, message) in [
        ("", "there is no case"),
        ("sed = 1", "line 1: unknown field `sed`"),
        ("[[factor]]\nname = \"a\"\n", "needs either `setting` and `values`"),
        (
            "[[factor]]\nname = \"a\"\nsetting = \"base.uc\"\nvalues = [1]\n",
            "case a=1: there is no setting `base.uc`",
        ),
        (
            "[[factor]]\nname = \"a\"\nsetting = \"base.cu\"\nvalues = [0.1]\n",
            "case a=0.1, base.cu: `0.1` is not allowed",
        ),
        ("[[factor]]\nname = \"a\"\nsetting = \"base.cu\"\nvalues = [2, 2]\n", "level `2` twice"),
        ("[[factor]]\nname = \"a=b\"\nsetting = \"base.cu\"\nvalues = [2]\n", "is not allowed"),
        ("[[case]]\nname = \"../x\"\n", "is not allowed"),
        ("[[case]]\nname = \"x\"\n[[case]]\nname = \"x\"\n", "two cases are called `x`"),
        (
            "[[case]]\nname = \"x\"\nset = { filter = { \
             curve = \"a.csv\", density = \"loose\", cu = 2 } }\n",
            "both say what the filter's constrictions are",
        ),
        ("[[case]]\nname = \"x\"\n[[case]]\nname = \"X\"\n", "share the folder X"),
        (
            "[[factor]]\nname = \"f\"\n[factor.levels]\na = { base = { cu = 2 } }\n\
             A = { base = { cu = 3 } }\n",
            "share the folder f=A",
        ),
        ("[[case]]\nname = \"x\"\n[[leave_out]]\nfilter = \"x\"\n", "there is no factor `filter`"),
    ] {
        let error = plan(text).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }
}
