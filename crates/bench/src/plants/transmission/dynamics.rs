//! Equations of the transmission bench at one state: accelerations, works, memories.

use super::bearing::OnShaft;
use super::geometry::Geometry;
use super::{
    BREAKAWAY, BRISTLE, BearingForces, LOAD_ANGLE, LOAD_SPEED, RISE, STATES, Snapshot, State, Transmission,
};
use crate::description::ripples;
use crate::integrate::{ContactAngles, ContactPlant, ContactReading, Slip, Touch};
use contact::GRAVITY_M_S2;

/// Rate at which bristles straighten without contact.
const BRISTLE_RECOVERY_PER_S: f64 = 1e3;

impl Transmission {
    /// Computes the state derivative under a held action of the bearing, and returns the power in W
    /// that is lost because it keeps its direction while the journal moves.
    pub(crate) fn dynamics(&self, time_s: f64, s: &State, bearing: &OnShaft, out: &mut State) -> f64 {
        let g = self.geometry(time_s, s);
        self.motion::<true>(time_s, s, &g, g.depth_m > 0.0, bearing, out);
        let held_power =
            bearing.force_y_n * s[2] + bearing.force_z_n * s[3] + bearing.torque_nm * g.speed_rad_s;
        let loss_at_contact =
            bearing.normal_n * g.rate_m_s - bearing.friction_n * g.sliding_m_s + bearing.film_loss_w;
        -held_power - loss_at_contact
    }

    /// Computes as [`Self::dynamics`] at a known geometry; works and losses only if `ENERGIES` is
    /// set.
    pub(super) fn motion<const ENERGIES: bool>(
        &self,
        time_s: f64,
        s: &State,
        g: &Geometry,
        touching: bool,
        bearing: &OnShaft,
        out: &mut State,
    ) -> f64 {
        let (force_y, force_z) = (bearing.force_y_n, bearing.force_z_n);
        let lever = self.drive_lever_m * g.cos;
        let (load_cos, load_speed) = match self.shaft {
            None => (g.cos, g.speed_rad_s),
            Some(_) => (s[LOAD_ANGLE].cos(), s[LOAD_SPEED]),
        };
        let load_rate = s[2] + self.load_lever_m * load_cos * load_speed;
        let mut cylinder = self.load.at(time_s).value;
        if !self.extension.load_ripples.is_empty() {
            cylinder += ripples(&self.extension.load_ripples, time_s);
        }
        let load_friction = self.load_friction.as_ref().map_or(0.0, |f| f.force_n(load_rate));
        let load = cylinder + load_friction;
        let mut torque = bearing.torque_nm;
        if !self.extension.position_ripples.is_empty() {
            torque += ripples(&self.extension.position_ripples, g.angle_rad());
        }
        // On a flexible shaft the load acts on the drive's end only through the shaft.
        let (mut twist_loss, mut load_angular, mut inertia) = (0.0, 0.0, self.inertia_kg_m2);
        let mut load_torque = load * self.load_lever_m * load_cos;
        if let Some(shaft) = &self.shaft {
            let (through, loss) = shaft.torque_nm(g.angle_rad(), g.speed_rad_s, s[LOAD_ANGLE], s[LOAD_SPEED]);
            load_angular = (load_torque - through) / shaft.load_kg_m2;
            (load_torque, twist_loss, inertia) = (through, loss, shaft.drive_kg_m2);
        }
        let (acceleration_y, angular, fork) = match &self.compliance {
            None => {
                let drive_term =
                    g.drive.acceleration + self.drive_lever_m * g.sin * g.speed_rad_s * g.speed_rad_s;
                let reduced = inertia / (lever * lever);
                let load_part = match self.shaft {
                    None => load * (1.0 - self.load_lever_m / self.drive_lever_m),
                    Some(_) => load - load_torque / lever,
                };
                let y =
                    (reduced * drive_term + load_part + force_y - torque / lever) / (self.mass_kg + reduced);
                (y, 0.0, self.mass_kg * y - load - force_y)
            }
            Some(compliance) => {
                let gap = g.drive.value - s[0] - self.drive_lever_m * g.sin;
                let gap_rate = g.drive.rate - s[2] - lever * g.speed_rad_s;
                let fork = compliance.force_n(gap, gap_rate);
                let angular = (fork * lever + load_torque + torque) / inertia;
                ((fork + load + force_y) / self.mass_kg, angular, fork)
            }
        };
        let friction_heat = -bearing.friction_n * g.sliding_m_s;
        *out = [0.0; STATES];
        [out[0], out[1], out[2], out[3]] =
            [s[2], s[3], acceleration_y, force_z / self.mass_kg - GRAVITY_M_S2];
        if self.compliance.is_some() {
            [out[4], out[5]] = [g.speed_rad_s, angular];
        }
        if ENERGIES {
            // Each term follows from its own law, none from the others: a force without matching
            // work leaves a residual.
            let drive_power = fork * (s[2] + lever * g.speed_rad_s);
            let elastic = if touching { self.joint_law.elastic.force_n(g.depth_m) } else { 0.0 };
            let damping_loss = (bearing.normal_n - elastic) * g.rate_m_s;
            [out[6], out[7], out[8]] = [drive_power, drive_power.abs(), cylinder * load_rate];
            out[9] = friction_heat;
            out[10] = damping_loss + bearing.film_loss_w + twist_loss;
            out[11] = -load_friction * load_rate;
        }
        if self.shaft.is_some() {
            [out[LOAD_ANGLE], out[LOAD_SPEED]] = [s[LOAD_SPEED], load_angular];
        }
        self.memory_rates(s, g, touching, friction_heat, out);
        fork
    }

    /// Computes the rates of the friction memories.
    fn memory_rates(&self, s: &State, g: &Geometry, touching: bool, heat_w: f64, out: &mut State) {
        let distance = self.extension.presliding_distance_m;
        // Bristles without contact straighten.
        out[BRISTLE] = if !touching {
            -BRISTLE_RECOVERY_PER_S * s[BRISTLE]
        } else if distance > 0.0 {
            let sign = (g.sliding_m_s / self.sign_width_m_s).tanh();
            g.sliding_m_s.abs() / distance * (sign - s[BRISTLE])
        } else {
            self.friction_law.rate_m_s(g.sliding_m_s, s[BRISTLE])
        };
        if let Some(term) = &self.extension.breakaway {
            out[BREAKAWAY] = term.rate_per_s(s[BREAKAWAY], g.sliding_m_s);
        }
        if let Some(term) = &self.extension.thermal {
            out[RISE] = term.rate_k_s(s[RISE], heat_w);
        }
    }

    /// Returns all quantities at a state under given forces.
    pub fn snapshot(&self, time_s: f64, s: &State, latched_m_s: f64, forces: BearingForces) -> Snapshot {
        let g = self.geometry(time_s, s);
        let bearing = self.on_shaft_at(&g, &forces);
        let mut derivative = [0.0; STATES];
        let drive_force_n = self.motion::<false>(time_s, s, &g, g.depth_m > 0.0, &bearing, &mut derivative);
        Snapshot {
            time_s,
            angle_rad: g.angle_rad(),
            speed_rad_s: g.speed_rad_s,
            y_m: s[0],
            z_m: s[1],
            contact: self.view(&g, latched_m_s),
            forces,
            force_y_n: bearing.force_y_n,
            force_z_n: bearing.force_z_n,
            friction_torque_nm: bearing.torque_nm,
            drive_force_n,
            // As its sensor shows it: without the ripple of an effect.
            load_force_n: self.load.at(time_s).value,
            drive: self.drive.at(time_s),
        }
    }
}

impl ContactPlant<STATES> for Transmission {
    fn derivative(&self, time_s: f64, state: &State, touch: Option<Touch>, derivative: &mut State) {
        self.rates::<true>(time_s, state, &self.geometry(time_s, state), touch, derivative);
    }

    fn deformation(&self, time_s: f64, s: &State) -> (f64, f64) {
        if self.extension.out_of_round_m != [0.0; 2] {
            let g = self.geometry(time_s, s);
            return (g.depth_m, g.rate_m_s);
        }
        let distance = (s[0] * s[0] + s[1] * s[1]).sqrt();
        let rate = if distance > 0.0 { (s[0] * s[2] + s[1] * s[3]) / distance } else { 0.0 };
        (distance - self.radial_clearance_m, rate)
    }

    fn contact(&self, time_s: f64, state: &State, latched_m_s: f64) -> ContactReading {
        let (depth_m, rate_m_s) = self.deformation(time_s, state);
        let force_n = self.joint_law.law.force_n(depth_m, rate_m_s, latched_m_s);
        ContactReading { depth_m, rate_m_s, force_n }
    }

    fn angles(&self, time_s: f64, state: &State) -> ContactAngles {
        ContactAngles {
            crank_rad: self.geometry(time_s, state).angle_rad(),
            contact_rad: state[1].atan2(state[0]),
        }
    }

    fn has_slip_ended(&self, time_s: f64, state: &State, touch: Touch) -> bool {
        self.has_slip_ended_at(time_s, state, &self.geometry(time_s, state), touch)
    }

    fn next_slip(&self, time_s: f64, state: &mut State, touch: Touch) -> Slip {
        let g = self.geometry(time_s, state);
        self.next_slip_at(time_s, state, &g, touch)
    }
}
