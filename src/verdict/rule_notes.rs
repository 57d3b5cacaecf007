//! The words of what rules of practice say beside their results, and of why practice regrades a base.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::quantity::{fixed, given};
use crate::gradation::{FEW_FINES, RegradeCause, RegradeReason};
use crate::outcome::numbers::{in_digits, rounded_down, rounded_up, significant};
use crate::outcome::record::{RuleNote, RuleText};

impl RuleNote {
    /// What it says, as a part of a sentence.
    pub fn words(self) -> String {
        let text = match self {
            Self::NeedsFinesOfBase => {
                "needs finer sieves of the base: whether it has 15 % fines or more is not known"
            }
            Self::NeedsD85B => "needs the base's D85: finer sieves, or base.d0_mm",
            Self::NeedsD95B => "needs the base's D95: finer sieves",
            Self::NeedsD15B => "needs the base's D15: finer sieves, or base.d0_mm",
            Self::NeedsD15F => "needs the filter's D15: finer sieves, or filter.d0_mm",
            Self::NeedsD15FSieved => "needs the filter's D15: finer sieves",
            Self::NeedsD10F => "needs the filter's D10: finer sieves",
            Self::NeedsFinesOfFilter => "needs finer sieves of the filter, down to 0.075 mm",
            Self::NeedsSievesOfFilter => "needs finer sieves of the filter",
            Self::NeedsFinestPartOfFilter => {
                "needs finer sieves, or filter.d0_mm: too much of the filter is finer than its finest sieve"
            }
            Self::NeedsCurveOfFilter => "needs the filter's sieve curve",
            Self::NeedsCurveOfFilterInMm => "needs the filter's sieve curve in mm",
            Self::NeedsTestOfDispersive => {
                "needs a test of this soil: it is dispersive, and no source that was read gives its limit \
                 with so few fines; that of other soils is the most that it can be"
            }
            Self::NeedsErosion => "needs a walk whose first run erodes something",
            Self::D15FBetween(from, to) => return between("D15F lies", from, to),
            Self::D15BBetween(from, to) => return between("D15B lies", from, to),
            Self::D85BBetween(from, to) => return between("D85B lies", from, to),
            Self::D95BBetween(from, to) => return between("D95B lies", from, to),
            Self::FilterBetween(from, to) => return between("sizes of the filter are not known", from, to),
            Self::BaseBetween(from, to) => return between("sizes of the base are not known", from, to),
            Self::FlatBase(limit) => {
                let limit = rounded_down(limit);
                return format!("the base may be gap-graded: the stricter limit; the other is {limit} mm");
            }
            Self::Dispersive => "dispersive",
            Self::Category(category) => return format!("base category {category}"),
            Self::RegradedOn(size) => return format!("base regraded on {} mm", significant(size)),
            Self::BeforeRegrading => "base before regrading",
            Self::TakenAsSand => "sizes are multiples of D0F: taken as a sand without fines",
            Self::ResultOfModel => "a result of the model, for the base as it is walked",
            Self::BeyondAnyLimit => "beyond the most that the limit can be",
            Self::NoClearBoundary => {
                "not a limit: with 15 to 85 % fines and D95B above 2 mm tests identified no boundary of \
                 continuing erosion (Fell et al., section 9.3.2); the manual of the Corps has one in a \
                 figure alone"
            }
            Self::BeyondUnclearBoundary => {
                "beyond 9 D95B, though with 15 to 85 % fines and D95B above 2 mm tests identified no \
                 boundary of continuing erosion (Fell et al., section 9.3.2)"
            }
            Self::ExcessiveNotJudged => "continuing erosion not reached; excessive erosion not judged",
            Self::ByFines(times, until, fines) => {
                let [width, until] = [until - FEW_FINES, until].map(given);
                let fines = given((100.0 * fines).round() / 100.0);
                let times = if times == 1.0 { String::new() } else { given(times) + " " };
                let by_fines = format!("[({until} - {fines})/{width} (4 D85B - 0.7) + 0.7]");
                return format!("{times}{by_fines} mm for {fines} % fines");
            }
            Self::FloorGoverns(times, size) => {
                return format!("its floor: {} D85B would be {} mm", given(times), rounded_down(size));
            }
            Self::LeastGoverns(times, size) => {
                return format!("its floor: {} D15B is below {} mm", given(times), rounded_up(size));
            }
            Self::D15FAtMost => "D15F is finer than the finest sieve: at most this",
            Self::LimitAtMost => "D15B is finer than the finest sieve: no more than this is needed",
            Self::LimitAtLeast => "D15B is finer than the finest sieve; the limit is never less than this",
            Self::CuAtLeast => "D10 is finer than the finest sieve: Cu is at least this",
            Self::FinestSieveOfFilter(size) => {
                return format!("the finest sieve is {} mm: at most what passes it", significant(size));
            }
            Self::AtPercentFiner(percent) => return format!("at {} % finer", fixed(percent, 0)),
            Self::BandFrom(percent) => {
                return format!("compared from {} % finer, as no finer sieve tells", fixed(percent, 0));
            }
            Self::Joint(joint, d95b, ratio) => {
                let [d95b, ratio] = [fixed(d95b, 3), fixed(ratio, 2)];
                return format!(
                    "joint of {} mm, D95B {d95b} mm: JOS/D95B = {ratio}; steady flow",
                    given(joint)
                );
            }
            Self::LessThanSource => "less than 0.01 %",
            Self::ChecksWalk => "checks the walk against their tests, not the filter",
            Self::FarFinerThanTests(times) => {
                let times = in_digits(times, 2);
                return format!("{times} times finer: the openings walked are not those of such tests");
            }
            Self::KezdiAt(split, coarse, fine) => {
                let [coarse, fine] = [coarse, fine].map(significant);
                return format!(
                    "split at {} % finer: D'15 of the coarser part {coarse} mm, d'85 of the finer part \
                     {fine} mm",
                    fixed(split, 1)
                );
            }
            Self::KezdiSplits(from, to) => {
                return format!("judged over splits at {} to {} % finer", fixed(from, 1), fixed(to, 1));
            }
            Self::KezdiHidden(share) => {
                let share = fixed(share, 0);
                return format!("what its {share} % finer than the finest sieve hide is not known");
            }
            Self::ShapeAt(at, most) => {
                return format!("at F = {} %, judged up to F = {} %", fixed(at, 1), given(most));
            }
            Self::ShapeAbovePan(at, from, most) => {
                let [at, from] = [at, from].map(|percent| fixed(percent, 1));
                return format!(
                    "at F = {at} %, judged from F = {from} % (finest sieve) up to F = {} %",
                    given(most)
                );
            }
            Self::BurenkovaRange(whole, low, high) => {
                let [whole, low, high] = [whole, low, high].map(|value| fixed(value, 2));
                return format!("h'' = D90/D15 = {whole}; the range is {low} to {high}");
            }
            Self::WanFellSand => "as sand and gravel with up to 10 % of fines that are not plastic",
            Self::WanFellSilt => {
                "as silt, sand and gravel with up to 10 % of clay and a plasticity index of up to 12"
            }
            Self::WanFellContours => {
                "the source states contours from 5 to 95 % and no limit, and is unsure of soils with less \
                 than 15 % of finer fraction"
            }
            Self::LimitsByFines(percent) => {
                let percent = fixed(percent, 0);
                return format!("{percent} % of the base is fines: limits by fines stand in its place");
            }
            Self::BurenkovaSoils => "for grains of up to 100 mm and a Cu of up to 200",
            Self::BurenkovaThirdZone(high) => {
                return format!(
                    "h' is above {}: Burenkova's third zone, of which Wan and Fell have no tests and expect \
                     no loss of fines",
                    fixed(high, 2)
                );
            }
            Self::UniformFilter => "the filter is neither broadly graded (Cu of 6 and more) nor gap-graded",
        };
        text.into()
    }
}

/// The end of every note on two sieves that stand far apart.
const TEST_BETWEEN: &str = ": test the sieves between";

fn between(what: &str, from: f64, to: f64) -> String {
    let [from, to] = [from, to].map(|size| given((1e6 * size).round() / 1e6));
    format!("{what} between {from} and {to} mm{TEST_BETWEEN}")
}

impl RegradeReason {
    /// What it says, as a part of a sentence.
    pub fn words(&self) -> String {
        let cause = match self.cause {
            RegradeCause::Gap(from) => {
                &*format!("gap-graded: next to nothing between {} mm and four times that", fixed(from, 3))
            }
            RegradeCause::GapAmongGravel(from) => &*format!(
                "gap-graded: next to nothing between {} mm and four times that; what is finer is regraded on \
                 No. 4 (4.75 mm)",
                fixed(from, 3)
            ),
            RegradeCause::GravelAndFines => "grains coarser than No. 4 (4.75 mm) and 15 % fines or more",
            RegradeCause::BroadGravel => "broadly graded, with grains coarser than No. 4 (4.75 mm)",
            RegradeCause::GravelOfUnknownCu => {
                "grains coarser than No. 4 (4.75 mm), and Cu is not known: taken as broadly graded"
            }
            RegradeCause::NarrowGravel => "less than 15 % fines and not broadly graded",
            RegradeCause::NoGravel => "nothing is coarser than No. 4 (4.75 mm)",
            RegradeCause::NoUnit => "sizes are multiples of D0F",
        };
        match self.nothing_passes {
            true => format!("{cause}; but no known size of it passes that sieve: left as it is"),
            false => cause.to_owned(),
        }
    }
}

impl RuleText {
    /// The words by which a rule hangs on sizes between two sieves that stand far apart.
    pub fn of_sieves_between(&self) -> Option<String> {
        Some(self.to_string()).filter(|words| words.ends_with(TEST_BETWEEN))
    }

    /// Whether it says this note, also as a file has it that was read back.
    pub fn says(&self, note: RuleNote) -> bool {
        match self {
            Self::Of(notes) => notes.contains(&note),
            Self::Said(words) => words.contains(&note.words()),
        }
    }
}

impl fmt::Display for RuleText {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Of(notes) => {
                f.write_str(&notes.iter().map(|note| note.words()).collect::<Vec<_>>().join("; "))
            }
            Self::Said(words) => f.write_str(words),
        }
    }
}

/// What was read back is the same as what was written.
impl PartialEq for RuleText {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl Serialize for RuleText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for RuleText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(Self::Said)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_note_reads_well_with_any_number() {
        for number in [0.0, 1e-300, -1.0, 12.345, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut all = BTreeSet::new();
            for note in RuleNote::all_with(number) {
                let words = note.words();
                assert!(!words.contains("NaN") && !words.contains("inf "), "{note:?}: {words}");
                assert!(!words.is_empty() && !words.contains("  ") && words.len() < 200, "{note:?}: {words}");
                // Others follow behind a semicolon.
                assert!(!words.ends_with(['.', ';', ':', ' ']), "{note:?}: {words}");
                assert_eq!(words.starts_with("needs "), format!("{note:?}").starts_with("Needs"), "{words}");
                assert!(all.insert(words), "{note:?} says what another says");
            }
        }
    }

    #[test]
    fn every_reason_to_regrade_reads_well_with_any_number() {
        for size in [0.0, 1e-300, -1.0, 12.345, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (cause, begin) in [
                (RegradeCause::Gap(size), "gap-graded: next to nothing between "),
                (RegradeCause::GapAmongGravel(size), "gap-graded: next to nothing between "),
                (RegradeCause::GravelAndFines, "grains coarser than No. 4 (4.75 mm) and 15 %"),
                (RegradeCause::BroadGravel, "broadly graded, with grains"),
                (RegradeCause::GravelOfUnknownCu, "grains coarser than No. 4 (4.75 mm), and Cu"),
                (RegradeCause::NarrowGravel, "less than 15 % fines"),
                (RegradeCause::NoGravel, "nothing is coarser than No. 4"),
                (RegradeCause::NoUnit, "sizes are multiples of D0F"),
            ] {
                for nothing_passes in [false, true] {
                    let words = RegradeReason { cause, nothing_passes }.words();
                    assert!(words.starts_with(begin) && words.len() < 200, "{words}");
                    assert_eq!(words.ends_with("sieve: left as it is"), nothing_passes, "{words}");
                    assert!(!words.contains("NaN") && !words.contains("inf ") && !words.ends_with('.'));
                }
            }
        }
    }

    /// Files of every version hold the words alone.
    #[test]
    fn notes_are_written_as_words_and_read_back() {
        let notes = RuleText::Of(vec![RuleNote::Category(2), RuleNote::RegradedOn(4.75)]);
        let text = serde_json::to_string(&notes).unwrap();
        assert_eq!(text, "\"base category 2; base regraded on 4.75 mm\"");
        let read: RuleText = serde_json::from_str(&text).unwrap();
        assert!(matches!(&read, RuleText::Said(_)) && read == notes && !read.is_empty());
        assert_eq!(serde_json::from_str::<RuleText>("\"\"").unwrap(), RuleText::default());
    }

    #[test]
    fn a_note_is_known_again_among_others() {
        let excessive = RuleNote::ExcessiveNotJudged;
        let notes = RuleText::Of(vec![RuleNote::RegradedOn(4.75), excessive]);
        let read: RuleText = serde_json::from_str(&serde_json::to_string(&notes).unwrap()).unwrap();
        for text in [&notes, &read] {
            assert!(text.says(excessive) && !text.says(RuleNote::NoClearBoundary), "{text:?}");
        }
    }
}
