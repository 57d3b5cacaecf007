//! Workbooks whose cells say more than their values: errors, raised and struck-out digits, units in formats.

use super::sheets::zipped;
use voidwalk::sheets::Soil;

/// Openings and percents of the only soil of a workbook, or why it is refused.
fn read(bytes: &[u8]) -> Result<Vec<(f64, f64)>, String> {
    let soil = Soil::one("sheet", bytes, None).map_err(|error| error.to_string())?;
    let curve = soil.gradation(None).map_err(|error| error.to_string())?;
    Ok(curve.points().iter().map(|point| (point.size, point.percent)).collect())
}

/// An .ods of `Sieve (mm) | % passing`, 9.5, 4.75, 2 and 0.425 mm, whose third row has this cell.
fn ods(styles: &str, cell: &str) -> Vec<u8> {
    let text = |text: &str| {
        format!("<table:table-cell office:value-type=\"string\"><text:p>{text}</text:p></table:table-cell>")
    };
    let number = |value: &str| {
        format!(
            "<table:table-cell office:value-type=\"float\" office:value=\"{value}\"><text:p>{value}</text:p>\
             </table:table-cell>"
        )
    };
    let row = |cells: String| format!("<table:table-row>{cells}</table:table-row>");
    let rows = [
        row(text("Sieve (mm)") + &text("% passing")),
        row(number("9.5") + &number("100")),
        row(number("4.75") + &number("97")),
        row(number("2") + cell),
        row(number("0.425") + &number("0")),
    ];
    let content = format!(
        "<office:document-content><office:automatic-styles>{styles}</office:automatic-styles>\
         <table:table table:name=\"A\">{}</table:table></office:document-content>",
        rows.concat()
    );
    zipped(&[("content.xml", content)])
}

/// An .xlsx of the same rows, in which `size` and `value` are the cells of the third, with their styles.
fn xlsx(formats: &str, strings: &str, heading: &str, rows: &[(&str, &str)]) -> Vec<u8> {
    xlsx_ending("</sheetData></worksheet>", formats, strings, heading, rows)
}

/// The same, whose sheet ends so.
fn xlsx_ending(end: &str, formats: &str, strings: &str, heading: &str, rows: &[(&str, &str)]) -> Vec<u8> {
    let text = |text: &str| format!("<c t=\"inlineStr\"><is><t>{text}</t></is></c>");
    let mut sheet = format!("<row>{}{}</row>", text(heading), text("% passing"));
    for (size, value) in rows {
        sheet += &format!("<row>{size}{value}</row>");
    }
    let styles = format!(
        "<styleSheet><numFmts>{formats}</numFmts><cellXfs><xf numFmtId=\"0\"/>\
         <xf numFmtId=\"170\"/></cellXfs></styleSheet>"
    );
    zipped(&[
        ("xl/workbook.xml", "<workbook><sheets><sheet name=\"A\" id=\"r1\"/></sheets></workbook>".into()),
        (
            "xl/_rels/workbook.xml.rels",
            "<Relationships><Relationship Id=\"r1\" Target=\"worksheets/sheet1.xml\"/></Relationships>"
                .into(),
        ),
        ("xl/styles.xml", styles),
        ("xl/sharedStrings.xml", format!("<sst>{strings}</sst>")),
        ("xl/worksheets/sheet1.xml", format!("<worksheet><sheetData>{sheet}{end}")),
    ])
}

const ROWS: [(&str, &str); 4] = [
    ("<c><v>9.5</v></c>", "<c><v>100</v></c>"),
    ("<c><v>4.75</v></c>", "<c><v>97</v></c>"),
    ("<c><v>2</v></c>", "<c><v>81</v></c>"),
    ("<c><v>0.425</v></c>", "<c><v>0</v></c>"),
];

#[test]
fn a_time_is_no_opening_whatever_its_format() {
    let of_format = |id: &str| {
        let formats = format!("<numFmt numFmtId=\"170\" formatCode=\"{id}\"/>");
        let mut rows = ROWS;
        rows[0].0 = "<c s=\"1\"><v>45724</v></c>";
        read(&xlsx(&formats, "", "Sieve (mm)", &rows))
    };
    assert_eq!(of_format("0.0").unwrap().last(), Some(&(45724.0, 100.0)));
    for format in ["m:ss", "[s]", "h AM/PM", "m"] {
        assert!(of_format(format).is_err(), "{format}");
    }
}

#[test]
fn a_sheet_that_is_cut_off_is_not_read_as_whole() {
    let ending = |end: &str| read(&xlsx_ending(end, "", "", "Sieve (mm)", &ROWS));
    assert_eq!(ending("</sheetData></worksheet>").unwrap().len(), 4);
    assert!(ending("").is_err());
}

#[test]
fn an_unknown_entity_does_not_glue_its_neighbours() {
    let mut rows = ROWS;
    rows[2].1 = "<c><v>8&b;1</v></c>";
    assert!(read(&xlsx("", "", "Sieve (mm)", &rows)).is_err());
}

#[test]
fn a_table_within_a_cell_does_not_hide_the_rows_behind_it() {
    let nested = "<table:table-cell><table:table table:name=\"B\"><table:table-row><table:table-cell/>\
                  </table:table-row></table:table></table:table-cell>";
    assert!(read(&ods("", nested)).unwrap_err().contains("a cell contains a table"));
}

#[test]
fn an_error_in_a_cell_of_opendocument_is_not_its_value() {
    for error in ["#DIV/0!", "Err:502", "#REF!", "#VALUE!", "#N/A"] {
        for kind in ["float", "percentage"] {
            let cell = format!(
                "<table:table-cell table:formula=\"of:=1/0\" office:value-type=\"{kind}\" office:value=\"0\">\
                 <text:p>{error}</text:p></table:table-cell>"
            );
            let said = read(&ods("", &cell)).unwrap_err();
            assert!(said.contains(error), "{said}");
        }
    }
}

const RAISED: &str = "<style:style style:name=\"T1\" style:family=\"text\"><style:text-properties \
                      style:text-position=\"super 58%\"/></style:style><style:style style:name=\"T2\" \
                      style:family=\"text\"><style:text-properties style:text-line-through-style=\"solid\"/>\
                      </style:style>";

#[test]
fn raised_and_struck_digits_are_not_glued_to_a_number() {
    let of_ods = |spans: &str| {
        let cell = format!(
            "<table:table-cell office:value-type=\"string\"><text:p>{spans}</text:p></table:table-cell>"
        );
        read(&ods(RAISED, &cell)).map(|points| points[1])
    };
    let of_xlsx = |runs: &str, is_shared: bool| {
        let value = match is_shared {
            true => "<c t=\"s\"><v>0</v></c>".to_owned(),
            false => format!("<c t=\"inlineStr\"><is>{runs}</is></c>"),
        };
        let strings = format!("<si>{runs}</si>");
        let number = |value: &str| format!("<c><v>{value}</v></c>");
        let rows = [("9.5", number("100")), ("4.75", number("97")), ("2", value), ("0.425", number("0"))];
        let rows: Vec<(String, String)> =
            rows.into_iter().map(|(size, value)| (number(size), value)).collect();
        let rows: Vec<(&str, &str)> =
            rows.iter().map(|(size, value)| (size.as_str(), value.as_str())).collect();
        read(&xlsx("", &strings, "Sieve (mm)", &rows)).map(|points| points[1])
    };
    assert_eq!(of_ods("8<text:span text:style-name=\"T1\">1</text:span>"), Ok((2.0, 8.0)));
    assert!(of_ods("<text:span text:style-name=\"T2\">8</text:span>5").is_err());
    assert!(of_ods("8<text:span text:style-name=\"T9\">1</text:span>").is_err());
    assert_eq!(of_ods("8<text:span text:style-name=\"T9\">.1</text:span>"), Ok((2.0, 8.1)));
    for is_shared in [true, false] {
        let run =
            |format: &str| of_xlsx(&format!("<r><t>8</t></r><r><rPr>{format}</rPr><t>1</t></r>"), is_shared);
        assert_eq!(run("<vertAlign val=\"superscript\"/>"), Ok((2.0, 8.0)));
        for refused in ["<strike/>", "<b/>", "<vertAlign val=\"subscript\"/>", "<strike val=\"1\"/><b/>"] {
            assert!(run(refused).is_err(), "{refused}");
        }
        assert_eq!(of_xlsx("<r><t>8</t></r><r><t>1</t></r>", is_shared), Ok((2.0, 81.0)));
    }
}

#[test]
fn a_unit_in_the_format_of_a_number_is_read_as_one() {
    let curve = |code: &str| {
        let formats = format!("<numFmt numFmtId=\"170\" formatCode=\"{}\"/>", code.replace('"', "&quot;"));
        let sizes = ["425", "250", "150", "75"].map(|size| format!("<c s=\"1\"><v>{size}</v></c>"));
        let values = ["100", "60", "30", "5"].map(|value| format!("<c><v>{value}</v></c>"));
        let rows: Vec<(&str, &str)> =
            sizes.iter().zip(&values).map(|(size, value)| (size.as_str(), value.as_str())).collect();
        read(&xlsx(&formats, "", "Sieve", &rows)).map(|points| points.last().unwrap().0)
    };
    for code in ["0\" µm\"", "0.0\" um\"", "0\\ \\µ\\m", "General\" microns\"", "0\"µ\"_D"] {
        assert_eq!(curve(code), Ok(0.425), "{code}");
    }
    assert_eq!(curve("0\" in\""), Ok(425.0 * 25.4));
    assert!(curve("0\" furlongs\"").is_err());
    assert_eq!(curve("0.0_D_M\" mm\""), Ok(425.0));
    let cell = "<table:table-cell office:value-type=\"float\" office:value=\"8\"><text:p>8 mm</text:p>\
                </table:table-cell>";
    assert!(read(&ods("", cell)).is_err());
    assert_eq!(read(&ods("", &cell.replace("mm", "g"))).unwrap()[1], (2.0, 8.0));
}

/// Openings (mm) of the soils of a text, or why it is refused.
fn sizes(name: &str, text: &str) -> Result<Vec<Vec<f64>>, String> {
    let soils = Soil::all(name, text.as_bytes()).map_err(|error| error.to_string())?;
    let sizes = |soil: &Soil| {
        let curve = soil.gradation(None).map_err(|error| error.to_string())?;
        Ok(curve.points().iter().map(|point| point.size).collect())
    };
    soils.iter().map(sizes).collect()
}

fn ags(groups: &[(&str, &str, &[&str])]) -> String {
    let mut text = String::new();
    for (headings, units, rows) in groups {
        text += &format!("\"GROUP\",\"GRAT\"\n\"HEADING\",\"LOCA_ID\",{headings}\n\"UNIT\",\"\",{units}\n");
        rows.iter().for_each(|row| text += &format!("\"DATA\",{row}\n"));
    }
    text
}

#[test]
fn units_and_columns_of_ags_are_those_of_each_group() {
    let (sizes_first, um, mm) = ("\"GRAT_SIZE\",\"GRAT_PERP\"", "\"um\",\"%\"", "\"mm\",\"%\"");
    let one = ["\"BH1\",\"425\",\"100\"", "\"BH1\",\"75\",\"20\""];
    let other = ["\"BH2\",\"2\",\"100\"", "\"BH2\",\"0.3\",\"20\""];
    let (one, other): ((_, _, &[&str]), (_, _, &[&str])) =
        ((sizes_first, um, &one), (sizes_first, mm, &other));
    let wanted = vec![vec![0.075, 0.425], vec![0.3, 2.0]];
    assert_eq!(sizes("a.ags", &ags(&[one, other])), Ok(wanted.clone()));
    assert_eq!(sizes("a.ags", &ags(&[other, one])), Ok(wanted.into_iter().rev().collect()));
    let swapped: (_, _, &[&str]) =
        ("\"GRAT_PERP\",\"GRAT_SIZE\"", "\"%\",\"um\"", &["\"BH1\",\"60\",\"150\""]);
    let in_mm: (_, _, &[&str]) = (sizes_first, mm, &["\"BH1\",\"0.15\",\"60\""]);
    for second in [swapped, in_mm] {
        assert!(sizes("a.ags", &ags(&[one, second])).unwrap_err().contains("its first rows"));
    }
    let amid = "\"GROUP\",\"LOCA\"\n\"HEADING\",\"LOCA_ID\"\n\"DATA\",\"BH1\",\"150\",\"60\"\n";
    assert!(sizes("a.ags", &(ags(&[one]) + amid)).unwrap_err().contains("a row of LOCA"));
    assert!(sizes("a.ags", &(ags(&[one]) + &amid.replace(",\"150\",\"60\"", ""))).is_ok());
}

#[test]
fn a_column_called_group_is_no_ags() {
    let text = "group,Sieve (mm),% passing\n,9.5,100\n,4.75,60\n,2,10\n";
    for text in [text.to_owned(), text.replace("group", "\"group\"")] {
        let read = sizes("a.csv", &text);
        assert!(!read.as_ref().is_err_and(|said| said.contains("AGS4")), "{read:?}");
    }
}

#[test]
fn units_beside_and_above_the_openings_are_heeded_or_asked_for() {
    let rows = "425,100\n250,80\n150,45\n75,12\n45,4\n";
    for text in [
        format!("Size,Passing\n[µ],[%]\n{rows}"),
        format!("Size,Passing\nµm,%\n{rows}"),
        format!("Size,Unit,% passing\n{}", rows.replace(',', ",um,")),
        format!("Sieve,,% finer\n{}", rows.replace(',', ",microns,")),
        format!("Size (µ),% passing\n{rows}"),
    ] {
        assert_eq!(sizes("a.csv", &text).unwrap()[0].last(), Some(&0.425), "{text}");
    }
    for text in [
        format!("µm,%\nSize,Passing\n{rows}"),
        format!("Sizes in µm\nSize,Passing\n{rows}"),
        format!("# size_um,percent_finer\nSize,Passing\n{rows}"),
        "# unit: um\nSize,Passing\n4,100\n2,50\n1,3\n".to_owned(),
        "Grain size in phi units\nSize,Passing\n-1,100\n0,50\n1,3\n".to_owned(),
        format!("Size (furlongs),Passing\n{rows}"),
        "Size,Unit,% passing\n9.5,mm,100\n4.75,mm,60\n600,um,30\n75,um,2\n".to_owned(),
        format!("Size (mm),Unit,% passing\n{}", rows.replace(',', ",um,")),
        format!("Size,Unit,% passing\n{}", rows.replace(',', ",um,").replace("150,um", "150,")),
        format!("Size,Passing\n{rows}"),
        "Sieve (µm),% passing\n9.5,100\n4.75,97\n2.36,85\n1.18,66\n0.6,44\n0.3,21\n".to_owned(),
    ] {
        assert!(sizes("a.csv", &text).is_err(), "{text}");
    }
    for text in [
        "Below 63 µm by laser\nSize,Passing\n4,100\n2,50\n1,3\n",
        "Size,Passing\n200,100\n100,60\n50,20\n25,3\n",
    ] {
        assert!(sizes("a.csv", text).is_ok(), "{text}");
    }
}

#[test]
fn numbers_of_sieves_of_other_series_are_refused() {
    for (heading, lead) in [
        ("Tyler mesh", ""),
        ("BS No.", ""),
        ("BSS mesh", ""),
        ("B.S. Sieve No.", ""),
        ("IS Sieve No.", ""),
        ("JIS No.", ""),
        ("AFNOR", "No. "),
        ("GOST", "No. "),
        ("Tyler sieve", ""),
    ] {
        let rows: String =
            [(10, 100), (14, 80), (28, 60), (100, 5)].map(|(n, p)| format!("{lead}{n},{p}\n")).concat();
        assert!(sizes("a.csv", &format!("{heading},% passing\n{rows}")).is_err(), "{heading}");
    }
    assert!(sizes("a.csv", "IS Sieve,% passing\n4.75,100\n2.36,60\n0.3,5\n").is_ok());
    assert!(sizes("a.csv", "US mesh,% passing\n10,100\n20,80\n100,5\n").is_ok());
}

#[test]
fn points_that_may_be_those_of_thousands_are_refused_among_whole_masses() {
    let text = |mass: &str| {
        format!("Sieve (mm),Mass retained (g)\n9.5,0\n4.75,150\n2,600\n1,{mass}\n0.5,950\nPan,700\n")
    };
    assert!(sizes("a.csv", &text("1.100")).unwrap_err().contains("thousands"));
    assert!(sizes("a.csv", &text("1100")).is_ok());
    assert!(sizes("a.csv", &text("1.100").replace("950", "950.5")).is_ok());
}

#[test]
fn letters_of_samples_are_neither_sizes_nor_grams() {
    let masses = "Sieve (mm),Soil D (g),Soil E (g)\n9.5,0,0\n4.75,10,20\n2,50,60\nPan,40,20\n";
    assert_eq!(sizes("a.csv", masses).unwrap().len(), 2);
    for names in ["Sample C,Sample D", "Zone F,Zone G", "Sample D,Sample G"] {
        let text = format!("Sieve (mm),{names}\n9.5,100,100\n4.75,60,70\n2,10,20\n");
        assert_eq!(sizes("a.csv", &text).unwrap().len(), 2, "{text}");
    }
}
