//! The page of a precision study: what a second of processor time buys, tier by tier.

mod figures;
mod judgements;
mod tables;

use std::path::Path;

use maud::{Markup, html};

use super::error::ReportError;
use super::files::json;
use super::section::Sections;
use super::shell::{Drawn, clean, fact};
use super::written::Written;
use crate::outcome::precision::Precision;
use crate::outcome::quantity::{duration, whole};

pub use judgements::precision_judgements;

/// A tier on the page.
struct Tier {
    name: &'static str,
    heading: &'static str,
    question: String,
    figures: Vec<Drawn>,
    tables: Markup,
}

/// Writes `precision.html` and its figures into the folder of a precision study, from `precision.json` alone.
///
/// # Errors
/// `precision.json` is missing or malformed, or a file cannot be written.
pub fn write_precision(folder: &Path) -> Result<Written, ReportError> {
    let study: Precision = json(&folder.join("precision.json"))?;
    let judgements = precision_judgements(&study);
    let title = "Error against run time";
    let lead = html! { p {
        "This page shows how much accuracy a second of processor time buys. Errors are standard deviations \
         over replicates. They are not estimated from the number of particles, because all particles of a \
         run share one network. Bars are 95 % intervals. The figure of merit is 1 / (error² × time). It \
         does not depend on the number of replicates. Of two settings, the one with the larger figure of \
         merit reaches the same accuracy in less time."
    } };
    let mut page = Sections::new(title, title, &html! { (clean(&study.scene)) })
        .words(&lead)
        .words(&tables::merits(&study))
        .contents();
    for tier in tiers(&study) {
        let words = html! {
            p { (clean(&tier.question)) }
            @for (_, sentence) in judgements.iter().filter(|(name, _)| *name == tier.name) {
                p { b { (clean(sentence)) } }
            }
        };
        page = page.section(tier.heading, &words).figures(tier.figures).words(&tier.tables);
    }
    let footer = html! { p.small { "voidwalk " (study.version) ", " (duration(study.seconds)) "." } };
    page.section("How this was made", &made(&study)).write(folder, "precision.html", &footer)
}

fn tiers(study: &Precision) -> Vec<Tier> {
    let exact = study.exact.as_ref().map(|exact| Tier {
        name: "exact",
        heading: "Against exact answers",
        question: "A linear solve gives the exact probability that the first particle leaves a given \
                   network. Does every engine find this probability? Does its error fall as it does for \
                   independent particles?"
            .into(),
        figures: figures::exact(exact),
        tables: tables::exact(exact),
    });
    let sampling = study.sampling.as_ref().map(|sampling| Tier {
        name: "sampling",
        heading: "Scatter of this scene",
        question: format!(
            "Eroded mass of the first run, walked on {}. Replicates differ in network and walk, or in the \
             walk alone. No sampling of the base particles removes the scatter between networks.",
            sampling.on
        ),
        figures: figures::sampling(sampling),
        tables: tables::sampling(sampling),
    });
    let bias = study.bias.as_ref().map(|bias| Tier {
        name: "bias",
        heading: "What settings do to the answer",
        question:
            "One setting is changed at a time. A difference whose interval excludes zero is a bias. More \
             replicates do not remove it."
                .into(),
        figures: figures::bias(bias),
        tables: tables::bias(bias),
    });
    let decision = study.decision.as_ref().map(|decision| Tier {
        name: "decision",
        heading: "Wrong verdicts",
        question: format!(
            "How often is the class wrong, and how does that depend on the time spent? The cases lie near \
             the 7.5 % that divides \"no erosion\" from the rest. They are this scene with other base \
             sizes, walked on {}.",
            decision.on
        ),
        figures: figures::decision(decision),
        tables: tables::decision(decision),
    });
    let scaling = study.scaling.as_ref().map(|scaling| Tier {
        name: "scaling",
        heading: "What a larger problem costs",
        question: "Processor time of a first run.".into(),
        figures: figures::scaling(scaling),
        tables: tables::scaling(scaling),
    });
    let packing = study.packing.as_ref().map(|packing| Tier {
        name: "packing",
        heading: "Packing and triangulation",
        question: "Small packings of this scene's filter are compared by void ratio and constriction \
                   curve, with one setting changed at a time. Triangulations are timed, and their \
                   geometric identities are checked."
            .into(),
        figures: figures::packing(packing),
        tables: tables::packing(packing),
    });
    [exact, sampling, bias, decision, scaling, packing].into_iter().flatten().collect()
}

fn made(study: &Precision) -> Markup {
    html! {
        div.scroll { table.facts { tbody {
            (fact("Started (UTC)", &study.started))
            (fact("Machine", &study.machine))
            (fact("Commit", study.commit.as_deref().unwrap_or("not known")))
            (fact("Seed", study.seed.to_string()))
            (fact("Budget of processor time", duration(study.budget_s)))
            @for (tier, seconds) in &study.spent {
                (fact(&format!("Processor time, {tier}"), duration(*seconds)))
            }
            (fact("Base particles of a run", whole(study.n_base)))
            (fact("Voids", whole(study.voids)))
        } } }
        p.small {
            "The same seed and budget give the same numbers on every machine; only times differ. Each run \
             uses one thread, and its time is the processor time of that thread. The numbers of every \
             figure are in the CSV files beside this page."
        }
    }
}
