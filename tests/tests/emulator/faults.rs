//! Faults on demand: the controller survives each, records cause and address, and reports them in
//! the hello frame after the reset.
//!
//! The image of `cargo xtask firmware --provoke` sends its hello frame, commits the fault of the
//! command line, resets, sends the next hello frame and ends.

use crate::batch;
use controller::configuration::BENCH_B;
use controller::emulator::MACHINE;
use controller::supervisor::record::build_hash;
use host_sim::controller::EmulatedController;
use link::start::{FaultKind, FaultRecord, KeptConfiguration, ResetReason};
use link::{Command, Hello, NumberedCommand, ToController, ToHost};
use object::{Object, ObjectSymbol};
use std::path::{Path, PathBuf};
use std::process::ExitStatus;

fn provoking() -> PathBuf {
    EmulatedController::default_elf().with_file_name("estimator-provoke")
}

/// Runs an image over messages until it ends; returns the exit status and its last hello frame.
fn run(image: &Path, provocation: &str, messages: &[ToController]) -> (ExitStatus, Hello) {
    run_with(image, provocation, &[], messages)
}

/// Runs an image with more arguments of the emulator.
fn run_with(
    image: &Path,
    provocation: &str,
    more: &[&str],
    messages: &[ToController],
) -> (ExitStatus, Hello) {
    let (status, received) = batch::run(MACHINE, image, provocation, more, messages);
    let mut hellos = received.iter().filter_map(|message| match message {
        ToHost::Hello(hello) => Some(*hello),
        _ => None,
    });
    (status, hellos.next_back().unwrap())
}

/// Returns the record of a provoked fault.
fn record(provocation: &str) -> FaultRecord {
    let (status, hello) = run(&provoking(), provocation, &[]);
    assert!(status.success(), "{provocation}: {status}");
    let record = hello.start.fault.unwrap_or_else(|| panic!("{provocation}: no record"));
    let reason = match record.kind {
        FaultKind::Starved { .. } => ResetReason::Starved,
        _ => ResetReason::Fault,
    };
    assert_eq!(hello.start.reason, reason, "{provocation}");
    assert_eq!((record.count, record.build), (1, build_hash(&hello.build_id)), "{provocation}");
    record
}

/// Returns whether an address is in a function of the provoking image whose name contains a text.
fn is_in(address: u32, function: &str) -> bool {
    let bytes = std::fs::read(provoking()).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let address = u64::from(address);
    file.symbols()
        .filter(|symbol| symbol.name().is_ok_and(|name| name.contains(function)))
        .any(|symbol| (symbol.address() & !1..(symbol.address() & !1) + symbol.size()).contains(&address))
}

#[test]
fn every_forbidden_access_is_recorded_with_its_address_and_program_counter() {
    let cases = [
        ("wild-load", "bus error, data", Some(0xD000_0000), "provoke4load"),
        ("store-below-ram", "bus error, data", Some(0x1FFF_FFF0), "provoke5store"),
        ("store-into-guard", "memory protection, data", Some(0x2000_0010), "provoke5store"),
        ("undefined-instruction", "undefined instruction", None, "provoke"),
    ];
    for (provocation, cause, address, function) in cases {
        let record = record(provocation);
        assert_eq!(record.kind, FaultKind::Core, "{provocation}: {record}");
        assert_eq!((record.cause(), record.address), (cause, address), "{provocation}: {record}");
        assert!(is_in(record.pc, function), "{provocation}: {record}");
        assert!((0x2000_0100..0x2000_C000).contains(&record.msp), "{provocation}: {record}");
    }
}

#[test]
fn a_stack_overflow_is_survived_and_reported_with_and_without_meeting_the_guard() {
    for (provocation, msp) in [("overflow", 0x2000_0000..0x2000_0100), ("leaping-overflow", 0..0x2000_0000)] {
        let record = record(provocation);
        assert_eq!(record.kind, FaultKind::StackOverflow, "{provocation}: {record}");
        assert!(msp.contains(&record.msp), "{provocation}: {record}");
    }
}

#[test]
fn a_task_that_does_not_check_in_is_named() {
    for (name, bit) in [("sampling", 1), ("inference", 2), ("link", 4), ("self-test", 8)] {
        let record = record(&format!("starve-{name}"));
        assert_eq!(record.kind, FaultKind::Starved { missing: bit }, "{record}");
        assert_eq!(record.missing().collect::<Vec<_>>(), [name]);
    }
}

#[test]
fn a_kept_configuration_with_which_every_start_faults_does_not_restart_the_controller_for_ever() {
    let commands = [Command::Configure(BENCH_B), Command::Stop, Command::Keep];
    let messages: Vec<_> = (1..)
        .zip(commands)
        .map(|(id, command)| ToController::Command(NumberedCommand { id, command }))
        .collect();
    // The first start keeps it and faults; the next three use it and fault.
    let (status, hello) = run(&provoking(), "with-kept", &messages);
    assert!(status.success(), "{status}");
    assert_eq!(hello.start.kept, KeptConfiguration::SetAside { faulted_starts: 3 });
    assert_eq!(hello.start.fault.map(|fault| fault.count), Some(4));
}

#[test]
fn a_panic_is_recorded_as_one() {
    assert_eq!(record("panic").kind, FaultKind::Panic);
}

#[test]
fn a_fault_ends_the_emulation_if_no_reset_is_allowed() {
    let (status, hello) = run_with(&provoking(), "wild-load", &["-no-reboot"], &[]);
    assert!(status.success(), "{status}");
    assert_eq!(hello.start.fault, None, "the hello frame before the fault");
}

#[test]
fn the_shipped_image_commits_no_fault_on_demand() {
    let (status, hello) = run(&EmulatedController::default_elf(), "wild-load", &[]);
    assert!(status.success() && hello.start.fault.is_none(), "{:?}", hello.start);
    let bytes = std::fs::read(EmulatedController::default_elf()).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let names: Vec<_> = file.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    assert!(names.iter().any(|name| name.contains("record_fault")), "its symbols are there");
    assert!(!names.iter().any(|name| name.contains("provoke")));
}
