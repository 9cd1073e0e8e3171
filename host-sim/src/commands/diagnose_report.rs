//! The report of a diagnosis: the verdict in a sentence, causes, gain, ranking, residuals before and after.

use crate::figure::{Chart, Series, lines};
use crate::page::Page;
use bench::Channel;
use diagnosis::{Cause, Diagnosis, Gain, ParameterEstimate, Series as Residual, Verdict};
use std::fmt::Write as _;

const WIDE: (u32, u32) = (1040, 300);
const HALF: (u32, u32) = (520, 300);
/// Bins of a cycle in the pictures.
const BINS: usize = 96;
/// Pictures over time a report shows; more logs than that would hide the others.
const MOST_PICTURES: usize = 12;

fn channelled(effect: &str, channel: Option<Channel>) -> String {
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
fn number(value: f64) -> String {
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
            nominal bench, refitted with everything that is uncertain, on a logarithmic scale. The line is what a cause has to pass.");
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

fn pictures(page: &mut Page, diagnosis: &Diagnosis) -> Result<(), String> {
    page.section("Residual before and after");
    let y = |c: Channel| format!("measured - simulated, {}", c.unit());
    let mut channels: Vec<Channel> = diagnosis.series.iter().map(|s| s.channel).collect();
    channels.sort();
    channels.dedup();
    for channel in channels {
        let of: Vec<&Residual> = diagnosis.series.iter().filter(|s| s.channel == channel).collect();
        let title = format!("{channel} over the cycle, mean");
        let by_phase = by_phase(&of);
        let mut pair = Vec::new();
        if !by_phase.is_empty() {
            let chart = Chart { title: &title, x: "cycle phase", y: &y(channel), size: HALF };
            pair.push((
                lines(&chart, &by_phase)?,
                "Mean of all cycles by phase, from the middle of the forward stroke.",
            ));
        }
        for s in of.iter().take(MOST_PICTURES / of.len().max(1) + 1).take(4) {
            let title = format!("{channel}, {}", short(&s.source));
            let size = if by_phase.is_empty() && of.len() == 1 { WIDE } else { HALF };
            let chart = Chart { title: &title, x: "time, s", y: &y(channel), size };
            let series = [
                Series::new("before", s.time_s.iter().copied(), s.before.iter().copied()),
                Series::new("after", s.time_s.iter().copied(), s.after.iter().copied()),
            ];
            pair.push((lines(&chart, &series)?, "Every sample."));
        }
        page.figures(&pair);
    }
    Ok(())
}

fn short(source: &str) -> &str {
    source.rsplit(['/', '\\']).next().unwrap_or(source)
}

/// Means over bins of the cycle's phase; empty where the motion does not repeat.
fn by_phase(residuals: &[&Residual]) -> Vec<Series> {
    let mut sums = vec![(0.0, 0.0, 0.0); BINS];
    for r in residuals {
        let Some(phase) = &r.phase else { continue };
        for ((p, before), after) in phase.iter().zip(&r.before).zip(&r.after) {
            if let Some(bin) = sums.get_mut((p.rem_euclid(1.0) * BINS as f64) as usize) {
                *bin = (bin.0 + before, bin.1 + after, bin.2 + 1.0);
            }
        }
    }
    let filled: Vec<(f64, f64, f64)> = sums
        .iter()
        .enumerate()
        .filter(|(_, s)| s.2 > 0.0)
        .map(|(i, s)| ((i as f64 + 0.5) / BINS as f64, s.0 / s.2, s.1 / s.2))
        .collect();
    if filled.is_empty() {
        return Vec::new();
    }
    vec![
        Series::new("before", filled.iter().map(|f| f.0), filled.iter().map(|f| f.1)),
        Series::new("after", filled.iter().map(|f| f.0), filled.iter().map(|f| f.2)),
    ]
}

/// The ranking as bars on a logarithmic scale.
fn bars(diagnosis: &Diagnosis) -> String {
    const ROW: f64 = 24.0;
    const LEFT: f64 = 300.0;
    const RIGHT: f64 = 90.0;
    const WIDTH: f64 = 1040.0;
    let most = diagnosis.ranking.iter().map(|r| r.evidence).fold(10.0 * diagnosis.threshold, f64::max);
    let x = |v: f64| LEFT + (WIDTH - LEFT - RIGHT) * (v.max(1.0).ln() / most.ln()).clamp(0.0, 1.0);
    let height = ROW * (diagnosis.ranking.len() as f64 + 1.0);
    let mut svg = format!(
        "<svg width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"13\">"
    );
    for (i, r) in diagnosis.ranking.iter().enumerate() {
        let y = ROW * i as f64;
        let chosen = diagnosis.causes.iter().any(|c| c.effect == r.effect && c.channel == r.channel);
        let colour = if chosen { "#d55e00" } else { "#0072b2" };
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><rect x=\"{LEFT}\" y=\"{:.1}\" width=\"{:.1}\" \
             height=\"{:.1}\" fill=\"{colour}\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            LEFT - 8.0,
            y + 17.0,
            channelled(&r.effect, r.channel),
            y + 4.0,
            (x(r.evidence) - LEFT).max(1.0),
            ROW - 8.0,
            x(r.evidence) + 6.0,
            y + 17.0,
            number(r.evidence),
        );
    }
    let at = x(diagnosis.threshold);
    let _ = write!(
        svg,
        "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"0\" y2=\"{:.1}\" stroke=\"#333\" stroke-dasharray=\"4 3\"/>\
         <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{:.1}</text></svg>",
        height - ROW,
        height - 7.0,
        diagnosis.threshold,
    );
    svg
}
