//! The walk's own boundary beside the range of D15F in which erosion began in tests.

use crate::outcome::apart::digits_of;
use crate::outcome::design::specification::SpecifiedCurve;
use crate::outcome::design::{Design, Specification};
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::rules::range_of_tests;
use crate::verdict::entry::EVIDENCE_UNSAFE;

/// A boundary of no erosion of the walk that lies beyond every D15F without erosion in tests.
pub(super) struct BeyondTests {
    /// D15F (mm) between which erosion began in tests on soils with such fines.
    range_mm: [f64; 2],
    /// The walk's D15F over the centre of that range, the geometric mean of its ends.
    pub by_centre: f64,
    /// Real soils of this kind, where nine in ten or more have a smaller ratio.
    soils: Option<u64>,
}

impl BeyondTests {
    /// Of a design and its specification, which knows the base as practice regrades it. `None` where the
    /// boundary lies within the range or below it, where one of them is not known, and of a dispersive base,
    /// which had other tests.
    pub fn of(design: &Design, specification: Option<&Specification>) -> Option<Self> {
        let specification = specification.filter(|of| !of.dispersive && !design.inverse)?;
        let greatest = |curve: &&SpecifiedCurve| curve.d15f_max_mm.unwrap_or(f64::INFINITY);
        let base = specification.curves.iter().min_by(|a, b| greatest(a).total_cmp(&greatest(b)))?;
        let range_mm = range_of_tests(base.fines_percent?, base.d85_mm?);
        let (row, held) = design.least_held()?;
        let ratio = row.no_erosion.as_ref().map_or(held, |boundary| boundary.median);
        let d15f_mm = ratio * design.base.d85_mm?;
        let [low, high] = range_mm;
        if d15f_mm <= high {
            return None;
        }
        let by_centre = d15f_mm / (low * high).sqrt();
        Some(Self { range_mm, by_centre, soils: soils_below(design, by_centre) })
    }

    /// What the walk is worth then, in a sentence without its full stop.
    pub fn words(&self) -> String {
        let [low, high] = self.range_mm;
        let soils = match self.soils {
            Some(soils) => format!(", beyond that of nine in ten of {soils} soils of this kind"),
            None => String::new(),
        };
        format!(
            "The walk is no guide here: its boundary of no erosion is {} times the centre of the range in \
             which erosion began in tests on soils with such fines ({} to {} mm; Fell et al., Table \
             9.2){soils}",
            digits_of(self.by_centre, 2),
            rounded_down(low),
            rounded_up(high)
        )
    }
}

/// How many real soils of this kind were walked, where nine in ten of them or more have a boundary that lies
/// nearer to the centre of tests.
fn soils_below(design: &Design, by_centre: f64) -> Option<u64> {
    let of_kind = design.findings.iter().find(|of| of.finding.id == EVIDENCE_UNSAFE)?;
    let number = |name: &str| of_kind.finding.numbers.get(name);
    let high = number("high")?.as_f64()?;
    number("soils")?.as_u64().filter(|_| by_centre > high)
}
