//! Every number of a table is in a curve, is named as left out, or the table is refused.

use super::sheets::{Cell, xlsx};
use voidwalk::sheets::Soil;

/// The curve of a sheet with one soil and its notes, or why it is refused.
fn read(text: &str) -> Result<(Vec<(f64, f64)>, String), String> {
    read_bytes("a.csv", text.as_bytes())
}

fn read_bytes(name: &str, bytes: &[u8]) -> Result<(Vec<(f64, f64)>, String), String> {
    let soil = Soil::one(name, bytes, None).map_err(|error| error.to_string())?;
    let curve = soil.gradation(None).map_err(|error| error.to_string())?;
    Ok((curve.points().iter().map(|point| (point.size, point.percent)).collect(), soil.notes().join("; ")))
}

const CLASSES: [(f64, f64); 5] = [(0.053, 5.0), (0.075, 15.0), (0.106, 55.0), (0.15, 88.0), (0.3, 100.0)];

#[test]
fn bounds_of_classes_are_openings_in_either_order_unit_and_language() {
    let rows =
        [("0.3", "0.15", "12"), ("0.15", "0.106", "33"), ("0.106", "0.075", "40"), ("0.075", "0.053", "10")];
    for (upper, lower, value) in [
        ("Upper (mm)", "Lower (mm)", "% in class retained"),
        ("Size from", "Size to", "% retained"),
        ("d max (mm)", "d min (mm)", "% retained"),
        ("Sieve upper", "Sieve lower", "% retained on each"),
        ("Passing (mm)", "Retained on (mm)", "% retained"),
        ("von (mm)", "bis (mm)", "Rückstand (%)"),
    ] {
        for (swapped, backwards) in [(false, false), (true, false), (false, true)] {
            let line = |upper: &str, lower: &str, value: &str| match swapped {
                true => format!("{lower},{upper},{value}\n"),
                false => format!("{upper},{lower},{value}\n"),
            };
            let mut lines: Vec<String> = rows.iter().map(|(u, l, v)| line(u, l, v)).collect();
            if backwards {
                lines.reverse();
            }
            let text = line(upper, lower, value) + &lines.concat();
            let (curve, notes) = read(&text).unwrap_or_else(|said| panic!("{text}{said}"));
            assert_eq!(curve, CLASSES, "{text}");
            assert!(notes.contains("bounds of classes"), "{notes}");
        }
    }
}

#[test]
fn a_class_without_a_lower_bound_is_the_pan() {
    for pan in ["0.053,,5", "0.053,0,5", "0.053,Pan,5"] {
        let text = format!(
            "Upper (mm),Lower (mm),Mass retained (g)\n0.3,0.15,12\n0.15,0.106,33\n0.106,0.075,40\n0.075,0.053,10\n{pan}\n"
        );
        assert_eq!(read(&text).unwrap().0, CLASSES, "{text}");
    }
}

#[test]
fn a_second_column_of_openings_that_is_neither_classes_nor_the_same_sieves_is_refused() {
    for text in [
        // One bound does not follow.
        "Upper (mm),Lower (mm),% retained\n0.6,0.3,10\n0.3,0.2,12\n0.15,0.106,33\n0.106,0.075,45\n",
        // Percents finer of which bound?
        "Upper (mm),Lower (mm),% finer\n0.6,0.3,100\n0.3,0.15,88\n0.15,0.106,55\n0.106,0.075,15\n",
        // The heading does not say that they are openings.
        "Sieve (mm),to,% retained\n0.6,0.3,10\n0.3,0.15,12\n0.15,0.106,33\n0.106,0.075,45\n",
        "Sieve (mm),Percent in class,Lower\n0.6,100,0.3\n0.3,88,0.15\n0.15,55,0.106\n0.106,15,0.075\n",
        "Sieve (mm),Passing,% retained\n100,50,10\n50,25,12\n25,12.5,33\n12.5,6.3,45\n",
        // Two units that disagree in one row.
        "Sieve (in),Sieve (mm),% finer\n0.75,19,100\n0.375,12.5,70\n0.187,4.75,10\n",
        "Sieve No.,Opening (mm),% finer\n4,4.75,100\n10,1,70\n200,0.075,10\n",
    ] {
        assert!(read(text).is_err(), "{text}");
    }
}

#[test]
fn the_same_sieves_in_two_units_are_read() {
    for text in [
        "Sieve (in),Sieve (mm),% finer\n0.75,19,100\n0.375,9.5,70\n0.187,4.75,10\n",
        "Sieve,Opening (mm),% finer\n3/4 in,19,100\n3/8 in,9.5,70\nNo. 4,4.75,10\n",
        "Sieve No.,Opening (mm),% finer\n1,19,100\n2,9.5,70\n3,4.75,10\n",
        "Size (phi),Sieve (mm),% finer\n-4.25,19,100\n-3.25,9.5,70\n-2.25,4.75,10\n",
    ] {
        assert_eq!(read(text).unwrap().0, [(4.75, 10.0), (9.5, 70.0), (19.0, 100.0)], "{text}");
    }
}

/// A table of percents finer or of masses whose fourth line is `row`.
fn with(heading: &str, separator: char, row: &str) -> String {
    let rows = ["9.5,100", "4.75,91.7", "", "1.18,61.6", "0.6,40.7", "0.075,2"];
    let masses = ["9.5,0", "4.75,15", "", "1.18,95", "0.6,110", "Pan,10"];
    let rows = if heading.contains("Mass") { masses } else { rows };
    let line = |line: &&str| match line.is_empty() {
        true => row.to_owned() + "\n",
        false => line.replace(',', &separator.to_string()) + "\n",
    };
    format!("{}\n", heading.replace(',', &separator.to_string())) + &rows.iter().map(line).collect::<String>()
}

#[test]
fn a_row_that_cannot_be_read_is_refused_with_its_line() {
    for heading in ["Sieve (mm),% passing", "Sieve (mm),Mass retained (g)"] {
        for (separator, row) in [
            ('\t', "2.36   79.3"),
            ('\t', "2.36,79.3"),
            ('\t', "2.36;79.3"),
            ('\t', "2.36|79.3"),
            ('\t', "\"2.36\t79.3\""),
            (',', "2.36;79.3"),
            (',', "2.36\t79.3"),
            (',', "\"2.36,79.3\""),
            (',', "'2.36,79.3'"),
            (',', "2.36 mm 79.3"),
            (',', "No. 8 79.3"),
            (',', "Sieve no. 8   79.3"),
            (',', "2.36"),
            (',', "2.36,79.3,4"),
            (';', "2.36,79.3"),
            (';', "2.36"),
            (',', "x2.36,79.3"),
            (',', "2.36,7O.3"),
            (',', ",79.3"),
        ] {
            let text = with(heading, separator, row);
            let said = read(&text).expect_err(&text);
            assert!(said.contains("line 4"), "{text}{said}");
        }
    }
    for row in ["0.01   1", "\"0.01,1\"", "0.01;1", "Pan   0"] {
        let text = with("Sieve (mm),% passing", ',', "2.36,79.3") + row + "\n";
        let said = read(&text).expect_err(&text);
        assert!(said.contains("line 8"), "{text}{said}");
    }
    for row in ["9.5   100", "No. 3/8 100", "\"9.5\t100\""] {
        let text = with("Sieve (mm),% passing", '\t', "2.36\t79.3").replace("9.5\t100", row);
        let said = read(&text).expect_err(&text);
        assert!(said.contains("line 2"), "{text}{said}");
    }
}

#[test]
fn a_percent_that_is_empty_is_named_and_a_mass_that_is_empty_refused() {
    let (curve, notes) = read(&with("Sieve (mm),% passing", ',', "2.36,")).unwrap();
    assert!(curve.len() == 5 && notes.contains("line 4 has no percent"), "{notes}");
    assert!(read(&with("Sieve (mm),Mass retained (g)", ',', "2.36,")).is_err());
    assert!(read(&with("Sieve (mm),Mass retained (g)", ',', "2.36,-")).is_err());
    assert!(read("Sieve (mm),% retained on each\n9.5,0\n4.75,40\n2.36,\n1.18,30\nPan,10\n").is_err());
    assert!(read("Sieve (mm),% retained on each\n9.5,0\n4.75,40\n2.36,\n1.18,50\nPan,10\n").is_ok());
    let (_, notes) = read("Sieve (mm),Cum. % retained\n9.5,0\n4.75,40\n2.36,\n1.18,90\n").unwrap();
    assert!(notes.contains("line 4 has no percent"), "{notes}");
    let several = "Sieve (mm),A,B\n9.5,100,100\n4.75,,80\n2.36,50,60\n";
    let soils = Soil::all("a.csv", several.as_bytes()).unwrap();
    let is_named = |soil: &Soil| soil.notes().iter().any(|note| note.contains("line 3 has no percent"));
    assert!(is_named(&soils[0]) && !is_named(&soils[1]));
    let (curve, notes) =
        read("BS sieve,Mass (g) actual,% passing\n20 mm,0,100\n6.3 mm,75,85\nriffled m4,250,\n2 mm,28,64\n")
            .unwrap();
    assert!(curve.len() == 3 && notes.contains("line 4 has no percent"), "{notes}");
}

#[test]
fn remarks_and_footnotes_without_numbers_of_the_table_are_left_out() {
    let text = "Sieve (mm),% passing\n9.5,100\n4.75,91.7\nHydrometer\n0.02,20\n0.002,5\n* dried at 60 °C\n28 November 2026\n";
    let (curve, notes) = read(text).unwrap();
    assert!(curve.len() == 4 && notes.contains("remarks"), "{notes}");
}

#[test]
fn of_total_says_the_base_of_percents_and_not_that_they_are_cumulative() {
    let rows = "9.5,0\n4.75,1\n2.36,3\n1.18,6\n0.6,10\n0.3,15\n0.15,25\n0.075,38\n";
    for heading in ["% of total retained", "% retained of the total sample", "Retained, % of total mass"] {
        let said = read(&format!("Sieve (mm),\"{heading}\"\n{rows}")).unwrap_err();
        assert!(said.contains("cumulative") && said.contains("individual"), "{heading}: {said}");
    }
    let (curve, _) = read(&format!("Sieve (mm),Total % retained\n{rows}")).unwrap();
    assert_eq!(curve[0], (0.075, 62.0));
}

#[test]
fn columns_of_percents_that_contradict_each_other_are_refused() {
    let sheet = |heads: &str, third: &str| {
        format!("Sieve (mm),{heads}\n9.5,0,100\n4.75,18,82\n2.36,{third}\n1.18,75,25\n0.6,92,8\n")
    };
    assert!(read(&sheet("% cumulative retained,% passing", "50,50")).is_ok());
    assert!(read(&sheet("% retained,% passing", "50,50")).is_ok());
    let said = read(&sheet("% cumulative retained,% passing", "57,50")).unwrap_err();
    assert!(said.contains("line 4") && said.contains("agree"), "{said}");
    assert!(read(&sheet("% retained,% finer", "57,50")).is_err());
    let single = "Sieve (mm),% retained,Cumulative % retained\n9.5,0,0\n4.75,18,18\n2.36,32,50\n1.18,25,75\n0.6,17,92\n";
    assert!(read(single).is_ok());
    assert!(read(&single.replace("32,50", "39,50")).is_err());
}

#[test]
fn masses_are_refused_where_sizes_turn_or_totals_differ() {
    let masses = "Sieve (mm),Mass retained (g)\n9.5,0\n4.75,15\n2.36,60\n1.18,95\nPan,10\nTotal,180\n";
    assert!(read(masses).is_ok());
    assert!(read(&masses.replace("2.36,60", "60,2.36")).is_err());
    assert!(read(&format!("{masses}Total,190\n")).is_err());
}

#[test]
fn words_below_a_table_end_it_whatever_stands_below_them() {
    let rows: [&[&str]; 19] = [
        &["", "Project", "Dam A"],
        &["", "Sieve [mm]", "Mass [g]", "Finer [%]"],
        &["", "9.5", "0", "100"],
        &["", "4.75", "90", "82"],
        &["", "2.36", "160", "50"],
        &["", "1.18", "125", "25"],
        &["", "0.6", "85", "8"],
        &["", "0.3", "35", "1"],
        &["", "Pan", "5", "0"],
        &["", "Dry mass [g]", "500"],
        &["", "D10 [mm]", "0.66"],
        &["", "Cu", "4.3"],
        &[],
        &["", "Statistics of the field"],
        &["", "Samples", "mean D10", "deviation"],
        &["", "12", "0.61", "0.08"],
        &["", "25", "0.63", "0.11"],
        &["", "50", "0.70", "7"],
        &["", "Mean", "0.65", "3"],
    ];
    let right = [(0.3, 1.0), (0.6, 8.0), (1.18, 25.0), (2.36, 50.0), (4.75, 82.0), (9.5, 100.0)];
    let cell = |text: &&str| match (text.is_empty(), text.parse()) {
        (true, _) => None,
        (_, Ok(number)) => Some(Cell::Number(number)),
        _ => Some(Cell::Text((*text).to_owned())),
    };
    let grid = rows.iter().map(|row| row.iter().map(cell).collect()).collect();
    let csv: String = rows.iter().map(|row| row.join(";") + "\n").collect();
    for (name, bytes) in [("a.xlsx", xlsx(&grid)), ("a.csv", csv.into_bytes())] {
        let (curve, notes) = read_bytes(name, &bytes).unwrap();
        assert_eq!(curve, right, "{name}");
        assert!(
            notes.contains("s 10 to 19 below the table") && notes.contains("\"Dry mass [g]\" 500"),
            "{notes}"
        );
    }
    // Sieves that go on below the words are a part of the table.
    let goes_on = "Sieve (mm),% passing\n9.5,100\n4.75,82\nCoarse fraction,55\n2.36,50\n1.18,25\n";
    assert!(read(goes_on).unwrap_err().contains("line 4"));
}

#[test]
fn rows_of_ags_and_of_tables_on_their_side_are_not_passed_over() {
    let ags = "\"GROUP\",\"GRAT\"\n\"HEADING\",\"LOCA_ID\",\"GRAT_SIZE\",\"GRAT_PERP\"\n\"UNIT\",\"\",\"mm\",\"%\"\n\
               \"DATA\",\"BH1\",\"2\",\"100\"\n\"DATA\",\"BH1\",\"0.6\",\"60\"\n\"DATA\",\"BH1\",\"0.1\",\"5\"\n";
    let row = "\"DATA\",\"BH1\",\"0.6\",\"60\"";
    assert!(read(ags).is_ok());
    for damaged in [
        "\"DATA\",\"0.6\",\"60\"",
        "\"DATA,BH1,0.6,60\"",
        "DATA;BH1;0.6;60",
        "\"DTA\",\"BH1\",\"0.6\",\"60\"",
        "\"DATA\",\"BH1\",\"0.6,\"60\"",
    ] {
        let said = read(&ags.replace(row, damaged)).expect_err(damaged);
        assert!(said.contains("line 5"), "{damaged}: {said}");
    }
    let across = "Sample,19,9.5,4.75,2\nTP1,100,90,80,70\nTP2,100,91,75,60\nTP3,100,95,85,65\n";
    let all = |text: &str| Soil::all("a.csv", text.as_bytes());
    assert_eq!(all(across).unwrap().len(), 3);
    for (row, damaged) in [
        ("TP2,100,91,75,60", "TP2;100;91;75;60"),
        ("TP1,100,90,80,70", "\"TP1,100,90,80,70\""),
        ("TP2,100,91,75,60", "TP2,91,75,60"),
        ("TP2,100,91,75,60", "TP2,100,91,75,60,3"),
        ("Sample,19,9.5,4.75,2", "Sample,9.5,4.75,2"),
        ("Sample,19,9.5,4.75,2", "Sample,19,9.5,4.75,x,2"),
        ("Sample,19,9.5,4.75,2", "Sample;19;9.5;4.75;2"),
        ("Sample,19,9.5,4.75,2", "Sample,19,4.75,9.5,2"),
        ("TP1,100,90,80,70", "Lower (mm),9.5,4.75,2,1"),
    ] {
        let text = across.replace(row, damaged);
        assert!(all(&text).is_err(), "{text}");
    }
}
