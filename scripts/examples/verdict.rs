//! Two sieve tables in, a verdict out: `cargo run --release --example verdict -- FILTER.csv BASE.csv`.
//!
//! The constrictions are estimated from the filter's gradation; `filter.density=loose` instead of
//! `filter.estimate` packs its grains.

use std::error::Error;
use voidwalk::practice::quantity::SizeUnit;
use voidwalk::words::sentence;
use voidwalk::{Callbacks, Case, Scene, walk_case};

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let [filter, base] = files.as_slice() else { return Err("name two sieve tables: filter, base".into()) };
    let scene = Scene::built_in(&[
        format!("filter.sieve={filter}"),
        "filter.estimate=0.5".into(),
        "filter.grains_per_void=0.6".into(),
        format!("base.sieve={base}"),
        "network.nx=20".into(),
        "network.ny=20".into(),
        "record.sensitivity=[]".into(),
    ])?;
    let case = Case::new(scene)?;
    let outcome = walk_case(&case, &Callbacks::default())?;
    if let Some(headline) = outcome.headline {
        println!("Practice: {}", headline.words());
    }
    println!("Model (research): {}", outcome.model.class.words());
    for run in &outcome.summary {
        println!("run {}: {:.2} % of the mass eroded", run.run, 100.0 * run.eroded_mass_fraction.mean);
    }
    outcome.notes.iter().for_each(|note| println!("- {}", sentence(note, SizeUnit::Mm)));
    Ok(())
}
