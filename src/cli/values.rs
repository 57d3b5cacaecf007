//! Values of options, as a user writes them, with what to write instead where they are not understood.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::schemas::schema;
use crate::constrictions::Facets;
use crate::run::RunError;
use crate::scene::{Density, SheetUnits};
use crate::schema::length::{LENGTHS, millimetres};
use crate::store::format::FORMATS;

/// A setting and its value.
pub(super) fn assignment(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((name, _)) if !name.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("write KEY=VALUE, as --set filter.cu=3".into()),
    }
}

/// How densely a filter lies. A number could be a void ratio, a relative density or a friction.
pub(super) fn density(text: &str) -> Result<Density, String> {
    Density::named(text).ok_or_else(|| {
        "write loose, medium (or intermediate) or dense; the friction between grains while they are \
         compressed is a number: --set filter.friction=0.2"
            .into()
    })
}

/// The words for the facets between voids that are counted.
pub(super) const FACETS: [(&str, Facets); 2] = [("all", Facets::All), ("on-both-hulls", Facets::OnBothHulls)];

/// Which facets between voids are counted.
pub(super) fn facets(text: &str) -> Result<Facets, String> {
    let named = FACETS.iter().find(|(word, _)| *word == text);
    named.map(|(_, facets)| *facets).ok_or_else(|| FACETS.map(|(word, _)| word).join(" or "))
}

/// The size of a lattice: voids along each side, or along x, y and z.
pub(super) fn lattice_size(text: &str) -> Result<[u32; 3], String> {
    let length = |text: &str| text.trim().parse().ok().filter(|&voids| voids > 0);
    let lengths: Option<Vec<u32>> = text.split('x').map(length).collect();
    match lengths.as_deref() {
        Some(&[size]) => Ok([size; 3]),
        Some(&[nx, ny, nz]) => Ok([nx, ny, nz]),
        _ => Err("write a whole number of voids above 0, or three as 40x40x60".into()),
    }
}

/// A seed.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("write a whole number from 0 to {}", u64::MAX))
}

/// What a sheet shows beside mm.
pub(super) fn sheet_units(text: &str) -> Result<SheetUnits, String> {
    let named = SheetUnits::ALL.into_iter().find(|units| units.name() == text);
    named.ok_or_else(|| SheetUnits::ALL.map(SheetUnits::name).join(" or "))
}

/// The JSON Schema of a file, by the name of its form.
pub(super) fn schema_of(text: &str) -> Result<String, String> {
    let names: Vec<&str> = FORMATS.iter().map(|form| form.name()).collect();
    schema(text).ok_or_else(|| format!("one of {}", names.join(", ")))
}

/// A number of threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number| (1..=1024).contains(number));
    number.ok_or_else(|| "write a whole number from 1 to 1024".into())
}

/// A span of time.
pub(super) fn time(text: &str) -> Result<Duration, String> {
    humantime::parse_duration(text).map_err(|e| format!("{e}; write a time as 30s, 4min or 1h"))
}

/// A length above 0 (mm).
pub(super) fn length(text: &str) -> Result<f64, String> {
    millimetres(text).ok_or_else(|| format!("write {LENGTHS}"))
}

/// How far the interval may reach, in percentage points.
pub(super) fn target_error(text: &str) -> Result<f64, String> {
    let allowed = "write a number of percentage points above 0 and below 100 with its unit, as 0.5pp";
    number_with(text, "pp", f64::MIN_POSITIVE..=99.999_999, allowed)
}

/// The probability with which the verdict is to be right, in percent.
pub(super) fn decide(text: &str) -> Result<f64, String> {
    let allowed = "write a probability from 50% to 99.999% with its unit, as 99.9%";
    number_with(text, "%", 50.0..=99.999, allowed)
}

/// A number of a range, with its unit.
fn number_with(text: &str, unit: &str, range: RangeInclusive<f64>, allowed: &str) -> Result<f64, String> {
    let number = text.trim().strip_suffix(unit).and_then(|digits| digits.trim().parse::<f64>().ok());
    number.filter(|n| range.contains(n)).ok_or_else(|| allowed.to_owned())
}

/// What a sieve table cannot say, as options and settings.
pub(super) fn of_soils(dispersive: bool, joint_mm: Option<f64>) -> [(&'static str, Option<String>); 2] {
    [
        ("--dispersive", dispersive.then(|| "base.dispersive=true".to_owned())),
        ("--joint-mm", joint_mm.map(|mm| format!("filter.joint_mm={mm:?}"))),
    ]
}

/// Settings given by --set, and those that options of their own give.
///
/// # Errors
/// One is given both ways.
pub(super) fn with_options<const N: usize>(
    settings: &[String],
    options: [(&str, Option<String>); N],
) -> Result<Vec<String>, RunError> {
    let key = |setting: &str| setting.split('=').next().unwrap_or_default().trim().to_owned();
    let mut all = settings.to_vec();
    for (option, said) in options {
        let Some(said) = said else { continue };
        if let Some(setting) = settings.iter().find(|setting| key(setting) == key(&said)) {
            let problem = format!("{option} and --set {setting} say the same thing twice: give one");
            return Err(RunError::Refused(problem));
        }
        all.push(said);
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::{assignment, decide, seed, target_error, with_options};

    #[test]
    fn numbers_carry_their_unit_and_lie_in_their_range() {
        assert_eq!(target_error("0.1pp"), Ok(0.1));
        assert_eq!(decide(" 99.9 %"), Ok(99.9));
        for text in ["0.1", "pp", "nanpp", "0.1%", "1e400pp", "0pp", "-1pp", "100pp"] {
            assert!(target_error(text).unwrap_err().contains("as 0.5pp"), "{text}");
        }
        for text in ["99", "150%", "100%", "0.999", "%", "nan%", "-99%"] {
            assert!(decide(text).unwrap_err().contains("from 50% to 99.999%"), "{text}");
        }
        assert!(seed("-1").is_err() && seed("18446744073709551615") == Ok(u64::MAX));
        assert!(assignment("filter.cu").is_err() && assignment("=3").is_err() && assignment("a=").is_ok());
    }

    #[test]
    fn what_is_said_twice_is_refused() {
        let set = [" seed = 4".to_owned(), "base.cu=2".to_owned()];
        let seed = |seed: Option<u64>| [("--seed", seed.map(|seed| format!("seed={seed}")))];
        let said = with_options(&set, seed(Some(3))).unwrap_err().to_string();
        assert!(said.contains("--seed and --set  seed = 4 say the same thing twice: give one"), "{said}");
        assert_eq!(with_options(&set, seed(None)).unwrap(), set);
        assert_eq!(with_options(&set[1..], seed(Some(3))).unwrap(), ["base.cu=2", "seed=3"]);
    }
}
