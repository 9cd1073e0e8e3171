//! Rate of exchanges with the emulated controller, one at a time, and with the native one.
//!
//! `cargo xtask firmware && cargo bench -p host-sim --bench exchanges`. `link_alone`: the
//! controller decodes a sample's frame and encodes a refusal, because it is not configured.
//! `whole_tick`: it also estimates the sample. Compare figures of one benchmark run only.
#![allow(clippy::expect_used, reason = "a benchmark that cannot set itself up has nothing to measure")]

use controller::configuration::BENCH_B;
use divan::Bencher;
use divan::counter::ItemsCount;
use host_sim::controller::{Controller, EmulatedController, NativeController};
use link::track::SensorStatus;
use link::{MAX_FRAME, SensorFrame, ToController, encode};

/// Exchanges per round.
const EXCHANGES: u32 = 10_000;

fn main() {
    divan::main();
}

/// The journal swings in and out of contact, as in a slow run of bench B.
fn sample(sequence: u32) -> SensorFrame {
    let (sine, cosine) = (f64::from(sequence) / 500.0).sin_cos();
    let distance_nm = 500_000.0 + 20_000.0 * (f64::from(sequence) / 60.0).sin();
    SensorFrame {
        sequence,
        time_us: sequence.wrapping_mul(BENCH_B.bench.sample_period_us),
        journal_y_nm: (distance_nm * sine) as i32,
        journal_z_nm: (-distance_nm * cosine) as i32,
        shaft_angle_nrad: (sequence % 1000).cast_signed() * 20_000,
        load_force_mn: 10_000_000,
    }
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn link_alone(bencher: Bencher<'_, '_>) {
    let mut controller = EmulatedController::open(&EmulatedController::default_elf()).expect("emulator");
    let mut buffer = [0; MAX_FRAME];
    let message = ToController::Sensor(sample(0), SensorStatus::GOOD);
    let frame = encode(&message, &mut buffer).expect("frame");
    bencher.counter(ItemsCount::new(EXCHANGES)).bench_local(|| {
        for _ in 0..EXCHANGES {
            divan::black_box(controller.disturb(frame).expect("refusal"));
        }
    });
}

fn whole_tick(bencher: Bencher<'_, '_>, controller: &mut dyn Controller) {
    let mut sequence = 0;
    bencher.counter(ItemsCount::new(EXCHANGES)).bench_local(|| {
        for _ in 0..EXCHANGES {
            divan::black_box(controller.exchange(&sample(sequence)).expect("estimate"));
            sequence += 1;
        }
    });
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn whole_tick_emulated(bencher: Bencher<'_, '_>) {
    let elf = EmulatedController::default_elf();
    whole_tick(bencher, &mut EmulatedController::start(BENCH_B, &elf).expect("emulator"));
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn whole_tick_native(bencher: Bencher<'_, '_>) {
    whole_tick(bencher, &mut NativeController::start(BENCH_B).expect("controller"));
}
