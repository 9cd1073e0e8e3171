//! A column of four or eight words that takes the place of another's two copies, with the copies compared on the way: LDM and STM of four words each and
//! USADA8, which adds up by how much the bytes of two words differ. 9 instructions for four words; one by one it would be 28.
//!
//! # Safety argument
//!
//! The function reads `4 QUADS` words at each of its three arguments and writes as many at the second and the third; the wrapper takes references to
//! arrays of that length, whose words are aligned as LDM and STM want them. r4 to r11 are saved, 32 bytes of stack keep it aligned to 8.

use core::arch::naked_asm;

#[unsafe(naked)]
unsafe extern "C" fn quads<const QUADS: usize>(new: *const u32, first: *mut u32, second: *mut u32) -> u32 {
    naked_asm!(
        "push {{r4-r11}}",
        "movs r3, #0",
        ".rept {quads}",
        "ldm r1, {{r4-r7}}",
        "ldm r2, {{r8-r11}}",
        "usada8 r3, r4, r8, r3",
        "usada8 r3, r5, r9, r3",
        "usada8 r3, r6, r10, r3",
        "usada8 r3, r7, r11, r3",
        "ldm r0!, {{r4-r7}}",
        "stm r1!, {{r4-r7}}",
        "stm r2!, {{r4-r7}}",
        ".endr",
        "mov r0, r3",
        "pop {{r4-r11}}",
        "bx lr",
        quads = const { QUADS },
    )
}

/// Writes `new` over both copies; by how much they differed, 0 if not at all.
#[inline]
pub(crate) fn exchange<const QUADS: usize>(
    new: &[[u32; 4]; QUADS],
    first: &mut [[u32; 4]; QUADS],
    second: &mut [[u32; 4]; QUADS],
) -> u32 {
    // SAFETY: three arrays of `4 QUADS` words, none of which is another.
    unsafe { quads::<QUADS>(new.as_ptr().cast(), first.as_mut_ptr().cast(), second.as_mut_ptr().cast()) }
}
