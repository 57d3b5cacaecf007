//! Sums over a run: integers, and masses added in a fixed order.

use super::error::WalkError;

/// Sums over a run up to and including an increment. Masses are sums of diameter cubed, in units of the
/// reference length cubed.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tally {
    /// Base particles inserted.
    pub inserted: u64,
    /// Base particles still moving.
    pub moving: u64,
    /// Base particles that left through the end.
    pub eroded: u64,
    /// Base particles stopped by a constriction.
    pub retained_in_constrictions: u64,
    /// Those of them that are in arches.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub retained_in_arches: u64,
    /// Arches.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub arches: u64,
    /// Mass in arches.
    #[serde(default, skip_serializing_if = "no_mass")]
    pub arched_mass: f64,
    /// Base particles in voids without open exits.
    pub retained_in_voids: u64,
    /// Base particles trapped in closed loops.
    pub trapped: u64,
    /// Blocked constrictions, those of earlier runs included.
    pub blocked: u64,
    /// Completed moves, the one that leaves included; stays at 2^64 - 1 once it is there.
    pub particle_moves: u64,
    /// Mass inserted.
    pub inserted_mass: f64,
    /// Mass eroded.
    pub eroded_mass: f64,
    /// Passive base particles inserted.
    pub passive_inserted: u64,
    /// Passive base particles eroded.
    pub passive_eroded: u64,
    /// Diameter of the largest eroded particle; 0 if no particle has eroded.
    pub largest_eroded: f32,
}

fn is_zero(number: &u64) -> bool {
    *number == 0
}

fn no_mass(mass: &f64) -> bool {
    *mass == 0.0
}

impl Tally {
    /// Counts every moving particle as trapped.
    pub(super) fn trap_all_moving(&mut self) {
        self.trapped += std::mem::take(&mut self.moving);
    }

    /// Checks that every particle inserted is somewhere.
    pub(super) fn check(&self, increment: u64) -> Result<(), WalkError> {
        let all =
            [self.moving, self.eroded, self.retained_in_constrictions, self.retained_in_voids, self.trapped];
        // Sums that something has spoilt may be beyond 64 bits.
        let accounted = all.into_iter().fold(0u64, u64::saturating_add);
        match all.into_iter().map(u128::from).sum::<u128>() == u128::from(self.inserted) {
            true => Ok(()),
            false => Err(WalkError::NotConserved { increment, inserted: self.inserted, accounted }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_particle_is_noticed() {
        let tally = Tally { inserted: 5, moving: 1, eroded: 1, trapped: 2, ..Tally::default() };
        let error = tally.check(3).unwrap_err().to_string();
        assert_eq!(error, "increment 3: 5 base particles inserted, but 4 accounted for");
        assert!(Tally { retained_in_voids: 1, ..tally }.check(3).is_ok());
        // 2^64 and 5 particles are not 5.
        assert!(Tally { retained_in_voids: u64::MAX, trapped: 4, ..tally }.check(3).is_err());
    }
}
