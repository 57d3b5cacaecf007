//! The day on a sheet: the day of the last walk behind it, or of its making if nothing was walked.

use std::path::Path;
use std::time::SystemTime;

use crate::outcome::record::Manifest;
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::read_whole;
use voidwalk_core::text::moment;

/// Today, as `2026-11-25`.
pub(crate) fn today() -> Option<String> {
    day(&moment(SystemTime::now()))
}

/// The last day on which one of these cases was done; `None` if no folder has a date.
pub(crate) fn last_day<'a>(cases: impl IntoIterator<Item = &'a Path>) -> Option<String> {
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
    use voidwalk_core::store::format::MANIFEST;

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
        assert_eq!(today().map(|day| day.len()), Some(10));
    }
}
