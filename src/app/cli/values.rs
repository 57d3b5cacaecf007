//! Values of options, as a user writes them, with the expected form if they are not understood.

use std::time::Duration;

use super::schemas::schema;
use crate::scene::Density;
use voidwalk_core::constrictions::Facets;
use voidwalk_core::schema::length::{LENGTHS, millimetres};
use voidwalk_core::store::format::FORMATS;

/// A setting and its value.
pub(super) fn assignment(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((name, _)) if !name.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("write KEY=VALUE, as --set filter.cu=3".into()),
    }
}

/// Density of a filter. A number could be a void ratio, a relative density or a friction.
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

#[cfg(test)]
mod tests {
    use super::{assignment, seed};

    #[test]
    fn values_are_read_or_refused() {
        assert!(seed("-1").is_err() && seed("18446744073709551615") == Ok(u64::MAX));
        assert!(assignment("filter.cu").is_err() && assignment("=3").is_err() && assignment("a=").is_ok());
    }
}
