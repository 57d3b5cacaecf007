//! Slow, simple walk as a check of the fast one.
//!
//! It moves one particle after another and computes every weight afresh from the network, as the model is
//! stated. It shares with the kernel only the network, its flow solver, the sizes of the base, the strata,
//! the streams, and the tabulated law of arching with its range.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};

use bitvec::vec::BitVec;

use super::{CHUNK, Supply};
use crate::network::{END, ExitRule, Flow, Network};
use crate::stream::{DRAWS_PER_BLOCK, Key, LANES, Purpose, Words, draw16};

/// One base particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Rank in order of insertion.
    pub rank: u64,
    /// Void that contains the particle.
    pub void: u32,
    /// Diameter, in units of the network's reference length.
    pub diameter: f32,
}

/// Run, particle by particle.
pub struct Reference<'a> {
    network: Cow<'a, Network>,
    /// Flow, last increment before its solution, and number of changes of constrictions by then.
    flow: Option<(Flow, u64, usize)>,
    supply: &'a Supply,
    seed: u64,
    run: u64,
    /// Last completed increment.
    pub(crate) increment: u64,
    /// Moving particles, in order of insertion.
    pub moving: Vec<Particle>,
    /// Eroded particles, in order of leaving.
    pub eroded: Vec<Particle>,
    /// Particles stopped by a constriction, with the constriction.
    pub stopped: Vec<(Particle, usize)>,
    /// Number of stopped particles in arches.
    pub arched: u64,
    /// Sum of the diameters cubed of particles in arches.
    pub arched_mass: f64,
    /// Number of arches.
    pub arches: u64,
    /// Particles in voids without open exits.
    pub stranded: Vec<Particle>,
    /// Particles trapped in closed loops.
    pub trapped: Vec<Particle>,
    /// True for each blocked constriction.
    pub blocked: Vec<bool>,
    /// Width of each constriction, if blocked ones leave openings.
    pub widths: Option<Vec<f32>>,
    /// Number of narrowings, at most one per constriction and increment.
    pub narrowings: usize,
    /// Widths at the last solution of the flow.
    widths_then: Vec<f32>,
    /// Increment and constriction of each blocking.
    pub history: Vec<(u64, usize)>,
    /// Number of completed moves.
    pub particle_moves: u64,
}

impl<'a> Reference<'a> {
    /// Prepares for the first increment.
    pub fn new(network: &'a Network, supply: &'a Supply, blocked: Vec<bool>, seed: u64, run: u64) -> Self {
        Self {
            network: Cow::Borrowed(network),
            flow: network.exit_rule().needs_flow().then(|| (Flow::new(network), 0, 0)),
            supply,
            seed,
            run,
            increment: 0,
            moving: vec![],
            eroded: vec![],
            stopped: vec![],
            arched: 0,
            arched_mass: 0.0,
            arches: 0,
            stranded: vec![],
            trapped: vec![],
            widths: supply.leaves_openings().then(|| network.diameters().to_vec()),
            narrowings: 0,
            widths_then: network.diameters().to_vec(),
            blocked,
            history: vec![],
            particle_moves: 0,
        }
    }

    /// Continues from the openings of an earlier run.
    pub fn from_widths(self, widths: Option<Vec<f32>>) -> Self {
        Self { widths, ..self }
    }

    /// Tells if the run has ended.
    pub fn finished(&self) -> bool {
        self.increment >= self.supply.increments() && self.moving.is_empty()
    }

    /// Performs one increment.
    pub fn increment(&mut self) {
        self.increment += 1;
        self.direct();
        self.insert();
        let mut newly_blocked = BTreeSet::new();
        let stopped_before = self.stopped.len();
        let mut still_moving = vec![];
        let mut begun = HashMap::new();
        let mut place_in_chunk = vec![0u64; 1 + self.supply.total() as usize / CHUNK];
        for particle in std::mem::take(&mut self.moving) {
            let place = &mut place_in_chunk[particle.rank as usize / CHUNK];
            let draw = self.draw_of(self.key(Purpose::Step, particle.rank / CHUNK as u64), *place);
            *place += 1;
            let Some(exit) = self.pick(particle.void, draw) else {
                match self.waits(particle.void) {
                    true => still_moving.push(particle),
                    false => self.stranded.push(particle),
                }
                continue;
            };
            let width = self.width(exit);
            let place = (particle.rank / CHUNK as u64, *place - 1);
            let fits = particle.diameter <= width;
            let arches = fits && self.arches(place, exit, particle.diameter, &mut begun);
            if arches {
                self.arched += 1;
                self.arched_mass += f64::from(particle.diameter).powi(3);
            }
            if arches || !fits {
                newly_blocked.insert(exit);
                self.stopped.push((particle, exit));
                continue;
            }
            self.particle_moves += 1;
            match self.network.targets()[exit] {
                END => self.eroded.push(particle),
                void => still_moving.push(Particle { void, ..particle }),
            }
        }
        self.arches += begun.len() as u64;
        self.moving = still_moving;
        self.narrow(stopped_before);
        for exit in newly_blocked {
            if !std::mem::replace(&mut self.blocked[exit], true) {
                self.blocked[self.network.twin(exit).unwrap_or(exit)] = true;
                self.history.push((self.increment, exit));
            }
        }
        if self.increment >= self.supply.increments() && self.moving.iter().all(|p| self.is_trapped(p)) {
            self.trapped = std::mem::take(&mut self.moving);
        }
    }

    fn width(&self, exit: usize) -> f32 {
        self.widths.as_ref().map_or(self.network.diameters()[exit], |widths| widths[exit])
    }

    /// Narrows the constrictions that stopped particles from entry `from` on: to the circle inscribed between
    /// the finest of them and two grains, the constriction being the gap of three equal touching grains.
    fn narrow(&mut self, from: usize) {
        let Some(widths) = &mut self.widths else { return };
        let mut narrowed = BTreeSet::new();
        for (particle, exit) in &self.stopped[from..] {
            let whole = f64::from(self.network.diameters()[*exit]);
            let left = descartes(f64::from(particle.diameter), whole / (2.0 / 3f64.sqrt() - 1.0)).min(whole);
            if (left as f32) < widths[*exit] {
                let twin = self.network.twin(*exit).unwrap_or(*exit);
                (widths[*exit], widths[twin]) = (left as f32, left as f32);
                narrowed.insert(twin.min(*exit));
            }
        }
        self.narrowings += narrowed.len();
    }

    /// Fraction that a constriction of this width (three openings beside a particle) keeps of a quantity
    /// proportional to this power of the diameter.
    fn part(&self, exit: usize, width: f32, power: i32) -> f64 {
        let whole = f64::from(self.network.diameters()[exit]);
        if whole == 0.0 { 0.0 } else { (3.0 * (f64::from(width) / whole).powi(power)).min(1.0) }
    }

    /// Solves the flow before the first increment, and again if the constrictions that have closed since
    /// carried more of it than the tolerance, or if any has closed and ten increments have passed.
    fn direct(&mut self) {
        let Some((mut flow, solved_at, changes_then)) = self.flow.take() else { return };
        let changes = if self.widths.is_some() { self.narrowings } else { self.history.len() };
        let carried: f64 = match &self.widths {
            None => self.history[changes_then..].iter().map(|&(_, exit)| flow.share(exit)).sum(),
            Some(widths) => {
                let lost = |&exit: &usize| {
                    let then = self.part(exit, self.widths_then[exit], 4);
                    let lost = then - self.part(exit, widths[exit], 4);
                    if then > 0.0 { flow.share(exit) * lost / then } else { 0.0 }
                };
                let once = |&exit: &usize| self.network.twin(exit).is_none_or(|twin| exit < twin);
                (0..widths.len()).filter(once).map(|exit| lost(&exit)).sum()
            }
        };
        let is_late = self.increment > solved_at + 10;
        let is_due = changes > changes_then && (is_late || carried >= self.network.flow_tolerance());
        let blocked: BitVec = self.blocked.iter().copied().collect();
        let parts: Option<Vec<f64>> = self
            .widths
            .as_ref()
            .map(|widths| (0..widths.len()).map(|exit| self.part(exit, widths[exit], 4)).collect());
        let network = self.network.to_mut();
        if self.increment == 1 {
            // The clean filter is solved first: the next solution starts from its pressures.
            flow.solve(network, &BitVec::repeat(false, blocked.len())).expect("small networks are solved");
        }
        self.flow = Some(if self.increment == 1 || is_due {
            match &parts {
                None => flow.solve(network, &blocked),
                Some(parts) => flow.solve_parts(network, parts),
            }
            .expect("small networks are solved");
            flow.direct(network);
            self.widths_then = self.widths.clone().unwrap_or_default();
            (flow, self.increment - 1, changes)
        } else {
            (flow, solved_at, changes_then)
        });
    }

    /// Tells if the particle at a place of a chunk stays in an arch: it jams by its own draw, and the arch
    /// started there by the first particle of the increment has room. `begun`: room left, by constriction.
    fn arches(
        &self,
        (chunk, place): (u64, u64),
        exit: usize,
        diameter: f32,
        begun: &mut HashMap<usize, u32>,
    ) -> bool {
        let Some(arching) = self.supply.arching() else { return false };
        let ratio = f64::from(self.width(exit)) / f64::from(diameter);
        if ratio >= arching.law.widest {
            return false;
        }
        let draw = self.draw_of(self.key(Purpose::Arching, chunk), place);
        if ((draw >> 16) as f64) >= arching.by_table(ratio) * 2f64.powi(48) {
            return false;
        }
        let has = (ratio * ratio + 1.0).round().max(2.0) as u32;
        let constriction = self.network.twin(exit).map_or(exit, |twin| twin.min(exit));
        let room = begun.entry(constriction).or_insert(has);
        let joins = *room > 0;
        *room = room.saturating_sub(1);
        joins
    }

    /// Tells if water left a void in the last solution, so that its particles wait for the next.
    fn waits(&self, void: u32) -> bool {
        self.flow.is_some() && self.network.exits(void).any(|e| self.network.exit_weight(e) > 0.0)
    }

    fn key(&self, purpose: Purpose, chunk: u64) -> Key {
        Key { seed: self.seed, purpose, run: self.run, increment: self.increment, chunk }
    }

    fn insert(&mut self) {
        let ranks = self.supply.inserted(self.increment - 1)..self.supply.inserted(self.increment);
        let mut place_in_chunk = vec![0u64; 1 + self.supply.total() as usize / CHUNK];
        for rank in ranks {
            let chunk = rank / CHUNK as u64;
            let place = &mut place_in_chunk[chunk as usize];
            let word = |w: u64| {
                let block = block(self.key(Purpose::Insertion, chunk), w / LANES as u64).0;
                block[w as usize % LANES]
            };
            let (nodes, words) = (self.network.start(), [word(2 * *place), word(2 * *place + 1)]);
            let (mut node, mut size) =
                (((u128::from(words[0]) * nodes.len() as u128) >> 64) as usize, words[1]);
            if let Some(strata) = self.supply.strata(self.increment) {
                let m = rank - self.supply.inserted(self.increment - 1);
                (node, size) = (strata.node(m, words[0], nodes.len() as u64), strata.size_word(m, words[1]));
            }
            let diameter = self.supply.diameter(size);
            *place += 1;
            self.moving.push(Particle { rank, void: nodes[node], diameter });
        }
    }

    /// All 64 bits of the draw of the particle at `place` in its chunk.
    fn draw_of(&self, key: Key, place: u64) -> u64 {
        let (block, extension) = block(key, place / DRAWS_PER_BLOCK as u64);
        extension.complete(draw16(&block, place as usize % DRAWS_PER_BLOCK), place)
    }

    fn open_area(&self, exit: usize) -> f64 {
        if let Some(widths) = &self.widths {
            let weight = self.network.exit_weight(exit);
            return match self.network.exit_rule() {
                _ if weight == 0.0 => 0.0,
                ExitRule::Flux => {
                    weight * self.part(exit, widths[exit], 4) / self.part(exit, self.widths_then[exit], 4)
                }
                _ => weight * self.part(exit, widths[exit], 2),
            };
        }
        if self.network.reservoir().is_some() {
            return if self.blocked[exit] { 0.0 } else { self.network.exit_weight(exit) };
        }
        let diameter = f64::from(self.network.diameters()[exit]);
        if self.blocked[exit] { 0.0 } else { diameter * diameter }
    }

    fn open_exits(&self, void: u32) -> Vec<usize> {
        self.network.exits(void).filter(|&e| self.open_area(e) > 0.0).collect()
    }

    /// Exit picked by a draw among the open ones, with probability proportional to area.
    fn pick(&self, void: u32, draw: u64) -> Option<usize> {
        let open = self.open_exits(void);
        let total: f64 = open.iter().map(|&e| self.open_area(e)).sum();
        let mut sum = 0.0;
        for &exit in &open {
            sum += self.open_area(exit);
            if draw < (sum / total * 2f64.powi(64)) as u64 {
                return Some(exit);
            }
        }
        open.last().copied()
    }

    /// Tells if, through open constrictions that it fits, the particle can reach neither the end, nor an
    /// open constriction finer than it, nor a void without open exits.
    fn is_trapped(&self, particle: &Particle) -> bool {
        let mut seen = BTreeSet::from([particle.void]);
        let mut todo = vec![particle.void];
        while let Some(void) = todo.pop() {
            let open = self.open_exits(void);
            if open.is_empty() {
                return false;
            }
            for exit in open {
                let stops = self.supply.arching().map_or(1.0, |arching| arching.stops_to());
                let width = f64::from(self.width(exit));
                if stops * f64::from(particle.diameter) > width || self.network.targets()[exit] == END {
                    return false;
                }
                if seen.insert(self.network.targets()[exit]) {
                    todo.push(self.network.targets()[exit]);
                }
            }
        }
        true
    }
}

/// Block `index` of a stream, and the words that complete its draws.
fn block(key: Key, index: u64) -> ([u64; LANES], Words) {
    let mut lanes = key.lanes();
    for _ in 0..index {
        lanes.next_block();
    }
    (lanes.next_block(), lanes.extension())
}

/// Diameter of the circle inscribed between touching circles of diameters `a`, `b` and `b`.
fn descartes(a: f64, b: f64) -> f64 {
    let [one, two, three] = [a, b, b].map(|diameter| 2.0 / diameter);
    2.0 / (one + two + three + 2.0 * (one * two + two * three + three * one).sqrt())
}
