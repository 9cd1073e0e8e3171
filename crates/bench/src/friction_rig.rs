//! A single driven axis with given motion and a measured effort: the friction rig, or a linear axis.
//!
//! `effort = load_gain * load + inertia * acceleration + friction`, where friction opposes the motion:
//! `(coulomb_effort +- asymmetry/2 + (load_coefficient + mu) |load| radius) tanh(v/v_r) + viscous_effort * speed`.
//! The effort is the drive's, so friction adds to it while the axis moves forward.
//!
//! `mu` is the coefficient of the rubbing pair under `[surface]`, dry, sliding speed `v` in m/s, load `N` in N, mean pressure `p`
//! in MPa on 140 mm x 140 mm:
//!
//! * Babbitt: `.14 + .08 exp(-v/.010) (1 + .15 (N - 100e3)/100e3)`: falls with speed, the more the higher the load.
//! * plastic: `.08 (p/5)^-.15 + 6 (v - .0035)` from 3.5 mm/s to the 7.4 mm/s of the rig's range; flat up to 20 mm/s, then
//!   `.25 (v - .020)`.
//!
//! It follows the speed with a lag (frictional memory), and a rest raises it: the excess grows towards
//! `break_away_ratio - 1` over `break_away_time_s` at rest and is lost over `break_away_distance_m` of sliding. These are
//! assumptions in the shape of published curves; the anchors lie within a factor of two of them. Without `[surface]` the
//! effort is a function of motion and load alone.

use crate::description::{BearingMaterial, FrictionRig, Surface};
use crate::motion::Motion;

/// Area that the load rests on, m2.
const AREA_M2: f64 = 0.14 * 0.14;
/// Fastest sliding of the rig's own tests: 6 deg/s at a radius of 70 mm, rounded up.
const RIG_SPEED_M_S: f64 = 0.0074;
/// Speed below which a pair is at rest.
const REST_M_S: f64 = 1e-5;
/// Smallest pressure in MPa that the plastic's power law is taken at.
const LEAST_PRESSURE_MPA: f64 = 0.01;
/// Longest step of the memory of a rest, s.
const MEMORY_STEP_S: f64 = 1e-3;

/// Effort of the drive and its friction share, in N or N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Whole effort.
    pub effort: f64,
    /// Friction share, positive while it opposes forward motion.
    pub friction: f64,
}

/// The effort under a motion and a load, with a coefficient of the rubbing pair (0 without one).
fn effort_with(rig: &FrictionRig, motion: &Motion, load_n: f64, coefficient: f64) -> Effort {
    let axis = &rig.axis;
    let sign = (motion.rate * axis.friction_radius_m / axis.regularisation_m_s).tanh();
    let load_dependent = (axis.load_coefficient + coefficient) * load_n.abs() * axis.friction_radius_m;
    let dry = axis.coulomb_effort + load_dependent;
    let friction =
        dry * sign + 0.5 * axis.coulomb_asymmetry * sign * sign + axis.viscous_effort * motion.rate;
    Effort { effort: axis.load_gain * load_n + axis.inertia * motion.acceleration + friction, friction }
}

/// The efforts at ascending times under a motion and a load.
pub fn efforts(
    rig: &FrictionRig,
    times_s: &[f64],
    motion: impl Fn(f64) -> Motion,
    load_n: impl Fn(f64) -> f64,
) -> Vec<Effort> {
    let Some(surface) = &rig.surface else {
        return times_s.iter().map(|&t| effort_with(rig, &motion(t), load_n(t), 0.0)).collect();
    };
    let start_s = times_s.first().copied().unwrap_or_default();
    let sliding = |t: f64| (motion(t.max(start_s)).rate * rig.axis.friction_radius_m).abs();
    let (mut excess, mut last) = (0.0, start_s);
    let at = |&t: &f64| {
        // The memory of a rest, marched in steps that follow the speed.
        let steps = ((t - last) / MEMORY_STEP_S).ceil().max(1.0);
        let step = (t - last) / steps;
        for k in 0..steps as usize {
            excess = surface.remember(excess, sliding(last + (k as f64 + 0.5) * step), step);
        }
        last = t;
        let load = load_n(t);
        let coefficient = coefficient(surface.material, sliding(t - surface.lag_s), load) * (1.0 + excess);
        effort_with(rig, &motion(t), load, coefficient)
    };
    times_s.iter().map(at).collect()
}

/// Coefficient of a dry pair at a sliding speed in m/s (not negative) and a load in N.
pub fn coefficient(material: BearingMaterial, sliding_m_s: f64, load_n: f64) -> f64 {
    let load = load_n.abs();
    match material {
        BearingMaterial::Babbitt => {
            0.14 + 0.08 * (-sliding_m_s / 0.010).exp() * (1.0 + 0.15 * (load - 100e3) / 100e3)
        }
        BearingMaterial::Plastic => {
            let pressure = (load / AREA_M2 * 1e-6).max(LEAST_PRESSURE_MPA);
            0.08 * (pressure / 5.0).powf(-0.15)
                + 6.0 * (sliding_m_s.min(RIG_SPEED_M_S) - 0.0035).max(0.0)
                + 0.25 * (sliding_m_s - 0.020).max(0.0)
        }
    }
}

impl Surface {
    /// The excess of static friction after a step at a sliding speed.
    fn remember(&self, excess: f64, sliding_m_s: f64, step_s: f64) -> f64 {
        let full = self.break_away_ratio - 1.0;
        if sliding_m_s < REST_M_S {
            full + (excess - full) * (-step_s / self.break_away_time_s).exp()
        } else {
            excess * (-sliding_m_s * step_s / self.break_away_distance_m).exp()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bench;
    use crate::motion::Profile;

    fn rig(name: &str) -> FrictionRig {
        let Bench::FrictionRig(rig) = Bench::open(name).unwrap() else { panic!("{name}") };
        *rig
    }

    #[test]
    fn babbitt_falls_with_speed_and_more_at_load_while_plastic_rises() {
        use BearingMaterial::{Babbitt, Plastic};
        let drop = |load| coefficient(Babbitt, 0.0, load) - coefficient(Babbitt, 0.0073, load);
        assert!(drop(240e3) > 1.15 * drop(100e3) && drop(100e3) > 0.04);
        assert!((coefficient(Babbitt, 0.0, 100e3) - 0.22).abs() < 1e-15);
        assert_eq!(coefficient(Plastic, 0.001, 100e3), coefficient(Plastic, 0.003, 100e3));
        assert!((coefficient(Plastic, 0.0055, 98e3) - 0.08 - 6.0 * 0.002).abs() < 1e-12);
        assert!(coefficient(Plastic, 0.006, 240e3) < coefficient(Plastic, 0.006, 100e3));
        // A higher torque with Babbitt at every speed and load of the rig.
        for load in [100e3, 150e3, 200e3, 240e3] {
            for speed in [0.0, 0.002, 0.005, 0.0073] {
                assert!(coefficient(Babbitt, speed, load) > coefficient(Plastic, speed, load));
            }
        }
    }

    #[test]
    fn a_rest_raises_break_away_and_the_lag_opens_a_loop() {
        let rig = rig("friction-rig-babbitt");
        let drive = Profile::Resting { stroke: 1.3334, period_s: 40.0, cycles: 1.0, dwell_s: 5.0 };
        let times: Vec<f64> = (0..50_000).map(|i| 1e-3 * f64::from(i)).collect();
        let run = |rig: &FrictionRig| efforts(rig, &times, |t| drive.at(t), |_| 100e3);
        let (with, mut without) = (run(&rig), rig.clone());
        if let Some(s) = &mut without.surface {
            (s.break_away_ratio, s.lag_s) = (1.0, 0.0);
        }
        let without = run(&without);
        let peak = |e: &[Effort]| e[5000..8000].iter().map(|e| e.friction).fold(0.0, f64::max);
        let ratio = peak(&with) / peak(&without);
        assert!((1.15..1.26).contains(&ratio), "{ratio}");
        // Well into the sliding only the lag is left: more friction while speeding up, less while slowing down, by
        // `lag * dmu/dv * dv/dt * N R` = 0.92 N m 7 s after the start.
        let difference = |t: usize| with[t].friction - without[t].friction;
        assert!((difference(12_000) - 0.92).abs() < 0.02, "{}", difference(12_000));
        assert!(difference(20_000) < -1.0, "{}", difference(20_000));
        // The other direction is the mirror image.
        assert!((with[12_000].friction + with[37_000].friction).abs() < 1e-3 * with[12_000].friction);
    }

    #[test]
    fn without_a_surface_the_effort_is_a_function_of_the_moment() {
        let rig = rig("friction-rig");
        let motion = Motion { value: 0.0, rate: 0.1, acceleration: 0.02 };
        let all = efforts(&rig, &[0.0, 1.0], |_| motion, |_| 1e5);
        assert_eq!(all[0], all[1]);
        assert!((all[0].friction - 0.14 * 1e5 * 0.07).abs() < 1e-9);
        assert!((all[0].effort - all[0].friction - 5.0 * 0.02).abs() < 1e-9);
    }
}
