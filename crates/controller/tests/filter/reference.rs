//! The same filter in double precision, dense and with numerical derivatives.
//!
//! It shares the equations of `docs/estimation.md` with the filter and no code: one state vector of
//! nine, Jacobians by central differences, covariance updates in Joseph's form.

use controller::filter::{FilterConfiguration, Measurement};
use nalgebra::{SMatrix, SVector};
use std::f64::consts::{PI, SQRT_2, TAU};

/// States: y, z, y', z', residual force, then stiffness, clearance, friction and damping as
/// changes.
const N: usize = 9;
type Vector = [f64; N];
type Matrix = [[f64; N]; N];

/// Steps of the differences.
const STEPS: Vector = [1e-9, 1e-9, 1e-6, 1e-6, 1e-2, 1e-5, 1e-10, 1e-5, 1e-5];

/// Drive: displacement, speed, acceleration, jerk.
type Drive = [f64; 4];

/// Inputs of a step that are no state.
#[derive(Clone, Copy)]
struct Fixed {
    load: f64,
    approach: f64,
    /// Deviations of deformation, sliding speed, stiffness and damping.
    deviations: [f64; 4],
}

pub(crate) struct Reference {
    config: FilterConfiguration,
    state: Vector,
    covariance: Matrix,
    drive: Drive,
    drive_covariance: [[f64; 4]; 4],
    drive_gain: Drive,
    remaining_s: f64,
    load: f64,
    approach: f64,
    is_touching: bool,
}

/// Forces of the contact: normal, friction, Y, Z, and what is needed to judge them.
struct Contact {
    friction: f64,
    y: f64,
    z: f64,
    deformation: f64,
    rate: f64,
    normal_error: f64,
    friction_error: f64,
}

impl Reference {
    /// Starts with the first sample.
    pub(crate) fn new(config: &FilterConfiguration, first: &Measurement) -> Self {
        let c = Numbers(config);
        let (jerk, time) = (c.jerk(), c.jerk_time());
        let unknown = c.reflected() * jerk * time;
        let residual = (c.residual_variance(first.load_force_n.into()) + unknown * unknown).sqrt();
        let speed = (4.0 * 9.81 * f64::from(config.radial_clearance_m)).sqrt();
        let noise = f64::from(config.noise.position_m);
        let [e, gap, q] = c.factors();
        let drive = [c.displacement_noise(), 0.5 * jerk * time * time, jerk * time, jerk];
        let (y, z) = (f64::from(first.journal_y_m), f64::from(first.journal_z_m));
        let displacement = y + f64::from(config.drive_lever_m) * f64::from(first.shaft_angle_rad).sin();
        let beyond = (y.hypot(z) - f64::from(config.radial_clearance_m)).max(0.0);
        let deviations = [noise, noise, speed, speed, residual, e, gap.hypot(0.5 * beyond), q, 0.3];
        Self {
            config: *config,
            state: [y, z, 0.0, 0.0, 0.0, 0.0, beyond, 0.0, 0.0],
            covariance: diagonal(deviations.map(|d| d * d)),
            drive: [displacement, 0.0, 0.0, 0.0],
            drive_covariance: diagonal(drive.map(|d| d * d)),
            drive_gain: [0.0; 4],
            remaining_s: 2.0 * time,
            load: first.load_force_n.into(),
            approach: speed,
            is_touching: false,
        }
    }

    /// Takes a sample; returns the force components.
    pub(crate) fn step(&mut self, measured: &Measurement) -> (f64, f64) {
        let c = self.config;
        let numbers = Numbers(&c);
        self.predict(f64::from(c.sample_period_s));
        self.load = measured.load_force_n.into();
        let angle = f64::from(measured.shaft_angle_rad);
        let displacement = f64::from(measured.journal_y_m) + f64::from(c.drive_lever_m) * angle.sin();
        self.correct_drive(numbers, displacement);
        self.correct(0, measured.journal_y_m.into());
        self.correct(1, measured.journal_z_m.into());
        self.scale_damping();
        self.onset();
        let contact = self.contact(&self.state, &self.drive, &self.fixed());
        (contact.y, contact.z)
    }

    /// Speed of the shaft and lever of the crank.
    fn turning(&self, s: &Vector, drive: &Drive) -> (f64, f64, f64) {
        let lever = f64::from(self.config.drive_lever_m);
        let sine = ((drive[0] - s[0]) / lever).clamp(-0.95, 0.95);
        let arm = lever * (1.0 - sine * sine).sqrt();
        ((drive[1] - s[2]) / arm, arm, sine)
    }

    fn fixed(&self) -> Fixed {
        let s = &self.state;
        let distance = s[0].hypot(s[1]);
        let (ny, nz) = (s[0] / distance, s[1] / distance);
        let mut deformation = [0.0; N];
        (deformation[0], deformation[1], deformation[6]) = (ny, nz, -1.0);
        let (_, arm, _) = self.turning(s, &self.drive);
        let mut slip = [0.0; N];
        (slip[2], slip[3]) = (-f64::from(self.config.journal_radius_m) / arm + nz, -ny);
        let mut unit = [[0.0; N]; 2];
        (unit[0][5], unit[1][8]) = (1.0, 1.0);
        let deviations = [deformation, slip, unit[0], unit[1]].map(|row| self.variance(&row).max(0.0).sqrt());
        Fixed { load: self.load, approach: self.approach, deviations }
    }

    fn variance(&self, row: &Vector) -> f64 {
        (0..N).map(|i| (0..N).map(|j| row[i] * self.covariance[i][j] * row[j]).sum::<f64>()).sum()
    }

    fn contact(&self, s: &Vector, drive: &Drive, fixed: &Fixed) -> Contact {
        let c = &self.config;
        let [sd, sliding_sd, stiffness_sd, damping_sd] = fixed.deviations;
        let distance = s[0].hypot(s[1]);
        let (ny, nz) = (s[0] / distance, s[1] / distance);
        let gap = f64::from(c.radial_clearance_m) + s[6];
        let (deformation, rate) = (distance - gap, ny * s[2] + nz * s[3]);
        let ratio = deformation / sd;
        let (turning, _, _) = self.turning(s, drive);
        let sliding = turning * f64::from(c.journal_radius_m) - (ny * s[3] - nz * s[2]);
        let modulus = SQRT_2 * PI / 8.0 * f64::from(c.effective_modulus_pa);
        let inside = deformation.max(0.0);
        let shape = modulus * (3.0 * gap + 2.0 * inside) / (gap + inside).powf(1.5);
        let touching = 0.5 * libm::erfc(-ratio / SQRT_2);
        let density = (-0.5 * ratio * ratio).exp() / TAU.sqrt();
        let square = if ratio >= 4.0 {
            deformation * deformation + sd * sd
        } else if ratio <= -4.0 {
            0.0
        } else {
            (deformation * deformation + sd * sd) * touching + deformation * sd * density
        };
        let slope =
            if ratio >= 4.0 { 2.0 * deformation } else { 2.0 * (deformation * touching + sd * density) };
        let damping = (1.0 + s[8]) * f64::from(c.dissipation_factor) / fixed.approach;
        let elastic = (1.0 + s[5]) * shape * square;
        let normal = (elastic * (1.0 + damping * rate)).max(0.0);
        let law = &c.friction;
        let size = f64::from(law.coulomb_coefficient)
            + f64::from(law.static_coefficient - law.coulomb_coefficient)
                * (-sliding.abs() / f64::from(law.stribeck_speed_m_s)).exp()
            + f64::from(law.viscous_slope_s_m) * (sliding.abs() - f64::from(law.viscous_onset_m_s)).max(0.0);
        let width = f64::from(law.regularisation_m_s);
        let friction = -(1.0 + s[7]) * size * (sliding / width).tanh() * normal;
        let factor = (1.0 + s[5]) * (1.0 + damping * rate);
        let shape_slope = shape * (2.0 / (3.0 * gap + 2.0 * inside) - 1.5 / (gap + inside));
        let by_deformation = (factor * (shape * slope + shape_slope * square) * sd).abs();
        let by_stiffness = (shape * square * (1.0 + damping * rate) * stiffness_sd).abs();
        let ratio = f64::from(c.dissipation_factor) / fixed.approach;
        let by_damping = (elastic * ratio * rate * damping_sd).abs();
        let products = by_deformation * by_damping + by_stiffness * (by_deformation + by_damping);
        let steepest = f64::from(law.static_coefficient) * normal;
        let bend = (0.5 * 0.77 * (sliding_sd / width).powi(2)).min(0.3);
        Contact {
            friction,
            y: friction * nz - normal * ny,
            z: -normal * nz - friction * ny,
            deformation,
            rate,
            normal_error: if normal > 0.0 {
                SQRT_2 * shape * sd * sd + products / normal.max(1.0)
            } else {
                0.0
            },
            friction_error: if sliding.abs() < 3.0 * width { bend * steepest } else { 0.0 },
        }
    }

    /// Derivative of the state.
    fn derivative(&self, s: &Vector, drive: &Drive, fixed: &Fixed) -> Vector {
        let c = &self.config;
        let contact = self.contact(s, drive, fixed);
        let (turning, arm, sine) = self.turning(s, drive);
        let reflected = f64::from(c.inertia_kg_m2) / (arm * arm);
        let driven = reflected * (drive[2] + f64::from(c.drive_lever_m) * sine * turning * turning);
        let load = fixed.load * (1.0 - f64::from(c.load_lever_m) / f64::from(c.drive_lever_m));
        let friction = contact.friction * f64::from(c.journal_radius_m) / arm;
        let along = driven + load + s[4] + contact.y - friction;
        let mass = f64::from(c.mass_kg);
        let mut rates = [0.0; N];
        (rates[0], rates[1]) = (s[2], s[3]);
        (rates[2], rates[3]) = (along / (mass + reflected), contact.z / mass - 9.81);
        rates
    }

    fn jacobian(&self, s: &Vector, drive: &Drive, fixed: &Fixed) -> Matrix {
        differences(s, |at| self.derivative(at, drive, fixed))
    }

    /// One step of Rosenbrock's method, with the Jacobian at its start.
    fn advance(
        &self,
        s: &Vector,
        [start, end]: [&Drive; 2],
        fixed: &Fixed,
        time: f64,
        jacobian: &Matrix,
    ) -> Vector {
        let gamma = 1.0 - 1.0 / SQRT_2;
        let system: Matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j| f64::from(u8::from(i == j)) - gamma * time * jacobian[i][j])
        });
        let first = solve(system, self.derivative(s, start, fixed));
        let midway: Vector = std::array::from_fn(|i| s[i] + time * first[i]);
        let rates = self.derivative(&midway, end, fixed);
        let second = solve(system, std::array::from_fn(|i| rates[i] - 2.0 * first[i]));
        std::array::from_fn(|i| s[i] + time * (1.5 * first[i] + 0.5 * second[i]))
    }

    fn predict(&mut self, time: f64) {
        let c = Numbers(&self.config);
        let fixed = self.fixed();
        let start = self.drive;
        let end = multiply4(&c.drive_transition(time), &start);
        let jacobian = self.jacobian(&self.state, &start, &fixed);
        // The linear system's own step is the transition; its derivative is exact.
        let linear = |direction: &Vector| {
            let gamma = 1.0 - 1.0 / SQRT_2;
            let system: Matrix = std::array::from_fn(|i| {
                std::array::from_fn(|j| f64::from(u8::from(i == j)) - gamma * time * jacobian[i][j])
            });
            let first = solve(system, multiply(&jacobian, direction));
            let midway: Vector = std::array::from_fn(|i| direction[i] + time * first[i]);
            let rates = multiply(&jacobian, &midway);
            let second = solve(system, std::array::from_fn(|i| rates[i] - 2.0 * first[i]));
            std::array::from_fn(|i| direction[i] + time * (1.5 * first[i] + 0.5 * second[i]))
        };
        let columns: Vec<Vector> =
            (0..N).map(|j| linear(&std::array::from_fn(|i| f64::from(u8::from(i == j))))).collect();
        let keeps = 1.0 / (1.0 + time / c.residual_time());
        let mut transition: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
        transition[4][4] = keeps;
        let contact = self.contact(&self.state, &start, &fixed);
        let (_, arm, _) = self.turning(&self.state, &start);
        let mut state = self.advance(&self.state, [&start, &end], &fixed, time, &jacobian);
        state[4] *= keeps;
        let distance = self.state[0].hypot(self.state[1]);
        let (ny, nz) = (self.state[0] / distance, self.state[1] / distance);
        let mut next = sandwich(&transition, &self.covariance);
        let mass = f64::from(self.config.mass_kg);
        let reflected = f64::from(self.config.inertia_kg_m2) / (arm * arm);
        let lever = f64::from(self.config.journal_radius_m) / arm;
        let (per_y, per_z) = (1.0 / (mass + reflected), 1.0 / mass);
        let normal = [-ny * per_y, -nz * per_z].map(|v| v * contact.normal_error * time);
        let friction = [(nz - lever) * per_y, -ny * per_z].map(|v| v * contact.friction_error * time);
        for i in 0..2 {
            for j in 0..2 {
                next[2 + i][2 + j] += normal[i] * normal[j] + friction[i] * friction[j];
            }
            next[2 + i][2 + i] += (0.01_f64 * 9.81).powi(2) * 1e-4 * time;
        }
        let [e, gap, q] = c.factors();
        let unknown = c.reflected().powi(2) * self.drive_covariance[2][2];
        next[4][4] += (c.residual_variance(self.load) + unknown) * 2.0 * time / c.residual_time();
        for (place, deviation) in [(5, e), (6, gap), (7, q), (8, 0.3)] {
            next[place][place] += deviation * deviation * time / 100.0;
        }
        (self.state, self.covariance, self.drive) = (state, next, end);
    }

    fn correct_drive(&mut self, c: Numbers<'_>, displacement: f64) {
        let period = f64::from(self.config.sample_period_s);
        if self.remaining_s > 0.0 {
            self.remaining_s -= period;
            let transition = c.drive_transition(period);
            let mut next = [[0.0; 4]; 4];
            for i in 0..4 {
                for j in 0..4 {
                    for k in 0..4 {
                        for l in 0..4 {
                            next[i][j] += transition[i][k] * self.drive_covariance[k][l] * transition[j][l];
                        }
                    }
                }
            }
            next[3][3] += c.jerk().powi(2) * 2.0 * period / c.jerk_time();
            let variance = next[0][0] + c.displacement_noise().powi(2);
            self.drive_gain = std::array::from_fn(|i| next[i][0] / variance);
            let first = next[0];
            for (row, gain) in next.iter_mut().zip(self.drive_gain) {
                row.iter_mut().zip(first).for_each(|(value, own)| *value -= gain * own);
            }
            self.drive_covariance = next;
        }
        let innovation = displacement - self.drive[0];
        self.drive.iter_mut().zip(self.drive_gain).for_each(|(value, gain)| *value += gain * innovation);
    }

    /// Corrects by a measured position in Joseph's form.
    fn correct(&mut self, axis: usize, measured: f64) {
        let noise = f64::from(self.config.noise.position_m).powi(2);
        let variance = self.covariance[axis][axis] + noise;
        let gain: Vector = std::array::from_fn(|i| self.covariance[i][axis] / variance);
        let innovation = measured - self.state[axis];
        let keeps: Matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j| f64::from(u8::from(i == j)) - if j == axis { gain[i] } else { 0.0 })
        });
        self.covariance = sandwich(&keeps, &self.covariance);
        for i in 0..N {
            self.state[i] += gain[i] * innovation;
            for j in 0..N {
                self.covariance[i][j] += gain[i] * gain[j] * noise;
            }
        }
        self.state[5] = self.state[5].clamp(-0.9, 9.0);
        self.state[7] = self.state[7].clamp(-0.9, 9.0);
    }

    fn scale_damping(&mut self) {
        let half = 0.5 * self.state[8].clamp(-1.0, 1.0);
        self.state[8] = 0.0;
        let fall = (4.0 * 9.81 * f64::from(self.config.radial_clearance_m)).sqrt();
        self.approach = (self.approach * (1.0 - half) / (1.0 + half))
            .clamp(0.5 * f64::from(self.config.latch_floor_m_s), 10.0 * fall);
    }

    fn onset(&mut self) {
        let fixed = self.fixed();
        let contact = self.contact(&self.state, &self.drive, &fixed);
        let sd = fixed.deviations[0];
        if contact.deformation < -3.0 * sd {
            self.is_touching = false;
        }
        if self.is_touching || contact.deformation <= 0.0 {
            return;
        }
        let floor = f64::from(self.config.latch_floor_m_s);
        let distance = self.state[0].hypot(self.state[1]);
        let mut row = [0.0; N];
        (row[2], row[3]) = (self.state[0] / distance, self.state[1] / distance);
        let rate_sd = self.variance(&row).max(0.0).sqrt();
        let speed = contact.rate.max(0.5 * rate_sd).max(floor);
        let rates = self.derivative(&self.state, &self.drive, &fixed);
        let passing = rates[2].hypot(rates[3]) * sd / (speed * speed);
        let spread = (rate_sd / speed).hypot(passing);
        let ratio = (speed / (speed / (1.0 + spread)).max(floor)).sqrt();
        self.approach = speed / ratio;
        self.is_touching = true;
        self.state[8] = 0.0;
        for i in 0..N {
            self.covariance[8][i] = 0.0;
            self.covariance[i][8] = 0.0;
        }
        self.covariance[8][8] = 0.3 * 0.3 + spread.min(ratio).powi(2);
    }
}

/// Noise levels of a configuration.
#[derive(Clone, Copy)]
struct Numbers<'a>(&'a FilterConfiguration);

impl Numbers<'_> {
    fn frequency(self) -> f64 {
        TAU / f64::from(self.0.period_s)
    }

    fn reflected(self) -> f64 {
        f64::from(self.0.inertia_kg_m2) / f64::from(self.0.drive_lever_m).powi(2)
    }

    fn jerk(self) -> f64 {
        0.5 * f64::from(self.0.stroke_m) * self.frequency().powi(3)
    }

    fn jerk_time(self) -> f64 {
        0.5 * f64::from(self.0.period_s)
    }

    fn displacement_noise(self) -> f64 {
        let lever = f64::from(self.0.drive_lever_m);
        f64::from(self.0.noise.position_m).hypot(lever * f64::from(self.0.noise.angle_rad))
    }

    fn residual_variance(self, load: f64) -> f64 {
        let unknown = &self.0.uncertainty;
        let drive = f64::from(unknown.inertia_share) * self.reflected() * self.jerk() / self.frequency();
        let ratio = f64::from(self.0.load_lever_m) / f64::from(self.0.drive_lever_m);
        drive * drive + 2.0 * (f64::from(unknown.lever_share) * load * ratio).powi(2)
    }

    fn residual_time(self) -> f64 {
        0.02 * f64::from(self.0.period_s)
    }

    fn factors(self) -> [f64; 3] {
        let unknown = &self.0.uncertainty;
        [unknown.stiffness_share, unknown.clearance_m, unknown.friction_share].map(f64::from)
    }

    fn drive_transition(self, h: f64) -> [[f64; 4]; 4] {
        [
            [1.0, h, h * h / 2.0, h * h * h / 6.0],
            [0.0, 1.0, h, h * h / 2.0],
            [0.0, 0.0, 1.0, h],
            [0.0, 0.0, 0.0, 1.0 - h / self.jerk_time()],
        ]
    }
}

fn differences(at: &Vector, of: impl Fn(&Vector) -> Vector) -> Matrix {
    let mut matrix = [[0.0; N]; N];
    for j in 0..N {
        let (mut low, mut high) = (*at, *at);
        low[j] -= STEPS[j];
        high[j] += STEPS[j];
        let (low, high) = (of(&low), of(&high));
        for (i, row) in matrix.iter_mut().enumerate() {
            row[j] = (high[i] - low[i]) / (2.0 * STEPS[j]);
        }
    }
    matrix
}

fn diagonal<const M: usize>(values: [f64; M]) -> [[f64; M]; M] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { values[i] } else { 0.0 }))
}

fn multiply(matrix: &Matrix, vector: &Vector) -> Vector {
    std::array::from_fn(|i| (0..N).map(|j| matrix[i][j] * vector[j]).sum())
}

fn multiply4(matrix: &[[f64; 4]; 4], vector: &Drive) -> Drive {
    std::array::from_fn(|i| (0..4).map(|j| matrix[i][j] * vector[j]).sum())
}

/// `a p a'`.
fn sandwich(a: &Matrix, p: &Matrix) -> Matrix {
    let left: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * p[k][j]).sum()));
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| left[i][k] * a[j][k]).sum()))
}

/// Solves a linear system.
fn solve(a: Matrix, b: Vector) -> Vector {
    let matrix = SMatrix::<f64, N, N>::from_fn(|row, column| a[row][column]);
    matrix.lu().solve(&SVector::from(b)).unwrap().into()
}
