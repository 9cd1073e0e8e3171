//! Counts the instructions of the reference network's modes and of single layers, on a board whose SysTick runs at 168 MHz.
//!
//! One line a figure: name, fewest and most instructions over random inputs, multiply-accumulates.
#![no_std]
#![no_main]

use cortex_m as _;
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use inference::activation::Activation;
use inference::chain::{Chain, Then};
use inference::image::WeightForm;
use inference::{Convolution, Head, Interleaved, Same, Streaming, Windowed};
use on_target::network::{COLUMNS, INPUTS, Reference, Room, random, read, reference_shapes};
use on_target::noise::Noise;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("panicked");
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

/// SysTick as a counter of instructions: with `-icount shift=6` an instruction is 64 ns, that is 10.752 ticks at 168 MHz.
struct Counter {
    overhead: u32,
}

impl Counter {
    fn new(systick: &mut SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(0x00ff_ffff);
        systick.clear_current();
        systick.enable_counter();
        let mut counter = Self { overhead: 0 };
        counter.overhead = counter.count(|| {});
        counter
    }

    fn count(&self, work: impl FnOnce()) -> u32 {
        let before = SYST::get_current();
        work();
        let after = SYST::get_current();
        let ticks = before.wrapping_sub(after) & 0x00ff_ffff;
        // Instructions = ticks / 10.752, to the nearest.
        ((u64::from(ticks) * 1000 + 5376) / 10752) as u32 - self.overhead
    }
}

/// The extremes over many inputs.
struct Extremes(u32, u32);

impl Extremes {
    fn over(times: usize, mut once: impl FnMut() -> u32) -> Self {
        (0..times).fold(Self(u32::MAX, 0), |Self(least, most), _| {
            let count = once();
            Self(least.min(count), most.max(count))
        })
    }

    fn print(&self, name: &str, macs: usize) {
        hprintln!("{} {} {} {}", name, self.0, self.1, macs);
    }
}

const TIMES: usize = 1000;

fn column(noise: &mut Noise) -> [i16; INPUTS] {
    core::array::from_fn(|_| noise.within(32767) as i16)
}

fn modes<A: Activation>(counter: &Counter, room: &mut Room, form: WeightForm, names: [&str; 4]) -> Option<()> {
    let used = random(&reference_shapes::<A>(if A::BITS == 8 { WeightForm::Packed } else { form }, form), 1, room).ok()?;
    let network: Reference<'_, A> = read(room.0.get(..used)?).ok()?;
    let [window_name, reuse_name, stream_name, pieces_name] = names;
    let mut noise = Noise(2);
    let mut window = Windowed::<_, i16, INPUTS, COLUMNS, Same>::new(network);
    Extremes::over(TIMES, || {
        let columns: [[i16; INPUTS]; COLUMNS] = core::array::from_fn(|_| column(&mut noise));
        counter.count(|| {
            core::hint::black_box(window.evaluate(&columns));
        })
    })
    .print(window_name, 196_608);
    Extremes::over(TIMES, || {
        let newest = column(&mut noise);
        counter.count(|| {
            core::hint::black_box(window.slide(&newest));
        })
    })
    .print(reuse_name, 60_256);
    let mut stream = Streaming::<_, i16, INPUTS>::new(network);
    Extremes::over(TIMES, || {
        let newest = column(&mut noise);
        counter.count(|| {
            core::hint::black_box(stream.push(&newest));
        })
    })
    .print(stream_name, Reference::<'_, A>::MACS);
    let mut pieces = Interleaved::<_, i16, INPUTS, 4>::new(network);
    let mut tick = 0;
    Extremes::over(4 * TIMES, || {
        let newest = column(&mut noise);
        tick += 1;
        counter.count(|| {
            if tick % 4 == 1 {
                pieces.begin(&newest);
            }
            core::hint::black_box(pieces.tick());
        })
    })
    .print(pieces_name, Reference::<'_, A>::MACS / 4);
    Some(())
}

/// A layer at one position and at two neighbouring ones.
fn layer<A: Activation, const IN: usize, const OUT: usize, const K: usize>(
    counter: &Counter,
    room: &mut Room,
    form: WeightForm,
    name: &str,
) -> Option<()> {
    let shapes = [Convolution::<A, A, IN, OUT, K>::shape(form), Head::<A, OUT, 1, 1>::shape(form)];
    let used = random(&shapes, 3, room).ok()?;
    let network: Then<Convolution<'_, A, A, IN, OUT, K>, Head<'_, A, OUT, 1, 1>> = read(room.0.get(..used)?).ok()?;
    let mut noise = Noise(4);
    for (suffix, positions) in [(1usize, 1usize), (2, 2)] {
        let mut outputs = [[A::default(); OUT]; 2];
        let extremes = Extremes::over(TIMES, || {
            let inputs: [[A; IN]; 6] =
                core::array::from_fn(|_| core::array::from_fn(|_| A::from_i32(noise.within(A::MAX.cast_unsigned()))));
            let columns = inputs.get(..K - 1 + positions).unwrap_or_default();
            counter.count(|| {
                core::hint::black_box(network.layer.positions::<inference::kernel::Native>(
                    columns,
                    0,
                    0..positions,
                    &mut outputs,
                ));
            })
        });
        let Extremes(least, most) = extremes;
        hprintln!("{}_{} {} {} {}", name, suffix, least, most, K * IN * OUT * positions);
    }
    Some(())
}

fn everything(counter: &Counter, room: &mut Room) -> Option<()> {
    modes::<i16>(counter, room, WeightForm::Wide, ["reference_window", "reference_reuse", "reference_stream", "reference_interleaved_4"])?;
    Some(())
}

#[entry]
fn main() -> ! {
    let Some(mut core) = cortex_m::Peripherals::take() else { loop {} };
    let counter = Counter::new(&mut core.SYST);
    let mut room = Room([0; 20_000]);
    let done = everything(&counter, &mut room);
    layer::<i16, 16, 32, 5>(&counter, &mut room, WeightForm::Wide, "conv_16_32_5_wide");
    debug::exit(if done.is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {}
}
