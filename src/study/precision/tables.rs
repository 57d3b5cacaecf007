//! A precision study as tidy tables.

use crate::outcome::precision::{NetworkRow, Precision};
use crate::outcome::table::csv_of;

/// Names and content of the CSV files, one observation a row.
pub(super) fn tables(of: &Precision, networks: &[NetworkRow]) -> Vec<(&'static str, Vec<u8>)> {
    let exact = of.exact.iter().flat_map(|exact| {
        [
            ("exact.csv", csv_of(&exact.rows)),
            ("exact_slopes.csv", csv_of(&exact.slopes)),
            ("exact_closed.csv", csv_of(&exact.closed)),
            ("exact_networks.csv", csv_of(networks)),
        ]
    });
    let sampling = of.sampling.iter().flat_map(|sampling| {
        [("sampling.csv", csv_of(&sampling.rows)), ("sampling_merit.csv", csv_of(&sampling.lines))]
    });
    let bias = of.bias.iter().map(|bias| ("bias.csv", csv_of(bias)));
    let decision = of.decision.iter().flat_map(|decision| {
        [("decision.csv", csv_of(&decision.rows)), ("decision_cases.csv", csv_of(&decision.cases))]
    });
    let scaling = of.scaling.iter().map(|scaling| ("scaling.csv", csv_of(scaling)));
    let packing = of.packing.iter().flat_map(|packing| {
        [("packing.csv", csv_of(&packing.packings)), ("triangulation.csv", csv_of(&packing.triangulations))]
    });
    exact.chain(sampling).chain(bias).chain(decision).chain(scaling).chain(packing).collect()
}
