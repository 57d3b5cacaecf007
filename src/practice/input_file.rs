//! A file that was read, by name and checksum.

use serde::{Deserialize, Serialize};

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct InputFile {
    /// Its name as given.
    pub name: String,
    /// XXH3 of its bytes, hexadecimal. Finds accidents, not attackers.
    pub xxh3: String,
}

impl InputFile {
    /// A file with these bytes.
    pub fn of(name: impl Into<String>, bytes: &[u8]) -> Self {
        Self { name: name.into(), xxh3: format!("{:016x}", xxhash_rust::xxh3::xxh3_64(bytes)) }
    }
}
