//! Pictures of a diagnosis: measured and simulated signals, residuals over their causes, ranking
//! and shares as bars.

use super::sentences::placed;
use bench::Channel;
use diagnosis::{Diagnosis, Series as Residual, four_digits};
use report::figure::{Chart, Series, Style, lines};
use report::page::Page;
use std::collections::BTreeMap;
use std::fmt::Write as _;

const WIDE: (u32, u32) = (1040, 300);
const HALF: (u32, u32) = (512, 300);
/// Bins of a cycle in the pictures.
const BINS: usize = 96;
/// Maximum number of pictures over time; more logs than that would hide the others.
const MAX_PICTURES: usize = 12;
/// Channels that are also shown over the position, those with the largest error first.
const MAX_OVER_POSITION: usize = 2;
/// Quantities over which a channel's residual is shown.
const MAX_PLACES: usize = 4;

/// Channels with a residual, sorted by the ratio of error to noise, the largest first.
fn channels(diagnosis: &Diagnosis) -> Vec<Channel> {
    let far = |channel: &Channel| {
        let gain = diagnosis.gain.iter().find(|g| g.channel == *channel);
        gain.map_or(0.0, |g| g.baseline_rms / g.noise_rms.max(f64::MIN_POSITIVE))
    };
    let mut channels: Vec<Channel> = diagnosis.series.iter().map(|s| s.channel).collect();
    channels.sort();
    channels.dedup();
    channels.sort_by(|a, b| far(b).total_cmp(&far(a)));
    channels
}

/// Returns whether a channel is a position itself, which over the position is a straight line.
fn is_position(channel: Channel) -> bool {
    matches!(channel, Channel::Position | Channel::SpindleAngle)
}

/// Draws a held-out cycle of each channel over time and over the position: measured, simulated
/// before and after. It is the cycle that the causes change most or, without causes, the one with
/// the largest error.
pub(crate) fn measured_and_simulated(page: &mut Page, diagnosis: &Diagnosis) -> Result<(), String> {
    let mut pictures = Vec::new();
    for (rank, channel) in channels(diagnosis).into_iter().enumerate() {
        let own = || diagnosis.series.iter().filter(|s| s.channel == channel);
        let Some(series) = own().find(|s| s.held_out.contains(&true)).or_else(|| own().next()) else {
            continue;
        };
        let shown = shown_cycle(series);
        let title = format!("{channel}, {}", short(&series.source));
        for (x, values, words) in [
            ("time, s", &series.time_s, "The cycle that shows most; of a log without cycles all of it."),
            ("position of the drive, m or rad", &series.position, "The same samples over the position."),
        ]
        .into_iter()
        .take(if rank < MAX_OVER_POSITION && !is_position(channel) { 2 } else { 1 })
        {
            let line = |name: &str, read: &dyn Fn(usize) -> f64| {
                Series::through(name, shown.iter().map(|&i| (values[i], read(i))).collect())
            };
            let chart = Chart { title: &title, x, y: channel.unit(), size: HALF };
            let drawn = lines(
                &chart,
                &[
                    line("measured", &|i| series.measured[i]).styled(Style::Wide),
                    line("simulated before", &|i| series.measured[i] - series.before[i]),
                    line("after", &|i| series.measured[i] - series.after[i]),
                ],
            )?;
            pictures.push((drawn, words));
        }
    }
    page.figures(&pictures);
    Ok(())
}

/// Draws the mean residual over the quantities that explain most of it.
pub(crate) fn places(page: &mut Page, diagnosis: &Diagnosis) -> Result<(), String> {
    let worst = channels(diagnosis);
    for channel in worst.iter().take(2) {
        let mut pictures = Vec::new();
        let mut shares = Vec::new();
        for place in diagnosis.places.iter().filter(|p| p.channel == *channel).take(MAX_PLACES) {
            shares.push(format!("{} {:.0} %", place.quantity, 100.0 * place.share));
            let title = format!("{channel} over {}", place.quantity);
            let y = format!("mean of measured - simulated, {}", channel.unit());
            let chart = Chart { title: &title, x: place.quantity, y: &y, size: HALF };
            let line = |name: &str, read: fn(&diagnosis::ResidualBin) -> f64| {
                let points = place.bins.iter().map(|b| (0.5 * (b.from + b.to), read(b))).collect();
                Series::through(name, points).styled(Style::Both)
            };
            let drawn = lines(&chart, &[line("before", |b| b.before), line("after", |b| b.after)])?;
            pictures.push((drawn, "Bins of equal counts; SI units."));
        }
        page.figures(&pictures);
        page.note(&format!(
            "Of the power of the error of {channel} before, the means over these make up: {}.",
            shares.join(", ")
        ));
    }
    Ok(())
}

/// Draws the residual before and after, over the cycle and over time.
pub(crate) fn residuals(page: &mut Page, diagnosis: &Diagnosis) -> Result<(), String> {
    let y = |c: Channel| format!("measured - simulated, {}", c.unit());
    for channel in channels(diagnosis) {
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
        for s in of.iter().take(MAX_PICTURES / of.len().max(1) + 1).take(4) {
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

/// Samples of the held-out cycle that the causes change most or, without causes, of the one with
/// the largest error; all samples of a log without cycles.
fn shown_cycle(series: &Residual) -> Vec<usize> {
    let Some(phase) = &series.phase else { return (0..series.time_s.len()).collect() };
    let is_changed = series.before != series.after;
    let mut cycles: BTreeMap<i64, (f64, Vec<usize>)> = BTreeMap::new();
    let is_any_held_out = series.held_out.contains(&true);
    for (i, phase) in phase.iter().enumerate().filter(|(i, _)| series.held_out[*i] || !is_any_held_out) {
        let shown = series.before[i] - if is_changed { series.after[i] } else { 0.0 };
        let (power, samples) = cycles.entry(phase.floor() as i64).or_default();
        *power += shown * shown;
        samples.push(i);
    }
    let most = cycles.into_values().max_by(|a, b| a.0.total_cmp(&b.0));
    most.map_or_else(Vec::new, |(_, samples)| samples)
}

fn short(source: &str) -> &str {
    source.rsplit(['/', '\\']).next().unwrap_or(source)
}

/// Means over bins of the cycle's phase; empty if the motion does not repeat.
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

/// A bar with its name and the number at its end.
struct Bar {
    name: String,
    /// Length as a share of the whole width.
    share: f64,
    value: String,
    colour: &'static str,
}

const CHOSEN: &str = "#d55e00";
const OTHER: &str = "#0072b2";
const PALE: &str = "#9ec4dc";

const ROW: f64 = 24.0;
const MIN_LEFT: f64 = 300.0;
/// Width of a letter, rounded up: only the size of the font is known.
const LETTER: f64 = 7.5;
const RIGHT: f64 = 90.0;
const WIDTH: f64 = 1040.0;

/// Width of the longest name.
fn left(bars: &[Bar]) -> f64 {
    let longest = bars.iter().map(|bar| bar.name.chars().count()).max().unwrap_or_default();
    MIN_LEFT.max(LETTER * longest as f64 + 8.0)
}

/// Draws bars below each other, with space for a line of text under them.
fn bars(bars: &[Bar], below: &str) -> String {
    let left = left(bars);
    let height = ROW * (bars.len() as f64 + 1.0);
    let mut svg = format!(
        "<svg style=\"min-width:640px\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} \
         {height}\" font-family=\"sans-serif\" font-size=\"13\">"
    );
    for (i, bar) in bars.iter().enumerate() {
        let (y, length) = (ROW * i as f64, ((WIDTH - left - RIGHT) * bar.share.clamp(0.0, 1.0)).max(1.0));
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><rect x=\"{left:.1}\" y=\"{:.1}\" \
             width=\"{length:.1}\" height=\"{:.1}\" fill=\"{}\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            left - 8.0,
            y + 17.0,
            bar.name,
            y + 4.0,
            ROW - 8.0,
            bar.colour,
            left + length + 6.0,
            y + 17.0,
            bar.value,
        );
    }
    svg + below + "</svg>"
}

/// The ranking on a logarithmic scale, with the threshold.
pub(crate) fn ranking(diagnosis: &Diagnosis) -> String {
    let largest = diagnosis.ranking.iter().map(|r| r.evidence).fold(10.0 * diagnosis.threshold, f64::max);
    let share = |value: f64| value.max(1.0).ln() / largest.ln();
    let rows: Vec<Bar> = diagnosis
        .ranking
        .iter()
        .map(|r| {
            let own = (&r.effect, r.channel, &r.of);
            let chosen = diagnosis.causes.iter().any(|c| (&c.effect, c.channel, &c.of) == own);
            let colour = match (chosen, r.refitted) {
                (true, _) => CHOSEN,
                (false, true) => OTHER,
                (false, false) => PALE,
            };
            Bar {
                name: placed(&r.effect, r.channel, &r.of),
                share: share(r.evidence),
                value: four_digits(r.evidence),
                colour,
            }
        })
        .collect();
    let left = left(&rows);
    let (at, height) = (left + (WIDTH - left - RIGHT) * share(diagnosis.threshold), ROW * rows.len() as f64);
    let line = format!(
        "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"0\" y2=\"{height:.1}\" stroke=\"#000000\" \
         stroke-dasharray=\"4 3\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{:.1}</text>",
        height + 17.0,
        diagnosis.threshold,
    );
    bars(&rows, &line)
}

/// Minimum share of a hypothesis that gets a bar.
const MIN_SHARE: f64 = 1e-3;

/// Posterior shares of the hypotheses, `none` and `unknown` among them.
pub(crate) fn shares(diagnosis: &Diagnosis) -> String {
    let chosen: Vec<String> = diagnosis.causes.iter().map(|c| placed(&c.effect, c.channel, &c.of)).collect();
    let fitted = diagnosis.hypotheses.iter().filter(|h| h.probability >= MIN_SHARE).map(|h| {
        let names: Vec<String> = h.causes.iter().map(|m| placed(&m.effect, m.channel, &m.of)).collect();
        let colour = if names == chosen { CHOSEN } else { OTHER };
        (names.join(" + "), h.probability, colour)
    });
    let others = [("none", diagnosis.probability_none), ("unknown", diagnosis.probability_unknown)];
    let others = others.map(|(name, share)| (name.to_owned(), share, PALE));
    let bar = |(name, share, colour): (String, f64, &'static str)| Bar {
        name,
        share,
        value: format!("{:.1} %", 100.0 * share),
        colour,
    };
    bars(&fitted.chain(others).map(bar).collect::<Vec<_>>(), "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_name_of_a_bar_has_room() {
        let bar = |name: &str| Bar { name: name.into(), share: 1.0, value: "1".into(), colour: OTHER };
        assert_eq!(left(&[bar("none")]), MIN_LEFT);
        let pair = "sensor-offset of drive_force_n + sensor-gain of drive_force_n";
        let room = left(&[bar("none"), bar(pair)]);
        assert!(room > 7.0 * pair.len() as f64 && room < WIDTH - RIGHT - 200.0, "{room}");
        assert!(bars(&[bar(pair)], "").contains(&format!("<rect x=\"{room:.1}\"")));
    }
}
