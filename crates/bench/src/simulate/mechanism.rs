//! Runs of a described mechanism, with the names and the error bars that a report needs.

use super::error_bars::error_bars;
use super::peaks::TIGHTER;
use crate::description::{JointKind, JointSection, MechanismBench, distinct};
use crate::integrate::IntegrationError;
#[cfg(doc)]
use crate::plants::mechanism::Snapshot;
use crate::plants::mechanism::{HeldForces, MechanismRun, RunOptions};
use contact::BearingMaterial;
use std::collections::BTreeMap;

/// Run of a mechanism with the numerical error bar of each peak force.
#[derive(Clone, Debug)]
pub struct RunWithBars {
    /// The run, at the tighter tolerance.
    pub run: MechanismRun,
    /// Error bar of each impact's peak force in N, from three runs of different tolerances or
    /// communication steps; infinite for an impact that
    /// only the finest run has.
    pub bars_n: Vec<f64>,
}

impl RunWithBars {
    /// Error bars of a run from two coarser ones.
    pub fn new(run: MechanismRun, middle: &MechanismRun, coarse: Option<&MechanismRun>) -> Self {
        let nth = |run: &MechanismRun, contact: usize, n: usize| {
            run.impacts.iter().filter(|i| i.contact == contact).nth(n).map(|i| i.peak_force_n)
        };
        let mut seen = BTreeMap::new();
        let mut peaks = Vec::with_capacity(run.impacts.len());
        for impact in &run.impacts {
            let count: &mut usize = seen.entry(impact.contact).or_default();
            let n = *count;
            *count += 1;
            let other = |run: &MechanismRun| nth(run, impact.contact, n);
            peaks.push((impact.peak_force_n, other(middle), coarse.and_then(other)));
        }
        let bars_n = error_bars(&peaks);
        Self { run, bars_n }
    }
}

impl MechanismBench {
    /// Runs the described mechanism at a relative tolerance and records it at ascending times.
    pub fn simulate(&self, samples_s: &[f64], tolerance: f64) -> Result<MechanismRun, IntegrationError> {
        self.simulate_with(samples_s, tolerance, None)
    }

    /// Runs the described mechanism as [`Self::simulate`], with contact forces that are held.
    pub fn simulate_held(
        &self,
        samples_s: &[f64],
        tolerance: f64,
        mut held: HeldForces<'_>,
    ) -> Result<MechanismRun, IntegrationError> {
        self.simulate_with(samples_s, tolerance, Some(&mut held))
    }

    fn simulate_with(
        &self,
        samples_s: &[f64],
        tolerance: f64,
        held: Option<&mut HeldForces<'_>>,
    ) -> Result<MechanismRun, IntegrationError> {
        let mechanism = self
            .mechanism()
            .map_err(|error| IntegrationError::Stopped { time_s: 0.0, reason: error.to_string() })?;
        mechanism.run(samples_s, &self.run_options(tolerance), held)
    }

    /// Options of a run at a relative tolerance.
    pub(super) fn run_options(&self, tolerance: f64) -> RunOptions {
        RunOptions {
            duration_s: self.run.duration_s,
            tolerance,
            largest_step_s: self.run.largest_step_s,
            is_closed: self.run.closed_start,
        }
    }

    /// Runs the described mechanism at its tolerance, a tighter and a wider one.
    pub fn simulate_with_bars(&self, samples_s: &[f64]) -> Result<RunWithBars, IntegrationError> {
        let middle = self.simulate(&[], self.run.tolerance)?;
        // A run that is too coarse to succeed leaves wider bars.
        let coarse = self.simulate(&[], self.run.tolerance / TIGHTER).ok();
        let run = self.simulate(samples_s, self.run.tolerance * TIGHTER)?;
        Ok(RunWithBars::new(run, &middle, coarse.as_ref()))
    }

    /// Bearing material whose networks give the forces of each contact, in the order of a run.
    pub fn networks(&self) -> Vec<Option<BearingMaterial>> {
        let of_joint = |joint: &JointSection| {
            let entry = self.contact.iter().find(|entry| Some(&entry.name) == joint.contact.as_ref());
            std::iter::repeat_n(entry.and_then(|entry| entry.network), joint.contacts())
        };
        self.joint.iter().flat_map(of_joint).collect()
    }

    /// Names of the contacts in the order of a run: the two bodies, and a number where a joint has
    /// several contacts.
    pub fn contact_names(&self) -> Vec<String> {
        let of_joint = |(name, joint): (String, &JointSection)| {
            let count = joint.contacts();
            (1..=count).map(move |n| if count == 1 { name.clone() } else { format!("{name}_{n}") })
        };
        distinct(self.named_joints().flat_map(of_joint).collect())
    }

    /// Names of the columns of a log after the time, in the order of [`Snapshot::row`].
    pub fn columns(&self) -> Vec<String> {
        let with = |name: &str, quantities: &[&str]| -> Vec<String> {
            quantities.iter().map(|quantity| format!("{name}_{quantity}")).collect()
        };
        let bodies = self.body.iter().flat_map(|body| with(&body.name, &["x_m", "y_m", "angle_rad"]));
        let contacts = self
            .contact_names()
            .into_iter()
            .flat_map(|name| with(&name, &["deformation_m", "normal_n", "friction_n", "sliding_m_s"]));
        let drives = self.drive_names().into_iter().map(|(name, unit)| format!("{name}_drive_{unit}"));
        bodies.chain(contacts).chain(drives).collect()
    }

    /// Returns for each contact in the order of a run whether it is that of a clearance joint.
    pub(crate) fn are_clearance(&self) -> Vec<bool> {
        let of_joint =
            |joint: &JointSection| std::iter::repeat_n(joint.kind == JointKind::Clearance, joint.contacts());
        self.joint.iter().flat_map(of_joint).collect()
    }

    /// Floor of the latched approach speed of each contact in m/s, in the order of a run.
    pub fn latch_floors_m_s(&self) -> Vec<f64> {
        let floor = |joint: &JointSection| {
            let entry = self.contact.iter().find(|entry| Some(&entry.name) == joint.contact.as_ref());
            let floor = entry.map_or(0.0, |entry| entry.latch_floor_m_s);
            std::iter::repeat_n(floor, joint.contacts())
        };
        self.joint.iter().flat_map(floor).collect()
    }

    /// Joints with a drive without backlash, in the order of a run.
    pub(crate) fn drives(&self) -> impl Iterator<Item = &JointSection> {
        self.joint.iter().filter(|joint| joint.has_stiff_drive())
    }

    /// Name and unit of the force of each drive, in the order of a run; a drive with backlash acts
    /// through its contacts.
    pub fn drive_names(&self) -> Vec<(String, &'static str)> {
        let unit = |joint: &JointSection| if joint.kind == JointKind::Prismatic { "n" } else { "nm" };
        let drives = self.named_joints().filter(|(_, joint)| joint.has_stiff_drive());
        drives.map(|(name, joint)| (name, unit(joint))).collect()
    }
}
