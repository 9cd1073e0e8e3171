//! Prints the digest of `on_target::agreement` with both engines of the core and, with
//! an FPU, that of `on_target::filter`.
#![no_std]
#![no_main]

use cortex_m as _;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use inference::kernel::{Native, Portable};
use on_target::agreement::digest;
use on_target::network::Room;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("panicked");
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

#[entry]
fn main() -> ! {
    let mut room = Room([0; 20_000]);
    for seed in 1..=4 {
        for found in [digest::<Portable>(seed, &mut room), digest::<Native>(seed, &mut room)] {
            hprintln!("{} {:016x}", seed, found.map_or(0, |digest| digest.0));
        }
    }
    #[cfg(feature = "filter")]
    hprintln!("filter {:016x}", on_target::filter::digest().unwrap_or(0));
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}
