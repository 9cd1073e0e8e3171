//! Checks of a mechanism's description beyond the ranges of its fields: names, and the fields that
//! each kind of joint needs and uses.

use super::{GROUND, JointKind, JointSection, MechanismBench};
use crate::description::{Refusal, format_number};

/// Maximum number of bodies, which the integrator's state bounds.
const MAX_BODIES: usize = 48;
/// Maximum number of contacts whose friction has bristles, beyond which a state has no room.
const MAX_CONTACTS: usize = 80;

impl MechanismBench {
    /// Index of a body by its name; none for the ground and for a name that no body has.
    pub(crate) fn body_index(&self, name: &str) -> Option<usize> {
        self.body.iter().position(|body| body.name == name)
    }

    pub(super) fn structure_refusals(&self) -> Vec<Refusal> {
        let mut all = Vec::new();
        self.refuse_counts(&mut all);
        self.refuse_bodies(&mut all);
        for (i, joint) in self.joint.iter().enumerate() {
            let path = format!("joint.{i}");
            self.refuse_pair(&path, [&joint.first, &joint.second], &mut all);
            refuse_fields(&path, joint, &mut all);
            self.refuse_contact(&path, joint, &mut all);
            all.extend(refuse_offset(&path, joint));
        }
        for (i, spring) in self.spring.iter().enumerate() {
            let path = format!("spring.{i}");
            self.refuse_pair(&path, [&spring.first, &spring.second], &mut all);
            if spring.from_m.is_some() != spring.to_m.is_some() {
                let missing = if spring.from_m.is_some() { "to_m" } else { "from_m" };
                let expected = "both points, or none for a torsional spring".to_owned();
                all.push((format!("{path}.{missing}"), "missing".into(), expected));
            }
            if let (Some(length), None) = (spring.free_length_m, spring.from_m) {
                let expected = "none: a torsional spring is free at the start".to_owned();
                all.push((format!("{path}.free_length_m"), format_number(length), expected));
            }
        }
        for (i, load) in self.load.iter().enumerate() {
            self.refuse_name(&format!("load.{i}.body"), &load.body, false, &mut all);
        }
        self.refuse_measured(&mut all);
        all
    }

    fn refuse_counts(&self, all: &mut Vec<Refusal>) {
        let bodies = self.body.len();
        if !(1..=MAX_BODIES).contains(&bodies) {
            let expected = format!("1 to {MAX_BODIES} entries");
            all.push(("body".into(), format!("{bodies} entries"), expected));
        }
        let contacts = self.joint.iter().map(JointSection::contacts).sum::<usize>();
        if contacts > MAX_CONTACTS {
            let expected = format!("at most {MAX_CONTACTS}: 1 per clearance, 4 per guide, 2 per backlash");
            all.push(("joint".into(), format!("{contacts} contacts"), expected));
        }
    }

    fn refuse_bodies(&self, all: &mut Vec<Refusal>) {
        for (i, body) in self.body.iter().enumerate() {
            let path = format!("body.{i}");
            let is_taken = body.name == GROUND || self.body_index(&body.name) != Some(i);
            if is_taken {
                let expected = "a name that neither another body nor the ground has".to_owned();
                all.push((format!("{path}.name"), format!("`{}`", body.name), expected));
            }
            if !body.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-') {
                let expected =
                    "ASCII letters, digits, `_` and `-`: the log's columns have this name".to_owned();
                all.push((format!("{path}.name"), format!("`{}`", body.name), expected));
            }
            if body.angle_rad != 0.0 && body.at_m.is_none() {
                let expected = "no angle: that of a bar is the direction from its first to its second end";
                all.push((format!("{path}.angle_rad"), format_number(body.angle_rad), expected.to_owned()));
            }
            let missing = |field: &str, expected: &str| {
                (format!("{path}.{field}"), "missing".to_owned(), expected.to_owned())
            };
            match (body.at_m, body.from_m, body.to_m) {
                (Some(_), None, None) if body.inertia_kg_m2.is_none() => {
                    all.push(missing("inertia_kg_m2", "a number, which a body with `at_m` needs"));
                }
                (Some(_), None, None) => {}
                (None, Some(from), Some(to)) if from != to => {}
                (None, Some(_), Some(_)) => {
                    all.push((
                        format!("{path}.to_m"),
                        "equal to from_m".into(),
                        "the other end of the bar".into(),
                    ));
                }
                (Some(_), ..) => {
                    let expected = "no ends beside `at_m`: a body has either".to_owned();
                    all.push((format!("{path}.at_m"), "combined with an end".into(), expected));
                }
                (None, Some(_), None) => all.push(missing("to_m", "the second end of the bar")),
                (None, None, Some(_)) => all.push(missing("from_m", "the first end of the bar")),
                (None, None, None) => all.push(missing("at_m", "`at_m`, or `from_m` and `to_m`")),
            }
        }
    }

    fn refuse_pair(&self, path: &str, [first, second]: [&str; 2], all: &mut Vec<Refusal>) {
        self.refuse_name(&format!("{path}.first"), first, true, all);
        self.refuse_name(&format!("{path}.second"), second, true, all);
        if first == second {
            let expected = "another body than `first`".to_owned();
            all.push((format!("{path}.second"), format!("`{second}`"), expected));
        }
    }

    fn refuse_name(&self, field: &str, name: &str, with_ground: bool, all: &mut Vec<Refusal>) {
        if self.body_index(name).is_some() || (with_ground && name == GROUND) {
            return;
        }
        let mut known: Vec<&str> = self.body.iter().map(|body| body.name.as_str()).collect();
        if with_ground {
            known.insert(0, GROUND);
        }
        all.push((field.into(), format!("`{name}`"), format!("one of {}", known.join(", "))));
    }

    /// Refuses a contact without a law, or with one that no entry has.
    fn refuse_contact(&self, path: &str, joint: &JointSection, all: &mut Vec<Refusal>) {
        let Some(name) = &joint.contact else { return };
        let entry = self.contact.iter().find(|entry| entry.name == *name);
        if joint.kind != JointKind::Clearance && entry.is_some_and(|entry| entry.network.is_some()) {
            let expected = "a contact without `network`: networks know the bearing of `clearance` alone";
            all.push((format!("{path}.contact"), format!("`{name}`"), expected.to_owned()));
        }
        if joint.contacts() > 0 && entry.is_none() {
            let known: Vec<&str> = self.contact.iter().map(|entry| entry.name.as_str()).collect();
            let expected = format!("the name of a `[[contact]]`, one of {}", known.join(", "));
            all.push((format!("{path}.contact"), format!("`{name}`"), expected));
        }
    }
}

/// Refuses a journal that begins outside its bearing's clearance.
fn refuse_offset(path: &str, joint: &JointSection) -> Option<Refusal> {
    let clearance_m = joint.clearance_m.filter(|_| joint.kind == JointKind::Clearance)?;
    let distance_m = joint.offset_m[0].hypot(joint.offset_m[1]);
    (distance_m > clearance_m).then(|| {
        let expected = format!("a distance of at most the clearance of {} m", format_number(clearance_m));
        (format!("{path}.offset_m"), format!("a distance of {} m", format_number(distance_m)), expected)
    })
}

impl JointSection {
    /// Number of contacts of the joint.
    pub const fn contacts(&self) -> usize {
        match self.kind {
            JointKind::Clearance => 1,
            JointKind::Guide => 4,
            _ if self.backlash_m.is_some() => 2,
            _ => 0,
        }
    }
}

/// Number of a joint's description: name, value, and whether the joint uses and needs it.
type NumberUse = (&'static str, Option<f64>, bool, bool);

impl JointSection {
    /// Returns whether the joint drives its second body through flanks with play.
    const fn has_backlash(&self) -> bool {
        self.can_drive() && self.is_driven() && self.backlash_m.is_some()
    }

    const fn can_drive(&self) -> bool {
        matches!(self.kind, JointKind::Revolute | JointKind::Prismatic)
    }

    fn numbers(&self) -> [NumberUse; 12] {
        let can_drive = self.can_drive();
        let has_axis = matches!(self.kind, JointKind::Prismatic | JointKind::Slot | JointKind::Guide);
        let has_period = can_drive && (self.drive_amplitude.is_some() || self.drive_stroke.is_some());
        let has_radius = self.has_backlash() && self.kind == JointKind::Revolute;
        let (is_clearance, is_guide) = (self.kind == JointKind::Clearance, self.kind == JointKind::Guide);
        let has_clearance = is_clearance || is_guide;
        let non_zero = |value: f64| (value != 0.0).then_some(value);
        let offset_m = non_zero(self.offset_m[0].abs() + self.offset_m[1].abs());
        [
            ("axis_rad", non_zero(self.axis_rad), has_axis, false),
            ("drive_speed", self.drive_speed, can_drive, false),
            ("drive_amplitude", self.drive_amplitude, can_drive, false),
            ("drive_stroke", self.drive_stroke, can_drive, false),
            ("drive_period_s", self.drive_period_s, has_period, has_period),
            ("backlash_m", self.backlash_m, can_drive && self.is_driven(), false),
            ("flank_radius_m", non_zero(self.flank_radius_m - 1.0), has_radius, false),
            ("clearance_m", self.clearance_m, has_clearance, has_clearance),
            ("bearing_radius_m", self.bearing_radius_m, is_clearance, is_clearance),
            ("offset_m", offset_m, is_clearance, false),
            ("length_m", self.length_m, has_clearance, is_guide),
            ("height_m", self.height_m, is_guide, is_guide),
        ]
    }
}

/// Refuses fields that the kind of a joint does not use, and misses those that it needs.
fn refuse_fields(path: &str, joint: &JointSection, all: &mut Vec<Refusal>) {
    let kind = crate::schema::FieldType::text(&joint.kind);
    let mut refuse = |field: &str, found: String, expected: String| {
        all.push((format!("{path}.{field}"), found, expected));
    };
    for (field, value, is_used, is_needed) in joint.numbers() {
        match value {
            Some(value) if !is_used => {
                let of_drive = matches!(field, "drive_period_s" | "backlash_m" | "flank_radius_m");
                let drive = if of_drive { " without its drive" } else { "" };
                refuse(field, format_number(value), format!("none: `{kind}`{drive} does not use it"));
            }
            None if is_needed => refuse(field, "missing".into(), format!("a number, which `{kind}` needs")),
            _ => {}
        }
    }
    let has_contact = matches!(joint.kind, JointKind::Clearance | JointKind::Guide) || joint.has_backlash();
    if joint.contact.is_some() && !has_contact {
        let expected = format!("none: `{kind}` without clearance or backlash has no contact");
        refuse("contact", "given".into(), expected);
    } else if joint.contact.is_none() && has_contact {
        refuse("contact", "missing".into(), "the name of a `[[contact]]`".into());
    }
    match (joint.kind == JointKind::Rod, joint.to_m) {
        (true, None) => refuse("to_m", "missing".into(), "the end of the rod on `second`".into()),
        (false, Some(_)) => refuse("to_m", "given".into(), format!("none: `{kind}` is no rod")),
        (true, Some(to_m)) if to_m == joint.at_m => {
            refuse("to_m", "equal to at_m".into(), "the other end of the rod".into());
        }
        _ => {}
    }
    if let (JointKind::Clearance, Some(radius_m), Some(clearance_m)) =
        (joint.kind, joint.bearing_radius_m, joint.clearance_m)
        && clearance_m >= radius_m
    {
        let expected = format!("less than the bearing's {}", format_number(radius_m));
        refuse("clearance_m", format_number(clearance_m), expected);
    }
}
