//! Choice of the column of each signal.

use super::names::{Meaning, MotionKind, Quantity, is_pressure, meaning};
use crate::log::{RawColumn, RawLog, TIME};
use crate::signals::Channel;

/// Interval between rows above which a clock without a unit is not taken for seconds.
const MAX_INTERVAL_S: f64 = 0.5;

/// A column with the meaning of its name.
pub(super) struct Candidate<'a> {
    pub(super) column: &'a RawColumn,
    pub(super) meaning: Meaning,
}

/// Returns the columns of a log with their meanings, of several lengths those of the longest.
pub(super) fn candidates(log: &RawLog) -> Vec<Candidate<'_>> {
    let rows = log.columns.iter().map(|column| column.values.len()).max();
    let columns = log.columns.iter().filter(|column| Some(column.values.len()) == rows);
    let mut all: Vec<Candidate<'_>> = columns.map(candidate).collect();
    let is_time =
        |c: &Candidate<'_>| c.meaning.own == Some(TIME) || c.meaning.quantity == Some(Quantity::Time);
    // Without names the first column that always rises is the time.
    if !all.iter().any(is_time)
        && let Some(time) =
            all.iter_mut().find(|c| c.column.name.is_empty() && is_ascending(&c.column.values))
    {
        time.meaning.quantity = Some(Quantity::Time);
    }
    all
}

/// A column with its meaning.
pub(super) fn candidate(column: &RawColumn) -> Candidate<'_> {
    Candidate { column, meaning: meaning(&named(column)) }
}

/// Name of a column with the unit of the line under it.
fn named(column: &RawColumn) -> String {
    let unit = column.unit.trim_matches(['[', ']', '(', ')']);
    if unit.is_empty() { column.name.clone() } else { format!("{} [{unit}]", column.name) }
}

fn is_ascending(values: &[f64]) -> bool {
    values.windows(2).all(|pair| matches!(pair, [a, b] if b > a))
}

/// A signal with its column.
#[derive(Clone, Debug)]
pub(super) struct Chosen<'a> {
    pub(super) column: &'a RawColumn,
    /// Factor to SI; none if the name has no known unit.
    pub(super) scale: Option<f64>,
    /// True if the column has the name of the signal.
    pub(super) is_own: bool,
}

impl Chosen<'_> {
    /// Smallest and largest value in SI.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        let ((min, max), scale) = (self.column.range()?, self.scale?);
        Some((scale * min, scale * max))
    }

    /// The same with a scale of 1 if the scale is not known.
    pub(super) fn or_unscaled(&self) -> Self {
        Self { scale: self.scale.or(Some(1.0)), ..self.clone() }
    }

    /// Finite values in SI, 0 where missing.
    pub(super) fn values(&self) -> Option<Vec<f64>> {
        let scale = self.scale?;
        let value = |v: &f64| if v.is_finite() { scale * v } else { 0.0 };
        Some(self.column.values.iter().map(value).collect())
    }
}

/// Chooses the column of a signal: that with its name, or the first of its quantity with a unit,
/// rather one whose name has a word for the quantity (of `delay [s]` and `time [s]` the second).
pub(super) fn choose<'a>(
    candidates: &[Candidate<'a>],
    name: &str,
    quantity: Option<Quantity>,
    kind: Option<MotionKind>,
) -> Option<Chosen<'a>> {
    let own = candidates.iter().find(|c| c.meaning.own == Some(name));
    if let Some(own) = own {
        return Some(Chosen { column: own.column, scale: Some(1.0), is_own: true });
    }
    let quantity = quantity?;
    let suits = |c: &&Candidate<'_>| {
        let is_other_kind = kind.is_some() && c.meaning.kind.is_some() && kind != c.meaning.kind;
        c.meaning.quantity == Some(quantity) && (quantity == Quantity::Load || !is_other_kind)
    };
    let mut fit = candidates.iter().filter(suits);
    let mut with_unit = fit.clone().filter(|c| c.meaning.scale.is_some());
    let named = with_unit.clone().find(|c| c.meaning.is_named);
    let first = named.or_else(|| with_unit.next()).or_else(|| fit.next())?;
    let mut scale = first.meaning.scale;
    if quantity == Quantity::Time && scale.is_none() && interval(&first.column.values) < MAX_INTERVAL_S {
        scale = Some(1.0);
    }
    Some(Chosen { column: first.column, scale, is_own: false })
}

/// Names of the first two pressures: those of a cylinder's chambers.
pub(super) fn chambers<'a>(candidates: &[Candidate<'a>]) -> Option<[&'a str; 2]> {
    let names = candidates.iter().map(|candidate| candidate.column.name.as_str());
    let mut pressures = names.filter(|name| is_pressure(name));
    Some([pressures.next()?, pressures.next()?])
}

/// Kind of the driven motion that the columns indicate.
pub(super) fn motion_kind(candidates: &[Candidate<'_>]) -> MotionKind {
    let own = |c: &Candidate<'_>| match c.meaning.own.and_then(Channel::from_name)? {
        Channel::SpindleAngle | Channel::SpindleSpeed | Channel::OrderedAngle | Channel::DriveTorque => {
            Some(MotionKind::Rotary)
        }
        Channel::Position | Channel::Velocity | Channel::OrderedPosition => Some(MotionKind::Linear),
        _ => None,
    };
    let kinds: Vec<MotionKind> = candidates.iter().filter_map(|c| own(c).or(c.meaning.kind)).collect();
    let rotary = kinds.iter().filter(|kind| **kind == MotionKind::Rotary).count();
    if 2 * rotary > kinds.len() { MotionKind::Rotary } else { MotionKind::Linear }
}

/// Median interval between rows, in the column's unit.
pub(super) fn interval(values: &[f64]) -> f64 {
    let mut steps: Vec<f64> =
        values.windows(2).filter_map(|pair| Some(pair.get(1)? - pair.first()?)).collect();
    steps.retain(|step| *step > 0.0);
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or_default()
}

/// Period of a motion from its upward crossings of the middle; `None` with fewer than two.
pub(super) fn period_s(time_s: &[f64], position: &[f64]) -> Option<f64> {
    let min = position.iter().copied().reduce(f64::min)?;
    let max = position.iter().copied().reduce(f64::max)?;
    let (middle, margin) = (0.5 * (min + max), 0.1 * (max - min));
    let (mut is_below, mut crossings) = (false, Vec::new());
    for (t, x) in time_s.iter().zip(position) {
        if *x < middle - margin {
            is_below = true;
        } else if is_below && *x > middle + margin {
            is_below = false;
            crossings.push(*t);
        }
    }
    let (first, last) = (crossings.first()?, crossings.last()?);
    (crossings.len() > 1).then(|| (last - first) / (crossings.len() - 1) as f64)
}
