//! The walk, plainly: see README.md beside this file.
/// Processor time in seconds: other work on the machine does not count.
fn seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}

#[derive(Clone, Copy)]
struct Particle {
    node: usize,
    diameter: f64,
}

/// xoshiro256++, seeded by SplitMix64.
struct Random {
    s: [u64; 4],
}

impl Random {
    fn new(seed: u64) -> Self {
        let mut x = seed;
        let s = std::array::from_fn(|_| {
            x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        });
        Self { s }
    }

    fn next(&mut self) -> u64 {
        let [s0, s1, s2, s3] = &mut self.s;
        let out = s0.wrapping_add(*s3).rotate_left(23).wrapping_add(*s0);
        let t = *s1 << 17;
        *s2 ^= *s0;
        *s3 ^= *s1;
        *s1 ^= *s2;
        *s0 ^= *s3;
        *s2 ^= t;
        *s3 = s3.rotate_left(45);
        out
    }

    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

struct Curve {
    points: Vec<(f64, f64)>,
}

impl Curve {
    fn read(path: &str) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let points = text.lines().filter_map(|line| {
            let (p, d) = line.split_once(',')?;
            Some((p.parse().ok()?, d.parse().ok()?))
        });
        Self { points: points.collect() }
    }

    fn at(&self, percent: f64) -> f64 {
        let mut i = 1;
        while i + 1 < self.points.len() && self.points[i].0 < percent {
            i += 1;
        }
        let ((p, a), (q, b)) = (self.points[i - 1], self.points[i]);
        a + (percent - p) / (q - p) * (b - a)
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let n: u64 = arguments[1].parse().unwrap();
    let curve = Curve::read(&arguments[2]);
    let passive = arguments[3] == "passive";
    let mut random = Random::new(arguments[4].parse().unwrap());
    let until: u64 = arguments[5].parse().unwrap();
    let (nx, ny, nz) = (40, 40, 60);
    let (plane, voids, increments) = (nx * ny, nx * ny * nz, 100);

    let diameter: Vec<f64> = (0..3 * voids).map(|_| curve.at(100.0 * random.uniform())).collect();
    let mut target: Vec<Option<usize>> = Vec::new();
    for v in 0..voids {
        let (x, y, z) = (v % nx, v / nx % ny, v / plane);
        target.push(Some(v - x + (x + 1) % nx));
        target.push(Some(v - y * nx + (y + 1) % ny * nx));
        target.push(if z + 1 == nz { None } else { Some(v + plane) });
    }

    let cu = 4.5f64;
    let d0 = if passive { 0.16 / (cu * cu) } else { curve.at(5.0) / cu.powf(1.7) };
    let (y0, y1) = (d0.powi(-3), (d0 * cu * cu).powi(-3));

    let mut blocked = vec![false; 3 * voids];
    let mut particles: Vec<Particle> = Vec::with_capacity(n as usize);
    let mut newly_blocked = Vec::new();
    let mut retained = vec![0u64; voids];
    let (mut steps, mut steps_after, mut eroded, mut blocked_count) = (0u64, 0u64, 0u64, 0u64);
    let (mut eroded_mass, mut largest_eroded, mut time_after) = (0.0, 0f64, 0.0);

    let begin = seconds();
    let mut t = 0;
    while (t < increments || !particles.is_empty()) && (until == 0 || t < until) {
        t += 1;
        let began = seconds();
        if t <= increments {
            for _ in n * (t - 1) / increments..n * t / increments {
                let diameter = (y0 + random.uniform() * (y1 - y0)).powf(-1.0 / 3.0);
                let node = (random.uniform() * plane as f64) as usize;
                particles.push(Particle { node, diameter });
            }
        }
        let moving = particles.len() as u64;
        steps += moving;
        particles.retain_mut(|particle| {
            let first = 3 * particle.node;
            let mut area = [0.0; 3];
            for e in 0..3 {
                if !blocked[first + e] {
                    area[e] = diameter[first + e] * diameter[first + e];
                }
            }
            let total: f64 = area.iter().sum();
            if total == 0.0 {
                retained[particle.node] += 1;
                return false;
            }
            let mut draw = random.uniform() * total;
            let mut exit = 0;
            while exit < 2 && draw >= area[exit] {
                draw -= area[exit];
                exit += 1;
            }
            while area[exit] == 0.0 {
                exit -= 1;
            }
            if particle.diameter > diameter[first + exit] {
                retained[particle.node] += 1;
                newly_blocked.push(first + exit);
                return false;
            }
            match target[first + exit] {
                Some(node) => {
                    particle.node = node;
                    true
                }
                None => {
                    eroded += 1;
                    eroded_mass += particle.diameter.powi(3);
                    largest_eroded = largest_eroded.max(particle.diameter);
                    false
                }
            }
        });
        for c in newly_blocked.drain(..) {
            blocked_count += u64::from(!blocked[c]);
            blocked[c] = true;
        }
        if t > increments {
            time_after += seconds() - began;
            steps_after += moving;
        }
    }
    let all = seconds() - begin;
    println!(
        "steps {steps} ns_step_all {:.4} steps_after {steps_after} ns_step_after {:.4} eroded {eroded} blocked {blocked_count} eroded_mass {eroded_mass:.6}",
        all / steps as f64 * 1e9,
        time_after / steps_after as f64 * 1e9,
    );
}
