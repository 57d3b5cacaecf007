//! What may be wrong with a verdict, and which way it points.

use super::record::Verdict;

/// A sentence on where a case leaves the range in which the model was checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// What is in doubt.
    pub said: String,
    /// Which way the walk errs for it.
    pub way: Way,
}

/// Which way a walk errs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// The real filter erodes at least as much: a verdict of continuing erosion is the surer for it.
    Unsafe,
    /// The real filter erodes at most as much: a verdict of no erosion is the surer for it.
    Safe,
    /// Nobody knows.
    Open,
    /// Both ends of what is not known were looked at, and they agree.
    Settled,
}

impl Doubt {
    /// Sentences that all point one way.
    pub fn all(way: Way, said: impl IntoIterator<Item = String>) -> impl Iterator<Item = Self> {
        said.into_iter().map(move |said| Self { said, way })
    }

    /// Whether it could turn this verdict; what makes a verdict surer is no doubt of it.
    pub fn is_against(&self, verdict: Verdict) -> bool {
        match self.way {
            Way::Settled => false,
            Way::Unsafe => verdict != Verdict::Continuing,
            Way::Safe => verdict != Verdict::None,
            Way::Open => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_a_verdict_surer_is_no_doubt_of_it() {
        let against = |way, verdict| Doubt { said: String::new(), way }.is_against(verdict);
        assert!(against(Way::Unsafe, Verdict::None) && !against(Way::Unsafe, Verdict::Continuing));
        assert!(against(Way::Safe, Verdict::Continuing) && !against(Way::Safe, Verdict::None));
        for verdict in Verdict::ALL {
            assert!(against(Way::Open, verdict) && !against(Way::Settled, verdict));
        }
        for middle in [Verdict::Some, Verdict::Undecided] {
            assert!(against(Way::Unsafe, middle) && against(Way::Safe, middle));
        }
    }
}
