//! `host-sim run`: the bench with the networks or the law as the bearing force, the estimator beside it.

use super::{output, run_report, run_tilt, slider_crank, sweep};
use crate::controller::{ControllerError, EmulatedController, NativeController};
use crate::error::CliError;
use crate::estimator::{self, Tracked};
use crate::force::{self, ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use crate::options::BenchOptions;
use crate::progress;
use crate::sensing;
use crate::summary::{AgainstLaw, EstimatorSummary, Figures, PeakRow, Summary};
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
}

/// Arguments of `host-sim run`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim run\n  host-sim run --force law --bearing plastic --clearance-mm 1 --load-kn -5\n  \
    host-sim run --controller emulated --json"
)]
pub struct RunArgs {
    /// The bench.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Source of the bearing force.
    #[arg(long, value_enum, default_value = "quantised-net")]
    pub force: ForceSource,
    /// Where the estimator runs.
    #[arg(long, value_enum, default_value = "native")]
    pub controller: ControllerChoice,
    /// Communication step of the networks in microseconds: their force is held that long.
    #[arg(long, default_value_t = 10.0, value_name = "US", allow_negative_numbers = true)]
    pub step_us: f64,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Firmware for the emulated controller.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
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
}

/// Runs the command.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    if let Some(bench) = SliderCrankBench::open(&args.bench.bench)? {
        args.bench.unchanged("slider-crank")?;
        return slider_crank::run(&bench, args);
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
    let tracked = if args.controller == ControllerChoice::None {
        None
    } else {
        bar.set_message("estimator");
        let frames = sensing::frames(&described, &forced.run.samples, args.seed);
        let configuration = estimator::controller_configuration(&plant, &resolved, SAMPLE_RATE_HZ)?;
        let native = estimator::track(Box::new(NativeController::start(configuration)?), &frames)?;
        let (tracked, differences) = if args.controller == ControllerChoice::Emulated {
            let elf = args.elf.clone().unwrap_or_else(EmulatedController::default_elf);
            let emulated =
                estimator::track(Box::new(EmulatedController::start(configuration, &elf)?), &frames)?;
            let differences = estimator::bit_differences(&native, &emulated);
            (emulated, Some(differences))
        } else {
            (native, None)
        };
        summary.estimator = Some(EstimatorSummary::of(&resolved, &forced.run.samples, &tracked, differences));
        Some(tracked)
    };
    bar.finish_and_clear();
    Ok(Finished { bench: *resolved, summary, forced, law, tracked })
}

/// Samples of a run from one of the log to the next.
fn log_interval(finished: &Finished) -> usize {
    ((SAMPLE_RATE_HZ / finished.bench.logging.sample_rate_hz).round() as usize).max(1)
}

/// The run as a measured log: the bench's sensors at its logging rate.
fn log_of(finished: &Finished, seed: u64) -> MeasuredLog {
    let samples: Vec<_> =
        finished.forced.run.samples.iter().step_by(log_interval(finished)).copied().collect();
    bench::record::log_of(&Bench::Transmission(Box::new(finished.bench.clone())), &samples, seed)
}

impl From<ControllerError> for CliError {
    fn from(error: ControllerError) -> Self {
        Self::Work(error.to_string())
    }
}
