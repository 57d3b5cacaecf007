//! Checks for grains that cannot be a packing, and doubts about unlikely ones.

use super::frame::Region;
use super::measure::{Constrictions, ConstrictionsError};

/// Least and greatest void ratio of grains that rest on each other.
const DENSEST: f64 = 0.2;
const LOOSEST: f64 = 1.5;

impl Constrictions {
    /// Refuses grains that cannot be a packing: grains inside others in a periodic cell, which must then be
    /// the wrong cell; grains that occur twice; grains that leave no voids; grains that enclose no grain.
    ///
    /// # Errors
    /// [`ConstrictionsError::Hidden`], [`ConstrictionsError::Twice`], [`ConstrictionsError::Outside`] or
    /// [`ConstrictionsError::Full`].
    pub fn check(&self) -> Result<(), ConstrictionsError> {
        match (self.hidden.first(), self.duplicates.first()) {
            (Some(&first), _) if self.region == Region::Everything => Err(ConstrictionsError::Hidden {
                hidden: self.hidden.len(),
                grains: self.grains + self.hidden.len(),
                first,
            }),
            (_, Some(&first)) => Err(ConstrictionsError::Twice { pairs: self.duplicates.len(), first }),
            _ if !self.is_surrounded => Err(ConstrictionsError::Outside),
            // The ratio is NaN if the region holds no tetrahedron.
            _ if self.void_ratio <= 0.0 => Err(ConstrictionsError::Full { void_ratio: self.void_ratio }),
            _ => Ok(()),
        }
    }

    /// Reasons to doubt that the grains are a packing.
    pub fn doubts(&self) -> Vec<String> {
        let (ratio, is_periodic) = (self.void_ratio, self.region == Region::Everything);
        let rest = "grains that rest on each other hardly leave";
        let other = if is_periodic { "the cell" } else { "their centres" };
        let loose = match is_periodic {
            true => "the cell may be too large, or in another unit than the grains",
            false => "they may lie apart, or diameters be in another unit than centres",
        };
        let mut doubts = Vec::new();
        if ratio > LOOSEST {
            doubts.push(format!("the void ratio is {ratio:.4}, and {rest} more than {LOOSEST}: {loose}"));
        }
        if ratio < DENSEST {
            doubts.push(format!(
                "the void ratio is {ratio:.4}, and {rest} less than {DENSEST}: they overlap, or diameters \
                 are in another unit than {other}"
            ));
        }
        if let Some([one, other]) = self.near.first() {
            doubts.push(format!(
                "{} pairs of grains lie nearer than a quarter of the smaller diameter, the first of them \
                 grains {one} and {other} (counted from 0): they may be one that stands twice",
                self.near.len()
            ));
        }
        if let Some(first) = self.hidden.first() {
            doubts.push(format!(
                "{} grains lie inside others and take no part, the first of them grain {first} (counted \
                 from 0)",
                self.hidden.len()
            ));
        }
        doubts
    }
}
