//! Notes on a file of grains, and doubts that its grains are a packing.

use voidwalk_core::constrictions::Doubt;
use voidwalk_core::packing::ReadingNote;

/// Note on how a file of grains was read.
pub fn reading(note: &ReadingNote, file: &str) -> String {
    match note {
        ReadingNote::Frame { frames, lacking, time: (name, time) } => {
            let with = lacking.map_or(String::new(), |lacking| format!(" with {lacking}"));
            format!("holds {frames} frames: the last one{with}, {name} {time}, is taken")
        }
        ReadingNote::Array { name, unit } => {
            let unit = unit.words();
            format!("{file}: the array {name} is in {unit}, and the coordinates are taken to be too")
        }
        ReadingNote::Unit(unit) => format!("lengths are in {}, converted to mm", unit.words()),
    }
}

/// Doubt that grains are a packing.
pub fn doubt(doubt: &Doubt) -> String {
    match *doubt {
        Doubt::Loose { void_ratio, most, is_periodic } => {
            let loose = match is_periodic {
                true => "the cell may be too large, or in another unit than the grains",
                false => "they may not touch, or diameters may be in another unit than centres",
            };
            format!(
                "the void ratio is {void_ratio:.4}, and grains that rest on each other hardly leave more \
                 than {most}: {loose}"
            )
        }
        Doubt::Dense { void_ratio, least, is_periodic } => {
            let other = if is_periodic { "the cell" } else { "their centres" };
            format!(
                "the void ratio is {void_ratio:.4}, and grains that rest on each other hardly leave less \
                 than {least}: they overlap, or diameters are in another unit than {other}"
            )
        }
        Doubt::Near(pairs, [one, other]) => format!(
            "{pairs} pairs of grains lie nearer than a quarter of the smaller diameter, the first of them \
             grains {one} and {other} (counted from 0): they may be one grain given twice"
        ),
        Doubt::Hidden(grains, first) => format!(
            "{grains} grains lie inside others and take no part, the first of them grain {first} (counted \
             from 0)"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voidwalk_core::packing::LengthUnit;

    #[test]
    fn notes_on_a_file_of_grains() {
        let (frames, time) = (2, ("timestep", "0".into()));
        for (note, words) in [
            (
                ReadingNote::Frame { frames, lacking: Some("atoms"), time },
                "holds 2 frames: the last one with atoms, timestep 0, is taken",
            ),
            (ReadingNote::Unit(LengthUnit::Um), "lengths are in micrometres, converted to mm"),
            (
                ReadingNote::Array { name: "r_mm".into(), unit: LengthUnit::Mm },
                "f: the array r_mm is in millimetres, and the coordinates are taken to be too",
            ),
        ] {
            assert_eq!(reading(&note, "f"), words);
        }
        let loose = |is_periodic| Doubt::Loose { void_ratio: 3.0, most: 2.0, is_periodic };
        let dense = |is_periodic| Doubt::Dense { void_ratio: 0.1, least: 0.2, is_periodic };
        for (note, words) in [
            (loose(true), "leave more than 2: the cell may be too large, or in another unit than the grains"),
            (loose(false), "3.0000, and grains that rest on each other hardly leave more than 2: they may"),
            (
                dense(true),
                "leave less than 0.2: they overlap, or diameters are in another unit than the cell",
            ),
            (dense(false), "0.1000, and grains that rest on each other hardly leave less than 0.2: they"),
            (Doubt::Near(5, [1, 2]), "5 pairs of grains lie nearer than a quarter of the smaller diameter"),
            (Doubt::Hidden(4, 3), "4 grains lie inside others and take no part, the first of them grain 3"),
        ] {
            assert!(doubt(&note).contains(words), "{}", doubt(&note));
        }
    }
}
