//! Sequence of words that hardware exchanges with the sensors at each tick of the sample timer.
//!
//! The core takes no part. One timer divides the sample period into slots of one word of 16 bits.
//! Its outputs are the selects of the devices, so the instants at which these sample are those of
//! the timer, to a cycle. They never wait for an interrupt, a lock or a bus.
//!
//! | event in a slot | effect |
//! |---|---|
//! | start | a device may be selected; DMA loads length and compare values of the next slot |
//! | command | DMA writes a word to the bus |
//! | release | the device may be released |
//!
//! A period begins with the rest that the words leave. The rest has slots, too, whose words no
//! device is selected for: a timer requests a word in every slot, also if its compare value lies
//! beyond the end. After a restart the first sample so takes a whole period. A frame of the
//! converter takes two slots, one of the encoder one.
//!
//! Sources: AS5047P v1-11 (350 ns from select to clock and between two selects), SBAS582C (at most
//! 850 ns from select to result, which 16 clocks at 17 MHz take), RM0090 section 18.4.5 (compare
//! flag of a value beyond the length).

use heapless::Vec;

use super::absolute::COMMANDS;
use super::converter::frame_of;
use super::sampler::MAX_INPUTS;

/// Maximum number of words of a sample: two for each input, and three of the encoder.
pub const MAX_WORDS: usize = 2 * MAX_INPUTS + COMMANDS.len();

/// Maximum number of slots that fill the rest of a period.
const MAX_REST: usize = 20;
/// Maximum number of slots of a period.
pub const MAX_SLOTS: usize = MAX_WORDS + MAX_REST;

/// Times from a select to the first clock, from the last clock to the release, and from there to
/// the next select, ns.
const PAUSE_NS: u32 = 400;
/// Bits of a word.
const BITS: u32 = 16;
/// Clocks of the bus that may pass before the first bit.
const START_CLOCKS: u32 = 2;
/// Longest slot, in ticks of the timer. It has 16 bits, and [`BEYOND`] must be longer.
const MAX_LENGTH: u32 = 60_000;
/// Shortest slot, in ticks: the registers of the next one are loaded in it.
const MIN_LENGTH: u32 = 100;
/// Time until which a device is selected beyond the end of a slot.
const BEYOND: u16 = u16::MAX;

/// Words that arrived in the slots of a sample.
pub type Answers = [u16; MAX_WORDS];

/// A device on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Device {
    /// Converter of probes and load.
    Converter,
    /// Absolute encoder.
    Encoder,
}

/// One word of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Device that is selected.
    pub device: Device,
    /// Word to the device.
    pub command: u16,
    /// True if the device is selected before the word.
    pub begins: bool,
    /// True if the device is released after the word.
    pub ends: bool,
}

/// The words of a sample.
///
/// The encoder's first frame comes first. It samples the angle at the end of that frame, which is
/// just before the first probe is sampled.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sequence(Vec<Word, MAX_WORDS>);

/// Values of the timer in one slot, in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Length.
    pub length: u16,
    /// Time of the command, the same in every slot.
    pub command: u16,
    /// Time until which the converter is selected: 0 if it is not, beyond the length if it stays
    /// so.
    pub converter: u16,
    /// Time until which the encoder is selected.
    pub encoder: u16,
}

/// The slots of a sample period, each with the word of its command. Those of the rest come first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Schedule {
    slots: Vec<Slot, MAX_SLOTS>,
    commands: Vec<u16, MAX_SLOTS>,
    rest: usize,
}

impl Schedule {
    /// Returns the slots in their order.
    #[must_use]
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// Returns the words in the order of the slots.
    #[must_use]
    pub fn commands(&self) -> &[u16] {
        &self.commands
    }

    /// Returns the number of slots of the rest.
    #[must_use]
    pub const fn rest(&self) -> usize {
        self.rest
    }

    /// Returns the slots in the order in which DMA loads them: the timer starts in the first with
    /// the second in its preload registers, and loads the third when the second begins.
    pub fn ahead(&self) -> impl Iterator<Item = &Slot> + Clone {
        self.slots.iter().cycle().skip(2).take(self.slots.len())
    }

    fn push(&mut self, slot: Slot, command: u16) -> Option<()> {
        self.slots.push(slot).ok()?;
        self.commands.push(command).ok()
    }
}

impl Sequence {
    /// Creates the sequence of a ring of inputs. Each frame of the converter selects the input of
    /// the next one. Inputs beyond [`MAX_INPUTS`] are left out.
    #[must_use]
    pub fn new(inputs: &[u8], has_encoder: bool) -> Self {
        let mut words = Vec::new();
        let [angle, diagnostics, errors] = COMMANDS.map(|command| {
            let word = Word { device: Device::Encoder, command, begins: true, ends: true };
            has_encoder.then_some(word)
        });
        let inputs = inputs.get(..MAX_INPUTS).unwrap_or(inputs);
        let next = inputs.iter().skip(1).chain(inputs.first());
        let conversions = next.flat_map(|&input| {
            let [command, rest] = frame_of(input);
            let word = Word { device: Device::Converter, command, begins: true, ends: false };
            [word, Word { command: rest, begins: false, ends: true, ..word }]
        });
        let all = angle.into_iter().chain(conversions).chain(diagnostics).chain(errors);
        for word in all {
            // All fit: the inputs are limited.
            let _ = words.push(word);
        }
        Self(words)
    }

    /// Returns the words in their order.
    #[must_use]
    pub fn words(&self) -> &[Word] {
        &self.0
    }

    /// Returns the shortest period of the sequence, in ticks of the timer.
    #[must_use]
    pub fn shortest_period(&self, timing: &SlotTiming) -> u32 {
        // At most 14 times 2^16.
        u32::from(timing.length).saturating_mul((self.0.len() as u32).saturating_add(1))
    }

    /// Returns the slots of a period, in ticks of the timer. `None` if the period is shorter than
    /// [`Self::shortest_period`] or longer than [`MAX_REST`] slots can fill.
    #[must_use]
    pub fn schedule(&self, timing: &SlotTiming, period_ticks: u32) -> Option<Schedule> {
        let SlotTiming { command, release, length } = *timing;
        let words = self.shortest_period(timing).checked_sub(length.into())?;
        let mut rest = period_ticks.checked_sub(words).filter(|&rest| rest >= u32::from(length))?;
        let mut schedule = Schedule::default();
        for remaining in (1..=rest.div_ceil(MAX_LENGTH)).rev() {
            let part = rest.checked_div(remaining)?;
            rest = rest.checked_sub(part)?;
            let length = u16::try_from(part).ok()?;
            schedule.push(Slot { length, command, converter: 0, encoder: 0 }, 0)?;
        }
        schedule.rest = schedule.slots.len();
        for word in &self.0 {
            let until = if word.ends { release } else { BEYOND };
            let (converter, encoder) = match word.device {
                Device::Converter => (until, 0),
                Device::Encoder => (0, until),
            };
            schedule.push(Slot { length, command, converter, encoder }, word.command)?;
        }
        Some(schedule)
    }
}

/// Answers of the encoder in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderAnswers {
    /// Answer to the request of the angle.
    pub angle: u16,
    /// Answer to the request of the diagnostics.
    pub diagnostics: u16,
}

impl EncoderAnswers {
    /// Takes the answers out of those of a sample with a number of inputs.
    #[must_use]
    pub(super) fn of(answers: &Answers, inputs: usize) -> Option<Self> {
        // An answer arrives with the frame after its request.
        let first = inputs.checked_mul(2)?.checked_add(1)?;
        let [angle, diagnostics] = *answers.get(first..)?.first_chunk()?;
        Some(Self { angle, diagnostics })
    }
}

/// Takes the words of a conversion out of the answers of a sample.
pub(super) fn conversion(answers: &Answers, number: usize, has_encoder: bool) -> Option<[u16; 2]> {
    let first = number.checked_mul(2)?.checked_add(usize::from(has_encoder))?;
    answers.get(first..)?.first_chunk().copied()
}

/// Times of the events in a slot with a word, in ticks of the timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlotTiming {
    /// Command.
    pub command: u16,
    /// Release.
    pub release: u16,
    /// Length of the slot.
    pub length: u16,
}

impl SlotTiming {
    /// Derives the times from the frequencies of the timer and of the bus, Hz. Returns `None` if a
    /// slot is shorter or longer than the timer's registers allow, or the bus has no clock.
    #[must_use]
    pub fn new(timer_hz: u32, bus_hz: u32) -> Option<Self> {
        let pause = ticks(timer_hz, PAUSE_NS)?;
        let word = u64::from(BITS + START_CLOCKS).checked_mul(timer_hz.into())?;
        let word = u32::try_from(word.checked_add(u64::from(bus_hz))?.checked_div(bus_hz.into())?).ok()?;
        let release = pause.checked_add(word)?.checked_add(pause)?;
        let length = release.checked_add(pause)?;
        if !(MIN_LENGTH..=MAX_LENGTH).contains(&length) {
            return None;
        }
        let [command, release, length] = [pause, release, length].map(|time| u16::try_from(time).ok());
        Some(Self { command: command?, release: release?, length: length? })
    }

    /// Returns the time between the samples of two successive inputs, ns.
    #[must_use]
    pub fn input_interval_ns(&self, timer_hz: u32) -> u32 {
        let ticks = u64::from(self.length).saturating_mul(2_000_000_000);
        let interval = ticks.checked_div(timer_hz.into()).unwrap_or_default();
        u32::try_from(interval).unwrap_or(u32::MAX)
    }
}

/// Returns a time in ticks, rounded up.
fn ticks(timer_hz: u32, time_ns: u32) -> Option<u32> {
    u32::try_from(u64::from(timer_hz).checked_mul(time_ns.into())?.div_ceil(1_000_000_000)).ok()
}
