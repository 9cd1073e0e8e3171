//! Changed questions: the same log in another form must get the same answer.
//!
//! The changes are foreign names, units and signs; other time stamps; another order of columns; a
//! row counter before the columns; the log twice; a second record, which shrinks intervals by
//! about the square root of two; the residual of the calibrated bench shuffled, which leaves
//! nothing to find. Order and counter test the reader of logs: such a file has no header, and the
//! description gives the columns by number.

use super::CampaignError;
use super::cell::CHANGES;
use super::cell_run::{CellRun, hide};
use super::compare::Outcome;
use crate::generator::noise::Noise;
use crate::generator::plant::Plant;
use crate::generator::record::{Point, Record};
use crate::generator::size::Scale;
use crate::generator::vocabulary::size_parameters;
use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Verdict};
use std::fmt::Write as _;
use std::time::Instant;

/// Name of the column that counts rows.
const COUNTER: &str = "counter";

/// Foreign columns of a plant: channel, foreign name, factor from SI.
fn foreign(plant: Plant) -> &'static [(&'static str, &'static str, f64)] {
    match plant {
        Plant::Linear => &[
            ("position_m", "pos [mm]", 1e3),
            ("velocity_m_s", "v", -100.0),
            ("drive_force_n", "F [kN]", -1e-3),
        ],
        _ => &[
            ("spindle_angle_rad", "angle [deg]", 57.29577951308232),
            ("drive_torque_nm", "T", -1e3),
            ("friction_torque_nm", "R", 2.0),
        ],
    }
}

/// Splits a log into names and rows.
fn table(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let names = lines.next().unwrap_or_default().split(',').map(str::to_owned).collect();
    (names, lines.map(|l| l.split(',').filter_map(|f| f.parse().ok()).collect()).collect())
}

fn csv(names: &[String], rows: &[Vec<f64>]) -> String {
    let mut text = names.join(",") + "\n";
    for row in rows {
        let fields: Vec<String> = row.iter().map(|v| format!("{v:.12e}")).collect();
        let _ = writeln!(text, "{}", fields.join(","));
    }
    text
}

/// Returns the log with later time stamps.
fn later(text: &str) -> String {
    let (names, mut rows) = table(text);
    rows.iter_mut().filter_map(|r| r.first_mut()).for_each(|t| *t += 4321.5);
    csv(&names, &rows)
}

/// Returns the log without header, in another order or after a counter, with the tables that give
/// the columns by number.
fn numbered(change: &str, text: &str) -> (String, String) {
    let (mut names, mut rows) = table(text);
    if change == "order" {
        names.reverse();
        rows.iter_mut().for_each(|r| r.reverse());
    } else {
        names.insert(0, COUNTER.into());
        rows.iter_mut().enumerate().for_each(|(i, r)| r.insert(0, i as f64));
    }
    let mut tables = String::from("\n[log]\nheader = false\n\n[columns]\n");
    for (i, name) in names.iter().enumerate().filter(|(_, n)| *n != COUNTER) {
        let _ = writeln!(tables, "{name} = {{ from = {i} }}");
    }
    let text = csv(&names, &rows);
    (text.split_once('\n').map_or("", |(_, rows)| rows).to_owned(), tables)
}

/// Returns the log in foreign units and signs, with the tables that describe them.
fn translated(plant: Plant, text: &str) -> (String, String) {
    let (mut names, mut rows) = table(text);
    let mut tables = String::from("\n[columns]\n");
    for (name, other, factor) in foreign(plant) {
        let Some(i) = names.iter().position(|n| n == name) else { continue };
        names[i] = (*other).into();
        rows.iter_mut().filter_map(|r| r.get_mut(i)).for_each(|v| *v *= factor);
        let _ = writeln!(tables, "{name} = {{ from = \"{other}\", scale = {:e} }}", 1.0 / factor);
    }
    (csv(&names, &rows), tables)
}

/// Returns the log with the residual of the calibrated bench shuffled over the samples of each
/// channel.
///
/// The question is asked of the calibrated bench. Of the bench as described, the moves of the
/// calibration would be left to find.
fn shuffled(log: &MeasuredLog, nominal: &Diagnosis, noise: &mut Noise) -> MeasuredLog {
    let mut log = log.clone();
    for series in &nominal.series {
        let mut others = series.before.clone();
        for i in (1..others.len()).rev() {
            others.swap(i, (noise.uniform() * (i + 1) as f64) as usize);
        }
        // The engine may have left out samples.
        let mut points = series.time_s.iter().zip(series.before.iter().zip(&others)).peekable();
        let values = log.channels.get_mut(&series.channel).into_iter().flatten();
        for (time, value) in log.time_s.iter().zip(values) {
            if let Some((_, (own, other))) = points.next_if(|(t, _)| *t == time) {
                *value += other - own;
            }
        }
    }
    log
}

/// Returns the width of the interval of the first size parameter.
fn width(answer: &Diagnosis) -> Option<f64> {
    let cause = answer.causes.first()?;
    let names = size_parameters(&cause.effect);
    let parameter = cause.parameters.iter().find(|p| names.contains(&p.name.as_str()))?;
    Some(parameter.ci95[1] - parameter.ci95[0])
}

fn is_same(a: &Diagnosis, b: &Diagnosis) -> bool {
    let names = |d: &Diagnosis| d.causes.iter().map(|c| (c.effect.clone(), c.channel)).collect::<Vec<_>>();
    a.verdict == b.verdict && names(a) == names(b)
}

pub(super) fn run(run: &CellRun<'_>) -> Result<Outcome, CampaignError> {
    let cell = run.cell;
    let change = CHANGES.get(cell.variant).copied().unwrap_or_default();
    let mut noise = Noise::new(cell.stream());
    let record = Record::draw(cell.plant, 0.8, Point::default(), &mut noise);
    let scale = Scale::new(&record);
    let mut outcome = Outcome::new(cell);
    let Some(effects) = hide(cell, &scale, &record, &mut noise) else { return Ok(outcome) };
    let bench = run.bench()?;
    let text = record.log(&effects, &mut noise);
    let log = run.log("log", &text, &bench)?;
    let start = Instant::now();
    let answer = run.diagnose(&bench, std::slice::from_ref(&log), &[])?;
    outcome.engine_s = start.elapsed().as_secs_f64();
    let changed = match change {
        "units" | "order" | "counter" => {
            let (text, tables) =
                if change == "units" { translated(cell.plant, &text) } else { numbered(change, &text) };
            let description = format!("{}{tables}", cell.plant.description());
            let bench = Bench::parse("foreign.toml", &description).map_err(|e| run.failed(&e))?;
            let log = run.log("foreign", &text, &bench)?;
            run.diagnose(&bench, &[log], &[])?
        }
        "twice" => run.diagnose(&bench, &[log.clone(), log], &[])?,
        "more" => {
            let second = record.repeat(Point::default(), &mut noise).log(&effects, &mut noise);
            let second = run.log("second", &second, &bench)?;
            run.diagnose(&bench, &[log, second], &[])?
        }
        "shuffled" => {
            let nominal = run.calibrate(&bench, &log)?;
            let log = shuffled(&log, &nominal, &mut noise);
            run.diagnose(nominal.extended.as_ref().unwrap_or(&bench), &[log], &[])?
        }
        _ => run.diagnose(&bench, &[run.log("changed", &later(&text), &bench)?], &[])?,
    };
    outcome.score(&answer, &effects);
    outcome.settled = Some(match change {
        "shuffled" => changed.verdict == Verdict::None,
        _ => is_same(&answer, &changed),
    });
    if matches!(change, "twice" | "more") && is_same(&answer, &changed) {
        outcome.ratio = width(&answer).zip(width(&changed)).map(|(one, two)| one / two);
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bench::effects::CATALOGUE;
    use diagnosis::{Options, diagnose};

    #[test]
    fn a_foreign_log_is_read_back_as_the_same_numbers() {
        let mut noise = Noise::new(8);
        let record = Record::draw(Plant::Linear, 0.8, Point::default(), &mut noise);
        let text = record.log(&[], &mut noise);
        let (foreign, tables) = translated(Plant::Linear, &text);
        assert!(foreign.starts_with("t_s,pos [mm],v,"), "{}", &foreign[..40]);
        let bench = Bench::parse("a", &format!("{}{tables}", Plant::Linear.description())).unwrap();
        let plain = Bench::parse("b", Plant::Linear.description()).unwrap();
        let one = MeasuredLog::parse("a.csv", &foreign, &bench.log_format()).unwrap();
        let two = MeasuredLog::parse("b.csv", &text, &plain.log_format()).unwrap();
        assert_eq!(one.time_s.len(), two.time_s.len());
        for (channel, values) in &two.channels {
            let other = &one.channels[channel];
            assert!(
                values.iter().zip(other).all(|(a, b)| (a - b).abs() <= 1e-9 * a.abs().max(1e-3)),
                "{channel}"
            );
        }
    }

    #[test]
    fn a_log_with_numbered_columns_is_read_back_as_the_same_numbers() {
        let mut noise = Noise::new(8);
        let text = Record::draw(Plant::Linear, 0.8, Point::default(), &mut noise).log(&[], &mut noise);
        let read = |text: &str, tables: &str| {
            let bench = Bench::parse("a", &format!("{}{tables}", Plant::Linear.description())).unwrap();
            let log = MeasuredLog::parse("a.csv", text, &bench.log_format()).unwrap();
            (log.time_s, log.channels)
        };
        for (change, first) in [("order", "drive_force_n"), ("counter", "t_s")] {
            let (other, tables) = numbered(change, &text);
            assert!(
                tables.contains(&format!("{first} = {{ from = {} }}", usize::from(change == "counter"))),
                "{tables}"
            );
            assert_eq!(read(&other, &tables), read(&text, ""), "{change}");
            // With the tables of the other file, the log is rejected or gives other numbers.
            let (_, tables) = numbered(if change == "order" { "counter" } else { "order" }, &text);
            let bench = Bench::parse("b", &format!("{}{tables}", Plant::Linear.description())).unwrap();
            let wrong = MeasuredLog::parse("b.csv", &other, &bench.log_format());
            assert!(wrong.is_err() || wrong.is_ok_and(|w| (w.time_s, w.channels) != read(&text, "")));
        }
    }

    #[test]
    fn a_later_log_holds_the_same_samples() {
        let text = "t_s,a,b\n1,2,3\n4,5,6\n";
        assert_eq!(table(&later(text)).1, [[4322.5, 2.0, 3.0], [4325.5, 5.0, 6.0]]);
    }

    #[test]
    fn a_shuffled_residual_is_the_same_numbers_in_another_order() {
        let mut noise = Noise::new(8);
        let text = Record::draw(Plant::Linear, 0.8, Point::default(), &mut noise).log(&[], &mut noise);
        let bench = Bench::parse("b", Plant::Linear.description()).unwrap();
        let mut log = MeasuredLog::parse("a.csv", &text, &bench.log_format()).unwrap();
        // An outlier, which the engine leaves out: from there on, its rows differ from those of the
        // log.
        log.channels.values_mut().for_each(|values| values[500] += 1e4);
        let every: Vec<String> = CATALOGUE.iter().map(|kind| kind.name.to_owned()).collect();
        let options = Options { exclude: &every, ..Options::default() };
        let nominal = diagnose(&bench, &[log.clone()], &[], &options).unwrap();
        let other = shuffled(&log, &nominal, &mut noise);
        for series in &nominal.series {
            assert!(series.before.len() < log.time_s.len());
            let shift = |t: &f64| {
                let row = log.time_s.iter().position(|own| own == t).unwrap();
                other.channels[&series.channel][row] - log.channels[&series.channel][row]
            };
            let sorted = |mut values: Vec<f64>| {
                values.sort_by(f64::total_cmp);
                values
            };
            let moved: Vec<f64> =
                series.time_s.iter().zip(&series.before).map(|(t, b)| b + shift(t)).collect();
            assert!(moved != series.before);
            let apart =
                sorted(moved).into_iter().zip(sorted(series.before.clone())).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-9);
        }
    }
}
