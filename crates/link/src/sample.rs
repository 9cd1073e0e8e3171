//! The two frames of a tick: one sample of the sensors and its estimate.
//!
//! An estimate has a fixed layout on the wire ([`EstimateLayout`]): one byte for its kind, then
//! words, so that it can be encoded word by word ([`crate::encode_estimate`]). In the name of an
//! integer `_nm` means nanometres, in the name of a float newton metres.

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
    /// Shaft angle, nrad, modulo 2^32.
    pub shaft_angle_nrad: i32,
    /// Load force along y, mN.
    pub load_force_mn: i32,
}

/// Number of floats in an [`EstimateFrame`].
pub const VALUES: usize = 19;

/// Estimate for one sample.
///
/// Deviations are standard deviations. Those of force and torque are infinite while nothing is
/// known and while the estimate is held or tripped.
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
    /// Deviation of the normal force, N.
    pub normal_force_sd_n: f32,
    /// Deviation of the force vector, N.
    pub force_sd_n: f32,
    /// Deviation of the friction torque, N m.
    pub friction_torque_sd_nm: f32,
    /// Normal force of the networks at the estimated contact, N.
    pub network_force_n: f32,
    /// Friction torque of the networks at the estimated contact, N m.
    pub network_torque_nm: f32,
    /// Normal force of the analytic law at the estimated contact, N.
    pub law_force_n: f32,
    /// Friction torque of the analytic law at the estimated contact, N m.
    pub law_torque_nm: f32,
    /// Radial clearance, m.
    pub clearance_m: f32,
    /// Deviation of the clearance, m.
    pub clearance_sd_m: f32,
    /// Stiffness of the contact over that of networks or law.
    pub stiffness_factor: f32,
    /// Deviation of the stiffness factor.
    pub stiffness_sd: f32,
    /// Friction over that of networks or law.
    pub friction_factor: f32,
    /// Deviation of the friction factor.
    pub friction_sd: f32,
    /// Flags of the networks (bits 0 to 14), and those that the controller adds (bits 15 to 31).
    pub flags: u32,
    /// Number of activations that saturated in this sample.
    pub saturated: u16,
    /// Timer ticks of the previous complete tick; 0 on the host. Not part of the result.
    pub instruction_ticks: u32,
}

impl EstimateFrame {
    /// Estimate while nothing is known: forces of 0, infinite deviations.
    pub const UNKNOWN: Self = Self {
        sequence: 0,
        time_us: 0,
        normal_force_n: 0.0,
        force_y_n: 0.0,
        force_z_n: 0.0,
        friction_torque_nm: 0.0,
        deformation_m: 0.0,
        contact_angle_rad: 0.0,
        normal_force_sd_n: f32::INFINITY,
        force_sd_n: f32::INFINITY,
        friction_torque_sd_nm: f32::INFINITY,
        network_force_n: 0.0,
        network_torque_nm: 0.0,
        law_force_n: 0.0,
        law_torque_nm: 0.0,
        clearance_m: 0.0,
        clearance_sd_m: f32::INFINITY,
        stiffness_factor: 1.0,
        stiffness_sd: f32::INFINITY,
        friction_factor: 1.0,
        friction_sd: f32::INFINITY,
        flags: 0,
        saturated: 0,
        instruction_ticks: 0,
    };

    /// Makes the deviations of force and torque infinite: the values are not those of this sample.
    pub const fn forget_deviations(&mut self) {
        self.normal_force_sd_n = f32::INFINITY;
        self.force_sd_n = f32::INFINITY;
        self.friction_torque_sd_nm = f32::INFINITY;
    }

    /// Returns `true` if two estimates agree in every bit of every field except the tick count.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }

    /// The bits of the floats, in their order.
    #[must_use]
    #[inline]
    pub fn value_bits(&self) -> [u32; VALUES] {
        self.values().map(f32::to_bits)
    }

    fn bits(&self) -> (u32, u32, [u32; VALUES], u32, u16) {
        (self.sequence, self.time_us, self.value_bits(), self.flags, self.saturated)
    }
}

/// Lists the floats of an estimate once, in the order of the wire.
macro_rules! in_order {
    ($($field:ident),+ $(,)?) => {
        impl EstimateFrame {
            /// The floats, in their order.
            #[must_use]
            #[inline]
            pub const fn values(&self) -> [f32; VALUES] {
                [$(self.$field),+]
            }

            /// Replaces the floats, in their order.
            pub const fn set_values(&mut self, values: [f32; VALUES]) {
                [$(self.$field),+] = values;
            }
        }
    };
}

in_order! {
    normal_force_n,
    force_y_n,
    force_z_n,
    friction_torque_nm,
    deformation_m,
    contact_angle_rad,
    normal_force_sd_n,
    force_sd_n,
    friction_torque_sd_nm,
    network_force_n,
    network_torque_nm,
    law_force_n,
    law_torque_nm,
    clearance_m,
    clearance_sd_m,
    stiffness_factor,
    stiffness_sd,
    friction_factor,
    friction_sd,
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

/// Number of words of an [`EstimateLayout`].
const WORDS: usize = VALUES + 5;

/// Bytes of an estimate after the byte of its kind: `dropped` and `saturated`, then little-endian
/// words: number, sequence, time, the floats in order, flags, ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EstimateLayout(pub [u8; 3], pub [[u8; 4]; WORDS]);

impl From<NumberedEstimate> for EstimateLayout {
    #[inline]
    fn from(numbered: NumberedEstimate) -> Self {
        let estimate = numbered.estimate;
        let [low, high] = estimate.saturated.to_le_bytes();
        let mut words = [0; WORDS];
        let [number, sequence, time_us, values @ .., flags, ticks] = &mut words;
        (*number, *sequence, *time_us) = (numbered.number, estimate.sequence, estimate.time_us);
        *values = estimate.value_bits();
        (*flags, *ticks) = (estimate.flags, estimate.instruction_ticks);
        Self([numbered.dropped, low, high], words.map(u32::to_le_bytes))
    }
}

impl From<EstimateLayout> for NumberedEstimate {
    fn from(EstimateLayout([dropped, low, high], words): EstimateLayout) -> Self {
        let [number, sequence, time_us, values @ .., flags, instruction_ticks] =
            words.map(u32::from_le_bytes);
        let mut estimate = EstimateFrame {
            sequence,
            time_us,
            flags,
            saturated: u16::from_le_bytes([low, high]),
            instruction_ticks,
            ..EstimateFrame::default()
        };
        estimate.set_values(values.map(f32::from_bits));
        Self { number, dropped, estimate }
    }
}
