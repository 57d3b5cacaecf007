//! Parts of the box with the verdict of walks, on a page and in brief.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, Render, html};

use super::quantity::{SizeUnit, percent};
use super::results::run_heading;
use super::run_figures;
use super::shell::clean;
use super::table::Table;
use super::walks::Walks;
use crate::outcome::record::{ModelLimit, RunSummary, Verdict};
use crate::outcome::statistic::percent_interval;
use crate::outcome::table::Columns;
use crate::words::left_out::left_out_in_brief;
use crate::words::{FirstLine, meaning, sentence};
use voidwalk_practice::Note;

/// Eroded mass by run, with its interval.
pub(super) fn eroded_table(walks: &Walks) -> Markup {
    Table::of(walks.summary, eroded_columns()).render()
}

/// The columns of the table of eroded mass.
fn eroded_columns<'a>() -> Columns<'a, RunSummary> {
    Columns::default()
        .name("run", "Base eroded, by mass", |run: &RunSummary| run_heading(run.run))
        .number("mean", "mean", |run| percent(run.eroded_mass_fraction.mean))
        .number("interval", "95 % interval", |run| {
            percent_interval(&run.eroded_mass_fraction)
                .map_or_else(|| "none".to_owned(), |span| span.to_string())
        })
}

/// Meaning of the class, in a sentence.
pub(super) fn in_words(walks: &Walks) -> String {
    meaning(walks.verdict, walks.summary, walks.threshold)
}

/// The classes of the replicates, counted, with the words for one replicate and for each of several.
pub(super) fn tally(walks: &Walks, [single, several]: [&str; 2]) -> String {
    let count = walks.replicates.len();
    if count == 1 {
        return format!("1 replicate ({single}).");
    }
    let classes = Verdict::ALL.into_iter().filter_map(|class| {
        let number = walks.replicates.iter().filter(|replicate| replicate.verdict == class).count();
        let share = if number == count { "all".to_owned() } else { number.to_string() };
        (number > 0).then(|| format!("{} in {share}", class.words()))
    });
    let classes = classes.collect::<Vec<_>>().join(", ");
    format!("{count} replicates, each {several}: {classes}.")
}

/// Text on replicates below the table: their number, the threshold, and a warning for a single one.
pub(super) fn replicates_in_words(walks: &Walks, what: [&str; 2]) -> Markup {
    html! {
        p {
            (tally(walks, what)) " Threshold between the classes: "
            (percent(walks.threshold).in_digits(3)) "."
        }
        @if walks.replicates.len() == 1 {
            p {
                b { "One replicate: the scatter is unknown." }
                " Walk more replicates before relying on this."
            }
        }
    }
}

/// Texts of a verdict in brief beside its numbers.
pub(super) struct Said<'a> {
    /// The lines of practice and model; for a network the model's alone.
    pub lines: &'a [(FirstLine, String)],
    /// Meaning of the class, in the sentence of the page.
    pub meaning: String,
    /// Notes for the reader.
    pub notes: &'a [Note],
    /// Words for one replicate, and for each of several.
    pub replicate: [&'static str; 2],
    /// Features that the model omits.
    pub leaves_out: &'a [ModelLimit],
}

/// The verdict in brief, for a page of another program, as a notebook: it needs no style, and the figure is a
/// picture, so that several fit on one page.
pub(super) fn brief(walks: &Walks, texts: &Said) -> String {
    let drawn = run_figures::verdict(walks);
    let picture = BASE64_STANDARD.encode(drawn.figure.file());
    let columns = eroded_columns().number("blocked", "constrictions blocked", |run| run.blocked_fraction);
    html! {
        div {
            @for (line, words) in texts.lines { p { b { (line.name()) } ": " (clean(words)) "." } }
            p { (clean(&texts.meaning)) }
            ul { @for note in texts.notes { li { (clean(&sentence(note, SizeUnit::Mm))) } } }
            img src={ "data:image/svg+xml;base64," (picture) }
                alt="Mean and 95 % interval of the eroded mass in each run, against the threshold";
            (Table::of(walks.summary, columns))
            (replicates_in_words(walks, texts.replicate))
            p { (clean(&left_out_in_brief(texts.leaves_out))) }
        }
    }
    .into_string()
}
