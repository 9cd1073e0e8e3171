//! Properties of the wire format: what goes in comes out, and nothing else does.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use link::{
    BuildId, ClockSource, Configuration, Configured, Counters, Decoder, EstimateFrame, Fault, FrameError,
    Hello, MAGIC, MAX_FRAME, ModelId, PROTOCOL_VERSION, Refusal, SensorFrame, Target, ToController, ToHost,
    encode,
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

fn configuration() -> impl Strategy<Value = Configuration> {
    any::<(u8, u32, u32, u32, u32)>().prop_map(|(bearing, clearance, radius, period, floor)| Configuration {
        bearing,
        radial_clearance_nm: clearance,
        journal_radius_nm: radius,
        sample_period_us: period,
        latch_floor_um_s: floor,
        unseen_approach_um_s: floor,
    })
}

fn to_controller() -> impl Strategy<Value = ToController> {
    prop_oneof![
        Just(ToController::Identify),
        configuration().prop_map(ToController::Configure),
        sensor().prop_map(ToController::Sensor),
        Just(ToController::Stop),
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
    fn estimates_come_back_bit_for_bit(sent in estimate()) {
        let back = decode_all::<ToHost>(&mut Decoder::new(), &frame(&ToHost::Estimate(sent)));
        let [Ok(ToHost::Estimate(back))] = back[..] else { panic!("expected one estimate, found {back:?}") };
        prop_assert!(back.same_bits(&sent));
        prop_assert_eq!(back.instruction_ticks, sent.instruction_ticks);
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

#[test]
fn every_answer_fits_into_a_frame() {
    let counters = Counters {
        samples: u32::MAX,
        flagged: u32::MAX,
        sequence_gaps: u32::MAX,
        time_faults: u32::MAX,
        deadline_overruns: u32::MAX,
        idle_ticks: u32::MAX,
        dropped: u32::MAX,
        bad_frames: link::BadFrames { cobs: u32::MAX, crc: u32::MAX, overlong: u32::MAX, unknown: u32::MAX },
    };
    let configuration = Configuration {
        bearing: u8::MAX,
        radial_clearance_nm: u32::MAX,
        journal_radius_nm: u32::MAX,
        sample_period_us: u32::MAX,
        latch_floor_um_s: u32::MAX,
        unseen_approach_um_s: u32::MAX,
    };
    let model = ModelId { crc: u32::MAX, training_id: u64::MAX };
    let answers = [
        ToHost::Hello(hello(PROTOCOL_VERSION)),
        ToHost::Configured(Configured { configuration, model, window: u16::MAX }),
        ToHost::Stopped(counters),
        ToHost::Fault(Fault::Refused(Refusal::SamplePeriod {
            found_us: u32::MAX,
            min_us: u32::MAX,
            max_us: u32::MAX,
        })),
        ToHost::Fault(Fault::BadFrame(FrameError::OtherVersion { found: 255 })),
    ];
    for answer in answers {
        assert_eq!(decode_all::<ToHost>(&mut Decoder::new(), &frame(&answer)), [Ok(answer)]);
    }
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
    let stop = frame(&ToController::Stop);
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
