//! The image samples its own sensors on command, paced by its timer, and reports over its serial
//! port.
//!
//! The emulator's SPI port has no device and reads zeros. No channel may take that for a value:
//! every estimate reports missing sensors, and so do the counts by channel.

use crate::board::Board;
use crate::frames::configuration;
use controller::flags::SENSOR_MISSING;
use controller::session::{OWN_ESTIMATE_INTERVAL, OWN_SAMPLE_PERIOD_US};
use inference::{BearingMaterial, Flags};
use link::track::SensorHealth;
use link::{
    Answer, Command, EstimateFrame, Field, NumberedEstimate, Refusal, SensorFrame, SlowReport, ToController,
    ToHost,
};

fn is_missing(estimate: &EstimateFrame) -> bool {
    Flags::from_bits(estimate.flags).contains(SENSOR_MISSING)
}

#[test]
fn without_sensors_on_its_bus_it_estimates_on_time_and_reports_every_channel_as_missing() {
    let mut board = Board::configured(configuration(BearingMaterial::Babbitt));
    assert_eq!(board.order(Command::SampleYourself), Ok(Answer::Sampling { every: OWN_ESTIMATE_INTERVAL }));
    let mut health: Option<SensorHealth> = None;
    let mut estimates = std::mem::take(&mut board.estimates);
    while estimates.len() < 500 || health.is_none() {
        match board.next() {
            ToHost::Estimate(estimate) => estimates.push(estimate),
            ToHost::Slow(slow) => {
                if let SlowReport::Sensors(report) = slow.report {
                    health = Some(report);
                }
            }
            other => panic!("{other:?}"),
        }
    }
    let period = u32::from(OWN_ESTIMATE_INTERVAL);
    for pair in estimates.windows(2) {
        let [NumberedEstimate { number, estimate, .. }, next] = pair else { unreachable!() };
        assert_eq!(next.number, number + 1, "one number a sent estimate");
        assert_eq!(next.estimate.sequence, estimate.sequence + period);
        assert_eq!(next.estimate.time_us, estimate.time_us + period * OWN_SAMPLE_PERIOD_US);
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
fn it_samples_itself_only_when_configured_for_its_own_period() {
    let mut board = Board::start();
    assert_eq!(board.order(Command::SampleYourself), Err(Refusal::NotConfigured));
    let mut slow = configuration(BearingMaterial::Babbitt);
    slow.bench.sample_period_us = 200;
    assert!(matches!(board.order(Command::Configure(slow)), Ok(Answer::Configured(_))));
    match board.order(Command::SampleYourself) {
        Err(Refusal::Configuration(reasons)) => {
            assert_eq!(reasons.iter().map(|reason| reason.field).collect::<Vec<_>>(), [Field::SamplePeriod]);
        }
        other => panic!("{other:?}"),
    }
    assert!(board.estimates.is_empty());
}
