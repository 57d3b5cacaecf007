//! Guesses the name that a user meant by one that does not exist.

use strsim::damerau_levenshtein;

/// Largest number of settings in a list.
const NAMED: usize = 30;

/// `did you mean ...` if a known name resembles `name`; else the names in its section.
pub fn instead_of(name: &str, known: &[String]) -> String {
    let sections = sections(known);
    // A section by itself, as `[filtre]`.
    if !name.contains('.')
        && let Some(section) = sections.iter().find(|section| is_like(section, name))
        && !known.iter().any(|known| is_like(known, name))
    {
        return format!("did you mean [{section}]?");
    }
    let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
    let distance = |known: &&String| {
        let whole = damerau_levenshtein(known, name);
        (whole.min(damerau_levenshtein(&last(known), &last(name)) + 1), whole)
    };
    let nearest = known.iter().min_by_key(distance);
    let nearest = nearest.filter(|known| is_like(known, name) || is_like(&last(known), &last(name)));
    let begins = || known.iter().find(|known| name.len() > 2 && known.starts_with(name));
    if let Some(nearest) = nearest.or_else(begins) {
        return format!("did you mean `{nearest}`?");
    }
    let section = name.rsplit_once('.').map_or("", |(section, _)| section);
    let of_section: Vec<&str> = known.iter().filter_map(|known| in_section(known, section)).collect();
    if !section.is_empty() && !of_section.is_empty() {
        return format!("[{section}] has {}", listed(&of_section));
    }
    let top: Vec<&str> = known.iter().filter_map(|known| in_section(known, "")).collect();
    let sections: Vec<String> = sections.iter().map(|section| format!("[{section}]")).collect();
    format!("there are {}; and {} without a section", sections.join(", "), listed(&top))
}

/// Tells if few letters differ, for the length of the name.
fn is_like(known: &str, name: &str) -> bool {
    damerau_levenshtein(known, name) <= (name.chars().count() / 3).clamp(1, 3)
}

fn sections(known: &[String]) -> Vec<&str> {
    let mut sections: Vec<&str> = known.iter().filter_map(|name| Some(name.split_once('.')?.0)).collect();
    sections.dedup();
    sections
}

/// Name inside a section, if it is in that section.
fn in_section<'a>(name: &'a str, section: &str) -> Option<&'a str> {
    match name.rsplit_once('.') {
        Some((its_section, name)) => (its_section == section).then_some(name),
        None => section.is_empty().then_some(name),
    }
}

fn listed(names: &[&str]) -> String {
    let more = if names.len() > NAMED { ", ..." } else { "" };
    format!("{}{more}", names[..names.len().min(NAMED)].join(", "))
}

#[cfg(test)]
mod tests {
    use super::instead_of;

    #[test]
    fn a_name_that_is_like_none_gets_those_of_its_section() {
        let known =
            ["seed", "runs", "filter.cu", "filter.sieve", "base.cu", "base.d85_mm", "stop.decide_percent"];
        let known = known.map(String::from);
        for (name, wanted) in [
            ("sed", "did you mean `seed`?"),
            ("filtre", "did you mean [filter]?"),
            ("filter.seive", "did you mean `filter.sieve`?"),
            ("bas.cu", "did you mean `base.cu`?"),
            ("base.d85", "did you mean `base.d85_mm`?"),
            ("base.sieve", "did you mean `filter.sieve`?"),
            ("stop.bias", "[stop] has decide_percent"),
            ("walk.bias", "there are [filter], [base], [stop]; and seed, runs without a section"),
            ("temperature", "there are [filter], [base], [stop]; and seed, runs without a section"),
        ] {
            assert_eq!(instead_of(name, &known), wanted, "{name}");
        }
    }
}
