//! A precision study as tidy tables.

use serde::Serialize;

use crate::outcome::precision::{NetworkRow, Precision};

/// Names and content of the CSV files, one observation a row.
///
/// # Errors
/// None that numbers and names could cause.
pub(super) fn tables(
    of: &Precision,
    networks: &[NetworkRow],
) -> Result<Vec<(&'static str, Vec<u8>)>, csv::Error> {
    let mut files = Vec::new();
    if let Some(exact) = &of.exact {
        files.push(("exact.csv", table(&exact.rows)?));
        files.push(("exact_slopes.csv", table(&exact.slopes)?));
        files.push(("exact_closed.csv", table(&exact.closed)?));
        files.push(("exact_networks.csv", table(networks)?));
    }
    if let Some(sampling) = &of.sampling {
        files.push(("sampling.csv", table(&sampling.rows)?));
        files.push(("sampling_merit.csv", table(&sampling.lines)?));
    }
    if let Some(bias) = &of.bias {
        files.push(("bias.csv", table(bias)?));
    }
    if let Some(decision) = &of.decision {
        files.push(("decision.csv", table(&decision.rows)?));
        files.push(("decision_cases.csv", table(&decision.cases)?));
    }
    if let Some(scaling) = &of.scaling {
        files.push(("scaling.csv", table(scaling)?));
    }
    if let Some(packing) = &of.packing {
        files.push(("packing.csv", table(&packing.packings)?));
        files.push(("triangulation.csv", table(&packing.triangulations)?));
    }
    Ok(files)
}

fn table(rows: &[impl Serialize]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}
