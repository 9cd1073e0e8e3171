//! Checks of the laws in a description: each can be built from the given parameters, and each given
//! parameter is used.

use crate::description::{
    Bench, ContactSection, FrictionSection, MechanismBench, Refusal, SliderCrankBench, TransmissionBench,
    format_number,
};
use crate::plants::contact_laws::{BearingFriction, JointLaw};
use contact::{FrictionKind, LawError, StiffnessKind};

/// Reason for which a plant with several contacts has no law that sticks.
const SHARED_FORCES: &str = "the forces of several contacts that stick depend on each other";
/// Reason for which the joint of a slider-crank has no law with a deflection.
const NO_DEFLECTION: &str = "the joint of a slider-crank keeps no deflection";

/// Plants that integrate the friction law of this name, if its contacts stick. `None` for a law
/// that every plant with a friction law integrates.
pub fn sticking_plants(name: &str) -> Option<&'static str> {
    let kind = FrictionKind::from_name(name).filter(|kind| kind.sticks())?;
    Some(if kind.has_state() {
        "the planar transmission bench"
    } else {
        "the planar transmission bench and the slider-crank"
    })
}

/// Refuses the friction law of a section if it is excluded, with the laws that are not.
fn excluded(
    field: &str,
    friction: &FrictionSection,
    is_excluded: impl Fn(FrictionKind) -> bool,
    reason: &str,
) -> Option<Refusal> {
    let name = friction.law.filter(|name| is_excluded(name.0))?;
    let fit = FrictionKind::ALL.into_iter().filter(|kind| !is_excluded(*kind));
    let names: Vec<&str> = fit.map(|kind| kind.entry().name).collect();
    let expected = format!("one of {}: {reason}", names.join(", "));
    Some((field.into(), name.0.entry().name.into(), expected))
}

/// Returns everything about the laws of a description that is not allowed.
pub(super) fn refusals(bench: &Bench) -> Vec<Refusal> {
    match bench {
        Bench::Transmission(bench) => {
            let mut all = bearing_refusals(bench);
            all.extend(presliding_refusal(bench));
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
    let friction = &bench.friction;
    let sticks = |kind: FrictionKind| bench.two_plane.is_some() && kind.sticks();
    match excluded("friction.law", friction, sticks, SHARED_FORCES) {
        Some(refusal) => all.push(refusal),
        None => all.extend(memory_refusal(bench)),
    }
    if all.is_empty() {
        let error = BearingFriction::from_bench(bench).err();
        all.extend(error.and_then(|error| wrong("friction", error)));
    }
    all.extend(viscous_refusal("friction", friction));
    all
}

/// Refuses the memory of a friction law that has none, and misses that of the one that has.
fn memory_refusal(bench: &TransmissionBench) -> Option<Refusal> {
    let has_memory = bench.friction.law.is_some_and(|law| law.0 == FrictionKind::SevenParameter);
    let (found, expected) = match (has_memory, &bench.friction_memory) {
        (true, None) => ("missing", "a section with lag_s and rise_s, which `seven-parameter` needs"),
        (false, Some(_)) => ("given", "no such section: only `seven-parameter` uses it"),
        _ => return None,
    };
    Some(("friction_memory".into(), found.into(), expected.into()))
}

/// Returns everything about the parameters of a friction law that is not allowed. `section` is the
/// name of the section.
fn friction_refusals(section: &str, friction: &FrictionSection) -> Vec<Refusal> {
    let error = BearingFriction::from_section(friction, None).err();
    let mut all: Vec<Refusal> = error.and_then(|error| wrong(section, error)).into_iter().collect();
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
    let (law, used) = match section.law {
        Some(complete) => (complete.0.entry().name, complete.0.parameters()),
        None => (section.stiffness.0.entry().name, section.stiffness.0.parameters()),
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

/// Checks that pre-sliding is described once: by the friction law or by an effect.
fn presliding_refusal(bench: &TransmissionBench) -> Option<Refusal> {
    let has_effect = bench.common.effects.iter().any(|effect| effect.name == "presliding-hysteresis");
    let law = bench.friction.law?.0;
    let (found, expected) = if law.sticks() {
        ("that sticks", "one of the two: such a law states what happens before sliding")
    } else {
        law.has_state().then_some(("with bristles", "one of the two: such a law includes pre-sliding"))?
    };
    let found = format!("`presliding-hysteresis` with a friction law {found}");
    has_effect.then(|| ("effects".into(), found, expected.into()))
}

/// Returns everything about the friction of a slider-crank's joint that is not allowed.
fn joint_friction_refusals(friction: &FrictionSection) -> Vec<Refusal> {
    match excluded("friction.law", friction, FrictionKind::has_state, NO_DEFLECTION) {
        Some(refusal) => vec![refusal],
        None => friction_refusals("friction", friction),
    }
}

/// Returns everything about the laws of a mechanism that is not allowed: in themselves, and in the
/// joints that use them.
fn mechanism_refusals(bench: &MechanismBench) -> Vec<Refusal> {
    let mut all = Vec::new();
    for (i, entry) in bench.contact.iter().enumerate() {
        let path = format!("contact.{i}");
        all.extend(contact_refusals(&path, &entry.contact_section(), true));
        all.extend(entry.friction_section().iter().flat_map(|friction| {
            let field = format!("{path}.friction");
            match excluded(&field, friction, FrictionKind::sticks, SHARED_FORCES) {
                Some(refusal) => vec![refusal],
                None => friction_refusals(&path, friction),
            }
        }));
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
