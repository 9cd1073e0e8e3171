//! Load in a wrong unit, over a wrong area or with the wrong sign.

use super::column_mapping::scaled;
use super::factors;
use super::finding::{Finding, Severity};
use super::rows::{keep_rows, multiply};
use super::simulated::Simulated;
use super::tuning;
use crate::statistics::median;
use bench::{Bench, Channel, MeasuredLog};

/// Finds and corrects a wrong load, which all outputs show together. Returns the simulation under
/// the corrected load; `None` if no load is plausible or the inputs cannot be simulated. The
/// outputs then remain unchecked.
pub(super) fn check(bench: &Bench, log: &mut MeasuredLog, findings: &mut Vec<Finding>) -> Option<Simulated> {
    let described_n = bench.load_n();
    let load_n = median(log.channels.get(&Channel::LoadForce).into_iter().flatten().copied());
    // A simulation under an impossible load may take very long.
    let is_possible = log_ratio(load_n, described_n) < tuning::MAX_LOAD_RATIO.ln()
        || described_n.abs() < tuning::MIN_LOAD_N
        || load_n.abs() < described_n.abs();
    let own = if is_possible { Simulated::new(bench, log) } else { None };
    let (before, wrong, all) =
        own.as_ref().map_or((tuning::MAX_MISMATCH_COUNTED, 2, 2), |s| s.overall(bench, log));
    // The load acts on all outputs, so a single wrong one of several is not due to it.
    let is_suspect = before > tuning::LOAD_MISMATCH && (wrong >= 2 || (all == 1 && wrong == 1));
    if !is_suspect || !log.channels.contains_key(&Channel::LoadForce) {
        return own;
    }
    let short = first_cycles(bench, log);
    let tried = plausible_factors(bench, log, load_n).into_iter().filter_map(|(factor, cause)| {
        let mut other = short.clone();
        multiply(&mut other, Channel::LoadForce, 1.0 / factor);
        let (after, ..) = Simulated::new(bench, &other)?.overall(bench, &other);
        Some((after, factor, cause))
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((after, factor, cause)) if after < tuning::MAX_LEFT_SHARE_LOAD * before => {
            let kind = if factor < 0.0 {
                "sign"
            } else if factor.ln().abs() > tuning::MIN_LOG_FACTOR {
                "unit"
            } else {
                "gain"
            };
            let found = format!("{factor:.4} times the load that all outputs together indicate");
            findings.push(
                Finding::new(Severity::Wrong, &log.source, Channel::LoadForce.name(), kind, found)
                    .cause(cause)
                    .evidence("factor", factor)
                    .evidence("mean_mismatch", before)
                    .evidence("mean_mismatch_corrected", after)
                    .correction(scaled(bench, Channel::LoadForce.name(), 1.0 / factor))
                    .applied(format!("divided by {factor:.6}")),
            );
            multiply(log, Channel::LoadForce, 1.0 / factor);
            Simulated::new(bench, log)
        }
        _ if is_possible => own,
        _ => {
            let found = format!("{load_n:.0} N, described {described_n:.0} N: the outputs were not checked");
            findings.push(
                Finding::new(
                    Severity::Doubtful,
                    &log.source,
                    Channel::LoadForce.name(),
                    "contradiction",
                    found,
                )
                .cause("another bench, or a load in an unknown unit"),
            );
            None
        }
    }
}

/// Magnitude of the logarithm of the ratio of two loads, whatever their signs.
fn log_ratio(load_n: f64, described_n: f64) -> f64 {
    (load_n / described_n).abs().ln().abs()
}

/// Factors by which the load may be wrong, with their causes.
///
/// A wrong gain of the outputs looks like one of the load. So a large factor is tried only if its
/// correction comes nearer to the described load.
fn plausible_factors(bench: &Bench, log: &MeasuredLog, load_n: f64) -> Vec<(f64, String)> {
    let described_n = bench.load_n();
    let mut candidates = factors::units(bench, Channel::LoadForce);
    candidates.push((-1.0, "its sign is inverted: the load is positive along +Y".into()));
    // Only the drive force distinguishes a wrong area from another lever.
    if bench.transmission().is_some() && log.channels.contains_key(&Channel::DriveForce) {
        candidates.extend(factors::geometry(bench));
        candidates.extend(factors::areas());
    }
    let own = log_ratio(load_n, described_n);
    candidates.retain(|(factor, _)| {
        if tuning::GEOMETRY_FACTORS.contains(factor) {
            true
        } else if *factor < 0.0 {
            load_n * described_n < 0.0
        } else {
            log_ratio(load_n / factor, described_n) + tuning::MIN_LOG_APPROACH < own
        }
    });
    candidates
}

/// The first described cycles of a log, for trial loads.
fn first_cycles(bench: &Bench, log: &MeasuredLog) -> MeasuredLog {
    let period_s = bench.period_s();
    let end_s = log.time_s.first().copied().unwrap_or_default() + tuning::TRIAL_CYCLES * period_s;
    let mut short = log.clone();
    keep_rows(&mut short, &log.time_s.iter().map(|t| *t <= end_s).collect::<Vec<_>>());
    short
}
