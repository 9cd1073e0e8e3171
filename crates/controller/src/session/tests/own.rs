//! Samples of the controller's own sensors.

use super::*;
use crate::flags::SENSOR_MISSING;
use link::track::SensorChannel;
use link::{Decoder, OutOfRange};

/// Own samples per sent estimate at 100 us.
const EVERY: u16 = 40;

/// Samples of at least a period in us.
fn own(shortest_period_us: u32) -> OwnSampling {
    OwnSampling { shortest_period_us, input_interval_ns: 9_000 }
}

fn sampling() -> Session {
    let mut session = configured(Target::Silicon, BENCH_B);
    assert_eq!(order(&mut session, Command::SampleYourself), Err(Refusal::NoSensors));
    assert!(!session.is_sampling());
    session.set_own_sampling(Some(own(100)));
    assert_eq!(order(&mut session, Command::SampleYourself), Ok(Answer::Sampling { every: EVERY }));
    assert!(session.is_sampling());
    session
}

fn sample(sequence: u32) -> (SensorFrame, SensorStatus) {
    let time_us = sequence * 100;
    let frame = SensorFrame { sequence, time_us, ..SensorFrame::default() };
    (frame, SensorStatus::GOOD.missing(SensorChannel::JournalY))
}

fn decoded(bytes: &[u8]) -> NumberedEstimate {
    let mut decoder = Decoder::new();
    match bytes.iter().find_map(|&byte| decoder.push::<ToHost>(byte)) {
        Some(Ok(ToHost::Estimate(estimate))) => estimate,
        other => panic!("{other:?}"),
    }
}

#[test]
fn one_estimate_in_so_many_is_sent_and_their_numbers_have_no_gaps() {
    let mut session = sampling();
    let sent: Vec<_> = (0..200)
        .filter_map(|sequence| session.tick_own_sample(|| sample(sequence), &mut NoTicks))
        .map(|sent| decoded(&sent.frame))
        .collect();
    let every = u32::from(EVERY);
    assert_eq!(sent.len() as u32, 200 / every);
    for (estimate, number) in sent.iter().zip(0..) {
        assert_eq!((estimate.number, estimate.estimate.sequence), (number, (number + 1) * every - 1));
        assert!(Flags::from_bits(estimate.estimate.flags).contains(SENSOR_MISSING));
    }
    assert_eq!((session.counters().samples, session.counters().flagged), (200, 200));
}

#[test]
fn every_sent_estimate_has_the_block_of_the_estimates_before_it() {
    let mut session = sampling();
    let blocks: Vec<_> = (0..200)
        .filter_map(|sequence| session.tick_own_sample(|| sample(sequence), &mut NoTicks))
        .map(|sent| sent.block.unwrap().load())
        .collect();
    assert_eq!(blocks.len(), 5);
    for ((block, is_corrupted), number) in blocks.into_iter().zip(0..) {
        assert!(!is_corrupted);
        assert_eq!((block.number, block.samples), (number, EVERY));
        assert!(Flags::from_bits(block.flags).contains(SENSOR_MISSING));
        assert!(block.max_force_n >= block.min_force_n && block.max_age < EVERY);
    }
}

#[test]
fn the_time_to_take_the_sample_is_part_of_the_deadline() {
    /// A counter that only the sample moves.
    struct Moved(std::rc::Rc<std::cell::Cell<u32>>);
    impl TickSource for Moved {
        fn start(&mut self) -> u32 {
            self.0.get()
        }
        fn since(&mut self, start: u32) -> u32 {
            self.0.get() - start
        }
    }
    let mut session = sampling();
    let count = std::rc::Rc::new(std::cell::Cell::new(0));
    for sequence in 0..5 {
        let slow = || {
            // A cycle more than a sample period at 168 MHz.
            count.set(count.get() + 16_801);
            sample(sequence)
        };
        session.tick_own_sample(slow, &mut Moved(count.clone()));
    }
    assert_eq!(session.counters().deadline_overruns, 5);
}

#[test]
fn the_wiring_of_a_configuration_is_returned_once() {
    let mut configuration = BENCH_B;
    configuration.wiring.load_input = 5;
    let mut session = configured(Target::Silicon, configuration);
    assert_eq!(session.take_wiring().map(|wiring| wiring.load.input), Some(5));
    assert!(session.take_wiring().is_none());
    configuration.wiring.load_input = 0;
    assert!(order(&mut session, Command::Configure(configuration)).is_err());
    assert!(session.take_wiring().is_none(), "refused, it changes nothing");
}

#[test]
fn a_stop_a_new_configuration_and_a_period_shorter_than_the_tick_end_it() {
    let mut session = sampling();
    assert!(matches!(order(&mut session, Command::Configure(BENCH_B)), Ok(Answer::Configured(_))));
    assert!(!session.is_sampling(), "a new configuration ends it");
    assert!(order(&mut session, Command::SampleYourself).is_ok() && session.is_sampling());
    stopped(&mut session);
    assert!(!session.is_sampling());
    assert!(session.tick_own_sample(|| sample(0), &mut NoTicks).is_none());
    assert_eq!(order(&mut session, Command::SampleYourself), Err(Refusal::NotConfigured));
    assert!(matches!(order(&mut session, Command::Configure(BENCH_B)), Ok(Answer::Configured(_))));
    session.set_own_sampling(Some(own(101)));
    match order(&mut session, Command::SampleYourself) {
        Err(Refusal::Configuration(reasons)) => {
            let expected = OutOfRange { field: Field::SamplePeriod, found: 100, min: 101, max: 1_000 };
            assert_eq!(reasons.iter().collect::<Vec<_>>(), [&expected]);
        }
        answer => panic!("{answer:?}"),
    }
    assert!(!session.is_sampling());
}

#[test]
fn every_period_from_the_shortest_on_is_served_and_paces_the_timer() {
    for (sample_period_us, every) in [(300, 14), (500, 8), (1_000, 4)] {
        let mut session = sampling();
        session.set_own_sampling(Some(own(300)));
        let mut other = BENCH_B;
        other.bench.sample_period_us = sample_period_us;
        assert!(matches!(order(&mut session, Command::Configure(other)), Ok(Answer::Configured(_))));
        assert_eq!(order(&mut session, Command::SampleYourself), Ok(Answer::Sampling { every }));
        assert_eq!(session.sample_period_us(), sample_period_us);
        let sent = (0..2 * u32::from(every))
            .filter_map(|sequence| session.tick_own_sample(|| sample(sequence), &mut NoTicks));
        assert_eq!(sent.count(), 2);
        stopped(&mut session);
        assert_eq!(session.sample_period_us(), 100);
    }
}
