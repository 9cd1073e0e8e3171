//! ADS8688.

use crate::script::{Broken, conversion, frame};
use controller::sensors::{Ads8688, InputRange, SensorFault};
use embedded_hal_mock::eh1::spi::Mock;

#[test]
fn it_is_reset_given_its_ranges_and_set_to_the_first_input() {
    let script: Vec<_> = [
        frame(&[0x85, 0, 0, 0], &[0, 0, 0, 0]),
        // Register 0x05 + 2, write, 0 to 5.12 V; the device returns the value.
        frame(&[0x0f, 0b110, 0], &[0, 0, 0b110]),
        frame(&[0x0b, 0b000, 0], &[0, 0, 0b000]),
        conversion(2, 0),
    ]
    .concat();
    let mut device = Ads8688::new(Mock::new(&script));
    let ranges = [(2, InputRange::Unipolar5V), (0, InputRange::Bipolar10V)];
    assert_eq!(device.configure(&ranges), Ok(()));
    device.release().done();
}

#[test]
fn a_frame_returns_the_input_selected_before_and_selects_the_next() {
    let script = [conversion(7, 0x1234), conversion(1, 0xffff)].concat();
    let mut device = Ads8688::new(Mock::new(&script));
    assert_eq!(device.select(7), Ok(0x1234));
    assert_eq!(device.select(1), Ok(0xffff));
    device.release().done();
}

#[test]
fn a_device_that_does_not_answer_is_detected() {
    let script = [
        frame(&[0xc0, 0, 0, 0], &[0xff; 4]),
        frame(&[0xc0, 0, 0, 0], &[0, 1, 0, 0]),
        frame(&[0x85, 0, 0, 0], &[0; 4]),
        frame(&[0x0b, 0b101, 0], &[0, 0, 0b001]),
    ]
    .concat();
    let mut device = Ads8688::new(Mock::new(&script));
    assert_eq!(device.select(0), Err(SensorFault::NoAnswer));
    assert_eq!(device.select(0), Err(SensorFault::NoAnswer), "bits shifted");
    assert_eq!(device.configure(&[(0, InputRange::Unipolar10V)]), Err(SensorFault::NotConfigured));
    device.release().done();
    assert_eq!(Ads8688::new(Broken).select(0), Err(SensorFault::Bus));
}
