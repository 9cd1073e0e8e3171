//! Host and emulated controller give the same bits, and the instruction counts of the latter repeat
//! exactly.

use crate::frames::{configuration, disturbed_frames};
use controller::emulator::TICKS_PER_INSTRUCTION;
use controller::flags::{NAMES, STALE, TRIPPED};
use host_sim::controller::{Controller, EmulatedController, NativeController};
use inference::{BearingMaterial, Flags};
use link::{ControllerConfiguration, Counters, EstimateFrame, SensorFrame};
use system_tests::faults::plan::Fault;
use system_tests::faults::scenario::Scenario;
use system_tests::faults::streams::disturbed;
use system_tests::soak::TICK_INSTRUCTIONS;

/// Number of a campaign fault: a probe that drifts by .1 mm/s.
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
fn host_and_emulator_agree_bit_for_bit_on_any_input() {
    let mut flags = 0;
    for (bearing, seed) in [(BearingMaterial::Babbitt, 1), (BearingMaterial::Plastic, 2)] {
        let mut configuration = configuration(bearing);
        configuration.limits.force_limit_n = 2_000;
        let frames = disturbed_frames(&configuration, 20_000, seed);
        let on_host = native(configuration, &frames);
        assert_same(&on_host, &emulated(configuration, &frames));
        flags |= union(&on_host.0);

        // The frames must contain both directions of sliding, contact and no contact.
        let count = |holds: fn(&EstimateFrame) -> bool| on_host.0.iter().filter(|e| holds(e)).count();
        let (forward, backward) =
            (count(|e| e.friction_torque_nm > 0.0), count(|e| e.friction_torque_nm < 0.0));
        assert!(forward > 500 && backward > 500, "{bearing:?}: {forward} {backward}");
        let light = count(|e| e.normal_force_n < 10.0);
        assert!(light > 100, "{bearing:?}: {light}");
    }
    // A clearance outside the range of every network.
    let mut wide = configuration(BearingMaterial::Babbitt);
    wide.bench.radial_clearance_nm = 2_000_000;
    let frames = disturbed_frames(&wide, 5_000, 3);
    let on_host = native(wide, &frames);
    assert_same(&on_host, &emulated(wide, &frames));
    flags |= union(&on_host.0);

    // A probe that drifts: the disturbed frames above leave no time for a misfit.
    let scenario = Scenario::new(1).unwrap();
    let drift = disturbed(&Fault::for_sensor(1, DRIFT).unwrap(), &scenario.frames);
    let frames: Vec<SensorFrame> = drift.into_iter().map(|(frame, _)| frame).collect();
    let on_host = native(scenario.configuration, &frames);
    assert_same(&on_host, &emulated(scenario.configuration, &frames));
    flags |= union(&on_host.0);

    // Every flag was raised, except those that intact images and integer sensors cannot raise, and
    // lateness: lockstep has no time.
    let without_cause = Flags::NON_FINITE
        | Flags::SATURATED
        | Flags::CORRUPTED
        | Flags::IMPLAUSIBLE_FRICTION
        | STALE
        | TRIPPED;
    for (flag, name) in NAMES {
        if !without_cause.contains(flag) {
            assert!(Flags::from_bits(flags).contains(flag), "no frame raised {name}");
        }
    }
}

#[test]
fn instruction_counts_repeat_exactly_and_stay_within_their_budget() {
    for bearing in BearingMaterial::ALL {
        let configuration = configuration(bearing);
        let frames = disturbed_frames(&configuration, 5_000, 4);
        let ticks = |run: (Vec<EstimateFrame>, Counters)| {
            run.0.iter().map(|e| e.instruction_ticks).collect::<Vec<_>>()
        };
        // The first estimate reports no earlier tick.
        let first = ticks(emulated(configuration, &frames)).split_off(1);
        assert_eq!(first, ticks(emulated(configuration, &frames))[1..], "{bearing:?}: two runs");
        let (least, most) = (first.iter().min().unwrap(), first.iter().max().unwrap());
        let instructions = |ticks: &u32| f64::from(*ticks) / TICKS_PER_INSTRUCTION;
        println!("{bearing:?}: {:.0} to {:.0} instructions", instructions(least), instructions(most));
        // Two networks of 3,700 multiply-accumulates, at most two in a cycle: a smaller count would
        // be an error of measurement.
        assert!(instructions(least) > 1_800.0, "{bearing:?}: {least} ticks");
        assert!(instructions(most) < TICK_INSTRUCTIONS, "{bearing:?}: {most} ticks");
    }
}
