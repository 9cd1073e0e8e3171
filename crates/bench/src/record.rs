//! Logs of simulated benches as their sensors would take them, from a seed.

use crate::channel::Channel;
use crate::description::{Bench, FrictionRig, TransmissionBench};
use crate::friction_rig;
use crate::integrate::IntegrationError;
use crate::log::MeasuredLog;
use crate::motion::Profile;
use crate::respond::{AXIS_FINENESS, Response, TRANSMISSION_FINENESS, outputs_of, reading, refined};
use crate::run::{DEFAULT_TOLERANCE, snapshots};
use crate::sensor::Sensor;
use crate::transmission::Snapshot;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Inputs and outputs of the transmission bench's log.
const TRANSMISSION_CHANNELS: &[Channel] = &[
    Channel::DriveDisplacement,
    Channel::DriveVelocity,
    Channel::LoadForce,
    Channel::ShaftAngle,
    Channel::ShaftSpeed,
    Channel::JournalY,
    Channel::JournalZ,
    Channel::BearingForceY,
    Channel::BearingForceZ,
    Channel::FrictionTorque,
    Channel::DriveForce,
];

/// Records the described run: effects applied, every sensor's electronics, noise and resolution from `seed`.
pub fn record(bench: &Bench, seed: u64) -> Result<MeasuredLog, IntegrationError> {
    let resolved = bench.resolved();
    let (time_s, channels, fineness) = match &resolved {
        Bench::Transmission(bench) => transmission(bench)?,
        Bench::FrictionRig(rig) => axis(rig),
    };
    Ok(sensed(&resolved, (&time_s, fineness), channels, seed))
}

/// The log that the sensors of a transmission bench take of a run: one row for so many of its samples, between which late sensors read.
pub fn log_of(bench: &Bench, (samples, for_each_row): (&[Snapshot], usize), seed: u64) -> MeasuredLog {
    let time_s: Vec<f64> = samples.iter().map(|s| s.time_s).collect();
    let channels = outputs_of(samples, TRANSMISSION_CHANNELS);
    sensed(&bench.resolved(), (&time_s, for_each_row.max(1)), channels, seed)
}

/// The log of true outputs at times that are finer than the samples.
fn sensed(
    resolved: &Bench,
    (fine_s, fineness): (&[f64], usize),
    mut channels: Response,
    seed: u64,
) -> MeasuredLog {
    let perfect = Sensor::default();
    for (index, (channel, values)) in channels.iter_mut().enumerate() {
        let sensor = resolved.sensors().get(channel).unwrap_or(&perfect);
        *values = reading(sensor, fine_s, values, fineness);
        // A stream of its own for each channel: leaving one out does not change the others.
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(index as u64 + 1);
        sensor.read(values, &mut rng);
    }
    let time_s = fine_s.iter().step_by(fineness).copied().collect();
    MeasuredLog { source: "recorded".into(), time_s, channels }
}

/// True outputs at refined times, and how fine these are.
type Refined = (Vec<f64>, Response, usize);

fn transmission(bench: &TransmissionBench) -> Result<Refined, IntegrationError> {
    let time_s = refined(&bench.sample_times_s(bench.logging.sample_rate_hz), TRANSMISSION_FINENESS);
    let inputs = (bench.drive_profile(), bench.load_profile());
    let samples = snapshots(bench, inputs, bench.duration_s(), &time_s, DEFAULT_TOLERANCE)?;
    let channels = outputs_of(&samples, TRANSMISSION_CHANNELS);
    Ok((time_s, channels, TRANSMISSION_FINENESS))
}

fn axis(rig: &FrictionRig) -> Refined {
    let drive = rig.axis.motion();
    let load = Profile::Ramp { level: rig.load.force_n, ramp_s: rig.load.ramp_s };
    let count = (rig.axis.duration_s() * rig.logging.sample_rate_hz).round() as usize;
    let samples: Vec<f64> = (0..count).map(|i| i as f64 / rig.logging.sample_rate_hz).collect();
    let time_s = refined(&samples, AXIS_FINENESS);
    let (position, speed, effort) = rig.channels();
    let at = |read: &dyn Fn(f64) -> f64| time_s.iter().map(|&t| read(t)).collect::<Vec<f64>>();
    let efforts = friction_rig::efforts(rig, &time_s, |t| drive.at(t), |t| load.at(t).value);
    let mut channels = Response::from([
        (position, at(&|t| drive.at(t).value)),
        (speed, at(&|t| drive.at(t).rate)),
        (Channel::LoadForce, at(&|t| load.at(t).value)),
        (effort, efforts.iter().map(|e| e.effort).collect()),
    ]);
    if rig.surface.is_some() {
        channels.insert(Channel::FrictionTorque, efforts.iter().map(|e| -e.friction).collect());
    }
    (time_s, channels, AXIS_FINENESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_of_a_run_is_the_recorded_one_and_a_late_sensor_needs_its_finer_samples() {
        let mut bench = Bench::open("bench-b").unwrap();
        let Bench::Transmission(plant) = &mut bench else { panic!("a transmission bench") };
        plant.sensors.entry(Channel::FrictionTorque).or_default().delay_s = 2e-4;
        let plant = plant.clone();
        let times = plant.sample_times_s(plant.logging.sample_rate_hz);
        let samples = |times: &[f64]| {
            let inputs = (plant.drive_profile(), plant.load_profile());
            snapshots(&plant, inputs, plant.duration_s(), times, DEFAULT_TOLERANCE).unwrap()
        };
        let fine = samples(&refined(&times, TRANSMISSION_FINENESS));
        let recorded = record(&bench, 3).unwrap();
        let log = log_of(&bench, (&fine, TRANSMISSION_FINENESS), 3);
        assert_eq!((&log.time_s, &log.channels), (&recorded.time_s, &recorded.channels));
        let coarse = log_of(&bench, (&samples(&times), 1), 3);
        let torque = |log: &MeasuredLog| log.channels[&Channel::FrictionTorque].clone();
        let off =
            torque(&log).iter().zip(&torque(&coarse)).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off > 4.0, "ten deviations of the noise: {off}");
    }
}
