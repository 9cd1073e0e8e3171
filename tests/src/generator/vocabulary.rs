//! Random draws of the effects: sign, phase and shape within the documented ranges. The magnitude
//! stays free, to be scaled to a requested size.

pub use super::drawn::Drawn;
use super::hidden::HiddenEffect;
use super::noise::Noise;
use super::plant::Plant;
use super::record::Record;
use super::{axis_effects, planar_effects};
use std::f64::consts::TAU;

/// Returns the parameters that define the size of an effect on any plant; the others define its
/// shape.
pub fn size_parameters(effect: &str) -> Vec<&'static str> {
    let sensor: &[(&str, &[&str])] = &[
        ("sensor-offset", &["offset"]),
        ("sensor-gain", &["relative_change"]),
        ("sensor-delay", &["delay_s"]),
        ("sensor-drift", &["drift_per_s"]),
        ("sensor-saturation", &["inverse_limit"]),
    ];
    let all = axis_effects::SIZES.iter().chain(planar_effects::SIZES).chain(sensor);
    all.filter(|(name, _)| *name == effect).flat_map(|(_, sizes)| *sizes).copied().collect()
}

const SENSOR: [&str; 5] =
    ["sensor-offset", "sensor-gain", "sensor-delay", "sensor-drift", "sensor-saturation"];

/// Returns the effects that a plant can show.
pub fn effects(plant: Plant) -> Vec<&'static str> {
    match plant {
        Plant::Rotary => [&axis_effects::ROTARY[..], &SENSOR].concat(),
        Plant::Linear => [&axis_effects::ROTARY[..], axis_effects::LINEAR, &SENSOR].concat(),
        Plant::Bench => [planar_effects::EFFECTS, &SENSOR].concat(),
        Plant::TwoPlane => [planar_effects::TILTING, &SENSOR].concat(),
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
        return planar_effects::draw(effect, sign, phase, noise);
    }
    let log_s = (record.logger.start_s, record.length_s());
    Some(axis_effects::draw(effect, record.plant, log_s, sign, phase, noise))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_every_plant_has_parameters_of_its_size() {
        for plant in [Plant::Rotary, Plant::Linear, Plant::Bench, Plant::TwoPlane] {
            for effect in effects(plant) {
                assert!(!size_parameters(effect).is_empty(), "{effect}");
            }
        }
    }
}
