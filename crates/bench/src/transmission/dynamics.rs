//! The equations of the transmission bench at one state: contact, laws, accelerations, works.

use super::{BRISTLE, BearingForces, ContactView, GRAVITY_M_S2, STATES, Snapshot, State, Transmission};
use crate::integrate::{ContactAngles, ContactPlant, ContactReading};
use crate::motion::Motion;

/// Largest sine of the crank angle under a rigid drive: the slide jams at 1.
pub(crate) const LARGEST_SINE: f64 = 0.9999;
/// Rate at which bristles out of contact straighten.
const BRISTLE_RECOVERY_PER_S: f64 = 1e3;

/// Where things are at one state; computed once and used by laws and equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry {
    /// Normal of the contact.
    pub(super) ny: f64,
    pub(super) nz: f64,
    /// Deformation in m and its rate.
    pub(super) depth_m: f64,
    pub(super) rate_m_s: f64,
    /// Crank.
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) speed_rad_s: f64,
    /// Sliding speed.
    pub(super) sliding_m_s: f64,
    /// Drive cylinder as the fork follows it.
    drive: Motion,
}

impl Transmission {
    /// Drive cylinder as the fork follows it.
    pub(super) fn drive_motion(&self, time_s: f64) -> Motion {
        self.drive.at(time_s - self.extension.drive_lag_s)
    }

    pub(super) fn geometry(&self, time_s: f64, s: &State) -> Geometry {
        let drive = self.drive_motion(time_s);
        let (sin, cos, speed_rad_s) = if self.compliance.is_some() {
            let (sin, cos) = s[4].sin_cos();
            (sin, cos, s[5])
        } else {
            let sin = ((drive.value - s[0]) / self.drive_lever_m).clamp(-LARGEST_SINE, LARGEST_SINE);
            let cos = (1.0 - sin * sin).sqrt();
            (sin, cos, (drive.rate - s[2]) / (self.drive_lever_m * cos))
        };
        let distance = (s[0] * s[0] + s[1] * s[1]).sqrt();
        let (ny, nz) = if distance > 0.0 { (s[0] / distance, s[1] / distance) } else { (0.0, 0.0) };
        Geometry {
            ny,
            nz,
            depth_m: distance - self.radial_clearance_m,
            rate_m_s: ny * s[2] + nz * s[3],
            sin,
            cos,
            speed_rad_s,
            sliding_m_s: speed_rad_s * self.journal_radius_m + nz * s[2] - ny * s[3],
            drive,
        }
    }

    /// The contact at a state; `latched_m_s` as held by the integrator.
    pub fn contact_view(&self, time_s: f64, s: &State, latched_m_s: f64) -> ContactView {
        self.view(&self.geometry(time_s, s), latched_m_s)
    }

    fn view(&self, g: &Geometry, latched_m_s: f64) -> ContactView {
        ContactView {
            radial_clearance_m: self.radial_clearance_m,
            deformation_m: g.depth_m,
            rate_m_s: g.rate_m_s,
            latched_m_s,
            sliding_speed_m_s: g.sliding_m_s,
        }
    }

    /// The analytic laws of the description for a contact without history: a friction law with bristles is taken in its
    /// steady state.
    pub fn law(&self, view: &ContactView) -> BearingForces {
        self.forces_of(view, self.friction_law.steady_deflection_m(view.sliding_speed_m_s))
    }

    /// The analytic laws at a state.
    pub fn forces(&self, time_s: f64, s: &State, latched_m_s: f64) -> BearingForces {
        self.forces_of(&self.contact_view(time_s, s, latched_m_s), s[BRISTLE])
    }

    fn forces_of(&self, view: &ContactView, deflection_m: f64) -> BearingForces {
        if view.deformation_m <= 0.0 {
            return BearingForces::default();
        }
        let normal_n = self.joint_law.law.force_n(view.deformation_m, view.rate_m_s, view.latched_m_s);
        let v = view.sliding_speed_m_s;
        let mut dry = self.friction_law.force_n(normal_n, v, deflection_m) * self.friction_level;
        if self.extension.coulomb_asymmetry != 0.0 {
            dry *= 1.0 + self.extension.coulomb_asymmetry * (v / self.sign_width_m_s).tanh();
        }
        BearingForces { normal_n, friction_n: dry - self.extension.viscous_n_s_m * v }
    }

    /// Components on the journal and torque on the shaft of given forces at a state.
    pub(crate) fn components(&self, s: &State, forces: &BearingForces) -> (f64, f64, f64) {
        let distance = (s[0] * s[0] + s[1] * s[1]).sqrt();
        let (ny, nz) = if distance > 0.0 { (s[0] / distance, s[1] / distance) } else { (0.0, 0.0) };
        self.components_along(ny, nz, forces)
    }

    fn components_along(&self, ny: f64, nz: f64, forces: &BearingForces) -> (f64, f64, f64) {
        (
            -forces.normal_n * ny + forces.friction_n * nz,
            -forces.normal_n * nz - forces.friction_n * ny,
            forces.friction_n * self.journal_radius_m,
        )
    }

    /// State derivative and fork force under given components of the bearing force.
    pub(crate) fn dynamics(
        &self,
        time_s: f64,
        s: &State,
        components: (f64, f64, f64),
        out: &mut State,
    ) -> f64 {
        let g = self.geometry(time_s, s);
        self.motion(time_s, s, &g, g.depth_m > 0.0, components, out)
    }

    fn motion(
        &self,
        time_s: f64,
        s: &State,
        g: &Geometry,
        touching: bool,
        (force_y, force_z, torque): (f64, f64, f64),
        out: &mut State,
    ) -> f64 {
        let lever = self.drive_lever_m * g.cos;
        let load_rate = s[2] + self.load_lever_m * g.cos * g.speed_rad_s;
        let cylinder = self.load.at(time_s).value;
        let load_friction = self.load_friction.as_ref().map_or(0.0, |f| f.force_n(load_rate));
        let load = cylinder + load_friction;
        let (acceleration_y, angular, fork) = match &self.compliance {
            None => {
                let drive_term =
                    g.drive.acceleration + self.drive_lever_m * g.sin * g.speed_rad_s * g.speed_rad_s;
                let reduced = self.inertia_kg_m2 / (lever * lever);
                let y =
                    (reduced * drive_term + load * (1.0 - self.load_lever_m / self.drive_lever_m) + force_y
                        - torque / lever)
                        / (self.mass_kg + reduced);
                (y, 0.0, self.mass_kg * y - load - force_y)
            }
            Some(compliance) => {
                let gap = g.drive.value - s[0] - self.drive_lever_m * g.sin;
                let gap_rate = g.drive.rate - s[2] - lever * g.speed_rad_s;
                let fork = compliance.force_n(gap, gap_rate);
                let angular = (fork * lever + load * self.load_lever_m * g.cos + torque) / self.inertia_kg_m2;
                ((fork + load + force_y) / self.mass_kg, angular, fork)
            }
        };
        let drive_power = fork * (s[2] + lever * g.speed_rad_s);
        // The bearing's whole power on the shaft is friction, elastic force, and what is left: the loss of the normal
        // force. A force held from outside keeps its direction while the journal moves on; that too lands in the loss.
        let bearing_power = force_y * s[2] + force_z * s[3] + torque * g.speed_rad_s;
        let friction_heat = -torque / self.journal_radius_m * g.sliding_m_s;
        let elastic_power =
            if touching { self.joint_law.elastic.force_n(g.depth_m) * g.rate_m_s } else { 0.0 };
        *out = [
            s[2],
            s[3],
            acceleration_y,
            force_z / self.mass_kg - GRAVITY_M_S2,
            if self.compliance.is_some() { g.speed_rad_s } else { 0.0 },
            angular,
            drive_power,
            drive_power.abs(),
            cylinder * load_rate,
            friction_heat,
            -bearing_power - friction_heat - elastic_power,
            -load_friction * load_rate,
            // Bristles that touch nothing straighten.
            if touching {
                self.friction_law.rate_m_s(g.sliding_m_s, s[BRISTLE])
            } else {
                -BRISTLE_RECOVERY_PER_S * s[BRISTLE]
            },
        ];
        fork
    }

    /// Everything at a state under given forces.
    pub fn snapshot(&self, time_s: f64, s: &State, latched_m_s: f64, forces: BearingForces) -> Snapshot {
        let g = self.geometry(time_s, s);
        let components = self.components_along(g.ny, g.nz, &forces);
        let mut derivative = [0.0; STATES];
        let drive_force_n = self.motion(time_s, s, &g, g.depth_m > 0.0, components, &mut derivative);
        Snapshot {
            time_s,
            angle_rad: g.sin.asin(),
            speed_rad_s: g.speed_rad_s,
            y_m: s[0],
            z_m: s[1],
            contact: self.view(&g, latched_m_s),
            forces,
            force_y_n: components.0,
            force_z_n: components.1,
            friction_torque_nm: components.2,
            drive_force_n,
            load_force_n: self.load.at(time_s).value,
            drive: self.drive.at(time_s),
        }
    }
}

impl ContactPlant<STATES> for Transmission {
    fn derivative(&self, time_s: f64, state: &State, latched_m_s: Option<f64>, derivative: &mut State) {
        let g = self.geometry(time_s, state);
        let forces = latched_m_s
            .map_or(BearingForces::default(), |l| self.forces_of(&self.view(&g, l), state[BRISTLE]));
        let components = self.components_along(g.ny, g.nz, &forces);
        self.motion(time_s, state, &g, latched_m_s.is_some(), components, derivative);
    }

    fn deformation(&self, _: f64, s: &State) -> (f64, f64) {
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
            crank_rad: self.geometry(time_s, state).sin.asin(),
            contact_rad: state[1].atan2(state[0]),
        }
    }
}
