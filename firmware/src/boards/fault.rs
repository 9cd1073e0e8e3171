//! What happens when something happens that cannot: the controller restarts, and its greeting tells the host so.
//!
//! The panic handler is there because the language wants one. It refers to [`PINTLE_PANIC_MARKER`]; a release image in which
//! that symbol exists contains a reachable panic, and `cargo xtask size` reports it.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};

#[expect(unsafe_code, reason = "the symbol's name is what is looked for in the image")]
#[unsafe(no_mangle)]
static PINTLE_PANIC_MARKER: u32 = 0x0BAD_F00D;

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    #[expect(unsafe_code, reason = "a read that the optimiser may not drop keeps the marker in the image")]
    let _ = unsafe { core::ptr::read_volatile(&raw const PINTLE_PANIC_MARKER) };
    SCB::sys_reset()
}

#[allow(unsafe_code, reason = "the runtime demands an unsafe handler; an expectation is lost in its macro")]
#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    SCB::sys_reset()
}
