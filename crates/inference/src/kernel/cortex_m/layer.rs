//! All blocks of a convolution at one position in one function: products, scaling, clipping and
//! storing, for wide weights and 16-bit activations.
//!
//! A stream spends most of its instructions here. At one position the overhead around the products
//! costs a quarter of them, so one function computes the complete layer. Six pairs of taps of four
//! outputs take 31 instructions for their 48 products: 24 SMLAD, four LDM of six weights each,
//! three LDRD of two pairs of activations. The overhead for four outputs is 29 instructions, one
//! more if they are stored twice.
//!
//! Clipping: USAT keeps 16 bits, so bit 15 of a half is set if the output exceeds full scale; both
//! halves of two words are counted side by side. UQADD16 with 0x8000 in each half saturates exactly
//! those, and EOR with the same removes it again. The result is the smaller of the value and
//! 0x7FFF.
//!
//! Biases, weights and multipliers are stored one after the other, so a single pointer, which never
//! leaves its register, passes through all of them. The function returns where it ended. That
//! differs from the end of the layer if the output pointer or its end, which are on the stack, were
//! corrupted. It does not detect a corrupted count of clipped outputs. It also does not detect a
//! corrupted pointer to the columns, which is read from the stack if a layer has more than 95 pairs
//! of taps or 4095 bytes of them.
//!
//! # Safety argument
//!
//! `K * IN` is even and the columns are `K * IN / 2` words. The layer is `blocks` (not 0) times `K
//! * IN / 2 + 2` groups of four words. There are `blocks` outputs of two words each, followed by as
//! much memory for outputs as `N` columns of `OUT`. [`run`] checks all of this, and that columns
//! and outputs are at addresses divisible by 4, as LDRD, STRD, LDM and STM require; otherwise it
//! does nothing. The output pointer is valid for all this memory. Flags (GE and Q among them), r0
//! to r3 and r12 are free to use by the procedure call standard; the function saves the other
//! registers that it uses. Its 56 bytes of stack keep the stack pointer aligned to 8. It accesses
//! no other memory.

use crate::kernel::engine::{BLOCK, LayerOutcome, Quad};
use core::arch::naked_asm;

/// Products of outputs 0 to 3 with a pair of activations: `$a` to `$d` are the weights.
macro_rules! four {
    ($x:literal: $a:literal, $b:literal, $c:literal, $d:literal) => {
        concat!(two!($x: "r4", $a, "r5", $b), two!($x: "r6", $c, "r7", $d))
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
        "ldm r2!, {{r8-r12, lr}}\n"
    };
}
macro_rules! activations {
    () => {
        "ldrd r0, r1, [r3], #8\n"
    };
}
/// Six pairs of taps.
macro_rules! six {
    () => {
        concat!(
            activations!(), weights!(),
            four!("r0": "r8", "r9", "r10", "r11"), two!("r1": "r4", "r12", "r5", "lr"),
            weights!(),
            two!("r1": "r6", "r8", "r7", "r9"), activations!(), four!("r0": "r10", "r11", "r12", "lr"),
            weights!(),
            four!("r1": "r8", "r9", "r10", "r11"), activations!(), two!("r0": "r4", "r12", "r5", "lr"),
            weights!(),
            two!("r0": "r6", "r8", "r7", "r9"), four!("r1": "r10", "r11", "r12", "lr")
        )
    };
}

/// Words above the stack pointer: outputs, their end, clipped, columns, ten saved registers (r12
/// for alignment). Returns the number of clipped outputs and, in the upper half, the final weight
/// pointer.
#[unsafe(naked)]
unsafe extern "C" fn wide_layer<const IN: usize, const OUT: usize, const K: usize, const N: usize>(
    outputs: *mut i16,
    end: *const i16,
    blocks: *const Quad,
    columns: *const u32,
) -> u64 {
    naked_asm!(
        "push {{r0-r12, lr}}",
        "mov r0, #0",
        "str r0, [sp, #8]",
        "2:",
        "ldm r2!, {{r4-r7}}",
        ".if {turns} > 1",
        "3:",
        ".endif",
        ".if {turns}",
        ".rept 4",
        six!(),
        ".endr",
        ".endif",
        // The end of the complete turns, computed from the start of the columns.
        ".if {turns} > 1",
        "ldr r8, [sp, #12]",
        "movw r9, #({turns} * 96)",
        "add r8, r9",
        "cmp r3, r8",
        "bne 3b",
        ".endif",
        ".rept {sixes}",
        six!(),
        ".endr",
        ".rept {left}",
        "ldr r0, [r3], #4",
        "ldm r2!, {{r8-r11}}",
        four!("r0": "r8", "r9", "r10", "r11"),
        ".endr",
        ".if {bytes} > 4095",
        "ldr r3, [sp, #12]",
        ".else",
        "subw r3, r3, #{bytes}",
        ".endif",
        "ldm r2!, {{r8-r11}}",
        "mov r12, #0x80008000",
        "smmulr r4, r4, r8",
        "smmulr r5, r5, r9",
        "smmulr r6, r6, r10",
        "smmulr r7, r7, r11",
        "usat r4, #16, r4",
        "usat r5, #16, r5",
        "usat r6, #16, r6",
        "usat r7, #16, r7",
        "pkhbt r4, r4, r5, lsl #16",
        "pkhbt r6, r6, r7, lsl #16",
        "ldr r0, [sp, #8]",
        "and r5, r4, r12",
        "and r7, r6, r12",
        "add r0, r0, r5, lsr #15",
        "add r0, r0, r7, lsr #15",
        "str r0, [sp, #8]",
        "uqadd16 r4, r4, r12",
        "uqadd16 r6, r6, r12",
        "eor r4, r4, r12",
        "eor r6, r6, r12",
        "ldrd r8, r9, [sp]",
        ".if {distance} > 1020",
        "movw r10, #{distance}",
        "add r10, r8",
        "stm r10, {{r4, r6}}",
        ".elseif {distance}",
        "strd r4, r6, [r8, #{distance}]",
        ".endif",
        "stm r8!, {{r4, r6}}",
        "str r8, [sp]",
        "cmp r8, r9",
        "bne 2b",
        // The counts of both halves: at most 2^15 outputs each.
        "uxth r1, r0",
        "add r0, r1, r0, lsr #16",
        "mov r1, r2",
        "add sp, #16",
        "pop {{r4-r12, pc}}",
        turns = const { K * IN / 2 / 24 },
        sixes = const { K * IN / 2 % 24 / 6 },
        left = const { K * IN / 2 % 6 },
        bytes = const { K * IN * 2 },
        distance = const { distance::<OUT, N>() },
    )
}

/// Returns the bytes from a column to its copy; 0 if the copy is not word-aligned, which this
/// function does not support.
const fn distance<const OUT: usize, const N: usize>() -> usize {
    let bytes = 2 * OUT * N;
    if bytes.is_multiple_of(4) { bytes } else { 0 }
}

/// Computes some blocks if this function supports the shape. Stores the outputs in `outputs` and
/// `N` columns of `OUT` after it.
#[inline]
pub(super) fn run<const IN: usize, const OUT: usize, const K: usize, const N: usize>(
    blocks: &[Quad],
    columns: &[[i16; IN]; K],
    outputs: &mut [i16],
) -> Option<LayerOutcome> {
    const { assert!(K * IN / 2 / 24 * 96 <= 65535 && 2 * OUT * N <= 65535) };
    let aligned = (columns.as_ptr().addr() | outputs.as_ptr().addr() | 2 * OUT * N).is_multiple_of(4);
    let block = K * IN / 2 + 2;
    let count = blocks.len() / block;
    let is_complete =
        blocks.len().is_multiple_of(block) && outputs.len() >= OUT * N + count.wrapping_mul(BLOCK);
    if !(K * IN).is_multiple_of(2)
        || K * IN == 0
        || !aligned
        || !is_complete
        || count == 0
        || count > usize::from(u16::MAX) / BLOCK
    {
        return None;
    }
    let start = outputs.as_mut_ptr();
    let end = start.wrapping_add(count.wrapping_mul(BLOCK));
    // SAFETY: lengths and addresses match the module's safety argument.
    let done = unsafe { wide_layer::<IN, OUT, K, N>(start, end, blocks.as_ptr(), columns.as_ptr().cast()) };
    let last = blocks.as_ptr_range().end.addr() as u32;
    Some(LayerOutcome { clipped: done as u32, corruption: (done >> 32) as u32 ^ last })
}
