//! `host-sim run`: the bench with the networks or the law as the bearing force, the estimator beside it.

use super::end::ProbeOptions;
use super::{output, run_controller, run_report, run_tilt, slider_crank, sweep};
use crate::controller::{ControllerError, Recording};
use crate::error::CliError;
use crate::estimator::{self, OnRestart, See, Tracked};
use crate::force::{self, ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use crate::options::BenchOptions;
use crate::progress;
use crate::same_signals;
use crate::sensing::{self, DropOut};
use crate::summary::{AgainstLaw, EstimatorSummary, Figures, PeakRow, Summary};
use crate::watch::Watch;
use crate::watch::scene::Scene;
use bench::description::TransmissionBench;
use bench::slider_crank_description::SliderCrankBench;
use bench::transmission::Transmission;
use bench::{Bench, MeasuredLog, impact_log};
use clap::{Args, Parser, ValueEnum};
use std::path::PathBuf;

/// Where the estimator runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ControllerChoice {
    /// No estimator.
    None,
    /// The firmware's estimator in this process.
    Native,
    /// The firmware on the emulated controller, in lockstep; also natively, and the two are compared bit for bit.
    Emulated,
    /// A board on a serial port or at a debug probe, in lockstep; also natively, and the two are compared bit for bit.
    Attached,
}

/// Arguments of `host-sim run`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim run\n  host-sim run --force law --bearing plastic --clearance-mm 1 --load-kn -5\n  \
    host-sim run --controller emulated --json\n  host-sim run --controller emulated --watch --watch-speed 0.2\n  \
    host-sim run --controller attached --port /dev/ttyUSB0 --on-restart continue --record out/run/link.rec"
)]
pub struct RunArgs {
    /// The bench.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Source of the bearing force.
    #[arg(long, value_enum, default_value = "quantised-net")]
    pub force: ForceSource,
    /// Where the estimator runs.
    #[arg(long, value_enum, default_value = "native", requires_if("attached", "way"))]
    pub controller: ControllerChoice,
    /// Communication step of the networks in microseconds: their force is held that long.
    #[arg(long, default_value_t = 10.0, value_name = "US", allow_negative_numbers = true)]
    pub step_us: f64,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Share of the readings that do not reach the controller, each channel for itself; noise, delay, bandwidth, resolution, offset, drift and
    /// limits are in the bench's description under `[sensors]`.
    #[arg(long, default_value_t = 0.0, value_name = "SHARE", allow_negative_numbers = true)]
    pub dropout_share: f64,
    /// Readings that are lost in a row.
    #[arg(long, default_value_t = 1.0, value_name = "N", allow_negative_numbers = true)]
    pub dropout_samples: f64,
    /// Firmware for the emulated controller.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// Serial port of the attached controller.
    #[arg(long, value_name = "PATH", group = "way")]
    pub port: Option<PathBuf>,
    /// Its debug probe.
    #[command(flatten)]
    pub probe: ProbeOptions,
    /// What to do when the controller restarts in the middle of the run; that of the emulator is gone then.
    #[arg(long, value_enum, default_value = "stop")]
    pub on_restart: OnRestart,
    /// File for every frame exchanged with the controller; `host-sim replay` says them again.
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Draw force, orbit and flags in the terminal while the estimator runs, at the bench's own pace; q closes the view.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Simulated seconds a second of the live view.
    #[arg(
        long,
        default_value_t = 1.0,
        value_name = "FACTOR",
        requires = "watch",
        allow_negative_numbers = true
    )]
    pub watch_speed: f64,
    /// Folder for log.csv, impacts.csv, run.json and report.html; on a bench in two planes also tilt.csv.
    #[arg(long, default_value = "out/run", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Parser)]
struct Defaults {
    #[command(flatten)]
    args: RunArgs,
}

impl RunArgs {
    /// The main job: every option at its default.
    pub fn default_job() -> Self {
        Defaults::parse_from(["host-sim"]).args
    }
}

/// A finished run with what the report shows of it.
pub struct Finished {
    /// The bench as run.
    pub bench: TransmissionBench,
    /// Figures.
    pub summary: Summary,
    /// The run.
    pub forced: ForcedRun,
    /// The run with the analytic law, if the force came from networks.
    pub law: Option<ForcedRun>,
    /// What the estimator said.
    pub tracked: Option<Tracked>,
    /// What was exchanged with the controller, if it was to be recorded.
    pub recording: Option<Recording>,
}

/// Runs the command.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    if let Some(bench) = SliderCrankBench::open(&args.bench.bench)? {
        args.bench.unchanged("slider-crank")?;
        if args.record.is_some() || args.watch {
            let option = if args.watch { "--watch" } else { "--record" };
            return Err(CliError::Input(format!(
                "{option}: found plant `slider-crank`; expected `transmission-bench`, which has a controller"
            )));
        }
        return slider_crank::run(&bench, args);
    }
    if args.controller == ControllerChoice::None && (args.record.is_some() || args.watch) {
        let option = if args.watch { "--watch" } else { "--record" };
        return Err(CliError::Input(format!("{option}: found --controller none; expected a controller")));
    }
    let finished = execute(args)?;
    let json = output::json(&finished.summary)?;
    let impacts = impact_log::to_csv(&finished.forced.run.impacts, finished.bench.contact.latch_floor_m_s);
    let page = run_report::page(&finished).map_err(CliError::Work)?;
    output::write(&args.out, "log.csv", &log_of(&finished, args.seed).to_csv())?;
    output::write(&args.out, impact_log::FILE_NAME, &impacts)?;
    if !finished.forced.tilting.is_empty() {
        let table = run_tilt::to_csv(&finished.forced.tilting, log_interval(&finished));
        output::write(&args.out, run_tilt::FILE_NAME, &table)?;
    }
    if let (Some(path), Some(recording)) = (&args.record, &finished.recording) {
        recording.write(path).map_err(|e| CliError::output(path, &e))?;
    }
    output::write(&args.out, "run.json", &format!("{json}\n"))?;
    output::write(&args.out, "report.html", &page.render())?;
    if args.json {
        say!("{json}");
    } else {
        for row in run_report::rows(&finished.summary) {
            say!("{:<44} {:>14}", row[0], row[1]);
        }
        run_report::print_audit(&finished);
        say!("\nreport: {}", args.out.join("report.html").display());
    }
    Ok(())
}

/// Runs the bench and the estimator.
pub fn execute(args: &RunArgs) -> Result<Finished, CliError> {
    let Bench::Transmission(bench) = args.bench.open()? else {
        return Err(CliError::Input(format!(
            "{}: found plant `friction-rig`; expected `transmission-bench` (a rig's logs go to `record` and `diagnose`)",
            args.bench.bench
        )));
    };
    let step_s = sweep::step_s(args.step_us)?;
    let drop_out = drop_out(args)?;
    let described = Bench::Transmission(bench.clone());
    let Bench::Transmission(resolved) = described.resolved() else {
        return Err(CliError::Work("plant changed".into()));
    };
    let plant = Transmission::new(&resolved, resolved.drive_profile(), resolved.load_profile());

    let bar = progress::bar(args.json, progress::PERCENT);
    bar.set_message(format!("bench with {}", args.force.name()));
    let forced = force::run_bench(&resolved, args.force, step_s, || bar.inc(1))?;
    let mut summary = Summary {
        figures: Figures::of(&resolved, args.force, &forced, SAMPLE_RATE_HZ),
        wall_s_per_simulated_s: forced.wall_s / resolved.duration_s(),
        energy: forced
            .run
            .energy
            .terms()
            .map(|(name, value)| (name.to_owned(), value.into()))
            .into_iter()
            .collect(),
        peaks: forced.peaks.iter().map(PeakRow::from).collect(),
        law_peaks: Vec::new(),
        tilt: forced.tilt,
        estimator: None,
        against_law: None,
    };
    let law = if args.force == ForceSource::Law {
        None
    } else {
        let law = force::run_bench(&resolved, ForceSource::Law, step_s, || {})?;
        summary.law_peaks = law.peaks.iter().map(PeakRow::from).collect();
        summary.against_law = Some(AgainstLaw::of(&resolved, &forced.run.samples, &law.run.samples));
        Some(law)
    };
    bar.set_message("estimator");
    let configuration = estimator::controller_configuration(&plant, &resolved, SAMPLE_RATE_HZ)?;
    let frames = sensing::samples(&described, &forced.run.samples, args.seed, drop_out);
    let (mut tracked, mut recording) = (None, None);
    let mut watch = if args.watch {
        bar.finish_and_clear();
        Some(Watch::open(scene(&resolved, &forced, args), args.watch_speed)?)
    } else {
        None
    };
    let mut see = watch.as_mut().map(|watch| |sample: &_, estimate: &_| watch.see(sample, estimate));
    let see = see.as_mut().map(|see| see as &mut See<'_>);
    let estimated = run_controller::estimate(args, configuration, &frames, see)?;
    drop(watch);
    if let Some(estimated) = estimated {
        let seen = frames.iter().map(|sampled| sampled.frame);
        summary.estimator = Some(EstimatorSummary::of(
            &resolved,
            &forced.run.samples,
            &estimated.tracked,
            &same_signals::follow(&resolved, &configuration, seen)?,
            estimated.differences,
        ));
        (tracked, recording) = (Some(estimated.tracked), estimated.recording);
    }
    bar.finish_and_clear();
    Ok(Finished { bench: *resolved, summary, forced, law, tracked, recording })
}

/// The live view of a run that is about to be estimated.
fn scene(bench: &TransmissionBench, forced: &ForcedRun, args: &RunArgs) -> Scene {
    let title = format!(
        "{}, {:.2} mm, {:+.1} kN, {:?}",
        bench.bearing.material.name(),
        bench.bearing.radial_clearance_m * 1e3,
        bench.load.force_n * 1e-3,
        args.controller,
    );
    let truth = forced.run.samples.iter().map(|s| (s.time_s, s.forces.normal_n));
    Scene::new(title.to_lowercase(), bench.duration_s(), bench.bearing.radial_clearance_m, truth)
}

/// The drop-outs asked for.
fn drop_out(args: &RunArgs) -> Result<DropOut, CliError> {
    let refuse = |option: &str, found: f64, expected: &str| {
        Err(CliError::Input(format!("{option}: found {found}; expected {expected}")))
    };
    let (share, samples) = (args.dropout_share, args.dropout_samples);
    if !(0.0..=0.9).contains(&share) {
        return refuse("--dropout-share", share, "0 to 0.9");
    }
    if !(1.0..=1e6).contains(&samples) || samples.fract() != 0.0 {
        return refuse("--dropout-samples", samples, "a whole number, 1 to 1000000");
    }
    Ok(DropOut { share, samples })
}

/// Samples of a run from one of the log to the next.
fn log_interval(finished: &Finished) -> usize {
    ((SAMPLE_RATE_HZ / finished.bench.logging.sample_rate_hz).round() as usize).max(1)
}

/// The run as a measured log: the bench's sensors at its logging rate.
fn log_of(finished: &Finished, seed: u64) -> MeasuredLog {
    let samples = (finished.forced.run.samples.as_slice(), log_interval(finished));
    bench::record::log_of(&Bench::Transmission(Box::new(finished.bench.clone())), samples, seed)
}

impl From<ControllerError> for CliError {
    fn from(error: ControllerError) -> Self {
        match error {
            ControllerError::Port { .. } => Self::Input(error.to_string()),
            #[cfg(feature = "probe")]
            ControllerError::Probe(error) => error.into(),
            other => Self::Work(other.to_string()),
        }
    }
}
