//! Signals of which one is the derivative of another: `value = a + g integral(rate) + b t + c rate`.
//!
//! `g` is the ratio of their gains; `c/g` is how far the value runs ahead of the rate, in s; `b` takes an offset of the rate.
//! Integrating the rate, not differentiating the value, keeps the noise out. Across a gap of the log nobody knows the integral:
//! each stretch between gaps has its own `a`. Limit: a log whose rows come in bursts of a few has no relation.

use super::clock::GAP;
use super::factors;
use super::finding::{Finding, Severity};
use super::mend::scaled;
use super::statistics::{median, range};
use bench::{Bench, Channel, MeasuredLog};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Rms of what the relation leaves, in that of the value, from which on there is no relation.
const UNRELATED: f64 = 0.2;
/// Deviation of the ratio of gains from 1 that two good sensors do not reach.
const GAIN: f64 = 0.1;
/// Deviation of the ratio of gains that is worth a look.
const GAIN_DOUBTFUL: f64 = 0.03;
/// Tolerance on a factor that has a name.
const NAMED: f64 = 0.03;
/// Factor from the described stroke within which a stroke may be, and the one from which on its unit is looked at.
const STROKE: f64 = 4.0;
const UNLIKE_STROKE: f64 = 12.0;
/// Delay, in samples and in s, from which on two inputs contradict each other.
const DELAY_SAMPLES: f64 = 2.0;
const DELAY_S: f64 = 2e-3;
/// Singular values, smallest over largest, below which offset and gain cannot be told apart.
const LEAST_SINGULAR: f64 = 1e-3;
/// Rows of a stretch from which on it tells something.
const LEAST_STRETCH: usize = 32;
/// Sweeps of the singular values of a matrix of three; some ten are needed.
const MOST_SWEEPS: usize = 1000;

/// The driven motion of a log.
pub(super) struct Motion<'a> {
    pub(super) value: &'a [f64],
    rate: Option<&'a [f64]>,
}

/// Channels of the driven motion: value and rate.
fn drive(bench: &Bench) -> (Channel, Channel) {
    match bench {
        Bench::Transmission(_) => (Channel::DriveDisplacement, Channel::DriveVelocity),
        Bench::FrictionRig(rig) => (rig.channels().0, rig.channels().1),
    }
}

pub(super) fn motion_of<'a>(bench: &Bench, log: &'a MeasuredLog) -> Option<Motion<'a>> {
    let (value, rate) = drive(bench);
    let rate = log.channels.get(&rate).map(Vec::as_slice);
    Some(Motion { value: log.channels.get(&value)?, rate })
}

impl Motion<'_> {
    /// Ratio of the gains of value and rate, where they are related.
    pub(super) fn ratio(&self, time_s: &[f64]) -> Option<f64> {
        let fit = relation(time_s, self.value, self.rate?)?;
        (fit.left < UNRELATED).then_some(fit.ratio)
    }
}

/// How value and rate go together.
pub(super) struct Relation {
    ratio: f64,
    ahead_s: f64,
    /// Rms of what is left over that of the value.
    left: f64,
}

/// The log from gap to gap; `None` where less than half of its rows are in stretches worth the name.
fn stretches(time_s: &[f64]) -> Option<Vec<Range<usize>>> {
    let intervals = || time_s.windows(2).map(|t| t.last().zip(t.first()).map_or(0.0, |(b, a)| b - a));
    let most_s = GAP * median(intervals());
    let ends = intervals().enumerate().filter(|(_, d)| *d > most_s).map(|(i, _)| i + 1);
    let mut from = 0;
    let all = ends.chain([time_s.len()]).map(|to| std::mem::replace(&mut from, to)..to);
    let long: Vec<Range<usize>> = all.filter(|s| s.len() >= LEAST_STRETCH).collect();
    (2 * long.iter().map(Range::len).sum::<usize>() >= time_s.len()).then_some(long)
}

pub(super) fn relation(time_s: &[f64], value: &[f64], rate: &[f64]) -> Option<Relation> {
    let stretches = stretches(time_s)?;
    let mut integral = vec![0.0; time_s.len()];
    let mut sum = 0.0;
    for (i, (t, v)) in time_s.windows(2).zip(rate.windows(2)).enumerate() {
        let (&[t0, t1], &[v0, v1]) = (t, v) else { return None };
        sum += 0.5 * (v0 + v1) * (t1 - t0);
        *integral.get_mut(i + 1)? = sum;
    }
    // Without its mean over each stretch: what a gap adds to the integral is gone with it.
    let centred = |values: &[f64]| {
        let of = |stretch: &Range<usize>| {
            let values = values.get(stretch.clone()).unwrap_or_default();
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            values.iter().map(move |v| v - mean).collect::<Vec<_>>()
        };
        DVector::from_vec(stretches.iter().flat_map(of).collect())
    };
    let y = centred(value);
    let all = [centred(&integral), centred(rate), centred(time_s)];
    // Motion at constant speed tells an offset of the rate from nothing else: then there is none.
    for columns in [all.as_slice(), all.get(..2)?] {
        let norms: Vec<f64> = columns.iter().map(|c| c.norm()).collect();
        if !norms.iter().chain([&y.norm()]).all(|n| n.is_finite() && *n > 0.0) {
            return None;
        }
        let scaled: Vec<DVector<f64>> = columns.iter().zip(&norms).map(|(c, n)| c / *n).collect();
        let matrix = DMatrix::from_columns(&scaled);
        let normal = matrix.transpose() * &matrix;
        let svd = normal.try_svd(true, true, f64::EPSILON, MOST_SWEEPS)?;
        if svd.singular_values.min() < LEAST_SINGULAR * svd.singular_values.max() {
            continue;
        }
        let solution = svd.solve(&(matrix.transpose() * &y), 0.0).ok()?;
        let left = (&y - &matrix * &solution).norm() / y.norm();
        let of = |i: usize| Some(solution.get(i)? / norms.get(i)?);
        let ratio = of(0)?;
        return Some(Relation { ratio, ahead_s: of(1)? / ratio, left });
    }
    None
}

/// Inputs that contradict each other: which one is off, by what, and what becomes of it.
pub(super) fn inputs(bench: &Bench, log: &mut MeasuredLog, interval_s: f64, findings: &mut Vec<Finding>) {
    let (value, rate) = drive(bench);
    if !log.channels.contains_key(&rate) {
        alone(bench, log, value, findings);
    }
    let (Some(x), Some(v)) = (log.channels.get(&value), log.channels.get(&rate)) else { return };
    let Some(fit) = relation(&log.time_s, x, v) else { return };
    let source = log.source.clone();
    let finding = |severity, channel: Channel, kind, found| {
        Finding::new(severity, &source, channel.name(), kind, found)
            .evidence("ratio_of_gains", fit.ratio)
            .evidence("ahead_s", fit.ahead_s)
            .evidence("left_share", fit.left)
    };
    if fit.left > UNRELATED {
        let found = format!("it is not the derivative of {value}: {:.0} % of that is left", 100.0 * fit.left);
        findings.push(
            finding(Severity::Wrong, rate, "contradiction", found)
                .cause("another signal in this column, or a dead sensor")
                .done("left out the channel; the motion comes from the other one"),
        );
        log.channels.remove(&rate);
        return;
    }
    // Value over integral of rate: a reading of the value that is too large, or one of the rate that is too small.
    let off = (fit.ratio.abs().ln()).abs();
    let named = |factor: f64| (fit.ratio.abs() / factor - 1.0).abs() < NAMED;
    let mut candidates: Vec<(Channel, f64, String)> = Vec::new();
    for (channel, power) in [(value, 1), (rate, -1)] {
        for (factor, cause) in factors::units(bench, channel).into_iter().chain(factors::geometry(bench)) {
            if named(factor.powi(power)) {
                candidates.push((channel, factor, cause));
            }
        }
    }
    if off > GAIN
        && let Some((channel, factor, cause)) =
            candidates.into_iter().min_by(|a, b| misfit(bench, log, a).total_cmp(&misfit(bench, log, b)))
    {
        let kind = if factor.ln().abs() > 1.0 { "unit" } else { "gain" };
        let other = if channel == value { rate } else { value };
        let found = format!("it contradicts {other}: {factor:.4} times what that makes it");
        findings.push(
            finding(Severity::Wrong, channel, kind, found)
                .cause(cause)
                .evidence("factor", factor)
                .mend(scaled(bench, channel.name(), 1.0 / factor))
                .done(format!("divided by {factor:.6}")),
        );
        super::multiply(log, channel, 1.0 / factor);
    } else if off > GAIN_DOUBTFUL {
        let severe = off > GAIN;
        let found = format!("{value} is {:.4} times its integral", fit.ratio.abs());
        let mut finding =
            finding(if severe { Severity::Wrong } else { Severity::Doubtful }, rate, "contradiction", found)
                .cause("a gain of one of the two sensors is off");
        if severe {
            finding = finding.done("left out the channel; the motion comes from the other one");
            log.channels.remove(&rate);
        }
        findings.push(finding);
    }
    if fit.ratio < 0.0 {
        // The stroke of the transmission bench is one-sided; an axis keeps its position.
        let below = log.channels.get(&value).is_some_and(|x| median(x.iter().copied()) < 0.0);
        let flipped = if matches!(bench, Bench::Transmission(_)) && below { value } else { rate };
        if log.channels.contains_key(&flipped) {
            findings.push(
                finding(Severity::Wrong, flipped, "sign", format!("{value} falls where {rate} is positive"))
                    .cause("its sign is the other way round")
                    .mend(scaled(bench, flipped.name(), -1.0))
                    .done("changed the sign"),
            );
            super::multiply(log, flipped, -1.0);
        }
    }
    if fit.ahead_s.abs() > (DELAY_SAMPLES * interval_s).max(DELAY_S) && log.channels.contains_key(&rate) {
        let way = if fit.ahead_s > 0.0 { "behind" } else { "ahead of" };
        let found = format!("it runs {:.2} ms {way} {value}", 1e3 * fit.ahead_s.abs());
        findings.push(
            finding(Severity::Wrong, rate, "delay", found)
                .cause("a filter or another clock in one of the two")
                .done("left out the channel; the motion comes from the other one"),
        );
        log.channels.remove(&rate);
    }
}

/// A position without a velocity beside it, against the described stroke: only a unit's factor is told from another stroke.
fn alone(bench: &Bench, log: &mut MeasuredLog, value: Channel, findings: &mut Vec<Finding>) {
    let Some(stroke) = log.channels.get(&value).map(|x| range(x)).filter(|r| *r > 0.0) else { return };
    let described = described_stroke(bench);
    let off = |factor: f64| (stroke / factor / described).ln().abs();
    let units =
        factors::units(bench, value).into_iter().filter(|(f, _)| f.ln() > 0.0 && off(*f) < STROKE.ln());
    let best = units.min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
    let Some((factor, cause)) = best.filter(|_| off(1.0) > UNLIKE_STROKE.ln()) else { return };
    let found = format!("its stroke is {stroke:.4}, the described one {described:.4} {}", value.unit());
    findings.push(
        Finding::new(Severity::Wrong, &log.source, value.name(), "unit", found)
            .cause(cause)
            .evidence("factor", factor)
            .evidence("stroke", stroke)
            .evidence("described_stroke", described)
            .mend(scaled(bench, value.name(), 1.0 / factor))
            .done(format!("divided by {factor:.6}")),
    );
    super::multiply(log, value, 1.0 / factor);
}

fn described_stroke(bench: &Bench) -> f64 {
    match bench {
        Bench::Transmission(b) => b.drive.stroke_m,
        Bench::FrictionRig(r) => 2.0 * r.axis.amplitude,
    }
}

/// How far a candidate's channel would be from the described motion, as a logarithm.
fn misfit(bench: &Bench, log: &MeasuredLog, (channel, factor, _): &(Channel, f64, String)) -> f64 {
    let (value, rate) = drive(bench);
    let stroke = described_stroke(bench);
    let period_s = match bench {
        Bench::Transmission(b) => b.drive.period_s,
        Bench::FrictionRig(r) => r.axis.period_s,
    };
    let of = |c: Channel, described: f64| {
        let range = log.channels.get(&c).map_or(0.0, |x| range(x));
        let corrected = if c == *channel { range / factor } else { range };
        (corrected / described).ln().abs()
    };
    of(value, stroke) + of(rate, 2.0 * core::f64::consts::PI * 0.5 * stroke / period_s)
}

/// Angle and speed of the shaft that contradict each other, after each has been compared with the simulation.
pub(super) fn outputs(log: &MeasuredLog, interval_s: f64, findings: &mut Vec<Finding>) {
    let (value, rate) = (Channel::ShaftAngle, Channel::ShaftSpeed);
    let (Some(x), Some(v)) = (log.channels.get(&value), log.channels.get(&rate)) else { return };
    let Some(fit) = relation(&log.time_s, x, v) else { return };
    let late = fit.ahead_s.abs() > (DELAY_SAMPLES * interval_s).max(DELAY_S);
    if fit.left < UNRELATED && (fit.ratio - 1.0).abs() < GAIN && !late {
        return;
    }
    let found = format!(
        "{value} is {:.4} times its integral and {:.2} ms {} of it, {:.0} % left",
        fit.ratio,
        1e3 * fit.ahead_s.abs(),
        if fit.ahead_s > 0.0 { "ahead" } else { "late" },
        100.0 * fit.left
    );
    findings.push(
        Finding::new(Severity::Doubtful, &log.source, rate.name(), "contradiction", found)
            .cause("a gain or a delay of one of the two sensors")
            .evidence("ratio_of_gains", fit.ratio)
            .evidence("ahead_s", fit.ahead_s)
            .evidence("left_share", fit.left),
    );
}
