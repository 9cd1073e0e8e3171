//! Guard at the bottom of the stack.
//!
//! Armv7-M: region 7 of the MPU forbids access to the lowest bytes of the stack; the default map
//! holds elsewhere. A frame larger than the guard skips it and leaves the RAM, which is a bus error
//! and is reported as well.
//!
//! Armv8-M: the core's stack limit register.
//!
//! Memory, bus and usage faults stay disabled and escalate to the hard fault handler, which the MPU
//! does not restrict.

use super::memory;

/// Sets up the MPU region.
#[cfg(not(stack_limit_register))]
pub(super) fn set(mpu: &cortex_m::peripheral::MPU) {
    const REGION: u32 = 7;
    const NEVER_EXECUTE: u32 = 1 << 28;
    const SIZE_256: u32 = 7 << 1;
    const ENABLE: u32 = 1;
    const DEFAULT_MAP: u32 = 1 << 2;
    const { assert!(memory::GUARD_BYTES == 256, "the region's size says 256") };
    #[expect(
        unsafe_code,
        reason = "forbids memory without use: the memory map aligns the stack to the region's size"
    )]
    unsafe {
        mpu.rnr.write(REGION);
        mpu.rbar.write(memory::stack_lowest());
        mpu.rasr.write(NEVER_EXECUTE | SIZE_256 | ENABLE);
        mpu.ctrl.write(DEFAULT_MAP | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Sets the stack limit.
#[cfg(stack_limit_register)]
pub(super) fn set(_mpu: &cortex_m::peripheral::MPU) {
    #[expect(unsafe_code, reason = "the limit is below everything that uses the stack")]
    unsafe {
        core::arch::asm!(
            "msr MSPLIM, {}",
            in(reg) memory::guard_end(),
            options(nomem, nostack, preserves_flags)
        );
    }
}
