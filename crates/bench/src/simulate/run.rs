//! Runs of the transmission bench with its analytic laws, or with an external bearing force that is
//! held over a step.

use crate::description::TransmissionBench;
use crate::integrate::{Impact, IntegrationError, integrate};
use crate::plants::energy::EnergyAudit;
use crate::plants::transmission::{
    BearingForces, ContactView, MOVING, PLAIN, Reduced, ServoPlant, Snapshot, Transmission,
};
use crate::plants::two_plane::{TwoPlane, run_two_plane};
use crate::signals::Profile;
use crate::simulate::peaks::Extremes;
use crate::simulate::stepped::HeldMemory;

/// Relative tolerance of a run unless stated otherwise.
pub const DEFAULT_TOLERANCE: f64 = 1e-7;

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// State of the bench at the requested times.
    pub samples: Vec<Snapshot>,
    /// Periods in contact. With a held force their times are those of communication steps.
    pub impacts: Vec<Impact>,
    /// Residual of the energy balance, relative to the drive's absolute work.
    pub energy_residual_rel: f64,
    /// The energy balance.
    pub energy: EnergyAudit,
    /// Losses from the start up to every sample in J: friction heat, damping loss, heat of the load
    /// cylinder.
    pub losses_j: Vec<[f64; 3]>,
    /// Integrator steps.
    pub steps: usize,
    /// Extremes over all communication steps after the load's ramp; only with a held force.
    pub extremes: Option<Extremes>,
}

impl Run {
    fn new(
        (samples, losses_j): (Vec<Snapshot>, Vec<[f64; 3]>),
        (impacts, steps): (Vec<Impact>, usize),
        energy: EnergyAudit,
    ) -> Self {
        let energy_residual_rel = energy.residual_rel;
        Self { samples, impacts, energy_residual_rel, energy, losses_j, steps, extremes: None }
    }
}

impl Transmission {
    /// Refuses contacts that are deeper than the range of the normal law.
    pub(super) fn check_deformation(&self, impacts: &[Impact]) -> Result<(), IntegrationError> {
        let deformation_m = impacts.iter().map(|i| i.max_deformation_m).fold(0.0, f64::max);
        match self.largest_deformation_m().filter(|largest| deformation_m > *largest) {
            Some(largest_m) => Err(IntegrationError::OutsideLaw { deformation_m, largest_m }),
            None => Ok(()),
        }
    }
}

/// Integrates the described bench with its analytic laws: with its servo, if it has one.
pub fn run_bench_with_law(
    bench: &TransmissionBench,
    samples_s: &[f64],
    tolerance: f64,
) -> Result<Run, IntegrationError> {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    match ServoPlant::new(bench, &plant) {
        Some(servo) => run_servo(&servo, &plant, bench.duration_s(), samples_s, tolerance),
        None => run_with_law(&plant, bench.duration_s(), samples_s, tolerance),
    }
}

/// Integrates the plant with its servo.
fn run_servo(
    servo: &ServoPlant<'_>,
    plant: &Transmission,
    end_s: f64,
    samples_s: &[f64],
    tolerance: f64,
) -> Result<Run, IntegrationError> {
    let start_s = samples_s.first().copied().unwrap_or_default().min(end_s);
    let initial = servo.initial_state(start_s);
    let mut samples = Vec::with_capacity(samples_s.len());
    let mut losses_j = Vec::with_capacity(samples_s.len());
    let tolerances = servo.tolerances(tolerance);
    let result =
        integrate(servo, (start_s, end_s), initial, false, samples_s, &tolerances, |t, s, touch| {
            samples.push(servo.snapshot(t, s, touch));
            losses_j.push(plant.losses_j(&ServoPlant::bench_state(s)));
        })?;
    plant.check_deformation(&result.impacts)?;
    let (first, last) = (ServoPlant::bench_state(&initial), ServoPlant::bench_state(&result.state));
    let energy = plant.audit((start_s, &first), (end_s, &last));
    Ok(Run::new((samples, losses_j), (result.impacts, result.steps), energy))
}

/// Integrates the plant with its analytic laws, without a servo.
pub fn run_with_law(
    plant: &Transmission,
    end_s: f64,
    samples_s: &[f64],
    tolerance: f64,
) -> Result<Run, IntegrationError> {
    let start_s = samples_s.first().copied().unwrap_or_default().min(end_s);
    let initial = plant.initial_state(start_s);
    let mut samples = Vec::with_capacity(samples_s.len());
    let mut losses_j = Vec::with_capacity(samples_s.len());
    let result = integrate(
        plant,
        (start_s, end_s),
        initial,
        false,
        samples_s,
        &plant.tolerances(tolerance),
        |t, s, touch| {
            let forces = plant.forces(t, s, touch);
            samples.push(plant.snapshot(t, s, touch.latched_m_s, forces));
            losses_j.push(plant.losses_j(s));
        },
    )?;
    plant.check_deformation(&result.impacts)?;
    let energy = plant.audit((start_s, &initial), (end_s, &result.state));
    Ok(Run::new((samples, losses_j), (result.impacts, result.steps), energy))
}

/// Simulates the bench under a drive and a load with its analytic laws and returns its states at
/// the given times. The plant is planar, or has two planes if the description has a `[two_plane]`
/// section.
pub fn snapshots(
    bench: &TransmissionBench,
    (drive, load): (Profile, Profile),
    end_s: f64,
    samples_s: &[f64],
    tolerance: f64,
) -> Result<Vec<Snapshot>, IntegrationError> {
    if bench.two_plane.is_some() {
        let run = run_two_plane(&TwoPlane::new(bench, drive, load), end_s, samples_s, tolerance)?;
        return Ok(run.samples.into_iter().map(|s| s.planar).collect());
    }
    let plant = Transmission::new(bench, drive, load);
    if let Some(servo) = ServoPlant::new(bench, &plant) {
        return Ok(run_servo(&servo, &plant, end_s, samples_s, tolerance)?.samples);
    }
    if plant.is_plain() {
        run_reduced::<PLAIN>(&plant, end_s, samples_s, tolerance)
    } else {
        run_reduced::<MOVING>(&plant, end_s, samples_s, tolerance)
    }
}

/// Integrates as [`run_with_law`], without the energy balance.
fn run_reduced<const N: usize>(
    plant: &Transmission,
    end_s: f64,
    samples_s: &[f64],
    tolerance: f64,
) -> Result<Vec<Snapshot>, IntegrationError> {
    let start_s = samples_s.first().copied().unwrap_or_default().min(end_s);
    let reduced = Reduced::<N>(plant);
    let initial = reduced.reduce(&plant.initial_state(start_s));
    let mut samples = Vec::with_capacity(samples_s.len());
    let tolerances = reduced.tolerances(tolerance);
    let result =
        integrate(&reduced, (start_s, end_s), initial, false, samples_s, &tolerances, |t, s, touch| {
            let full = reduced.expand(s);
            let forces = plant.forces(t, &full, touch);
            samples.push(plant.snapshot(t, &full, touch.latched_m_s, forces));
        })?;
    plant.check_deformation(&result.impacts)?;
    Ok(samples)
}

/// Integrates the plant with an external bearing force that is held over a communication step of
/// `step_s`.
///
/// `force` reads the contact once per step, extrapolated to the middle of the step. Its components
/// are held in the direction of the contact there, with the description's effects on friction
/// applied. A direction that is half a step late would push the swinging journal along its path and
/// feed the oscillation (10 % in half a second at 5 us). In sustained contact the damping `chi
/// d'/d'0` makes the loop stiff and limits the step; the command `host-sim run --step-us` shows the
/// error against the law.
pub fn run_with_held_force(
    plant: &Transmission,
    end_s: f64,
    samples_s: &[f64],
    step_s: f64,
    mut force: impl FnMut(&ContactView) -> BearingForces,
) -> Result<Run, IntegrationError> {
    let count = (end_s / step_s).round() as usize;
    let mut memory = HeldMemory::start(plant, 0.0);
    let initial = *memory.state();
    let mut samples = Vec::with_capacity(samples_s.len());
    let mut losses_j = Vec::with_capacity(samples_s.len());
    let (mut next_sample, mut hold_loss_j) = (0, 0.0);
    let mut impacts: Vec<Impact> = Vec::new();
    let mut extremes = Extremes::default();
    for step in 0..count {
        let time_s = step as f64 * step_s;
        let moment = memory.step(plant, time_s, step_s, &mut force)?;
        impacts.extend(moment.ended);
        hold_loss_j += moment.hold_loss_j;
        if time_s >= plant.load_ramp_end_s() {
            extremes.update(&moment.snapshot);
        }
        while samples_s.get(next_sample).is_some_and(|&t| t < time_s + 0.5 * step_s) {
            samples.push(moment.snapshot);
            losses_j.push(moment.losses_j);
            next_sample += 1;
        }
    }
    impacts.extend(memory.contact.impact);
    let end_s = count as f64 * step_s;
    let energy = plant.audit((0.0, &initial), (end_s, memory.state())).with_hold_loss(hold_loss_j);
    Ok(Run { extremes: Some(extremes), ..Run::new((samples, losses_j), (impacts, count), energy) })
}
