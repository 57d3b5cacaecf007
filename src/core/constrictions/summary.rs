//! Results of measuring a packing's constrictions, their files, and checks that grains can be a packing.

use super::curve::CurveError;
use super::voids::Region;
use super::{Constrictions, ConstrictionsError, Facets};
use crate::gradation::CurvePoint;
use crate::packing::vtp_points;
use crate::store::format;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Percentages for which [`Summary`] gives diameters.
const SUMMARY_PERCENT: [f64; 13] =
    [0.0, 1.0, 1.5, 5.0, 10.0, 15.0, 25.0, 50.0, 60.0, 75.0, 90.0, 99.0, 100.0];

/// Results for a packing's constrictions, as in `constrictions.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Summary {
    /// Number of grains, without hidden ones.
    pub grains: usize,
    /// Number of voids.
    pub voids: usize,
    /// Grains per void, N_p / N_voids of Eq. (2).
    pub grains_per_void: f64,
    /// Number of tetrahedra.
    pub tetrahedra: usize,
    /// Number of constrictions.
    pub constrictions: usize,
    /// Volume of voids over volume of grains.
    pub void_ratio: f64,
    /// D_c60 / D_c10.
    pub cu_csd: f64,
    /// Smallest grain (mm).
    pub(crate) d0_mm: f64,
    /// Diameter (mm) that this percentage of the constrictions by number do not exceed, by percentage.
    pub dc_mm: serde_json::Map<String, serde_json::Value>,
    /// Mean number of constrictions per void.
    pub mean_connectivity: f64,
    /// Number of voids by number of constrictions, from 0.
    pub connectivity: Vec<usize>,
    /// Overlap from which two tetrahedra share a void.
    pub merge_overlap: f64,
    /// Selection of the facets between voids.
    pub(crate) counted_facets: Facets,
    /// Number of constrictions whose disc was made smaller by a fourth grain.
    pub(crate) cut_constrictions: usize,
    /// Number of facets between voids that are closed by grains.
    pub(crate) closed_facets: usize,
    /// Grains that lie inside others, counted from 0.
    pub(crate) hidden_grains: Vec<u32>,
    /// Pairs of grains with the same centre.
    pub(crate) duplicate_grains: Vec<[u32; 2]>,
    /// Notes on these grains.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Permeability along z over the square of the grains' Sauter mean d32; absent without a periodic cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k_over_d32_squared: Option<f64>,
    /// Kozeny and Carman's permeability over d32^2, (1 - c)^3 / (180 c^2) with c the solid fraction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kozeny_carman_over_d32_squared: Option<f64>,
}

impl Constrictions {
    /// Computes all results; `warnings` are the doubts in words.
    ///
    /// # Errors
    /// Errors of [`Constrictions::curve`].
    pub fn summary(&self, warnings: Vec<String>) -> Result<Summary, CurveError> {
        let curve = self.curve()?;
        let dc = |percent: f64| curve.dc(percent).map(|d| (percent.to_string(), d.into()));
        Ok(Summary {
            grains: self.grains,
            voids: self.voids(),
            grains_per_void: self.grains_per_void(),
            tetrahedra: self.tetrahedra,
            constrictions: self.constrictions(),
            void_ratio: self.void_ratio,
            cu_csd: curve.cu(),
            d0_mm: self.d0_mm,
            dc_mm: SUMMARY_PERCENT.into_iter().filter_map(dc).collect(),
            mean_connectivity: self.mean_connectivity(),
            connectivity: self.connectivity(),
            merge_overlap: self.merge_overlap,
            counted_facets: self.counted,
            cut_constrictions: self.cut,
            closed_facets: self.closed,
            hidden_grains: self.hidden.clone(),
            duplicate_grains: self.duplicates.clone(),
            warnings,
            k_over_d32_squared: None,
            kozeny_carman_over_d32_squared: None,
        })
    }

    /// Makes the files of results, by name: the curve, the constrictions for ParaView, and this summary.
    ///
    /// # Errors
    /// Errors of [`Constrictions::curve`].
    pub fn files(&self, summary: &Summary) -> Result<[(&'static str, String); 3], CurveError> {
        let json = format::CONSTRICTIONS.json(summary).expect("numbers and names");
        Ok([
            ("constrictions.csv", self.curve_csv()?),
            ("constrictions.vtp", self.to_vtp()),
            ("constrictions.json", json),
        ])
    }

    /// Writes the curve as CSV, `percent_smaller,diameter_mm`.
    ///
    /// # Errors
    /// Errors of [`Constrictions::curve`].
    pub fn curve_csv(&self) -> Result<String, CurveError> {
        let mut text = String::from("percent_smaller,diameter_mm\n");
        for CurvePoint { size: diameter, percent } in self.curve()?.points() {
            // Writing to a String never fails.
            let _ = writeln!(text, "{percent},{diameter}");
        }
        Ok(text)
    }

    /// Writes the constrictions for ParaView: points (mm) with their diameter and the voids they join.
    pub(crate) fn to_vtp(&self) -> String {
        let column = |voids: &[u32]| voids.iter().map(|&v| f64::from(v)).collect::<Vec<_>>();
        let (upstream, downstream) = (column(&self.upstream), column(&self.downstream));
        vtp_points(
            &self.centre_mm,
            &[("diameter_mm", &self.diameter_mm), ("upstream", &upstream), ("downstream", &downstream)],
        )
    }
}

/// Minimum and maximum void ratio of grains that rest on each other.
const DENSEST: f64 = 0.2;
const LOOSEST: f64 = 1.5;

impl Constrictions {
    /// Refuses grains that cannot be a packing: grains inside others in a periodic cell, which is then the
    /// wrong cell; grains that occur twice; grains that leave no voids; grains that surround no grain.
    ///
    /// # Errors
    /// [`ConstrictionsError::Hidden`], [`ConstrictionsError::Twice`], [`ConstrictionsError::Outside`] or
    /// [`ConstrictionsError::Full`].
    pub fn check(&self) -> Result<(), ConstrictionsError> {
        match (self.hidden.first(), self.duplicates.first()) {
            (Some(&first), _) if self.region == Region::Everything => {
                let (hidden, grains) = (self.hidden.len(), self.grains + self.hidden.len());
                Err(ConstrictionsError::Hidden { hidden, grains, first })
            }
            (_, Some(&first)) => Err(ConstrictionsError::Twice(self.duplicates.len(), first)),
            _ if !self.is_surrounded => Err(ConstrictionsError::Outside),
            // The ratio is NaN if the region holds no tetrahedron.
            _ if self.void_ratio <= 0.0 => Err(ConstrictionsError::Full(self.void_ratio)),
            _ => Ok(()),
        }
    }

    /// Reasons to doubt that the grains are a packing.
    pub fn doubts(&self) -> Vec<Doubt> {
        let (void_ratio, is_periodic) = (self.void_ratio, self.region == Region::Everything);
        let loose = Doubt::Loose { void_ratio, most: LOOSEST, is_periodic };
        let dense = Doubt::Dense { void_ratio, least: DENSEST, is_periodic };
        [
            (void_ratio > LOOSEST).then_some(loose),
            (void_ratio < DENSEST).then_some(dense),
            self.near.first().map(|&first| Doubt::Near(self.near.len(), first)),
            self.hidden.first().map(|&first| Doubt::Hidden(self.hidden.len(), first)),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// Reasons to doubt that grains are a packing.
#[allow(missing_docs)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// More voids than grains that rest on each other leave.
    Loose { void_ratio: f64, most: f64, is_periodic: bool },
    /// Fewer voids than grains that rest on each other leave.
    Dense { void_ratio: f64, least: f64, is_periodic: bool },
    /// Pairs of grains nearer than a quarter of the smaller diameter: their number, and the first pair.
    Near(usize, [u32; 2]),
    /// Grains inside others, which take no part: their number, and the first, counted from 0.
    Hidden(usize, u32),
}
