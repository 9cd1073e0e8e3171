//! Pairs of effects that look alike on a plain motion: one sine under a constant load.
//!
//! The engine must name both, with the experiment that separates them. The generator then performs
//! that experiment, and the answer to all logs together must be the hidden effect. An answer that
//! no experiment of the menu separates them is counted separately.
//!
//! The similarity of a pair is measured: the generator imitates the hidden effect with its rival as
//! in [`super::compare`]. A cell counts only if the remaining chi-square is below [`ALIKE`].

use super::CampaignError;
use super::cell_run::{CellRun, hide};
use super::compare::Outcome;
use crate::generator::hidden::HiddenEffect;
use crate::generator::motion::Course;
use crate::generator::noise::Noise;
use crate::generator::record::{Point, Record};
use crate::generator::size::Scale;
use crate::generator::vocabulary::draw;
use bench::Bench;
use std::time::Instant;

/// Chi-square between hidden effect and imitation below which they cannot be separated.
const ALIKE: f64 = 9.0;

/// Returns the record and the cycles of a proposed description, relative to the described plant. A
/// sine without standstill begins at any phase, as its log does. The load gets a ramp only if the
/// proposal changes it.
fn proposed(described: &Bench, wanted: &str) -> Option<(Point, f64)> {
    let wanted = Bench::parse("proposed", wanted).ok()?;
    let (Bench::FrictionRig(now), Bench::FrictionRig(then)) = (described, &wanted) else { return None };
    let (axis, cycles) = (&then.axis, f64::from(then.axis.cycles));
    let ratio = if axis.last_period_s > 0.0 { axis.period_s / axis.last_period_s } else { 1.0 };
    let rise = 0.5 * (ratio * ratio - 1.0) / cycles;
    let standstill = axis.dwell_s / axis.period_s;
    let plain = standstill == 0.0 && rise == 0.0 && !axis.backwards;
    let point = Point {
        speed: now.axis.period_s / axis.period_s,
        load: then.load.force_n / now.load.force_n,
        stroke: axis.amplitude / now.axis.amplitude * if axis.backwards { -1.0 } else { 1.0 },
        course: if plain { Course::Plain } else { Course::Described { standstill, rise } },
        ramp_s: if then.load.ramp_s == now.load.ramp_s { 0.0 } else { then.load.ramp_s },
    };
    Some((point, cycles))
}

pub(super) fn run(run: &CellRun<'_>) -> Result<Outcome, CampaignError> {
    let cell = run.cell;
    let mut noise = Noise::new(cell.stream());
    let point = Point { course: Course::Plain, ..Point::default() };
    let record = Record::draw(cell.plant, 0.8, point, &mut noise);
    let scale = Scale::new(&record);
    let mut outcome = Outcome::new(cell);
    let Some(effects) = hide(cell, &scale, &record, &mut noise) else { return Ok(outcome) };
    let base = record.readings(&record.off, &[]);
    let Some(rival) = cell.effects.get(1).and_then(|e| draw(e, &record, &base, &mut noise)) else {
        return Ok(outcome);
    };
    let imitation: HiddenEffect = rival.at(rival.guess);
    let left = scale.residual(&scale.response(&effects), &[scale.response(std::slice::from_ref(&imitation))]);
    if left.iter().map(|v| v * v).sum::<f64>() > ALIKE {
        return Ok(outcome);
    }
    let bench = run.bench()?;
    let log = run.log("log", &record.log(&effects, &mut noise), &bench)?;
    let start = Instant::now();
    let answer = run.diagnose(&bench, std::slice::from_ref(&log), &[])?;
    outcome.engine_s = start.elapsed().as_secs_f64();
    outcome.score(&answer, &effects);
    let named = |e: &HiddenEffect| {
        let group = outcome.causes.iter().chain(&outcome.ambiguous_with);
        group.into_iter().any(|n| n.effect == e.effect && n.channel == e.channel)
    };
    outcome.in_group = effects.iter().chain([&imitation]).filter(|e| named(e)).count();
    let Some(proposal) = answer.experiment.filter(|e| !e.recordings.is_empty()) else { return Ok(outcome) };
    let mut logs = vec![log];
    for (number, recording) in proposal.recordings.iter().enumerate() {
        let Some((point, cycles)) = proposed(&bench, &recording.bench) else { return Ok(outcome) };
        let mut experiment = record.repeat(point, &mut noise);
        experiment.cycles = cycles;
        logs.push(run.log(&format!("experiment-{number}"), &experiment.log(&effects, &mut noise), &bench)?);
    }
    let all = run.diagnose(&bench, &logs, &[])?;
    let mut after = Outcome::new(cell);
    after.score(&all, &effects);
    outcome.settled = Some(after.first && after.causes.len() == 1 && after.ambiguous_with.is_empty());
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::plant::Plant;

    #[test]
    fn a_proposed_description_becomes_a_record() {
        let bench = Bench::parse("bench.toml", Plant::Linear.description()).unwrap();
        let wanted = |change: &dyn Fn(&mut bench::description::FrictionRig)| {
            let Bench::FrictionRig(mut rig) = bench.clone() else { panic!("a cylinder") };
            change(&mut rig);
            proposed(&bench, &Bench::FrictionRig(rig).to_toml().unwrap()).unwrap().0
        };
        let plain = Point { course: Course::Plain, ..Point::default() };
        assert_eq!(wanted(&|r| r.load.force_n *= -1.0), Point { load: -1.0, ..plain });
        assert_eq!(wanted(&|r| r.axis.period_s *= 2.0), Point { speed: 0.5, ..plain });
        assert_eq!(wanted(&|r| r.load.ramp_s = 0.2), Point { ramp_s: 0.2, ..plain });
        let rests = Course::Described { standstill: 0.25, rise: 0.0 };
        assert_eq!(wanted(&|r| r.axis.dwell_s = 1.0), Point { course: rests, ..plain });
        let sweep = wanted(&|r| (r.axis.cycles, r.axis.last_period_s) = (2, 0.5 * r.axis.period_s));
        assert_eq!(sweep.course, Course::Described { standstill: 0.0, rise: 0.75 });
        let mut record = Record::draw(Plant::Linear, 0.8, sweep, &mut Noise::new(3));
        record.cycles = 2.0;
        // Two cycles at a mean of 1.5 times the frequency.
        assert!((record.length_s() - 4.0 * 2.0 / 1.5).abs() < 1e-12, "{}", record.length_s());
    }

    #[test]
    fn the_pairs_look_alike_and_an_unlike_pair_does_not() {
        let apart = |plant, one: &str, two: &str| {
            let mut noise = Noise::new(3);
            let point = Point { course: Course::Plain, ..Point::default() };
            let record = Record::draw(plant, 0.8, point, &mut noise);
            let (scale, base) = (Scale::new(&record), record.readings(&record.off, &[]));
            let (one, two) = (draw(one, &record, &base, &mut noise), draw(two, &record, &base, &mut noise));
            let (one, two) = (one.unwrap(), two.unwrap());
            let size = scale.magnitude(|m| one.at(m), one.guess, one.most, 1.0).unwrap();
            let left =
                scale.residual(&scale.response(&[one.at(size)]), &[scale.response(&[two.at(two.guess)])]);
            left.iter().map(|v| v * v).sum::<f64>()
        };
        assert!(apart(Plant::Linear, "coulomb-level", "load-dependent-friction") < ALIKE);
        assert!(apart(Plant::Linear, "inertia-mismatch", "sensor-offset") > 100.0 * ALIKE);
    }
}
