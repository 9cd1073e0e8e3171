//! ADS8688: its configuration.

use crate::script::{Broken, frame, selection};
use controller::sensors::{Ads8688, InputRange, SensorFault};
use embedded_hal_mock::eh1::spi::Mock;

#[test]
fn it_is_reset_given_its_ranges_and_set_to_the_first_input() {
    let script: Vec<_> = [
        frame(&[0x85, 0, 0, 0], &[0, 0, 0, 0]),
        // Register 0x05 + 2, write, 0 to 5.12 V; the device returns the value.
        frame(&[0x0f, 0b110, 0], &[0, 0, 0b110]),
        frame(&[0x0b, 0b000, 0], &[0, 0, 0b000]),
        selection(2),
    ]
    .concat();
    let mut device = Mock::new(&script);
    let ranges = [(2, InputRange::Unipolar5V), (0, InputRange::Bipolar10V)];
    assert_eq!(Ads8688::new(device.clone()).configure(&ranges), Ok(()));
    device.done();
}

#[test]
fn a_device_that_does_not_answer_is_detected() {
    let ranges = [(0, InputRange::Unipolar10V)];
    let reset = frame(&[0x85, 0, 0, 0], &[0; 4]);
    let scripts = [
        (vec![frame(&[0x85, 0, 0, 0], &[0xff; 4])], SensorFault::NoAnswer),
        (vec![frame(&[0x85, 0, 0, 0], &[0, 1, 0, 0])], SensorFault::NoAnswer),
        (vec![reset.clone(), frame(&[0x0b, 0b101, 0], &[0, 0, 0b001])], SensorFault::NotConfigured),
    ];
    for (script, fault) in scripts {
        let mut device = Mock::new(&script.concat());
        assert_eq!(Ads8688::new(device.clone()).configure(&ranges), Err(fault));
        device.done();
    }
    assert_eq!(Ads8688::new(Broken).configure(&ranges), Err(SensorFault::Bus));
}
