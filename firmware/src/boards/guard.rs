//! The guard below the stack.
//!
//! Armv7-M: region 7 of the MPU forbids the lowest bytes of the stack's room to everybody; everything else stays as the default map has
//! it. A frame larger than the guard jumps over it and leaves the RAM, which is a bus error: reported just the same.
//! Armv8-M: the core's own limit register.
//! Faults are not split: memory, bus and usage faults are left disabled and escalate to the one hard fault handler, which the MPU does not
//! bind.

use super::memory;

/// Sets the guard.
#[cfg(feature = "stm32f405")]
pub(super) fn set(mpu: &cortex_m::peripheral::MPU) {
    const REGION: u32 = 7;
    const NEVER_EXECUTE: u32 = 1 << 28;
    const SIZE_256: u32 = 7 << 1;
    const ENABLE: u32 = 1;
    const DEFAULT_MAP: u32 = 1 << 2;
    const { assert!(memory::GUARD_BYTES == 256, "the region's size says 256") };
    #[expect(unsafe_code, reason = "forbids only what nobody may touch: the memory map aligns the stack to the region's size")]
    unsafe {
        mpu.rnr.write(REGION);
        mpu.rbar.write(memory::stack_lowest());
        mpu.rasr.write(NEVER_EXECUTE | SIZE_256 | ENABLE);
        mpu.ctrl.write(DEFAULT_MAP | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Sets the limit.
#[cfg(feature = "mps2-an505")]
pub(super) fn set() {
    #[expect(unsafe_code, reason = "the limit is below everything that uses the stack")]
    unsafe {
        core::arch::asm!("msr MSPLIM, {}", in(reg) memory::guard_end(), options(nomem, nostack, preserves_flags));
    }
}
