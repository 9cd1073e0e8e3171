//! Figures over many cells, and the goals that they stand beside.
//!
//! Every share is of the cells in which the plant could show the wanted size. Detected: any answer but `none`. First name: the first
//! cause of a named or ambiguous answer. Group: causes and what is said to fit as well. Wrong: causes are named, and the hidden
//! effect is neither in the group nor equivalent to a cause.

use super::cell::{Arm, Campaign};
use super::changed::CHANGES;
use super::compare::Outcome;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Shares over cells with one hidden effect.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shares {
    /// Cells.
    pub cells: usize,
    /// Share with any answer but `none`.
    pub detected: f64,
    /// Share whose first cause is right.
    pub first: f64,
    /// Share with the truth in the group.
    pub in_group: f64,
    /// Mean size of the groups that are not empty.
    pub group: f64,
    /// Share `unknown`.
    pub unknown: f64,
    /// Share with a cause that is equivalent under another name.
    pub equivalent: f64,
    /// Share with a wrong name.
    pub wrong: f64,
}

/// A count and the shares of what was asked.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Cells.
    pub cells: usize,
    /// Share of them.
    pub share: f64,
}

/// The figures of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Day of the run.
    pub date: String,
    /// Which cells were asked for.
    pub campaign: Option<Campaign>,
    /// Cells that ran, by plant.
    pub ran: BTreeMap<String, usize>,
    /// Cells whose plant could not show the wanted size, by effect.
    pub out_of_reach: BTreeMap<String, usize>,
    /// Clean logs: share with any answer but `none`, by plant.
    pub false_alarms: BTreeMap<String, Share>,
    /// Clean logs: share with a named cause.
    pub false_names: Share,
    /// Single effects by size.
    pub by_size: BTreeMap<String, Shares>,
    /// Single effects of size .5 and more, by plant and effect.
    pub by_effect: BTreeMap<String, Shares>,
    /// First names at sizes of .5 and more, by hidden effect.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Deleted causes.
    pub deleted: Shares,
    /// Two effects: both in the group; a third named.
    pub both: Share,
    /// Two effects: share with a third cause.
    pub third: Share,
    /// Inseparable pairs: both named.
    pub pair_named: Share,
    /// Inseparable pairs that were named: settled by the proposed experiment.
    pub pair_settled: Share,
    /// Changed questions: same answer, by change.
    pub changed: BTreeMap<String, Share>,
    /// Two sessions: median ratio of interval widths.
    pub shrink: Option<f64>,
    /// Stated probability against hit rate by bin: cells, mean stated, hit.
    pub calibration: Vec<(usize, f64, f64)>,
    /// Expected calibration error.
    pub calibration_error: Option<f64>,
    /// Share of 95 % intervals that hold the truth.
    pub covered: Share,
    /// Median relative parameter error at size 1.
    pub parameter_error: Option<f64>,
    /// Median of realised over predicted held-out gain, less 1, without sign.
    pub gain_error: Option<f64>,
    /// Share of cells with a realised gain within 20 % of the predicted.
    pub gain_within: Share,
    /// Longest and median wall time of the engine in s.
    pub engine_s: (f64, f64),
}

fn share(cells: &[&Outcome], hit: impl Fn(&Outcome) -> bool) -> Share {
    let hits = cells.iter().filter(|o| hit(o)).count();
    Share { cells: cells.len(), share: hits as f64 / cells.len().max(1) as f64 }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

fn shares(cells: &[&Outcome]) -> Shares {
    let of = |hit: &dyn Fn(&Outcome) -> bool| share(cells, hit).share;
    let groups: Vec<usize> = cells.iter().map(|o| o.group()).filter(|g| *g > 0).collect();
    Shares {
        cells: cells.len(),
        detected: of(&Outcome::detected),
        first: of(&|o| o.first),
        in_group: of(&|o| o.in_group > 0),
        group: groups.iter().sum::<usize>() as f64 / groups.len().max(1) as f64,
        unknown: of(&|o| o.verdict == "unknown"),
        equivalent: of(&|o| o.equivalent),
        wrong: of(&Outcome::wrong),
    }
}

fn groups<'a, K: Ord>(cells: &[&'a Outcome], key: impl Fn(&Outcome) -> K) -> BTreeMap<K, Vec<&'a Outcome>> {
    let mut out: BTreeMap<K, Vec<&Outcome>> = BTreeMap::new();
    for cell in cells {
        out.entry(key(cell)).or_default().push(cell);
    }
    out
}

fn size(outcome: &Outcome) -> f64 {
    outcome.cell.sizes.first().copied().unwrap_or_default()
}

fn effect(outcome: &Outcome) -> String {
    outcome.cell.effects.first().cloned().unwrap_or_default()
}

/// The figures over outcomes.
pub fn figures(date: &str, campaign: &Campaign, outcomes: &[Outcome]) -> Figures {
    let shown: Vec<&Outcome> = outcomes.iter().filter(|o| o.shown()).collect();
    let arm = |arm: Arm| -> Vec<&Outcome> { shown.iter().filter(|o| o.cell.arm == arm).copied().collect() };
    let (single, two, pair) = (arm(Arm::Single), arm(Arm::Two), arm(Arm::Pair));
    let clean = arm(Arm::Clean);
    let clear: Vec<&Outcome> = single.iter().filter(|o| size(o) >= 0.5).copied().collect();
    let (calibration, calibration_error) = calibration(&single);
    let covered: Vec<&Outcome> = single.iter().filter(|o| o.covered.is_some()).copied().collect();
    let gains: Vec<&Outcome> =
        clear.iter().filter(|o| o.realised.is_some() && o.predicted.is_some()).copied().collect();
    let gain = |o: &Outcome| (o.realised.unwrap_or(0.0) / o.predicted.unwrap_or(1.0) - 1.0).abs();
    let named: Vec<&Outcome> = pair.iter().filter(|o| o.in_group == 2).copied().collect();
    let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for outcome in &clear {
        let first = outcome.causes.first().map_or(outcome.verdict.as_str(), |c| &c.effect);
        *confusion.entry(effect(outcome)).or_default().entry(first.into()).or_default() += 1;
    }
    let mut out_of_reach = BTreeMap::new();
    for outcome in outcomes.iter().filter(|o| !o.shown() && o.cell.arm == Arm::Single) {
        *out_of_reach.entry(format!("{} {}", outcome.cell.plant.name(), effect(outcome))).or_default() += 1;
    }
    let mut times: Vec<f64> = shown.iter().map(|o| o.engine_s).collect();
    times.sort_by(f64::total_cmp);
    Figures {
        date: date.into(),
        campaign: Some(campaign.clone()),
        ran: groups(&shown, |o| o.cell.plant.name().to_owned())
            .into_iter()
            .map(|(k, v)| (k, v.len()))
            .collect(),
        out_of_reach,
        false_alarms: groups(&clean, |o| o.cell.plant.name().to_owned())
            .into_iter()
            .map(|(k, v)| (k, share(&v, Outcome::detected)))
            .collect(),
        false_names: share(&clean, |o| !o.causes.is_empty()),
        by_size: groups(&single, |o| format!("{}", size(o)))
            .iter()
            .map(|(k, v)| (k.clone(), shares(v)))
            .collect(),
        by_effect: groups(&clear, |o| format!("{} {}", o.cell.plant.name(), effect(o)))
            .iter()
            .map(|(k, v)| (k.clone(), shares(v)))
            .collect(),
        confusion,
        deleted: shares(&arm(Arm::Deleted)),
        both: share(&two, |o| o.in_group == 2),
        third: share(&two, |o| o.causes.len() > 2),
        pair_named: share(&pair, |o| o.in_group == 2),
        pair_settled: share(&named, |o| o.settled == Some(true)),
        changed: groups(&arm(Arm::Changed), |o| CHANGES.get(o.cell.variant).copied().unwrap_or_default())
            .into_iter()
            .map(|(k, v)| (k.to_owned(), share(&v, |o| o.settled == Some(true))))
            .collect(),
        shrink: median(
            arm(Arm::Changed)
                .iter()
                .filter(|o| CHANGES.get(o.cell.variant) == Some(&"more"))
                .filter_map(|o| o.ratio)
                .collect(),
        ),
        calibration,
        calibration_error,
        covered: share(&covered, |o| o.covered == Some(true)),
        parameter_error: median(
            single.iter().filter(|o| size(o) == 1.0).filter_map(|o| o.parameter_error).collect(),
        ),
        gain_error: median(gains.iter().map(|o| gain(o)).collect()),
        gain_within: share(&gains, |o| gain(o) <= 0.2),
        engine_s: (times.last().copied().unwrap_or_default(), median(times).unwrap_or_default()),
    }
}

/// Bins of stated probability of the first cause against how often it is right (or equivalent).
fn calibration(cells: &[&Outcome]) -> (Vec<(usize, f64, f64)>, Option<f64>) {
    let edges = [0.0, 0.5, 0.7, 0.9, 0.99, f64::INFINITY];
    let stated: Vec<(f64, bool)> =
        cells.iter().filter_map(|o| Some((o.causes.first()?.probability, o.first || o.equivalent))).collect();
    let mut bins = Vec::new();
    let mut error = 0.0;
    for pair in edges.windows(2) {
        let (&[low, high], count) = (pair, 0.0) else { continue };
        let inside = stated.iter().filter(|(p, _)| (low..high).contains(p));
        let (n, p, hit) = inside
            .fold((count, 0.0, 0.0), |(n, p, hit), (q, h)| (n + 1.0, p + q, hit + f64::from(u8::from(*h))));
        if n > 0.0 {
            bins.push((n as usize, p / n, hit / n));
            error += (p - hit).abs() / stated.len() as f64;
        }
    }
    let error = (!bins.is_empty()).then_some(error);
    (bins, error)
}

/// One goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// What.
    pub name: &'static str,
    /// What is wanted, both ends included.
    pub wanted: (f64, f64),
    /// What was found, if it was asked.
    pub found: Option<f64>,
}

impl Goal {
    /// How far the finding is outside of what is wanted.
    pub fn missed_by(&self) -> Option<f64> {
        let (least, most) = self.wanted;
        self.found.map(|v| (least - v).max(v - most).max(0.0))
    }
}

impl Figures {
    /// The goals with what was found.
    pub fn goals(&self) -> Vec<Goal> {
        let at = |size: &str, read: fn(&Shares) -> f64| self.by_size.get(size).map(read);
        let (hits, clean) = self
            .false_alarms
            .values()
            .fold((0.0, 0.0), |(hits, n), s| (hits + s.share * s.cells as f64, n + s.cells as f64));
        let of = |s: &Share| (s.cells > 0).then_some(s.share);
        let deleted = |v: f64| (self.deleted.cells > 0).then_some(v);
        let known = self.deleted.unknown + self.deleted.equivalent;
        let most = |name, most: f64, found| Goal { name, wanted: (0.0, most), found };
        let least = |name, least: f64, found| Goal { name, wanted: (least, 1.0), found };
        vec![
            most("false alarms", 0.01, (clean > 0.0).then(|| hits / clean)),
            least("detected at size .5", 0.97, at("0.5", |s| s.detected)),
            least("first name at size .5", 0.90, at("0.5", |s| s.first)),
            least("first name at size 1", 0.97, at("1", |s| s.first)),
            least("truth in the group at size 1", 0.97, at("1", |s| s.in_group)),
            most("mean group size at size 1", 2.0, at("1", |s| s.group)),
            least("deleted cause unknown or equivalent", 0.90, deleted(known)),
            most("deleted cause wrongly named", 0.05, deleted(self.deleted.wrong)),
            least("two effects, both in the group", 0.85, of(&self.both)),
            least("inseparable pair, both named", 0.95, of(&self.pair_named)),
            least("pair settled by the proposed experiment", 0.90, of(&self.pair_settled)),
            most("parameter error at size 1, median", 0.10, self.parameter_error),
            most("calibration error", 0.05, self.calibration_error),
            Goal {
                name: "95 % intervals that hold the truth",
                wanted: (0.92, 0.98),
                found: of(&self.covered),
            },
            most("realised against predicted gain, median difference", 0.20, self.gain_error),
            most("longest wall time of the engine, s", 60.0, Some(self.engine_s.0)),
        ]
    }

    /// Goals that are missed by more than they were in `golden`, and changes of what was asked; wall times are left out.
    pub fn worse_than(&self, golden: &Self) -> Vec<String> {
        let mut worse = Vec::new();
        if self.ran != golden.ran {
            worse.push(format!("cells that ran: found {:?}, expected {:?}", self.ran, golden.ran));
        }
        for (found, before) in self.goals().iter().zip(golden.goals()) {
            let allowed = before.missed_by().map_or(0.0, |m| m + 1e-9);
            if !found.name.contains("wall time") && found.missed_by().is_some_and(|m| m > allowed) {
                worse.push(format!("{}: found {:?}, golden {:?}", found.name, found.found, before.found));
            }
        }
        let kept = |f: &Self| f.changed.values().map(|s| s.share * s.cells as f64).sum::<f64>();
        if kept(self) < kept(golden) - 1e-9 {
            worse.push(format!("changed questions: found {:?}, golden {:?}", self.changed, golden.changed));
        }
        worse
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::session::Plant;

    fn campaign() -> Campaign {
        Campaign {
            seeds: 1,
            bench_seeds: 0,
            plants: vec![Plant::Linear],
            sizes: vec![0.5],
            arms: vec![Arm::Clean, Arm::Single, Arm::Deleted],
        }
    }

    /// Outcomes in which the first `hits` of every arm's cells have the answer that is wanted.
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
        assert_eq!((singles.cells, singles.detected), (19, 1.0));
        assert!((singles.first - 8.0 / 19.0).abs() < 1e-12);
        assert_eq!(found.deleted.unknown, 1.0);
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
}
