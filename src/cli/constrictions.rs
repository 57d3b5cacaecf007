//! `voidwalk constrictions`: from a packing to its constriction curve.

use std::path::PathBuf;

use super::Exit;
use super::args::ConstrictionsArgs;
use super::print::{count, plain, to_stdout};
use super::run::refused_or_failed;
use crate::constrictions::Constrictions;
use crate::packing::Packing;
use crate::store::Folder;

/// Measures a packing's constrictions and writes them into a folder.
pub fn constrictions(args: &ConstrictionsArgs) -> Result<(), Exit> {
    let packing = Packing::read(&args.packing).map_err(Exit::refused)?;
    let found = Constrictions::measure(&packing, args.merge_overlap).map_err(Exit::refused)?;
    let summary = found.summary().map_err(Exit::failed)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("voidwalk-constrictions"));
    let folder = Folder::open(&out).map_err(refused_or_failed)?;
    if folder.has("constrictions.json") && !args.overwrite {
        let problem =
            format!("{}: holds constrictions already; name another folder or add --overwrite", out.display());
        return Err(Exit::refused(plain(&problem)));
    }
    folder.write("grains.vtp", packing.to_vtp().as_bytes()).map_err(Exit::failed)?;
    for (name, text) in found.files().map_err(Exit::failed)? {
        folder.write(name, text.as_bytes()).map_err(Exit::failed)?;
        if args.json && name.ends_with(".json") {
            to_stdout(&text);
        }
    }
    if args.json {
        return Ok(());
    }
    to_stdout(&plain_lines(&[
        format!("{} grains, void ratio {:.4}", count(summary.grains as u64), summary.void_ratio),
        format!(
            "{} voids, {:.3} grains per void (Eq. 2), {:.2} constrictions a void on average",
            count(summary.voids as u64),
            summary.grains_per_void,
            summary.mean_connectivity
        ),
        format!(
            "{} constrictions, Cu_CSD {:.3}, merge_overlap {}",
            count(summary.constrictions as u64),
            summary.cu_csd,
            args.merge_overlap
        ),
        format!("for a scene: filter.curve = \"{}\"", out.join("constrictions.csv").display()),
    ]));
    Ok(())
}

fn plain_lines(lines: &[String]) -> String {
    lines.iter().map(|line| plain(line) + "\n").collect()
}
