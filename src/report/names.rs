//! What a soil is called on a page: its own name and not that of a file, where there is one.

use std::borrow::Cow;

/// Endings of the tables that soils are read from.
const TABLES: [&str; 7] = ["csv", "txt", "tsv", "xlsx", "ods", "ags", "dat"];

/// What follows the name of a base that is walked regraded.
const REGRADED: &str = ", regraded on ";

/// The soil of `soils.xlsx#Till 3` is `Till 3`, that of `csv/tillh.csv` is `tillh`; any other name stays, and
/// so does what a base is regraded on.
pub(super) fn soil_name(name: &str) -> Cow<'_, str> {
    match name.rsplit_once(REGRADED) {
        Some((soil, size)) => Cow::Owned(format!("{}{REGRADED}{size}", own_name(soil))),
        None => Cow::Borrowed(own_name(name)),
    }
}

fn own_name(name: &str) -> &str {
    let (file, soil) = name.split_once('#').unwrap_or((name, ""));
    let Some((stem, ending)) = file.rsplit_once('.') else { return name };
    if !TABLES.iter().any(|table| ending.eq_ignore_ascii_case(table)) {
        return name;
    }
    match (soil.trim(), stem.rsplit(['/', '\\']).next().unwrap_or_default()) {
        ("", "") => name,
        ("", stem) => stem,
        (soil, _) => soil,
    }
}

#[cfg(test)]
mod tests {
    use super::soil_name;

    #[test]
    fn a_soil_is_called_by_its_own_name() {
        for (name, soil) in [
            ("csv/tillh.csv", "tillh"),
            ("C:\\soils\\C33 sand.CSV", "C33 sand"),
            ("lab/soils.xlsx#Till 3", "Till 3"),
            ("soils.ods# ", "soils"),
            ("linear, Cu 1.5", "linear, Cu 1.5"),
            ("till.csv, regraded on 4.75 mm", "till, regraded on 4.75 mm"),
            ("linear, Cu 30, regraded on 2 mm", "linear, Cu 30, regraded on 2 mm"),
            ("Silty core fill no. 3", "Silty core fill no. 3"),
            ("#3", "#3"),
            (".csv", ".csv"),
            ("", ""),
        ] {
            assert_eq!(soil_name(name), soil);
        }
    }
}
