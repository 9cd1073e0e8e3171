//! Exchanged axes: the signal of one axis under the name of the other.

use super::column_mapping::taken;
use super::finding::{Finding, Severity};
use super::simulated::{AXES, Simulated};
use super::tuning;
use bench::{Bench, Channel, MeasuredLog};

/// Finds axes whose signals are under each other's names, and exchanges them.
pub(super) fn check(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) {
    for (y, z) in AXES {
        let logged: Vec<(Channel, Channel)> =
            [(y, z), (z, y)].into_iter().filter(|(c, _)| log.channels.contains_key(c)).collect();
        let as_named: Option<f64> = logged.iter().map(|(c, _)| simulated.mismatch(log, *c, *c, 1.0)).sum();
        let max_mismatch = tuning::MAX_MISMATCH * logged.len() as f64;
        let Some(as_named) = as_named.filter(|sum| !logged.is_empty() && *sum > max_mismatch) else {
            continue;
        };
        // A plain exchange, or a quarter turn, which also changes the sign of one axis.
        let exchanged = |signs: [f64; 2]| -> Option<f64> {
            logged.iter().zip(signs).map(|((c, other), sign)| simulated.mismatch(log, *c, *other, sign)).sum()
        };
        let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let tried = signs.into_iter().filter_map(|signs| Some((exchanged(signs)?, signs)));
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        let has_wrong_sign =
            |c: Channel| simulated.mismatch(log, c, c, -1.0).is_some_and(|r| r < tuning::MAX_MISMATCH);
        let is_exchange = |(mismatch, _): &(f64, [f64; 2])| {
            *mismatch < tuning::MAX_LEFT_SHARE * as_named && !logged.iter().all(|(c, _)| has_wrong_sign(*c))
        };
        let Some((left, signs)) = best.filter(is_exchange) else { continue };
        for ((channel, other), sign) in logged.iter().zip(signs) {
            let changed = if sign < 0.0 { " with its sign changed" } else { "" };
            findings.push(
                Finding::new(
                    Severity::Wrong,
                    &log.source,
                    channel.name(),
                    "swapped-axes",
                    format!("it looks like {other}{changed}"),
                )
                .cause("the two axes are exchanged in the columns, or the sensors in their mounts")
                .evidence("mismatch_as_named", as_named)
                .evidence("mismatch_exchanged", left)
                .correction(taken(bench, other.name(), channel.name(), sign))
                .applied(format!("took it as {other}{changed}")),
            );
        }
        let renamed: Vec<(Channel, Vec<f64>)> = logged
            .iter()
            .zip(signs)
            .filter_map(|((c, other), sign)| {
                Some((*other, log.channels.remove(c)?.into_iter().map(|v| sign * v).collect()))
            })
            .collect();
        log.channels.extend(renamed);
    }
}
