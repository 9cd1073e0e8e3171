//! Runs the windows of `model-quant/peers` through the shipped networks and prints the sum of each
//! on a line, in the order of the file: Babbitt collision, Babbitt friction, plastic collision,
//! plastic friction.
#![no_std]
#![no_main]

use cortex_m as _;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use inference::chain::{Chain, Sums};
use inference::{BearingMaterial, Model, Streaming, WINDOW, shipped};

/// The file, see `model-quant/peers/README.md`.
static WINDOWS: &[u8] = include_bytes!("../../../../../model-quant/peers/windows.bin");

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("panicked");
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

/// Bytes not yet read.
struct Reader(&'static [u8]);

impl Reader {
    fn u32(&mut self) -> Option<u32> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u32::from_le_bytes(*bytes))
    }

    fn i16(&mut self) -> Option<i16> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(i16::from_le_bytes(*bytes))
    }
}

fn network<N: Chain<'static, i16, IN, Output = Sums<1>> + Copy, const IN: usize>(
    windows: &mut Reader,
    network: N,
) -> Option<()> {
    let [_, columns, features, drawn, from_rows] = [(); 5].map(|()| windows.u32());
    if columns? as usize != WINDOW || features? as usize != IN {
        return None;
    }
    let mut stream = Streaming::<N, i16, IN>::new(network);
    for _ in 0..drawn?.checked_add(from_rows?)? {
        stream.reset();
        let mut sum = 0;
        for _ in 0..WINDOW {
            let mut column = [0; IN];
            for value in &mut column {
                *value = windows.i16()?;
            }
            (Sums([sum]), _) = stream.push(&column);
        }
        hprintln!("{}", sum);
    }
    Some(())
}

fn everything() -> Option<()> {
    let mut windows = Reader(WINDOWS.get(16..)?);
    let networks = Reader(WINDOWS.get(12..)?).u32()? as usize;
    for bearing in BearingMaterial::ALL.into_iter().take(networks / 2) {
        let model: Model = Model::load(shipped(bearing)).ok()?;
        network(&mut windows, *model.collision())?;
        network(&mut windows, *model.friction())?;
    }
    Some(())
}

#[entry]
fn main() -> ! {
    let done = everything();
    debug::exit(if done.is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {}
}
