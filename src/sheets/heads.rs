//! Openings within the headings of percents, as tables of results have them: `P#200`, `Passing 19 mm`.

use super::content::is_words;
use super::heading::{Retained, Role, role, says_finer, says_sample, words};
use super::size::{Opening, opening};

/// Words before or behind an opening that mean finer.
const FINER: [&str; 17] = [
    "p",
    "pass",
    "passing",
    "passed",
    "percent",
    "percentage",
    "pct",
    "perc",
    "finer",
    "smaller",
    "than",
    "through",
    "minus",
    "cum",
    "cumul",
    "cumulative",
    "undersize",
];
/// Words that mean retained.
const RETAINED: [&str; 6] = ["ret", "retained", "coarser", "plus", "oversize", "cr"];
/// Words between those and the opening.
const BETWEEN: [&str; 8] = ["on", "sieve", "sieves", "size", "the", "by", "mass", "weight"];

/// An opening as the heading of a column.
pub(super) struct Head {
    /// The opening without the words around it.
    pub(super) text: String,
    /// Finer or retained, as the words say; `None` without words.
    pub(super) role: Option<Role>,
}

/// The heading without the words of percents at its edges, and the role that they name.
fn without_words(heading: &str) -> (String, Option<Role>) {
    let small = heading.to_lowercase().replace('_', " ");
    let (mut rest, mut stated, mut retained, mut cumulative) = (small.as_str(), false, false, None);
    let mut take = |word: &str, stated: &mut bool| {
        let is_retained =
            RETAINED.contains(&word) || matches!(role(word), Role::Retained(Retained { percent: true, .. }));
        retained |= is_retained;
        if word.starts_with("cum") {
            cumulative = Some(true);
        }
        let is_word = is_retained || FINER.contains(&word) || says_finer(word);
        *stated |= is_word;
        is_word || *stated && BETWEEN.contains(&word)
    };
    loop {
        let bare = rest.trim_start_matches([' ', '%', '.', ':', '<', '≤', '(', '-']);
        stated |= rest[..rest.len() - bare.len()].contains(['%', '<', '≤', '-']);
        rest = bare;
        if let Some(after) = rest.strip_prefix('+') {
            rest = after;
            take("plus", &mut stated);
            continue;
        }
        let mut word: String = rest.chars().take_while(|c| c.is_alphabetic()).collect();
        if ["pno", "pnr"].contains(&word.as_str()) {
            word.truncate(1);
        }
        if word.is_empty() || !take(&word, &mut stated) {
            break;
        }
        rest = &rest[word.len()..];
    }
    while opening(rest).is_none() {
        let bare = rest.trim_end_matches([' ', '%', '.', ':', ',', '(', ')']);
        stated |= rest[bare.len()..].contains('%');
        rest = bare;
        let from = rest
            .rfind(|c: char| !c.is_alphabetic())
            .map_or(0, |at| at + rest[at..].chars().next().map_or(1, char::len_utf8));
        if from == rest.len() || !take(&rest[from..], &mut stated) {
            break;
        }
        rest = &rest[..from];
    }
    let role = match retained {
        true => Role::Retained(Retained { percent: true, cumulative }),
        false => Role::Finer,
    };
    (rest.trim().to_owned(), stated.then_some(role))
}

fn is_size(text: &str) -> bool {
    match opening(text) {
        Some((Opening::Mm(size) | Opening::Bare(size), _)) => size > 0.0 && size.is_finite(),
        _ => false,
    }
}

/// The opening that a heading names, with or without words of percents around it.
pub(super) fn head(heading: &str) -> Option<Head> {
    if is_size(heading) && !heading.starts_with('+') {
        return Some(Head { text: heading.to_owned(), role: None });
    }
    let (text, role) = without_words(heading);
    (role.is_some() && is_size(&text)).then_some(Head { text, role })
}

/// True if a heading seems to name an opening and does not: `P#4x`.
pub(super) fn is_broken(heading: &str) -> bool {
    let (text, role) = without_words(heading);
    role.is_some() && text.contains(|c: char| c.is_ascii_digit()) && !is_size(&text)
}

/// True if a heading may be an opening with a typing error: `#2OO`, `0..075`, `PO.O75`; not `LL`, `D60`.
pub(super) fn is_misspelt(heading: &str) -> bool {
    let mended = heading.replace(['O', 'o'], "0").replace(['l', 'I'], "1");
    let has_digit = heading.contains(|c: char| c.is_ascii_digit() || c == '#');
    has_digit && (!is_words(heading) || head(&mended).is_some())
}

/// True if a heading says that names lie below it, and is no name itself: `Sample no.`, `Hole`.
pub(super) fn is_of_names(heading: &str) -> bool {
    const BESIDE: [&str; 18] = [
        "no",
        "nr",
        "number",
        "id",
        "ref",
        "reference",
        "type",
        "test",
        "trial",
        "hole",
        "bore",
        "location",
        "station",
        "description",
        "bh",
        "tp",
        "lab",
        "layer",
    ];
    let words = words(heading);
    !words.is_empty() && words.iter().all(|word| says_sample(word) || BESIDE.contains(&word.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn openings_are_found_within_headings_of_percents() {
        for (heading, text) in [
            ("P3/4", "3/4"),
            ("P#4", "#4"),
            ("P 200", "200"),
            ("PNo. 40", "no. 40"),
            ("P-#40", "#40"),
            ("Passing 19 mm", "19 mm"),
            ("% pass #40", "#40"),
            ("%<0.425mm", "0.425mm"),
            ("<0.075 mm", "0.075 mm"),
            ("% finer No. 200", "no. 200"),
            ("Percent passing sieve No. 4", "no. 4"),
            ("pct_finer_0.075mm", "0.075mm"),
            ("Cum 19", "19"),
            ("#200 (%)", "#200"),
            ("19 mm passing", "19 mm"),
            ("3/4 in. % passing", "3/4 in"),
            ("Minus #200", "#200"),
            ("Durchgang 4 mm", "4 mm"),
            ("Passant 80 µm", "80 µm"),
            ("No. 4", "No. 4"),
        ] {
            let head = head(heading).unwrap_or_else(|| panic!("{heading}"));
            assert_eq!(head.text, text, "{heading}");
            assert!(!matches!(head.role, Some(Role::Retained(_))), "{heading}");
        }
        for heading in ["% ret #4", "Rückstand 4 mm", "Cum. % retained on 4.75 mm", "+4.75 mm"] {
            assert!(matches!(head(heading).unwrap().role, Some(Role::Retained(_))), "{heading}");
        }
        for heading in ["LL", "PI (%)", "Sample", "P80 (um)", "D60", "Depth (m)", "Gravel %", "Cu", "P", "%"]
        {
            assert!(head(heading).is_none(), "{heading}");
        }
        assert!(["P#4x", "% pass 3//4", "Passing No. 201"].into_iter().all(is_broken));
        assert!(
            ["#2OO", "0..075", "PO.O75", "#200x", "#lOO", "No. 2OO", "O.O75"].into_iter().all(is_misspelt)
        );
        for other in ["LL", "PI", "Cu", "D60", "Moisture (%)", "P80 (um)", "CaCO3 (%)", "USCS", "LL1"] {
            assert!(!is_misspelt(other), "{other}");
        }
        assert!(!["LL (%)", "P#4", "Depth 2", "D60", "Cu"].into_iter().any(is_broken));
    }
}
