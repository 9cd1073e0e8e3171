//! Garbage on the link changes neither the estimates nor the cost of a tick.

use crate::frames::{configuration, disturbed_frames};
use controller::emulator::TICKS_PER_INSTRUCTION;
use host_sim::controller::{Controller, EmulatedController};
use inference::BearingMaterial;
use link::{BadFrames, Counters, Decoder, EstimateFrame, Fault, ToController, ToHost};

/// Number of samples.
const SAMPLES: u32 = 2_000;

/// Returns bytes that end as one refused frame: any but zeros, up to twice the length of a frame,
/// then the delimiter.
pub(crate) fn garbage(index: u32) -> Vec<u8> {
    let mut state = index.wrapping_mul(0x9E37_79B9) | 1;
    let mut byte = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state >> 8) as u8
    };
    let length = 1 + usize::from(byte()) * 2;
    let mut bytes: Vec<u8> = (0..length).map(|_| byte().max(1)).collect();
    bytes.push(0);
    bytes
}

/// Returns the instructions of a tick. The timer's count depends by one on the phase of SysTick.
fn instructions(estimate: &EstimateFrame) -> f64 {
    (f64::from(estimate.instruction_ticks) / TICKS_PER_INSTRUCTION).round()
}

#[test]
fn garbage_between_the_frames_changes_neither_estimates_nor_the_instructions_of_a_tick() {
    let configuration = configuration(BearingMaterial::Babbitt);
    let frames = disturbed_frames(&configuration, SAMPLES, 21);
    let elf = EmulatedController::default_elf();
    let mut quiet = EmulatedController::start(configuration, &elf).unwrap();
    let mut flooded = EmulatedController::start(configuration, &elf).unwrap();
    let mut decoder = Decoder::new();
    let mut sent = 0;
    for (frame, index) in frames.iter().zip(0..) {
        let garbage = garbage(index);
        sent += garbage.len();
        let expected: Vec<_> =
            garbage.iter().filter_map(|&byte| decoder.push::<ToController>(byte)).collect();
        let answer = flooded.disturb(&garbage).unwrap();
        let [Err(error)] = expected[..] else { panic!("{expected:?}") };
        assert_eq!(answer, ToHost::Fault(Fault::BadFrame(error)));
        let (quiet, flooded) = (quiet.exchange(frame).unwrap(), flooded.exchange(frame).unwrap());
        assert!(flooded.same_bits(&quiet), "sample {index}");
        assert_eq!(instructions(&flooded), instructions(&quiet), "sample {index}");
    }
    println!("{sent} bytes of garbage between {SAMPLES} samples");
    let counters = Box::new(flooded).finish().unwrap();
    assert_eq!(counters.bad_frames, decoder.bad_frames());
    assert_eq!(counters.bad_frames.total(), SAMPLES);
    let without = Counters { bad_frames: BadFrames::default(), ..counters };
    assert_eq!(without, Box::new(quiet).finish().unwrap());
}
