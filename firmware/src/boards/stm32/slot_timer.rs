//! TIM4, whose slots pace the samples, and TIM5, the time base.
//!
//! Outputs 3 and 4 of TIM4 are the selects of both devices, low while the counter is below the
//! compare value (PWM mode 1). At the end of each slot the timer takes its preloaded length and
//! compare values, and requests those of the next slot from DMA. Compare event 1 requests a word
//! for the bus. TIM5 counts microseconds, also while a debugger halts the core.
//!
//! Sources: RM0090 section 18 and RM0433 section 43 (TIM2 to TIM5), whose registers agree.

use controller::sensors::{Device, Slot};

use super::super::microcontroller::bus;
use super::registers::Registers;

const CONTROL: usize = 0x00;
const REQUESTS: usize = 0x0C;
const STATUS: usize = 0x10;
const EVENTS: usize = 0x14;
/// Mode of compare event 1, which has no output.
const COMMAND_MODE: usize = 0x18;
const OUTPUT_MODES: usize = 0x1C;
const OUTPUT_ENABLES: usize = 0x20;
const COUNT: usize = 0x24;
const PRESCALER: usize = 0x28;
const LENGTH: usize = 0x2C;
const COMPARE: [usize; 4] = [0x34, 0x38, 0x3C, 0x40];
const BURST_CONTROL: usize = 0x48;
const BURST: usize = 0x4C;

/// Enables the counter.
const ENABLE: u32 = 1;
/// A software update makes no request.
const QUIET_UPDATE: u32 = 1 << 2;
/// The length is preloaded.
const PRELOAD_LENGTH: u32 = 1 << 7;
const UPDATE: u32 = 1;
/// Requests for DMA at updates and at compare event 1.
const UPDATE_AND_COMMAND: u32 = 1 << 8 | 1 << 9;
/// The compare value of an output is preloaded.
const PRELOAD: u32 = 1 << 3;
/// PWM mode 1 of an output.
const PWM: u32 = 6 << 4;
/// Forces an output active.
const ACTIVE: u32 = 5 << 4;
/// Forces an output inactive.
const INACTIVE: u32 = 4 << 4;
/// Outputs 3 and 4, active low.
const OUTPUTS: u32 = 3 << 8 | 3 << 12;

/// Registers that a burst writes: the length, one without a use, and four compare values.
pub(super) const BURST_LENGTH: usize = 6;

/// TIM4.
pub(super) struct SlotTimer(Registers);

/// TIM5.
pub(super) struct TimeBase(Registers);

impl SlotTimer {
    /// Sets up both timers for their clock in MHz and starts the time base. Their clocks must be
    /// enabled. Both devices are released.
    pub(super) fn start(timer_mhz: u32) -> (Self, TimeBase) {
        #[expect(unsafe_code, reason = "TIM4 and TIM5, whose owner the caller is")]
        let (timer, base) = unsafe { (Registers::new(bus::slot_timer()), Registers::new(bus::time_base())) };
        base.write(PRESCALER, timer_mhz.saturating_sub(1));
        base.write(LENGTH, u32::MAX);
        base.write(EVENTS, UPDATE);
        base.write(CONTROL, ENABLE);
        timer.write(PRESCALER, bus::SLOT_DIVIDER.saturating_sub(1));
        timer.write(CONTROL, QUIET_UPDATE | PRELOAD_LENGTH);
        timer.write(COMMAND_MODE, PRELOAD);
        let started = Self(timer);
        started.stop(|| 0);
        timer.write(OUTPUT_ENABLES, OUTPUTS);
        (started, TimeBase(base))
    }

    /// Stops the slots and releases both devices. `remaining` is the number of values that DMA has
    /// yet to load: a burst is completed, because the timer would continue it later.
    pub(super) fn stop(&self, remaining: impl Fn() -> usize) {
        /// Polls until a burst has ended, which takes less than 1 us.
        const POLLS: u32 = 1_000;
        self.0.write(CONTROL, QUIET_UPDATE | PRELOAD_LENGTH);
        // An event just before the stop has reached the streams.
        let _ = self.0.read(CONTROL);
        cortex_m::asm::delay(bus::SELECT_CYCLES);
        let _ = (0..POLLS).any(|_| remaining().is_multiple_of(BURST_LENGTH));
        self.0.write(REQUESTS, 0);
        self.0.write(OUTPUT_MODES, INACTIVE | INACTIVE << 8);
    }

    /// Starts in a slot, with the second one preloaded.
    pub(super) fn run(&self, first: &Slot, second: &Slot) {
        let both = |mode: u32| (mode | PRELOAD) | (mode | PRELOAD) << 8;
        // From the length on, six registers.
        self.0.write(BURST_CONTROL, (BURST_LENGTH as u32 - 1) << 8 | (LENGTH / 4) as u32);
        self.0.write(OUTPUT_MODES, both(INACTIVE));
        self.preload(first);
        // The counter is 0 and the preloaded values become active, before the outputs follow them.
        self.0.write(EVENTS, UPDATE);
        self.0.write(OUTPUT_MODES, both(PWM));
        self.preload(second);
        self.0.write(STATUS, 0);
        self.0.write(REQUESTS, UPDATE_AND_COMMAND);
        self.0.write(CONTROL, QUIET_UPDATE | PRELOAD_LENGTH | ENABLE);
    }

    fn preload(&self, slot: &Slot) {
        let [length, _, command, _, third, fourth] = burst(slot);
        self.0.write(LENGTH, length.into());
        for (register, value) in COMPARE.into_iter().zip([command, 0, third, fourth]) {
            self.0.write(register, value.into());
        }
    }

    /// Selects or releases the converter while the slots are stopped.
    pub(super) fn select_converter(&self, is_selected: bool) {
        let mode = if is_selected { ACTIVE } else { INACTIVE };
        self.0.write(
            OUTPUT_MODES,
            match bus::SELECT_3 {
                Device::Converter => mode | INACTIVE << 8,
                Device::Encoder => INACTIVE | mode << 8,
            },
        );
    }

    /// Address of the register that a burst writes.
    pub(super) const fn burst_address(&self) -> u32 {
        self.0.address(BURST)
    }
}

impl TimeBase {
    /// Time since the start, us, modulo 2^32.
    pub(super) fn time_us(&self) -> u32 {
        self.0.read(COUNT)
    }
}

/// Returns the registers of a slot in the order of a burst.
pub(super) const fn burst(slot: &Slot) -> [u16; BURST_LENGTH] {
    let [third, fourth] = match bus::SELECT_3 {
        Device::Converter => [slot.converter, slot.encoder],
        Device::Encoder => [slot.encoder, slot.converter],
    };
    [slot.length.saturating_sub(1), 0, slot.command, 0, third, fourth]
}
