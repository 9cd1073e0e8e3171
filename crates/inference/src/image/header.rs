//! Header of a model image: bearing, training and ranges.
//!
//! All ranges are integers in sufficiently small units; methods return them in SI units as `f32`.

use super::{FORMAT_VERSION, HEADER_LENGTH, ImageError, MAGIC};
use contact::BearingMaterial;

/// Closed interval of a physical quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f32,
    /// Upper end.
    pub high: f32,
}

impl Range {
    /// Decides whether a value lies inside.
    pub fn contains(&self, value: f32) -> bool {
        value >= self.low && value <= self.high
    }

    /// Returns the nearest value inside.
    pub fn clamp(&self, value: f32) -> f32 {
        if value < self.low {
            self.low
        } else if value > self.high {
            self.high
        } else {
            value
        }
    }
}

/// Everything that an image contains apart from its layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Header {
    /// Bearing the networks were trained for.
    pub bearing: BearingMaterial,
    /// Identity of the training: CRC-64 of the float checkpoint.
    pub training_id: u64,
    /// Exponent, in halves, of the normalised deformation that multiplies the collision output to
    /// give the square root of the normal force; 0, 1 or 2.
    pub deformation_half_powers: u8,
    /// Lower end of the training range of the radial clearance in nm, above 0.
    pub clearance_low_nm: u32,
    /// Upper end of the training range of the radial clearance in nm.
    pub clearance_high_nm: u32,
    /// Upper end of the training range of the deformation in pm; the lower is 0.
    pub deformation_high_pm: u32,
    /// Largest magnitude of the rate over the approach speed in the training range, times 2^16.
    pub rate_ratio_high_q16: u32,
    /// Largest magnitude of the sliding speed in the training range, nm/s.
    pub sliding_speed_high_nm_s: u32,
    /// Largest normal force of the training set in mN; the smallest is 0.
    pub normal_force_high_mn: u32,
    /// Floor of the latched approach speed in nm/s, above 0.
    pub latch_floor_nm_s: u32,
    /// Scale of the friction network's third input in nm/s: the onset of sliding.
    pub slow_speed_nm_s: u32,
    /// Scale of the friction network's fourth input in nm/s: the speed range of the Stribeck
    /// effect.
    pub fast_speed_nm_s: u32,
}

/// Largest value of a field in nm, pm or nm/s: 2^30, so that sums of two stay in 32 bits.
const MAX_FIELD: u32 = 1 << 30;

impl Header {
    /// Parses a header of an image of `length` bytes.
    pub(crate) fn parse(bytes: &[u8; HEADER_LENGTH], length: usize) -> Result<Self, ImageError> {
        let bytes: &[[u8; 4]; HEADER_LENGTH / 4] =
            bytes.as_chunks::<4>().0.try_into().map_err(|_| ImageError::TooShort)?;
        let [
            magic_low,
            magic_high,
            [version_low, version_high, bearing, half_powers],
            declared,
            id_low,
            id_high,
            fields @ ..,
        ] = *bytes;
        if [magic_low, magic_high].as_flattened() != MAGIC {
            return Err(ImageError::Magic);
        }
        let version = u16::from_le_bytes([version_low, version_high]);
        if version != FORMAT_VERSION {
            return Err(ImageError::Version { found: version, expected: FORMAT_VERSION });
        }
        let declared = u32::from_le_bytes(declared);
        if usize::try_from(declared) != Ok(length) {
            return Err(ImageError::Length { found: length, expected: declared });
        }
        let bearing = BearingMaterial::from_code(bearing).ok_or(ImageError::Bearing { found: bearing })?;
        let training_id =
            u64::from(u32::from_le_bytes(id_low)) | u64::from(u32::from_le_bytes(id_high)) << 32;
        let [low, high, deformation, ratio, sliding, force, floor, slow, fast, reserved] =
            fields.map(u32::from_le_bytes);
        let header = Self {
            bearing,
            training_id,
            deformation_half_powers: half_powers,
            clearance_low_nm: low,
            clearance_high_nm: high,
            deformation_high_pm: deformation,
            rate_ratio_high_q16: ratio,
            sliding_speed_high_nm_s: sliding,
            normal_force_high_mn: force,
            latch_floor_nm_s: floor,
            slow_speed_nm_s: slow,
            fast_speed_nm_s: fast,
        };
        header.check(reserved)?;
        Ok(header)
    }

    fn check(&self, reserved: u32) -> Result<(), ImageError> {
        // Features divide by the largest rate inside the range. At the floor that rate is the floor
        // times the ratio, in nm/s.
        let min_floor = (1u32 << 16).div_ceil(self.rate_ratio_high_q16.max(1));
        let fields = [
            (
                self.clearance_low_nm,
                1,
                self.clearance_high_nm.saturating_sub(1),
                "radial clearance, lower end in nm",
            ),
            (self.clearance_high_nm, 2, 2_000_000, "radial clearance, upper end in nm"),
            (self.deformation_high_pm, 1, MAX_FIELD, "deformation in pm"),
            // 1/16 to 64 times the approach speed.
            (self.rate_ratio_high_q16, 1 << 12, 1 << 22, "rate ratio times 2^16"),
            (self.sliding_speed_high_nm_s, 1, MAX_FIELD, "sliding speed in nm/s"),
            (self.normal_force_high_mn, 1, i32::MAX as u32, "normal force in mN"),
            (self.latch_floor_nm_s, min_floor, MAX_FIELD, "latch floor in nm/s"),
            (self.slow_speed_nm_s, 1, MAX_FIELD, "slow speed in nm/s"),
            (self.fast_speed_nm_s, 1, MAX_FIELD, "fast speed in nm/s"),
            (u32::from(self.deformation_half_powers), 0, 2, "half powers"),
            (reserved, 0, 0, "reserved number"),
        ];
        match fields.iter().find(|(found, low, high, _)| found < low || found > high) {
            Some(&(found, low, high, name)) => Err(ImageError::Field { name, found, expected: [low, high] }),
            None => Ok(()),
        }
    }

    /// Returns the header's bytes for an image of `length` bytes.
    pub(crate) fn to_bytes(self, length: u32) -> [u8; HEADER_LENGTH] {
        let [version_low, version_high] = FORMAT_VERSION.to_le_bytes();
        let mut words = [[0; 4]; HEADER_LENGTH / 4];
        let [magic_low, magic_high, kind, declared, id_low, id_high, fields @ ..] = &mut words;
        let [m0, m1, m2, m3, m4, m5, m6, m7] = MAGIC;
        (*magic_low, *magic_high) = ([m0, m1, m2, m3], [m4, m5, m6, m7]);
        *kind = [version_low, version_high, self.bearing.code(), self.deformation_half_powers];
        *declared = length.to_le_bytes();
        *id_low = (self.training_id as u32).to_le_bytes();
        *id_high = ((self.training_id >> 32) as u32).to_le_bytes();
        *fields = [
            self.clearance_low_nm,
            self.clearance_high_nm,
            self.deformation_high_pm,
            self.rate_ratio_high_q16,
            self.sliding_speed_high_nm_s,
            self.normal_force_high_mn,
            self.latch_floor_nm_s,
            self.slow_speed_nm_s,
            self.fast_speed_nm_s,
            0,
        ]
        .map(u32::to_le_bytes);
        bytemuck::cast(words)
    }

    /// Training range of the radial clearance in m.
    pub fn radial_clearance_m(&self) -> Range {
        Range { low: scaled(self.clearance_low_nm, 1e-9), high: scaled(self.clearance_high_nm, 1e-9) }
    }

    /// Training range of the deformation in m.
    pub fn deformation_m(&self) -> Range {
        Range { low: 0.0, high: scaled(self.deformation_high_pm, 1e-12) }
    }

    /// Training range of the rate over the approach speed.
    pub fn rate_ratio(&self) -> Range {
        let high = scaled(self.rate_ratio_high_q16, 1.0 / 65536.0);
        Range { low: -high, high }
    }

    /// Training range of the sliding speed in m/s.
    pub fn sliding_speed_m_s(&self) -> Range {
        let high = scaled(self.sliding_speed_high_nm_s, 1e-9);
        Range { low: -high, high }
    }

    /// Range of the normal forces of the training set in N.
    pub fn normal_force_n(&self) -> Range {
        Range { low: 0.0, high: scaled(self.normal_force_high_mn, 1e-3) }
    }

    /// Floor of the latched approach speed in m/s.
    pub fn latch_floor_m_s(&self) -> f32 {
        scaled(self.latch_floor_nm_s, 1e-9)
    }

    /// Scales of the friction network's third and fourth input in m/s.
    pub fn speed_scales_m_s(&self) -> [f32; 2] {
        [scaled(self.slow_speed_nm_s, 1e-9), scaled(self.fast_speed_nm_s, 1e-9)]
    }
}

fn scaled(value: u32, unit: f64) -> f32 {
    (f64::from(value) * unit) as f32
}
