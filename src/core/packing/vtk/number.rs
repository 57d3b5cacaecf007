//! Numbers of VTK files as bytes.

/// Type of the numbers of an array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    /// Size in bytes.
    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// All numbers in a run of bytes; an incomplete rest is ignored.
    pub fn all(self, bytes: &[u8], is_big_endian: bool) -> Vec<f64> {
        bytes.chunks_exact(self.bytes()).map(|bytes| self.one(bytes, is_big_endian)).collect()
    }

    pub fn one(self, bytes: &[u8], is_big_endian: bool) -> f64 {
        let mut little = [0; 8];
        for (k, slot) in little.iter_mut().take(bytes.len()).enumerate() {
            *slot = if is_big_endian { bytes[bytes.len() - 1 - k] } else { bytes[k] };
        }
        let whole = u64::from_le_bytes(little);
        match self {
            Self::I8 => f64::from(whole as i8),
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => whole as f64,
            Self::I16 => f64::from(whole as i16),
            Self::I32 => f64::from(whole as i32),
            Self::I64 => whole as i64 as f64,
            Self::F32 => f64::from(f32::from_bits(whole as u32)),
            Self::F64 => f64::from_bits(whole),
        }
    }
}
