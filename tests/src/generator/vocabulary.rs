//! Random draws of the effects: sign, phase and shape within the documented ranges. The magnitude
//! stays free, to be scaled to a requested size.

use super::drawn::Draw;
pub use super::drawn::Drawn;
use super::hidden::HiddenEffect;
use super::noise::Noise;
use super::plant::Plant;
use super::record::Record;
use std::f64::consts::TAU;

/// Returns the parameters that define the size of an effect; the others define its shape.
pub(crate) fn size_parameters(effect: &str) -> &'static [&'static str] {
    match effect {
        "clearance-wear" => &["clearance_increase_m"],
        "restitution" => &["restitution_change"],
        "journal-out-of-round" => &["cosine_m", "sine_m"],
        "misalignment" => &["slope_y_rad", "slope_z_rad"],
        "inertia-mismatch" => &["inertia_change", "relative_change"],
        "shaft-flexibility" => &["compliance_rad_nm"],
        "stribeck-friction" => &["effort_rise", "coefficient_rise"],
        "coulomb-level" | "friction-step" => &["coulomb_effort", "relative_change"],
        "viscous-friction" => &["viscous_effort", "viscous_n_s_m"],
        "viscous-asymmetry" => &["asymmetry_effort", "asymmetry_n_s_m"],
        "coulomb-asymmetry" => &["asymmetry_effort", "asymmetry"],
        "load-dependent-friction" => &["load_coefficient", "load_exponent"],
        "breakaway" => &["excess_effort", "excess"],
        "presliding-hysteresis" => &["distance_m"],
        "thermal-friction-drift" => &["level_per_k"],
        "seal-friction" => &["seal_force_n"],
        "position-ripple" => &["cos_effort", "sin_effort", "cos_torque_nm", "sin_torque_nm"],
        "hydraulic-compliance" => &["compliance_m_n"],
        "drive-lag" => &["lag_s"],
        "load-gain" => &["gain_change"],
        "spring-effort" => &["stiffness"],
        "position-friction" => &["friction_slope"],
        "load-ripple" => &["cos_force_n", "sin_force_n"],
        "fork-backlash" => &["backlash_m"],
        "squeeze-film" => &["viscosity_pa_s"],
        "sensor-offset" => &["offset"],
        "sensor-delay" => &["delay_s"],
        "sensor-drift" => &["drift_per_s"],
        "sensor-saturation" => &["inverse_limit"],
        // contact-stiffness, lever-ratio, sensor-gain.
        _ => &["relative_change"],
    }
}

const SENSOR: [&str; 5] =
    ["sensor-offset", "sensor-gain", "sensor-delay", "sensor-drift", "sensor-saturation"];
const ROTARY: [&str; 15] = [
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

/// Returns the effects that a plant can show.
pub fn effects(plant: Plant) -> Vec<&'static str> {
    match plant {
        Plant::Rotary => [&ROTARY[..], &SENSOR].concat(),
        Plant::Linear => [&ROTARY[..], &["load-gain", "load-ripple"], &SENSOR].concat(),
        Plant::Bench => [super::bench_vocabulary::EFFECTS, &SENSOR].concat(),
        Plant::TwoPlane => [super::bench_vocabulary::TILTING, &SENSOR].concat(),
    }
}

/// Draws an effect for a record; `None` if its plant does not have it.
pub fn draw(effect: &str, record: &Record, base: &[Vec<f64>], noise: &mut Noise) -> Option<Drawn> {
    if !effects(record.plant).contains(&effect) {
        return None;
    }
    let sign = if noise.uniform() < 0.5 { -1.0 } else { 1.0 };
    let phase = TAU * noise.uniform();
    if effect.starts_with("sensor-") {
        let outputs = record.plant.outputs();
        let which = ((noise.uniform() * outputs.len() as f64) as usize).min(outputs.len() - 1);
        return Some(sensor(effect, record, outputs[which], &base[which], sign));
    }
    if record.plant.is_transmission() {
        return super::bench_vocabulary::draw(effect, sign, phase, noise);
    }
    Some(of_axis(effect, record, sign, phase, noise))
}

fn sensor(effect: &str, record: &Record, channel: &str, base: &[f64], sign: f64) -> Drawn {
    let sensors = record.sensors();
    let floor = sensors.iter().find(|s| s.channel == channel).map_or(1.0, |s| s.floor());
    let largest = base.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let (parameter, share, guess, most) = match effect {
        "sensor-offset" => ("offset", sign, floor, 1e6 * floor),
        "sensor-gain" => ("relative_change", sign, 2.0 * floor / largest, 0.9),
        "sensor-delay" => ("delay_s", 1.0, 1e-3, 0.2),
        "sensor-drift" => ("drift_per_s", sign, floor / record.length_s(), 1e6 * floor),
        _ => ("inverse_limit", 1.0, 1.1 / largest, 20.0 / largest),
    };
    let effect = HiddenEffect::for_sensor(effect, channel, parameter, 0.0);
    Drawn { effect, sizes: vec![(parameter, share)], guess, most }
}

fn of_axis(effect: &str, record: &Record, sign: f64, phase: f64, noise: &mut Noise) -> Drawn {
    let rotary = record.plant == Plant::Rotary;
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
            let at = record.logger.start_s + share * record.length_s();
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
