//! Sensors and logger: delay, gain, offset, drift, limit, coloured noise, resolution and lost
//! samples, written as CSV.
//!
//! A reading is the signal at an earlier time, interpolated linearly between the plant's fine
//! steps. Noise is white, or a first-order autoregression with the same standard deviation.

use super::hidden::HiddenEffect;
use super::noise::Noise;
use std::fmt::Write as _;

/// True signals on an even grid from time 0, by channel.
pub struct Signals {
    /// Step, s.
    pub step_s: f64,
    /// Inputs of the plant.
    pub inputs: Vec<(&'static str, Vec<f64>)>,
    /// Outputs of the plant.
    pub outputs: Vec<(&'static str, Vec<f64>)>,
}

/// Noise (standard deviation) and resolution of a channel.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Channel.
    pub channel: &'static str,
    /// Standard deviation.
    pub noise: f64,
    /// Resolution.
    pub resolution: f64,
}

impl Reading {
    /// Returns the standard deviation of noise and resolution together.
    pub fn floor(&self) -> f64 {
        (self.noise * self.noise + self.resolution * self.resolution / 12.0).sqrt()
    }
}

/// The logger of a record.
#[derive(Clone, Copy, Debug)]
pub struct Logger {
    /// Samples a second.
    pub rate_hz: f64,
    /// Correlation of the noise from sample to sample; 0: white.
    pub colour: f64,
    /// Share of lost samples.
    pub lost: f64,
    /// First time stamp, s.
    pub start_s: f64,
}

/// Returns the output readings without noise at the logger's times, by channel: the basis of sizes.
pub fn readings(signals: &Signals, rate_hz: f64, hidden: &[HiddenEffect]) -> Vec<Vec<f64>> {
    let mut all = unlimited(signals, rate_hz, hidden);
    for (values, (channel, _)) in all.iter_mut().zip(&signals.outputs) {
        let most = limit(channel, hidden);
        values.iter_mut().for_each(|v| *v = v.clamp(-most, most));
    }
    all
}

/// Returns the same before the sensor's limit, which applies to signal and noise together.
fn unlimited(signals: &Signals, rate_hz: f64, hidden: &[HiddenEffect]) -> Vec<Vec<f64>> {
    let count = signals.outputs.first().map_or(0, |o| (o.1.len() as f64 * signals.step_s * rate_hz) as usize);
    let one = |(channel, values): &(&'static str, Vec<f64>)| {
        let of = |effect: &str, parameter: &str| -> f64 {
            let mine = hidden.iter().filter(|h| h.effect == effect && h.channel.as_deref() == Some(channel));
            mine.map(|h| h.get(parameter)).sum()
        };
        let (late, gain) = (of("sensor-delay", "delay_s"), 1.0 + of("sensor-gain", "relative_change"));
        let (offset, drift) = (of("sensor-offset", "offset"), of("sensor-drift", "drift_per_s"));
        let read = |t: f64| gain * between(values, (t - late) / signals.step_s) + offset + drift * t;
        (0..count).map(|i| read(i as f64 / rate_hz)).collect()
    };
    signals.outputs.iter().map(one).collect()
}

/// Returns the largest reading of a channel; infinite without saturation.
pub fn limit(channel: &str, hidden: &[HiddenEffect]) -> f64 {
    let of = |h: &&HiddenEffect| h.effect == "sensor-saturation" && h.channel.as_deref() == Some(channel);
    let inverse: f64 = hidden.iter().filter(of).map(|h| h.get("inverse_limit")).sum();
    if inverse > 0.0 { 1.0 / inverse } else { f64::INFINITY }
}

fn between(values: &[f64], place: f64) -> f64 {
    let place = place.clamp(0.0, values.len().saturating_sub(1) as f64);
    let index = (place as usize).min(values.len().saturating_sub(2));
    let (Some(a), Some(b)) = (values.get(index), values.get(index + 1)) else {
        return values.first().copied().unwrap_or_default();
    };
    a + (b - a) * (place - index as f64)
}

fn round(value: f64, resolution: f64) -> f64 {
    if resolution > 0.0 { (value / resolution).round() * resolution } else { value }
}

/// Returns the log of a record as CSV text.
pub fn log(
    signals: &Signals,
    sensors: &[Reading],
    logger: &Logger,
    hidden: &[HiddenEffect],
    noise: &mut Noise,
) -> String {
    let outputs = unlimited(signals, logger.rate_hz, hidden);
    let count = outputs.first().map_or(0, Vec::len);
    let of = |channel: &str| sensors.iter().find(|s| s.channel == channel).copied();
    let names: Vec<&str> = signals.inputs.iter().chain(&signals.outputs).map(|s| s.0).collect();
    let mut text = format!("t_s,{}\n", names.join(","));
    let mut coloured = vec![0.0; names.len()];
    coloured.iter_mut().for_each(|state| *state = noise.normal());
    for i in 0..count {
        let t = i as f64 / logger.rate_hz;
        let inputs = signals.inputs.iter().map(|(_, v)| between(v, t / signals.step_s));
        let values: Vec<f64> = inputs.chain(outputs.iter().map(|v| v[i])).collect();
        let mut row = format!("{:.5}", logger.start_s + t);
        for ((value, name), state) in values.iter().zip(&names).zip(&mut coloured) {
            let output = signals.outputs.iter().any(|o| o.0 == *name);
            let colour = if output { logger.colour } else { 0.0 };
            *state = colour * *state + (1.0 - colour * colour).sqrt() * noise.normal();
            let sensor = of(name).unwrap_or(Reading { channel: "", noise: 0.0, resolution: 0.0 });
            let most = limit(name, hidden);
            let read = round((value + sensor.noise * *state).clamp(-most, most), sensor.resolution);
            let _ = write!(row, ",{read:.9e}");
        }
        if i > 0 && noise.uniform() < logger.lost {
            continue;
        }
        text.push_str(&row);
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Signals {
        let values = (0..10_000).map(|i| 1e-3 * f64::from(i)).collect();
        Signals { step_s: 1e-3, inputs: vec![], outputs: vec![("drive_force_n", values)] }
    }

    #[test]
    fn a_late_drifting_sensor_reads_what_it_should() {
        let of = |e, p, v| HiddenEffect::for_sensor(e, "drive_force_n", p, v);
        let hidden = [
            of("sensor-delay", "delay_s", 0.05),
            of("sensor-gain", "relative_change", 0.1),
            of("sensor-drift", "drift_per_s", 2.0),
            of("sensor-offset", "offset", 3.0),
        ];
        let read = readings(&ramp(), 100.0, &hidden);
        assert!((read[0][500] - (1.1 * 4.95 + 10.0 + 3.0)).abs() < 1e-9, "{}", read[0][500]);
        let other = [HiddenEffect::for_sensor("sensor-offset", "drive_torque_nm", "offset", 3.0)];
        assert!((readings(&ramp(), 100.0, &other)[0][500] - 5.0).abs() < 1e-9);
    }

    #[test]
    fn coloured_noise_has_the_same_deviation_and_its_correlation() {
        let flat = Signals { outputs: vec![("drive_force_n", vec![0.0; 400_000])], ..ramp() };
        let sensors = [Reading { channel: "drive_force_n", noise: 2.0, resolution: 0.0 }];
        let logger = Logger { rate_hz: 1000.0, colour: 0.6, lost: 0.0, start_s: 0.0 };
        let mut noise = Noise::new(5);
        let text = log(&flat, &sensors, &logger, &[], &mut noise);
        let values: Vec<f64> =
            text.lines().skip(1).map(|l| l.split_once(',').unwrap().1.parse().unwrap()).collect();
        assert_eq!(values.len(), 400_000);
        let power = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        let shifted = values.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / values.len() as f64;
        assert!((power.sqrt() - 2.0).abs() < 0.02, "{power}");
        assert!((shifted / power - 0.6).abs() < 0.01, "{}", shifted / power);
    }

    #[test]
    fn a_saturated_reading_stays_within_the_limit_noise_included() {
        let hidden = [HiddenEffect::for_sensor("sensor-saturation", "drive_force_n", "inverse_limit", 0.2)];
        let sensors = [Reading { channel: "drive_force_n", noise: 0.5, resolution: 0.01 }];
        let logger = Logger { rate_hz: 100.0, colour: 0.0, lost: 0.1, start_s: 0.0 };
        let text = log(&ramp(), &sensors, &logger, &hidden, &mut Noise::new(1));
        let values: Vec<f64> =
            text.lines().skip(1).map(|l| l.split_once(',').unwrap().1.parse().unwrap()).collect();
        assert!(values.len() < 950 && values.len() > 850);
        assert!(values.iter().all(|v| v.abs() <= 5.0 + 1e-9));
        assert!(values.iter().filter(|v| **v > 4.99).count() > 400);
    }
}
