//! Frame of every page: one HTML file that fetches nothing, its head, its figures, and the cover of a sheet
//! that can be handed in. [`maud::Markup`] escapes texts; texts from outside also go through [`clean()`].

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::figures::{Figure, Size, shorten};
use crate::outcome::record::ModelLimit;
use crate::words::left_out::model_limit;
use voidwalk_core::text::all_visible;
use voidwalk_practice::SheetCover;

const STYLE: &str = include_str!("page.css");
/// SHA-256 of the style in base64, for the content security policy. If the style changes, a test on Linux
/// prints the new hash.
const STYLE_HASH: &str = "mDepA0nhVqGFzpjx3fdu2udUK7V6SF3ya+Kp73qFFQA=";

pub(crate) struct Drawn {
    /// File name without the ending; unique on the page.
    pub(crate) name: &'static str,
    pub(crate) caption: String,
    pub(crate) figure: Figure,
}

impl Drawn {
    pub(crate) fn new(name: &'static str, figure: Figure, caption: impl Into<String>) -> Self {
        Self { name, caption: caption.into(), figure }
    }
}

/// Content security policy of every page, which allows nothing from elsewhere.
pub(crate) fn content_policy() -> String {
    // The style is named by its hash, so that a style injected by a hostile name has no effect.
    format!("default-src 'none'; style-src 'sha256-{STYLE_HASH}'; base-uri 'none'; form-action 'none'")
}

/// Page as text: `title` for the browser, a text in the footer of every printed sheet next to its number, and
/// the contents of each part of its body.
pub(super) fn page_with_foot(
    foot: Option<&str>,
    title: &str,
    [header, main, footer]: [&Markup; 3],
) -> String {
    let policy = content_policy();
    let main = with_contents(&main.0);
    html! {
        (DOCTYPE)
        html lang="en" data-foot=[foot] {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="referrer" content="no-referrer";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header { (header) }
                main { (PreEscaped(main)) }
                footer { (footer) }
            }
        }
    }
    .into_string()
}

/// Place for the list of the headings that follow.
const CONTENTS: &str = "<nav class=\"contents\"></nav>";

pub(super) fn contents() -> Markup {
    html! { (PreEscaped(CONTENTS)) }
}

/// Adds the list of headings to a page if it was requested; each heading gets an id.
fn with_contents(main: &str) -> String {
    let Some((before, after)) = main.split_once(CONTENTS) else { return main.to_owned() };
    let mut parts = after.split("<h2>");
    let mut marked = parts.next().unwrap_or_default().to_owned();
    let mut headings: Vec<&str> = Vec::new();
    for part in parts {
        headings.push(part.split("</h2>").next().unwrap_or_default());
        marked.push_str(&format!("<h2 id=\"part-{}\">{part}", headings.len()));
    }
    let list = html! {
        nav.contents aria-label="Contents" {
            @for (index, heading) in headings.iter().enumerate() {
                @if !heading.contains('<') {
                    a href=(format!("#part-{}", index + 1)) { (PreEscaped(heading)) } " "
                }
            }
        }
    };
    [before, &list.0, &marked].concat()
}

/// Text from outside without non-text characters; maud escapes the markup in it.
pub(crate) fn clean(text: &str) -> String {
    all_visible(text)
}

/// Cleaned sentence with no line break between a number and its unit.
pub(super) fn unbroken(text: &str) -> String {
    let mut sentence = clean(text);
    for unit in ["%", "mm"] {
        let (broken, joined) = (format!(" {unit}"), format!("\u{202f}{unit}"));
        sentence = (0..10).fold(sentence, |sentence, digit| {
            sentence.replace(&format!("{digit}{broken}"), &format!("{digit}{joined}"))
        });
    }
    sentence
}

/// Figure as an element of the page, in all its sizes; the style shows the size that fits.
pub(crate) fn drawing(drawn: &Drawn) -> Markup {
    let inline = |size, name| PreEscaped(drawn.figure.inline(&format!("{}-{name}", drawn.name), size));
    html! {
        div.wide { (inline(Size::Wide, "wide")) } div.narrow { (inline(Size::Narrow, "narrow")) }
        @if drawn.figure.sheet.is_some() { div.paper { (inline(Size::Sheet, "sheet")) } }
    }
}

pub(super) fn figure(number: usize, drawn: &Drawn) -> Markup {
    html! {
        figure.tall[drawn.figure.is_tall()] {
            (looks(number, &drawn.figure.curves()))
            (drawing(drawn))
            figcaption { b { "Figure " (number) ". " } (clean(&drawn.caption)) }
        }
    }
}

/// Controls of a figure on a screen: the curves that are shown, and their size. The boxes work by style
/// alone, because no script runs on a page; in print all curves are shown.
fn looks(number: usize, curves: &[String]) -> Markup {
    html! {
        div.looks role="group" aria-label=(format!("Figure {number}, as shown on a screen")) {
            @for (index, name) in curves.iter().enumerate() {
                label { input.(format!("show-{}", index + 1)) type="checkbox" checked; " " (clean(name)) }
            }
            label { input.larger type="checkbox"; " larger" }
        }
    }
}

/// Explanation of the model, before its first mention on a page.
pub(super) fn model() -> Markup {
    html! {
        p.model {
            b { "Model" } " (“the walk”): base particles are moved through voids with the filter’s openings \
            (constrictions): a simulation, not a test."
        }
    }
}

/// Limits of the model, for a page to list beside its results.
pub(super) fn leaves_out(limits: &[ModelLimit], more: &Markup) -> Markup {
    html! {
        aside.leaves {
            h2 { "What the model leaves out" }
            ul { @for limit in limits { li { (clean(&model_limit(*limit))) } } }
            (more)
        }
    }
}

pub(super) fn citation() -> Markup {
    html! {
        h2 { "How to cite" }
        p {
            "The model: Shire and O’Sullivan, " cite { "A network model to assess base-filter \
                                                        combinations" }
            ", Computers and Geotechnics."
        }
    }
}

pub(super) fn fact(name: &str, value: impl std::fmt::Display) -> Markup {
    html! { tr { th { (name) } td { (clean(&value.to_string())) } } }
}

/// Maximum number of characters of a user's text shown.
pub(super) const LINE: usize = 120;

/// Number of characters that fit in the footer of a printed page.
const FOOT: usize = 60;

/// People who sign: on paper their names are in the signature fields.
const SIGNED: [&str; 2] = ["Author", "Checked by"];

/// Version and commit of the program, in short.
pub(super) fn program(version: &str, commit: Option<&str>) -> String {
    match commit {
        Some(commit) => format!("{version} ({})", shorten(commit, 12)),
        None => version.to_owned(),
    }
}

/// Cover: stated facts, the date, the program and, after a walk, its seed. On paper missing facts become
/// blank lines, and there are fields for three signatures.
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

/// Footer of every page, next to its number: the number of the project, or its name.
pub(super) fn foot(sheet: &SheetCover) -> Option<String> {
    let text = sheet.number.as_ref().or(sheet.project.as_ref())?;
    Some(clean(&shorten(text, FOOT)))
}

/// Signature fields on paper, for those who prepared, checked and approved the sheet.
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

    /// The hash equals the output of `sha256sum`.
    #[cfg(target_os = "linux")]
    #[test]
    fn the_hash_of_the_style_is_its_own() {
        use base64::Engine as _;
        use base64::prelude::BASE64_STANDARD;
        let style = concat!(env!("CARGO_MANIFEST_DIR"), "/report/page.css");
        let output = std::process::Command::new("sha256sum").arg(style).output().unwrap();
        let output = String::from_utf8(output.stdout).unwrap();
        let byte = |at: usize| u8::from_str_radix(&output[at..at + 2], 16).unwrap();
        let hash = BASE64_STANDARD.encode((0..64).step_by(2).map(byte).collect::<Vec<_>>());
        assert_eq!(STYLE_HASH, hash, "page.css has changed: STYLE_HASH is {hash} now");
    }

    #[test]
    fn every_page_names_its_style_by_its_hash_and_has_a_foot() {
        let page_with = |foot| page_with_foot(foot, "A page", [&html! {}; 3]);
        let page = page_with(Some("D-114 \"<b>"));
        assert!(page.contains("<html lang=\"en\" data-foot=\"D-114 &quot;&lt;b&gt;\">"), "{page}");
        assert!(page_with(None).contains("<html lang=\"en\"><head>"));
        assert!(page.contains(&format!("<style>{STYLE}</style>")), "{page}");
        assert!(page.contains(&format!("style-src 'sha256-{STYLE_HASH}'")), "{page}");
        for part in ["--foot:attr(data-foot)", "content:var(--foot)", "counter(page) \" of \" counter(pages)"]
        {
            assert!(STYLE.contains(part), "{part}");
        }
    }

    #[test]
    fn headings_are_listed_where_that_is_wanted() {
        let (part, mark) = ("<h2>Part &amp; 1</h2><p>1</p><h2>Of <b>2</b></h2>", CONTENTS);
        let page = with_contents(&format!("<h2>Before</h2>{mark}{part}"));
        let list =
            "<nav class=\"contents\" aria-label=\"Contents\"><a href=\"#part-1\">Part &amp; 1</a> </nav>";
        let marked = "<h2 id=\"part-1\">Part &amp; 1</h2><p>1</p><h2 id=\"part-2\">Of <b>2</b></h2>";
        assert_eq!(page, format!("<h2>Before</h2>{list}{marked}"));
        assert_eq!(with_contents(part), part);
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
        let named = program("1.0", Some("0123456789abcdef"));
        assert_eq!([named, program("1.0", None)], ["1.0 (0123456789a…)", "1.0"]);
        let page = cover(&sheet, "1.0", Some(7)).into_string();
        for fact in ["Dam &lt;1&gt;", "D-2031", "Chimney filter", "Water Board", ">A<"] {
            assert_eq!(page.matches(fact).count(), 1, "{fact}: {page}");
        }
        // Signature fields, and the footer of every page.
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
