//! Timers: SysTick paces the tick, and a counter times the work of a tick.
//!
//! | where | SysTick | counter | counts from |
//! |---|---|---|---|
//! | silicon | 10 kHz | the core's cycle counter | the timer's tick |
//! | emulator, serial link | 10 kHz | SysTick itself: less than a period | the timer's tick |
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

use controller::session::{OWN_SAMPLE_PERIOD_US, TickSource};
use controller::supervisor::{Attendance, Periods};

/// Timer ticks per second if SysTick paces the tick.
pub const TICKS_PER_SECOND: u32 = 10_000;
const _: () =
    assert!(TICKS_PER_SECOND * OWN_SAMPLE_PERIOD_US == 1_000_000, "own samples are taken every tick");

const FULL: u32 = 0x00FF_FFFF;

static UPTIME_US: AtomicU32 = AtomicU32::new(0);
static PERIOD_US: AtomicU32 = AtomicU32::new(0);

/// Returns the time from the start to the last timer tick, us, modulo 2^32.
#[must_use]
pub fn uptime_us() -> u32 {
    UPTIME_US.load(Ordering::Relaxed)
}

/// Advances the uptime by a timer tick and returns it, us. To be called once per tick.
pub fn advance_uptime() -> u32 {
    let period_us = PERIOD_US.load(Ordering::Relaxed);
    UPTIME_US.fetch_add(period_us, Ordering::Relaxed).wrapping_add(period_us)
}

/// Creates the register of check-ins. Paced by the timer, a tick is 100 us. In lockstep, where time
/// passes only while the controller works, it is 0.1 to 0.9 s.
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
    /// Starts SysTick and the cycle counter.
    pub(super) fn start(
        mut syst: SYST,
        mut dcb: DCB,
        mut dwt: DWT,
        core_hz: u32,
        target: Target,
        paced: bool,
    ) -> Self {
        let reload = if paced { (core_hz / TICKS_PER_SECOND).saturating_sub(1) } else { FULL };
        let period_us =
            u64::from(reload).saturating_add(1).saturating_mul(1_000_000).checked_div(core_hz.into());
        PERIOD_US.store(period_us.and_then(|us| us.try_into().ok()).unwrap_or(u32::MAX), Ordering::Relaxed);
        syst.set_clock_source(SystClkSource::Core);
        syst.set_reload(reload);
        syst.clear_current();
        syst.enable_counter();
        syst.enable_interrupt();
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        match (paced, target) {
            (false, _) => Self::SysTick,
            (true, Target::Silicon) => Self::Cycles { reload },
            (true, _) => Self::Due { reload },
        }
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
