//! Layout of the RAM: stack at the bottom; emergency stack, fault record and count of faulted
//! starts where start-up does not clear them.
//!
//! ```text
//! lowest address   guard (MPU: no access; cores with a stack limit have none)
//!                  stack, growing down towards the guard
//!                  .data, .bss: an overflow never reaches them
//! highest          .uninit: emergency stack, fault record, count of faulted starts
//! ```
//!
//! The runtime paints the stack before it starts anything. [`stack_used`] searches for the lowest
//! word without paint.

use core::cell::UnsafeCell;

use link::start::{FaultRecord, StackReport};

use controller::supervisor::paint::Mark;
use controller::supervisor::record::{WORDS, decode, encode};
use controller::supervisor::start::StartWatch;

/// Bytes of the emergency stack. `cargo xtask stack` checks that the fault handler needs no more.
pub(super) const EMERGENCY_BYTES: usize = 1024;

/// Bytes at the bottom of the stack that must not be accessed.
#[cfg(not(stack_limit_register))]
pub(super) const GUARD_BYTES: u32 = 256;
/// A core with a stack limit needs no guard.
#[cfg(stack_limit_register)]
pub(super) const GUARD_BYTES: u32 = 0;

#[expect(unsafe_code, reason = "the linker defines them; only their addresses are taken")]
unsafe extern "C" {
    /// Lowest address of the stack, from the memory map.
    static _stack_end: u32;
    /// First address above the stack, from the memory map.
    static _stack_start: u32;
}

/// RAM that one part of the firmware accesses at a time: start-up, the link service after it, or a
/// fault handler that ends in a reset.
#[repr(C, align(8))]
pub(super) struct Retained<T>(UnsafeCell<core::mem::MaybeUninit<T>>);

#[expect(unsafe_code, reason = "no two parts access the same object at a time")]
unsafe impl<T> Sync for Retained<T> {}

impl<T> Retained<T> {
    const fn new() -> Self {
        Self(UnsafeCell::new(core::mem::MaybeUninit::uninit()))
    }
}

#[expect(unsafe_code, reason = "this section is left alone by start-up")]
#[unsafe(link_section = ".uninit.emergency_stack")]
pub(super) static EMERGENCY: Retained<[u8; EMERGENCY_BYTES]> = Retained::new();

#[expect(unsafe_code, reason = "this section is left alone by start-up, so the record outlives a reset")]
#[unsafe(link_section = ".uninit.fault_record")]
static RECORD: Retained<[u32; WORDS]> = Retained::new();

#[expect(unsafe_code, reason = "as above, so that it counts starts")]
#[unsafe(link_section = ".uninit.start_watch")]
static START_WATCH: Retained<u32> = Retained::new();

/// Returns the count of faulted starts.
pub(super) fn start_watch() -> StartWatch {
    #[expect(unsafe_code, reason = "any bits are a word; start-up and then the link service use it")]
    let word = unsafe { START_WATCH.0.get().cast::<u32>().read_volatile() };
    StartWatch::of_word(word)
}

/// Stores the count of faulted starts.
pub(super) fn set_start_watch(watch: StartWatch) {
    #[expect(unsafe_code, reason = "only start-up and then the link service use it")]
    unsafe {
        START_WATCH.0.get().cast::<u32>().write_volatile(watch.to_word());
    }
}

/// Returns the lowest address of the stack, guard included.
pub(super) fn stack_lowest() -> u32 {
    (&raw const _stack_end) as u32
}

/// Returns the first address above the stack.
pub(super) fn stack_highest() -> u32 {
    (&raw const _stack_start) as u32
}

/// Returns the lowest address that the stack may use.
pub(super) fn guard_end() -> u32 {
    stack_lowest().saturating_add(GUARD_BYTES)
}

/// Returns the stored fault record and whether it has not been reported yet.
pub(super) fn stored_fault() -> Option<(FaultRecord, bool)> {
    #[expect(unsafe_code, reason = "any bits are words, and the checksum decides whether they are a record")]
    let words = unsafe { RECORD.0.get().cast::<[u32; WORDS]>().read_volatile() };
    decode(&words)
}

/// Stores a record so that it outlasts the next reset.
pub(super) fn store_fault(record: &FaultRecord, fresh: bool) {
    #[expect(unsafe_code, reason = "nothing else runs where this is called, see `Retained`")]
    unsafe {
        RECORD.0.get().cast::<[u32; WORDS]>().write_volatile(encode(record, fresh));
    }
}

/// Starts a search for the deepest use of the stack.
pub fn stack_mark() -> Mark {
    Mark::new((stack_highest().saturating_sub(guard_end()) / 4) as usize)
}

/// Searches further and returns the result so far.
pub(super) fn stack_used(mark: &mut Mark) -> StackReport {
    const WORDS_A_CALL: usize = 128;
    let lowest = guard_end() as *const u32;
    mark.search(WORDS_A_CALL, |index| {
        #[expect(unsafe_code, reason = "the mark's indices end where the stack does; a read has no effect")]
        unsafe {
            lowest.add(index).read_volatile()
        }
    });
    StackReport {
        reserved_bytes: stack_highest().saturating_sub(guard_end()),
        used_bytes: u32::try_from(mark.used_bytes()).unwrap_or(u32::MAX),
    }
}
