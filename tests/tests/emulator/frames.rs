//! Sensor frames that exercise every state of the estimator, the same in every run.
//!
//! The journal swings along the clearance circle and in and out of contact with 0.4 um of noise.
//! Between clean sections there are disturbances: jumps, lost samples, wrong times, stuck sensors,
//! deep and fast contacts, a racing shaft, the centre of the bearing, the ends of the integer
//! range.

use controller::configuration::BENCH_B;
use core::f64::consts::{FRAC_PI_2, TAU};
use inference::BearingMaterial;
use link::{BenchConfiguration, ControllerConfiguration, SensorFrame};
use system_tests::random::SplitMix64;

/// Samples of a section: enough to detect a stuck sensor and to fill the networks' history again.
const STRETCH: u32 = 250;
/// Samples of a round through all disturbances.
const ROUND: u32 = 2 * STRETCH * DISTURBANCES.len() as u32;
/// A load that the bench bears, mN.
const PLAUSIBLE_MN: i32 = 3_000_000;

/// Returns the configuration of bench B with a bearing.
pub(crate) fn configuration(bearing: BearingMaterial) -> ControllerConfiguration {
    let bench = BenchConfiguration { bearing: bearing.code(), ..BENCH_B.bench };
    ControllerConfiguration { bench, ..BENCH_B }
}

/// Random bits with the draws of the disturbed samples.
struct Random(SplitMix64);

impl Random {
    /// Returns a uniform number in [-1, 1).
    fn unit(&mut self) -> f64 {
        (self.0.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn code(&mut self) -> i32 {
        match self.0.bits() % 4 {
            0 => i32::MIN,
            1 => i32::MAX,
            _ => self.0.bits() as i32,
        }
    }
}

/// Disturbance of a section.
#[derive(Clone, Copy, PartialEq)]
enum Disturbance {
    None,
    Jump,
    Lost,
    Late,
    StuckAngle,
    StuckJournal,
    Deep,
    Fast,
    Racing,
    Centre,
    Extreme,
}

const DISTURBANCES: [Disturbance; 10] = [
    Disturbance::Jump,
    Disturbance::Lost,
    Disturbance::Late,
    Disturbance::StuckAngle,
    Disturbance::StuckJournal,
    Disturbance::Deep,
    Disturbance::Fast,
    Disturbance::Racing,
    Disturbance::Centre,
    Disturbance::Extreme,
];

/// Returns `count` frames for a configuration. Every second section is clean; all disturbances take
/// 5,000 frames. The load is random for 5,000 frames and plausible for the next 5,000: a load known
/// to be faulty hides an implausible swing.
pub(crate) fn disturbed_frames(
    configuration: &ControllerConfiguration,
    count: u32,
    seed: u64,
) -> Vec<SensorFrame> {
    let configuration = configuration.bench;
    let mut random = Random(SplitMix64(seed));
    let clearance_m = f64::from(configuration.radial_clearance_nm) * 1e-9;
    let period_s = f64::from(configuration.sample_period_us) * 1e-6;
    let (mut lost, mut late_us, mut angle_rad) = (0_u32, 0_u32, 0.0);
    let mut frames: Vec<SensorFrame> = Vec::new();
    for index in 0..count {
        let (stretch, within) = (index / STRETCH, index % STRETCH);
        let trouble = match DISTURBANCES.get((stretch / 2) as usize % DISTURBANCES.len()) {
            Some(trouble) if stretch % 2 == 1 => *trouble,
            _ => Disturbance::None,
        };
        let t = f64::from(index) * period_s;
        let (mean_m, breath_m, breath_hz) = match trouble {
            Disturbance::Deep => (400e-6, 200e-6, 40.0),
            Disturbance::Fast => (0.0, 100e-6, 300.0),
            Disturbance::Centre => (-clearance_m, 1e-6, 30.0),
            _ => (15e-6, 30e-6, 33.0),
        };
        let shaft_rad_s = if trouble == Disturbance::Racing { 30.0 } else { 0.5 * (TAU * 1.5 * t).cos() };
        angle_rad += shaft_rad_s * period_s;
        let swing_rad = 0.5e-3 / clearance_m * (TAU * 45.0 * t).sin() - FRAC_PI_2;
        let distance_m = clearance_m + mean_m + breath_m * (TAU * breath_hz * t).sin();
        let mut read = |value: f64| ((value + 0.4e-6 * random.unit()) * 1e9).round() as i32;
        let (journal_y_nm, journal_z_nm) =
            (read(distance_m * swing_rad.cos()), read(distance_m * swing_rad.sin()));
        let noisy_angle = angle_rad + 40e-6 * random.unit();
        lost += u32::from(trouble == Disturbance::Lost && within % 60 == 0);
        late_us += if trouble == Disturbance::Late && within % 90 == 0 { 77 } else { 0 };
        let sequence = index + lost;
        let load = random.code();
        let is_wild = (index / ROUND).is_multiple_of(2);
        let load_force_mn = if is_wild { load } else { PLAUSIBLE_MN + load / 100_000 };
        let mut frame = SensorFrame {
            sequence,
            time_us: (sequence * configuration.sample_period_us).wrapping_add(late_us),
            journal_y_nm,
            journal_z_nm,
            shaft_angle_nrad: (noisy_angle * 1e9).round() as i64 as i32,
            load_force_mn,
        };
        let previous = frames.last().copied().unwrap_or(frame);
        disturb(&mut frame, trouble, within, &previous, &mut random);
        frames.push(frame);
    }
    frames
}

/// Changes the values of a frame; `within` is its place in the section.
fn disturb(
    frame: &mut SensorFrame,
    trouble: Disturbance,
    within: u32,
    previous: &SensorFrame,
    random: &mut Random,
) {
    match trouble {
        Disturbance::Jump if within % 80 == 40 => frame.journal_z_nm += 100_000,
        Disturbance::Jump if within % 80 == 70 => frame.shaft_angle_nrad ^= 1 << 29,
        Disturbance::StuckAngle if within > 0 => frame.shaft_angle_nrad = previous.shaft_angle_nrad,
        Disturbance::StuckJournal if within > 0 => frame.journal_y_nm = previous.journal_y_nm,
        Disturbance::Centre if within.is_multiple_of(7) => (frame.journal_y_nm, frame.journal_z_nm) = (0, 0),
        // Single values, then values held for longer than the window.
        Disturbance::Extreme if within < 150 || within.is_multiple_of(50) => {
            (frame.journal_y_nm, frame.journal_z_nm) = (random.code(), random.code());
            frame.shaft_angle_nrad = random.code();
        }
        Disturbance::Extreme => {
            (frame.journal_y_nm, frame.journal_z_nm) = (previous.journal_y_nm, previous.journal_z_nm);
        }
        _ => {}
    }
}
