//! The sequence on a model of the hardware that runs it: the timer with its preload registers and
//! outputs, the transfers by DMA, the shift register of the bus and both devices, from their
//! manuals and data sheets.

use crate::script::answer;
use controller::sensors::{Answers, Device, MAX_WORDS, Schedule, Sequence, Slot, SlotTiming};
use proptest::prelude::*;

/// Something that happens on the bus.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    Select(Device),
    /// First and last bit of a word.
    Word(u16, f64),
    Release(Device),
}

/// Frequencies of the slots' timer and of the bus, Hz.
#[derive(Clone, Copy, Debug)]
struct Clocks {
    timer_hz: u32,
    bus_hz: u32,
}

impl Clocks {
    fn timing(self) -> SlotTiming {
        SlotTiming::new(self.timer_hz, self.bus_hz).unwrap()
    }

    /// The slots of a period in us.
    fn schedule(self, sequence: &Sequence, period_us: u32) -> Schedule {
        let period_ticks = self.timer_hz / 1_000_000 * period_us;
        sequence.schedule(&self.timing(), period_ticks).unwrap()
    }
}

/// Timer with compare values that become active with the next slot, and its two selects.
struct Timer {
    active: Slot,
    preload: Slot,
    /// Start of the slot, ticks.
    start: u64,
    /// Selected until now.
    selected: [bool; 2],
}

impl Timer {
    /// Runs the slot that has begun; `word` is the next one for the bus. Returns true if it was
    /// sent.
    fn slot(&mut self, clocks: Clocks, word: u16, events: &mut Vec<(f64, Event)>) {
        let tick = 1e9 / f64::from(clocks.timer_hz);
        let at = |ticks: u64| (self.start + ticks) as f64 * tick;
        let slot = self.active;
        let selects = [(Device::Converter, slot.converter), (Device::Encoder, slot.encoder)];
        // The output is active while the counter is below the compare value.
        for (selected, (device, until)) in self.selected.iter_mut().zip(selects) {
            match (*selected, until > 0) {
                (false, true) => events.push((at(0), Event::Select(device))),
                (true, false) => events.push((at(0), Event::Release(device))),
                _ => {}
            }
            *selected = until > 0;
        }
        // The compare event of a value beyond the end comes at the end. The port starts within two
        // of its clocks.
        let start = at(slot.command.min(slot.length).into()) + 1e9 / f64::from(clocks.bus_hz);
        events.push((start, Event::Word(word, start + 16.0 * 1e9 / f64::from(clocks.bus_hz))));
        for (selected, (device, until)) in self.selected.iter_mut().zip(selects) {
            if *selected && until < slot.length {
                events.push((at(until.into()), Event::Release(device)));
                *selected = false;
            }
        }
        self.start += u64::from(slot.length);
    }
}

/// Runs a schedule for some periods, as timer and DMA do. Returns the events with their times in
/// ns.
fn run(schedule: &Schedule, clocks: Clocks, periods: usize) -> Vec<(f64, Event)> {
    let [first, second, ..] = *schedule.slots() else { panic!("two slots or more") };
    let mut table = schedule.ahead().cycle();
    let mut words = schedule.commands().iter().cycle();
    let mut timer = Timer { active: first, preload: second, start: 0, selected: [false; 2] };
    let mut events = vec![];
    for _ in 0..periods * schedule.slots().len() {
        timer.slot(clocks, *words.next().unwrap(), &mut events);
        timer.active = timer.preload;
        timer.preload = *table.next().unwrap();
    }
    events
}

/// Frames that the devices see: device, time of its select, words, time of its release. Panics if a
/// time of a data sheet is not kept or a word reaches no device or both.
fn frames(events: &[(f64, Event)]) -> Vec<(Device, f64, Vec<u16>, f64)> {
    let (mut found, mut open, mut released, mut last_word) = (vec![], None, -1e9, -1e9);
    for (at, event) in events {
        match *event {
            Event::Select(device) => {
                assert!(open.is_none() && at - released >= 350.0, "{device:?} selected at {at}");
                open = Some((device, *at, vec![]));
            }
            Event::Word(word, end) => {
                assert!(*at > last_word, "a word at {at}");
                if let Some((_, selected, words)) = &mut open {
                    assert!(at - *selected >= 350.0, "a word at {at}");
                    words.push(word);
                } else {
                    assert_eq!(word, 0, "no device is selected for the words of the rest");
                }
                last_word = end;
            }
            Event::Release(device) => {
                let (selected_device, selected, words) = open.take().expect("a release of nothing");
                assert!(device == selected_device && at - last_word >= 350.0, "{device:?} at {at}");
                found.push((device, selected, words, *at));
                released = *at;
            }
        }
    }
    assert!(open.is_none(), "every device is released in the end");
    found
}

/// ADS8688: the input that it converts at the next select, and the codes of its inputs.
struct Converter {
    next: usize,
    codes: [u16; 8],
}

impl Converter {
    /// Answers a frame.
    fn frame(&mut self, words: &[u16]) -> Vec<u16> {
        let [command, _] = words else { panic!("a conversion has 32 clocks: {words:?}") };
        assert_eq!(command & 0xe3ff, 0xc000, "MAN_Ch_n");
        let code = self.codes[self.next];
        self.next = usize::from(command >> 10 & 7);
        vec![0, code]
    }
}

/// AS5047P: the answer to the last request, and the registers.
struct Encoder {
    pending: u16,
    angle: u16,
    is_flagged: bool,
}

impl Encoder {
    fn frame(&mut self, words: &[u16]) -> Vec<u16> {
        let [command] = words else { panic!("a frame has 16 clocks: {words:?}") };
        assert!(command.count_ones().is_multiple_of(2) && command & 0x4000 != 0, "a read with parity");
        let sent = self.pending;
        let data = match command & 0x3fff {
            0x3fff => self.angle,
            0x3ffc => 0x0180,
            0x0001 => u16::from(std::mem::take(&mut self.is_flagged)),
            other => panic!("register {other:#x}"),
        };
        let flag = if self.is_flagged { 0x4000 } else { 0 };
        self.pending = answer(data | flag);
        vec![sent]
    }
}

/// Runs a sample on both devices. Returns the answers as DMA stores them.
fn sample(sequence: &Sequence, clocks: Clocks, converter: &mut Converter, encoder: &mut Encoder) -> Answers {
    let mut received = vec![];
    for (device, _, words, _) in frames(&run(&clocks.schedule(sequence, 300), clocks, 1)) {
        received.extend(match device {
            Device::Converter => converter.frame(&words),
            Device::Encoder => encoder.frame(&words),
        });
    }
    received.resize(MAX_WORDS, 0xdead);
    received.try_into().unwrap()
}

/// Clocks of the boards: STM32F405 with the PLL, STM32H743 at 480 and 400 MHz.
const BOARDS: [Clocks; 3] = [
    Clocks { timer_hz: 84_000_000, bus_hz: 5_250_000 },
    Clocks { timer_hz: 120_000_000, bus_hz: 8_000_000 },
    Clocks { timer_hz: 100_000_000, bus_hz: 8_000_000 },
];

proptest! {
    #[test]
    fn every_input_and_the_angle_of_the_same_sample_arrive_in_their_places(
        inputs in prop::sample::subsequence((0_u8..8).collect::<Vec<_>>(), 3..=5).prop_shuffle(),
        samples in prop::collection::vec((any::<[u16; 8]>(), 0_u16..0x4000), 1..5),
        board in 0..BOARDS.len(),
    ) {
        let sequence = Sequence::new(&inputs, true);
        let mut converter = Converter { next: inputs[0].into(), codes: [0; 8] };
        let mut encoder = Encoder { pending: 0xffff, angle: 0, is_flagged: true };
        for (codes, angle) in samples {
            (converter.codes, encoder.angle) = (codes, angle);
            let answers = sample(&sequence, BOARDS[board], &mut converter, &mut encoder);
            for (place, input) in inputs.iter().enumerate() {
                let words = &answers[1 + 2 * place..][..2];
                prop_assert_eq!(words, [0, codes[usize::from(*input)]]);
            }
            let [found, diagnostics] = [1, 2].map(|place| answers[2 * inputs.len() + place]);
            prop_assert_eq!(found & 0x3fff, angle);
            prop_assert_eq!(diagnostics & 0x3fff, 0x0180);
        }
        prop_assert!(!encoder.is_flagged, "the error register is read in each sample");
    }

    #[test]
    fn the_times_of_the_data_sheets_are_kept_in_every_period_at_every_clock(
        timer_mhz in 40_u32..=120, bus_hz in 1_000_000_u32..=10_000_000, period_us in 300_u32..10_000,
    ) {
        let clocks = Clocks { timer_hz: timer_mhz * 1_000_000, bus_hz };
        let schedule = clocks.schedule(&Sequence::new(&[0, 1, 2, 3, 4], true), period_us);
        prop_assert_eq!(schedule.commands().len(), schedule.rest() + MAX_WORDS);
        let frames = frames(&run(&schedule, clocks, 3));
        prop_assert_eq!(frames.len(), 3 * 8);
        // Every period is the first one, a period later.
        for (before, after) in frames.iter().zip(&frames[8..]) {
            prop_assert_eq!((&before.0, &before.2), (&after.0, &after.2));
            prop_assert!((after.1 - before.1 - f64::from(period_us) * 1e3).abs() < 1e-3);
        }
    }
}

#[test]
fn the_second_probe_is_sampled_at_the_stated_interval_and_the_angle_just_before_the_first() {
    for (clocks, expected_ns) in BOARDS.into_iter().zip([9_309, 6_916, 6_920]) {
        let schedule = clocks.schedule(&Sequence::new(&[0, 1, 2], true), 300);
        let frames = frames(&run(&schedule, clocks, 1));
        let [(_, _, _, angle), (_, first, ..), (_, second, ..), ..] = frames[..] else { panic!() };
        let interval_ns = clocks.timing().input_interval_ns(clocks.timer_hz);
        // The figures of docs/firmware.md: 9.3 us on the STM32F405, and slots of half of that.
        assert_eq!(interval_ns, expected_ns);
        let interval = f64::from(interval_ns);
        assert!((second - first - interval).abs() <= 1.0, "{} {interval}", second - first);
        assert!((0.0..500.0).contains(&(first - angle)), "the encoder samples when it is released");
    }
}

#[test]
fn a_period_that_is_too_short_or_too_long_has_no_schedule() {
    let [clocks, ..] = BOARDS;
    let (sequence, timing) = (Sequence::new(&[0, 1, 2], true), clocks.timing());
    let words = u32::from(timing.length) * 9;
    let shortest = sequence.shortest_period(&timing);
    assert_eq!(shortest, words + u32::from(timing.length));
    assert_eq!(sequence.schedule(&timing, shortest - 1), None);
    assert!(sequence.schedule(&timing, shortest).is_some());
    assert_eq!(sequence.schedule(&timing, u32::MAX), None);
}

#[test]
fn a_sample_without_an_encoder_has_words_of_the_converter_only() {
    let sequence = Sequence::new(&[3, 5], false);
    assert!(sequence.words().iter().all(|word| word.device == Device::Converter));
    assert_eq!(sequence.words().len(), 4);
}

#[test]
fn a_bus_that_is_too_slow_or_too_fast_for_the_timer_has_no_timing() {
    assert_eq!(SlotTiming::new(240_000_000, 50_000), None);
    assert_eq!(SlotTiming::new(8_000_000, 8_000_000), None);
    assert_eq!(SlotTiming::new(32_000_000, 9_600_001), None);
    assert_eq!(SlotTiming::new(240_000_000, 0), None);
}
