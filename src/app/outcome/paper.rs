//! Numbers that the paper states about its filters, to be set beside ours. Nothing is fitted to them at run
//! time.

/// A row of Table 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperFilter {
    /// D60 / D10 by mass of the linear gradation.
    pub cu: f64,
    /// Friction between grains during compression.
    pub friction: f64,
    /// Void ratio.
    pub void_ratio: f64,
    /// D60 / D10 by number of the constrictions.
    pub cu_csd: f64,
}

/// Table 2 of Shire & O'Sullivan, *A network model to assess base-filter combinations*.
pub const TABLE_2: [PaperFilter; 6] = [
    PaperFilter { cu: 1.2, friction: 0.0, void_ratio: 0.558, cu_csd: 1.48 },
    PaperFilter { cu: 1.5, friction: 0.0, void_ratio: 0.531, cu_csd: 1.52 },
    PaperFilter { cu: 1.5, friction: 0.3, void_ratio: 0.658, cu_csd: 1.63 },
    PaperFilter { cu: 3.0, friction: 0.0, void_ratio: 0.382, cu_csd: 1.57 },
    PaperFilter { cu: 3.0, friction: 0.3, void_ratio: 0.455, cu_csd: 1.60 },
    PaperFilter { cu: 6.0, friction: 0.7, void_ratio: 0.340, cu_csd: 1.57 },
];

/// The paper's filter with this linear gradation and friction, if it has one.
pub fn filter(cu: f64, friction: f64) -> Option<PaperFilter> {
    TABLE_2.into_iter().find(|f| (f.cu - cu).abs() < 1e-6 && f.friction == friction)
}
