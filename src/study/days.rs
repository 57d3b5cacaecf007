//! The day on a sheet: that of the last walk that it rests on, or of its making where nothing was walked.

use std::path::Path;
use std::time::SystemTime;

use crate::outcome::record::Manifest;
use crate::store::format::from_json;
use crate::store::read_whole;
use crate::text::moment;

/// Today, as `2026-11-25`.
pub(super) fn today() -> Option<String> {
    day(&moment(SystemTime::now()))
}

/// Whether a date is a day as this program writes it.
pub(super) fn is_day(date: &str) -> bool {
    date.len() == 10 && humantime::parse_rfc3339(&format!("{date}T00:00:00Z")).is_ok()
}

/// The day on which a file was written.
pub(super) fn day_of(file: &Path) -> Option<String> {
    let written = file.metadata().and_then(|meta| meta.modified()).ok()?;
    day(&moment(written))
}

/// The last day on which one of these cases was done; `None` where no folder says it.
pub(super) fn last_day<'a>(cases: impl IntoIterator<Item = &'a Path>) -> Option<String> {
    let finished = |case: &Path| {
        let bytes = read_whole(&case.join("manifest.json")).ok()?;
        day(&from_json::<Manifest>(&bytes).ok()?.finished)
    };
    // Days of this form are in order as texts.
    cases.into_iter().filter_map(finished).max()
}

/// The day of a moment.
fn day(moment: &str) -> Option<String> {
    moment.split('T').next().filter(|day| !day.is_empty()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::format::MANIFEST;

    #[test]
    fn the_last_day_of_several_cases_counts_and_a_folder_without_one_says_nothing() {
        let at = tempfile::tempdir().unwrap();
        let case = |name: &str, finished: &str| {
            let folder = at.path().join(name);
            std::fs::create_dir(&folder).unwrap();
            let manifest = Manifest {
                version: "1".into(),
                commit: None,
                seed: 1,
                inputs: Vec::new(),
                threads: 1,
                host: String::new(),
                machine: String::new(),
                started: String::new(),
                finished: finished.into(),
                command: String::new(),
            };
            std::fs::write(folder.join("manifest.json"), MANIFEST.json(&manifest).unwrap()).unwrap();
            folder
        };
        let cases =
            [case("a", "2026-11-25T23:59:59Z"), case("b", "2026-11-26T00:00:01Z"), at.path().join("c")];
        assert_eq!(last_day(cases.iter().map(|case| case.as_path())).as_deref(), Some("2026-11-26"));
        assert_eq!(last_day([cases[2].as_path()]), None);
        let today = today().unwrap();
        assert!(is_day(&today) && !["1 April 2026", "2026-13-01", "Größe 2026"].into_iter().any(is_day));
        assert_eq!(day_of(&at.path().join("a/manifest.json")).as_ref(), Some(&today));
    }
}
