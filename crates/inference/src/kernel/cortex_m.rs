//! Kernels with the DSP instructions of Cortex-M4, M7, M33 and M55.
//!
//! Together with its submodules this is the only unsafe code of the crate: `layer` computes all
//! blocks of a layer at once, `difference` compares the two copies of a column.
//!
//! SMLAD adds two products of 16-bit halves to a sum. A pair of taps at two positions and four
//! outputs takes 12 instructions for its 16 products: eight SMLAD, two loads of activations, two
//! LDM of two weights each. Sums, weights and activations use all fourteen registers, so the end of
//! the loop is on the stack. SXTB16 widens two packed weights per instruction.
//!
//! Shapes are constants of the functions. Four groups of taps are computed per turn, the remaining
//! ones are unrolled after the loop, and no branch depends on data. The number of instructions
//! depends on the shape only. One exception: if a column is no integer number of words (odd `IN` of
//! 16 bits), that of a head also depends on the address of the columns.
//!
//! # Safety argument
//!
//! The functions read `K` (or, at two positions, `K + 1`) columns and `groups` groups of weights
//! and write the sums. The safe wrappers check both lengths and do nothing if they are wrong. An
//! odd tap at the end is loaded alone, so no load exceeds the columns. The other half is 0, so the
//! weights that pad a group have no effect.
//!
//! LDM and LDRD load the weights; they need addresses divisible by 4, and weights are words. LDR,
//! LDRH and LDRB load the activations. They accept any address of normal memory (all RAM and flash,
//! unless an MPU region forbids it) while CCR.UNALIGN_TRP is clear, as it is after a reset. With it
//! set, or in device memory, an odd column causes a usage fault, not a wrong sum. The one LDM of
//! activations follows a test of their address. The sums are i32, hence aligned.
//!
//! The functions follow the procedure call standard. They save r4 to r11 and lr if they use them;
//! r12 and the flags are free to use (SMLAD may set Q, which no code reads). They use 48, 40 and 32
//! bytes of stack, which keeps it aligned to 8. Nothing is stored below the stack pointer, where an
//! interrupt writes. They access no other memory. A shape whose constants do not fit their
//! instructions does not compile: MOVW holds 65535, an offset of LDR 4095.
#![allow(unsafe_code)]

mod difference;
mod layer;

pub(crate) use difference::difference;

use super::engine::{BLOCK, Engine, Kernel, LayerOutcome, Quad, blockwise};
use crate::activation::Activation;
use crate::storage::{Packed8, Packed16, Storage, Wide, groups};
use core::arch::{asm, naked_asm};

/// Engine of Cortex-M cores with the DSP instructions.
#[derive(Clone, Copy, Debug)]
pub struct CortexM;

impl Engine for CortexM {
    #[inline]
    fn requantise(sum: i32, multiplier: i32) -> i32 {
        let value;
        // SAFETY: one instruction on registers: the upper half of the product, rounded.
        unsafe {
            asm!("smmulr {}, {}, {}", lateout(reg) value, in(reg) sum, in(reg) multiplier,
                options(pure, nomem, nostack, preserves_flags));
        }
        value
    }
}

/// See [`super::read_anew`].
#[inline]
pub(super) fn read_anew<T>(value: &mut T) {
    // SAFETY: no instruction is emitted; the compiler only has to assume that everything that may
    // be written through the pointer has been written.
    unsafe { asm!("// {}", in(reg) core::ptr::from_mut(value), options(nostack, preserves_flags)) }
}

/// Multiplies a pair of weights for outputs 0 and 1 (in r11, r12) by activations r0 (first
/// position) and lr (second).
macro_rules! four_low {
    () => {
        "smlad r3, r11, r0, r3\n smlad r4, r12, r0, r4\n smlad r7, r11, lr, r7\n smlad r8, r12, lr, r8\n"
    };
}
/// The same for outputs 2 and 3.
macro_rules! four_high {
    () => {
        "smlad r5, r11, r0, r5\n smlad r6, r12, r0, r6\n smlad r9, r11, lr, r9\n smlad r10, r12, lr, r10\n"
    };
}
/// Multiplies two pairs of weights at a time, as they are stored, by the activations in r0 and lr.
macro_rules! wide_quad {
    () => {
        concat!("ldm r1!, {{r11, r12}}\n", four_low!(), "ldm r1!, {{r11, r12}}\n", four_high!())
    };
}
/// Bytes 0 and 2 of each of four words of weights.
macro_rules! even_quad {
    () => {
        concat!(
            "ldrd r11, r12, [r1]\n sxtb16 r11, r11\n sxtb16 r12, r12\n",
            four_low!(),
            "ldrd r11, r12, [r1, #8]\n sxtb16 r11, r11\n sxtb16 r12, r12\n",
            four_high!()
        )
    };
}
/// Bytes 1 and 3 of each of four words of weights; advances to the next four.
macro_rules! odd_quad {
    () => {
        concat!(
            "ldrd r11, r12, [r1], #8\n sxtb16 r11, r11, ror #8\n sxtb16 r12, r12, ror #8\n",
            four_low!(),
            "ldrd r11, r12, [r1], #8\n sxtb16 r11, r11, ror #8\n sxtb16 r12, r12, ror #8\n",
            four_high!()
        )
    };
}

/// Four outputs, two positions: `r0` sums, `r1` weights, `r2` columns; `$full` multiplies one
/// complete group, `$rest` the last, partial one. `{step}` is the distance of the positions,
/// `{turns}` and `{left}` count the complete groups in and after the loop.
macro_rules! pair {
    ($full:expr, $rest:expr) => {
        concat!(
            "push {{r4-r11, lr}}\n sub sp, #12\n str r0, [sp, #4]\n ldm r0, {{r3-r10}}\n",
            ".if {turns}\n movw r0, #({turns} * 64)\n add r0, r1\n str r0, [sp]\n",
            "2:\n .rept 4\n",
            $full,
            ".endr\n ldr r11, [sp]\n cmp r1, r11\n bne 2b\n .endif\n",
            ".rept {left}\n",
            $full,
            ".endr\n",
            $rest,
            "ldr r0, [sp, #4]\n stm r0, {{r3-r10}}\n add sp, #12\n pop {{r4-r11, pc}}\n"
        )
    };
}

/// Four outputs, one position.
macro_rules! block {
    ($full:expr, $rest:expr) => {
        concat!(
            "push {{r0, r4-r11, lr}}\n ldm r0, {{r3-r6}}\n",
            ".if {turns}\n movw r11, #({turns} * 64)\n add r11, r1\n",
            "2:\n .rept 4\n",
            $full,
            ".endr\n cmp r1, r11\n bne 2b\n .endif\n",
            ".rept {left}\n",
            $full,
            ".endr\n",
            $rest,
            "pop {{r0}}\n stm r0, {{r3-r6}}\n pop {{r4-r11, lr}}\n bx lr\n"
        )
    };
}

/// One output, one position: sum in `r0`. `$four` multiplies four complete groups, `$full` one.
macro_rules! row {
    ($four:expr, $full:expr, $rest:expr) => {
        concat!(
            "push {{r4-r10, lr}}\n",
            ".if {turns}\n movw r3, #({turns} * 16)\n add r3, r1\n",
            $four,
            ".endif\n",
            ".rept {left}\n",
            $full,
            ".endr\n",
            $rest,
            "pop {{r4-r10, pc}}\n"
        )
    };
}

/// Four groups, one after the other.
macro_rules! four_times {
    ($full:expr) => {
        concat!("2:\n .rept 4\n", $full, ".endr\n cmp r1, r3\n bne 2b\n")
    };
}

/// Defines the three functions of one storage form and their wrappers.
macro_rules! kernel {
    (
        $storage:ty, $taps:literal, $bytes:literal,
        $pair:ident: $pair_text:expr, $block:ident: $block_text:expr, $row:ident: $row_text:expr
        $(, $($more:tt)*)?
    ) => {
        #[unsafe(naked)]
        unsafe extern "C" fn $pair<const IN: usize, const K: usize>(
            sums: *mut i32,
            weights: *const u32,
            columns: *const u8,
        ) {
            naked_asm!(
                $pair_text,
                step = const { IN * $bytes },
                turns = const { K * IN / $taps / 4 },
                left = const { K * IN / $taps % 4 },
                rest = const { K * IN % $taps },
            )
        }

        #[unsafe(naked)]
        unsafe extern "C" fn $block<const IN: usize, const K: usize>(
            sums: *mut i32,
            weights: *const u32,
            columns: *const u8,
        ) {
            naked_asm!(
                $block_text,
                turns = const { K * IN / $taps / 4 },
                left = const { K * IN / $taps % 4 },
                rest = const { K * IN % $taps },
            )
        }

        #[unsafe(naked)]
        unsafe extern "C" fn $row<const IN: usize, const K: usize>(
            sum: i32,
            weights: *const u32,
            columns: *const u8,
        ) -> i32 {
            naked_asm!(
                $row_text,
                turns = const { K * IN / $taps / 4 },
                left = const { K * IN / $taps % 4 },
                rest = const { K * IN % $taps },
            )
        }

        impl Kernel<$storage> for CortexM {
            #[inline]
            fn pair<const IN: usize, const K: usize>(
                weights: &[Quad],
                columns: &[[<$storage as Storage>::Activation; IN]],
                sums: &mut [[i32; BLOCK]; 2],
            ) {
                const { assert!(IN * $bytes + 16 <= 4095 && K * IN / $taps / 4 * 64 <= 65535) };
                if weights.len() == groups::<$storage>(K * IN) && columns.len() == K + 1 {
                    // SAFETY: the lengths match the module's safety argument.
                    unsafe {
                        $pair::<IN, K>(
                            sums.as_mut_ptr().cast(),
                            weights.as_ptr().cast(),
                            columns.as_ptr().cast(),
                        )
                    }
                }
            }

            #[inline]
            fn block<const IN: usize, const K: usize>(
                weights: &[Quad],
                columns: &[[<$storage as Storage>::Activation; IN]; K],
                sums: &mut [i32; BLOCK],
            ) {
                const { assert!(K * IN / $taps / 4 * 64 <= 65535) };
                if weights.len() == groups::<$storage>(K * IN) {
                    // SAFETY: as above.
                    unsafe {
                        $block::<IN, K>(sums.as_mut_ptr(), weights.as_ptr().cast(), columns.as_ptr().cast())
                    }
                }
            }

            #[inline]
            fn row<const IN: usize, const K: usize>(
                weights: &[u32],
                columns: &[[<$storage as Storage>::Activation; IN]; K],
                sum: i32,
            ) -> i32 {
                const { assert!(K * IN / $taps / 4 * 16 <= 65535) };
                if weights.len() != groups::<$storage>(K * IN) {
                    return sum;
                }
                // SAFETY: as above.
                unsafe { $row::<IN, K>(sum, weights.as_ptr(), columns.as_ptr().cast()) }
            }

            $($($more)*)?
        }
    };
}

kernel!(Wide, 2, 2,
    wide_pair: pair!(
        concat!("ldr lr, [r2, #{step}]\n ldr r0, [r2], #4\n", wide_quad!()),
        concat!(".if {rest}\n ldrh lr, [r2, #{step}]\n ldrh r0, [r2]\n", wide_quad!(), ".endif\n")
    ),
    wide_block: block!(
        "ldr r0, [r2], #4\n ldm r1!, {{r7-r10}}\n smlad r3, r7, r0, r3\n smlad r4, r8, r0, r4\n \
         smlad r5, r9, r0, r5\n smlad r6, r10, r0, r6\n",
        ".if {rest}\n ldrh r0, [r2]\n ldm r1!, {{r7-r10}}\n smlad r3, r7, r0, r3\n smlad r4, r8, r0, r4\n \
         smlad r5, r9, r0, r5\n smlad r6, r10, r0, r6\n .endif\n"
    ),
    wide_row: row!(
        // Activations at an address divisible by 4 are loaded four words at once.
        concat!(
            "tst r2, #3\n bne 3f\n",
            "2:\n ldm r1!, {{r4-r7}}\n ldm r2!, {{r8-r10, r12}}\n",
            "smlad r0, r4, r8, r0\n smlad r0, r5, r9, r0\n smlad r0, r6, r10, r0\n smlad r0, r7, r12, r0\n",
            "cmp r1, r3\n bne 2b\n b 4f\n",
            "3:\n ldm r1!, {{r4-r7}}\n ldr r8, [r2], #4\n ldr r9, [r2], #4\n ldr r10, [r2], #4\n",
            "ldr r12, [r2], #4\n",
            "smlad r0, r4, r8, r0\n smlad r0, r5, r9, r0\n smlad r0, r6, r10, r0\n smlad r0, r7, r12, r0\n",
            "cmp r1, r3\n bne 3b\n",
            "4:\n"
        ),
        "ldr r4, [r1], #4\n ldr r12, [r2], #4\n smlad r0, r4, r12, r0\n",
        ".if {rest}\n ldr r4, [r1], #4\n ldrh r12, [r2]\n smlad r0, r4, r12, r0\n .endif\n"
    ),
    #[inline]
    fn blocks<B: Activation, const IN: usize, const OUT: usize, const K: usize, const N: usize>(
        blocks: &[Quad],
        columns: &[[i16; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> LayerOutcome {
        let wide = if B::BITS == 16 {
            bytemuck::try_cast_slice_mut(outputs.as_flattened_mut()).ok()
        } else {
            None
        };
        match wide.and_then(|outputs| layer::run::<IN, OUT, K, N>(blocks, columns, outputs)) {
            Some(outcome) => outcome,
            None => blockwise::<Self, Wide, B, IN, OUT, K, N>(blocks, columns, outputs),
        }
    }
);

/// Multiplies two pairs of weights of four outputs, unpacked from r7 to r10, by the activations in
/// r0 and r12.
macro_rules! packed_block {
    () => {
        concat!(
            "ldm r1!, {{r7-r10}}\n",
            "sxtb16 lr, r7\n smlad r3, lr, r0, r3\n sxtb16 r7, r7, ror #8\n smlad r3, r7, r12, r3\n",
            "sxtb16 lr, r8\n smlad r4, lr, r0, r4\n sxtb16 r8, r8, ror #8\n smlad r4, r8, r12, r4\n",
            "sxtb16 lr, r9\n smlad r5, lr, r0, r5\n sxtb16 r9, r9, ror #8\n smlad r5, r9, r12, r5\n",
            "sxtb16 lr, r10\n smlad r6, lr, r0, r6\n sxtb16 r10, r10, ror #8\n smlad r6, r10, r12, r6\n"
        )
    };
}
/// Multiplies the weights of one output by the activations in r12 and lr.
macro_rules! packed_row {
    () => {
        "ldr r4, [r1], #4\n sxtb16 r5, r4\n smlad r0, r5, r12, r0\n sxtb16 r4, r4, ror #8\n \
         smlad r0, r4, lr, r0\n"
    };
}

kernel!(Packed16, 4, 2,
    packed16_pair: pair!(
        concat!(
            "ldr lr, [r2, #{step}]\n ldr r0, [r2], #4\n", even_quad!(),
            "ldr lr, [r2, #{step}]\n ldr r0, [r2], #4\n", odd_quad!()
        ),
        concat!(
            ".if {rest} == 1\n ldrh lr, [r2, #{step}]\n ldrh r0, [r2]\n", even_quad!(), ".endif\n",
            ".if {rest} > 1\n ldr lr, [r2, #{step}]\n ldr r0, [r2], #4\n", even_quad!(), ".endif\n",
            ".if {rest} == 3\n ldrh lr, [r2, #{step}]\n ldrh r0, [r2]\n", odd_quad!(), ".endif\n"
        )
    ),
    packed16_block: block!(
        concat!("ldr r0, [r2], #4\n ldr r12, [r2], #4\n", packed_block!()),
        concat!(
            ".if {rest} == 1\n ldrh r0, [r2]\n mov r12, #0\n .endif\n",
            ".if {rest} == 2\n ldr r0, [r2]\n mov r12, #0\n .endif\n",
            ".if {rest} == 3\n ldr r0, [r2]\n ldrh r12, [r2, #4]\n .endif\n",
            ".if {rest}\n", packed_block!(), ".endif\n"
        )
    ),
    packed16_row: row!(
        four_times!(concat!("ldr r12, [r2], #4\n ldr lr, [r2], #4\n", packed_row!())),
        concat!("ldr r12, [r2], #4\n ldr lr, [r2], #4\n", packed_row!()),
        concat!(
            ".if {rest} == 1\n ldrh r12, [r2]\n mov lr, #0\n .endif\n",
            ".if {rest} == 2\n ldr r12, [r2]\n mov lr, #0\n .endif\n",
            ".if {rest} == 3\n ldr r12, [r2]\n ldrh lr, [r2, #4]\n .endif\n",
            ".if {rest}\n", packed_row!(), ".endif\n"
        )
    )
);

/// Loads the remaining bytes of a group at `[r2, #offset]` into a register; `$spare` is
/// overwritten.
macro_rules! bytes_left {
    ($register:literal, $spare:literal, $offset:literal) => {
        concat!(
            ".if {rest} == 1\n ldrb ",
            $register,
            ", [r2, #",
            $offset,
            "]\n .endif\n",
            ".if {rest} > 1\n ldrh ",
            $register,
            ", [r2, #",
            $offset,
            "]\n .endif\n",
            ".if {rest} == 3\n ldrb ",
            $spare,
            ", [r2, #(",
            $offset,
            " + 2)]\n",
            "orr ",
            $register,
            ", ",
            $register,
            ", ",
            $spare,
            ", lsl #16\n .endif\n"
        )
    };
}

kernel!(Packed8, 4, 1,
    packed8_pair: pair!(
        concat!(
            "ldr lr, [r2, #{step}]\n ldr r0, [r2]\n sxtb16 lr, lr\n sxtb16 r0, r0\n", even_quad!(),
            "ldr lr, [r2, #{step}]\n ldr r0, [r2], #4\n sxtb16 lr, lr, ror #8\n sxtb16 r0, r0, ror #8\n",
            odd_quad!()
        ),
        concat!(
            ".if {rest}\n",
            bytes_left!("lr", "r11", "{step}"), bytes_left!("r0", "r11", "0"),
            "sxtb16 lr, lr\n sxtb16 r0, r0\n", even_quad!(),
            ".endif\n.if {rest} > 1\n",
            bytes_left!("lr", "r11", "{step}"), bytes_left!("r0", "r11", "0"),
            "sxtb16 lr, lr, ror #8\n sxtb16 r0, r0, ror #8\n", odd_quad!(),
            ".endif\n"
        )
    ),
    packed8_block: block!(
        concat!("ldr r12, [r2], #4\n sxtb16 r0, r12\n sxtb16 r12, r12, ror #8\n", packed_block!()),
        concat!(
            ".if {rest}\n", bytes_left!("r12", "r0", "0"),
            "sxtb16 r0, r12\n sxtb16 r12, r12, ror #8\n", packed_block!(), ".endif\n"
        )
    ),
    packed8_row: row!(
        four_times!(concat!("ldr lr, [r2], #4\n sxtb16 r12, lr\n sxtb16 lr, lr, ror #8\n", packed_row!())),
        concat!("ldr lr, [r2], #4\n sxtb16 r12, lr\n sxtb16 lr, lr, ror #8\n", packed_row!()),
        concat!(
            ".if {rest}\n", bytes_left!("lr", "r12", "0"),
            "sxtb16 r12, lr\n sxtb16 lr, lr, ror #8\n", packed_row!(), ".endif\n"
        )
    )
);
