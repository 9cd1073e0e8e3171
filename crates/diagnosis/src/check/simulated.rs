//! A log's outputs against what the described bench would have logged under the log's inputs.
//!
//! The mismatch of a reading `m` with a simulated `s` under a hypothesis `h` (the factor in the reading) is the median of `|m/h - s|` over that of
//! `|s|`: honest changes of a bench leave it well below 1/2, a wrong unit or sign does not.

use super::factors;
use super::finding::{Finding, Severity};
use super::mend::{scaled, taken};
use super::multiply;
use super::statistics::{median, slope};
use bench::respond::{Inputs, Response, respond};
use bench::{Bench, Channel, MeasuredLog};

/// Mismatch from which on a channel does not fit as it stands, and up to which a correction makes it fit.
const UNFIT: f64 = 0.5;
/// Share of the mismatch that an exact correction may leave.
const LEFT: f64 = 0.4;
/// Mean mismatch of all outputs from which on the load is looked at, and up to which another load explains them.
const LOAD_SUSPECT: f64 = 0.1;
const LOAD_LEFT: f64 = 0.3;

/// Times the described load that no bench bears.
const ABSURD: f64 = 50.0;

/// Left out at the start of a transmission bench's log after the load's ramp, and at its end, s.
const MARGIN_S: f64 = 0.010;

const AXES: [(Channel, Channel); 2] =
    [(Channel::JournalY, Channel::JournalZ), (Channel::BearingForceY, Channel::BearingForceZ)];

/// The described bench under a log's inputs.
pub(super) struct Simulated {
    response: Response,
    /// Samples after the start and before the end.
    steady: std::ops::Range<usize>,
}

impl Simulated {
    /// `None` where the inputs cannot be simulated; the diagnosis itself says why.
    pub(super) fn new(bench: &Bench, log: &MeasuredLog) -> Option<Self> {
        let mut asked = log.clone();
        for (y, z) in AXES {
            // Both axes, to find one under the other's name.
            if log.channels.contains_key(&y) || log.channels.contains_key(&z) {
                for channel in [y, z] {
                    asked.channels.entry(channel).or_insert_with(|| vec![0.0; log.time_s.len()]);
                }
            }
        }
        let response = respond(bench, &Inputs::new(bench, &asked).ok()?).ok()?;
        let (start, end) = (log.time_s.first()?, log.time_s.last()?);
        let (from, to) = match bench {
            Bench::Transmission(b) => (start + b.load.ramp_s + MARGIN_S, end - MARGIN_S),
            Bench::FrictionRig(_) => (*start, *end),
        };
        let steady = log.time_s.partition_point(|t| *t < from)..log.time_s.partition_point(|t| *t <= to);
        (steady.len() >= 32).then_some(Self { response, steady })
    }

    pub(super) fn steady(&self) -> std::ops::Range<usize> {
        self.steady.clone()
    }

    /// The simulated channel over the whole log.
    pub(super) fn of(&self, channel: Channel) -> Option<&[f64]> {
        self.response.get(&channel).map(Vec::as_slice)
    }

    fn pair<'a>(
        &'a self,
        log: &'a MeasuredLog,
        measured: Channel,
        simulated: Channel,
    ) -> Option<(&'a [f64], &'a [f64])> {
        let (m, s) = (log.channels.get(&measured)?, self.of(simulated)?);
        let s = s.get(self.steady())?;
        (size(s) > 0.0).then_some((m.get(self.steady())?, s))
    }

    /// Mismatch of a measured channel under a factor with a simulated one.
    pub(super) fn mismatch(
        &self,
        log: &MeasuredLog,
        measured: Channel,
        simulated: Channel,
        factor: f64,
    ) -> Option<f64> {
        let (m, s) = self.pair(log, measured, simulated)?;
        Some(median(m.iter().zip(s).map(|(m, s)| (m / factor - s).abs())) / size(s))
    }

    /// The robust gain of a channel against its simulation.
    pub(super) fn gain(&self, log: &MeasuredLog, channel: Channel) -> Option<f64> {
        let (m, s) = self.pair(log, channel, channel)?;
        slope(s, m)
    }

    /// Mean mismatch of all outputs, none of them with more than 2, and how many are off.
    fn overall(&self, log: &MeasuredLog) -> (f64, usize, usize) {
        let all: Vec<f64> = log.outputs().filter_map(|(c, _)| self.mismatch(log, c, c, 1.0)).collect();
        let off = all.iter().filter(|r| **r > LOAD_SUSPECT).count();
        (all.iter().map(|r| r.min(2.0)).sum::<f64>() / all.len().max(1) as f64, off, all.len())
    }
}

fn size(values: &[f64]) -> f64 {
    median(values.iter().map(|v| v.abs()))
}

/// A load in the wrong unit, over a wrong area or with the wrong sign: what the outputs say together. Gives the
/// simulation that holds from here on.
pub(super) fn load(bench: &Bench, log: &mut MeasuredLog, findings: &mut Vec<Finding>) -> Option<Simulated> {
    let described_n = match bench {
        Bench::Transmission(b) => b.load.force_n,
        Bench::FrictionRig(r) => r.load.force_n,
    };
    let load_n = median(log.channels.get(&Channel::LoadForce).into_iter().flatten().copied());
    let far = |factor: f64| (load_n / factor / described_n).abs().ln().abs();
    // Under a load that no bench bears a simulation may take for ever.
    let own = if far(1.0) < ABSURD.ln() || described_n.abs() < 1.0 || load_n.abs() < described_n.abs() {
        Simulated::new(bench, log)
    } else {
        None
    };
    let (before, off, all) = own.as_ref().map_or((2.0, 2, 2), |s| s.overall(log));
    let suspect = before > LOAD_SUSPECT && (off >= 2 || (all == 1 && off == 1));
    if !suspect || !log.channels.contains_key(&Channel::LoadForce) {
        return own;
    }
    let mut tried = factors::units(bench, Channel::LoadForce);
    tried.push((-1.0, "its sign is the other way round: the load is positive along +Y".into()));
    // Only the drive's force tells a wrong area from another lever.
    if matches!(bench, Bench::Transmission(_)) && log.channels.contains_key(&Channel::DriveForce) {
        tried.extend(factors::geometry(bench));
        tried.extend(factors::areas());
    }
    // A gain of the outputs can look like one of the load: the load is at fault if its correction brings it to the described one.
    tried.retain(|(factor, _)| {
        let areas = (0.2..5.0).contains(factor);
        areas || (if *factor < 0.0 { load_n * described_n < 0.0 } else { far(*factor) + 1.0 < far(1.0) })
    });
    let short = first_cycles(bench, log);
    let tried = tried.into_iter().filter_map(|(factor, cause)| {
        let mut other = short.clone();
        multiply(&mut other, Channel::LoadForce, 1.0 / factor);
        let (after, ..) = Simulated::new(bench, &other)?.overall(&other);
        Some((after, factor, cause))
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((after, factor, cause)) if after < LOAD_LEFT * before => {
            let kind = if factor < 0.0 {
                "sign"
            } else if factor.ln().abs() > 1.4 {
                "unit"
            } else {
                "gain"
            };
            let found = format!("{factor:.4} times the load that all outputs together tell of");
            findings.push(
                Finding::new(Severity::Wrong, &log.source, Channel::LoadForce.name(), kind, found)
                    .cause(cause)
                    .evidence("factor", factor)
                    .evidence("mean_mismatch", before)
                    .evidence("mean_mismatch_corrected", after)
                    .mend(scaled(bench, Channel::LoadForce.name(), 1.0 / factor))
                    .done(format!("divided by {factor:.6}")),
            );
            multiply(log, Channel::LoadForce, 1.0 / factor);
            Simulated::new(bench, log)
        }
        _ => own,
    }
}

/// The first two described cycles of a log: enough to try loads on.
fn first_cycles(bench: &Bench, log: &MeasuredLog) -> MeasuredLog {
    let period_s = match bench {
        Bench::Transmission(b) => b.drive.period_s,
        Bench::FrictionRig(r) => r.axis.period_s,
    };
    let end_s = log.time_s.first().copied().unwrap_or_default() + 2.0 * period_s;
    let mut short = log.clone();
    super::keep_rows(&mut short, &log.time_s.iter().map(|t| *t <= end_s).collect::<Vec<_>>());
    short
}

/// One axis under the other's name.
pub(super) fn swapped(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) {
    for (y, z) in AXES {
        let logged: Vec<(Channel, Channel)> =
            [(y, z), (z, y)].into_iter().filter(|(c, _)| log.channels.contains_key(c)).collect();
        let own: Option<f64> = logged.iter().map(|(c, _)| simulated.mismatch(log, *c, *c, 1.0)).sum();
        let Some(own) = own.filter(|own| !logged.is_empty() && *own > UNFIT * logged.len() as f64) else {
            continue;
        };
        // Beside the plain exchange, a quarter turn: one of the axes then has its sign changed too.
        let turned = |signs: [f64; 2]| -> Option<f64> {
            logged.iter().zip(signs).map(|((c, other), sign)| simulated.mismatch(log, *c, *other, sign)).sum()
        };
        let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let best = signs.into_iter().filter_map(|s| Some((turned(s)?, s))).min_by(|a, b| a.0.total_cmp(&b.0));
        let alone = |c: Channel| {
            let plain = simulated.mismatch(log, c, c, -1.0);
            plain.is_some_and(|r| r < UNFIT)
        };
        let Some((left, signs)) =
            best.filter(|(left, _)| *left < LEFT * own && !logged.iter().all(|(c, _)| alone(*c)))
        else {
            continue;
        };
        for ((channel, other), sign) in logged.iter().zip(signs) {
            let turned = if sign < 0.0 { " with its sign changed" } else { "" };
            findings.push(
                Finding::new(
                    Severity::Wrong,
                    &log.source,
                    channel.name(),
                    "swapped-axes",
                    format!("it looks like {other}{turned}"),
                )
                .cause("the two axes are exchanged in the columns, or the sensors in their mounts")
                .evidence("mismatch_as_named", own)
                .evidence("mismatch_exchanged", left)
                .mend(taken(bench, other.name(), channel.name(), sign))
                .done(format!("took it as {other}{turned}")),
            );
        }
        let taken: Vec<(Channel, Vec<f64>)> = logged
            .iter()
            .zip(signs)
            .filter_map(|((c, other), sign)| {
                Some((*other, log.channels.remove(c)?.into_iter().map(|v| sign * v).collect()))
            })
            .collect();
        log.channels.extend(taken);
    }
}

/// Outputs in a wrong unit or with the wrong sign.
pub(super) fn units(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) {
    let channels: Vec<Channel> = log.outputs().map(|(c, _)| c).collect();
    for channel in channels {
        let Some(own) = simulated.mismatch(log, channel, channel, 1.0).filter(|r| *r > UNFIT) else {
            continue;
        };
        let named = factors::units(bench, channel);
        let mut tried: Vec<(f64, String)> = vec![(-1.0, "its sign is the other way round".into())];
        tried.extend(named.iter().map(|(f, c)| (-f, format!("{c}; and its sign is the other way round"))));
        tried.extend(named);
        let mismatch = |f: f64| simulated.mismatch(log, channel, channel, f);
        let best = tried.into_iter().filter_map(|(f, c)| Some((mismatch(f)?, f, c)));
        let best = best.min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((left, factor, cause)) = best.filter(|(left, ..)| *left < LEFT * own && *left < UNFIT)
        else {
            continue;
        };
        let kind = if factor == -1.0 { "sign" } else { "unit" };
        findings.push(
            corrected(bench, log, channel, kind, factor, cause)
                .evidence("gain", simulated.gain(log, channel).unwrap_or(f64::NAN))
                .evidence("mismatch", own)
                .evidence("mismatch_corrected", left),
        );
        multiply(log, channel, 1.0 / factor);
    }
}

/// A finding about an output that is divided by a factor.
pub(super) fn corrected(
    bench: &Bench,
    log: &MeasuredLog,
    channel: Channel,
    kind: &'static str,
    factor: f64,
    cause: String,
) -> Finding {
    let found = format!("{factor:.4} times what the described bench gives under these inputs");
    let done = if factor == -1.0 { "changed the sign".into() } else { format!("divided by {factor:.6}") };
    Finding::new(Severity::Wrong, &log.source, channel.name(), kind, found)
        .cause(cause)
        .evidence("factor", factor)
        .mend(scaled(bench, channel.name(), 1.0 / factor))
        .done(done)
}
