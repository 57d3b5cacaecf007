//! `voidwalk constrictions`: from a packing to its constriction curve.

use super::args::ConstrictionsArgs;
use super::print::{as_it_is, json, plain, to_stdout, whole};
use super::progress::unfollowed;
use crate::run::{ConstrictionsOptions, RunError, measure_constrictions};
use voidwalk_core::packing::ReadOptions;
use voidwalk_core::store::format;

/// Measures a packing's constrictions and writes them into a folder.
pub fn constrictions(args: &ConstrictionsArgs) -> Result<(), RunError> {
    let options = ConstrictionsOptions {
        merge_overlap: args.merge_overlap,
        facets: args.facets,
        read: ReadOptions { unit: args.unit, cell: args.cell },
        out: args.out.clone(),
        overwrite: args.overwrite,
    };
    let summary = measure_constrictions(&args.packing, &options, &unfollowed())?;
    if args.json {
        as_it_is(&json(format::CONSTRICTIONS, &summary)?);
        return Ok(());
    }
    let mut lines = vec![
        format!("{} grains, void ratio {:.4}", whole(summary.grains as u64), summary.void_ratio),
        format!(
            "{} voids, {:.3} grains per void (Eq. 2), {:.2} constrictions a void on average",
            whole(summary.voids as u64),
            summary.grains_per_void,
            summary.mean_connectivity
        ),
        format!(
            "{} constrictions, Cu_CSD {:.3}, merge_overlap {}",
            whole(summary.constrictions as u64),
            summary.cu_csd,
            args.merge_overlap
        ),
        String::new(),
        format!("for a scene: filter.curve = \"{}\"", args.out.join("constrictions.csv").display()),
    ];
    let permeability = summary.k_over_d32_squared.zip(summary.kozeny_carman_over_d32_squared);
    lines[3] = match permeability {
        Some((k, kc)) => format!(
            "permeability {k:.3e} d32 squared along z, {:.2} times Kozeny and Carman's; the void \
             graph: graph.csv",
            k / kc
        ),
        None => "no void graph: it needs a periodic cell through which no void runs from end to end".into(),
    };
    lines.splice(1..1, summary.warnings.iter().map(|warning| format!("warning: {warning}")));
    to_stdout(&lines.iter().map(|line| plain(line) + "\n").collect::<String>());
    Ok(())
}
