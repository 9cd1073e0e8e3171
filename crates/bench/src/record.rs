//! Logs of simulated benches as their sensors would take them, from a seed.

use crate::channel::Channel;
use crate::description::{Bench, FrictionRig, TransmissionBench};
use crate::friction_rig;
use crate::integrate::IntegrationError;
use crate::log::MeasuredLog;
use crate::motion::Profile;
use crate::respond::{Response, outputs_of};
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
    let (time_s, channels) = match &resolved {
        Bench::Transmission(bench) => transmission(bench)?,
        Bench::FrictionRig(rig) => axis(rig),
    };
    Ok(sensed(&resolved, time_s, channels, seed))
}

/// The log that the sensors of a transmission bench take of a run sampled at the logging rate.
pub fn log_of(bench: &Bench, samples: &[Snapshot], seed: u64) -> MeasuredLog {
    let time_s = samples.iter().map(|s| s.time_s).collect();
    sensed(&bench.resolved(), time_s, outputs_of(samples, TRANSMISSION_CHANNELS), seed)
}

fn sensed(resolved: &Bench, time_s: Vec<f64>, mut channels: Response, seed: u64) -> MeasuredLog {
    let perfect = Sensor::default();
    for (index, (channel, values)) in channels.iter_mut().enumerate() {
        let sensor = resolved.sensors().get(channel).unwrap_or(&perfect);
        *values = sensor.respond(&time_s, values);
        // A stream of its own for each channel: leaving one out does not change the others.
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(index as u64 + 1);
        sensor.read(values, &mut rng);
    }
    MeasuredLog { source: "recorded".into(), time_s, channels }
}

fn transmission(bench: &TransmissionBench) -> Result<(Vec<f64>, Response), IntegrationError> {
    let time_s = bench.sample_times_s(bench.logging.sample_rate_hz);
    let inputs = (bench.drive_profile(), bench.load_profile());
    let samples = snapshots(bench, inputs, bench.duration_s(), &time_s, DEFAULT_TOLERANCE)?;
    let channels = outputs_of(&samples, TRANSMISSION_CHANNELS);
    Ok((time_s, channels))
}

fn axis(rig: &FrictionRig) -> (Vec<f64>, Response) {
    let drive = rig.axis.motion();
    let load = Profile::Ramp { level: rig.load.force_n, ramp_s: rig.load.ramp_s };
    let count = (rig.axis.duration_s() * rig.logging.sample_rate_hz).round() as usize;
    let time_s: Vec<f64> = (0..count).map(|i| i as f64 / rig.logging.sample_rate_hz).collect();
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
    (time_s, channels)
}
