//! Files to try the program with: sheets, a scene, a plan and a notebook.

use std::path::Path;

use super::error::RunError;
use super::folder::shown;
use super::prepare::write_new;
use voidwalk_core::store::StoreError;

/// An example: its file name, a description, and its text.
#[derive(Clone, Copy, Debug)]
pub struct ExampleFile {
    /// Its name.
    pub name: &'static str,
    /// Description of its contents.
    pub what: &'static str,
    /// All that is in it.
    pub text: &'static str,
}

/// The example in `src/app/data/examples` of this name.
macro_rules! example {
    ($name:literal, $what:literal) => {
        ExampleFile { name: $name, what: $what, text: include_str!(concat!("../data/examples/", $name)) }
    };
}

/// Every example.
pub const EXAMPLE_FILES: [ExampleFile; 8] = [
    example!("base.csv", "a base: openings in mm, percent finer by mass"),
    example!("filter.csv", "a filter for it"),
    example!("filter-fine.csv", "a finer one"),
    example!("us-sieves.csv", "two soils by US sieves, as they stand side by side in a sheet"),
    example!("borrow-area.ags", "six samples of a borrow area (AGS4)"),
    example!("scene.toml", "a scene: base, filter and network, with a cover for the first sheet"),
    example!("plan.toml", "a plan: two filters by two densities"),
    example!("notebook.ipynb", "the same from Python"),
];

/// Writes every example into a folder, which is made if it is missing. Other files in it stay.
///
/// ```
/// use voidwalk_app::run::{EXAMPLE_FILES, write_examples};
/// let folder = std::env::temp_dir().join(format!("voidwalk-examples-{}", std::process::id()));
/// write_examples(&folder)?;
/// assert!(EXAMPLE_FILES.iter().all(|file| folder.join(file.name).is_file()));
/// assert!(write_examples(&folder).unwrap_err().to_string().contains("is there already"));
/// # std::fs::remove_dir_all(folder).unwrap();
/// # Ok::<(), voidwalk_app::RunError>(())
/// ```
///
/// # Errors
/// [`RunError::Refused`] if a file is there already, or the folder is a file: then nothing is written.
pub fn write_examples(folder: &Path) -> Result<(), RunError> {
    let places = EXAMPLE_FILES.map(|file| folder.join(file.name));
    if let Some(taken) = places.iter().find(|path| path.symlink_metadata().is_ok()) {
        let problem = "is there already; nothing was written. Name another folder";
        return Err(RunError::Refused(format!("{}: {problem}", shown(taken))));
    }
    if let Some(file) = folder.ancestors().find(|part| part.exists() && !part.is_dir()) {
        let problem = "is a file; name a folder, a new one or one that is there";
        return Err(RunError::Refused(format!("{}: {problem}", shown(file))));
    }
    let io = |source| StoreError::Io { path: folder.to_owned(), action: "make the folder", source };
    std::fs::create_dir_all(folder).map_err(io).map_err(RunError::Claim)?;
    places.iter().zip(EXAMPLE_FILES).try_for_each(|(path, file)| write_new(path, file.text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use crate::cases::CasePlan;
    use crate::scene::Scene;
    use voidwalk_sheets::{curves_in_file, soils_in_file};

    #[test]
    fn every_example_is_read_without_a_remark_and_the_soils_are_what_is_said() {
        let root = tempfile::tempdir().unwrap();
        write_examples(root.path()).unwrap();
        let place = |name: &str| root.path().join(name);
        let soils = |name: &str| curves_in_file(&place(name), None).unwrap().len();
        let counts =
            ["base.csv", "filter.csv", "filter-fine.csv", "us-sieves.csv", "borrow-area.ags"].map(soils);
        assert_eq!(counts, [1, 1, 1, 2, 6]);
        let notes = |name: &str| soils_in_file(&place(name), None).unwrap()[0].notes.clone();
        assert_eq!(
            notes("us-sieves.csv"),
            ["US sieves read as the openings of ASTM E11 (No. 200 = 0.075 mm)"]
        );
        let case = Case::new(Scene::read(&place("scene.toml"), &[]).unwrap()).unwrap();
        assert_eq!(case.scene.filter.thickness_mm, Some(609.6));
        let plan = CasePlan::read(&place("plan.toml")).unwrap();
        assert_eq!(plan.cases.len(), 4);
        for case in &plan.cases {
            Case::new(case.scene.clone()).unwrap();
        }
        let notebook = EXAMPLE_FILES.iter().find(|file| file.name == "notebook.ipynb").unwrap();
        let notebook: serde_json::Value = serde_json::from_str(notebook.text).unwrap();
        assert_eq!((&notebook["nbformat"], notebook["cells"].as_array().unwrap().len()), (&4.into(), 8));
    }

    #[test]
    fn nothing_is_written_over_and_nothing_half() {
        let root = tempfile::tempdir().unwrap();
        let taken = root.path().join("plan.toml");
        std::fs::write(&taken, "mine").unwrap();
        let message = write_examples(root.path()).unwrap_err().to_string();
        assert!(message.contains("plan.toml: is there already; nothing was written"), "{message}");
        assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 1);
        let message = write_examples(&taken.join("below")).unwrap_err().to_string();
        assert!(message.contains("plan.toml: is a file"), "{message}");
    }
}
