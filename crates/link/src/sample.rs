//! The two frames of a tick: one sample of the sensors and its estimate.
//!
//! An estimate has a fixed layout on the wire ([`EstimateLayout`]): one byte for its kind and 47
//! bytes of content, so that it can be encoded word by word ([`crate::encode_estimate`]).

use serde::{Deserialize, Serialize};

/// One sample of the sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensorFrame {
    /// Number of the sample, modulo 2^32.
    pub sequence: u32,
    /// Time of the sample, us, modulo 2^32.
    pub time_us: u32,
    /// Journal centre from the bearing's centre along y, nm.
    pub journal_y_nm: i32,
    /// Journal centre from the bearing's centre along z (up), nm.
    pub journal_z_nm: i32,
    /// Shaft angle, nrad, modulo 2^32: only its differences are used.
    pub shaft_angle_nrad: i32,
    /// Load force along y, mN. It enters no force; it limits the plausible swing and feeds the
    /// tracking.
    pub load_force_mn: i32,
}

/// Estimate for one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EstimateFrame {
    /// Sequence number of the sample.
    pub sequence: u32,
    /// Time of the sample, us.
    pub time_us: u32,
    /// Normal contact force, N, not negative.
    pub normal_force_n: f32,
    /// Force of the bearing on the journal along y, N: normal and friction together.
    pub force_y_n: f32,
    /// Force of the bearing on the journal along z, N: normal and friction together.
    pub force_z_n: f32,
    /// Torque of the bearing on the shaft, N m: `F_f R_J`, negative while the shaft slides forward.
    pub friction_torque_nm: f32,
    /// Deformation, m; negative values are the gap.
    pub deformation_m: f32,
    /// Direction of the journal from the bearing's centre, rad, from +y towards +z.
    pub contact_angle_rad: f32,
    /// Flags of the networks (bits 0 to 14), and those that the controller adds (bits 15 to 31).
    pub flags: u32,
    /// Number of activations that saturated in this sample.
    pub saturated: u16,
    /// Timer ticks of the previous complete tick; 0 on the host. Not part of the result.
    pub instruction_ticks: u32,
}

impl EstimateFrame {
    /// Returns `true` if two estimates agree in every bit of every field except the tick count.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }

    /// The bits of the six floats, in their order.
    #[must_use]
    #[inline]
    pub const fn value_bits(&self) -> [u32; 6] {
        [
            self.normal_force_n.to_bits(),
            self.force_y_n.to_bits(),
            self.force_z_n.to_bits(),
            self.friction_torque_nm.to_bits(),
            self.deformation_m.to_bits(),
            self.contact_angle_rad.to_bits(),
        ]
    }

    fn bits(&self) -> [u32; 10] {
        let [normal, y, z, torque, deformation, angle] = self.value_bits();
        let saturated = u32::from(self.saturated);
        [self.sequence, self.time_us, normal, y, z, torque, deformation, angle, self.flags, saturated]
    }
}

/// Estimate with its number, as it is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "EstimateLayout", into = "EstimateLayout")]
pub struct NumberedEstimate {
    /// Number of the estimate, modulo 2^32. A gap is a loss on the line or at the host.
    pub number: u32,
    /// Number of estimates that the controller dropped since it was configured, modulo 256.
    pub dropped: u8,
    /// Estimate.
    pub estimate: EstimateFrame,
}

/// Bytes of an estimate after the byte of its kind: `dropped` and `saturated`, then little-endian
/// words: number, sequence, time, the six floats in order, flags, ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EstimateLayout(pub [u8; 3], pub [[u8; 4]; 11]);

impl From<NumberedEstimate> for EstimateLayout {
    fn from(numbered: NumberedEstimate) -> Self {
        let estimate = numbered.estimate;
        let [low, high] = estimate.saturated.to_le_bytes();
        let [normal, y, z, torque, deformation, angle] = estimate.value_bits();
        let words = [
            numbered.number,
            estimate.sequence,
            estimate.time_us,
            normal,
            y,
            z,
            torque,
            deformation,
            angle,
            estimate.flags,
            estimate.instruction_ticks,
        ];
        Self([numbered.dropped, low, high], words.map(u32::to_le_bytes))
    }
}

impl From<EstimateLayout> for NumberedEstimate {
    fn from(EstimateLayout([dropped, low, high], words): EstimateLayout) -> Self {
        let [number, sequence, time_us, normal, y, z, torque, deformation, angle, flags, instruction_ticks] =
            words.map(u32::from_le_bytes);
        let estimate = EstimateFrame {
            sequence,
            time_us,
            normal_force_n: f32::from_bits(normal),
            force_y_n: f32::from_bits(y),
            force_z_n: f32::from_bits(z),
            friction_torque_nm: f32::from_bits(torque),
            deformation_m: f32::from_bits(deformation),
            contact_angle_rad: f32::from_bits(angle),
            flags,
            saturated: u16::from_le_bytes([low, high]),
            instruction_ticks,
        };
        Self { number, dropped, estimate }
    }
}
