//! Equal grains in every form of VTK, and the refusals.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use proptest::prelude::*;

use crate::packing::{Cell, CellOption, LengthUnit, Packing, ReadOptions};

const PLACES: [f64; 6] = [0.5, 1.0, 2.0, 1.5, 2.5, 3.25];
const RADII: [f64; 2] = [0.5, 0.375];

fn read(content: &[u8]) -> Result<Packing, String> {
    let options = ReadOptions { unit: Some(LengthUnit::Mm), cell: Some(CellOption::None) };
    Packing::parse_as("f", content, &options).map(|read| read.0).map_err(|error| error.to_string())
}

fn expected() -> Packing {
    let [x, y, z] = [[0.5, 1.5], [1.0, 2.5], [2.0, 3.25]].map(Vec::from);
    Packing { cell: Cell::Free, x, y, z, diameter: vec![1.0, 0.75] }
}

fn words(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn floats(values: &[f64], is_big_endian: bool) -> Vec<u8> {
    let bytes = |&value: &f64| match is_big_endian {
        true => (value as f32).to_be_bytes(),
        false => (value as f32).to_le_bytes(),
    };
    values.iter().flat_map(bytes).collect()
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(content).unwrap();
    packed.finish().unwrap()
}

const LEGACY: &str = "# vtk DataFile Version 3.0\nLIGGGHTS\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n\
                      0.5 1 2\n1.5 2.5 3.25\nVERTICES 2 4\n1 0\n1 1\nPOINT_DATA 2\n\
                      VECTORS v float\n0 0 0 0 0 0\nSCALARS radius float 1\nLOOKUP_TABLE default\n0.5\n\
                      0.375\n";

#[test]
fn files_before_xml() {
    assert_eq!(read(LEGACY.as_bytes()), Ok(expected()));
    assert_eq!(read(&gzip(LEGACY.as_bytes())), Ok(expected()));
    assert_eq!(read(LEGACY.replace('\n', "\r\n").as_bytes()), Ok(expected()));
    // Binary, in the form of VTK 9: cells by offsets, a field, and notes on arrays.
    let ints = |values: &[i64]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
    let parts: [(&str, Vec<u8>); 7] = [
        (
            "# vtk DataFile Version 5.1\nvtk output\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\n",
            floats(&PLACES, true),
        ),
        ("\nMETADATA\nINFORMATION 0\n\nVERTICES 3 2\nOFFSETS vtktypeint64\n", ints(&[0, 1, 2])),
        ("\nCONNECTIVITY vtktypeint64\n", ints(&[0, 1])),
        ("\nCELL_DATA 2\nSCALARS radius int\nLOOKUP_TABLE default\n", vec![0; 8]),
        ("\nPOINT_DATA 2\nFIELD FieldData 2\nvelocity 3 2 float\n", floats(&PLACES, true)),
        ("\nradius 1 2 float\n", floats(&RADII, true)),
        ("\nMETADATA\nINFORMATION 0\n\n", Vec::new()),
    ];
    let binary: Vec<u8> = parts.iter().flat_map(|(text, bytes)| [text.as_bytes(), bytes].concat()).collect();
    assert_eq!(read(&binary), Ok(expected()));
    // Every shorter file is refused, or lacks only the part behind the radii.
    for end in 0..binary.len() {
        let shorter = read(&binary[..end]);
        assert!(shorter.is_err() || shorter == Ok(expected()), "{end}: {shorter:?}");
    }
}

/// A file in XML whose arrays have these attributes and this content.
fn in_xml(attributes: &str, arrays: [(&str, &str); 2], appended: &[u8]) -> Vec<u8> {
    let [(of_places, places), (of_radii, radii)] = arrays;
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" {attributes}>\n\
         <UnstructuredGrid>\n<Piece NumberOfPoints=\"2\" NumberOfCells=\"0\">\n<PointData>\n\
         <DataArray type=\"Float32\" Name=\"radii\" {of_radii}>{radii}</DataArray>\n</PointData>\n<Points>\n\
         <DataArray type=\"Float32\" NumberOfComponents=\"3\" {of_places}>{places}</DataArray>\n</Points>\n\
         </Piece>\n</UnstructuredGrid>\n"
    );
    [head.as_bytes(), appended, b"</VTKFile>\n"].concat()
}

fn with_length(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

/// Two blocks of 4 bytes or fewer packed by zlib, and the header before them.
fn zlib(bytes: &[u8]) -> [Vec<u8>; 2] {
    let half = bytes.len() / 2 + 2;
    let blocks: Vec<Vec<u8>> = bytes
        .chunks(half)
        .map(|block| {
            let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            packed.write_all(block).unwrap();
            packed.finish().unwrap()
        })
        .collect();
    let last = bytes.len() % half;
    let header = [blocks.len(), half, last].into_iter().chain(blocks.iter().map(Vec::len));
    [header.flat_map(|n| (n as u32).to_le_bytes()).collect(), blocks.concat()]
}

#[test]
fn files_in_xml() {
    let (places, radii) = (floats(&PLACES, false), floats(&RADII, false));
    let text = [words(&PLACES), words(&RADII)];
    let ascii = in_xml("", [("format=\"ascii\"", &text[0]), ("format=\"ascii\"", &text[1])], b"");
    assert_eq!(read(&ascii), Ok(expected()));
    // Notes of VTK on an array lie within it.
    let noted =
        text.each_ref().map(|text| format!("{text}\n<InformationKey><Value>9</Value></InformationKey>"));
    let noted = [("format=\"ascii\"", noted[0].as_str()), ("format=\"ascii\"", &noted[1])];
    assert_eq!(read(&in_xml("", noted, b"")), Ok(expected()));
    assert_eq!(read(&gzip(&ascii)), Ok(expected()));
    let coded = [&places, &radii].map(|bytes| STANDARD.encode(with_length(bytes)));
    let inline = [("format=\"binary\"", coded[0].as_str()), ("format=\"binary\"", &coded[1])];
    assert_eq!(read(&in_xml("byte_order=\"LittleEndian\"", inline, b"")), Ok(expected()));
    let packed = [&places, &radii].map(|bytes| zlib(bytes).map(|part| STANDARD.encode(part)).concat());
    let inline = [("format=\"binary\"", packed[0].as_str()), ("format=\"binary\"", &packed[1])];
    let compressor = "compressor=\"vtkZLibDataCompressor\" header_type=\"UInt32\"";
    assert_eq!(read(&in_xml(compressor, inline, b"")), Ok(expected()));
    for (is_raw, is_zlib) in [(true, false), (false, false), (true, true), (false, true)] {
        let encoded = |bytes: &[u8]| match (is_raw, is_zlib) {
            (true, false) => with_length(bytes),
            (true, true) => zlib(bytes).concat(),
            (false, false) => STANDARD.encode(with_length(bytes)).into_bytes(),
            (false, true) => zlib(bytes).map(|part| STANDARD.encode(part)).concat().into_bytes(),
        };
        let (first, second) = (encoded(&places), encoded(&radii));
        let encoding = if is_raw { "raw" } else { "base64" };
        let appended =
            [format!("<AppendedData encoding=\"{encoding}\">\n _").as_bytes(), &first, &second].concat();
        let appended = [&appended[..], b"\n</AppendedData>\n"].concat();
        let at = format!("format=\"appended\" offset=\"{}\"", first.len());
        let declared = [("format=\"appended\" offset=\"0\"", ""), (at.as_str(), "")];
        let content = in_xml(if is_zlib { compressor } else { "" }, declared, &appended);
        assert_eq!(read(&content), Ok(expected()), "{is_raw} {is_zlib}");
    }
    // Files written by this program give their unit.
    let packing = Packing { cell: Cell::Free, ..expected() };
    let options = ReadOptions { unit: None, cell: Some(CellOption::None) };
    let (back, _) = Packing::parse_as("grains.vtp", packing.to_vtp().as_bytes(), &options).unwrap();
    assert_eq!(back, packing);
}

#[test]
fn what_is_refused_says_why() {
    let legacy = |from: &str, to: &str| LEGACY.replacen(from, to, 1).into_bytes();
    let array = "format=\"ascii\"";
    let xml = |attributes: &str, radii: &str| {
        in_xml(attributes, [(array, "0.5 1 2 1.5 2.5 3.25"), (array, radii)], b"")
    };
    for (content, message) in [
        (legacy("POLYDATA", "STRUCTURED_POINTS"), "f, line 4, dataset: \"STRUCTURED_POINTS\""),
        (legacy("radius", "size"), "f, line 5, arrays of the points: \"size\""),
        (
            legacy("0.375", "-1"),
            "f, line 14, diameter: \"-1\" is not allowed; allowed: a finite number above",
        ),
        (legacy("0.375\n", ""), "expected further numbers"),
        (legacy("0.375", "much"), "f, line 17, number: \"much\""),
        (legacy("2.5", "nan"), "f, line 5, y: \"NaN\""),
        (legacy("POINTS 2", "POINTS 99999999999999999"), "expected 99999999999999999 times 3 numbers"),
        (legacy("POINTS 2 float", "POINTS 2 string"), "f, line 5, type: \"string\""),
        (legacy("ASCII", "TEXT"), "f, line 3, form: \"TEXT\" is not allowed; allowed: ASCII or BINARY"),
        (xml("", "0.5"), "f, line 6, diameter: \"1 numbers\" is not allowed; allowed: 2 numbers"),
        (
            in_xml("", [(array, "0.5 1 2 1.5"), (array, "1 1")], b""),
            "f, line 8, points: \"4 numbers\" is not allowed; allowed: x, y and z of 2 points, as NumberOf",
        ),
        (
            String::from_utf8(xml("", "1 1")).unwrap().replace("</VTKFile>", "").into_bytes(),
            "expected </VTKFile>",
        ),
        (
            String::from_utf8(xml("", "1 1")).unwrap().replace("Points=\"2\"", "Points=\"9\"").into_bytes(),
            "x, y and z of 9 points",
        ),
        (xml("byte_order=\"Middle\"", "1 1"), "f, line 2, byte_order: \"Middle\""),
        (xml("", "0.5 x"), "f, line 6, number: \"x\""),
        (
            xml("compressor=\"vtkLZ4DataCompressor\"", "1 1"),
            "f, line 2, compressor: \"vtkLZ4DataCompressor\"",
        ),
        (b"<VTKFile type=\"PPolyData\">".to_vec(), "of a parallel file give a piece"),
        (in_xml("", [("format=\"binary\"", "AAAA"), (array, "1 1")], b""), "expected all bytes of the array"),
        (
            in_xml("", [("format=\"appended\" offset=\"0\"", ""), (array, "1 1")], b""),
            "expected AppendedData with the numbers",
        ),
        (gzip(&gzip(LEGACY.as_bytes())), "packed twice (gzip)"),
        (gzip(LEGACY.as_bytes())[..40].to_vec(), "f: cannot be read: its gzip is broken"),
    ] {
        let error = read(&content).expect_err(message);
        assert!(error.contains(message), "{error}\n{message}");
    }
}

proptest! {
    /// No bytes cause a panic.
    #[test]
    fn nothing_panics(at in 0usize..600, byte: u8, form in 0usize..3) {
        let zlib = [&PLACES[..], &RADII]
            .map(|values| zlib(&floats(values, false)).map(|part| STANDARD.encode(part)).concat());
        let inline = [("format=\"binary\"", zlib[0].as_str()), ("format=\"binary\"", &zlib[1])];
        let mut content = match form {
            0 => LEGACY.as_bytes().to_vec(),
            1 => LEGACY.replace("ASCII", "BINARY").into_bytes(),
            _ => in_xml("compressor=\"vtkZLibDataCompressor\"", inline, b""),
        };
        let at = at % content.len();
        content[at] = byte;
        let _ = read(&content);
        let _ = read(&content[..at]);
    }
}
