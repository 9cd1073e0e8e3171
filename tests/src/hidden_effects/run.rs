//! One cell: hide an effect, ask the engine, score the answer.

use super::cell::{Arm, Cell};
use super::cell_run::{CellRun, hide};
use super::compare::Outcome;
use super::{CampaignError, changed, pairs};
use crate::generator::motion::Course;
use crate::generator::noise::Noise;
use crate::generator::record::{Point, Record};
use crate::generator::size::Scale;
use bench::simulate::{Inputs, respond};
use bench::{Bench, MeasuredLog};
use diagnosis::Diagnosis;
use std::path::Path;
use std::time::Instant;

/// Maximum deviation of the real plant from its description beside a hidden effect, in declared
/// standard deviations.
const SPREAD: f64 = 0.8;
/// The same in clean logs.
const CLEAN_SPREAD: f64 = 2.0;
/// Minimum size at which a predicted gain is compared with a measured one.
const GAIN_SIZE: f64 = 0.5;

/// Draws a clean record: coloured noise, another operating point, more samples lost.
fn clean(cell: &Cell, noise: &mut Noise) -> Record {
    let any = |noise: &mut Noise, choices: &[f64]| choices[(noise.uniform() * choices.len() as f64) as usize];
    let point = Point {
        speed: if cell.plant.is_transmission() { 1.0 } else { any(noise, &[0.7, 1.0, 1.3]) },
        load: any(noise, &[0.3, 0.6, 1.0]),
        stroke: if cell.plant.is_transmission() { 1.0 } else { any(noise, &[0.6, 1.0]) },
        course: if noise.uniform() < 0.2 { Course::Plain } else { Course::Swing },
        ..Point::default()
    };
    let mut record = Record::draw(cell.plant, CLEAN_SPREAD, point, noise);
    record.logger.colour = any(noise, &[0.0, 0.3, 0.6]);
    record.logger.lost = any(noise, &[0.0, 0.004, 0.03]);
    record
}

/// Runs a cell in a folder and removes its files.
pub fn run(folder: &Path, cell: &Cell) -> Result<Outcome, CampaignError> {
    let place = tempfile::tempdir_in(folder).map_err(|e| CampaignError::File {
        file: folder.display().to_string(),
        found: e.to_string(),
        expected: "a folder that can be written",
    })?;
    let run = CellRun { folder: place.path(), cell };
    match cell.arm {
        Arm::Pair => pairs::run(&run),
        Arm::Changed => changed::run(&run),
        _ => plain(&run),
    }
}

fn plain(run: &CellRun<'_>) -> Result<Outcome, CampaignError> {
    let cell = run.cell;
    let mut noise = Noise::new(cell.stream());
    let record = match cell.arm {
        Arm::Clean => clean(cell, &mut noise),
        Arm::Hard if cell.effects.is_empty() => clean(cell, &mut noise).hard(),
        Arm::Hard => Record::draw(cell.plant, SPREAD, Point::default(), &mut noise).hard(),
        _ => Record::draw(cell.plant, SPREAD, Point::default(), &mut noise),
    };
    let mut outcome = Outcome::new(cell);
    let scale = Scale::new(&record);
    let Some(effects) = hide(cell, &scale, &record, &mut noise) else { return Ok(outcome) };
    let bench = run.bench()?;
    let log = run.log("log", &record.log(&effects, &mut noise), &bench)?;
    let exclude = if cell.arm == Arm::Deleted { cell.effects.clone() } else { Vec::new() };
    let start = Instant::now();
    let answer = run.diagnose(&bench, std::slice::from_ref(&log), &exclude)?;
    outcome.engine_s = start.elapsed().as_secs_f64();
    outcome.score(&answer, &effects);
    outcome.score_equivalence(&scale, &answer);
    if is_gain_measured(&outcome) {
        let text = record.repeat(Point::default(), &mut noise).log(&effects, &mut noise);
        outcome.realised = realised(run, &bench, &log, &text, &answer)?;
    }
    Ok(outcome)
}

/// Returns whether a predicted gain is measured. Wrong names count, too, because the engine does
/// not know that they are wrong.
fn is_gain_measured(outcome: &Outcome) -> bool {
    let cell = &outcome.cell;
    cell.arm == Arm::Single && !outcome.causes.is_empty() && cell.sizes.iter().all(|s| *s >= GAIN_SIZE)
}

/// Returns the share of the residual above the noise that the extended bench removes, relative to
/// the calibrated nominal bench, on a record that the engine never saw.
fn realised(
    run: &CellRun<'_>,
    bench: &Bench,
    seen: &MeasuredLog,
    text: &str,
    answer: &Diagnosis,
) -> Result<Option<f64>, CampaignError> {
    let fresh = run.log("fresh", text, bench)?;
    let nominal = run.calibrate(bench, seen)?;
    let (Some(before), Some(after)) = (&nominal.extended, &answer.extended) else { return Ok(None) };
    let sensors = run.cell.conditions().sensors(run.cell.plant);
    let left = |bench: &Bench| -> Result<f64, CampaignError> {
        let inputs = Inputs::new(bench, &fresh).map_err(|e| run.failed(&e))?;
        let response = respond(bench, &inputs).map_err(|e| run.failed(&e))?;
        let power = |(channel, simulated): (&bench::Channel, &Vec<f64>)| {
            let floor = sensors.iter().find(|s| s.channel == channel.name()).map_or(1.0, |s| s.floor());
            let measured = fresh.channels.get(channel).map_or(&[][..], Vec::as_slice);
            let used = fresh.time_s.iter().map(|t| *t > run.cell.plant.landing_s());
            let pairs = measured.iter().zip(simulated).zip(used).filter(|(_, used)| *used);
            let (sum, count) = pairs
                .fold((0.0, 0.0_f64), |(sum, n), ((m, s), _)| (sum + ((m - s) / floor).powi(2), n + 1.0));
            sum / count.max(1.0) - 1.0
        };
        Ok(response.iter().map(power).sum())
    };
    let (before, after) = (left(before)?, left(after)?);
    Ok((before > 0.0).then(|| 1.0 - after / before))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hidden_effects::cell::Campaign;
    use crate::hidden_effects::compare::Named;

    #[test]
    fn the_gain_of_a_wrong_name_is_measured_too() {
        let cells = Campaign { sizes: vec![0.3, 0.5], arms: vec![Arm::Single], ..Campaign::quick() }.cells();
        for cell in &cells {
            let mut outcome = Outcome::new(cell);
            assert!(!is_gain_measured(&outcome));
            outcome.causes = vec![Named { effect: "another".into(), channel: None, probability: 0.9 }];
            assert_eq!(is_gain_measured(&outcome), cell.sizes != [0.3]);
        }
    }
}
