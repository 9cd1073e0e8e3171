//! The simulated motion of an axis against closed forms, against the inverse model, and over the
//! range of the description.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::simulate::{Inputs, Response, record, respond};
use bench::{Bench, Channel, MeasuredLog};
use proptest::prelude::*;
use std::fmt::Write as _;

/// A linear axis of 2 kg with these entries of `[axis]` and of `[drive]`.
fn bench(axis: &[(&str, f64)], drive: &str) -> Result<Bench, String> {
    let mut numbers = vec![
        ("inertia", 2.0),
        ("friction_radius_m", 1.0),
        ("load_gain", 0.0),
        ("coulomb_effort", 0.0),
        ("viscous_effort", 0.0),
        ("load_coefficient", 0.0),
        ("regularisation_m_s", 1e-4),
        ("period_s", 2.0),
        ("amplitude", 0.1),
    ];
    for (name, value) in axis {
        numbers.retain(|(other, _)| other != name);
        numbers.push((name, *value));
    }
    let mut text = "plant = \"friction-rig\"\n[axis]\nkind = \"linear\"\n".to_owned();
    for (name, value) in numbers {
        let _ = writeln!(text, "{name} = {value:?}");
    }
    let rest = "\n[load]\nforce_n = 0.0\nramp_s = 0.05\n[logging]\nsample_rate_hz = 1000.0\n";
    Bench::parse("x", &format!("{text}[drive]\n{drive}\n{rest}")).map_err(|e| e.to_string())
}

fn open_loop(axis: &[(&str, f64)]) -> Bench {
    bench(axis, "simulates = \"motion\"").unwrap()
}

/// A log of so many seconds at 1 kHz with functions of time.
fn log(end_s: f64, channels: &[(Channel, &dyn Fn(f64) -> f64)]) -> MeasuredLog {
    let time_s: Vec<f64> = (0..=(end_s * 1e3).round() as usize).map(|i| i as f64 * 1e-3).collect();
    let values = |read: &dyn Fn(f64) -> f64| time_s.iter().map(|&t| read(t)).collect();
    let channels = channels.iter().map(|(channel, read)| (*channel, values(read))).collect();
    MeasuredLog { source: "log".into(), time_s, channels }
}

/// Response to an effort, from a position and a speed.
fn moved(bench: &Bench, end_s: f64, effort: &dyn Fn(f64) -> f64, start: [f64; 2]) -> Response {
    let [x, v] = start;
    let channels: [(Channel, &dyn Fn(f64) -> f64); 3] =
        [(Channel::Position, &|t| x + v * t), (Channel::Velocity, &|_| v), (Channel::DriveForce, effort)];
    respond(bench, &Inputs::new(bench, &log(end_s, &channels)).unwrap()).unwrap()
}

fn largest_error(values: &[f64], expected: impl Fn(f64) -> f64) -> f64 {
    values.iter().enumerate().map(|(i, v)| (v - expected(i as f64 * 1e-3)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_constant_force_on_a_viscous_axis_gives_an_exponential_approach() {
    let bench = open_loop(&[("viscous_effort", 5.0)]);
    let response = moved(&bench, 2.0, &|_| 3.0, [0.1, 0.2]);
    // m v' + c v = F: v = F/c + (v0 - F/c) exp(-c t/m).
    let (end, tau) = (0.6, 0.4);
    let speed = |t: f64| end + (0.2 - end) * (-t / tau).exp();
    let position = |t: f64| 0.1 + end * t + (0.2 - end) * tau * (1.0 - (-t / tau).exp());
    assert!(largest_error(&response[&Channel::Velocity], speed) < 1e-8);
    assert!(largest_error(&response[&Channel::Position], position) < 1e-8);
}

#[test]
fn coulomb_friction_stops_the_axis_in_finite_time_and_holds_it() {
    for width in [1e-3, 1e-5, 1e-9, 1e-12] {
        let bench = open_loop(&[("coulomb_effort", 4.0), ("regularisation_m_s", width)]);
        let response = moved(&bench, 1.0, &|_| 0.0, [0.0, 0.5]);
        // Deceleration of 2 m/s2: it stops after 0.25 s and 62.5 mm. The last width takes longer.
        let speed = |t: f64| (0.5 - 2.0 * t).max(0.0);
        let position = |t: f64| if t < 0.25 { 0.5 * t - t * t } else { 0.0625 };
        let (v, x) = (&response[&Channel::Velocity], &response[&Channel::Position]);
        let (speed_error, error) = (largest_error(v, speed), largest_error(x, position));
        // A step of 0.25 ms changes the speed by 0.5 mm/s.
        assert!(speed_error < 5e-4 + 2.0 * width, "{width}: {speed_error}");
        assert!(error < 1e-6 + width, "{width}: {error}");
        assert!(v[600..].iter().all(|v| v.abs() < 1e-9 * width), "{width}");
    }
}

#[test]
fn below_the_breakaway_level_the_axis_creeps_at_the_speed_of_its_regularised_sign() {
    let effort = |t: f64| 3.0 * (0.5 * t).min(1.0);
    for width in [1e-3, 1e-6, 1e-12] {
        let bench = open_loop(&[("coulomb_effort", 4.0), ("regularisation_m_s", width)]);
        let response = moved(&bench, 3.0, &effort, [0.0, 0.0]);
        let v = response[&Channel::Velocity].last().unwrap();
        // tanh(v/width) = 3/4.
        assert!((v / width / 0.75_f64.atanh() - 1.0).abs() < 1e-6, "{width}: {v}");
        let x = response[&Channel::Position].last().unwrap();
        assert!(*x < 3.0 * width, "{width}: {x}");
        // Above the level it breaks away.
        let bench = open_loop(&[("coulomb_effort", 2.0), ("regularisation_m_s", width)]);
        assert!(moved(&bench, 3.0, &effort, [0.0, 0.0])[&Channel::Velocity].last().unwrap() > &0.3);
    }
}

#[test]
fn a_mass_on_a_spring_keeps_its_period_and_nearly_its_amplitude() {
    let bench = open_loop(&[("spring_stiffness", 72.0), ("neutral_position", 0.3)]);
    let response = moved(&bench, 10.0, &|_| 0.0, [0.4, 0.0]);
    // 6 rad/s over 9.5 periods.
    let error = largest_error(&response[&Channel::Position], |t| 0.3 + 0.1 * (6.0 * t).cos());
    assert!(error < 1e-6, "{error}");
}

#[test]
fn a_voltage_acts_through_gain_and_time_constant() {
    let drive = "simulates = \"motion\"\ninput = \"voltage\"\ngain = 35.0\ntime_constant_s = 0.05";
    let bench = bench(&[("viscous_effort", 5.0)], drive).unwrap();
    let channels: [(Channel, &dyn Fn(f64) -> f64); 4] = [
        (Channel::Position, &|_| 0.0),
        (Channel::DriveVoltage, &|t| (20.0 * t).sin()),
        (Channel::DriveForce, &|_| 0.0),
        (Channel::LoadForce, &|_| 0.0),
    ];
    let response = respond(&bench, &Inputs::new(&bench, &log(3.0, &channels)).unwrap()).unwrap();
    // At 20 rad/s the lag of 50 ms is 45 degrees and 1/sqrt(2).
    let steady = |t: f64| {
        if t < 1.0 { 0.0 } else { 35.0 * 0.5_f64.sqrt() * (20.0 * t - 0.25 * std::f64::consts::PI).sin() }
    };
    let effort = &response[&Channel::DriveForce];
    let error = (1000..effort.len()).map(|i| (effort[i] - steady(i as f64 * 1e-3)).abs()).fold(0.0, f64::max);
    assert!(error < 1e-2, "{error}");
}

/// An effort of the inverse model along a smooth motion, given to the forward model, gives the
/// motion again.
fn round_trip(extra: &[(&str, f64)], effect: &str) -> f64 {
    let mut axis = vec![("coulomb_effort", 5.0), ("viscous_effort", 20.0), ("regularisation_m_s", 2e-3)];
    axis.extend(extra);
    let inverse = bench(&axis, "simulates = \"effort\"").unwrap();
    let with = |bench: Bench| Bench::parse("x", &format!("{}\n{effect}", bench.to_toml().unwrap())).unwrap();
    let motion = inverse.axis().unwrap().axis.motion();
    let mut log = record(&with(inverse.clone()), 1).unwrap();
    let forward = with(bench(&axis, "simulates = \"motion\"").unwrap());
    log.channels.insert(Channel::Velocity, log.time_s.iter().map(|t| motion.at(*t).rate).collect());
    let response = respond(&forward, &Inputs::new(&forward, &log).unwrap()).unwrap();
    let error = largest_error(&response[&Channel::Position], |t| motion.at(t).value);
    error / 0.2
}

#[test]
fn the_effort_of_a_given_motion_moves_the_axis_along_that_motion() {
    for (extra, effect, tolerance) in [
        (&[][..], "", 2e-4),
        (&[("spring_stiffness", 30.0), ("constant_effort", 3.0)], "", 2e-4),
        (&[], "[[effects]]\nname = \"stribeck-friction\"\neffort_rise = 2.0\nspeed_m_s = 0.02", 4e-4),
        (&[], "[[effects]]\nname = \"presliding-hysteresis\"\ndistance_m = 1e-4", 1e-3),
        // With the other sign the error would be some 6e-3.
        (&[], "[[effects]]\nname = \"drive-lag\"\nlag_s = 2e-3", 1e-3),
        (&[], "[[effects]]\nname = \"viscous-asymmetry\"\nasymmetry_effort = 5.0", 2e-4),
    ] {
        let error = round_trip(extra, effect);
        assert!(error < tolerance, "{extra:?} {effect}: {error} of the stroke");
    }
}

#[test]
fn a_loop_with_proportional_action_has_the_steady_error_of_its_gains() {
    // A ramp of the order with PD: kp e + kd (w' - v) = c v + Fc.
    let axis = [("viscous_effort", 20.0), ("coulomb_effort", 6.0), ("constant_effort", 3.0)];
    let ramp: [(Channel, &dyn Fn(f64) -> f64); 1] = [(Channel::OrderedPosition, &|t| 0.25 * t)];
    let still: [(Channel, &dyn Fn(f64) -> f64); 1] = [(Channel::OrderedPosition, &|_| 0.0)];
    let run = |drive: &str, order: &[(Channel, &dyn Fn(f64) -> f64)], axis: &[(&str, f64)]| {
        let bench = bench(axis, &format!("simulates = \"motion\"\ninput = \"order\"\n{drive}")).unwrap();
        let mut log = log(4.0, order);
        let order = log.channels[&Channel::OrderedPosition].clone();
        log.channels.insert(Channel::DriveForce, vec![0.0; order.len()]);
        log.channels.insert(Channel::Position, order.clone());
        let response = respond(&bench, &Inputs::new(&bench, &log).unwrap()).unwrap();
        let order = order.last().unwrap();
        (
            order - response[&Channel::Position].last().unwrap(),
            *response[&Channel::DriveForce].last().unwrap(),
        )
    };
    let (error, effort) = run("kp = 2000.0\nkd = 100.0\nspeed_feedforward = 100.0", &ramp, &axis);
    assert!((error / (14.0 / 2000.0) - 1.0).abs() < 1e-6, "{error}");
    assert!((effort - 14.0).abs() < 1e-6, "{effort}");
    // Without feedforward the derivative acts on the speed: kp e = (c + kd) v + Fc + F0.
    let (error, _) = run("kp = 2000.0\nkd = 100.0", &ramp, &axis);
    assert!((error / (39.0 / 2000.0) - 1.0).abs() < 1e-6, "{error}");
    // The integral removes it.
    let (error, _) = run("kp = 2000.0\nki = 20000.0\nkd = 100.0", &ramp, &axis);
    assert!(error.abs() < 1e-6, "{error}");
    // Cascade: speed_gain (kp e - v) = c v + Fc + F0, and with the integral of the speed error
    // kp e = v.
    let (error, _) = run("kp = 20.0\nspeed_gain = 100.0", &ramp, &axis);
    assert!((error / ((0.14 + 0.25) / 20.0) - 1.0).abs() < 1e-6, "{error}");
    let (error, _) = run("kp = 20.0\nspeed_gain = 100.0\nspeed_ki = 1000.0", &ramp, &axis);
    assert!((error / (0.25 / 20.0) - 1.0).abs() < 1e-4, "{error}");
    // At standstill with a constant effort: kp e = F0.
    let (error, _) = run("kp = 2000.0\nkd = 200.0", &still, &[("constant_effort", 3.0)]);
    assert!((error / 1.5e-3 - 1.0).abs() < 1e-6, "{error}");
    // A controller that is read every 2 ms is nearly the same.
    let (error, _) = run("kp = 2000.0\nkd = 100.0\nsample_period_s = 0.002", &ramp, &axis);
    assert!((error / (39.0 / 2000.0) - 1.0).abs() < 1e-3, "{error}");
}

#[test]
fn the_effort_stays_within_its_limit_and_the_integral_does_not_wind_up() {
    let drive =
        "simulates = \"motion\"\ninput = \"order\"\nkp = 800.0\nki = 4000.0\nkd = 60.0\neffort_limit = 10.0";
    let bench = bench(&[("viscous_effort", 5.0)], drive).unwrap();
    let channels: [(Channel, &dyn Fn(f64) -> f64); 3] = [
        (Channel::OrderedPosition, &|t| if t < 0.1 { 0.0 } else { 0.5 }),
        (Channel::Position, &|_| 0.0),
        (Channel::DriveForce, &|_| 0.0),
    ];
    let response = respond(&bench, &Inputs::new(&bench, &log(4.0, &channels)).unwrap()).unwrap();
    let effort = &response[&Channel::DriveForce];
    assert!(effort.iter().all(|f| f.abs() <= 10.0) && effort.contains(&10.0));
    let x = &response[&Channel::Position];
    let overshoot = x.iter().fold(0.0_f64, |max, x| max.max(x - 0.5));
    assert!(overshoot < 0.05, "{overshoot}");
    assert!((x.last().unwrap() - 0.5).abs() < 1e-3, "{:?}", x.last());
}

/// Response of a closed loop to an order, from a position and an effort at the start.
fn followed(bench: &Bench, log: &mut MeasuredLog, start: [f64; 2]) -> Response {
    let count = log.time_s.len();
    log.channels.insert(Channel::Position, vec![start[0]; count]);
    log.channels.insert(Channel::DriveForce, vec![start[1]; count]);
    log.channels.insert(Channel::DriveVoltage, vec![0.0; count]);
    respond(bench, &Inputs::new(bench, log).unwrap()).unwrap()
}

#[test]
fn a_sampled_controller_reports_the_voltage_that_it_applies() {
    for period_s in [0.0012, 0.002, 0.003] {
        let drive = format!(
            "simulates = \"motion\"\ninput = \"order\"\ngain = 5.0\nkp = 400.0\nkd = 20.0\n\
             sample_period_s = {period_s}"
        );
        let bench = bench(&[("viscous_effort", 20.0)], &drive).unwrap();
        let swing = |t: f64| 0.1 * (3.0 * t).sin();
        let response = followed(&bench, &mut log(1.0, &[(Channel::OrderedPosition, &swing)]), [0.0, 0.0]);
        let pairs = response[&Channel::DriveForce].iter().zip(&response[&Channel::DriveVoltage]);
        let largest = pairs.skip(1).map(|(effort, volts)| (effort - 5.0 * volts).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{period_s}: {largest}");
    }
}

#[test]
fn a_loop_beyond_its_limit_begins_with_the_measured_effort() {
    // The position error alone asks for 40 N, the limit is 10 N, and 3 N were measured.
    let drive =
        "simulates = \"motion\"\ninput = \"order\"\nkp = 400.0\nki = 50.0\nkd = 20.0\neffort_limit = 10.0";
    let bench = bench(&[("viscous_effort", 20.0)], drive).unwrap();
    let response = followed(&bench, &mut log(0.1, &[(Channel::OrderedPosition, &|_| 0.1)]), [0.0, 3.0]);
    let effort = response[&Channel::DriveForce][0];
    assert!((effort - 3.0).abs() < 1e-9, "{effort}");
}

#[test]
fn a_gap_at_standstill_does_not_change_what_a_sampled_loop_does_afterwards() {
    let drive = "simulates = \"motion\"\ninput = \"order\"\nkp = 400.0\nki = 2000.0\nkd = 20.0\n\
                 sample_period_s = 0.001";
    let bench = bench(&[("viscous_effort", 20.0)], drive).unwrap();
    let order = |t: f64| if t < 3.0 { 0.0 } else { 0.05 * (1.0 - (4.0 * (t - 3.0)).cos()) };
    let mut whole = log(4.0, &[(Channel::OrderedPosition, &order)]);
    let mut short = whole.clone();
    let kept: Vec<usize> = (0..whole.time_s.len()).filter(|i| !(500..2900).contains(i)).collect();
    short.time_s = kept.iter().map(|&i| whole.time_s[i]).collect();
    for values in short.channels.values_mut() {
        *values = kept.iter().map(|&i| values[i]).collect();
    }
    let [whole, short] =
        [&mut whole, &mut short].map(|log| followed(&bench, log, [0.0, 0.0])[&Channel::Position].clone());
    let ends = |values: &[f64]| values[values.len() - 1000..].to_vec();
    let largest = ends(&whole).iter().zip(ends(&short)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest < 1e-4, "{largest}");
}

#[test]
fn a_number_that_the_input_does_not_use_cannot_be_uncertain() {
    let refused = |drive: &str, name: &str| {
        let uncertain = format!("simulates = \"motion\"\n{drive}\n[uncertain]\n\"{name}\" = 0.1");
        bench(&[], &uncertain).is_err_and(|error| error.contains(name))
    };
    assert!(!refused("input = \"voltage\"", "drive.gain"));
    for (drive, name) in [
        ("", "drive.gain"),
        ("input = \"voltage\"", "drive.kp"),
        ("input = \"order\"\nkp = 3.0", "drive.speed_ki"),
        ("", "axis.play"),
        ("", "axis.gravity_cos"),
    ] {
        assert!(refused(drive, name), "{drive} {name}");
    }
}

#[test]
fn contradictory_entries_are_refused_together() {
    let error = bench(
        &[("inertia", 0.0)],
        "simulates = \"motion\"\ninput = \"voltage\"\nkp = 3.0\nsample_period_s = 0.001",
    )
    .unwrap_err();
    for part in [
        "axis.inertia is 0; expected 1e-12 to 1e9 kg or kg m2",
        "drive.kp is 3; expected no value without input = \"order\"",
        "drive.sample_period_s is 0.001; expected no value without input = \"order\"",
    ] {
        assert!(error.contains(part), "{error}");
    }
    let error = bench(&[], "simulates = \"effort\"\ninput = \"order\"\ngain = 2.0").unwrap_err();
    for part in
        ["drive.input is `order`; expected no input", "drive.gain is 2; expected no value with simulates"]
    {
        assert!(error.contains(part), "{error}");
    }
    let error =
        bench(&[], "simulates = \"motion\"\ninput = \"order\"\nspeed_ki = 2.0\neffort_amplitude = 3.0")
            .unwrap_err();
    for part in [
        "drive.kp is 0; expected kp or ki above 0",
        "drive.speed_ki is 2; expected no value without speed_gain",
        "drive.effort_amplitude is 3; expected no value with input = \"order\"",
    ] {
        assert!(error.contains(part), "{error}");
    }
    let error = bench(&[], "simulates = \"motions\"").unwrap_err();
    assert!(error.contains("drive.simulates is `motions`; expected one of effort, motion"), "{error}");
    let error = bench(&[], "simulates = \"motion\"\ngain = 2.0\n[nuisances.offset]\ndrive_force_n = 1.0")
        .unwrap_err();
    assert!(error.contains("drive.gain is 2; expected no value without input = \"voltage\" or"), "{error}");
    assert!(error.contains("nuisances.offset.drive_force_n is of an input"), "{error}");
    let described = bench(&[], "simulates = \"motion\"\n[nuisances.offset]\nposition_m = 1.0").unwrap();
    assert_eq!(Bench::parse("x", &described.to_toml().unwrap()).unwrap(), described);
}

#[test]
fn a_section_that_simulates_the_effort_changes_nothing() {
    let with = bench(&[("coulomb_effort", 3.0)], "simulates = \"effort\"").unwrap();
    let mut without = with.clone();
    without.axis_mut().unwrap().drive = None;
    assert_eq!(record(&with, 3).unwrap(), record(&without, 3).unwrap());
}

#[test]
fn a_record_has_the_channels_of_its_direction_and_is_the_same_again() {
    let names = |bench: &Bench| -> Vec<&str> {
        record(bench, 1).unwrap().channels.keys().map(|channel| channel.name()).collect()
    };
    let with = |drive: &str| {
        bench(&[("viscous_effort", 30.0)], &format!("simulates = \"motion\"\n{drive}")).unwrap()
    };
    let effort = with("effort_amplitude = 10.0");
    assert_eq!(names(&effort), ["position_m", "velocity_m_s", "load_force_n", "drive_force_n"]);
    let voltage = with("input = \"voltage\"\ngain = 5.0\neffort_amplitude = 10.0");
    assert_eq!(names(&voltage), ["position_m", "velocity_m_s", "drive_voltage_v", "load_force_n"]);
    let order = with("input = \"order\"\nkp = 1e3");
    assert_eq!(
        names(&order),
        ["position_m", "velocity_m_s", "ordered_position_m", "load_force_n", "drive_force_n"]
    );
    let log = record(&effort, 1).unwrap();
    let peak = log.channels[&Channel::DriveForce].iter().fold(0.0_f64, |max, f| max.max(*f));
    assert!((peak - 10.0).abs() < 1e-3, "{peak}");
    for bench in [effort, voltage, order] {
        assert_eq!(record(&bench, 1).unwrap(), record(&bench, 1).unwrap());
        // The record of a bench is what it answers to the inputs of the record.
        let log = record(&bench, 1).unwrap();
        let response = respond(&bench, &Inputs::new(&bench, &log).unwrap()).unwrap();
        for (channel, values) in response {
            let largest = log.channels[&channel].iter().fold(0.0_f64, |max, v| max.max(v.abs()));
            let off = log.channels[&channel]
                .iter()
                .zip(&values)
                .fold(0.0_f64, |max, (a, b)| max.max((a - b).abs()));
            assert!(off < 2e-3 * largest, "{channel}: {off} of {largest}");
        }
    }
}

#[test]
fn readings_do_not_depend_on_the_places_that_are_read() {
    let mut axis =
        bench(&[("coulomb_effort", 3.0)], "simulates = \"motion\"\ninput = \"order\"\nkp = 1e3\nkd = 50.0")
            .unwrap();
    let log = record(&axis, 1).unwrap();
    let inputs = Inputs::new(&axis, &log).unwrap();
    let prompt = respond(&axis, &inputs).unwrap();
    axis.sensors_mut().entry(Channel::Position).or_default().delay_s = 1e-9;
    let late = respond(&axis, &inputs).unwrap();
    assert_eq!(prompt[&Channel::Velocity], late[&Channel::Velocity]);
}

/// A number over orders of magnitude, or 0.
fn wide(min: f64, max: f64) -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 4 => (min.ln()..max.ln()).prop_map(f64::exp)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn no_description_gives_a_number_that_is_not_finite(
        inertia in (1e-12_f64.ln()..1e9_f64.ln()).prop_map(f64::exp),
        width in (1e-12_f64.ln()..1e3_f64.ln()).prop_map(f64::exp),
        radius in (1e-6_f64.ln()..1e3_f64.ln()).prop_map(f64::exp),
        friction in (wide(1e-6, 1e12), wide(1e-6, 1e12), wide(1e-3, 10.0)),
        springs in (wide(1e-6, 1e12), any::<bool>(), -1e12_f64..1e12),
        gains in (wide(1e-6, 1e12), wide(1e-6, 1e12), wide(1e-6, 1e12), wide(1e-6, 1e12), wide(1e-6, 1e12)),
        drive in (wide(1e-6, 10.0), wide(1e-6, 1e3), (1e-12_f64.ln()..1e12_f64.ln()).prop_map(f64::exp)),
        input in 0_usize..3,
        amplitude in wide(1e-3, 1e12),
        effect in 0_usize..6,
    ) {
        let (coulomb, viscous, load) = friction;
        let axis = [
            ("inertia", inertia), ("regularisation_m_s", width), ("friction_radius_m", radius),
            ("coulomb_effort", coulomb), ("viscous_effort", viscous), ("load_coefficient", load),
            ("spring_stiffness", if springs.1 { -springs.0 } else { springs.0 }),
            ("constant_effort", springs.2), ("period_s", 0.2),
        ];
        let text = match input {
            0 => format!("effort_amplitude = {amplitude:?}"),
            1 => format!(
                "input = \"voltage\"\ngain = {:?}\ntime_constant_s = {:?}\neffort_amplitude = {amplitude:?}",
                drive.2, drive.1
            ),
            _ => {
                let (kp, speed_ki) = (gains.0.max(1e-6), if gains.3 > 0.0 { gains.4 } else { 0.0 });
                format!(
                    "input = \"order\"\ngain = {:?}\ntime_constant_s = {:?}\nkp = {kp:?}\nki = {:?}\n\
                     kd = {:?}\nspeed_gain = {:?}\nspeed_ki = {speed_ki:?}\n\
                     effort_limit = {amplitude:?}\nsample_period_s = {:?}",
                    drive.2, drive.1, gains.1, gains.2, gains.3, drive.0,
                )
            }
        };
        let effects = [
            "", "name = \"presliding-hysteresis\"\ndistance_m = 1e-9",
            "name = \"breakaway\"\nexcess_effort = 50.0\nrest_time_s = 1e-3\ndistance_m = 1e-6",
            "name = \"stribeck-friction\"\neffort_rise = 500.0\nspeed_m_s = 1e-4",
            "name = \"thermal-friction-drift\"\nlevel_per_k = 0.1", "name = \"drive-lag\"\nlag_s = 0.01",
        ];
        let effect = if effect == 0 { String::new() } else { format!("[[effects]]\n{}", effects[effect]) };
        let described = bench(&axis, &format!("simulates = \"motion\"\n{text}")).unwrap();
        let described = Bench::parse("x", &format!("{}\n{effect}", described.to_toml().unwrap()));
        let described = described.map_err(|e| TestCaseError::fail(e.to_string()))?;
        let log = record(&described, 1).unwrap();
        for (channel, values) in &log.channels {
            prop_assert!(values.iter().all(|v| v.is_finite()), "{channel}");
        }
    }
}

#[test]
fn a_simulated_motion_refuses_play_and_an_elastic_coupling() {
    let servo = include_str!("../../../examples/servo-loop.toml");
    let text = servo.replace("cycles = 4", "cycles = 4\nplay = 1e-3\ncoupling_compliance = 1e-6");
    let refusal = Bench::parse("a.toml", &text).unwrap_err().to_string();
    for field in ["axis.play", "axis.coupling_compliance"] {
        assert!(refusal.contains(field), "{refusal}");
    }
}
