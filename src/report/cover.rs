//! The cover of every sheet that can be handed in: for whom and by whom it is, of which day, and by which
//! program.

use maud::{Markup, html};

use super::figures::shorten;
use super::shell::clean;
use crate::outcome::record::SheetCover;

/// Characters of a text of the user's that are shown.
pub(super) const LINE: usize = 120;

/// Version and commit of the program, in short.
pub(super) fn program(version: &str, commit: Option<&str>) -> String {
    match commit {
        Some(commit) => format!("{version} ({})", shorten(commit, 12)),
        None => version.to_owned(),
    }
}

/// What was stated, the date, the program and, where something was walked, its seed.
pub(super) fn cover(of: &SheetCover, program: &str, seed: Option<u64>) -> Markup {
    let facts = [
        ("Project", of.project.clone()),
        ("Number", of.number.clone()),
        ("Purpose", of.purpose.clone()),
        ("Client", of.client.clone()),
        ("Author", of.author.clone()),
        ("Checked by", of.checker.clone()),
        ("Revision", of.revision.clone()),
        ("Date", of.date.clone()),
        ("Program", Some(format!("voidwalk {program}"))),
        ("Seed", seed.map(|seed| seed.to_string())),
    ];
    html! {
        dl.about { @for (name, value) in facts { @if let Some(value) = value {
            div { dt { (name) } " " dd { bdi { (clean(&shorten(&value, LINE))) } } }
        } } }
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
    fn every_field_stands_once_and_what_is_not_said_is_left_out() {
        let text = |text: &str| Some(text.to_owned());
        let of = SheetCover {
            project: text("Dam <1>"),
            number: text("D-2031"),
            purpose: text("Chimney filter"),
            client: text("Water Board"),
            author: text("N. N."),
            checker: text("M. M."),
            revision: text("A"),
            date: text("2026-11-25"),
        };
        let page = cover(&of, "1.0", Some(7)).into_string();
        for said in ["Dam &lt;1&gt;", "D-2031", "Chimney filter", "Water Board", "N. N.", "M. M.", ">A<"] {
            assert_eq!(page.matches(said).count(), 1, "{said}: {page}");
        }
        assert!(
            page.contains("2026-11-25") && page.contains("voidwalk 1.0") && page.contains(">7<"),
            "{page}"
        );
        let none = cover(&SheetCover::default(), "1.0", None).into_string();
        assert!(none.matches("<dt>").count() == 1 && none.contains("Program"), "{none}");
    }
}
