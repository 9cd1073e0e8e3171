//! Samples that hardware takes: a timer, three DMA streams and the sensor bus.
//!
//! [`Acquisition`] starts and stops them, in the tick. [`Collector`] takes the answers in an
//! interrupt of the highest priority, stamps them and starts the tick.

use core::sync::atomic::{AtomicU16, AtomicU32, AtomicUsize, Ordering};

use controller::sensors::{
    Collected, Completion, MAX_SLOTS, MAX_WORDS, Schedule, SensorBus, Sequence, SlotTiming,
};
use controller::session::IDLE_PERIOD_US;
use cortex_m::peripheral::DWT;

use super::super::microcontroller::bus;
use super::slot_timer::{BURST_LENGTH, SlotTimer, TimeBase, burst};
use super::spi::Converter;
use super::streams::{Ends, Stream, Streams};

/// Polls for the end of the first sequence: some 10 ms.
const POLLS: u32 = 100_000;

/// Length of the table of slots.
const TABLE: usize = MAX_SLOTS * BURST_LENGTH;

/// Memory that DMA reads and writes.
#[cfg_attr(
    feature = "stm32h743",
    expect(unsafe_code, reason = "the section of the memory that DMA can reach"),
    unsafe(link_section = ".dma.samples")
)]
static BUFFERS: Buffers = Buffers {
    slots: [const { AtomicU16::new(0) }; TABLE],
    commands: [const { AtomicU16::new(0) }; MAX_SLOTS],
    answers: [const { AtomicU16::new(0) }; MAX_SLOTS],
};
/// Number of the run; it rises whenever the hardware stops.
static RUN: AtomicU32 = AtomicU32::new(0);
/// Number of slots of a period in this run, and of the rest before its words.
static SLOTS: [AtomicUsize; 2] = [const { AtomicUsize::new(0) }; 2];

struct Buffers {
    slots: [AtomicU16; TABLE],
    commands: [AtomicU16; MAX_SLOTS],
    answers: [AtomicU16; MAX_SLOTS],
}

/// The hardware as the tick uses it.
pub struct Acquisition {
    timer: SlotTimer,
    streams: Streams,
    timing: Option<SlotTiming>,
    /// Frequency of the slots' timer, MHz.
    slot_mhz: u32,
    is_running: bool,
}

/// The hardware as the interrupt of a complete sample uses it.
pub struct Collector {
    base: TimeBase,
    streams: Streams,
}

impl Acquisition {
    /// Sets up the hardware for the clocks of timers (MHz) and bus (Hz). The clocks of timers, bus,
    /// DMA and buffers must be enabled; the pins are connected afterwards.
    pub(in crate::boards) fn start(timer_mhz: u32, bus_hz: u32) -> (Self, Collector) {
        // Start-up leaves memory for DMA alone.
        for word in BUFFERS.slots.iter().chain(&BUFFERS.commands).chain(&BUFFERS.answers) {
            word.store(0, Ordering::Relaxed);
        }
        let slot_mhz = (timer_mhz / bus::SLOT_DIVIDER).max(1);
        let timing = SlotTiming::new(slot_mhz.saturating_mul(1_000_000), bus_hz);
        let (streams, (timer, base)) = (Streams::new(), SlotTimer::start(timer_mhz));
        (Self { timer, streams, timing, slot_mhz, is_running: false }, Collector { base, streams })
    }

    /// Time between the samples of two successive inputs, ns.
    #[must_use]
    pub fn input_interval_ns(&self) -> u32 {
        self.timing.map_or(0, |timing| timing.input_interval_ns(self.slot_mhz.saturating_mul(1_000_000)))
    }

    /// Runs a sequence and waits for its end, with a timeout. Returns false without one, or if the
    /// clocks are too slow for the longest sequence: then the hardware paces nothing and is
    /// stopped.
    #[must_use]
    pub(in crate::boards) fn try_out(&mut self) -> bool {
        let longest = Sequence::new(&[0, 1, 2, 3, 4], true);
        let fits = self.timing.is_some_and(|timing| {
            longest.shortest_period(&timing) <= self.slot_mhz.saturating_mul(IDLE_PERIOD_US)
        });
        self.run(&longest, IDLE_PERIOD_US);
        let is_complete = fits && (0..POLLS).any(|_| self.streams.take_complete());
        if !is_complete {
            self.stop();
        }
        is_complete
    }

    fn stop(&mut self) {
        if !core::mem::take(&mut self.is_running) {
            return;
        }
        let Self { timer, streams, .. } = self;
        timer.stop(|| streams.remaining(Stream::Slots));
        // Before the streams: no word that waits may become the first answer of the next run.
        bus::disable();
        for stream in [Stream::Commands, Stream::Answers, Stream::Slots] {
            let _ = streams.stop(stream);
        }
        // Last: a sample that has just been collected is one of the run before.
        RUN.fetch_add(1, Ordering::Relaxed);
    }

    /// Fills the buffers and starts everything, the timer last.
    fn start_schedule(&mut self, schedule: &Schedule) {
        let [first, second, ..] = schedule.slots() else { return };
        for (entries, slot) in BUFFERS.slots.chunks(BURST_LENGTH).zip(schedule.ahead()) {
            entries.iter().zip(burst(slot)).for_each(|(entry, value)| entry.store(value, Ordering::Relaxed));
        }
        for (entry, command) in BUFFERS.commands.iter().zip(schedule.commands()) {
            entry.store(*command, Ordering::Relaxed);
        }
        let slots = schedule.slots().len();
        let [all, rest] = &SLOTS;
        all.store(slots, Ordering::Relaxed);
        rest.store(schedule.rest(), Ordering::Relaxed);
        // A stream reads its first item when it starts.
        cortex_m::asm::dsb();
        let streams = [
            (Stream::Answers, bus::data_in(), BUFFERS.answers.as_ptr(), slots),
            (Stream::Commands, bus::data_out(), BUFFERS.commands.as_ptr(), slots),
            (
                Stream::Slots,
                self.timer.burst_address(),
                BUFFERS.slots.as_ptr(),
                slots.wrapping_mul(BURST_LENGTH),
            ),
        ];
        for (stream, peripheral, memory, length) in streams {
            self.streams.start(stream, &Ends { peripheral, memory: memory as u32, length });
        }
        bus::enable_words();
        self.is_running = true;
        self.timer.run(first, second);
    }
}

impl SensorBus for Acquisition {
    type Converter<'a> = Converter<'a>;

    fn converter(&mut self) -> Converter<'_> {
        self.stop();
        Converter::new(&self.timer)
    }

    fn run(&mut self, sequence: &Sequence, period_us: u32) -> u32 {
        self.stop();
        let schedule = self.timing.and_then(|timing| {
            let period = self.slot_mhz.saturating_mul(period_us);
            sequence.schedule(&timing, period.max(sequence.shortest_period(&timing)))
        });
        if let Some(schedule) = schedule {
            self.start_schedule(&schedule);
        }
        RUN.load(Ordering::Relaxed)
    }
}

impl Collector {
    /// Reads the counters.
    #[must_use]
    pub fn now(&self) -> Completion {
        Completion { time_us: self.base.time_us(), cycles: DWT::cycle_count() }
    }

    /// Takes the answers of a complete sample. `None` if there is none.
    pub fn collect(&mut self) -> Option<Collected> {
        let completion = self.now();
        if !self.streams.take_complete() {
            return None;
        }
        // The streams have written what is read now.
        cortex_m::asm::dsb();
        let [all, rest] = &SLOTS;
        let (all, rest) = (all.load(Ordering::Relaxed), rest.load(Ordering::Relaxed));
        let mut answers = [0; MAX_WORDS];
        for (answer, word) in answers.iter_mut().zip(BUFFERS.answers.get(rest..all).unwrap_or_default()) {
            *answer = word.load(Ordering::Relaxed);
        }
        // The next period begins with the words of the rest, which lie before these.
        let is_complete = self.streams.remaining(Stream::Answers) >= all.saturating_sub(rest);
        let run = RUN.load(Ordering::Relaxed);
        Some(Collected { run, answers: is_complete.then_some(answers), completion })
    }
}
