//! The pictures of a diagnosis: the ranking as bars, residuals over time and over the cycle.

use super::diagnose_report::{channelled, number};
use crate::figure::{Chart, Series, lines};
use crate::page::Page;
use bench::Channel;
use diagnosis::{Diagnosis, Series as Residual};
use std::fmt::Write as _;

const WIDE: (u32, u32) = (1040, 300);
const HALF: (u32, u32) = (512, 300);
/// Bins of a cycle in the pictures.
const BINS: usize = 96;
/// Pictures over time a report shows; more logs than that would hide the others.
const MOST_PICTURES: usize = 12;

pub(super) fn pictures(page: &mut Page, diagnosis: &Diagnosis) -> Result<(), String> {
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
pub(super) fn bars(diagnosis: &Diagnosis) -> String {
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
        let colour = match (chosen, r.refitted) {
            (true, _) => "#d55e00",
            (false, true) => "#0072b2",
            (false, false) => "#9ec4dc",
        };
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
