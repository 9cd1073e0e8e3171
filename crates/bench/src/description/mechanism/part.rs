//! Parts of a mechanism by name, on which effects act and whose numbers may be uncertain.

use super::{ContactEntry, JointKind, JointSection, MechanismBench, SpringSection};

/// Kind of part on which an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Body.
    Body,
    /// Joint with a clearance: a bearing with its journal, or a guide with its slider.
    Clearance,
    /// Joint with contacts: one with a clearance, or a drive with backlash.
    Contact,
    /// Joint about which two bodies turn.
    Pin,
    /// Drive with backlash.
    Backlash,
}

impl Part {
    fn contains(self, joint: &JointSection) -> bool {
        match self {
            Self::Body => false,
            Self::Clearance => joint.clearance_m.is_some(),
            Self::Contact => joint.contact.is_some(),
            Self::Pin => matches!(joint.kind, JointKind::Revolute | JointKind::Clearance),
            Self::Backlash => joint.backlash_m.is_some(),
        }
    }
}

impl MechanismBench {
    /// Joints with their names: the two bodies, and a number if a joint of the same bodies comes
    /// before.
    pub(crate) fn named_joints(&self) -> impl Iterator<Item = (String, &JointSection)> {
        let pairs = self.joint.iter().map(|joint| format!("{}_{}", joint.first, joint.second));
        super::distinct(pairs.collect()).into_iter().zip(&self.joint)
    }

    /// Names of the parts of a kind.
    pub(crate) fn parts(&self, part: Part) -> Vec<String> {
        if part == Part::Body {
            return self.body.iter().map(|body| body.name.clone()).collect();
        }
        self.named_joints().filter(|(_, joint)| part.contains(joint)).map(|(name, _)| name).collect()
    }

    /// A joint by its name, for changes.
    pub(crate) fn joint_mut(&mut self, name: &str) -> Option<&mut JointSection> {
        let index = self.named_joints().position(|(own, _)| own == name)?;
        self.joint.get_mut(index)
    }

    /// Laws of a joint's contacts, for changes that leave those of other joints as they are. They
    /// replace networks of the joint, which know no changed law.
    pub(crate) fn own_contact_mut(&mut self, name: &str) -> Option<&mut ContactEntry> {
        let shared = self.joint_mut(name)?.contact.clone()?;
        let users = self.joint.iter().filter(|joint| joint.contact.as_ref() == Some(&shared)).count();
        let own = if users > 1 { self.separate_contact(name, &shared)? } else { shared };
        let entry = self.contact.iter_mut().find(|entry| entry.name == own)?;
        entry.network = None;
        Some(entry)
    }

    /// Gives a joint a copy of its laws, and returns the copy's name.
    fn separate_contact(&mut self, joint: &str, shared: &str) -> Option<String> {
        let entry = self.contact.iter().find(|entry| entry.name == shared)?;
        let own = format!("{shared} of {joint}");
        let copy = ContactEntry { name: own.clone(), ..entry.clone() };
        self.contact.push(copy);
        self.joint_mut(joint)?.contact = Some(own.clone());
        Some(own)
    }

    /// Adds a torsional spring with a damper between the bodies of a joint, N m/rad and N m s/rad.
    pub(crate) fn add_torsion(&mut self, joint: &str, stiffness: f64, damping: f64) {
        let Some(joint) = self.joint_mut(joint) else { return };
        let (first, second) = (joint.first.clone(), joint.second.clone());
        let torsion = SpringSection {
            first,
            second,
            from_m: None,
            to_m: None,
            stiffness,
            damping,
            free_length_m: None,
        };
        self.spring.push(torsion);
    }

    /// Returns whether calibration and effects left every joint a possible clearance.
    pub fn has_clearances(&self) -> bool {
        let is_possible = |joint: &JointSection| {
            let radius_m = joint.bearing_radius_m.unwrap_or(f64::INFINITY);
            joint.clearance_m.is_none_or(|clearance_m| clearance_m > 0.0 && clearance_m < radius_m)
        };
        self.joint.iter().all(is_possible)
    }

    /// Moves every journal that would begin beyond its clearance, because calibration has reduced
    /// it, to the surface of its bearing.
    pub fn limit_offsets(&mut self) {
        for joint in &mut self.joint {
            let distance_m = joint.offset_m[0].hypot(joint.offset_m[1]);
            if let Some(clearance_m) = joint.clearance_m.filter(|clearance_m| distance_m > *clearance_m) {
                // Below the clearance by more than rounding.
                let factor = clearance_m / distance_m * (1.0 - 1e-12);
                joint.offset_m = joint.offset_m.map(|component| component * factor);
            }
        }
    }

    /// A number that may be declared uncertain: `body.NAME.FIELD`, `joint.NAME.FIELD` or
    /// `contact.NAME.FIELD`.
    pub(super) fn part_number_mut(&mut self, path: &str) -> Option<&mut f64> {
        let (section, rest) = path.split_once('.')?;
        let (name, field) = rest.rsplit_once('.')?;
        match section {
            "body" => {
                let body = self.body.iter_mut().find(|body| body.name == name)?;
                match field {
                    "mass_kg" => Some(&mut body.mass_kg),
                    "inertia_kg_m2" => body.inertia_kg_m2.as_mut(),
                    _ => None,
                }
            }
            "joint" => {
                let joint = self.joint_mut(name)?;
                match field {
                    "clearance_m" => joint.clearance_m.as_mut(),
                    "backlash_m" => joint.backlash_m.as_mut(),
                    "drive_speed" => joint.drive_speed.as_mut(),
                    _ => None,
                }
            }
            "contact" => {
                let entry = self.contact.iter_mut().find(|entry| entry.name == name)?;
                match field {
                    "youngs_modulus_pa" => Some(&mut entry.youngs_modulus_pa),
                    "coefficient" => entry.coefficient.as_mut(),
                    "restitution" => Some(&mut entry.restitution),
                    "coulomb_coefficient" => Some(&mut entry.coulomb_coefficient),
                    _ => None,
                }
            }
            _ => None,
        }
    }
}
