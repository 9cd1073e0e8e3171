//! The link with arbitrary bytes: a bounded, seeded run of the test that the fuzzer runs without
//! end (`fuzz/`).
#![expect(clippy::expect_used, reason = "a test fails by panicking")]

mod survives;

use controller::configuration::BENCH_B;
use link::track::SensorStatus;
use link::{Command, MAX_FRAME, NumberedCommand, SensorFrame, ToController, encode};
use survives::{Subject, framed};

/// Bytes of the run.
const BYTES: usize = 1_500_000;

/// SplitMix64: small, and the same everywhere.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.bits() % end.max(1) as u64) as usize
    }

    fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.bits() as u8).collect()
    }
}

/// A message that the session accepts or almost accepts. One in three commands has the right
/// number.
fn message(random: &mut Random, last_command: u32) -> ToController {
    let mut configuration = BENCH_B;
    // One in four is refused because of a field.
    if random.below(4) == 0 {
        configuration.bench.bearing = random.below(9) as u8;
        configuration.bench.radial_clearance_nm = random.bits() as u32 >> random.below(32);
    }
    configuration.limits.deadline_trip_count = random.below(4) as u16;
    configuration.limits.slow_every = 10 * random.below(3) as u16;
    let command = match random.below(8) {
        0..3 => Command::Configure(configuration),
        3 => Command::GetConfiguration,
        4 => Command::GetCounters,
        5 => Command::ClearTrip,
        6 => Command::Keep,
        _ => Command::Stop,
    };
    match random.below(4) {
        0 => ToController::Identify { token: random.bits() as u32 },
        1 => ToController::Command(NumberedCommand {
            id: last_command.wrapping_add(random.below(3) as u32),
            command,
        }),
        _ => {
            let frame = SensorFrame {
                sequence: random.bits() as u32,
                time_us: random.bits() as u32,
                journal_y_nm: random.bits() as i32,
                journal_z_nm: random.bits() as i32,
                shaft_angle_nrad: random.bits() as i32,
                load_force_mn: random.bits() as i32,
            };
            ToController::Sensor(frame, SensorStatus(random.bits() as u8))
        }
    }
}

/// One case: garbage, or frames that are complete, corrupted, truncated, merged or contain a wrong
/// payload.
fn case(random: &mut Random, last_command: u32) -> Vec<u8> {
    let mut case = vec![0];
    for _ in 0..1 + random.below(6) {
        let mut buffer = [0; MAX_FRAME];
        let mut frame =
            encode(&message(random, last_command), &mut buffer).expect("every message fits").to_vec();
        match random.below(7) {
            0 => {
                let count = random.below(600);
                frame = random.bytes(count);
            }
            1 => {
                let at = random.below(frame.len());
                frame[at] ^= 1 << random.below(8);
            }
            2 => frame.truncate(random.below(frame.len())),
            3 => drop(frame.pop()),
            4 => {
                let count = random.below(300);
                frame = framed(&random.bytes(count));
            }
            5 => {
                // A message that was corrupted before its checksum was computed.
                let mut payload = postcard::to_slice(&message(random, last_command), &mut buffer)
                    .expect("it fits")
                    .to_vec();
                let at = random.below(payload.len());
                payload[at] ^= 1 << random.below(8);
                frame = framed(&payload);
            }
            _ => {}
        }
        case.extend(frame);
    }
    case
}

#[test]
fn the_link_counts_and_recovers_from_a_million_bytes_of_garbage_and_corrupted_frames() {
    let mut random = Random(11);
    let mut subject = Subject::default();
    let mut bytes = 0;
    while bytes < BYTES {
        let case = case(&mut random, subject.last_command());
        bytes += case.len();
        subject.survives(&case);
    }
    // Enough messages were accepted for a meaningful test.
    let [estimates, configurations] = subject.served;
    assert!(estimates > 1_000 && configurations > 50, "{estimates}, {configurations}");
}

#[test]
fn random_payloads_with_a_correct_checksum_are_accepted_or_refused() {
    let mut random = Random(12);
    let mut subject = Subject::default();
    for _ in 0..2_000 {
        let count = random.below(400);
        let mut case = vec![1];
        case.extend(random.bytes(count));
        subject.survives(&case);
    }
}
