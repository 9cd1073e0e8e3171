//! Length from a converter's code: `(code - zero) * gain`, less an error from a table.
//!
//! The table has [`TABLE_POINTS`] errors in nm at evenly spaced codes, 0 to 65536, as a calibration
//! against a micrometer finds them, with linear interpolation.

use fixed::FixedI64;
use fixed::types::extra::U16;
use fixed::types::{I16F16, I32F0};

/// Number of points of a linearisation table: one every 4096 codes, and the end.
const TABLE_POINTS: usize = 17;
const SPACING_BITS: u32 = 12;
const HALF: FixedI64<U16> = FixedI64::lit("0.5");

/// Scale of one input.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Code at 0 nm.
    pub zero_code: u16,
    /// Length of a code, nm; negative if the code falls with the length.
    pub gain_nm: I16F16,
    /// Error of the straight line in nm; it is subtracted.
    pub table_nm: Option<&'static [i32; TABLE_POINTS]>,
}

impl Scale {
    /// Returns the length of a code, nm.
    #[must_use]
    pub(crate) fn length_nm(&self, code: u16) -> i32 {
        let error_nm = self.table_nm.map_or(0, |table| error_nm(table, code));
        linear(code, self.zero_code, self.gain_nm).wrapping_sub(error_nm).clamp(MIN_NM, MAX_NM) as i32
    }
}

/// Minimum of a length, nm: its negative is representable.
const MIN_NM: i64 = i32::MIN as i64 + 1;
/// Maximum of a length, nm.
const MAX_NM: i64 = i32::MAX as i64;

/// Returns `(code - zero) * gain`, rounded to the nearest integer; below 2^31.
pub(super) fn linear(code: u16, zero_code: u16, gain: I16F16) -> i64 {
    let from_zero = I32F0::from_bits(i32::from(code).wrapping_sub(zero_code.into()));
    from_zero.wide_mul(gain).wrapping_add(HALF).wrapping_to_num()
}

/// Returns the table's error at a code, nm.
fn error_nm(table: &[i32; TABLE_POINTS], code: u16) -> i64 {
    let place = usize::from(code >> SPACING_BITS);
    let remainder = i64::from(code & ((1 << SPACING_BITS) - 1));
    let mut ends = table.iter().skip(place);
    let (low, high) = (i64::from(*ends.next().unwrap_or(&0)), i64::from(*ends.next().unwrap_or(&0)));
    low.wrapping_add(high.wrapping_sub(low).wrapping_mul(remainder) >> SPACING_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_keeps_a_nanometre_over_the_whole_range() {
        // 2 mm over the codes, falling.
        let scale = Scale { zero_code: 65_535, gain_nm: I16F16::from_bits(-2_000_000), table_nm: None };
        for code in [0, 1, 1000, 32_768, 65_534, 65_535] {
            let exact = (65_535.0 - f64::from(code)) * 2e6 / 65_536.0;
            assert!((f64::from(scale.length_nm(code)) - exact).abs() <= 0.5, "{code}");
        }
    }

    #[test]
    fn the_table_is_exact_at_its_points_and_linear_between_them() {
        static TABLE: [i32; TABLE_POINTS] =
            [0, 100, -300, 50, 0, 7, 9, 1000, -1000, 0, 0, 0, 0, 0, 0, 400, 800];
        let scale = Scale { zero_code: 0, gain_nm: I16F16::lit("10"), table_nm: Some(&TABLE) };
        for (point, error) in TABLE[..16].iter().enumerate() {
            let code = (point * 4096) as u16;
            assert_eq!(scale.length_nm(code), i32::from(code) * 10 - error);
        }
        assert_eq!(scale.length_nm(6144), 61_440 + 100, "half way from 100 to -300");
        assert_eq!(scale.length_nm(65_535), 655_350 - 799, "a 4096th before the end");
    }

    #[test]
    fn no_code_and_no_gain_overflows() {
        for gain_nm in [I16F16::MIN, I16F16::MAX] {
            let ends = [0, u16::MAX]
                .map(|code| Scale { zero_code: 0x8000, gain_nm, table_nm: None }.length_nm(code));
            assert!(ends[0].signum() == -ends[1].signum() && ends[0].unsigned_abs() > 1 << 29);
        }
    }
}
