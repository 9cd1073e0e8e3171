//! Goals of the figures, and the comparison with golden figures.

use super::score::{Figures, Share, Shares};

/// A goal with its figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Name of the figure.
    pub name: &'static str,
    /// Accepted range, both ends included.
    pub wanted: (f64, f64),
    /// Measured figure, if the campaign asked for it.
    pub found: Option<f64>,
    /// Number of cells of the figure.
    pub cells: usize,
}

impl Goal {
    /// Returns the distance of the figure from the accepted range.
    pub(crate) fn missed_by(&self) -> Option<f64> {
        let (min, max) = self.wanted;
        self.found.map(|v| (min - v).max(v - max).max(0.0))
    }
}

impl Figures {
    /// Returns the goals with the measured figures.
    pub fn goals(&self) -> Vec<Goal> {
        let at = |size: &str, read: fn(&Shares) -> f64| {
            self.by_size.get(size).map_or((None, 0), |s| (Some(read(s)), s.cells))
        };
        let (hits, clean) = self
            .false_alarms
            .values()
            .fold((0.0, 0), |(hits, n), s| (hits + s.share * s.cells as f64, n + s.cells));
        let of = |s: &Share| ((s.cells > 0).then_some(s.share), s.cells);
        let cells = self.deleted.cells;
        let deleted = |v: f64| ((cells > 0).then_some(v), cells);
        let known = self.deleted.unknown + self.deleted.equivalent;
        let stated = self.calibration_of_all.iter().map(|bin| bin.0).sum();
        let all = self.ran.values().sum();
        let at_most = |name, max: f64, (found, cells)| Goal { name, wanted: (0.0, max), found, cells };
        let at_least = |name, min: f64, (found, cells)| Goal { name, wanted: (min, 1.0), found, cells };
        let (covered, intervals) = of(&self.covered);
        vec![
            at_most("false alarms", 0.01, ((clean > 0).then(|| hits / clean as f64), clean)),
            at_least("detected at size .5", 0.97, at("0.5", |s| s.detected)),
            at_least("first name at size .5", 0.90, at("0.5", |s| s.first)),
            at_least("first name at size 1", 0.97, at("1", |s| s.first)),
            at_least("truth in the group at size 1", 0.97, at("1", |s| s.in_group)),
            at_most("mean group size at size 1", 2.0, at("1", |s| s.group)),
            at_least("deleted cause unknown or equivalent", 0.90, deleted(known)),
            at_most("deleted cause wrongly named", 0.05, deleted(self.deleted.wrong)),
            at_most("wrong among the named deleted causes", 0.10, of(&self.wrong_among_named())),
            at_least("two effects, both in the group", 0.85, of(&self.both)),
            at_least("inseparable pair, both named", 0.95, of(&self.pair_named)),
            at_least("pair settled by the proposed experiment", 0.90, of(&self.pair_settled)),
            at_most("false alarms under hard conditions", 0.01, of(&self.hard_false_alarms)),
            at_least(
                "first name at size 1 under hard conditions",
                0.97,
                ((self.hard.cells > 0).then_some(self.hard.first), self.hard.cells),
            ),
            at_most("parameter error at size 1, median", 0.10, (self.parameter_error, self.parameter_cells)),
            at_most("calibration error over all arms", 0.05, (self.calibration_error_of_all, stated)),
            Goal {
                name: "95 % intervals that contain the truth",
                wanted: (0.92, 0.98),
                found: covered,
                cells: intervals,
            },
            at_most(
                "measured against predicted gain, median difference",
                0.20,
                (self.gain_error, self.gain_within.cells),
            ),
            at_most("longest wall time of the engine, s", 60.0, (Some(self.engine_s.0), all)),
        ]
    }

    /// Lists what is worse than in `golden`: goals missed by more, figures that disappeared, and
    /// other cells. Wall times are left out.
    pub fn worse_than(&self, golden: &Self) -> Vec<String> {
        let mut worse = Vec::new();
        if self.ran != golden.ran {
            worse.push(format!("cells that ran: found {:?}, expected {:?}", self.ran, golden.ran));
        }
        for (found, before) in self.goals().iter().zip(golden.goals()) {
            let allowed = before.missed_by().map_or(0.0, |m| m + 1e-9);
            let lost = before.found.is_some() && found.found.is_none();
            if !found.name.contains("wall time") && (lost || found.missed_by().is_some_and(|m| m > allowed)) {
                worse.push(format!("{}: found {:?}, golden {:?}", found.name, found.found, before.found));
            }
        }
        let unchanged = |f: &Self| f.changed.values().map(|s| s.share * s.cells as f64).sum::<f64>();
        if unchanged(self) < unchanged(golden) - 1e-9 {
            worse.push(format!("changed questions: found {:?}, golden {:?}", self.changed, golden.changed));
        }
        worse
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::hidden::HiddenEffect;
    use crate::generator::plant::Plant;
    use crate::hidden_effects::cell::{Arm, Campaign};
    use crate::hidden_effects::compare::{Named, Outcome};
    use crate::hidden_effects::score::figures;
    use std::collections::BTreeMap;

    fn campaign() -> Campaign {
        Campaign {
            seeds: 1,
            bench_seeds: 0,
            skipped_seeds: 0,
            bench_alone: false,
            is_sample: false,
            plants: vec![Plant::Linear],
            sizes: vec![0.5],
            arms: vec![Arm::Clean, Arm::Single, Arm::Deleted],
        }
    }

    /// Returns outcomes in which the first `hits` cells of every arm have the right answer.
    fn outcomes(hits: usize) -> Vec<Outcome> {
        let mut seen: BTreeMap<Arm, usize> = BTreeMap::new();
        let one = |cell: &crate::hidden_effects::cell::Cell| {
            let place = seen.entry(cell.arm).or_default();
            *place += 1;
            let hit = *place <= hits;
            let mut outcome = Outcome::new(cell);
            outcome.verdict = match (cell.arm, hit) {
                (Arm::Clean, true) => "none",
                (Arm::Single, true) => "named",
                _ => "unknown",
            }
            .into();
            outcome.first = cell.arm == Arm::Single && hit;
            outcome
        };
        campaign().cells().iter().map(one).collect()
    }

    #[test]
    fn shares_are_hits_over_cells() {
        let found = figures("2026-01-01", &campaign(), &outcomes(8));
        assert_eq!(found.false_alarms["linear"], Share { cells: 10, share: 0.2 });
        let singles = &found.by_size["0.5"];
        assert_eq!((singles.cells, singles.detected), (22, 1.0));
        assert!((singles.first - 8.0 / 22.0).abs() < 1e-12);
        assert_eq!(found.deleted.unknown, 1.0);
    }

    #[test]
    fn names_of_partial_answers_and_of_deleted_causes_are_scored() {
        let mut outcomes = answers(|arm| arm == Arm::Single);
        let deleted = outcomes.iter_mut().filter(|o| o.cell.arm == Arm::Deleted);
        for (i, outcome) in deleted.enumerate() {
            if i < 4 {
                (outcome.verdict, outcome.causes) = ("partial".into(), Vec::new());
                (outcome.partial_names, outcome.partial_right) = (2, usize::from(i == 0));
            }
            outcome.equivalent = i == 4;
        }
        let found = figures("2026-01-01", &campaign(), &outcomes);
        assert_eq!(found.partial_names, Share { cells: 8, share: 1.0 / 8.0 });
        assert_eq!(found.wrong_among_named(), Share { cells: 18, share: 17.0 / 18.0 });
        let goal = |f: &Figures| {
            f.goals().into_iter().find(|g| g.name == "wrong among the named deleted causes").unwrap()
        };
        assert!(goal(&found).missed_by().unwrap() > 0.8 && !found.worse_than(&Figures::default()).is_empty());
    }

    #[test]
    fn fewer_hits_are_worse_and_more_are_not() {
        let of = |hits| figures("2026-01-01", &campaign(), &outcomes(hits));
        assert!(of(9).worse_than(&of(9)).is_empty() && of(10).worse_than(&of(9)).is_empty());
        let worse = of(8).worse_than(&of(9));
        assert!(worse.iter().any(|w| w.starts_with("false alarms")), "{worse:?}");
        assert!(worse.iter().any(|w| w.starts_with("first name at size .5")), "{worse:?}");
        let fewer = figures("2026-01-01", &campaign(), &outcomes(9)[..30]);
        assert!(fewer.worse_than(&of(9))[0].starts_with("cells that ran"));
    }

    /// Returns an answer for every cell of the campaign; `right` selects the arms whose first cause
    /// is hidden.
    fn answers(right: impl Fn(Arm) -> bool) -> Vec<Outcome> {
        let answer = |cell: &crate::hidden_effects::cell::Cell| {
            let mut outcome = Outcome::new(cell);
            outcome.verdict = "named".into();
            outcome.hidden = cell.effects.iter().map(|e| HiddenEffect::new(e, &[])).collect();
            let effect = if right(cell.arm) { cell.effects[0].clone() } else { "another".into() };
            outcome.first = right(cell.arm);
            outcome.causes = vec![Named { effect, channel: None, probability: 1.0 }];
            outcome
        };
        campaign().cells().iter().map(answer).collect()
    }

    #[test]
    fn names_in_clean_logs_and_of_deleted_causes_count_against_the_stated_probabilities() {
        let found = figures("2026-01-01", &campaign(), &answers(|arm| arm == Arm::Single));
        assert_eq!((found.calibration_error, &found.calibration), (Some(0.0), &vec![(22, 1.0, 1.0)]));
        // 22 right answers to 22 single effects, 10 clean logs and 22 deleted causes.
        assert_eq!(found.calibration_of_all, [(54, 1.0, 22.0 / 54.0)]);
        let goal = found.goals().into_iter().find(|g| g.name == "calibration error over all arms").unwrap();
        assert!((goal.found.unwrap() - 32.0 / 54.0).abs() < 1e-12 && goal.cells == 54);
    }

    #[test]
    fn parameter_errors_count_right_names_and_gains_count_wrong_names_too() {
        let sizes = Campaign { sizes: vec![1.0], arms: vec![Arm::Single], ..campaign() };
        let mut outcomes: Vec<Outcome> = sizes.cells().iter().map(Outcome::new).collect();
        for (i, outcome) in outcomes.iter_mut().enumerate() {
            outcome.verdict = "named".into();
            outcome.first = i < 4;
            outcome.parameter_error = (i < 4).then_some(0.02);
            (outcome.predicted, outcome.realised) = (Some(0.5), Some(if i < 4 { 0.5 } else { 0.1 }));
        }
        let found = figures("2026-01-01", &sizes, &outcomes);
        let goal = |name: &str| found.goals().into_iter().find(|g| g.name.starts_with(name)).unwrap();
        assert_eq!((goal("parameter error").found, goal("parameter error").cells), (Some(0.02), 4));
        assert_eq!(found.gain_within, Share { cells: 22, share: 4.0 / 22.0 });
    }

    #[test]
    fn a_missing_figure_is_worse_and_cells_that_were_not_asked_are_counted() {
        let found = figures("2026-01-01", &campaign(), &answers(|arm| arm == Arm::Single));
        let mut gone = found.clone();
        gone.calibration_error_of_all = None;
        assert!(found.worse_than(&found).is_empty());
        let worse = gone.worse_than(&found);
        assert!(worse[0].starts_with("calibration error over all arms: found None"), "{worse:?}");
        let none: Vec<Outcome> = campaign().cells().iter().map(Outcome::new).collect();
        let unasked = figures("2026-01-01", &campaign(), &none).out_of_reach;
        assert_eq!(unasked.values().sum::<usize>(), campaign().cells().len());
        assert_eq!(unasked["deleted linear drive-lag"], 1, "{unasked:?}");
    }
}
