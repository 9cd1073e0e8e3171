//! Numbers and texts of a TDMS file in either byte order.

/// Fractions of a second in a time stamp.
const STAMPS_PER_S: f64 = 18_446_744_073_709_551_616.0;

/// Reason to stop parsing a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    Damage,
    TooLarge,
}

/// Kind of stored numbers by its code in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    Bool,
    Timestamp,
    /// Content that is no number, with its size in bytes; 0 for texts.
    Other(usize),
}

/// Size of the time stamp: fractions of a second in 2^-64, seconds since 1904.
const TIMESTAMP_BYTES: usize = 16;

impl Kind {
    /// Kind of a data type of the format.
    pub(super) fn from_code(code: u32) -> Result<Self, Flaw> {
        Ok(match code {
            1 => Self::I8,
            2 => Self::I16,
            3 => Self::I32,
            4 => Self::I64,
            5 => Self::U8,
            6 => Self::U16,
            7 => Self::U32,
            8 => Self::U64,
            // With and without a unit.
            9 | 0x19 => Self::F32,
            10 | 0x1A => Self::F64,
            0x20 => Self::Other(0),
            0x21 => Self::Bool,
            0x44 => Self::Timestamp,
            // Extended precision, complex numbers of single and double precision.
            11 | 0x1B | 0x10_000D => Self::Other(16),
            0x08_000C => Self::Other(8),
            _ => return Err(Flaw::Damage),
        })
    }

    /// Kind of the numbers of a measuring card.
    pub(super) fn of_card(code: u32) -> Result<Self, Flaw> {
        let kinds = [Self::U8, Self::I8, Self::U16, Self::I16, Self::U32, Self::I32];
        kinds.get(code as usize).copied().ok_or(Flaw::Damage)
    }

    /// Size in bytes; 0 for texts.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 | Self::Bool => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
            Self::Timestamp => TIMESTAMP_BYTES,
            Self::Other(size) => size,
        }
    }

    /// Time stamp at the start of `bytes`, in 2^-64 s since 1904; 0 for other content.
    pub(super) fn stamp(self, bytes: &[u8], is_big: bool) -> u128 {
        match bytes.first_chunk() {
            // The seconds are the upper half in both byte orders.
            Some(bytes) if self == Self::Timestamp && is_big => u128::from_be_bytes(*bytes),
            Some(bytes) if self == Self::Timestamp => u128::from_le_bytes(*bytes),
            _ => 0,
        }
    }

    /// Number at the start of `bytes`, a time stamp in s since `origin`; `None` for other content
    /// or if bytes are missing.
    pub(super) fn number(self, bytes: &[u8], is_big: bool, origin: u128) -> Option<f64> {
        macro_rules! read {
            ($type:ty) => {{
                let bytes = *bytes.first_chunk()?;
                if is_big { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) }
            }};
        }
        Some(match self {
            Self::I8 => f64::from(read!(i8)),
            Self::I16 => f64::from(read!(i16)),
            Self::I32 => f64::from(read!(i32)),
            Self::I64 => read!(i64) as f64,
            Self::U8 => f64::from(read!(u8)),
            Self::U16 => f64::from(read!(u16)),
            Self::U32 => f64::from(read!(u32)),
            Self::U64 => read!(u64) as f64,
            Self::F32 => f64::from(read!(f32)),
            Self::F64 => read!(f64),
            Self::Bool => f64::from(u8::from(read!(u8) != 0)),
            Self::Timestamp => seconds(read!(u128), origin),
            Self::Other(_) => return None,
        })
    }
}

/// Seconds from one time stamp to another.
pub(super) fn seconds(stamp: u128, origin: u128) -> f64 {
    stamp.wrapping_sub(origin).cast_signed() as f64 / STAMPS_PER_S
}

/// Place in a file from which fields are read in order.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(super) is_big: bool,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8], is_big: bool) -> Self {
        Self { bytes, at: 0, is_big }
    }

    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], Flaw> {
        let end = self.at.checked_add(count).ok_or(Flaw::Damage)?;
        let taken = self.bytes.get(self.at..end).ok_or(Flaw::Damage)?;
        self.at = end;
        Ok(taken)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Flaw> {
        let bytes = *self.take(4)?.first_chunk().ok_or(Flaw::Damage)?;
        Ok(if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    pub(super) fn u64(&mut self) -> Result<u64, Flaw> {
        let bytes = *self.take(8)?.first_chunk().ok_or(Flaw::Damage)?;
        Ok(if self.is_big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    /// Reads an integer that counts something in memory.
    pub(super) fn count(&mut self) -> Result<usize, Flaw> {
        usize::try_from(self.u64()?).map_err(|_| Flaw::Damage)
    }

    pub(super) fn text(&mut self) -> Result<String, Flaw> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }
}
