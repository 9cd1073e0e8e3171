//! The transmission bench in two planes: the shaft may tilt in its bearing.
//!
//! The bearing is divided along its length `L` into `N` slices of equal length with their middles
//! at `s_k`. The axis of the shaft at `s` is `y(s) = y + a s`, `z(s) = z + b s` with small slopes
//! `a`, `b`. Relative to a misaligned bearing it is `r_k = (y(s_k) - e_y s_k, z(s_k) - e_z s_k)`.
//! Each slice has a clearance circle, deformation `|r_k| - D`, rate, latch and sliding speed. It
//! carries the `N`-th part of the bearing's law at its own deformation: the law per unit of length
//! times the slice's length. With all slices equal the sum is exactly the planar bench's law.
//!
//! ```text
//! m y'' = P + F_L + sum F_y             m z'' = sum F_z - m g
//! J_t a'' = P s_d + F_L s_l + sum F_y s_k - k_t a - c_t a'
//! J_t b'' = sum F_z s_k - k_t b - c_t b'
//! J th'' = P R_d cos th + F_L R_l cos th + sum T
//! y + a s_d + R_d sin th = x_f(t)                               the rigid fork, which gives P
//! ```
//!
//! `s_d`, `s_l`: planes of the drive and the load crank. `k_t`, `c_t`: stiffness and damping of
//! further bearings and couplings against the tilt, towards the machine's axis; they make a
//! misaligned bearing load its edge. Friction laws with bristles are taken in their steady state.
//! The model's omissions: [`crate::description::PlantDescription::limits`].

mod dynamics;
mod output;

pub use output::{SliceLoad, TwoPlaneRun, TwoPlaneSnapshot, run_two_plane};

use crate::description::{Extension, LoadFriction, StartState, TransmissionBench, TwoPlaneSection};
use crate::integrate::Tolerances;
use crate::plants::contact_laws::{BearingFriction, JointLaw};
use crate::plants::energy::{EnergyAudit, elastic_energy_j};
use crate::signals::Profile;
use contact::GRAVITY_M_S2;

/// Number of states.
pub(crate) const STATES: usize = 14;
/// States under error control: the motion and the drive's two works.
const CONTROLLED: f64 = 10.0;

/// States: y, z, y', z', a, b, a', b', then energies in J: work of the fork, its absolute work,
/// work of the load, heat of friction, loss of the normal forces and the supports, heat of the load
/// cylinder.
pub type State = [f64; STATES];

/// Two-plane bench, ready for integration.
#[derive(Clone, Debug)]
pub struct TwoPlane {
    drive_lever_m: f64,
    load_lever_m: f64,
    mass_kg: f64,
    inertia_kg_m2: f64,
    journal_radius_m: f64,
    radial_clearance_m: f64,
    length_m: f64,
    section: TwoPlaneSection,
    /// Middles of the slices.
    positions_m: Vec<f64>,
    joint_law: JointLaw,
    friction_law: BearingFriction,
    friction_level: f64,
    sign_width_m_s: f64,
    extension: Extension,
    /// True if friction is that of the law alone.
    plain_friction: bool,
    load_friction: Option<LoadFriction>,
    drive: Profile,
    load: Profile,
    start: StartState,
}

impl TwoPlane {
    /// Builds the plant of a resolved description. Without a `[two_plane]` section its defaults
    /// apply.
    ///
    /// Only effects that are declared for this plant act; see [`crate::effects`].
    pub fn new(bench: &TransmissionBench, drive: Profile, load: Profile) -> Self {
        let section = bench.two_plane.clone().unwrap_or_default();
        let (length_m, count) = (bench.bearing.length_m, section.slices.max(1));
        let middle = |k: u32| length_m * ((f64::from(k) + 0.5) / f64::from(count) - 0.5);
        Self {
            drive_lever_m: bench.geometry.drive_lever_radius_m,
            load_lever_m: bench.geometry.load_lever_radius_m,
            mass_kg: bench.shaft.mass_kg,
            inertia_kg_m2: bench.shaft.inertia_kg_m2,
            journal_radius_m: bench.bearing.bearing_radius_m - bench.bearing.radial_clearance_m,
            radial_clearance_m: bench.bearing.radial_clearance_m,
            length_m,
            positions_m: (0..count).map(middle).collect(),
            section,
            joint_law: JointLaw::after_changes(bench),
            friction_law: BearingFriction::after_changes(&bench.friction),
            friction_level: bench.friction.level,
            sign_width_m_s: bench.friction.regularisation_m_s,
            plain_friction: bench.extension.leaves_friction(),
            extension: bench.extension.clone(),
            load_friction: bench.load_friction.clone(),
            drive,
            load,
            start: bench.start_state(),
        }
    }

    /// Initial state: journal just above the bottom of the clearance, as on the planar bench, and
    /// in line with the bearing.
    pub fn initial_state(&self) -> State {
        let mut state = [0.0; STATES];
        state[1] = -self.radial_clearance_m * (1.0 - self.start.gap_share);
        state[3] = -self.start.speed_m_s;
        state[4] = self.section.misalignment_y_rad;
        state[5] = self.section.misalignment_z_rad;
        state
    }

    /// Error control at a relative tolerance, as on the planar bench.
    pub fn tolerances(&self, relative: f64) -> Tolerances<STATES> {
        let relative = relative * (CONTROLLED / STATES as f64).sqrt();
        let sizes = [1e-4, 1e-4, 1e-2, 1e-2, 1e-3, 1e-3, 1e-1, 1e-1, 1e3, 1e3];
        let absolute = std::array::from_fn(|i| sizes.get(i).map_or(f64::INFINITY, |size| size * relative));
        Tolerances { relative, absolute, largest_step_s: 1e-3 }
    }

    /// Share of the bearing's law that a slice carries.
    fn share(&self) -> f64 {
        1.0 / self.positions_m.len() as f64
    }

    /// Kinetic energy of the shaft, elastic energy of the slices and the supports, J.
    fn stored_energy_j(&self, time_s: f64, s: &State) -> f64 {
        let crank = self.crank(time_s, s);
        let slices = self.positions_m.iter().map(|&position| {
            let elastic = elastic_energy_j(&self.joint_law.elastic, self.slice(position, &crank, s).depth_m);
            self.share() * elastic
        });
        0.5 * self.mass_kg * (s[2] * s[2] + s[3] * s[3])
            + 0.5 * self.section.transverse_inertia_kg_m2 * (s[6] * s[6] + s[7] * s[7])
            + 0.5 * self.inertia_kg_m2 * crank.speed_rad_s * crank.speed_rad_s
            + 0.5 * self.section.support_stiffness_nm_rad * (s[4] * s[4] + s[5] * s[5])
            + slices.sum::<f64>()
    }

    /// Returns the energy balance between two states of a run. The loss of the supports counts as
    /// damping.
    pub fn audit(&self, (start_s, start): (f64, &State), (end_s, end): (f64, &State)) -> EnergyAudit {
        let change = |i: usize| end[i] - start[i];
        EnergyAudit {
            drive_work_j: change(8),
            drive_work_absolute_j: change(9),
            load_work_j: change(10),
            gravity_work_j: -self.mass_kg * GRAVITY_M_S2 * change(1),
            friction_heat_j: change(11),
            damping_loss_j: change(12),
            load_friction_heat_j: change(13),
            stored_change_j: self.stored_energy_j(end_s, end) - self.stored_energy_j(start_s, start),
            ..EnergyAudit::default()
        }
        .with_residuals()
    }
}
