//! What came of the readings of a base whose pan fraction (finer than its finest sieve) need not be passive;
//! as they are recorded.

use serde::{Deserialize, Serialize};

use super::record::{Classed, Stopping, Verdict};

/// The readings of a pan fraction that need not be passive: its sizes are not known, but they lie between two
/// bounds, and go on in a likely way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PanBounds {
    /// Share of the base's mass that is finer than its finest sieve.
    pub mass_fraction: f64,
    /// The finest sieve.
    pub finest_sieve_mm: f64,
    /// The finest constriction: what is finer is passive.
    pub finest_constriction_mm: f64,
    /// The readings; the rest of `outcome.json` is of the first, its verdict of all. Folders of earlier
    /// versions have the bounds alone.
    pub readings: Vec<PanReading>,
}

/// One reading of a pan fraction, walked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PanReading {
    /// Of what size its particles were walked.
    pub taken_as: PanSize,
    /// Base particles inserted in each run; all readings insert the same mass, where no cap bites.
    pub n_base: u64,
    /// What was walked.
    #[serde(flatten)]
    pub walked: Classed,
    /// Why there are so many replicates, where a rule added them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopping: Option<Stopping>,
}

/// Of what size the particles of a pan fraction are walked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum PanSize {
    /// As in soils whose finest part was measured.
    #[serde(rename = "continued")]
    Continued,
    /// Just finer than every constriction: they block nothing.
    #[serde(rename = "passive")]
    Passive,
    /// As coarse as they can be: of the finest sieve's size.
    #[serde(rename = "finest sieve")]
    FinestSieve,
}

impl PanBounds {
    /// The verdict that all readings give; where they differ that of the likely one, and undecided without.
    pub fn verdict(&self) -> Verdict {
        match self.likely() {
            Some(likely) => likely.walked.verdict,
            None if self.differ() => Verdict::Undecided,
            None => self.readings.first().map_or(Verdict::Undecided, |reading| reading.walked.verdict),
        }
    }

    /// The likely reading.
    pub fn likely(&self) -> Option<&PanReading> {
        self.readings.iter().find(|reading| reading.taken_as == PanSize::Continued)
    }

    /// The verdict of one reading.
    pub fn verdict_of(&self, size: PanSize) -> Option<Verdict> {
        Some(self.readings.iter().find(|reading| reading.taken_as == size)?.walked.verdict)
    }

    /// Whether the readings give different verdicts.
    pub fn differ(&self) -> bool {
        self.readings.windows(2).any(|two| two[0].walked.verdict != two[1].walked.verdict)
    }

    /// A reading in words, as `all 0.075 mm`.
    pub fn words(&self, reading: &PanReading) -> String {
        match reading.taken_as {
            PanSize::Continued => "continued as in soils with a hydrometer test".into(),
            PanSize::Passive => "finer than every constriction".into(),
            PanSize::FinestSieve => format!("all {} mm", self.finest_sieve_mm),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(verdicts: [Verdict; 2]) -> PanBounds {
        let reading = |taken_as, verdict| PanReading {
            taken_as,
            n_base: 100,
            walked: Classed { replicates: 2, stopped_when_clear: false, verdict, runs: Vec::new() },
            stopping: None,
        };
        PanBounds {
            mass_fraction: 0.35,
            finest_sieve_mm: 0.075,
            finest_constriction_mm: 0.0392,
            readings: vec![
                reading(PanSize::Passive, verdicts[0]),
                reading(PanSize::FinestSieve, verdicts[1]),
            ],
        }
    }

    #[test]
    fn what_both_readings_give_is_the_verdict_and_else_it_is_open() {
        let both = bounds([Verdict::Some; 2]);
        assert_eq!((both.verdict(), both.differ()), (Verdict::Some, false));
        let open = bounds([Verdict::Continuing, Verdict::None]);
        assert_eq!((open.verdict(), open.differ()), (Verdict::Undecided, true));
        // One that is open itself agrees with nothing but another that is.
        let half = bounds([Verdict::Undecided, Verdict::None]);
        assert_eq!(half.verdict(), Verdict::Undecided);
        let mut likely = open.clone();
        let walked = Classed { verdict: Verdict::Some, ..likely.readings[0].walked.clone() };
        let reading = PanReading { taken_as: PanSize::Continued, walked, ..likely.readings[0].clone() };
        likely.readings.insert(0, reading);
        assert_eq!((likely.verdict(), likely.differ()), (Verdict::Some, true));
    }
}
