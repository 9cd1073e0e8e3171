//! Facts about the emulator (QEMU) of the default controller.
//!
//! With `-icount shift=6` it executes an instruction every 64 ns of emulated time, and its SysTick
//! runs at the frequency of the PLL whatever the clock registers contain. So the controller's
//! timer counts instructions.

use crate::clock::PLL_HZ;

/// Name of the emulated machine: the emulator's only one with an STM32F405.
pub const MACHINE: &str = "netduinoplus2";
/// Frequency of the emulated SysTick, Hz.
pub const SYSTICK_HZ: u32 = PLL_HZ;
/// Duration of an instruction in emulated time, ns.
const INSTRUCTION_NS: u32 = 64;
/// SysTick counts of an instruction: 10.752.
pub const TICKS_PER_INSTRUCTION: f64 = SYSTICK_HZ as f64 * INSTRUCTION_NS as f64 / 1e9;
