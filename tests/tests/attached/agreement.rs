//! The controller on the serial port gives the results of the native controller.

use crate::board::{Board, PATIENT, frames, native};
use controller::configuration::BENCH_B;
use host_sim::controller::{
    AttachedController, Controller, EmulatedController, NativeController, Recorder, Recording,
};
use host_sim::replay::replay;
use host_sim::run::exchange::{bit_differences, exchange};
use link::{Counters, Target};

#[test]
fn estimates_and_counts_are_those_of_the_native_controller_and_a_later_host_finds_the_same() {
    let board = Board::start();
    for seed in [1, 2] {
        let frames = frames(1_000, seed);
        let controller = board.attached();
        assert_eq!((controller.hello().target, controller.name()), (Target::Emulator, "attached"));
        let there = exchange(Box::new(controller), &frames).unwrap();
        let here = native(&frames);
        assert_eq!(bit_differences(&there, &here), 0);
        assert!(here.counters.flagged > 0 && here.counters.sequence_gaps > 0, "{:?}", here.counters);
        // Repetitions on the line do not belong to the run.
        let of_the_run = |c: Counters| {
            (
                c.samples,
                c.flagged,
                c.sequence_gaps,
                c.time_faults,
                c.over_force,
                c.deadline_overruns,
                c.trips,
                c.held,
            )
        };
        assert_eq!(of_the_run(there.counters), of_the_run(here.counters));
        assert!(here.estimates.iter().filter(|e| e.normal_force_n > 100.0).count() > 200, "contacts");
        println!("{:.0} exchanges a second", frames.len() as f64 / there.wall_s);
    }
}

#[test]
fn a_recording_of_the_serial_port_is_replayed_bit_for_bit_on_every_endpoint() {
    let board = Board::start();
    let frames = frames(500, 3);
    let mut controller = board.attached();
    let recorder = Recorder::default();
    controller.listen(recorder.clone());
    controller.configure(BENCH_B).unwrap();
    let build_id = controller.hello().build_id;
    exchange(Box::new(controller), &frames).unwrap();
    let recording = Recording { build_id, frames: recorder.take() };
    let ends: [Box<dyn Controller>; 3] = [
        Box::new(NativeController::open().unwrap()),
        Box::new(EmulatedController::open(&EmulatedController::default_elf()).unwrap()),
        Box::new(AttachedController::open_with(&board.port, PATIENT).unwrap()),
    ];
    for mut end in ends {
        let replayed = replay(&recording, &mut *end).unwrap();
        assert_eq!((replayed.samples, replayed.commands), (500, 2), "{}", end.name());
        assert_eq!(replayed.differences, [], "{}", end.name());
    }
}
