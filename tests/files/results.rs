//! Tables of results, a sample a row: whatever their headings, each is read right or refused.

use voidwalk::sheets::Soil;

const SIZES: [f64; 5] = [37.5, 19.0, 4.75, 2.0, 0.075];
const PERCENTS: [[f64; 5]; 2] = [[100.0, 97.0, 71.0, 54.0, 12.0], [100.0, 99.0, 88.0, 62.0, 37.5]];

/// Sizes as headings write them, without the words around them.
const NAMES: [[&str; 5]; 6] = [
    ["1 1/2 in", "3/4 in", "No. 4", "No. 10", "No. 200"],
    ["1.5\"", "0.75\"", "#4", "#10", "#200"],
    ["37.5 mm", "19 mm", "4.75 mm", "2 mm", "0.075 mm"],
    ["37.5", "19", "4.75", "2", "0.075"],
    ["1 1/2", "3/4", "4", "10", "200"],
    ["11/2in", "3/4in", "No4", "No10", "No200"],
];

#[test]
fn percents_of_a_sample_are_never_openings_whatever_the_headings_say() {
    let before = [
        "",
        "P",
        "P ",
        "Passing ",
        "% pass ",
        "%<",
        "% finer ",
        "Cum ",
        "pct_",
        "F",
        "Fin ",
        "% ret ",
        "R",
        ">",
        "-",
        "Minus ",
        "Sieve ",
        "Retained ",
    ];
    let behind = ["", " %", " (%)", " passing", "x", "*", " ?"];
    let labels = ["Sample,", "Filter,LL,", ","];
    let (mut read, mut refused) = (0, 0);
    let combinations = || before.iter().flat_map(|lead| behind.iter().map(move |tail| (lead, tail)));
    for (names, (lead, tail)) in
        NAMES.iter().flat_map(|names| combinations().map(move |words| (names, words)))
    {
        for (label, slip) in labels.iter().flat_map(|label| [(label, None), (label, Some(2))]) {
            let heads = names.iter().enumerate().map(|(at, name)| match Some(at) == slip {
                true => "Fines".to_owned(),
                false => format!("\"{}\"", format!("{lead}{name}{tail}").replace('"', "\"\"")),
            });
            let mut text = label.to_string() + &heads.collect::<Vec<_>>().join(",") + "\n";
            for (name, percents) in ["Core 1", "Core 2"].iter().zip(PERCENTS) {
                let more = if label.matches(',').count() > 1 { ",31.5" } else { "" };
                text += &format!("{name}{more},{}\n", percents.map(|p| p.to_string()).join(","));
            }
            let curves = Soil::all("a.csv", text.as_bytes()).and_then(|soils| {
                soils.iter().map(|soil| soil.gradation(None)).collect::<Result<Vec<_>, _>>()
            });
            let Ok(curves) = curves else {
                refused += 1;
                continue;
            };
            read += 1;
            assert_eq!(curves.len(), PERCENTS.len(), "{text}");
            for (curve, percents) in curves.iter().zip(PERCENTS) {
                for point in curve.points() {
                    let is_it = |(size, percent): (&f64, f64)| {
                        (point.size - size).abs() < 1e-6 * size && (point.percent - percent).abs() < 1e-6
                    };
                    assert!(SIZES.iter().zip(percents).any(is_it), "{text}{curve:?}");
                }
            }
        }
    }
    assert!(read > 400 && refused > 400, "{read} read, {refused} refused");
}

/// `p4` and `No. 4` are sieves above percents, and names of soils beside a column of sizes.
#[test]
fn beside_a_column_of_sizes_headings_are_names() {
    let sizes = [9.0, 4.0, 2.0, 0.5];
    for (lead, first) in
        [("p", 0), ("P", 1), ("Passing ", 1), ("% finer ", 3), ("s", 1), ("P #", 4), ("Lime 5% ", 1)]
    {
        for size in ["size_mm", "Sieve (mm)", "Korngröße [mm]"] {
            let names: Vec<String> = (first..first + 6).map(|n| format!("{lead}{n}")).collect();
            let mut text = format!("{size},{}\n", names.join(","));
            for (row, size) in sizes.iter().enumerate() {
                let percents = (0..6).map(|soil| (100 - row * (20 + soil)).to_string());
                text += &format!("{size},{}\n", percents.collect::<Vec<_>>().join(","));
            }
            let soils = Soil::all("a.csv", text.as_bytes()).unwrap_or_else(|e| panic!("{text}{e}"));
            assert_eq!(soils.len(), 6, "{text}");
            for (at, (soil, name)) in soils.iter().zip(&names).enumerate() {
                let curve = soil.gradation(None).unwrap();
                let finer = curve.percent_finer_by_mass(4.0);
                assert!((finer - (80 - at) as f64).abs() < 1e-9, "{text}{finer}");
                assert!(soil.name().contains(name.trim()), "{text}{}", soil.name());
            }
        }
    }
}
