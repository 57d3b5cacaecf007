//! The specification of a filter for a base, step by step, with its words.

mod curve;
mod formula;
mod sides;
mod steps;
#[cfg(test)]
mod tests;

use crate::gradation::{FEW_FINES, FINES_MM};
use crate::outcome::design::SieveSeries;
use crate::outcome::design::products::LEAST_CU;
use crate::outcome::design::specification::{SizeBand, Specification, margins};
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::record::{SheetCover, commit};
use crate::outcome::rules::{
    DESIGN_FLOOR_MM, GREATEST_SIZE_MM, LEAST_D15F_MM, MOST_CU, MOST_FINES_PERCENT, NamedCurve, WIDEST_BAND,
    range_of_tests,
};
use crate::verdict::words::capital;
use curve::ReadCurve;
use steps::{Control, D15_OVER_D10, Found};

/// What to do where a base is found to be dispersive.
pub const DESIGN_AGAIN: &str = "design again for a dispersive base";

/// The same of many samples.
pub const DESIGN_EACH_AGAIN: &str = "design again for dispersive soils";

/// What a specification is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpecificationOptions {
    /// Whether the base is dispersive; `None` where nobody has said.
    pub dispersive: Option<bool>,
    /// The sieves at which the limits are stated.
    pub sieves: SieveSeries,
    /// Whether the band is to lie at the finer end of what is allowed, and not at the coarser.
    pub finer: bool,
    /// Maximum D15F (mm) that the walk holds, where a base was walked.
    pub walked_mm: Option<f64>,
}

impl Specification {
    /// For a base of one curve or of several, in mm. Every curve is to be retained and drained: the strictest
    /// limit of each counts.
    ///
    /// ```
    /// use voidwalk::Gradation;
    /// use voidwalk::outcome::design::Specification;
    /// use voidwalk::verdict::SpecificationOptions;
    /// let clay = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)])?;
    /// let of = Specification::of("core", &[("core".into(), clay)], SpecificationOptions::default());
    /// assert_eq!((of.d15f_min_mm, of.d15f_max_mm), (Some(0.1), Some(0.7)));
    /// # Ok::<(), voidwalk::gradation::GradationError>(())
    /// ```
    pub fn of(name: &str, bases: &[NamedCurve], options: SpecificationOptions) -> Self {
        let dispersive = options.dispersive == Some(true);
        let read: Vec<ReadCurve> = bases.iter().map(|base| ReadCurve::of(base, dispersive)).collect();
        let strictest = read.iter().min_by(|a, b| a.greatest().total_cmp(&b.greatest()));
        let unknown = read.iter().find(|curve| curve.unknown.is_some());
        let by_practice = strictest.filter(|_| unknown.is_none()).and_then(|curve| curve.of.d15f_max_mm);
        let d15f_max = by_practice.map(|limit| options.walked_mm.map_or(limit, |walked| limit.min(walked)));
        let coarsest = read.iter().max_by(|a, b| a.least().total_cmp(&b.least()));
        let d15f_min = coarsest.and_then(|curve| curve.of.d15f_min_mm);
        let control = d15f_min.zip(d15f_max).and_then(|(min, max)| control(min, max, options.finer));
        let band = control.as_ref().and_then(|of| SizeBand::of(of.d15, of.d60));
        let at_most = coarsest.is_some_and(ReadCurve::least_at_most);
        let certain = read.iter().map(ReadCurve::certain_least).fold(0.0, f64::max);
        let no_band = no_band((d15f_min, at_most), d15f_max, unknown, band.is_some());
        let if_dispersive = if options.dispersive.is_none() { curve::if_dispersive(bases) } else { None };
        let found = Found {
            walked_mm: options.walked_mm,
            read: &read,
            strictest,
            unknown,
            coarsest,
            by_practice,
            d15f_max,
            control,
            finer: options.finer,
        };
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            base: name.into(),
            dispersive,
            sieves: options.sieves,
            cover: SheetCover::default(),
            inches: false,
            inputs: Vec::new(),
            steps: found.steps(band.as_ref()),
            curves: read.iter().map(|curve| curve.of.clone()).collect(),
            findings: curve::findings(&read).into_iter().chain(sides::findings(band.as_ref())).collect(),
            d15f_min_mm: d15f_min,
            d15f_min_at_most: at_most,
            d15f_max_mm: d15f_max,
            finer: options.finer,
            if_dispersive,
            limits: band.as_ref().map(|band| band.limits(options.sieves)).unwrap_or_default(),
            products: margins((d15f_min, certain), d15f_max),
            no_band,
            band,
        }
    }
}

/// The control points of a band between a least and a maximum D15F (mm), at the finer or at the coarser end
/// where that is wider than a band may be; `None` where the least is above.
fn control(min: f64, max: f64, finer: bool) -> Option<Control> {
    let d15 = match finer {
        true => [min, max.min(WIDEST_BAND * min)],
        false => [min.max(max / WIDEST_BAND), max],
    };
    let d60_max = MOST_CU * d15[1] / D15_OVER_D10;
    (min <= max).then_some(Control { d15, d60: [d60_max / WIDEST_BAND, d60_max] })
}

/// The D15F (mm) at which the band of a filter begins that drains from a least D15F (mm) and retains up to a
/// maximum: raised where the band would be too wide.
pub(super) fn least_of_band(min: f64, max: f64) -> f64 {
    control(min, max, false).map_or(min, |of| of.d15[0])
}

/// Why no filter between a least and a maximum D15F (mm) has a band; `None` where one has.
pub(super) fn no_band_between((min, at_most): (f64, bool), max: f64) -> Option<String> {
    let band = control(min, max, false).and_then(|of| SizeBand::of(of.d15, of.d60));
    no_band((Some(min), at_most), Some(max), None, band.is_some())
}

impl Specification {
    /// The band to specify, in words: D15F of both sides, and Cu. `None` without a band.
    ///
    /// ```
    /// use voidwalk::Gradation;
    /// use voidwalk::outcome::design::Specification;
    /// use voidwalk::verdict::SpecificationOptions;
    /// let clay = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)])?;
    /// let of = Specification::of("core", &[("core".into(), clay)], SpecificationOptions::default());
    /// assert_eq!(of.band_in_words().as_deref(), Some("D15F from 0.140 to 0.700 mm, Cu from 2 to 6"));
    /// # Ok::<(), voidwalk::gradation::GradationError>(())
    /// ```
    pub fn band_in_words(&self) -> Option<String> {
        let [least, greatest] = self.band.as_ref()?.d15_mm();
        let [lower, upper] = [rounded_up(least), rounded_down(greatest)];
        let is_open = self.d15f_min_at_most && self.d15f_min_mm.is_some_and(|drains| drains >= least);
        let open = match is_open {
            true => " (what drains the base is not known and at most the lower D15F)",
            false => "",
        };
        Some(format!("D15F from {lower} to {upper} mm{open}, Cu from {LEAST_CU} to {MOST_CU}"))
    }

    /// Why the band begins above the minimum D15F that drains the base, or ends below the maximum that
    /// retains it, in a sentence without its end; `None` where it does neither.
    pub fn raised_in_words(&self) -> Option<String> {
        let [least, greatest] = self.band.as_ref()?.d15_mm();
        if let Some(retains) = self.d15f_max_mm.filter(|of| greatest < of * (1.0 - 1e-9)) {
            let [retains, greatest] = [retains, greatest].map(rounded_down);
            return Some(format!(
                "The maximum D15F that retains the base is {retains} mm; this maximum is lowered to \
                 {greatest} mm, so that the band is no wider than {WIDEST_BAND} to 1"
            ));
        }
        let drains = self.d15f_min_mm.filter(|drains| least > drains * (1.0 + 1e-9))?;
        let at_most = if self.d15f_min_at_most { "not known, and at most " } else { "" };
        let [drains, least] = [drains, least].map(rounded_up);
        Some(format!(
            "The minimum D15F that drains the base is {at_most}{drains} mm; this minimum is raised to \
             {least} mm, so that the band is no wider than {WIDEST_BAND} to 1"
        ))
    }

    /// What a specification lacks that no text with its numbers could be read for, in a sentence: the maximum
    /// D90F, which keeps a filter from segregating. `None` without a band.
    pub fn still_to_set(&self) -> Option<String> {
        let least = steps::least_d10(self.band.as_ref()?);
        Some(format!(
            "Not a complete specification: there is no limit above D60F, and the maximum D90F is still to be \
             set from the table of FEMA (2011) or NRCS (National Engineering Handbook, Part 633, Chapter \
             26), \
             for a minimum D10F of {} mm.",
            // Where a table is entered: a finer D10F allows no coarser D90F.
            rounded_down(least)
        ))
    }

    /// What a delivery must keep beside the limits at the sieves: between two sieves it may leave the band
    /// or have a gap. `None` without a band.
    pub fn beside_limits(&self) -> Option<String> {
        let [least, greatest] = self.band.as_ref()?.d15_mm();
        Some(format!(
            "The limits alone are not enough: D15F of each delivery must lie between {} and {} mm, its Cu \
             between {LEAST_CU} and {MOST_CU}, and it must have no gap. Judge each delivery by its own \
             gradation.",
            rounded_up(least),
            rounded_down(greatest)
        ))
    }
}

impl Specification {
    /// That the maximum D15F has no margin, where practice sets it and it is the boundary of no erosion of
    /// tests itself: a sentence without its end.
    pub fn without_margin_in_words(&self) -> Option<String> {
        let greatest = self.d15f_max_mm?;
        let limits = self.curves.iter().filter_map(|curve| Some((curve, curve.d15f_max_mm?)));
        let (curve, limit) = limits.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let fines = curve.fines_percent.filter(|_| curve.without_margin && greatest >= limit)?;
        let why = match (self.dispersive && fines >= FEW_FINES, range_of_tests(fines, curve.d85_mm?)) {
            // The limit of design is the floor of any filter then, and above the boundary of tests.
            (true, _) if limit < DESIGN_FLOOR_MM => {
                "it is the boundary of no erosion in tests (Fell et al., Table 9.2, note b)".into()
            }
            (true, _) => {
                "Fell et al. (Table 9.2, note b) give it for no erosion in tests; it is taken for design, too"
                    .into()
            }
            (false, [low, high]) if limit <= low * (1.0 + 1e-9) => format!(
                "it is the lower end of the range in which tests put the boundary of no erosion ({} to {} \
                 mm; Fell et al., Table 9.2)",
                rounded_down(low),
                rounded_up(high)
            ),
            (false, [low, high]) => format!(
                "it lies {} the range in which tests put the boundary of no erosion ({} to {} mm; Fell et \
                 al., Table 9.2)",
                if limit > high { "beyond" } else { "in" },
                rounded_down(low),
                rounded_up(high)
            ),
        };
        Some(format!("This limit has no margin: {why}"))
    }

    /// What the maximum D15F is if the base is dispersive, what of the specification does not hold then, and
    /// what to do, as [`DESIGN_AGAIN`]: sentences, the last without its end; `None` where it all holds, or
    /// somebody has said whether it is.
    pub fn if_dispersive_in_words(&self, again: &str) -> Option<String> {
        let of =
            self.if_dispersive.filter(|of| of.beside(self.d15f_max_mm.unwrap_or(f64::INFINITY)).is_some())?;
        let [before, invalid] = match self.band {
            Some(_) => ["this band is specified", "this band is not valid: "],
            None => ["a filter is specified", ""],
        };
        let (limit, test) = of.limit_of_base();
        let test = test.map_or_else(String::new, |test| format!(", and {test}"));
        Some(format!(
            "Whether the base is dispersive is not stated: have it tested (pinhole or crumb) before \
             {before}. If it is, {invalid}{limit}. {}{test}",
            capital(again)
        ))
    }
}

/// Why there is no band.
fn no_band(
    (min, at_most): (Option<f64>, bool),
    max: Option<f64>,
    unknown: Option<&ReadCurve>,
    has_band: bool,
) -> Option<String> {
    match (min, max) {
        _ if has_band => None,
        (Some(min), Some(max)) if min > max && at_most => Some(format!(
            "The minimum D15F that drains this base is not known. It is at most {} mm, and D15F must be at \
             most {} mm to retain the base: D15B must be tested.",
            rounded_up(min),
            rounded_down(max)
        )),
        (Some(min), Some(max)) if min > max => Some(format!(
            "No filter both drains and retains this base: D15F must be at least {} mm to drain it and at \
             most {} mm to retain it. {}",
            rounded_up(min),
            rounded_down(max),
            // So fine a base is not broad: the least D15F of any filter is beyond its limit.
            match min <= LEAST_D15F_MM {
                true =>
                    "Have the base tested in the laboratory with the filter, or take a filter in two stages.",
                false => "A filter in two stages, or a base that is less broad, is needed.",
            }
        )),
        (Some(_), Some(max)) if MOST_CU * max / D15_OVER_D10 < GREATEST_SIZE_MM => Some(format!(
            "The coarse side would have more than {MOST_FINES_PERCENT} % finer than {FINES_MM} mm."
        )),
        (Some(_), Some(max)) => Some(format!(
            "The maximum D60F is {} mm and lies beyond the greatest size of {GREATEST_SIZE_MM} mm.",
            rounded_down(MOST_CU * max / D15_OVER_D10)
        )),
        _ => Some(match unknown.and_then(|curve| curve.unknown.as_ref().map(|why| (&curve.of.curve, why))) {
            Some((curve, why)) => format!("The maximum D15F is not known for {curve}: {why}."),
            None => "No rule of retention covers this base.".into(),
        }),
    }
}
