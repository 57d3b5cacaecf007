use super::*;
use crate::network::ExitRule;

/// Whatever closed and opened again before: conductances are those of what is blocked now.
#[test]
fn conductances_follow_what_is_blocked() {
    let diameters = (0..3 * 4 * 3 * 5).map(|c| if c % 17 == 0 { 0.0 } else { 1.0 + 0.01 * c as f32 });
    let lattice = Network::cubic_from_diameters([4, 3, 5], diameters.collect(), 1.0).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.1, 4.0).unwrap();
    let blocked = |every: &[usize]| {
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        for c in every.iter().flat_map(|&step| (0..network.constrictions()).step_by(step)) {
            network.set_blocked(&mut blocked, c, true);
        }
        blocked
    };
    let mut flow = Flow::new(&network);
    for every in [&[][..], &[5], &[5, 7], &[5], &[3], &[]] {
        let blocked = blocked(every);
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

/// Blocks of voids are cut off one after another, some with a factor that is kept: pressures are those
/// that are found without it, all the way to where no water comes through.
#[test]
fn a_factor_serves_while_little_has_closed() {
    let [n, layers] = [12, 14];
    let diameters = (0..3 * n * n * layers).map(|c| 1.0 + (c * 7919 % 100) as f32 / 100.0);
    let lattice = Network::cubic_from_diameters([n, n, layers], diameters.collect(), 1.0).unwrap();
    for rho in [0.0, 0.1] {
        let network = lattice.undirected_lattice(ExitRule::Flux, rho, 4.0).unwrap();
        let reservoir = network.reservoir().unwrap();
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        let mut flow = Flow::new(&network);
        flow.solve(&network, &blocked).unwrap();
        let (mut served, mut made) = (0, 0);
        let like_afresh = |flow: &Flow, blocked: &BitSlice| {
            let mut afresh = Flow::new(&network);
            let permeability = afresh.solve(&network, blocked).unwrap();
            for (v, (kept, anew)) in flow.pressure.iter().zip(&afresh.pressure).enumerate() {
                assert!((kept - anew).abs() < 1e-7, "void {v}: {kept} for {anew}");
            }
            permeability.conductance
        };
        // Two by two by one voids, with open ways between them and none out.
        for corner in
            (3 * n * n + 1..(layers - 3) * n * n).step_by(2 * n as usize + 5).filter(|v| v % n < n - 1)
        {
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
            like_afresh(&flow, &blocked);
        }
        assert!(served > made && made > 0, "{served} {made}");
        // The inlets close, a few at a time.
        let inlets: Vec<usize> = network.exits(reservoir).collect();
        for some in inlets.chunks(20) {
            some.iter().for_each(|&c| network.set_blocked(&mut blocked, c, true));
            flow.solve(&network, &blocked).unwrap();
            like_afresh(&flow, &blocked);
        }
        assert_eq!(like_afresh(&flow, &blocked) == 0.0, rho == 0.0);
    }
}

/// Four slabs that clog: pressures, what is kept for the next solution and the weights of exits are the
/// same to the bit on any number of threads, balance at every void, and are those that are found from
/// nothing.
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let [n, layers] = [11, 200];
    let diameters = (0..3 * n * n * layers).map(|c| 1.0 + (c * 7919 % 100) as f32 / 100.0);
    let lattice = Network::cubic_from_diameters([n, n, layers], diameters.collect(), 1.0).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap();
    assert_eq!(Flow::new(&network).passages.slabs().number(), 4);
    let walk = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut network = network.clone();
            let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
            let mut flow = Flow::new(&network);
            let mut found = Vec::new();
            // A little, much, and much of all layers but the first.
            for (from, step) in [(0, 1009), (1, 37), (3 * network.constrictions() / 40, 11)] {
                for c in (from..network.constrictions()).step_by(step) {
                    network.set_blocked(&mut blocked, c, true);
                }
                flow.solve(&network, &blocked).unwrap();
                flow.direct(&mut network);
                let weights: Vec<f64> =
                    (0..network.constrictions()).map(|c| network.exit_weight(c)).collect();
                found.push((blocked.clone(), flow.pressure.clone(), weights));
            }
            found
        })
    };
    let alone = walk(1);
    for threads in [2, 3, 7] {
        assert!(walk(threads) == alone, "{threads} threads");
    }
    for (blocked, pressure, _) in &alone {
        let mut afresh = Flow::new(&network);
        let through = afresh.solve(&network, blocked).unwrap().conductance;
        let (mut warm, reservoir) = (Flow::new(&network), network.reservoir().unwrap());
        warm.set_blocked(&network, blocked, 0.0);
        warm.pressure.clone_from(pressure);
        assert!((warm.through(&network) / through - 1.0).abs() < 1e-9);
        for void in (0..network.voids() as u32).filter(|&void| void != reservoir) {
            let [kept, anew] = [&warm, &afresh].map(|flow| flow.pressure[void as usize]);
            assert!((kept - anew).abs() < 1e-8, "void {void}: {kept} for {anew}");
            let off: f64 = network.exits(void).map(|c| warm.flux(void, c)).sum();
            assert!(off.abs() < 1e-9 * through, "void {void}: {off} of {through}");
        }
    }
}

/// A thick network that clogs is known after one solution, though with the residual of a thin one it is not.
#[test]
fn a_thick_network_is_solved_once() {
    let [n, layers] = [16, THICK as u32];
    let diameters = (0..3 * n * n * layers).map(|c| 1.0 + (c * 7919 % 100) as f32 / 100.0);
    let lattice = Network::cubic_from_diameters([n, n, layers], diameters.collect(), 1.0).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap();
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    let mut flow = Flow::new(&network);
    for step in [1009, 211, 37] {
        (0..network.constrictions()).step_by(step).for_each(|c| {
            network.set_blocked(&mut blocked, c, true);
        });
        let found = flow.solve(&network, &blocked).unwrap().conductance;
        assert_eq!(flow.accuracy, CONVERGED_THICK);
        assert!(flow.is_known(&network) && flow.missing < 0.1 * KNOWN * found, "{} of {found}", flow.missing);
        let mut closely = Flow::new(&network);
        let exact = closely.solve_closely(&network, &blocked).unwrap().conductance;
        assert!((found / exact - 1.0).abs() < KNOWN, "{found} for {exact}");
    }
}

/// A thick network of ten slabs, closed step by step where `is_closed` says, by layer and constriction.
fn close_step_by_step(
    rho: f64,
    steps: usize,
    is_closed: impl Fn(usize, u32, usize) -> bool + Sync,
    mut see: impl FnMut(&Flow, &Network, &BitSlice, Turned),
) {
    let [n, layers] = [12, THICK as u32 + 20];
    let diameters = (0..3 * n * n * layers).map(|c| 1.0 + (c * 7919 % 100) as f32 / 100.0);
    let lattice = Network::cubic_from_diameters([n, n, layers], diameters.collect(), 1.0).unwrap();
    let mut network = lattice.undirected_lattice(ExitRule::Flux, rho, 4.0).unwrap();
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    let mut flow = Flow::new(&network);
    assert_eq!(flow.passages.slabs().number(), 10);
    flow.solve(&network, &blocked).unwrap();
    flow.direct(&mut network);
    for step in 0..steps {
        for void in 0..network.voids() as u32 {
            let layer = network.layer_of()[void as usize];
            for c in network.exits(void).filter(|&c| is_closed(step, layer, c)) {
                network.set_blocked(&mut blocked, c, true);
            }
        }
        flow.solve(&network, &blocked).unwrap();
        let turned = flow.direct(&mut network);
        see(&flow, &network, &blocked, turned);
    }
}

/// Pressures, and the share of each exit in what leaves its void, are those that are found from nothing.
fn are_as_afresh(flow: &Flow, network: &Network, blocked: &BitSlice) {
    let mut afresh = Flow::new(network);
    let anew = afresh.solve(network, blocked).unwrap().conductance;
    assert!((flow.through(network) / anew - 1.0).abs() < 1e-8, "{} for {anew}", flow.through(network));
    for (v, (near, anew)) in flow.pressure.iter().zip(&afresh.pressure).enumerate() {
        assert!((near - anew).abs() < 1e-9, "void {v}: {near} for {anew}");
    }
    let mut other = network.clone();
    afresh.direct(&mut other);
    for void in 0..network.voids() as u32 {
        let shares = |of: &Network| {
            let weights: Vec<f64> = network.exits(void).map(|c| of.exit_weight(c)).collect();
            let sum = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            weights.into_iter().map(move |weight| weight / sum)
        };
        for (near, anew) in shares(network).zip(shares(&other)) {
            assert!((near - anew).abs() < 1e-5, "void {void}: {near} for {anew}");
        }
    }
}

/// A pulse that closes constrictions of forty layers on its way through a thick network: little but its
/// surroundings is looked at.
#[test]
fn a_pulse_is_solved_near_where_it_is() {
    for (rho, steps) in [(0.0, 8), (0.1, 2)] {
        let mut step_now = 0;
        let is_closed = |step: usize, layer: u32, c: usize| {
            let first = step as u32 * 50;
            (first..first + 40).contains(&layer) && (c + 31 * step).is_multiple_of(61)
        };
        close_step_by_step(rho, steps, is_closed, |flow, network, blocked, turned| {
            let voids: usize = turned.groups().map(|group| group.len()).sum();
            assert!(4 * voids < 3 * network.voids(), "{voids} of {}", network.voids());
            if step_now % 3 == 0 || step_now + 1 == steps {
                are_as_afresh(flow, network, blocked);
            }
            step_now += 1;
        });
    }
}

/// Two places far apart at once; both ends at once, with which the flow through all that lies between
/// changes; a layer of which little stays open; and the one end by itself.
#[test]
fn what_closes_in_several_places_is_solved_alike() {
    let is_closed = |step: usize, layer: u32, c: usize| match step {
        0 => [100, 101, 300, 301].contains(&layer) && c.is_multiple_of(7),
        1 => [0, 1, THICK as u32 + 18].contains(&layer) && c.is_multiple_of(11),
        2 => layer == 200 && c % (6 * 144) > 40,
        _ => layer < 3 && c.is_multiple_of(5),
    };
    let mut turned_in = Vec::new();
    close_step_by_step(0.0, 4, is_closed, |flow, network, blocked, turned| {
        turned_in.push(turned == Turned::all(network.voids()));
        are_as_afresh(flow, network, blocked);
    });
    assert_eq!(turned_in, [false, true, false, false]);
}

/// After stretches: parts of conductances, what was blocked opens again, every flux is asked for, and the
/// inlets close.
#[test]
fn whatever_follows_a_stretch_is_solved() {
    let is_closed = |step: usize, layer: u32, c: usize| layer / 40 == 3 + step as u32 && c.is_multiple_of(13);
    close_step_by_step(0.0, 1, is_closed, |_, network, blocked, _| {
        let mut flow = Flow::new(network);
        let mut blocked = blocked.to_bitvec();
        let none: BitVec = BitVec::repeat(false, network.constrictions());
        for blocked in [&none, &blocked] {
            flow.solve(network, blocked).unwrap();
        }
        let like_afresh = |flow: &Flow, solve: &dyn Fn(&mut Flow) -> Permeability| {
            let mut afresh = Flow::new(network);
            let through = solve(&mut afresh).conductance;
            assert!((flow.through(network) - through).abs() < 1e-8 * through.max(1e-3));
            for (v, (now, anew)) in flow.pressure.iter().zip(&afresh.pressure).enumerate() {
                assert!((now - anew).abs() < 1e-9, "void {v}: {now} for {anew}");
            }
        };
        let mut parts: Vec<f64> = blocked.iter().map(|blocked| if *blocked { 0.0 } else { 1.0 }).collect();
        for step in 0..2 {
            for void in
                (0..network.voids() as u32).filter(|&void| network.layer_of()[void as usize] / 40 == 6 + step)
            {
                for c in network.exits(void).filter(|c| c.is_multiple_of(7)) {
                    parts[c] *= 0.2;
                    network.twin(c).into_iter().for_each(|twin| parts[twin] = parts[c]);
                }
            }
            flow.solve_parts(network, &parts).unwrap();
            like_afresh(&flow, &|flow| flow.solve_parts(network, &parts).unwrap());
        }
        flow.solve(network, &none).unwrap();
        like_afresh(&flow, &|flow| flow.solve(network, &none).unwrap());
        flow.solve(network, &blocked).unwrap();
        flow.solve_closely(network, &blocked).unwrap();
        like_afresh(&flow, &|flow| flow.solve_closely(network, &blocked).unwrap());
        for c in network.exits(network.reservoir().unwrap()) {
            network.set_blocked(&mut blocked, c, true);
        }
        assert_eq!(flow.solve(network, &blocked).unwrap().conductance, 0.0);
    });
}

/// Two chains of voids, of which the one conducts next to nothing: once the other is blocked, squares of what
/// is left are no numbers beside those of before.
#[test]
fn next_to_nothing_is_solved_once_it_is_all_there_is() {
    use crate::network::{Link, LinkEnd, LinkedVoids};
    const LONG: u32 = 8000;
    let small = |i: u32| 1e-170 * f64::from(1 + i % 7);
    let mut links = Vec::new();
    for (first, conductance) in [(0, None), (LONG, Some(small))] {
        let ends = |i: u32| if i < LONG { LinkEnd::Void(first + i) } else { LinkEnd::Outside };
        for i in 0..=LONG {
            let from = if i == 0 { LinkEnd::Outside } else { ends(i - 1) };
            let conductance = conductance.map_or(1.0, |of| of(i));
            links.push(Link { from, to: ends(i), diameter: 1.0, conductance, rise: 1.0 });
        }
    }
    let layer = (0..2 * LONG).map(|void| void % LONG).collect();
    let voids = LinkedVoids { layer, unit_mm: 1.0, rule: ExitRule::Flux, ..LinkedVoids::default() };
    let network = Network::linked(voids, &links).unwrap();
    let mut flow = Flow::new(&network);
    assert!(flow.passages.slabs().number() > 1);
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    flow.solve(&network, &blocked).unwrap();
    let inlet = network.exits(network.reservoir().unwrap()).next().unwrap();
    network.set_blocked(&mut blocked, inlet, true);
    // Half a millionth of what passed before is not known of what passes now; but it is not what it was.
    let found = flow.solve(&network, &blocked);
    let exact = 1.0 / (0..=LONG).map(|i| 1.0 / small(i)).sum::<f64>();
    let through = flow.through(&network);
    assert!((through / exact - 1.0).abs() < 1e-6, "{through} for {exact}, {found:?}");
}

/// The same bits on any number of threads, of pressures and weights, where stretches are solved.
#[test]
fn stretches_give_the_same_bits_on_any_number_of_threads() {
    let walk = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let is_closed =
            |step: usize, layer: u32, c: usize| layer / 50 == 2 + step as u32 && c.is_multiple_of(37);
        let mut found = Vec::new();
        pool.install(|| {
            close_step_by_step(0.0, 3, is_closed, |flow, network, _, turned| {
                let weights: Vec<f64> =
                    (0..network.constrictions()).map(|c| network.exit_weight(c)).collect();
                assert!(turned != Turned::all(network.voids()), "stretches are what this is about");
                found.push((flow.pressure.clone(), weights, turned));
            });
        });
        found
    };
    let alone = walk(1);
    for threads in [2, 3, 7] {
        assert!(walk(threads) == alone, "{threads} threads");
    }
}

/// Parts that shrink a few at a time, solved with a factor that is kept: pressures are those that are
/// found without it. What is blocked afterwards is solved without those parts.
#[test]
fn parts_are_solved_as_afresh_and_forgotten() {
    let diameters = (0..3 * 10 * 10 * 10).map(|c| 1.0 + (c * 7919 % 100) as f32 / 100.0);
    let lattice = Network::cubic_from_diameters([10, 10, 10], diameters.collect(), 1.0).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.1, 4.0).unwrap();
    let is_like = |flow: &mut Flow, found: Permeability, solve: &dyn Fn(&mut Flow) -> Permeability| {
        let mut afresh = Flow::new(&network);
        let anew = solve(&mut afresh);
        assert!((found.conductance / anew.conductance - 1.0).abs() < 1e-7, "{found:?} {anew:?}");
        for (v, (kept, anew)) in flow.pressure.iter().zip(&afresh.pressure).enumerate() {
            assert!((kept - anew).abs() < 1e-7, "void {v}: {kept} for {anew}");
        }
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
        let found = flow.solve_parts(&network, &parts).unwrap();
        served += usize::from(flow.kept.as_ref().is_some_and(|kept| kept.closed > 0));
        is_like(&mut flow, found, &|flow| flow.solve_parts(&network, &parts).unwrap());
    }
    assert!(served > 3, "{served}");
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    for every in [network.constrictions(), 50] {
        (0..network.constrictions()).step_by(every).for_each(|c| {
            network.set_blocked(&mut blocked, c, every == 50);
        });
        flow.solve_parts(&network, &parts).unwrap();
        let found = flow.solve(&network, &blocked).unwrap();
        is_like(&mut flow, found, &|flow| flow.solve(&network, &blocked).unwrap());
        for c in 0..network.constrictions() {
            let rho = if blocked[c] { 0.1 } else { 1.0 };
            assert_eq!(flow.open[c], rho * whole(&network, c), "{every} {c}");
        }
    }
}

/// A void that was cut off when a factor was made has no row there: once it opens, another is made.
#[test]
fn what_opens_again_needs_another_factor() {
    let lattice = Network::cubic_from_diameters([8, 8, 8], vec![1.0; 3 * 512], 1.0).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap();
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    let mut flow = Flow::new(&network);
    let close = |blocked: &mut BitVec, void: u32, is: bool| {
        network.exits(void).for_each(|c| network.set_blocked(blocked, c, is));
    };
    close(&mut blocked, 200, true);
    flow.solve(&network, &blocked).unwrap();
    close(&mut blocked, 300, true);
    flow.solve(&network, &blocked).unwrap();
    assert!(flow.kept.as_ref().is_some_and(|kept| kept.closed > 0), "twelve exits in some 3000");
    close(&mut blocked, 200, false);
    flow.solve(&network, &blocked).unwrap();
    assert_eq!(flow.kept.as_ref().unwrap().closed, 0);
    let mut afresh = Flow::new(&network);
    afresh.solve(&network, &blocked).unwrap();
    for (v, (kept, anew)) in flow.pressure.iter().zip(&afresh.pressure).enumerate() {
        assert!((kept - anew).abs() < 1e-8, "void {v}: {kept} for {anew}");
    }
}

/// Each exit weighs by what flows out of it, and nothing where water flows in, or where it is blocked,
/// though it leaks.
#[test]
fn exits_weigh_by_what_leaves_through_them() {
    let diameters = (0..3 * 6 * 6 * 6).map(|c| 1.0 + (c * 7919 % 100) as f32 / 100.0);
    let lattice = Network::cubic_from_diameters([6, 6, 6], diameters.collect(), 1.0).unwrap();
    for rule in [ExitRule::Flux, ExitRule::AreaAlongFlow] {
        let mut network = lattice.undirected_lattice(rule, 0.1, 4.0).unwrap();
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        (0..network.constrictions()).step_by(5).for_each(|c| network.set_blocked(&mut blocked, c, true));
        let mut flow = Flow::new(&network);
        flow.solve(&network, &blocked).unwrap();
        flow.direct(&mut network);
        let mut seen = [0; 3];
        for void in 0..network.voids() as u32 {
            for c in network.exits(void) {
                let (flux, area) = (flow.flux(void, c), f64::from(network.diameters()[c]).powi(2));
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
