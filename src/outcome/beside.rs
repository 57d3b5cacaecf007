//! What stands beside every verdict, wherever it is shown: in words, the same on each face.

use super::digits::{count, percent};
use super::record::{Outcome, PanBounds};

impl Outcome {
    /// What a reader must see beside the verdict and its reasons, in sentences: what else is to be known of
    /// the pair, both readings of the base's
    /// finest part, what the replicates leave open, what was trapped or capped, the thickness and how the
    /// verdict moves with it, and what water and voids came to.
    pub fn beside_the_verdict(&self) -> Vec<String> {
        let stopped = self.stopping.as_ref().and_then(|stopping| stopping.sentence.clone());
        let first = [self.pan_bounds.as_ref().map(readings), stopped];
        let second = [
            self.what_would_decide().map(String::from),
            self.trapped_sentence(),
            self.capped_sentence(),
            self.thickness_sentence(),
            self.with_thickness(),
            self.flow_sentence(),
            self.overfull_sentence(),
        ];
        self.notes.iter().cloned().chain(first.into_iter().chain(second).flatten()).collect()
    }

    /// How many particles circle for ever.
    pub fn trapped_sentence(&self) -> Option<String> {
        let trapped: u64 = self.replicates.iter().flat_map(|r| &r.runs).map(|r| r.trapped).sum();
        (trapped > 0)
            .then(|| format!("{} particles trapped in closed loops; they count as retained", count(trapped)))
    }

    fn capped_sentence(&self) -> Option<String> {
        let eq2 = self.n_base_eq2.filter(|_| self.capped)?;
        Some(format!("capped; Eq. (2) requires {} base particles", count(eq2)))
    }

    fn thickness_sentence(&self) -> Option<String> {
        let unit = if self.inputs.scale_free { "D0F" } else { "mm" };
        let thickness = self.inputs.network.thickness_mm?;
        Some(format!("modelled filter thickness: {thickness:.1} {unit} along the flow"))
    }
}

/// What either reading of the base's finest part came to.
fn readings(bounds: &PanBounds) -> String {
    let each = bounds.readings.each_ref().map(|reading| {
        let runs: Vec<String> = reading.runs.iter().map(|run| percent(run.mean)).collect();
        let (words, verdict) = (bounds.words(reading), reading.verdict.words());
        format!("{words}: {verdict}, {} eroded", runs.join(" and "))
    });
    format!(
        "those are of the base with its finest part finer than every constriction; both readings: {}",
        each.join("; ")
    )
}
