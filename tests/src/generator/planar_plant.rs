//! The equations of the planar transmission bench for [`super::planar`], with what effects add to them.
//!
//! Fork on a crank pin, shaft with journal in a clearance bearing, load on a second crank: see the head of
//! `bench::transmission` for the drawing. Effects have the meaning that `docs/effects.md` documents.

use super::hidden::{HiddenEffect, total};
use super::planar::{Hidden, RealBench, Row, State};
use std::f64::consts::{PI, TAU};

const GRAVITY: f64 = 9.81;
/// Normal force that an exponent of friction is relative to, N.
const REFERENCE_N: f64 = 10e3;
/// Length of the ramp of a step of friction, s.
const RAMP_S: f64 = 4e-3;

/// What effects add beyond other numbers of the bench.
#[derive(Default)]
struct Added {
    stribeck: (f64, f64),
    coulomb_asymmetry: f64,
    viscous_asymmetry: f64,
    load_exponent: f64,
    step: (f64, f64),
    position_ripple: (f64, f64, f64),
    load_ripple: (f64, f64, f64),
    seal_n: f64,
    lag_s: f64,
}

impl Added {
    fn new(effects: &[HiddenEffect]) -> Self {
        let of = |effect: &str, parameter: &str| total(effects, effect, parameter);
        let three = |effect: &str, [a, b, c]: [&str; 3]| (of(effect, a), of(effect, b), of(effect, c));
        Self {
            stribeck: (of("stribeck-friction", "coefficient_rise"), of("stribeck-friction", "speed_m_s")),
            coulomb_asymmetry: of("coulomb-asymmetry", "asymmetry"),
            viscous_asymmetry: of("viscous-asymmetry", "asymmetry_n_s_m"),
            load_exponent: of("load-dependent-friction", "load_exponent"),
            step: (of("friction-step", "relative_change"), of("friction-step", "time_s")),
            position_ripple: three("position-ripple", ["cos_torque_nm", "sin_torque_nm", "period_rad"]),
            load_ripple: three("load-ripple", ["cos_force_n", "sin_force_n", "frequency_hz"]),
            seal_n: of("seal-friction", "seal_force_n"),
            lag_s: of("drive-lag", "lag_s"),
        }
    }
}

/// A bench under its effects.
pub(super) struct Plant {
    pub(super) drive_lever_m: f64,
    load_lever_m: f64,
    mass: f64,
    inertia: f64,
    pub(super) clearance_m: f64,
    journal_radius_m: f64,
    effective_modulus: f64,
    damping_factor: f64,
    friction: f64,
    viscous: f64,
    load_n: f64,
    third_harmonic_n: f64,
    column: Option<(f64, f64)>,
    added: Added,
}

impl Plant {
    pub(super) fn new(real: &RealBench, hidden: &Hidden, effects: &[HiddenEffect]) -> Self {
        let of = |effect: &str, parameter: &str| total(effects, effect, parameter);
        let factor = |effect: &str| 1.0 + of(effect, "relative_change");
        let clearance_m =
            real.clearance_m + hidden.clearance_m + of("clearance-wear", "clearance_increase_m");
        let inertia = real.inertia.1 * factor("inertia-mismatch");
        let modulus_pa = real.modulus_pa * factor("contact-stiffness");
        let compliance = |modulus: f64, poisson: f64| (1.0 - poisson * poisson) / modulus;
        let restitution = (0.4 + of("restitution", "restitution_change")).clamp(0.05, 1.0);
        let compliance_m_n = hidden.compliance_m_n + of("hydraulic-compliance", "compliance_m_n");
        let column = (compliance_m_n > 0.0).then(|| {
            let stiffness = 1.0 / compliance_m_n;
            let reduced = inertia / real.levers_m.0.powi(2);
            (stiffness, 0.2 * (stiffness * reduced).sqrt())
        });
        Self {
            drive_lever_m: real.levers_m.0,
            load_lever_m: real.levers_m.1 * factor("lever-ratio"),
            mass: real.inertia.0,
            inertia,
            clearance_m,
            journal_radius_m: 0.070 - clearance_m,
            effective_modulus: 1.0 / (compliance(modulus_pa, 0.3) + compliance(206e9, 0.3)),
            damping_factor: 0.75 * (1.0 - restitution * restitution) * (2.0 * (1.0 - restitution)).exp(),
            friction: real.friction * (1.0 + hidden.friction) * factor("coulomb-level"),
            viscous: hidden.viscous_n_s_m + of("viscous-friction", "viscous_n_s_m"),
            load_n: real.load_n,
            third_harmonic_n: hidden.third_harmonic_n,
            column,
            added: Added::new(effects),
        }
    }

    /// Displacement, velocity and acceleration of the drive as logged.
    pub(super) fn drive(&self, t: f64) -> (f64, f64, f64) {
        let (half, w) = (0.086, TAU);
        (half * (1.0 - (w * t).cos()), half * w * (w * t).sin(), half * w * w * (w * t).cos())
    }

    fn load(&self, t: f64) -> f64 {
        if t < 0.05 { 0.5 * self.load_n * (1.0 - (PI * t / 0.05).cos()) } else { self.load_n }
    }

    /// F_cy, F_cz, T_f.
    fn bearing(&self, t: f64, s: &State, speed: f64, latched: f64) -> (f64, f64, f64) {
        let distance = s[0].hypot(s[1]);
        let depth = distance - self.clearance_m;
        if depth <= 0.0 {
            return (0.0, 0.0, 0.0);
        }
        let (ny, nz) = (s[0] / distance, s[1] / distance);
        let gap = self.clearance_m;
        let stiffness = PI / 8.0
            * self.effective_modulus
            * (2.0 * depth * (3.0 * gap + 2.0 * depth).powi(2) / (gap + depth).powi(3)).sqrt();
        let rate = ny * s[2] + nz * s[3];
        let normal = stiffness * depth.powf(1.5) * (1.0 + self.damping_factor * rate / latched.max(1e-3));
        let normal = normal.max(0.0);
        let slide = speed * self.journal_radius_m + nz * s[2] - ny * s[3];
        let sign = 1.0 - 2.0 / (1.0 + (2.0 * slide / 1e-3).exp());
        let added = &self.added;
        let mut coefficient = self.friction * (0.14 + 0.08 * (-slide.abs() / 0.02).exp());
        if added.stribeck.0 != 0.0 {
            coefficient += added.stribeck.0 / (slide.abs() / added.stribeck.1).exp();
        }
        coefficient *= 1.0 + added.coulomb_asymmetry * sign;
        if added.load_exponent != 0.0 && normal > 0.0 {
            coefficient *= (added.load_exponent * (normal / REFERENCE_N).ln()).exp();
        }
        coefficient *= 1.0 + added.step.0 * ((t - added.step.1) / RAMP_S + 0.5).clamp(0.0, 1.0);
        let friction = -coefficient * normal * sign - (self.viscous + added.viscous_asymmetry * sign) * slide;
        (-normal * ny + friction * nz, -normal * nz - friction * ny, friction * self.journal_radius_m)
    }

    /// Derivative and everything a row needs.
    pub(super) fn derivative(&self, t: f64, s: &State, latched: f64) -> (State, Row) {
        let (x, v, a) = self.drive((t - self.added.lag_s).max(0.0));
        let measured = self.load(t);
        let (sine, speed) = match self.column {
            Some(_) => (s[4].sin(), s[5]),
            None => {
                let sine = (x - s[0]) / self.drive_lever_m;
                (sine, (v - s[2]) / (self.drive_lever_m * (1.0 - sine * sine).sqrt()))
            }
        };
        let cosine = (1.0 - sine * sine).sqrt();
        let lever = self.drive_lever_m * cosine;
        let (fy, fz, bearing_torque) = self.bearing(t, s, speed, latched);
        let torque = bearing_torque + wave(self.added.position_ripple, sine.asin());
        let (cosine_n, sine_n, frequency_hz) = self.added.load_ripple;
        let pin = s[2] + self.load_lever_m * cosine * speed;
        let load = measured + wave((cosine_n, sine_n, 1.0 / frequency_hz), t)
            - self.added.seal_n * (pin / 1e-3).tanh();
        let extra = self.third_harmonic_n * (3.0 * TAU * t).sin();
        let vertical = (fz + extra) / self.mass - GRAVITY;
        let (fork, lateral, angular) = match self.column {
            Some((stiffness, damping)) => {
                let fork =
                    stiffness * (x - s[0] - self.drive_lever_m * sine) + damping * (v - s[2] - lever * speed);
                let angular = (fork * lever + load * self.load_lever_m * cosine + torque) / self.inertia;
                (fork, (fork + load + fy) / self.mass, angular)
            }
            None => {
                let reduced = self.inertia / (lever * lever);
                let given = a + self.drive_lever_m * sine * speed * speed;
                let lateral = (reduced * given + load * (1.0 - self.load_lever_m / self.drive_lever_m) + fy
                    - torque / lever)
                    / (self.mass + reduced);
                (self.mass * lateral - load - fy, lateral, 0.0)
            }
        };
        let (x, v, _) = self.drive(t);
        let outputs = [sine.asin(), speed, s[0], s[1], fy, fz, bearing_torque, fork];
        let row = Row { drive: (x, v), load: measured, outputs };
        ([s[2], s[3], lateral, vertical, speed, angular], row)
    }

    /// Everything that a log may show of a state.
    pub(super) fn row(&self, t: f64, s: &State, latched: f64) -> Row {
        self.derivative(t, s, latched).1
    }
}

/// `A cos + B sin` of a place on a period; nothing without one.
fn wave((cosine, sine, period): (f64, f64, f64), place: f64) -> f64 {
    if cosine == 0.0 && sine == 0.0 {
        return 0.0;
    }
    let (s, c) = (TAU * place / period).sin_cos();
    cosine * c + sine * s
}
