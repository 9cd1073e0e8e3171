//! Caches of the core, and reads that may fail.
//!
//! Stack, statics and the filter's state are in the data TCM, which needs no cache. Both caches
//! serve the flash: the instruction cache code, the data cache weights and constants. Flash changes
//! only by erasing and programming, after which the data cache is emptied. The memory protection
//! unit excludes the memory that DMA writes, so that a read never returns old bytes.
//!
//! Sources: PM0253 sections 4.6 (MPU) and 4.8 (caches), Armv7-M reference manual B3.2.8 (CCR).

use cortex_m::Peripherals;
use cortex_m::peripheral::{MPU, SCB};

#[expect(unsafe_code, reason = "the linker defines it; only its address is taken")]
unsafe extern "C" {
    /// Lowest address of the memory for DMA, from the memory map.
    static _dma_start: u32;
}

/// Excludes the memory for DMA from the data cache. To be called before the MPU is enabled.
pub(super) fn exclude_dma(mpu: &MPU) {
    const REGION: u32 = 0;
    const NEVER_EXECUTE: u32 = 1 << 28;
    const FULL_ACCESS: u32 = 3 << 24;
    /// Normal memory that is not cached.
    const NOT_CACHED: u32 = 1 << 19;
    const SIZE_128_KB: u32 = 16 << 1;
    const ENABLE: u32 = 1;
    #[expect(unsafe_code, reason = "changes the attributes of memory that nothing has used yet")]
    unsafe {
        mpu.rnr.write(REGION);
        mpu.rbar.write((&raw const _dma_start) as u32);
        mpu.rasr.write(NEVER_EXECUTE | FULL_ACCESS | NOT_CACHED | SIZE_128_KB | ENABLE);
    }
}

/// Enables both caches. To be called after the MPU is enabled.
pub(super) fn start(core: &mut Peripherals) {
    core.SCB.enable_icache();
    core.SCB.enable_dcache(&mut core.CPUID);
}

/// Empties the data cache after flash was written.
pub(super) fn flush() {
    #[expect(
        unsafe_code,
        reason = "only the registers of the caches are used, and only here after the start"
    )]
    let mut core = unsafe { Peripherals::steal() };
    core.SCB.clean_invalidate_dcache(&mut core.CPUID);
}

/// Reads a word at each address while bus errors are masked and interrupts wait. Returns false if
/// one of the reads was a bus error. The addresses must be divisible by 4 and those of flash.
pub(super) fn read_masked(addresses: impl Iterator<Item = usize>) -> bool {
    /// Bus errors of loads are ignored at the priority of a fault handler.
    const IGNORE_BUS_FAULTS: u32 = 1 << 8;
    /// Flags of bus errors.
    const BUS_FAULTS: u32 = 0xFF00;
    #[expect(
        unsafe_code,
        reason = "reads of flash change nothing, and every register has its old value afterwards"
    )]
    unsafe {
        let scb = &*SCB::PTR;
        core::arch::asm!("cpsid f", options(nostack, preserves_flags));
        scb.ccr.modify(|value| value | IGNORE_BUS_FAULTS);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        for address in addresses {
            let _ = (address as *const u32).read_volatile();
        }
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        let has_failed = scb.cfsr.read() & BUS_FAULTS != 0;
        // Writing ones clears them.
        scb.cfsr.write(BUS_FAULTS);
        scb.ccr.modify(|value| value & !IGNORE_BUS_FAULTS);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        core::arch::asm!("cpsie f", options(nostack, preserves_flags));
        !has_failed
    }
}
