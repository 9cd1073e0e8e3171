//! Places in RAM: the stack at its bottom, the emergency stack and the fault record that no start-up clears.
//!
//! ```text
//! lowest address   guard (MPU: no access; cores with a stack limit have none)
//!                  stack, growing down towards the guard
//!                  .data, .bss: an overflow never reaches them
//! highest          .uninit: emergency stack, fault record
//! ```
//!
//! The runtime paints the stack before it starts anything; [`stack_used`] looks how far the paint has gone.

use core::cell::UnsafeCell;

use link::start::{FaultRecord, StackReport};

use crate::supervisor::paint::Mark;
use crate::supervisor::record::{WORDS, decode, encode};

/// Bytes of the emergency stack. `cargo xtask stack` checks that the fault handler needs no more.
pub(super) const EMERGENCY_BYTES: usize = 1024;

/// Bytes at the bottom of the stack that nobody may touch.
#[cfg(feature = "stm32f405")]
pub(super) const GUARD_BYTES: u32 = 256;
/// The core's own stack limit needs no guard.
#[cfg(feature = "mps2-an505")]
pub(super) const GUARD_BYTES: u32 = 0;

#[expect(unsafe_code, reason = "the linker defines them; only their addresses are taken")]
unsafe extern "C" {
    /// Lowest address of the stack, from the memory map.
    static _stack_end: u32;
    /// First address above the stack, from the memory map.
    static _stack_start: u32;
}

/// RAM that only a fault handler or a start-up, where nothing else runs, touches.
#[repr(C, align(8))]
pub(super) struct Kept<T>(UnsafeCell<core::mem::MaybeUninit<T>>);

#[expect(unsafe_code, reason = "touched by code that nothing can interrupt: start-up, or a handler that ends in a reset")]
unsafe impl<T> Sync for Kept<T> {}

impl<T> Kept<T> {
    const fn new() -> Self {
        Self(UnsafeCell::new(core::mem::MaybeUninit::uninit()))
    }
}

#[expect(unsafe_code, reason = "this section is left alone by start-up")]
#[unsafe(link_section = ".uninit.emergency_stack")]
pub(super) static EMERGENCY: Kept<[u8; EMERGENCY_BYTES]> = Kept::new();

#[expect(unsafe_code, reason = "this section is left alone by start-up, so the record outlives a reset")]
#[unsafe(link_section = ".uninit.fault_record")]
static RECORD: Kept<[u32; WORDS]> = Kept::new();

/// Lowest address that belongs to the stack, guard included.
pub(super) fn stack_lowest() -> u32 {
    (&raw const _stack_end) as u32
}

/// First address above the stack.
pub(super) fn stack_highest() -> u32 {
    (&raw const _stack_start) as u32
}

/// Lowest address that the stack may use.
pub(super) fn guard_end() -> u32 {
    stack_lowest().saturating_add(GUARD_BYTES)
}

/// The record that was kept, and whether it is news.
pub(super) fn kept() -> Option<(FaultRecord, bool)> {
    #[expect(unsafe_code, reason = "any bits are words, and the check sum tells whether they are a record")]
    let words = unsafe { RECORD.0.get().cast::<[u32; WORDS]>().read_volatile() };
    decode(&words)
}

/// Keeps a record over the next reset.
pub(super) fn keep(record: &FaultRecord, fresh: bool) {
    #[expect(unsafe_code, reason = "nothing else runs where this is called, see `Kept`")]
    unsafe {
        RECORD.0.get().cast::<[u32; WORDS]>().write_volatile(encode(record, fresh));
    }
}

/// A search for the deepest use of the stack.
pub fn stack_mark() -> Mark {
    Mark::new((stack_highest().saturating_sub(guard_end()) / 4) as usize)
}

/// Searches a little further and says what has been found so far.
pub fn stack_used(mark: &mut Mark) -> StackReport {
    const WORDS_A_CALL: usize = 128;
    let lowest = guard_end() as *const u32;
    mark.search(WORDS_A_CALL, |index| {
        #[expect(unsafe_code, reason = "the mark's indices end where the stack does; a read disturbs nobody")]
        unsafe {
            lowest.add(index).read_volatile()
        }
    });
    StackReport {
        reserved_bytes: stack_highest().saturating_sub(guard_end()),
        used_bytes: u32::try_from(mark.used_bytes()).unwrap_or(u32::MAX),
    }
}
