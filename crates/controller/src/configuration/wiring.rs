//! Wiring of the controller's own sensors: accepted ranges, and the drivers' form.

use core::ops::RangeInclusive;

use link::{ControllerConfiguration, WiringField};

use fixed::types::{I2F30, I16F16};

use crate::sensors::{INPUTS, LoadInput, Probe, ProbePair, Scale, Transmitter, Wiring};

/// Field, its value and the accepted values.
type Ranged = (WiringField, i64, RangeInclusive<i64>);

/// Number of inputs in use: two probes and a transmitter.
const USED: usize = 3;
/// Maximum force at 20 mA, N. 10 MN is more than any rudder drive has.
const MAX_LOAD_N: i64 = 10_000_000;

/// Returns every field with its value and range.
#[must_use]
pub(super) fn ranges(wiring: &link::Wiring) -> [Ranged; 12] {
    use WiringField as Field;
    let [first, second] = wiring.probe_inputs;
    let used = [first, second, wiring.load_input];
    let distinct =
        used.iter().enumerate().filter(|(place, input)| !used.iter().take(*place).any(|u| u == *input));
    let inputs = 0..=i64::from(INPUTS.saturating_sub(1));
    // 1 um/V to 10 mm/V.
    let gains = 1_000..=10_000_000;
    let [first_gain, second_gain] = wiring.probe_gain_nm_v.map(|gain| i64::from(gain.unsigned_abs()));
    let [first_gap, second_gap] = wiring.centre_gap_um.map(i64::from);
    let gaps = 0..=20_000;
    let load_n = u64::from(wiring.transmitter_range_kpa).wrapping_mul(wiring.piston_mm2.into()) / 1_000;
    // One thousandth of a product of two words fits into 63 bits.
    let load_n = load_n.cast_signed();
    [
        (Field::Input, first.into(), inputs.clone()),
        (Field::Input, second.into(), inputs.clone()),
        (Field::Input, wiring.load_input.into(), inputs),
        (Field::DistinctInputs, distinct.count() as i64, USED as i64..=USED as i64),
        (Field::ProbeGain, first_gain, gains.clone()),
        (Field::ProbeGain, second_gain, gains),
        (Field::CentreGap, first_gap, gaps.clone()),
        (Field::CentreGap, second_gap, gaps),
        (Field::FirstProbe, wiring.first_probe_centidegrees.into(), -18_000..=18_000),
        // 10 ohm to 6.5 kiloohm.
        (Field::Shunt, wiring.shunt_deciohm.into(), 100..=u16::MAX.into()),
        // Up to 10,000 bar.
        (Field::TransmitterRange, wiring.transmitter_range_kpa.into(), 1..=1_000_000),
        (Field::LoadSpan, load_n, 1..=MAX_LOAD_N),
    ]
}

/// Returns the wiring for the drivers, or `None` if the configuration has not been validated.
#[must_use]
pub fn wiring(configuration: &ControllerConfiguration) -> Option<Wiring> {
    let given = &configuration.wiring;
    let [first, second] = given.probe_inputs;
    let [first_gain, second_gain] = given.probe_gain_nm_v;
    let range = given.probe_range;
    // A code over 2^16 is the span's millionth part times 2^16: nm/V times the span in V.
    let probe = |input, gain_nm_v: i32| -> Option<Probe> {
        let gain = i64::from(gain_nm_v).checked_mul(range.span_uv().into())? / 1_000_000;
        let scale = Scale {
            zero_code: range.zero_code(),
            gain_nm: I16F16::from_bits(i32::try_from(gain).ok()?),
            table_nm: None,
        };
        Some(Probe { input, scale })
    };
    let current =
        u64::from(given.load_range.span_uv()).checked_mul(10_000)?.checked_div(given.shunt_deciohm.into())?;
    let transmitter = Transmitter::new(
        given.load_range.zero_code(),
        I16F16::from_bits(i32::try_from(current).ok()?),
        given.transmitter_range_kpa.checked_mul(1_000)?,
        given.piston_mm2,
    )?;
    let gaps_nm = given.centre_gap_um.map(|gap_um| i32::from(gap_um).wrapping_mul(1_000));
    let direction = direction(given.first_probe_centidegrees);
    Some(Wiring {
        probes: [probe(first, first_gain)?, probe(second, second_gain)?],
        opposite: None,
        geometry: ProbePair::new(direction, gaps_nm, configuration.bench.journal_radius_nm, None)?,
        load: LoadInput { input: given.load_input, transmitter },
        counter_load: None,
        probe_range: range,
        load_range: given.load_range,
    })
}

/// Returns cosine and sine of an angle in hundredths of a degree, by their series within 45 degrees
/// of an axis.
fn direction(centidegrees: i16) -> [I2F30; 2] {
    let shifted = i32::from(centidegrees).wrapping_add(4_500);
    let quarter = shifted.div_euclid(9_000).rem_euclid(4);
    let angle = f64::from(shifted.rem_euclid(9_000).wrapping_sub(4_500)) * (core::f64::consts::PI / 18_000.0);
    let square = angle * angle;
    let (mut cosine, mut sine) = (1.0, 1.0);
    // Horner scheme from the last term: 1 - x2/(n(n+1)) (1 - ...), to 1e-14.
    for term in [13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        cosine = 1.0 - square / (term * (term + 1.0)) * cosine;
        sine = 1.0 - square / ((term + 1.0) * (term + 2.0)) * sine;
    }
    // Rounds to the nearest value. The conversion of `fixed` itself would panic for NaN.
    let fixed = |value: f64| {
        let bits = value * f64::from(I2F30::ONE.to_bits());
        I2F30::from_bits((if bits < 0.0 { bits - 0.5 } else { bits + 0.5 }) as i32)
    };
    let (cosine, sine) = (fixed(cosine), fixed(sine * angle));
    match quarter {
        0 => [cosine, sine],
        1 => [sine.wrapping_neg(), cosine],
        2 => [cosine.wrapping_neg(), sine.wrapping_neg()],
        _ => [sine, cosine.wrapping_neg()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::{BENCH_B, validate};
    use link::{Field, InputRange};
    use proptest::prelude::*;

    fn with(change: impl FnOnce(&mut link::Wiring)) -> ControllerConfiguration {
        let mut configuration = BENCH_B;
        change(&mut configuration.wiring);
        configuration
    }

    #[test]
    fn the_nominal_wiring_is_2_mm_and_50_kn_over_their_spans() {
        let wiring = wiring(&BENCH_B).unwrap();
        let [first, second] = wiring.probes;
        assert_eq!((first.input, second.input, wiring.load.input), (0, 1, 2));
        // 5 V of 10.24 V.
        assert_eq!(first.scale.length_nm(32_000), 1_000_000);
        assert_eq!(wiring.geometry.centre_nm([1_000_000, 1_000_000]), [0, 0]);
        // 4 and 20 mA over 250 ohm: 1 and 5 V of 5.12 V.
        assert_eq!(wiring.load.transmitter.force_mn(12_800), Ok(0));
        let full = wiring.load.transmitter.force_mn(64_000).unwrap();
        assert!((full - 50_000_000).abs() < 100, "{full}");
    }

    #[test]
    fn a_bipolar_range_has_its_zero_in_the_middle_and_a_falling_probe_falls() {
        let configuration = with(|wiring| {
            wiring.probe_range = InputRange::Bipolar10V;
            wiring.probe_gain_nm_v = [-200_000, 200_000];
        });
        let [first, second] = wiring(&configuration).unwrap().probes;
        assert_eq!((first.scale.length_nm(0x8000), first.scale.length_nm(0xC000)), (0, -1_024_000));
        assert_eq!(second.scale.length_nm(0xC000), 1_024_000);
    }

    #[test]
    fn contradictory_values_are_refused_by_field() {
        let refused = |configuration: &ControllerConfiguration| {
            let reasons = validate(configuration).unwrap_err();
            reasons.iter().map(|reason| reason.field).collect::<Vec<_>>()
        };
        let field = |field| vec![Field::Wiring(field)];
        assert_eq!(refused(&with(|w| w.load_input = 0)), field(WiringField::DistinctInputs));
        assert_eq!(refused(&with(|w| w.load_input = 8)), field(WiringField::Input));
        assert_eq!(refused(&with(|w| w.probe_gain_nm_v[1] = 0)), field(WiringField::ProbeGain));
        assert_eq!(refused(&with(|w| w.shunt_deciohm = 0)), field(WiringField::Shunt));
        assert_eq!(refused(&with(|w| w.first_probe_centidegrees = 18_001)), field(WiringField::FirstProbe));
        assert_eq!(refused(&with(|w| w.piston_mm2 = 1_000_000)), field(WiringField::LoadSpan));
        assert_eq!(refused(&with(|w| w.piston_mm2 = 0)), field(WiringField::LoadSpan));
    }

    proptest! {
        #[test]
        fn a_direction_is_that_of_the_standard_library(centidegrees in -18_000..=18_000_i16) {
            let angle = f64::from(centidegrees).to_radians() / 100.0;
            for (found, exact) in direction(centidegrees).into_iter().zip([angle.cos(), angle.sin()]) {
                prop_assert!((f64::from(found) - exact).abs() < 2.0_f64.powi(-30));
            }
        }

        /// Every valid configuration can be converted into drivers.
        #[test]
        fn every_valid_wiring_has_drivers(
            inputs in prop::sample::subsequence((0..8_u8).collect::<Vec<_>>(), 3),
            ranges in prop::array::uniform2(prop::sample::select(vec![
                InputRange::Bipolar10V,
                InputRange::Bipolar5V,
                InputRange::Bipolar2V5,
                InputRange::Unipolar10V,
                InputRange::Unipolar5V,
            ])),
            gains in any::<[i32; 2]>(),
            gaps in any::<[u16; 2]>(),
            direction in any::<i16>(),
            shunt in any::<u16>(),
            range in any::<u32>(),
            piston in any::<u32>(),
            small in any::<bool>(),
        ) {
            let scale = |value: u32, most: u32| if small { value % most } else { value };
            let configuration = with(|wiring| *wiring = link::Wiring {
                probe_inputs: [inputs[0], inputs[1]],
                load_input: inputs[2],
                probe_range: ranges[0],
                load_range: ranges[1],
                probe_gain_nm_v: gains.map(|gain| if small { gain % 10_000_001 } else { gain }),
                centre_gap_um: gaps,
                first_probe_centidegrees: direction,
                shunt_deciohm: shunt,
                transmitter_range_kpa: scale(range, 1_000_001),
                piston_mm2: scale(piston, 10_000),
                sample_at_start: small,
            });
            prop_assert!(validate(&configuration).is_err() || wiring(&configuration).is_some());
        }
    }
}
