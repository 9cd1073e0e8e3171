//! The link under bytes of every kind: a bounded, seeded run of what the fuzzer does without end (`fuzz/`).
#![expect(clippy::expect_used, reason = "a test fails by panicking")]

mod survives;

use firmware::configuration::BENCH_B;
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

/// A message that the session serves, or nearly: a number is right one time in three.
fn message(random: &mut Random, last_command: u32) -> ToController {
    let mut configuration = BENCH_B;
    // One in four is refused for some field.
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

/// One case: garbage, or frames that are whole, bent, cut short, run together or stuffed with the wrong things.
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
                // A message bent before its check sum was taken.
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
fn a_million_bytes_of_garbage_and_bent_frames_are_survived_counted_and_recovered_from() {
    let mut random = Random(11);
    let mut subject = Subject::default();
    let mut bytes = 0;
    while bytes < BYTES {
        let case = case(&mut random, subject.last_command());
        bytes += case.len();
        subject.survives(&case);
    }
    // Enough of it was understood to be worth the name.
    let [estimates, configurations] = subject.served;
    assert!(estimates > 1_000 && configurations > 50, "{estimates}, {configurations}");
}

#[test]
fn payloads_behind_the_check_sum_are_survived() {
    let mut random = Random(12);
    let mut subject = Subject::default();
    for _ in 0..2_000 {
        let count = random.below(400);
        let mut case = vec![1];
        case.extend(random.bytes(count));
        subject.survives(&case);
    }
}
