//! Rainflow counts of the settled part of a run.
//!
//! Half of a counted range belongs to the cycle of the drive of each of its turning points. So
//! every count is a mean over cycles, and its interval one over cycles.

use super::course::Course;
use crate::plants::transmission::Snapshot;
use crate::statistics::{Estimate, RangeCycle, count_ranges, estimate, mean, sums_per_cycle};
use schemars::JsonSchema;
use serde::Serialize;

/// Histories that are counted, with their names.
type History = (&'static str, fn(&Snapshot) -> f64);
const HISTORIES: [History; 3] = [
    ("contact_force_n", |s| s.forces.normal_n),
    ("drive_force_n", |s| s.drive_force_n),
    ("friction_torque_nm", |s| s.friction_torque_nm),
];
/// Lower ends of the bins as shares of the largest range; smaller ranges are not listed.
const BINS: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5];

/// Rainflow count of one history.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct RangeCount {
    /// Name of the history, unit included.
    pub name: &'static str,
    /// Largest range.
    pub largest_range: f64,
    /// Range that, once per cycle, damages as all ranges do by Miner's rule with exponent 3.
    pub equivalent_range_3: Estimate,
    /// The same with exponent 5.
    pub equivalent_range_5: Estimate,
    /// Ranges by size.
    pub bins: Vec<RangeBin>,
}

/// Ranges of similar size.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct RangeBin {
    /// Smallest range.
    pub from: f64,
    /// Largest range.
    pub to: f64,
    /// Number per cycle of the drive.
    pub per_cycle: Estimate,
}

/// Counts the histories between the first and the last of some boundaries.
pub(super) fn counts(course: &Course<'_>, boundaries: &[usize], seed: u64) -> Vec<RangeCount> {
    let (Some(&first), Some(&last)) = (boundaries.first(), boundaries.last()) else { return Vec::new() };
    let samples = course.samples.get(first..last).unwrap_or_default();
    let one = |&(name, read): &History| {
        let history: Vec<f64> = samples.iter().map(read).collect();
        let ranges = count_ranges(&history);
        let largest_range = ranges.iter().map(|cycle| cycle.range).fold(0.0, f64::max);
        let starts: Vec<usize> = boundaries.iter().map(|start| start - first).collect();
        let per_cycle = |weight: &dyn Fn(&RangeCycle) -> f64| sums_per_cycle(&ranges, &starts, weight);
        let equivalent = |exponent: i32| {
            let damage = per_cycle(&|c| c.count * (c.range / largest_range).powi(exponent));
            estimate(&damage, seed, |d| largest_range * mean(d).powf(1.0 / f64::from(exponent)))
        };
        let bin = |(index, &from): (usize, &f64)| {
            let to = BINS.get(index + 1).copied().unwrap_or(1.0);
            let is_last = index + 1 == BINS.len();
            let is_in = |c: &RangeCycle| {
                let share = c.range / largest_range;
                share >= from && (share < to || is_last)
            };
            let numbers = per_cycle(&|c| if is_in(c) { c.count } else { 0.0 });
            let per_cycle = estimate(&numbers, seed, |n| mean(n));
            RangeBin { from: from * largest_range, to: to * largest_range, per_cycle }
        };
        RangeCount {
            name,
            largest_range,
            equivalent_range_3: equivalent(3),
            equivalent_range_5: equivalent(5),
            bins: BINS.iter().enumerate().map(bin).collect(),
        }
    };
    HISTORIES.iter().map(one).collect()
}
