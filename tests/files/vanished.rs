//! Rows, soils and openings that a sheet would lose without a word: refused with their line, or named in a note.

use voidwalk::gradation::Soil;

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
