//! Ticks of a session with the default bench, and a digest of their frames.

use controller::configuration::BENCH_B;
use controller::session::{Identity, NoTicks, Session};
use link::SensorFrame;
use link::track::SensorStatus;

use crate::agreement::Digest;
use crate::filter::Orbit;

/// Ticks of the digest.
pub const TICKS: u32 = 1_000;
/// Digest of the frames of [`TICKS`] ticks, on every core.
pub const DIGEST: u64 = 0xbb34_eef4_df40_5899;

/// A session that is running.
#[derive(Debug)]
pub struct Ticks {
    session: Session,
    orbit: Orbit,
    sequence: u32,
    digest: Digest,
}

impl Ticks {
    /// Configures a session; `None` if it refuses.
    #[must_use]
    pub fn new(identity: Identity) -> Option<Self> {
        let mut session = Session::new(identity);
        session.configure(&BENCH_B).ok()?;
        Some(Self { session, orbit: Orbit::new(false)?, sequence: 0, digest: Digest::EMPTY })
    }

    /// Returns the next sample.
    pub fn sample(&mut self) -> SensorFrame {
        let measured = self.orbit.measure();
        let sequence = self.sequence;
        self.sequence += 1;
        SensorFrame {
            sequence,
            time_us: sequence * BENCH_B.bench.sample_period_us,
            journal_y_nm: (measured.journal_y_m * 1e9) as i32,
            journal_z_nm: (measured.journal_z_m * 1e9) as i32,
            shaft_angle_nrad: (measured.shaft_angle_rad * 1e9) as i32,
            load_force_mn: (measured.load_force_n * 1e3) as i32,
        }
    }

    /// Runs a tick; `None` if the session does not estimate.
    pub fn tick(&mut self, sample: &SensorFrame) -> Option<()> {
        let frame = self.session.tick(sample, SensorStatus::GOOD, &mut NoTicks).ok()?;
        frame.iter().for_each(|byte| self.digest.add(i64::from(*byte)));
        Some(())
    }

    /// Returns the digest of all frames.
    #[must_use]
    pub const fn digest(&self) -> u64 {
        self.digest.0
    }
}
