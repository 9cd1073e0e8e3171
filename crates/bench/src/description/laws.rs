//! Whether the laws that a description names can be built from what it gives, and whether it gives nothing in vain.

use super::TransmissionBench;
use super::ranges::shown;
use crate::contact_laws::{BearingFriction, JointLaw};
use contact::{FrictionKind, LawError, StiffnessKind, WholeKind};

/// Friction laws of the catalogue that no bench integrates. Two jump at rest, where an error-controlled step cannot pass,
/// and Karnopp's and the seven-parameter law need the force that holds a rest or its length besides.
const NOT_INTEGRATED: [FrictionKind; 3] =
    [FrictionKind::Coulomb, FrictionKind::Karnopp, FrictionKind::SevenParameter];

/// Whether a bench can be integrated with the friction law of this name.
pub fn integrates_friction(name: &str) -> bool {
    FrictionKind::from_name(name).is_some_and(|kind| !NOT_INTEGRATED.contains(&kind))
}

/// Whether the friction law of a description has a deflection.
pub(super) fn has_bristles(bench: &TransmissionBench) -> bool {
    BearingFriction::of(&bench.friction).is_ok_and(|law| law.has_state())
}

/// Field, what was found and what was expected, if anything is wrong.
pub(super) fn refusal(bench: &TransmissionBench) -> Option<(String, String, String)> {
    if let Some(name) = bench.friction.law.filter(|name| NOT_INTEGRATED.contains(&name.0)) {
        let fit = FrictionKind::ALL.iter().filter(|kind| !NOT_INTEGRATED.contains(kind));
        let names: Vec<&str> = fit.map(|kind| kind.entry().name).collect();
        let expected = format!(
            "one of {}: a bench integrates laws that are a rate and continuous at rest",
            names.join(", ")
        );
        return Some(("friction.law".into(), name.0.entry().name.into(), expected));
    }
    in_vain(bench)
        .or_else(|| wrong("contact", JointLaw::of(bench).err()?))
        .or_else(|| wrong("friction", BearingFriction::of(&bench.friction).err()?))
}

fn wrong(section: &str, error: LawError) -> Option<(String, String, String)> {
    Some(match error {
        LawError::OutOfRange { quantity, found, expected } => {
            (format!("{section}: {quantity}"), shown(found), expected.into())
        }
        LawError::Missing { law, quantity } => {
            let field = quantity.trim_start_matches("an ").trim_start_matches("a ");
            (format!("{section}.{field}"), "missing".into(), format!("a number, which `{law}` needs"))
        }
        LawError::UnknownName { .. } => (section.into(), error.to_string(), "a law of the catalogue".into()),
    })
}

/// A parameter of the contact that the named law does not use.
fn in_vain(bench: &TransmissionBench) -> Option<(String, String, String)> {
    let section = &bench.contact;
    let (law, used): (&str, &[&str]) = match section.law {
        Some(whole) => (
            whole.0.entry().name,
            match whole.0 {
                WholeKind::KelvinVoigt => &["coefficient", "damping_n_s_m"],
                WholeKind::Anagnostopoulos => &["coefficient"],
                WholeKind::AdamsImpact => {
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
    let given = [
        ("coefficient", section.coefficient),
        ("exponent", section.exponent),
        ("damping_n_s_m", section.damping_n_s_m),
        ("full_damping_depth_m", section.full_damping_depth_m),
    ];
    let (field, value) = given
        .into_iter()
        .find_map(|(field, value)| Some((field, value?)).filter(|g| !used.contains(&g.0)))?;
    Some((format!("contact.{field}"), shown(value), format!("none: `{law}` does not use it")))
}
