//! Handling of core faults and panics: record the fault and reset. The next hello frame reports it.
//!
//! The hard fault handler does not trust the stack that faulted. Its first instructions load the
//! emergency stack. It reads the pushed registers only if the core reports that it pushed them and
//! the pointer lies within the stack. A fault in the handler itself puts the core into lockup,
//! which the hardware watchdog ends.
//!
//! The language requires the panic handler. It refers to [`PINTLE_PANIC_MARKER`]: a release image
//! with that symbol contains a reachable panic, which `cargo xtask size` reports.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use link::start::{FaultKind, ResetReason, StartReport};

use super::image::build_id;
use super::memory;
use controller::supervisor::record::build_hash;
use controller::supervisor::start::{Status, given_up, report};

#[expect(unsafe_code, reason = "the symbol's name is what is looked for in the image")]
#[unsafe(no_mangle)]
static PINTLE_PANIC_MARKER: u32 = 0x0BAD_F00D;

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    #[expect(unsafe_code, reason = "a read that the optimiser may not drop keeps the marker in the image")]
    let _ = unsafe { core::ptr::read_volatile(&raw const PINTLE_PANIC_MARKER) };
    give_up(FaultKind::Panic)
}

/// Lifts the stack limit on cores that have one: the emergency stack lies outside it.
#[cfg(stack_limit_register)]
macro_rules! lift_limit {
    () => {
        "movs r1, #0\nmsr msplim, r1"
    };
}
#[cfg(not(stack_limit_register))]
macro_rules! lift_limit {
    () => {
        ""
    };
}

/// Entry point of the hard fault.
mod entry {
    #![expect(
        unsafe_code,
        reason = "the vector table requires this symbol; the code before the jump needs no stack"
    )]

    use core::arch::naked_asm;

    use super::{memory, record_fault};

    #[unsafe(naked)]
    #[unsafe(export_name = "HardFault")]
    #[unsafe(link_section = ".HardFault.user")]
    unsafe extern "C" fn hard_fault() -> ! {
        naked_asm!(
            "mrs r0, msp",
            lift_limit!(),
            "movw r2, #:lower16:{stack}",
            "movt r2, #:upper16:{stack}",
            "add r2, r2, #{bytes}",
            "msr msp, r2",
            "isb",
            "b {record}",
            stack = sym memory::EMERGENCY,
            bytes = const memory::EMERGENCY_BYTES,
            record = sym record_fault,
        )
    }
}

/// Records the core's fault registers. `msp` is the stack pointer at the fault.
extern "C" fn record_fault(msp: u32) -> ! {
    #[expect(unsafe_code, reason = "the system control block is there on every core; only read")]
    let scb = unsafe { &*SCB::PTR };
    let mut status = Status {
        cfsr: scb.cfsr.read(),
        hfsr: scb.hfsr.read(),
        mmfar: scb.mmfar.read(),
        bfar: scb.bfar.read(),
        msp,
        pushed: None,
    };
    if status.is_pushed(memory::stack_lowest(), memory::stack_highest()) {
        /// Offset of the pushed link register; the program counter follows it.
        const LINK_REGISTER: u32 = 20;
        let pushed = msp.wrapping_add(LINK_REGISTER) as *const [u32; 2];
        #[expect(unsafe_code, reason = "within the stack and aligned, as just checked")]
        let pushed = unsafe { pushed.read_volatile() };
        status.pushed = Some(pushed);
    }
    let previous = memory::stored_fault().map(|(fault, _)| fault);
    memory::store_fault(&status.record(memory::guard_end(), build_hash(&build_id()), previous), true);
    SCB::sys_reset()
}

/// Records a fault that the firmware itself detected, and resets.
pub fn give_up(kind: FaultKind) -> ! {
    cortex_m::interrupt::disable();
    let previous = memory::stored_fault().map(|(fault, _)| fault);
    memory::store_fault(
        &given_up(kind, cortex_m::register::msp::read(), build_hash(&build_id()), previous),
        true,
    );
    SCB::sys_reset()
}

/// Returns the report of this start, marks a new fault record as reported, and counts the start.
pub(super) fn start_report(reason: ResetReason) -> StartReport {
    let stored = memory::stored_fault();
    if let Some((fault, true)) = stored {
        memory::store_fault(&fault, false);
    }
    let report = report(reason, stored);
    memory::set_start_watch(memory::start_watch().after(report.reason));
    report
}
