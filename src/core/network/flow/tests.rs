use super::*;
use crate::network::{ExitRule, Link, LinkEnd, LinkedVoids};

/// Undirected lattice whose diameters have no pattern.
fn lattice(shape: [u32; 3], rule: ExitRule, rho: f64) -> Network {
    let diameters = (0..3 * shape.iter().product::<u32>()).map(|c| 1.0 + (c * 7919 % 100) as f32 / 100.0);
    let lattice = Network::cubic_from_diameters(shape, diameters.collect(), 1.0).unwrap();
    lattice.undirected_lattice(rule, rho, 4.0).unwrap()
}

fn none_blocked(network: &Network) -> BitVec {
    BitVec::repeat(false, network.constrictions())
}

/// Asserts that pressures equal those found without an earlier factor; returns that solution.
fn like_afresh(network: &Network, flow: &Flow, solve: impl Fn(&mut Flow) -> Permeability) -> Permeability {
    let mut afresh = Flow::new(network);
    let solution = solve(&mut afresh);
    for (v, (kept, anew)) in flow.pressure.iter().zip(&afresh.pressure).enumerate() {
        assert!((kept - anew).abs() < 1e-8, "void {v}: {kept} for {anew}");
    }
    solution
}

/// Conductances follow the current blocked set, regardless of earlier closing and reopening.
#[test]
fn conductances_follow_what_is_blocked() {
    let diameters = (0..3 * 4 * 3 * 5).map(|c| if c % 17 == 0 { 0.0 } else { 1.0 + 0.01 * c as f32 });
    let lattice = Network::cubic_from_diameters([4, 3, 5], diameters.collect(), 1.0).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.1, 4.0).unwrap();
    let mut flow = Flow::new(&network);
    for every in [&[][..], &[5], &[5, 7], &[5], &[3], &[]] {
        let mut blocked = none_blocked(&network);
        for c in every.iter().flat_map(|&step| (0..network.constrictions()).step_by(step)) {
            network.set_blocked(&mut blocked, c, true);
        }
        flow.solve(&network, &blocked).unwrap();
        for c in 0..network.constrictions() {
            let rho = if blocked[c] { 0.1 } else { 1.0 };
            let whole = if network.diameters()[c] == 0.0 { 0.0 } else { network.conductance(c) };
            assert_eq!(flow.open[c], rho * whole, "{every:?} {c}");
        }
        let mut afresh = Flow::new(&network);
        let all = [&mut flow, &mut afresh].map(|f| f.solve(&network, &blocked).unwrap().conductance);
        assert!((all[0] / all[1] - 1.0).abs() < 1e-9, "{all:?}");
    }
}

/// Blocks of voids are cut off one after another, some with a kept factor: pressures agree with those
/// found without it, until no water comes through.
#[test]
fn a_factor_serves_while_little_has_closed() {
    let [n, layers] = [12, 14];
    for rho in [0.0, 0.1] {
        let network = lattice([n, n, layers], ExitRule::Flux, rho);
        let mut blocked = none_blocked(&network);
        let mut flow = Flow::new(&network);
        flow.solve(&network, &blocked).unwrap();
        let (mut served, mut made) = (0, 0);
        // 2 x 2 x 1 voids, with open constrictions between them and no way out.
        let corners = (3 * n * n + 1..(layers - 3) * n * n).step_by(2 * n as usize + 5);
        for corner in corners.filter(|v| v % n < n - 1) {
            let block = [corner, corner + 1, corner + n, corner + n + 1];
            for &void in &block {
                for c in network.exits(void).filter(|&c| !block.contains(&network.targets()[c])) {
                    network.set_blocked(&mut blocked, c, true);
                }
            }
            flow.solve(&network, &blocked).unwrap();
            match flow.kept.as_ref().unwrap().closed {
                0 => made += 1,
                _ => served += 1,
            }
            like_afresh(&network, &flow, |flow| flow.solve(&network, &blocked).unwrap());
        }
        assert!(served > made && made > 0, "{served} {made}");
        // The inlets close, a few at a time.
        let inlets: Vec<usize> = network.exits(network.reservoir().unwrap()).collect();
        let mut last = 1.0;
        for some in inlets.chunks(20) {
            some.iter().for_each(|&c| network.set_blocked(&mut blocked, c, true));
            flow.solve(&network, &blocked).unwrap();
            last = like_afresh(&network, &flow, |f| f.solve(&network, &blocked).unwrap()).conductance;
        }
        assert_eq!(last == 0.0, rho == 0.0);
    }
}

/// Two chains of voids, one with almost no conductance: once the other is blocked, squares of the
/// remaining conductances vanish beside the earlier squares.
#[test]
fn next_to_nothing_is_solved_once_it_is_all_there_is() {
    const LONG: u32 = 8000;
    let small = |i: u32| 1e-170 * f64::from(1 + i % 7);
    let mut links = Vec::new();
    for (first, is_small) in [(0, false), (LONG, true)] {
        let ends = |i: u32| if i < LONG { LinkEnd::Void(first + i) } else { LinkEnd::Outside };
        for i in 0..=LONG {
            let from = if i == 0 { LinkEnd::Outside } else { ends(i - 1) };
            let conductance = if is_small { small(i) } else { 1.0 };
            links.push(Link { from, to: ends(i), diameter: 1.0, conductance, rise: 1.0 });
        }
    }
    let layer = (0..2 * LONG).map(|void| void % LONG).collect();
    let voids = LinkedVoids { layer, unit_mm: 1.0, rule: ExitRule::Flux, ..LinkedVoids::default() };
    let network = Network::linked(voids, &links).unwrap();
    let (mut flow, mut blocked) = (Flow::new(&network), none_blocked(&network));
    flow.solve(&network, &blocked).unwrap();
    let inlet = network.exits(network.reservoir().unwrap()).next().unwrap();
    network.set_blocked(&mut blocked, inlet, true);
    // An accuracy of half a millionth of the earlier flow says nothing about the current flow, but the
    // flow is not the old one.
    let solution = flow.solve(&network, &blocked);
    let exact = 1.0 / (0..=LONG).map(|i| 1.0 / small(i)).sum::<f64>();
    let through = flow.through;
    assert!((through / exact - 1.0).abs() < 1e-6, "{through} for {exact}, {solution:?}");
}

/// Fractions that shrink a few at a time, solved with a kept factor: pressures agree with those found
/// without it. A later solution for blocked constrictions discards the fractions.
#[test]
fn parts_are_solved_as_afresh_and_forgotten() {
    let network = lattice([10, 10, 10], ExitRule::Flux, 0.1);
    let is_like = |flow: &Flow, solution: Permeability, solve: &dyn Fn(&mut Flow) -> Permeability| {
        let anew = like_afresh(&network, flow, solve);
        assert!((solution.conductance / anew.conductance - 1.0).abs() < 1e-7, "{solution:?} {anew:?}");
    };
    let mut parts = vec![1.0; network.constrictions()];
    let mut flow = Flow::new(&network);
    flow.solve_parts(&network, &parts).unwrap();
    let mut served = 0;
    for step in 1..12 {
        for c in (37 * step..network.constrictions()).step_by(997) {
            let part = if step % 4 == 0 { 0.0 } else { 0.3 / step as f64 };
            parts[c] = part;
            if let Some(twin) = network.twin(c) {
                parts[twin] = part;
            }
        }
        let solution = flow.solve_parts(&network, &parts).unwrap();
        served += usize::from(flow.kept.as_ref().is_some_and(|kept| kept.closed > 0));
        is_like(&flow, solution, &|flow| flow.solve_parts(&network, &parts).unwrap());
    }
    assert!(served > 3, "{served}");
    let mut blocked = none_blocked(&network);
    for every in [network.constrictions(), 50] {
        (0..network.constrictions()).step_by(every).for_each(|c| {
            network.set_blocked(&mut blocked, c, every == 50);
        });
        flow.solve_parts(&network, &parts).unwrap();
        let solution = flow.solve(&network, &blocked).unwrap();
        is_like(&flow, solution, &|flow| flow.solve(&network, &blocked).unwrap());
        for c in 0..network.constrictions() {
            let rho = if blocked[c] { 0.1 } else { 1.0 };
            assert_eq!(flow.open[c], rho * whole(&network, c), "{every} {c}");
        }
    }
}

/// A void that was cut off when a factor was made has no row in it; once it opens, a new factor is made.
#[test]
fn what_opens_again_needs_another_factor() {
    let lattice = Network::cubic_from_diameters([8, 8, 8], vec![1.0; 3 * 512], 1.0).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap();
    let (mut flow, mut blocked) = (Flow::new(&network), none_blocked(&network));
    for (void, is_closed, is_kept) in [(200, true, false), (300, true, true), (200, false, false)] {
        network.exits(void).for_each(|c| network.set_blocked(&mut blocked, c, is_closed));
        flow.solve(&network, &blocked).unwrap();
        // Twelve of some 3,000 exits close.
        assert_eq!(flow.kept.as_ref().unwrap().closed > 0, is_kept, "{void}");
    }
    like_afresh(&network, &flow, |flow| flow.solve(&network, &blocked).unwrap());
}

/// The weight of an exit follows its outflow; it is 0 if water flows in, or if the exit is blocked, even
/// if it leaks.
#[test]
fn exits_weigh_by_what_leaves_through_them() {
    for rule in [ExitRule::Flux, ExitRule::AreaAlongFlow] {
        let mut network = lattice([6, 6, 6], rule, 0.1);
        let (mut flow, mut blocked) = (Flow::new(&network), none_blocked(&network));
        (0..network.constrictions()).step_by(5).for_each(|c| network.set_blocked(&mut blocked, c, true));
        flow.solve(&network, &blocked).unwrap();
        flow.direct(&mut network);
        let mut seen = [0; 3];
        for void in 0..network.voids() as u32 {
            for c in network.exits(void) {
                let (flux, area) = (flow.flux(c), f64::from(network.diameters()[c]).powi(2));
                let out = if rule == ExitRule::Flux { flux } else { area };
                let (kind, expected) = match (blocked[c], flux > 0.0) {
                    (true, _) => (0, 0.0),
                    (false, false) => (1, 0.0),
                    (false, true) => (2, out),
                };
                seen[kind] += 1;
                assert_eq!(network.exit_weight(c), expected, "{void} {c}: flux {flux}");
            }
        }
        assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
    }
}
