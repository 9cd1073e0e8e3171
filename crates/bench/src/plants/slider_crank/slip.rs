//! Stick-slip of the joint: the friction that holds it, and the change between slips. The rules are
//! those of [`crate::plants::stick_slip`].
//!
//! The sliding acceleration `v_t' = b'' R_J + t.v' - w n.v`, with `w` the turning rate of `n`, is
//! affine in the friction force; its slope is the mobility `m_t`. So `-v_t'(F_f = 0)/m_t` is the
//! friction that keeps the sliding speed. A joint that is stopped gets the impulse `-v_t/m_t`.

use super::{Pose, SliderCrank};
use crate::integrate::{Slip, Touch};
use crate::plants::stick_slip::{Balance, StickingLaw};

impl SliderCrank {
    /// Friction in N that keeps the sliding speed under a normal force.
    pub(super) fn needed_n(&self, state: &[f64; 4], p: &Pose, normal_n: f64) -> f64 {
        let [rod, slider] = self.accelerations(p, Self::force_on_journal(p, normal_n, 0.0), 0.0);
        let (pin_ax, pin_ay) = self.pin_acceleration(p);
        let (l, swing) = (self.rod_length_m, self.rod_length_m * state[2] * state[2]);
        let ax = pin_ax - l * rod * p.rod_sin - swing * p.rod_cos - slider;
        let ay = pin_ay + l * rod * p.rod_cos - swing * p.rod_sin;
        let acceleration = rod * self.journal_radius_m - p.ny * ax + p.nx * ay - p.turning_rad_s * p.rate_m_s;
        -acceleration / self.mobility(p, self.response(p))
    }

    /// Accelerations of rod and slider per newton of friction.
    fn response(&self, p: &Pose) -> [f64; 2] {
        let moment = self.rod_length_m * (p.rod_cos * p.nx + p.rod_sin * p.ny) + self.journal_radius_m;
        [moment / self.rod_inertia_about_pin(), p.ny / self.slider_mass_kg]
    }

    /// Sliding acceleration per newton of friction, 1/kg.
    fn mobility(&self, p: &Pose, [rod, slider]: [f64; 2]) -> f64 {
        let (ax, ay) = (-self.rod_length_m * rod * p.rod_sin - slider, self.rod_length_m * rod * p.rod_cos);
        rod * self.journal_radius_m - p.ny * ax + p.nx * ay
    }

    /// Balance of the joint at standstill.
    pub(super) fn balance(
        &self,
        (law, level): (&StickingLaw, f64),
        state: &[f64; 4],
        p: &Pose,
        touch: Touch,
    ) -> Balance {
        let normal_n = self.normal_law.force_n(p.depth_m, p.rate_m_s, touch.latched_m_s);
        Balance { needed_n: self.needed_n(state, p, normal_n), limit_n: level * law.break_away_n(normal_n) }
    }

    /// Friction law of the joint that sticks, with its factor.
    pub(super) fn sticking(&self) -> Option<(&StickingLaw, f64)> {
        self.friction.as_ref().and_then(|(law, level)| Some((law.sticking()?, *level)))
    }

    /// Removes the sliding speed by an impulse of friction. Returns the energy in J that becomes
    /// heat, and the work of the crank.
    fn stop(&self, state: &mut [f64; 4], p: &Pose) -> [f64; 2] {
        let response = self.response(p);
        let impulse = -p.sliding_m_s / self.mobility(p, response);
        let [rod, slider] = response.map(|rate| rate * impulse);
        state[2] += rod;
        state[3] += slider;
        // Impulse of the crank on the rod: momentum of the rod less the impulse at the journal.
        let momentum = self.rod_mass_kg * 0.5 * self.rod_length_m * rod;
        let (x, y) = (-momentum * p.rod_sin + impulse * p.ny, momentum * p.rod_cos - impulse * p.nx);
        let pin_speed = self.crank_length_m * self.crank_speed_rad_s;
        [-0.5 * impulse * p.sliding_m_s, pin_speed * (y * p.crank_cos - x * p.crank_sin)]
    }

    /// Chooses the next slip; returns it with heat and work of the crank of a stop.
    pub(super) fn next_slip_at(&self, time_s: f64, state: &mut [f64; 4], touch: Touch) -> (Slip, [f64; 2]) {
        let Some((law, level)) = self.sticking() else { return (Slip::Smooth, [0.0; 2]) };
        let p = self.pose(time_s, state);
        let balance = || self.balance((law, level), state, &p, touch);
        let next = law.next(touch.slip, time_s, p.sliding_m_s, &mut 0.0, balance);
        (next.slip, if next.is_stopped { self.stop(state, &p) } else { [0.0; 2] })
    }
}
