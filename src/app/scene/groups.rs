//! Which settings of a scene exclude each other.

use voidwalk_core::schema::{Alternative, Group};

/// Settings that state one fact in different ways.
pub(super) const GROUPS: &[Group] = &[
    // Measurements on one packing do not apply to another.
    Group {
        says: "say what is packed",
        alternatives: &[Alternative {
            resets: &["filter.measured"],
            ..Alternative::by(&["filter.density", "filter.friction", "filter.cu", "filter.sieve", "packing."])
        }],
    },
    Group {
        says: "say what the filter's constrictions are",
        alternatives: &[
            Alternative::by(&["filter.curve"]),
            Alternative::by(&["filter.density"]),
            Alternative::by(&["filter.friction"]),
            Alternative::by(&["filter.library"]),
            Alternative::by(&["filter.estimate"]),
        ],
    },
    // A network from a file brings its constrictions along; a curve may still define D85B.
    Group {
        says: "say what the filter's constrictions are",
        alternatives: &[
            Alternative::by(&["filter.density", "filter.friction", "filter.library", "filter.estimate"]),
            Alternative::by(&["network.file"]),
        ],
    },
    Group {
        says: "give the filter's gradation",
        alternatives: &[
            Alternative::by(&["filter.cu"]),
            // With a sieve table, d0_mm is the end of its tail, not the start of the gradation.
            Alternative { resets: &["filter.d0_mm"], ..Alternative::by(&["filter.sieve"]) },
        ],
    },
    Group {
        says: "give the base",
        alternatives: &[
            Alternative {
                with_chooses: true,
                ..Alternative::by(&["base.cu"]).with(&[
                    "base.d85_mm",
                    "base.d85_at_dc",
                    "base.d15f_over_d85b",
                    "base.dc_curve",
                ])
            },
            Alternative::by(&["base.sieve"]).with(&["base.d0_mm"]),
            Alternative::by(&["base.single_mm"]),
        ],
    },
    Group {
        says: "set D85B",
        alternatives: &[
            Alternative::by(&["base.d85_mm"]),
            Alternative::by(&["base.d85_at_dc"]).with(&["base.dc_curve"]),
            Alternative::by(&["base.d15f_over_d85b"]),
        ],
    },
    Group {
        says: "say how much base",
        alternatives: &[
            Alternative::by(&["base.mass_ratio"]).with(&["base.cap"]),
            Alternative::by(&["base.n_base"]),
        ],
    },
    Group {
        says: "give the network",
        alternatives: &[
            Alternative::by(&["network.nx", "network.ny", "network.nz", "network.connectivity"]),
            Alternative::by(&["network.file"]),
            Alternative {
                resets: &["filter.curve", "filter.library", "filter.estimate"],
                ..Alternative::by(&["network.packing", "network.copies"])
            },
        ],
    },
    Group {
        says: "say what the network is made of",
        alternatives: &[Alternative {
            resets: &["network.nx", "network.ny", "network.nz", "network.connectivity", "network.file"],
            ..Alternative::by(&["network.kind"])
        }],
    },
    Group {
        says: "say how thick the filter is",
        alternatives: &[
            Alternative::by(&["network.nz"]),
            Alternative::by(&["network.copies"]),
            Alternative::by(&["network.thickness_mm"]),
            Alternative::by(&["network.thickness_d50f"]),
        ],
    },
];
