//! The cover of every sheet that can be handed in: client, author, date and program.

use maud::{Markup, html};

use super::figures::shorten;
use super::shell::clean;
use voidwalk_practice::SheetCover;

/// Characters of a text of the user's that are shown.
pub(super) const LINE: usize = 120;

/// Characters that fit at the foot of a printed page.
const FOOT: usize = 60;

/// Those who sign: on paper their names are in the signature fields.
const SIGNED: [&str; 2] = ["Author", "Checked by"];

/// Version and commit of the program, in short.
pub(super) fn program(version: &str, commit: Option<&str>) -> String {
    match commit {
        Some(commit) => format!("{version} ({})", shorten(commit, 12)),
        None => version.to_owned(),
    }
}

/// Stated facts, the date, the program and, if something was walked, its seed; on paper blank lines for
/// missing facts, and the fields of three signatures.
pub(super) fn cover(sheet: &SheetCover, program: &str, seed: Option<u64>) -> Markup {
    let facts = [
        ("Project", sheet.project.clone()),
        ("Number", sheet.number.clone()),
        ("Purpose", sheet.purpose.clone()),
        ("Client", sheet.client.clone()),
        ("Author", sheet.author.clone()),
        ("Checked by", sheet.checker.clone()),
        ("Revision", sheet.revision.clone()),
        ("Date", sheet.date.clone()),
        ("Program", Some(format!("voidwalk {program}"))),
        ("Seed", seed.map(|seed| seed.to_string())),
    ];
    // A missing fact is a blank line on paper; without a seed nothing was walked.
    let shown = facts.iter().filter(|(name, value)| *name != "Seed" || value.is_some());
    html! {
        div.title {
            dl.about { @for (name, value) in shown { @match value {
                Some(value) => div class=[SIGNED.contains(name).then_some("signed")] {
                    dt { (name) } " " dd { bdi { (clean(&shorten(value, LINE))) } }
                },
                None => div.blank.signed[SIGNED.contains(name)] aria-hidden="true" {
                    dt { (name) } " " dd {}
                },
            } } }
            (signatures(sheet))
        }
    }
}

/// Text at the foot of every page beside its number: the number of the project, or its name.
pub(super) fn foot(sheet: &SheetCover) -> Option<String> {
    let text = sheet.number.as_ref().or(sheet.project.as_ref())?;
    Some(clean(&shorten(text, FOOT)))
}

/// Signature fields of those who prepared, checked and approved the sheet, on paper.
fn signatures(sheet: &SheetCover) -> Markup {
    let who = [("Prepared", sheet.author.as_ref()), ("Checked", sheet.checker.as_ref()), ("Approved", None)];
    html! {
        table.sign aria-hidden="true" {
            thead { tr { th {} th { "Name" } th { "Date" } th { "Signature" } } }
            tbody { @for (did, name) in who { tr {
                th { (did) }
                td { @if let Some(name) = name { bdi { (clean(&shorten(name, LINE))) } } }
                td {} td {}
            } } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_is_named_with_the_commit_that_it_was_built_from() {
        assert_eq!(
            program("1.0", Some("0123456789abcdef")),
            format!("1.0 ({})", shorten("0123456789abcdef", 12))
        );
        assert_eq!(program("1.0", None), "1.0");
    }

    #[test]
    fn every_field_stands_once_and_what_is_not_said_is_a_blank_line() {
        let text = |text: &str| Some(text.to_owned());
        let sheet = SheetCover {
            project: text("Dam <1>"),
            number: text("D-2031"),
            purpose: text("Chimney filter"),
            client: text("Water Board"),
            author: text("N. N."),
            checker: text("M. M."),
            revision: text("A"),
            date: text("2026-11-25"),
        };
        let page = cover(&sheet, "1.0", Some(7)).into_string();
        for fact in ["Dam &lt;1&gt;", "D-2031", "Chimney filter", "Water Board", ">A<"] {
            assert_eq!(page.matches(fact).count(), 1, "{fact}: {page}");
        }
        // The signature fields, and the foot of every page.
        assert_eq!(foot(&sheet).as_deref(), Some("D-2031"));
        for fact in ["Prepared</th><td><bdi>N. N.<", "Checked</th><td><bdi>M. M.<", "Approved</th><td></td>"]
        {
            assert!(page.contains(fact), "{fact}: {page}");
        }
        assert!(!page.contains("class=\"blank"), "{page}");
        assert!(
            page.contains("2026-11-25") && page.contains("voidwalk 1.0") && page.contains(">7<"),
            "{page}"
        );
        let none = cover(&SheetCover::default(), "1.0", None).into_string();
        assert_eq!((none.matches("<dt>").count(), none.matches("class=\"blank").count()), (9, 8), "{none}");
        assert!(none.contains("Program") && !none.contains("Seed"), "{none}");
        let project = SheetCover { project: text("Main dam"), ..SheetCover::default() };
        assert_eq!((foot(&project).as_deref(), foot(&SheetCover::default())), (Some("Main dam"), None));
    }
}
