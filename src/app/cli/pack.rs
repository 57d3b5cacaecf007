//! `voidwalk pack`: grains from a gradation, and their constrictions.

use super::args::PackArgs;
use super::print::{as_it_is, plain, to_stdout};
use super::progress::followed;
use crate::run::{self, FinishedPacking, PackOptions, RunError};
use crate::scene::Scene;
use crate::verdict::beside::packed_part;
use crate::words::sentence;
use voidwalk_practice::quantity::{SizeUnit, whole};

/// Packs a filter into a folder.
pub fn pack(args: &PackArgs) -> Result<(), RunError> {
    let spec = Scene::read_packing(&args.filter, &args.settings.assignments)?;
    let options = PackOptions {
        out: args.out.clone(),
        overwrite: args.overwrite,
        threads: args.threads,
        checkpoint_interval: args.checkpoint_every,
        ..PackOptions::default()
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
    let change = match record.friction == record.final_friction {
        true => String::new(),
        false => {
            format!(" ({:.4} before friction {} was set)", record.before.void_ratio, record.final_friction)
        }
    };
    let lines = [
        format!("Void ratio {:.4}{change} at {:.2} kPa", record.after.void_ratio, record.after.pressure_kpa),
        format!(
            "  {} grains, mean coordination number {:.2} ({:.2} without the {:.1} % rattlers), {} steps",
            whole(record.grains),
            record.after.coordination,
            record.after.coordination_held,
            100.0 * record.after.rattlers,
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
    lines.into_iter().chain(part).map(|line| plain(&line) + "\n").collect()
}
