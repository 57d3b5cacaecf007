//! The figures of the campaign: Figs. 14 to 17, 19 and 20.

use super::scatter::{Group, Plot, across, colour_of, scatter};
use crate::measures::{blocked, of_both_runs, twins};
use crate::study::{Case, Study};
use voidwalk::outcome::record::Statistic;
use voidwalk::report::figures::{Across, BLUE, PURPLE, Rule, Shape, VERMILLION};
use voidwalk::report::shell::Drawn;

const MAIN: &str = "paper";
const D85: &str = "D15F / D85B (–)";
const D95: &str = "D15F / D95B (–)";
const ERODED: &str = "Base eroded, by mass (%)";

fn alone(mean: f64) -> Statistic {
    Statistic { mean, sd: None, low: None, high: None }
}

/// The rules that the paper states for D15F/D85B; Sherard and Dunnigan's limits it does not state.
fn d85_rules() -> Vec<Rule> {
    vec![
        across(Across::Y, 7.5, "7.5 %"),
        across(Across::X, 4.0, "4: Terzaghi"),
        across(Across::X, 5.0, "5: the paper"),
        across(Across::X, 7.0, "7: Foster and Fell, no erosion"),
    ]
}

fn d95_rules() -> Vec<Rule> {
    vec![
        across(Across::Y, 7.5, "7.5 %"),
        across(Across::X, 4.7, "4.7: the paper"),
        across(Across::X, 9.0, "9: Foster and Fell, some erosion"),
    ]
}

/// Figs. 14 and 15: both runs of all bases on loose or on dense filters.
fn erosion(
    study: &Study,
    density: &str,
    plot: Plot,
    rules: Vec<Rule>,
    ratio: fn(&Case) -> f64,
) -> Option<Drawn> {
    let cases = study.cases(MAIN);
    let mut groups = Vec::new();
    for cu_b in ["1.5", "3", "4.5"] {
        for (cu_f, shape) in [("cu1.5", Shape::Circle), ("cu3", Shape::Diamond)] {
            for (run, hollow) in [(1, false), (2, true)] {
                let filter = format!("{cu_f}-{density}");
                let own = cases.iter().filter(|c| c.level("filter") == filter && c.level("cu_b") == cu_b);
                let points = own.filter_map(|case| Some((ratio(case), case.eroded(run)?))).collect();
                let run = if hollow { "second" } else { "first" };
                let label = format!("base Cu {cu_b}, filter Cu {}, {run} run", &cu_f[2..]);
                groups.push(Group { label, colour: colour_of(cu_b), shape, hollow, joined: false, points });
            }
        }
    }
    scatter(plot, rules, groups)
}

fn titled(name: &'static str, title: &'static str, caption: &str) -> Plot {
    Plot { name, title, caption: caption.into(), x: D85, y: ERODED, percent: true, reach: (2.5, 7.2) }
}

pub fn fig_14(study: &Study) -> Vec<Drawn> {
    let caption = "Sherard and Dunnigan vary the limit with the base; the paper states none of their \
                   numbers, so none is drawn.";
    let a = titled("fig14a", "Fig. 14(a): loose filters", caption);
    let b = titled("fig14b", "Fig. 14(b): dense filters", caption);
    let drawn = [("loose", a), ("dense", b)];
    drawn.into_iter().filter_map(|(d, plot)| erosion(study, d, plot, d85_rules(), Case::d85_ratio)).collect()
}

pub fn fig_15(study: &Study) -> Vec<Drawn> {
    let plot = |name, title| Plot { x: D95, reach: (2.0, 9.2), ..titled(name, title, "") };
    let (a, b) = (plot("fig15a", "Fig. 15(a): loose filters"), plot("fig15b", "Fig. 15(b): dense filters"));
    let drawn = [("loose", a), ("dense", b)];
    drawn.into_iter().filter_map(|(d, plot)| erosion(study, d, plot, d95_rules(), Case::d95_ratio)).collect()
}

/// One group a filter: the base with Cu 1.5, first run.
fn by_filter(study: &Study, filters: [&str; 2], of: fn(&Case) -> Option<Statistic>) -> Vec<Group> {
    let cases = study.cases(MAIN);
    let look = [(BLUE, Shape::Circle), (VERMILLION, Shape::Diamond)];
    let group = |(filter, (colour, shape)): (&str, _)| {
        let own = cases.iter().filter(|c| c.level("filter") == filter && c.level("cu_b") == "1.5");
        let points = own.filter_map(|case| Some((case.d85_ratio(), of(case)?))).collect();
        Group { label: filter.into(), colour, shape, hollow: false, joined: true, points }
    };
    filters.into_iter().zip(look).map(group).collect()
}

fn kenney() -> Vec<Rule> {
    vec![across(Across::Y, 0.2, "0.2: Kenney et al., Dc* ≤ D15F/5")]
}

pub fn fig_16(study: &Study) -> Vec<Drawn> {
    let filters = ["cu1.5-loose", "cu3-loose"];
    let a = Plot {
        y: "Largest eroded / D0F (–)",
        percent: false,
        ..titled(
            "fig16a",
            "Fig. 16(a): largest eroded particle over D0F",
            "Base with Cu 1.5, loose filters, first run.",
        )
    };
    let b = titled("fig16b", "Fig. 16(b): proportion eroded", "Base with Cu 1.5, loose filters, first run.");
    let c = Plot {
        y: "Largest eroded / D15F (–)",
        percent: false,
        ..titled(
            "fig16c",
            "Fig. 16(c): largest eroded particle over D15F",
            "Base with Cu 1.5, loose filters, first run.",
        )
    };
    [
        scatter(a, Vec::new(), by_filter(study, filters, |case| case.largest_over_d0f(1))),
        scatter(b, d85_rules(), by_filter(study, filters, |case| case.eroded(1))),
        scatter(c, kenney(), by_filter(study, filters, |case| case.largest(1))),
    ]
    .into_iter()
    .flatten()
    .collect()
}

pub fn fig_17(study: &Study) -> Vec<Drawn> {
    let filters = ["cu1.5-loose", "cu1.5-dense"];
    let caption = "Filter and base with Cu 1.5, first run.";
    let a = Plot {
        y: "Largest eroded / D0F (–)",
        percent: false,
        ..titled("fig17a", "Fig. 17(a): largest eroded particle by density", caption)
    };
    let b = titled("fig17b", "Fig. 17(b): proportion eroded by density", caption);
    [
        scatter(a, Vec::new(), by_filter(study, filters, |case| case.largest_over_d0f(1))),
        scatter(b, d85_rules(), by_filter(study, filters, |case| case.eroded(1))),
    ]
    .into_iter()
    .flatten()
    .collect()
}

pub fn fig_19(study: &Study) -> Vec<Drawn> {
    let cases = study.cases(MAIN);
    let groups = |of: fn((f64, f64)) -> f64| {
        let group = |cu_b: &str| {
            let own = cases.iter().filter(|case| case.is_loose() && case.level("cu_b") == cu_b);
            let points =
                own.filter_map(|case| Some((of(blocked(case)?), alone(of_both_runs(case))))).collect();
            let (label, colour) = (format!("base Cu {cu_b}"), colour_of(cu_b));
            Group { label, colour, shape: Shape::Circle, hollow: false, joined: false, points }
        };
        ["1.5", "3", "4.5"].map(group).into_iter().collect()
    };
    let plot = |name, title, x| Plot {
        x,
        y: "Base eroded, mean of both runs (%)",
        reach: (0.0, 10.0),
        ..titled(name, title, "Loose filters, blocked after the second run.")
    };
    let a = plot("fig19a", "Fig. 19(a): blocked throughout", "Constrictions blocked, of all (%)");
    let b = plot(
        "fig19b",
        "Fig. 19(b): blocked in the first three layers",
        "Constrictions blocked, of the first three layers (%)",
    );
    let limit = vec![across(Across::X, 7.5, "7.5 %")];
    let drawn = [scatter(a, limit, groups(|both| both.0)), scatter(b, Vec::new(), groups(|both| both.1))];
    drawn.into_iter().flatten().collect()
}

pub fn fig_20(study: &Study) -> Vec<Drawn> {
    let twins = twins(study);
    let mut groups = Vec::new();
    for (cu_b, shape) in [("1.5", Shape::Circle), ("3", Shape::Diamond), ("4.5", Shape::Square)] {
        for (network, hollow, colour) in [("cubic", false, BLUE), ("as in Table 3", true, PURPLE)] {
            let own = twins.iter().filter(|(modified, _)| modified.level("cu_b") == cu_b);
            let of = |(modified, cubic): &(&Case, &Case)| {
                let case = if hollow { modified } else { cubic };
                Some((case.d85_ratio(), case.eroded(1)?))
            };
            let points = own.filter_map(of).collect();
            let label = format!("base Cu {cu_b}, {network}");
            groups.push(Group { label, colour, shape, hollow, joined: true, points });
        }
    }
    let plot = titled("fig20", "Fig. 20: change of connectivity", "Loose filter with Cu 1.5, first run.");
    scatter(plot, d85_rules(), groups).into_iter().collect()
}
