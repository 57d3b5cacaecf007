//! Openings beside the particles that block constrictions, where their numbers are known exactly.

use std::collections::BTreeSet;
use std::sync::Arc;

use voidwalk::constrictions::{Curve, CurveUnit};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{ExitRule, Link, LinkEnd, LinkedVoids, Network};
use voidwalk::store::checkpoint::{Identity, Label, newest, save};
use voidwalk::walk::{
    Arching, Clogged, Isa, Law, Narrowing, SavedState, SizeClasses, State, Supply, Walk, WalkControl,
    residual_opening,
};

fn of(csv: &str) -> Network {
    Network::from_csv(format!("from,to,diameter_mm\nstart,0,\n{csv}").as_bytes(), "n.csv", 1.0).unwrap()
}

/// `n` particles of one size, in so many increments.
fn single(size: f64, n: u64, increments: u64) -> Supply {
    let sampler = SizeSampler::new(&Gradation::single(size).unwrap(), 1.0).unwrap();
    Supply::new(sampler, n, increments).leaving_openings(true)
}

fn walk(network: &Network, supply: &Supply, clogged: Clogged, (seed, run): (u64, u64)) -> State {
    let mut state = State::new(network, supply, SizeClasses::logarithmic(0.1, 4.0, 8), clogged, seed, run);
    Walk::new(network, supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
    let t = &state.tally;
    let everywhere = t.eroded + t.retained_in_constrictions + t.retained_in_voids + t.trapped;
    assert_eq!((t.inserted, t.moving), (everywhere, 0));
    state
}

/// What a particle leaves of a constriction, in the precision of the walk.
fn left_by(constriction: f64, particle: f64) -> f32 {
    residual_opening(constriction, f64::from(particle as f32)) as f32
}

fn first(network: &Network, supply: &Supply) -> State {
    walk(network, supply, Clogged::none(network), (1, 1))
}

fn width(of: &State, exit: usize) -> f32 {
    of.openings.as_ref().unwrap().widths[exit]
}

/// What blocks it leaves an opening that finer particles pass; coarser ones narrow it, and are stopped.
#[test]
fn one_constriction_is_narrowed_by_the_finest_particle_that_it_stopped() {
    let network = of("0,end,1\n");
    let coarse = first(&network, &single(1.2, 10, 2));
    let left = left_by(1.0, 1.2);
    assert_eq!((coarse.tally.retained_in_constrictions, coarse.tally.blocked), (10, 1));
    assert_eq!(width(&coarse, 0), left);
    assert!((0.44..0.46).contains(&left), "{left}");
    let narrowings = &coarse.openings.as_ref().unwrap().history;
    assert_eq!((narrowings.len(), narrowings[0].before, narrowings[0].after), (1, 1.0, left));
    let clogged = coarse.into_clogged();
    // One as fine as the opening passes, and does nothing to it.
    let fine = walk(&network, &single(f64::from(left), 50, 5), clogged.clone(), (1, 2));
    assert_eq!((fine.tally.eroded, width(&fine, 0)), (50, left));
    assert!(fine.openings.as_ref().unwrap().history.is_empty());
    // One between the opening and the constriction does not.
    let between = walk(&network, &single(0.5, 50, 5), clogged, (1, 2));
    assert_eq!((between.tally.eroded, between.tally.retained_in_constrictions), (0, 50));
    assert_eq!((between.tally.blocked, between.history.len()), (1, 0));
    assert_eq!(width(&between, 0), left_by(1.0, 0.5));
    // Nor does a third run of coarse ones make it wider.
    let again = walk(&network, &single(1.2, 50, 5), between.into_clogged(), (1, 3));
    assert_eq!(width(&again, 0), left_by(1.0, 0.5));
}

/// Several sizes at once: the finest of those that were stopped, whatever came first.
#[test]
fn of_many_in_one_increment_the_finest_counts() {
    let network = of("0,end,1\n");
    let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.8, 2.0).unwrap(), 1.0).unwrap();
    let supply = Supply::new(sampler, 40_000, 1).leaving_openings(true);
    let state = first(&network, &supply);
    let narrowings = &state.openings.as_ref().unwrap().history;
    assert_eq!(narrowings.len(), 1);
    // Of 40 000 the finest above 1 lies within a hundredth of it, over three chunks.
    let [least, most] = [1.0, 1.01].map(|d| residual_opening(1.0, d) as f32);
    assert!((least..most).contains(&narrowings[0].after), "{narrowings:?}");
    assert_eq!(state.tally.eroded + state.tally.retained_in_constrictions, 40_000);
    assert!(state.tally.eroded > 1000);
}

/// In a row, the opening that is left at the narrowest place decides.
#[test]
fn a_chain_passes_what_its_narrowest_opening_passes() {
    let network = of("0,1,3\n1,2,2\n2,end,1\n");
    let clogged = first(&network, &single(1.5, 5, 1)).into_clogged();
    let left = left_by(1.0, 1.5);
    assert_eq!(clogged.widths, [3.0, 2.0, left]);
    let pass = walk(&network, &single(f64::from(left) - 1e-4, 100, 10), clogged.clone(), (1, 2));
    assert_eq!((pass.tally.eroded, pass.tally.particle_moves), (100, 300));
    let stop = walk(&network, &single(f64::from(left) + 1e-4, 100, 10), clogged, (1, 2));
    assert_eq!((stop.tally.eroded, stop.tally.particle_moves), (0, 200));
    assert_eq!(stop.retained_in_constrictions, [0, 0, 100]);
}

/// At a fork a blocked exit has three times the area of its opening, until those are narrowed as well.
#[test]
fn at_a_fork_particles_choose_by_the_area_that_is_left() {
    // The second way is one move longer, so that moves tell which way was taken.
    let network = of("0,end,1\n0,1,1.3\n1,end,9\n");
    let clogged = first(&network, &single(1.2, 100, 10)).into_clogged();
    let left = left_by(1.0, 1.2);
    assert_eq!(clogged.widths, [left, 1.3, 9.0]);
    let by = |left: f32| {
        let area = 3.0 * f64::from(left).powi(2);
        area / (area + 1.3 * 1.3)
    };
    let (n, share) = (100_000u64, by(left));
    let is_near = |found: u64, share: f64| {
        let error = (share * (1.0 - share) * n as f64).sqrt();
        assert!((found as f64 - share * n as f64).abs() < 5.0 * error, "{found}, {share}");
    };
    let fine = walk(&network, &single(0.3, n, 10), clogged.clone(), (5, 2));
    assert_eq!(fine.tally.eroded, n);
    is_near(2 * n - fine.tally.particle_moves, share);
    // All at once, before anything is narrowed: as many are stopped as choose the opening.
    let once = walk(&network, &single(0.6, n, 1), clogged, (5, 2));
    is_near(once.tally.retained_in_constrictions, share);
    let narrower = left_by(1.0, 0.6);
    assert_eq!(width(&once, 0), narrower);
    // And then as many as choose what is left of it.
    let then = walk(&network, &single(0.6, n, 1), once.into_clogged(), (5, 3));
    is_near(then.tally.retained_in_constrictions, by(narrower));
    assert!(by(narrower) < 0.75 * share);
}

/// One size without limit blocks what it blocks where constrictions close; each is as wide as the formula says,
/// and no particle is without an exit.
#[test]
fn one_size_narrows_each_that_it_reaches() {
    let curve = Curve::from_points(&[(0.0, 0.1), (50.0, 0.2), (100.0, 0.5)], CurveUnit::Mm).unwrap();
    let network = Network::cubic([5, 6, 3], &curve, 1.0, 4).unwrap();
    for d in [0.13, 0.16, 0.19] {
        let state = first(&network, &single(d, 200_000, 20));
        let blocked: Vec<u32> = state.blocked.iter_ones().map(|c| c as u32).collect();
        assert_eq!(blocked, network.blocked_by_one_size(d as f32));
        assert!(blocked.len() > 30, "{}", blocked.len());
        let is_blocked: BTreeSet<u32> = blocked.into_iter().collect();
        for (c, &whole) in (0u32..).zip(network.diameters()) {
            let wanted = if is_blocked.contains(&c) { left_by(f64::from(whole), d) } else { whole };
            assert_eq!(width(&state, c as usize), wanted);
        }
        assert_eq!(state.tally.retained_in_voids, 0);
    }
}

/// As many pass before an arch closes a constriction as where blocked ones are closed; then the opening beside
/// a particle of the arch stops the others, which were left without an exit.
#[test]
fn an_arch_leaves_the_opening_beside_one_of_its_particles() {
    let network = of("0,end,2\n");
    let law = Arc::new(Arching::new(Law::named("zuriguel-2005").unwrap(), 0.2));
    let mut arched = 0;
    for seed in 1..200 {
        let [open, closed] = [true, false].map(|is| {
            let supply = single(1.0, 60, 60).arching_by(Some(law.clone())).leaving_openings(is);
            walk(&network, &supply, Clogged::none(&network), (seed, 1))
        });
        assert_eq!(open.tally.eroded, closed.tally.eroded);
        assert_eq!(closed.tally.arches, closed.tally.blocked);
        assert_eq!(open.tally.retained_in_constrictions, 60 - open.tally.eroded);
        assert_eq!(closed.tally.retained_in_voids, 60 - closed.tally.eroded - closed.tally.arches);
        if open.tally.blocked == 1 {
            arched += 1;
            assert_eq!(width(&open, 0), left_by(2.0, 1.0));
            assert_eq!(open.tally.arches, 1);
        }
    }
    assert!(arched > 150, "{arched}");
}

/// Three resistors in a row, of which one is blocked: what is left of the permeability.
#[test]
fn water_passes_a_blocked_constriction_by_its_openings() {
    let size = [1.0f32, 2.0, 1.5];
    let conductance = size.map(|d| f64::from(d).powi(4));
    let ends = [LinkEnd::Outside, LinkEnd::Void(0), LinkEnd::Void(1), LinkEnd::Outside];
    let links: Vec<Link> = (0..3)
        .map(|i| Link {
            from: ends[i],
            to: ends[i + 1],
            diameter: size[i],
            conductance: conductance[i],
            rise: 1.0,
        })
        .collect();
    let voids =
        LinkedVoids { layer: vec![0, 1], unit_mm: 1.0, rule: ExitRule::Flux, ..LinkedVoids::default() };
    let network = Network::linked(voids, &links).unwrap();
    let supply = single(1.7, 20, 4);
    let mut state =
        State::new(&network, &supply, SizeClasses::logarithmic(1.0, 2.0, 2), Clogged::none(&network), 3, 1);
    let mut walk = Walk::new(&network, &supply, &state);
    walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
    let k = walk.end(&state).unwrap().1.unwrap().solutions;
    // The inlet stops them all.
    let kept = 3.0 * residual_opening(1.0, f64::from(1.7f32)).powi(4);
    let resistance = |of: f64| of + 1.0 / conductance[1] + 1.0 / conductance[2];
    let wanted = resistance(1.0) / resistance(1.0 / kept);
    let last = k.last().unwrap().k_over_k0;
    assert!((last / wanted - 1.0).abs() < 1e-6, "{last} and not {wanted}");
    assert!(k[0].k_over_k0 == 1.0 && (0.1..0.9).contains(&last));
    assert_eq!((state.tally.retained_in_constrictions, state.tally.blocked), (20, 1));
}

/// A filter that holds conducts by its openings, and is sealed where they are closed.
#[test]
fn a_filter_that_holds_is_not_sealed() {
    let curve = Curve::from_points(&[(0.0, 0.15), (100.0, 0.25)], CurveUnit::Mm).unwrap();
    let lattice = Network::cubic([5, 5, 8], &curve, 1.0, 2).unwrap();
    let network = lattice.undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap();
    let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.1, 2.5).unwrap(), 1.0).unwrap();
    let [open, closed] = [true, false].map(|is| {
        let supply = Supply::new(sampler.clone(), 40_000, 20).leaving_openings(is);
        let mut state = State::new(
            &network,
            &supply,
            SizeClasses::logarithmic(0.1, 0.6, 4),
            Clogged::none(&network),
            3,
            1,
        );
        let mut walk = Walk::new(&network, &supply, &state);
        walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
        walk.end(&state).unwrap().1.unwrap().solutions.last().unwrap().k_over_k0
    });
    assert_eq!(closed, 0.0);
    assert!((1e-3..0.9).contains(&open), "{open}");
}

/// No arches, and arches in a dense and a thin suspension.
fn laws() -> Vec<Option<Arching>> {
    let law = Law::named("marin-2018").unwrap();
    vec![None, Some(Arching::new(law, 0.2)), Some(Arching::new(law, 0.02))]
}

/// A graded base that blocks, narrows and arches.
fn graded(arches: &Option<Arching>, n: u64) -> Supply {
    let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.05, 2.5).unwrap(), 1.0).unwrap();
    Supply::new(sampler, n, 25).arching_by(arches.clone().map(Arc::new)).leaving_openings(true)
}

fn networks() -> [Network; 2] {
    let curve = Curve::from_points(&[(0.0, 0.1), (100.0, 0.4)], CurveUnit::Mm).unwrap();
    let lattice = Network::cubic([6, 6, 8], &curve, 1.0, 9).unwrap();
    let flowing = lattice.undirected_lattice(ExitRule::Flux, 0.0, 4.0).unwrap();
    [lattice, flowing]
}

/// All that results follow from.
fn shown(state: &State) -> String {
    format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {}",
        state.tally,
        state.history,
        state.openings,
        state.retained_in_constrictions,
        state.eroded_sizes,
        state.retained_sizes,
        state.increment
    )
}

#[test]
fn threads_and_instructions_change_no_bit() {
    for network in &networks() {
        for arches in &laws() {
            let supply = graded(arches, 60_000);
            let run = |threads: usize, isa: Option<Isa>| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let classes = SizeClasses::logarithmic(0.05, 0.4, 8);
                    let mut state = State::new(network, &supply, classes, Clogged::none(network), 5, 1);
                    let mut walk = Walk::new(network, &supply, &state);
                    if let Some(isa) = isa {
                        walk = walk.with_isa(isa);
                    }
                    walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
                    shown(&state)
                })
            };
            let one = run(1, None);
            for threads in [2, 3, 7] {
                assert_eq!(run(threads, None), one, "{threads} threads");
            }
            for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
                assert_eq!(run(2, Some(isa)), one, "{isa:?}");
            }
        }
    }
}

/// Both runs, the second of which begins on the openings that the first left, broken off after every increment.
#[test]
fn a_walk_goes_on_from_every_increment() {
    const N: u64 = 10_000;
    let root = tempfile::tempdir().unwrap();
    let [lattice, flowing] = &networks();
    let cases = laws().into_iter().map(|law| (lattice, law)).chain([(flowing, None)]);
    for (kind, (network, arches)) in cases.enumerate() {
        let supply = graded(&arches, N);
        let mut clogged = Clogged::none(network);
        let mut narrowed = [0; 2];
        for run in [1, 2] {
            let fresh = |clogged: Clogged| {
                State::new(network, &supply, SizeClasses::logarithmic(0.05, 0.4, 8), clogged, 5, run)
            };
            let at = |increment: u64| root.path().join(format!("{kind}-{run}-{increment}"));
            let mut whole = fresh(clogged.clone());
            Walk::new(network, &supply, &whole)
                .run(&mut whole, &mut |state| {
                    let label = Label { generation: state.increment, ..Label::default() };
                    std::fs::create_dir(at(state.increment)).unwrap();
                    save(&at(state.increment), "x", &label, &SavedState::new(state).sections()).unwrap();
                    WalkControl::Continue
                })
                .unwrap();
            narrowed[run as usize - 1] = whole.openings.as_ref().unwrap().history.len();
            for increment in 1..whole.increment {
                let saved = newest(&at(increment), "x", &Identity::default()).unwrap().0.unwrap();
                // What the constrictions were when the run began is in the checkpoint as well.
                let mut state = fresh(clogged.blocked.clone().into());
                state.restore(network, &supply, &saved).unwrap();
                Walk::new(network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
                assert_eq!(shown(&state), shown(&whole), "run {run}, from increment {increment}");
            }
            // A walk in which blocked constrictions are closed is another.
            let saved = newest(&at(5), "x", &Identity::default()).unwrap().0.unwrap();
            let closed = graded(&arches, N).leaving_openings(false);
            let classes = SizeClasses::logarithmic(0.05, 0.4, 8);
            let mut state = State::new(network, &closed, classes, Clogged::none(network), 5, run);
            assert!(state.restore(network, &closed, &saved).is_err());
            clogged = whole.into_clogged();
        }
        assert!(narrowed[0] > 50 && narrowed[1] > 0, "{narrowed:?}");
    }
}

/// Two narrowings of one constriction.
fn again(history: &[Narrowing]) -> (usize, usize) {
    let earlier = |after: usize| {
        history[..after].iter().position(|before| before.constriction == history[after].constriction)
    };
    (0..history.len()).find_map(|after| Some((earlier(after)?, after))).unwrap()
}

/// Checksums that are right do not make openings of no walk: they are refused.
#[test]
fn openings_of_no_walk_are_refused() {
    let root = tempfile::tempdir().unwrap();
    let [network, _] = networks();
    let supply = graded(&None, 2000);
    let fresh = || {
        let classes = SizeClasses::logarithmic(0.05, 0.4, 8);
        State::new(&network, &supply, classes, Clogged::none(&network), 5, 1)
    };
    type Forge = fn(&mut State);
    let forgeries: [(bool, Forge); 12] = [
        (true, |_| ()),
        (false, |s| s.openings.as_mut().unwrap().widths[0] = f32::NAN),
        (false, |s| s.openings.as_mut().unwrap().widths[0] = 9.0),
        (false, |s| s.openings.as_mut().unwrap().history[0].constriction = 1 << 30),
        (false, |s| s.openings.as_mut().unwrap().history[0].increment = 99),
        (false, |s| s.openings.as_mut().unwrap().history[0].after = f32::NAN),
        (false, |s| s.openings = None),
        // Beside the finest particle of the base, 0.05, the finest constriction, 0.1, leaves 0.026.
        (false, |s| {
            let c = s.openings.as_ref().unwrap().history.last().unwrap().constriction as usize;
            let openings = s.openings.as_mut().unwrap();
            openings.history.last_mut().unwrap().after = 0.02;
            openings.widths[c] = 0.02;
        }),
        // Not what the last narrowing left, of another before, at another time.
        (false, |s| {
            let openings = s.openings.as_mut().unwrap();
            let last = *openings.history.last().unwrap();
            openings.widths[last.constriction as usize] = last.before;
        }),
        (false, |s| {
            let history = &mut s.openings.as_mut().unwrap().history;
            let (before, after) = again(history);
            history[after].before = history[before].before;
        }),
        (false, |s| s.openings.as_mut().unwrap().history.last_mut().unwrap().increment = 1),
        (false, |s| s.openings.as_mut().unwrap().history.reverse()),
    ];
    for (at, (is_whole, forge)) in forgeries.into_iter().enumerate() {
        let folder = root.path().join(at.to_string());
        std::fs::create_dir(&folder).unwrap();
        let mut state = fresh();
        let mut walk = Walk::new(&network, &supply, &state);
        (0..8).for_each(|_| walk.increment(&mut state).unwrap());
        forge(&mut state);
        save(&folder, "x", &Label::default(), &SavedState::new(&state).sections()).unwrap();
        let saved = newest(&folder, "x", &Identity::default()).unwrap().0.unwrap();
        assert_eq!(fresh().restore(&network, &supply, &saved).is_ok(), is_whole, "{at}");
    }
}
