//! Commands `voidwalk pack` and `constrictions`: grains from a gradation, and the constrictions of a packing.

use super::args::{ConstrictionsArgs, PackArgs};
use super::print::{self, as_it_is, to_stdout};
use super::progress::{followed, unfollowed};
use crate::run;
use crate::run::{ConstrictionsOptions, FinishedPacking, PackOptions, RunError, measure_constrictions};
use crate::scene::Scene;
use crate::verdict::walks::packed_part;
use crate::words::sentence;
use voidwalk_core::packing::ReadOptions;
use voidwalk_core::store::format;
use voidwalk_practice::quantity::{SizeUnit, whole};

pub(crate) fn pack(args: &PackArgs) -> Result<(), RunError> {
    let spec = Scene::read_packing(&args.filter, &args.settings.assignments)?;
    let options = PackOptions {
        out: args.out.clone(),
        overwrite: args.overwrite,
        threads: args.threads,
        checkpoint_interval: args.checkpoint_every,
    };
    let packing = followed(args.quiet, |callbacks| run::pack(&spec, &options, callbacks))?;
    if args.json {
        as_it_is(&packing.json);
    } else if !args.quiet {
        to_stdout(&summary(&packing));
    }
    Ok(())
}

fn summary(packing: &FinishedPacking) -> String {
    let (record, filter, out) = (&packing.record, &packing.filter, &packing.folder);
    let (before, after) = (&record.before, &record.after);
    let change = match record.friction == record.final_friction {
        true => String::new(),
        false => format!(" ({:.4} before friction {} was set)", before.void_ratio, record.final_friction),
    };
    let lines = [
        format!("Void ratio {:.4}{change} at {:.2} kPa", after.void_ratio, after.pressure_kpa),
        format!(
            "  {} grains, mean coordination number {:.2} ({:.2} without the {:.1} % rattlers), {} steps",
            whole(record.grains),
            after.coordination,
            after.coordination_held,
            100.0 * after.rattlers,
            whole(record.steps)
        ),
        format!(
            "  Cu_CSD {:.3}, Dc5 {:.4} mm, Dc50 {:.4} mm, {:.3} grains per void (Eq. 2)",
            filter.curve.cu(),
            filter.curve.dc(5.0).unwrap_or(f64::NAN),
            filter.curve.dc(50.0).unwrap_or(f64::NAN),
            filter.grains_per_void
        ),
        format!("{:.1} s; report: {}", record.seconds, out.join("report.html").display()),
        format!("for a scene: filter.curve = \"{}\"", out.join("constrictions.csv").display()),
    ];
    let part = filter.part.iter().map(|part| format!("  {}", sentence(&packed_part(part), SizeUnit::Mm)));
    print::lines(lines.into_iter().chain(part))
}

pub(crate) fn constrictions(args: &ConstrictionsArgs) -> Result<(), RunError> {
    let options = ConstrictionsOptions {
        merge_overlap: args.merge_overlap,
        facets: args.facets,
        read: ReadOptions { unit: args.unit, cell: args.cell },
        out: args.out.clone(),
        overwrite: args.overwrite,
    };
    let summary = measure_constrictions(&args.packing, &options, &unfollowed())?;
    if args.json {
        as_it_is(&format::CONSTRICTIONS.json(&summary)?);
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
        match summary.k_over_d32_squared.zip(summary.kozeny_carman_over_d32_squared) {
            Some((k, kc)) => format!(
                "permeability {k:.3e} d32 squared along z, {:.2} times Kozeny and Carman's; the void \
                 graph: graph.csv",
                k / kc
            ),
            None => {
                "no void graph: it needs a periodic cell through which no void runs from end to end".into()
            }
        },
        format!("for a scene: filter.curve = \"{}\"", args.out.join("constrictions.csv").display()),
    ];
    lines.splice(1..1, summary.warnings.iter().map(|warning| format!("warning: {warning}")));
    to_stdout(&print::lines(lines));
    Ok(())
}
