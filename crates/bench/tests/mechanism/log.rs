//! Logs of mechanisms.

use super::{assert_near, text};
use bench::Bench;

#[test]
fn a_mechanism_has_no_log_and_no_effects() {
    let bench = Bench::open("four-bar").unwrap();
    let error = bench::simulate::record(&bench, 1).unwrap_err().to_string();
    assert!(error.starts_with("found plant `mechanism`, which has no log"), "{error}");
    let text = format!(
        "{}\n[[effects]]\nname = \"viscous-friction\"\nviscous_n_s_m = 1.0\n",
        text("../../examples/four-bar.toml")
    );
    let error = Bench::parse("x.toml", &text).unwrap_err().to_string();
    assert!(error.contains("which has no log"), "{error}");
}

/// Bench B as a mechanism with the channels of a dedicated log. The angle has the other sign, and
/// with it the friction torque.
fn measured_bench_b() -> String {
    let names =
        ["journal_y_m", "journal_z_m", "bearing_force_y_n", "bearing_force_z_n", "friction_torque_nm"];
    let of_joint = names.map(|name| format!("[[measured]]\nchannel = \"{name}\"\nof = \"ground_shaft\"\n"));
    text("../../examples/bench-b-mechanism.toml")
        .replace("duration_s = 1.0", "duration_s = 0.4, samples = 400")
        + &of_joint.concat()
        + "[[measured]]\nchannel = \"shaft_angle_rad\"\nof = \"shaft\"\n\
           [[measured]]\nchannel = \"shaft_speed_rad_s\"\nof = \"shaft\"\n\
           [[measured]]\nchannel = \"position_m\"\nof = \"ground_fork\"\n\
           [[measured]]\nchannel = \"velocity_m_s\"\nof = \"ground_fork\"\n\
           [[measured]]\nchannel = \"drive_force_n\"\nof = \"ground_fork\"\n"
}

#[test]
fn a_recorded_mechanism_reads_what_the_dedicated_plant_reads() {
    let mut dedicated = Bench::open("bench-b").unwrap();
    dedicated.sensors_mut().clear();
    dedicated.transmission_mut().unwrap().logging.sample_rate_hz = 1000.0;
    let known = bench::simulate::record(&dedicated, 1).unwrap();
    let found = bench::simulate::record(&Bench::parse("x.toml", &measured_bench_b()).unwrap(), 1).unwrap();
    assert_eq!((found.time_s.len(), found.channels.len()), (400, 10));
    let cases = [
        ("journal_y_m", "journal_y_m", 1.0, 1e-8),
        ("journal_z_m", "journal_z_m", 1.0, 1e-8),
        ("bearing_force_y_n", "bearing_force_y_n", 1.0, 1.0),
        ("bearing_force_z_n", "bearing_force_z_n", 1.0, 1.0),
        ("friction_torque_nm", "friction_torque_nm", -1.0, 0.05),
        ("shaft_angle_rad", "shaft_angle_rad", -1.0, 1e-7),
        ("shaft_speed_rad_s", "shaft_speed_rad_s", -1.0, 1e-5),
        ("position_m", "drive_displacement_m", 1.0, 1e-12),
        ("velocity_m_s", "drive_velocity_m_s", 1.0, 1e-12),
    ];
    for (name, of_plant, sign, tolerance) in cases {
        let channel = |name: &str| bench::signals::Channel::from_name(name).unwrap();
        let (own, other) = (&found.channels[&channel(name)], &known.channels[&channel(of_plant)]);
        let largest = other.iter().take(400).fold(0.0_f64, |max, value| max.max(value.abs()));
        assert!(largest > 100.0 * tolerance, "{name} {largest}");
        for (time_s, (own, other)) in found.time_s.iter().zip(own.iter().zip(other)) {
            assert_near(&format!("{name} at {time_s}"), sign * own, *other, tolerance);
        }
    }
}

#[test]
fn the_sensors_of_a_mechanism_add_noise_from_the_seed_and_are_simulated_without_it() {
    let text = measured_bench_b() + "[sensors.journal_y_m]\nnoise = 1e-6\noffset = 2e-6\n";
    let bench = Bench::parse("x.toml", &text).unwrap();
    let [first, again, other] = [1, 1, 2].map(|seed| bench::simulate::record(&bench, seed).unwrap());
    assert_eq!(first, again);
    let journal = |log: &bench::log::MeasuredLog| log.channels[&bench::signals::Channel::JournalY].clone();
    assert_ne!(journal(&first), journal(&other));
    assert_eq!(
        first.channels[&bench::signals::Channel::JournalZ],
        other.channels[&bench::signals::Channel::JournalZ]
    );
    let inputs = bench::simulate::Inputs::new(&bench, &first).unwrap();
    let simulated = bench::simulate::respond(&bench, &inputs).unwrap();
    // The drive's motion is an input, and the mechanism follows its description.
    assert_eq!(simulated.len(), 8);
    let read = &simulated[&bench::signals::Channel::JournalY];
    let errors: Vec<f64> = journal(&first).iter().zip(read).map(|(a, b)| a - b).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((0.85e-6..1.15e-6).contains(&rms), "{rms}");
    let mut early = first;
    early.time_s[0] = -1e-3;
    let error = bench::simulate::Inputs::new(&bench, &early).unwrap_err().to_string();
    assert!(error.contains("t_s from -0.001; expected t_s from 0"), "{error}");
}

#[test]
fn wrong_channels_of_a_mechanism_are_refused() {
    let refused = |from: &str, to: &str| {
        let text = measured_bench_b();
        assert!(text.contains(from), "{from}");
        Bench::parse("x.toml", &text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let error = refused("of = \"shaft\"", "of = \"rudder\"");
    assert!(error.contains("measured.5.of is `rudder`; expected one of fork, shaft"), "{error}");
    let error = refused("\"ground_shaft\"", "\"fork\"");
    assert!(error.contains("measured.0.of is `fork`; expected one of ground_shaft"), "{error}");
    let error = refused("\"journal_y_m\"", "\"journal_z_m\"");
    assert!(
        error.contains("measured.1.channel is `journal_z_m`; expected a channel that no other"),
        "{error}"
    );
    let error = refused("\"journal_y_m\"", "\"load_force_n\"");
    assert!(error.contains("measured.0.channel is `load_force_n`; expected a channel of which"), "{error}");
    let error = refused("\"position_m\"", "\"drive_torque_nm\"");
    assert!(
        error.contains("measured.7.channel is `drive_torque_nm`; expected a channel of which"),
        "{error}"
    );
    let text = measured_bench_b() + "[sensors.bearing_temperature_c]\nnoise = 1.0\n";
    let error = Bench::parse("x.toml", &text).unwrap_err().to_string();
    assert!(error.contains("expected a channel of `[[measured]]`"), "{error}");
}
