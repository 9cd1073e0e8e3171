//! Contradictions between two signals of which one is the derivative of the other.

use super::column_mapping::scaled;
use super::factors;
use super::finding::{Finding, Severity};
use super::motion::{Relation, drive_channels, relation};
use super::rows::multiply;
use super::tuning;
use crate::statistics::{median, range};
use bench::{Bench, Channel, MeasuredLog};

/// Finds inputs that contradict each other, and corrects or leaves out the wrong one.
pub(super) fn check_inputs(
    bench: &Bench,
    log: &mut MeasuredLog,
    interval_s: f64,
    findings: &mut Vec<Finding>,
) {
    let Some((value, rate)) = drive_channels(bench) else { return };
    if !log.channels.contains_key(&rate) {
        check_stroke(bench, log, value, &[value], findings);
    }
    let (Some(x), Some(v)) = (log.channels.get(&value), log.channels.get(&rate)) else { return };
    let Some(relation) = relation(&log.time_s, x, v) else { return };
    let drive = Drive { bench, value, rate, relation };
    if drive.relation.unexplained_share > tuning::MAX_UNRELATED {
        findings.push(drive.leave_out_unrelated(log));
        return;
    }
    findings.extend(drive.correct_gain(log));
    if drive.relation.ratio < 0.0 {
        findings.extend(drive.correct_sign(log));
    }
    let max_delay_s = (tuning::MAX_DELAY_SAMPLES * interval_s).max(tuning::MAX_DELAY_S);
    if drive.relation.lead_s.abs() > max_delay_s && log.channels.contains_key(&rate) {
        findings.push(drive.leave_out_delayed(log));
    }
    // Both in the same wrong unit do not contradict each other.
    if (drive.relation.ratio.abs() - 1.0).abs() < tuning::NAMED_TOLERANCE {
        check_stroke(bench, log, value, &[value, rate], findings);
    }
}

/// The two measured inputs of the driven motion, and their relation.
struct Drive<'a> {
    bench: &'a Bench,
    value: Channel,
    rate: Channel,
    relation: Relation,
}

impl Drive<'_> {
    fn finding(
        &self,
        log: &MeasuredLog,
        severity: Severity,
        channel: Channel,
        kind: &'static str,
        found: String,
    ) -> Finding {
        Finding::new(severity, &log.source, channel.name(), kind, found)
            .evidence("ratio_of_gains", self.relation.ratio)
            .evidence("ahead_s", self.relation.lead_s)
            .evidence("left_share", self.relation.unexplained_share)
    }

    fn leave_out_unrelated(&self, log: &mut MeasuredLog) -> Finding {
        let found = format!(
            "it is not the derivative of {}: {:.0} % of it is unexplained",
            self.value,
            100.0 * self.relation.unexplained_share
        );
        log.channels.remove(&self.rate);
        self.finding(log, Severity::Wrong, self.rate, "contradiction", found)
            .cause("another signal in this column, or a dead sensor")
            .applied("left out the channel; the motion comes from the other one")
    }

    /// Corrects a gain that is wrong by a known factor, and leaves out the rate if the factor is
    /// unknown.
    fn correct_gain(&self, log: &mut MeasuredLog) -> Option<Finding> {
        // The ratio of value to integrated rate is large if the value is too large or the rate too
        // small.
        let ratio = self.relation.ratio.abs();
        let error = ratio.ln().abs();
        if error > tuning::MAX_GAIN_ERROR
            && let Some((channel, factor, cause)) = self.known_factor(log)
        {
            let kind = if factor.ln().abs() > tuning::MIN_LOG_UNIT_OF_INPUT { "unit" } else { "gain" };
            let other = if channel == self.value { self.rate } else { self.value };
            let found =
                format!("it contradicts {other}: it is {factor:.4} times the value that follows from it");
            multiply(log, channel, 1.0 / factor);
            return Some(
                self.finding(log, Severity::Wrong, channel, kind, found)
                    .cause(cause)
                    .evidence("factor", factor)
                    .correction(scaled(self.bench, channel.name(), 1.0 / factor))
                    .applied(format!("divided by {factor:.6}")),
            );
        }
        if error <= tuning::DOUBTFUL_GAIN_ERROR {
            return None;
        }
        let is_severe = error > tuning::MAX_GAIN_ERROR;
        let severity = if is_severe { Severity::Wrong } else { Severity::Doubtful };
        let found = format!("{} is {ratio:.4} times its integral", self.value);
        let finding = self
            .finding(log, severity, self.rate, "contradiction", found)
            .cause("a wrong gain of one of the two sensors");
        if !is_severe {
            return Some(finding);
        }
        log.channels.remove(&self.rate);
        Some(finding.applied("left out the channel; the motion comes from the other one"))
    }

    /// The channel, factor and cause that explain the ratio; of several, those whose correction
    /// comes nearest to the described motion.
    fn known_factor(&self, log: &MeasuredLog) -> Option<(Channel, f64, String)> {
        let ratio = self.relation.ratio.abs();
        let explains = |factor: f64| (ratio / factor - 1.0).abs() < tuning::NAMED_TOLERANCE;
        let mut candidates: Vec<(Channel, f64, String)> = Vec::new();
        for (channel, power) in [(self.value, 1), (self.rate, -1)] {
            let known = factors::units(self.bench, channel).into_iter().chain(factors::geometry(self.bench));
            let explaining = known.filter(|(factor, _)| explains(factor.powi(power)));
            candidates.extend(explaining.map(|(factor, cause)| (channel, factor, cause)));
        }
        let distance = |c: &(Channel, f64, String)| distance_from_described(self.bench, log, c);
        candidates.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    fn correct_sign(&self, log: &mut MeasuredLog) -> Option<Finding> {
        // The stroke of the transmission bench is one-sided. An axis keeps its position.
        let is_below = log.channels.get(&self.value).is_some_and(|x| median(x.iter().copied()) < 0.0);
        let flipped = if !self.bench.is_axis() && is_below { self.value } else { self.rate };
        if !log.channels.contains_key(&flipped) {
            return None;
        }
        multiply(log, flipped, -1.0);
        let found = format!("{} falls where {} is positive", self.value, self.rate);
        Some(
            self.finding(log, Severity::Wrong, flipped, "sign", found)
                .cause("its sign is inverted")
                .correction(scaled(self.bench, flipped.name(), -1.0))
                .applied("changed the sign"),
        )
    }

    fn leave_out_delayed(&self, log: &mut MeasuredLog) -> Finding {
        let lead_s = self.relation.lead_s;
        let relation = if lead_s > 0.0 { "lags" } else { "leads" };
        let found = format!("it {relation} {} by {:.2} ms", self.value, 1e3 * lead_s.abs());
        log.channels.remove(&self.rate);
        self.finding(log, Severity::Wrong, self.rate, "delay", found)
            .cause("a filter or another clock in one of the two")
            .applied("left out the channel; the motion comes from the other one")
    }
}

/// Finds and corrects the unit of a position, alone or together with that of its rate: a stroke far
/// from the described one that the factor of a unit explains.
fn check_stroke(
    bench: &Bench,
    log: &mut MeasuredLog,
    value: Channel,
    channels: &[Channel],
    findings: &mut Vec<Finding>,
) {
    // In open loop the stroke follows from the effort, not from the description.
    if bench.is_open_loop() {
        return;
    }
    let Some(stroke) = log.channels.get(&value).map(|x| range(x)).filter(|r| *r > 0.0) else { return };
    let described = bench.stroke();
    let log_ratio = |factor: f64| (stroke / factor / described).ln().abs();
    let units = factors::units(bench, value)
        .into_iter()
        .filter(|(f, _)| f.ln() > 0.0 && log_ratio(*f) < tuning::MAX_STROKE_RATIO.ln());
    let best = units.min_by(|a, b| log_ratio(a.0).total_cmp(&log_ratio(b.0)));
    let Some((factor, cause)) = best.filter(|_| log_ratio(1.0) > tuning::UNLIKELY_STROKE_RATIO.ln()) else {
        return;
    };
    let found = format!("its stroke is {stroke:.4}, the described one {described:.4} {}", value.unit());
    for &channel in channels.iter().filter(|channel| log.channels.contains_key(channel)).collect::<Vec<_>>() {
        let (found, cause) = if channel == value {
            (found.clone(), cause.clone())
        } else {
            (format!("it agrees with {value}, whose unit is wrong"), format!("the same factor as of {value}"))
        };
        findings.push(
            Finding::new(Severity::Wrong, &log.source, channel.name(), "unit", found)
                .cause(cause)
                .evidence("factor", factor)
                .evidence("stroke", stroke)
                .evidence("described_stroke", described)
                .correction(scaled(bench, channel.name(), 1.0 / factor))
                .applied(format!("divided by {factor:.6}")),
        );
        multiply(log, channel, 1.0 / factor);
    }
}

/// Distance of the motion from the described one if a candidate's channel is corrected: sum of the
/// logarithms of the ratios of both ranges.
fn distance_from_described(
    bench: &Bench,
    log: &MeasuredLog,
    (channel, factor, _): &(Channel, f64, String),
) -> f64 {
    let Some((value, rate)) = drive_channels(bench) else { return f64::INFINITY };
    let stroke = bench.stroke();
    let period_s = bench.period_s();
    let distance = |c: Channel, described: f64| {
        let range = log.channels.get(&c).map_or(0.0, |x| range(x));
        let corrected = if c == *channel { range / factor } else { range };
        (corrected / described).ln().abs()
    };
    distance(value, stroke) + distance(rate, 2.0 * core::f64::consts::PI * 0.5 * stroke / period_s)
}

/// Reports an angle and a speed of the shaft that contradict each other. Each has been compared
/// with the simulation before.
pub(super) fn check_outputs(log: &MeasuredLog, interval_s: f64, findings: &mut Vec<Finding>) {
    let (value, rate) = (Channel::ShaftAngle, Channel::ShaftSpeed);
    let (Some(x), Some(v)) = (log.channels.get(&value), log.channels.get(&rate)) else { return };
    let Some(relation) = relation(&log.time_s, x, v) else { return };
    let is_late = relation.lead_s.abs() > (tuning::MAX_DELAY_SAMPLES * interval_s).max(tuning::MAX_DELAY_S);
    let is_related = relation.unexplained_share < tuning::MAX_UNRELATED;
    if is_related && (relation.ratio - 1.0).abs() < tuning::MAX_GAIN_ERROR && !is_late {
        return;
    }
    let found = format!(
        "{value} is {:.4} times its integral and {} it by {:.2} ms; {:.0} % is unexplained",
        relation.ratio,
        if relation.lead_s > 0.0 { "leads" } else { "lags" },
        1e3 * relation.lead_s.abs(),
        100.0 * relation.unexplained_share
    );
    findings.push(
        Finding::new(Severity::Doubtful, &log.source, rate.name(), "contradiction", found)
            .cause("a gain or a delay of one of the two sensors")
            .evidence("ratio_of_gains", relation.ratio)
            .evidence("ahead_s", relation.lead_s)
            .evidence("left_share", relation.unexplained_share),
    );
}
