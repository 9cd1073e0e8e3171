//! A flooded serial port: ticks begin and end as on a quiet line, estimates are the same to the bit, what finds no room is counted.
//!
//! The emulated port has a byte of room and makes the line wait for it, so nothing is lost in the port itself: bytes are lost where the link's
//! loop is busy for longer than its buffer lasts. That a full buffer loses and counts is tested in `firmware::boards::ring` as well.

use crate::board::Board;
use crate::flood::garbage;
use crate::frames::{configuration, troubled};
use crate::update::package;
use firmware::session::{OWN_EVERY, OWN_PERIOD_US};
use firmware::{Identity, NoTicks, Session};
use inference::Bearing;
use link::track::SensorStatus;
use link::update::UpdateRequest;
use link::{Answer, BuildId, ClockSource, Command, Counters, NumberedEstimate, Target, ToController, ToHost};

/// Estimates looked at: 0.8 s of ticks.
const ESTIMATES: usize = 400;
/// Samples sent among garbage: beyond the first trouble.
const SAMPLES: u32 = 300;
/// Timer ticks of 200 instructions at 4 ns each: what the link's loop may shut a tick out for while it hands something over.
const HANDING_OVER: u32 = 134;
/// Frames sent to a busy link: eight times what its buffer holds.
const FRAMES: u32 = 4_000;

fn sampling() -> Board {
    let mut board = Board::configured(configuration(Bearing::Babbitt));
    assert_eq!(board.order(Command::SampleYourself), Ok(Answer::Sampling { every: OWN_EVERY }));
    board
}

/// The longest that a tick took from when it was due to the end of its frame, after checking that no sample was left out: an estimate that was
/// dropped on its way has had its number.
fn longest(estimates: &[NumberedEstimate]) -> u32 {
    for pair in estimates.windows(2) {
        let [before, after] = pair else { unreachable!() };
        let samples = (after.number - before.number) * u32::from(OWN_EVERY);
        assert_eq!(after.estimate.sequence, before.estimate.sequence + samples);
        assert_eq!(after.estimate.time_us, before.estimate.time_us + samples * OWN_PERIOD_US);
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
    let configuration = configuration(Bearing::Babbitt);
    let mut board = Board::configured(configuration);
    let build_id = BuildId::new("host");
    let mut session = Session::new(Identity {
        build_id,
        target: Target::Emulator,
        clock: ClockSource::Internal,
        core_hz: 168_000_000,
    });
    session.configure(&configuration).unwrap();
    for (frame, index) in troubled(&configuration, SAMPLES, 5).iter().zip(0..) {
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
fn bytes_that_come_while_the_link_is_busy_are_read_later_or_counted_as_lost_and_the_ticks_go_on() {
    let mut board = sampling();
    // The check of a signature takes the link's loop some 10 ms; the buffer holds 1,024 bytes.
    for version in 2..=5 {
        board.send(&ToController::Update(UpdateRequest::Begin(package(version, Bearing::Babbitt).signed)));
    }
    // The shortest frames there are.
    board.send_bytes(&[7_u8, 0].repeat(FRAMES as usize));
    let estimates: Vec<_> = (0..ESTIMATES).map(|_| board.estimate()).collect();
    longest(&estimates);
    let counters = board.counters();
    // Nor does the loop send while it is busy; of more estimates than there is room for it drops some.
    let [first, .., last] = &estimates[..] else { unreachable!() };
    assert_eq!(last.number - first.number + 1, estimates.len() as u32 + counters.dropped_estimates);
    nothing_dropped(&counters);
    let (lost, counted) = (FRAMES - counters.bad_frames.total(), counters.dropped_bytes);
    println!("{FRAMES} frames of 2 bytes, {lost} lost, {counted} bytes counted as dropped");
    // How many are lost, and in how many gaps, hangs on how fast the emulator's host brings them. In whatever gaps: a lost byte costs one frame at most,
    // and a lost frame two bytes at most.
    assert!(lost <= counted && counted <= 2 * lost, "{lost} frames lost, {counters:?}");
}
