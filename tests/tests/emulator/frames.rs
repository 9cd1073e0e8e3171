//! Sensor frames that lead the estimator through everything it can do, the same at every run.
//!
//! The journal swings along the clearance circle and in and out of contact with 0.4 um of noise; between clean stretches something
//! goes wrong: jumps, lost samples, wrong times, stuck sensors, deep and fast contacts, a racing shaft, the centre, the
//! ends of the integers.

use core::f64::consts::{FRAC_PI_2, TAU};
use firmware::configuration::BENCH_B;
use inference::Bearing;
use link::{Configuration, ControllerConfiguration, SensorFrame};

/// Samples of one stretch: longer than a stuck sensor needs to be noticed, and than the window needs to fill again.
const STRETCH: u32 = 250;

/// Bench B with either bearing.
pub(crate) fn configuration(bearing: Bearing) -> ControllerConfiguration {
    let bench = Configuration { bearing: bearing.code(), ..BENCH_B.bench };
    ControllerConfiguration { bench, ..BENCH_B }
}

/// SplitMix64: small, and the same everywhere.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Uniform in -1..1.
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn code(&mut self) -> i32 {
        match self.bits() % 4 {
            0 => i32::MIN,
            1 => i32::MAX,
            _ => self.bits() as i32,
        }
    }
}

/// What a stretch of samples is like.
#[derive(Clone, Copy, PartialEq)]
enum Trouble {
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

const TROUBLES: [Trouble; 10] = [
    Trouble::Jump,
    Trouble::Lost,
    Trouble::Late,
    Trouble::StuckAngle,
    Trouble::StuckJournal,
    Trouble::Deep,
    Trouble::Fast,
    Trouble::Racing,
    Trouble::Centre,
    Trouble::Extreme,
];

/// `count` frames for a configuration. Every second stretch is clean; a full round of troubles takes 5,000 frames.
pub(crate) fn troubled(configuration: &ControllerConfiguration, count: u32, seed: u64) -> Vec<SensorFrame> {
    let configuration = configuration.bench;
    let mut random = Random(seed);
    let clearance_m = f64::from(configuration.radial_clearance_nm) * 1e-9;
    let period_s = f64::from(configuration.sample_period_us) * 1e-6;
    let (mut lost, mut late_us, mut angle_rad) = (0_u32, 0_u32, 0.0);
    let mut frames: Vec<SensorFrame> = Vec::new();
    for index in 0..count {
        let (stretch, within) = (index / STRETCH, index % STRETCH);
        let trouble = match TROUBLES.get((stretch / 2) as usize % TROUBLES.len()) {
            Some(trouble) if stretch % 2 == 1 => *trouble,
            _ => Trouble::None,
        };
        let t = f64::from(index) * period_s;
        let (mean_m, breath_m, breath_hz) = match trouble {
            Trouble::Deep => (400e-6, 200e-6, 40.0),
            Trouble::Fast => (0.0, 100e-6, 300.0),
            Trouble::Centre => (-clearance_m, 1e-6, 30.0),
            _ => (15e-6, 30e-6, 33.0),
        };
        let shaft_rad_s = if trouble == Trouble::Racing { 30.0 } else { 0.5 * (TAU * 1.5 * t).cos() };
        angle_rad += shaft_rad_s * period_s;
        let swing_rad = 0.5e-3 / clearance_m * (TAU * 45.0 * t).sin() - FRAC_PI_2;
        let distance_m = clearance_m + mean_m + breath_m * (TAU * breath_hz * t).sin();
        let mut read = |value: f64| ((value + 0.4e-6 * random.unit()) * 1e9).round() as i32;
        let (journal_y_nm, journal_z_nm) =
            (read(distance_m * swing_rad.cos()), read(distance_m * swing_rad.sin()));
        let noisy_angle = angle_rad + 40e-6 * random.unit();
        lost += u32::from(trouble == Trouble::Lost && within % 60 == 0);
        late_us += if trouble == Trouble::Late && within % 90 == 0 { 77 } else { 0 };
        let sequence = index + lost;
        let mut frame = SensorFrame {
            sequence,
            time_us: (sequence * configuration.sample_period_us).wrapping_add(late_us),
            journal_y_nm,
            journal_z_nm,
            shaft_angle_nrad: (noisy_angle * 1e9).round() as i64 as i32,
            load_force_mn: random.code(),
        };
        let previous = frames.last().copied().unwrap_or(frame);
        match trouble {
            Trouble::Jump if within % 80 == 40 => frame.journal_z_nm += 100_000,
            Trouble::Jump if within % 80 == 70 => frame.shaft_angle_nrad ^= 1 << 29,
            Trouble::StuckAngle if within > 0 => frame.shaft_angle_nrad = previous.shaft_angle_nrad,
            Trouble::StuckJournal if within > 0 => frame.journal_y_nm = previous.journal_y_nm,
            Trouble::Centre if within % 7 == 0 => (frame.journal_y_nm, frame.journal_z_nm) = (0, 0),
            // By themselves, then held for longer than the window.
            Trouble::Extreme if within < 150 || within % 50 == 0 => {
                (frame.journal_y_nm, frame.journal_z_nm) = (random.code(), random.code());
                frame.shaft_angle_nrad = random.code();
            }
            Trouble::Extreme => {
                (frame.journal_y_nm, frame.journal_z_nm) = (previous.journal_y_nm, previous.journal_z_nm);
            }
            _ => {}
        }
        frames.push(frame);
    }
    frames
}
