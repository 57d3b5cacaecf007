//! Whose rules a sheet lists.

use serde::{Deserialize, Serialize};

/// An authority that states rules, or all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Authority {
    /// All of them, and the checks of this program.
    #[default]
    All,
    /// Natural Resources Conservation Service.
    Nrcs,
    /// U.S. Bureau of Reclamation.
    Usbr,
    /// U.S. Army Corps of Engineers.
    Usace,
    /// Foster and Fell.
    FosterFell,
}

impl Authority {
    /// Each.
    pub const ALL: [Self; 5] = [Self::All, Self::Nrcs, Self::Usbr, Self::Usace, Self::FosterFell];

    /// The word of the command line and of a scene.
    pub fn word(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Nrcs => "nrcs",
            Self::Usbr => "usbr",
            Self::Usace => "usace",
            Self::FosterFell => "foster-fell",
        }
    }

    /// The authority of a word.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|of| of.word() == word)
    }

    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all authorities",
            Self::Nrcs => "NRCS",
            Self::Usbr => "USBR",
            Self::Usace => "USACE",
            Self::FosterFell => "Foster and Fell",
        }
    }
}
