//! The same log given twice: noise that agrees to the last digit is a copied file, and would pass for something that repeats. Held out it would
//! promise a gain on what was fitted.

use super::finding::{Finding, Severity};
use bench::MeasuredLog;

/// The logs that are none of those before them; what is said of the others.
pub(super) fn distinct<'a>(
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
            .cause("the same recording given twice")
            .done("left out"),
        );
    }
    out
}

/// Whether all readings are the same; the clock may have been set anew.
fn is_copy(a: &MeasuredLog, b: &MeasuredLog) -> bool {
    let same = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
    };
    !a.time_s.is_empty()
        && a.channels.keys().eq(b.channels.keys())
        && a.channels.values().zip(b.channels.values()).all(same)
}
