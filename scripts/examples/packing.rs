//! From a gradation to grains, constrictions and a curve, stage by stage: `cargo run --release --example
//! packing`.

use std::error::Error;
use voidwalk::packing::{Settings, compress};
use voidwalk::{Constrictions, Gradation};

fn main() -> Result<(), Box<dyn Error>> {
    let filter = Gradation::linear_from_d0(1.0, 1.5)?;
    let settings = Settings { grains: 400, friction: 0.3, ..Settings::default() };
    let (packing, report) = compress(&filter, &settings, |_| true)?;
    println!("{} grains, void ratio {:.3}", packing.x.len(), report.after.void_ratio);
    let found = Constrictions::measure(&packing, voidwalk::constrictions::DEFAULT_MERGE_OVERLAP)?;
    let curve = found.curve()?;
    for percent in [0.0, 15.0, 50.0, 85.0, 100.0] {
        println!("Dc{percent}: {:.3} mm", curve.dc(percent).ok_or("the curve has every percent")?);
    }
    println!("{:.2} grains per void", found.grains_per_void());
    Ok(())
}
