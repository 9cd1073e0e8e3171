//! Equations of motion of a world.
//!
//! The mechanism is a Rapson slide: fork with given motion `x_f(t)`, drive crank, shaft with its
//! journal at `(y, z)` from the bearing's centre, load crank. With `R_c = R_d cos th`:
//!
//! ```text
//! sin th = (x_f - y)/R_d                      th' = (x_f' - y')/R_c
//! (m + J/R_c^2) y'' = J (x_f'' + R_d sin th th'^2)/R_c^2 + F_L (1 - R_l/R_d) + F_cy - T_f/R_c
//! m z'' = F_cz - m g                          fork force = m y'' - F_L - F_cy
//! F_c = -F_n n + F_f t,  n = (y, z)/a,  t = (n_z, -n_y),  T_f = F_f R_J,  v_t = th' R_J + v.t
//! F_n = (pi/8) E* sqrt(2 d (3 D + 2 d)^2/(D + d)^3) d^1.5 (1 + chi d'/d'_0),  d = a - D
//! F_f = -mu(v_t) tanh(v_t/v_r) F_n
//! ```
//!
//! The contact law is the hybrid one of Bai and Zhao as printed in the paper, with the damping
//! factor of Zhiying and Qishao.

use crate::row::Row;
use crate::world::World;
use std::f64::consts::PI;

/// Gravity, m/s2. Not `contact::GRAVITY_M_S2`: this crate depends on nothing.
pub(crate) const GRAVITY_M_S2: f64 = 9.81;
/// Deformation at which a changed exponent leaves the elastic force as it is, m.
const EXPONENT_PIVOT_M: f64 = 20e-6;

/// Journal position along y and z in m, and their velocities in m/s.
pub(crate) type State = [f64; 4];

/// A world with its derived constants.
pub(crate) struct Equations<'a> {
    world: &'a World,
    journal_radius_m: f64,
    effective_modulus_pa: f64,
    dissipation_factor: f64,
}

impl<'a> Equations<'a> {
    pub(crate) fn new(world: &'a World) -> Self {
        Self {
            world,
            journal_radius_m: world.journal_radius_m(),
            effective_modulus_pa: world.effective_modulus_pa(),
            dissipation_factor: world.dissipation_factor(),
        }
    }

    /// Returns deformation and its rate.
    pub(crate) fn deformation(&self, [y, z, vy, vz]: &State) -> (f64, f64) {
        let distance = (y * y + z * z).sqrt();
        (distance - self.world.radial_clearance_m, (y * vy + z * vz) / distance)
    }

    fn elastic_n(&self, d: f64) -> f64 {
        let gap = self.world.radial_clearance_m;
        let span = gap + d;
        let force = PI / 8.0 * self.effective_modulus_pa * (3.0 * gap + 2.0 * d) / span * d * d;
        let changed = self.world.exponent_change;
        let factor = if changed == 0.0 { 1.0 } else { (d / EXPONENT_PIVOT_M).powf(changed) };
        force * (2.0 / span).sqrt() * factor
    }

    /// Returns the friction coefficient with the sign of the sliding speed.
    fn coefficient(&self, sliding_m_s: f64) -> f64 {
        let (World { friction, stribeck_rise, .. }, speed) = (self.world, sliding_m_s.abs());
        let drop = friction.static_coefficient - friction.coulomb_coefficient;
        let mut coefficient = friction.coulomb_coefficient
            + drop * (-speed / friction.stribeck_speed_m_s).exp()
            + friction.viscous_slope_s_m * (speed - friction.viscous_onset_m_s).max(0.0);
        if *stribeck_rise != 0.0 {
            coefficient += stribeck_rise * (-speed / self.world.stribeck_rise_speed_m_s).exp();
        }
        coefficient * (sliding_m_s / friction.regularisation_m_s).tanh()
    }

    /// Returns the derivative of a state and all quantities; no latched speed is a gap.
    pub(crate) fn at(&self, time_s: f64, state: &State, latched_m_s: Option<f64>) -> (State, Row) {
        let (w, [y, z, vy, vz]) = (self.world, *state);
        let [x, v, a] = w.drive_at(time_s);
        let sine = (x - y) / w.drive_lever_m;
        let lever = w.drive_lever_m * (1.0 - sine * sine).sqrt();
        let speed = (v - vy) / lever;
        let (deformation, rate) = self.deformation(state);
        let distance = deformation + w.radial_clearance_m;
        let (ny, nz) = (y / distance, z / distance);
        let sliding = speed * self.journal_radius_m + vy * nz - vz * ny;
        let (mut normal, mut friction) = (0.0, 0.0);
        if let (Some(latched), true) = (latched_m_s, deformation > 0.0) {
            let damping = self.dissipation_factor * rate / latched.max(w.latch_floor_m_s);
            normal = (self.elastic_n(deformation) * (1.0 + damping)).max(0.0);
            friction = -self.coefficient(sliding) * normal;
        }
        let (force_y, force_z) = (-normal * ny + friction * nz, -normal * nz - friction * ny);
        let (torque, load) = (friction * self.journal_radius_m, w.load_at(time_s));
        let reflected = w.inertia_kg_m2 / (lever * lever);
        let driven = reflected * (a + w.drive_lever_m * sine * speed * speed);
        let lateral = load * (1.0 - w.load_lever_m / w.drive_lever_m) + force_y - torque / lever;
        let acceleration = (driven + lateral) / (w.mass_kg + reflected);
        let row = Row {
            time_s,
            journal_y_m: y,
            journal_z_m: z,
            velocity_y_m_s: vy,
            velocity_z_m_s: vz,
            shaft_angle_rad: sine.asin(),
            shaft_speed_rad_s: speed,
            drive_velocity_m_s: v,
            drive_force_n: w.mass_kg * acceleration - load - force_y,
            load_force_n: load,
            normal_force_n: normal,
            friction_force_n: friction,
            force_y_n: force_y,
            force_z_n: force_z,
            friction_torque_nm: torque,
            deformation_m: deformation,
            deformation_rate_m_s: rate,
            sliding_speed_m_s: sliding,
        };
        ([vy, vz, acceleration, force_z / w.mass_kg - GRAVITY_M_S2], row)
    }
}
