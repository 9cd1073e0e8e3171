//! Comparison of two columns of four or eight words: LDM of four words each and USADA8, which
//! accumulates the differences of the bytes of two words. It takes 6 instructions for four words in
//! place of 16.
//!
//! # Safety argument
//!
//! The function reads `4 QUADS` words at each of its two arguments. The wrapper takes references to
//! arrays of that length, whose words are aligned as LDM requires. r4 to r9 are saved; 24 bytes of
//! stack keep it aligned to 8; r12 and the flags are free to use. No other memory is written.

use core::arch::naked_asm;

#[unsafe(naked)]
unsafe extern "C" fn quads<const QUADS: usize>(first: *const u32, second: *const u32) -> u32 {
    naked_asm!(
        "push {{r4-r9}}",
        "movs r2, #0",
        ".rept {quads}",
        "ldm r0!, {{r3-r6}}",
        "ldm r1!, {{r7-r9, r12}}",
        "usada8 r2, r3, r7, r2",
        "usada8 r2, r4, r8, r2",
        "usada8 r2, r5, r9, r2",
        "usada8 r2, r6, r12, r2",
        ".endr",
        "mov r0, r2",
        "pop {{r4-r9}}",
        "bx lr",
        quads = const { QUADS },
    )
}

/// Returns the sum of the byte differences of two columns, 0 if they are equal.
#[inline]
pub(crate) fn difference<const QUADS: usize>(first: &[[u32; 4]; QUADS], second: &[[u32; 4]; QUADS]) -> u32 {
    // SAFETY: two arrays of `4 QUADS` words.
    unsafe { quads::<QUADS>(first.as_ptr().cast(), second.as_ptr().cast()) }
}
