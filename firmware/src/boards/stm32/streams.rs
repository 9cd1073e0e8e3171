//! The three DMA streams of the samples, all circular and of one controller.
//!
//! Source: RM0090 section 10 and RM0433 section 15 (DMA), whose registers agree.

use super::super::microcontroller::bus;
use super::registers::Registers;

const LOW_FLAGS: usize = 0x00;
const LOW_CLEAR: usize = 0x08;
const HIGH_CLEAR: usize = 0x0C;
/// Flags of a stream: transfer complete, half, error, direct mode error, FIFO error.
const FLAGS: u32 = 0x3D;
/// Positions of the flags of streams 0 to 3, and of 4 to 7, in their registers.
const SHIFTS: [u32; 4] = [0, 6, 16, 22];
const COMPLETE: u32 = 1 << 5;

const ENABLE: u32 = 1;
const COMPLETE_INTERRUPT: u32 = 1 << 4;
const TO_PERIPHERAL: u32 = 1 << 6;
const CIRCULAR: u32 = 1 << 8;
const INCREMENT: u32 = 1 << 10;
/// Half words at both ends.
const HALF_WORDS: u32 = 1 << 11 | 1 << 13;
const VERY_HIGH: u32 = 3 << 16;

/// Polls until a stream has stopped, which takes a few cycles.
const POLLS: u32 = 1_000;

/// A stream by its number.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stream {
    /// Commands to the bus.
    Commands = 0,
    /// Answers from the bus.
    Answers = 3,
    /// Lengths and compare values to the timer.
    Slots = 6,
}

/// Ends of a stream.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    pub(super) peripheral: u32,
    pub(super) memory: u32,
    /// Number of half words.
    pub(super) length: usize,
}

/// The streams.
#[derive(Clone, Copy)]
pub(super) struct Streams(Registers);

impl Streams {
    /// Takes the streams. The clock of the controller must be enabled.
    pub(super) fn new() -> Self {
        #[expect(unsafe_code, reason = "the controller's other streams are left alone")]
        Self(unsafe { Registers::new(bus::dma()) })
    }

    /// Stops a stream and clears its flags. Returns false if it does not stop.
    pub(super) fn stop(self, stream: Stream) -> bool {
        let control = control(stream);
        self.0.write(control, 0);
        let has_stopped = (0..POLLS).any(|_| self.0.read(control) & ENABLE == 0);
        self.clear(stream);
        has_stopped
    }

    /// Clears the flags of a stream.
    fn clear(self, stream: Stream) {
        let number = stream as usize;
        let shift = SHIFTS.get(number % SHIFTS.len()).copied().unwrap_or_default();
        self.0.write(if number < SHIFTS.len() { LOW_CLEAR } else { HIGH_CLEAR }, FLAGS << shift);
    }

    /// Starts a stopped stream between its ends.
    pub(super) fn start(self, stream: Stream, ends: &Ends) {
        let direction = match stream {
            Stream::Answers => COMPLETE_INTERRUPT,
            Stream::Commands | Stream::Slots => TO_PERIPHERAL,
        };
        self.clear(stream);
        let control = control(stream);
        self.0.write(control.wrapping_add(4), ends.length as u32);
        self.0.write(control.wrapping_add(8), ends.peripheral);
        self.0.write(control.wrapping_add(12), ends.memory);
        let settings =
            bus::channel(stream as u32) | VERY_HIGH | HALF_WORDS | INCREMENT | CIRCULAR | direction;
        self.0.write(control, settings);
        self.0.write(control, settings | ENABLE);
    }

    /// Number of half words until the stream begins anew.
    pub(super) fn remaining(self, stream: Stream) -> usize {
        self.0.read(control(stream).wrapping_add(4)) as usize
    }

    /// Returns whether all answers have arrived since the last call.
    pub(super) fn take_complete(self) -> bool {
        let shift = SHIFTS.get(Stream::Answers as usize).copied().unwrap_or_default();
        let is_complete = self.0.read(LOW_FLAGS) >> shift & COMPLETE != 0;
        if is_complete {
            self.0.write(LOW_CLEAR, COMPLETE << shift);
        }
        is_complete
    }
}

/// Offset of a stream's control register.
const fn control(stream: Stream) -> usize {
    (stream as usize).wrapping_mul(0x18).wrapping_add(0x10)
}
