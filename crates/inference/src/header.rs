//! The header of a model image: which bearing, which training, which ranges.

use crate::bearing::Bearing;
use crate::error::ImageError;
use crate::layout::{
    CHANNELS, COLLISION_INPUTS, FORMAT_VERSION, FRICTION_INPUTS, HEAD_COLUMNS, HEADER_LENGTH, KERNEL, MAGIC,
};
use crate::read::Reader;

/// Closed interval of a physical quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f32,
    /// Upper end.
    pub high: f32,
}

impl Range {
    /// Whether a value lies inside.
    pub fn contains(&self, value: f32) -> bool {
        value >= self.low && value <= self.high
    }

    /// The nearest value inside.
    pub fn clamp(&self, value: f32) -> f32 {
        if value < self.low {
            self.low
        } else if value > self.high {
            self.high
        } else {
            value
        }
    }

    fn is_ordered(&self) -> bool {
        self.low.is_finite() && self.high.is_finite() && self.low < self.high
    }
}

/// Everything an image says about itself apart from its weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// Bearing the networks were trained for.
    pub bearing: Bearing,
    /// Version of the image format.
    pub format_version: u16,
    /// Identity of the training: CRC-64 of the float checkpoint.
    pub training_id: u64,
    /// The collision network's output times the deformation (over its upper end) to the power of so many halves is
    /// the square root of the normal force.
    pub deformation_half_powers: u8,
    /// Training range of the radial clearance in m, above 0.
    pub radial_clearance_m: Range,
    /// Training range of the deformation in m, from 0.
    pub deformation_m: Range,
    /// Training range of the rate over the approach speed, symmetric.
    pub rate_ratio: Range,
    /// Training range of the sliding speed in m/s, symmetric.
    pub sliding_speed_m_s: Range,
    /// Range of the normal forces in the training set in N, from 0.
    pub normal_force_n: Range,
    /// Floor of the latched approach speed in m/s, above 0.
    pub latch_floor_m_s: f32,
    /// Speed in m/s at which the slow sliding feature `v/(v + v0)` is one half (onset of sliding).
    pub slow_speed_m_s: f32,
    /// The same for the second, faster feature (Stribeck range).
    pub fast_speed_m_s: f32,
    /// CRC-32 at the end of the image.
    pub crc: u32,
}

impl Header {
    /// Shape bytes of the collision network.
    pub(crate) const COLLISION_SHAPE: [u8; 4] =
        [COLLISION_INPUTS as u8, CHANNELS as u8, KERNEL as u8, HEAD_COLUMNS as u8];
    /// Shape bytes of the friction network.
    pub(crate) const FRICTION_SHAPE: [u8; 4] =
        [FRICTION_INPUTS as u8, CHANNELS as u8, KERNEL as u8, HEAD_COLUMNS as u8];

    /// Reads and checks the header's bytes; `length` and `crc` are those of the whole image.
    pub(crate) fn parse(bytes: &[u8], length: usize, crc: u32) -> Result<Self, ImageError> {
        let mut reader = Reader::new(bytes, length);
        if reader.array()? != MAGIC {
            return Err(ImageError::Magic);
        }
        let format_version = reader.u16()?;
        if format_version != FORMAT_VERSION {
            return Err(ImageError::Version { found: format_version, expected: FORMAT_VERSION });
        }
        let [code, deformation_half_powers] = reader.array()?;
        let bearing = Bearing::from_code(code).ok_or(ImageError::Bearing { found: code })?;
        let declared = reader.u32()?;
        if usize::try_from(declared) != Ok(length) {
            return Err(ImageError::DeclaredLength { found: declared, expected: length as u32 });
        }
        let training_id = reader.u64()?;
        let mut range = || Ok::<_, ImageError>(Range { low: reader.f32()?, high: reader.f32()? });
        let header = Self {
            bearing,
            format_version,
            training_id,
            deformation_half_powers,
            radial_clearance_m: range()?,
            deformation_m: range()?,
            rate_ratio: range()?,
            sliding_speed_m_s: range()?,
            normal_force_n: range()?,
            latch_floor_m_s: reader.f32()?,
            slow_speed_m_s: reader.f32()?,
            fast_speed_m_s: reader.f32()?,
            crc,
        };
        let _reserved: [u8; 8] = reader.array()?;
        for (network, expected) in [("collision", Self::COLLISION_SHAPE), ("friction", Self::FRICTION_SHAPE)]
        {
            let found: [u8; 4] = reader.array()?;
            if found != expected {
                return Err(ImageError::Shape { network, found, expected });
            }
        }
        header.check()?;
        Ok(header)
    }

    /// Refuses ranges that are not finite, not in order, or that the features cannot be formed from.
    pub(crate) fn check(&self) -> Result<(), ImageError> {
        let above_zero = |value: f32| value.is_finite() && value > 0.0;
        let from_zero = |range: &Range| range.is_ordered() && range.low == 0.0;
        let symmetric = |range: &Range| range.is_ordered() && range.low == -range.high;
        for (name, fine) in [
            ("deformation half powers", self.deformation_half_powers <= 2),
            (
                "radial clearance range",
                self.radial_clearance_m.is_ordered() && self.radial_clearance_m.low > 0.0,
            ),
            ("deformation range", from_zero(&self.deformation_m)),
            ("rate ratio range", symmetric(&self.rate_ratio)),
            ("sliding speed range", symmetric(&self.sliding_speed_m_s)),
            ("normal force range", from_zero(&self.normal_force_n)),
            ("latch floor", above_zero(self.latch_floor_m_s)),
            ("slow speed scale", above_zero(self.slow_speed_m_s)),
            ("fast speed scale", above_zero(self.fast_speed_m_s)),
        ] {
            if !fine {
                return Err(ImageError::Field { name });
            }
        }
        Ok(())
    }

    /// Writes the header's bytes.
    pub(crate) fn write(&self, length: usize, out: &mut [u8; HEADER_LENGTH]) {
        let floats = [
            self.radial_clearance_m.low,
            self.radial_clearance_m.high,
            self.deformation_m.low,
            self.deformation_m.high,
            self.rate_ratio.low,
            self.rate_ratio.high,
            self.sliding_speed_m_s.low,
            self.sliding_speed_m_s.high,
            self.normal_force_n.low,
            self.normal_force_n.high,
            self.latch_floor_m_s,
            self.slow_speed_m_s,
            self.fast_speed_m_s,
            0.0,
            0.0,
        ];
        let bytes = (MAGIC.into_iter())
            .chain(FORMAT_VERSION.to_le_bytes())
            .chain([self.bearing.code(), self.deformation_half_powers])
            .chain((length as u32).to_le_bytes())
            .chain(self.training_id.to_le_bytes())
            .chain(floats.into_iter().flat_map(f32::to_le_bytes))
            .chain(Self::COLLISION_SHAPE)
            .chain(Self::FRICTION_SHAPE);
        for (out, byte) in out.iter_mut().zip(bytes) {
            *out = byte;
        }
    }
}
