//! Caches of the core, and reads that may fail.
//!
//! Stack, statics and the filter's state are in the data TCM, which needs no cache. Both caches
//! serve the flash: the instruction cache code, the data cache weights and constants. Flash changes
//! only by erasing and programming, after which the data cache is emptied. The memory protection
//! unit excludes the memory that DMA writes, so that a read never returns old bytes, and memory
//! that the core must not read speculatively.
//!
//! Sources: PM0253 sections 4.6 (MPU) and 4.8 (caches), Armv7-M reference manual B3.2.8 (CCR),
//! AN4838 (external memory); issue 60449 of Zephyr (system memory).

use cortex_m::Peripherals;
use cortex_m::peripheral::{MPU, SCB};

#[expect(unsafe_code, reason = "the linker defines it; only its address is taken")]
unsafe extern "C" {
    /// Lowest address of the memory for DMA, from the memory map.
    static _dma_start: u32;
}

const NEVER_EXECUTE: u32 = 1 << 28;
const FULL_ACCESS: u32 = 3 << 24;
/// Attributes of normal memory that is not cached.
const NOT_CACHED: u32 = 1 << 19;
/// Attribute of strongly ordered memory that several masters share.
const SHARED: u32 = 1 << 18;
const ENABLE: u32 = 1;

/// Size field of a region of 2^`exponent` bytes.
const fn size(exponent: u32) -> u32 {
    (exponent - 1) << 1
}

/// Sets the attributes of memory for the caches and for the core's speculative accesses. To be
/// called before the MPU is enabled; of two regions the one with the higher number counts.
pub(super) fn protect(mpu: &MPU) {
    /// Subregions of 512 MB that keep the default map: code to peripherals, and the core's own.
    const INSIDE: u32 = 0x87 << 8;
    let regions = [
        // External memory, whose controllers have no clock: a speculative access would never end.
        (0, NEVER_EXECUTE | INSIDE | size(32)),
        // Memory that DMA writes is not cached.
        ((&raw const _dma_start) as u32, NEVER_EXECUTE | FULL_ACCESS | NOT_CACHED | size(17)),
        // System memory: speculative reads set the flags of protection errors of the flash.
        (0x1FF0_0000, NEVER_EXECUTE | FULL_ACCESS | SHARED | size(19)),
    ];
    for (number, (start, attributes)) in (0..).zip(regions) {
        #[expect(unsafe_code, reason = "changes the attributes of memory that nothing has used yet")]
        unsafe {
            mpu.rnr.write(number);
            mpu.rbar.write(start);
            mpu.rasr.write(attributes | ENABLE);
        }
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

/// Reads a word at each address and returns false if one of the reads was a bus error. The
/// addresses must be divisible by 4 and those of flash. Interrupts wait for a few of the reads at a
/// time.
pub(super) fn read_masked(addresses: impl Iterator<Item = usize>) -> bool {
    /// Words that are read while interrupts wait: some 10 us.
    const WORDS: usize = 64;
    let mut addresses = addresses.peekable();
    while addresses.peek().is_some() {
        if !read_few(addresses.by_ref().take(WORDS)) {
            return false;
        }
    }
    true
}

/// Reads words while bus errors are masked and interrupts wait.
fn read_few(addresses: impl Iterator<Item = usize>) -> bool {
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
