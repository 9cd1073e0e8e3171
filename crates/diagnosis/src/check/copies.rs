//! Copies of a log. A copy has the same noise, which would count as repeatable. The gain on a
//! held-out copy would be one on fitted data.

use super::finding::{Finding, Severity};
use bench::MeasuredLog;

/// The logs that are not copies of earlier ones; each copy becomes a finding.
pub(super) fn leave_out_copies<'a>(
    logs: &'a [MeasuredLog],
    before: &[&MeasuredLog],
    findings: &mut Vec<Finding>,
) -> Vec<&'a MeasuredLog> {
    let mut out: Vec<&MeasuredLog> = Vec::new();
    for log in logs {
        let Some(other) = before.iter().chain(&out).find(|other| is_copy(other, log)) else {
            out.push(log);
            continue;
        };
        findings.push(
            Finding::new(
                Severity::Wrong,
                &log.source,
                "t_s",
                "copy",
                format!("every reading is that of {}", other.source),
            )
            .cause("the same recording was given twice")
            .applied("left out"),
        );
    }
    out
}

/// Returns whether all readings are the same; the times may differ.
fn is_copy(a: &MeasuredLog, b: &MeasuredLog) -> bool {
    let same = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
    };
    !a.time_s.is_empty()
        && a.channels.keys().eq(b.channels.keys())
        && a.channels.values().zip(b.channels.values()).all(same)
}
