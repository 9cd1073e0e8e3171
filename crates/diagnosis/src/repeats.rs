//! What repeated cycles say of a channel: noise is what does not repeat, model error is what does.
//!
//! Residuals of whole cycles are laid on one grid of phases, a point for every sample of a cycle; a sample beside its point is
//! moved there along the slope of the mean cycle. Half the mean square of the difference of neighbouring cycles, less its
//! mean, is the variance of pure error; the lower quartile over the pairs of cycles keeps out of it a step, which spoils the two
//! pairs that its cycle is in, or a lost stretch. The power of the mean cycle, less what pure error leaves in a mean, is what repeats.
//!
//! Limits: a disturbance that does not follow the motion (a ripple over time) counts as noise here, and noise that is locked
//! to the cycle counts as model error.

use crate::session::{Columns, Data, Session, Use};
use bench::Channel;

/// Cycles of a log from which repeats say anything.
const LEAST_CYCLES: i64 = 3;
/// Points of a cycle below which a residual has no shape.
const LEAST_POINTS: usize = 8;
/// Share of the points of a cycle that two cycles have to have in common.
const LEAST_SHARE: f64 = 0.5;

/// What repeated cycles say of a channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Repeats {
    /// Whole cycles compared, over all logs.
    pub(crate) cycles: usize,
    /// Standard deviation of what does not repeat.
    pub(crate) deviation: f64,
    /// Share of the residual's power that repeats, 0 to 1.
    pub(crate) repeatable_share: f64,
}

/// What the logs with enough cycles say of a channel's residual; `None` where there is none.
pub(crate) fn repeats(data: &Data, residual: &Columns, channel: Channel) -> Option<Repeats> {
    let (mut cycles, mut variances, mut repeating, mut total) = (0, Vec::new(), 0.0, 0.0);
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let Some(table) = data.sessions.get(block.session).and_then(|s| table(s, values)) else { continue };
        cycles += table.len();
        variances.extend(table.windows(2).filter_map(|pair| match pair {
            [one, next] => pure_error(one, next),
            _ => None,
        }));
        for point in 0..table.first().map_or(0, Vec::len) {
            let column: Vec<f64> = table.iter().filter_map(|c| c.get(point).copied().flatten()).collect();
            let n = column.len() as f64;
            if n < 2.0 {
                continue;
            }
            let mean = column.iter().sum::<f64>() / n;
            let scatter: f64 = column.iter().map(|v| (v - mean).powi(2)).sum();
            repeating += mean * mean - scatter / (n * (n - 1.0));
            total += column.iter().map(|v| v * v).sum::<f64>() / n;
        }
    }
    variances.sort_by(f64::total_cmp);
    let variance = *variances.get(variances.len().checked_sub(1)? / 4)?;
    let repeatable_share = if total > 0.0 { (repeating / total).clamp(0.0, 1.0) } else { 0.0 };
    Some(Repeats { cycles, deviation: variance.sqrt(), repeatable_share })
}

/// Values on the grid of phases, one row a whole cycle.
fn table(session: &Session, values: &[f64]) -> Option<Vec<Vec<Option<f64>>>> {
    let phase = session.phase.as_ref()?;
    let used: Vec<(f64, f64)> = phase
        .iter()
        .zip(values)
        .zip(&session.uses)
        .filter(|(_, u)| **u != Use::Skip)
        .map(|((p, v), _)| (*p, *v))
        .collect();
    let (first, last) = (used.first()?.0, used.last()?.0);
    let points = (used.len() as f64 / (last - first).max(f64::MIN_POSITIVE)).round() as usize;
    // A cycle whose last sample is one short of the next crossing is whole.
    let slack = 1.0 / points.max(1) as f64;
    let (from, to) = ((first - slack).ceil() as i64, (last + slack).floor() as i64);
    if points < LEAST_POINTS || to - from < LEAST_CYCLES {
        return None;
    }
    let mut rows = vec![vec![None; points]; (to - from) as usize];
    for (phase, value) in used {
        let place = phase * points as f64;
        let nearest = place.round();
        let (cycle, point) =
            ((nearest as i64).div_euclid(points as i64), (nearest as i64).rem_euclid(points as i64));
        let row = usize::try_from(cycle - from).ok().and_then(|c| rows.get_mut(c));
        if let Some(cell) = row.and_then(|r| r.get_mut(point as usize)) {
            *cell = Some((value, place - nearest));
        }
    }
    let mean: Vec<Option<f64>> = (0..points)
        .map(|k| {
            let column: Vec<f64> =
                rows.iter().filter_map(|r| r.get(k).copied().flatten()).map(|c| c.0).collect();
            (!column.is_empty()).then(|| column.iter().sum::<f64>() / column.len() as f64)
        })
        .collect();
    let at = |k: usize| mean.get(k % points).copied().flatten();
    let slope = |k: usize| Some(0.5 * (at(k + 1)? - at(k + points - 1)?));
    let moved = |(k, cell): (usize, &Option<(f64, f64)>)| {
        cell.map(|(value, beside)| value - beside * slope(k).unwrap_or_default())
    };
    Some(rows.iter().map(|r| r.iter().enumerate().map(moved).collect()).collect())
}

/// Variance of pure error from two cycles.
fn pure_error(one: &[Option<f64>], next: &[Option<f64>]) -> Option<f64> {
    let differences: Vec<f64> = one.iter().zip(next).filter_map(|(a, b)| Some((*a)? - (*b)?)).collect();
    let n = differences.len() as f64;
    if n < LEAST_SHARE * one.len() as f64 || n < 2.0 {
        return None;
    }
    let mean = differences.iter().sum::<f64>() / n;
    Some(0.5 * differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
mod tests {
    use super::*;
    use crate::session::Split;
    use bench::{Bench, MeasuredLog, record};

    /// A rig of 5 cycles of 2 s with a torque that repeats beside its model, and noise of 2 N m.
    fn residual(repeating: f64, change: impl Fn(f64) -> f64) -> (Data, Columns) {
        let mut bench = Bench::open("friction-rig").unwrap();
        if let Bench::FrictionRig(rig) = &mut bench {
            // Not a whole number of samples a cycle.
            (rig.axis.period_s, rig.axis.cycles) = (2.0037, 5);
        }
        let mut log: MeasuredLog = record::record(&bench, 3).unwrap();
        let times = log.time_s.clone();
        let torque = log.channels.get_mut(&Channel::DriveTorque).unwrap();
        for (t, v) in times.iter().zip(torque) {
            *v += repeating * (3.0 * std::f64::consts::TAU * t / 2.0037).sin() + change(*t);
        }
        let data = Data::new(&bench, &[log], &[], Split::Halves).unwrap();
        let described = crate::fit::simulate(&data, &bench, None).unwrap();
        let residual = data.residual(&described.columns);
        (data, residual)
    }

    fn torque(repeating: f64, change: impl Fn(f64) -> f64) -> Repeats {
        let (data, residual) = residual(repeating, change);
        repeats(&data, &residual, Channel::DriveTorque).unwrap()
    }

    #[test]
    fn model_error_repeats_and_noise_does_not() {
        let clean = torque(0.0, |_| 0.0);
        assert!((clean.deviation / 2.0 - 1.0).abs() < 0.1, "{clean:?}");
        assert!(clean.repeatable_share < 0.1 && clean.cycles >= 4, "{clean:?}");
        let wrong = torque(20.0, |_| 0.0);
        assert!((wrong.deviation / 2.0 - 1.0).abs() < 0.1, "{wrong:?}");
        // 200 of 204 N2m2.
        assert!((wrong.repeatable_share - 200.0 / 204.0).abs() < 0.01, "{wrong:?}");
    }

    #[test]
    fn a_step_in_one_cycle_and_a_drift_are_no_noise() {
        let stepped = torque(0.0, |t| if t > 4.7 { 30.0 } else { 0.0 });
        assert!((stepped.deviation / 2.0 - 1.0).abs() < 0.1, "{stepped:?}");
        let drifting = torque(0.0, |t| 5.0 * t);
        assert!((drifting.deviation / 2.0 - 1.0).abs() < 0.1, "{drifting:?}");
    }

    #[test]
    fn two_cycles_say_nothing() {
        let mut bench = Bench::open("friction-rig").unwrap();
        bench.set_cycles(2);
        let log = record::record(&bench, 3).unwrap();
        let data = Data::new(&bench, &[log], &[], Split::Halves).unwrap();
        let described = crate::fit::simulate(&data, &bench, None).unwrap();
        assert!(repeats(&data, &data.residual(&described.columns), Channel::DriveTorque).is_none());
    }
}
