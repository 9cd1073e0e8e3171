//! Results of a run of the two-plane bench: tilt, load along the length, edges.

use super::{STATES, State, TwoPlane};
use crate::integrate::{Impact, IntegrationError, integrate_slices};
use crate::plants::energy::EnergyAudit;
use crate::plants::transmission::{BearingForces, ContactView, Snapshot};
use crate::signals::Motion;

/// One slice of the bearing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SliceLoad {
    /// Middle of the slice from the middle of the bearing, m.
    pub position_m: f64,
    /// The contact.
    pub contact: ContactView,
    /// Normal force of the slice in N.
    pub normal_n: f64,
    /// Friction force of the slice in N.
    pub friction_n: f64,
    /// Normal force per length in N/m.
    pub line_load_n_m: f64,
}

/// All quantities of the bench at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoPlaneSnapshot {
    /// The bench in the form of the planar model's snapshot: journal in the bearing's middle plane,
    /// total forces. The contact is that of the slice with the largest load.
    pub planar: Snapshot,
    /// Tilt of the shaft about the Y axis in rad (positive lowers the end at positive `s`).
    pub tilt_about_y_rad: f64,
    /// Tilt of the shaft about the Z axis in rad (positive moves the end at positive `s` along +Y).
    pub tilt_about_z_rad: f64,
    /// Moment of the bearing's Y forces about its middle, N m.
    pub moment_y_nm: f64,
    /// Moment of the bearing's Z forces about its middle, N m.
    pub moment_z_nm: f64,
    /// The slices along the length.
    pub slices: Vec<SliceLoad>,
}

impl TwoPlaneSnapshot {
    /// Ratio of the larger line load of the two end slices to the mean: 1 for an even load, 0
    /// without contact.
    pub fn edge_ratio(&self) -> f64 {
        let mean = self.slices.iter().map(|s| s.line_load_n_m).sum::<f64>() / self.slices.len() as f64;
        let ends = [self.slices.first(), self.slices.last()];
        let edge = ends.into_iter().flatten().map(|s| s.line_load_n_m).fold(0.0, f64::max);
        if mean > 0.0 { edge / mean } else { 0.0 }
    }
}

/// Result of a run of the two-plane bench.
#[derive(Clone, Debug)]
pub struct TwoPlaneRun {
    /// States of the bench at the requested times.
    pub samples: Vec<TwoPlaneSnapshot>,
    /// Periods in contact, each with its slice.
    pub impacts: Vec<Impact>,
    /// The energy balance.
    pub energy: EnergyAudit,
    /// Losses from the start up to every sample in J, as in [`crate::simulate::Run`].
    pub losses_j: Vec<[f64; 3]>,
    /// Integrator steps.
    pub steps: usize,
}

/// Integrates the plant with its analytic laws.
pub fn run_two_plane(
    plant: &TwoPlane,
    end_s: f64,
    samples_s: &[f64],
    tolerance: f64,
) -> Result<TwoPlaneRun, IntegrationError> {
    let start_s = samples_s.first().copied().unwrap_or_default().min(end_s);
    let initial = plant.initial_state();
    let mut samples = Vec::with_capacity(samples_s.len());
    let mut losses_j = Vec::with_capacity(samples_s.len());
    let result = integrate_slices(
        plant,
        (start_s, end_s),
        initial,
        &[],
        samples_s,
        &plant.tolerances(tolerance),
        |t, s, latched| {
            samples.push(plant.snapshot(t, s, latched));
            losses_j.push([s[11], s[12], s[13]]);
        },
    )?;
    let deformation_m = result.impacts.iter().map(|i| i.max_deformation_m).fold(0.0, f64::max);
    if let Some(largest_m) = plant.joint_law.law.largest_deformation_m().filter(|l| deformation_m > *l) {
        return Err(IntegrationError::OutsideLaw { deformation_m, largest_m });
    }
    let energy = plant.audit((start_s, &initial), (end_s, &result.state));
    Ok(TwoPlaneRun { samples, impacts: result.impacts, energy, losses_j, steps: result.steps })
}

impl TwoPlane {
    /// Returns all quantities at a state with the latched speeds of the slices, `None` in a gap.
    pub fn snapshot(&self, time_s: f64, s: &State, latched_m_s: &[Option<f64>]) -> TwoPlaneSnapshot {
        let crank = self.crank(time_s, s);
        let sums = self.sums(time_s, &crank, s, latched_m_s);
        let mut derivative = [0.0; STATES];
        let drive_force_n = self.motion(time_s, s, &crank, &sums, &mut derivative);
        let width = self.length_m * self.share();
        let load = |(&position_m, latched): (&f64, &Option<f64>)| {
            let slice = self.slice(position_m, &crank, s);
            let (normal_n, friction_n) =
                latched.map_or((0.0, 0.0), |l| self.slice_forces_n(time_s, &slice, l));
            let contact = ContactView {
                radial_clearance_m: self.radial_clearance_m,
                deformation_m: slice.depth_m,
                rate_m_s: slice.rate_m_s,
                latched_m_s: latched.unwrap_or_default(),
                sliding_speed_m_s: slice.sliding_m_s,
            };
            SliceLoad { position_m, contact, normal_n, friction_n, line_load_n_m: normal_n / width }
        };
        let slices: Vec<SliceLoad> = self.positions_m.iter().zip(latched_m_s).map(load).collect();
        let hardest = slices.iter().max_by(|a, b| a.normal_n.total_cmp(&b.normal_n));
        let forces = BearingForces {
            normal_n: slices.iter().map(|l| l.normal_n).sum(),
            friction_n: slices.iter().map(|l| l.friction_n).sum(),
        };
        let drive: Motion = self.drive(time_s);
        let planar = Snapshot {
            time_s,
            angle_rad: crank.sin.asin(),
            speed_rad_s: crank.speed_rad_s,
            y_m: s[0],
            z_m: s[1],
            contact: hardest.map_or(ContactView::default(), |l| l.contact),
            forces,
            force_y_n: sums.force_y,
            force_z_n: sums.force_z,
            friction_torque_nm: sums.torque,
            drive_force_n,
            load_force_n: self.load_n(time_s),
            drive,
        };
        TwoPlaneSnapshot {
            planar,
            tilt_about_y_rad: -s[5],
            tilt_about_z_rad: s[4],
            moment_y_nm: sums.moment_y,
            moment_z_nm: sums.moment_z,
            slices,
        }
    }
}
