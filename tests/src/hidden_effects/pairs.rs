//! Pairs of effects that look alike on a plain motion (one sine under a constant load): both have to be named, with the
//! experiment that tells them apart; the generator then makes that experiment, and the answer has to be the hidden effect.
//!
//! Whether a pair is inseparable is measured, not believed: the generator imitates the hidden effect by its rival as in
//! [`super::compare`], and a cell counts only where the chi-square that is left stays below [`ALIKE`].

use super::CampaignError;
use super::compare::Outcome;
use super::run::{Desk, hide};
use super::seal::{Answer, Label, Sealed, name_of};
use crate::generator::hidden::HiddenEffect;
use crate::generator::motion::Course;
use crate::generator::noise::Noise;
use crate::generator::session::{Plant, Point, Session};
use crate::generator::size::Scale;
use crate::generator::vocabulary::draw;
use std::time::Instant;

/// Chi-square between hidden effect and imitation up to which nothing can tell them apart.
const ALIKE: f64 = 9.0;

/// Pairs by plant.
pub const PAIRS: &[(Plant, &str, &str)] = &[
    (Plant::Linear, "coulomb-level", "load-dependent-friction"),
    (Plant::Linear, "drive-lag", "sensor-delay"),
    (Plant::Rotary, "coulomb-level", "load-dependent-friction"),
];

/// The operating point that a proposal asks for; `None` where its words mean nothing to the generator.
fn proposed(words: &str, now: Point) -> Option<Point> {
    let points = [
        ("twice as fast", Point { speed: 2.0 * now.speed, ..now }),
        ("half the speed", Point { speed: 0.5 * now.speed, ..now }),
        ("half the load", Point { load: 0.5 * now.load, ..now }),
        ("twice the load", Point { load: 2.0 * now.load, ..now }),
        ("load reversed", Point { load: -now.load, ..now }),
        ("half the stroke", Point { stroke: 0.5 * now.stroke, ..now }),
    ];
    points.iter().find(|(name, _)| words.contains(name)).map(|(_, point)| *point)
}

pub(super) fn run(desk: &Desk<'_>) -> Result<Outcome, CampaignError> {
    let cell = desk.cell;
    let mut noise = Noise::new(cell.stream());
    let point = Point { course: Course::Plain, ..Point::default() };
    let session = Session::draw(cell.plant, 0.8, point, &mut noise);
    let scale = Scale::new(&session);
    let mut outcome = Outcome::new(cell);
    let Some(effects) = hide(cell, &scale, &session, &mut noise) else { return Ok(outcome) };
    let base = session.readings(&session.off, &[]);
    let Some(rival) = cell.effects.get(1).and_then(|e| draw(e, &session, &base, &mut noise)) else {
        return Ok(outcome);
    };
    let imitation: HiddenEffect = rival.at(rival.guess);
    let left = scale.left(&scale.added(&effects), &[scale.added(std::slice::from_ref(&imitation))]);
    if left.iter().map(|v| v * v).sum::<f64>() > ALIKE {
        return Ok(outcome);
    }
    let bench = desk.bench()?;
    let name = name_of(&cell.words(), cell.seed);
    let log = desk.log(&name, &session.log(&effects, &mut noise), &bench)?;
    let label = Label { effects: effects.clone(), sizes: cell.sizes.clone() };
    let sealed = Sealed::close(desk.folder, &name, cell.stream(), &label)?;
    let start = Instant::now();
    let answer = desk.ask(&bench, std::slice::from_ref(&log), &[])?;
    outcome.engine_s = start.elapsed().as_secs_f64();
    let label = sealed.open(&Answer::write(desk.folder, &name, &answer)?)?;
    outcome.judge(&answer, &label);
    let named = |e: &HiddenEffect| {
        let group = outcome.causes.iter().chain(&outcome.ambiguous_with);
        group.into_iter().any(|n| n.effect == e.effect && n.channel == e.channel)
    };
    outcome.in_group = effects.iter().chain([&imitation]).filter(|e| named(e)).count();
    if let Some(point) = answer.next_experiment.as_deref().and_then(|words| proposed(words, point)) {
        let text = session.again(point, &mut noise).log(&effects, &mut noise);
        let second = desk.log(&name_of(&format!("{} again", cell.words()), cell.seed), &text, &bench)?;
        let both = desk.ask(&bench, &[log, second], &[])?;
        let mut after = Outcome::new(cell);
        after.judge(&both, &label);
        outcome.settled = Some(after.first && after.ambiguous_with.is_empty());
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_experiment_of_the_menu_is_known() {
        let here = Point::default();
        let words = "record two cycles with the load reversed: that would set a apart from b";
        assert_eq!(proposed(words, here), Some(Point { load: -1.0, ..here }));
        assert_eq!(proposed("record two cycles at half the speed", here), Some(Point { speed: 0.5, ..here }));
        assert_eq!(proposed("look at it again", here), None);
    }

    #[test]
    fn the_pairs_look_alike_and_an_unlike_pair_does_not() {
        let apart = |plant, one: &str, two: &str| {
            let mut noise = Noise::new(3);
            let point = Point { course: Course::Plain, ..Point::default() };
            let session = Session::draw(plant, 0.8, point, &mut noise);
            let (scale, base) = (Scale::new(&session), session.readings(&session.off, &[]));
            let (one, two) = (draw(one, &session, &base, &mut noise), draw(two, &session, &base, &mut noise));
            let (one, two) = (one.unwrap(), two.unwrap());
            let size = scale.magnitude(|m| one.at(m), one.guess, one.most, 1.0).unwrap();
            let left = scale.left(&scale.added(&[one.at(size)]), &[scale.added(&[two.at(two.guess)])]);
            left.iter().map(|v| v * v).sum::<f64>()
        };
        assert!(apart(Plant::Linear, "coulomb-level", "load-dependent-friction") < ALIKE);
        assert!(apart(Plant::Linear, "inertia-mismatch", "sensor-offset") > 100.0 * ALIKE);
    }
}
