//! Text of an inspection for the terminal: the logs, their findings and channels, the declared
//! parameters, and motions that would show more.

use crate::diagnose::tables::push_findings;
use crate::evaluate::text::short;
use diagnosis::{ChannelQuality, DeclaredParameter, Inspection, LogSummary, Severity, four_digits};
use report::text_table;
use std::fmt::Write as _;

/// Formats the inspection.
pub(crate) fn text(inspection: &Inspection) -> String {
    let mut out = String::new();
    for log in &inspection.logs {
        let _ = writeln!(out, "{}", log_words(log));
    }
    let graver = |severity| inspection.checks.iter().filter(|f| f.severity == severity).count();
    let (wrong, doubtful) = (graver(Severity::Wrong), graver(Severity::Doubtful));
    let _ = writeln!(out, "findings: {wrong} wrong, {doubtful} doubtful");
    push_findings(&mut out, &inspection.checks);
    let header =
        ["channel", "role", "unit", "smallest", "largest", "step", "noise", "noise from", "declared"];
    let _ = write!(out, "\n{}\n", text_table(header, inspection.channels.iter().map(channel), 3));
    push_parameters(&mut out, inspection);
    for remark in &inspection.not_determined {
        let _ = write!(out, "\nnot determined: {}\n", remark.words);
    }
    for motion in &inspection.motions {
        let _ = write!(out, "\nfor {}: {}\n", motion.parameters.join(", "), motion.words);
        for (number, changes) in motion.changes.iter().enumerate() {
            let _ = writeln!(out, "  recording {}: {}", number + 1, changes.join("; "));
        }
    }
    out
}

fn log_words(log: &LogSummary) -> String {
    let rate_hz = (log.rows.max(2) - 1) as f64 / log.duration_s.max(f64::MIN_POSITIVE);
    let cycles =
        if log.cycles > 0.0 { format!("{:.1} cycles", log.cycles) } else { "no repeated motion".into() };
    format!(
        "{}: {} rows in {} s, {} per second, {cycles}",
        short(&log.log),
        log.rows,
        four_digits(log.duration_s),
        four_digits(rate_hz)
    )
}

fn channel(c: &ChannelQuality) -> Vec<String> {
    let or_none = |value: Option<f64>| value.map_or_else(|| "-".into(), four_digits);
    vec![
        c.channel.name().into(),
        c.role.into(),
        c.unit.into(),
        four_digits(c.min),
        four_digits(c.max),
        or_none(c.resolution),
        four_digits(c.noise),
        c.noise_source.into(),
        or_none(c.declared_noise),
    ]
}

fn push_parameters(out: &mut String, inspection: &Inspection) {
    if inspection.parameters.is_empty() {
        out.push_str(
            "\nThe description declares no parameter in `[uncertain]`: a calibration would move nothing.\n",
        );
        return;
    }
    let row = |p: &DeclaredParameter| {
        vec![
            p.name.clone(),
            four_digits(p.described),
            four_digits(p.declared_deviation),
            four_digits(p.remaining_deviation),
            format!("{:.3}", p.change_over_noise),
            if p.is_determined { "yes" } else { "no" }.into(),
        ]
    };
    let header =
        ["declared parameter", "described", "deviation", "with the logs", "change/noise", "determined"];
    let _ = write!(
        out,
        "\n{}\nas if the model were right and the sensors' noise the only error\n",
        text_table(header, inspection.parameters.iter().map(row), 1)
    );
}
