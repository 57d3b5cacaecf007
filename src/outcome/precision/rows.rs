//! The rows of a precision study. A field is a column of its CSV file; what follows `=>` is how the page
//! shows it.

use std::fmt::Display;

use crate::outcome::quantity::{Quantity, duration, percent, significant};
use crate::outcome::record::Verdict;
use crate::outcome::table::table_rows;

/// A fraction in percent, or a difference in percentage points.
fn points(fraction: f64) -> Quantity {
    significant(100.0 * fraction)
}

/// A difference in percentage points, with its sign.
fn signed(fraction: f64) -> String {
    format!("{}{}", if fraction < 0.0 { "−" } else { "+" }, points(fraction.abs()))
}

/// A value with the ends of its interval.
fn between<R: Display>(show: impl Fn(f64) -> R, [value, low, high]: [f64; 3]) -> String {
    format!("{} ({} to {})", show(value), show(low), show(high))
}

/// A difference from the reference setting, with its interval where there is one.
fn difference<R: Display>(
    is_reference: bool,
    show: impl Fn(f64) -> R,
    (mean, low, high): (f64, Option<f64>, Option<f64>),
) -> String {
    match low.zip(high) {
        _ if is_reference => "reference".to_owned(),
        Some((low, high)) => between(show, [mean, low, high]),
        None => show(mean).to_string(),
    }
}

fn holds(holds: bool) -> &'static str {
    if holds { "✓" } else { "FAILED" }
}

table_rows! {
    /// Error of an engine with this many particles, over all networks.
    pub struct ExactRow {
        /// Name of the quantity.
        pub quantity: String =>
            words("Quantity and engine", |row| format!("{}, {}", row.quantity, row.engine)),
        /// The engine.
        pub engine: String,
        /// Particles of each network.
        pub particles: u64 => number("Most particles", |row| format!("{:.0e}", row.particles as f64)),
        /// Networks.
        pub networks: u64,
        /// Root mean square of found less exact.
        pub error: f64 => number("Error (–)", |row| format!("{:.2e}", row.error)),
        /// Lower end of its 95 % interval.
        pub error_low: f64,
        /// Upper end of its 95 % interval.
        pub error_high: f64,
        /// The error that independent particles have: root mean square of `sqrt(p (1 - p) / particles)`.
        pub expected_error: f64 =>
            number("Error of independent particles (–)", |row| format!("{:.2e}", row.expected_error)),
        /// Mean of found less exact.
        pub bias: f64,
        /// Largest deviation of one network in standard errors; `None` where nothing is drawn.
        pub largest_z: Option<f64>,
        /// Sum of the squares of all deviations, on as many degrees of freedom as there are networks.
        pub chi_squared: Option<f64> =>
            number("χ² of its degrees of freedom", |row| {
                row.chi_squared.map(|chi| format!("{chi:.0} of {}", row.networks))
            }),
        /// Processor time of one network, mean, s.
        pub core_seconds: f64,
        /// `1 / (error^2 core_seconds)`; `None` without an error.
        pub merit: Option<f64>,
    }

    /// How the error of an engine falls with the number of particles.
    pub struct Slope {
        /// Name of the quantity.
        pub quantity: String,
        /// The engine.
        pub engine: String,
        /// Slope of ln(error) against ln(particles); `None` with fewer than two errors.
        pub slope: Option<f64> => number("Slope", |row| row.slope.map(|slope| format!("{slope:.3}"))),
        /// Smallest error reached.
        pub smallest_error: f64,
        /// Largest deviation of one network, at any number of particles.
        pub largest_z: Option<f64> =>
            number("Largest |z| of a network", |row| {
                row.largest_z.map_or_else(|| "nothing drawn".into(), |z| format!("{z:.2}"))
            }),
    }

    /// An answer that is known without a solve.
    pub struct ClosedRow {
        /// What.
        pub what: String => headed("What"),
        /// The answer.
        pub exact: f64 => headed("Exact"),
        /// What was found.
        pub found: f64 =>
            number("Found", |row| match row.z {
                Some(_) => format!("{:.4}", row.found),
                None => row.found.to_string(),
            }),
        /// Difference in standard errors; `None` for integers, which must be equal.
        pub z: Option<f64> =>
            number("z", |row| row.z.map_or_else(|| "must be equal".into(), |z| format!("{z:+.2}"))),
        /// Whether it is as it must be: equal, or within four standard errors.
        pub holds: bool => words("Holds", |row| holds(row.holds)),
        /// Particles, or networks.
        pub samples: u64,
        /// Processor time, s.
        pub core_seconds: f64 => headed("Processor time (s)"),
    }

    /// All replicates of a variant.
    pub struct SamplingLine {
        /// How base particles are drawn and moved.
        pub variant: String =>
            words("Sampling, networks", |line| format!("{}, {}", line.variant, line.networks)),
        /// `new networks`, or `one network`.
        pub networks: String,
        /// Replicates.
        pub replicates: u64 => headed("Replicates"),
        /// Mean of the eroded mass fraction.
        pub mean: f64 => number("Eroded mass (%)", |line| points(line.mean)),
        /// Mean less that of the first variant, on the same networks: zero but for the scatter, if both have
        /// one expectation.
        pub difference: f64 =>
            number("Difference from the first line (points ± standard error)", |line| {
                line.difference_error.map(|error| format!("{} ± {}", signed(line.difference), points(error)))
            }),
        /// Its standard error; `None` for the first variant.
        pub difference_error: Option<f64>,
        /// Standard deviation of one replicate.
        pub sd: f64 =>
            number("SD of a replicate (points, 95 %)", |line| {
                between(points, [line.sd, line.sd_low, line.sd_high])
            }),
        /// Lower end of the 95 % interval.
        pub sd_low: f64,
        /// Upper end of the 95 % interval.
        pub sd_high: f64,
        /// `sqrt(mean (1 - mean) / N_base)`, what a binomial of all particles would have; for comparison
        /// only.
        pub binomial: f64 => number("SD over binomial SD (–)", |line| line.sd / line.binomial),
        /// Processor time of a replicate, mean, s.
        pub core_seconds: f64 => headed("Processor time of a replicate (s)"),
        /// `1 / (sd^2 core_seconds)`; `None` without scatter.
        pub merit: Option<f64>,
        /// Lower end of its 95 % interval, from that of `sd`.
        pub merit_low: Option<f64>,
        /// Upper end of the 95 % interval.
        pub merit_high: Option<f64>,
    }

    /// What a setting does to the eroded mass fraction of the first run.
    pub struct BiasRow {
        /// What is changed.
        pub factor: String => words("Setting", |row| format!("{}: {}", row.factor, row.level)),
        /// To what, in words.
        pub level: String,
        /// The changed setting as a number, where it is one.
        pub at: f64,
        /// Whether this is the setting that the others are compared with.
        pub reference: bool,
        /// Base particles.
        pub n_base: u64 => headed("Base particles"),
        /// Replicates.
        pub replicates: u64 =>
            number("Replicates", |row| {
                format!("{}{}", row.replicates, if row.paired { ", same networks" } else { "" })
            }),
        /// Mean of the eroded mass fraction.
        pub value: f64 => number("Eroded mass (%)", |row| points(row.value)),
        /// Mean less that of the reference.
        pub bias: f64 =>
            number("Difference (points, 95 %)", |row| {
                difference(row.reference, signed, (row.bias, row.bias_low, row.bias_high))
            }),
        /// Lower end of its 95 % interval; `None` for the reference.
        pub bias_low: Option<f64>,
        /// Upper end of the 95 % interval.
        pub bias_high: Option<f64>,
        /// Whether both were walked on the same networks with the same random numbers, so that the interval
        /// is that of the differences replicate by replicate.
        pub paired: bool,
        /// Processor time of a replicate, mean, s.
        pub core_seconds: f64 => headed("Processor time of a replicate (s)"),
    }

    /// A case near the threshold.
    pub struct DecisionCase {
        /// What it is called.
        pub name: String => headed("Case"),
        /// Factor on every size of the scene's base.
        pub size_factor: f64 => headed("Factor on sizes"),
        /// Base particles.
        pub n_base: u64 => headed("Base particles"),
        /// Replicates of the reference.
        pub replicates: u64 => headed("Replicates"),
        /// Eroded mass fraction of the first run, mean over the reference.
        pub mean: f64 =>
            number("Eroded mass of the first run (%, 95 %)", |case| {
                between(points, [case.mean, case.low, case.high])
            }),
        /// Lower end of the 95 % interval.
        pub low: f64,
        /// Upper end of the 95 % interval.
        pub high: f64,
        /// Standard deviation of a replicate.
        pub sd: f64 => number("SD of a replicate (points)", |case| points(case.sd)),
        /// The class, by the means of all replicates.
        pub class: Verdict =>
            words("Class", |case| {
                format!("{}{}", case.class.words(), if case.certain { "" } else { " (inconclusive)" })
            }),
        /// Whether the 95 % interval of the first run lies on one side of 7.5 %.
        pub certain: bool,
        /// Processor time of a replicate, mean, s.
        pub core_seconds: f64 => headed("Processor time of a replicate (s)"),
    }

    /// How often a rule gives the wrong class.
    pub struct DecisionRow {
        /// The case.
        pub case: String => headed("Case"),
        /// `fixed`, or `decided at` a confidence level.
        pub rule: String => headed("Rule"),
        /// Replicates, mean.
        pub replicates: f64 => headed("Replicates"),
        /// Share of wrong classes.
        pub wrong: f64 =>
            number("Wrong (95 %)", |row| between(percent, [row.wrong, row.wrong_low, row.wrong_high])),
        /// Lower end of the 95 % interval.
        pub wrong_low: f64,
        /// Upper end of the 95 % interval.
        pub wrong_high: f64,
        /// Share of trials that ended without a class.
        pub undecided: f64 => number("Without a class", |row| percent(row.undecided)),
        /// Processor time, mean, s.
        pub core_seconds: f64 => headed("Processor time (s)"),
    }

    /// Time of a first run.
    pub struct ScalingRow {
        /// What is varied: `base particles`, `voids` or `threads`.
        pub against: String,
        /// The engine.
        pub engine: String => headed("Engine"),
        /// Base particles.
        pub n_base: u64 => headed("Base particles"),
        /// Voids.
        pub voids: u64,
        /// Threads.
        pub threads: u64 => headed("Threads of one run"),
        /// Wall time, s.
        pub wall_seconds: f64 => headed("Wall time (s)"),
        /// Processor time, s.
        pub core_seconds: f64 => headed("Processor time (s)"),
        /// Increments.
        pub increments: u64,
        /// Completed moves.
        pub particle_moves: u64,
        /// Eroded mass over inserted mass.
        pub eroded_mass_fraction: f64 =>
            number("Eroded mass (%)", |row| format!("{:.6}", 100.0 * row.eroded_mass_fraction)),
    }

    /// A packing's void ratio and constriction curve under a setting, over some seeds.
    pub struct PackingRow {
        /// Friction while it is compressed.
        pub friction: f64 =>
            words("Setting", |row| match row.factor.as_str() {
                "reference" => format!("friction {}, default settings", row.friction),
                factor => format!("friction {}, {factor} x {}", row.friction, row.at),
            }),
        /// What is changed: `stiffness`, `rate`, `grains` or `time step`.
        pub factor: String,
        /// To what, as a multiple of the default; grains as a number.
        pub at: f64,
        /// Whether this is the setting that the others are compared with.
        pub reference: bool,
        /// Grains.
        pub grains: u64 => headed("Grains"),
        /// Packings.
        pub seeds: u64,
        /// Packings that came to rest at their pressure.
        pub settled: u64 => number("At rest", |row| format!("{} of {}", row.settled, row.seeds)),
        /// Volume of voids over volume of grains, mean.
        pub void_ratio: f64 => number("Void ratio", |row| format!("{:.4}", row.void_ratio)),
        /// Standard deviation of one packing.
        pub void_ratio_sd: Option<f64>,
        /// Void ratio less that of the reference.
        pub bias: f64 =>
            number("Difference (95 %)", |row| {
                let show = |value| format!("{value:+.4}");
                difference(row.reference, show, (row.bias, row.bias_low, row.bias_high))
            }),
        /// Lower end of the 95 % interval.
        pub bias_low: Option<f64>,
        /// Upper end of the 95 % interval.
        pub bias_high: Option<f64>,
        /// Dc5 over the smallest grain, mean.
        pub dc5: f64 => number("Dc5 (D0F)", |row| format!("{:.4}", row.dc5)),
        /// Dc50 over the smallest grain, mean.
        pub dc50: f64 => number("Dc50 (D0F)", |row| format!("{:.4}", row.dc50)),
        /// Relative difference of Dc50 from the reference.
        pub dc50_bias: f64 => number("Difference of Dc50", |row| format!("{:+.2} %", 100.0 * row.dc50_bias)),
        /// Dc60 / Dc10 of the constrictions, mean.
        pub cu_csd: f64 => number("Cu of constrictions", |row| format!("{:.3}", row.cu_csd)),
        /// Processor time of a packing, mean, s.
        pub core_seconds: f64 => headed("Processor time (s)"),
    }

    /// Time of a triangulation, and whether its identities hold.
    pub struct TriangulationRow {
        /// Where the grains are.
        pub packing: String => headed("Packing"),
        /// Grains.
        pub grains: u64 => headed("Grains"),
        /// Tetrahedra.
        pub tetrahedra: u64 => headed("Tetrahedra"),
        /// Constrictions.
        pub constrictions: u64 => headed("Constrictions"),
        /// Processor time of the triangulation, s.
        pub triangulate_seconds: f64 => number("Triangulation", |row| duration(row.triangulate_seconds)),
        /// Processor time of voids, discs and curve, s.
        pub measure_seconds: f64 => number("Voids, discs, curve", |row| duration(row.measure_seconds)),
        /// Every facet shared by two, positive volumes that sum to the cell, local regularity, Euler's
        /// relation.
        pub identities_hold: bool => words("Identities", |row| holds(row.identities_hold)),
    }
}
