//! Tables that can hardly be a base and its filter: exchanged, or in another unit.

use crate::Note;
use crate::quantity::significant;
use crate::rules::{BaseSoil, NamedCurve};
use voidwalk_core::gradation::Gradation;

/// Two tables that can hardly be a base and its filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// The error, if the two are refused.
    pub sentence: String,
    /// The note, if they are not refused.
    pub note: Note,
    /// Kind of mistake.
    pub kind: MistakeKind,
}

/// Kind of mistake in two tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MistakeKind {
    /// Sizes so far apart that a unit must be wrong, or the files are exchanged.
    Unit,
    /// The D15 of the base is far above the D15 of the filter.
    Exchanged,
    /// The base is the coarser of the two, but not by enough to prove an exchange.
    Coarser,
    /// The filter's sizes may be micrometres.
    Boulders,
}

/// Bounds of the size that a percentage is finer than: two if it lies in a finest tail.
struct Bounds {
    least: f64,
    most: f64,
}

impl Bounds {
    fn of(soil: &Gradation, percent: f64) -> Self {
        match soil.d(percent) {
            Some(size) => Self { least: size, most: size },
            None => Self { least: 0.0, most: soil.smallest_mm() },
        }
    }

    fn words(&self) -> String {
        if self.least > 0.0 { format!("{:.3} mm", self.most) } else { format!("below {:.3} mm", self.most) }
    }
}

impl Mistake {
    /// Looks for exchanged tables, and for micrometres where mm are meant.
    ///
    /// The D15 of both are compared as sampled, as for permeability: a broad till has a D50 above many
    /// filters that hold it, and a D15 far below. The bounds of an open finest tail are compared. Two soils
    /// that are close are told apart by the D50 of the regraded base, with a warning only. Sizes that are
    /// multiples of D0F (`scale_free`) have no unit that could be wrong.
    ///
    /// ```
    /// use voidwalk_core::Gradation;
    /// use voidwalk_practice::Mistake;
    /// let base = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)])?;
    /// let filter = Gradation::from_lines(&[(0.5, 0.0), (2.0, 100.0)])?;
    /// assert_eq!(Mistake::find(&base, &filter, false), None);
    /// assert!(Mistake::find(&filter, &base, false).unwrap().is_refused());
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn find(base: &Gradation, filter: &Gradation, scale_free: bool) -> Option<Self> {
        /// No soil is so much coarser than its filter (D50).
        const HOPELESS: f64 = 50.0;
        /// A filter whose D15 is this much finer than its base's drains less than the base does, and practice
        /// asks for the contrary, four or five times: the other order of such a pair is the right one.
        const FINER: f64 = 2.0;
        /// No filter is coarser than this (D50, mm).
        const BOULDERS_MM: f64 = 300.0;
        let [d15f, d50f] = [15.0, 50.0].map(|percent| Bounds::of(filter, percent));
        let [d15b, d50b] = [15.0, 50.0].map(|percent| Bounds::of(base, percent));
        if d50b.least > HOPELESS * d50f.most && d15b.most > d15f.least && !scale_free {
            let sentence = format!(
                "the base (D50 {}) is {:.0} times as coarse as the filter (D50 {}): are its sizes \
                 micrometres under a header in mm, or are the two files exchanged?",
                d50b.words(),
                d50b.least / d50f.most,
                d50f.words()
            );
            let note = Note::UnitDoubtful { base_d50_mm: d50b.least, filter_d50_mm: d50f.most };
            return Some(Self { sentence, note, kind: MistakeKind::Unit });
        }
        let BaseSoil { gradation, regraded_at_mm, .. } = BaseSoil::of(base, scale_free);
        let regraded = Bounds::of(&gradation, 50.0);
        // In a base regraded at a gap, the part that practice looks at may be far finer than its D15.
        let looked_at = Bounds::of(&gradation, 85.0);
        let is_fine = regraded_at_mm.is_some() && looked_at.most < d15f.least;
        let is_far = d15b.least > FINER * d15f.most && !is_fine;
        if is_far || (d15b.least > d15f.most && regraded.least > d50f.most) {
            let how =
                regraded_at_mm.map_or(String::new(), |at| format!(" regraded on {} mm", significant(at)));
            let sentence = format!(
                "the base is coarser than the filter (D15 {} against {}, D50 {}{how} against {}): are \
                 the two files exchanged? Or its sizes micrometres under a header in mm?",
                d15b.words(),
                d15f.words(),
                regraded.words(),
                d50f.words()
            );
            let kind = if is_far { MistakeKind::Exchanged } else { MistakeKind::Coarser };
            let note = Note::FilesExchanged { base_d15_mm: d15b.most, filter_d15_mm: d15f.most };
            return Some(Self { sentence, note, kind });
        }
        (d50f.least > BOULDERS_MM && !scale_free).then(|| Self {
            sentence: format!(
                "the filter's D50 is {:.0} mm: are its sizes micrometres under a header in mm?",
                d50f.least
            ),
            note: Note::FilterOfBoulders { d50_mm: d50f.least },
            kind: MistakeKind::Boulders,
        })
    }

    /// Looks for mistakes in two envelopes, by every base and the coarsest filter, so that a single sensible
    /// pair of curves prevents a refusal.
    pub fn of_envelopes(bases: &[NamedCurve], filters: &[NamedCurve]) -> Option<Self> {
        let d15 = |curve: &NamedCurve| curve.1.d(15.0).unwrap_or(0.0);
        let (_, coarsest) = filters.iter().max_by(|a, b| d15(a).total_cmp(&d15(b)))?;
        let mut all = Vec::new();
        for (_, base) in bases {
            all.push(Self::find(base, coarsest, false)?);
        }
        let refused = all.iter().position(|mistake| !mistake.is_refused()).unwrap_or(0);
        all.into_iter().nth(refused)
    }

    /// True if the two tables are refused, unless the user says that they are as given.
    pub fn is_refused(&self) -> bool {
        matches!(self.kind, MistakeKind::Unit | MistakeKind::Exchanged)
    }

    /// Text of the refusal on the command line.
    pub fn refusal(&self) -> String {
        self.refusal_unless("--as-given")
    }

    /// Text of the refusal if another setting says that the two are as given.
    pub fn refusal_unless(&self, as_given: &str) -> String {
        format!(
            "{} The base is named first, then the filter: exchange the two, or say that they are as given \
             ({as_given})",
            self.sentence
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PairRules;

    fn linear(d0_mm: f64) -> Gradation {
        Gradation::linear_from_d0(d0_mm, 2.0).unwrap()
    }

    #[test]
    fn exchanged_tables_and_micrometres_are_recognised() {
        let mistake = |base: f64, filter: f64| Mistake::find(&linear(base), &linear(filter), false);
        assert_eq!(mistake(0.2, 2.0), None);
        let exchanged = mistake(2.0, 0.2).unwrap();
        assert_eq!(exchanged.kind, MistakeKind::Exchanged);
        assert!(exchanged.refusal().contains("are the two files exchanged?"));
        assert!(exchanged.refusal().ends_with("(--as-given)"));
        // 318 um, read as mm.
        let micrometres = mistake(200.0, 2.0).unwrap();
        assert!(micrometres.sentence.contains("micrometres under a header in mm"));
        assert_eq!(micrometres.kind, MistakeKind::Unit);
        let boulders = mistake(0.2, 400.0).unwrap();
        assert!(boulders.sentence.contains("the filter's D50 is 800 mm") && !boulders.is_refused());
    }

    /// A base, its filter, and true if the filter drains the base.
    fn a_pair(draw: &mut impl FnMut() -> f64) -> Option<(Gradation, Gradation, bool)> {
        let mut between = |low: f64, high: f64| low + (high - low) * draw();
        // Three straight pieces over log size, of any breadth; two in five end at the No. 200 sieve.
        let d50 = libm::exp(between(libm::log(0.01), libm::log(2.0)));
        let widths = [between(0.2, 2.5), between(0.2, 2.0), between(0.1, 1.6), between(0.1, 1.2)];
        let size = |power: f64| d50 * libm::exp(power);
        let rows = [
            (size(-widths[0] - widths[1]), 0.0),
            (size(-widths[1]), between(8.0, 30.0)),
            (d50, 50.0),
            (size(widths[2]), between(70.0, 92.0)),
            (size(widths[2] + widths[3]), 100.0),
        ];
        let is_open = between(0.0, 1.0) < 0.4;
        let rows: Vec<(f64, f64)> = rows.into_iter().filter(|row| !is_open || row.0 >= 0.075).collect();
        let base = Gradation::from_lines(&rows).ok()?;
        let any = Gradation::linear_from_dx(15.0, 1.0, 1.5).ok()?;
        let rules = PairRules::of(&base, &any).rules;
        let limit = rules.iter().find(|rule| rule.id == "sherard-dunnigan")?.limit?;
        let d15f = limit * between(0.4, 1.5);
        let filter = Gradation::linear_from_dx(15.0, d15f, between(1.3, 8.0)).ok()?;
        let drains = d15f >= 4.0 * base.d(15.0).unwrap_or(base.smallest_mm());
        Some((base, filter, drains))
    }

    /// 5000 pairs whose filter holds the base, or nearly: half to one and a half of the limit of design.
    #[test]
    fn sensible_pairs_pass_in_their_order_and_are_refused_in_the_other() {
        let mut state = 20_261_124_u64;
        let mut draw = || {
            // Knuth's MMIX generator: good enough for soils.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut all, mut draining, mut refused, mut missed, mut missed_draining) = (0, 0, 0, 0, 0);
        while all < 5000 {
            let Some((base, filter, drains)) = a_pair(&mut draw) else { continue };
            let is_refused = |base: &Gradation, filter: &Gradation| {
                Mistake::find(base, filter, false).is_some_and(|m| m.is_refused())
            };
            all += 1;
            draining += usize::from(drains);
            refused += usize::from(is_refused(&base, &filter));
            let is_missed = !is_refused(&filter, &base);
            missed += usize::from(is_missed);
            missed_draining += usize::from(is_missed && drains);
        }
        println!(
            "{all} pairs, {draining} drain: {refused} refused in the right order; exchanged, {missed} of \
             all and \
             {missed_draining} of those that drain are not refused"
        );
        assert_eq!(refused, 0);
        assert!(missed * 50 < all && missed_draining * 200 < draining, "{missed} {missed_draining}");
    }

    /// A natural sand a little coarser than its filter sand gets a warning and is not refused.
    #[test]
    fn two_soils_that_are_close_are_no_exchange() {
        let sand = |d15: f64| Gradation::linear_from_dx(15.0, d15, 2.0).unwrap();
        let close = Mistake::find(&sand(0.3), &sand(0.18), false).unwrap();
        assert!(close.kind == MistakeKind::Coarser && !close.is_refused());
        assert!(Mistake::find(&sand(0.37), &sand(0.18), false).unwrap().is_refused());
    }

    /// A gravel with a gap, regraded on it: practice looks at the silt, which no filter can be exchanged
    /// with.
    #[test]
    fn a_base_that_is_regraded_at_a_gap_is_no_exchange() {
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let gravel = soil(&[(0.01, 0.0), (0.05, 9.0), (0.06, 12.0), (2.0, 12.0), (8.0, 60.0), (20.0, 100.0)]);
        let filter = soil(&[(0.15, 0.0), (0.2, 15.0), (0.6, 60.0), (2.0, 100.0)]);
        let BaseSoil { regraded_at_mm, gradation, .. } = BaseSoil::of(&gravel, false);
        assert!(
            regraded_at_mm.is_some() && gradation.d(85.0).unwrap() < 0.2 && gravel.d(15.0).unwrap() > 0.4
        );
        assert_eq!(Mistake::find(&gravel, &filter, false), None);
    }

    /// A till whose D50 is above the D50 of its filter sand.
    #[test]
    fn a_broad_till_is_no_exchange() {
        let till = [(0.002, 2.0), (0.02, 15.0), (0.075, 22.0), (0.425, 34.0), (5.0, 50.0), (75.0, 100.0)];
        let till = Gradation::from_lines(&till).unwrap();
        let c33 =
            [(0.075, 1.5), (0.15, 5.0), (0.3, 17.5), (0.6, 42.5), (1.18, 67.5), (2.36, 90.0), (9.5, 100.0)];
        let c33 = Gradation::from_lines(&c33).unwrap();
        assert!(till.d(50.0) > c33.d(50.0) && till.d(15.0).unwrap() < 0.021);
        assert_eq!(Mistake::find(&till, &c33, false), None);
        assert_eq!(Mistake::find(&c33, &till, false).unwrap().kind, MistakeKind::Exchanged);
    }
}
