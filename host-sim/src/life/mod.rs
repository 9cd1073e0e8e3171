//! Life of a bearing with the interval of its wear rate, and the clearance that the controller
//! tracks along it.
//!
//! Three lives are computed: with the described wear rate, and with the rate divided and multiplied
//! by the declared factor. Their clearances are the prediction and its 95 % interval; no other
//! uncertainty is propagated.

pub(crate) mod pictures;
pub(crate) mod report;
mod tracking;

use crate::cli::error::CliError;
use crate::cli::{parallel, progress};
use bench::BearingMaterial;
use bench::Bench;
use bench::description::TransmissionBench;
use bench::simulate::life::{Life, LifeError, LifePoint, limit_clearance_m, run_life};
use schemars::JsonSchema;
use serde::Serialize;
pub(crate) use tracking::Settings;
use tracking::{Tracked, wear_effect};

/// Profiles in `profile.csv` and in the pictures.
const PROFILES: usize = 5;

/// Result of a life.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct Outcome {
    /// Bearing material.
    pub(crate) bearing: &'static str,
    /// Radial clearance of the new bearing.
    pub(crate) described_clearance_m: f64,
    /// Radial clearance that ends the life.
    pub(crate) limit_clearance_m: f64,
    /// Specific wear rate of the bearing.
    pub(crate) specific_wear_rate_m3_nm: f64,
    /// Factor by which the wear rate may be larger or smaller (95 %).
    pub(crate) wear_factor: f64,
    /// Last cycle computed: that asked for, or the one at which the limit is reached.
    pub(crate) cycles: f64,
    /// Cycle at which the clearance reaches its limit; none if it does not.
    pub(crate) limit_cycle: Option<f64>,
    /// The same with the rate times the factor; none if it does not.
    pub(crate) limit_cycle_earliest: Option<f64>,
    /// The same with the rate over the factor; none if it does not.
    pub(crate) limit_cycle_latest: Option<f64>,
    /// Clearance at the last cycle.
    pub(crate) clearance_m: f64,
    /// Its interval by the factor of the wear rate. The limit stands for a larger upper end: see
    /// `limit_cycle_earliest`.
    pub(crate) clearance_ci95_m: [f64; 2],
    /// Value of the effect `clearance-wear` at the last cycle, `clearance_increase_m`.
    pub(crate) clearance_increase_m: f64,
    /// Duties that were computed for the described rate, of `life.duty_cycles` cycles each.
    pub(crate) computed_duties: usize,
    /// Course with the described rate.
    pub(crate) points: Vec<LifePoint>,
    /// Clearance that the controller tracks.
    pub(crate) tracked: Vec<Tracked>,
}

/// Lives of one bench.
pub(crate) struct LifeResult {
    /// With the wear rate over the factor, with the described one, and with the rate times the
    /// factor.
    pub(crate) lives: [Life; 3],
    /// Figures.
    pub(crate) outcome: Outcome,
}

impl LifeResult {
    /// Points of the life whose profiles are shown: evenly over the largest depth.
    pub(super) fn shown_points(&self) -> Vec<usize> {
        let points = &self.lives[1].points;
        let end_m = points.last().map_or(0.0, |point| point.largest_depth_m);
        let after = |i: usize| {
            let depth_m = end_m * i as f64 / (PROFILES - 1) as f64;
            points.iter().position(|point| point.largest_depth_m >= depth_m)
        };
        let mut shown: Vec<usize> = (0..PROFILES).filter_map(after).collect();
        shown.dedup();
        shown
    }
}

impl From<LifeError> for CliError {
    fn from(error: LifeError) -> Self {
        match error {
            LifeError::Description(text) => Self::Input(text),
            other => Self::Work(other.to_string()),
        }
    }
}

/// Computes the lives of a bench and follows the one with the described rate.
pub(crate) fn simulate(described: &TransmissionBench, settings: Settings) -> Result<LifeResult, CliError> {
    let bench = described.resolved();
    let wear = bench.wear.clone().unwrap_or_default();
    let bar = progress::bar(3 * progress::PERCENT);
    bar.set_message("lives");
    let lives = parallel::map(settings.threads, &[1.0 / wear.factor, 1.0, wear.factor], |_, factor| {
        let mut reported = 0;
        let mut report = |percent: u64| {
            bar.inc(percent.saturating_sub(reported));
            reported = reported.max(percent);
        };
        let life = run_life(&bench, *factor, |share| report((share * progress::PERCENT as f64) as u64))?;
        report(progress::PERCENT);
        Ok(life)
    })?;
    bar.finish_and_clear();
    let lives: [Life; 3] = lives.try_into().map_err(|_| CliError::Work("lives: expected three".into()))?;
    let [slow, life, fast] = &lives;
    let cycles = life.limit_cycle.unwrap_or_else(|| life.points.last().map_or(0.0, |point| point.cycle));
    let clearance_m = life.clearance_m(cycles);
    let limit_m = limit_clearance_m(&bench);
    let material = bench.bearing.material.lining().specific_wear_rate_m3_nm;
    let outcome = Outcome {
        bearing: BearingMaterial::name(bench.bearing.material),
        described_clearance_m: bench.bearing.radial_clearance_m,
        limit_clearance_m: limit_m,
        specific_wear_rate_m3_nm: wear.specific_wear_rate_m3_nm.unwrap_or(material),
        wear_factor: wear.factor,
        cycles,
        limit_cycle: life.limit_cycle,
        limit_cycle_earliest: fast.limit_cycle,
        limit_cycle_latest: slow.limit_cycle,
        clearance_m,
        clearance_ci95_m: interval_m(&lives, limit_m, cycles),
        clearance_increase_m: clearance_m - bench.bearing.radial_clearance_m,
        computed_duties: life.computed,
        points: life.points.clone(),
        tracked: tracking::follow(&bench, life, cycles, settings)?,
    };
    Ok(LifeResult { lives, outcome })
}

/// Interval of the clearance at a cycle. The life with the larger rate ends at its limit, which
/// then stands for the upper end.
fn interval_m([slow, life, fast]: &[Life; 3], limit_m: f64, cycle: f64) -> [f64; 2] {
    let largest_m = limit_m.max(life.clearance_m(cycle));
    [slow.clearance_m(cycle), fast.clearance_m(cycle).min(largest_m)]
}

/// The bench with its wear at the end as an effect; none if the effect does not go so far.
pub(crate) fn worn_bench(bench: &TransmissionBench, outcome: &Outcome) -> Option<TransmissionBench> {
    let effect = wear_effect(outcome.clearance_increase_m);
    effect.check(&Bench::from(bench.clone())).ok()?;
    let mut worn = bench.clone();
    worn.common.effects.push(effect);
    Some(worn)
}
