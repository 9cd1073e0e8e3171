//! Timers: the source of the ticks, and a counter that times the work of a tick.
//!
//! | where | ticks | counter | counts from |
//! |---|---|---|---|
//! | silicon | end of a sample | the core's cycle counter | the tick |
//! | silicon without samples | SysTick | the core's cycle counter | the tick |
//! | emulator, serial link | SysTick | SysTick itself, less than a period | the tick |
//! | emulator, lockstep | SysTick, 10 Hz | SysTick itself, wrap removed | the start of the work |
//!
//! If no sample ends for the time that SysTick's 24 bits can count, SysTick is the tick.
//!
//! Paced by a timer, the count starts when the tick is due, so that any delay counts as work.
//!
//! In lockstep each frame is a tick and nothing is paced. SysTick still runs, because the emulator
//! stops without an active timer. With `-icount shift=6` an instruction takes 64 ns, which SysTick
//! at 168 MHz counts as 10.752 ticks. Work of up to 1.5 million instructions is counted correctly.
//! The emulator has no cycle counter.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{DCB, DWT, SCB, SYST};
use heapless::spsc::Consumer;
use link::Target;

use controller::sensors::{Acquired, Collected, Passed, SampleClock};
use controller::service::Pace;
use controller::session::{IDLE_PERIOD_US, TickSource};
use controller::supervisor::{Attendance, Periods};

const FULL: u32 = 0x00FF_FFFF;

static UPTIME_US: AtomicU32 = AtomicU32::new(0);

/// Returns the time from the start to the last timer tick, us, modulo 2^32.
#[must_use]
pub fn uptime_us() -> u32 {
    UPTIME_US.load(Ordering::Relaxed)
}

/// Source of the ticks.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// SysTick as a counter; nothing is paced.
    Lockstep,
    /// SysTick.
    Timer(Target),
    /// The end of each sample that hardware takes.
    Samples {
        /// Time between the samples of two successive inputs, ns.
        input_interval_ns: u32,
    },
}

impl Source {
    /// Returns the source of a board. `input_interval_ns` is that of samples that hardware takes.
    pub(super) fn of(is_paced: bool, target: Target, input_interval_ns: Option<u32>) -> Self {
        match (is_paced, input_interval_ns) {
            (false, _) => Self::Lockstep,
            (true, None) => Self::Timer(target),
            (true, Some(input_interval_ns)) => Self::Samples { input_interval_ns },
        }
    }
}

/// Samples on their way from the interrupt at their end to the tick.
pub const COLLECTED: usize = 4;

/// Clock of the ticks.
pub struct Pacer {
    clock: Clock,
    core_mhz: u32,
}

enum Clock {
    /// SysTick; not paced in lockstep.
    SysTick { syst: SYST, is_paced: bool, pace: Pace },
    /// The samples, with their period and the cycle count at the start of the tick. No samples come
    /// if `is_stalled`.
    Samples { clock: SampleClock, period_us: u32, cycles: u32, is_stalled: bool },
}

impl Pacer {
    /// Takes the next tick and advances the uptime by its period. To be called once per interrupt.
    ///
    /// The uptime counts ticks and not time, so that a task does not seem to be missing only
    /// because the core was halted or writing flash.
    pub fn tick(&mut self, collected: &mut Consumer<'static, Collected>) -> Acquired {
        match &mut self.clock {
            Clock::SysTick { pace, .. } => Acquired::nothing(advance_uptime(pace.advance())),
            Clock::Samples { clock, period_us, cycles, is_stalled } => {
                let now_us = advance_uptime(*period_us);
                let next = collected.dequeue();
                *is_stalled = next.is_none();
                let Some(Collected { run, answers, completion }) = next else {
                    clock.count_stall();
                    *cycles = DWT::cycle_count();
                    return Acquired::nothing(now_us);
                };
                if collected.ready() {
                    // Of two interrupts that waited, one was served.
                    SCB::set_pendst();
                }
                *cycles = completion.cycles;
                let Passed { time_us, lost } = clock.advance(run, completion, *period_us);
                Acquired { time_us, lost, run, answers }
            }
        }
    }

    /// Decides whether SysTick has ended without a sample.
    #[must_use]
    pub const fn is_stalled(&self) -> bool {
        matches!(self.clock, Clock::Samples { is_stalled: true, .. })
    }

    /// Changes the period from the next tick on; us. Returns true if the time to the next tick is
    /// that period already. In lockstep nothing changes. Samples change their period themselves.
    pub fn set_period(&mut self, new_us: u32) -> bool {
        match &mut self.clock {
            Clock::SysTick { is_paced: false, .. } => true,
            Clock::SysTick { syst, pace, .. } => {
                let (is_new, is_current) = pace.set_period(new_us);
                if is_new {
                    syst.set_reload(reload(self.core_mhz, new_us));
                }
                is_current
            }
            Clock::Samples { period_us, .. } => {
                *period_us = new_us;
                true
            }
        }
    }

    /// Returns the counter of a tick.
    #[must_use]
    pub fn timer(&self, timer: Timer) -> Timer {
        match &self.clock {
            Clock::Samples { cycles, .. } => Timer::Since { cycles: *cycles },
            Clock::SysTick { pace, .. } => {
                let reload = reload(self.core_mhz, pace.current_us());
                match timer {
                    Timer::SysTick | Timer::Since { .. } => timer,
                    Timer::Due { .. } => Timer::Due { reload },
                    Timer::Cycles { .. } => Timer::Cycles { reload },
                }
            }
        }
    }

    /// Returns the clock of the samples; `None` if SysTick is the source of the ticks.
    #[must_use]
    pub const fn sample_clock(&self) -> Option<&SampleClock> {
        match &self.clock {
            Clock::SysTick { .. } => None,
            Clock::Samples { clock, .. } => Some(clock),
        }
    }
}

/// Advances the uptime and returns it, us.
fn advance_uptime(passed_us: u32) -> u32 {
    UPTIME_US.fetch_add(passed_us, Ordering::Relaxed).wrapping_add(passed_us)
}

/// Starts SysTick's time anew: a sample has come.
pub fn postpone() {
    #[expect(unsafe_code, reason = "writing the counter's register only clears the counter")]
    unsafe {
        (*SYST::PTR).cvr.write(0);
    }
}

/// Returns the reload value of a period in us.
fn reload(core_mhz: u32, period_us: u32) -> u32 {
    core_mhz.saturating_mul(period_us).clamp(2, FULL).saturating_sub(1)
}

/// Creates the register of check-ins. Paced by the timer, a tick is at most 1 ms. In lockstep,
/// where time passes only while the controller works, it is 0.1 to 0.9 s.
pub(super) const fn attendance(paced: bool) -> Attendance {
    const SECOND_US: u32 = 1_000_000;
    Attendance::new(if paced {
        Periods {
            sampling_us: 5_000,
            inference_us: 5_000,
            // The longest work between two passes of the link service is to send a frame.
            link_us: SECOND_US / 2,
            self_test_us: 60 * SECOND_US,
        }
    } else {
        Periods {
            sampling_us: 5 * SECOND_US,
            inference_us: 5 * SECOND_US,
            link_us: 5 * SECOND_US,
            self_test_us: 60 * SECOND_US,
        }
    })
}

/// Counter that times a tick.
#[derive(Clone, Copy, Debug)]
pub enum Timer {
    /// SysTick's 24 bits, counting down.
    SysTick,
    /// SysTick from its reload value on.
    Due {
        /// Reload value.
        reload: u32,
    },
    /// The core's cycle counter, from the moment when SysTick was reloaded.
    Cycles {
        /// Reload value of SysTick.
        reload: u32,
    },
    /// The core's cycle counter, from the end of a sample.
    Since {
        /// Count at that end.
        cycles: u32,
    },
}

impl Timer {
    /// Starts SysTick and the cycle counter. Returns the counter and the clock of the ticks.
    pub(super) fn start(
        mut syst: SYST,
        mut dcb: DCB,
        mut dwt: DWT,
        core_hz: u32,
        source: Source,
    ) -> (Self, Pacer) {
        // Clocks of the boards have no fraction of a megahertz.
        let core_mhz = (core_hz / 1_000_000).max(1);
        let is_paced = !matches!(source, Source::Lockstep);
        let period_us = if is_paced { IDLE_PERIOD_US } else { FULL.saturating_add(1) / core_mhz };
        syst.set_clock_source(SystClkSource::Core);
        let reload = match source {
            // If no sample comes for that long, SysTick is the tick.
            Source::Lockstep | Source::Samples { .. } => FULL,
            Source::Timer(_) => reload(core_mhz, period_us),
        };
        syst.set_reload(reload);
        syst.clear_current();
        syst.enable_counter();
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        let timer = match source {
            Source::Lockstep => Self::SysTick,
            Source::Timer(Target::Silicon) | Source::Samples { .. } => Self::Cycles { reload },
            Source::Timer(_) => Self::Due { reload },
        };
        let clock = match source {
            Source::Samples { input_interval_ns } => {
                syst.enable_interrupt();
                let clock = SampleClock::new(core_mhz, input_interval_ns);
                Clock::Samples { clock, period_us, cycles: 0, is_stalled: false }
            }
            Source::Lockstep | Source::Timer(_) => {
                syst.enable_interrupt();
                Clock::SysTick { syst, is_paced, pace: Pace::new(period_us) }
            }
        };
        (timer, Pacer { clock, core_mhz })
    }
}

impl TickSource for Timer {
    fn start(&mut self) -> u32 {
        match self {
            Self::SysTick => SYST::get_current(),
            Self::Due { reload } => *reload,
            Self::Cycles { reload } => {
                let late = reload.wrapping_sub(SYST::get_current());
                DWT::cycle_count().wrapping_sub(late)
            }
            Self::Since { cycles } => *cycles,
        }
    }

    fn since(&mut self, start: u32) -> u32 {
        match self {
            Self::SysTick | Self::Due { .. } => start.wrapping_sub(SYST::get_current()) & FULL,
            Self::Cycles { .. } | Self::Since { .. } => DWT::cycle_count().wrapping_sub(start),
        }
    }
}
