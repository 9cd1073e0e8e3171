//! A mechanism from its description.

use super::builder::{BodyIndex, Builder, Laws};
use super::{Body, DriveMotion, Mechanism, MechanismRun, RunOptions};
use crate::description::{BodySection, JointKind, JointSection, MechanismBench};
use crate::integrate::IntegrationError;
use crate::plants::contact_laws::{BearingFriction, JointLaw};
use crate::simulate::peaks::TIGHTER;
use contact::{Joint, LawError};

impl MechanismBench {
    /// Laws of a joint's contacts; none if the joint names no law.
    pub(crate) fn laws(&self, joint: &JointSection) -> Option<Result<Laws, LawError>> {
        let name = joint.contact.as_ref()?;
        let entry = self.contact.iter().find(|entry| entry.name == *name)?;
        let section = entry.contact_section();
        let [bearing, journal] = entry.materials();
        // Laws that follow from the geometry of a bearing refuse a joint without one.
        let geometry = Joint {
            bearing_radius_m: joint.bearing_radius_m.unwrap_or_default(),
            radial_clearance_m: joint.clearance_m.unwrap_or_default(),
            length_m: joint.length_m.unwrap_or_default(),
            bearing,
            journal,
        };
        // Only Liu's and the logarithmic laws use the length; Hertz' sphere has none.
        let geometry = match (joint.kind, section.stiffness.0) {
            (JointKind::Clearance, contact::StiffnessKind::Hertz) => Joint { length_m: 1.0, ..geometry },
            (JointKind::Clearance, contact::StiffnessKind::HybridAsPrinted) => {
                Joint { length_m: 1.0, ..geometry }
            }
            _ => geometry,
        };
        let mass = |name: &str| self.body_index(name).and_then(|i| self.body.get(i)).map(|b| b.mass_kg);
        let mass_kg = mass(&joint.second).or(mass(&joint.first)).unwrap_or(1.0);
        let friction = entry.friction_section().map(|friction| BearingFriction::from_section(&friction));
        let law = JointLaw::from_section(&section, geometry, entry.restitution, mass_kg);
        Some(law.and_then(|law| Ok((law, friction.transpose()?))))
    }

    /// Builds the mechanism. A law that a later change took out of its range is an error.
    pub fn mechanism(&self) -> Result<Mechanism, LawError> {
        let stabilisation_per_s = self.run.stabilisation_per_s.unwrap_or(1.0 / self.run.largest_step_s);
        let mut builder = Builder::new(self.run.gravity_m_s2, stabilisation_per_s);
        for body in &self.body {
            add_body(&mut builder, body);
        }
        for joint in &self.joint {
            self.add_joint(&mut builder, joint)?;
        }
        let pair = |first: &str, second: &str| [self.body_index(first), self.body_index(second)];
        for spring in &self.spring {
            let bodies = pair(&spring.first, &spring.second);
            let size = (spring.stiffness, spring.damping);
            match (spring.from_m, spring.to_m) {
                (Some(from), Some(to)) => builder.spring(bodies, [from, to], size, spring.free_length_m),
                _ => builder.torsional_spring(bodies, size),
            }
        }
        for load in &self.load {
            let body = self.body_index(&load.body);
            let at_m = load.at_m.unwrap_or_else(|| builder.centre_m(body));
            builder.load(body, at_m, (load.force_n, load.torque_nm), load.ramp_s);
        }
        Ok(builder.build())
    }

    fn add_joint(&self, builder: &mut Builder, joint: &JointSection) -> Result<(), LawError> {
        let bodies: [BodyIndex; 2] = [self.body_index(&joint.first), self.body_index(&joint.second)];
        let (at_m, axis) = (joint.at_m, joint.axis());
        let laws = || self.laws(joint).unwrap_or(Err(LawError::UnknownName { group: "contact" }));
        let clearance_m = joint.clearance_m.unwrap_or_default();
        match joint.kind {
            JointKind::Revolute => builder.revolute(bodies, at_m),
            JointKind::Prismatic => builder.prismatic(bodies, at_m, axis),
            JointKind::Slot => builder.slot(bodies, at_m, axis),
            JointKind::Rod => builder.rod(bodies, [at_m, joint.to_m.unwrap_or(at_m)]),
            JointKind::Weld => builder.weld(bodies, at_m),
            JointKind::Clearance => {
                let radius_m = joint.bearing_radius_m.unwrap_or_default();
                let radii_m = [radius_m, radius_m - clearance_m];
                builder.clearance(bodies, at_m, joint.offset_m, radii_m, laws()?);
            }
            JointKind::Guide => {
                let length_m = joint.length_m.unwrap_or_default();
                let height_m = joint.height_m.unwrap_or_default();
                builder.guide(bodies, at_m, axis, [length_m, height_m, clearance_m], laws()?);
            }
        }
        if !joint.is_driven() {
            return Ok(());
        }
        let motion = DriveMotion {
            speed: joint.drive_speed.unwrap_or_default(),
            amplitude: joint.drive_amplitude.unwrap_or_default(),
            stroke: joint.drive_stroke.unwrap_or_default(),
            period_s: joint.drive_period_s.unwrap_or(1.0),
        };
        let axis = (joint.kind == JointKind::Prismatic).then_some(axis);
        match joint.backlash_m {
            Some(play_m) => {
                let flanks = (play_m, joint.flank_radius_m);
                builder.drive_with_backlash((bodies, at_m, axis), motion, flanks, laws()?);
            }
            None => builder.drive(bodies, at_m, axis, motion),
        }
        Ok(())
    }

    /// Runs the described mechanism at a relative tolerance and records it at ascending times.
    pub fn simulate(&self, samples_s: &[f64], tolerance: f64) -> Result<MechanismRun, IntegrationError> {
        let mechanism = self
            .mechanism()
            .map_err(|error| IntegrationError::Stopped { time_s: 0.0, reason: error.to_string() })?;
        let options = RunOptions {
            duration_s: self.run.duration_s,
            tolerance,
            largest_step_s: self.run.largest_step_s,
            is_closed: self.run.closed_start,
        };
        mechanism.run(samples_s, &options)
    }
}

/// Run of a mechanism with the numerical error bar of each peak force.
#[derive(Clone, Debug)]
pub struct RunWithBars {
    /// The run, at the tighter tolerance.
    pub run: MechanismRun,
    /// Distance of each impact's peak force in N from that of a coarser run; infinite for an impact
    /// that only the finer run has.
    pub bars_n: Vec<f64>,
}

impl MechanismBench {
    /// Runs the described mechanism at its tolerance and at a tighter one.
    pub fn simulate_with_bars(&self, samples_s: &[f64]) -> Result<RunWithBars, IntegrationError> {
        let coarse = self.simulate(&[], self.run.tolerance)?;
        let run = self.simulate(samples_s, self.run.tolerance * TIGHTER)?;
        let nth = |run: &MechanismRun, contact: usize, n: usize| {
            run.impacts.iter().filter(|i| i.contact == contact).nth(n).map(|i| i.peak_force_n)
        };
        let mut seen = vec![0; self.joint.iter().map(JointSection::contacts).sum()];
        let bars = run.impacts.iter().map(|impact| {
            let n = seen.get(impact.contact).copied().unwrap_or_default();
            if let Some(count) = seen.get_mut(impact.contact) {
                *count += 1;
            }
            let other = nth(&coarse, impact.contact, n);
            other.map_or(f64::INFINITY, |peak_n| (peak_n - impact.peak_force_n).abs())
        });
        let bars_n = bars.collect();
        Ok(RunWithBars { run, bars_n })
    }

    /// Names of the contacts in the order of a run: the two bodies, and a number where a joint has
    /// several contacts.
    pub fn contact_names(&self) -> Vec<String> {
        let of_joint = |joint: &JointSection| {
            let (pair, count) = (format!("{}_{}", joint.first, joint.second), joint.contacts());
            (1..=count).map(move |n| if count == 1 { pair.clone() } else { format!("{pair}_{n}") })
        };
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

    /// Name and unit of the force of each drive, in the order of a run; a drive with backlash acts
    /// through its contacts.
    pub fn drive_names(&self) -> Vec<(String, &'static str)> {
        let drives = self.joint.iter().filter(|joint| joint.is_driven() && joint.backlash_m.is_none());
        let name = |joint: &JointSection| {
            let unit = if joint.kind == JointKind::Prismatic { "n" } else { "nm" };
            (format!("{}_{}", joint.first, joint.second), unit)
        };
        drives.map(name).collect()
    }
}

fn add_body(builder: &mut Builder, body: &BodySection) {
    let [vx, vy] = body.velocity_m_s;
    let start_rate = [vx, vy, body.speed_rad_s];
    if let (Some(from), Some(to)) = (body.from_m, body.to_m) {
        builder.bar(body.mass_kg, body.inertia_kg_m2, [from, to], start_rate);
        return;
    }
    let [x, y] = body.at_m.unwrap_or_default();
    let inertia_kg_m2 = body.inertia_kg_m2.unwrap_or(f64::NAN);
    builder.body(Body { mass_kg: body.mass_kg, inertia_kg_m2, start: [x, y, body.angle_rad], start_rate });
}
