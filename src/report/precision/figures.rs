//! The figures of a precision study: log-log, with a guide line of slope -1/2 where more time means more
//! samples.

use crate::outcome::precision::{
    BiasRow, DecisionRow, DecisionTier, ExactRow, ExactTier, PackingTier, SamplingLine, SamplingTier,
    ScalingRow, TriangulationRow,
};
use crate::report::figures::{
    Across, Axis, BLACK, BLUE, Colour, Dash, Figure, GREEN, GREY, Line, ORANGE, PURPLE, Point, Rule, Shape,
    VERMILLION, positive_range, ramp,
};
use crate::report::shell::Drawn;

/// Percentage points of a fraction.
const PP: f64 = 100.0;

/// Colour and symbol of an engine or a way of drawing.
fn look(name: &str) -> (Colour, Shape) {
    match name {
        "particles" => (VERMILLION, Shape::Square),
        "counts" => (BLUE, Shape::Circle),
        "expected" => (GREEN, Shape::Diamond),
        "one at a time" => (PURPLE, Shape::Triangle),
        "counts, stratified base" => (ORANGE, Shape::Circle),
        "expected, stratified base" => (ORANGE, Shape::Diamond),
        "counts, stratified constrictions" => (PURPLE, Shape::Circle),
        "expected, both stratified" => (PURPLE, Shape::Diamond),
        _ => (ORANGE, Shape::Triangle),
    }
}

/// An empty figure with room for names above its frame, on a page and on a telephone.
fn figure(title: &str, what: &str, x: Axis, y: Axis) -> Figure {
    Figure::new(title, what, "", x, y).names_above().sizes((720.0, 500.0), (358.0, 600.0))
}

/// A thin line with a name, still without points.
fn curve(colour: Colour, name: &str) -> Line {
    Line::new(Vec::new(), colour).width(1.5).label(name)
}

/// A logarithmic axis around positive values.
fn log(label: &str, values: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = positive_range(values);
    Axis::log(label, low, high)
}

/// A dashed power law through a point, over positive values of x.
fn power(through: (f64, f64), exponent: f64, x: impl Iterator<Item = f64>, colour: Colour) -> Line {
    let (low, high) = positive_range(x);
    let at = |x: f64| (x, through.1 * libm::pow(x / through.0, exponent));
    Line::new(vec![at(low), at(high)], colour).width(1.5).dash(Dash::Dashed)
}

/// The dashed line on which errors of independent samples lie.
fn guide(through: (f64, f64), x: impl Iterator<Item = f64>) -> Line {
    power(through, -0.5, x, GREY).label("slope −1/2")
}

/// Distinct values in order of first appearance.
fn distinct<'a, T: 'a>(rows: impl IntoIterator<Item = &'a T>, of: impl Fn(&'a T) -> &'a str) -> Vec<&'a str> {
    let mut all: Vec<&str> = Vec::new();
    for name in rows.into_iter().map(of) {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

pub(super) fn exact(exact: &ExactTier) -> Vec<Drawn> {
    type Of = fn(&ExactRow) -> f64;
    let kinds: [(&'static str, &str, Of, &str); 2] = [
        (
            "exact-particles",
            "Particles of a network",
            |row| row.particles as f64,
            "Root mean square error of the probability to leave over the random networks, against the number \
             of particles. Dashed: the error of independent particles, slope −1/2; particles, counts and \
             single particles must lie on it. \"Expected\" draws nothing: its error is the rounding of its \
             whole numbers. Filled: clogged lattice; hollow, dotted: first particle.",
        ),
        (
            "exact-time",
            "Processor time of a network (s)",
            |row| row.core_seconds,
            "Root mean square error of the probability to leave, against the processor time of one network. \
             Counts cost the same for any number of particles, so their line falls without more time. \
             Dashed: slope −1/2.",
        ),
    ];
    let drawn = |(name, label, x, caption): (&'static str, &str, Of, &str)| {
        let what = "Root mean square error of the probability to leave, by engine";
        let errors = exact.rows.iter().flat_map(|row| [row.error_low, row.error_high]);
        let y = log("Error of the probability to leave (–)", errors);
        let mut figure = figure("Error against exact answers", what, log(label, exact.rows.iter().map(x)), y);
        let mut named: Vec<&str> = Vec::new();
        for (index, quantity) in exact.quantities.iter().enumerate() {
            let rows = || exact.rows.iter().filter(|row| row.quantity == quantity.name);
            for engine in distinct(rows(), |row| &row.engine) {
                let (colour, shape) = look(engine);
                let of_engine = || rows().filter(|row| row.engine == engine);
                let dash = if index == 0 { Dash::Solid } else { Dash::Dotted };
                let path = of_engine().map(|row| (x(row), row.error)).collect();
                let line = Line::new(path, colour).width(1.5).dash(dash);
                figure.add(if named.contains(&engine) { line } else { line.label(engine) });
                named.push(engine);
                for row in of_engine() {
                    let bar = Some((row.error_low, row.error_high));
                    let point = Point::new(x(row), row.error, colour, shape).y_interval(bar);
                    figure.add(if index == 0 { point } else { point.hollow() });
                }
            }
        }
        if let Some(row) = exact.rows.iter().rfind(|row| row.engine == "particles") {
            figure.add(guide((x(row), row.expected_error), exact.rows.iter().map(x)));
        }
        Drawn::new(name, figure, caption)
    };
    kinds.into_iter().map(drawn).collect()
}

pub(super) fn sampling(sampling: &SamplingTier) -> Vec<Drawn> {
    let kinds = [
        (
            "sampling-new-networks",
            "new networks",
            "Over new networks and new walks: standard deviation of the mean of 1, 2, 4, ... replicates \
             against the processor time that they take together. Bars: 95 % intervals from the independent \
             groups of replicates. The floor is the scatter between networks, which no other way of drawing \
             base particles lowers.",
        ),
        (
            "sampling-one-network",
            "one network",
            "Over new walks on one network: standard deviation of the mean of 1, 2, 4, ... replicates \
             against their processor time, which a way of drawing base particles can change.",
        ),
    ];
    let drawn = |(name, kind, caption): (&'static str, &str, &str)| {
        let lines: Vec<&SamplingLine> = sampling.lines.iter().filter(|line| line.networks == kind).collect();
        (!lines.is_empty()).then(|| scatter(sampling, name, caption, &lines))
    };
    kinds.into_iter().filter_map(drawn).collect()
}

fn scatter(sampling: &SamplingTier, name: &'static str, caption: &str, lines: &[&SamplingLine]) -> Drawn {
    let first = lines[0];
    let kind = &first.networks;
    let rows = || sampling.rows.iter().filter(|row| row.networks == *kind);
    let seconds = || rows().map(|row| row.core_seconds);
    let errors = rows().flat_map(|row| [PP * row.error_low, PP * row.error_high]);
    let mut figure = figure(
        &format!("Standard error of the eroded mass against time, {kind}"),
        "Standard deviation of means over replicates of the eroded mass fraction against processor time",
        log("Processor time of the replicates averaged (s)", seconds()),
        log("Standard error of the eroded mass (percentage points)", errors.chain([PP * first.binomial])),
    );
    for line in lines {
        let (colour, shape) = look(&line.variant);
        let of_line = || rows().filter(|row| row.variant == line.variant);
        let points = of_line()
            .map(|row| (row.core_seconds, PP * row.error, Some((PP * row.error_low, PP * row.error_high))));
        figure.add_series(curve(colour, &line.variant), shape, points);
    }
    figure.add(guide((first.core_seconds, PP * first.sd), seconds()));
    if let (true, Some(floor)) = (kind == "new networks", between_networks(sampling, first)) {
        let floor = power((first.core_seconds, PP * floor), -0.5, seconds(), BLACK);
        figure.add(floor.label("networks alone: the sampling floor"));
    }
    let (low, high) = positive_range(seconds());
    let binomial = vec![(low, PP * first.binomial), (high, PP * first.binomial)];
    let binomial = Line::new(binomial, BLACK).width(1.0).dash(Dash::Dotted);
    figure.add(binomial.label("one replicate by a binomial: too small"));
    Drawn::new(name, figure, caption)
}

/// The scatter between networks alone: what a line over new networks has beyond that over one.
pub(super) fn between_networks(sampling: &SamplingTier, new: &SamplingLine) -> Option<f64> {
    let one = sampling.lines.iter().find(|l| l.variant == new.variant && l.networks == "one network")?;
    let variance = new.sd * new.sd - one.sd * one.sd;
    (variance > 0.0).then(|| variance.sqrt())
}

/// Colour and symbol of a changed setting.
fn factor_look(factor: &str) -> (Colour, Shape) {
    match factor {
        "base particles" | "stiffness" => (BLUE, Shape::Circle),
        "cap" | "rate" => (BLUE, Shape::Square),
        "cross-section" | "time step" => (VERMILLION, Shape::Circle),
        "length" => (VERMILLION, Shape::Square),
        "injection" | "grains" => (GREEN, Shape::Diamond),
        "constriction sampling" => (PURPLE, Shape::Triangle),
        "precision" => (ORANGE, Shape::Diamond),
        _ => (GREY, Shape::Triangle),
    }
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
    /// The size of the difference on a logarithmic axis from `least` on: hollow where the interval holds
    /// zero.
    fn sized(&self, least: f64) -> Point {
        let (colour, shape) = factor_look(self.factor);
        let point = Point::new(self.core_seconds, self.bias.abs().max(least), colour, shape);
        let Some((low, high)) = self.interval else { return point.hollow() };
        let holds_zero = low <= 0.0 && high >= 0.0;
        let (near, far) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
        let near = if holds_zero { least } else { near.max(least) };
        let point = point.y_interval(Some((near, far.max(least))));
        if holds_zero { point.hollow() } else { point }
    }
}

/// Sizes of differences from the reference setting against time, a symbol a setting; `decades` below the
/// largest.
fn differences(
    [title, what, y]: [&str; 3],
    x: Axis,
    changed: &[Changed],
    decades: f64,
    floor: Option<(f64, &str)>,
) -> Figure {
    let ends = changed.iter().filter_map(|row| row.interval).flat_map(|(low, high)| [low.abs(), high.abs()]);
    let (_, most) = positive_range(ends.chain(changed.iter().map(|row| row.bias.abs())));
    let least = most * libm::pow(10.0, -decades);
    let mut figure = figure(title, what, x, Axis::log(y, least, most));
    for factor in distinct(changed, |row| row.factor) {
        let of_factor = changed.iter().filter(|row| row.factor == factor);
        figure.add_points(factor, of_factor.map(|row| row.sized(least)));
    }
    if let Some((floor, label)) = floor {
        figure.add(Rule::new(Across::Y, floor, BLACK).dash(Dash::Dashed).label(label));
    }
    figure
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
        "Size of the difference from the reference (percentage points)",
    ];
    let x = log("Processor time of a replicate (s)", changed.iter().map(|row| row.core_seconds));
    let floor = floor.map(|floor| (floor, "sampling floor without common networks"));
    let caption = "Size of the difference of the mean eroded mass from the reference setting, against the \
                   processor time of a replicate. Hollow: the 95 % interval holds zero. Bars: 95 % \
                   intervals, replicate by replicate where both were walked on the same networks.";
    let figure = differences(words, x, &changed, 4.0, floor);
    std::iter::once(Drawn::new("bias", figure, caption)).chain(amount(rows)).collect()
}

/// Eroded mass against the share of the base that is walked.
fn amount(rows: &[BiasRow]) -> Option<Drawn> {
    let reference = rows.iter().find(|row| row.reference)?;
    let shares: Vec<&BiasRow> = rows.iter().filter(|row| row.factor == "base particles").collect();
    let smallest = shares.iter().map(|row| row.at).reduce(f64::min)?.min(1.0);
    let highest = shares.iter().filter_map(|row| row.bias_high).fold(0.0, f64::max);
    let lowest = shares.iter().filter_map(|row| row.bias_low).fold(0.0, f64::min);
    let mut figure = Figure::new(
        "Bias of too few base particles",
        "Difference of the eroded mass from that with all base particles of Eq. 2",
        "",
        Axis::log("Base particles by those of Eq. 2 (–)", smallest, 1.0),
        Axis::linear("Difference of the eroded mass (percentage points)", PP * lowest, PP * highest),
    );
    let path = shares.iter().map(|row| (row.at, PP * row.bias)).chain([(1.0, 0.0)]).collect();
    figure.add(Line::new(path, BLUE));
    for row in &shares {
        let bar = row.bias_low.zip(row.bias_high).map(|(l, h)| (PP * l, PP * h));
        figure.add(Point::new(row.at, PP * row.bias, BLUE, Shape::Circle).y_interval(bar));
    }
    figure.add(Rule::new(Across::Y, 0.0, GREY).dash(Dash::Dashed));
    let caption = format!(
        "Difference of the eroded mass when only a part of the base particles that the model requires is \
         walked: a bias that no replicate takes away. With all of them {:.1} % erode. Bars: 95 % intervals.",
        PP * reference.value
    );
    Some(Drawn::new("bias-base-particles", figure, caption))
}

pub(super) fn decision(decision: &DecisionTier) -> Vec<Drawn> {
    let most = decision.rows.iter().map(|row| row.wrong_high).fold(0.1, f64::max);
    let mut figure = figure(
        "Wrong class against time",
        "Share of wrong classes against processor time, for cases near the threshold",
        log("Processor time (s)", decision.rows.iter().map(|row| row.core_seconds)),
        Axis::linear("Wrong class (% of trials)", 0.0, PP * most),
    );
    for (index, case) in decision.cases.iter().enumerate() {
        let colour = ramp(index, decision.cases.len());
        let of = |fixed: bool| {
            decision.rows.iter().filter(move |row| row.case == case.name && (row.rule == "fixed") == fixed)
        };
        let point = |row: &DecisionRow| {
            (row.core_seconds, PP * row.wrong, Some((PP * row.wrong_low, PP * row.wrong_high)))
        };
        figure.add_series(curve(colour, &case.name), Shape::Circle, of(true).map(point));
        for (x, y, bar) in of(false).map(point) {
            figure.add(Point::new(x, y, VERMILLION, Shape::Diamond).y_interval(bar));
        }
    }
    let caption = "Share of trials whose class is not that of all replicates together, against their \
                   processor time; a line a case, named by its eroded mass. Circles: the mean of 1, 2, 4, \
                   ... replicates. Diamonds: sequential stopping. Bars: 95 % intervals.";
    vec![Drawn::new("decision", figure, caption)]
}

pub(super) fn scaling(rows: &[ScalingRow]) -> Vec<Drawn> {
    type Of = fn(&ScalingRow) -> f64;
    let kinds: [(&str, &'static str, &str, Of, &str); 2] = [
        (
            "base particles",
            "scaling-base-particles",
            "Base particles",
            |row| row.n_base as f64,
            "Processor time of a first run of this scene's base against the number of its particles. Dashed: \
             in proportion.",
        ),
        (
            "voids",
            "scaling-voids",
            "Voids",
            |row| row.voids as f64,
            "Processor time of a first run on cubes, with as many base particles a void as this scene has. \
             Dashed: in proportion.",
        ),
    ];
    let drawn = |(against, name, label, x, caption): (&str, &'static str, &str, Of, &str)| {
        let of: Vec<&ScalingRow> = rows.iter().filter(|row| row.against == against).collect();
        let all_x = || of.iter().map(|row| x(row));
        let mut figure = figure(
            &format!("Time against {against}"),
            &format!("Processor time of a first run against {against}, by engine"),
            log(label, all_x()),
            log("Processor time of a first run (s)", of.iter().map(|row| row.core_seconds)),
        );
        for engine in distinct(of.iter().copied(), |row| &row.engine) {
            let (colour, shape) = look(engine);
            let of_engine = of.iter().filter(|row| row.engine == engine);
            figure.add_series(
                curve(colour, engine),
                shape,
                of_engine.map(|row| (x(row), row.core_seconds, None)),
            );
        }
        let end = of.iter().rfind(|row| row.engine == "particles").or(of.first())?;
        figure.add(power((x(end), end.core_seconds), 1.0, all_x(), GREY).label("slope 1"));
        Some(Drawn::new(name, figure, caption))
    };
    kinds.into_iter().filter_map(drawn).collect()
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
        "Size of the difference of the void ratio (–)",
    ];
    let x = log("Processor time of a packing (s)", tier.packings.iter().map(|row| row.core_seconds));
    let caption = "Size of the difference of the mean void ratio from the default settings against the \
                   processor time of a packing. Hollow: the 95 % interval holds zero. The floor is the \
                   scatter of as many seeds.";
    Some(Drawn::new("packing", differences(words, x, &changed, 3.0, floor), caption))
}

fn triangulations(tier: &PackingTier) -> Option<Drawn> {
    let rows = &tier.triangulations;
    let last = rows.last()?;
    let grains = || rows.iter().map(|row| row.grains as f64);
    let seconds = rows.iter().flat_map(|row| [row.triangulate_seconds, row.measure_seconds]);
    let mut figure = figure(
        "Time of triangulations",
        "Processor time of triangulation and of the constrictions against the number of grains",
        log("Grains", grains()),
        log("Processor time (s)", seconds),
    );
    let mut add = |name: &str, of: fn(&TriangulationRow) -> f64, colour, shape| {
        figure.add_points(
            name,
            rows.iter().map(|row| {
                let point = Point::new(row.grains as f64, of(row), colour, shape);
                if row.packing.starts_with("at random") { point.hollow() } else { point }
            }),
        );
    };
    add("triangulation", |row| row.triangulate_seconds, BLUE, Shape::Circle);
    add("voids, discs and curve", |row| row.measure_seconds, VERMILLION, Shape::Square);
    figure.add(power((last.grains as f64, last.triangulate_seconds), 1.0, grains(), GREY).label("slope 1"));
    let caption = "Processor time of the regular triangulation and of the constrictions measured on it. \
                   Filled: compressed packings; hollow: grains at random before compression.";
    Some(Drawn::new("triangulation", figure, caption))
}
