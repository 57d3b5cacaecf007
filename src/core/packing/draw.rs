//! Draws grains from a gradation and places them loosely.

use super::compression::TALLEST;
use super::grains::{Cell, Packing};
use super::neighbours::Aspect;
use super::place::place;
use super::settings::{PackingError, Settings};
use crate::gradation::Gradation;
use crate::stream::{Key, Purpose, unit};
use rand::Rng;
use std::f64::consts::PI;

/// Draws diameters (mm, descending) from the known sizes of a gradation, one from each of `grains` equal
/// strata of the number: the sample's curve follows the gradation much more closely than independent draws
/// would.
///
/// A pan fraction is left out: its grains are too fine to form the skeleton, and their number is not known.
///
/// ```
/// use voidwalk_core::{gradation::Gradation, packing::draw};
/// let filter = Gradation::linear_from_d0(1.0, 1.5).unwrap();
/// let diameter_mm = draw(&filter, 1000, 1);
/// assert!(diameter_mm[0] <= 2.25 && diameter_mm[999] >= 1.0);
/// ```
pub fn draw(gradation: &Gradation, grains: usize, seed: u64) -> Vec<f64> {
    let mut generator = Key { seed, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 0 }.generator();
    let mut diameter: Vec<f64> = (0..grains)
        .map(|i| 100.0 * (i as f64 + unit(generator.next_u64())) / grains as f64)
        .filter_map(|percent| gradation.d_by_number(percent))
        .collect();
    diameter.sort_by(|a, b| b.total_cmp(a));
    diameter
}

/// Places these grains (mm, any order) at random without overlap, at the packing fraction of the settings;
/// the grains of the result are in descending order of size.
///
/// # Errors
/// Settings out of range; an invalid diameter; a cell narrower than two of the largest grain; no room.
pub fn random_start(diameter_mm: &[f64], settings: &Settings) -> Result<Packing, PackingError> {
    tall_start(diameter_mm, 1.0, settings)
}

/// Places grains like [`random_start`] in a cell that is `aspect` times as tall (along z) as wide, 1 to 100
/// times.
///
/// # Errors
/// Errors of [`random_start`]; an aspect out of range.
pub fn tall_start(diameter_mm: &[f64], aspect: f64, settings: &Settings) -> Result<Packing, PackingError> {
    settings.check()?;
    if !(1.0..=TALLEST).contains(&aspect) {
        return Err(PackingError::Aspect(aspect));
    }
    let aspect = Aspect::new(aspect);
    if diameter_mm.is_empty() {
        return Err(PackingError::Columns([0; 4]));
    }
    let good = |d: &f64| *d > 0.0 && *d < f64::INFINITY;
    if let Some(grain) = diameter_mm.iter().position(|d| !good(d)) {
        let value = diameter_mm[grain];
        return Err(PackingError::Grain { grain, column: "diameter", value, allowed: "a positive number" });
    }
    let mut diameter = diameter_mm.to_vec();
    diameter.sort_by(|a, b| b.total_cmp(a));
    let unit_mm = diameter[diameter.len() - 1];
    let radius: Vec<f64> = diameter.iter().map(|d| 0.5 * (d / unit_mm)).collect();
    let volume = radius.iter().map(|r| r * r * r).sum::<f64>() * (4.0 / 3.0 * PI);
    let cell = libm::cbrt(volume / settings.start_fraction / aspect.height());
    if cell < 4.0 * radius[0] {
        return Err(PackingError::NarrowCell { cell_mm: cell * unit_mm, largest_mm: diameter[0] });
    }
    let mut generator =
        Key { seed: settings.seed, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 1 }.generator();
    let centre = place(&radius, cell, aspect, &mut generator)?;
    let edge = cell * unit_mm;
    Ok(Packing {
        cell: Cell::Periodic([edge, edge, edge * aspect.height()]),
        x: centre.iter().map(|c| c[0] * edge).collect(),
        y: centre.iter().map(|c| c[1] * edge).collect(),
        z: centre.iter().map(|c| c[2] * edge).collect(),
        diameter,
    })
}
