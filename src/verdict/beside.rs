//! What the results of a run say beside its verdict, and the findings of an outcome as they are shown.

use super::entry::Finding;
use super::study_points::beside_ends;
use super::{amount, finding, thickness};
use crate::outcome::digits::{percent, percent_span};
use crate::outcome::packing::{FLOATING_PERCENT, PackedPart};
use crate::outcome::record::{
    CurveEnd, CurveRange, FindingRecord, Outcome, PanBounds, PanSize, Run, ShortOf, Stopping, Verdict,
};
use crate::outcome::undecided::UndecidedBy;

/// Id of a finest part of the filter that the mass eroded does not know of.
pub const NOT_COUNTED: &str = "pan_of_filter";

/// Above this part of its volume a void holds more than any packing of particles would.
const ROOM: f64 = 0.6;

impl Outcome {
    /// What its results say: the readings of the base's finest part, the range of the constriction curve,
    /// what the replicates leave open, what was trapped, the thickness, and what water and voids came to.
    pub fn found(&self) -> Vec<Finding> {
        let trapped: u64 = self.replicates.iter().flat_map(|r| &r.runs).map(|r| r.trapped).sum();
        [
            self.pan_bounds.as_ref().map(readings),
            self.stopping.as_ref().and_then(short_of),
            self.replicates_leave_open(),
            (trapped > 0).then(|| finding::trapped(trapped)),
            thickness::modelled(self),
            thickness::finding(self),
            amount::finding(self),
            self.permeability(),
            self.overfull(),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// What speaks against the verdict, in order; of folders of earlier versions the sentences alone.
    pub fn against(&self) -> Vec<FindingRecord> {
        if self.findings.is_empty() {
            return self.reasons.iter().map(|said| FindingRecord::of_earlier(said)).collect();
        }
        self.findings.iter().filter(|finding| finding.against).cloned().collect()
    }

    /// What else is to be known, in order; of folders of earlier versions what they say and what their
    /// results do.
    pub fn besides(&self) -> Vec<FindingRecord> {
        if !self.findings.is_empty() {
            return self.findings.iter().filter(|finding| !finding.against).cloned().collect();
        }
        let mut said: Vec<&String> = Vec::new();
        let of_stopping = self.stopping.as_ref().and_then(|stopping| stopping.sentence.as_ref());
        for sentence in self.notes.iter().chain(&self.warnings).chain(of_stopping) {
            if !self.reasons.contains(sentence) && !said.contains(&sentence) {
                said.push(sentence);
            }
        }
        let is_said =
            self.reasons.iter().chain(said.iter().copied()).any(|said| said.starts_with("capped at"));
        let capped = self.n_base_eq2.filter(|_| self.capped && !is_said);
        let capped = capped.map(|eq2| finding::capped_base(self.n_base, eq2));
        let of_earlier = said.into_iter().map(|said| FindingRecord::of_earlier(said));
        of_earlier.chain(capped.iter().chain(&self.found()).map(|finding| finding.record(false))).collect()
    }

    /// The sentence of a finding; `None` without it.
    pub fn sentence_of(&self, id: &str) -> Option<String> {
        let mut all = self.against().into_iter().chain(self.besides());
        all.find(|finding| finding.id == id).map(|finding| finding.sentence)
    }

    /// What the mass eroded does not know of the filter, and that the base erodes all the same where it does;
    /// `None` where all of the filter is counted.
    pub fn not_counted(&self) -> Option<String> {
        let said = self.sentence_of(NOT_COUNTED)?;
        let erodes = matches!(self.verdict, Verdict::Some | Verdict::Continuing);
        Some(if erodes { said + " The base erodes all the same." } else { said })
    }

    /// What soils of the base's kind say of the walk, whichever way it points.
    pub fn evidence_in_words(&self) -> Option<String> {
        self.findings.iter().find(|finding| is_evidence(finding)).map(|finding| finding.sentence.clone())
    }

    /// The sentences of what else is to be known, each with the setting that changes it.
    pub fn beside_the_verdict(&self) -> Vec<String> {
        self.besides().iter().map(FindingRecord::with_to_do).collect()
    }

    /// What leaves a class open that the replicates do not separate, where nothing else says it.
    fn replicates_leave_open(&self) -> Option<Finding> {
        // A target error that was met says nothing of the class.
        let said = |stopping: &Stopping| {
            stopping.short_of.is_some() || stopping.sentence.is_some() || stopping.decide_percent.is_some()
        };
        if self.stopping.as_ref().is_some_and(said) {
            return None;
        }
        match self.undecided_by()? {
            UndecidedBy::Pan | UndecidedBy::Curve => None,
            UndecidedBy::SecondRun => Some(finding::second_run_missing()),
            UndecidedBy::Replicates => Some(finding::replicates_leave_open()),
        }
    }

    /// How far the permeability fell, run by run: means over the replicates; `None` where no water flowed.
    fn permeability(&self) -> Option<Finding> {
        let falls: Vec<String> = (0..self.summary.len())
            .map(|run| Some(format!("{:.1} %", 100.0 * self.mean_of(run, |run| run.k_over_k0)?)))
            .collect::<Option<_>>()?;
        let clean = self.network.as_ref().and_then(|network| network.k0_m_per_s);
        let clean = clean.map_or(String::new(), |k| format!(" ({k:.1e} m/s for water of 10 °C)"));
        let of = if falls.len() > 1 { "first and second run" } else { "run" };
        (!falls.is_empty()).then(|| finding::permeability(of, &falls.join(" and "), &clean))
    }

    /// That a void holds more than it has room for; `None` where none does, or volumes are not known.
    fn overfull(&self) -> Option<Finding> {
        let runs = || self.replicates.iter().flat_map(|replicate| &replicate.runs);
        let share = 100.0 * runs().filter_map(|run| run.overfull_fraction).reduce(f64::max)?;
        let fullest = runs().filter_map(|run| run.fullness_max).reduce(f64::max);
        match fullest.filter(|&fullest| fullest > ROOM) {
            Some(fullest) => Some(finding::overfull(fullest, share)),
            None => (share > 0.0).then(|| finding::no_room(share)),
        }
    }

    /// Mean of a figure of one run over the replicates that have it.
    fn mean_of(&self, run: usize, of: impl Fn(&Run) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.replicates.iter().filter_map(|r| of(r.runs.get(run)?)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// Whether a finding is the line of evidence, which stands above all others.
pub fn is_evidence(finding: &FindingRecord) -> bool {
    finding.id.starts_with("evidence")
}

/// What the readings of the base's finest part say of its verdict.
pub fn pan(bounds: &PanBounds) -> Finding {
    let (share, sieve) = (100.0 * bounds.mass_fraction, bounds.finest_sieve_mm);
    let finest = bounds.finest_constriction_mm;
    let [fine, coarse] = [PanSize::Passive, PanSize::FinestSieve].map(|size| match bounds.verdict_of(size) {
        Some(Verdict::Undecided) | None => "stays open".to_owned(),
        Some(verdict) => format!("is {}", verdict.words()),
    });
    match (bounds.differ(), bounds.likely()) {
        (true, Some(likely)) => {
            finding::pan_taken_as_likely(share, sieve, finest, likely.walked.verdict.words(), &fine, &coarse)
        }
        (true, None) => finding::pan_decides(share, sieve, finest, &fine, &coarse),
        (false, _) => finding::pan_agrees(share, sieve, finest, bounds.verdict().words()),
    }
}

/// What the range of a constriction curve says of its verdict.
pub fn curve_range(range: &CurveRange) -> Finding {
    let end = |end: &CurveEnd| {
        let runs: Vec<String> = end.walked.runs.iter().map(|s| percent(s.mean)).collect();
        format!("{}: {}, {} eroded", end.curve, end.walked.verdict.words(), runs.join(" then "))
    };
    let ends: Vec<String> = range.ends.iter().map(end).collect();
    let each = format!("{}; by the curve itself: {}", ends.join("; "), range.verdict.words());
    let ends = range.eroded_mass_fraction.first().copied().unwrap_or([f64::NAN; 2]);
    let span = percent_span(ends.map(|of| of.max(0.0))) + beside_ends(range);
    let [low, high] = ends.map(|of| 100.0 * of);
    match range.agrees() {
        true => finding::curve_range_agrees(low, high, &span, &each),
        false if range.worst_counts && range.whole() != Verdict::Undecided => {
            finding::worst_of_range(range.whole().words(), low, high, &span, &each)
        }
        // What the curve itself leaves open, its range does not decide.
        false if range.verdict == Verdict::Undecided => finding::curve_range_open(low, high, &span, &each),
        false => finding::curve_range_decides(low, high, &span, &each),
    }
}

/// What a reader must know of a filter of which this part was packed.
pub fn packed_part(part: &PackedPart) -> Finding {
    let PackedPart { percent, largest_mm, finer_by, sizes_missing_above, .. } = *part;
    let of_part = match (sizes_missing_above, percent >= FLOATING_PERCENT) {
        (_, false) => finding::loose_part_packed,
        (true, true) => finding::floating_part_packed,
        (false, true) => finding::part_packed,
    };
    of_part(percent, largest_mm, 100.0 * finer_by)
}

/// What each reading of the base's finest part came to.
fn readings(bounds: &PanBounds) -> Finding {
    let each: Vec<String> = bounds
        .readings
        .iter()
        .map(|reading| {
            let runs: Vec<String> = reading.walked.runs.iter().map(|run| percent(run.mean)).collect();
            let (words, verdict) = (bounds.words(reading), reading.walked.verdict.words());
            format!("{words}: {verdict}, {} eroded", runs.join(" and "))
        })
        .collect();
    finding::pan_readings(
        &bounds.readings.first().map_or(String::new(), |of| bounds.words(of)),
        &each.join("; "),
    )
}

/// Why replicates do not reach what was asked for.
fn short_of(stopping: &Stopping) -> Option<Finding> {
    Some(match stopping.short_of? {
        ShortOf::SecondRun => finding::second_run_missing(),
        ShortOf::Decision { run, mean_percent, distance_pp, sd_pp, needed } => {
            let which = if run == 1 { "first" } else { "second" };
            let more = match needed {
                Some(n) => format!("About {n} replicates would decide, if the mean stayed where it is"),
                None => "No number of replicates will decide".into(),
            };
            let level = stopping.decide_percent.unwrap_or(0.0);
            finding::level_missed(level, which, &format!("{mean_percent:.3} %"), distance_pp, sd_pp, &more)
        }
        ShortOf::Target { half_width_pp, replicates, needed } => {
            let target = stopping.target_error_pp.unwrap_or(0.0);
            finding::target_missed(target, half_width_pp, replicates, needed)
        }
    })
}
