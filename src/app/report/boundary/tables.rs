//! The tables of the page of boundaries.

use maud::{Markup, html};

use super::words::{in_band, ratio, size_unit};
use crate::outcome::boundary::{Boundaries, Boundary, BoundaryRow, WalkRow};
use crate::outcome::table::{Columns, TableCell};
use crate::report::appendix::input_files;
use crate::report::names::{file_name, option_words};
use crate::report::quantity::{NumberRole, length, percent, significant, whole};
use crate::report::shell::{clean, fact};
use crate::report::shown::known;
use crate::report::table::Table;
use crate::words::base_size;
use crate::words::boundary::share_of_networks;
use crate::words::sentence;
use voidwalk_practice::Note;

/// The columns of the boundaries, whose cells the page decorates.
fn columns<'a>() -> Columns<'a, BoundaryRow> {
    let thick = |row: &BoundaryRow| {
        let mm = row.thickness_mm.map(|mm| format!(", {} mm", significant(mm))).unwrap_or_default();
        format!("{} layers{mm}", whole(row.layers))
    };
    let median = |boundary: &Option<Boundary>| boundary.as_ref().map(|boundary| ratio(boundary.median));
    Columns::default()
        .name("density", "Density", |row: &BoundaryRow| row.name())
        .text("thickness", "Thickness, at the no-erosion boundary", move |row| {
            row.thickness.as_str().shown().below(thick(row))
        })
        .text("no_erosion", "No erosion in the model up to", move |row| median(&row.shown()[0]))
        .text("continuing", "Continuing erosion from", move |row| median(&row.shown()[1]))
        .number("not_monotone", "Not monotone", |row| {
            format!("{} of {}", row.not_monotone, row.networks.len())
        })
}

/// The boundaries of the model, a row a density and thickness.
pub(super) fn boundaries(all: &Boundaries) -> Markup {
    let of_base =
        all.base.size().map_or(String::new(), |base| format!(" ({})", base_size(&base, size_unit(all))));
    // A boundary of no erosion is stated as a limit.
    let unit = size_unit(all);
    let limit = |mm: f64| length(mm, unit).role(NumberRole::Greatest).to_string();
    let rounded = |mm: f64| length(mm, unit).to_string();
    let cell = |boundary: Option<&Boundary>, notes: &[Note], is_limit: bool| {
        let end = move |value| {
            significant(value).role(if is_limit { NumberRole::Greatest } else { NumberRole::Value }).number()
        };
        html! {
            @match boundary {
                Some(boundary) => {
                    (ratio(boundary.median))
                    (in_band(boundary.low, boundary.high, ratio))
                    @if let Some(range) = &boundary.d15f_mm {
                        br; (if is_limit { limit(range.median) } else { rounded(range.median) })
                        (in_band(range.low, range.high, end))
                    }
                },
                None => "no number",
            }
            @for note in notes { br; span.small { (clean(&sentence(note, unit))) } }
        }
    };
    html! {
        p {
            "Results of the walks alone, without the rules of practice: D15F/D85B" (of_base)
            @if all.replicates == 1 { ", of one network" } @else {
                ", median of " (whole(all.replicates)) " networks (in brackets "
                (share_of_networks(all.replicates)) ")"
            }
            "; below it the D15F in mm where sizes have a unit."
        }
        (Table::of(&all.boundaries, columns()).class("study")
            .showing("no_erosion", |row| cell(row.shown()[0].as_ref(), &row.no_erosion_notes, true))
            .showing("continuing", |row| cell(row.shown()[1].as_ref(), &row.continuing_notes, false)))
        p.small {
            "No erosion: less than " (percent(all.threshold).in_digits(3))
            " of the mass of the base erodes in the first run. Continuing: at least as much in the second, \
             too. Between the two is some erosion."
            @if all.moves_expectation() {
                " Base particles that can block nothing move as their expectation. A run with another engine \
                 draws other random numbers: on a small lattice it may lose "
                (percent(all.threshold).in_digits(3))
                " of the base at a smaller D15F than the boundary."
            }
        }
    }
}

/// A coefficient of uniformity, or words for an unknown one.
fn cu(value: Option<f64>) -> String {
    value.map_or_else(|| "not known".to_owned(), |cu| significant(cu).in_digits(4).to_string())
}

/// Walks and inputs of the boundaries.
pub(super) fn made(all: &Boundaries, walks: &[WalkRow]) -> Markup {
    let [low, high] = all.bracket;
    let size = |value: Option<f64>| value.map_or_else(|| "not known".to_owned(), |mm| format!("{mm:.4} mm"));
    let grains = all.boundaries.iter().find_map(|row| row.grains_per_void);
    let asked = all.settings.iter().map(|setting| option_words(setting)).collect::<Vec<_>>().join(" ");
    html! {
        table.facts { tbody {
            (fact("Base", file_name(&all.base.name)))
            (fact("Cu of the base as walked; D15 as sampled, D85 as walked", format!(
                "{}; {}, {}",
                cu(all.base.cu),
                size(all.base.d15_mm),
                size(all.base.d85_mm)
            )))
            @if let Some(base) = all.base.size() { (fact("D85B", base_size(&base, size_unit(all)))) }
            (fact("Filter", file_name(&all.filter)))
            (fact("Constriction curve", file_name(&all.curve_name)))
            @if let Some(mm) = all.filter_d15_mm { (fact("D15F of the filter as given", size(Some(mm)))) }
            (fact("Cu of the filter", cu(all.filter_cu)))
            (fact("Grains per void", known(grains, |grains| significant(grains).in_digits(4))))
            @if !all.engine.is_empty() { (fact("Engine", &all.engine)) }
            (fact("Networks, seed", format!("{}, {}", whole(all.replicates), all.seed)))
            (fact("Searched", format!(
                "D15F/D85B {low} to {high}, outwards to steps of 8 %, in steps of {} %; {} ratios walked \
                 (boundary.csv)",
                significant(100.0 * all.step).in_digits(4),
                whole(walks.len() as u64)
            )))
            (input_files(&all.inputs))
            (fact("Asked for", if asked.is_empty() { "nothing in particular" } else { &asked }))
        } }
    }
}
