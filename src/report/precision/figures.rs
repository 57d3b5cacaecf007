//! The figures of a precision study: log-log, with a guide line of slope -1/2 where more time means more
//! samples.

use crate::outcome::precision::{
    BiasRow, DecisionRow, DecisionTier, ExactRow, ExactTier, PackingTier, SamplingLine, SamplingRow,
    SamplingTier, ScalingRow, TriangulationRow,
};
use crate::report::figures::{
    Across, BLACK, BLUE, Chart, Dash, GREEN, GREY, ORANGE, PURPLE, Role, Rule, SeriesLook, Shape, VERMILLION,
    positive_range, ramp,
};
use crate::report::shell::Drawn;

/// Percentage points of a fraction.
const PP: f64 = 100.0;

/// The guide of errors of independent samples.
const SLOPE: &str = "slope −1/2";

/// The look of an engine or a way of drawing.
fn look(name: &str) -> SeriesLook {
    let (colour, shape) = match name {
        "particles" => (VERMILLION, Shape::Square),
        "counts" => (BLUE, Shape::Circle),
        "expected" => (GREEN, Shape::Diamond),
        "one at a time" => (PURPLE, Shape::Triangle),
        "counts, stratified base" => (ORANGE, Shape::Circle),
        "expected, stratified base" => (ORANGE, Shape::Diamond),
        "counts, stratified constrictions" => (PURPLE, Shape::Circle),
        "expected, both stratified" => (PURPLE, Shape::Diamond),
        _ => (ORANGE, Shape::Triangle),
    };
    SeriesLook::line(colour, shape)
}

/// A figure with room for names above its frame, on a page and on a telephone.
fn drawn<T>(name: &'static str, chart: Chart<T>, caption: &str) -> Drawn {
    Drawn::new(name, chart.figure().names_above().sizes((720.0, 500.0), (358.0, 600.0)), caption)
}

/// The ends of an interval in percentage points.
fn in_points(low: f64, high: f64) -> Option<(f64, f64)> {
    Some((PP * low, PP * high))
}

pub(super) fn exact(exact: &ExactTier) -> Vec<Drawn> {
    type Of = fn(&ExactRow) -> f64;
    let kinds: [(&'static str, &str, Of, &str); 2] = [
        (
            "exact-particles",
            "Particles of a network",
            |row| row.particles as f64,
            "Root mean square error of the probability of leaving, over the random networks, against the \
             number of particles. Dashed: the error of independent particles, slope −1/2. Particles, \
             counts and single particles must follow it. \"Expected\" draws no random numbers; its error \
             comes from rounding to whole particles. Filled symbols: clogged lattice. Hollow symbols and \
             dotted lines: first particle.",
        ),
        (
            "exact-time",
            "Processor time of a network (s)",
            |row| row.core_seconds,
            "Root mean square error of the probability of leaving, against the processor time of one \
             network. Counts cost the same for any number of particles, so their error falls at no extra \
             time. Dashed: slope −1/2.",
        ),
    ];
    let figure = |(name, label, x, caption): (&'static str, &str, Of, &str)| {
        let words = [
            "Error against exact answers",
            "Root mean square error of the probability of leaving, by engine",
        ];
        let y = Role::log("Error of the probability of leaving (–)", |row: &ExactRow| row.error)
            .interval(|row| Some((row.error_low, row.error_high)));
        let is_first = |row: &ExactRow| exact.quantities.first().is_some_and(|of| of.name == row.quantity);
        let chart = Chart::of(&exact.rows, words, Role::log(label, x), y).by(
            |row| [&row.quantity, &row.engine],
            |row| match is_first(row) {
                true => look(&row.engine),
                false => look(&row.engine).dash(Dash::Dotted).hollow(true),
            },
        );
        let chart = match exact.rows.iter().rfind(|row| row.engine == "particles") {
            Some(row) => chart.power((x(row), row.expected_error), -0.5, SLOPE),
            None => chart,
        };
        drawn(name, chart, caption)
    };
    kinds.into_iter().map(figure).collect()
}

pub(super) fn sampling(sampling: &SamplingTier) -> Vec<Drawn> {
    let kinds = [
        (
            "sampling-new-networks",
            "new networks",
            "Standard deviation of the mean of 1, 2, 4, ... replicates, each on a new network, against the \
             processor time of all of them. Bars: 95 % intervals from independent groups of replicates. \
             The floor is the scatter between networks, which no sampling of the base particles lowers.",
        ),
        (
            "sampling-one-network",
            "one network",
            "Standard deviation of the mean of 1, 2, 4, ... replicates on one network, against the \
             processor time of all of them. The sampling of the base particles can change this scatter.",
        ),
    ];
    let figure = |(name, kind, caption): (&'static str, &str, &str)| {
        let lines: Vec<&SamplingLine> = sampling.lines.iter().filter(|line| line.networks == kind).collect();
        (!lines.is_empty()).then(|| scatter(sampling, name, caption, &lines))
    };
    kinds.into_iter().filter_map(figure).collect()
}

fn scatter(sampling: &SamplingTier, name: &'static str, caption: &str, lines: &[&SamplingLine]) -> Drawn {
    let first = lines[0];
    let kind = &first.networks;
    let x = Role::log("Processor time of the replicates averaged (s)", |row: &SamplingRow| row.core_seconds);
    let y = Role::log("Standard error of the eroded mass (percentage points)", |row: &SamplingRow| {
        PP * row.error
    })
    .interval(|row| in_points(row.error_low, row.error_high))
    .also([PP * first.binomial]);
    let words = [
        &format!("Standard error of the eroded mass against time, {kind}"),
        "Standard deviation of means over replicates of the eroded mass fraction against processor time",
    ];
    let rows = sampling.rows.iter().filter(|row| row.networks == *kind);
    let mut chart = Chart::of(rows, words, x, y)
        .by(|row| [row.variant.as_str()], |row| look(&row.variant))
        .power((first.core_seconds, PP * first.sd), -0.5, SLOPE);
    if let (true, Some(floor)) = (kind == "new networks", between_networks(sampling, first)) {
        let through = (first.core_seconds, PP * floor);
        chart = chart.power_in(BLACK, through, -0.5, "scatter between networks: the floor");
    }
    let binomial = Rule::new(Across::Y, PP * first.binomial, BLACK).dash(Dash::Dotted);
    drawn(name, chart.mark(binomial.label("binomial error of one replicate: too small")), caption)
}

/// The scatter between networks alone: what a line over new networks has beyond that over one.
pub(super) fn between_networks(sampling: &SamplingTier, new: &SamplingLine) -> Option<f64> {
    let one = sampling.lines.iter().find(|l| l.variant == new.variant && l.networks == "one network")?;
    let variance = new.sd * new.sd - one.sd * one.sd;
    (variance > 0.0).then(|| variance.sqrt())
}

/// The look of a changed setting.
fn factor_look(factor: &str) -> SeriesLook {
    let (colour, shape) = match factor {
        "base particles" | "stiffness" => (BLUE, Shape::Circle),
        "cap" | "rate" => (BLUE, Shape::Square),
        "cross-section" | "time step" => (VERMILLION, Shape::Circle),
        "length" => (VERMILLION, Shape::Square),
        "injection" | "grains" => (GREEN, Shape::Diamond),
        "constriction sampling" => (PURPLE, Shape::Triangle),
        "precision" => (ORANGE, Shape::Diamond),
        _ => (GREY, Shape::Triangle),
    };
    SeriesLook::points(colour, shape)
}

/// A changed setting: the processor time of a replicate (s), and a difference from the reference with its
/// interval.
struct Changed<'a> {
    factor: &'a str,
    core_seconds: f64,
    bias: f64,
    interval: Option<(f64, f64)>,
}

impl Changed<'_> {
    /// Whether the interval holds zero, or is not known.
    fn is_open(&self) -> bool {
        self.interval.is_none_or(|(low, high)| low <= 0.0 && high >= 0.0)
    }

    /// The interval of the size of the difference, on a logarithmic axis from `least` on.
    fn sizes(&self, least: f64) -> Option<(f64, f64)> {
        let (low, high) = self.interval?;
        let (near, far) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
        Some((if self.is_open() { least } else { near.max(least) }, far.max(least)))
    }
}

/// Sizes of differences from the reference setting against time, a symbol a setting; `decades` below the
/// largest.
fn differences<'a>(
    [title, what, x, y]: [&str; 4],
    changed: &'a [Changed],
    decades: f64,
    floor: Option<(f64, &str)>,
) -> Chart<'a, Changed<'a>> {
    let ends = changed.iter().filter_map(|row| row.interval).flat_map(|(low, high)| [low.abs(), high.abs()]);
    let (_, most) = positive_range(ends.chain(changed.iter().map(|row| row.bias.abs())));
    let least = most * libm::pow(10.0, -decades);
    let x = Role::log(x, |row: &Changed| row.core_seconds);
    let y =
        Role::log(y, move |row: &Changed| row.bias.abs().max(least)).interval(move |row| row.sizes(least));
    let chart = Chart::of(changed, [title, what], x, y.also([least]))
        .by(|row| [row.factor], |row| factor_look(row.factor).hollow(row.is_open()));
    match floor {
        Some((at, name)) => chart.mark(Rule::new(Across::Y, at, BLACK).dash(Dash::Dashed).label(name)),
        None => chart,
    }
}

pub(super) fn bias(rows: &[BiasRow]) -> Vec<Drawn> {
    let others = || rows.iter().filter(|row| !row.reference);
    let changed: Vec<Changed> = others()
        .map(|row| Changed {
            factor: &row.factor,
            core_seconds: row.core_seconds,
            bias: PP * row.bias,
            interval: row.bias_low.zip(row.bias_high).map(|(low, high)| (PP * low, PP * high)),
        })
        .collect();
    // Half of the width of the narrowest interval without pairs: what is smaller was not to be seen without
    // them.
    let unpaired = changed.iter().zip(others()).filter(|(_, row)| !row.paired);
    let widths = unpaired.filter_map(|(changed, _)| changed.interval).map(|(low, high)| (high - low) / 2.0);
    let floor = widths.reduce(f64::min).filter(|_| rows.len() > 1);
    let words = [
        "Bias of settings against time",
        "Size of the difference of the eroded mass from the reference setting, against processor time of a \
         replicate",
        "Processor time of a replicate (s)",
        "Size of the difference from the reference (percentage points)",
    ];
    let floor = floor.map(|floor| (floor, "sampling floor without common networks"));
    let caption = "Size of the difference in mean eroded mass from the reference setting, against the \
                   processor time of a replicate. Hollow: the 95 % interval includes zero. Bars: 95 % \
                   intervals, replicate by replicate where both settings were walked on the same networks.";
    let figure = drawn("bias", differences(words, &changed, 4.0, floor), caption);
    std::iter::once(figure).chain(amount(rows)).collect()
}

/// Eroded mass against the share of the base that is walked.
fn amount(rows: &[BiasRow]) -> Option<Drawn> {
    let reference = rows.iter().find(|row| row.reference)?;
    let shares = || rows.iter().filter(|row| row.factor == "base particles");
    shares().next()?;
    let words =
        ["Bias of too few base particles", "Difference of the eroded mass from that with all base particles"];
    let share = |row: &BiasRow| if row.reference { 1.0 } else { row.at };
    let x = Role::log("Share of the base particles (–)", share);
    let y = Role::linear("Difference of the eroded mass (percentage points)", |row: &BiasRow| PP * row.bias)
        .interval(|row| in_points(row.bias_low?, row.bias_high?))
        .also([0.0]);
    let figure = Chart::of(shares().chain([reference]), words, x, y)
        .by(|_| [""], |_| SeriesLook::line(BLUE, Shape::Circle))
        .mark(Rule::new(Across::Y, 0.0, GREY).dash(Dash::Dashed))
        .figure();
    let caption = format!(
        "Difference of the eroded mass if only part of the required base particles is walked. More \
         replicates do not remove this bias. With all of them, {:.1} % of the mass erodes. Bars: 95 % \
         intervals.",
        PP * reference.value
    );
    Some(Drawn::new("bias-base-particles", figure, caption))
}

pub(super) fn decision(decision: &DecisionTier) -> Vec<Drawn> {
    let words = [
        "Wrong class against time",
        "Share of wrong classes against processor time, for cases near the threshold",
    ];
    let x = Role::log("Processor time (s)", |row: &DecisionRow| row.core_seconds);
    let y = Role::linear("Wrong class (% of trials)", |row: &DecisionRow| PP * row.wrong)
        .interval(|row| in_points(row.wrong_low, row.wrong_high))
        .also([0.0, 10.0]);
    let colour = |row: &DecisionRow| {
        let index = decision.cases.iter().position(|case| case.name == row.case);
        ramp(index.unwrap_or(0), decision.cases.len())
    };
    let is_fixed = |row: &DecisionRow| row.rule == "fixed";
    let chart = Chart::of(&decision.rows, words, x, y).by(
        |row| [if is_fixed(row) { "fixed" } else { "sequential" }, &row.case],
        |row| match is_fixed(row) {
            true => SeriesLook::line(colour(row), Shape::Circle),
            false => SeriesLook::points(VERMILLION, Shape::Diamond),
        },
    );
    let caption = "Share of trials whose class differs from that of all replicates together, against \
                   processor time. Each line is a case, named by its eroded mass. Circles: means of 1, 2, \
                   4, ... replicates. Diamonds: sequential stopping. Bars: 95 % intervals.";
    vec![drawn("decision", chart, caption)]
}

pub(super) fn scaling(rows: &[ScalingRow]) -> Vec<Drawn> {
    type Of = fn(&ScalingRow) -> f64;
    let kinds: [(&str, &'static str, &str, Of, &str); 2] = [
        (
            "base particles",
            "scaling-base-particles",
            "Base particles",
            |row| row.n_base as f64,
            "Processor time of a first run of this scene, against its number of base particles. Dashed: \
             proportional.",
        ),
        (
            "voids",
            "scaling-voids",
            "Voids",
            |row| row.voids as f64,
            "Processor time of a first run on cubic lattices with as many base particles per void as this \
             scene. Dashed: proportional.",
        ),
    ];
    let figure = |(against, name, label, x, caption): (&str, &'static str, &str, Of, &str)| {
        let of = || rows.iter().filter(|row| row.against == against);
        let words = [
            &format!("Time against {against}"),
            &*format!("Processor time of a first run against {against}, by engine"),
        ];
        let y = Role::log("Processor time of a first run (s)", |row: &ScalingRow| row.core_seconds);
        let chart = Chart::of(of(), words, Role::log(label, x), y)
            .by(|row| [row.engine.as_str()], |row| look(&row.engine));
        let end = of().rfind(|row| row.engine == "particles").or(of().next())?;
        Some(drawn(name, chart.power((x(end), end.core_seconds), 1.0, "slope 1"), caption))
    };
    kinds.into_iter().filter_map(figure).collect()
}

pub(super) fn packing(tier: &PackingTier) -> Vec<Drawn> {
    void_ratios(tier).into_iter().chain(triangulations(tier)).collect()
}

fn void_ratios(tier: &PackingTier) -> Option<Drawn> {
    let others = tier.packings.iter().filter(|row| !row.reference);
    let changed: Vec<Changed> = others
        .map(|row| Changed {
            factor: &row.factor,
            core_seconds: row.core_seconds,
            bias: row.bias,
            interval: row.bias_low.zip(row.bias_high),
        })
        .collect();
    changed.first()?;
    let reference = tier.packings.iter().find(|row| row.reference);
    let sd = reference.and_then(|row| Some((row.void_ratio_sd.filter(|sd| *sd > 0.0)?, row.seeds as f64)));
    let floor =
        sd.map(|(sd, seeds)| (sd * (2.0 / seeds).sqrt(), "sampling floor: standard error of a difference"));
    let words = [
        "Void ratio of packings against time",
        "Size of the difference of the void ratio from the default settings, against processor time of a \
         packing",
        "Processor time of a packing (s)",
        "Size of the difference of the void ratio (–)",
    ];
    let caption = "Size of the difference in mean void ratio from the default settings, against the \
                   processor time of a packing. Hollow: the 95 % interval includes zero. The floor is the \
                   standard error of a difference between means over the same number of seeds.";
    Some(drawn("packing", differences(words, &changed, 3.0, floor), caption))
}

fn triangulations(tier: &PackingTier) -> Option<Drawn> {
    let rows = &tier.triangulations;
    let last = rows.last()?;
    let both = |row| [("triangulation", row), ("voids, discs and curve", row)];
    let both: Vec<(&str, &TriangulationRow)> = rows.iter().flat_map(both).collect();
    let seconds = |(name, row): &(&str, &TriangulationRow)| match *name {
        "triangulation" => row.triangulate_seconds,
        _ => row.measure_seconds,
    };
    let words = [
        "Time of triangulations",
        "Processor time of triangulation and of the constrictions against the number of grains",
    ];
    let x = Role::log("Grains", |(_, row): &(&str, &TriangulationRow)| row.grains as f64);
    let chart = Chart::of(&both, words, x, Role::log("Processor time (s)", seconds))
        .by(
            |(name, _)| [*name],
            |(name, row)| {
                let (colour, shape) = match *name {
                    "triangulation" => (BLUE, Shape::Circle),
                    _ => (VERMILLION, Shape::Square),
                };
                SeriesLook::points(colour, shape).hollow(row.packing.starts_with("at random"))
            },
        )
        .power((last.grains as f64, last.triangulate_seconds), 1.0, "slope 1");
    let caption = "Processor time of the regular triangulation and of the constrictions measured on it. \
                   Filled: compressed packings. Hollow: random positions before compression.";
    Some(drawn("triangulation", chart, caption))
}
