//! The page: each figure of the paper with ours, every statement beside ours, every combination.

use std::path::Path;

use maud::{Markup, html};
use voidwalk::outcome::record::Verdict;
use voidwalk::outcome::{Modelled, leaves_out};
use voidwalk::report::quantity::{duration, significant, whole};
use voidwalk::report::shell::{Drawn, clean, drawing, whole_page};
use voidwalk::report::{ReportError, Written, write_page};
use voidwalk::store::write_whole;
use voidwalk::words::left_out::model_limit;

use crate::figures;
use crate::measured::Measured;
use crate::statements::{self, Judged, Judgement, Standing};
use crate::study::{Case, Study, VARIANTS};

/// A figure or table of the paper: its key in the statements, its heading, what is drawn for it.
type Section = (&'static str, &'static str, fn(&Study) -> Vec<Drawn>);

const SECTIONS: [Section; 15] = [
    ("6", "Fig. 6 and the first checks: percolation, one size", figures::fig_6),
    ("table2", "Table 2: the filters", |_| Vec::new()),
    ("7", "Fig. 7: gradations and constriction curves", figures::fig_7),
    ("8", "Fig. 8: Kenney’s tests, filter with Cu 1.2", figures::fig_8),
    ("9", "Fig. 9: Kenney’s tests, filter with Cu 3", figures::fig_9),
    ("10", "Fig. 10: Kenney’s tests, filter with Cu 6", figures::fig_10),
    ("13", "Fig. 13: one case of each class", figures::fig_13),
    ("14", "Fig. 14: erosion against D15F/D85B, and reruns", figures::fig_14),
    ("15", "Fig. 15: erosion against D15F/D95B", figures::fig_15),
    ("16", "Fig. 16: influence of the filter’s Cu", figures::fig_16),
    ("17", "Fig. 17: influence of the filter’s density", figures::fig_17),
    ("18", "Fig. 18: what is retained", figures::fig_18),
    ("19", "Fig. 19: erosion against blocked constrictions", figures::fig_19),
    ("table3", "Table 3: connectivity", |_| Vec::new()),
    ("20", "Fig. 20: erosion on the modified network", figures::fig_20),
];

/// Writes `report.html`, `figures/*.svg` and `statements.csv` into the folder of a reproduction.
///
/// # Errors
/// A file that is missing or malformed; nothing is written then.
pub fn write(folder: &Path) -> Result<Written, ReportError> {
    let study = Study::read(folder)?;
    if study.is_empty() {
        return Err(ReportError::Value {
            path: folder.to_owned(),
            field: "cases".into(),
            value: "none".into(),
            allowed: "folders of the plans in scripts/campaigns, filled by scripts/paper/paper.sh".into(),
        });
    }
    let judged = statements::judged(&study);
    let sections: Vec<(&Section, Vec<Drawn>)> = SECTIONS.iter().map(|s| (s, s.2(&study))).collect();
    let page = page(&study, &judged, &sections);
    let figures: Vec<Drawn> = sections.into_iter().flat_map(|(_, drawn)| drawn).collect();
    write_whole(&folder.join("statements.csv"), statements::table(&judged).as_bytes())?;
    write_page(folder, &figures, &page)
}

fn page(study: &Study, judged: &[Judged], sections: &[(&Section, Vec<Drawn>)]) -> String {
    let title = "The paper’s numbers, and ours";
    let count = |wanted: fn(Judgement) -> bool| judged.iter().filter(|j| j.counts_as(wanted)).count();
    let (agree, differ) = (count(|j| j == Judgement::Agrees), count(|j| matches!(j, Judgement::Differs(_))));
    let (counted, of) =
        (count(|_| true), |standing| judged.iter().filter(|j| j.standing() == standing).count());
    let (set, fitted, readings) = (of(Standing::Set), of(Standing::Fitted), of(Standing::Reading));
    let always = of(Standing::Always);
    let header = html! {
        h1 { (title) }
        p.names { "Shire and O’Sullivan, " cite { "A network model to assess base-filter combinations" } }
    };
    let main = html! {
        div.first {
            section {
                p.lead {
                    "Of " (counted) " statements, " b { (agree) " agree" } ", "
                    b { (differ) " differ" } ", and "
                    b { (counted - agree - differ) } " inconclusive."
                }
                p {
                    (judged.len() - counted) " more are shown and not counted: " (set) " that the plans set, \
                     so that they agree or differ by construction; " (always) " that is kept whatever \
                     the model; " (fitted) " that our rule for merging \
                     voids was fitted to; " (readings) " other readings of statements that are counted."
                }
                p {
                    "A statement agrees when our value lies within what the paper states and its tolerance, \
                     or when our 95 % interval covers the stated value; inconclusive when nothing was \
                     walked or when the interval lies on both sides of what decides; it differs otherwise. \
                     No judgement is typed in, and nothing is tuned to the paper case by case. Where a \
                     number differs, the same is measured in campaigns that change what their names say: \
                     grains per void, cap, constriction curves, overlap rule."
                }
                (thickness(study))
            }
            aside.leaves {
                h2 { "What the model leaves out" }
                ul { @for limit in leaves_out(Modelled::default()) { li { (model_limit(limit)) } } }
            }
        }
        (what_differs(judged))
        @for ((key, heading, _), drawn) in sections {
            h2 { (heading) }
            @for drawn in drawn {
                figure {
                    (drawing(drawn))
                    figcaption { b { (drawn.figure.title()) ". " } (drawn.caption) }
                }
            }
            (statements_of(judged, key))
        }
        h2 { "Every statement in every campaign" }
        p.small {
            "The first column of ours is the one judged above. Empty: the campaign cannot say, or nothing \
             changes for it. ✗ differs, ? inconclusive."
        }
        (matrix(study, judged))
        h2 { "Every combination" }
        p.small {
            "Percent of the base eroded in the first and the second run, and the class: N no, S some, \
             C continuing erosion, ? undecided. These are all that the paper’s list of filters and bases \
             gives. It says that there were 66, which is the list without any one of the six sizes Dc5 to \
             Dc75; it does not say which, so none is left out here."
        }
        (combinations(study))
        (provenance(study))
    };
    let footer = html! { p.small { "Regenerated by " code { "scripts/paper/paper.sh" } "." } };
    whole_page(title, &header, &main, &footer)
}

/// How thick the filters of the campaign are: the paper counts layers and gives no length.
fn thickness(study: &Study) -> Markup {
    let mut all: Vec<(u64, String)> = Vec::new();
    for case in study.cases(VARIANTS[0].name) {
        let (network, filter) = (&case.outcome.inputs.network, &case.outcome.inputs.filter);
        let over =
            network.thickness_mm.map_or_else(String::new, |mm| significant(mm / filter.d0_mm).to_string());
        let of = filter.cu.map(|cu| ((100.0 * cu).round() / 100.0).to_string()).unwrap_or_default();
        let one = (network.layers, format!("{over} D0F with Cu {of}"));
        if !all.contains(&one) {
            all.push(one);
        }
    }
    let sizes: Vec<&str> = all.iter().map(|(_, size)| size.as_str()).collect();
    html! { @if let Some((layers, _)) = all.first() {
        p {
            "Every filter is " (layers) " layers of voids thick. With voids as far apart as the median grain \
             by number is wide, that is " (clean(&sizes.join(", "))) "; the paper gives no length. A thicker \
             filter erodes less at the same D15F/D85B: every boundary here is that of this thickness."
        }
    } }
}

/// The statements that differ, each in a line; not those that a setting or a second reading makes differ.
fn what_differs(judged: &[Judged]) -> Markup {
    let says = |j: &&Judged| matches!(j.standing(), Standing::Counted | Standing::Fitted);
    let differ: Vec<_> =
        judged.iter().filter(says).filter(|j| matches!(j.ours().1, Judgement::Differs(_))).collect();
    html! {
        @if !differ.is_empty() {
            h2 { "What differs, and in which campaign it does not" }
            ul { @for judged in differ {
                @let stated = &judged.statement;
                li {
                    (stated.says) ": paper " b { (stated.states) } ", ours "
                    @if let Some(measured) = judged.ours().0 { b { (ours(judged, measured)) } }
                    "; " (judged.sentence()) "."
                }
            } }
        }
    }
}

fn ours(judged: &Judged, measured: &Measured) -> String {
    let s = &judged.statement;
    let interval = measured.interval.map(|(low, high)| format!(" ({} to {})", s.show(low), s.show(high)));
    format!("{}{}", s.show(measured.value), interval.unwrap_or_default())
}

fn statements_of(judged: &[Judged], key: &str) -> Markup {
    let class = |judged: &Judged| match judged.ours().1 {
        _ if judged.standing() != Standing::Counted => "small",
        Judgement::Agrees => "keeps",
        Judgement::Differs(_) => "breaks",
        Judgement::Inconclusive => "small",
    };
    html! {
        div.scroll { table {
            thead { tr { th { "What" } th { "Paper" } th { "Ours (95 % interval)" } th { "Judgement" } } }
            tbody { @for judged in judged.iter().filter(|judged| judged.statement.shown == key) {
                @let (measured, judgement) = judged.ours();
                @let beside = judged.beside();
                tr {
                    td { (judged.statement.says) br; span.small { (judged.statement.place) } }
                    td { (judged.statement.states) br; span.small { (judged.statement.why) } }
                    td {
                        @if let Some(measured) = measured {
                            (ours(judged, measured)) br; span.small { (measured.words) }
                        } @else { "–" }
                        @for (title, value) in beside { br; span.small { (title) ": " (value) } }
                    }
                    td { @match judgement {
                        Judgement::Differs(_) => { (judged.sentence()) },
                        _ => span class=(class(judged)) { (judged.sentence()) },
                    } }
                }
            } }
        } }
    }
}

fn matrix(study: &Study, judged: &[Judged]) -> Markup {
    let variants: Vec<_> = study.variants().collect();
    let cell = |judged: &Judged, name: &str| {
        let found = judged.variants.iter().find(|ours| ours.variant.name == name);
        let Some((ours, measured)) = found.and_then(|ours| Some((ours, ours.measured.as_ref()?))) else {
            return String::new();
        };
        let sign = match ours.judgement {
            _ if ours.standing == Standing::Set => "",
            Judgement::Agrees => "",
            Judgement::Differs(_) => " ✗",
            Judgement::Inconclusive => " ?",
        };
        format!("{}{sign}", judged.statement.show(measured.value))
    };
    html! {
        div.scroll { table.replicates {
            thead { tr {
                th { "Statement" } th { "Paper" }
                @for variant in &variants { th.n { (variant.title) } }
            } }
            tbody { @for judged in judged { tr {
                th { (judged.statement.id) @if judged.standing() != Standing::Counted { " (not counted)" } }
                td { (judged.statement.states) }
                @for variant in &variants { td.n { (cell(judged, variant.name)) } }
            } } }
        } }
    }
}

fn combinations(study: &Study) -> Markup {
    let variants: Vec<_> = study.variants().collect();
    let class = |case: &Case| match case.line.verdict {
        Verdict::None => "N",
        Verdict::Some => "S",
        Verdict::Continuing => "C",
        Verdict::Undecided => "?",
    };
    let cell = |name: &str, case: &Case| {
        let levels = ["filter", "cu_b", "d85b"].map(|factor| (factor, case.level(factor)));
        let Some(case) = study.case(name, &levels) else { return String::new() };
        let capped = if case.line.capped { " capped" } else { "" };
        format!("{:.1} → {:.1} {}{capped}", case.mean(1), case.mean(2), class(case))
    };
    let Some(first) = variants.first() else { return html! {} };
    html! {
        div.scroll { table.replicates {
            thead { tr {
                th { "filter" } th.n { "base Cu" } th { "D85B" }
                th.n { "D15F/D85B" } th.n { "D15F/D95B" } th.n { "N_base" }
                @for variant in &variants { th.n { (variant.title) } }
            } }
            tbody { @for case in study.cases(first.name) { tr {
                td { (clean(case.level("filter"))) }
                td.n { (clean(case.level("cu_b"))) }
                td { (clean(case.level("d85b"))) }
                td.n { (significant(case.d85_ratio())) }
                td.n { (significant(case.d95_ratio())) }
                td.n { (whole(case.line.n_base)) }
                @for variant in &variants { td.n { (cell(variant.name, case)) } }
            } } }
        } }
    }
}

fn provenance(study: &Study) -> Markup {
    let unlike = |of: fn(&Case) -> String| {
        let mut all: Vec<String> = study.walked().iter().flat_map(|walked| &walked.cases).map(of).collect();
        all.sort_unstable();
        all.dedup();
        clean(&all.join(", "))
    };
    let fewest = |cases: &[Case]| cases.iter().map(|case| case.line.replicates).min().unwrap_or(0);
    html! {
        h2 { "How this was made" }
        table {
            thead { tr { th { "Plan" } th.n { "cases" } th.n { "replicates" } th.n { "walks" } } }
            tbody { @for walked in study.walked() { tr {
                td { code { "scripts/campaigns/" (walked.name) ".toml" } }
                td.n { (walked.cases.len()) }
                td.n { (fewest(&walked.cases)) }
                td.n { (duration(walked.cases.iter().map(|case| case.line.made.seconds).sum())) }
            } } }
        }
        p {
            "voidwalk " (unlike(|case| case.line.version.clone())) ", commit "
            (unlike(|case| case.line.commit.clone().unwrap_or_else(|| "not known".into()))) "."
            " Seeds are in the plans; each case’s own is in its ledger."
        }
    }
}
