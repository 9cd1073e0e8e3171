//! The service with a scripted transport.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;

use embedded_storage::nor_flash::{ErrorType, MultiwriteNorFlash, NorFlash, NorFlashErrorKind, ReadNorFlash};
use inference::BearingMaterial;
use link::start::StackReport;
use link::track::SensorStatus;
use link::update::{FlashOperation, ModelMemory, SlotState, UpdateRefusal};
use link::{
    Answer, BuildId, ClockSource, Command, Decoder, MAX_FRAME, NumberedCommand, ReportKind, SensorFrame,
    SlowReport, Target, ToController, ToHost, encode,
};
use rtic_core::Exclusive;

use super::*;
use crate::configuration::BENCH_B;
use crate::sensors::Acquired;
use crate::session::{Identity, NoTicks, Session};
use crate::store::key::DEVELOPMENT_KEY;
use crate::supervisor::paint::{Mark, PAINT};
use crate::supervisor::{Attendance, CodeCheck, Periods};

#[allow(dead_code, unreachable_pub, reason = "the tests of the store use the rest")]
#[path = "../../tests/store/package.rs"]
mod package;
use package::Package;

mod authentication;
mod fixture;
mod journal;
mod stores;
use fixture::{Fixture, Flash, SPANS, Script, blank, fixture, fixture_with, fixture_with_key};

/// A tick without samples of the board.
const AT_START: Acquired = Acquired::nothing(0);

fn sample(sequence: u32) -> ToController {
    let frame = SensorFrame { sequence, time_us: sequence * 100, ..SensorFrame::default() };
    ToController::Sensor(frame, SensorStatus::GOOD)
}

#[test]
fn in_lockstep_every_sample_is_estimated_at_once_and_the_end_of_the_script_stops_the_service() {
    let mut fixture = fixture(Pacing::Lockstep, blank());
    fixture.order(Command::Configure(BENCH_B));
    let mut script = Script { is_closed_at_end: true, ..Script::default() };
    script.write(&[sample(0), sample(1), sample(2)]);
    assert_eq!(fixture.run(&mut script, &mut Script::default(), 10), Err(Stop::Closed));
    let numbers: Vec<_> = script
        .replies()
        .into_iter()
        .map(|reply| match reply {
            ToHost::Estimate(estimate) => estimate.number,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(numbers, [0, 1, 2]);
    let [sampling, inference, ..] = fixture.board.attendance.look(0);
    assert!(sampling.expected && inference.expected);
}

#[test]
fn paced_by_the_timer_samples_wait_for_the_tick_and_samples_without_room_are_counted() {
    let mut fixture = fixture(Pacing::Timer, blank());
    fixture.order(Command::Configure(BENCH_B));
    let mut script = Script::default();
    script.write(&(0..10).map(sample).collect::<Vec<_>>());
    fixture.run(&mut script, &mut Script::default(), 10).unwrap();
    assert!(script.replies().is_empty());
    assert_eq!(fixture.shared.session.counters().dropped_samples, 2);
    for _ in 0..8 {
        assert_eq!(fixture.shared.tick(&AT_START, true, &mut NoTicks), Tick::Sampled);
    }
    assert_eq!(fixture.shared.tick(&AT_START, true, &mut NoTicks), Tick::Idle);
    let mut script = Script::default();
    fixture.run(&mut script, &mut Script::default(), 1).unwrap();
    assert_eq!(script.replies().len(), 8);
    assert!(script.purposes.iter().all(|&purpose| purpose == Purpose::Stream));
}

#[test]
fn replies_go_to_the_port_of_the_request_and_estimates_to_the_port_of_the_last_frame() {
    let mut fixture = fixture(Pacing::Timer, blank());
    fixture.order(Command::Configure(BENCH_B));
    let (mut serial, mut probe) = (Script::default(), Script::default());
    probe.write(&[ToController::Identify { token: 5 }, sample(0)]);
    let mut ports = Ports::new(&mut serial, &mut probe);
    for _ in 0..3 {
        let mut shared = Exclusive(&mut fixture.shared);
        fixture.service.pass(&mut ports, &mut shared, &mut fixture.board).unwrap();
        fixture.shared.tick(&AT_START, true, &mut NoTicks);
    }
    assert!(serial.sent.is_empty());
    assert!(matches!(probe.replies()[..], [ToHost::Hello(hello), ToHost::Estimate(_)] if hello.token == 5));
    assert_eq!(probe.purposes, [Purpose::Reply, Purpose::Stream]);
}

#[test]
fn one_pass_sends_at_most_one_reply() {
    let mut fixture = fixture(Pacing::Timer, blank());
    let mut script = Script::default();
    script.write(&[ToController::Identify { token: 1 }, ToController::Identify { token: 2 }]);
    fixture.run(&mut script, &mut Script::default(), 1).unwrap();
    assert_eq!(script.replies().len(), 1);
    fixture.run(&mut script, &mut Script::default(), 1).unwrap();
    assert_eq!(script.replies().len(), 1);
}

#[test]
fn the_bytes_of_one_pass_are_bounded() {
    let mut fixture = fixture(Pacing::Timer, blank());
    let mut script = Script { received: vec![1; 1_000].into(), ..Script::default() };
    fixture.run(&mut script, &mut Script::default(), 1).unwrap();
    assert_eq!(script.received.len(), 1_000 - MAX_BYTES_PER_PASS);
}

#[test]
fn the_hello_frame_of_a_start_goes_to_both_ports_after_the_end_of_a_cut_frame() {
    let mut fixture = fixture(Pacing::Timer, blank());
    let (mut serial, mut probe) = (Script::default(), Script::default());
    let mut ports = Ports::new(&mut serial, &mut probe);
    let hello = fixture.service.announce(&mut ports, &mut Exclusive(&mut fixture.shared));
    assert_eq!((hello.token, hello.stack), (0, StackReport { reserved_bytes: 40, used_bytes: 16 }));
    for port in [&mut serial, &mut probe] {
        assert_eq!(port.sent.first(), Some(&link::DELIMITER));
        assert_eq!(port.replies(), [ToHost::Hello(hello)]);
    }
}

#[test]
fn status_of_supervisor_and_models_is_current_when_a_report_is_requested() {
    let mut fixture = fixture(Pacing::Timer, blank());
    // A pass reads the check-ins before its own, so the first pass sees none of the link.
    fixture.order(Command::GetCounters);
    fixture.board.uptime_us = 77;
    let Answer::Report(SlowReport::Supervisor(report)) =
        fixture.order(Command::GetReport(ReportKind::Supervisor))
    else {
        panic!("expected the supervisor's report")
    };
    assert_eq!((report.uptime_us, report.parties[2].expected), (77, true));
    assert!(matches!(
        fixture.ask(ToController::Update(UpdateRequest::Status))[..],
        [ToHost::Update(UpdateAnswer::Status(_))]
    ));
}

#[test]
fn telemetry_is_sent_when_it_is_due() {
    let mut fixture = fixture(Pacing::Lockstep, blank());
    let mut configuration = BENCH_B;
    configuration.limits.slow_every = 10;
    fixture.order(Command::Configure(configuration));
    let mut script = Script::default();
    script.write(&(0..20).map(sample).collect::<Vec<_>>());
    fixture.run(&mut script, &mut Script::default(), 25).unwrap();
    let telemetry = script.replies().into_iter().filter(|reply| matches!(reply, ToHost::Slow(_)));
    assert_eq!(telemetry.count(), 2);
}

#[test]
fn frames_that_the_transport_does_not_take_and_line_errors_are_counted() {
    let mut fixture = fixture(Pacing::Timer, blank());
    let line = LineReport { dropped_bytes: 3, ..LineReport::default() };
    let mut script = Script { is_blocked: true, line, ..Script::default() };
    script.write(&[ToController::Identify { token: 1 }]);
    fixture.run(&mut script, &mut Script::default(), 1).unwrap();
    let counters = fixture.shared.session.counters();
    assert_eq!((counters.dropped_answers, counters.dropped_bytes), (1, 3));
}

#[test]
fn corrupted_code_stops_the_service_and_at_a_start_refuses_every_run() {
    let mut fixture = fixture(Pacing::Timer, blank());
    fixture.run(&mut Script::default(), &mut Script::default(), 20).unwrap();
    fixture.board.code[9] ^= 1 << 20;
    let stopped = fixture.run(&mut Script::default(), &mut Script::default(), 20);
    assert_eq!(stopped, Err(Stop::Corrupted));
    // A sealed image whose seal does not match.
    let mut session = crate::session::Session::new(Identity {
        build_id: BuildId::new("test"),
        target: Target::Native,
        clock: ClockSource::Host,
        core_hz: 0,
    });
    let code = CodeCheck::new(SPANS, 1);
    Background::start(code, Mark::new(10), &mut session, &fixture.board);
    assert!(session.configure(&BENCH_B).is_err());
}

#[test]
fn the_self_test_checks_in_after_a_round() {
    let mut fixture = fixture(Pacing::Timer, blank());
    let mut passes = 0;
    while !fixture.board.attendance.look(0)[3].expected {
        fixture.run(&mut Script::default(), &mut Script::default(), 1).unwrap();
        passes += 1;
        assert!(passes < 1_000, "a round ends");
    }
}
