//! Complete samples: frames and status from scripted devices.

use crate::script::{conversion, frame};
use controller::sensors::{
    Ads8688, AngleSensor, InputRange, LoadInput, Opposite, Probe, ProbePair, Sampler, Scale, SensorFault,
    Transmitter, Wiring,
};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use fixed::types::{I2F30, I16F16};
use link::track::{SensorChannel, SensorStatus};

/// Angles, or faults, one a sample.
struct Angles(Vec<Result<i32, SensorFault>>);

impl AngleSensor for Angles {
    fn angle_nrad(&mut self) -> Result<i32, SensorFault> {
        self.0.remove(0)
    }
}

/// 20 nm a code; the journal is in the centre at code 50,000 of either probe.
fn probe(input: u8) -> Probe {
    Probe { input, scale: Scale { zero_code: 0, gain_nm: I16F16::lit("20"), table_nm: None } }
}

fn wiring(opposite: bool) -> Wiring {
    let third = opposite.then_some(Opposite { gap_nm: 1_000_000, tolerance_nm: 2_000 });
    Wiring {
        probes: [probe(0), probe(1)],
        opposite: opposite.then_some(probe(2)),
        geometry: ProbePair::new([I2F30::ONE, I2F30::ZERO], [1_000_000; 2], 69_500_000, third).unwrap(),
        // 500 nA a code; 100 bar on 10 cm2, 10 kN.
        load: LoadInput {
            input: 6,
            transmitter: Transmitter::new(0, I16F16::lit("500"), 10_000_000, 1_000).unwrap(),
        },
        counter_load: Some(LoadInput {
            input: 7,
            transmitter: Transmitter::new(0, I16F16::lit("500"), 10_000_000, 500).unwrap(),
        }),
        probe_range: InputRange::Unipolar10V,
        load_range: InputRange::Unipolar5V,
    }
}

fn configured(inputs: &[(u8, u8)]) -> Vec<Transaction<u8>> {
    let mut script = frame(&[0x85, 0, 0, 0], &[0; 4]).to_vec();
    for (input, range) in inputs {
        script.extend(frame(&[(5 + input) << 1 | 1, *range, 0], &[0, 0, *range]));
    }
    script.extend(conversion(0, 0));
    script
}

/// 12 mA and 4 mA: 5 kN and nothing.
const LOAD: [u16; 2] = [24_000, 8_000];

fn sample(codes: [u16; 4]) -> Vec<Transaction<u8>> {
    [1, 6, 7, 0].iter().zip(codes).flat_map(|(next, code)| conversion(*next, code)).collect()
}

const TWO_PROBES: [(u8, u8); 4] = [(0, 0b101), (1, 0b101), (6, 0b110), (7, 0b110)];

fn sampler(
    samples: &[Vec<Transaction<u8>>],
    angles: Vec<Result<i32, SensorFault>>,
) -> Sampler<Mock<u8>, Angles> {
    let script = [configured(&TWO_PROBES), samples.concat()].concat();
    let mut sampler = Sampler::new(Ads8688::new(Mock::new(&script)), Angles(angles), wiring(false));
    assert_eq!(sampler.configure(), Ok(()));
    sampler
}

#[test]
fn a_sample_is_a_frame_in_the_controller_s_time() {
    let samples = [sample([45_000, 55_000, LOAD[0], LOAD[1]]), sample([50_000, 50_000, LOAD[0], LOAD[0]])];
    let mut sampler = sampler(&samples, vec![Ok(-5), Ok(9)]);
    let (first, status) = sampler.sample(u32::MAX);
    assert_eq!(status, SensorStatus::GOOD);
    assert_eq!((first.sequence, first.time_us, first.shaft_angle_nrad), (0, u32::MAX, -5));
    // 100 um towards the first probe, away from the second; 72 nm of curvature either way.
    assert_eq!((first.journal_y_nm, first.journal_z_nm), (100_071, -99_929));
    assert!((first.load_force_mn - 5_000_000).abs() < 10, "{}", first.load_force_mn);
    let (second, _) = sampler.sample(99);
    assert_eq!((second.sequence, second.time_us, second.journal_y_nm), (1, 99, 0));
    assert!((second.load_force_mn - 2_500_000).abs() < 10, "the other side's half area against it");
    sampler.release().0.done();
}

#[test]
fn each_fault_marks_its_channels_keeps_their_values_and_is_counted() {
    let samples = [
        sample([45_000, 55_000, LOAD[0], LOAD[1]]),
        sample([45_000, 55_000, 100, LOAD[1]]),
        sample([45_000, 55_000, 60_000, LOAD[1]]),
        sample([65_530, 55_000, LOAD[0], LOAD[1]]),
    ];
    let mut sampler = sampler(&samples, vec![Ok(7), Err(SensorFault::Parity), Ok(8), Ok(8)]);
    let (good, _) = sampler.sample(0);

    let (frame, status) = sampler.sample(100);
    assert_eq!(
        status,
        SensorStatus::GOOD.missing(SensorChannel::ShaftAngle).missing(SensorChannel::LoadForce)
    );
    assert_eq!((frame.shaft_angle_nrad, frame.load_force_mn), (7, good.load_force_mn));
    let (_, status) = sampler.sample(200);
    assert_eq!(status, SensorStatus::GOOD.missing(SensorChannel::LoadForce));
    let (frame, status) = sampler.sample(300);
    assert_eq!(status, SensorStatus::GOOD.at_rail(SensorChannel::JournalY).at_rail(SensorChannel::JournalZ));
    assert!(frame.journal_y_nm < -300_000, "the rail's value");

    let faults = sampler.faults();
    assert_eq!(faults.count(SensorChannel::ShaftAngle, SensorFault::Parity), 1);
    assert_eq!(faults.count(SensorChannel::LoadForce, SensorFault::BrokenWire), 1);
    assert_eq!(faults.count(SensorChannel::LoadForce, SensorFault::ShortCircuit), 1);
    assert_eq!(faults.count(SensorChannel::JournalZ, SensorFault::AtRail), 1);
    assert_eq!(faults.count(SensorChannel::JournalZ, SensorFault::Bus), 0);
    sampler.release().0.done();
}

#[test]
fn after_a_frame_without_an_answer_the_next_input_is_unknown() {
    // The second frame is lost: the input that the third one returns is unknown.
    let mut lost = [conversion(1, 45_000), frame(&[0xd8, 0, 0, 0], &[0xff; 4])].concat();
    lost.extend([conversion(7, LOAD[0]), conversion(0, LOAD[1])].concat());
    let samples =
        [sample([50_000, 50_000, LOAD[0], LOAD[1]]), lost, sample([45_000, 55_000, LOAD[0], LOAD[1]])];
    let mut sampler = sampler(&samples, vec![Ok(0); 3]);
    sampler.sample(0);
    let (frame, status) = sampler.sample(100);
    let all = SensorStatus::GOOD
        .missing(SensorChannel::JournalY)
        .missing(SensorChannel::JournalZ)
        .missing(SensorChannel::LoadForce);
    assert_eq!((status, frame.journal_y_nm), (all, 0));
    assert_eq!(sampler.sample(200).1, SensorStatus::GOOD);
    assert_eq!(sampler.faults().count(SensorChannel::LoadForce, SensorFault::NoAnswer), 1);
    sampler.release().0.done();
}

#[test]
fn an_absent_converter_is_configured_again_and_its_channels_are_missing_until_then() {
    // All zeros, as an open line reads: the range that was written does not read back.
    let absent = [frame(&[0x85, 0, 0, 0], &[0; 4]), frame(&[11, 0b101, 0], &[0; 3])].concat();
    let script =
        [absent.clone(), absent, configured(&TWO_PROBES), sample([50_000, 50_000, LOAD[0], LOAD[1]])];
    let mut sampler =
        Sampler::new(Ads8688::new(Mock::new(&script.concat())), Angles(vec![Ok(0); 4]), wiring(false));
    let none = SensorStatus::GOOD
        .missing(SensorChannel::JournalY)
        .missing(SensorChannel::JournalZ)
        .missing(SensorChannel::LoadForce);
    for time_us in [0, 100, 200] {
        assert_eq!(sampler.sample(time_us).1, none);
    }
    assert_eq!(sampler.sample(300).1, SensorStatus::GOOD);
    assert_eq!(sampler.faults().count(SensorChannel::LoadForce, SensorFault::NotConfigured), 3);
    sampler.release().0.done();
}

#[test]
fn a_third_probe_that_disagrees_makes_the_journal_missing() {
    let inputs = [(0, 0b101), (1, 0b101), (2, 0b101), (6, 0b110), (7, 0b110)];
    let five = |third: u16| -> Vec<_> {
        [(1, 45_000), (2, 50_000), (6, third), (7, LOAD[0]), (0, LOAD[1])]
            .iter()
            .flat_map(|(next, code)| conversion(*next, *code))
            .collect()
    };
    let script = [configured(&inputs), five(55_000), five(54_000)].concat();
    let mut sampler = Sampler::new(Ads8688::new(Mock::new(&script)), Angles(vec![Ok(0); 2]), wiring(true));
    assert_eq!(sampler.configure(), Ok(()));
    assert_eq!(sampler.sample(0).1, SensorStatus::GOOD);
    let (_, status) = sampler.sample(100);
    assert_eq!(status.missing_bits(), 0b0011);
    assert_eq!(sampler.faults().count(SensorChannel::JournalY, SensorFault::Disagreement), 1);
    sampler.release().0.done();
}
