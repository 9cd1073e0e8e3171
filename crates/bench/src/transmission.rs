//! The transmission bench: fork (motion given along Y), drive crank, shaft in the clearance bearing, load crank.
//!
//! A Rapson slide. Planar; journal centre `(y, z)` from the bearing's centre, crank angle `th`:
//!
//! ```text
//! x_f = y + R_d sin th                               the fork's pin
//! m y'' = P + F_L + F_cy          m z'' = F_cz - m g
//! J th'' = P R_d cos th + F_L R_l cos th + T_f
//! F_c = -F_n n + F_f t,  n = (y, z)/a,  t = (n_z, -n_y),  T_f = F_f R_J,  v_t = th' R_J + v.t
//! ```
//!
//! With a rigid drive `x_f(t)` is given and the fork force `P` follows; with a hydraulic column
//! `P = k (x_d - x_f) + c (x_d' - x_f')` and `th` is a state of its own. What this does not model: tilt of the shaft,
//! friction of the load cylinder, bending of the levers.

use crate::description::{
    BearingMaterial, DissipationName, Extension, ShapeName, StiffnessName, TransmissionBench,
};
use crate::integrate::{ContactPlant, Tolerances};
use crate::motion::{Motion, Profile};
use contact::{
    Dissipation, FrictionLaw, Material, NormalLaw, Stiffness, StribeckShape, effective_modulus_pa,
};

/// Gravity in m/s2, the value of the published test problems.
const GRAVITY_M_S2: f64 = 9.81;
/// Damping ratio of the hydraulic column against the shaft's inertia (oil columns: .05 to .15).
const COLUMN_DAMPING_RATIO: f64 = 0.1;
/// Gap at the start as a share of the radial clearance.
const START_GAP_SHARE: f64 = 1e-3;
/// Compliance below which the column counts as rigid, m/N: a hundredth of a micrometre under 10 kN.
const LEAST_COMPLIANCE_M_N: f64 = 1e-12;

/// States: y, z, y', z', th, th' (the last two only with a compliant drive), work done on the shaft in J, and the
/// sum of the magnitudes of that work.
pub type State = [f64; 8];

/// The forces of the bearing on the shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BearingForces {
    /// Normal force `F_n` in N, not negative.
    pub normal_n: f64,
    /// Friction force `F_f` in N, along `t`.
    pub friction_n: f64,
}

/// The contact as a force law sees it.
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

/// Everything about the bench at one time.
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
    /// Whole force on the journal along Y in N.
    pub force_y_n: f64,
    /// Whole force on the journal along Z in N.
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

/// A transmission bench ready to be integrated.
#[derive(Clone, Debug)]
pub struct Transmission {
    drive_lever_m: f64,
    load_lever_m: f64,
    mass_kg: f64,
    inertia_kg_m2: f64,
    journal_radius_m: f64,
    radial_clearance_m: f64,
    normal_law: NormalLaw,
    friction_law: FrictionLaw,
    friction_level: f64,
    extension: Extension,
    column: Option<(f64, f64)>,
    drive: Profile,
    load: Profile,
}

impl Transmission {
    /// Builds the plant of a resolved description with a drive and a load.
    pub fn new(bench: &TransmissionBench, drive: Profile, load: Profile) -> Self {
        let bearing = Material {
            youngs_modulus_pa: bench.bearing.youngs_modulus_pa,
            poisson_ratio: bench.bearing.poisson_ratio,
        };
        let effective_modulus_pa = effective_modulus_pa(&bearing, &Material::STEEL);
        let radial_clearance_m = bench.bearing.radial_clearance_m;
        let stiffness = match bench.contact.stiffness {
            StiffnessName::HybridAsPrinted => {
                Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m }
            }
            StiffnessName::LiuTimesLength => Stiffness::LiuTimesLength {
                effective_modulus_pa,
                radial_clearance_m,
                length_m: bench.bearing.length_m,
            },
        };
        let dissipation = bench.contact.dissipation.law();
        let compliance = bench.extension.hydraulic_compliance_m_n;
        let inertia = bench.shaft.inertia_kg_m2;
        let column = (compliance > LEAST_COMPLIANCE_M_N).then(|| {
            let stiffness = 1.0 / compliance;
            let reduced_mass = inertia / bench.geometry.drive_lever_radius_m.powi(2);
            (stiffness, 2.0 * COLUMN_DAMPING_RATIO * (stiffness * reduced_mass).sqrt())
        });
        Self {
            drive_lever_m: bench.geometry.drive_lever_radius_m,
            load_lever_m: bench.geometry.load_lever_radius_m,
            mass_kg: bench.shaft.mass_kg,
            inertia_kg_m2: inertia,
            journal_radius_m: bench.bearing.bearing_radius_m - radial_clearance_m,
            radial_clearance_m,
            normal_law: NormalLaw {
                stiffness,
                dissipation,
                restitution: bench.bearing.restitution,
                latch_floor_m_s: bench.contact.latch_floor_m_s,
            },
            friction_law: bench.friction_law(),
            friction_level: bench.friction.level,
            extension: bench.extension,
            column,
            drive,
            load,
        }
    }

    /// Journal at rest just above the bottom of the clearance, crank on the drive.
    ///
    /// The gap is a thousandth of the clearance. It matters: the journal drops through it, lands at
    /// `sqrt(2 g D/1000)` (4.4 mm/s at 1 mm), and as the bench then stays in contact, this is the approach speed that
    /// the damping of the whole run is scaled with wherever it exceeds the floor.
    pub fn initial_state(&self, time_s: f64) -> State {
        let drive = self.drive_motion(time_s);
        let sine = (drive.value / self.drive_lever_m).clamp(-1.0, 1.0);
        let cosine = (1.0 - sine * sine).sqrt();
        let speed = drive.rate / (self.drive_lever_m * cosine);
        [0.0, -self.radial_clearance_m * (1.0 - START_GAP_SHARE), 0.0, 0.0, sine.asin(), speed, 0.0, 0.0]
    }

    /// Speed in m/s at which the journal lands after the start: what the latch then holds.
    pub fn landing_speed_m_s(&self) -> f64 {
        (2.0 * GRAVITY_M_S2 * START_GAP_SHARE * self.radial_clearance_m).sqrt()
    }

    /// Error control at a relative tolerance; absolute ones are that share of the states' natural sizes.
    pub fn tolerances(&self, relative: f64) -> Tolerances<8> {
        let share = relative;
        Tolerances {
            relative,
            absolute: [
                1e-4 * share,
                1e-4 * share,
                1e-2 * share,
                1e-2 * share,
                share,
                share,
                1e3 * share,
                1e3 * share,
            ],
            largest_step_s: 1e-3,
        }
    }

    /// Journal radius in m.
    pub fn journal_radius_m(&self) -> f64 {
        self.journal_radius_m
    }

    /// Radial clearance in m.
    pub fn radial_clearance_m(&self) -> f64 {
        self.radial_clearance_m
    }

    /// Drive cylinder as the fork follows it.
    fn drive_motion(&self, time_s: f64) -> Motion {
        self.drive.at(time_s - self.extension.drive_lag_s)
    }

    fn angle(&self, time_s: f64, s: &State) -> (f64, f64, f64, f64) {
        // (sin th, cos th, th', th'' without the y'' term times R_c)
        if self.column.is_some() {
            let (sin, cos) = s[4].sin_cos();
            return (sin, cos, s[5], 0.0);
        }
        let drive = self.drive_motion(time_s);
        let sin = ((drive.value - s[0]) / self.drive_lever_m).clamp(-0.9999, 0.9999);
        let cos = (1.0 - sin * sin).sqrt();
        let rate = (drive.rate - s[2]) / (self.drive_lever_m * cos);
        (sin, cos, rate, drive.acceleration + self.drive_lever_m * sin * rate * rate)
    }

    /// The contact at a state; `latched_m_s` as held by the integrator.
    pub fn contact_view(&self, time_s: f64, s: &State, latched_m_s: f64) -> ContactView {
        let distance = s[0].hypot(s[1]);
        let (ny, nz) = if distance > 0.0 { (s[0] / distance, s[1] / distance) } else { (0.0, 0.0) };
        let (_, _, speed, _) = self.angle(time_s, s);
        ContactView {
            radial_clearance_m: self.radial_clearance_m,
            deformation_m: distance - self.radial_clearance_m,
            rate_m_s: ny * s[2] + nz * s[3],
            latched_m_s,
            sliding_speed_m_s: speed * self.journal_radius_m + nz * s[2] - ny * s[3],
        }
    }

    /// The analytic laws of the description.
    pub fn law(&self, view: &ContactView) -> BearingForces {
        let normal_n = self.normal_law.force_n(view.deformation_m, view.rate_m_s, view.latched_m_s);
        let v = view.sliding_speed_m_s;
        let direction =
            1.0 + self.extension.coulomb_asymmetry * (v / self.friction_law.regularisation_m_s).tanh();
        let dry = self.friction_law.force_n(normal_n, v) * self.friction_level * direction;
        let viscous = if view.deformation_m > 0.0 { -self.extension.viscous_n_s_m * v } else { 0.0 };
        BearingForces { normal_n, friction_n: dry + viscous }
    }

    /// Components on the journal and torque on the shaft of given forces at a state.
    pub fn components(&self, s: &State, forces: &BearingForces) -> (f64, f64, f64) {
        let distance = s[0].hypot(s[1]);
        let (ny, nz) = if distance > 0.0 { (s[0] / distance, s[1] / distance) } else { (0.0, 0.0) };
        (
            -forces.normal_n * ny + forces.friction_n * nz,
            -forces.normal_n * nz - forces.friction_n * ny,
            forces.friction_n * self.journal_radius_m,
        )
    }

    /// State derivative and fork force under given components of the bearing force.
    pub fn dynamics(
        &self,
        time_s: f64,
        s: &State,
        (force_y, force_z, torque): (f64, f64, f64),
        out: &mut State,
    ) -> f64 {
        let load = self.load.at(time_s).value;
        let (sin, cos, speed, drive_term) = self.angle(time_s, s);
        let lever = self.drive_lever_m * cos;
        let acceleration_z = force_z / self.mass_kg - GRAVITY_M_S2;
        let (acceleration_y, angular, fork) = match self.column {
            None => {
                let reduced = self.inertia_kg_m2 / (lever * lever);
                let y =
                    (reduced * drive_term + load * (1.0 - self.load_lever_m / self.drive_lever_m) + force_y
                        - torque / lever)
                        / (self.mass_kg + reduced);
                (y, 0.0, self.mass_kg * y - load - force_y)
            }
            Some((stiffness, damping)) => {
                let drive = self.drive_motion(time_s);
                let gap = drive.value - s[0] - self.drive_lever_m * sin;
                let gap_rate = drive.rate - s[2] - lever * speed;
                let fork = stiffness * gap + damping * gap_rate;
                let angular = (fork * lever + load * self.load_lever_m * cos + torque) / self.inertia_kg_m2;
                ((fork + load + force_y) / self.mass_kg, angular, fork)
            }
        };
        let fork_rate = s[2] + lever * speed;
        let power = fork * fork_rate
            + load * (s[2] + self.load_lever_m * cos * speed)
            + force_y * s[2]
            + force_z * s[3]
            + torque * speed
            - self.mass_kg * GRAVITY_M_S2 * s[3];
        let angle_rate = if self.column.is_some() { speed } else { 0.0 };
        *out = [
            s[2],
            s[3],
            acceleration_y,
            acceleration_z,
            angle_rate,
            angular,
            power,
            (fork * fork_rate).abs(),
        ];
        fork
    }

    /// Kinetic energy of the shaft in J: what the work on it must add up to.
    pub fn kinetic_energy_j(&self, time_s: f64, s: &State) -> f64 {
        let (_, _, speed, _) = self.angle(time_s, s);
        0.5 * self.mass_kg * (s[2] * s[2] + s[3] * s[3]) + 0.5 * self.inertia_kg_m2 * speed * speed
    }

    /// Everything at a state under given forces.
    pub fn snapshot(&self, time_s: f64, s: &State, latched_m_s: f64, forces: BearingForces) -> Snapshot {
        let components = self.components(s, &forces);
        let mut derivative = [0.0; 8];
        let drive_force_n = self.dynamics(time_s, s, components, &mut derivative);
        let (sin, _, speed_rad_s, _) = self.angle(time_s, s);
        Snapshot {
            time_s,
            angle_rad: sin.asin(),
            speed_rad_s,
            y_m: s[0],
            z_m: s[1],
            contact: self.contact_view(time_s, s, latched_m_s),
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

impl ContactPlant<8> for Transmission {
    fn derivative(&self, time_s: f64, state: &State, latched_m_s: f64, derivative: &mut State) {
        let forces = self.law(&self.contact_view(time_s, state, latched_m_s));
        self.dynamics(time_s, state, self.components(state, &forces), derivative);
    }

    fn deformation(&self, _: f64, s: &State) -> (f64, f64) {
        let distance = s[0].hypot(s[1]);
        let rate = if distance > 0.0 { (s[0] * s[2] + s[1] * s[3]) / distance } else { 0.0 };
        (distance - self.radial_clearance_m, rate)
    }

    fn normal_force_n(&self, _: f64, state: &State, latched_m_s: f64) -> f64 {
        let (depth, rate) = self.deformation(0.0, state);
        self.normal_law.force_n(depth, rate, latched_m_s)
    }
}

impl TransmissionBench {
    /// The friction law of the description, without its level.
    pub fn friction_law(&self) -> FrictionLaw {
        let f = &self.friction;
        FrictionLaw {
            coulomb_coefficient: f.coulomb_coefficient,
            static_coefficient: f.static_coefficient,
            stribeck_speed_m_s: f.stribeck_speed_m_s,
            shape: match f.shape {
                ShapeName::Tustin => StribeckShape::Tustin,
                ShapeName::Gauss => StribeckShape::Gauss,
            },
            viscous_slope_s_m: f.viscous_slope_s_m,
            viscous_onset_m_s: f.viscous_onset_m_s,
            regularisation_m_s: f.regularisation_m_s,
        }
    }
}

impl DissipationName {
    /// The law of the name.
    pub const fn law(self) -> Dissipation {
        match self {
            Self::None => Dissipation::None,
            Self::HuntCrossley => Dissipation::HuntCrossley,
            Self::LankaraniNikravesh => Dissipation::LankaraniNikravesh,
            Self::ZhiyingQishao => Dissipation::ZhiyingQishao,
        }
    }
}

impl BearingMaterial {
    /// The name in descriptions and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Babbitt => "babbitt",
            Self::Plastic => "plastic",
        }
    }
}
