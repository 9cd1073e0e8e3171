//! AS5047P.

use crate::script::{ASK_ANGLE, ASK_DIAGNOSTICS, ASK_ERRORS, Broken, encoder};
use controller::sensors::{Absolute, AngleSensor, As5047p, SensorFault};
use embedded_hal_mock::eh1::spi::Mock;

/// An answer with its parity bit.
fn answer(data: u16) -> u16 {
    data | (data.count_ones() as u16 & 1) << 15
}

#[test]
fn the_first_reply_has_no_angle_and_the_later_ones_have_one() {
    let script = [
        encoder(ASK_ANGLE, answer(0)),
        encoder(ASK_ANGLE, answer(0x1234)),
        encoder(ASK_ANGLE, answer(0x3ffe)),
    ]
    .concat();
    let mut device = As5047p::new(Mock::new(&script));
    assert!(device.read().is_err());
    assert_eq!(device.read(), Ok(0x1234));
    assert_eq!(device.read(), Ok(0x3ffe));
    device.release().done();
}

#[test]
fn every_single_wrong_bit_is_a_parity_error_or_an_error_flag() {
    for bit in 0..16 {
        let wrong = answer(0x0fa5) ^ 1 << bit;
        let script = [encoder(ASK_ANGLE, answer(0)), encoder(ASK_ANGLE, wrong)].concat();
        let mut device = As5047p::new(Mock::new(&script));
        assert!(device.read().is_err());
        assert_eq!(device.read(), Err(SensorFault::Parity), "bit {bit}");
        device.release().done();
    }
}

#[test]
fn an_error_flag_is_reported_once_and_cleared() {
    let script = [
        encoder(ASK_ANGLE, answer(0)),
        encoder(ASK_ANGLE, answer(0x4000 | 77)),
        encoder(ASK_ERRORS, answer(78)),
        encoder(ASK_ANGLE, answer(0x0001)),
        encoder(ASK_ANGLE, answer(80)),
    ]
    .concat();
    let mut device = As5047p::new(Mock::new(&script));
    assert!(device.read().is_err());
    assert_eq!(device.read(), Err(SensorFault::ErrorFlag));
    assert_eq!(device.read(), Ok(78), "asked for before the flag was seen");
    assert_eq!(device.read(), Err(SensorFault::ErrorFlag), "the error register is no angle");
    assert_eq!(device.read(), Ok(80));
    device.release().done();
}

#[test]
fn an_open_line_gives_no_angle() {
    let mut device = As5047p::new(Mock::new(&encoder(ASK_ANGLE, 0xffff)));
    assert_eq!(device.read(), Err(SensorFault::NoAnswer));
    device.release().done();
    assert_eq!(As5047p::new(Broken).read(), Err(SensorFault::Bus));
}

#[test]
fn a_line_that_only_reads_zeros_never_gives_an_angle() {
    let mut script = [encoder(ASK_ANGLE, 0), encoder(ASK_ANGLE, 0)].concat();
    script.extend((0..50).flat_map(|_| encoder(ASK_DIAGNOSTICS, 0)));
    let mut device = As5047p::new(Mock::new(&script));
    assert!((0..52).all(|_| device.read().is_err()));
    device.release().done();
}

#[test]
fn a_shaft_at_zero_has_an_angle_once_the_device_has_replied() {
    let script = [
        encoder(ASK_ANGLE, 0),
        encoder(ASK_ANGLE, 0),
        encoder(ASK_DIAGNOSTICS, 0),
        encoder(ASK_DIAGNOSTICS, answer(0x0180)),
        encoder(ASK_ANGLE, answer(0x0180)),
        encoder(ASK_ANGLE, 0),
    ]
    .concat();
    let mut device = As5047p::new(Mock::new(&script));
    for _ in 0..5 {
        assert!(device.read().is_err(), "diagnostics are no angle");
    }
    assert_eq!(device.read(), Ok(0));
    device.release().done();
}

#[test]
fn the_angle_counts_on_over_the_encoder_s_zero() {
    let steps = [16_380, 16_383, 2, 16_382, 5];
    let script: Vec<_> = core::iter::once(encoder(ASK_ANGLE, answer(0)))
        .chain(steps.iter().map(|step| encoder(ASK_ANGLE, answer(*step))))
        .collect::<Vec<_>>()
        .concat();
    let mut device = Absolute::new(As5047p::new(Mock::new(&script)));
    assert!(device.angle_nrad().is_err());
    let angles: Vec<i64> = steps.iter().map(|_| i64::from(device.angle_nrad().unwrap())).collect();
    let step_nrad = core::f64::consts::TAU * 1e9 / 16_384.0;
    for (angle, steps) in angles.iter().zip([0.0, 3.0, 6.0, 2.0, 9.0]) {
        let moved = (angle - angles[0]) as f64;
        assert!((moved - steps * step_nrad).abs() < 2.0, "{moved} for {steps} steps");
    }
    device.release().done();
}
