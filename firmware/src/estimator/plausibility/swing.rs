//! How fast the journal can swing along its clearance.
//!
//! Falling from rest across the whole clearance under weight and load gives `v^2 = 4 D (g + |F_L| |1 - R_l/R_d|/m)`; rolling along, the
//! surface of the shaft gives its own speed. The bound is [`MARGIN`] times the former and twice the latter. It leaves out that the crank's
//! inertia slows the journal along y by a factor of two and that friction takes from it: bench B stays below two thirds of the bound. A
//! displacement over [`SPAN`] samples is held against it, so that noise and single samples do not count; those are the jump's. A longer span
//! would let a journal that circles come back to where it was.

use crate::constants::Sum;
use link::SensorFrame;

/// Samples over which the displacement is taken.
const SPAN: u32 = 14;
/// A span begins so often.
const EVERY: u32 = 16;
/// Places at which the displacement begins and ends: samples in which the tracker sums nothing up.
const BEGINS: u32 = 15;
const ENDS: u32 = 13;
/// Margin on the speed.
const MARGIN: f32 = 1.5;
const GRAVITY_M_S2: f32 = 9.81;

/// What limits the swing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingLimit {
    /// Radial clearance, m.
    pub radial_clearance_m: f32,
    /// Journal radius, m.
    pub journal_radius_m: f32,
    /// Acceleration of the journal by the load, m/s2 per N: `|1 - R_l/R_d|/m`.
    pub per_load: f32,
}

impl SwingLimit {
    /// No limit.
    pub const NONE: Self = Self { radial_clearance_m: f32::INFINITY, journal_radius_m: 0.0, per_load: 0.0 };
}

/// Watches the displacement.
#[derive(Clone, Debug, Default)]
pub(super) struct Swing {
    base_nm2: f32,
    per_load_nm2: f32,
    per_angle: f32,
    index: u32,
    /// Where the span began.
    from: SensorFrame,
    begun: bool,
}

impl Swing {
    pub(super) fn constants(&self, sum: &mut Sum) {
        sum.floats(&[self.base_nm2, self.per_load_nm2, self.per_angle]);
    }

    pub(super) fn new(limit: &SwingLimit, period_us: u32) -> Self {
        let span_s = SPAN as f32 * period_us as f32 * 1e-6;
        // Squared displacement in nm2 per m/s2.
        let per = 4e18 * (MARGIN * span_s) * (MARGIN * span_s) * limit.radial_clearance_m;
        Self {
            base_nm2: per * GRAVITY_M_S2,
            // An infinite limit times no acceleration is no number, which would never be exceeded either; but say so plainly.
            per_load_nm2: if limit.per_load > 0.0 { per * limit.per_load * 1e-3 } else { 0.0 },
            per_angle: 2.0 * limit.journal_radius_m,
            ..Self::default()
        }
    }

    /// Takes a sample; true at the end of a span over which the displacement was too large.
    pub(super) fn too_fast(&mut self, frame: &SensorFrame) -> bool {
        let place = self.index;
        self.index = place.wrapping_add(1) % EVERY;
        if place == BEGINS {
            self.from = *frame;
            self.begun = true;
        }
        if place != ENDS {
            return false;
        }
        let y = frame.journal_y_nm.wrapping_sub(self.from.journal_y_nm) as f32;
        let z = frame.journal_z_nm.wrapping_sub(self.from.journal_z_nm) as f32;
        let surface = frame.shaft_angle_nrad.wrapping_sub(self.from.shaft_angle_nrad) as f32 * self.per_angle;
        let load_mn = frame.load_force_mn.unsigned_abs() as f32;
        let bound = self.base_nm2 + self.per_load_nm2 * load_mn + surface * surface;
        self.begun & (y * y + z * z > bound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: SwingLimit =
        SwingLimit { radial_clearance_m: 0.5e-3, journal_radius_m: 0.0695, per_load: 0.2 / 150.0 };

    /// How often a journal that moves at a speed along y is too fast in 320 samples, under 10 kN, with the shaft at a speed.
    fn too_fast(speed_m_s: f64, shaft_rad_s: f64) -> usize {
        let mut swing = Swing::new(&LIMIT, 100);
        (0..BEGINS + 160)
            .filter(|index| {
                let t = f64::from(*index) * 1e-4;
                swing.too_fast(&SensorFrame {
                    journal_y_nm: (speed_m_s * t * 1e9) as i32,
                    shaft_angle_nrad: (shaft_rad_s * t * 1e9) as i32,
                    load_force_mn: 10_000_000,
                    ..SensorFrame::default()
                })
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
        let mut swing = Swing::new(&SwingLimit::NONE, 100);
        for index in 0..100 {
            let far = SensorFrame { journal_y_nm: i32::MAX * (index % 2), ..SensorFrame::default() };
            assert!(!swing.too_fast(&far));
        }
    }
}
