//! The figures of a precision study: log-log, with a guide line of slope -1/2 where more time means more samples.

use crate::outcome::precision::{
    BiasRow, DecisionTier, ExactRow, ExactTier, PackingTier, SamplingLine, SamplingTier, ScalingRow,
};
use crate::report::figures::{
    Across, Axis, BLACK, BLUE, Colour, Dash, Figure, GREEN, GREY, Line, ORANGE, PURPLE, Point, Rule, Shape,
    VERMILLION, ramp,
};
use crate::report::shell::Drawn;

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

/// Room for names above the frame, on a page and on a telephone.
const WIDE: (f64, f64) = (720.0, 500.0);
const NARROW: (f64, f64) = (358.0, 600.0);

/// Least and most of positive values.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let positive = values.filter(|v| *v > 0.0 && v.is_finite());
    let (low, high) =
        positive.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
    if low.is_finite() { (low, high) } else { (0.1, 1.0) }
}

/// A line of slope -1/2 through a point, from one x to another.
fn guide(through: (f64, f64), from: f64, to: f64) -> Line {
    let at = |x: f64| (x, through.1 * (through.0 / x).sqrt());
    Line::new(vec![at(from), at(to)], GREY).width(1.5).dash(Dash::Dashed).label("slope −1/2")
}

/// Distinct values in order of first appearance.
fn distinct<'a, T>(rows: &'a [T], of: impl Fn(&'a T) -> &'a str) -> Vec<&'a str> {
    let mut all: Vec<&str> = Vec::new();
    for name in rows.iter().map(of) {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

pub(super) fn exact(exact: &ExactTier) -> Vec<Drawn> {
    let captions = [
        (
            "exact-particles",
            "Root mean square error of the chance to leave over the random networks, against the number of particles. Dashed: the error of independent \
             particles, slope −1/2; particles, counts and single particles must lie on it. \"Expected\" draws nothing: its error is the rounding of its whole numbers. Filled: clogged lattice; hollow, dotted: first particle.",
        ),
        (
            "exact-time",
            "The same errors against the processor time of one network. Counts cost the same for any number of particles, so their line falls without more time. \
             Dashed: slope −1/2.",
        ),
    ];
    let mut figures = Vec::new();
    for (index, (name, caption)) in captions.into_iter().enumerate() {
        let by_time = index == 1;
        let x = |row: &ExactRow| if by_time { row.core_seconds } else { row.particles as f64 };
        let (low, high) = range(exact.rows.iter().map(x));
        let label = if by_time { "Processor time of a network (s)" } else { "Particles of a network" };
        let errors = exact.rows.iter().flat_map(|row| [row.error_low, row.error_high]);
        let (least, most) = range(errors);
        let mut figure = Figure::new(
            "Error against exact answers",
            "Root mean square error of the chance to leave, by engine",
            "",
            Axis::log(label, low, high),
            Axis::log("Error of the chance to leave (–)", least, most),
        )
        .names_above()
        .sizes(WIDE, NARROW);
        let mut named: Vec<&str> = Vec::new();
        for quantity in &exact.quantities {
            let rows: Vec<&ExactRow> =
                exact.rows.iter().filter(|row| row.quantity == quantity.name).collect();
            let mut engines: Vec<&str> = Vec::new();
            rows.iter().for_each(|row| {
                if !engines.contains(&row.engine.as_str()) {
                    engines.push(&row.engine)
                }
            });
            let first = quantity.name == exact.quantities[0].name;
            for engine in engines {
                let (colour, shape) = look(engine);
                let of_engine: Vec<&&ExactRow> = rows.iter().filter(|row| row.engine == engine).collect();
                let path = of_engine.iter().map(|row| (x(row), row.error)).collect();
                let dash = if first { Dash::Solid } else { Dash::Dotted };
                let line = Line::new(path, colour).width(1.5).dash(dash);
                let is_new = !named.contains(&engine);
                figure.add(if is_new { line.label(engine) } else { line });
                named.push(engine);
                for row in of_engine {
                    let bar = Some((row.error_low, row.error_high));
                    let point = Point::new(x(row), row.error, colour, shape).y_interval(bar);
                    figure.add(if first { point } else { point.hollow() });
                }
            }
        }
        let leading = exact.rows.iter().rev().find(|row| row.engine == "particles");
        if let Some(row) = leading {
            figure.add(guide((x(row), row.expected_error), low, high));
        }
        figures.push(Drawn { name, caption: caption.to_owned(), figure });
    }
    figures
}

pub(super) fn sampling(sampling: &SamplingTier) -> Vec<Drawn> {
    let captions = [
        (
            "sampling-new-networks",
            "new networks",
            "Over new networks and new walks: standard deviation of the mean of 1, 2, 4, ... replicates against the processor time that they take together. Bars: 95 % intervals from the \
             independent groups of replicates. The floor is the scatter between networks, which no other way of drawing base particles lowers.",
        ),
        (
            "sampling-one-network",
            "one network",
            "The same over new walks on one network: what a way of drawing base particles can change.",
        ),
    ];
    let drawn = |(name, kind, caption): (&'static str, &str, &str)| {
        let lines: Vec<&SamplingLine> = sampling.lines.iter().filter(|line| line.networks == kind).collect();
        (!lines.is_empty()).then(|| scatter(sampling, name, caption, &lines))
    };
    captions.into_iter().filter_map(drawn).collect()
}

fn scatter(sampling: &SamplingTier, name: &'static str, caption: &str, lines: &[&SamplingLine]) -> Drawn {
    const PP: f64 = 100.0;
    let kind = &lines[0].networks;
    let rows = || sampling.rows.iter().filter(|row| row.networks == *kind);
    let (low, high) = range(rows().map(|row| row.core_seconds));
    let errors = rows().flat_map(|row| [PP * row.error_low, PP * row.error_high]);
    let (least, most) = range(errors.chain([PP * lines[0].binomial]));
    let mut figure = Figure::new(
        &format!("Standard error of the eroded mass against time, {kind}"),
        "Standard deviation of means over replicates of the eroded mass fraction against processor time",
        "",
        Axis::log("Processor time of the replicates averaged (s)", low, high),
        Axis::log("Standard error of the eroded mass (percentage points)", least, most),
    )
    .names_above()
    .sizes(WIDE, NARROW);
    for line in lines {
        let (colour, shape) = look(&line.variant);
        let of_line = || rows().filter(|row| row.variant == line.variant);
        let path = of_line().map(|row| (row.core_seconds, PP * row.error)).collect();
        figure.add(Line::new(path, colour).width(1.5).label(&line.variant));
        for row in of_line() {
            let bar = Some((PP * row.error_low, PP * row.error_high));
            figure.add(Point::new(row.core_seconds, PP * row.error, colour, shape).y_interval(bar));
        }
    }
    let first = lines[0];
    figure.add(guide((first.core_seconds, PP * first.sd), low, high));
    if let (true, Some(floor)) = (kind == "new networks", between_networks(sampling, first)) {
        let at = |x: f64| (x, PP * floor * (first.core_seconds / x).sqrt());
        let floor = Line::new(vec![at(low), at(high)], BLACK).width(1.5).dash(Dash::Dashed);
        figure.add(floor.label("networks alone: the sampling floor"));
    }
    let binomial = vec![(low, PP * first.binomial), (high, PP * first.binomial)];
    let binomial = Line::new(binomial, BLACK).width(1.0).dash(Dash::Dotted);
    figure.add(binomial.label("one replicate by a binomial: too small"));
    Drawn { name, caption: caption.to_owned(), figure }
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

/// A difference with its interval on a logarithmic axis: its size, hollow where the interval holds zero.
fn sized(x: f64, bias: f64, interval: Option<(f64, f64)>, least: f64, look: (Colour, Shape)) -> Point {
    let point = Point::new(x, bias.abs().max(least), look.0, look.1);
    let Some((low, high)) = interval else { return point.hollow() };
    let holds_zero = low <= 0.0 && high >= 0.0;
    let (near, far) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
    let near = if holds_zero { least } else { near.max(least) };
    let point = point.y_interval(Some((near, far.max(least))));
    if holds_zero { point.hollow() } else { point }
}

pub(super) fn bias(rows: &[BiasRow]) -> Vec<Drawn> {
    const PP: f64 = 100.0;
    let changed: Vec<&BiasRow> = rows.iter().filter(|row| !row.reference).collect();
    let (low, high) = range(changed.iter().map(|row| row.core_seconds));
    let ends = changed.iter().flat_map(|row| [row.bias_low, row.bias_high]).flatten().map(|b| PP * b.abs());
    let (_, most) = range(ends.chain(changed.iter().map(|row| PP * row.bias.abs())));
    let least = most * 1e-4;
    let mut figure = Figure::new(
        "Bias of settings against time",
        "Size of the difference of the eroded mass from the reference setting, against processor time of a replicate",
        "",
        Axis::log("Processor time of a replicate (s)", low, high),
        Axis::log("Size of the difference from the reference (percentage points)", least, most),
    )
    .names_above()
        .sizes(WIDE, NARROW);
    for factor in distinct(rows, |row| &row.factor) {
        let (colour, shape) = factor_look(factor);
        let of_factor: Vec<&&BiasRow> = changed.iter().filter(|row| row.factor == factor).collect();
        for (index, row) in of_factor.iter().enumerate() {
            let interval = row.bias_low.zip(row.bias_high).map(|(l, h)| (PP * l, PP * h));
            let point = sized(row.core_seconds, PP * row.bias, interval, least, (colour, shape));
            figure.add(if index == 0 { point.label(factor) } else { point });
        }
    }
    // Half of the width of the reference's own interval: what is smaller was not to be seen without pairs.
    let unpaired = changed.iter().filter(|row| !row.paired);
    let widths = unpaired.filter_map(|row| Some(PP * (row.bias_high? - row.bias_low?) / 2.0));
    if let (true, floor) = (rows.len() > 1, widths.fold(f64::INFINITY, f64::min))
        && floor.is_finite()
    {
        let rule = Rule::new(Across::Y, floor, BLACK).dash(Dash::Dashed);
        figure.add(rule.label("sampling floor without common networks"));
    }
    let caption = "Size of the difference of the mean eroded mass from the reference setting, against the processor time of a replicate. Hollow: the 95 % interval holds zero. Bars: 95 % \
                   intervals, replicate by replicate where both were walked on the same networks."
        .to_owned();
    let mut figures = vec![Drawn { name: "bias", caption, figure }];
    figures.extend(amount(rows));
    figures
}

/// Eroded mass against the share of the base that is walked.
fn amount(rows: &[BiasRow]) -> Option<Drawn> {
    const PP: f64 = 100.0;
    let reference = rows.iter().find(|row| row.reference)?;
    let shares: Vec<&BiasRow> = rows.iter().filter(|row| row.factor == "base particles").collect();
    let smallest = shares.iter().map(|row| row.at).fold(1.0, f64::min);
    let highest = shares.iter().filter_map(|row| row.bias_high).fold(0.0, f64::max);
    let lowest = shares.iter().filter_map(|row| row.bias_low).fold(0.0, f64::min);
    if shares.is_empty() {
        return None;
    }
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
        "Difference of the eroded mass when only a part of the base particles that Eq. (2) asks for is walked: a bias that no replicate takes away. With all of them {:.1} % erode. Bars: 95 % \
         intervals.",
        PP * reference.value
    );
    Some(Drawn { name: "bias-base-particles", caption, figure })
}

pub(super) fn decision(decision: &DecisionTier) -> Vec<Drawn> {
    let (low, high) = range(decision.rows.iter().map(|row| row.core_seconds));
    let most = decision.rows.iter().map(|row| row.wrong_high).fold(0.1, f64::max);
    let mut figure = Figure::new(
        "Wrong class against time",
        "Share of wrong classes against processor time, for cases near the threshold",
        "",
        Axis::log("Processor time (s)", low, high),
        Axis::linear("Wrong class (% of trials)", 0.0, 100.0 * most),
    )
    .names_above()
    .sizes(WIDE, NARROW);
    for (index, case) in decision.cases.iter().enumerate() {
        let colour = ramp(index, decision.cases.len());
        let of = |rule: bool| {
            decision.rows.iter().filter(move |row| row.case == case.name && (row.rule == "fixed") == rule)
        };
        let path = of(true).map(|row| (row.core_seconds, 100.0 * row.wrong)).collect();
        figure.add(Line::new(path, colour).width(1.5).label(&case.name));
        for (fixed, shape) in [(true, Shape::Circle), (false, Shape::Diamond)] {
            for row in of(fixed) {
                let bar = Some((100.0 * row.wrong_low, 100.0 * row.wrong_high));
                let colour = if fixed { colour } else { VERMILLION };
                figure.add(Point::new(row.core_seconds, 100.0 * row.wrong, colour, shape).y_interval(bar));
            }
        }
    }
    let caption = "Share of trials whose class is not that of all replicates together, against their processor time; a line a case, named by its eroded mass. Circles: the mean of 1, 2, 4, ... \
                   replicates. Diamonds: sequential stopping. Bars: 95 % intervals."
        .to_owned();
    vec![Drawn { name: "decision", caption, figure }]
}

pub(super) fn scaling(rows: &[ScalingRow]) -> Vec<Drawn> {
    type Of = fn(&ScalingRow) -> f64;
    let kinds: [(&str, &'static str, &str, Of, &str); 2] = [
        (
            "base particles",
            "scaling-base-particles",
            "Base particles",
            |row| row.n_base as f64,
            "Processor time of a first run of this scene's base against the number of its particles. Dashed: in proportion.",
        ),
        (
            "voids",
            "scaling-voids",
            "Voids",
            |row| row.voids as f64,
            "Processor time of a first run on cubes, with as many base particles a void as this scene has. Dashed: in proportion.",
        ),
    ];
    let mut figures = Vec::new();
    for (against, name, label, x, caption) in kinds {
        let of: Vec<&ScalingRow> = rows.iter().filter(|row| row.against == against).collect();
        let Some(first) = of.first() else { continue };
        let (low, high) = range(of.iter().map(|row| x(row)));
        let (least, most) = range(of.iter().map(|row| row.core_seconds));
        let title = format!("Time against {against}");
        let mut figure = Figure::new(
            &title,
            &format!("Processor time of a first run against {against}, by engine"),
            "",
            Axis::log(label, low, high),
            Axis::log("Processor time of a first run (s)", least, most),
        )
        .names_above()
        .sizes(WIDE, NARROW);
        for engine in distinct(rows, |row| &row.engine) {
            let (colour, shape) = look(engine);
            let points: Vec<(f64, f64)> =
                of.iter().filter(|row| row.engine == engine).map(|row| (x(row), row.core_seconds)).collect();
            if points.is_empty() {
                continue;
            }
            points.iter().for_each(|&(x, y)| figure.add(Point::new(x, y, colour, shape)));
            figure.add(Line::new(points, colour).width(1.5).label(engine));
        }
        let end = of.iter().rfind(|row| row.engine == "particles").unwrap_or(first);
        let at = |to: f64| (to, end.core_seconds * to / x(end));
        figure.add(Line::new(vec![at(low), at(high)], GREY).width(1.5).dash(Dash::Dashed).label("slope 1"));
        figures.push(Drawn { name, caption: caption.to_owned(), figure });
    }
    figures
}

pub(super) fn packing(tier: &PackingTier) -> Vec<Drawn> {
    let mut figures = Vec::new();
    let changed: Vec<_> = tier.packings.iter().filter(|row| !row.reference).collect();
    if !changed.is_empty() {
        let (low, high) = range(tier.packings.iter().map(|row| row.core_seconds));
        let ends = changed.iter().flat_map(|row| [row.bias_low, row.bias_high]).flatten().map(f64::abs);
        let (_, most) = range(ends.chain(changed.iter().map(|row| row.bias.abs())));
        let least = most * 1e-3;
        let mut figure = Figure::new(
            "Void ratio of packings against time",
            "Size of the difference of the void ratio from the default settings, against processor time of a packing",
            "",
            Axis::log("Processor time of a packing (s)", low, high),
            Axis::log("Size of the difference of the void ratio (–)", least, most),
        )
        .names_above()
        .sizes(WIDE, NARROW);
        for factor in distinct(&tier.packings, |row| &row.factor) {
            let mut named = false;
            for row in changed.iter().filter(|row| row.factor == factor) {
                let interval = row.bias_low.zip(row.bias_high);
                let point = sized(row.core_seconds, row.bias, interval, least, factor_look(factor));
                figure.add(if named { point } else { point.label(factor) });
                named = true;
            }
        }
        let reference = tier.packings.iter().find(|row| row.reference);
        if let Some((sd, row)) = reference.and_then(|row| Some((row.void_ratio_sd?, row)))
            && sd > 0.0
        {
            let floor = sd * (2.0 / row.seeds as f64).sqrt();
            let rule = Rule::new(Across::Y, floor, BLACK).dash(Dash::Dashed);
            figure.add(rule.label("sampling floor: standard error of a difference"));
        }
        let caption = "Size of the difference of the mean void ratio from the default settings against the processor time of a packing. Hollow: the 95 % interval holds zero. The floor is what as \
                       many seeds scatter."
            .to_owned();
        figures.push(Drawn { name: "packing", caption, figure });
    }
    if !tier.triangulations.is_empty() {
        let rows = &tier.triangulations;
        let (low, high) = range(rows.iter().map(|row| row.grains as f64));
        let (least, most) = range(rows.iter().flat_map(|row| [row.triangulate_seconds, row.measure_seconds]));
        let mut figure = Figure::new(
            "Time of triangulations",
            "Processor time of triangulation and of the constrictions against the number of grains",
            "",
            Axis::log("Grains", low, high),
            Axis::log("Processor time (s)", least, most),
        )
        .names_above()
        .sizes(WIDE, NARROW);
        for (index, row) in rows.iter().enumerate() {
            let x = row.grains as f64;
            let points = [
                (row.triangulate_seconds, BLUE, Shape::Circle, "triangulation"),
                (row.measure_seconds, VERMILLION, Shape::Square, "voids, discs and curve"),
            ];
            for (y, colour, shape, name) in points {
                let point = Point::new(x, y, colour, shape);
                let point = if row.packing.starts_with("at random") { point.hollow() } else { point };
                figure.add(if index == 0 { point.label(name) } else { point });
            }
        }
        let last = &rows[rows.len() - 1];
        let at = |x: f64| (x, last.triangulate_seconds * x / last.grains as f64);
        figure.add(Line::new(vec![at(low), at(high)], GREY).width(1.5).dash(Dash::Dashed).label("slope 1"));
        let caption = "Processor time of the regular triangulation and of the constrictions measured on it. Filled: compressed packings; hollow: grains at random before compression.".to_owned();
        figures.push(Drawn { name: "triangulation", caption, figure });
    }
    figures
}
