//! Course of a run whose settled operation is described.

use crate::integrate::Impact;
use crate::plants::transmission::Snapshot;
use crate::simulate::Run;

/// Course of a run, in samples of a constant rate.
#[derive(Clone, Copy, Debug)]
pub struct Course<'a> {
    pub(super) samples: &'a [Snapshot],
    pub(super) losses: &'a [[f64; 3]],
    pub(super) impacts: &'a [Impact],
    pub(super) end_losses: [f64; 3],
    pub(super) rate_hz: f64,
    pub(super) cycle_s: f64,
    pub(super) end_s: f64,
    pub(super) counted_from_s: f64,
}

impl<'a> Course<'a> {
    /// Course of a run that was sampled at a rate. Its cycles are `cycle_s` long, and its peaks
    /// count from `counted_from_s` on.
    pub fn new(run: &'a Run, rate_hz: f64, cycle_s: f64, end_s: f64, counted_from_s: f64) -> Self {
        let energy = &run.energy;
        Self {
            samples: &run.samples,
            losses: &run.losses_j,
            impacts: &run.impacts,
            end_losses: [energy.friction_heat_j, energy.damping_loss_j, energy.load_friction_heat_j],
            rate_hz,
            cycle_s,
            end_s,
            counted_from_s,
        }
    }

    /// Loss up to a sample in J; up to the end after the last one.
    pub(super) fn loss(&self, sample: usize, part: usize) -> f64 {
        let losses = self.losses.get(sample).unwrap_or(&self.end_losses);
        losses.get(part).copied().unwrap_or_default()
    }
}
