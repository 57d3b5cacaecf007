//! Particles that a run retained and constrictions that it blocked, by the connectivity of the void (paper,
//! Table 3).

use std::collections::BTreeMap;

use super::record::{ByConnectivity, Replicate};
use voidwalk_core::network::Network;
use voidwalk_core::walk::State;

/// Voids, exits, blocked exits, particles in exits, particles in voids.
type Sums = [u64; 5];

/// Sums by ascending connectivity; empty if all voids have the same. Trapped particles never settle in one
/// void and are not counted.
pub fn of_run(network: &Network, state: &State) -> Vec<ByConnectivity> {
    let mut sums: BTreeMap<u64, Sums> = BTreeMap::new();
    // Entrances and exits are the same there, and all voids of the cubic lattice are alike.
    if network.reservoir().is_some() || network.shape().is_some() {
        return Vec::new();
    }
    for (void, &k) in network.connectivity().iter().enumerate() {
        let exits = network.exits(void as u32);
        let of_void = [
            1,
            exits.len() as u64,
            exits.filter(|&c| state.blocked[c]).count() as u64,
            state.retained_in_constrictions[void],
            state.retained_in_voids[void],
        ];
        add(sums.entry(u64::from(k)).or_default(), of_void);
    }
    rows(&sums)
}

/// All replicates of run `run` (counted from 1) together.
pub fn of_replicates(replicates: &[Replicate], run: u64) -> Vec<ByConnectivity> {
    let mut sums: BTreeMap<u64, Sums> = BTreeMap::new();
    for row in
        replicates.iter().flat_map(|r| &r.runs).filter(|r| r.run == run).flat_map(|r| &r.by_connectivity)
    {
        let of_row =
            [row.voids, row.constrictions, row.blocked, row.retained_in_constrictions, row.retained_in_voids];
        add(sums.entry(row.connectivity).or_default(), of_row);
    }
    rows(&sums)
}

fn add(sums: &mut Sums, more: Sums) {
    sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}

fn rows(sums: &BTreeMap<u64, Sums>) -> Vec<ByConnectivity> {
    if sums.len() < 2 {
        return Vec::new();
    }
    let retained = |s: &Sums| s[3] + s[4];
    let all_voids: u64 = sums.values().map(|s| s[0]).sum();
    let all_retained: u64 = sums.values().map(retained).sum();
    let row = |(&connectivity, s): (&u64, &Sums)| ByConnectivity {
        connectivity,
        voids: s[0],
        voids_fraction: s[0] as f64 / all_voids as f64,
        constrictions: s[1],
        blocked: s[2],
        retained_in_constrictions: s[3],
        retained_in_voids: s[4],
        retained_per_void: retained(s) as f64 / s[0] as f64,
        retained_fraction: retained(s) as f64 / all_retained.max(1) as f64,
    };
    sums.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_by_hand() {
        let sums = BTreeMap::from([(5, [1, 2, 1, 30, 0]), (6, [3, 9, 0, 4, 6])]);
        let rows = rows(&sums);
        assert_eq!((rows[0].voids_fraction, rows[1].voids_fraction), (0.25, 0.75));
        assert_eq!((rows[0].retained_per_void, rows[0].retained_fraction), (30.0, 0.75));
        assert!((rows[1].retained_per_void - 10.0 / 3.0).abs() < 1e-12);
        assert!(super::rows(&BTreeMap::from([(6, [1, 3, 0, 0, 0])])).is_empty());
    }
}
