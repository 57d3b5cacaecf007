//! The section on connectivity of a report page: Table 3 of the paper for this run.

use maud::{Markup, html};

use super::run_figures::run_name;
use super::table::Table;
use super::walks::Walks;
use crate::outcome::by_connectivity::of_replicates;
use crate::outcome::record::ByConnectivity;
use crate::outcome::table::Columns;
use voidwalk_practice::quantity::{percent, significant, whole};

/// Empty if all voids have the same connectivity.
pub(super) fn by_connectivity(walks: &Walks) -> Markup {
    let runs: Vec<(u64, Vec<ByConnectivity>)> = walks
        .runs()
        .map(|run| (run, of_replicates(walks.replicates, run)))
        .filter(|(_, rows)| !rows.is_empty())
        .collect();
    html! {
        @if !runs.is_empty() {
            h2 { "By connectivity of the void" }
            p {
                "A void’s connectivity is the number of its entrances and exits. The network is not \
                 uniform: voids with few "
                "connections close early and then retain whatever enters (Table 3 of the paper). All \
                 replicates together."
            }
            @for (run, rows) in &runs { (of_run(*run, rows)) }
        }
    }
}

fn of_run(run: u64, rows: &[ByConnectivity]) -> Markup {
    let sum = |count: fn(&ByConnectivity) -> u64| rows.iter().map(count).sum::<u64>();
    let retained = sum(|r| r.retained_in_constrictions + r.retained_in_voids);
    let blocked = |blocked: u64, all: u64| percent(blocked as f64 / all.max(1) as f64);
    let columns = Columns::default()
        .number("connectivity", "Connectivity", |row: &ByConnectivity| row.connectivity.to_string())
        .number("voids", "Share of voids", |row| percent(row.voids_fraction))
        .number("retained_per_void", "Retained per void", |row| row.retained_per_void)
        .number("retained", "Share of retained", |row| percent(row.retained_fraction))
        .number("blocked", "Exits blocked", |row| blocked(row.blocked, row.constrictions));
    let all = html! { tr {
        th { "All (" (whole(sum(|r| r.voids))) " voids)" }
        td.n { (percent(1.0)) }
        td.n { (significant(retained as f64 / sum(|r| r.voids) as f64)) }
        td.n { (percent(1.0)) }
        td.n { (blocked(sum(|r| r.blocked), sum(|r| r.constrictions))) }
    } };
    html! {
        h3 { span class={ "run-" (run) } { (run_name(run)) } }
        (Table::of(rows, columns).more(all))
    }
}
