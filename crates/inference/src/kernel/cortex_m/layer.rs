//! All blocks of a convolution at one position in one go: products, scaling, clipping and storing, wide weights and 16-bit activations.
//!
//! A stream spends most of its instructions here, and at one position what surrounds the products costs as much as a quarter of them: so one
//! function does the whole layer. Six pairs of taps of four outputs take 31 instructions for their 48 products: 24 SMLAD,
//! four LDM of six weights each, three LDRD of two pairs of activations. Scaling, counting and storing four outputs take 34, one more where they are
//! stored twice.
//!
//! Clipping: USAT keeps 16 bits, so bit 15 of a half says that the output is beyond full scale; the halves of two words are counted
//! side by side. UQADD16 with 0x8000 in each half saturates exactly those, and EOR with the same takes it away again: what is left is the
//! smaller of the value and 0x7FFF.
//!
//! # Safety argument
//!
//! `K * IN` is even and the columns are `K * IN / 2` words; the weights are `blocks * K * IN / 2` groups of four words; biases,
//! multipliers (four words each) and outputs (two words) are `blocks`, which is not 0; as much memory for outputs is `N` columns of `OUT` behind these. [`run`] checks
//! all of it, and that columns and outputs stand at addresses divisible by 4, as LDRD, STRD, LDM and STM need it; otherwise it does nothing. Flags (GE and Q among them), r0 to r3, r12 and, in
//! the caller's frame, the two arguments on the stack are the function's own by the procedure call standard; it saves the other registers
//! that it uses. Its 56 bytes of stack keep the stack pointer aligned to 8, and it touches no other memory.

use crate::kernel::{BLOCK, Blocks, Quad};
use core::arch::naked_asm;

/// Products of outputs 0 to 3 with a pair of activations: `$a` to `$d` are the weights.
macro_rules! four {
    ($x:literal: $a:literal, $b:literal, $c:literal, $d:literal) => {
        concat!(two!($x: "r3", $a, "r4", $b), two!($x: "r5", $c, "r6", $d))
    };
}
/// Products of two outputs.
macro_rules! two {
    ($x:literal: $s:literal, $a:literal, $t:literal, $b:literal) => {
        concat!(
            "smlad ", $s, ", ", $a, ", ", $x, ", ", $s, "\n", "smlad ", $t, ", ", $b, ", ", $x, ", ", $t,
            "\n"
        )
    };
}
/// The next six words of weights; the next two pairs of activations.
macro_rules! weights {
    () => {
        "ldm r1!, {{r7-r11, lr}}\n"
    };
}
macro_rules! activations {
    () => {
        "ldrd r0, r12, [r2], #8\n"
    };
}
/// Six pairs of taps.
macro_rules! six {
    () => {
        concat!(
            activations!(), weights!(),
            four!("r0": "r7", "r8", "r9", "r10"), two!("r12": "r3", "r11", "r4", "lr"),
            weights!(),
            two!("r12": "r5", "r7", "r6", "r8"), activations!(), four!("r0": "r9", "r10", "r11", "lr"),
            weights!(),
            four!("r12": "r7", "r8", "r9", "r10"), activations!(), two!("r0": "r3", "r11", "r4", "lr"),
            weights!(),
            two!("r0": "r5", "r7", "r6", "r8"), four!("r12": "r9", "r10", "r11", "lr")
        )
    };
}

/// Words behind the stack pointer: biases, clipped, (columns), multipliers, nine saved registers (r12 is there for the alignment), outputs, count of blocks, which becomes the end
/// of the outputs.
#[unsafe(naked)]
unsafe extern "C" fn wide_layer<const IN: usize, const OUT: usize, const K: usize, const N: usize>(
    biases: *const [i32; BLOCK],
    weights: *const Quad,
    columns: *const u32,
    multipliers: *const [i32; BLOCK],
    outputs: *mut [u32; 2],
    blocks: usize,
) -> u32 {
    naked_asm!(
        "push {{r0-r12, lr}}",
        "mov r7, #0",
        "str r7, [sp, #4]",
        "ldrd r7, r8, [sp, #56]",
        "add r8, r7, r8, lsl #3",
        "str r8, [sp, #60]",
        "2:",
        "ldr r11, [sp]",
        "ldm r11!, {{r3-r6}}",
        "str r11, [sp]",
        ".if {turns} > 1",
        "3:",
        ".endif",
        ".if {turns}",
        ".rept 4",
        six!(),
        ".endr",
        ".endif",
        // The end of the whole turns, found by the start of the columns.
        ".if {turns} > 1",
        "ldr r7, [sp, #8]",
        "movw r8, #({turns} * 96)",
        "add r7, r8",
        "cmp r2, r7",
        "bne 3b",
        ".endif",
        ".rept {sixes}",
        six!(),
        ".endr",
        ".rept {left}",
        "ldr r0, [r2], #4",
        "ldm r1!, {{r7-r10}}",
        four!("r0": "r7", "r8", "r9", "r10"),
        ".endr",
        "ldrd r2, r11, [sp, #8]",
        "ldm r11!, {{r7-r10}}",
        "str r11, [sp, #12]",
        "mov r12, #0x80008000",
        "smmulr r3, r3, r7",
        "smmulr r4, r4, r8",
        "smmulr r5, r5, r9",
        "smmulr r6, r6, r10",
        "usat r3, #16, r3",
        "usat r4, #16, r4",
        "usat r5, #16, r5",
        "usat r6, #16, r6",
        "pkhbt r3, r3, r4, lsl #16",
        "pkhbt r5, r5, r6, lsl #16",
        "ldr r0, [sp, #4]",
        "and r4, r3, r12",
        "and r6, r5, r12",
        "add r0, r0, r4, lsr #15",
        "add r0, r0, r6, lsr #15",
        "str r0, [sp, #4]",
        "uqadd16 r3, r3, r12",
        "uqadd16 r5, r5, r12",
        "eor r3, r3, r12",
        "eor r5, r5, r12",
        "ldrd r7, r8, [sp, #56]",
        ".if {distance} > 1020",
        "movw r9, #{distance}",
        "add r9, r7",
        "stm r9, {{r3, r5}}",
        ".elseif {distance}",
        "strd r3, r5, [r7, #{distance}]",
        ".endif",
        "stm r7!, {{r3, r5}}",
        "str r7, [sp, #56]",
        "cmp r7, r8",
        "bne 2b",
        // The counts of both halves: at most 2^15 outputs each.
        "uxth r1, r0",
        "add r0, r1, r0, lsr #16",
        "add sp, #16",
        "pop {{r4-r12, pc}}",
        turns = const { K * IN / 2 / 24 },
        sixes = const { K * IN / 2 % 24 / 6 },
        left = const { K * IN / 2 % 6 },
        distance = const { distance::<OUT, N>() },
    )
}

/// Bytes from a column to its copy; one that is not at a word's address is none for this function.
const fn distance<const OUT: usize, const N: usize>() -> usize {
    let bytes = 2 * OUT * N;
    if bytes.is_multiple_of(4) { bytes } else { 0 }
}

/// Computes some blocks, if this function can, stored from `outputs` on and `N` columns of `OUT` behind that: how many outputs were clipped.
#[inline]
pub(super) fn run<const IN: usize, const OUT: usize, const K: usize, const N: usize>(
    &Blocks { weights, biases, multipliers }: &Blocks<'_>,
    columns: &[[i16; IN]; K],
    outputs: &mut [i16],
) -> Option<u32> {
    const { assert!(K * IN / 2 / 24 * 96 <= 65535 && 2 * OUT * N <= 65535) };
    let blocks = biases.len();
    let aligned = (columns.as_ptr().addr() | outputs.as_ptr().addr() | 2 * OUT * N).is_multiple_of(4);
    let whole = weights.len() == blocks.wrapping_mul(K * IN / 2)
        && outputs.len() >= OUT * N + blocks.wrapping_mul(BLOCK)
        && multipliers.len() == blocks;
    if !(K * IN).is_multiple_of(2)
        || K * IN == 0
        || !aligned
        || !whole
        || blocks == 0
        || blocks > usize::from(u16::MAX) / BLOCK
    {
        return None;
    }
    // SAFETY: the lengths and addresses are those of the argument above.
    Some(unsafe {
        wide_layer::<IN, OUT, K, N>(
            biases.as_ptr(),
            weights.as_ptr(),
            columns.as_ptr().cast(),
            multipliers.as_ptr(),
            outputs.as_mut_ptr().cast(),
            blocks,
        )
    })
}
