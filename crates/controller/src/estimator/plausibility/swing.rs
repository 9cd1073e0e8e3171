//! Largest speed of the journal's swing along its clearance.
//!
//! A fall from rest across the whole clearance under weight and load gives
//! `v^2 = 4 D (g + |F_L| |1 - R_l/R_d|/m)`; a rolling journal moves at the speed of the shaft's
//! surface. The limit is [`MARGIN`] times the former and twice the latter. It neglects the inertia
//! of the crank, which halves the speed along y, and friction: bench B stays below two thirds of
//! the limit. The limit applies to the displacement over [`SPAN`] samples, so that noise and single
//! samples, which the jump check covers, do not count. Over a longer span, a journal that circles
//! would return to its start.
//!
//! A swing above the limit shows that the position or the load is wrong, but not which of them.
//! Therefore it counts against the position, and the estimate is held. Where the load is known to
//! be faulty the swing is not checked: its samples carry the flag of that fault.

use crate::integrity::words;
use link::SensorFrame;

/// Samples over which the displacement is taken.
const SPAN: u32 = 14;
/// Period of the spans, samples.
const EVERY: u32 = 16;
/// Places at which a span begins and ends: they spread the work of the checks over the samples.
const BEGINS: u32 = 15;
const ENDS: u32 = 13;
/// Factor on the speed of the fall.
const MARGIN: f32 = 1.5;
const GRAVITY_M_S2: f32 = contact::GRAVITY_M_S2 as f32;

/// Parameters of the swing's limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SwingLimit {
    /// Radial clearance, m.
    pub(crate) radial_clearance_m: f32,
    /// Journal radius, m.
    pub(crate) journal_radius_m: f32,
    /// Acceleration of the journal by the load, m/s2 per N: `|1 - R_l/R_d|/m`.
    pub(crate) per_load: f32,
}

impl SwingLimit {
    /// No limit.
    pub(crate) const NONE: Self =
        Self { radial_clearance_m: f32::INFINITY, journal_radius_m: 0.0, per_load: 0.0 };
}

/// Limits of the displacement.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swing {
    base_nm2: f32,
    per_load_nm2: f32,
    per_angle: f32,
}
words!(Swing { base_nm2, per_load_nm2, per_angle });

/// Start of the current span.
#[derive(Clone, Debug, Default)]
pub(super) struct SwingState {
    index: u32,
    start: SensorFrame,
    has_start: bool,
}

impl Swing {
    pub(super) fn new(limit: &SwingLimit, period_us: u32) -> Self {
        let span_s = SPAN as f32 * period_us as f32 * 1e-6;
        // Squared displacement in nm2 per m/s2.
        let per = 4e18 * (MARGIN * span_s) * (MARGIN * span_s) * limit.radial_clearance_m;
        Self {
            base_nm2: per * GRAVITY_M_S2,
            // An infinite limit times an acceleration of 0 would be NaN.
            per_load_nm2: if limit.per_load > 0.0 { per * limit.per_load * 1e-3 } else { 0.0 },
            per_angle: 2.0 * limit.journal_radius_m,
        }
    }

    /// Takes a sample; returns true at the end of a span over which the displacement was too large.
    /// `is_load_good` is false if the load is known to be faulty.
    pub(super) fn update(&self, state: &mut SwingState, frame: &SensorFrame, is_load_good: bool) -> bool {
        let place = state.index;
        state.index = place.wrapping_add(1) % EVERY;
        if place == BEGINS {
            state.start = *frame;
            state.has_start = true;
        }
        if place != ENDS {
            return false;
        }
        let y = frame.journal_y_nm.wrapping_sub(state.start.journal_y_nm) as f32;
        let z = frame.journal_z_nm.wrapping_sub(state.start.journal_z_nm) as f32;
        let angle_nrad = frame.shaft_angle_nrad.wrapping_sub(state.start.shaft_angle_nrad) as f32;
        let surface = angle_nrad * self.per_angle;
        let load_mn = frame.load_force_mn.unsigned_abs() as f32;
        let limit = self.base_nm2 + self.per_load_nm2 * load_mn + surface * surface;
        state.has_start & is_load_good & (y * y + z * z > limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: SwingLimit =
        SwingLimit { radial_clearance_m: 0.5e-3, journal_radius_m: 0.0695, per_load: 0.2 / 150.0 };

    /// Counts how often a journal is too fast in 320 samples under 10 kN, for a speed along y and a
    /// speed of the shaft.
    fn too_fast(speed_m_s: f64, shaft_rad_s: f64) -> usize {
        let (swing, mut state) = (Swing::new(&LIMIT, 100), SwingState::default());
        (0..BEGINS + 160)
            .filter(|index| {
                let t = f64::from(*index) * 1e-4;
                swing.update(
                    &mut state,
                    &SensorFrame {
                        journal_y_nm: (speed_m_s * t * 1e9) as i32,
                        shaft_angle_nrad: (shaft_rad_s * t * 1e9) as i32,
                        load_force_mn: 10_000_000,
                        ..SensorFrame::default()
                    },
                    true,
                )
            })
            .count()
    }

    #[test]
    fn the_bound_is_the_fall_under_weight_and_load_with_its_margin() {
        // sqrt(4 * 0.5 mm * (9.81 + 13.33) m/s2) = 0.215 m/s.
        assert_eq!((too_fast(0.31, 0.0), too_fast(0.33, 0.0)), (0, 10));
        assert_eq!((too_fast(-0.31, 0.0), too_fast(-0.33, 0.0)), (0, 10));
        // 2 * 0.0695 m * 2 rad/s = 0.278 m/s on top, as squares.
        assert_eq!((too_fast(0.42, 2.0), too_fast(0.43, 2.0)), (0, 10));
    }

    #[test]
    fn without_a_limit_nothing_is_too_fast() {
        let (swing, mut state) = (Swing::new(&SwingLimit::NONE, 100), SwingState::default());
        for index in 0..100 {
            let far = SensorFrame { journal_y_nm: i32::MAX * (index % 2), ..SensorFrame::default() };
            assert!(!swing.update(&mut state, &far, true));
        }
    }
}
