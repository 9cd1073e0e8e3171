//! Where code and constants are in flash, for the check of them ([`crate::supervisor::code`]).
//!
//! From the vector table to the end of the constants, the built-in networks left out. What `.data` starts with (the log's control block) is not
//! covered.

use inference::{Bearing, shipped};

use crate::supervisor::CodeCheck;
use crate::supervisor::code::UNSEALED;

/// Replaced by `cargo xtask firmware`.
#[expect(unsafe_code, reason = "the build looks for the symbol's name")]
#[unsafe(no_mangle)]
static PINTLE_CODE_SEAL: u32 = UNSEALED;

#[expect(unsafe_code, reason = "the linker defines them; only their addresses are taken")]
unsafe extern "C" {
    static __vector_table: u32;
    static __etext: u32;
    static __srodata: u32;
    static __erodata: u32;
}

/// The check of this image.
#[must_use]
pub fn code_check() -> CodeCheck {
    #[expect(unsafe_code, reason = "the compiler may not take the build's placeholder for the value")]
    let seal = unsafe { (&raw const PINTLE_CODE_SEAL).read_volatile() };
    let [a, b] = Bearing::ALL.map(|bearing| {
        let range = shipped(bearing).as_ptr_range();
        range.start as usize..range.end as usize
    });
    let (first, second) = if a.start < b.start { (a, b) } else { (b, a) };
    let (text, constants) = (&raw const __vector_table as usize, &raw const __srodata as usize);
    CodeCheck::new(
        [
            text..&raw const __etext as usize,
            constants..first.start,
            first.end..second.start,
            second.end..&raw const __erodata as usize,
        ],
        seal,
    )
}

/// A word of the flash.
#[must_use]
pub fn code_word(address: usize) -> u32 {
    #[expect(unsafe_code, reason = "the check's addresses are those of flash, in whole words")]
    unsafe {
        (address as *const u32).read_volatile()
    }
}
