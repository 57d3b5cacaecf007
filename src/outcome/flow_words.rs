//! What came of the water that flowed through a walked network, in sentences.

use super::record::{Outcome, Run};

/// Above this part of its volume a void holds more than any packing of particles would.
const ROOM: f64 = 0.6;

impl Outcome {
    /// How far the permeability fell, run by run: means over the replicates; `None` where no water flowed.
    pub fn flow_sentence(&self) -> Option<String> {
        let falls: Vec<String> = (0..self.summary.len())
            .map(|run| Some(format!("{:.1} %", 100.0 * self.mean_of(run, |run| run.k_over_k0)?)))
            .collect::<Option<_>>()?;
        let clean = self.network.as_ref().and_then(|network| network.k0_m_per_s);
        let clean = clean.map_or(String::new(), |k| format!(" ({k:.1e} m/s for water of 10 °C)"));
        let of = if falls.len() > 1 { "first and second run" } else { "run" };
        let falls = falls.join(" and ");
        (!falls.is_empty())
            .then(|| format!("permeability at the end of the {of}: {falls} of the clean filter's{clean}"))
    }

    /// That a void holds more than it has room for; `None` where none does, or volumes are not known.
    pub fn overfull_sentence(&self) -> Option<String> {
        let runs = || self.replicates.iter().flat_map(|replicate| &replicate.runs);
        let share = 100.0 * runs().filter_map(|run| run.overfull_fraction).reduce(f64::max)?;
        let fullest = runs().filter_map(|run| run.fullness_max).reduce(f64::max);
        let what = match fullest.filter(|&fullest| fullest > ROOM) {
            Some(fullest) => format!(
                "the fullest void holds {fullest:.1} times the volume that it has between the grains, and up \
                 to {share:.2} % of the voids more than {ROOM} times"
            ),
            None if share > 0.0 => {
                format!(
                    "particles rest in up to {share:.2} % of the voids that have no volume between the grains"
                )
            }
            None => return None,
        };
        Some(what + ": more than there is room for, which the model does not know")
    }

    /// Mean of a figure of one run over the replicates that have it.
    fn mean_of(&self, run: usize, of: impl Fn(&Run) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.replicates.iter().filter_map(|r| of(r.runs.get(run)?)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}
