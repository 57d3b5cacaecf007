//! Rows, soils and openings that a sheet would lose without a word: refused with their line, or named in a note.

use voidwalk::sheets::Soil;

/// The soils of a sheet and all of their notes, or why it is refused.
fn read(text: &str) -> Result<(Vec<Soil>, String), String> {
    let soils = Soil::all("a.csv", text.as_bytes()).map_err(|error| error.to_string())?;
    if let Some(error) = soils.iter().find_map(|soil| soil.gradation(None).err()) {
        return Err(error.to_string());
    }
    let notes: Vec<&str> = soils.iter().flat_map(|soil| soil.notes()).map(String::as_str).collect();
    let notes = notes.join("; ");
    Ok((soils, notes))
}

fn refused(text: &str, part: &str) {
    let said = read(text).map(|(_, notes)| notes).expect_err(text);
    assert!(said.contains(part), "{text}{said}");
}

const MASSES: &str = "Sieve (mm),Mass retained (g),Remark\n9.5,0,ok\n4.75,15,ok\n2.36,60,ok\n1.18,95,re-run\n\
                      0.6,110,ok\n0.3,115,ok\n0.15,70,ok\n0.075,25,ok\nPan,10,\n";

#[test]
fn a_row_behind_a_hash_is_named_or_refused_whatever_stands_beside_its_number() {
    assert!(read(MASSES).is_ok());
    for row in ["1.18,95,re-run", "0.075,25,ok", "9.5,0,ok"] {
        refused(&MASSES.replace(&format!("\n{row}"), &format!("\n#{row}")), row);
    }
    refused(&MASSES.replace("1.18,95,re-run", "# 1.18;95;re-run"), "1.18;95");
    for (text, line) in [
        (
            "Sample,9.5,4.75,2.36,1.18,0.6\nA,100,97,85,66,44\n#B,100,99,95,88,71\nC,100,90,70,50,30\n",
            "line 3",
        ),
        (
            "Sample,Sieve (mm),% passing\nA,9.5,100\nA,2.36,60\nA,0.6,7\n#B,9.5,100\nC,9.5,100\nC,2.36,70\n",
            "line 5",
        ),
    ] {
        let (soils, notes) = read(text).unwrap();
        assert!(soils.len() == 2 && notes.contains(line), "{text}{notes}");
    }
    // Names of sieves, and what stands above a table.
    let numbers = "# Sample 12, depth 3 m\n# w (%), 12.5\nSieve,Mass retained (g),Remark\n#4,0,ok\n#10,15,ok\n#40,60,\n#200,20,ok\nPan,5,\n";
    assert_eq!(read(numbers).unwrap().0[0].gradation(None).unwrap().points().len(), 4);
    let remark = MASSES.replace("\n0.3", "\n# sieved twice, by hand\n0.3");
    assert!(read(&remark).is_ok());
}

const TIDY: &str = "Sample,Sieve (mm),Mass retained (g)\nA,9.5,0\nA,4.75,15\nA,2.36,60\nA,1.18,95\nA,Pan,5\n\
                    B,9.5,0\nB,4.75,20\nB,2.36,60\nB,Pan,5\n";

#[test]
fn a_torn_row_is_no_remark_behind_a_name() {
    assert_eq!(read(TIDY).unwrap().0.len(), 2);
    for row in
        ["A;2.36;60", "A|2.36|60", "\"A,2.36,60\"", "A\t2.36\t60", "A 2.36 60", "A: 2.36: 60", "BH 1/2.36/60"]
    {
        refused(&TIDY.replace("A,2.36,60", row), "line 4");
    }
    refused(&TIDY.replace("A,Pan,5", "A;Pan;5"), "line 6");
    let two = "Sieve (mm),Mass retained (g)\n9.5,0\n4.75,15\n2.36,60\n1.18,95\n0.6,30\nPan,10\n";
    for row in ["Sieve no. 8; 60 g", "x 2.36;60", "retested 2.36: 60 g", "Sieve 2.36 mm = 60 g"] {
        refused(&two.replace("2.36,60", row), "line 4");
    }
    for remark in ["Note: washed on 2024-03-05", "Tested 12/03/2024", "\"Lab 7, BS 1377-2:1990\""] {
        let text = two.replace("1.18", &format!("{remark}\n1.18"));
        assert!(read(&text).is_ok(), "{text}");
        assert!(read(&format!("{two}{remark}\n")).is_ok(), "{remark}");
    }
    let three = "Sieve (mm),A % ret,B % ret\n9.5,0,0\n4.75,20,30\n2.36,30,20\n0.6,40,40\n";
    for row in ["0.075: 5: 5", "0.075 / 5 / 5", "0.075 = 5 = 5", "x 0.075; 5; 5"] {
        refused(&format!("{three}{row}\n"), "line 6");
    }
    let across = "Sample,9.5,4.75,2.36,1.18,0.6\nA,100,97,85,66,44\nB,100,99,95,88,71\n";
    let row = "C;100;97;70;50;30";
    for sign in [";", "\t", " ", "|", ":", "/", " = "] {
        refused(&format!("{across}{}\n", row.replace(';', sign)), "line 4");
    }
    refused(&format!("{across}\"C,100,97,70,50,30\"\n"), "line 4");
    assert!(read(&format!("{across}Tested 12/03/2024\n")).is_ok());
}

#[test]
fn a_misspelt_heading_beside_the_openings_of_a_table_on_its_side_is_refused() {
    let sheet =
        |heading: &str| format!("Sample,3/8,#4,#16,#100,{heading}\nA,100,97,66,7,2\nB,100,99,88,33,20\n");
    for heading in ["#2OO", "0..075", "PO.O75", "#200x", "O.O75", "No. 2OO"] {
        refused(&sheet(heading), heading);
    }
    for heading in ["LL", "PI", "Cu", "D60", "Moisture (%)"] {
        assert_eq!(read(&sheet(heading)).map(|read| read.0.len()), Ok(2), "{heading}");
    }
}

const SIZES: [&str; 8] = ["9.5", "4.75", "2.36", "1.18", "0.6", "0.3", "0.15", "0.075"];

/// A table of two columns.
fn column(heading: &str, values: [&str; 8]) -> String {
    let rows = SIZES.iter().zip(values).map(|(size, value)| format!("{size},{value}\n"));
    format!("Sieve (mm),{heading}\n{}", rows.collect::<String>())
}

#[test]
fn fractions_retained_are_no_percents() {
    let cumulative = ["0", "0.03", "0.15", "0.34", "0.56", "0.79", "0.93", "0.98"];
    let single = ["0", "0.03", "0.12", "0.19", "0.22", "0.23", "0.14", "0.05"];
    for (heading, values) in [("Cumulative fraction retained", cumulative), ("Fraction retained", single)] {
        let (soils, _) = read(&column(heading, values)).unwrap();
        let curve = soils[0].gradation(None).unwrap();
        assert!((curve.percent_finer_if_known(0.6).unwrap() - 44.0).abs() < 1e-6, "{heading}");
    }
    for heading in ["Cumulative % retained", "Cumulative %", "Cum. retained", "% coarser"] {
        refused(&column(heading, cumulative), "fraction");
    }
    refused(&column("% retained", single), "fraction");
    let across = |values: [&str; 8]| {
        format!("% retained,{}\nA,{}\nB,{}\n", SIZES.join(","), values.join(","), values.join(","))
    };
    refused(&across(single), "fraction");
    refused(&across(cumulative), "fraction");
    // Fifty grams?
    for heading in ["Retained", "Cum. retained"] {
        refused(&column(heading, ["0", "2", "8", "15", "26", "37", "44", "47"]), "% or g");
    }
    assert!(read(&column("Cum. retained", ["0", "3", "15", "34", "56", "79", "93", "98"])).is_ok());
    assert!(read(&column("Cum. retained (%)", ["0", "2", "8", "15", "26", "37", "44", "47"])).is_ok());
}

#[test]
fn a_hundred_above_fractions_is_asked_for() {
    for top in ["100", "100 %"] {
        for heading in ["Passing", "% passing"] {
            refused(
                &column(heading, [top, "0.97", "0.85", "0.66", "0.44", "0.21", "0.07", "0.02"]),
                "line 3",
            );
        }
    }
    refused(&column("Passing", ["100 %", "97 %", "85 %", "66 %", "44 %", "0.21", "7 %", "2 %"]), "line 7");
    assert!(read(&column("Passing", ["100", "97", "85", "66", "44", "7", "0.9", "0.2"])).is_ok());
    assert!(read(&column("Passing", ["100 %", "97 %", "85 %", "66 %", "44 %", "7 %", "0.9 %", "0"])).is_ok());
}

#[test]
fn a_mass_above_beside_or_below_a_table_is_that_of_the_table() {
    let table = "Sieve (mm),Mass retained (g)\n9.5,0\n4.75,30\n2.36,120\n1.18,190\n0.6,50\nPan,10\n";
    let beside =
        |row: &str| table.replacen("9.5,0", &format!("9.5,0,{row}"), 1).replacen("(g)", "(g),Notes,Value", 1);
    for mass in ["500", "300"] {
        let row = format!("Total dry mass (g),{mass}");
        for text in [format!("{row}\n{table}"), format!("{table}{row}\n"), beside(&row)] {
            refused(&text, "400");
        }
        let row = format!("Initial mass (g),{mass}");
        for text in [format!("{row}\n{table}"), format!("{table}{row}\n"), beside(&row)] {
            let (_, notes) = read(&text).unwrap();
            assert!(notes.contains("come to 400"), "{text}{notes}");
        }
    }
    for row in [
        "Total dry mass (g),400",
        "Total dry mass (kg),0.4",
        "Dry mass: 401 g",
        "Mass of tare (g),25",
        "Depth (m),3",
    ] {
        let (_, notes) = read(&format!("{row}\n{table}")).unwrap();
        assert!(!notes.contains("come to"), "{row}: {notes}");
    }
}

#[test]
fn masses_with_a_pan_agree_with_the_percents_beside_them() {
    let table = "Sieve (mm),Mass retained (g),% finer\n9.5,0,100\n4.75,15,97\n2.36,60,85\n1.18,95,66\n0.6,110,44\n\
                 0.3,115,21\n0.15,70,7\n0.075,25,2\nPan,10,\n";
    assert!(read(table).is_ok());
    refused(&table.replace("110,44", "110,54"), "line 6");
    refused(&table.replace("110,44", "150,44"), "agree");
    let cumulative = "Sieve (mm),Cumulative mass retained (g),% finer\n9.5,0,100\n4.75,15,97\n2.36,75,85\n1.18,170,66\n0.6,280,44\nPan,500,\n";
    assert!(read(cumulative).is_ok());
    refused(&cumulative.replace("280,44", "250,44"), "agree");
    // Fines that were washed out are in the percents alone.
    let washed = "Sieve (mm),Mass retained (g),% finer\n9.5,0,100\n4.75,15,97\n2.36,60,85\n1.18,95,66\n0.6,110,44\nPan,10,\n";
    assert!(read(washed).is_ok());
}

#[test]
fn samples_that_do_not_overlap_are_soils_of_their_own() {
    let table = "Sample,Sieve (mm),% passing\nA,75,100\nA,37.5,90\nA,19,80\nA,9.5,70\nB,4.75,100\nB,2.36,90\n\
                 B,1.18,70\nB,.6,50\n";
    assert_eq!(read(table).unwrap().0.len(), 2);
    let retained =
        "Sample,Sieve (mm),% retained on each\nA,75,0\nA,37.5,20\nA,19,80\nB,9.5,0\nB,4.75,30\nB,2.36,70\n";
    assert_eq!(read(retained).unwrap().0.len(), 2);
    let fractions = "Material,Sieve (mm),% passing\nGravel,75,100\nGravel,4.75,60\nSand,2,40\nSand,0.075,5\n";
    assert_eq!(read(fractions).unwrap().0.len(), 1);
}
