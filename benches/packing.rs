//! Compression of a linear gradation, in grain-steps a second and in seconds to the settled packing.
//!
//! `cargo bench --bench packing -- cu=1.5 friction=0.3 grains=9313 seed=1 threads=1 start=START.csv out=PACKING.csv`
//! prints one line; the other settings may be given by name too. Goal: 12 million grain-steps a second on one core.

use std::fmt::Write;
use std::time::Instant;
use voidwalk::gradation::Gradation;
use voidwalk::packing::{Cell, Compression, Packing, Settings, draw, random_start};

fn table(packing: &Packing) -> String {
    let Cell::Periodic([x, y, z]) = packing.cell else { unreachable!("a compression is periodic") };
    let mut text = format!("# cell_mm = {x}, {y}, {z}\nx_mm,y_mm,z_mm,diameter_mm\n");
    for i in 0..packing.x.len() {
        writeln!(text, "{},{},{},{}", packing.x[i], packing.y[i], packing.z[i], packing.diameter[i]).unwrap();
    }
    text
}

fn main() {
    let mut settings = Settings { grains: 2000, ..Settings::default() };
    let (mut cu, mut threads) = (1.5, 1);
    let (mut start_file, mut out_file, mut watch) = (None, None, false);
    for argument in std::env::args().skip(1) {
        let Some((key, value)) = argument.split_once('=') else { continue };
        let real = || value.parse::<f64>().unwrap_or_else(|_| panic!("{key} = {value}: a number is needed"));
        match key {
            "cu" => cu = real(),
            "threads" => threads = real() as usize,
            "start" => start_file = Some(value.to_owned()),
            "out" => out_file = Some(value.to_owned()),
            "watch" => watch = real() > 0.0,
            "grains" => settings.grains = real() as usize,
            "seed" => settings.seed = real() as u64,
            "friction" => settings.friction = real(),
            "final_friction" => settings.final_friction = real(),
            "stiffness_ratio" => settings.stiffness_ratio = real(),
            "restitution" => settings.restitution = real(),
            "drag" => settings.drag = real(),
            "settling_drag" => settings.settling_drag = real(),
            "local_damping" => settings.local_damping = real(),
            "start_fraction" => settings.start_fraction = real(),
            "compression_target_fraction" => settings.compression_target_fraction = real(),
            "squeeze_rate" => settings.squeeze_rate = real(),
            "servo_rate" => settings.servo_rate = real(),
            "servo_gain" => settings.servo_gain = real(),
            "mass_exponent" => settings.mass_exponent = real(),
            "step_fraction" => settings.step_fraction = real(),
            "hold_steps" => settings.hold_steps = real() as u64,
            "max_steps" => settings.max_steps = real() as u64,
            _ => panic!("{key} is not a setting"),
        }
    }
    // Runs inside the pool like the program: a step that is asked for from outside the pool waits for it to
    // wake.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let gradation = Gradation::linear_from_d0(1.0, cu).expect("cu above 1");
    let start = random_start(&draw(&gradation, settings.grains, settings.seed), &settings).expect("a start");
    if let Some(path) = start_file {
        std::fs::write(path, table(&start)).expect("a writable file");
    }
    let mut compression =
        Compression::new(&start, &settings).expect("a compression").of_gradation(&gradation);
    let clock = Instant::now();
    let outcome = pool.install(|| {
        compression.run(|p| {
            if watch {
                eprintln!("{p:?}");
            }
            true
        })
    });
    let seconds = clock.elapsed().as_secs_f64();
    let m = compression.measure();
    let (before, after) = match &outcome {
        Ok(report) => (report.before, report.after),
        Err(error) => {
            eprintln!("{error}");
            (m, m)
        }
    };
    let steps = compression.steps();
    println!(
        "{{\"settled\":{},\"cu\":{cu},\"friction\":{},\"grains\":{},\"void_ratio_before\":{:.5},\"void_ratio\":{:.5},\
         \"coordination\":{:.3},\"coordination_held\":{:.3},\"rattlers\":{:.4},\"pressure_kpa\":{:.3},\
         \"kinetic_ratio\":{:.1e},\"unbalanced\":{:.1e},\"steps\":{steps},\"seconds\":{seconds:.2},\"million_grain_steps_per_second\":{:.2}}}",
        outcome.is_ok(),
        settings.friction,
        settings.grains,
        before.void_ratio,
        after.void_ratio,
        after.coordination,
        after.coordination_held,
        after.rattlers,
        after.pressure_kpa,
        after.kinetic_ratio,
        after.unbalanced,
        steps as f64 * settings.grains as f64 / seconds / 1e6,
    );
    if let Some(path) = out_file {
        std::fs::write(path, table(&compression.packing())).expect("a writable file");
    }
}
