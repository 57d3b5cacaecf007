//! Size classes: how many particles, and how much of the mass, is of which size.

/// Bounds of size classes, ascending; class `k` holds diameters above bound `k - 1` up to bound `k`.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeClasses {
    upper: Vec<f32>,
}

impl SizeClasses {
    /// `count` classes of equal width in the logarithm of the diameter, from `smallest` to `largest`;
    /// one class where the two are equal.
    pub fn logarithmic(smallest: f32, largest: f32, count: usize) -> Self {
        let ratio = libm::log(f64::from(largest) / f64::from(smallest));
        let bound = |k: usize| f64::from(smallest) * libm::exp(ratio * k as f64 / count as f64);
        let mut upper: Vec<f32> = (1..count).map(|k| bound(k) as f32).collect();
        upper.push(largest);
        upper.dedup();
        Self { upper }
    }

    /// Upper bound of each class.
    pub fn upper(&self) -> &[f32] {
        &self.upper
    }

    /// Class of a diameter; sizes above the last bound count in the last class.
    #[inline]
    pub fn of(&self, diameter: f32) -> usize {
        self.upper.partition_point(|&bound| bound < diameter).min(self.upper.len() - 1)
    }
}

/// Number and mass by size class.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeCounts {
    /// Particles by class.
    pub number: Vec<u64>,
    /// Sum of diameter cubed by class.
    pub mass: Vec<f64>,
}

impl SizeCounts {
    /// Nothing in any class.
    pub fn new(classes: &SizeClasses) -> Self {
        Self { number: vec![0; classes.upper.len()], mass: vec![0.0; classes.upper.len()] }
    }

    pub(super) fn add(&mut self, classes: &SizeClasses, diameter: f32) {
        let class = classes.of(diameter);
        self.number[class] += 1;
        self.mass[class] += cube(diameter);
    }

    pub(super) fn clear(&mut self) {
        self.number.fill(0);
        self.mass.fill(0.0);
    }

    /// Adds what `other` holds.
    pub fn merge(&mut self, other: &Self) {
        for (sum, n) in self.number.iter_mut().zip(&other.number) {
            *sum += n;
        }
        for (sum, m) in self.mass.iter_mut().zip(&other.mass) {
            *sum += m;
        }
    }
}

/// Diameter cubed: mass in units of the reference length cubed.
#[inline]
pub(super) fn cube(diameter: f32) -> f64 {
    let d = f64::from(diameter);
    d * d * d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_cover_their_range() {
        let classes = SizeClasses::logarithmic(1.0, 8.0, 3);
        assert_eq!(classes.upper().len(), 3);
        assert_eq!([classes.of(1.0), classes.of(1.9), classes.of(2.1), classes.of(8.0)], [0, 0, 1, 2]);
        assert_eq!(classes.of(9.0), 2);
        assert_eq!(SizeClasses::logarithmic(2.0, 2.0, 64).upper(), [2.0]);
    }
}
