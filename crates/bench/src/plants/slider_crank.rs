//! Slider-crank with one dry clearance joint at the pin between rod and slider; the crank speed is
//! prescribed.
//!
//! The rod hangs from the crank pin (prescribed motion) and turns freely; the slider moves along x.
//! The pin at the far end of the rod is the journal, and the slider carries the bearing. There is
//! no gravity. States: rod angle, slider position, and their rates. The rod's centre of mass is at
//! its middle.
//!
//! Friction of the joint acts along `t = (-n_y, n_x)` at the sliding speed `v_t = b' R_J + v.t` of
//! the journal, with the rod's angle `b`; the slider does not turn. Friction `F_f` on the journal
//! has the torque `F_f R_J` on the rod. Without a law the joint is frictionless. Laws that stick
//! are in `slip`.

mod slip;

use crate::description::SliderCrankBench;
use crate::integrate::{
    ContactAngles, ContactPlant, ContactReading, IntegrationError, Slip, Tolerances, Touch, integrate,
};
use crate::plants::contact_laws::BearingFriction;
use crate::plants::energy::{EnergyAudit, elastic_energy_j};
use contact::{
    LawError, Material, NormalLaw, Stiffness, StiffnessKind, StiffnessParameters, hertz_sphere_in_sphere,
};

/// Relative tolerance at which the slider of the published problem is within 2e-7 m of its
/// reference after 0.6 revolutions.
pub const DEFAULT_TOLERANCE: f64 = 3e-9;

/// Parameters, SI.
#[derive(Clone, Copy, Debug)]
pub struct SliderCrank {
    /// Crank length in m.
    pub crank_length_m: f64,
    /// Crank speed in rad/s.
    pub crank_speed_rad_s: f64,
    /// Rod length in m.
    pub rod_length_m: f64,
    /// Rod mass in kg.
    pub rod_mass_kg: f64,
    /// Rod inertia about its centre of mass in kg m2.
    pub rod_inertia_kg_m2: f64,
    /// Slider mass in kg.
    pub slider_mass_kg: f64,
    /// Radial clearance in m.
    pub radial_clearance_m: f64,
    /// Journal radius in m.
    pub journal_radius_m: f64,
    /// Normal law of the joint.
    pub normal_law: NormalLaw,
    /// Friction law of the joint and the factor on it; `None` without friction.
    pub(crate) friction: Option<(BearingFriction, f64)>,
}

impl SliderCrank {
    /// Initial state: aligned, concentric, slider at standstill. The rod has the angular speed that
    /// keeps its pin at standstill.
    pub fn initial_state(&self) -> [f64; 4] {
        let rod_speed = -self.crank_length_m * self.crank_speed_rad_s / self.rod_length_m;
        [0.0, self.crank_length_m + self.rod_length_m, rod_speed, 0.0]
    }

    /// Error control at a relative tolerance; see [`DEFAULT_TOLERANCE`].
    pub fn tolerances(&self, relative: f64) -> Tolerances<4> {
        Tolerances { relative, absolute: [relative * 1e-2; 4], largest_step_s: 1e-4 }
    }

    fn pose(&self, time_s: f64, [rod, slider, rod_rate, slider_rate]: &[f64; 4]) -> Pose {
        let (crank_sin, crank_cos) = (self.crank_speed_rad_s * time_s).sin_cos();
        let (rod_sin, rod_cos) = rod.sin_cos();
        let (r, l, w) = (self.crank_length_m, self.rod_length_m, self.crank_speed_rad_s);
        // Journal centre relative to the bearing centre, and its rate.
        let (x, y) = (r * crank_cos + l * rod_cos - slider, r * crank_sin + l * rod_sin);
        let (vx, vy) = (
            -r * w * crank_sin - l * rod_rate * rod_sin - slider_rate,
            r * w * crank_cos + l * rod_rate * rod_cos,
        );
        let distance = (x * x + y * y).sqrt();
        let (nx, ny) = if distance > 0.0 { (x / distance, y / distance) } else { (0.0, 0.0) };
        Pose {
            crank_sin,
            crank_cos,
            rod_sin,
            rod_cos,
            nx,
            ny,
            depth_m: distance - self.radial_clearance_m,
            rate_m_s: nx * vx + ny * vy,
            sliding_m_s: rod_rate * self.journal_radius_m - ny * vx + nx * vy,
            turning_rad_s: if distance > 0.0 { (nx * vy - ny * vx) / distance } else { 0.0 },
        }
    }

    /// Friction of the joint on the journal in N, along the sliding direction.
    pub fn friction_force_n(&self, time_s: f64, state: &[f64; 4], touch: Touch) -> f64 {
        let p = self.pose(time_s, state);
        let normal_n = self.normal_law.force_n(p.depth_m, p.rate_m_s, touch.latched_m_s);
        self.friction_n(time_s, state, &p, normal_n, touch.slip)
    }

    fn friction_n(&self, time_s: f64, state: &[f64; 4], p: &Pose, normal_n: f64, slip: Slip) -> f64 {
        let Some((law, level)) = self.friction else { return 0.0 };
        match law.sticking() {
            Some(_) if p.depth_m <= 0.0 => 0.0,
            Some(_) if slip.is_sticking() => self.needed_n(state, p, normal_n),
            Some(law) => level * law.force_n(slip, time_s, normal_n, p.sliding_m_s, 0.0),
            None => level * law.force_n(normal_n, p.sliding_m_s, 0.0),
        }
    }

    /// Force on the journal; its opposite acts on the slider's bearing.
    fn force_on_journal(p: &Pose, normal: f64, friction: f64) -> (f64, f64) {
        (-normal * p.nx - friction * p.ny, -normal * p.ny + friction * p.nx)
    }

    /// Inertia of the rod about the crank pin.
    fn rod_inertia_about_pin(&self) -> f64 {
        let half = 0.5 * self.rod_length_m;
        self.rod_inertia_kg_m2 + self.rod_mass_kg * half * half
    }

    /// Acceleration of the crank pin.
    fn pin_acceleration(&self, p: &Pose) -> (f64, f64) {
        let pin = self.crank_length_m * self.crank_speed_rad_s * self.crank_speed_rad_s;
        (-pin * p.crank_cos, -pin * p.crank_sin)
    }

    /// Accelerations of rod and slider under a force of the bearing on the journal, from moments
    /// about the moving crank pin: `I_pin rod'' = r x F + T_f - m half (e x a_pin)`.
    fn accelerations(&self, p: &Pose, (force_x, force_y): (f64, f64), friction: f64) -> [f64; 2] {
        let (pin_ax, pin_ay) = self.pin_acceleration(p);
        let moment = self.rod_length_m * (p.rod_cos * force_y - p.rod_sin * force_x)
            + friction * self.journal_radius_m
            - self.rod_mass_kg * (0.5 * self.rod_length_m) * (p.rod_cos * pin_ay - p.rod_sin * pin_ax);
        [moment / self.rod_inertia_about_pin(), -force_x / self.slider_mass_kg]
    }

    /// Rates of the states and the powers at a state.
    fn motion(&self, time_s: f64, state: &[f64; 4], touch: Option<Touch>) -> ([f64; 4], Powers) {
        let p = self.pose(time_s, state);
        let Touch { latched_m_s, slip } = touch.unwrap_or_default();
        let normal = touch.map_or(0.0, |_| self.normal_law.force_n(p.depth_m, p.rate_m_s, latched_m_s));
        let friction = touch.map_or(0.0, |_| self.friction_n(time_s, state, &p, normal, slip));
        let (force_x, force_y) = Self::force_on_journal(&p, normal, friction);
        let half = 0.5 * self.rod_length_m;
        let (pin_ax, pin_ay) = self.pin_acceleration(&p);
        let [rod, slider] = self.accelerations(&p, (force_x, force_y), friction);
        // Force of the crank on the rod: mass times acceleration of the rod's middle, less the
        // force at the journal.
        let swing = half * state[2] * state[2];
        let crank_x = self.rod_mass_kg * (pin_ax - swing * p.rod_cos - half * rod * p.rod_sin) - force_x;
        let crank_y = self.rod_mass_kg * (pin_ay - swing * p.rod_sin + half * rod * p.rod_cos) - force_y;
        let pin_speed = self.crank_length_m * self.crank_speed_rad_s;
        let elastic = touch.map_or(0.0, |_| self.normal_law.stiffness.force_n(p.depth_m));
        let powers = Powers {
            drive_w: pin_speed * (crank_y * p.crank_cos - crank_x * p.crank_sin),
            friction_w: if slip.is_sticking() { 0.0 } else { -friction * p.sliding_m_s },
            damping_w: (normal - elastic) * p.rate_m_s,
        };
        ([state[2], state[3], rod, slider], powers)
    }

    /// Kinetic energy of rod and slider and elastic energy of the joint, J.
    fn stored_energy_j(&self, time_s: f64, state: &[f64; 4]) -> f64 {
        let p = self.pose(time_s, state);
        let (half, pin_speed) = (0.5 * self.rod_length_m, self.crank_length_m * self.crank_speed_rad_s);
        let middle_x = -pin_speed * p.crank_sin - half * state[2] * p.rod_sin;
        let middle_y = pin_speed * p.crank_cos + half * state[2] * p.rod_cos;
        0.5 * self.rod_mass_kg * (middle_x * middle_x + middle_y * middle_y)
            + 0.5 * self.rod_inertia_kg_m2 * state[2] * state[2]
            + 0.5 * self.slider_mass_kg * state[3] * state[3]
            + elastic_energy_j(&self.normal_law.stiffness, p.depth_m)
    }

    /// Returns the energy balance of a run from the initial state. The drive is the crank.
    ///
    /// # Errors
    ///
    /// As [`integrate`].
    pub fn audit(&self, end_s: f64, relative: f64) -> Result<EnergyAudit, IntegrationError> {
        let mut initial = [0.0; AUDITED];
        for (value, start) in initial.iter_mut().zip(self.initial_state()) {
            *value = start;
        }
        // A contact begins at a state of the dense output, whose error grows with the step.
        let largest_step_s = AUDIT_STEP_SHARE * core::f64::consts::TAU / self.crank_speed_rad_s;
        // The method's norm is a mean over all states, also those that are not controlled.
        let own = self.tolerances(relative * (4.0 / AUDITED as f64).sqrt());
        let absolute = std::array::from_fn(|i| own.absolute.get(i).copied().unwrap_or(f64::INFINITY));
        let tolerances = Tolerances { relative: own.relative, absolute, largest_step_s };
        let run = integrate(&Audited(self), (0.0, end_s), initial, false, &[], &tolerances, |_, _, _| {})?;
        let [rod, slider, rod_rate, slider_rate, drive, absolute, friction, damping] = run.state;
        let end = [rod, slider, rod_rate, slider_rate];
        Ok(EnergyAudit {
            drive_work_j: drive,
            drive_work_absolute_j: absolute,
            friction_heat_j: friction,
            damping_loss_j: damping,
            stored_change_j: self.stored_energy_j(end_s, &end)
                - self.stored_energy_j(0.0, &self.initial_state()),
            ..EnergyAudit::default()
        }
        .with_residuals())
    }
}

/// Powers at a state in W, each from its own law.
struct Powers {
    drive_w: f64,
    friction_w: f64,
    damping_w: f64,
}

/// States of a run with its energies: those of the plant, then work of the crank, its absolute
/// work, heat of friction and damping loss in J.
const AUDITED: usize = 8;
/// Largest step of an audited run, as a share of a revolution.
const AUDIT_STEP_SHARE: f64 = 1e-3;

/// The plant with its energies.
struct Audited<'a>(&'a SliderCrank);

impl Audited<'_> {
    fn moving(state: &[f64; AUDITED]) -> [f64; 4] {
        let [rod, slider, rod_rate, slider_rate, ..] = *state;
        [rod, slider, rod_rate, slider_rate]
    }
}

impl ContactPlant<AUDITED> for Audited<'_> {
    fn derivative(&self, t: f64, state: &[f64; AUDITED], touch: Option<Touch>, out: &mut [f64; AUDITED]) {
        let ([a, b, c, d], powers) = self.0.motion(t, &Self::moving(state), touch);
        let drive = powers.drive_w;
        *out = [a, b, c, d, drive, drive.abs(), powers.friction_w, powers.damping_w];
    }

    fn deformation(&self, t: f64, state: &[f64; AUDITED]) -> (f64, f64) {
        self.0.deformation(t, &Self::moving(state))
    }

    fn contact(&self, t: f64, state: &[f64; AUDITED], latched_m_s: f64) -> ContactReading {
        self.0.contact(t, &Self::moving(state), latched_m_s)
    }

    fn angles(&self, t: f64, state: &[f64; AUDITED]) -> ContactAngles {
        self.0.angles(t, &Self::moving(state))
    }

    fn has_slip_ended(&self, t: f64, state: &[f64; AUDITED], touch: Touch) -> bool {
        self.0.has_slip_ended(t, &Self::moving(state), touch)
    }

    fn next_slip(&self, t: f64, state: &mut [f64; AUDITED], touch: Touch) -> Slip {
        let mut moving = Self::moving(state);
        let (slip, [heat_j, work_j]) = self.0.next_slip_at(t, &mut moving, touch);
        state[..4].copy_from_slice(&moving);
        for (place, energy_j) in state[4..7].iter_mut().zip([work_j, work_j.abs(), heat_j]) {
            *place += energy_j;
        }
        slip
    }
}

impl SliderCrankBench {
    /// Builds the stiffness part of the joint's normal law.
    pub(crate) fn stiffness(&self) -> Result<Stiffness, LawError> {
        let solid = Material {
            youngs_modulus_pa: self.joint.youngs_modulus_pa,
            poisson_ratio: self.joint.poisson_ratio,
        };
        let (bearing, journal) = (self.joint.bearing_radius_m, self.joint.journal_radius_m);
        let Some(name) = self.joint.stiffness.filter(|name| name.0 != StiffnessKind::Hertz) else {
            let coefficient = hertz_sphere_in_sphere(bearing, &solid, journal, &solid);
            return Ok(Stiffness::Hertz { coefficient });
        };
        let law = name.0.entry().name;
        let length_m = self.joint.length_m.ok_or(LawError::Missing { law, quantity: "length_m" })?;
        name.0.build(&StiffnessParameters::from_joint(contact::Joint {
            bearing_radius_m: bearing,
            radial_clearance_m: bearing - journal,
            length_m,
            bearing: solid,
            journal: solid,
        }))
    }

    /// Builds the plant.
    pub fn plant(&self) -> SliderCrank {
        SliderCrank {
            crank_length_m: self.crank.length_m,
            crank_speed_rad_s: self.crank.speed_rpm * core::f64::consts::PI / 30.0,
            rod_length_m: self.rod.length_m,
            rod_mass_kg: self.rod.mass_kg,
            rod_inertia_kg_m2: self.rod.inertia_kg_m2,
            slider_mass_kg: self.slider.mass_kg,
            radial_clearance_m: self.joint.bearing_radius_m - self.joint.journal_radius_m,
            journal_radius_m: self.joint.journal_radius_m,
            friction: self.friction.as_ref().map(|f| (BearingFriction::after_changes(f), f.level)),
            normal_law: NormalLaw {
                // The description was checked when it was read; a law that a later change took out
                // of its range gives NaN.
                stiffness: self.stiffness().unwrap_or(Stiffness::Linear { coefficient: f64::NAN }),
                dissipation: self.joint.dissipation.0,
                restitution: self.joint.restitution,
                latch_floor_m_s: self.joint.latch_floor_m_s,
            },
        }
    }
}

/// Angles and contact at one state.
struct Pose {
    crank_sin: f64,
    crank_cos: f64,
    rod_sin: f64,
    rod_cos: f64,
    nx: f64,
    ny: f64,
    depth_m: f64,
    rate_m_s: f64,
    sliding_m_s: f64,
    turning_rad_s: f64,
}

impl ContactPlant<4> for SliderCrank {
    fn derivative(&self, time_s: f64, state: &[f64; 4], touch: Option<Touch>, out: &mut [f64; 4]) {
        *out = self.motion(time_s, state, touch).0;
    }

    fn deformation(&self, time_s: f64, state: &[f64; 4]) -> (f64, f64) {
        let p = self.pose(time_s, state);
        (p.depth_m, p.rate_m_s)
    }

    fn contact(&self, time_s: f64, state: &[f64; 4], latched_m_s: f64) -> ContactReading {
        let p = self.pose(time_s, state);
        ContactReading {
            depth_m: p.depth_m,
            rate_m_s: p.rate_m_s,
            force_n: self.normal_law.force_n(p.depth_m, p.rate_m_s, latched_m_s),
        }
    }

    fn angles(&self, time_s: f64, state: &[f64; 4]) -> ContactAngles {
        let p = self.pose(time_s, state);
        ContactAngles { crank_rad: self.crank_speed_rad_s * time_s, contact_rad: p.ny.atan2(p.nx) }
    }

    fn has_slip_ended(&self, time_s: f64, state: &[f64; 4], touch: Touch) -> bool {
        self.sticking().is_some_and(|law| {
            let p = self.pose(time_s, state);
            law.0.has_ended(touch.slip, time_s, p.sliding_m_s, 0.0, || self.balance(law, state, &p, touch))
        })
    }

    fn next_slip(&self, time_s: f64, state: &mut [f64; 4], touch: Touch) -> Slip {
        self.next_slip_at(time_s, state, touch).0
    }
}

#[cfg(test)]
mod tests {
    use super::DEFAULT_TOLERANCE;
    use crate::description::SliderCrankBench;
    use crate::integrate::integrate;

    #[test]
    fn the_default_tolerance_keeps_the_slider_within_its_bound() {
        let bench = SliderCrankBench::open("slider-crank").unwrap();
        let plant = bench.plant();
        let tolerances = plant.tolerances(DEFAULT_TOLERANCE);
        let span = (0.0, bench.duration_s());
        let run =
            integrate(&plant, span, plant.initial_state(), false, &[], &tolerances, |_, _, _| {}).unwrap();
        assert!((run.state[1] - 0.0754435223).abs() <= 2e-7, "{}", run.state[1]);
    }

    #[test]
    fn slider_crank_matches_the_known_answers() {
        let bench = SliderCrankBench::open("slider-crank").unwrap();
        let plant = bench.plant();
        let result = integrate(
            &plant,
            (0.0, bench.duration_s()),
            plant.initial_state(),
            false,
            &[],
            &plant.tolerances(1e-11),
            |_, _, _| {},
        )
        .unwrap();
        let first = result.impacts[0];
        assert!((first.onset_s - 227.286e-6).abs() < 1e-9, "onset {}", first.onset_s);
        assert!((first.approach_speed_m_s - 4.385783).abs() < 1e-6, "speed {}", first.approach_speed_m_s);
        assert!((first.peak_force_n / 45777.46 - 1.0).abs() < 1e-6, "peak {}", first.peak_force_n);
        assert!(
            (first.separation_s.unwrap() - 280.763e-6).abs() < 1e-9,
            "separation {:?}",
            first.separation_s
        );
        for (impact, peak) in result.impacts.iter().zip([45777.46, 20971.99, 25593.21, 6770.89, 13012.17]) {
            assert!((impact.peak_force_n / peak - 1.0).abs() < 1e-5, "{impact:?} for {peak}");
        }
        assert_eq!(result.impacts.len(), 20);
        assert!((result.state[1] - 0.0754435223).abs() < 1e-6, "x(.6 rev) = {}", result.state[1]);
        assert!((result.state[3] - 9.984871).abs() < 1e-3, "v(.6 rev) = {}", result.state[3]);
    }
}
