//! Counts the instructions of the reference network's modes, of single layers and of an estimate's
//! frame, on a board whose SysTick runs at 168 MHz.
//!
//! Prints one line per figure: name, minimum and maximum of the instructions over random inputs,
//! multiply-accumulates.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m as _;
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use inference::chain::{Chain, Then};
use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use inference::image::WeightForm;
use inference::word_sum::WordSum;
use inference::kernel::{Engine, Native, Portable};
use inference::{
    BearingMaterial, Convolution, Head, LayerInput, Model, Network, Pair, Same, Sample, Streaming, Windowed,
    shipped,
};
use controller::filter::Filter;
use link::{ESTIMATE_FRAME, EstimateLayout, NumberedEstimate, VALUES, encode_estimate};
use on_target::filter::Orbit;
use on_target::network::{COLUMNS, INPUTS, Reference, Room, random, read, reference_shapes};
use on_target::noise::Noise;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("panicked");
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

/// SysTick as an instruction counter: with `-icount shift=6` an instruction takes 64 ns, which is
/// 10.752 ticks at 168 MHz.
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
        // Instructions = ticks / 10.752, rounded to nearest.
        ((u64::from(ticks) * 1000 + 5376) / 10752) as u32 - self.overhead
    }
}

/// Minimum and maximum over many inputs.
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

/// Number of random inputs for each figure.
const TIMES: usize = 1000;
/// All positions of the window.
const REFERENCE_WINDOW_MACS: usize = 32 * (5 * 6 * 16 + 5 * 16 * 32 + 3 * 32 * 32) + 32 * 32;
/// Work of a move by one column: 5, 9 and 11 positions of 32, and the dense layer.
const REFERENCE_REUSE_MACS: usize = 5 * 5 * 6 * 16 + 9 * 5 * 16 * 32 + 11 * 3 * 32 * 32 + 32 * 32;

type Collision<'a> = Network<'a, i16, COLLISION_INPUTS>;
type Friction<'a> = Network<'a, i16, FRICTION_INPUTS>;

fn column(noise: &mut Noise) -> [i16; INPUTS] {
    core::array::from_fn(|_| noise.within(32767) as i16)
}

/// Counts the reference network in every mode.
fn modes<A: LayerInput, E: Engine>(
    counter: &Counter,
    room: &mut Room,
    form: WeightForm,
    [window_name, reuse_name, stream_name]: [&str; 3],
) -> Option<()> {
    let used = random(&reference_shapes::<A>(form, form), 1, room).ok()?;
    let network: Reference<'_, A> = read(room.0.get(..used)?).ok()?;
    let mut noise = Noise(2);
    let mut window = Windowed::<_, i16, INPUTS, COLUMNS, Same, E>::new(network);
    Extremes::over(TIMES, || {
        let columns: [[i16; INPUTS]; COLUMNS] = core::array::from_fn(|_| column(&mut noise));
        counter.count(|| {
            black_box(window.evaluate(&columns));
        })
    })
    .print(window_name, REFERENCE_WINDOW_MACS);
    Extremes::over(TIMES, || {
        let newest = column(&mut noise);
        counter.count(|| {
            black_box(window.slide(&newest));
        })
    })
    .print(reuse_name, REFERENCE_REUSE_MACS);
    let mut stream = Streaming::<_, i16, INPUTS, E>::new(network);
    Extremes::over(TIMES, || {
        let newest = column(&mut noise);
        counter.count(|| {
            black_box(stream.push(&newest));
        })
    })
    .print(stream_name, Reference::<'_, A>::MACS);
    Some(())
}

/// Counts a layer at one position and at two neighbouring positions.
fn layer<A: LayerInput, const IN: usize, const OUT: usize, const K: usize>(
    counter: &Counter,
    room: &mut Room,
    form: WeightForm,
    mode: &str,
) -> Option<()> {
    let shapes = [Convolution::<A, A, IN, OUT, K>::shape(form), Head::<A, OUT, 1, 1>::shape(form)];
    let used = random(&shapes, 3, room).ok()?;
    let network: Then<Convolution<'_, A, A, IN, OUT, K>, Head<'_, A, OUT, 1, 1>> =
        read(room.0.get(..used)?).ok()?;
    let mut noise = Noise(4);
    for positions in [1usize, 2] {
        let mut outputs = [[A::default(); OUT]; 2];
        let Extremes(least, most) = Extremes::over(TIMES, || {
            let inputs: [[A; IN]; 6] = core::array::from_fn(|_| {
                core::array::from_fn(|_| A::from_i32(noise.within(A::MAX.cast_unsigned())))
            });
            let columns = inputs.get(..K - 1 + positions).unwrap_or_default();
            counter.count(|| {
                black_box(network.layer.positions::<Native>(columns, 0, 0..positions, &mut outputs));
            })
        });
        let macs = K * IN * OUT * positions;
        hprintln!("convolution_{}x{}_to_{}_{}_{} {} {} {}", K, IN, OUT, mode, positions, least, most, macs);
    }
    Some(())
}

/// Counts one dense output.
fn head<A: LayerInput, const IN: usize, const COLUMNS: usize>(
    counter: &Counter,
    room: &mut Room,
    form: WeightForm,
    mode: &str,
) -> Option<()> {
    let used = random(&[Head::<A, IN, COLUMNS, 1>::shape(form)], 3, room).ok()?;
    let head: Head<'_, A, IN, COLUMNS, 1> = read(room.0.get(..used)?).ok()?;
    let mut noise = Noise(4);
    let Extremes(least, most) = Extremes::over(TIMES, || {
        let inputs: [[A; IN]; COLUMNS] = core::array::from_fn(|_| {
            core::array::from_fn(|_| A::from_i32(noise.within(A::MAX.cast_unsigned())))
        });
        counter.count(|| {
            black_box(head.apply::<Native>(&inputs));
        })
    });
    hprintln!("head_{}x{}_{} {} {} {}", COLUMNS, IN, mode, least, most, COLUMNS * IN);
    Some(())
}

/// Counts the shapes of the reference network and of the shipped networks.
fn layers<A: LayerInput>(counter: &Counter, room: &mut Room, form: WeightForm, mode: &str) -> Option<()> {
    layer::<A, 6, 16, 5>(counter, room, form, mode)?;
    layer::<A, 16, 32, 5>(counter, room, form, mode)?;
    layer::<A, 32, 32, 3>(counter, room, form, mode)?;
    head::<A, 32, 32>(counter, room, form, mode)?;
    layer::<A, 4, 16, 3>(counter, room, form, mode)?;
    layer::<A, 8, 16, 3>(counter, room, form, mode)?;
    layer::<A, 16, 16, 3>(counter, room, form, mode)?;
    head::<A, 16, 2>(counter, room, form, mode)
}

/// Counts the pair of a bearing over samples within and beyond its ranges.
fn pair(counter: &Counter, bearing: BearingMaterial) -> Option<()> {
    let mut pair: Pair = Pair::new(Model::load(shipped(bearing)).ok()?);
    let mut noise = Noise(5);
    let macs = Collision::<'_>::MACS + Friction::<'_>::MACS;
    let Extremes(least, most) = Extremes::over(TIMES, || {
        let sample = Sample {
            radial_clearance_nm: noise.bits() % 2_000_000,
            deformation_pm: noise.within(300_000_000),
            deformation_rate_nm_s: noise.within(10_000_000),
            approach_speed_nm_s: noise.bits() % 3_000_000,
            sliding_speed_nm_s: noise.within(300_000_000),
        };
        counter.count(|| {
            black_box(pair.step(&sample));
        })
    });
    hprintln!("pair_{} {} {} {}", bearing.name(), least, most, macs);
    Some(())
}

/// Counts the frame of an estimate over random bytes, zeros among them.
fn frame(counter: &Counter) {
    let mut noise = Noise(6);
    Extremes::over(TIMES, || {
        let sparse = noise.bits();
        let mut byte = |at: usize| if sparse >> (at % 32) & 1 == 0 { 0 } else { noise.bits() as u8 };
        let first = [byte(0), byte(1), byte(2)];
        let words: [[u8; 4]; VALUES + 5] =
            core::array::from_fn(|word| core::array::from_fn(|at| byte(4 * word + at)));
        let estimate = NumberedEstimate::from(EstimateLayout(first, words));
        let mut frame = [0; ESTIMATE_FRAME];
        let computed = WordSum::from_words(&estimate.estimate.value_bits());
        let count = counter.count(|| {
            let check = |values: &[u32; VALUES]| WordSum::from_words(values).difference(computed);
            encode_estimate(black_box(&estimate), check, &mut frame);
        });
        black_box(frame);
        count
    })
    .print("estimate_frame", 0);
}

/// Counts a sample of the Kalman filter: in contact, at its loss and onset, and at slow sliding.
fn filter(counter: &Counter) {
    for (name, drive_force) in [("filter", false), ("filter_drive_force", true)] {
        let Some(mut orbit) = Orbit::new(drive_force) else { return };
        Extremes::over(TIMES, || {
            let measured = orbit.measure();
            counter.count(|| {
                black_box(orbit.filter.step(&measured));
            })
        })
        .print(name, 0);
    }
    hprintln!("filter_bytes {} {} 0", size_of::<Filter>(), size_of::<Filter>());
    hprintln!("filter_state_bytes {} {} 0", Filter::STATE_BYTES, Filter::STATE_BYTES);
}

fn everything(counter: &Counter, room: &mut Room) -> Option<()> {
    let (wide, packed) = (WeightForm::Wide, WeightForm::Packed);
    modes::<i16, Native>(
        counter,
        room,
        wide,
        ["reference_window", "reference_reuse", "reference_stream"],
    )?;
    modes::<i16, Native>(
        counter,
        room,
        packed,
        [
            "reference_window_packed",
            "reference_reuse_packed",
            "reference_stream_packed",
        ],
    )?;
    modes::<i8, Native>(
        counter,
        room,
        packed,
        [
            "reference_window_compact",
            "reference_reuse_compact",
            "reference_stream_compact",
        ],
    )?;
    modes::<i16, Portable>(
        counter,
        room,
        wide,
        [
            "reference_window_portable",
            "reference_reuse_portable",
            "reference_stream_portable",
        ],
    )?;
    for bearing in BearingMaterial::ALL {
        pair(counter, bearing)?;
    }
    frame(counter);
    filter(counter);
    layers::<i16>(counter, room, wide, "wide")?;
    layers::<i16>(counter, room, packed, "packed")?;
    layers::<i8>(counter, room, packed, "compact")
}

#[entry]
fn main() -> ! {
    let Some(mut core) = cortex_m::Peripherals::take() else { loop {} };
    let counter = Counter::new(&mut core.SYST);
    let mut room = Room([0; 20_000]);
    let done = everything(&counter, &mut room);
    hprintln!("pair_bytes {} {} 0", size_of::<Pair>(), size_of::<Pair>());
    debug::exit(if done.is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {}
}
