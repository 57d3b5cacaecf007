//! Guesses the nature of a text that is not a settings file, or of a name that does not exist, and
//! suggests a correction.

use super::length;
use strsim::damerau_levenshtein;
use toml::de::DeTable;

/// First bytes of workbooks: .xlsx and .ods are zip files, .xls is older.
const WORKBOOKS: [&[u8]; 2] = [b"PK\x03\x04", b"\xd0\xcf\x11\xe0"];

/// Sections and keys found only in the plan of a campaign.
const OF_A_PLAN: [&str; 6] = ["factor", "case", "leave_out", "seeds", "title", "set"];

/// A unit, and its size in another unit as a numerator and a denominator.
type Unit = (&'static str, [f64; 2]);

/// Units at the end of a setting's name, and the sizes of other units in each.
const UNITS: [(&str, &[Unit]); 4] = [
    ("mm", &length::UNITS),
    ("kPa", &[("kPa", [1.0, 1.0]), ("Pa", [1.0, 1e3]), ("MPa", [1e3, 1.0]), ("GPa", [1e6, 1.0])]),
    ("GPa", &[("GPa", [1.0, 1.0]), ("Pa", [1.0, 1e9]), ("kPa", [1.0, 1e6]), ("MPa", [1.0, 1e3])]),
    ("kg/m3", &[("kg/m3", [1.0, 1.0])]),
];

/// Settings that are percentages.
const PERCENTAGES: [&str; 2] = ["d85_at_dc", "coarsest"];

/// Settings that are fractions, besides those whose names end in `_fraction`.
const FRACTIONS: [&str; 5] = ["mass_ratio", "inject_share", "estimate", "rho", "concentration"];

/// Decodes bytes as text without a byte order mark.
///
/// # Errors
/// A description of the bytes.
pub fn as_text(bytes: &[u8]) -> Result<&str, String> {
    if WORKBOOKS.iter().any(|begin| bytes.starts_with(begin)) {
        return Err("is a workbook, not TOML text; two of its soils are judged by `voidwalk judge \
                    \"FILE#BASE\" \"FILE#FILTER\"`, and `voidwalk soil FILE` shows them"
            .into());
    }
    let utf_16 = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    let zeros = bytes.iter().take(64).filter(|byte| **byte == 0).count();
    if utf_16 || (zeros > 0 && 3 * zeros >= bytes.len().min(64)) {
        return Err("is UTF-16 text, as some editors save it; save it as UTF-8".into());
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
        format!("is not UTF-8 text (line {line}); save it as UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Describes the error in a line that is not TOML, if it is a usual mistake; `line` counts from 1.
pub fn of_line(text: &str, line: usize) -> Option<String> {
    let (key, value) = text.lines().nth(line.checked_sub(1)?)?.split_once('=')?;
    let (key, value) = (key.trim(), value.split('#').next().unwrap_or_default().trim());
    if let Some((whole, part)) = decimal_comma(value) {
        return Some(format!("`{value}` has a decimal comma; write {key} = {whole}.{part}"));
    }
    if value.contains('\\') {
        let path = value.trim_matches(['"', '\'']).replace("\\\\", "/").replace('\\', "/");
        return Some(format!(
            "`{value}` looks like a path with backslashes; write {key} = \"{path}\", or the path as it is \
             between single quotes"
        ));
    }
    if let Some(hint) = of_value(key, value) {
        return Some(format!("`{value}`: {hint}"));
    }
    let is_bare = value.starts_with(|c: char| c.is_alphabetic() || "./~".contains(c))
        && !value.contains(['"', '\'', ',', '=', '[', '{'])
        && !["true", "false"].contains(&value);
    is_bare.then(|| {
        format!("`{value}` is not a number: a name or a word needs quotes; write {key} = \"{value}\"")
    })
}

/// Describes the error in a value of the setting `name` that should be a number, if it is a usual
/// mistake. A corrected number is suggested only if the setting's unit is certain.
pub(crate) fn of_value(name: &str, value: &str) -> Option<String> {
    let number = value.trim();
    if let Some((whole, part)) = decimal_comma(number) {
        return Some(format!("a decimal point, not a comma: {whole}.{part}"));
    }
    let end = number.find(|c: char| !c.is_ascii_digit() && !".+-".contains(c))?;
    let (digits, unit) = (number[..end].trim(), number[end..].trim());
    // A number that is not above 0 is wrong in any unit.
    let given = digits.parse().ok().filter(|given: &f64| *given > 0.0)?;
    // A name may be written with its section.
    let name = parts(name).1.trim();
    let is_unit = UNITS.iter().any(|(_, units)| units.iter().any(|(other, _)| *other == unit));
    if !is_unit && !["%", "layers"].contains(&unit) {
        return None;
    }
    let alone = || Some(format!("the number alone, without its unit: {digits}"));
    let ending = |unit: &str| format!("_{}", unit.to_lowercase().replace('/', "_"));
    let is_in = |unit: &str| name.to_lowercase().ends_with(&ending(unit));
    if let Some((setting_unit, units)) = UNITS.iter().find(|(setting_unit, _)| is_in(setting_unit)) {
        return match units.iter().find(|(other, _)| *other == unit) {
            Some((other, _)) if other == setting_unit => alone(),
            Some((_, [above, below])) => {
                Some(format!("in {setting_unit}, without the unit: {}", rounded(given * above / below)))
            }
            None => Some(format!("in {setting_unit}, not in {unit}")),
        };
    }
    match unit {
        "%" if PERCENTAGES.contains(&name) => alone(),
        "%" if FRACTIONS.contains(&name) || name.ends_with("_fraction") => {
            Some(format!("as a fraction, without the unit: {}", rounded(given / 100.0)))
        }
        "layers" if name == "nz" => alone(),
        _ => Some("a number that has no unit".into()),
    }
}

/// Drops the last digits, which a conversion may get wrong.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Splits a number at its decimal comma.
fn decimal_comma(number: &str) -> Option<(&str, &str)> {
    let is_digits = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    number
        .split_once(',')
        .filter(|(whole, part)| is_digits(whole.trim_start_matches(['+', '-'])) && is_digits(part))
}

/// Tells if a text that is not TOML is a table of numbers.
pub fn is_table(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let fields = |line: &str| line.split([',', ';', '\t']).filter(|field| !field.is_empty()).count();
    let is_row = |line: &str| fields(line) >= 2 && line.starts_with(|c: char| c.is_ascii_digit() || c == '"');
    lines.clone().all(|line| !line.contains('=')) && lines.any(is_row)
}

/// Tells if a table is the plan of a campaign.
pub fn is_plan(table: &DeTable) -> bool {
    table.keys().any(|key| OF_A_PLAN.contains(&&**key.get_ref()))
}

/// Maximum number of settings in a list.
const NAMED: usize = 30;

/// Suggests `did you mean ...` if a known name resembles `name`; else lists the names in its section.
pub(super) fn instead_of(name: &str, known: &[String]) -> String {
    let sections = known.iter().map(|known| parts(known).0).filter(|section| !section.is_empty());
    let mut sections: Vec<&str> = sections.collect();
    sections.dedup();
    // A section by itself, as `[filtre]`.
    if !name.contains('.')
        && let Some(section) = sections.iter().find(|section| is_like(section, name))
        && !known.iter().any(|known| is_like(known, name))
    {
        return format!("did you mean [{section}]?");
    }
    let (section, last) = parts(name);
    let distance = |known: &&String| {
        let whole = damerau_levenshtein(known, name);
        (whole.min(damerau_levenshtein(parts(known).1, last) + 1), whole)
    };
    let nearest = known.iter().min_by_key(distance);
    let nearest = nearest.filter(|known| is_like(known, name) || is_like(parts(known).1, last));
    let begins = || known.iter().find(|known| name.len() > 2 && known.starts_with(name));
    if let Some(nearest) = nearest.or_else(begins) {
        return format!("did you mean `{nearest}`?");
    }
    let listed = |section: &str| {
        let names = known.iter().map(|known| parts(known)).filter(|(other, _)| *other == section);
        let names: Vec<&str> = names.map(|(_, name)| name).collect();
        let more = if names.len() > NAMED { ", ..." } else { "" };
        format!("{}{more}", names[..names.len().min(NAMED)].join(", "))
    };
    if sections.contains(&section) {
        return format!("[{section}] has {}", listed(section));
    }
    let sections: Vec<String> = sections.iter().map(|section| format!("[{section}]")).collect();
    format!("there are {}; and {} without a section", sections.join(", "), listed(""))
}

/// Splits the full name of a setting into its section, empty if it has none, and its name there.
fn parts(name: &str) -> (&str, &str) {
    name.rsplit_once('.').unwrap_or(("", name))
}

/// Tells if two names differ by few letters, relative to their length.
fn is_like(known: &str, name: &str) -> bool {
    damerau_levenshtein(known, name) <= (name.chars().count() / 3).clamp(1, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_mistakes_are_known() {
        let hint = |line: &str| of_line(&format!("seed = 1\n{line}\n"), 2);
        assert_eq!(hint("cu = 1,5 # wide").unwrap(), "`1,5` has a decimal comma; write cu = 1.5");
        assert_eq!(hint("cu = -1,5").unwrap(), "`-1,5` has a decimal comma; write cu = -1.5");
        for line in ["sieve = \"csv\\sand.csv\"", "sieve = csv\\sand.csv"] {
            assert!(hint(line).unwrap().contains("write sieve = \"csv/sand.csv\""), "{line}");
        }
        assert_eq!(
            hint("sieve = sand.csv").unwrap(),
            "`sand.csv` is not a number: a name or a word needs quotes; write sieve = \"sand.csv\""
        );
        assert!(hint("d0_mm = 0.5 mm").unwrap().contains("without its unit: 0.5"));
        for line in ["cu = ", "cu = 1,5,6", "cu = a,b", "[filter", "cu", "cu = \"a", "cu = 1e"] {
            assert_eq!(hint(line), None, "{line}");
        }
        assert_eq!(of_line("", 0), None);
    }

    #[test]
    fn numbers_with_a_comma_or_a_unit_are_known() {
        let texts = ["3,5", "500mm", "0.5 mm", "500 mm", "1e3", "abc", "7", "12 weeks", ""]
            .map(|text| of_value("network.thickness_mm", text));
        let hints: Vec<Option<&str>> = texts.iter().map(|text| text.as_deref().map(|t| &t[..18])).collect();
        let [comma, unit] = [Some("a decimal point, n"), Some("the number alone, ")];
        assert_eq!(hints, [comma, unit, unit, unit, None, None, None, None, None]);
    }

    #[test]
    fn a_number_is_named_in_the_unit_of_its_setting() {
        for (name, value, hint) in [
            ("base.d85_mm", "75um", "in mm, without the unit: 0.075"),
            ("base.d85_mm", "75 μm", "in mm, without the unit: 0.075"),
            ("filter.thickness_mm", "0.3m", "in mm, without the unit: 300"),
            ("thickness_mm", "1.1 cm", "in mm, without the unit: 11"),
            ("thickness_mm", "3in", "in mm, without the unit: 76.2"),
            ("thickness_mm", "5%", "in mm, not in %"),
            ("base.mass_ratio", "5%", "as a fraction, without the unit: 0.05"),
            ("walk.concentration", "2%", "as a fraction, without the unit: 0.02"),
            ("packing.start_fraction", "35%", "as a fraction, without the unit: 0.35"),
            ("base.d85_at_dc", "5%", "the number alone, without its unit: 5"),
            ("base.d85_at_dc", "5mm", "a number that has no unit"),
            ("network.nz", "60 layers", "the number alone, without its unit: 60"),
            ("filter.cu", "3%", "a number that has no unit"),
            ("packing.shear_modulus_gpa", "27GPa", "the number alone, without its unit: 27"),
            ("packing.pressure_kpa", "0.1MPa", "in kPa, without the unit: 100"),
            ("packing.density_kg_m3", "2670kg/m3", "the number alone, without its unit: 2670"),
        ] {
            assert_eq!(of_value(name, value).as_deref(), Some(hint), "{name} = {value}");
        }
    }

    #[test]
    fn texts_are_told_apart() {
        assert!(as_text(b"PK\x03\x04 and more").unwrap_err().starts_with("is a workbook"));
        let utf_16: Vec<u8> = "seed = 1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(as_text(&utf_16).unwrap_err().contains("UTF-16"));
        assert!(as_text(&[&[0xff, 0xfe], &utf_16[..]].concat()).unwrap_err().contains("UTF-16"));
        assert_eq!(
            as_text(b"a = 1\nb = \"\xe4\"").unwrap_err(),
            "is not UTF-8 text (line 2); save it as UTF-8"
        );
        assert_eq!(as_text("\u{feff}a".as_bytes()), Ok("a"));
        assert!(is_table("# sand\nopening_mm,percent\n2,100\n") && is_table("2;100\n1;50\n"));
        assert!(!is_table("seed = 1\n") && !is_table("") && !is_table("some words, and more\n"));
    }

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
