//! Repeatable part of a channel's residual: the part that is the same in every cycle is model
//! error, the remainder is noise.
//!
//! Residuals of complete cycles are brought to one grid of phases, with one point per sample of a
//! cycle. A sample between two points moves to the nearest one along the slope of the mean cycle.
//!
//! The variance of the noise is half the variance of the difference between two neighbouring cycles
//! (pure error). A step disturbs the two pairs of its cycle, and lost samples disturb others, so
//! the lower quartile over all pairs counts. The repeatable part is the power of the mean cycle,
//! less the power that noise leaves in a mean.
//!
//! Limits: a disturbance that does not follow the motion, such as a ripple over time, counts as
//! noise. Noise that is locked to the cycle counts as model error.

use super::logs::{Columns, Data, Log};
use super::split::Use;
use super::tuning;
use crate::statistics::{lower_quartile, square_deviations};
use bench::Channel;
use bench::statistics::mean;

/// Noise and repeatable part of a channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Repeatability {
    /// Complete cycles compared, over all logs.
    pub(crate) cycles: usize,
    /// Standard deviation of the noise.
    pub(crate) deviation: f64,
    /// Share of the residual's power that is repeatable, 0 to 1.
    pub(crate) repeatable_share: f64,
}

/// Noise and repeatable part of a channel's residual; `None` if no log has enough cycles.
pub(crate) fn repeatability(data: &Data, residual: &Columns, channel: Channel) -> Option<Repeatability> {
    let (mut cycles, mut variances, mut repeating, mut total) = (0, Vec::new(), 0.0, 0.0);
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let Some(rows) = data.logs.get(block.log).and_then(|log| cycle_rows(log, values)) else { continue };
        cycles += rows.len();
        variances.extend(rows.windows(2).filter_map(|pair| match pair {
            [one, next] => pure_error(one, next),
            _ => None,
        }));
        for point in 0..rows.first().map_or(0, Vec::len) {
            let column: Vec<f64> = rows.iter().filter_map(|c| c.get(point).copied().flatten()).collect();
            let n = column.len() as f64;
            if n < 2.0 {
                continue;
            }
            let mean = mean(&column);
            repeating += mean * mean - square_deviations(&column, mean) / (n * (n - 1.0));
            total += column.iter().map(|v| v * v).sum::<f64>() / n;
        }
    }
    let variance = lower_quartile(variances)?;
    let repeatable_share = if total > 0.0 { (repeating / total).clamp(0.0, 1.0) } else { 0.0 };
    Some(Repeatability { cycles, deviation: variance.sqrt(), repeatable_share })
}

/// Values on the grid of phases, one row per complete cycle; `None` with too few cycles or points.
fn cycle_rows(log: &Log, values: &[f64]) -> Option<Vec<Vec<Option<f64>>>> {
    let phase = log.phase.as_ref()?;
    let used: Vec<(f64, f64)> = phase
        .iter()
        .zip(values)
        .zip(&log.uses)
        .filter(|(_, u)| **u != Use::Skip)
        .map(|((p, v), _)| (*p, *v))
        .collect();
    let (first, last) = (used.first()?.0, used.last()?.0);
    let points = (used.len() as f64 / (last - first).max(f64::MIN_POSITIVE)).round() as usize;
    // A cycle is complete even if its last sample is one short of the next crossing.
    let slack = 1.0 / points.max(1) as f64;
    let (from, to) = ((first - slack).ceil() as i64, (last + slack).floor() as i64);
    if points < tuning::MIN_POINTS_PER_CYCLE || to - from < tuning::MIN_CYCLES {
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
            // The value with its distance from the point, in points.
            *cell = Some((value, place - nearest));
        }
    }
    let mean_cycle: Vec<Option<f64>> = (0..points)
        .map(|k| {
            let column: Vec<f64> =
                rows.iter().filter_map(|r| r.get(k).copied().flatten()).map(|c| c.0).collect();
            (!column.is_empty()).then(|| mean(&column))
        })
        .collect();
    let at = |k: usize| mean_cycle.get(k % points).copied().flatten();
    let slope = |k: usize| Some(0.5 * (at(k + 1)? - at(k + points - 1)?));
    let on_grid = |(k, cell): (usize, &Option<(f64, f64)>)| {
        cell.map(|(value, distance)| value - distance * slope(k).unwrap_or_default())
    };
    Some(rows.iter().map(|r| r.iter().enumerate().map(on_grid).collect()).collect())
}

/// Variance of the noise from two cycles; `None` if they have too few points in common.
fn pure_error(one: &[Option<f64>], next: &[Option<f64>]) -> Option<f64> {
    let differences: Vec<f64> = one.iter().zip(next).filter_map(|(a, b)| Some((*a)? - (*b)?)).collect();
    let n = differences.len() as f64;
    if n < tuning::MIN_COMMON_SHARE * one.len() as f64 || n < 2.0 {
        return None;
    }
    let mean = mean(&differences);
    Some(0.5 * square_deviations(&differences, mean) / (n - 1.0))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
mod tests {
    use super::*;
    use crate::data::split::Split;
    use bench::simulate::{record, respond};
    use bench::{Bench, MeasuredLog};

    /// Residual of a rig over 5 cycles of 2 s, with a repeatable torque, a `change` over time and
    /// noise of 2 N m.
    fn residual(repeating: f64, change: impl Fn(f64) -> f64) -> (Data, Columns) {
        let mut bench = Bench::open("friction-rig").unwrap();
        if let Some(rig) = bench.axis_mut() {
            // The number of samples in a cycle is not an integer.
            (rig.axis.period_s, rig.axis.cycles) = (2.0037, 5);
        }
        let mut log: MeasuredLog = record(&bench, 3).unwrap();
        let times = log.time_s.clone();
        let torque = log.channels.get_mut(&Channel::DriveTorque).unwrap();
        for (t, v) in times.iter().zip(torque) {
            *v += repeating * (3.0 * std::f64::consts::TAU * t / 2.0037).sin() + change(*t);
        }
        let data = Data::new(&bench, &[log], &[], Split::Halves).unwrap();
        let residual = residual_of(&data, &bench);
        (data, residual)
    }

    /// Residual of the described bench, without a fit.
    fn residual_of(data: &Data, bench: &Bench) -> Columns {
        let responses: Vec<_> = data.logs.iter().map(|log| respond(bench, &log.inputs).unwrap()).collect();
        data.residual(&data.columns(&responses))
    }

    fn torque(repeating: f64, change: impl Fn(f64) -> f64) -> Repeatability {
        let (data, residual) = residual(repeating, change);
        repeatability(&data, &residual, Channel::DriveTorque).unwrap()
    }

    #[test]
    fn the_repeatable_share_is_the_power_of_the_model_error() {
        let clean = torque(0.0, |_| 0.0);
        assert!((clean.deviation / 2.0 - 1.0).abs() < 0.1, "{clean:?}");
        assert!(clean.repeatable_share < 0.1 && clean.cycles >= 4, "{clean:?}");
        let wrong = torque(20.0, |_| 0.0);
        assert!((wrong.deviation / 2.0 - 1.0).abs() < 0.1, "{wrong:?}");
        // 200 of 204 N^2 m^2.
        assert!((wrong.repeatable_share - 200.0 / 204.0).abs() < 0.01, "{wrong:?}");
    }

    #[test]
    fn a_step_and_a_drift_do_not_count_as_noise() {
        let stepped = torque(0.0, |t| if t > 4.7 { 30.0 } else { 0.0 });
        assert!((stepped.deviation / 2.0 - 1.0).abs() < 0.1, "{stepped:?}");
        let drifting = torque(0.0, |t| 5.0 * t);
        assert!((drifting.deviation / 2.0 - 1.0).abs() < 0.1, "{drifting:?}");
    }

    #[test]
    fn two_cycles_have_no_repeatable_part() {
        let mut bench = Bench::open("friction-rig").unwrap();
        bench.set_cycles(2);
        let log = record(&bench, 3).unwrap();
        let data = Data::new(&bench, &[log], &[], Split::Halves).unwrap();
        assert!(repeatability(&data, &residual_of(&data, &bench), Channel::DriveTorque).is_none());
    }
}
