//! Smallest program that uses the crate: a shipped model, samples in, forces out, no floating
//! point. The build checks its symbols and its size.
#![no_std]
#![no_main]

use core::ptr::{read_volatile, write_volatile};
use cortex_m as _;
use cortex_m_rt::entry;
use inference::{BearingMaterial, Model, Pair, Sample, shipped};

/// Linked only if a panic is reachable.
#[unsafe(no_mangle)]
static PINTLE_PANIC_MARKER: u32 = 0x0BAD_F00D;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: reads a constant.
    let _ = unsafe { read_volatile(&raw const PINTLE_PANIC_MARKER) };
    loop {}
}

static mut SAMPLE: Sample = Sample {
    radial_clearance_nm: 500_000,
    deformation_pm: 30_000_000,
    deformation_rate_nm_s: 0,
    approach_speed_nm_s: 0,
    sliding_speed_nm_s: 100_000_000,
};
static mut FORCE_MN: i32 = 0;

#[entry]
fn main() -> ! {
    loop {
        let Ok(model) = Model::load(shipped(BearingMaterial::Babbitt)) else { loop {} };
        let mut pair: Pair = Pair::new(model);
        for _ in 0..1000 {
            // SAFETY: nothing else accesses these; volatile, so that the work is not optimised
            // away.
            unsafe {
                let sample = read_volatile(&raw const SAMPLE);
                write_volatile(&raw mut FORCE_MN, pair.step(&sample).normal_force_mn);
            }
        }
    }
}
