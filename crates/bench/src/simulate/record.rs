//! Logs of simulated benches as their sensors would record them, from a seed.

use super::respond::{Truth, read_samples};
use super::transmission_log::all_outputs_from;
use crate::description::Bench;
use crate::integrate::IntegrationError;
use crate::log::MeasuredLog;
use crate::plants::transmission::Snapshot;
use crate::signals::Sensor;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Records the described run with its effects and with every sensor's electronics, noise and
/// resolution from `seed`.
pub fn record(bench: &Bench, seed: u64) -> Result<MeasuredLog, IntegrationError> {
    let resolved = bench.resolved();
    let plant = resolved.logged().ok_or(IntegrationError::NoLog { plant: resolved.plant_name() })?;
    let (fine_s, truth) = plant.run()?;
    Ok(record_sensors(&resolved, &fine_s, truth, seed))
}

/// Returns the log that the sensors of a transmission bench record of a run. One row is written per
/// `samples_per_row` samples; delayed sensors read between the rows.
pub fn log_from_samples(
    bench: &Bench,
    (samples, samples_per_row): (&[Snapshot], usize),
    seed: u64,
) -> MeasuredLog {
    let time_s: Vec<f64> = samples.iter().map(|s| s.time_s).collect();
    let truth = Truth { outputs: all_outputs_from(samples), fineness: samples_per_row.max(1) };
    record_sensors(&bench.resolved(), &time_s, truth, seed)
}

/// Returns the log that the sensors record of a truth at refined times.
fn record_sensors(resolved: &Bench, fine_s: &[f64], truth: Truth, seed: u64) -> MeasuredLog {
    let perfect = Sensor::default();
    let Truth { outputs: mut channels, fineness } = truth;
    for (index, (channel, values)) in channels.iter_mut().enumerate() {
        let sensor = resolved.sensors().get(channel).unwrap_or(&perfect);
        *values = read_samples(sensor, fine_s, values, fineness);
        // Each channel has its own random stream: leaving one out does not change the others.
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(index as u64 + 1);
        sensor.read(values, &mut rng);
    }
    let time_s = fine_s.iter().step_by(fineness).copied().collect();
    MeasuredLog { source: "recorded".into(), time_s, channels }
}

#[cfg(test)]
mod tests {
    use super::super::respond::refined;
    use super::super::transmission_log::FINENESS;
    use super::*;
    use crate::signals::Channel;
    use crate::simulate::{DEFAULT_TOLERANCE, snapshots};

    #[test]
    fn the_log_of_a_run_is_the_recorded_one_and_a_delayed_sensor_needs_finer_samples() {
        let mut bench = Bench::open("bench-b").unwrap();
        bench.sensors_mut().entry(Channel::FrictionTorque).or_default().delay_s = 2e-4;
        let plant = bench.transmission().unwrap().clone();
        let times = plant.sample_times_s(plant.logging.sample_rate_hz);
        let samples = |times: &[f64]| {
            let inputs = (plant.drive_profile(), plant.load_profile());
            snapshots(&plant, inputs, plant.duration_s(), times, DEFAULT_TOLERANCE).unwrap()
        };
        let fine = samples(&refined(&times, FINENESS));
        let recorded = record(&bench, 3).unwrap();
        let log = log_from_samples(&bench, (&fine, FINENESS), 3);
        assert_eq!((&log.time_s, &log.channels), (&recorded.time_s, &recorded.channels));
        let coarse = log_from_samples(&bench, (&samples(&times), 1), 3);
        let torque = |log: &MeasuredLog| log.channels[&Channel::FrictionTorque].clone();
        let off =
            torque(&log).iter().zip(&torque(&coarse)).fold(0.0_f64, |max, (a, b)| max.max((a - b).abs()));
        assert!(off > 4.0, "ten deviations of the noise: {off}");
    }
}
