//! The motion of an axis that is estimated from a log deviates from the true one by no more than
//! the log's noise.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::simulate::Inputs;
use bench::{Bench, MeasuredLog};
use std::fmt::Write as _;

const RATE_HZ: f64 = 200.0;

/// Angle, speed and acceleration of a stroke that starts at 1 s along `35 u^4 - 84 u^5 + 70 u^6 -
/// 20 u^7` and takes 1.6 s.
fn moved(time_s: f64) -> [f64; 3] {
    let (way, length) = (0.8, 1.6);
    let u = ((time_s - 1.0) / length).clamp(0.0, 1.0);
    [
        way * u.powi(4) * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u))),
        way / length * 140.0 * (u * (1.0 - u)).powi(3),
        way / (length * length) * 420.0 * (u * (1.0 - u)).powi(2) * (1.0 - 2.0 * u),
    ]
}

/// Evenly distributed numbers of unit variance.
fn spread() -> impl FnMut() -> f64 {
    let mut state: u64 = 7;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        12.0_f64.sqrt() * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
    }
}

/// Inputs from a log of the friction rig with these channels.
fn inputs(channels: &str, mut at: impl FnMut(f64) -> Vec<f64>) -> Inputs {
    let bench = Bench::open("friction-rig").unwrap();
    let mut text = format!("t_s,{channels},drive_torque_nm\n");
    for t in (0..(4.0 * RATE_HZ) as usize).map(|i| i as f64 / RATE_HZ) {
        let _ = write!(text, "{t:.5}");
        for value in at(t) {
            let _ = write!(text, ",{value:.9e}");
        }
        text.push_str(",0.0\n");
    }
    let log = MeasuredLog::parse("log.csv", &text, &bench.log_format()).unwrap();
    Inputs::new(&bench, &log).unwrap()
}

/// RMS errors of speed and acceleration, and the largest error of the speed while friction reverses
/// (below 30 mrad/s), from angle noise and, where measured, speed noise. The ends of the log, where
/// windows are incomplete, are left out.
fn errors(angle_noise: f64, speed_noise: Option<f64>) -> [f64; 3] {
    let mut noise = spread();
    let inputs = match speed_noise {
        None => inputs("spindle_angle_rad", |t| vec![moved(t)[0] + angle_noise * noise()]),
        Some(deviation) => inputs("spindle_angle_rad,spindle_speed_rad_s", |t| {
            vec![moved(t)[0] + angle_noise * noise(), moved(t)[1] + deviation * noise()]
        }),
    };
    let times = (0..(4.0 * RATE_HZ) as usize).map(|i| i as f64 / RATE_HZ);
    let inside: Vec<f64> = times.filter(|t| (0.1..3.9).contains(t)).collect();
    let (mut rate, mut acceleration, mut turning) = (0.0, 0.0, 0.0_f64);
    for &t in &inside {
        let ([_, speed, a], found) = (moved(t), inputs.drive(t));
        rate += (found.rate - speed).powi(2);
        acceleration += (found.acceleration - a).powi(2);
        if speed > 0.0 && speed < 0.03 {
            turning = turning.max((found.rate - speed).abs());
        }
    }
    let rms = |sum: f64| (sum / inside.len() as f64).sqrt();
    [rms(rate), rms(acceleration), turning]
}

#[test]
fn a_precise_speed_keeps_its_precision() {
    let [rate, acceleration, turning] = errors(2e-6, Some(5e-5));
    assert!(rate < 3e-5 && turning < 1e-4, "{rate} {turning}");
    // Neighbouring differences alone would leave 0.007 rad/s2.
    assert!(acceleration < 5e-3, "{acceleration}");
}

#[test]
fn a_speed_from_positions_is_better_than_their_difference() {
    let [rate, _, turning] = errors(2e-6, None);
    // Central differences: 2e-6 rad 200/s / root of 2 = 2.8e-4 rad/s.
    assert!(rate < 1e-4 && turning < 1e-3, "{rate} {turning}");
}

#[test]
fn a_noisy_speed_is_smoothed() {
    let [rate, _, _] = errors(2e-6, Some(5e-3));
    assert!(rate < 5e-4, "{rate}");
}

#[test]
fn an_axis_at_standstill_has_speed_0() {
    let mut noise = spread();
    let inputs = inputs("spindle_angle_rad", |t| vec![moved(t)[0] + 2e-6 * noise()]);
    for time_s in [0.0, 0.5, 3.5] {
        let found = inputs.drive(time_s);
        assert_eq!((found.rate, found.acceleration), (0.0, 0.0), "{time_s} s");
    }
}

#[test]
fn a_constant_speed_without_a_position_is_no_standstill() {
    let mut noise = spread();
    let speed = |t: f64| 0.5 + 5e-4 * (core::f64::consts::TAU * 0.5 * t).sin();
    let inputs = inputs("spindle_speed_rad_s", |t| vec![speed(t) + 1e-3 * noise()]);
    // High and low for half a second each.
    let mean =
        |from_s: f64| (0..100).map(|i| inputs.drive(from_s + 5e-3 * f64::from(i)).rate).sum::<f64>() / 100.0;
    assert!(mean(0.25) - mean(1.25) > 7e-4, "{} {}", mean(0.25), mean(1.25));
}
