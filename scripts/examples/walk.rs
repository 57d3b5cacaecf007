//! The core alone: a lattice, a base, one walk, and where its particles came to rest: `cargo run --release
//! --example walk`.

use std::error::Error;

use bitvec::vec::BitVec;
use voidwalk::constrictions::find;
use voidwalk::gradation::SizeSampler;
use voidwalk::walk::{Engine, RunPlan, SizeClasses, State, WalkControl};
use voidwalk::{Gradation, Network, Walk};

fn main() -> Result<(), Box<dyn Error>> {
    let (seed, n_base, increments) = (1, 100_000, 100);
    let curve = find("cu1.5-loose")?.curve()?.in_mm(1.0)?;
    let network = Network::cubic([20, 20, 30], &curve, 1.0, seed)?;
    let d85 = curve.dc(5.0).ok_or("the curve has a Dc5")?;
    let sampler = SizeSampler::new(&Gradation::linear_from_dx(85.0, d85, 3.0)?, 1.0)?;
    let open = BitVec::repeat(false, network.constrictions());
    let plan = RunPlan::new(Engine::Auto, &network, &sampler, &open, n_base / increments);
    let supply = plan.supply(sampler.clone(), n_base, increments, seed, 1);
    let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 64);
    let mut state = State::new(&network, &supply, classes, open, seed, 1);
    Walk::new(&network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue)?;
    let tally = &state.tally;
    println!("{} increments: {} of {} particles eroded", state.increment, tally.eroded, tally.inserted);
    println!("{} of {} constrictions blocked", state.blocked.count_ones(), network.constrictions());
    Ok(())
}
