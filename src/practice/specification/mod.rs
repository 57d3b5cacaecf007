//! The specification of a filter for a base, step by step.

mod curve;
mod formula;
mod sides;
mod steps;
#[cfg(test)]
mod tests;

use crate::SheetCover;
use crate::design::SieveSeries;
use crate::design::size_band::D15_OVER_D10;
use crate::design::specification::{NoBand, SizeBand, Specification, margins};
use crate::rules::{GREATEST_SIZE_MM, MOST_CU, NamedCurve, WIDEST_BAND};
use curve::ReadCurve;
use steps::{Control, Found};

/// Options of a specification.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpecificationOptions {
    /// True if the base is dispersive; `None` if nobody has said.
    pub dispersive: Option<bool>,
    /// Sieves at which the limits are stated.
    pub sieves: SieveSeries,
    /// True to place the band at the finer end of the allowed sizes instead of the coarser.
    pub finer: bool,
}

impl Specification {
    /// Specifies a filter for a base of one curve or of several, in mm. The filter must retain and drain
    /// every curve: the strictest limit of each kind counts.
    ///
    /// ```
    /// use voidwalk_core::Gradation;
    /// use voidwalk_practice::design::Specification;
    /// use voidwalk_practice::SpecificationOptions;
    /// let clay = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)])?;
    /// let filter = Specification::of("core", &[("core".into(), clay)], SpecificationOptions::default());
    /// assert_eq!((filter.d15f_min_mm, filter.d15f_max_mm), (Some(0.1), Some(0.7)));
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn of(name: &str, bases: &[NamedCurve], options: SpecificationOptions) -> Self {
        let dispersive = options.dispersive == Some(true);
        let read: Vec<ReadCurve> = bases.iter().map(|base| ReadCurve::of(base, dispersive)).collect();
        let strictest = read.iter().min_by(|a, b| a.greatest().total_cmp(&b.greatest()));
        let unknown = read.iter().find(|curve| curve.unknown.is_some());
        let d15f_max = strictest.filter(|_| unknown.is_none()).and_then(|curve| curve.of.d15f_max_mm);
        let coarsest = read.iter().max_by(|a, b| a.least().total_cmp(&b.least()));
        let d15f_min = coarsest.and_then(|curve| curve.of.d15f_min_mm);
        let control = d15f_min.zip(d15f_max).and_then(|(min, max)| control(min, max, options.finer));
        let band = control.as_ref().and_then(|control| SizeBand::of(control.d15, control.d60));
        let at_most = coarsest.is_some_and(ReadCurve::least_at_most);
        let certain = read.iter().map(ReadCurve::certain_least).fold(0.0, f64::max);
        let no_band = no_band((d15f_min, at_most), d15f_max, unknown, band.is_some());
        let if_dispersive = if options.dispersive.is_none() { curve::if_dispersive(bases) } else { None };
        let facts =
            Found { read: &read, strictest, unknown, coarsest, d15f_max, control, finer: options.finer };
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: None,
            base: name.into(),
            dispersive,
            sieves: options.sieves,
            cover: SheetCover::default(),
            inches: false,
            inputs: Vec::new(),
            steps: facts.steps(band.as_ref()),
            curves: read.iter().map(|curve| curve.of.clone()).collect(),
            notes: curve::notes(&read).into_iter().chain(sides::notes(band.as_ref())).collect(),
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

/// The control points of a band between a least and a maximum D15F (mm). If that range is wider than a band
/// may be, they lie at its finer or at its coarser end; `None` if the least is above the maximum.
fn control(min: f64, max: f64, finer: bool) -> Option<Control> {
    let d15 = match finer {
        true => [min, max.min(WIDEST_BAND * min)],
        false => [min.max(max / WIDEST_BAND), max],
    };
    let d60_max = MOST_CU * d15[1] / D15_OVER_D10;
    (min <= max).then_some(Control { d15, d60: [d60_max / WIDEST_BAND, d60_max] })
}

/// The D15F (mm) at which the band of a filter begins that drains from a least D15F (mm) and retains up to a
/// maximum: raised if the band would otherwise be too wide.
pub fn least_of_band(min: f64, max: f64) -> f64 {
    control(min, max, false).map_or(min, |control| control.d15[0])
}

/// Reason why no filter between a least and a maximum D15F (mm) has a band; `None` if one has.
pub fn no_band_between((min, at_most): (f64, bool), max: f64) -> Option<NoBand> {
    let band = control(min, max, false).and_then(|control| SizeBand::of(control.d15, control.d60));
    no_band((Some(min), at_most), Some(max), None, band.is_some())
}

/// Reason why there is no band.
fn no_band(
    (min, at_most): (Option<f64>, bool),
    max: Option<f64>,
    unknown: Option<&ReadCurve>,
    has_band: bool,
) -> Option<NoBand> {
    Some(match (min, max) {
        _ if has_band => return None,
        (Some(min), Some(max)) if min > max && at_most => {
            NoBand::DrainageNotKnown { most_drains_mm: min, most_mm: max }
        }
        (Some(min), Some(max)) if min > max => NoBand::NoneDrainsAndRetains { least_mm: min, most_mm: max },
        (Some(_), Some(max)) if MOST_CU * max / D15_OVER_D10 < GREATEST_SIZE_MM => NoBand::TooManyFines,
        (Some(_), Some(max)) => NoBand::TooCoarse { most_d60f_mm: MOST_CU * max / D15_OVER_D10 },
        _ => match unknown.and_then(|curve| Some((curve.of.curve.clone(), curve.unknown.clone()?))) {
            Some((curve, needs)) => NoBand::LimitNotKnown { curve, needs },
            None => NoBand::NoRule,
        },
    })
}
