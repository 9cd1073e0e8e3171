//! The image samples its own sensors on command, paced by its timer, and reports over its serial
//! port.
//!
//! The emulator's SPI port has no device and reads zeros. No channel may take that for a value:
//! every estimate reports missing sensors, and so do the counts by channel.

use crate::board::Board;
use crate::frames::configuration;
use controller::flags::SENSOR_MISSING;
use controller::session::own_estimate_interval;
use inference::{BearingMaterial, Flags};
use link::track::SensorHealth;
use link::{
    Answer, Command, EstimateFrame, NumberedEstimate, Refusal, SensorFrame, SlowReport, ToController, ToHost,
};

fn is_missing(estimate: &EstimateFrame) -> bool {
    Flags::from_bits(estimate.flags).contains(SENSOR_MISSING)
}

#[test]
fn without_sensors_on_its_bus_it_estimates_on_time_and_reports_every_channel_as_missing() {
    follow(100);
    follow(300);
}

/// Configures a board for a sample period in us and follows its own samples.
fn follow(sample_period_us: u32) {
    let mut configuration = configuration(BearingMaterial::Babbitt);
    configuration.bench.sample_period_us = sample_period_us;
    let mut board = Board::configured(configuration);
    let every = own_estimate_interval(sample_period_us);
    assert_eq!(board.order(Command::SampleYourself), Ok(Answer::Sampling { every }));
    let mut health: Option<SensorHealth> = None;
    let mut estimates = std::mem::take(&mut board.estimates);
    let mut blocks = Vec::new();
    while estimates.len() < 250 || health.is_none() {
        match board.next() {
            ToHost::Estimate(estimate) => estimates.push(estimate),
            ToHost::Block(block) => blocks.push(block),
            ToHost::Slow(slow) => {
                if let SlowReport::Sensors(report) = slow.report {
                    health = Some(report);
                }
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(blocks.len() + 2 > estimates.len(), "a block after every estimate");
    assert!(blocks.iter().all(|block| block.samples == every && block.max_age < every));
    assert!(blocks.windows(2).all(|pair| pair[1].number == pair[0].number + 1));
    let period = u32::from(every);
    for pair in estimates.windows(2) {
        let [NumberedEstimate { number, estimate, .. }, next] = pair else { unreachable!() };
        assert_eq!(next.number, number + 1, "one number a sent estimate");
        assert_eq!(next.estimate.sequence, estimate.sequence + period);
        assert_eq!(next.estimate.time_us, estimate.time_us + period * sample_period_us);
    }
    assert!(estimates.iter().all(|numbered| is_missing(&numbered.estimate)));
    let served = estimates.last().unwrap().estimate.sequence;
    let channels = health.unwrap().channels;
    for (channel, counts) in channels.iter().enumerate() {
        assert!(counts.missing > 0, "channel {channel}: {counts:?}");
    }
    let counters = board.counters();
    assert!(counters.samples > served && counters.flagged == counters.samples, "{counters:?}");
    let lost = [
        counters.sequence_gaps,
        counters.time_faults,
        counters.idle_ticks,
        counters.dropped_samples,
        counters.dropped_estimates,
    ];
    assert_eq!(lost, [0; 5]);

    // Samples over the link are dropped meanwhile.
    board.send(&ToController::Sensor(SensorFrame::default(), link::track::SensorStatus::GOOD));
    // It is in the queue until the next tick.
    assert!((0..50).any(|_| board.counters().dropped_samples == 1));
    assert!(matches!(board.order(Command::Stop), Ok(Answer::Stopped(_))));
}

#[test]
fn it_samples_itself_only_when_configured() {
    let mut board = Board::start();
    assert_eq!(board.order(Command::SampleYourself), Err(Refusal::NotConfigured));
    assert!(board.estimates.is_empty());
}
