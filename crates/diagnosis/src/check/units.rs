//! Outputs in a wrong unit or with the wrong sign.

use super::column_mapping::scaled;
use super::factors;
use super::finding::{Finding, Severity};
use super::rows::multiply;
use super::simulated::Simulated;
use super::tuning;
use bench::{Bench, Channel, MeasuredLog};

/// Finds and corrects outputs in a wrong unit or with the wrong sign.
pub(super) fn check(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) {
    let channels: Vec<Channel> = bench.outputs(log);
    for channel in channels {
        let Some(own) = simulated.mismatch(log, channel, channel, 1.0).filter(|r| *r > tuning::MAX_MISMATCH)
        else {
            continue;
        };
        let named = factors::units(bench, channel);
        let mut candidates: Vec<(f64, String)> = vec![(-1.0, "its sign is inverted".into())];
        candidates.extend(named.iter().map(|(f, c)| (-f, format!("{c}; and its sign is inverted"))));
        candidates.extend(named);
        let mismatch = |f: f64| simulated.mismatch(log, channel, channel, f);
        let tried = candidates.into_iter().filter_map(|(f, c)| Some((mismatch(f)?, f, c)));
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((left, factor, cause)) =
            best.filter(|(left, ..)| *left < tuning::MAX_LEFT_SHARE * own && *left < tuning::MAX_MISMATCH)
        else {
            continue;
        };
        let kind = if factor == -1.0 { "sign" } else { "unit" };
        findings.push(
            correction(bench, log, channel, kind, factor, cause)
                .evidence("gain", simulated.gain(log, channel).unwrap_or(f64::NAN))
                .evidence("mismatch", own)
                .evidence("mismatch_corrected", left),
        );
        multiply(log, channel, 1.0 / factor);
    }
}

/// Finding about an output that is divided by a factor.
pub(super) fn correction(
    bench: &Bench,
    log: &MeasuredLog,
    channel: Channel,
    kind: &'static str,
    factor: f64,
    cause: String,
) -> Finding {
    let found = format!("{factor:.4} times what the described bench gives under these inputs");
    let applied = if factor == -1.0 { "changed the sign".into() } else { format!("divided by {factor:.6}") };
    Finding::new(Severity::Wrong, &log.source, channel.name(), kind, found)
        .cause(cause)
        .evidence("factor", factor)
        .correction(scaled(bench, channel.name(), 1.0 / factor))
        .applied(applied)
}
