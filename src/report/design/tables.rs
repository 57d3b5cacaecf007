//! The tables of the page of a design.

use maud::{Markup, Render, html};

use super::words::{in_band, of_walk, ratio, sentence, shown_in};
use crate::outcome::design::band::{Band, SetBy};
use crate::outcome::design::products::to_be_checked;
use crate::outcome::design::{Boundary, Design, DesignRow, WalkRow, share_of_networks};
use crate::outcome::record::{AppliedRule, RuleRole};
use crate::report::appendix::input_files;
use crate::report::names::{file_name, option_words};
use crate::report::numbers::{rounded_down, rounded_up, significant, threshold, trimmed, whole};
use crate::report::rules;
use crate::report::shell::{clean, fact, unbroken};
use crate::report::table::Table;
use crate::verdict::fitting::{FITS, MAY_DRAIN};
use crate::verdict::words::capital;

/// The boundaries of the walk alone, a row a density and thickness.
pub(super) fn boundaries(design: &Design) -> Markup {
    let of_base = design.base.size().map_or(String::new(), |base| format!(" ({})", base.words()));
    // A boundary of no erosion is stated as a limit.
    let unit = shown_in(design, "mm");
    let within: fn(f64) -> String = if design.inverse { rounded_up } else { rounded_down };
    let limit = |mm: f64| unit.limit(mm, "mm", design.inverse);
    let found = |mm: f64| format!("{} mm{}", significant(mm), unit.beside(mm));
    let cell = |boundary: Option<&Boundary>, note: Option<&String>, is_limit: bool| {
        let end = if is_limit { within } else { significant };
        html! {
            @match boundary {
                Some(boundary) => {
                    (of_walk(design, &ratio(boundary.median)))
                    (in_band(boundary.low, boundary.high, ratio))
                    @for range in [&boundary.d15f_mm, &boundary.d85b_mm].into_iter().flatten() {
                        br; (if is_limit { limit(range.median) } else { found(range.median) })
                        (in_band(range.low, range.high, end))
                    }
                },
                None => "no number",
            }
            @if let Some(note) = note { br; span.small { (sentence(note)) } }
        }
    };
    let thick = |row: &DesignRow| {
        let mm = row.thickness_mm.map(|mm| format!(", {} mm", significant(mm))).unwrap_or_default();
        format!("{} layers{mm}", whole(row.layers))
    };
    html! {
        p {
            "Results of the walks alone, without the rules of practice: D15F/D85B" (of_base)
            @if design.replicates == 1 { ", of one network" } @else {
                ", median of " (whole(design.replicates)) " networks (in brackets "
                (share_of_networks(design.replicates)) ")"
            }
            "; below it the "
            @if design.inverse { "finest D85B" } @else { "D15F" } " in mm where sizes have a unit."
        }
        (Table::of(&design.boundaries).class("study")
            .name("Density", |row| clean(&row.name()))
            .text("Thickness, at the no-erosion boundary", |row| {
                html! { (clean(&row.thickness)) br; span.small { (thick(row)) } }
            })
            .text("No erosion in the model up to", |row| {
                let [no_erosion, _] = row.shown();
                cell(no_erosion.as_ref(), row.no_erosion_note.as_ref(), true)
            })
            .text("Continuing erosion from", |row| {
                let [_, continuing] = row.shown();
                cell(continuing.as_ref(), row.continuing_note.as_ref(), false)
            })
            .number("Not monotone", |row| {
                format!("{} of {}", row.not_monotone, row.networks.len())
            })
            .render())
        p.small {
            "No erosion: less than " (threshold(design.threshold)) " of the mass of the base erodes in the \
             first run. Continuing: at least as much in the second run, too. Between the two is some \
             erosion."
            @if design.moves_expectation() {
                " Base particles that can block nothing move as their expectation. A run with another engine \
                 draws other random numbers: on a small lattice it may lose " (threshold(design.threshold))
                " of the base at a smaller D15F than the boundary."
            }
        }
    }
}

/// The band of each row.
pub(super) fn bands(design: &Design) -> Markup {
    let rows: Vec<&DesignRow> = design.boundaries.iter().filter(|row| row.band.is_some()).collect();
    let size = |row: &DesignRow, at_least: bool, of: fn(&Band) -> Option<f64>| {
        let band = row.band.as_ref().expect("rows without one were left out");
        let limit = |value| shown_in(design, &band.unit).limit(value, &band.unit, at_least);
        of(band).map_or_else(|| "–".to_owned(), limit)
    };
    let set_by = |row: &DesignRow| match row.band.as_ref().map(|band| band.greatest) {
        Some(greatest) if row.band.as_ref().and_then(|band| band.practice) == Some(greatest) => "practice",
        _ => "the walk",
    };
    html! {
        @if !rows.is_empty() {
            p {
                "D15F from the least that drains the base to the greatest that both allow: the walk, in \
                 which \
                 all but 5 % of networks show no erosion, and the strictest rule of retention. The band to \
                 specify lies within it and may be narrower. It is empty \
                 if the least exceeds the greatest. If the constriction curve is known only within a range, \
                 the whole range must hold."
            }
            (Table::of(rows.iter().copied()).class("study")
                .name("Density, thickness", |row| clean(&format!("{}, {}", row.density, row.thickness)))
                .number("Least (drains)", |row| {
                    let is_open = row.band.as_ref().is_some_and(|band| band.least_at_most);
                    let least = size(row, true, |band| Some(band.least));
                    if is_open { format!("at most {least}, not known") } else { least }
                })
                .number("Greatest", |row| size(row, false, |band| Some(band.greatest)))
                .text("Set by", |row| set_by(row))
                .number("Practice allows", |row| size(row, false, |band| band.practice))
                .text("Result", |row| match row.band.as_ref().is_some_and(|band| band.is_empty) {
                    true => html! { span.breaks { "✗ empty" } },
                    false => html! { span.keeps { "✓" } },
                })
                .render())
            @for row in &rows {
                @if let Some(band) = row.band.as_ref().filter(|band| band.is_empty) {
                    p { b { (clean(&capital(&band.said))) } "." }
                }
            }
        }
    }
}

/// Standard products beside the narrowest band.
pub(super) fn products(design: &Design) -> Markup {
    let yes = |holds: bool| match holds {
        true => html! { span.keeps { "✓" } },
        false => html! { span.breaks { "✗" } },
    };
    let sources = design.products.iter().map(|of| (of.name.as_str(), of.source.as_str()));
    let to_check = to_be_checked(sources);
    html! {
        @if !design.products.is_empty() {
            p {
                "A product fits if the D15 of both sides of its specification lies within the narrowest band \
                 and practice agrees. D15 is interpolated between sieves. The products’ own shapes were not \
                 walked: another shape holds to another D15."
                @if design.fits_by_practice() {
                    " The limit of practice sets the answer: a product fits by practice. "
                    (design.walk_beside_practice())
                } @else {
                    " No product is said to fit here, because the answer is in doubt."
                }
            }
            (Table::of(&design.products)
                .class("products")
                .name("Product", |fit| clean(&fit.name))
                .number("D15, fine to coarse side (mm)", |fit| {
                    format!("{} to {}", significant(fit.d15_mm[0]), significant(fit.d15_mm[1]))
                })
                .text("Drains", |fit| match fit.may_drain {
                    true => html! { (MAY_DRAIN) },
                    false => yes(fit.drains),
                })
                .text("Holds (walk and practice)", |fit| yes(fit.holds))
                .text("Practice", |fit| fit.practice.map_or_else(|| html! { "–" }, yes))
                .number("Result", |fit| match &*design.product_in_words(fit) {
                    FITS => html! { b { (FITS) } },
                    said => html! { (said) },
                })
                .render())
            @if let Some(said) = to_check { p.small { (clean(&said)) } }
        }
    }
}

/// Whose answer the rules are read at.
fn read_at(design: &Design) -> &'static str {
    match (design.answer().set_by, design.least_held()) {
        (SetBy::Practice, _) => ", the greatest that practice allows",
        (SetBy::Walk, Some(_)) => ", the coarsest that holds in the model",
        (SetBy::Walk, None) => "",
    }
}

/// Every rule of practice, at the answer.
pub(super) fn practice(design: &Design) -> Markup {
    let rules: Vec<&AppliedRule> = design.rules.iter().filter(|rule| rule.role != RuleRole::Walk).collect();
    html! {
        @if !rules.is_empty() {
            p {
                "For a filter with D15F/D85B " (ratio(design.rules_at))
                (read_at(design)) "."
                @if let Some(said) = design.judged_filter_in_words() { " " (unbroken(&said)) }
            }
            (rules::table(&rules, shown_in(design, &design.unit)))
        }
    }
}

/// What each network says.
pub(super) fn networks(design: &Design) -> Markup {
    let digits = |value: Option<f64>| value.map_or_else(|| "beyond".to_owned(), |v| format!("{v:.3}"));
    html! {
        @for row in &design.boundaries {
            h3 { (clean(&format!("{}, {}", row.density, row.thickness))) }
            (Table::of(&row.networks)
                .number("Network", |of| of.network)
                .number("No erosion up to D15F/D85B", |of| digits(of.no_erosion))
                .number("Continuing from", |of| digits(of.continuing))
                .render())
        }
    }
}

/// What was walked, and from what.
pub(super) fn made(design: &Design, walks: &[WalkRow]) -> Markup {
    let [low, high] = design.bracket;
    let size = |value: Option<f64>| value.map_or_else(|| "not known".to_owned(), |mm| format!("{mm:.4} mm"));
    let grains = design.boundaries.iter().find_map(|row| row.grains_per_void);
    let asked = design.settings.iter().map(|said| option_words(said)).collect::<Vec<_>>().join(" ");
    html! {
        table.facts { tbody {
            (fact("Base", file_name(&design.base.name)))
            (fact("Cu of the base as walked; D15 as sampled, D85 as walked", format!(
                "{}; {}, {}",
                design.base.cu.map_or_else(|| "not known".to_owned(), trimmed),
                size(design.base.d15_mm),
                size(design.base.d85_mm)
            )))
            @if let Some(base) = design.base.size() { (fact("D85B", base.words())) }
            (fact("Filter", file_name(&design.filter)))
            @if let Some(mm) = design.filter_d15_mm { (fact("D15F of the filter as given", size(Some(mm)))) }
            (fact("Cu of the filter", design.filter_cu.map_or_else(|| "not known".to_owned(), trimmed)))
            (fact("Grains per void", grains.map_or_else(|| "not given".to_owned(), trimmed)))
            @if !design.engine.is_empty() { (fact("Engine", &design.engine)) }
            (fact("Networks, seed", format!("{}, {}", whole(design.replicates), design.seed)))
            (fact("Searched", format!(
                "D15F/D85B {low} to {high}, outwards to steps of 8 %, in steps of {} %; {} ratios walked \
                 (design.csv)",
                trimmed(100.0 * design.step),
                whole(walks.len() as u64)
            )))
            (input_files(&design.inputs))
            (fact("Asked for", if asked.is_empty() { "nothing in particular" } else { &asked }))
        } }
    }
}
