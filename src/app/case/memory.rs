//! Particles of a case that are walked one by one, memory that it requires, and location of their columns.

use super::{Case, CaseError, CaseNetwork};
use crate::words::memory::{WalkMemory, bytes};
use std::path::Path;
use voidwalk_core::network::ExitRule;
use voidwalk_core::store::{Placement, platform};
use voidwalk_core::walk::{CHUNK, Engine};

/// Maximum total memory of replicates that walk side by side, so that memory does not grow with the
/// number of threads.
const SIDE_BY_SIDE_BYTES: u64 = 1 << 30;
/// Bytes for the events of a chunk's particles in an increment, and for their size classes (measured).
const EVENT_BYTES: u64 = 16 << 10;
/// Bytes that a worker keeps to move counts: for a void, its particles there; and for a batch of voids.
const COUNTS_A_WORKER: (u64, u64) = (8, 32 << 10);
/// Bytes for a constriction if water flows: two exits of 28 in the network and in its copy, 12 of the
/// flow and 34 of tables each; 24 of the flow; and links, a factor, and leftovers from reading a file
/// (measured: at most 523 in total, for a file with a million throats).
const FLOW_BYTES: u64 = 2 * (2 * 28 + 12 + 34) + 24 + 300;
/// Bytes for an exit if blocked constrictions leave openings: its width now, at the last solution of the
/// flow and before the next run, and its conducting fraction.
const OPENING_BYTES: u64 = 3 * 4 + 8;
/// Bytes for a narrowing, and for its columns while they are saved.
const NARROWING_BYTES: u64 = 2 * 24;
/// Average number of narrowings of an exit in a run for which there is room: a new finest particle
/// becomes rarer each time.
const NARROWINGS: u64 = 8;
/// Bytes that `record.voids` keeps while it is written. For a void with particles after an increment: its
/// row in two copies, in growing room, and its line (measured: up to 184). For a void: its position, row
/// and line. For a constriction: its row, its line, and the time at which it was blocked.
const KEPT_BYTES: [u64; 3] = [200, 240, 420];
/// Bytes of a network: for a void, and for a constriction (its target and diameter).
const NETWORK_BYTES: [u64; 2] = [8, 8];
/// Bytes of the exits with which its first runs begin: words and exits; shares, and the void that a
/// constriction leaves.
const EXIT_BYTES: [u64; 2] = [16, 16];

/// Limits on memory and disk for the walks of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ResourceLimits {
    /// Memory (bytes).
    pub(crate) memory: u64,
    /// Free disk for the results (bytes).
    pub(crate) disk: u64,
}

impl ResourceLimits {
    /// Takes the memory requested, or else 80 % of the available memory, and never more than that; and
    /// the free disk at `folder`.
    pub(crate) fn new(asked: Option<u64>, available: u64, folder: &Path) -> Self {
        let share = available / 5 * 4;
        let there = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        Self {
            memory: asked.map_or(share, |asked| asked.min(available)),
            disk: there.ancestors().find_map(platform::free_bytes).unwrap_or(0),
        }
    }
}

impl Case {
    /// Number of base particles in a run of `n_base` that are walked one by one: all, or those that may
    /// be coarser than the finest constriction.
    pub(crate) fn one_by_one(&self, n_base: u64) -> u64 {
        if self.takes_each(n_base) {
            return n_base;
        }
        let passive = self.first_word(n_base) as f64 / 18_446_744_073_709_551_616.0;
        (n_base as f64 * (1.0 - passive)).ceil() as u64
    }

    /// True if all of `n_base` particles are walked one by one, whatever their sizes, on a network with
    /// its finest constriction.
    pub(crate) fn takes_each(&self, n_base: u64) -> bool {
        let passive = Engine::passive_share(n_base / self.increments(), self.passive_words());
        self.scene.walk.engine.takes_each(passive, self.network.start_nodes)
    }

    /// First random word that draws one of these particles.
    pub(crate) fn first_word(&self, n_base: u64) -> u128 {
        if self.takes_each(n_base) { 0 } else { self.passive_words() }
    }

    /// Number of the 2^64 words that draw a particle that is passive on the open network.
    fn passive_words(&self) -> u128 {
        if self.scene.leaves_openings() {
            return 0;
        }
        let (filter, fixed) = (&self.filter, self.network.fixed.as_ref());
        let finest = fixed.map_or((filter.finest_mm / filter.unit_mm) as f32, |fixed| fixed.finest);
        self.supply.sampler.word_limit(self.scene.law().map_or(finest, |law| law.passive_limit(finest)))
    }

    /// Bytes for the columns of a walk of `n_base` particles.
    fn column_bytes(&self, n_base: u64) -> u64 {
        // Columns of voids and diameters; a single size needs no column of diameters.
        let bytes = if self.supply.sampler.smallest() == self.supply.sampler.largest() { 4 } else { 8 };
        self.one_by_one(n_base).div_ceil(CHUNK as u64).saturating_mul(bytes * CHUNK as u64)
    }

    /// Further bytes to walk `n_base` particles on this many threads: network, tallies, bookkeeping.
    fn other_bytes(&self, n_base: u64, threads: u64) -> u64 {
        let CaseNetwork { voids, constrictions, .. } = self.network;
        let one_by_one = self.one_by_one(n_base);
        // A constriction without a direction is two exits with conductance, weight and flow, in the
        // network, in the copy that the walk directs, and in the system of equations.
        let (flow, exits) = match self.scene.exit_rule() {
            ExitRule::Area => (0, constrictions),
            _ => (constrictions.saturating_mul(FLOW_BYTES), constrictions.saturating_mul(2)),
        };
        let openings = match self.scene.leaves_openings() {
            true => {
                // A particle narrows at most one.
                let narrowings = exits.saturating_mul(NARROWINGS).min(n_base);
                exits.saturating_mul(OPENING_BYTES).saturating_add(narrowings.saturating_mul(NARROWING_BYTES))
            }
            false => 0,
        };
        // With counts each thread keeps a column of the whole network for the particles that it moves; a
        // single thread moves the expectation, and particles move in place.
        let is_counted = matches!(self.scene.walk.engine, Engine::Auto | Engine::Counts)
            && !self.takes_each(n_base)
            && one_by_one < n_base;
        let (of_void, of_batch) = COUNTS_A_WORKER;
        let of_worker = if is_counted { voids.saturating_mul(of_void).saturating_add(of_batch) } else { 0 };
        one_by_one
            .div_ceil(CHUNK as u64)
            .saturating_mul(EVENT_BYTES)
            .saturating_add(voids * 140 + constrictions * 25)
            .saturating_add(flow)
            .saturating_add(openings)
            .saturating_add(threads.max(1).saturating_mul(of_worker))
    }

    /// Bytes for the records of each void of the first replicate, if `record.voids` keeps them: at most
    /// one row for each void, or for each particle so far, after each increment of the list and at the
    /// end of each run.
    pub(crate) fn kept_bytes(&self) -> u64 {
        let Some(increments) = &self.scene.record.voids else { return 0 };
        let CaseNetwork { voids, constrictions, .. } = self.network;
        let [of_row, of_void, of_constriction] = KEPT_BYTES;
        let an_increment = self.supply.n_base.div_ceil(self.increments());
        // Void 0 always has a row.
        let rows_after = |increment: u64| voids.min(an_increment.saturating_mul(increment).saturating_add(1));
        let rows: u64 = increments.iter().copied().chain([self.increments()]).map(rows_after).sum();
        rows.saturating_mul(self.scene.walk.runs)
            .saturating_mul(of_row)
            .saturating_add(voids.saturating_mul(of_void))
            .saturating_add(constrictions.saturating_mul(of_constriction))
    }

    /// Approximate bytes of one of its networks, and of the exits with which first runs on it may begin,
    /// in this case or another one with the same network.
    pub(crate) fn shared_network_bytes(&self) -> [u64; 2] {
        let CaseNetwork { voids, constrictions, .. } = self.network;
        let bytes = |[of_void, of_constriction]: [u64; 2]| {
            voids.saturating_mul(of_void).saturating_add(constrictions.saturating_mul(of_constriction))
        };
        let exits = if self.scene.is_lattice_by_area() { EXIT_BYTES } else { [0; 2] };
        [bytes(NETWORK_BYTES), bytes(exits)]
    }

    /// Bytes to walk `n_base` particles on this many threads, including network and tallies.
    pub(crate) fn bytes(&self, n_base: u64, threads: u64) -> u64 {
        self.column_bytes(n_base).saturating_add(self.other_bytes(n_base, threads))
    }

    /// Maximum number of base particles in any run of the case.
    fn most_particles(&self) -> u64 {
        let largest = self.sensitivity_factors().into_iter().fold(1.0, f64::max);
        (self.supply.n_base as f64 * largest) as u64
    }

    /// Case with the thickest lattice of the study of its thickness, if it is thicker than its own. A
    /// graph's packing is not measured again for this.
    fn thickest(&self) -> Option<Case> {
        let factor = self.thickness_factors().into_iter().fold(1.0, f64::max);
        let is_lattice = self.network.copies().is_none();
        (factor > 1.0 && is_lattice).then(|| self.of_thickness(factor).ok()).flatten()
    }

    /// Maximum bytes of the whole case at any time on this many threads, with all columns in memory.
    pub(crate) fn peak_bytes(&self, threads: u64) -> u64 {
        let peak = |case: &Case| {
            let n_base = case.most_particles();
            let walks = case.bytes(n_base, threads).saturating_mul(case.side_by_side(n_base, threads));
            walks.saturating_add(case.kept_bytes())
        };
        // The thickest filter is walked after the others.
        peak(self).max(self.thickest().as_ref().map_or(0, peak))
    }

    /// Number of replicates of `n_base` particles that walk at the same time on this many threads: one,
    /// unless they are small.
    pub(crate) fn side_by_side(&self, n_base: u64, threads: u64) -> u64 {
        let all = self.bytes(n_base, threads).saturating_mul(threads);
        if all <= SIDE_BY_SIDE_BYTES.min(self.memory) { threads.max(1) } else { 1 }
    }

    /// Sets the location of the particles' columns: in memory if they fit, or else in files in `folder` that
    /// are mapped into memory. Errors: [`CaseError::Memory`]: they fit in neither.
    pub(crate) fn place(
        &mut self,
        room: &ResourceLimits,
        threads: u64,
        folder: &Path,
    ) -> Result<(), CaseError> {
        self.memory = room.memory;
        let kept = self.kept_bytes();
        let without_columns = |n_base| self.other_bytes(n_base, threads).saturating_add(kept);
        let (besides, columns) = (without_columns(self.supply.n_base), self.column_bytes(self.supply.n_base));
        let has_room = besides <= room.memory && (columns <= room.memory - besides || columns <= room.disk);
        // If the scene itself does not fit, the studies are not to blame.
        let thickest = if has_room { self.place_thickest(room, threads, folder)? } else { None };
        let n_base = if has_room { self.most_particles() } else { self.supply.n_base };
        let walks = self.bytes(n_base, threads).saturating_mul(self.side_by_side(n_base, threads));
        let (needed, without_columns) = (walks.saturating_add(kept), without_columns(n_base));
        if needed <= room.memory {
            // If the thickest filter of the study needs files, the whole case uses them.
            self.placement = thickest.unwrap_or(Placement::Memory);
            Ok(())
        } else if without_columns <= room.memory && self.column_bytes(n_base) <= room.disk {
            self.placement = Placement::Mapped(folder.to_owned());
            Ok(())
        } else {
            Err(self.no_room(room, n_base, needed, without_columns))
        }
    }

    /// Location of the columns of the thickest filter of the study, if there is one.
    fn place_thickest(
        &self,
        room: &ResourceLimits,
        threads: u64,
        folder: &Path,
    ) -> Result<Option<Placement>, CaseError> {
        let Some(mut case) = self.thickest() else { return Ok(None) };
        match case.place(room, threads, folder) {
            Err(CaseError::Memory { n_base, voids, needed, available, disk, .. })
                if case.supply.n_base != self.supply.n_base || case.network.voids != self.network.voids =>
            {
                let study = " (record.thickness: the thickest filter of the study; leave that out)".into();
                Err(CaseError::Memory { n_base, study, voids, needed, available, disk })
            }
            placed => placed.map(|()| Some(case.placement)),
        }
    }

    /// Error for `n_base` particles that need more memory than is available, with the study that needs them.
    fn no_room(&self, room: &ResourceLimits, n_base: u64, needed: u64, without_columns: u64) -> CaseError {
        let disk = match without_columns <= room.memory {
            true => format!(" and the disk has {} for the particles", bytes(room.disk)),
            false => String::new(),
        };
        let of_voids = match self.kept_bytes() {
            0 => String::new(),
            kept => format!(" (record.voids keeps up to {}: name fewer increments)", bytes(kept)),
        };
        let stated = self.supply.n_base;
        let study = match n_base == stated {
            true => String::new(),
            false => {
                let factor = n_base as f64 / stated as f64;
                format!(" (record.sensitivity: {factor} times the {stated} of the scene; leave that out)")
            }
        };
        CaseError::Memory {
            n_base: self.one_by_one(n_base),
            study,
            voids: self.network.voids,
            needed: bytes(needed),
            available: bytes(room.memory),
            disk: [disk, of_voids].concat(),
        }
    }

    /// Memory of its walks on this many threads.
    pub(crate) fn walk_memory(&self, threads: u64) -> WalkMemory {
        let n_base = self.supply.n_base;
        let (walk, on_disk) = match &self.placement {
            Placement::Memory => (self.bytes(n_base, threads), None),
            Placement::Mapped(_) => {
                (self.other_bytes(n_base, threads), Some(self.column_bytes(self.most_particles())))
            }
        };
        WalkMemory { walk, kept: self.kept_bytes(), most: self.memory, on_disk }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    fn case(set: &[&str]) -> Case {
        let small = ["network.nx=80", "network.ny=80", "network.nz=100", "record.sensitivity=[]"];
        Case::built_in(&[&small, set].concat()).unwrap()
    }

    /// The ends of a guessed curve's range have other finest constrictions.
    #[test]
    fn another_curve_has_another_finest_constriction() {
        let coarse = case(&["base.n_base=1e9"]);
        let fine = coarse.with_curve(coarse.filter.curve.scaled(0.5).unwrap());
        let [one_by_one, of_fine] = [&coarse, &fine].map(|case| case.one_by_one(case.supply.n_base));
        assert!(of_fine > one_by_one + 1_000_000, "{of_fine} for {one_by_one}");
    }

    #[test]
    fn counts_take_a_column_of_the_network_for_each_thread() {
        let counts = case(&["engine=counts", "base.single_mm=0.1", "base.n_base=1e11"]);
        let bytes = |case: &Case, threads| case.bytes(case.supply.n_base, threads);
        let a_thread = (bytes(&counts, 257) - bytes(&counts, 1)) / 256;
        assert!((5_100_000..5_300_000).contains(&a_thread), "{a_thread}");
        let auto = case(&["base.single_mm=0.1", "base.n_base=1e11"]);
        assert_eq!(bytes(&auto, 64), bytes(&counts, 64));
        for set in [
            // One by one by engine, or because they are few; an expectation; no passive particles.
            vec!["engine=particles", "base.n_base=1e6"],
            vec!["base.n_base=1e6"],
            vec!["engine=expected", "base.single_mm=0.1", "base.n_base=1e11"],
            vec!["engine=counts", "base.single_mm=9", "base.n_base=1e6"],
        ] {
            let other = case(&set);
            assert_eq!(bytes(&other, 256), bytes(&other, 1), "{set:?}");
        }
        // Replicates that run side by side each have columns, so fewer of them do.
        let small =
            case(&["network.nx=40", "network.ny=40", "network.nz=60", "base.single_mm=0.1", "engine=counts"]);
        assert_eq!([4, 64].map(|threads| small.side_by_side(small.supply.n_base, threads)), [4, 1]);
    }

    #[test]
    fn openings_take_memory_for_several_narrowings_of_each_exit() {
        let bytes_and_constrictions = |n_base: &str, set: &[&str]| {
            let case = case(&[&["engine=particles", n_base], set].concat());
            (case.other_bytes(case.supply.n_base, 1), case.network.constrictions)
        };
        for (n_base, flux, of_each) in [("1e9", "exit=area", 1), ("1e9", "exit=flux", 2)] {
            let set = [format!("base.n_base={n_base}"), format!("walk.{flux}")];
            let [(closed, exits), (open, _)] = [vec![&set[1][..]], vec![&set[1][..], "walk.blocked=open"]]
                .map(|more| bytes_and_constrictions(&set[0], &more));
            assert_eq!(open - closed, exits * of_each * (20 + 8 * 48), "{flux}");
        }
        let [(closed, exits), (open, _)] =
            [&[][..], &["walk.blocked=open"]].map(|more| bytes_and_constrictions("base.n_base=1000", more));
        assert_eq!(open - closed, exits * 20 + 1000 * 48);
    }

    #[test]
    fn what_each_void_comes_to_is_counted() {
        let with_base = |base: &str, set: &[&str]| case(&[&[base], set].concat());
        let many = |set: &[&str]| with_base("base.n_base=1e9", set);
        let (none, more) = (many(&["record.voids=[]"]), many(&["record.voids=[1, 5, 10]"]));
        assert_eq!(many(&[]).kept_bytes(), 0);
        // Three more increments in two runs, with at least two copies of a row.
        let rows = more.kept_bytes() - none.kept_bytes();
        let row = size_of::<crate::outcome::record::RetainedRow>() as u64;
        assert!(rows >= none.network.voids * 3 * 2 * 2 * row, "{rows}");
        let one_run = |list| many(&[list, "runs=1"]).kept_bytes();
        assert_eq!(rows, 2 * (one_run("record.voids=[1, 5, 10]") - one_run("record.voids=[]")));
        // Few particles occupy few voids.
        let few = |list| with_base("base.n_base=1000", &[list]).kept_bytes();
        let bytes = few("record.voids=[1, 5, 10]") - few("record.voids=[]");
        assert!(bytes > 0 && bytes < rows / 100, "{bytes}");
        // Only the case with more records runs short of memory.
        assert_eq!(more.peak_bytes(1) - none.peak_bytes(1), rows);
        let room = ResourceLimits { memory: none.peak_bytes(1) + rows / 2, disk: 0 };
        let place = |mut case: Case| case.place(&room, 1, Path::new("."));
        assert!(place(none).is_ok());
        let error = place(more).unwrap_err().to_string();
        assert!(error.contains("record.voids keeps up to"), "{error}");
    }

    #[test]
    fn a_refusal_names_what_asks_for_the_memory() {
        let all = ["network.nx=9", "network.ny=9", "network.nz=12", "base.n_base=1000", "engine=particles"];
        let refused = |set: &str| {
            let mut case = Case::built_in(&[&all, &[set][..]].concat()).unwrap();
            let room = ResourceLimits { memory: 100_000_000, disk: 0 };
            case.place(&room, 1, Path::new(".")).unwrap_err().to_string()
        };
        let error = refused("record.sensitivity=[1e12]");
        assert!(
            error.starts_with("1000000000000000 base particles walked one by one (record.sensit"),
            "{error}"
        );
        let error = refused("record.thickness=[10000]");
        assert!(error.contains("(record.thickness: the thickest"), "{error}");
        // No study is to blame if the scene itself does not fit.
        let error = refused("base.n_base=1e12");
        assert!(error.starts_with("1000000000000 base particles") && !error.contains("record."), "{error}");
    }
}
