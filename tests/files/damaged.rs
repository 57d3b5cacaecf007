//! A thousand sheets of ten layouts, made from a seed, each with one damaged row: the same curve is read, or the sheet
//! is refused, or a note names what was left out; no number is lost in silence.

use super::sheets::{Cell, Draw, Grid, xlsx};
use voidwalk::sheets::Soil;

const SHEETS_OF_EACH: usize = 10;
const SEED: u64 = 20261128;

/// Sieves: opening (mm), phi, name.
const SIEVES: [(f64, &str); 12] = [
    (37.5, "1 1/2 in"),
    (19.0, "3/4 in"),
    (9.5, "3/8 in"),
    (4.75, "No. 4"),
    (2.36, "No. 8"),
    (1.18, "No. 16"),
    (0.6, "No. 30"),
    (0.425, "No. 40"),
    (0.3, "No. 50"),
    (0.15, "No. 100"),
    (0.075, "No. 200"),
    (0.045, "No. 325"),
];

const LAYOUTS: [&str; 10] = [
    "finer",
    "retained",
    "cumulative",
    "masses",
    "side by side",
    "across",
    "phi",
    "inches",
    "total",
    "workbook",
];

const DAMAGES: [&str; 10] = [
    "separator",
    "dropped",
    "letter",
    "quoted",
    "empty",
    "swapped",
    "twice",
    "decimal sign",
    "thousands",
    "stray",
];

/// A sheet before it is written.
struct Sheet {
    rows: Vec<Vec<String>>,
    /// The rows that may be damaged.
    data: std::ops::Range<usize>,
    separator: char,
    in_workbook: bool,
}

/// Percents finer that fall from 100, in tenths; what stays on each sieve; and what is in the pan.
fn soil(draw: &mut Draw, sieves: usize) -> (Vec<u64>, Vec<u64>) {
    let mut retained: Vec<u64> = (0..=sieves).map(|_| 10 + draw.next() % 90).collect();
    retained[0] = 0;
    let sum: u64 = retained.iter().sum();
    let scaled: Vec<u64> = retained.iter().map(|part| part * 1000 / sum).collect();
    let mut on: Vec<u64> = scaled;
    let rest = 1000 - on.iter().sum::<u64>();
    on[sieves] += rest;
    let finer = (0..sieves).map(|sieve| 1000 - on[..=sieve].iter().sum::<u64>()).collect();
    (finer, on)
}

fn tenths(value: u64) -> String {
    format!("{}.{}", value / 10, value % 10)
}

fn sheet(draw: &mut Draw, layout: &str) -> Sheet {
    let count = 8 + draw.below(3);
    let first = draw.below(SIEVES.len() - count + 1);
    let sieves = &SIEVES[first..first + count];
    let (finer, on) = soil(draw, count);
    let (other, _) = soil(draw, count);
    let cells = |row: &[&str]| -> Vec<String> { row.iter().map(|cell| (*cell).to_owned()).collect() };
    let mm = |sieve: usize| sieves[sieve].0.to_string();
    let grams = |part: u64| format!("{}.{}", part * 23 / 10, part * 23 % 10);
    let sum = |sieve: usize| on[..=sieve].iter().sum::<u64>();
    let mut rows = Vec::new();
    let mut after = Vec::new();
    let mut titles = 1;
    for sieve in 0..count {
        rows.push(match layout {
            "finer" => vec![mm(sieve), tenths(finer[sieve])],
            "retained" => vec![mm(sieve), tenths(on[sieve])],
            "cumulative" => vec![mm(sieve), tenths(sum(sieve))],
            "masses" | "total" => vec![mm(sieve), grams(on[sieve])],
            "side by side" => vec![mm(sieve), tenths(finer[sieve]), tenths(other[sieve])],
            "phi" => vec![(sieve as f64 - 4.0).to_string(), tenths(finer[sieve])],
            "inches" => vec![sieves[sieve].1.to_owned(), tenths(finer[sieve])],
            "workbook" => vec![mm(sieve), grams(on[sieve]), tenths(on[sieve]), tenths(finer[sieve])],
            _ => Vec::new(),
        });
    }
    let head = match layout {
        "finer" => cells(&["Sieve (mm)", "% passing"]),
        "retained" => cells(&["Sieve (mm)", "% retained on each sieve"]),
        "cumulative" => cells(&["Sieve (mm)", "Cumulative % retained"]),
        "masses" | "total" => cells(&["Sieve (mm)", "Mass retained (g)"]),
        "side by side" => cells(&["Sieve (mm)", "Core", "Shell"]),
        "phi" => cells(&["Size (phi)", "% finer"]),
        "inches" => cells(&["Sieve", "% passing"]),
        "workbook" => cells(&["Sieve (mm)", "Mass retained (g)", "% retained", "% passing"]),
        _ => Vec::new(),
    };
    match layout {
        "masses" => rows.push(vec!["Pan".into(), grams(on[count])]),
        "total" => {
            rows.push(vec!["Pan".into(), grams(on[count])]);
            rows.push(vec!["Total".into(), grams(1000)]);
        }
        "workbook" => {
            titles = 3;
            after = vec![
                cells(&["Dry mass (g)", &grams(1000)]),
                cells(&["D10 (mm)", "0.1"]),
                cells(&["Cu", "5"]),
            ];
            rows.push(vec!["Pan".into(), grams(on[count]), tenths(on[count]), "0".into()]);
        }
        "across" => {
            let turned = |name: &str, value: &dyn Fn(usize) -> String| -> Vec<String> {
                std::iter::once(name.to_owned()).chain((0..count).map(value)).collect()
            };
            rows = vec![
                turned("Sample", &|sieve| format!("{} mm", mm(sieve))),
                turned("TP1", &|sieve| tenths(finer[sieve])),
                turned("TP2", &|sieve| tenths(other[sieve])),
                turned("TP3", &|sieve| tenths(1000 - sieve as u64 * 90)),
            ];
        }
        _ => {}
    }
    let mut all = vec![cells(&["Dam A"]), cells(&["Sample taken by hand"])];
    all.truncate(titles - 1);
    if !head.is_empty() {
        all.push(head);
    }
    let data = all.len()..all.len() + rows.len();
    all.extend(rows);
    all.extend(after);
    let separator = draw.one_of(&[',', ';', '\t']);
    Sheet { rows: all, data, separator, in_workbook: layout == "workbook" }
}

/// Where in the sheet a damage is: its line and its columns, counted from 1.
struct Place {
    line: usize,
}

impl Sheet {
    fn damage(&mut self, draw: &mut Draw, damage: &str) -> Option<Place> {
        let at = self.data.start + draw.below(self.data.len());
        let separator = self.separator;
        let row = &mut self.rows[at];
        let c = draw.below(row.len());
        match damage {
            "separator" => {
                let all = [",", ";", "\t", "   ", "|"];
                let others: Vec<&str> = all.into_iter().filter(|sign| !sign.starts_with(separator)).collect();
                *row = vec![row.join(draw.one_of(&others))];
            }
            "quoted" => *row = vec![format!("\"{}\"", row.join(&separator.to_string()))],
            "dropped" if self.in_workbook => row[c].clear(),
            "dropped" => drop(row.remove(c)),
            "letter" => {
                let place = draw.below(row[c].len() + 1);
                row[c].insert(place, draw.one_of(&['x', 'O', 'l', 'e', 'a']));
            }
            "empty" => {
                let value = 1 + draw.below(row.len() - 1);
                row[value].clear();
            }
            "swapped" => {
                // Exchanged numbers that fit either way are not lost.
                let c = if self.in_workbook { c } else { 0 };
                let other = (c + 1) % row.len();
                row.swap(c, other);
                let size = |row: usize| self.rows.get(row)?[0].parse::<f64>().ok();
                let rises = self.rows[self.data.start][0].starts_with('-');
                let fits = |a: usize, b: usize| size(a).zip(size(b)).is_none_or(|(a, b)| (a < b) == rises);
                if c == 0 && fits(at.wrapping_sub(1), at) && fits(at, at + 1) {
                    return None;
                }
            }
            "twice" => {
                let row = row.clone();
                self.rows.insert(at, row);
            }
            "decimal sign" => {
                let c = (0..row.len()).rev().find(|&c| row[c].contains('.'))?;
                let place = row[c].find('.')? + draw.below(2);
                row[c].insert(place, '.');
            }
            "thousands" => {
                let is_number = |cell: &str| cell.bytes().all(|b| b.is_ascii_digit() || b == b'.');
                let digits = |cell: &str| cell.find('.').unwrap_or(cell.len());
                let c = (0..row.len()).find(|&c| is_number(&row[c]) && digits(&row[c]) > 1)?;
                let whole = digits(&row[c]);
                let place = if whole > 3 { whole - 3 } else { 1 };
                row[c].insert(
                    place,
                    if whole > 3 { draw.one_of(&[',', ' ', '\'']) } else { draw.one_of(&[' ', '\'']) },
                );
            }
            _ => {
                row.extend((0..draw.below(3)).map(|_| String::new()));
                row.push("7.3".into());
            }
        }
        Some(Place { line: at + 1 })
    }

    fn bytes(&self) -> Vec<u8> {
        if self.in_workbook {
            let cell = |text: &String| match (text.is_empty(), text.parse()) {
                (true, _) => None,
                (_, Ok(number)) => Some(Cell::Number(number)),
                _ => Some(Cell::Text(text.trim_matches('"').to_owned())),
            };
            return xlsx(&self.rows.iter().map(|row| row.iter().map(cell).collect()).collect::<Grid>());
        }
        let line = |row: &Vec<String>| row.join(&self.separator.to_string()) + "\n";
        self.rows.iter().map(line).collect::<String>().into_bytes()
    }
}

type Read = Vec<(Vec<(f64, f64)>, Vec<String>)>;

fn read(sheet: &Sheet) -> Result<Read, String> {
    let name = if sheet.in_workbook { "a.xlsx" } else { "a.csv" };
    let soils = Soil::all(name, &sheet.bytes()).map_err(|error| error.to_string())?;
    let soil = |soil: &Soil| {
        let curve = soil.gradation(None).map_err(|error| error.to_string())?;
        Ok((curve.points().iter().map(|point| (point.size, point.percent)).collect(), soil.notes().to_vec()))
    };
    soils.iter().map(soil).collect()
}

fn distinct(mut curves: Vec<Vec<(f64, f64)>>) -> Vec<Vec<(f64, f64)>> {
    curves.dedup();
    curves
}

/// Whether a new note names the line of the damage, or what was left out behind it.
fn is_named(whole: &Read, damaged: &Read, place: &Place) -> bool {
    let old: Vec<&String> = whole.iter().flat_map(|(_, notes)| notes).collect();
    let numbers = |note: &str| -> Vec<usize> {
        note.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse().ok()).collect()
    };
    damaged.iter().flat_map(|(_, notes)| notes).filter(|note| !old.contains(note)).any(|note| {
        let names_line =
            (note.contains("line") || note.contains("row")) && numbers(note).contains(&place.line);
        names_line || note.starts_with("not used: column") || note.ends_with("has no percent: left out")
    })
}

#[test]
fn a_sheet_with_a_damaged_row_loses_no_number_in_silence() {
    let mut draw = Draw(SEED);
    let (mut same, mut refused, mut named, mut wrong) = (0, 0, 0, String::new());
    for layout in LAYOUTS {
        for damage in DAMAGES {
            let mut made = 0;
            while made < SHEETS_OF_EACH {
                let mut sheet = sheet(&mut draw, layout);
                let whole = read(&sheet);
                let Ok(whole) = whole else { panic!("{layout}: {whole:?} {:?}", sheet.rows) };
                made += 1;
                let Some(place) = sheet.damage(&mut draw, damage) else {
                    same += 1;
                    continue;
                };
                let curves = |read: &Read| read.iter().map(|(curve, _)| curve.clone()).collect::<Vec<_>>();
                match read(&sheet) {
                    Err(_) => refused += 1,
                    Ok(damaged) if curves(&damaged) == curves(&whole) => same += 1,
                    // A soil of a table on its side may stand in it twice.
                    Ok(damaged) if damage == "twice" && curves(&whole) == distinct(curves(&damaged)) => {
                        same += 1
                    }
                    Ok(damaged) if is_named(&whole, &damaged, &place) => named += 1,
                    Ok(damaged) => {
                        let row = &sheet.rows[place.line - 1];
                        wrong += &format!(
                            "{layout}, {damage}, line {}: {row:?}\n{:?}\n{damaged:?}\n\n",
                            place.line, sheet.rows
                        );
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{wrong}", wrong.matches("\n\n").count());
    assert!(
        same + refused + named == 1000 && refused > 700,
        "{same} the same, {refused} refused, {named} named"
    );
}
