//! A mechanism from its description.

use super::builder::{BodyIndex, Builder, Laws};
use super::{Body, DriveMotion, Mechanism};
use crate::description::{BodySection, JointKind, JointSection, MechanismBench};
use crate::plants::contact_laws::{BearingFriction, JointLaw};
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
        // Effective mass of the pair, which some laws need; the ground has an infinite one.
        let inverse_kg = [&joint.first, &joint.second].into_iter().filter_map(|name| Some(1.0 / mass(name)?));
        let mass_kg = 1.0 / inverse_kg.sum::<f64>();
        let friction =
            entry.friction_section().map(|friction| BearingFriction::from_section(&friction, None));
        let law = JointLaw::from_section(&section, geometry, entry.restitution, mass_kg);
        Some(law.and_then(|law| Ok((law, friction.transpose()?))))
    }

    /// Builds the mechanism. A law that a later change took out of its range is an error.
    pub(crate) fn mechanism(&self) -> Result<Mechanism, LawError> {
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
        let motion = joint.motion();
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
}

impl JointSection {
    /// Prescribed motion of a driven joint.
    pub(crate) fn motion(&self) -> DriveMotion {
        DriveMotion {
            speed: self.drive_speed.unwrap_or_default(),
            amplitude: self.drive_amplitude.unwrap_or_default(),
            stroke: self.drive_stroke.unwrap_or_default(),
            period_s: self.drive_period_s.unwrap_or(1.0),
        }
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
