//! One run of the bench: the source of the bearing force, the sensors, the controller with its
//! estimator, the figures.

pub mod arguments;
pub mod conditions;
pub mod configuration;
pub mod estimates;
mod estimator;
pub mod estimator_summary;
pub mod exchange;
pub mod force;
pub mod impacts;
pub mod magnitude;
pub(crate) mod mechanism;
mod mechanism_networks;
mod mechanism_sketch;
pub(crate) mod networks;
pub(crate) mod page;
pub(crate) mod report;
pub mod same_signals;
pub mod sensing;
pub(crate) mod servo;
pub(crate) mod settled;
pub(crate) mod slider_crank;
pub mod summary;
pub(crate) mod tilt;

pub use arguments::{ControllerChoice, RunArgs};

use crate::cli::error::CliError;
use crate::cli::progress;
use crate::controller::Recording;
use crate::fmu::plant_unit::PlantUnit;
use crate::live::LiveViews;
use crate::live::pace::Pace;
use crate::serve::Server;
use crate::serve::event::{FlagName, Start};
use crate::serve::feed::Feed;
use crate::watch::Watch;
use crate::watch::scene::Scene;
use arguments::communication_step_s;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use bench::simulate::DEFAULT_TOLERANCE;
use bench::{Bench, MeasuredLog};
use estimator_summary::EstimatorSummary;
use exchange::{ExchangeResult, Observer};
use force::{ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use sensing::DropOut;
use summary::{AgainstLaw, Figures, PeakRow, Summary};

/// A finished run with everything that its report shows.
pub struct Finished {
    /// The bench as run.
    pub bench: TransmissionBench,
    /// Figures.
    pub summary: Summary,
    /// The run.
    pub forced: ForcedRun,
    /// The run with the analytic law, if the run itself used networks.
    pub law: Option<ForcedRun>,
    /// The estimates, if there was a controller.
    pub exchange: Option<ExchangeResult>,
    /// The link session, if it was to be recorded.
    pub recording: Option<Recording>,
}

impl Finished {
    /// Returns the number of samples per row of the log.
    pub(crate) fn log_interval(&self) -> usize {
        ((SAMPLE_RATE_HZ / self.bench.logging.sample_rate_hz).round() as usize).max(1)
    }

    /// Returns the run as a measured log, with the bench's sensors at its logging rate.
    pub(crate) fn log(&self, seed: u64) -> MeasuredLog {
        let samples = (self.forced.run.samples.as_slice(), self.log_interval());
        bench::simulate::log_from_samples(&Bench::from(self.bench.clone()), samples, seed)
    }
}

/// Runs the bench and the estimator.
pub fn execute(args: &RunArgs) -> Result<Finished, CliError> {
    execute_live(args, None)
}

/// Runs the bench and the estimator, and shows them on a server.
pub(crate) fn execute_live(args: &RunArgs, server: Option<&Server>) -> Result<Finished, CliError> {
    let pace = Pace::new(args.watch_speed)?;
    let bench = args.bench.open_transmission()?;
    let step_s = communication_step_s(args.step_us)?;
    let drop_out = drop_out(args)?;
    let resolved = bench.resolved();
    let described = Bench::from(bench);
    let plant = Transmission::new(&resolved, resolved.drive_profile(), resolved.load_profile());

    let bar = progress::bar(progress::PERCENT);
    bar.set_message(format!("bench with {}", args.force().name()));
    let unit = PlantUnit::open(&args.plant, &described, args.bench.load_kn.is_some())?;
    let forced = match &unit {
        Some(unit) => unit.run(&resolved, args.force(), step_s, || bar.inc(1))?,
        None => force::run_bench(&resolved, args.force(), step_s, || bar.inc(1))?,
    };
    let is_controlled = args.force() == ForceSource::Law && unit.is_none();
    let mut summary = Summary {
        figures: Figures::from_run(&resolved, args.force(), &forced, SAMPLE_RATE_HZ),
        tolerance: is_controlled.then_some(DEFAULT_TOLERANCE),
        communication_step_s: (!is_controlled).then_some(step_s),
        wall_s: forced.wall_s,
        wall_s_per_simulated_s: forced.wall_s / resolved.duration_s(),
        energy: if unit.is_some() { Default::default() } else { energy_terms(&forced) },
        peaks: forced.peaks.iter().map(PeakRow::from).collect(),
        law_peaks: Vec::new(),
        tilt: forced.tilt,
        servo: servo::ServoFigures::from_run(&resolved, &forced.run.samples).filter(|_| unit.is_none()),
        settled: settled::describe(&resolved, &forced.run, args.seed).filter(|_| unit.is_none()),
        plant: forced.plant.clone(),
        estimator: None,
        against_law: None,
    };
    let law = if is_controlled || unit.is_some() {
        None
    } else {
        let law = force::run_bench(&resolved, ForceSource::Law, step_s, || {})?;
        summary.law_peaks = law.peaks.iter().map(PeakRow::from).collect();
        summary.against_law = Some(AgainstLaw::compare(&resolved, &forced.run.samples, &law.run.samples));
        Some(law)
    };
    bar.set_message("estimator");
    let configuration =
        configuration::lockstep_configuration(&plant, &resolved, SAMPLE_RATE_HZ, args.contact.into())?;
    let frames = sensing::samples(&described, &forced.run.samples, args.seed, drop_out);
    let (mut exchange, mut recording) = (None, None);
    let watch = if args.watch {
        bar.finish_and_clear();
        Some(Watch::open(scene(&resolved, &forced, args))?)
    } else {
        None
    };
    let feed = server.map(|server| feed(server, &resolved, frames.len(), (args, pace)));
    let mut views = LiveViews::new(watch, feed, pace);
    let mut see = views
        .as_mut()
        .map(|views| |sample: &_, estimate: &_, ended: &[_]| views.observe(sample, estimate, ended));
    let see = see.as_mut().map(|see| see as &mut Observer<'_>);
    let estimated = estimator::estimate(args, configuration, &frames, see)?;
    if let (Some(views), Some(estimated)) = (views, &estimated) {
        views.finish(&estimated.exchange.impacts);
    }
    if let Some(estimated) = estimated {
        let seen = frames.iter().map(|sampled| sampled.frame);
        summary.estimator = Some(EstimatorSummary::from_exchange(
            &resolved,
            (&forced.run.samples, &forced.run.impacts),
            &estimated.exchange,
            &same_signals::follow(&resolved, &configuration, seen)?,
            estimated.differences,
        ));
        (exchange, recording) = (Some(estimated.exchange), estimated.recording);
    }
    bar.finish_and_clear();
    Ok(Finished { bench: resolved, summary, forced, law, exchange, recording })
}

/// Terms of the energy balance in J, and its relative residual.
fn energy_terms(forced: &ForcedRun) -> serde_json::Map<String, serde_json::Value> {
    let terms = forced.run.energy.terms();
    terms.map(|(name, value)| (name.to_owned(), value.into())).into_iter().collect()
}

/// Title of a run's live views.
fn title(bench: &TransmissionBench, args: &RunArgs) -> String {
    format!(
        "{}, {:.2} mm, {:+.1} kN, {}",
        bench.bearing.material.name(),
        bench.bearing.radial_clearance_m * 1e3,
        bench.load.force_n * 1e-3,
        transport(args),
    )
}

/// Name of a run's transport.
fn transport(args: &RunArgs) -> String {
    format!("{:?}", args.controller).to_lowercase()
}

/// Begins the live view of a run on a server.
fn feed(server: &Server, bench: &TransmissionBench, samples: usize, (args, pace): (&RunArgs, Pace)) -> Feed {
    let start = Start {
        title: title(bench, args),
        controller: transport(args),
        duration_s: bench.duration_s(),
        clearance_nm: bench.bearing.radial_clearance_m * 1e9,
        sample_rate_hz: SAMPLE_RATE_HZ,
        block_samples: 0,
        flags: FlagName::all(),
    };
    server.feed(start, samples as u64, pace.speed())
}

/// Creates the live view of a run in the terminal.
fn scene(bench: &TransmissionBench, forced: &ForcedRun, args: &RunArgs) -> Scene {
    let truth = forced.run.samples.iter().map(|s| (s.time_s, s.forces.normal_n));
    Scene::new(title(bench, args), bench.duration_s(), bench.bearing.radial_clearance_m, truth)
}

/// Checks the options for drop-outs.
fn drop_out(args: &RunArgs) -> Result<DropOut, CliError> {
    let refuse = |option: &str, found: f64, expected: &str| {
        Err(CliError::Input(format!("{option}: found {found}; expected {expected}")))
    };
    let (share, samples) = (args.dropout_share, args.dropout_samples);
    if !(0.0..=0.9).contains(&share) {
        return refuse("--dropout-share", share, "0 to 0.9");
    }
    if !(1.0..=1e6).contains(&samples) || samples.fract() != 0.0 {
        return refuse("--dropout-samples", samples, "an integer, 1 to 1000000");
    }
    Ok(DropOut { share, samples })
}
