//! Tiny undirected networks, whose every outcome can be written down: what is walked beside what is enumerated.

use std::collections::BTreeMap;

use bitvec::vec::BitVec;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{ExitRule, Link, LinkEnd, LinkedVoids, Network};
use voidwalk::walk::{SizeClasses, State, Supply, Walk, WalkControl};

/// Diameter of the particles; what is narrower stops them and is blocked, both ways.
const SIZE: f64 = 2.0;

/// Three particles come in together.
const PARTICLES: usize = 3;

/// Outside: before the filter as the first of two ends, behind it as the second.
const OUT: usize = usize::MAX;

/// From, to, diameter, conductance. Narrow ones have diameters of their own, by which they are known.
type Tiny = [(usize, usize, f32, f64)];

/// Particles eroded, and the diameters (in hundredths) of what is blocked.
type Outcome = (usize, Vec<u32>);

/// Pressures by elimination: 1 before the filter, 0 behind it; links in `blocked` are closed. A void that nothing
/// joins has none.
fn pressures(voids: usize, links: &Tiny, blocked: usize) -> Vec<f64> {
    let mut a = vec![vec![0.0; voids + 1]; voids];
    for (_, &(from, to, _, g)) in links.iter().enumerate().filter(|(i, _)| blocked >> i & 1 == 0) {
        match (from, to) {
            (OUT, v) => (a[v][v], a[v][voids]) = (a[v][v] + g, a[v][voids] + g),
            (v, OUT) => a[v][v] += g,
            (u, v) => {
                (a[u][u], a[v][v]) = (a[u][u] + g, a[v][v] + g);
                (a[u][v], a[v][u]) = (a[u][v] - g, a[v][u] - g);
            }
        }
    }
    for i in 0..voids {
        if a[i][i] < 1e-12 {
            a[i][i] = 1.0;
        }
        for j in (0..voids).filter(|&j| j != i) {
            let times = a[j][i] / a[i][i];
            let row = a[i].clone();
            a[j].iter_mut().zip(row).for_each(|(to, from)| *to -= times * from);
        }
    }
    (0..voids).map(|i| a[i][voids] / a[i][i]).collect()
}

/// Adds the chance of every outcome from here on; particles stand in voids, in the reservoir (`voids`), or are gone.
fn enumerate(
    (voids, links): (usize, &Tiny),
    places: &[usize],
    (eroded, blocked): (usize, usize),
    chance: f64,
    found: &mut BTreeMap<Outcome, f64>,
) {
    let p = pressures(voids, links, blocked);
    let at = |end: usize, outside: f64| if end == OUT { outside } else { p[end] };
    // Ways on from a place: link, where to, flux.
    let ways = |place: usize| -> Vec<(usize, usize, f64)> {
        let flux = |i: usize| {
            let (from, to, _, g) = links[i];
            let flux = g * (at(from, 1.0) - at(to, 0.0));
            match (from, to) {
                (OUT, v) if place == voids => (v, flux),
                (v, OUT) if place == v => (OUT, flux),
                (u, v) if place == u && v != OUT => (v, flux),
                (u, v) if place == v && u != OUT => (u, -flux),
                _ => (0, 0.0),
            }
        };
        let open = (0..links.len()).filter(|i| blocked >> i & 1 == 0);
        open.map(|i| (i, flux(i).0, flux(i).1)).filter(|way| way.2 > 1e-9).collect()
    };
    // All choices of all particles of one increment.
    let mut choices = vec![(chance, eroded, blocked, Vec::new())];
    let mut moved = false;
    for &place in places {
        let ways = ways(place);
        let all: f64 = ways.iter().map(|way| way.2).sum();
        moved |= !ways.is_empty();
        choices = choices
            .into_iter()
            .flat_map(|(chance, eroded, blocked, left): (f64, usize, usize, Vec<usize>)| {
                let on = |to: usize| left.iter().copied().chain([to]).collect::<Vec<_>>();
                if ways.is_empty() {
                    return vec![(chance, eroded, blocked, on(place))];
                }
                ways.iter()
                    .map(|&(i, to, flux)| {
                        let chance = chance * flux / all;
                        match (f64::from(links[i].2) < SIZE, to == OUT) {
                            (true, _) => (chance, eroded, blocked | 1 << i, left.clone()),
                            (false, true) => (chance, eroded + 1, blocked, left.clone()),
                            (false, false) => (chance, eroded, blocked, on(to)),
                        }
                    })
                    .collect()
            })
            .collect();
    }
    if !moved {
        let diameters = (0..links.len()).filter(|i| blocked >> i & 1 == 1);
        let mut diameters: Vec<u32> = diameters.map(|i| (100.0 * links[i].2).round() as u32).collect();
        diameters.sort_unstable();
        *found.entry((eroded, diameters)).or_default() += chance;
        return;
    }
    for (chance, eroded, blocked, left) in choices {
        enumerate((voids, links), &left, (eroded, blocked), chance, found);
    }
}

/// What comes of one walk.
fn walked(network: &Network, seed: u64) -> Outcome {
    let sampler = SizeSampler::new(&Gradation::single(SIZE).unwrap(), 1.0).unwrap();
    let supply = Supply::new(sampler, PARTICLES as u64, 1);
    let clean = BitVec::repeat(false, network.constrictions());
    let mut state = State::new(network, &supply, SizeClasses::logarithmic(1.0, 4.0, 1), clean, seed, 1);
    let mut walk = Walk::new(network, &supply, &state);
    walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
    // The two ways through a constriction are blocked together.
    let blocked = state.blocked.iter_ones().filter(|&c| network.counts(c));
    let mut diameters: Vec<u32> = blocked.map(|c| (100.0 * network.diameters()[c]).round() as u32).collect();
    diameters.sort_unstable();
    (state.tally.eroded as usize, diameters)
}

/// 20,000 walks each: a chance of 0.1 that is wrong by 0.01 would be seen. Their outcomes are dozens, so that one
/// in some thousands of correct programs would fail; the seeds are fixed.
fn compare(voids: usize, links: &Tiny) -> BTreeMap<Outcome, f64> {
    let mut expected = BTreeMap::new();
    enumerate((voids, links), &[voids; PARTICLES], (0, 0), 1.0, &mut expected);
    assert!((expected.values().sum::<f64>() - 1.0).abs() < 1e-9);
    let end = |v: usize| if v == OUT { LinkEnd::Outside } else { LinkEnd::Void(v as u32) };
    let network = links.iter().map(|&(from, to, diameter, conductance)| Link {
        from: end(from),
        to: end(to),
        diameter,
        conductance,
        rise: 1.0,
    });
    let layer = vec![0; voids];
    let shape = LinkedVoids { layer, unit_mm: 1.0, rule: ExitRule::Flux, ..LinkedVoids::default() };
    let network = Network::linked(shape, &network.collect::<Vec<_>>()).unwrap();
    const WALKS: u64 = 20_000;
    let mut counted: BTreeMap<Outcome, u64> = BTreeMap::new();
    (0..WALKS).for_each(|seed| *counted.entry(walked(&network, seed)).or_default() += 1);
    for outcome in counted.keys() {
        assert!(expected.contains_key(outcome), "{outcome:?} cannot be; {expected:?}");
    }
    for (outcome, &chance) in &expected {
        let (n, all) = (counted.get(outcome).copied().unwrap_or(0) as f64, WALKS as f64);
        let spread = (all * chance * (1.0 - chance)).sqrt().max(1.0);
        assert!(((n - all * chance) / spread).abs() < 4.0, "{outcome:?}: {n} of {}", all * chance);
    }
    expected
}

/// One void with a narrow and a wide way out: as many are held as choose the narrow one while it is open.
#[test]
fn two_ways_out_of_one_void() {
    let links = [(OUT, 0, 9.0, 6.0), (0, OUT, 1.0, 1.0), (0, OUT, 9.0, 2.0)];
    let outcomes = compare(1, &links);
    // They come together, so that none of them finds it blocked: binomial, with a chance of 1 / 3.
    assert!((outcomes[&(3, vec![])] - 8.0 / 27.0).abs() < 1e-9);
    assert!((outcomes[&(0, vec![100])] - 1.0 / 27.0).abs() < 1e-9);
}

/// Wheatstone's bridge, whose cross link and one way out are narrow.
#[test]
fn a_bridge_with_two_narrow_links() {
    let links =
        [(OUT, 0, 9.0, 3.0), (OUT, 1, 9.0, 1.0), (0, 1, 1.1, 2.0), (0, OUT, 1.2, 1.0), (1, OUT, 9.0, 4.0)];
    let outcomes = compare(2, &links);
    assert!(outcomes.len() > 5, "{outcomes:?}");
}

/// Water turns round in the link between voids 1 and 2 when the wide-conducting, narrow way out is blocked.
#[test]
fn a_link_in_which_water_turns_round() {
    let links = [
        (OUT, 0, 9.0, 4.0),
        (0, 1, 9.0, 1.0),
        (1, OUT, 1.3, 3.0),
        (0, 2, 9.0, 2.0),
        (2, OUT, 9.0, 0.2),
        (2, 1, 1.4, 1.0),
    ];
    let before = pressures(3, &links, 0);
    let after = pressures(3, &links, 1 << 2);
    assert!(before[2] > before[1] && after[2] < after[1]);
    compare(3, &links);
}
