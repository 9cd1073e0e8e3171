//! From physical inputs to the columns that the networks see.
//!
//! Only `+ - * /`, comparison and `sqrtf`: every one of them is exact to the last bit under IEEE 754, so the
//! controller, its emulation and the host form the same numbers. Training uses this same code, in f32.
//!
//! All features lie in -1..=1 inside the training range; outside it the nearest value inside is taken (and flagged).

use crate::flags::Flags;
use crate::header::Header;
use crate::layout::{COLLISION_INPUTS, FRICTION_INPUTS};
use crate::state::ContactState;
use libm::sqrtf;

/// Largest i16 activation: a feature of 1.
pub const FULL_SCALE: f32 = 32767.0;

/// The force goes on growing with the deformation up to this multiple of the training range (and is flagged).
pub const EXTRAPOLATION: f32 = 4.0;

/// Collision features of a state, the state's flags, and the factor of the network's output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionColumn {
    /// The features.
    pub inputs: [f32; COLLISION_INPUTS],
    /// Factor that turns the network's output into the square root of the normal force; 0 without contact.
    pub root_force_factor: f32,
    /// Which inputs lie outside the training range.
    pub flags: Flags,
}

impl Header {
    /// Rate over the latched approach speed, with the floor applied, as it comes (not clamped).
    pub fn rate_ratio_of(&self, state: &ContactState) -> f32 {
        let speed = state.approach_speed_m_s;
        let floored = if speed > self.latch_floor_m_s { speed } else { self.latch_floor_m_s };
        state.deformation_rate_m_s / floored
    }

    /// The column of the collision network.
    ///
    /// Inputs: clearance `D`, deformation `d` (0 in a gap), `sqrt d`, ratio `r` of the rate to the approach speed, each
    /// over the upper end of its range; the penetration `d/(D + d)`; `r/(1 + |r|)`; `sqrt(D_low/(D + d))`;
    /// `sqrt((r - r_low)/(r_high - r_low))`.
    pub fn collision_column(&self, state: &ContactState) -> CollisionColumn {
        let contact = state.deformation_m > 0.0;
        let raw_ratio = self.rate_ratio_of(state);
        let clearance = self.radial_clearance_m.clamp(state.radial_clearance_m);
        let deformation = self.deformation_m.clamp(state.deformation_m);
        let ratio = self.rate_ratio.clamp(raw_ratio);
        let relative = deformation / self.deformation_m.high;
        let span = clearance + deformation;
        let magnitude = if ratio < 0.0 { -ratio } else { ratio };
        let unclamped = if contact { state.deformation_m / self.deformation_m.high } else { 0.0 };
        let unclamped = if unclamped > EXTRAPOLATION { EXTRAPOLATION } else { unclamped };
        let root_force_factor = match self.deformation_half_powers {
            0 => f32::from(u8::from(contact)),
            1 => sqrtf(unclamped),
            _ => unclamped,
        };
        CollisionColumn {
            inputs: [
                clearance / self.radial_clearance_m.high,
                relative,
                sqrtf(relative),
                ratio / self.rate_ratio.high,
                deformation / span,
                ratio / (1.0 + magnitude),
                sqrtf(self.radial_clearance_m.low / span),
                sqrtf((ratio - self.rate_ratio.low) / (self.rate_ratio.high - self.rate_ratio.low)),
            ],
            root_force_factor,
            flags: Flags::OUTSIDE_CLEARANCE.when(!self.radial_clearance_m.contains(state.radial_clearance_m))
                | Flags::OUTSIDE_DEFORMATION.when(state.deformation_m > self.deformation_m.high)
                | Flags::OUTSIDE_RATE_RATIO.when(contact && !self.rate_ratio.contains(raw_ratio))
                | Flags::OUTSIDE_SLIDING_SPEED
                    .when(contact && !self.sliding_speed_m_s.contains(state.sliding_speed_m_s)),
        }
    }

    /// The column of the friction network, from the square root of the normal force that the collision network gave
    /// and the sliding speed, whose sign is put back outside: friction is an odd function of the speed.
    ///
    /// Inputs: root force and speed `v` over the upper ends of their ranges, `v/(v + v_slow)`, `v/(v + v_fast)`.
    pub fn friction_column(&self, root_force: f32, sliding_speed_m_s: f32) -> [f32; FRICTION_INPUTS] {
        let magnitude = if sliding_speed_m_s < 0.0 { -sliding_speed_m_s } else { sliding_speed_m_s };
        let speed = self.sliding_speed_m_s.clamp(magnitude);
        let root = root_force / sqrtf(self.normal_force_n.high);
        [
            if root > 1.0 { 1.0 } else { root },
            speed / self.sliding_speed_m_s.high,
            speed / (speed + self.slow_speed_m_s),
            speed / (speed + self.fast_speed_m_s),
        ]
    }
}

/// Rounds features in -1..=1 to i16, halves away from zero.
pub fn quantise<const N: usize>(features: &[f32; N]) -> [i16; N] {
    features.map(|value| {
        let scaled = value * FULL_SCALE;
        (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i16
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantise_rounds_and_saturates() {
        assert_eq!(
            quantise(&[0.0, 1.0, -1.0, 2.0, 0.5 / FULL_SCALE, -0.4 / FULL_SCALE, f32::NAN]),
            [0, 32767, -32767, 32767, 1, 0, 0]
        );
    }
}
