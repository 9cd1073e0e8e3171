//! Statistics of settled operation: a run of many cycles of the transmission bench without its
//! transient.
//!
//! Figures of the first cycle describe the start from standstill; the bench forgets it only after
//! complete cycles. The transient is cut by the rule [`RULE`] for the peak of the contact force,
//! its oscillation and the dissipated energy; the longest transient of the three counts for all
//! quantities. Every statistic is one over the remaining cycles, with a 95 % interval.
//!
//! Histories are those of the samples: a peak between two samples is missed (at 10 kHz less than
//! .1 % of the contact force of bench B). Bands are parts of the normal force; the lowest one
//! begins at 3 Hz and contains harmonics of a drive that is faster than a cycle in some seconds.

mod course;
mod cycles;
mod ranges;

pub use course::Course;
pub use ranges::{RangeBin, RangeCount};

use crate::statistics::{Estimate, estimate, estimate_tail, largest_in, mean, quantile, transient_length};
use cycles::{Column, Kind, boundaries, columns};
use schemars::JsonSchema;
use serde::Serialize;

/// Fewest cycles of a run whose settled operation is described.
pub const MIN_CYCLES: usize = 3;
/// Number of cycles for which the largest peak is estimated.
const MANY_CYCLES: f64 = 1000.0;
/// Quantities that determine the transient.
const LEADING: [&str; 3] = ["peak_contact_force_n", "oscillation_rms_n", "dissipated_j"];

/// The rule of the transient, for reports.
pub const RULE: &str = "MSER (White 1997) over the cycles: the transient is as long as minimises the \
                        squared standard error of the mean of the others, with differences below 1 % \
                        counted as none, for peak contact force, oscillation and dissipated energy; \
                        the longest of the three, at most half the cycles";

/// A quantity over the settled cycles.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct Quantity {
    /// Name, unit included.
    pub name: String,
    /// Value in the first cycle.
    pub first_cycle: f64,
    /// Mean of the settled cycles.
    pub mean: Estimate,
    /// Smallest value of a settled cycle.
    pub smallest: f64,
    /// Median of the settled cycles.
    pub median: Estimate,
    /// 90 % quantile of the settled cycles.
    pub quantile_90: Estimate,
    /// Largest value of a settled cycle.
    pub largest: f64,
    /// Largest value to expect in 1000 cycles, by a Gumbel distribution; of peaks only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_in_1000: Option<Estimate>,
}

/// Settled operation of a run.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct Settled {
    /// Length of a cycle in s.
    pub cycle_s: f64,
    /// Complete cycles of the run.
    pub cycles: usize,
    /// Cycles of the transient.
    pub transient_cycles: usize,
    /// False if the transient may be longer than half the run.
    pub is_settled: bool,
    /// Rule by which the transient was cut.
    pub rule: &'static str,
    /// Quantities with one value per cycle.
    pub quantities: Vec<Quantity>,
    /// Rainflow counts of the settled cycles.
    pub rainflow: Vec<RangeCount>,
    #[serde(skip)]
    columns: Vec<Column>,
}

impl Settled {
    /// Describes the settled operation of a run; none with fewer than [`MIN_CYCLES`] complete
    /// cycles. The same seed gives the same intervals.
    pub fn from_course(course: &Course<'_>, seed: u64) -> Option<Self> {
        let boundaries = boundaries(course);
        let cycles = boundaries.len().checked_sub(1).filter(|&count| count >= MIN_CYCLES)?;
        let columns = columns(course, &boundaries);
        let leading = columns.iter().filter(|column| LEADING.contains(&column.name.as_str()));
        let transients: Vec<(usize, bool)> = leading.map(|c| transient_length(&c.values)).collect();
        let transient_cycles = transients.iter().map(|(length, _)| *length).max().unwrap_or_default();
        let quantity = |(index, column): (usize, &Column)| {
            let settled = column.values.get(transient_cycles..).unwrap_or_default();
            let seed = seed.wrapping_add(1000 * index as u64);
            Quantity {
                name: column.name.clone(),
                first_cycle: column.values.first().copied().unwrap_or_default(),
                mean: estimate(settled, seed, |v| mean(v)),
                smallest: settled.iter().copied().fold(f64::INFINITY, f64::min),
                median: estimate(settled, seed, |v| quantile(v, 0.5)),
                quantile_90: estimate_tail(settled, seed, |v| quantile(v, 0.9)),
                largest: settled.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                largest_in_1000: (column.kind == Kind::Peak)
                    .then(|| estimate_tail(settled, seed, |v| largest_in(MANY_CYCLES, v))),
            }
        };
        Some(Self {
            cycle_s: course.cycle_s,
            cycles,
            transient_cycles,
            is_settled: transients.iter().all(|(_, is_settled)| *is_settled),
            rule: RULE,
            quantities: columns.iter().enumerate().map(quantity).collect(),
            rainflow: ranges::counts(course, boundaries.get(transient_cycles..).unwrap_or_default(), seed),
            columns,
        })
    }

    /// A quantity by its name.
    pub fn quantity(&self, name: &str) -> Option<&Quantity> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }

    /// Values of a quantity in all cycles, the transient included.
    pub fn values(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|column| column.name == name).map(|column| column.values.as_slice())
    }

    /// Table of all quantities in all cycles as CSV; `is_transient` is 1 for a cycle that is cut.
    pub fn cycles_csv(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|column| column.name.as_str()).collect();
        let mut csv = format!("cycle,is_transient,{}\n", names.join(","));
        for cycle in 0..self.cycles {
            let value = |column: &Column| column.values.get(cycle).copied().unwrap_or_default().to_string();
            let values: Vec<String> = self.columns.iter().map(value).collect();
            let is_transient = u8::from(cycle < self.transient_cycles);
            csv.push_str(&format!("{},{is_transient},{}\n", cycle + 1, values.join(",")));
        }
        csv
    }
}
