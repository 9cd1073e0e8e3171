//! Shaft that is flexible in torsion between drive crank and load crank; see the effect
//! `shaft-flexibility`.

use crate::description::TransmissionBench;

/// Share of the moment of inertia that turns with the load crank.
const LOAD_SHARE: f64 = 0.5;
/// Damping ratio of the torsional mode.
const DAMPING_RATIO: f64 = 0.02;
/// Compliance in rad/(N m) below which the shaft counts as rigid: 0.1 urad under 10 kN at 0.3 m.
const MIN_COMPLIANCE: f64 = 3e-11;

/// The two inertias and the spring between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaft {
    /// Inertia at the drive crank, kg m2.
    pub(super) drive_kg_m2: f64,
    /// Inertia at the load crank, kg m2.
    pub(super) load_kg_m2: f64,
    /// Torsional stiffness in N m/rad.
    stiffness: f64,
    /// Torsional damping in N m s/rad.
    damping: f64,
}

impl Shaft {
    /// Shaft of a resolved description; `None` if it is rigid.
    pub(super) fn from_bench(bench: &TransmissionBench) -> Option<Self> {
        let compliance = bench.extension.shaft_compliance_rad_nm;
        (compliance > MIN_COMPLIANCE).then(|| {
            let (inertia, stiffness) = (bench.shaft.inertia_kg_m2, 1.0 / compliance);
            let (drive, load) = ((1.0 - LOAD_SHARE) * inertia, LOAD_SHARE * inertia);
            let damping = 2.0 * DAMPING_RATIO * (stiffness * drive * load / inertia).sqrt();
            Self { drive_kg_m2: drive, load_kg_m2: load, stiffness, damping }
        })
    }

    /// Torque of the load's end on the drive's end in N m, and the loss of its damping in W.
    pub(super) fn torque_nm(&self, angle: f64, speed: f64, load_angle: f64, load_speed: f64) -> (f64, f64) {
        let (twist, rate) = (load_angle - angle, load_speed - speed);
        (self.stiffness * twist + self.damping * rate, self.damping * rate * rate)
    }

    /// Kinetic and elastic energy in J.
    pub(super) fn stored_energy_j(&self, angle: f64, speed: f64, load_angle: f64, load_speed: f64) -> f64 {
        0.5 * self.drive_kg_m2 * speed * speed
            + 0.5 * self.load_kg_m2 * load_speed * load_speed
            + 0.5 * self.stiffness * (load_angle - angle).powi(2)
    }
}
