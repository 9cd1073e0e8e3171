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
    /// Names of the joints: the two bodies, and a number if joints of the same bodies come before.
    fn joint_names(&self) -> Vec<String> {
        super::distinct(self.joint.iter().map(JointSection::pair).collect())
    }

    /// Names of the parts of a kind.
    pub(crate) fn parts(&self, part: Part) -> Vec<String> {
        if part == Part::Body {
            return self.body.iter().map(|body| body.name.clone()).collect();
        }
        let named = self.joint_names().into_iter().zip(&self.joint);
        named.filter(|(_, joint)| part.contains(joint)).map(|(name, _)| name).collect()
    }

    /// A joint by its name, for changes.
    pub(crate) fn joint_mut(&mut self, name: &str) -> Option<&mut JointSection> {
        let index = self.joint_names().iter().position(|own| own == name)?;
        self.joint.get_mut(index)
    }

    /// Laws of a joint's contacts, for changes that leave those of other joints as they are.
    pub(crate) fn own_contact_mut(&mut self, name: &str) -> Option<&mut ContactEntry> {
        let shared = self.joint_mut(name)?.contact.clone()?;
        let users = self.joint.iter().filter(|joint| joint.contact.as_ref() == Some(&shared)).count();
        let own = if users > 1 { self.separate_contact(name, &shared)? } else { shared };
        self.contact.iter_mut().find(|entry| entry.name == own)
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

    /// Returns whether effects left every joint a clearance.
    pub fn has_clearances(&self) -> bool {
        self.joint.iter().all(|joint| joint.clearance_m.is_none_or(|clearance_m| clearance_m > 0.0))
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
