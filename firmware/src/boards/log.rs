//! defmt's transport: one RTT channel, read by a debug probe, harmless without one.
//!
//! Not the `defmt-rtt` crate because that contains panics (nested logging), and this image contains none. Here a nested record is
//! dropped instead. Nothing ever waits: an unread buffer is overwritten.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicPtr, AtomicU8, AtomicU32, Ordering};

use critical_section::RestoreState;

const SIZE: u32 = 1024;

static BUFFER: [AtomicU8; SIZE as usize] = [const { AtomicU8::new(0) }; SIZE as usize];
static NAME: [u8; 6] = *b"defmt\0";

/// RTT control block, as debug probes expect it: identifier, channel counts, one channel to the host.
#[repr(C)]
struct ControlBlock {
    id: [u8; 16],
    channels_up: u32,
    channels_down: u32,
    name: AtomicPtr<u8>,
    buffer: AtomicPtr<AtomicU8>,
    size: u32,
    write: AtomicU32,
    read: AtomicU32,
    flags: AtomicU32,
}

#[expect(unsafe_code, reason = "probes find the control block by this name")]
#[unsafe(no_mangle)]
static _SEGGER_RTT: ControlBlock = ControlBlock {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    channels_up: 1,
    channels_down: 0,
    name: AtomicPtr::new(NAME.as_ptr().cast_mut()),
    buffer: AtomicPtr::new(BUFFER.as_ptr().cast_mut()),
    size: SIZE,
    write: AtomicU32::new(0),
    read: AtomicU32::new(0),
    flags: AtomicU32::new(0),
};

fn put(bytes: &[u8]) {
    let mut at = _SEGGER_RTT.write.load(Ordering::Relaxed) % SIZE;
    for &byte in bytes {
        if let Some(slot) = BUFFER.get(at as usize) {
            slot.store(byte, Ordering::Relaxed);
        }
        at = at.wrapping_add(1) % SIZE;
    }
    _SEGGER_RTT.write.store(at, Ordering::Release);
}

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
    reason = "defmt's interface; interrupts are off from acquire to release, so nothing else gets at the cells"
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

defmt::timestamp!("{=u32:us}", super::uptime_us());
