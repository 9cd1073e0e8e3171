//! A measured log through the controller: the estimates that it would have given.
//!
//! The log's interval becomes the controller's sample period, its times those of the samples; time 0 is the log's beginning.

use super::replay::{ReplayArgs, estimates_csv};
use super::{end, output};
use crate::error::CliError;
use crate::estimator::{self, Tracked};
use crate::sensing;
use bench::transmission::Transmission;
use bench::{Bench, Channel, MeasuredLog};
use firmware::flags::SENSOR_FAULT;
use inference::Flags;
use link::{Command, SensorFrame};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Sample periods that the controller serves, s.
const PERIODS_S: std::ops::RangeInclusive<f64> = 50e-6..=1e-3;
/// Where the table goes unless told otherwise.
const OUT: &str = "out/replay";

/// Replays a log.
pub(super) fn run(args: &ReplayArgs) -> Result<(), CliError> {
    let bench = args.bench.open()?;
    let log = MeasuredLog::read(&args.file, &bench.log_format())?;
    let Bench::Transmission(resolved) = bench.resolved() else {
        return Err(CliError::Input(format!(
            "{}: found plant `friction-rig`; expected `transmission-bench`",
            args.bench.bench
        )));
    };
    let frames = frames(&log)?;
    let plant = Transmission::new(&resolved, resolved.drive_profile(), resolved.load_profile());
    let rate_hz = 1.0 / period_s(&log)?;
    let configuration = estimator::controller_configuration(&plant, &resolved, rate_hz)?;
    let mut controller = end::open(args.controller, args.elf.as_deref(), args.port.as_deref(), &args.probe)?;
    controller.order(Command::Configure(configuration))?;
    let tracked = estimator::track(controller, &frames)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(OUT));
    output::write(&out, "estimates.csv", &estimates_csv(&tracked.estimates))?;
    tell(args, &tracked, rate_hz, &out.join("estimates.csv"))
}

fn tell(args: &ReplayArgs, tracked: &Tracked, rate_hz: f64, table: &Path) -> Result<(), CliError> {
    let peak = tracked.estimates.iter().map(|e| e.normal_force_n).fold(0.0, f32::max);
    let flagged = |flags: Flags| {
        tracked.estimates.iter().filter(|e| Flags::from_bits(e.flags).intersects(flags)).count()
    };
    let (outside, suspect) = (flagged(Flags::OUTSIDE_TRAINING), flagged(SENSOR_FAULT));
    if args.json {
        say!(
            "{}",
            output::json(&json!({
                "log": args.file.display().to_string(),
                "controller": tracked.controller,
                "samples": tracked.estimates.len(),
                "sample_rate_hz": rate_hz,
                "peak_normal_force_n": peak,
                "outside_training": outside,
                "suspect": suspect,
                "counters": tracked.counters,
                "estimates": table.display().to_string(),
            }))?
        );
        return Ok(());
    }
    say!(
        "{}: {} samples at {rate_hz:.0} Hz on the {} controller",
        args.file.display(),
        tracked.estimates.len(),
        tracked.controller
    );
    say!("largest normal force {peak:.0} N; outside the training range {outside}, suspect {suspect} samples");
    say!("estimates: {}", table.display());
    Ok(())
}

/// The interval of a log, s: the middle one, so that lost rows do not count.
fn period_s(log: &MeasuredLog) -> Result<f64, CliError> {
    let mut intervals: Vec<f64> =
        log.time_s.windows(2).filter_map(|w| Some(w.get(1)? - w.first()?)).collect();
    intervals.sort_by(f64::total_cmp);
    let period_s = intervals.get(intervals.len() / 2).copied().unwrap_or_default();
    // The controller counts whole microseconds.
    let period_s = (period_s * 1e6).round() * 1e-6;
    if PERIODS_S.contains(&period_s) {
        Ok(period_s)
    } else {
        Err(CliError::Input(format!(
            "{}: found {:.0} us from sample to sample; expected {:.0} to {:.0} us",
            log.source,
            period_s * 1e6,
            PERIODS_S.start() * 1e6,
            PERIODS_S.end() * 1e6
        )))
    }
}

fn frames(log: &MeasuredLog) -> Result<Vec<SensorFrame>, CliError> {
    let y = log.need(Channel::JournalY)?;
    let z = log.need(Channel::JournalZ)?;
    let angle = log.need(Channel::ShaftAngle)?;
    let load = log.need(Channel::LoadForce)?;
    let start = log.time_s.first().copied().unwrap_or_default();
    let rows = log.time_s.iter().zip(y).zip(z).zip(angle).zip(load).enumerate();
    Ok(rows
        .map(|(index, ((((t, y), z), angle), load))| {
            sensing::frame(index as u32, t - start, [*y, *z, *angle, *load])
        })
        .collect())
}
