//! The flow through small networks beside that of exact arithmetic, whole numbers of any length: conductances over
//! many orders, the clean network and what is left of it as constrictions close one after another.

use std::sync::Arc;

use bitvec::vec::BitVec;
use num_bigint::BigInt;
use voidwalk::Gradation;
use voidwalk::network::{END, ExitRule, Flow, FlowError, Network, NetworkColumns};
use voidwalk::run::{Callbacks, NetworkWalk, walk_networks};

/// What flows, as whole numbers: a flux is its entry over `whole`, in units of 2^`unit`.
struct Exact {
    through: BigInt,
    flux: Vec<BigInt>,
    whole: BigInt,
    unit: i32,
}

/// Mantissa and power of two of a number.
fn parts(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let (power, mantissa) = ((bits >> 52) as i32, bits & ((1 << 52) - 1));
    assert!(power > 0 && value > 0.0, "{value} is a normal number above 0");
    (mantissa | 1 << 52, power - 1075)
}

/// Pressures by elimination without fractions (Bareiss): each entry stays a determinant, so every division is exact.
fn exact(network: &Network, blocked: &BitVec) -> Exact {
    let reservoir = network.reservoir().unwrap();
    let open = |c: usize| !blocked[c] && network.diameters()[c] > 0.0 && network.conductance(c) > 0.0;
    let exits = |void: u32| network.exits(void).filter(|&c| open(c));
    // One for all that is blocked.
    let conductances = (0..network.constrictions()).map(|c| network.conductance(c)).filter(|&g| g > 0.0);
    let unit = conductances.map(|g| parts(g).1).min().unwrap();
    let whole = |c: usize| {
        let (mantissa, power) = parts(network.conductance(c));
        BigInt::from(mantissa) << (power - unit) as usize
    };
    // Rows of the voids that water reaches from the reservoir.
    let (mut row, mut found) = (vec![usize::MAX; network.voids()], vec![]);
    let mut ahead: Vec<u32> = exits(reservoir).map(|c| network.targets()[c]).collect();
    while let Some(void) = ahead.pop() {
        if void != END && void != reservoir && row[void as usize] == usize::MAX {
            row[void as usize] = found.len();
            found.push(void);
            ahead.extend(exits(void).map(|c| network.targets()[c]));
        }
    }
    let n = found.len();
    let mut a = vec![vec![BigInt::ZERO; n + 1]; n];
    for (i, &void) in found.iter().enumerate() {
        for c in exits(void) {
            a[i][i] += whole(c);
            match network.targets()[c] {
                END => {}
                to if to == reservoir => a[i][n] += whole(c),
                to => a[i][row[to as usize]] -= whole(c),
            }
        }
    }
    let mut before = BigInt::from(1);
    for k in 0..n {
        for i in k + 1..n {
            for j in k + 1..=n {
                let minor = &a[i][j] * &a[k][k] - &a[i][k] * &a[k][j];
                a[i][j] = minor / &before;
            }
        }
        before = a[k][k].clone();
    }
    let mut pressure = vec![BigInt::ZERO; n];
    for k in (0..n).rev() {
        let known: BigInt = (k + 1..n).map(|j| &a[k][j] * &pressure[j]).sum();
        pressure[k] = (&before * &a[k][n] - known) / &a[k][k];
    }
    let at = |void: u32| match void {
        END => BigInt::ZERO,
        void if void == reservoir => before.clone(),
        void => row.get(void as usize).and_then(|&row| pressure.get(row)).cloned().unwrap_or_default(),
    };
    let mut flux = vec![BigInt::ZERO; network.constrictions()];
    for void in std::iter::once(reservoir).chain(found.iter().copied()) {
        for c in exits(void) {
            flux[c] = whole(c) * (at(void) - at(network.targets()[c]));
        }
    }
    let through = exits(reservoir).map(|c| flux[c].clone()).sum();
    Exact { through, flux, whole: before, unit }
}

/// How far a flow is from an exact one, over another, in parts of 2^-60.
fn off(found: f64, exact: &BigInt, over: &BigInt, of: &Exact) -> BigInt {
    let found = if found == 0.0 {
        BigInt::ZERO
    } else {
        let (mantissa, power) = parts(found.abs());
        let mantissa = BigInt::from(mantissa) * &of.whole * if found < 0.0 { -1 } else { 1 };
        let by = power - of.unit;
        if by >= 0 { mantissa << by as usize } else { mantissa >> -by as usize }
    };
    let difference = found - exact;
    let size = if difference < BigInt::ZERO { -difference } else { difference };
    (size << 60) / over
}

fn within(part: f64) -> BigInt {
    BigInt::from((part * (1u64 << 60) as f64) as u64)
}

struct Draw(u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A graph of 3 to 9 voids, with diameters over so many orders, and with conductances over so many where there are
/// any; `None` where nothing leads through.
fn graph(draw: &mut Draw, orders: f64, conductances: Option<f64>, rho: f64) -> Option<(Network, Vec<u32>)> {
    let voids = 3 + draw.below(7);
    let conns: Vec<[i64; 2]> = (0..voids + draw.below(2 * voids))
        .map(|_| [draw.below(voids) as i64, draw.below(voids) as i64])
        .filter(|[a, b]| a != b)
        .collect();
    let diameter: Vec<f64> = conns.iter().map(|_| 10f64.powf(-orders * draw.unit())).collect();
    let conductance: Option<Vec<f64>> =
        conductances.map(|orders| conns.iter().map(|_| 10f64.powf(orders * (draw.unit() - 0.5))).collect());
    let outlets: &[u32] = if draw.below(2) == 0 { &[1] } else { &[1, 2] };
    let columns = NetworkColumns {
        voids,
        conns: &conns,
        diameter_mm: &diameter,
        conductance: conductance.as_deref(),
        inlets: &[0],
        outlets,
        rule: ExitRule::Flux,
        rho,
        unit_mm: 1.0,
    };
    Network::from_columns(&columns).ok()
}

/// Some 290 graphs in each of seven ranges, 2,000 in all, clean and as they close: every flow, and every flux, is known
/// to a millionth of the clean flow, and close solutions know every flux to a hundred-millionth of what passes. None is refused: so
/// small networks are solved without subtraction where conjugate gradients do not tell.
#[test]
fn no_flow_of_a_small_network_is_wrong_or_refused() {
    let mut draw = Draw(34);
    let ranges = [
        (1.0, None),
        (2.0, None),
        (3.0, None),
        (6.0, None),
        (1.0, Some(12.0)),
        (1.0, Some(16.0)),
        (1.0, Some(40.0)),
    ];
    for (orders, conductances) in ranges {
        let (mut networks, mut known, mut refused) = (0, 0, 0);
        while networks < 2000 / ranges.len() + 1 {
            let Some((network, exit)) = graph(&mut draw, orders, conductances, 0.0) else { continue };
            networks += 1;
            let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
            let mut flow = Flow::new(&network);
            let clean = exact(&network, &blocked);
            let mut order: Vec<u32> = exit.iter().copied().filter(|&c| c != u32::MAX).collect();
            (1..order.len()).for_each(|i| order.swap(i, draw.below(i + 1)));
            let mut found = flow.solve(&network, &blocked);
            for closes in order.into_iter().map(Some).chain([None]) {
                let now = exact(&network, &blocked);
                let clean_now = &clean.through * &now.whole / &clean.whole;
                match &found {
                    Ok(found) => {
                        known += 1;
                        let off = off(found.conductance, &now.through, &clean_now, &now);
                        assert!(
                            off <= within(1e-6),
                            "{orders} {conductances:?}: {found:?} is off by {off} / 2^60"
                        );
                        assert_eq!(found.conductance == 0.0, now.through == BigInt::ZERO);
                        let voids = if found.conductance > 0.0 { network.voids() as u32 } else { 0 };
                        for c in (0..voids).flat_map(|void| network.exits(void)).filter(|&c| !blocked[c]) {
                            assert!(
                                self::off(flow.flux(c), &now.flux[c], &clean_now, &now) <= within(1e-6),
                                "{found:?}"
                            );
                        }
                    }
                    Err(FlowError::Unresolved { .. } | FlowError::NotConverged { .. }) => refused += 1,
                }
                let mut closely = Flow::new(&network);
                if now.through > BigInt::ZERO {
                    closely.solve_closely(&network, &blocked).unwrap();
                    for void in 0..network.voids() as u32 {
                        for c in network.exits(void).filter(|&c| !blocked[c]) {
                            let flux = closely.flux(c);
                            let off = off(flux, &now.flux[c], &now.through, &now);
                            assert!(
                                off <= within(1.1e-8),
                                "{orders} {conductances:?}: {flux} off by {off} / 2^60"
                            );
                        }
                    }
                }
                let Some(closes) = closes else { break };
                network.set_blocked(&mut blocked, closes as usize, true);
                found = flow.solve(&network, &blocked);
            }
        }
        println!(
            "{orders} orders of diameters, {conductances:?} of conductances: {known} known, {refused} refused"
        );
        assert!(known > 1400 && refused == 0, "{known} {refused}");
    }
}

/// A narrow way beside a long one that is a little wider, and blind constrictions a hundred times as wide, which set
/// what the way in conducts: once the narrow one is closed, what is left is no more than 1e-10 of that. It is 1.1 % of
/// what there was, as chains in series and side by side say, and all that comes after the first particle leaves by it.
#[test]
fn an_open_way_is_no_clogged_filter() {
    const LONG: usize = 100;
    const NARROW: f64 = 0.009;
    let (mut conns, mut diameter) = (vec![[0, 1]], vec![NARROW]);
    for i in 0..LONG as i64 {
        let at = |i: i64| {
            if i == 0 {
                0
            } else if i == LONG as i64 {
                1
            } else {
                i + 1
            }
        };
        conns.push([at(i), at(i + 1)]);
        diameter.push(1.03 * NARROW);
    }
    for blind in 0..1000 {
        conns.push([0, LONG as i64 + 1 + blind]);
        diameter.push(1.0);
    }
    let columns = NetworkColumns {
        voids: LONG + 1001,
        conns: &conns,
        diameter_mm: &diameter,
        conductance: None,
        inlets: &[0],
        outlets: &[1],
        rule: ExitRule::Flux,
        rho: 0.0,
        unit_mm: 1.0,
    };
    let (network, _) = Network::from_columns(&columns).unwrap();
    let long = 1.03f64.powi(4) / LONG as f64;
    let expected = long / (1.0 + long);
    let plan =
        NetworkWalk { replicates: 2, ..NetworkWalk::new(Gradation::single(1.015 * NARROW).unwrap(), 1000) };
    let outcome = walk_networks(&[Arc::new(network)], &plan, &Callbacks::default()).unwrap();
    for walked in &outcome.replicates {
        for run in &walked.result.replicate.runs {
            assert!((run.k_over_k0.unwrap() - expected).abs() < 1e-6, "{:?} for {expected}", run.k_over_k0);
            assert!(run.eroded_mass_fraction > 0.95, "{run:?}");
        }
    }
}
