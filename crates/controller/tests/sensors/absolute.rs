//! AS5047P.

use crate::script::{COMPENSATED, answer, encoder};
use controller::sensors::{Absolute, AngleSensor, EncoderAnswers, SensorFault};

const STEP_NRAD: f64 = core::f64::consts::TAU * 1e9 / 16_384.0;

fn read(sensor: &mut Absolute, [angle, diagnostics]: [u16; 2]) -> Result<i32, SensorFault> {
    sensor.angle_nrad(Some(&EncoderAnswers { angle, diagnostics }))
}

#[test]
fn the_first_sample_has_an_angle() {
    let mut sensor = Absolute::default();
    let angle = read(&mut sensor, encoder(0x1234)).unwrap();
    assert!((f64::from(angle) - f64::from(0x1234) * STEP_NRAD).abs() < 2.0, "{angle}");
    assert_eq!(read(&mut Absolute::default(), encoder(0)), Ok(0), "zero is an angle, too");
}

#[test]
fn every_single_wrong_bit_is_a_parity_error() {
    for bit in 0..16 {
        let [angle, diagnostics] = encoder(0x0fa5);
        for answers in [[angle ^ 1 << bit, diagnostics], [angle, diagnostics ^ 1 << bit]] {
            let found = read(&mut Absolute::default(), answers);
            assert_eq!(found, Err(SensorFault::Parity), "bit {bit}");
        }
    }
}

#[test]
fn a_flagged_frame_costs_one_angle() {
    let mut sensor = Absolute::default();
    assert!(read(&mut sensor, encoder(77)).is_ok());
    assert_eq!(read(&mut sensor, encoder(0x4000 | 78)), Err(SensorFault::ErrorFlag));
    assert!(read(&mut sensor, encoder(79)).is_ok(), "the error register has been read in between");
    let overflow = [answer(80), answer(COMPENSATED | 1 << 9)];
    assert_eq!(read(&mut sensor, overflow), Err(SensorFault::ErrorFlag));
}

#[test]
fn a_line_that_is_stuck_never_gives_an_angle() {
    let mut sensor = Absolute::default();
    assert!(read(&mut sensor, encoder(5)).is_ok());
    for level in [[0; 2], [u16::MAX; 2]] {
        assert_eq!(read(&mut sensor, level), Err(SensorFault::NoAnswer), "{level:?}");
    }
    assert_eq!(sensor.angle_nrad(None), Err(SensorFault::Bus));
}

#[test]
fn the_angle_counts_on_over_the_encoder_s_zero() {
    let steps = [16_380, 16_383, 2, 16_382, 5];
    let mut sensor = Absolute::default();
    let angles: Vec<i64> =
        steps.iter().map(|step| i64::from(read(&mut sensor, encoder(*step)).unwrap())).collect();
    for (angle, steps) in angles.iter().zip([0.0, 3.0, 6.0, 2.0, 9.0]) {
        let moved = (angle - angles[0]) as f64;
        assert!((moved - steps * STEP_NRAD).abs() < 2.0, "{moved} for {steps} steps");
    }
}
