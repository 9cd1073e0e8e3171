//! Inputs and outputs in the layout of C. The header documents units and ranges.

use inference::{ContactState, Estimate, Model, Sample};

/// C's `pintle_state`: a sample in SI units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CState {
    pub(crate) radial_clearance_m: f32,
    pub(crate) deformation_m: f32,
    pub(crate) deformation_rate_m_s: f32,
    pub(crate) approach_speed_m_s: f32,
    pub(crate) sliding_speed_m_s: f32,
}

impl CState {
    pub(crate) fn to_state(self) -> ContactState {
        ContactState {
            radial_clearance_m: self.radial_clearance_m,
            deformation_m: self.deformation_m,
            deformation_rate_m_s: self.deformation_rate_m_s,
            approach_speed_m_s: self.approach_speed_m_s,
            sliding_speed_m_s: self.sliding_speed_m_s,
        }
    }
}

/// C's `pintle_sample`: a sample in integers.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CSample {
    pub(crate) radial_clearance_nm: u32,
    pub(crate) deformation_pm: i32,
    pub(crate) deformation_rate_nm_s: i32,
    pub(crate) approach_speed_nm_s: u32,
    pub(crate) sliding_speed_nm_s: i32,
}

impl CSample {
    pub(crate) fn to_sample(self) -> Sample {
        Sample {
            radial_clearance_nm: self.radial_clearance_nm,
            deformation_pm: self.deformation_pm,
            deformation_rate_nm_s: self.deformation_rate_nm_s,
            approach_speed_nm_s: self.approach_speed_nm_s,
            sliding_speed_nm_s: self.sliding_speed_nm_s,
        }
    }
}

/// C's `pintle_estimate`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CEstimate {
    pub(crate) normal_force_n: f32,
    pub(crate) friction_force_n: f32,
    pub(crate) normal_force_mn: i32,
    pub(crate) friction_force_mn: i32,
    pub(crate) flags: u32,
    pub(crate) saturated: u32,
}

impl CEstimate {
    pub(crate) fn from_estimate(estimate: &Estimate) -> Self {
        Self {
            normal_force_n: estimate.normal_force_n(),
            friction_force_n: estimate.friction_force_n(),
            normal_force_mn: estimate.normal_force_mn,
            friction_force_mn: estimate.friction_force_mn,
            flags: estimate.flags.bits(),
            saturated: estimate.saturated.into(),
        }
    }
}

/// C's `pintle_info`: what an image says of itself.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CInfo {
    pub(crate) training_id: u64,
    pub(crate) checksum: u32,
    pub(crate) bearing: u32,
    pub(crate) radial_clearance_low_m: f32,
    pub(crate) radial_clearance_high_m: f32,
    pub(crate) deformation_high_m: f32,
    pub(crate) rate_ratio_high: f32,
    pub(crate) sliding_speed_high_m_s: f32,
    pub(crate) normal_force_high_n: f32,
    pub(crate) approach_speed_floor_m_s: f32,
    pub(crate) reserved: u32,
}

impl CInfo {
    pub(crate) fn from_model(model: &Model<'_>) -> Self {
        let header = model.header();
        let clearance = header.radial_clearance_m();
        Self {
            training_id: header.training_id,
            checksum: model.checksum(),
            bearing: header.bearing.code().into(),
            radial_clearance_low_m: clearance.low,
            radial_clearance_high_m: clearance.high,
            deformation_high_m: header.deformation_m().high,
            rate_ratio_high: header.rate_ratio().high,
            sliding_speed_high_m_s: header.sliding_speed_m_s().high,
            normal_force_high_n: header.normal_force_n().high,
            approach_speed_floor_m_s: header.latch_floor_m_s(),
            reserved: 0,
        }
    }
}
