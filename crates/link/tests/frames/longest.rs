//! Messages with the longest encoding of every field: they fit into a frame.

use super::{decode_all, frame, hello, record, wiring};
use link::start::{
    KeptConfiguration, PARTIES, Presence, ResetReason, StackReport, StartReport, SupervisorReport,
};
use link::track::{CHANNELS, ChannelCounts, MonitorConfiguration, MonitorField, SensorHealth};
use link::update::{
    ModelMemory, ModelSource, Receiving, RefusedPackage, SlotState, UpdateAnswer, UpdateRefusal, UpdateStatus,
};
use link::{
    Acknowledgement, Answer, BadFrames, BenchConfiguration, BlockSummary, Calibration, Command, Configured,
    ContactSource, ControllerConfiguration, Counters, Decoder, EstimateLayout, Fault, Field, FrameError,
    ImpactEnd, ImpactRecord, Limits, LineErrors, MAX_REASONS, ModelId, NumberedCommand, OutOfRange,
    PROTOCOL_VERSION, Reasons, Refusal, SamplingReport, SensorFrame, SlowFrame, SlowReport, State,
    ToController, ToHost, Wiring,
};

const ALL: u32 = u32::MAX;

fn counters() -> Counters {
    Counters {
        samples: ALL,
        flagged: ALL,
        sequence_gaps: ALL,
        time_faults: ALL,
        over_force: ALL,
        deadline_overruns: ALL,
        trips: ALL,
        held: ALL,
        idle_ticks: ALL,
        dropped_samples: ALL,
        dropped_estimates: ALL,
        impacts: ALL,
        dropped_impacts: ALL,
        dropped_answers: ALL,
        repeated_commands: ALL,
        refused_commands: ALL,
        dropped_bytes: ALL,
        line_errors: LineErrors { overruns: ALL, framing: ALL, noise: ALL },
        bad_frames: BadFrames { cobs: ALL, crc: ALL, overlong: ALL, unknown: ALL },
    }
}

fn monitor() -> MonitorConfiguration {
    let half = u16::MAX;
    MonitorConfiguration {
        mass_g: ALL,
        inertia_g_m2: ALL,
        drive_lever_um: ALL,
        load_lever_um: ALL,
        crank_vertical_nrad: i32::MIN,
        effective_modulus_kpa: ALL,
        damping_per_mille: half,
        stiffness_deviation_per_mille: half,
        inertia_deviation_per_mille: half,
        mass_deviation_per_mille: half,
        lever_deviation_ppht: half,
        clearance_deviation_nm: ALL,
        friction_deviation_per_mille: half,
        friction_level_per_mille: half,
        stroke_mm: half,
        drive_period_ms: half,
        journal_noise_nm: half,
        angle_noise_nrad: ALL,
        journal_noise_limit_nm: ALL,
        angle_noise_limit_nrad: ALL,
        load_noise_limit_mn: ALL,
        load_stuck_samples: half,
        journal_rail_nm: ALL,
        load_rail_mn: ALL,
        envelope_per_mille: half,
        envelope_floor_n: half,
        recovery_samples: half,
        lost_samples: ALL,
        wear_limit_nm: ALL,
        wear_hysteresis_nm: ALL,
    }
}

fn configuration() -> ControllerConfiguration {
    let bench = BenchConfiguration {
        bearing: u8::MAX,
        radial_clearance_nm: ALL,
        journal_radius_nm: ALL,
        sample_period_us: ALL,
        latch_floor_um_s: ALL,
        contact: ContactSource::Law,
    };
    let limits = Limits {
        force_limit_n: ALL,
        friction_level_limit_per_mille: u16::MAX,
        deadline_trip_count: u16::MAX,
        stuck_samples: u16::MAX,
        slow_every: u16::MAX,
    };
    ControllerConfiguration {
        calibration: [Calibration { offset: i32::MIN, gain_ppm: ALL }; CHANNELS],
        limits,
        wiring: Wiring {
            probe_gain_nm_v: [i32::MIN; 2],
            first_probe_centidegrees: i16::MIN,
            ..wiring(ALL, u16::MAX)
        },
        ..ControllerConfiguration::new(bench, monitor())
    }
}

fn reasons() -> Reasons {
    let (min, max) = (i64::from(i32::MIN), i64::from(ALL));
    let reason = OutOfRange { field: Field::Monitor(MonitorField::WearHysteresis), found: min, min, max };
    let mut reasons = Reasons::default();
    for _ in 0..MAX_REASONS + 3 {
        reasons.add(reason);
    }
    assert_eq!((usize::from(reasons.count), reasons.iter().count()), (MAX_REASONS + 3, MAX_REASONS));
    reasons
}

fn health() -> SensorHealth {
    let counts = ChannelCounts { missing: ALL, saturated: ALL, stuck: ALL, noisy: ALL, jumped: ALL };
    SensorHealth { channels: [counts; CHANNELS], ..SensorHealth::default() }
}

fn supervisor() -> SupervisorReport {
    let presence = Presence { expected: true, away_us: ALL, longest_us: ALL, period_us: ALL };
    SupervisorReport {
        uptime_us: ALL,
        parties: [presence; PARTIES.len()],
        start: StartReport {
            reason: ResetReason::Starved,
            fault: Some(record()),
            kept: KeptConfiguration::SetAside { faulted_starts: u8::MAX },
        },
        stack: StackReport { reserved_bytes: ALL, used_bytes: ALL },
    }
}

fn models() -> UpdateStatus {
    UpdateStatus {
        running: ModelSource::Slot { slot: 1, version: ALL, hash: [255; 4] },
        memory: ModelMemory::Volatile,
        capacity: ALL,
        receiving: Some(Receiving { version: ALL, next_offset: ALL, length: ALL }),
        refused: u16::MAX,
        corrupted: u16::MAX,
        development_key: true,
        slots: [SlotState::Valid { version: ALL }; 2],
        last_refusal: Some(RefusedPackage {
            number: u16::MAX,
            slot: Some(1),
            version: ALL,
            reason: UpdateRefusal::TooLong { found: ALL, most: ALL },
        }),
        min_version: ALL,
        trusted_keys: u8::MAX,
        revoked_keys: u8::MAX,
    }
}

fn impact() -> ImpactRecord {
    ImpactRecord {
        number: ALL,
        onset_sequence: ALL,
        onset_us: ALL,
        peak_us: ALL,
        duration_us: ALL,
        peak_force_n: f32::MAX,
        peak_force_sd_n: f32::INFINITY,
        approach_speed_m_s: f32::MIN,
        separation_speed_m_s: f32::MAX,
        energy_lost_j: f32::MAX,
        flags: ALL,
        end: ImpactEnd::Interrupted,
    }
}

fn outcomes() -> [Result<Answer, Refusal>; 7] {
    let model = ModelId { crc: ALL, training_id: u64::MAX };
    [
        Ok(Answer::Configured(Configured { configuration_crc: ALL, model, window: u16::MAX })),
        Ok(Answer::Configuration(Some(configuration()))),
        Ok(Answer::Stopped(counters())),
        Ok(Answer::Report(SlowReport::Sensors(health()))),
        Ok(Answer::Report(SlowReport::Supervisor(supervisor()))),
        Err(Refusal::Configuration(reasons())),
        Err(Refusal::OutOfOrder { expected: ALL }),
    ]
}

fn slow_reports() -> [SlowReport; 7] {
    [
        SlowReport::Counters(counters()),
        SlowReport::Sensors(health()),
        SlowReport::Supervisor(supervisor()),
        SlowReport::Models(models()),
        SlowReport::Estimate(EstimateLayout([255; 3], [[255; 4]; 24])),
        SlowReport::Sample(SensorFrame { sequence: ALL, journal_y_nm: i32::MIN, ..SensorFrame::default() }),
        SlowReport::Sampling(SamplingReport {
            lost: ALL,
            halts: ALL,
            halted_us: ALL,
            early_ns: ALL,
            late_ns: ALL,
            input_interval_ns: ALL,
        }),
    ]
}

#[test]
fn the_longest_answers_fit_into_a_frame() {
    let acknowledge = |outcome| ToHost::Acknowledged(Acknowledgement { id: ALL, outcome });
    let slow = |report| ToHost::Slow(SlowFrame { number: ALL, sequence: ALL, state: State::Tripped, report });
    let others = [
        ToHost::Hello(hello(PROTOCOL_VERSION)),
        ToHost::Update(UpdateAnswer::Status(models())),
        ToHost::Impact(impact()),
        ToHost::Block(BlockSummary {
            number: ALL,
            max_force_n: f32::MAX,
            min_force_n: f32::MIN,
            flags: ALL,
            samples: u16::MAX,
            max_age: u16::MAX,
        }),
        ToHost::Fault(Fault::BadFrame(FrameError::OtherVersion { found: 255 })),
    ];
    let answers = outcomes().into_iter().map(acknowledge).chain(slow_reports().into_iter().map(slow));
    for answer in answers.chain(others) {
        assert_eq!(decode_all::<ToHost>(&mut Decoder::new(), &frame(&answer)), [Ok(answer)]);
    }
    let command = NumberedCommand { id: ALL, command: Command::Configure(configuration()) };
    let command = ToController::Command(command);
    assert_eq!(decode_all::<ToController>(&mut Decoder::new(), &frame(&command)), [Ok(command)]);
}
