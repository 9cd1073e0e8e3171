//! The contact of the bearing alone, for a journal that another program moves.

use super::{BearingForces, ContactView, Transmission};
use crate::description::TransmissionBench;
use crate::integrate::IntegrationError;
use serde::{Deserialize, Serialize};

/// Motion of the journal relative to the bearing, in axes that do not turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointMotion {
    /// Centre of the journal from that of the bearing along Y and Z, m.
    pub offset_m: [f64; 2],
    /// Velocity of that centre, m/s.
    pub velocity_m_s: [f64; 2],
    /// Angular speed of the journal relative to the bearing, rad/s, positive as that of the crank.
    pub speed_rad_s: f64,
}

impl JointMotion {
    /// Motion after a time at these rates.
    #[must_use]
    pub fn after(&self, time_s: f64) -> Self {
        let moved = |i: usize| self.offset_m[i] + time_s * self.velocity_m_s[i];
        Self { offset_m: [moved(0), moved(1)], ..*self }
    }

    /// Normal of the contact, from the centre of the bearing to that of the journal; 0 if they
    /// coincide.
    fn normal(&self) -> [f64; 2] {
        let [y, z] = self.offset_m;
        let distance = (y * y + z * z).sqrt();
        if distance > 0.0 { [y / distance, z / distance] } else { [0.0; 2] }
    }
}

/// Memory of the contact between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointMemory {
    /// Approach speed at the onset of the contact, m/s; none in a gap.
    pub latched_m_s: Option<f64>,
    /// Deflection of the friction law's bristles, m.
    pub deflection_m: f64,
}

/// Laws of the bearing of a transmission bench.
#[derive(Clone, Debug)]
pub struct JointContact {
    plant: Transmission,
}

impl JointContact {
    /// Laws of a resolved description without its effects. None if its friction law sticks: then
    /// the force follows from all forces on the journal, which the contact does not know.
    pub fn new(bench: &TransmissionBench) -> Option<Self> {
        let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
        plant.friction_law.sticking().is_none().then_some(Self { plant })
    }

    /// Contact at a motion. The approach speed of a contact that has just begun is its present one.
    pub fn view(&self, motion: &JointMotion, memory: &JointMemory) -> ContactView {
        let ([y, z], [vy, vz], [ny, nz]) = (motion.offset_m, motion.velocity_m_s, motion.normal());
        let radial_clearance_m = self.plant.radial_clearance_m;
        let deformation_m = (y * y + z * z).sqrt() - radial_clearance_m;
        let rate_m_s = ny * vy + nz * vz;
        let latched_m_s = memory.latched_m_s.unwrap_or(rate_m_s.max(0.0));
        ContactView {
            radial_clearance_m,
            deformation_m,
            rate_m_s,
            latched_m_s: if deformation_m > 0.0 { latched_m_s } else { 0.0 },
            sliding_speed_m_s: motion.speed_rad_s * self.plant.journal_radius_m + vy * nz - vz * ny,
        }
    }

    /// Refuses a contact that is deeper than the range of the normal law.
    pub fn check_deformation(&self, view: &ContactView) -> Result<(), IntegrationError> {
        let deformation_m = view.deformation_m;
        match self.plant.largest_deformation_m().filter(|largest| deformation_m > *largest) {
            Some(largest_m) => Err(IntegrationError::OutsideLaw { deformation_m, largest_m }),
            None => Ok(()),
        }
    }

    /// Forces of the laws for a contact.
    pub fn law(&self, view: &ContactView, memory: &JointMemory) -> BearingForces {
        self.plant.forces_of(view, memory.deflection_m)
    }

    /// Components of the forces on the journal along Y and Z in N, and the torque on it in N m.
    pub fn on_journal(&self, motion: &JointMotion, forces: &BearingForces) -> ([f64; 2], f64) {
        let ([ny, nz], BearingForces { normal_n, friction_n }) = (motion.normal(), *forces);
        let force_n = [-normal_n * ny + friction_n * nz, -normal_n * nz - friction_n * ny];
        (force_n, friction_n * self.plant.journal_radius_m)
    }

    /// Memory after a step of `step_s` that begins with a contact.
    pub fn advance(&self, memory: &mut JointMemory, view: &ContactView, step_s: f64) {
        if view.deformation_m <= 0.0 {
            // Without a load a bristle keeps its deflection.
            memory.latched_m_s = None;
            return;
        }
        memory.latched_m_s.get_or_insert(view.latched_m_s);
        if !self.plant.friction_law.has_state() {
            return;
        }
        // At a constant speed the bristles approach their steady deflection exponentially.
        let speed_m_s = view.sliding_speed_m_s;
        let rate_m_s = self.plant.friction_law.rate_m_s(speed_m_s, memory.deflection_m);
        let steady_m = self.plant.friction_law.steady_deflection_m(speed_m_s);
        let missing_m = steady_m - memory.deflection_m;
        if missing_m != 0.0 {
            memory.deflection_m = steady_m - missing_m * (-(rate_m_s / missing_m).max(0.0) * step_s).exp();
        }
    }
}
