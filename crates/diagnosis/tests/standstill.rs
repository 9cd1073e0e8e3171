//! Clean logs of strokes with standstill and exact parameters: nothing may be found, whatever the
//! start of a stroke does to friction.
//!
//! The logs are computed here from the equation of motion of the axis alone. Strokes follow
//! `35 u^4 - 84 u^5 + 70 u^6 - 20 u^7`, dry friction reverses over 1 mm/s, and a second has 200
//! samples. An axis passes 1 mm/s in about ten samples, so smoothing the speed shifts the reversal
//! of friction by more than the noise.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::simulate::{Inputs, respond};
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Options, Verdict, diagnose};
use std::fmt::Write as _;

const SIGN_WIDTH_M_S: f64 = 1e-3;
const RADIUS_M: f64 = 0.07;
const CYCLE_S: f64 = 4.0;
const REST_S: f64 = 0.4;
const RATE_HZ: f64 = 200.0;

/// An axis that measures its torque; noise and resolution of the torque in N m.
fn bench(resolution: f64, inputs: &str) -> Bench {
    let text = format!(
        "plant = \"friction-rig\"\n\
        [axis]\nkind = \"rotary\"\ninertia = 10.0\nfriction_radius_m = {RADIUS_M}\nload_gain = 0.0\n\
        coulomb_effort = 140.0\nviscous_effort = 20.0\nload_coefficient = 0.0\n\
        regularisation_m_s = {SIGN_WIDTH_M_S}\nperiod_s = {CYCLE_S}\namplitude = 0.4\ndwell_s = {REST_S}\n\
        [load]\nforce_n = 0.0\nramp_s = 0.05\n[logging]\nsample_rate_hz = {RATE_HZ}\n\
        [sensors]\n{inputs}\ndrive_torque_nm = {{ noise = 1.0, resolution = {resolution} }}\n\
        [uncertain]\n\"axis.inertia\" = 0.2\n\"axis.coulomb_effort\" = 0.2\n\"axis.viscous_effort\" = 0.5\n"
    );
    Bench::parse("axis.toml", &text).unwrap()
}

/// Nearly normal numbers: sums of twelve uniform ones from a linear congruential generator.
struct Normal(u64);

impl Normal {
    fn next(&mut self) -> f64 {
        let uniform = |state: &mut u64| {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform(&mut self.0)).sum::<f64>() - 6.0
    }
}

/// Angle, speed and acceleration.
fn moved(time_s: f64) -> [f64; 3] {
    let half = 0.5 * CYCLE_S;
    let index = (time_s / half).floor();
    let way = if index.rem_euclid(2.0) < 0.5 { 0.8 } else { -0.8 };
    let length = half - REST_S;
    let u = ((time_s - index * half - REST_S) / length).max(0.0);
    [
        -0.5 * way + way * u.powi(4) * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u))),
        way / length * 140.0 * (u * (1.0 - u)).powi(3),
        way / (length * length) * 420.0 * (u * (1.0 - u)).powi(2) * (1.0 - 2.0 * u),
    ]
}

/// Noise of angle and speed.
#[derive(Clone, Copy)]
struct InputNoise {
    angle: f64,
    speed: f64,
}

const PRECISE: InputNoise = InputNoise { angle: 2e-6, speed: 5e-5 };

fn log(bench: &Bench, inputs: InputNoise, resolution: f64, seed: u64) -> MeasuredLog {
    let mut noise = Normal(seed);
    let round = |v: f64, step: f64| if step > 0.0 { (v / step).round() * step } else { v };
    let mut text = String::from("t_s,spindle_angle_rad,spindle_speed_rad_s,drive_torque_nm\n");
    for i in 0..(16.0 * RATE_HZ) as usize {
        let t = 0.3 + i as f64 / RATE_HZ;
        let [angle, speed, acceleration] = moved(t);
        let torque = 10.0 * acceleration
            + 140.0 * (speed * RADIUS_M / SIGN_WIDTH_M_S).tanh()
            + 20.0 * speed
            + noise.next();
        let _ = write!(text, "{t:.5},{:.9e}", angle + inputs.angle * noise.next());
        let _ = write!(text, ",{:.9e}", speed + inputs.speed * noise.next());
        let _ = writeln!(text, ",{:.9e}", round(torque, resolution));
    }
    MeasuredLog::parse("log.csv", &text, &bench.log_format()).unwrap()
}

/// Chi-square per sample of the simulation with exact parameters.
fn chi_square(bench: &Bench, log: &MeasuredLog, resolution: f64) -> f64 {
    let simulated = respond(bench, &Inputs::new(bench, log).unwrap()).unwrap();
    let (measured, simulated) = (&log.channels[&Channel::DriveTorque], &simulated[&Channel::DriveTorque]);
    let floor = 1.0 + resolution * resolution / 12.0;
    let sum: f64 = measured.iter().zip(simulated).map(|(m, s)| (m - s).powi(2) / floor).sum();
    sum / measured.len() as f64
}

fn assert_nothing_is_found(inputs: InputNoise, declared: &str, resolution: f64, max: f64) {
    let bench = bench(resolution, declared);
    for seed in 1..=4 {
        let log = log(&bench, inputs, resolution, seed);
        let chi = chi_square(&bench, &log, resolution);
        eprintln!("resolution {resolution}, seed {seed}: chi-square {chi:.3} a sample");
        assert!(chi < max, "seed {seed}: {chi}");
        let d = diagnose(&bench, &[log], &[], &Options::default()).unwrap();
        assert_eq!(d.verdict, Verdict::None, "seed {seed}: {:?} left {:?}", d.causes, d.signature);
    }
}

const DECLARED: &str = "spindle_angle_rad = { noise = 2e-6, resolution = 0.0 }\n\
    spindle_speed_rad_s = { noise = 5e-5, resolution = 0.0 }";

#[test]
fn nothing_is_found_in_a_clean_log_with_standstill() {
    assert_nothing_is_found(PRECISE, DECLARED, 0.0, 1.1);
}

#[test]
fn nothing_is_found_in_a_clean_log_with_a_resolution_of_half_its_noise() {
    assert_nothing_is_found(PRECISE, DECLARED, 0.5, 1.1);
}

#[test]
fn nothing_is_found_in_a_clean_log_without_declared_input_noise() {
    assert_nothing_is_found(PRECISE, "", 0.5, 1.1);
}

#[test]
fn the_nearest_candidate_is_reported_with_the_reason_for_its_rejection() {
    // Calibration absorbs 1.154 N m of an offset. The remainder of 1.25 N m is significant in
    // fitted samples, and not in held-out ones.
    let bench = bench(0.5, DECLARED);
    let answer = |offset: f64| {
        let mut log = log(&bench, PRECISE, 0.5, 1);
        log.channels.get_mut(&Channel::DriveTorque).unwrap().iter_mut().for_each(|t| *t += offset);
        diagnose(&bench, &[log], &[], &Options::default()).unwrap()
    };
    let (far, near) = (answer(-1.6), answer(-1.25));
    assert!(far.verdict == Verdict::Named && far.rejection.is_none(), "{:?}", far.rejection);
    let rejection = near.rejection.unwrap();
    assert_eq!((near.verdict, rejection.reason.as_str()), (Verdict::Unknown, "held-out-uncertain"));
    let causes: Vec<_> = rejection.causes.iter().map(|c| (c.effect.as_str(), c.channel)).collect();
    assert_eq!(causes, [("sensor-offset", Some(Channel::DriveTorque))]);
}
