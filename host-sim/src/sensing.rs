//! The controller's sensors: what a run looks like from beside the bench, one frame a sample period.

use bench::sensor::Sensor;
use bench::transmission::Snapshot;
use bench::{Bench, Channel};
use link::SensorFrame;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Turns a run, sampled at the controller's rate, into sensor frames. Noise, delay and the rest are those of the
/// bench description's sensors, applied at the controller's sample rate; a load transmitter without a description is
/// perfect.
pub fn frames(bench: &Bench, samples: &[Snapshot], seed: u64) -> Vec<SensorFrame> {
    let time_s: Vec<f64> = samples.iter().map(|s| s.time_s).collect();
    let perfect = Sensor::default();
    let read = |channel: Channel, stream: u64, truth: fn(&Snapshot) -> f64| {
        let sensor = bench.sensors().get(&channel).unwrap_or(&perfect);
        let truth: Vec<f64> = samples.iter().map(truth).collect();
        let mut signal = sensor.respond(&time_s, &truth);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        sensor.read(&mut signal, &mut rng);
        signal
    };
    let y = read(Channel::JournalY, 1, |s| s.y_m);
    let z = read(Channel::JournalZ, 2, |s| s.z_m);
    let angle = read(Channel::ShaftAngle, 3, |s| s.angle_rad);
    let load = read(Channel::LoadForce, 4, |s| s.load_force_n);
    // `as` saturates: a reading beyond the range stands at its end.
    let counts = |value: f64, unit: f64| (value / unit).round() as i32;
    time_s
        .iter()
        .zip(y.iter().zip(&z).zip(angle.iter().zip(&load)))
        .enumerate()
        .map(|(index, (t, ((y, z), (angle, load))))| SensorFrame {
            sequence: index as u32,
            time_us: (t * 1e6).round() as u32,
            journal_y_nm: counts(*y, 1e-9),
            journal_z_nm: counts(*z, 1e-9),
            shaft_angle_nrad: counts(*angle, 1e-9),
            load_force_mn: counts(*load, 1e-3),
        })
        .collect()
}
