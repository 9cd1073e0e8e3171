//! What happens when something happens that cannot: it is recorded, the controller resets, and its greeting tells the host.
//!
//! The hard fault handler trusts nothing of the stack that faulted: its first instructions load the emergency stack, and it reads the pushed
//! registers only where the core says that it pushed them and the pointer lies within the stack. A fault in the handler itself locks the core
//! up; then the hardware's watchdog resets.
//!
//! The panic handler is there because the language wants one. It refers to [`PINTLE_PANIC_MARKER`]; a release image in which
//! that symbol exists contains a reachable panic, and `cargo xtask size` reports it.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use link::start::{FaultKind, ResetReason, StartReport};

use super::{BUILD_ID, memory};
use crate::supervisor::record::build_hash;
use crate::supervisor::start::{Status, given_up, report};

#[expect(unsafe_code, reason = "the symbol's name is what is looked for in the image")]
#[unsafe(no_mangle)]
static PINTLE_PANIC_MARKER: u32 = 0x0BAD_F00D;

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    #[expect(unsafe_code, reason = "a read that the optimiser may not drop keeps the marker in the image")]
    let _ = unsafe { core::ptr::read_volatile(&raw const PINTLE_PANIC_MARKER) };
    give_up(FaultKind::Panic)
}

/// Cores with a stack limit: the emergency stack is not to be measured with it.
#[cfg(feature = "mps2-an505")]
macro_rules! lift_limit {
    () => {
        "movs r1, #0\nmsr msplim, r1"
    };
}
#[cfg(feature = "stm32f405")]
macro_rules! lift_limit {
    () => {
        ""
    };
}

/// Where the core arrives.
mod entry {
    #![expect(unsafe_code, reason = "the vector table wants this symbol; the code before the jump needs no stack")]

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

/// Records what the core's registers say. `msp` is the stack pointer as the fault left it.
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
        /// Where the pushed link register is; the program counter follows.
        const LINK_REGISTER: u32 = 20;
        let pushed = msp.wrapping_add(LINK_REGISTER) as *const [u32; 2];
        #[expect(unsafe_code, reason = "within the stack and aligned, as just checked")]
        let pushed = unsafe { pushed.read_volatile() };
        status.pushed = Some(pushed);
    }
    let previous = memory::kept().map(|(fault, _)| fault);
    memory::keep(&status.record(memory::guard_end(), build_hash(BUILD_ID), previous), true);
    SCB::sys_reset()
}

/// Records that the firmware itself gives up, and resets.
pub fn give_up(kind: FaultKind) -> ! {
    cortex_m::interrupt::disable();
    let previous = memory::kept().map(|(fault, _)| fault);
    memory::keep(&given_up(kind, cortex_m::register::msp::read(), build_hash(BUILD_ID), previous), true);
    SCB::sys_reset()
}

/// The report of this start; a record that was news is none any more.
pub(super) fn start_report(reason: ResetReason) -> StartReport {
    let kept = memory::kept();
    if let Some((fault, true)) = kept {
        memory::keep(&fault, false);
    }
    report(reason, kept)
}
