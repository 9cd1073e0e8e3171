//! A flooded serial port: ticks keep their time, estimates keep their bits, and lost bytes are
//! counted.
//!
//! The emulated port has room for one byte and makes the line wait, so that it loses none. Bytes
//! are lost while the link's loop is busy for longer than its buffer lasts. `controller` tests that
//! a full buffer loses and counts.

use crate::board::Board;
use crate::flood::garbage;
use crate::frames::{configuration, disturbed_frames};
use crate::update::package;
use controller::session::own_estimate_interval;
use controller::{Identity, NoTicks, Session};
use inference::BearingMaterial;
use link::track::SensorStatus;
use link::update::UpdateRequest;
use link::{
    Answer, BuildId, ClockSource, Command, Counters, MAX_FRAME, NumberedEstimate, Target, ToController,
    ToHost,
};

/// Sample period of the configuration, us.
const PERIOD_US: u32 = 100;
/// Number of estimates: 1.6 s of ticks.
const ESTIMATES: usize = 400;
/// Samples among garbage; the first disturbance is included.
const SAMPLES: u32 = 300;
/// Timer ticks of 200 instructions at 4 ns: the longest time for which the link's loop may lock out
/// a tick.
const HANDING_OVER: u32 = 134;
/// Frames for a busy link: eight times the size of its buffer.
const FRAMES: u32 = 4_000;

fn sampling() -> Board {
    let mut board = Board::configured(configuration(BearingMaterial::Babbitt));
    let every = own_estimate_interval(PERIOD_US);
    assert_eq!(board.order(Command::SampleYourself), Ok(Answer::Sampling { every }));
    board
}

/// Returns the longest time from the due time of a tick to the end of its frame, and checks that no
/// sample was left out. A dropped estimate has used its number.
fn longest(estimates: &[NumberedEstimate]) -> u32 {
    for pair in estimates.windows(2) {
        let [before, after] = pair else { unreachable!() };
        let samples = (after.number - before.number) * u32::from(own_estimate_interval(PERIOD_US));
        assert_eq!(after.estimate.sequence, before.estimate.sequence + samples);
        assert_eq!(after.estimate.time_us, before.estimate.time_us + samples * PERIOD_US);
    }
    estimates.iter().map(|numbered| numbered.estimate.instruction_ticks).max().unwrap()
}

fn nothing_dropped(counters: &Counters) {
    let dropped = [counters.sequence_gaps, counters.time_faults, counters.trips];
    assert_eq!(dropped, [0; 3], "{counters:?}");
}

#[test]
fn a_flood_of_garbage_delays_no_tick() {
    let mut quiet = sampling();
    let quiet: Vec<_> = (0..ESTIMATES).map(|_| quiet.estimate()).collect();
    let mut flooded = sampling();
    let mut sent = 0;
    let estimates: Vec<_> = (0..ESTIMATES as u32)
        .map(|index| {
            let garbage = garbage(index);
            sent += garbage.len();
            flooded.send_bytes(&garbage);
            flooded.estimate()
        })
        .collect();
    let (quiet, longest) = (longest(&quiet), longest(&estimates));
    println!(
        "{sent} bytes in {ESTIMATES} estimates' time; longest tick {longest} ticks, on a quiet line {quiet}"
    );
    assert!(longest <= quiet + HANDING_OVER, "{longest} ticks, on a quiet line {quiet}");
    let counters = flooded.counters();
    nothing_dropped(&counters);
    assert!(counters.bad_frames.total() > 0 && counters.dropped_estimates == 0, "{counters:?}");
}

#[test]
fn samples_among_garbage_are_estimated_as_on_the_host() {
    let configuration = configuration(BearingMaterial::Babbitt);
    let mut board = Board::configured(configuration);
    let build_id = BuildId::new("host");
    let mut session = Session::new(Identity {
        build_id,
        target: Target::Emulator,
        clock: ClockSource::Internal,
        core_hz: 168_000_000,
    });
    session.configure(&configuration).unwrap();
    for (frame, index) in disturbed_frames(&configuration, SAMPLES, 5).iter().zip(0..) {
        let message = ToController::Sensor(*frame, SensorStatus::GOOD);
        board.send_bytes(&garbage(index));
        board.send(&message);
        let ToHost::Estimate(expected) = session.handle(&message, &mut NoTicks) else { panic!() };
        let found = board.estimate();
        assert!(found.estimate.same_bits(&expected.estimate), "sample {index}: {found:?} {expected:?}");
        assert_eq!(found.number, expected.number);
    }
    let counters = board.counters();
    assert_eq!(counters.bad_frames.total(), SAMPLES);
    assert_eq!((counters.samples, counters.dropped_samples, counters.dropped_bytes), (SAMPLES, 0, 0));
}

#[test]
fn bytes_that_arrive_while_the_link_is_busy_are_read_later_or_counted_as_lost_and_the_ticks_continue() {
    let mut board = sampling();
    // Checking a signature takes the link's loop some 10 ms; the buffer holds 1,024 bytes.
    for version in 2..=5 {
        board.send(&ToController::Update(UpdateRequest::Begin(
            package(version, BearingMaterial::Babbitt).signed,
        )));
    }
    // The shortest possible frames.
    board.send_bytes(&[7_u8, 0].repeat(FRAMES as usize));
    let estimates: Vec<_> = (0..ESTIMATES).map(|_| board.estimate()).collect();
    longest(&estimates);
    let (counters, requests) = board.counters_of_full_line();
    // A busy loop does not send either; estimates without room are dropped.
    let [first, .., last] = &estimates[..] else { unreachable!() };
    assert_eq!(last.number - first.number + 1, estimates.len() as u32 + counters.dropped_estimates);
    nothing_dropped(&counters);
    let (lost, counted) = (FRAMES - counters.bad_frames.total(), counters.dropped_bytes);
    println!("{FRAMES} frames of 2 bytes, {lost} lost, {counted} bytes counted as dropped");
    // The number of lost bytes and gaps depends on the speed of the emulator's host. In any case a
    // lost byte costs at most one frame, and a lost frame at most two bytes.
    let lost_requests = (requests - 1) * MAX_FRAME as u32;
    assert!(lost <= counted && counted <= 2 * lost + lost_requests, "{lost} frames lost, {counters:?}");
}
