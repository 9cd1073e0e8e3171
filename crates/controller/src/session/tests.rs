//! The session by itself: what is served, refused, counted, and what lateness does.

mod own;

use super::*;
use crate::configuration::BENCH_B;
use crate::flags::{SEQUENCE_GAP, STALE, TRIPPED};
use inference::Flags;
use inference::{BearingMaterial, WINDOW};
use link::start::Presence;
use link::update::UpdateStatus;
use link::{
    Acknowledgement, Answer, BadFrames, BuildId, ClockSource, Command, ControllerConfiguration,
    EstimateFrame, Field, LineErrors, MAGIC, ModelId, NumberedCommand, PROTOCOL_VERSION, Refusal,
    SamplingReport,
};

/// A tick counter with given readings: before the frame is encoded, and in total.
struct FixedTicks {
    before_frame: u32,
    total: u32,
    readings: u32,
}

impl FixedTicks {
    fn new(before_frame: u32, total: u32) -> Self {
        Self { before_frame, total, readings: 0 }
    }
}

impl TickSource for FixedTicks {
    fn start(&mut self) -> u32 {
        self.readings = 0;
        7
    }

    fn since(&mut self, start: u32) -> u32 {
        assert_eq!(start, 7);
        self.readings += 1;
        if self.readings == 1 { self.before_frame } else { self.total }
    }
}

/// Flags of an estimate as a set.
fn flags_of(estimate: &EstimateFrame) -> Flags {
    Flags::from_bits(estimate.flags)
}

fn session(target: Target) -> Session {
    let build_id = BuildId::new("test");
    Session::new(Identity { build_id, target, clock: ClockSource::Internal, core_hz: 168_000_000 })
}

fn sensor(sequence: u32) -> ToController {
    let frame = SensorFrame { sequence, time_us: sequence * 100, ..SensorFrame::default() };
    ToController::Sensor(frame, SensorStatus::GOOD)
}

/// Sends a command with the next number.
fn order(session: &mut Session, command: Command) -> Result<Answer, Refusal> {
    let id = session.hello(0).last_command.wrapping_add(1);
    let message = ToController::Command(NumberedCommand { id, command });
    match session.handle(&message, &mut NoTicks) {
        ToHost::Acknowledged(Acknowledgement { id: answered, outcome }) if answered == id => outcome,
        other => panic!("{other:?}"),
    }
}

fn configured(target: Target, configuration: ControllerConfiguration) -> Session {
    let mut session = session(target);
    assert!(matches!(order(&mut session, Command::Configure(configuration)), Ok(Answer::Configured(_))));
    session
}

fn estimate(session: &mut Session, sequence: u32, ticks: &mut impl TickSource) -> EstimateFrame {
    match session.handle(&sensor(sequence), ticks) {
        ToHost::Estimate(numbered) => numbered.estimate,
        other => panic!("{other:?}"),
    }
}

fn stopped(session: &mut Session) -> Counters {
    match order(session, Command::Stop) {
        Ok(Answer::Stopped(counters)) => counters,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_hello_frame_names_both_models_and_repeats_the_token() {
    let mut session = session(Target::Native);
    let ToHost::Hello(hello) = session.handle(&ToController::Identify { token: 77 }, &mut NoTicks) else {
        panic!("expected a hello frame");
    };
    assert_eq!((hello.magic, hello.protocol, hello.window), (MAGIC, PROTOCOL_VERSION, WINDOW as u16));
    let (models, room) = hello.models.split_at(BearingMaterial::COUNT);
    assert!(models.iter().all(|model| model.crc != 0) && room.iter().all(|model| *model == ModelId::NONE));
    assert_ne!(hello.models[0], hello.models[1]);
    assert_eq!((hello.token, hello.last_command, hello.state), (77, 0, State::Waiting));
    assert_eq!(hello.configuration_crc, 0);
}

#[test]
fn samples_before_a_configuration_and_after_a_stop_are_refused() {
    let mut session = session(Target::Native);
    let refused = ToHost::Fault(Fault::NotConfigured { sequence: 3 });
    assert_eq!(session.handle(&sensor(3), &mut NoTicks), refused);
    order(&mut session, Command::Configure(BENCH_B)).unwrap();
    assert!(matches!(session.handle(&sensor(3), &mut NoTicks), ToHost::Estimate(_)));
    stopped(&mut session);
    assert_eq!(session.handle(&sensor(3), &mut NoTicks), refused);
}

#[test]
fn a_refused_configuration_changes_nothing() {
    let mut session = configured(Target::Native, BENCH_B);
    let hello = session.hello(0);
    estimate(&mut session, 0, &mut NoTicks);
    let mut bad = BENCH_B;
    bad.bench.bearing = 7;
    bad.limits.stuck_samples = 0;
    let Err(Refusal::Configuration(reasons)) = order(&mut session, Command::Configure(bad)) else {
        panic!("expected reasons");
    };
    let fields: Vec<_> = reasons.iter().map(|reason| reason.field).collect();
    assert_eq!(fields, [Field::Bearing, Field::StuckSamples]);
    assert_eq!(order(&mut session, Command::GetConfiguration), Ok(Answer::Configuration(Some(BENCH_B))));
    assert_eq!(session.hello(0).configuration_crc, hello.configuration_crc);
    // The run continues where it was.
    let next = estimate(&mut session, 1, &mut NoTicks);
    assert!(!flags_of(&next).intersects(SEQUENCE_GAP));
    assert_eq!(stopped(&mut session).samples, 2);
}

#[test]
fn a_repeated_command_is_answered_again_and_not_carried_out() {
    let mut session = configured(Target::Native, BENCH_B);
    let repeated = ToController::Command(NumberedCommand { id: 1, command: Command::Configure(BENCH_B) });
    estimate(&mut session, 0, &mut NoTicks);
    let ToHost::Acknowledged(again) = session.handle(&repeated, &mut NoTicks) else { panic!() };
    assert!(matches!(again, Acknowledgement { id: 1, outcome: Ok(Answer::Configured(_)) }));
    assert_eq!(session.counters().samples, 1, "the run was not started anew");
    let counters = stopped(&mut session);
    let again = ToController::Command(NumberedCommand { id: 2, command: Command::Stop });
    let ToHost::Acknowledged(again) = session.handle(&again, &mut NoTicks) else { panic!() };
    assert_eq!(again.outcome, Ok(Answer::Stopped(counters)));
    assert_eq!(session.counters().repeated_commands, 2);
}

#[test]
fn commands_out_of_order_and_other_commands_of_the_same_number_are_refused() {
    let mut session = configured(Target::Native, BENCH_B);
    let mut send = |id, command| match session
        .handle(&ToController::Command(NumberedCommand { id, command }), &mut NoTicks)
    {
        ToHost::Acknowledged(answer) => answer.outcome,
        other => panic!("{other:?}"),
    };
    for id in [0, 3, u32::MAX] {
        assert_eq!(send(id, Command::Stop), Err(Refusal::OutOfOrder { expected: 2 }));
    }
    assert_eq!(send(1, Command::Stop), Err(Refusal::NumberTaken));
    assert!(matches!(send(2, Command::GetCounters), Ok(Answer::Counters(c)) if c.refused_commands == 4));
}

#[test]
fn the_counters_count_every_event() {
    let mut session = session(Target::Silicon);
    session.bad_frame(FrameError::Crc);
    order(&mut session, Command::Configure(BENCH_B)).unwrap();
    for sequence in [0, 1, 2, 5, 6] {
        estimate(&mut session, sequence, &mut FixedTicks::new(16_800, 16_800));
    }
    estimate(&mut session, 7, &mut FixedTicks::new(16_801, 16_801));
    session.count_idle_tick();
    session.count_dropped_sample();
    session.count_dropped_estimate();
    session.count_dropped_answer();
    let line_errors = LineErrors { overruns: 4, framing: 5, noise: 6 };
    session.set_line_report(LineReport { dropped_bytes: 9, errors: line_errors });
    let expected = Counters {
        samples: 6,
        flagged: 1,
        sequence_gaps: 1,
        time_faults: 1,
        deadline_overruns: 1,
        idle_ticks: 1,
        dropped_samples: 1,
        dropped_estimates: 1,
        dropped_answers: 1,
        dropped_bytes: 9,
        line_errors,
        bad_frames: BadFrames { crc: 1, ..BadFrames::default() },
        ..Counters::default()
    };
    assert_eq!(stopped(&mut session), expected);
    let ToHost::Hello(_) = session.handle(&ToController::Identify { token: 1 }, &mut NoTicks) else {
        panic!()
    };
    let link_only = Counters {
        dropped_answers: 1,
        dropped_bytes: 9,
        line_errors,
        bad_frames: BadFrames { crc: 1, ..BadFrames::default() },
        ..Counters::default()
    };
    assert_eq!(*session.counters(), link_only);
}

#[test]
fn the_emulator_s_timer_counts_for_nothing() {
    let mut session = configured(Target::Emulator, BENCH_B);
    assert!(!flags_of(&estimate(&mut session, 0, &mut FixedTicks::new(20_000, 20_000))).intersects(STALE));
    session.count_idle_tick();
    assert_eq!(stopped(&mut session), Counters { samples: 1, ..Counters::default() });
}

/// Samples with the journal at the bottom of the bearing, pressed in, as lively as a sensor.
fn pressed(sequence: u32) -> ToController {
    let wobble = i32::try_from(sequence % 5).unwrap() * 40;
    let frame = SensorFrame {
        sequence,
        time_us: sequence * 100,
        journal_y_nm: wobble,
        journal_z_nm: -520_000 - wobble,
        shaft_angle_nrad: wobble * 100,
        load_force_mn: 0,
    };
    ToController::Sensor(frame, SensorStatus::GOOD)
}

#[test]
fn late_estimates_are_marked_and_trip_the_controller_until_it_is_cleared() {
    let mut configuration = BENCH_B;
    configuration.limits.deadline_trip_count = 3;
    // The period decides, not the timer that paces the loop: 1 ms are 168,000 ticks.
    configuration.bench.sample_period_us = 1_000;
    let mut session = configured(Target::Silicon, configuration);
    let mut sequence = 0;
    let mut next = |session: &mut Session, took: u32| {
        let message = pressed(sequence);
        sequence += 1;
        match session.handle(&message, &mut FixedTicks::new(took, took)) {
            ToHost::Estimate(numbered) => numbered.estimate,
            other => panic!("{other:?}"),
        }
    };
    for _ in 0..50 {
        let estimate = next(&mut session, 168_000);
        assert!(!flags_of(&estimate).intersects(STALE | TRIPPED));
    }
    for _ in 0..2 {
        assert!(flags_of(&next(&mut session, 168_001)).contains(STALE));
        assert_eq!(session.state(), State::Running);
    }
    assert_eq!(flags_of(&next(&mut session, 1_000)).bits() & STALE.bits(), 0, "one in time breaks the row");
    let good = next(&mut session, 1_000);
    assert!(good.normal_force_n > 100.0, "{good:?}");
    next(&mut session, 200_000);
    next(&mut session, 200_000);
    assert!(flags_of(&next(&mut session, 200_000)).contains(STALE | TRIPPED));
    assert_eq!((session.state(), session.hello(0).state), (State::Tripped, State::Tripped));
    // Held: the last good values with the new sample's number, whatever the time it takes.
    for took in [10, 200_000, 10] {
        let held = next(&mut session, took);
        assert!(flags_of(&held).contains(STALE | TRIPPED));
        assert_eq!(held.normal_force_n, good.normal_force_n);
        assert_eq!(held.force_sd_n, f32::INFINITY);
        assert_eq!(held.sequence, sequence_of(&session));
    }
    assert_eq!(order(&mut session, Command::ClearTrip), Ok(Answer::Cleared));
    let live = next(&mut session, 1_000);
    assert_eq!(session.state(), State::Running);
    assert!(!flags_of(&live).intersects(STALE | TRIPPED) && live.sequence == 60);
    let counters = stopped(&mut session);
    assert_eq!((counters.trips, counters.held), (1, 3));
    assert_eq!(counters.deadline_overruns, 6, "each late sample once");
}

#[test]
fn a_trip_before_the_first_estimate_in_time_repeats_an_unknown_force() {
    let mut configuration = BENCH_B;
    configuration.limits.deadline_trip_count = 3;
    let mut session = configured(Target::Silicon, configuration);
    let last = *session.run.as_ref().unwrap().last();
    assert_eq!((last.force_sd_n, last.clearance_sd_m), (f32::INFINITY, f32::INFINITY));
    for sequence in 0..8 {
        match session.handle(&pressed(sequence), &mut FixedTicks::new(200_000, 200_000)) {
            ToHost::Estimate(numbered) if sequence > 3 => {
                let estimate = numbered.estimate;
                assert!(flags_of(&estimate).contains(STALE | TRIPPED), "{estimate:?}");
                assert!(estimate.force_sd_n == f32::INFINITY, "{estimate:?}");
                assert!(estimate.friction_torque_sd_nm == f32::INFINITY, "{estimate:?}");
            }
            ToHost::Estimate(_) => {}
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(session.state(), State::Tripped);
}

fn sequence_of(session: &Session) -> u32 {
    session.telemetry.schedule.sequence
}

#[test]
fn the_frame_is_part_of_the_tick() {
    let mut session = configured(Target::Silicon, BENCH_B);
    let ToController::Sensor(frame, status) = pressed(0) else { unreachable!() };
    let estimates = |bytes: &[u8]| {
        let mut decoder = link::Decoder::new();
        bytes.iter().find_map(|&byte| decoder.push::<ToHost>(byte)).unwrap().unwrap()
    };
    let first = session.tick(&frame, status, &mut FixedTicks::new(16_000, 17_000)).unwrap();
    let second = session.tick(&frame, status, &mut FixedTicks::new(16_000, 17_000)).unwrap();
    let [ToHost::Estimate(first), ToHost::Estimate(second)] = [estimates(&first), estimates(&second)] else {
        panic!("expected estimates");
    };
    assert_eq!([first.number, second.number], [0, 1]);
    assert_eq!([first.estimate.instruction_ticks, second.estimate.instruction_ticks], [0, 17_000]);
    let stale = |estimate: &EstimateFrame| Flags::from_bits(estimate.flags).contains(STALE);
    assert_eq!([stale(&first.estimate), stale(&second.estimate)], [false, true]);
}

#[test]
fn forces_above_the_limit_are_flagged_and_counted() {
    let mut configuration = BENCH_B;
    configuration.limits.force_limit_n = 100;
    let mut session = configured(Target::Native, configuration);
    for sequence in 0..60 {
        session.handle(&pressed(sequence), &mut NoTicks);
    }
    let counters = stopped(&mut session);
    assert!(counters.over_force > 20 && counters.over_force <= 60, "{counters:?}");
}

#[test]
fn every_report_can_be_requested_and_is_sent_in_turn() {
    let mut configuration = BENCH_B;
    configuration.limits.slow_every = 10;
    configuration.limits.friction_level_limit_per_mille = 1_500;
    let mut session = configured(Target::Native, configuration);
    let parties = [Presence { expected: true, away_us: 1, longest_us: 2, period_us: 3 }; 4];
    let models = UpdateStatus { refused: 7, ..UpdateStatus::default() };
    let sample = SensorFrame { journal_y_nm: 5, ..SensorFrame::default() };
    let sampling = SamplingReport { lost: 3, ..SamplingReport::default() };
    session.update_status(Status {
        uptime_us: 99,
        parties,
        models,
        sample: Some(sample),
        sampling: Some(sampling),
    });
    let mut turns = Vec::new();
    for sequence in 0..80 {
        session.handle(&pressed(sequence), &mut NoTicks);
        assert_eq!(session.is_telemetry_due(), sequence % 10 == 9);
        if let Some(ToHost::Slow(slow)) = session.take_telemetry() {
            turns.push(slow.report);
        }
    }
    assert_eq!(turns.len(), ReportKind::ALL.len());
    for (turn, kind) in turns.iter().zip(ReportKind::ALL) {
        let Ok(Answer::Report(asked)) = order(&mut session, Command::GetReport(kind)) else {
            panic!("{kind:?}")
        };
        assert_eq!(std::mem::discriminant(&asked), std::mem::discriminant(turn));
        match asked {
            SlowReport::Track(track) => assert_eq!(track.friction, link::track::FrictionState::Unknown),
            SlowReport::Sensors(_) => {}
            SlowReport::Counters(counters) => assert_eq!(counters.samples, 80),
            SlowReport::Supervisor(known) => assert_eq!((known.uptime_us, known.parties), (99, parties)),
            SlowReport::Models(known) => assert_eq!(known, models),
            SlowReport::Sample(known) => assert_eq!(known, sample),
            SlowReport::Sampling(known) => assert_eq!(known, sampling),
            SlowReport::Estimate(known) => assert_eq!(NumberedEstimate::from(known).estimate.sequence, 79),
        }
    }
    stopped(&mut session);
    let [track, _, counters, ..] = ReportKind::ALL.map(|kind| order(&mut session, Command::GetReport(kind)));
    assert_eq!(track, Err(Refusal::NotConfigured));
    assert!(counters.is_ok());
}

#[test]
fn slow_telemetry_is_sent_every_n_samples_and_unfetched_reports_are_counted() {
    let mut configuration = BENCH_B;
    configuration.limits.slow_every = 10;
    let mut session = configured(Target::Native, configuration);
    let mut numbers = Vec::new();
    for sequence in 0..35 {
        session.handle(&pressed(sequence), &mut NoTicks);
        if let Some(ToHost::Slow(slow)) = session.take_telemetry() {
            assert_eq!((slow.sequence, slow.state), (sequence, State::Running));
            numbers.push((sequence, slow.number));
        }
    }
    assert_eq!(numbers, [(9, 0), (19, 1), (29, 2)]);
    for sequence in 35..60 {
        session.handle(&pressed(sequence), &mut NoTicks);
    }
    assert_eq!(session.counters().dropped_answers, 2);
}

#[test]
fn corrupted_code_names_no_model_and_accepts_no_configuration() {
    let mut session = session(Target::Silicon);
    session.mark_code_corrupted();
    assert!(session.hello(0).models.iter().all(|model| model.crc == 0));
    let refused = order(&mut session, Command::Configure(BENCH_B));
    assert_eq!(refused, Err(Refusal::Image { cause: 4 }));
    assert_eq!(session.state(), State::Waiting);
    assert!(session.configure(&BENCH_B).is_err(), "nor one that was kept");
    session.switch_models(crate::store::Models::built_in());
    assert!(session.hello(0).models.iter().all(|model| model.crc == 0), "an update changes nothing of that");
}
