//! Complete samples: frames and status from scripted devices.

use crate::script::{Bus, answers, encoder, frame, selection};
use controller::sensors::{
    Absolute, Acquired, Answers, InputRange, LoadInput, Opposite, Probe, ProbePair, Sampler, Scale,
    SensorFault, Transmitter, Wiring,
};
use embedded_hal_mock::eh1::spi::Transaction;
use fixed::types::{I2F30, I16F16};
use link::track::{SensorChannel, SensorStatus};

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
    script.extend(selection(0));
    script
}

/// 12 mA and 4 mA: 5 kN and nothing.
const LOAD: [u16; 2] = [24_000, 8_000];

const TWO_PROBES: [(u8, u8); 4] = [(0, 0b101), (1, 0b101), (6, 0b110), (7, 0b110)];
/// Angle in steps.
const ANGLE: u16 = 100;

fn good(codes: [u16; 4]) -> Answers {
    answers(&codes, encoder(ANGLE))
}

/// A sample of the first run.
fn at(time_us: u32, answers: Answers) -> Acquired {
    in_run(1, time_us, answers)
}

fn in_run(run: u32, time_us: u32, answers: Answers) -> Acquired {
    Acquired { time_us, lost: 0, run, answers: Some(answers) }
}

fn sampler() -> Sampler<Bus, Absolute> {
    let mut sampler =
        Sampler::new(Bus::new(&configured(&TWO_PROBES)), Absolute::default(), wiring(false), 100);
    assert_eq!(sampler.configure(), Ok(()));
    sampler
}

fn finish(sampler: Sampler<Bus, Absolute>) -> Bus {
    let mut bus = sampler.release().0;
    bus.converter.done();
    bus
}

#[test]
fn a_sample_is_a_frame_in_the_controller_s_time() {
    let mut sampler = sampler();
    let (first, status) = sampler.sample(&at(u32::MAX, good([45_000, 55_000, LOAD[0], LOAD[1]])));
    assert_eq!(status, SensorStatus::GOOD);
    assert_eq!((first.sequence, first.time_us, first.shaft_angle_nrad), (0, u32::MAX, 38_349_519));
    // 100 um towards the first probe, away from the second; 72 nm of curvature either way.
    assert_eq!((first.journal_y_nm, first.journal_z_nm), (100_071, -99_929));
    assert!((first.load_force_mn - 5_000_000).abs() < 10, "{}", first.load_force_mn);
    let (second, _) = sampler.sample(&at(99, good([50_000, 50_000, LOAD[0], LOAD[0]])));
    assert_eq!((second.sequence, second.time_us, second.journal_y_nm), (1, 99, 0));
    assert!((second.load_force_mn - 2_500_000).abs() < 10, "the other side's half area against it");
    assert_eq!(finish(sampler).runs.len(), 1, "hardware repeats it");
}

#[test]
fn lost_samples_are_missing_in_the_numbers() {
    let mut sampler = sampler();
    let codes = [50_000, 50_000, LOAD[0], LOAD[1]];
    assert_eq!(sampler.sample(&at(0, good(codes))).0.sequence, 0);
    assert_eq!(sampler.sample(&Acquired { lost: 3, ..at(1_200, good(codes)) }).0.sequence, 4);
    finish(sampler);
}

#[test]
fn each_fault_marks_its_channels_keeps_their_values_and_is_counted() {
    let mut sampler = sampler();
    let (first, _) = sampler.sample(&at(0, good([45_000, 55_000, LOAD[0], LOAD[1]])));

    let [angle, diagnostics] = encoder(7);
    let disturbed = answers(&[45_000, 55_000, 100, LOAD[1]], [angle ^ 1, diagnostics]);
    let (frame, status) = sampler.sample(&at(100, disturbed));
    assert_eq!(
        status,
        SensorStatus::GOOD.missing(SensorChannel::ShaftAngle).missing(SensorChannel::LoadForce)
    );
    assert_eq!((frame.shaft_angle_nrad, frame.load_force_mn), (first.shaft_angle_nrad, first.load_force_mn));
    let (_, status) = sampler.sample(&at(200, good([45_000, 55_000, 60_000, LOAD[1]])));
    assert_eq!(status, SensorStatus::GOOD.missing(SensorChannel::LoadForce));
    let (frame, status) = sampler.sample(&at(300, good([65_530, 55_000, LOAD[0], LOAD[1]])));
    assert_eq!(status, SensorStatus::GOOD.at_rail(SensorChannel::JournalY).at_rail(SensorChannel::JournalZ));
    assert!(frame.journal_y_nm < -300_000, "the rail's value");

    let faults = sampler.faults();
    assert_eq!(faults.count(SensorChannel::ShaftAngle, SensorFault::Parity), 1);
    assert_eq!(faults.count(SensorChannel::LoadForce, SensorFault::BrokenWire), 1);
    assert_eq!(faults.count(SensorChannel::LoadForce, SensorFault::ShortCircuit), 1);
    assert_eq!(faults.count(SensorChannel::JournalZ, SensorFault::AtRail), 1);
    assert_eq!(faults.count(SensorChannel::JournalZ, SensorFault::Bus), 0);
    finish(sampler);
}

#[test]
fn after_a_frame_without_an_answer_the_next_input_is_unknown() {
    let mut sampler = sampler();
    sampler.sample(&at(0, good([50_000, 50_000, LOAD[0], LOAD[1]])));
    // The second frame is lost: the input that the third one returns is unknown.
    let mut lost = good([45_000, 0, LOAD[0], LOAD[1]]);
    lost[3..5].fill(0xffff);
    let (frame, status) = sampler.sample(&at(100, lost));
    let all = SensorStatus::GOOD
        .missing(SensorChannel::JournalY)
        .missing(SensorChannel::JournalZ)
        .missing(SensorChannel::LoadForce);
    assert_eq!((status, frame.journal_y_nm), (all, 0));
    let (_, status) = sampler.sample(&at(200, good([45_000, 55_000, LOAD[0], LOAD[1]])));
    assert_eq!(status, SensorStatus::GOOD);
    assert_eq!(sampler.faults().count(SensorChannel::LoadForce, SensorFault::NoAnswer), 1);
    finish(sampler);
}

#[test]
fn an_absent_converter_is_configured_again_beside_a_working_encoder() {
    // All zeros, as an open line reads: the range that was written does not read back.
    let absent = [frame(&[0x85, 0, 0, 0], &[0; 4]), frame(&[11, 0b101, 0], &[0; 3])].concat();
    let script = [absent.clone(), absent.clone(), absent, configured(&TWO_PROBES)].concat();
    let mut sampler = Sampler::new(Bus::new(&script), Absolute::default(), wiring(false), 100);
    let none = SensorStatus::GOOD
        .missing(SensorChannel::JournalY)
        .missing(SensorChannel::JournalZ)
        .missing(SensorChannel::LoadForce);
    // No sequence runs before the first configuration.
    assert_eq!(sampler.sample(&Acquired::nothing(0)).1, none.missing(SensorChannel::ShaftAngle));
    let nothing = answers(&[0; 4], encoder(ANGLE));
    for run in 1..=3 {
        assert_eq!(sampler.sample(&in_run(run, 100 * run, nothing)).1, none);
    }
    let codes = [50_000, 50_000, LOAD[0], LOAD[1]];
    assert_eq!(sampler.sample(&in_run(4, 400, good(codes))).1, SensorStatus::GOOD);
    assert_eq!(sampler.faults().count(SensorChannel::LoadForce, SensorFault::NotConfigured), 4);
    assert_eq!(finish(sampler).runs.len(), 4, "it runs whether the converter answers or not");
}

#[test]
fn answers_of_an_earlier_run_do_not_count() {
    let mut sampler = sampler();
    let codes = [50_000, 50_000, LOAD[0], LOAD[1]];
    assert!(!sampler.set_period(300));
    assert_eq!(sampler.sample(&at(0, good(codes))).1.missing_bits(), 0b1111);
    // The sequence may have been cut: the first input of the new one is unknown.
    let (_, status) = sampler.sample(&in_run(2, 300, good(codes)));
    assert_eq!(status.missing_bits(), 0b0011);
    assert_eq!(sampler.sample(&in_run(2, 600, good(codes))).1, SensorStatus::GOOD);
    finish(sampler);
}

#[test]
fn a_converter_that_falls_silent_is_configured_again() {
    let script = [configured(&TWO_PROBES), configured(&TWO_PROBES)].concat();
    let mut sampler = Sampler::new(Bus::new(&script), Absolute::default(), wiring(false), 100);
    sampler.configure().unwrap();
    // Without supply, or shifted by a word.
    let mut silent = good([50_000, 50_000, LOAD[0], LOAD[1]]);
    silent[1..9].fill(0xffff);
    for sample in 0..9 {
        assert_eq!(sampler.sample(&at(100 * sample, silent)).1.missing_bits(), 0b1011);
    }
    let codes = [50_000, 50_000, LOAD[0], LOAD[1]];
    assert_eq!(sampler.sample(&in_run(2, 900, good(codes))).1, SensorStatus::GOOD);
    assert_eq!(finish(sampler).runs.len(), 2);
}

#[test]
fn another_period_runs_the_same_sequence_anew() {
    let mut sampler = sampler();
    assert!(sampler.set_period(100));
    assert!(!sampler.set_period(300) && sampler.set_period(300));
    let runs = finish(sampler).runs;
    assert_eq!(runs.iter().map(|(_, period_us)| *period_us).collect::<Vec<_>>(), [100, 300]);
    assert_eq!(runs[0].0, runs[1].0);
}

#[test]
fn a_third_probe_that_disagrees_makes_the_journal_missing() {
    let inputs = [(0, 0b101), (1, 0b101), (2, 0b101), (6, 0b110), (7, 0b110)];
    let five = |third| answers(&[45_000, 50_000, third, LOAD[0], LOAD[1]], encoder(ANGLE));
    let mut sampler = Sampler::new(Bus::new(&configured(&inputs)), Absolute::default(), wiring(true), 100);
    assert_eq!(sampler.configure(), Ok(()));
    assert_eq!(sampler.sample(&at(0, five(55_000))).1, SensorStatus::GOOD);
    let (_, status) = sampler.sample(&at(100, five(54_000)));
    assert_eq!(status.missing_bits(), 0b0011);
    assert_eq!(sampler.faults().count(SensorChannel::JournalY, SensorFault::Disagreement), 1);
    finish(sampler);
}
