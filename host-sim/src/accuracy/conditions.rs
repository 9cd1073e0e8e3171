//! The conditions: the paper's clearances and loads with both bearings, and held-out ones.
//!
//! The held-out conditions are those of [`model_quant::evaluate::held_out`].

use crate::cli::error::CliError;
use crate::run::conditions::{BEARINGS, CLEARANCES_MM, LOADS_KN, variant};
use crate::run::force::{self, DEFAULT_STEP_S, ForceSource, ForcedRun};
use bench::description::TransmissionBench;
use bench::signals::Sensor;
use bench::{BearingMaterial, Channel};
use model_quant::evaluate::held_out;
use schemars::JsonSchema;
use serde::Serialize;

/// Preset of the bench.
pub const BENCH: &str = "bench-b";
/// Noise of the journal's position sensors at the controller's rate, m.
pub(crate) const POSITION_NOISE_M: f64 = 0.2e-6;
/// Noise of the shaft's angle sensor at the controller's rate, degrees.
pub(crate) const ANGLE_NOISE_DEG: f64 = 0.01;

/// One condition of bench B.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Condition {
    /// Bearing material.
    #[schemars(with = "String")]
    pub bearing: BearingMaterial,
    /// Radial clearance.
    pub clearance_mm: f64,
    /// Load along +Y.
    pub load_kn: f64,
    /// Period of the drive.
    pub period_s: f64,
    /// True for a condition on which nothing was chosen.
    pub held_out: bool,
    /// Index in the list of all conditions, and number of the noise stream of its sensors.
    #[serde(skip)]
    pub index: u64,
}

/// A condition's bench, run with the analytic law.
#[derive(Clone, Debug)]
pub struct LawRun {
    /// The bench with the sensors' noise of this measurement.
    pub bench: TransmissionBench,
    /// The run.
    pub forced: ForcedRun,
}

/// All conditions: the paper's first, bearing by bearing.
pub fn all() -> Vec<Condition> {
    let of = |bearing: BearingMaterial| {
        let paper = CLEARANCES_MM.into_iter().flat_map(|clearance| LOADS_KN.map(|load| (clearance, load)));
        let paper = paper.map(|(clearance, load)| (clearance, load, None));
        let held_out = held_out::CONDITIONS.map(|(clearance, load, period)| (clearance, load, Some(period)));
        paper.chain(held_out).map(move |(clearance_mm, load_kn, period)| Condition {
            bearing,
            clearance_mm,
            load_kn,
            period_s: period.unwrap_or(1.0),
            held_out: period.is_some(),
            index: 0,
        })
    };
    let numbered = BEARINGS.into_iter().flat_map(of).enumerate();
    numbered.map(|(index, condition)| Condition { index: index as u64, ..condition }).collect()
}

impl Condition {
    /// Describes the condition.
    pub fn name(&self) -> String {
        let period =
            if self.period_s == 1.0 { String::new() } else { format!(", period {} s", self.period_s) };
        format!("{}, {} mm, {:+} kN{period}", self.bearing.name(), self.clearance_mm, self.load_kn)
    }

    /// Bench B at this condition with the sensors' noise of this measurement.
    pub fn bench(&self) -> Result<TransmissionBench, CliError> {
        let base = TransmissionBench::open(BENCH)?;
        let mut bench = variant(&base, self.bearing, self.clearance_mm, self.load_kn);
        bench.drive.period_s = self.period_s;
        let noises = [
            (Channel::JournalY, POSITION_NOISE_M),
            (Channel::JournalZ, POSITION_NOISE_M),
            (Channel::ShaftAngle, ANGLE_NOISE_DEG.to_radians()),
        ];
        bench.common.sensors =
            noises.map(|(channel, noise)| (channel, Sensor { noise, ..Sensor::default() })).into();
        Ok(bench.resolved())
    }

    /// Runs it with the analytic law.
    pub(crate) fn law_run(&self) -> Result<LawRun, CliError> {
        let bench = self.bench()?;
        let forced = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
        Ok(LawRun { bench, forced })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_conditions_are_all_there_and_no_held_out_one_is_among_them() {
        let all = all();
        let paper: Vec<&Condition> = all.iter().filter(|c| !c.held_out).collect();
        assert_eq!((paper.len(), all.len()), (48, 68));
        for held_out in all.iter().filter(|c| c.held_out) {
            assert!(paper.iter().all(|p| p.clearance_mm != held_out.clearance_mm));
            assert!(paper.iter().all(|p| p.load_kn != held_out.load_kn || p.period_s != held_out.period_s));
        }
        assert!(all.iter().enumerate().all(|(i, c)| c.index == i as u64));
    }
}
