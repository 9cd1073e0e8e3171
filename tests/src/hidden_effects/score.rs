//! Figures of a campaign; [`super::goals`] has their goals.
//!
//! Every share is relative to the cells in which the plant can show the requested size. Detected:
//! any answer but `none`. First name: the first cause of a named or ambiguous answer. Group: the
//! causes and the effects that fit equally well. Wrong: causes are named, and the hidden effect is
//! neither in the group nor equivalent to a cause.

use super::cell::{Arm, CHANGES, Campaign};
use super::compare::Outcome;
use serde::{Deserialize, Serialize};
use statrs::statistics::{Data, OrderStatistics};
use std::collections::BTreeMap;

/// Shares over cells with one hidden effect.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shares {
    /// Number of cells.
    pub cells: usize,
    /// Share with any answer but `none`.
    pub detected: f64,
    /// Share whose first cause is right.
    pub first: f64,
    /// Share with the truth in the group.
    pub in_group: f64,
    /// Mean size of the groups that are not empty.
    pub group: f64,
    /// Share `unknown` or `partial`.
    pub unknown: f64,
    /// Share with a cause that is equivalent under another name.
    pub equivalent: f64,
    /// Share with a wrong name.
    pub wrong: f64,
}

/// A share of cells.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Number of cells.
    pub cells: usize,
    /// Share of the cells.
    pub share: f64,
}

/// Figures of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Date of the run.
    pub date: String,
    /// Remarks about the run.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Cells that were asked for.
    pub campaign: Option<Campaign>,
    /// Cells that ran, by plant.
    pub ran: BTreeMap<String, usize>,
    /// Cells that were not asked, by arm, plant and effects: the plant cannot show the requested
    /// size, or a pair does not look alike.
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
    /// Causes in partial answers of all arms: share that is hidden or equivalent.
    #[serde(default)]
    pub partial_names: Share,
    /// Two effects: both in the group.
    pub both: Share,
    /// Two effects: share with a third cause.
    pub third: Share,
    /// Inseparable pairs: both named.
    pub pair_named: Share,
    /// Inseparable pairs that were named: settled by the proposed experiment.
    pub pair_settled: Share,
    /// Inseparable pairs that were named: the answer says that no experiment of the menu separates
    /// them.
    #[serde(default)]
    pub pair_hopeless: Share,
    /// Hard conditions, clean logs: any answer but `none`.
    #[serde(default)]
    pub hard_false_alarms: Share,
    /// Hard conditions, clean logs: a cause named.
    #[serde(default)]
    pub hard_false_names: Share,
    /// Hard conditions, single effects of size 1.
    #[serde(default)]
    pub hard: Shares,
    /// Changed questions: same answer, by change.
    pub changed: BTreeMap<String, Share>,
    /// Two records: median ratio of interval widths.
    pub shrink: Option<f64>,
    /// Bins of the stated probability of the first cause over single effects: cells, mean, hit
    /// rate.
    pub calibration: Vec<(usize, f64, f64)>,
    /// Expected calibration error over single effects.
    pub calibration_error: Option<f64>,
    /// The same bins over the cells of all arms, including those in which any cause is wrong.
    #[serde(default)]
    pub calibration_of_all: Vec<(usize, f64, f64)>,
    /// Expected calibration error over all arms.
    #[serde(default)]
    pub calibration_error_of_all: Option<f64>,
    /// Share of 95 % intervals that contain the truth, if the first cause is right.
    pub covered: Share,
    /// Median relative parameter error at size 1, if the first cause is right.
    pub parameter_error: Option<f64>,
    /// Number of cells of that error.
    #[serde(default)]
    pub parameter_cells: usize,
    /// Median of |measured / predicted gain - 1| over all cells with a cause at sizes of .5 and
    /// more.
    pub gain_error: Option<f64>,
    /// Share of those cells with a measured gain within 20 % of the predicted one.
    pub gain_within: Share,
    /// Longest and median wall time of the engine in s.
    pub engine_s: (f64, f64),
}

impl Figures {
    /// Deleted causes for which a cause is named: share with a wrong name.
    pub(crate) fn wrong_among_named(&self) -> Share {
        let count = |share: f64| (share * self.deleted.cells as f64).round();
        let (wrong, equivalent) = (count(self.deleted.wrong), count(self.deleted.equivalent));
        let named = wrong + equivalent;
        Share { cells: named as usize, share: wrong / named.max(1.0) }
    }
}

fn share(cells: &[&Outcome], hit: impl Fn(&Outcome) -> bool) -> Share {
    let hits = cells.iter().filter(|o| hit(o)).count();
    Share { cells: cells.len(), share: hits as f64 / cells.len().max(1) as f64 }
}

fn median(values: Vec<f64>) -> Option<f64> {
    (!values.is_empty()).then(|| Data::new(values).median())
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
        unknown: of(&Outcome::unknown),
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

/// Counts the first names by hidden effect.
fn confusion(cells: &[&Outcome]) -> BTreeMap<String, BTreeMap<String, usize>> {
    let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for outcome in cells {
        let first = outcome.causes.first().map_or(outcome.verdict.as_str(), |c| &c.effect);
        *confusion.entry(effect(outcome)).or_default().entry(first.into()).or_default() += 1;
    }
    confusion
}

/// Counts the cells that were not asked, by arm, plant and effects.
fn out_of_reach(outcomes: &[Outcome]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for cell in outcomes.iter().filter(|o| !o.shown()).map(|o| &o.cell) {
        let name = format!("{:?} {} {}", cell.arm, cell.plant.name(), cell.effects.join(" + "));
        *counts.entry(name.to_lowercase()).or_default() += 1;
    }
    counts
}

/// Computes the figures of outcomes.
pub fn figures(date: &str, campaign: &Campaign, outcomes: &[Outcome]) -> Figures {
    let shown: Vec<&Outcome> = outcomes.iter().filter(|o| o.shown()).collect();
    let arm = |arm: Arm| -> Vec<&Outcome> { shown.iter().filter(|o| o.cell.arm == arm).copied().collect() };
    let (single, two, pair) = (arm(Arm::Single), arm(Arm::Two), arm(Arm::Pair));
    let clean = arm(Arm::Clean);
    let (hard_clean, hard): (Vec<&Outcome>, _) =
        arm(Arm::Hard).into_iter().partition(|o| o.cell.effects.is_empty());
    let clear: Vec<&Outcome> = single.iter().filter(|o| size(o) >= 0.5).copied().collect();
    let (calibration_of_all, calibration_error_of_all) = calibration(&shown);
    let (calibration, calibration_error) = calibration(&single);
    let covered: Vec<&Outcome> = single.iter().filter(|o| o.covered.is_some()).copied().collect();
    let gains: Vec<&Outcome> =
        clear.iter().filter(|o| o.realised.is_some() && o.predicted.is_some()).copied().collect();
    let gain = |o: &Outcome| (o.realised.unwrap_or(0.0) / o.predicted.unwrap_or(1.0) - 1.0).abs();
    let parameter_errors: Vec<f64> =
        single.iter().filter(|o| size(o) == 1.0).filter_map(|o| o.parameter_error).collect();
    let named: Vec<&Outcome> = pair.iter().filter(|o| o.in_group == 2).copied().collect();
    let hopeless = |o: &Outcome| o.hopeless;
    let mut times: Vec<f64> = shown.iter().map(|o| o.engine_s).collect();
    times.sort_by(f64::total_cmp);
    Figures {
        date: date.into(),
        notes: Vec::new(),
        campaign: Some(campaign.clone()),
        ran: groups(&shown, |o| o.cell.plant.name().to_owned())
            .into_iter()
            .map(|(k, v)| (k, v.len()))
            .collect(),
        out_of_reach: out_of_reach(outcomes),
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
        confusion: confusion(&clear),
        deleted: shares(&arm(Arm::Deleted)),
        partial_names: partial_names(&shown),
        both: share(&two, |o| o.in_group == 2),
        third: share(&two, |o| o.causes.len() > 2),
        pair_named: share(&pair, |o| o.in_group == 2),
        pair_settled: share(&named, |o| o.settled == Some(true)),
        pair_hopeless: share(&named, hopeless),
        hard_false_alarms: share(&hard_clean, Outcome::detected),
        hard_false_names: share(&hard_clean, |o| !o.causes.is_empty()),
        hard: shares(&hard),
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
        calibration_of_all,
        calibration_error_of_all,
        covered: share(&covered, |o| o.covered == Some(true)),
        parameter_cells: parameter_errors.len(),
        parameter_error: median(parameter_errors),
        gain_error: median(gains.iter().map(|o| gain(o)).collect()),
        gain_within: share(&gains, |o| gain(o) <= 0.2),
        engine_s: (times.last().copied().unwrap_or_default(), median(times).unwrap_or_default()),
    }
}

/// Counts the causes in partial answers, and the share that is right.
fn partial_names(cells: &[&Outcome]) -> Share {
    let count = |read: fn(&Outcome) -> usize| cells.iter().map(|o| read(o)).sum::<usize>();
    let (names, right) = (count(|o| o.partial_names), count(|o| o.partial_right));
    Share { cells: names, share: right as f64 / names.max(1) as f64 }
}

/// Returns bins of the stated probability of the first cause with the rate at which it is right.
fn calibration(cells: &[&Outcome]) -> (Vec<(usize, f64, f64)>, Option<f64>) {
    let edges = [0.0, 0.5, 0.7, 0.9, 0.99, f64::INFINITY];
    let stated: Vec<(f64, bool)> =
        cells.iter().filter_map(|o| Some((o.causes.first()?.probability, o.right()))).collect();
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
