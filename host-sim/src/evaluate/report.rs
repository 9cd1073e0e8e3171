//! Report of an evaluation: errors, signals over the last cycle, errors over time, findings.

use super::text::{channels, logs, short};
use crate::cli::limits;
use crate::diagnose::tables::{Table, findings};
use bench::Bench;
use diagnosis::{Evaluation, Series as Compared};
use report::figure::{Chart, Drawing, Series, Style, lines};
use report::page::Page;

const HALF: (u32, u32) = (512, 300);
/// Maximum number of logs with pictures.
const MAX_LOGS: usize = 6;

/// Builds the page. An error describes a failure of drawing.
pub(crate) fn page(evaluation: &Evaluation, name: &str, bench: &Bench) -> Result<Page, String> {
    let mut page = Page::new(&format!("Evaluation of {}", short(name)));
    page.lead("The described bench under the inputs of the logs. Nothing was fitted.");
    section(&mut page, "Errors", &channels(evaluation));
    page.note(
        "Measured minus simulated values in the channel's unit. Noise: declared, or as the log shows it. An \
         error well above the noise is an error of the description.",
    );
    section(&mut page, "Errors by log", &logs(evaluation));
    page.section("Measured and simulated");
    let mut sources: Vec<&str> = evaluation.series.iter().map(|s| s.source.as_str()).collect();
    sources.dedup();
    for source in sources.iter().take(MAX_LOGS) {
        for series in evaluation.series.iter().filter(|s| s.source == *source) {
            page.figures(&[last_cycle(series)?, error_over_time(series)?]);
        }
    }
    if sources.len() > MAX_LOGS {
        page.note(&format!("The first {MAX_LOGS} of {} logs are shown.", sources.len()));
    }
    section(&mut page, "Findings about the logs", &findings(&evaluation.checks));
    limits::section(&mut page, &**bench);
    Ok(page)
}

fn section(page: &mut Page, title: &str, table: &Table) {
    if !table.rows.is_empty() {
        page.section(title).table(table.header, &table.rows);
    }
}

/// Draws measured and simulated values of the last cycle.
fn last_cycle(series: &Compared) -> Result<(Drawing, &'static str), String> {
    let start = series.phase.as_ref().and_then(|phase| phase.last()).map(|last| last - 1.0);
    let is_shown = |i: usize| match (&series.phase, start) {
        (Some(phase), Some(start)) => phase.get(i).is_some_and(|phase| *phase >= start),
        _ => true,
    };
    let shown: Vec<usize> = (0..series.time_s.len()).filter(|i| is_shown(*i)).collect();
    let line = |name: &str, read: &dyn Fn(usize) -> Option<f64>| {
        let point = |i: &usize| Some((*series.time_s.get(*i)?, read(*i)?));
        Series::through(name, shown.iter().filter_map(point).collect())
    };
    let measured = |i: usize| series.measured.get(i).copied();
    let simulated = |i: usize| Some(series.measured.get(i)? - series.before.get(i)?);
    let title = format!("{}, {}", series.channel, short(&series.source));
    let chart = Chart { title: &title, x: "time, s", y: series.channel.unit(), size: HALF };
    let both = [line("measured", &measured).styled(Style::Wide), line("simulated", &simulated)];
    Ok((lines(&chart, &both)?, "The last cycle; of a log without cycles all of it."))
}

/// Draws the error over time.
fn error_over_time(series: &Compared) -> Result<(Drawing, &'static str), String> {
    let title = format!("error of {}, {}", series.channel, short(&series.source));
    let y = format!("measured - simulated, {}", series.channel.unit());
    let chart = Chart { title: &title, x: "time, s", y: &y, size: HALF };
    let error = Series::new("error", series.time_s.iter().copied(), series.before.iter().copied());
    Ok((lines(&chart, &[error])?, "Every sample."))
}
