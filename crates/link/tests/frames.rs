//! Properties of the wire format: what goes in comes out, and nothing else does.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use link::start::{
    FaultKind, FaultRecord, PARTIES, Presence, ResetReason, StackReport, StartReport, SupervisorReport,
};
use link::track::{CHANNELS, ChannelCounts, MonitorConfiguration, MonitorField, SensorHealth, SensorStatus};
use link::update::{
    ModelMemory, ModelSource, Receiving, RefusedPackage, SlotState, UpdateAnswer, UpdateRefusal, UpdateStatus,
};
use link::{
    Acknowledgement, Answer, BuildId, Calibration, ClockSource, Command, Configuration, Configured,
    ControllerConfiguration, Counters, Decoder, EstimateFrame, Fault, Field, FrameError, Hello, InputRange,
    Limits, MAGIC, MAX_FRAME, MAX_REASONS, ModelId, NumberedCommand, NumberedEstimate, OutOfRange,
    PROTOCOL_VERSION, Reasons, Refused, ReportKind, SensorFrame, SlowFrame, SlowReport, State, Target,
    ToController, ToHost, Wiring, encode,
};
use proptest::prelude::*;

fn sensor() -> impl Strategy<Value = SensorFrame> {
    any::<(u32, u32, i32, i32, i32, i32)>().prop_map(|(sequence, time_us, y, z, angle, load)| SensorFrame {
        sequence,
        time_us,
        journal_y_nm: y,
        journal_z_nm: z,
        shaft_angle_nrad: angle,
        load_force_mn: load,
    })
}

fn configuration() -> impl Strategy<Value = ControllerConfiguration> {
    any::<([u32; 5], [i32; 4], [u16; 3], u8)>().prop_map(|(words, offsets, counts, bearing)| {
        let bench = Configuration {
            bearing,
            radial_clearance_nm: words[0],
            journal_radius_nm: words[1],
            sample_period_us: words[2],
            latch_floor_um_s: words[3],
            unseen_approach_um_s: words[4],
        };
        let mut configuration = ControllerConfiguration::new(bench, monitor(words[0]));
        configuration.calibration = offsets.map(|offset| Calibration { offset, gain_ppm: words[1] });
        configuration.limits = Limits {
            force_limit_n: words[2],
            friction_level_limit_per_mille: words[3],
            deadline_trip_count: counts[0],
            stuck_samples: counts[1],
            slow_every: counts[2],
        };
        configuration.wiring = wiring(words[4], counts[2]);
        configuration
    })
}

/// Every field the same. Every field is an integer of 16 or 32 bits, signed or not: each reads what a u16 wrote.
fn monitor(value: u32) -> MonitorConfiguration {
    let mut room = [0; 256];
    let bytes = postcard::to_slice(&[[value as u16; 32]; 2], &mut room).unwrap();
    postcard::take_from_bytes(bytes).unwrap().0
}

fn wiring(word: u32, half: u16) -> Wiring {
    Wiring {
        probe_inputs: [half as u8; 2],
        load_input: half as u8,
        probe_range: InputRange::Bipolar2V5,
        load_range: InputRange::Unipolar10V,
        probe_gain_nm_v: [word as i32, !word as i32],
        centre_gap_um: [half; 2],
        first_probe_centidegrees: half as i16,
        shunt_deciohm: half,
        transmitter_range_kpa: word,
        piston_mm2: word,
        sample_at_start: half.is_multiple_of(2),
    }
}

fn command() -> impl Strategy<Value = Command> {
    prop_oneof![
        configuration().prop_map(Command::Configure),
        Just(Command::GetConfiguration),
        Just(Command::Keep),
        Just(Command::GetCounters),
        Just(Command::ClearTrip),
        Just(Command::Stop),
        Just(Command::SampleYourself),
        prop::sample::select(ReportKind::ALL.to_vec()).prop_map(Command::GetReport),
    ]
}

fn to_controller() -> impl Strategy<Value = ToController> {
    prop_oneof![
        any::<u32>().prop_map(|token| ToController::Identify { token }),
        (any::<u32>(), command())
            .prop_map(|(id, command)| ToController::Command(NumberedCommand { id, command })),
        (sensor(), any::<u8>()).prop_map(|(frame, status)| ToController::Sensor(frame, SensorStatus(status))),
    ]
}

fn estimate() -> impl Strategy<Value = EstimateFrame> {
    (any::<(u32, u32, u32, u16, u32)>(), any::<[f32; 6]>()).prop_map(
        |((sequence, time_us, flags, saturated, ticks), f)| EstimateFrame {
            sequence,
            time_us,
            normal_force_n: f[0],
            force_y_n: f[1],
            force_z_n: f[2],
            friction_torque_nm: f[3],
            deformation_m: f[4],
            contact_angle_rad: f[5],
            flags,
            saturated,
            instruction_ticks: ticks,
        },
    )
}

fn hello(protocol: u8) -> Hello {
    let model = ModelId { crc: u32::MAX, training_id: u64::MAX };
    Hello {
        magic: MAGIC,
        protocol,
        build_id: BuildId::new("v0.1.0-12345-g0123456789abcdef-dirty"),
        target: Target::Silicon,
        clock: ClockSource::PllInternal,
        core_hz: u32::MAX,
        window: u16::MAX,
        models: [model; 2],
        token: u32::MAX,
        last_command: u32::MAX,
        state: State::Tripped,
        configuration_crc: u32::MAX,
        start: StartReport { reason: ResetReason::Starved, fault: Some(record()) },
        stack: StackReport { reserved_bytes: u32::MAX, used_bytes: u32::MAX },
    }
}

fn record() -> FaultRecord {
    let all = u32::MAX;
    FaultRecord {
        kind: FaultKind::Starved { missing: 0xFF },
        pc: all,
        lr: all,
        cfsr: all,
        hfsr: all,
        address: Some(all),
        msp: all,
        build: all,
        count: all,
    }
}

fn frame<M: serde::Serialize>(message: &M) -> Vec<u8> {
    let mut buffer = [0; MAX_FRAME];
    encode(message, &mut buffer).unwrap().to_vec()
}

fn decode_all<M: serde::de::DeserializeOwned>(
    decoder: &mut Decoder,
    bytes: &[u8],
) -> Vec<Result<M, FrameError>> {
    bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
}

proptest! {
    #[test]
    fn commands_come_back_whole(messages in prop::collection::vec(to_controller(), 1..20)) {
        let bytes: Vec<u8> = messages.iter().flat_map(frame).collect();
        let back = decode_all::<ToController>(&mut Decoder::new(), &bytes);
        prop_assert_eq!(back, messages.into_iter().map(Ok).collect::<Vec<_>>());
    }

    #[test]
    fn estimates_come_back_bit_for_bit(sent in estimate(), number in any::<u32>(), dropped in any::<u8>()) {
        let message = ToHost::Estimate(NumberedEstimate { number, dropped, estimate: sent });
        let back = decode_all::<ToHost>(&mut Decoder::new(), &frame(&message));
        let [Ok(ToHost::Estimate(back))] = back[..] else { panic!("expected one estimate, found {back:?}") };
        prop_assert!(back.estimate.same_bits(&sent));
        prop_assert_eq!((back.number, back.dropped), (number, dropped));
        prop_assert_eq!(back.estimate.instruction_ticks, sent.instruction_ticks);
    }

    #[test]
    fn garbage_yields_nothing_and_the_next_frame_is_found(garbage in prop::collection::vec(any::<u8>(), 0..2000), message in to_controller()) {
        let mut decoder = Decoder::new();
        for result in decode_all::<ToController>(&mut decoder, &garbage) {
            prop_assert!(result.is_err());
        }
        // The first delimiter may still belong to the garbage.
        decode_all::<ToController>(&mut decoder, &[0]);
        prop_assert_eq!(decode_all::<ToController>(&mut decoder, &frame(&message)), vec![Ok(message)]);
    }

    #[test]
    fn a_single_wrong_byte_never_yields_a_wrong_message(message in to_controller(), next in to_controller(), at in any::<prop::sample::Index>(), flip in 1..=u8::MAX) {
        let mut bytes = frame(&message);
        let at = at.index(bytes.len());
        bytes[at] ^= flip;
        let delimiter_lost = at + 1 == bytes.len();
        bytes.extend(frame(&next));
        let mut decoder = Decoder::new();
        let results = decode_all::<ToController>(&mut decoder, &bytes);
        let sound: Vec<_> = results.iter().filter_map(|r| r.ok()).collect();
        let expected = if delimiter_lost { vec![] } else { vec![next] };
        prop_assert_eq!(sound, expected);
        prop_assert!(decoder.bad_frames().total() > 0);
    }
}

/// Every field as long as it can be.
fn longest_monitor() -> MonitorConfiguration {
    let (all, half) = (u32::MAX, u16::MAX);
    MonitorConfiguration {
        mass_g: all,
        inertia_g_m2: all,
        drive_lever_um: all,
        load_lever_um: all,
        crank_vertical_nrad: i32::MIN,
        effective_modulus_kpa: all,
        damping_per_mille: all,
        stiffness_deviation_per_mille: half,
        inertia_deviation_per_mille: half,
        mass_deviation_per_mille: half,
        lever_deviation_ppht: half,
        offset_deviation_nm: all,
        journal_noise_nm: half,
        journal_noise_limit_nm: all,
        angle_noise_limit_nrad: all,
        load_noise_limit_mn: all,
        load_stuck_samples: all,
        journal_rail_nm: all,
        load_rail_mn: all,
        envelope_per_mille: all,
        envelope_floor_mn: all,
        recovery_samples: all,
        lost_samples: all,
        wear_limit_nm: all,
        wear_hysteresis_nm: all,
    }
}

#[test]
fn the_longest_answers_fit_into_a_frame() {
    let all = u32::MAX;
    let counters = Counters {
        samples: all,
        flagged: all,
        sequence_gaps: all,
        time_faults: all,
        over_force: all,
        deadline_overruns: all,
        trips: all,
        held: all,
        idle_ticks: all,
        dropped_samples: all,
        dropped_estimates: all,
        dropped_answers: all,
        repeated_commands: all,
        refused_commands: all,
        dropped_bytes: all,
        line_errors: link::LineErrors { overruns: all, framing: all, noise: all },
        bad_frames: link::BadFrames { cobs: all, crc: all, overlong: all, unknown: all },
    };
    let bench = Configuration {
        bearing: u8::MAX,
        radial_clearance_nm: all,
        journal_radius_nm: all,
        sample_period_us: all,
        latch_floor_um_s: all,
        unseen_approach_um_s: all,
    };
    let calibration = Calibration { offset: i32::MIN, gain_ppm: all };
    let limits = Limits {
        force_limit_n: all,
        friction_level_limit_per_mille: all,
        deadline_trip_count: u16::MAX,
        stuck_samples: u16::MAX,
        slow_every: u16::MAX,
    };
    let configuration = ControllerConfiguration {
        calibration: [calibration; CHANNELS],
        limits,
        wiring: Wiring {
            probe_gain_nm_v: [i32::MIN; 2],
            first_probe_centidegrees: i16::MIN,
            ..wiring(all, u16::MAX)
        },
        ..ControllerConfiguration::new(bench, longest_monitor())
    };
    let (min, max) = (i64::from(i32::MIN), i64::from(all));
    let reason = OutOfRange { field: Field::Monitor(MonitorField::WearHysteresis), found: min, min, max };
    let mut reasons = Reasons::default();
    for _ in 0..MAX_REASONS + 3 {
        reasons.add(reason);
    }
    assert_eq!((usize::from(reasons.count), reasons.iter().count()), (MAX_REASONS + 3, MAX_REASONS));
    let counts = ChannelCounts { missing: all, saturated: all, stuck: all, noisy: all, jumped: all };
    let health = SensorHealth { channels: [counts; CHANNELS], ..SensorHealth::default() };
    let presence = Presence { expected: true, away_us: all, longest_us: all, period_us: all };
    let supervisor = SupervisorReport {
        uptime_us: all,
        parties: [presence; PARTIES.len()],
        start: StartReport { reason: ResetReason::Starved, fault: Some(record()) },
        stack: StackReport { reserved_bytes: all, used_bytes: all },
    };
    let models = UpdateStatus {
        running: ModelSource::Slot { slot: 1, version: all, hash: [255; 4] },
        memory: ModelMemory::Volatile,
        capacity: all,
        receiving: Some(Receiving { version: all, next_offset: all, length: all }),
        refused: u16::MAX,
        altered: u16::MAX,
        development_key: true,
        slots: [SlotState::Sound { version: all }; 2],
        last_refusal: Some(RefusedPackage {
            number: u16::MAX,
            slot: Some(1),
            version: all,
            reason: UpdateRefusal::TooLong { found: all, most: all },
        }),
    };
    let slow = |report| ToHost::Slow(SlowFrame { number: all, sequence: all, state: State::Tripped, report });
    let outcomes = [
        Ok(Answer::Configured(Configured {
            configuration_crc: all,
            model: ModelId { crc: all, training_id: u64::MAX },
            window: u16::MAX,
        })),
        Ok(Answer::Configuration(Some(configuration))),
        Ok(Answer::Stopped(counters)),
        Ok(Answer::Report(SlowReport::Sensors(health))),
        Ok(Answer::Report(SlowReport::Supervisor(supervisor))),
        Err(Refused::Configuration(reasons)),
        Err(Refused::OutOfOrder { expected: all }),
    ];
    let answers = outcomes
        .map(|outcome| ToHost::Acknowledged(Acknowledgement { id: all, outcome }))
        .into_iter()
        .chain([
            ToHost::Hello(hello(PROTOCOL_VERSION)),
            slow(SlowReport::Counters(counters)),
            slow(SlowReport::Sensors(health)),
            slow(SlowReport::Supervisor(supervisor)),
            slow(SlowReport::Models(models)),
            slow(SlowReport::Estimate(link::EstimateLayout([255; 3], [[255; 4]; 11]))),
            slow(SlowReport::Sample(SensorFrame {
                sequence: all,
                journal_y_nm: i32::MIN,
                ..SensorFrame::default()
            })),
            ToHost::Update(UpdateAnswer::Status(models)),
            ToHost::Fault(Fault::BadFrame(FrameError::OtherVersion { found: 255 })),
        ]);
    for answer in answers {
        assert_eq!(decode_all::<ToHost>(&mut Decoder::new(), &frame(&answer)), [Ok(answer)]);
    }
    let command =
        ToController::Command(NumberedCommand { id: all, command: Command::Configure(configuration) });
    assert_eq!(decode_all::<ToController>(&mut Decoder::new(), &frame(&command)), [Ok(command)]);
}

#[test]
fn a_greeting_of_another_version_is_named_so() {
    let mut decoder = Decoder::new();
    let other = frame(&ToHost::Hello(hello(PROTOCOL_VERSION + 1)));
    let expected = FrameError::OtherVersion { found: PROTOCOL_VERSION + 1 };
    assert_eq!(decode_all::<ToHost>(&mut decoder, &other), [Err(expected)]);
    assert_eq!(decoder.bad_frames().unknown, 1);
}

#[test]
fn each_cause_is_counted_once() {
    let mut decoder = Decoder::new();
    let stop = frame(&ToController::Command(NumberedCommand { id: 7, command: Command::Stop }));
    let mut wrong_sum = stop.clone();
    wrong_sum[2] ^= 0x10;
    for bytes in
        [&wrong_sum[..], &[9, 1, 0], &[[1; 400].as_slice(), &[0]].concat(), &frame(&(77_u8, 3_u8)), &stop]
    {
        decode_all::<ToController>(&mut decoder, bytes);
    }
    let bad = decoder.bad_frames();
    assert_eq!((bad.crc, bad.cobs, bad.overlong, bad.unknown), (1, 1, 1, 1));
}

#[test]
fn a_build_id_keeps_what_fits() {
    assert_eq!(BuildId::new("v0.1.0").as_str(), "v0.1.0");
    assert_eq!(BuildId::new(&"x".repeat(99)).as_str(), "x".repeat(link::BUILD_ID_LEN));
}
