//! Host and emulated controller agree to the bit, and the emulated one repeats itself to the instruction.

use crate::frames::{configuration, troubled};
use firmware::flags::{NAMES, STALE, TRIPPED};
use host_sim::controller::{Controller, EmulatedController, NativeController};
use inference::{Bearing, Flags};
use link::{ControllerConfiguration, Counters, EstimateFrame, SensorFrame};
use system_tests::faults::plan::Fault;
use system_tests::faults::stage::Stage;
use system_tests::faults::streams::disturbed;

/// SysTick's ticks of one emulated instruction: 64 ns at 168 MHz.
const TICKS_PER_INSTRUCTION: f64 = 10.752;
/// Instructions in a sample period of 100 us, one a cycle at 168 MHz.
const BUDGET_INSTRUCTIONS: f64 = 16_800.0;
/// Number of a fault of the campaign: a probe that drifts by .1 mm/s.
const DRIFT: u64 = 1_388;

fn exchanged(mut controller: Box<dyn Controller>, frames: &[SensorFrame]) -> (Vec<EstimateFrame>, Counters) {
    let estimates = frames.iter().map(|frame| controller.exchange(frame).unwrap()).collect();
    (estimates, controller.finish().unwrap())
}

fn native(configuration: ControllerConfiguration, frames: &[SensorFrame]) -> (Vec<EstimateFrame>, Counters) {
    exchanged(Box::new(NativeController::start(configuration).unwrap()), frames)
}

fn emulated(
    configuration: ControllerConfiguration,
    frames: &[SensorFrame],
) -> (Vec<EstimateFrame>, Counters) {
    let elf = EmulatedController::default_elf();
    exchanged(Box::new(EmulatedController::start(configuration, &elf).unwrap()), frames)
}

fn assert_same(native: &(Vec<EstimateFrame>, Counters), emulated: &(Vec<EstimateFrame>, Counters)) {
    assert_eq!(native.0.len(), emulated.0.len());
    for (on_host, on_target) in native.0.iter().zip(&emulated.0) {
        assert!(on_host.same_bits(on_target), "host {on_host:?}\nemulator {on_target:?}");
    }
    assert_eq!(native.1, emulated.1, "the counters");
}

fn union(estimates: &[EstimateFrame]) -> u32 {
    estimates.iter().fold(0, |all, estimate| all | estimate.flags)
}

#[test]
fn host_and_emulator_agree_bit_for_bit_whatever_happens() {
    let mut flags = 0;
    for (bearing, seed) in [(Bearing::Babbitt, 1), (Bearing::Plastic, 2)] {
        let mut configuration = configuration(bearing);
        configuration.limits.force_limit_n = 2_000;
        let frames = troubled(&configuration, 10_000, seed);
        let on_host = native(configuration, &frames);
        assert_same(&on_host, &emulated(configuration, &frames));
        flags |= union(&on_host.0);

        // Both directions of sliding, contact and none: the frames are worth comparing.
        let count = |holds: fn(&EstimateFrame) -> bool| on_host.0.iter().filter(|e| holds(e)).count();
        assert!(count(|e| e.friction_torque_nm > 0.0) > 500, "{bearing:?}");
        assert!(count(|e| e.friction_torque_nm < 0.0) > 500, "{bearing:?}");
        assert!(count(|e| e.normal_force_n == 0.0) > 500, "{bearing:?}");
    }
    // A clearance that no network knows.
    let mut wide = configuration(Bearing::Babbitt);
    wide.bench.radial_clearance_nm = 2_000_000;
    let frames = troubled(&wide, 5_000, 3);
    let on_host = native(wide, &frames);
    assert_same(&on_host, &emulated(wide, &frames));
    flags |= union(&on_host.0);

    // A probe that drifts: no block of the troubled frames is sound enough to contradict anything.
    let stage = Stage::new(1).unwrap();
    let drift = disturbed(&Fault::of_sensor(1, DRIFT).unwrap(), &stage.frames);
    let frames: Vec<SensorFrame> = drift.into_iter().map(|(frame, _)| frame).collect();
    let on_host = native(stage.configuration, &frames);
    assert_same(&on_host, &emulated(stage.configuration, &frames));
    flags |= union(&on_host.0);

    // Every remark came up, but for those that sound images and integer sensors cannot raise, and lateness: lockstep has no time.
    let without_cause =
        Flags::NON_FINITE | Flags::SATURATED | Flags::ALTERED | Flags::IMPLAUSIBLE_FRICTION | STALE | TRIPPED;
    for (flag, name) in NAMES {
        if !without_cause.contains(flag) {
            assert!(Flags::from_bits(flags).contains(flag), "no frame raised {name}");
        }
    }
}

#[test]
fn instruction_counts_repeat_exactly_and_stay_within_the_sample_period() {
    for bearing in Bearing::ALL {
        let configuration = configuration(bearing);
        let frames = troubled(&configuration, 5_000, 4);
        let ticks = |run: (Vec<EstimateFrame>, Counters)| {
            run.0.iter().map(|e| e.instruction_ticks).collect::<Vec<_>>()
        };
        // The first estimate tells of no tick before it.
        let first = ticks(emulated(configuration, &frames)).split_off(1);
        assert_eq!(first, ticks(emulated(configuration, &frames))[1..], "{bearing:?}: two runs");
        let (least, most) = (first.iter().min().unwrap(), first.iter().max().unwrap());
        let instructions = |ticks: &u32| f64::from(*ticks) / TICKS_PER_INSTRUCTION;
        println!("{bearing:?}: {:.0} to {:.0} instructions", instructions(least), instructions(most));
        // Two networks of 3,700 multiply-accumulates, two a cycle at best: less is no measurement.
        assert!(instructions(least) > 1_800.0, "{bearing:?}: {least} ticks");
        assert!(instructions(most) < BUDGET_INSTRUCTIONS, "{bearing:?}: {most} ticks");
    }
}
