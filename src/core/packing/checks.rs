//! Checks of the contact law and the time integration against exact results.

use super::motion::LONGEST_MOVE;
use super::settings::{Contact, PackingError, Settings, critical_step, stability};
use super::state::{Compression, Energy};
use super::{Cell, Packing, draw, random_start, uniform};
use crate::gradation::Gradation;
use std::f64::consts::PI;

const STIFFNESS: f64 = 1e4;

fn packing(edge: f64, grains: &[[f64; 4]]) -> Packing {
    Packing::from_grains(Cell::Periodic([edge; 3]), grains.iter().copied())
}

fn compression(edge: f64, grains: &[[f64; 4]], settings: &Settings) -> Compression {
    Compression::new(&packing(edge, grains), settings).unwrap()
}

/// Draws grains of a linear gradation of this Cu, and places them at random.
fn drawn(cu: f64, settings: &Settings) -> Compression {
    let filter = Gradation::linear_from_d0(1.0, cu).unwrap();
    let start = random_start(&draw(&filter, settings.grains, 1), settings).unwrap();
    Compression::new(&start, settings).unwrap()
}

/// Index in memory of the grain of this rank.
fn place(c: &Compression, rank: u32) -> usize {
    c.rank.iter().position(|&r| r == rank).unwrap()
}

fn elastic(contact: Contact) -> Settings {
    Settings {
        contact,
        friction: 0.0,
        final_friction: 0.0,
        restitution: 1.0,
        drag: 0.0,
        settling_drag: 0.0,
        clip_tension: false,
        stiffness_ratio: 1e-2,
        ..Settings::default()
    }
}

fn rough(friction: f64) -> Settings {
    Settings { friction, final_friction: friction, ..elastic(Contact::Hertz) }
}

/// Takes steps without servo and protocol.
fn free(c: &mut Compression, steps: u64) {
    for _ in 0..steps {
        c.advance_once(None).unwrap();
    }
}

/// Two grains of diameter 1 that just touch and approach along x at the relative speed `speed`.
fn head_on(settings: &Settings, speed: f64, step: f64) -> Compression {
    let settings = Settings { step: Some(step), ..settings.clone() };
    let mut c = compression(8.0, &[[3.5, 4.0, 4.0, 1.0], [4.5, 4.0, 4.0, 1.0]], &settings);
    for (p, v) in c.position.iter().zip(&mut c.velocity) {
        v[0] = if p[0] < 0.5 { 0.5 * speed } else { -0.5 * speed };
    }
    c
}

fn distance(c: &Compression) -> f64 {
    (c.position[0][0] - c.position[1][0]).abs() * c.now.cell
}

fn approach(c: &Compression) -> f64 {
    let (a, b) = if c.position[0][0] < c.position[1][0] { (0, 1) } else { (1, 0) };
    c.velocity[a][0] - c.velocity[b][0]
}

/// Time from touch to separation, with interpolated ends, and the remaining fraction of the approach speed.
fn collide(mut c: Compression) -> (f64, f64) {
    let before = approach(&c);
    let mut last = distance(&c);
    for _ in 0..1_000_000 {
        free(&mut c, 1);
        let now = distance(&c);
        if now > 1.0 && last <= 1.0 && c.now.steps > 2 {
            let late = (now - 1.0) / (now - last) * c.now.step;
            free(&mut c, 3);
            return (c.now.time - 3.0 * c.now.step - late, -approach(&c) / before);
        }
        last = now;
    }
    panic!("no separation");
}

#[test]
fn linear_head_on_is_exact_to_second_order() {
    let settings = elastic(Contact::Linear(STIFFNESS));
    let reduced = PI / 12.0;
    let omega = (STIFFNESS / reduced).sqrt();
    let duration = PI / omega;
    let (measured, kept) = collide(head_on(&settings, 0.01, duration / 400.0));
    assert!((measured / duration - 1.0).abs() < 1e-4, "{measured} {duration}");
    assert!((kept - 1.0).abs() < 1e-4);
    let error = |steps: u64| {
        let mut c = head_on(&settings, 0.01, 0.4 * duration / steps as f64);
        free(&mut c, steps);
        let momentum = c.velocity[0][0] + c.velocity[1][0];
        assert!(momentum.abs() < 1e-14);
        (1.0 - distance(&c) - 0.01 / omega * libm::sin(0.4 * PI)).abs()
    };
    for steps in [20, 40, 80] {
        let ratio = error(steps) / error(2 * steps);
        assert!((3.8..4.2).contains(&ratio), "{steps}: {ratio}");
    }
}

#[test]
fn restitution_is_kept_at_every_speed() {
    for contact in [Contact::Linear(STIFFNESS), Contact::Hertz] {
        for speed in [1e-3, 1e-2] {
            for e in [0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99] {
                let undamped = elastic(contact);
                let duration = duration(contact, &undamped, speed);
                let settings = Settings { restitution: e, ..undamped };
                let ratio = -libm::log(e) / (PI * PI + libm::log(e) * libm::log(e)).sqrt();
                for parts in [50.0, 200.0, 800.0, 3200.0] {
                    // The damping force begins and ends within a step: a first-order error.
                    let bound =
                        5.0 * PI * ratio / (1.0 - ratio * ratio).sqrt() / parts + 10.0 / (parts * parts);
                    let bound = if e >= 0.9 && parts == 50.0 { 0.005f64 } else { bound };
                    let error = collide(head_on(&settings, speed, duration / parts)).1 / e - 1.0;
                    assert!(error.abs() < bound, "{contact:?} {speed} {e} {parts}: {error} {bound}");
                }
            }
        }
    }
}

fn duration(contact: Contact, settings: &Settings, speed: f64) -> f64 {
    let (mass, radius): (f64, f64) = (PI / 12.0, 0.25);
    match contact {
        Contact::Linear(k) => PI * (mass / k).sqrt(),
        Contact::Hertz => {
            let shear = settings.shear_modulus_gpa * settings.stiffness_ratio * 1e6 / settings.pressure_kpa;
            // E* of two equal grains is G / (1 - nu).
            let modulus = shear / (1.0 - settings.poisson_ratio);
            2.87 * libm::pow(mass * mass / (radius * modulus * modulus * speed), 0.2)
        }
    }
}

#[test]
fn hertz_contact_time() {
    let settings = elastic(Contact::Hertz);
    for speed in [1e-3, 1e-2] {
        let expected = duration(Contact::Hertz, &settings, speed);
        let (measured, kept) = collide(head_on(&settings, speed, expected / 500.0));
        assert!((measured / expected - 1.0).abs() < 0.01, "{measured} {expected}");
        assert!((kept - 1.0).abs() < 1e-3);
    }
}

/// A small grain pressed against a large one that turns at constant rate rolls and slides first, and
/// ends in rolling without sliding. The friction force never exceeds its limit.
#[test]
fn coulomb_limit_holds_for_spring_and_damping_together() {
    let settings = Settings { restitution: 0.6, clip_tension: true, ..rough(0.4) };
    let mut c = compression(12.0, &[[3.0, 6.0, 6.0, 3.0], [4.99, 6.0, 6.0, 1.0]], &settings);
    let large = place(&c, 0);
    c.spin[large][2] = 3.0;
    let mut slid = false;
    for _ in 0..400 {
        free(&mut c, 1);
        for chunk in &c.chunks {
            for m in &chunk.memory {
                let spring = (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]).sqrt();
                assert!(spring <= 0.4 * c.now.mean_normal * (1.0 + 1e-12), "{spring} {}", c.now.mean_normal);
                slid |= spring > 0.2 * c.now.mean_normal;
            }
        }
    }
    assert!(slid);
}

#[test]
fn the_step_is_refused_with_both_numbers() {
    let grains = packing(8.0, &[[2.0, 4.0, 4.0, 1.0], [5.0, 4.0, 4.0, 2.0]]);
    let c = Compression::new(&grains, &Settings::default()).unwrap();
    let (critical, _) = critical_step(&c.position, &c.velocity, &Settings::default());
    assert!(c.now.step < critical);
    for factor in [1.0, 2.0] {
        let settings = Settings { step: Some(factor * critical), ..Settings::default() };
        let error = Compression::new(&grains, &settings).unwrap_err();
        let both = [factor * critical, critical].map(|step| format!("time step {step:e}"));
        assert!(both.iter().all(|step| error.to_string().contains(step)), "{error}");
    }
    let settings = Settings { step: Some(0.99 * critical), ..Settings::default() };
    assert!(Compression::new(&grains, &settings).is_ok());
}

/// While the servo squeezes and then holds, the adaptive step stays well below the critical one at every
/// instant.
#[test]
fn the_automatic_step_stays_below_the_critical_one() {
    for friction in [0.0, 0.5] {
        let mut c = drawn(2.0, &Settings { grains: 150, friction, ..Settings::default() });
        let mut closest: f64 = 0.0;
        for _ in 0..9000 {
            let step = c.now.step;
            c.advance(1).unwrap();
            closest = closest.max(step / c.critical_step());
        }
        let pressure = c.now.pressure;
        assert!(pressure > 0.5 && closest > 0.5 && closest < 1.0, "{friction}: {closest} {pressure}");
    }
}

/// With a gain far above the inverse of the contacts' viscosity, the strain rate settles and does not
/// swing between its limits: it rarely changes sign.
#[test]
fn the_servo_does_not_swing() {
    let settings =
        Settings { grains: 300, squeeze_rate: 0.05, servo_gain: 0.1, drag: 0.2, ..Settings::default() };
    let mut c = drawn(2.0, &settings);
    while (c.now.pressure - 1.0).abs() > 0.005 {
        c.advance(1).unwrap();
    }
    c.advance(2000).unwrap();
    let mut swings = 0;
    for _ in 0..1000 {
        let before = c.now.strain_rate;
        c.advance(1).unwrap();
        swings += u64::from(before * c.now.strain_rate < 0.0);
    }
    assert!(swings < 100 && (c.now.pressure - 1.0).abs() < 0.005, "{swings} {}", c.now.pressure);
}

/// A chain of two grains becomes unstable at a step no shorter than the critical step of their contact.
#[test]
fn the_critical_step_is_stable_and_not_far_from_the_limit() {
    let k = STIFFNESS;
    let limit = 2.0 / (2.0 * k / (PI / 6.0)).sqrt();
    let run = |step: f64| {
        let mut c = head_on(&elastic(Contact::Linear(k)), 0.0, 1e-5);
        c.settings.step = None;
        c.position[0][0] += 1e-4 * if c.position[0][0] < 0.5 { 1.0 } else { -1.0 };
        c.now.step = step;
        let mut most: f64 = 0.0;
        for _ in 0..15 {
            c.now.steps = 0;
            free(&mut c, 1);
            most = most.max(1.0 - distance(&c));
        }
        most
    };
    assert!(run(0.9 * limit) < 5e-3);
    let mut c = head_on(&elastic(Contact::Linear(k)), 0.01, 1e-4);
    free(&mut c, 2);
    assert!((c.critical_step() / limit - 1.0).abs() < 1e-12);
}

/// The first velocity of a small grain pressed into a large one, from rest, shows the mass that was used: its
/// own, or the mass at which the contact's critical step is 1.5 times the one before there are contacts.
#[test]
fn crowded_grains_of_wide_packings_are_moved_as_heavier_ones() {
    let first_velocity = |ratio: f64, step: Option<f64>| {
        let settings = Settings { step, clip_tension: true, ..elastic(Contact::Hertz) };
        let overlap = 0.03;
        let (edge, apart) = (4.0 * ratio, 0.5 * (ratio + 1.0) - overlap);
        let grains =
            [[0.5 * edge, 0.5 * edge, 0.5 * edge, ratio], [0.5 * edge + apart, 0.5 * edge, 0.5 * edge, 1.0]];
        let mut c = compression(edge, &grains, &settings);
        let (law, reduced) = (c.law, 0.5 * ratio / (ratio + 1.0));
        let stiffness = law.stiffness * (reduced * overlap).sqrt();
        let small = place(&c, 1);
        let (true_mass, loose) = (c.velocity[small][3], critical_step(&c.position, &c.velocity, &settings).0);
        let heavier = 0.25 * stability(&law) * stiffness * (1.5 * loose) * (1.5 * loose);
        assert!(heavier > 1.2 * true_mass, "{heavier} {true_mass}");
        let step = c.now.step;
        free(&mut c, 1);
        assert_eq!(c.velocity[small][3], true_mass);
        let mass = 2.0 / 3.0 * stiffness * overlap * step / c.velocity[small][0];
        (mass / true_mass, heavier / true_mass)
    };
    for (ratio, step, is_heavier) in
        [(19.9, None, false), (20.0, None, true), (36.0, None, true), (36.0, Some(1e-4), false)]
    {
        let (mass, heavier) = first_velocity(ratio, step);
        let expected = if is_heavier { heavier } else { 1.0 };
        assert!((mass / expected - 1.0).abs() < 1e-9, "{ratio}: {mass}, expected {expected}");
    }
}

/// The step of a wide packing does not depend on its most crowded grains, and a hold is counted in the
/// steps that their own masses would have taken.
#[test]
fn the_step_of_wide_packings_does_not_follow_the_most_crowded_grains() {
    let settings = Settings { grains: 806, squeeze_rate: 0.03, ..Settings::default() };
    let sizes: Vec<f64> = (0..806).map(|i| if i < 6 { 20.0 } else { 1.0 }).collect();
    let mut c = Compression::new(&random_start(&sizes, &settings).unwrap(), &settings).unwrap();
    let loose = critical_step(&c.position, &c.velocity, &settings).0;
    let (mut held, mut closest): (f64, f64) = (0.0, 0.0);
    for _ in 0..6000 {
        let before = (c.now.hold.saved, c.now.hold.since);
        c.advance(1).unwrap();
        assert!(c.critical_step() > 1.499 * loose);
        closest = closest.max(c.now.step / c.critical_step());
        if c.now.hold.since == before.1 {
            assert!(c.now.hold.saved >= before.0);
            held = held.max(c.now.hold.saved - before.0);
        }
    }
    assert!(closest < 1.0 && held > 0.2, "{closest} {held}");
}

/// A wide gradation keeps its protocol even if no extreme grain was drawn.
#[test]
fn one_gradation_has_one_protocol() {
    for (cu, is_wide) in [(4.4, false), (4.6, true)] {
        let settings = Settings { grains: 3000, ..Settings::default() };
        let c = drawn(cu, &settings);
        assert!(!c.makes_heavier(), "the grains themselves differ less");
        let c = c.of_gradation(&Gradation::linear_from_d0(1.0, cu).unwrap());
        assert_eq!(c.makes_heavier(), is_wide);
        assert_eq!(Compression::from_bytes(&settings, &c.to_bytes()).unwrap().makes_heavier(), is_wide);
    }
}

#[test]
fn one_grain_touches_nothing() {
    let settings = Settings::default();
    let mut c = compression(2.0, &[[0.1, 0.1, 0.1, 1.0]], &settings);
    free(&mut c, 100);
    assert_eq!((c.now.contacts, c.velocity[0][0]), (0, 0.0));
    let narrow = Compression::new(&packing(1.99, &[[0.1, 0.1, 0.1, 1.0]]), &settings);
    assert_eq!(narrow.unwrap_err(), PackingError::NarrowCell { cell_mm: 1.99, largest_mm: 1.0 });
}

#[test]
fn coincident_centres_are_named() {
    let grains = [[1.0, 1.0, 1.0, 1.0], [3.0, 1.0, 1.0, 2.0], [7.0, 1.0, 1.0, 1.0], [11.0, 1.0, 1.0, 0.5]];
    let error = Compression::new(&packing(8.0, &grains), &Settings::default()).unwrap_err();
    assert_eq!(error, PackingError::Coincident(1, 3));
    assert!(error.to_string().contains("1 and 3"));
}

#[test]
fn an_overlapping_start_relaxes_at_a_capped_speed() {
    let mut u = uniform(1, 9);
    let grains: Vec<[f64; 4]> =
        (0..200).map(|_| [6.0 * u(), 6.0 * u(), 6.0 * u(), 1.0 + 0.2 * u()]).collect();
    let settings = Settings { drag: 0.5, friction: 0.0, ..Settings::default() };
    let mut c = compression(6.5, &grains, &settings);
    free(&mut c, 1);
    let start = c.measure().largest_overlap;
    assert!(start > 0.5);
    let mut capped = false;
    for _ in 0..30_000 {
        let step = c.now.step;
        free(&mut c, 1);
        for v in &c.velocity {
            let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt() * step;
            assert!(length <= LONGEST_MOVE * (1.0 + 1e-9));
            capped |= length > 0.99 * LONGEST_MOVE;
        }
    }
    assert!(capped && c.measure().largest_overlap < 0.05, "{}", c.measure().largest_overlap);
}

/// A gas: grains without overlap, at a given packing fraction, with random velocities and spins.
fn gas(n: usize, ratio: f64, fraction: f64, speed: f64, settings: &Settings) -> Compression {
    let mut u = uniform(7, 9);
    let diameter: Vec<f64> =
        (0..n).map(|i| if i < n.div_ceil(20) { ratio } else { 1.0 + 0.1 * u() }).collect();
    let settings = Settings { start_fraction: fraction, ..settings.clone() };
    let start = random_start(&diameter, &settings).unwrap();
    let mut c = Compression::new(&start, &settings).unwrap();
    let (mut sum, mut mass) = ([0.0; 3], 0.0);
    for v in &mut c.velocity {
        for a in 0..3 {
            v[a] = speed * (u() - 0.5) / v[3].sqrt();
            sum[a] += v[3] * v[a];
        }
        mass += v[3];
    }
    for v in &mut c.velocity {
        for a in 0..3 {
            v[a] -= sum[a] / mass;
        }
    }
    c
}

/// Energy while no two grains touch: the half step's velocities then equal those of the full step.
fn flying(c: &mut Compression) -> Energy {
    for _ in 0..100_000 {
        free(c, 1);
        if c.now.contacts == 0 && c.energy().elastic == 0.0 {
            return c.energy();
        }
    }
    panic!("always touching");
}

#[test]
fn undamped_gas_keeps_energy_and_momentum() {
    let mut c = gas(24, 1.5, 0.1, 0.2, &Settings { step_fraction: 0.02, ..elastic(Contact::Hertz) });
    c.settings.step = Some(c.now.step);
    let before = flying(&mut c).kinetic;
    let mut touched = 0;
    for _ in 0..1_000_000 {
        free(&mut c, 1);
        touched += c.now.contacts;
    }
    let after = flying(&mut c).kinetic;
    assert!(touched > 10_000, "{touched}");
    assert!((after / before - 1.0).abs() < 1e-5, "{}", after / before - 1.0);
    for a in 0..3 {
        let sum: f64 = c.velocity.iter().map(|v| v[3] * v[a]).sum();
        let scale: f64 = c.velocity.iter().map(|v| v[3] * v[a].abs()).sum();
        assert!(sum.abs() < 1e-12 * scale, "{sum} {scale}");
    }
}

/// With friction, no damping and true masses, the energy of a gas of two sizes falls and never rises by
/// more than the time step's error in single contacts.
#[test]
fn friction_makes_no_energy_at_any_size_ratio() {
    for ratio in [1.0, 10.0, 36.0, 100.0] {
        for mass_exponent in [0.0, 1.0] {
            let settings = Settings { step_fraction: 0.1, mass_exponent, ..rough(0.5) };
            let mut c = gas(40, ratio, 0.1, 0.5, &settings);
            c.settings.step = Some(c.now.step);
            let mut least = flying(&mut c).kinetic;
            let before = least;
            let mut touched = 0;
            for _ in 0..20 {
                for _ in 0..2000 {
                    free(&mut c, 1);
                    touched += c.now.contacts;
                }
                let now = flying(&mut c).kinetic;
                assert!(now <= least + 1e-6 * before, "ratio {ratio}: {now} after {least} of {before}");
                least = least.min(now);
            }
            assert!(touched > 20, "{ratio} {touched}");
        }
    }
}

/// Case of Vyas and others: a small grain squeezed between two large ones has to leave; it sticks if the
/// tangential motion is taken in the wrong plane. Here two approaching large grains expel it faster than
/// they approach, and the energy of the three never rises above the initial energy.
#[test]
fn a_small_grain_between_large_ones_is_expelled() {
    for ratio in [4.0, 10.0, 36.0, 100.0] {
        let settings = Settings { mass_exponent: 0.0, step_fraction: 0.1, ..rough(0.05) };
        // The small grain touches both, so far from their axis that friction cannot hold it.
        let big: f64 = 0.5 * ratio;
        let half = big + 0.25;
        let gap = ((big + 0.5) * (big + 0.5) - half * half).sqrt();
        assert!(gap / half > settings.friction);
        let middle = 2.0 * ratio;
        let edge = 4.0 * ratio;
        let grains = [
            [middle - half, middle, middle, ratio],
            [middle + half, middle, middle, ratio],
            [middle, middle + gap, middle, 1.0],
        ];
        let mut c = compression(edge, &grains, &settings);
        c.settings.step = Some(c.now.step);
        for (p, v) in c.position.iter().zip(&mut c.velocity) {
            if p[3] > 1.0 {
                v[0] = if p[0] < 0.5 { 0.01 } else { -0.01 };
            }
        }
        let before = c.energy().kinetic;
        let mut most: f64 = 0.0;
        for _ in 0..20_000 {
            free(&mut c, 1);
            let e = c.energy();
            most = most.max(e.kinetic + e.elastic);
        }
        let small = place(&c, 2);
        assert!(c.velocity[small][1] > 0.0, "ratio {ratio}: it stuck");
        assert!(most <= before * (1.0 + 1e-3), "ratio {ratio}: {most} of {before}");
    }
}
