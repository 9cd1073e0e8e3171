//! Effects of a driven axis: their names, their random draws, and the terms that they add to the
//! balance of [`super::axis`]. Units: SI, efforts in N or N m.

use super::axis_data::{RealAxis, STEP_S};
use super::drawn::{Draw, Drawn};
use super::hidden::{HiddenEffect, total};
use super::motion::Moved;
use super::noise::Noise;
use super::plant::Plant;
use std::f64::consts::TAU;

/// Length of the ramp of a step of friction, s.
const RAMP_S: f64 = 0.01;

/// Effects of every axis, without sensor effects.
pub(super) const ROTARY: [&str; 15] = [
    "inertia-mismatch",
    "stribeck-friction",
    "coulomb-level",
    "viscous-friction",
    "viscous-asymmetry",
    "coulomb-asymmetry",
    "load-dependent-friction",
    "position-friction",
    "breakaway",
    "presliding-hysteresis",
    "thermal-friction-drift",
    "friction-step",
    "spring-effort",
    "position-ripple",
    "drive-lag",
];

/// Further effects of a linear axis.
pub(super) const LINEAR: &[&str] = &["load-gain", "load-ripple"];

/// Parameters that define the size of an effect.
pub(super) const SIZES: &[(&str, &[&str])] = &[
    ("inertia-mismatch", &["inertia_change"]),
    ("stribeck-friction", &["effort_rise"]),
    ("coulomb-level", &["coulomb_effort"]),
    ("viscous-friction", &["viscous_effort"]),
    ("viscous-asymmetry", &["asymmetry_effort"]),
    ("coulomb-asymmetry", &["asymmetry_effort"]),
    ("load-dependent-friction", &["load_coefficient"]),
    ("position-friction", &["friction_slope"]),
    ("breakaway", &["excess_effort"]),
    ("presliding-hysteresis", &["distance_m"]),
    ("thermal-friction-drift", &["level_per_k"]),
    ("friction-step", &["coulomb_effort"]),
    ("spring-effort", &["stiffness"]),
    ("position-ripple", &["cos_effort", "sin_effort"]),
    ("drive-lag", &["lag_s"]),
    ("load-gain", &["gain_change"]),
    ("load-ripple", &["cos_force_n", "sin_force_n"]),
];

/// Draws an effect of an axis whose log has a start and a length in s.
pub(super) fn draw(
    effect: &str,
    plant: Plant,
    (start_s, length_s): (f64, f64),
    sign: f64,
    phase: f64,
    noise: &mut Noise,
) -> Drawn {
    let rotary = plant == Plant::Rotary;
    // Noise floor of the effort, radius of friction, stroke, usual speed.
    let (floor, radius, stroke, speed) = if rotary { (1.0, 0.07, 0.8, 0.6) } else { (3.0, 1.0, 0.3, 0.2) };
    let mut between = |low: f64, high: f64| low * (high / low).powf(noise.uniform());
    let slide = radius * speed;
    let (sizes, guess, most, shapes): Draw = match effect {
        "inertia-mismatch" => (vec![("inertia_change", sign)], 2.0 * floor, 1e4, vec![]),
        "stribeck-friction" => {
            (vec![("effort_rise", sign)], 4.0 * floor, 1e4, vec![("speed_m_s", slide * between(0.1, 0.4))])
        }
        "coulomb-level" => (vec![("coulomb_effort", sign)], 3.0 * floor, 1e4, vec![]),
        "viscous-friction" => (vec![("viscous_effort", sign)], 3.0 * floor / speed, 1e4, vec![]),
        "viscous-asymmetry" => (vec![("asymmetry_effort", sign)], 3.0 * floor / speed, 1e4, vec![]),
        "coulomb-asymmetry" => (vec![("asymmetry_effort", sign)], 3.0 * floor, 1e4, vec![]),
        "load-dependent-friction" => {
            (vec![("load_coefficient", sign)], if rotary { 0.002 } else { 0.01 }, 1.0, vec![])
        }
        "breakaway" => {
            let shapes = vec![
                ("rest_time_s", between(0.1, 0.5)),
                ("distance_m", radius * stroke * between(0.02, 0.08)),
            ];
            (vec![("excess_effort", 1.0)], 10.0 * floor, 1e4, shapes)
        }
        "presliding-hysteresis" => (vec![("distance_m", 1.0)], 1e-4, 5e-3, vec![]),
        "thermal-friction-drift" => {
            let shapes = vec![("resistance_k_w", 0.1), ("time_constant_s", between(4.0, 20.0))];
            (vec![("level_per_k", sign)], 0.005, 0.4, shapes)
        }
        "friction-step" => {
            let share = 0.1 + 0.8 * noise.uniform();
            let at = start_s + share * length_s;
            (vec![("coulomb_effort", sign)], 3.0 * floor, 1e4, vec![("time_s", at)])
        }
        "position-ripple" => (
            vec![("cos_effort", phase.cos()), ("sin_effort", phase.sin())],
            2.0 * floor,
            1e4,
            vec![("period", stroke * between(0.06, 0.35))],
        ),
        "load-gain" => (vec![("gain_change", sign)], 3e-3, 1.0, vec![]),
        "spring-effort" => (vec![("stiffness", sign)], 2.0 * floor / stroke, 1e6, vec![]),
        "position-friction" => (vec![("friction_slope", sign)], 2.0 * floor / stroke, 1e6, vec![]),
        "load-ripple" => (
            vec![("cos_force_n", phase.cos()), ("sin_force_n", phase.sin())],
            2.0 * floor,
            1e5,
            vec![("frequency_hz", between(2.0, 30.0))],
        ),
        _ => (vec![("lag_s", 1.0)], 2e-3, 0.1, vec![]),
    };
    Drawn { effect: HiddenEffect::new(effect, &shapes), sizes, guess, most }
}

/// Linear memory `state' = rate (target - state)`.
#[derive(Clone, Copy, Default)]
pub(super) struct Memory {
    pub(super) state: f64,
}

impl Memory {
    /// `1/(1 + x + x^2/2)` replaces the exponential: stable for any rate.
    fn step(&mut self, rate: f64, target: f64) {
        let x = rate * STEP_S;
        self.state = target + (self.state - target) / (1.0 + x * (1.0 + 0.5 * x));
    }
}

/// Parameters of the added effects.
pub(super) struct Added {
    stribeck: Option<(f64, f64)>,
    breakaway: Option<(f64, f64, f64)>,
    presliding_m: f64,
    pub(super) thermal: Option<(f64, f64, f64)>,
    step: Option<(f64, f64)>,
    position_ripple: Option<(f64, f64, f64)>,
    load_ripple: Option<(f64, f64, f64)>,
    pub(super) lag_s: f64,
    coulomb_asymmetry: f64,
    viscous_asymmetry: f64,
    spring: f64,
    /// Unbalanced moments at the angles 0 and a quarter of a turn, N m.
    gravity: [f64; 2],
    friction_slope: f64,
}

impl Added {
    pub(super) fn new(hidden: &[HiddenEffect]) -> Self {
        let of = |name: &str| hidden.iter().find(|h| h.effect == name);
        let three = |name, [a, b, c]: [&str; 3]| of(name).map(|h| (h.get(a), h.get(b), h.get(c)));
        Self {
            stribeck: of("stribeck-friction").map(|h| (h.get("effort_rise"), h.get("speed_m_s"))),
            breakaway: three("breakaway", ["excess_effort", "rest_time_s", "distance_m"]),
            presliding_m: total(hidden, "presliding-hysteresis", "distance_m"),
            thermal: three("thermal-friction-drift", ["level_per_k", "resistance_k_w", "time_constant_s"]),
            step: of("friction-step").map(|h| (h.get("coulomb_effort"), h.get("time_s"))),
            position_ripple: three("position-ripple", ["cos_effort", "sin_effort", "period"]),
            load_ripple: three("load-ripple", ["cos_force_n", "sin_force_n", "frequency_hz"]),
            lag_s: total(hidden, "drive-lag", "lag_s"),
            coulomb_asymmetry: total(hidden, "coulomb-asymmetry", "asymmetry_effort"),
            viscous_asymmetry: total(hidden, "viscous-asymmetry", "asymmetry_effort"),
            spring: total(hidden, "spring-effort", "stiffness"),
            gravity: ["cos_effort", "sin_effort"].map(|p| total(hidden, "gravity-moment", p)),
            friction_slope: total(hidden, "position-friction", "friction_slope"),
        }
    }
}

fn wave((cosine, sine, period): (f64, f64, f64), at: f64) -> f64 {
    if period <= 0.0 {
        return 0.0;
    }
    let (s, c) = (TAU * at / period).sin_cos();
    cosine * c + sine * s
}

impl RealAxis {
    /// Returns the effort and its friction at a time.
    pub(super) fn effort(
        &self,
        added: &Added,
        time_s: f64,
        driven: Moved,
        load_n: f64,
        (turned, adhesion, warmth): (&mut Memory, &mut Memory, &mut Memory),
    ) -> (f64, f64) {
        let slide = driven.speed * self.radius_m;
        let sign = 2.0 / (1.0 + (-2.0 * slide / self.sign_width_m_s).exp()) - 1.0;
        let load = load_n + added.load_ripple.map_or(0.0, |(c, s, f)| wave((c, s, 1.0 / f), time_s));
        let mut dry = self.coulomb + self.load_coefficient * load.abs() * self.radius_m;
        dry += added.friction_slope * driven.place;
        if let Some((rise, speed)) = added.stribeck {
            dry += rise / (slide.abs() / speed).exp();
        }
        if let Some((excess, rest_s, distance)) = added.breakaway {
            let (ageing, wearing) = (1.0 / rest_s, slide.abs() / distance);
            adhesion.step(ageing + wearing, ageing / (ageing + wearing));
            dry += excess * adhesion.state;
        }
        if let Some((change, at)) = added.step {
            dry += change * ((time_s - at) / RAMP_S + 0.5).clamp(0.0, 1.0);
        }
        if let Some((level, _, _)) = added.thermal {
            dry *= (1.0 + level * warmth.state).clamp(0.0, 3.0);
        }
        let mut direction = sign;
        if added.presliding_m > 0.0 {
            turned.step(slide.abs() / added.presliding_m, sign);
            direction = turned.state;
        }
        let friction = dry * direction
            + 0.5 * added.coulomb_asymmetry * sign * sign
            + self.viscous * driven.speed
            + added.viscous_asymmetry * driven.speed * sign;
        if let Some((_, resistance, time)) = added.thermal {
            warmth.step(1.0 / time, resistance * (friction * driven.speed).max(0.0));
        }
        let over_place =
            added.spring * driven.place + added.position_ripple.map_or(0.0, |r| wave(r, driven.place));
        // A weight on an arm, as a harmonic of one turn.
        let weight = wave((added.gravity[0], added.gravity[1], TAU), driven.place);
        let over_place = over_place + weight;
        (self.load_gain * load + self.inertia * driven.acceleration + friction + over_place, friction)
    }
}
