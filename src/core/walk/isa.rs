//! Instructions that the step uses: found once, when the program runs.

use std::sync::OnceLock;

/// Instruction sets that the step is written for; all give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// Instructions that every machine has.
    Portable,
    /// AVX2: eight particles at once.
    Avx2,
    /// AVX-512 (F, BW, DQ, VL): sixteen particles at once.
    Avx512,
}

impl Isa {
    /// All of them, the slowest first.
    pub const ALL: [Isa; 3] = [Isa::Portable, Isa::Avx2, Isa::Avx512];

    /// The name used in `VOIDWALK_ISA` and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Tells if this machine has it.
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        match self {
            Self::Portable => true,
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("popcnt"),
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("popcnt")
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == Self::Portable
        }
    }

    /// Set that walks use: the fastest that this machine has, or the one that the environment variable
    /// `VOIDWALK_ISA` names when the first walk starts, if this machine has it.
    pub fn chosen() -> Self {
        static CHOSEN: OnceLock<Isa> = OnceLock::new();
        *CHOSEN.get_or_init(|| {
            let named = std::env::var("VOIDWALK_ISA").ok();
            let named = Self::ALL.into_iter().find(|isa| Some(isa.name()) == named.as_deref());
            let fastest = Self::ALL.into_iter().rev().find(|isa| isa.is_available());
            named.filter(|isa| isa.is_available()).or(fastest).unwrap_or(Self::Portable)
        })
    }
}
