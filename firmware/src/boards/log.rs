//! Transport of defmt: a channel for debug probes ([`super::rtt`]).
//!
//! The crate `defmt-rtt` is not used because it contains panics (nested logging) and this image
//! contains none. A nested record is dropped here. Nothing waits: an unread buffer is overwritten.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

use critical_section::RestoreState;

use super::rtt::log as put;

struct State {
    encoder: UnsafeCell<defmt::Encoder>,
    restore: UnsafeCell<RestoreState>,
    depth: AtomicU32,
}

#[expect(unsafe_code, reason = "only touched between acquire and release, with interrupts off")]
unsafe impl Sync for State {}

static STATE: State = State {
    encoder: UnsafeCell::new(defmt::Encoder::new()),
    restore: UnsafeCell::new(RestoreState::invalid()),
    depth: AtomicU32::new(0),
};

#[defmt::global_logger]
struct Logger;

#[expect(
    unsafe_code,
    reason = "defmt's interface; interrupts are off from acquire to release: nothing else accesses the cells"
)]
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let restore = unsafe { critical_section::acquire() };
        if STATE.depth.fetch_add(1, Ordering::Relaxed) == 0 {
            unsafe {
                STATE.restore.get().write(restore);
                (*STATE.encoder.get()).start_frame(put);
            }
        }
    }

    unsafe fn flush() {}

    unsafe fn release() {
        if STATE.depth.fetch_sub(1, Ordering::Relaxed) == 1 {
            unsafe {
                (*STATE.encoder.get()).end_frame(put);
                critical_section::release(STATE.restore.get().read());
            }
        }
    }

    unsafe fn write(bytes: &[u8]) {
        if STATE.depth.load(Ordering::Relaxed) == 1 {
            unsafe { (*STATE.encoder.get()).write(bytes, put) }
        }
    }
}

defmt::timestamp!("{=u32:us}", super::timer::uptime_us());
