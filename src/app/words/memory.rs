//! Memory of walks.

/// Memory of the walks of a case (bytes).
pub(crate) struct WalkMemory {
    /// A walk, without its particles if these lie in files.
    pub(crate) walk: u64,
    /// Rows that `record.voids` keeps.
    pub(crate) kept: u64,
    /// Maximum for the walks.
    pub(crate) most: u64,
    /// Particles in files of the run folder.
    pub(crate) on_disk: Option<u64>,
}

/// Memory of the walks, and the place of their particles.
pub(crate) fn memory(memory: &WalkMemory) -> String {
    let WalkMemory { walk, kept, most, on_disk } = *memory;
    let kept = match kept {
        0 => String::new(),
        kept => format!(", and up to {} for what record.voids keeps", bytes(kept)),
    };
    let files = on_disk.map_or(String::new(), |on_disk| {
        format!(
            ", and {} in files in the run folder for the particles, mapped into memory: slower, the same \
             bits",
            bytes(on_disk)
        )
    });
    format!("{} a walk{kept}, of {} that it may take{files}", bytes(walk), bytes(most))
}

/// Bytes in words, such as `1.6 GB`.
pub(crate) fn bytes(bytes: u64) -> String {
    let (mut value, mut unit) = (bytes as f64, "bytes");
    for larger in ["kB", "MB", "GB", "TB", "PB", "EB"] {
        if value < 1000.0 {
            break;
        }
        value /= 1000.0;
        unit = larger;
    }
    if unit == "bytes" { format!("{bytes} bytes") } else { format!("{value:.2} {unit}") }
}
