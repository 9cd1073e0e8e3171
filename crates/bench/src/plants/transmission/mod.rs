//! The transmission bench: fork (motion given along Y), drive crank, shaft in the clearance
//! bearing, load crank.
//!
//! The mechanism is a Rapson slide. The model is planar, with the journal centre `(y, z)` from the
//! bearing's centre and the crank angle `th`:
//!
//! ```text
//! x_f = y + R_d sin th                               the fork's pin
//! m y'' = P + F_L + F_cy          m z'' = F_cz - m g
//! J th'' = P R_d cos th + F_L R_l cos th + T_f
//! F_c = -F_n n + F_f t,  n = (y, z)/a,  t = (n_z, -n_y),  T_f = F_f R_J,  v_t = th' R_J + v.t
//! ```
//!
//! With a rigid drive `x_f(t)` is given, and the fork force `P` follows from it. With a compliant
//! drive `th` is a separate state: `P = k (x_d - x_f) + c (x_d' - x_f')` for a hydraulic column,
//! and `P` of [`fork::Drive`] for play in the fork. With a `servo`, `x_d` is a state, too. On a
//! flexible shaft (`shaft`) the load crank has a separate angle. Friction of the load cylinder
//! reduces `F_L` by `F_c tanh(v/v_r) + c v` at the speed of the load crank's pin. What the model
//! leaves out: [`crate::description::PlantDescription::limits`].
//!
//! This file builds the plant from a description. `dynamics` has the equations, `fork` the drive's
//! compliance, `geometry` the contact, `bearing` its forces, `slip` its sticking. Additional
//! terms: [`crate::effects`].

pub(crate) use bearing::OnShaft;
pub(crate) use geometry::MAX_SINE;
pub use joint::{JointContact, JointMemory, JointMotion};
pub(crate) use reduced::{MOVING, PLAIN, Reduced};
pub(crate) use servo::ServoPlant;

#[cfg(test)]
mod audit_tests;
mod bearing;
mod dynamics;
mod fork;
mod geometry;
mod joint;
mod reduced;
mod servo;
mod shaft;
mod slip;

use crate::description::{Extension, LoadFriction, StartState, TransmissionBench};
use crate::integrate::Tolerances;
use crate::plants::contact_laws::{BearingFriction, JointLaw};
use crate::plants::energy::{EnergyAudit, elastic_energy_j};
use crate::signals::{Motion, Profile};
use contact::GRAVITY_M_S2;
use fork::Drive;
use shaft::Shaft;

/// Index of the bristles' deflection, or of the pre-sliding sign.
const BRISTLE: usize = 12;
/// Indices of angle and speed of the load crank on a flexible shaft.
const LOAD_ANGLE: usize = 13;
const LOAD_SPEED: usize = 14;
/// Index of the static friction that has built up at standstill.
const BREAKAWAY: usize = 15;
/// Index of the bearing's temperature rise.
const RISE: usize = 16;
/// States under error control, with a friction law without bristles.
const CONTROLLED: f64 = 8.0;
/// Number of states.
pub(crate) const STATES: usize = 17;

/// States: y, z, y', z', th, th' (the last two only with a compliant drive). Then energies in J:
/// work of the fork, its absolute work, work of the load, heat of friction, loss of the normal
/// force beyond its elastic part, heat of the load cylinder. Then the deflection of the bristles in
/// m for friction laws that have one, the memory of the seven-parameter law, or the pre-sliding
/// sign; angle and speed of the load crank on a flexible shaft; the static friction that has built
/// up at standstill; the bearing's temperature rise in K. The last five are constant without the
/// effect that needs them.
pub type State = [f64; STATES];

/// Forces of the bearing on the shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BearingForces {
    /// Normal force `F_n` in N, not negative.
    pub normal_n: f64,
    /// Friction force `F_f` in N, along `t`.
    pub friction_n: f64,
}

/// Contact as the input of a force law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactView {
    /// Radial clearance in m.
    pub radial_clearance_m: f64,
    /// Deformation in m, negative in a gap.
    pub deformation_m: f64,
    /// Rate of the deformation in m/s.
    pub rate_m_s: f64,
    /// Approach speed latched at onset in m/s.
    pub latched_m_s: f64,
    /// Relative tangential speed `v_t` in m/s.
    pub sliding_speed_m_s: f64,
}

/// All quantities of the bench at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Time in s.
    pub time_s: f64,
    /// Crank angle in rad.
    pub angle_rad: f64,
    /// Crank speed in rad/s.
    pub speed_rad_s: f64,
    /// Journal centre along Y in m.
    pub y_m: f64,
    /// Journal centre along Z in m.
    pub z_m: f64,
    /// The contact.
    pub contact: ContactView,
    /// Normal and friction force.
    pub forces: BearingForces,
    /// Total force on the journal along Y in N.
    pub force_y_n: f64,
    /// Total force on the journal along Z in N.
    pub force_z_n: f64,
    /// Torque of the bearing on the shaft in N m.
    pub friction_torque_nm: f64,
    /// Force of the fork on the shaft along +Y in N.
    pub drive_force_n: f64,
    /// Load in N.
    pub load_force_n: f64,
    /// Drive cylinder.
    pub drive: Motion,
}

/// Transmission bench, ready for integration.
#[derive(Clone, Debug)]
pub struct Transmission {
    drive_lever_m: f64,
    load_lever_m: f64,
    mass_kg: f64,
    inertia_kg_m2: f64,
    journal_radius_m: f64,
    radial_clearance_m: f64,
    bearing_length_m: f64,
    joint_law: JointLaw,
    friction_law: BearingFriction,
    sign_width_m_s: f64,
    friction_level: f64,
    extension: Extension,
    load_friction: Option<LoadFriction>,
    compliance: Option<Drive>,
    /// Flexible shaft, if there is one.
    shaft: Option<Shaft>,
    /// True if friction is that of the law alone.
    plain_friction: bool,
    drive: Profile,
    load: Profile,
    start: StartState,
}

impl Transmission {
    /// Builds the plant of a resolved description with a drive and a load.
    pub fn new(bench: &TransmissionBench, drive: Profile, load: Profile) -> Self {
        let radial_clearance_m = bench.bearing.radial_clearance_m;
        let friction_law = BearingFriction::of_changed_bench(bench);
        let mut extension = bench.extension.clone();
        if friction_law.sticking().is_some() {
            // The law includes what happens before sliding; a description may not name both.
            extension.presliding_distance_m = 0.0;
        }
        Self {
            drive_lever_m: bench.geometry.drive_lever_radius_m,
            load_lever_m: bench.geometry.load_lever_radius_m,
            mass_kg: bench.shaft.mass_kg,
            inertia_kg_m2: bench.shaft.inertia_kg_m2,
            journal_radius_m: bench.bearing.bearing_radius_m - radial_clearance_m,
            radial_clearance_m,
            bearing_length_m: bench.bearing.length_m,
            joint_law: JointLaw::after_changes(bench),
            friction_law,
            sign_width_m_s: bench.friction.regularisation_m_s,
            friction_level: bench.friction.level,
            plain_friction: extension.leaves_friction(),
            extension,
            load_friction: bench.load_friction.clone(),
            compliance: Drive::from_bench(bench),
            shaft: Shaft::from_bench(bench),
            drive,
            load,
            start: bench.start_state(),
        }
    }

    /// Initial state: journal just above the bottom of the clearance, crank on the drive.
    ///
    /// The gap matters. By default it is a thousandth of the clearance: the journal drops through
    /// it and lands at `sqrt(2 g D/1000)` (4.4 mm/s at 1 mm). As long as the bench stays in
    /// contact, this approach speed scales the damping wherever it exceeds the floor. The section
    /// `[start]` sets both.
    pub fn initial_state(&self, time_s: f64) -> State {
        let drive = self.drive_motion(time_s);
        let sine = (drive.value / self.drive_lever_m).clamp(-1.0, 1.0);
        let cosine = (1.0 - sine * sine).sqrt();
        let mut state = [0.0; STATES];
        state[1] = -self.radial_clearance_m * (1.0 - self.start.gap_share);
        state[3] = -self.start.speed_m_s;
        state[4] = sine.asin();
        state[5] = drive.rate / (self.drive_lever_m * cosine);
        state[RISE] = self.extension.temperature_start_k;
        // Parts without motion are assumed to have been at standstill for a long time.
        let sliding_m_s = state[5] * self.journal_radius_m;
        state[BREAKAWAY] = self.extension.breakaway.as_ref().map_or(0.0, |term| term.steady(sliding_m_s).0);
        if self.shaft.is_some() {
            [state[LOAD_ANGLE], state[LOAD_SPEED]] = [state[4], state[5]];
        }
        state
    }

    /// Speed in m/s at which the journal lands after the start; the latch then holds it.
    pub fn landing_speed_m_s(&self) -> f64 {
        let fall = 2.0 * GRAVITY_M_S2 * self.start.gap_share * self.radial_clearance_m;
        (self.start.speed_m_s * self.start.speed_m_s + fall).sqrt()
    }

    /// Error control at a relative tolerance. Absolute tolerances are that share of the states'
    /// typical sizes.
    ///
    /// Only two of the energies are controlled, those of the drive. The method's norm is a mean
    /// over all states, so the tolerance is reduced to compensate for the uncontrolled ones.
    pub fn tolerances(&self, relative: f64) -> Tolerances<STATES> {
        let relative = relative * (CONTROLLED / STATES as f64).sqrt();
        let sizes = [1e-4, 1e-4, 1e-2, 1e-2, 1.0, 1.0, 1e3, 1e3];
        let mut absolute =
            std::array::from_fn(|i| sizes.get(i).map_or(f64::INFINITY, |size| size * relative));
        let own = [
            (self.friction_law.has_state(), BRISTLE, 1e-6),
            (self.extension.presliding_distance_m > 0.0, BRISTLE, 1e-2),
            (self.shaft.is_some(), LOAD_ANGLE, 1e-2),
            (self.shaft.is_some(), LOAD_SPEED, 1.0),
            (self.extension.breakaway.is_some(), BREAKAWAY, 1e-2),
            (self.extension.thermal.is_some(), RISE, 1.0),
        ];
        for (_, state, size) in own.into_iter().filter(|(present, ..)| *present) {
            absolute[state] = size * relative;
        }
        Tolerances { relative, absolute, largest_step_s: 1e-3 }
    }

    /// Journal radius in m.
    pub fn journal_radius_m(&self) -> f64 {
        self.journal_radius_m
    }

    /// Replaces the drive and the load.
    pub(crate) fn set_profiles(&mut self, drive: Profile, load: Profile) {
        (self.drive, self.load) = (drive, load);
    }

    /// Radial clearance in m.
    pub fn radial_clearance_m(&self) -> f64 {
        self.radial_clearance_m
    }

    /// Time at which the load's ramp ends, s.
    pub(crate) fn load_ramp_end_s(&self) -> f64 {
        match self.load {
            Profile::Ramp { ramp_s, .. } | Profile::Raised { ramp_s, .. } => ramp_s,
            _ => 0.0,
        }
    }

    /// Maximum deformation in m for which the normal law is valid, if it has one.
    pub fn largest_deformation_m(&self) -> Option<f64> {
        self.joint_law.law.largest_deformation_m()
    }

    /// Kinetic energy of the shaft, elastic energy of its twist and of the contact, and potential
    /// of ripples, in J.
    fn stored_energy_j(&self, time_s: f64, s: &State) -> f64 {
        let g = self.geometry(time_s, s);
        let elastic = elastic_energy_j(&self.joint_law.elastic, g.depth_m);
        let turning = match &self.shaft {
            None => 0.5 * self.inertia_kg_m2 * g.speed_rad_s * g.speed_rad_s,
            Some(shaft) => shaft.stored_energy_j(g.angle_rad(), g.speed_rad_s, s[LOAD_ANGLE], s[LOAD_SPEED]),
        };
        let ripples = self.extension.position_ripples.iter().map(|r| r.integral(g.angle_rad()));
        0.5 * self.mass_kg * (s[2] * s[2] + s[3] * s[3]) + turning + elastic - ripples.sum::<f64>()
    }

    /// Losses up to a state in J: friction heat, damping loss, heat of the load cylinder.
    pub(crate) fn losses_j(&self, s: &State) -> [f64; 3] {
        [s[9], s[10], s[11]]
    }

    /// Returns the energy balance between two states of a run.
    pub fn audit(&self, (start_s, start): (f64, &State), (end_s, end): (f64, &State)) -> EnergyAudit {
        let change = |i: usize| end[i] - start[i];
        EnergyAudit {
            drive_work_j: change(6),
            drive_work_absolute_j: change(7),
            load_work_j: change(8),
            gravity_work_j: -self.mass_kg * GRAVITY_M_S2 * change(1),
            friction_heat_j: change(9),
            load_friction_heat_j: change(11),
            damping_loss_j: change(10),
            stored_change_j: self.stored_energy_j(end_s, end) - self.stored_energy_j(start_s, start),
            ..EnergyAudit::default()
        }
        .with_residuals()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bench;
    use crate::effects::Effect;

    #[test]
    fn the_friction_memory_starts_at_its_steady_value_for_the_first_speed() {
        let mut bench = Bench::open("bench-b").unwrap();
        let parameters = [("excess", 0.5), ("rest_time_s", 0.1), ("distance_m", 1e-3)]
            .map(|(name, value)| (name.to_owned(), value));
        bench.effects_mut().push(Effect {
            name: "breakaway".into(),
            channel: None,
            of: None,
            parameters: parameters.into(),
        });
        let Bench::Transmission(bench) = bench.resolved() else { panic!("bench-b is no axis") };
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        assert_eq!(
            plant.initial_state(0.0)[BREAKAWAY],
            1.0,
            "a plant at standstill starts with full static friction"
        );
        let moving = plant.initial_state(0.25);
        let sliding_m_s = moving[5].abs() * plant.journal_radius_m;
        let expected = 1.0 / (1.0 + sliding_m_s * 0.1 / 1e-3);
        assert!(
            (moving[BREAKAWAY] - expected).abs() < 1e-12 && expected < 0.2,
            "{} {expected}",
            moving[BREAKAWAY]
        );
    }
}
