//! Properties of the wire format: what goes in comes out, and nothing else does.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod longest;

use link::authentication::{Authentication, ManifestHash, TAG_LENGTH, Tag};
use link::start::{FaultKind, FaultRecord, KeptConfiguration, ResetReason, StackReport, StartReport};
use link::track::{MonitorConfiguration, SensorStatus};
use link::{
    BenchConfiguration, BlockSummary, BuildId, Calibration, ClockSource, Command, ContactSource,
    ControllerConfiguration, Decoder, EstimateFrame, FrameError, Hello, ImpactEnd, ImpactRecord, InputRange,
    Limits, MAGIC, MAX_FRAME, ModelId, NumberedCommand, NumberedEstimate, PROTOCOL_VERSION, ReportKind,
    SensorFrame, State, Target, ToController, ToHost, VALUES, Wiring, encode,
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
        let bench = BenchConfiguration {
            bearing,
            radial_clearance_nm: words[0],
            journal_radius_nm: words[1],
            sample_period_us: words[2],
            latch_floor_um_s: words[3],
            contact: if words[4].is_multiple_of(2) { ContactSource::Network } else { ContactSource::Law },
        };
        let mut configuration = ControllerConfiguration::new(bench, monitor(words[0]));
        configuration.calibration = offsets.map(|offset| Calibration { offset, gain_ppm: words[1] });
        configuration.limits = Limits {
            force_limit_n: words[2],
            friction_level_limit_per_mille: counts[0],
            deadline_trip_count: counts[0],
            stuck_samples: counts[1],
            slow_every: counts[2],
        };
        configuration.wiring = wiring(words[4], counts[2]);
        configuration
    })
}

/// Returns a configuration with the same value in every field. Every field is an integer of 16 or
/// 32 bits, so each can represent a `u16`.
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
        any::<[u8; TAG_LENGTH]>().prop_map(|hash| Command::PermitUpdate(ManifestHash(hash))),
    ]
}

fn to_controller() -> impl Strategy<Value = ToController> {
    prop_oneof![
        any::<u32>().prop_map(|token| ToController::Identify { token }),
        (any::<u32>(), command())
            .prop_map(|(id, command)| ToController::Command(NumberedCommand { id, command })),
        (any::<u32>(), command(), any::<[u8; TAG_LENGTH]>()).prop_map(|(id, command, tag)| {
            ToController::Authenticated(NumberedCommand { id, command }, Tag(tag))
        }),
        (sensor(), any::<u8>()).prop_map(|(frame, status)| ToController::Sensor(frame, SensorStatus(status))),
    ]
}

fn estimate() -> impl Strategy<Value = EstimateFrame> {
    (any::<(u32, u32, u32, u16, u32)>(), any::<[f32; VALUES]>()).prop_map(
        |((sequence, time_us, flags, saturated, ticks), values)| {
            let mut estimate = EstimateFrame {
                sequence,
                time_us,
                flags,
                saturated,
                instruction_ticks: ticks,
                ..EstimateFrame::default()
            };
            estimate.set_values(values);
            estimate
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
        models: [model; link::MODELS],
        token: u32::MAX,
        last_command: u32::MAX,
        state: State::Tripped,
        configuration_crc: u32::MAX,
        start: StartReport {
            reason: ResetReason::Starved,
            fault: Some(record()),
            kept: KeptConfiguration::SetAside { faulted_starts: u8::MAX },
        },
        stack: StackReport { reserved_bytes: u32::MAX, used_bytes: u32::MAX },
        authentication: Authentication::Required { start: u32::MAX, tag: Tag([u8::MAX; TAG_LENGTH]) },
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
    fn commands_survive_encoding_and_decoding(messages in prop::collection::vec(to_controller(), 1..20)) {
        let bytes: Vec<u8> = messages.iter().flat_map(frame).collect();
        let back = decode_all::<ToController>(&mut Decoder::new(), &bytes);
        prop_assert_eq!(back, messages.into_iter().map(Ok).collect::<Vec<_>>());
    }

    #[test]
    fn estimates_survive_the_link_bit_for_bit(
        sent in estimate(),
        number in any::<u32>(),
        dropped in any::<u8>(),
    ) {
        let message = ToHost::Estimate(NumberedEstimate { number, dropped, estimate: sent });
        let back = decode_all::<ToHost>(&mut Decoder::new(), &frame(&message));
        let [Ok(ToHost::Estimate(back))] = back[..] else { panic!("expected one estimate, found {back:?}") };
        prop_assert!(back.estimate.same_bits(&sent));
        prop_assert_eq!((back.number, back.dropped), (number, dropped));
        prop_assert_eq!(back.estimate.instruction_ticks, sent.instruction_ticks);
    }

    #[test]
    fn impacts_and_blocks_survive_the_link_bit_for_bit(
        words in any::<[u32; 6]>(),
        forces in any::<[f32; 5]>(),
        end in prop::sample::select(vec![ImpactEnd::Separation, ImpactEnd::Settled, ImpactEnd::Interrupted]),
    ) {
        let [number, onset_sequence, onset_us, peak_us, duration_us, flags] = words;
        let [peak_force_n, peak_force_sd_n, approach_speed_m_s, separation_speed_m_s, energy_lost_j] = forces;
        let impact = ImpactRecord {
            number,
            onset_sequence,
            onset_us,
            peak_us,
            duration_us,
            peak_force_n,
            peak_force_sd_n,
            approach_speed_m_s,
            separation_speed_m_s,
            energy_lost_j,
            flags,
            end,
        };
        let (samples, max_age) = (onset_us as u16, peak_us as u16);
        let (max_force_n, min_force_n) = (peak_force_n, energy_lost_j);
        let block = BlockSummary { number, max_force_n, min_force_n, flags, samples, max_age };
        for message in [ToHost::Impact(impact), ToHost::Block(block)] {
            prop_assert_eq!(decode_all::<ToHost>(&mut Decoder::new(), &frame(&message)), vec![Ok(message)]);
        }
    }

    #[test]
    fn garbage_yields_no_message_and_the_next_frame_is_found(
        garbage in prop::collection::vec(any::<u8>(), 0..2000),
        message in to_controller(),
    ) {
        let mut decoder = Decoder::new();
        for result in decode_all::<ToController>(&mut decoder, &garbage) {
            prop_assert!(result.is_err());
        }
        // The first delimiter may still belong to the garbage.
        decode_all::<ToController>(&mut decoder, &[0]);
        prop_assert_eq!(decode_all::<ToController>(&mut decoder, &frame(&message)), vec![Ok(message)]);
    }

    #[test]
    fn a_single_wrong_byte_never_yields_a_wrong_message(
        message in to_controller(),
        next in to_controller(),
        at in any::<prop::sample::Index>(),
        flip in 1..=u8::MAX,
    ) {
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

#[test]
fn a_hello_frame_of_another_version_is_reported_as_such() {
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
