//! The scenario of every fault: a section of bench B's run as the sensors measure it, with the
//! estimates without fault.
//!
//! The reference estimates are those of the same code in this process. The emulated controller
//! gives the same bits.

use super::CampaignError;
use bench::Bench;
use bench::description::TransmissionBench;
use host_sim::controller::{Controller, NativeController};
use host_sim::run::configuration::controller_configuration;
use host_sim::run::force::{DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ, run_bench};
use host_sim::run::sensing;
use link::track::TrackReport;
use link::{
    Answer, Command, ContactSource, ControllerConfiguration, EstimateFrame, ReportKind, SensorFrame,
    SlowReport,
};

/// Number of samples.
pub const SAMPLES: usize = 6_500;
/// First sample before which a fault may occur: the journal has landed and the load is applied.
pub(crate) const FAULTS_FROM: usize = 1_000;
/// End of the samples before which a fault may occur.
pub(crate) const FAULTS_BEFORE: usize = 2_000;

/// Samples with the estimates without fault.
#[derive(Debug)]
pub struct Scenario {
    /// Configuration of the controller.
    pub configuration: ControllerConfiguration,
    /// Samples, numbered from 0.
    pub frames: Vec<SensorFrame>,
    /// Estimates without fault.
    pub reference: Vec<EstimateFrame>,
    /// Tracked quantities at the end, without fault.
    pub track: TrackReport,
    /// Largest normal force of the reference, N.
    pub force_full_scale_n: f64,
    /// Largest friction torque of the reference, N m.
    pub torque_full_scale_nm: f64,
    /// Largest deformation or gap of the reference, m.
    pub deformation_full_scale_m: f64,
}

/// Simulates one cycle of bench B under its law; returns the sensor frames and the configuration.
pub fn bench_b(seed: u64) -> Result<(ControllerConfiguration, Vec<SensorFrame>), CampaignError> {
    let base = TransmissionBench::open("bench-b").map_err(host_sim::cli::error::CliError::from)?;
    let bench = base.resolved();
    let forced = run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
    let plant =
        bench::plants::transmission::Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let mut configuration = controller_configuration(&plant, &bench, SAMPLE_RATE_HZ, ContactSource::Network)?;
    // Slow telemetry is requested at the end only, so that any other message in between is a
    // report.
    configuration.limits.slow_every = 0;
    let bench = Bench::from(bench);
    Ok((configuration, sensing::frames(&bench, &forced.run.samples, seed)))
}

impl Scenario {
    /// Simulates the bench and computes the reference estimates.
    pub fn new(seed: u64) -> Result<Self, CampaignError> {
        let (configuration, frames) = bench_b(seed)?;
        let frames: Vec<SensorFrame> = frames
            .iter()
            .take(SAMPLES)
            .zip(0..)
            .map(|(frame, sequence)| SensorFrame { sequence, ..*frame })
            .collect();
        let (reference, track) = native(&configuration, &frames)?;
        let largest = |read: fn(&EstimateFrame) -> f32| {
            reference
                .iter()
                .skip(FAULTS_FROM)
                .map(|estimate| f64::from(read(estimate).abs()))
                .fold(0.0, f64::max)
        };
        let force_full_scale_n = largest(|estimate| estimate.normal_force_n);
        let torque_full_scale_nm = largest(|estimate| estimate.friction_torque_nm);
        let deformation_full_scale_m = largest(|estimate| estimate.deformation_m);
        Ok(Self {
            configuration,
            frames,
            reference,
            track,
            force_full_scale_n,
            torque_full_scale_nm,
            deformation_full_scale_m,
        })
    }
}

/// Runs the controller's code in this process over samples.
pub fn native(
    configuration: &ControllerConfiguration,
    frames: &[SensorFrame],
) -> Result<(Vec<EstimateFrame>, TrackReport), CampaignError> {
    let mut controller = NativeController::start(*configuration)?;
    let estimates = frames.iter().map(|frame| controller.exchange(frame)).collect::<Result<_, _>>()?;
    match controller.order(Command::GetReport(ReportKind::Track))? {
        Answer::Report(SlowReport::Track(track)) => Ok((estimates, track)),
        other => Err(CampaignError::Unexpected {
            found: format!("{other:?}"),
            expected: "a report of what is tracked",
        }),
    }
}
