//! Meaning of a column's heading.

use super::languages::{
    CUMULATED, FINER, INCH, INDIVIDUAL, MASS, MICROMETRE, MILLIMETRE, RETAINED, SIZE, Words,
};
use super::size::Unit;

/// Content of a column, according to its heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Size,
    /// Percent (or fraction) finer.
    Finer,
    Retained(Retained),
    Other,
}

/// Form in which retained values are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Retained {
    /// True for percents, which total 100; false for masses.
    pub(super) percent: bool,
    /// True for values on this sieve and all coarser ones, false for values on this one only; `None` if
    /// the heading does not say.
    pub(super) cumulative: Option<bool>,
}

impl Role {
    /// True for the role of percents or masses.
    pub(super) fn has_values(self) -> bool {
        matches!(self, Role::Finer | Role::Retained(_))
    }
}

/// Words of a column's name, in small letters.
pub(super) fn words(name: &str) -> Vec<String> {
    name.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).map(str::to_lowercase).collect()
}

fn any(words: &[String], list: &[&str]) -> bool {
    words.iter().any(|word| list.contains(&word.as_str()))
}

/// True if a heading says cumulative. `of total`, `total mass`, `total sample` only name the whole to
/// which the percents refer.
fn is_cumulative(words: &[String]) -> bool {
    static CUMULATIVE: Words = Words::of("cumulative|cum|cumul|accumulated|total|coarser|cumulated");
    static OF: Words = Words::of("of|the|du|del|do|von|vom|der");
    static WHOLE: Words = Words::of("mass|weight|wt|dry|sample|soil|specimen|aggregate|masse|peso");
    words.iter().enumerate().any(|(at, word)| {
        let of_whole = || at > 0 && OF.has(&words[at - 1]) || words.get(at + 1).is_some_and(|w| WHOLE.has(w));
        CUMULATIVE.has(word) && !(word == "total" && of_whole())
    })
}

/// `D10`, `D 85 (mm)`: a size read off a curve, not a column of openings.
fn is_characteristic(words: &[String]) -> bool {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    match words {
        [first, ..] if first.strip_prefix('d').is_some_and(is_number) => true,
        [first, second, ..] => first == "d" && is_number(second),
        _ => false,
    }
}

/// Words of a heading without the letter of a sample's name.
fn words_of_column(name: &str) -> Vec<String> {
    let mut words = words(name);
    for letter in ["d", "g"] {
        if is_letter_of_sample(name, &words, letter) {
            words.retain(|word| word != letter);
        }
    }
    words
}

/// `Sample D`, `Zone G (%)`: a letter after a name, which means neither diameters nor grams.
fn is_letter_of_sample(name: &str, words: &[String], letter: &str) -> bool {
    let is_bracketed = ['(', '['].iter().any(|sign| name.to_lowercase().contains(&format!("{sign}{letter}")));
    let others = || words.iter().filter(|word| *word != letter);
    let is_alone = others().next().is_none() || words[0] == letter && is_length(name);
    let is_weighed = others().any(|word| MASS.has(word)) || RETAINED.any(words) || name.contains(", g");
    !(is_bracketed || is_alone || letter == "g" && is_weighed)
}

fn is_length(name: &str) -> bool {
    matches!(unit(name), Ok(Some(Unit::Mm | Unit::Micrometre | Unit::Cm | Unit::Inch)))
}

/// True if a text says that a table continues below the finest sieve, with a hydrometer or another
/// sedimentation test.
pub(super) fn says_sedimentation(text: &str) -> bool {
    static TESTS: Words =
        Words::of("hydrom*|sediment*|sédiment*|areom*|aräom*|aréom*|schlämm*|schlaemm*|densim*|pipette*");
    TESTS.any(&words(text))
}

pub(super) fn says_mean(name: &str) -> bool {
    static MEAN: Words =
        Words::of("average|avg|ave|mean|mittel|mittelwert|moyenne|media|promedio|média|gemiddelde|średnia");
    MEAN.any(&words(name))
}

pub(super) fn says_limit(name: &str) -> bool {
    static LIMIT: Words =
        Words::of("min|max|minimum|maximum|limit|limits|mínimo|máximo|untergrenze|obergrenze");
    LIMIT.any(&words(name))
}

/// `Sample no.`, `Borehole:`: words that precede the name of a soil.
pub(super) fn says_sample(text: &str) -> bool {
    static SAMPLE: Words = Words::of(
        "sample|samples|specimen|soil|material|probe|borehole|boring|bohrung|name|échantillon|\
         echantillon|muestra|pit|source",
    );
    SAMPLE.any(&words(text))
}

/// True if the heading of percents says that they refer to the fines only.
pub(super) fn says_of_fines(text: &str) -> bool {
    let small = text.to_lowercase();
    let of_part =
        ["minus", "of fines", "of the fines", "partial", "< 0", "<0", "of passing", "of the passing"];
    of_part.iter().any(|part| small.contains(part)) || small.contains("200") && !small.contains("2000")
}

/// True if a heading says that its percents are finer, and restricts them neither to the whole nor to
/// cumulative ones.
pub(super) fn says_finer(name: &str) -> bool {
    const VAGUE: [&str; 6] = ["percent", "pct", "percentage", "cumulative", "massenanteil", "perp"];
    words(name).iter().any(|word| FINER.has(word) && !VAGUE.contains(&word.as_str()))
}

/// True if a heading says that percents finer or retained are cumulative.
pub(super) fn says_cumulative(name: &str) -> bool {
    CUMULATED.any(&words(name))
}

/// True for the heading of a weighing that still includes the sieve or its tare.
pub(super) fn is_weighing(name: &str) -> bool {
    static TARE: Words =
        Words::of("tare|gross|empty|tara|brutto|bruto|container|dish|leer|leeres|vide|vacío|vacio|vuoto");
    static AND: Words = Words::of("and|with|plus|und|mit|et|avec|y|con|com");
    static SOIL: Words =
        Words::of("soil|sample|material|boden|probe|sol|échantillon|suelo|muestra|solo|retained");
    let words = words_of_column(name);
    let has_unit = !matches!(unit(name), Ok(None | Some(Unit::SieveNumber)) | Err(()));
    let size = SIZE.any(&words);
    let both = name.contains(['+', '&']) || AND.any(&words);
    MASS.any(&words)
        && !has_unit
        && (TARE.any(&words) || both && size && SOIL.any(&words) || size && !RETAINED.any(&words))
}

pub(super) fn role(name: &str) -> Role {
    let words = words_of_column(name);
    if is_characteristic(&words) || is_weighing(name) {
        return Role::Other;
    }
    // `Core with 5% lime` is a name.
    let is_sign = |(at, _): (usize, &str)| !name[..at].trim_end().ends_with(|c: char| c.is_ascii_digit());
    let percent =
        name.match_indices('%').any(is_sign) || any(&words, &["percent", "pct", "percentage", "prozent"]);
    let (mass, size) = (MASS.any(&words), SIZE.any(&words));
    let cumulative = if is_cumulative(&words) { Some(true) } else { INDIVIDUAL.any(&words).then_some(false) };
    let has_digit = name.contains(|c: char| c.is_ascii_digit());
    let bounds = ["passing", "pass", "passed", "retained", "oversize", "undersize"];
    if is_length(name) && any(&words, &bounds) && !percent && !mass && !has_digit {
        // `Passing (mm)`, `Retained on (mm)`: bounds of a class.
        return Role::Size;
    }
    // `Ref. cum. (%)`, but not `Sample ref.`.
    let is_short = any(&words, &["ref"]) && (percent || mass);
    if RETAINED.any(&words) || is_short {
        return Role::Retained(Retained { percent: percent || !mass, cumulative });
    }
    if percent || FINER.any(&words) || any(&words, &["fraction", "ratio"]) && !size {
        return Role::Finer;
    }
    match (size, mass) {
        (true, _) => Role::Size,
        // `mass` alone may mean the mass that passes; grams are weighed on the sieves.
        (false, true) if any(&words, &["g", "gram", "grams", "kg", "grammes"]) => {
            Role::Retained(Retained { percent: false, cumulative })
        }
        _ => Role::Other,
    }
}

/// Returns the unit named by the heading of a column of openings; an error for an unknown unit.
pub(super) fn unit(name: &str) -> Result<Option<Unit>, ()> {
    // `SizeUm`
    let mut parted = String::new();
    for c in name.chars() {
        if c.is_uppercase() && parted.ends_with(char::is_lowercase) {
            parted.push(' ');
        }
        parted.push(c);
    }
    let words = [words(name), words(&parted)].concat();
    let last_is_in = words.last().is_some_and(|word| word == "in") || name.contains("(in");
    Ok(Some(if is_micrometres(name, &words) {
        Unit::Micrometre
    } else if MILLIMETRE.any(&words) {
        Unit::Mm
    } else if INCH.any(&words) || last_is_in || name.contains('"') {
        Unit::Inch
    } else if any(&words, &["phi", "φ", "ϕ", "krumbein"]) {
        Unit::Phi
    } else if any(&words, &["cm"]) {
        Unit::Cm
    } else if any(&words, &["m", "nm", "ø"]) {
        // `Ø` means both phi and a diameter.
        return Err(());
    } else if any(&words, &["no", "number", "nr", "mesh"]) || name.contains('#') {
        Unit::SieveNumber
    } else if is_unknown(name) {
        return Err(());
    } else {
        return Ok(None);
    }))
}

/// True if a name or its words mean micrometres rather than mm.
fn is_micrometres(name: &str, words: &[String]) -> bool {
    const PARTS: [&str; 8] =
        ["微米", "㎛", "1/1000 mm", "1/1000mm", "10^-3 mm", "10-3 mm", "10⁻³ mm", "0.001 mm"];
    PARTS.iter().any(|part| name.contains(part)) || !MILLIMETRE.any(words) && MICROMETRE.any(words)
}

/// True if a heading of openings ends with a word in brackets that names neither a unit nor sieves.
fn is_unknown(name: &str) -> bool {
    static OTHER: Words = Words::of("us|uss|astm|aashto|iso|din|en|standard|nominal|square|round|x|a|b");
    let Some((_, bracketed)) = name.rsplit_once(['(', '[']) else { return false };
    let (all, bracketed) = (words(name), words(bracketed));
    let [word] = &bracketed[..] else { return false };
    SIZE.any(&all) && word.chars().all(char::is_alphabetic) && !SIZE.has(word) && !OTHER.has(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_told_apart() {
        let retained = |percent, cumulative| Role::Retained(Retained { percent, cumulative });
        for (expected, names) in [
            (Role::Size, "opening_mm|Sieve No.|D (µm)|Retained on (mm)|Passing, mm|D (mm)|D, mm|D"),
            (Role::Finer, "% passing|percent finer by mass|Durchgang|Fraction finer|Passing, %|Filter D (%)"),
            (retained(false, None), "Mass retained (g)|Mass (g)|Soil D (g)|Weight g"),
            (retained(false, Some(false)), "Retained on each sieve, g|Individual, g"),
            (retained(false, Some(true)), "Cum. mass retained"),
            (retained(true, None), "% retained|Retained, % of total|% of the total sample retained"),
            (
                retained(true, Some(true)),
                "Cumulative % retained|Total % retained|Cumulative % of total retained|percent coarser",
            ),
            (Role::Other, "Filter A|D10 (mm)|D 60, mm|Mass of sieve (g)|Sample D|Zone G"),
        ] {
            for name in names.split('|') {
                assert_eq!(role(name), expected, "{name}");
            }
        }
        assert_eq!(unit("opening_mm"), Ok(Some(Unit::Mm)));
        assert_eq!(unit("opening (inch)"), Ok(Some(Unit::Inch)));
        assert_eq!(unit("Opening in mm"), Ok(Some(Unit::Mm)));
        assert_eq!(unit("Sieve No."), Ok(Some(Unit::SieveNumber)));
        assert_eq!(unit("size"), Ok(None));
        assert_eq!(unit("size, m"), Err(()));
    }
}
