//! What every fault is tried on: a stretch of bench B's run as the controller's sensors see it, and what the sound controller makes of it.
//!
//! The sound estimates are those of the same code in this process, which the emulated one equals to the bit as long as nothing is wrong.

use super::CampaignError;
use bench::Bench;
use host_sim::controller::{Controller, NativeController};
use host_sim::estimator::controller_configuration;
use host_sim::force::{DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ, run_bench};
use host_sim::paper::resolved;
use host_sim::sensing;
use link::track::TrackReport;
use link::{Answer, Command, ControllerConfiguration, EstimateFrame, ReportKind, SensorFrame, SlowReport};

/// Samples of the stretch.
pub const SAMPLES: usize = 6_500;
/// A fault happens before one of these samples: the journal has landed, the load is up.
pub const FAULTS_FROM: usize = 1_000;
/// As [`FAULTS_FROM`].
pub const FAULTS_BEFORE: usize = 2_000;

/// The stretch.
#[derive(Debug)]
pub struct Stage {
    /// What the controller is told.
    pub configuration: ControllerConfiguration,
    /// The samples, numbered from 0.
    pub frames: Vec<SensorFrame>,
    /// The sound estimates.
    pub sound: Vec<EstimateFrame>,
    /// What the sound controller has learnt at the end.
    pub track: TrackReport,
    /// Largest normal force of the sound estimates, N.
    pub force_full_scale_n: f64,
    /// Largest friction torque, N m.
    pub torque_full_scale_nm: f64,
    /// Largest deformation or gap, m.
    pub deformation_full_scale_m: f64,
}

/// One cycle of bench B under its law, as its sensors read it, with the configuration for it.
pub fn bench_b(seed: u64) -> Result<(ControllerConfiguration, Vec<SensorFrame>), CampaignError> {
    let Bench::Transmission(base) = Bench::open("bench-b").map_err(host_sim::error::CliError::from)? else {
        return Err(CampaignError::Unexpected { found: "another plant".into(), expected: "bench-b" });
    };
    let bench = resolved(*base)?;
    let forced = run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
    let plant = bench::transmission::Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let mut configuration = controller_configuration(&plant, &bench, SAMPLE_RATE_HZ)?;
    // Slow telemetry is asked for at the end; in between every answer that is no estimate means something.
    configuration.limits.slow_every = 0;
    let bench = Bench::Transmission(Box::new(bench));
    Ok((configuration, sensing::frames(&bench, &forced.run.samples, seed)))
}

impl Stage {
    /// Simulates the bench and has the sound controller follow it.
    pub fn new(seed: u64) -> Result<Self, CampaignError> {
        let (configuration, frames) = bench_b(seed)?;
        let frames: Vec<SensorFrame> = frames
            .iter()
            .take(SAMPLES)
            .zip(0..)
            .map(|(frame, sequence)| SensorFrame { sequence, ..*frame })
            .collect();
        let (sound, track) = native(&configuration, &frames)?;
        let largest = |read: fn(&EstimateFrame) -> f32| {
            sound.iter().skip(FAULTS_FROM).map(|estimate| f64::from(read(estimate).abs())).fold(0.0, f64::max)
        };
        let force_full_scale_n = largest(|estimate| estimate.normal_force_n);
        let torque_full_scale_nm = largest(|estimate| estimate.friction_torque_nm);
        let deformation_full_scale_m = largest(|estimate| estimate.deformation_m);
        Ok(Self {
            configuration,
            frames,
            sound,
            track,
            force_full_scale_n,
            torque_full_scale_nm,
            deformation_full_scale_m,
        })
    }
}

/// What the controller's code in this process makes of samples.
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
