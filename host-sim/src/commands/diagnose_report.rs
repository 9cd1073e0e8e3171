//! The report of a diagnosis: the verdict in a sentence, causes, gain, ranking, residuals before and after.

use super::diagnose_pictures::{bars, pictures};
use crate::page::Page;
use bench::Channel;
use diagnosis::{Cause, Diagnosis, Gain, ParameterEstimate, Verdict};
use std::fmt::Write as _;

pub(super) fn channelled(effect: &str, channel: Option<Channel>) -> String {
    channel.map_or_else(|| effect.to_owned(), |c| format!("{effect} of {c}"))
}

fn cause_words(cause: &Cause) -> String {
    let parameters: Vec<String> = cause
        .parameters
        .iter()
        .map(|p| format!("{} = {}", p.name, with_unit(number(p.value), &p.unit)))
        .collect();
    format!("{} ({})", channelled(&cause.effect, cause.channel), parameters.join(", "))
}

fn with_unit(text: String, unit: &str) -> String {
    if unit == "1" { text } else { format!("{text} {unit}") }
}

/// Four significant digits.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = value.abs().log10().floor();
    if (-3.0..5.0).contains(&exponent) {
        format!("{value:.*}", (3.0 - exponent).max(0.0) as usize)
    } else {
        format!("{value:.3e}")
    }
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".into(), |s| format!("{:.1} %", 100.0 * s))
}

fn interval(share: Option<[f64; 2]>) -> String {
    share.map_or_else(|| "-".into(), |[a, b]| format!("{:.1} to {:.1} %", 100.0 * a, 100.0 * b))
}

/// The verdict in one sentence.
pub(super) fn sentence(diagnosis: &Diagnosis) -> String {
    let causes: Vec<String> = diagnosis.causes.iter().map(cause_words).collect();
    let explained = diagnosis.explained_share.map_or_else(String::new, |s| {
        format!(", which explains {:.1} % of the repeatable error on samples that were not fitted", 100.0 * s)
    });
    let others: Vec<String> =
        diagnosis.ambiguous_with.iter().map(|a| channelled(&a.effect, a.channel)).collect();
    match diagnosis.verdict {
        Verdict::None => "Nothing is wrong within the declared uncertainty.".into(),
        Verdict::Named => format!("The cause is {}{explained}.", causes.join(" together with ")),
        Verdict::Ambiguous => format!(
            "The cause is {}{explained}; but on these logs {} would fit as well.",
            causes.join(" together with "),
            others.join(", ")
        ),
        Verdict::Unknown => "Something is wrong that no known effect explains: see where it sits.".into(),
    }
}

fn parameter_row(cause: &Cause, p: &ParameterEstimate) -> Vec<String> {
    vec![
        channelled(&cause.effect, cause.channel),
        format!("{:.1} %", 100.0 * cause.probability),
        p.name.clone(),
        with_unit(number(p.value), &p.unit),
        format!("{} to {}", number(p.ci95[0]), number(p.ci95[1])),
    ]
}

fn gain_row(gain: &Gain) -> Vec<String> {
    vec![
        gain.channel.name().into(),
        number(gain.baseline_rms),
        number(gain.extended_rms),
        number(gain.noise_rms),
        percent(gain.explained_share),
        interval(gain.explained_share_ci95),
    ]
}

const CAUSE_HEADER: [&str; 5] = ["cause", "probability", "parameter", "value", "95 % interval"];
const GAIN_HEADER: [&str; 6] =
    ["held-out error of", "before", "after", "noise", "explained", "95 % interval"];

fn cause_rows(diagnosis: &Diagnosis) -> Vec<Vec<String>> {
    diagnosis.causes.iter().flat_map(|c| c.parameters.iter().map(move |p| parameter_row(c, p))).collect()
}

/// The diagnosis for a terminal.
pub(super) fn text(diagnosis: &Diagnosis) -> String {
    let mut out = format!("verdict: {}\n{}\n", diagnosis.verdict.name(), sentence(diagnosis));
    let mut table = |header: &[&str], rows: &[Vec<String>]| {
        if rows.is_empty() {
            return;
        }
        let width = |i: usize| {
            rows.iter().filter_map(|r| r.get(i)).map(|c| c.chars().count()).fold(header[i].len(), usize::max)
        };
        out.push('\n');
        let header: Vec<String> = header.iter().map(|h| (*h).to_owned()).collect();
        for row in std::iter::once(&header).chain(rows) {
            for (i, cell) in row.iter().enumerate() {
                let _ = write!(out, "{cell:<width$}  ", width = width(i));
            }
            out.truncate(out.trim_end().len());
            out.push('\n');
        }
    };
    table(&CAUSE_HEADER, &cause_rows(diagnosis));
    let gains: Vec<Vec<String>> = diagnosis.gain.iter().map(gain_row).collect();
    table(&GAIN_HEADER, &gains);
    if let Some(left) = &diagnosis.signature {
        let _ = write!(
            out,
            "\nleft over: {} {}\n  ({} rms, {:.1} times the noise)\n",
            left.channel,
            left.place,
            with_unit(number(left.rms), left.channel.unit()),
            left.rms_over_noise
        );
    }
    if let Some(next) = &diagnosis.next_experiment {
        let _ = write!(out, "\nnext: {next}\n");
    }
    if let Some(path) = &diagnosis.extended_bench {
        let _ = write!(out, "\nextended bench: {path}\n");
    }
    out
}

/// The page. An error is a drawing failure, in words.
pub(super) fn page(diagnosis: &Diagnosis) -> Result<Page, String> {
    let mut page = Page::new(&format!("Diagnosis: {}", diagnosis.verdict.name()));
    page.lead(&sentence(diagnosis));
    if !diagnosis.causes.is_empty() {
        page.section("Causes").table(&CAUSE_HEADER, &cause_rows(diagnosis));
    }
    if let Some(left) = &diagnosis.signature {
        page.section("Left over").text(&format!(
            "{} {}. Its rms is {}, {:.1} times the sensor's noise.",
            left.channel,
            left.place,
            with_unit(number(left.rms), left.channel.unit()),
            left.rms_over_noise
        ));
    }
    if let Some(next) = &diagnosis.next_experiment {
        page.section("Next experiment").text(next);
    }
    let gains: Vec<Vec<String>> = diagnosis.gain.iter().map(gain_row).collect();
    page.section("Gain").table(&GAIN_HEADER, &gains).note(
        "Root mean squares of measured less simulated, in the channel's unit, on samples that were not fitted: before with \
         the calibrated nominal bench, after with the extended bench. Explained is the share of the power above the noise.",
    );
    if !diagnosis.ranking.is_empty() {
        page.section("Ranking").figure(&bars(diagnosis), "Fall of chi-square when an effect alone joins the calibrated \
            nominal bench, refitted with everything that is uncertain, on a logarithmic scale. The line is what a cause has to pass. Pale: out of the race on the first cycle already, figure from there.");
    }
    pictures(&mut page, diagnosis)?;
    let rows: Vec<Vec<String>> = diagnosis
        .calibrated
        .iter()
        .map(|c| {
            vec![
                c.name.clone(),
                number(c.described),
                number(c.declared_deviation),
                number(c.value),
                number(c.deviation),
            ]
        })
        .collect();
    if !rows.is_empty() {
        page.section("Calibrated parameters")
            .table(&["parameter", "described", "declared deviation", "calibrated", "deviation left"], &rows);
    }
    let rows: Vec<Vec<String>> = diagnosis
        .noise
        .iter()
        .map(|n| {
            vec![
                n.channel.name().into(),
                number(n.floor),
                if n.declared { "declared" } else { "from the log" }.into(),
                format!("{:.2}", n.excess),
                format!("{:.1}", n.correlation_samples),
            ]
        })
        .collect();
    page.section("Noise")
        .table(&["channel", "floor", "known from", "residual/floor", "correlation, samples"], &rows);
    Ok(page)
}
