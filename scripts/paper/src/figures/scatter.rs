//! A figure of points in groups, with rules across it: most figures of the paper are such.

use voidwalk::outcome::record::Statistic;
use voidwalk::report::figures::{
    Across, Axis, BLACK, BLUE, Colour, Dash, Figure, GREEN, GREY, Line, Point, Rule, Shape, VERMILLION,
};
use voidwalk::report::shell::Drawn;

/// Points of one kind.
pub struct Group {
    pub label: String,
    pub colour: Colour,
    pub shape: Shape,
    pub hollow: bool,
    /// Joined by a thin line.
    pub joined: bool,
    /// x, and y with its interval.
    pub points: Vec<(f64, Statistic)>,
}

/// Colour of a base by its Cu.
pub fn colour_of(cu_b: &str) -> Colour {
    match cu_b {
        "1.5" => BLUE,
        "3" => GREEN,
        _ => VERMILLION,
    }
}

/// What a plot is called, and its axes.
pub struct Plot {
    pub name: &'static str,
    pub title: &'static str,
    pub caption: String,
    pub x: &'static str,
    pub y: &'static str,
    /// Percent from 0 to 100 upward.
    pub percent: bool,
    /// Reaches at least from here to there along x.
    pub reach: (f64, f64),
}

/// A line across a plot.
pub fn across(axis: Across, at: f64, label: &str) -> Rule {
    let colour = if axis == Across::Y { BLACK } else { GREY };
    Rule::new(axis, at, colour).dash(Dash::Dashed).label(label)
}

/// `None` where there is no point.
pub fn scatter(plot: Plot, rules: Vec<Rule>, groups: Vec<Group>) -> Option<Drawn> {
    let points = || groups.iter().flat_map(|group| &group.points);
    points().next()?;
    let (low, high) = points().fold(plot.reach, |(low, high), (x, _)| (low.min(*x), high.max(*x)));
    let highest = points().map(|(_, y)| y.high.unwrap_or(y.mean)).fold(0.0, f64::max);
    let y = if plot.percent { Axis::percent(plot.y) } else { Axis::linear(plot.y, 0.0, 1.08 * highest) };
    // Names stand above the frame, and are not to take its room.
    let key = 10.0 * (groups.len() + rules.len()) as f64;
    let mut figure = Figure::new(plot.title, &plot.caption, "", Axis::linear(plot.x, low, high), y)
        .sizes((720.0, 370.0 + key), (358.0, 330.0 + 2.0 * key))
        .names_above();
    for rule in rules {
        figure.add(rule);
    }
    for group in groups {
        let mut sorted = group.points;
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        if group.joined {
            figure
                .add(Line::new(sorted.iter().map(|(x, y)| (*x, y.mean)).collect(), group.colour).width(1.0));
        }
        for (index, (x, y)) in sorted.iter().enumerate() {
            let point = Point::new(*x, y.mean, group.colour, group.shape).y_interval(y.low.zip(y.high));
            let point = if group.hollow { point.hollow() } else { point };
            figure.add(if index == 0 { point.label(&group.label) } else { point });
        }
    }
    Some(Drawn { name: plot.name, caption: plot.caption, figure })
}
