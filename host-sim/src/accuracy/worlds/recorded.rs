//! A world that has been run for one cycle, and the readings of its sensors.

use super::cases::{OperatingPoint, RealWorld};
use super::estimators::{self, Estimate, EstimatorKind};
use crate::cli::error::CliError;
use crate::run::force::SAMPLE_RATE_HZ;
use ::worlds::random::subseed;
use ::worlds::{Reading, Row};

/// A world that has been run and read.
pub(super) struct Recorded {
    pub(super) rows: Vec<Row>,
    pub(super) readings: Vec<Reading>,
}

impl Recorded {
    /// Runs a world for one cycle. The noise depends on the seed, the operating point and the
    /// world's name.
    pub(super) fn new(point: &OperatingPoint, real: &RealWorld, seed: u64) -> Self {
        let rows = real.world.run(real.world.period_s, SAMPLE_RATE_HZ);
        let seed = subseed(subseed(seed, &point.name()), &real.name);
        let readings = real.sensors.read(&rows, seed);
        Self { rows, readings }
    }

    pub(super) fn estimates(
        &self,
        point: &OperatingPoint,
        kind: EstimatorKind,
    ) -> Result<Vec<Estimate>, CliError> {
        estimators::follow(kind, &point.described_bench()?, &self.readings)
    }
}
