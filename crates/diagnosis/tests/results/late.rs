//! Causes that the first half of a log does not determine: a late limit, a temperature that still
//! rises, the age of a contact at the start.

use crate::{axis, diagnosed, logged, with};
use bench::effects::Effect;
use bench::{Channel, MeasuredLog};
use diagnosis::{Diagnosis, Verdict};

fn assert_named(d: &Diagnosis, name: &str) {
    let causes: Vec<&str> = d.causes.iter().map(|c| c.effect.as_str()).collect();
    assert_eq!((d.verdict, causes), (Verdict::Named, vec![name]), "{:?}\n{:?}", d.ranking, d.signature);
}

fn found(d: &Diagnosis, name: &str) -> f64 {
    d.causes[0].parameters.iter().find(|p| p.name == name).unwrap().value
}

fn shaped(name: &str, parameters: &[(&str, f64)]) -> Effect {
    let parameters = parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Effect { name: name.into(), channel: None, of: None, parameters }
}

#[test]
fn a_temperature_that_still_rises_at_the_end_of_the_first_half_is_named() {
    let drift = [("level_per_k", -0.04), ("resistance_k_w", 0.1), ("time_constant_s", 9.0)];
    let mut bench = axis(6);
    *bench.parameter_mut("axis.coulomb_effort").unwrap() = 120.0;
    let log = logged(&with(&bench, shaped("thermal-friction-drift", &drift)), 3);
    let d = diagnosed(&bench, &[log], &[]);
    assert_named(&d, "thermal-friction-drift");
    assert!((6.0..13.0).contains(&found(&d, "time_constant_s")), "{:?}", d.causes);
    // Only their product is known.
    let product = found(&d, "level_per_k") * found(&d, "resistance_k_w");
    assert!((product / -0.004 - 1.0).abs() < 0.25, "{:?}", d.causes);
}

#[test]
fn a_sensor_limit_reached_in_the_second_half_only_is_named() {
    // From the fourth of six cycles on the load is larger, and the reading is clipped.
    let bench = axis(6);
    let larger = |log: &mut MeasuredLog, by: f64, limit: f64| {
        let late: Vec<bool> = log.time_s.iter().map(|t| *t > 6.5).collect();
        for channel in [Channel::LoadForce, Channel::DriveForce] {
            let values = log.channels.get_mut(&channel).unwrap();
            values.iter_mut().zip(&late).filter(|(_, late)| **late).for_each(|(v, _)| *v += by);
        }
        let force = log.channels.get_mut(&Channel::DriveForce).unwrap();
        force.iter_mut().for_each(|v| *v = v.clamp(-limit, limit));
    };
    let mut log = logged(&bench, 4);
    larger(&mut log, 60.0, 615.0);
    let d = diagnosed(&bench, &[log], &[]);
    assert_named(&d, "sensor-saturation");
    assert!((1.0 / found(&d, "inverse_limit") - 615.0).abs() < 0.5, "{:?}", d.causes);
}

#[test]
fn static_friction_of_an_axis_without_standstill_is_not_called_a_fall_with_speed() {
    let excess = [("excess_effort", 20.0), ("rest_time_s", 0.15), ("distance_m", 2e-3)];
    let mut log = logged(&with(&axis(6), shaped("breakaway", &excess)), 6);
    // The log begins in the middle of the motion.
    let begin = log.time_s.partition_point(|t| *t < 0.45);
    log.time_s.drain(..begin);
    log.channels.values_mut().for_each(|values| drop(values.drain(..begin)));
    let d = diagnosed(&axis(6), &[log], &[]);
    assert_named(&d, "breakaway");
    assert!((found(&d, "distance_m") / 2e-3 - 1.0).abs() < 0.3, "{:?}", d.causes);
}
