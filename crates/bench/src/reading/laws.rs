//! Checks of the laws in a description: each can be built from the given parameters, and each given
//! parameter is used.

use crate::description::{
    Bench, ContactSection, FrictionSection, MechanismBench, Refusal, SliderCrankBench, TransmissionBench,
    format_number,
};
use crate::plants::contact_laws::{BearingFriction, JointLaw};
use contact::{CompleteLawKind, FrictionKind, LawError, StiffnessKind};

/// Friction laws of the catalogue that no bench can integrate. Two are discontinuous at speed 0,
/// which an error-controlled step cannot pass. Karnopp's law and the seven-parameter law also need
/// the holding force or the duration of a standstill.
const NOT_INTEGRATED: [FrictionKind; 3] =
    [FrictionKind::Coulomb, FrictionKind::Karnopp, FrictionKind::SevenParameter];

/// Returns whether a bench can be integrated with the friction law of this name.
pub fn integrates_friction(name: &str) -> bool {
    FrictionKind::from_name(name).is_some_and(|kind| !NOT_INTEGRATED.contains(&kind))
}

/// Returns whether the friction law of a description has bristles.
fn has_bristles(bench: &TransmissionBench) -> bool {
    BearingFriction::from_section(&bench.friction).is_ok_and(|law| law.has_state())
}

/// Returns everything about the laws of a description that is not allowed.
pub(super) fn refusals(bench: &Bench) -> Vec<Refusal> {
    match bench {
        Bench::Transmission(bench) => {
            let mut all = bearing_refusals(bench);
            all.extend(bristle_refusal(bench));
            all
        }
        Bench::SliderCrank(bench) => {
            let mut all: Vec<Refusal> = joint_refusal(bench).into_iter().collect();
            all.extend(bench.friction.iter().flat_map(joint_friction_refusals));
            all
        }
        Bench::Mechanism(bench) => mechanism_refusals(bench),
        // Other plants have no laws to choose.
        _ => Vec::new(),
    }
}

/// Returns everything about the laws of a bearing that is not allowed.
fn bearing_refusals(bench: &TransmissionBench) -> Vec<Refusal> {
    let mut all = contact_refusals("contact", &bench.contact, false);
    if all.is_empty() {
        all.extend(JointLaw::from_bench(bench).err().and_then(|error| wrong("contact", error)));
    }
    all.extend(friction_refusals("friction", "friction.law", &bench.friction));
    all
}

/// Returns everything about the friction law of a section that is not allowed. `section` and
/// `field` are the names of the section and of the law's name in it.
fn friction_refusals(section: &str, field: &str, friction: &FrictionSection) -> Vec<Refusal> {
    let mut all = Vec::new();
    if let Some(name) = friction.law.filter(|name| NOT_INTEGRATED.contains(&name.0)) {
        let fit = FrictionKind::ALL.iter().filter(|kind| !NOT_INTEGRATED.contains(kind));
        let names: Vec<&str> = fit.map(|kind| kind.entry().name).collect();
        let expected = format!(
            "one of {}: a bench integrates laws that depend on the speed continuously",
            names.join(", ")
        );
        all.push((field.into(), name.0.entry().name.into(), expected));
    } else {
        let error = BearingFriction::from_section(friction).err();
        all.extend(error.and_then(|error| wrong(section, error)));
    }
    all.extend(viscous_refusal(section, friction));
    all
}

/// Refuses the viscous parameter that the friction law does not use. Brown and McPhee's viscous
/// part is a force over a speed, that of the other laws a coefficient over a speed.
fn viscous_refusal(section: &str, friction: &FrictionSection) -> Option<Refusal> {
    let is_brown_mcphee = friction.law.is_some_and(|law| law.0 == FrictionKind::BrownMcPhee);
    let (unused, value, expected) = if is_brown_mcphee {
        let expected = "0: `brown-mcphee` uses viscous_damping_n_s_m, a force over the speed";
        ("viscous_slope_s_m", friction.viscous_slope_s_m, expected)
    } else {
        let expected = "0: only `brown-mcphee` uses it; other laws use viscous_slope_s_m";
        ("viscous_damping_n_s_m", friction.viscous_damping_n_s_m, expected)
    };
    (value != 0.0).then(|| (format!("{section}.{unused}"), format_number(value), expected.into()))
}

fn wrong(section: &str, error: LawError) -> Option<Refusal> {
    Some(match error {
        LawError::OutOfRange { quantity, found, expected } => {
            (format!("{section}: {quantity}"), format_number(found), expected.into())
        }
        LawError::Missing { law, quantity } => {
            let field = quantity.trim_start_matches("an ").trim_start_matches("a ");
            (format!("{section}.{field}"), "missing".into(), format!("a number, which `{law}` needs"))
        }
        LawError::UnknownName { .. } => (section.into(), error.to_string(), "a law of the catalogue".into()),
    })
}

/// Refuses parameters of the contact that the named law does not use, and misses those that it
/// needs. With `has_own_hertz` the stiffness of Hertz may come from the joint.
fn contact_refusals(path: &str, section: &ContactSection, has_own_hertz: bool) -> Vec<Refusal> {
    let (law, used): (&str, &[&str]) = match section.law {
        Some(complete) => (
            complete.0.entry().name,
            match complete.0 {
                CompleteLawKind::KelvinVoigt => &["coefficient", "damping_n_s_m"],
                CompleteLawKind::Anagnostopoulos => &["coefficient"],
                CompleteLawKind::AdamsImpact => {
                    &["coefficient", "exponent", "damping_n_s_m", "full_damping_depth_m"]
                }
            },
        ),
        None => (
            section.stiffness.0.entry().name,
            match section.stiffness.0 {
                StiffnessKind::Linear | StiffnessKind::Hertz => &["coefficient"],
                StiffnessKind::Power => &["coefficient", "exponent"],
                _ => &[],
            },
        ),
    };
    let is_of_joint = has_own_hertz && law == StiffnessKind::Hertz.entry().name;
    let given = [
        ("coefficient", section.coefficient),
        ("exponent", section.exponent),
        ("damping_n_s_m", section.damping_n_s_m),
        ("full_damping_depth_m", section.full_damping_depth_m),
    ];
    let refusal = |(field, value): (&str, Option<f64>)| {
        let (found, expected) = match (value, used.contains(&field)) {
            (Some(value), false) => (format_number(value), format!("none: `{law}` does not use it")),
            (None, true) if !is_of_joint => ("missing".into(), format!("a number, which `{law}` needs")),
            _ => return None,
        };
        Some((format!("{path}.{field}"), found, expected))
    };
    given.into_iter().filter_map(refusal).collect()
}

/// Checks that pre-sliding is described once: by bristles or by an effect.
fn bristle_refusal(bench: &TransmissionBench) -> Option<Refusal> {
    let has_effect = bench.common.effects.iter().any(|effect| effect.name == "presliding-hysteresis");
    (has_effect && has_bristles(bench)).then(|| {
        (
            "effects".into(),
            "`presliding-hysteresis` with a friction law with bristles".into(),
            "one of the two: such a law includes pre-sliding".into(),
        )
    })
}

/// Returns everything about the friction of a slider-crank's joint that is not allowed.
fn joint_friction_refusals(friction: &FrictionSection) -> Vec<Refusal> {
    let mut all = friction_refusals("friction", "friction.law", friction);
    if let Some(name) = friction.law.filter(|_| all.is_empty()) {
        let has_bristles = BearingFriction::from_section(friction).is_ok_and(|law| law.has_state());
        let expected = "a law without bristles: the joint of a slider-crank keeps no deflection";
        all.extend(
            has_bristles.then(|| ("friction.law".into(), name.0.entry().name.into(), expected.into())),
        );
    }
    all
}

/// Returns everything about the laws of a mechanism that is not allowed: in themselves, and in the
/// joints that use them.
fn mechanism_refusals(bench: &MechanismBench) -> Vec<Refusal> {
    let mut all = Vec::new();
    for (i, entry) in bench.contact.iter().enumerate() {
        let path = format!("contact.{i}");
        all.extend(contact_refusals(&path, &entry.contact_section(), true));
        let friction = entry.friction_section();
        all.extend(friction.iter().flat_map(|f| friction_refusals(&path, &format!("{path}.friction"), f)));
    }
    if !all.is_empty() {
        return all;
    }
    for (i, joint) in bench.joint.iter().enumerate().filter(|(_, joint)| joint.contacts() > 0) {
        let error = bench.laws(joint).and_then(Result::err);
        all.extend(error.and_then(|error| wrong(&format!("joint.{i}"), error)));
    }
    if all.is_empty() && bench.mechanism().is_ok_and(|mechanism| mechanism.is_contradictory()) {
        let found = "joints and drives that contradict each other at the start".into();
        all.push(("joint".into(), found, "rates and accelerations that satisfy all of them".into()));
    }
    all
}

/// Checks the stiffness of a slider-crank's joint.
fn joint_refusal(bench: &SliderCrankBench) -> Option<Refusal> {
    let error = bench.stiffness().err()?;
    Some(("joint".into(), error.to_string(), "a stiffness with its parameters in range".into()))
}
