//! Timers: SysTick paces the tick, and a counter times the work of a tick.
//!
//! | where | SysTick | counter | counts from |
//! |---|---|---|---|
//! | silicon | the sample period | the core's cycle counter | the tick |
//! | emulator, serial link | the sample period | SysTick itself, less than a period | the tick |
//! | emulator, lockstep | 24 bits: 10 Hz | SysTick itself, wrap removed | the start of the work |
//!
//! Paced by the timer, the count starts when the tick is due, so that any delay counts as work.
//!
//! In lockstep each frame is a tick and nothing is paced. SysTick still runs, because the emulator
//! stops without an active timer. With `-icount shift=6` an instruction takes 64 ns, which SysTick
//! at 168 MHz counts as 10.752 ticks. Work of up to 1.5 million instructions is counted correctly.
//! The emulator has no cycle counter.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{DCB, DWT, SYST};
use link::Target;

use controller::service::Pace;
use controller::session::{IDLE_PERIOD_US, TickSource};
use controller::supervisor::{Attendance, Periods};

const FULL: u32 = 0x00FF_FFFF;

static UPTIME_US: AtomicU32 = AtomicU32::new(0);

/// Returns the time from the start to the last timer tick, us, modulo 2^32.
#[must_use]
pub(super) fn uptime_us() -> u32 {
    UPTIME_US.load(Ordering::Relaxed)
}

/// SysTick as the clock of the ticks.
pub struct Pacer {
    syst: SYST,
    core_mhz: u32,
    is_paced: bool,
    pace: Pace,
}

impl Pacer {
    /// Advances the uptime by a timer tick and returns it, us. To be called once per tick.
    pub fn advance_uptime(&mut self) -> u32 {
        let passed_us = self.pace.advance();
        UPTIME_US.fetch_add(passed_us, Ordering::Relaxed).wrapping_add(passed_us)
    }

    /// Changes the period from the next tick on; us. Returns true if the time to the next tick is
    /// that period already. In lockstep nothing changes.
    pub fn set_period(&mut self, period_us: u32) -> bool {
        if !self.is_paced {
            return true;
        }
        let (is_new, is_current) = self.pace.set_period(period_us);
        if is_new {
            self.syst.set_reload(reload(self.core_mhz, period_us));
        }
        is_current
    }

    /// Returns the counter of a tick for the period that SysTick is counting now.
    #[must_use]
    pub fn timer(&self, timer: Timer) -> Timer {
        let reload = reload(self.core_mhz, self.pace.current_us());
        match timer {
            Timer::SysTick => timer,
            Timer::Due { .. } => Timer::Due { reload },
            Timer::Cycles { .. } => Timer::Cycles { reload },
        }
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
}

impl Timer {
    /// Starts SysTick and the cycle counter. Returns the counter and the clock of the ticks.
    pub(super) fn start(
        mut syst: SYST,
        mut dcb: DCB,
        mut dwt: DWT,
        core_hz: u32,
        target: Target,
        is_paced: bool,
    ) -> (Self, Pacer) {
        // Clocks of the boards have no fraction of a megahertz.
        let core_mhz = (core_hz / 1_000_000).max(1);
        let period_us = if is_paced { IDLE_PERIOD_US } else { FULL.saturating_add(1) / core_mhz };
        syst.set_clock_source(SystClkSource::Core);
        let reload = if is_paced { reload(core_mhz, period_us) } else { FULL };
        syst.set_reload(reload);
        syst.clear_current();
        syst.enable_counter();
        syst.enable_interrupt();
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        let timer = match (is_paced, target) {
            (false, _) => Self::SysTick,
            (true, Target::Silicon) => Self::Cycles { reload },
            (true, _) => Self::Due { reload },
        };
        (timer, Pacer { syst, core_mhz, is_paced, pace: Pace::new(period_us) })
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
        }
    }

    fn since(&mut self, start: u32) -> u32 {
        match self {
            Self::SysTick | Self::Due { .. } => start.wrapping_sub(SYST::get_current()) & FULL,
            Self::Cycles { .. } => DWT::cycle_count().wrapping_sub(start),
        }
    }
}
