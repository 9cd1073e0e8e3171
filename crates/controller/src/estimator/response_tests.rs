//! Response of the conditioning to noise and to a swing. The tests compare the table in [`super`]
//! with the computed values.

use super::newton::Newton;
use super::observer::{Observer, Radial};
use super::signals::{DEFORMATION_WINDOW, SHAFT_WINDOW, SWING_WINDOW};
use super::window::tests::weights;
use core::f64::consts::TAU;

/// Frequencies of the table, Hz.
const FREQUENCIES_HZ: [f64; 5] = [10.0, 30.0, 45.0, 65.0, 100.0];
/// Samples a second.
const RATE_HZ: f64 = 10_000.0;
/// Samples of a swing of 10 Hz.
const PERIOD: usize = 1000;

/// Root of the summed squares.
fn gain(weights: &[f64]) -> f64 {
    weights.iter().map(|w| w * w).sum::<f64>().sqrt()
}

/// Returns the frequency response of weights by age, real and imaginary part, relative to the ideal
/// response: 1 for a value, `i w` for a slope.
fn answer(weights: &[f64], hz: f64, slope: bool) -> (f64, f64) {
    let step = TAU * hz / RATE_HZ;
    let (mut re, mut im) = (0.0, 0.0);
    for (age, weight) in weights.iter().enumerate() {
        let angle = -step * age as f64;
        re += weight * angle.cos();
        im += weight * angle.sin();
    }
    if slope { (im / step, -re / step) } else { (re, im) }
}

/// Error in % and delay in ms at a frequency.
fn error_and_delay(weights: &[f64], hz: f64, slope: bool) -> (f64, f64) {
    let (re, im) = answer(weights, hz, slope);
    (100.0 * (re - 1.0).hypot(im), -im.atan2(re) / (TAU * hz) * 1e3)
}

/// A row of the table.
fn row(name: &str, weights: &[f64], slope: bool, samples: usize) -> String {
    let responses: Vec<_> = FREQUENCIES_HZ.iter().map(|&hz| error_and_delay(weights, hz, slope)).collect();
    let errors: Vec<_> = responses.iter().map(|(error, _)| format!("{error:.0}")).collect();
    let worst =
        (10..=100).map(|hz| error_and_delay(weights, f64::from(hz), slope).1.abs()).fold(0.0, f64::max);
    format!("| {name} | {:.4} | {} | {worst:.2} | {samples} |", gain(weights), errors.join(", "))
}

/// Returns weights by age of the observer without a prediction: position and rate per sample after
/// an impulse of 1 um.
fn observer_weights() -> (Vec<f64>, Vec<f64>) {
    let observer = Observer::new(100, 8_000, true);
    let mut state = observer.start();
    let quiet = Radial::default();
    observer.step(&mut state, 0, quiet, 0, true);
    for _ in 0..2000 {
        observer.step(&mut state, 0, quiet, 0, false);
    }
    let pulse = 16_000;
    (0..400)
        .map(|index| {
            let radial = observer.step(&mut state, if index == 0 { pulse } else { 0 }, quiet, 0, false);
            let rate = f64::from(radial.rate_nm_s) / RATE_HZ / 1000.0;
            (f64::from(radial.deformation) / f64::from(pulse), rate)
        })
        .unzip()
}

/// Error and delay of a rate whose prediction is nine tenths of the true rate. The observer gets
/// the complete rate, and the prediction has no delay.
fn nine_tenths(own: &[f64], hz: f64) -> (f64, f64) {
    let (re, im) = answer(own, hz, true);
    let (re, im) = (0.9 + 0.1 * re, 0.1 * im);
    (100.0 * (re - 1.0).hypot(im), -im.atan2(re) / (TAU * hz) * 1e3)
}

#[test]
fn the_table_of_the_module_equals_the_computed_values() {
    let (value, slope) = weights::<DEFORMATION_WINDOW>();
    let (_, swing) = weights::<SWING_WINDOW>();
    let (_, shaft) = weights::<SHAFT_WINDOW>();
    let (own_value, own_rate) = observer_weights();
    let predicted: Vec<_> = FREQUENCIES_HZ.iter().map(|&hz| nine_tenths(&own_rate, hz)).collect();
    let errors: Vec<_> = predicted.iter().map(|(error, _)| format!("{error:.0}")).collect();
    let worst = (10..=100).map(|hz| nine_tenths(&own_rate, hz.into()).1.abs()).fold(0.0, f64::max);
    let rows = [
        row("deformation, observer alone", &own_value, false, 250),
        row("deformation, window", &value, false, DEFORMATION_WINDOW),
        row("rate, observer alone", &own_rate, true, 250),
        format!(
            "| rate, Newton's law right to a tenth | {:.4} | {} | {worst:.2} | 250 |",
            gain(&own_rate),
            errors.join(", ")
        ),
        row("rate, window", &slope, true, DEFORMATION_WINDOW),
        row("journal's speed", &swing, true, SWING_WINDOW),
        row("shaft's speed", &shaft, true, SHAFT_WINDOW),
    ];
    let text = include_str!("mod.rs");
    let table: String = rows.map(|row| format!("//! {row}\n")).concat();
    assert!(text.contains(&table), "the table has to say:\n{table}");
}

/// The integer observer has the response of the filter with its gains. A prediction passes it
/// without delay.
#[test]
fn the_observer_is_its_filter_and_the_prediction_has_no_delay() {
    let (own_value, own_rate) = observer_weights();
    let (position_gain, rate_gain) = (99_775.0 / f64::from(1 << 20), 4_987.0 / f64::from(1 << 20));
    let (mut position, mut rate) = (0.0, 0.0);
    for (index, (value, slope)) in own_value.iter().zip(&own_rate).enumerate() {
        position += rate;
        let off = f64::from(u8::from(index == 0)) - position;
        position += position_gain * off;
        rate += rate_gain * off;
        assert!(
            (value - position).abs() < 1e-3 && (slope - rate).abs() < 2e-6,
            "{index}: {value} {position} {slope} {rate}"
        );
    }
    // A swing of 45 Hz and 1 mm/s, predicted exactly, without noise.
    let observer = Observer::new(100, 200, true);
    let mut state = observer.start();
    for index in 0..3 * PERIOD {
        let phase = TAU * 45.0 * index as f64 / RATE_HZ;
        let truth_nm_s = 1e6 * phase.cos();
        let position_nm = 1e6 / (TAU * 45.0) * phase.sin();
        let at = (position_nm * 16.0).round() as i32;
        // The position follows the mean rate of the step.
        let mean = 1e6 * (phase - TAU * 45.0 / RATE_HZ / 2.0).cos();
        let window = Radial { deformation: at, rate_nm_s: truth_nm_s.round() as i32 };
        let radial = observer.step(&mut state, at, window, mean.round() as i32, index < 5);
        if index > 300 {
            assert!(
                (f64::from(radial.rate_nm_s) - truth_nm_s).abs() < 2e4,
                "{index}: {radial:?} {truth_nm_s}"
            );
            assert!((radial.deformation - at).abs() < 40, "{index}: {radial:?} {at}");
        }
    }
}

/// Without known masses there is no prediction.
#[test]
fn without_masses_there_is_no_prediction() {
    let conditioning = super::Conditioning {
        masses: None,
        ..super::Conditioning::for_bearing(inference::BearingMaterial::Babbitt)
    };
    assert!(!Newton::new(&conditioning, 100).has_masses());
}
