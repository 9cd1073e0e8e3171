//! Stick-slip of the bearing: friction that holds the contact, and the change between slips. The
//! rules are those of [`crate::plants::stick_slip`].
//!
//! The sliding acceleration `v_t' = th'' R_J + t.v' + t'.v` is affine in the friction force, with
//! `t' = w n` and `w` the turning rate of the line of centres. Its slope is the mobility `m_t`. So
//! `-v_t'(F_f = 0)/m_t` is the friction that keeps the sliding speed. A contact that is stopped
//! gets the impulse `-v_t/m_t`. The energy `v_t^2/(2 m_t)` becomes friction heat, and a rigid drive
//! takes part with the impulse on the fork.

use super::geometry::Geometry;
use super::{BRISTLE, BearingForces, STATES, State, Transmission};
use crate::integrate::{Slip, Touch};
use crate::plants::stick_slip::{Balance, StickingLaw};

/// Index of the friction heat, and of the fork's two works.
const HEAT: usize = 9;
const FORK_WORKS: [usize; 2] = [6, 7];

impl Transmission {
    /// Forces of a contact that touches, with the effects on friction.
    pub(super) fn forces_at(&self, time_s: f64, s: &State, g: &Geometry, touch: Touch) -> BearingForces {
        let view = self.view(g, touch.latched_m_s);
        let Some(law) = self.friction_law.sticking().filter(|_| view.deformation_m > 0.0) else {
            return self.with_effects(time_s, s, &view, self.forces_of(&view, s[BRISTLE]));
        };
        let normal_n = self.joint_law.law.force_n(g.depth_m, g.rate_m_s, touch.latched_m_s);
        let friction_n = match touch.slip {
            Slip::Sticking { .. } if law.is_rigid() => self.needed_n(time_s, s, g, normal_n),
            slip => {
                let sign = match slip {
                    Slip::Sliding { direction, .. } | Slip::BreakingAway { direction } => direction,
                    Slip::Sticking { .. } => law.elastic_sign(slip, time_s, s[BRISTLE]),
                    Slip::Smooth => (g.sliding_m_s / self.sign_width_m_s).tanh(),
                };
                let dry_n = law.force_n(slip, time_s, normal_n, g.sliding_m_s, s[BRISTLE]);
                let forces = BearingForces { normal_n, friction_n: dry_n * self.friction_level };
                self.effective_friction_n(time_s, s, &forces, (g.sliding_m_s, sign))
            }
        };
        BearingForces { normal_n, friction_n }
    }

    /// Computes the state derivative of a contact, or of a gap (`None`), and returns the fork force
    /// and the forces of the bearing.
    pub(super) fn rates<const ENERGIES: bool>(
        &self,
        time_s: f64,
        s: &State,
        g: &Geometry,
        touch: Option<Touch>,
        out: &mut State,
    ) -> (f64, BearingForces) {
        let forces = touch.map_or(BearingForces::default(), |touch| self.forces_at(time_s, s, g, touch));
        let bearing = self.on_shaft_at(g, &forces);
        let fork_n = self.motion::<ENERGIES>(time_s, s, g, touch.is_some(), &bearing, out);
        if let Some((law, touch)) = self.friction_law.sticking().zip(touch) {
            out[BRISTLE] = law.memory_rate(touch.slip, g.sliding_m_s, s[BRISTLE]);
            if law.is_rigid() && touch.slip.is_sticking() {
                // The speed is 0 up to the error of the integration.
                out[HEAT] = 0.0;
            }
        }
        (fork_n, forces)
    }

    /// Returns whether the slip of the contact has ended.
    pub(super) fn has_slip_ended_at(&self, time_s: f64, s: &State, g: &Geometry, touch: Touch) -> bool {
        self.friction_law.sticking().is_some_and(|law| {
            let balance = || self.balance(law, time_s, s, g, touch);
            law.has_ended(touch.slip, time_s, g.sliding_m_s, s[BRISTLE], balance)
        })
    }

    /// Chooses the next slip of the contact; stops the contact if it begins at standstill.
    pub(super) fn next_slip_at(&self, time_s: f64, s: &mut State, g: &Geometry, touch: Touch) -> Slip {
        let Some(law) = self.friction_law.sticking() else { return Slip::Smooth };
        let mut memory = s[BRISTLE];
        let balance = || self.balance(law, time_s, s, g, touch);
        let next = law.next(touch.slip, time_s, g.sliding_m_s, &mut memory, balance);
        s[BRISTLE] = memory;
        if next.is_stopped {
            self.stop(s, g);
        }
        next.slip
    }

    /// Balance of the contact at standstill.
    fn balance(&self, law: &StickingLaw, time_s: f64, s: &State, g: &Geometry, touch: Touch) -> Balance {
        let normal_n = self.joint_law.law.force_n(g.depth_m, g.rate_m_s, touch.latched_m_s);
        let needed_n = self.needed_n(time_s, s, g, normal_n);
        let sign = needed_n.signum();
        let friction_n = sign * law.break_away_n(normal_n) * self.friction_level;
        let forces = BearingForces { normal_n, friction_n };
        let limit_n = sign * self.effective_friction_n(time_s, s, &forces, (0.0, -sign));
        Balance { needed_n, limit_n: limit_n.max(0.0) }
    }

    /// Friction in N that keeps the sliding speed under a normal force.
    fn needed_n(&self, time_s: f64, s: &State, g: &Geometry, normal_n: f64) -> f64 {
        let without = self.on_shaft_at(g, &BearingForces { normal_n, friction_n: 0.0 });
        let mut out = [0.0; STATES];
        self.motion::<false>(time_s, s, g, true, &without, &mut out);
        let angular = match self.compliance {
            Some(_) => out[5],
            None => {
                let drive = g.drive.acceleration + self.drive_lever_m * g.sin * g.speed_rad_s * g.speed_rad_s;
                (drive - out[2]) / (self.drive_lever_m * g.cos)
            }
        };
        let turning = (g.ny * s[3] - g.nz * s[2]) / (s[0] * s[0] + s[1] * s[1]).sqrt();
        let acceleration = angular * self.journal_radius_m + g.nz * out[2] - g.ny * out[3];
        -(acceleration + turning * g.radial_m_s) / self.mobility(g, self.response(g))
    }

    /// Accelerations per newton of friction: of the journal along Y and Z, and of the crank.
    fn response(&self, g: &Geometry) -> [f64; 3] {
        let inertia = self.shaft.as_ref().map_or(self.inertia_kg_m2, |shaft| shaft.drive_kg_m2);
        let (lever, along_z) = (self.drive_lever_m * g.cos, -g.ny / self.mass_kg);
        if self.compliance.is_some() {
            return [g.nz / self.mass_kg, along_z, self.journal_radius_m / inertia];
        }
        let along_y = (g.nz - self.journal_radius_m / lever) / (self.mass_kg + inertia / (lever * lever));
        [along_y, along_z, -along_y / lever]
    }

    /// Sliding acceleration per newton of friction, 1/kg.
    fn mobility(&self, g: &Geometry, [y, z, angle]: [f64; 3]) -> f64 {
        g.nz * y - g.ny * z + self.journal_radius_m * angle
    }

    /// Removes the sliding speed by an impulse of friction.
    fn stop(&self, s: &mut State, g: &Geometry) {
        let response = self.response(g);
        let impulse = -g.sliding_m_s / self.mobility(g, response);
        let [y, z, angle] = response.map(|rate| rate * impulse);
        s[2] += y;
        s[3] += z;
        s[HEAT] -= 0.5 * impulse * g.sliding_m_s;
        if self.compliance.is_some() {
            s[5] += angle;
        } else {
            let fork_work_j = (self.mass_kg * y - impulse * g.nz) * g.drive.rate;
            for (place, work_j) in FORK_WORKS.into_iter().zip([fork_work_j, fork_work_j.abs()]) {
                s[place] += work_j;
            }
        }
    }
}
