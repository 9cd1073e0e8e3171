//! Every law by its stable name, for descriptions and for lists on a command line.

pub use crate::entry::{Entry, Group};

use crate::contact_law::CompleteLawKind;
use crate::dissipation::Dissipation;
use crate::friction::FrictionKind;
use crate::stiffness_kind::StiffnessKind;

/// Returns every law: dissipation factors, stiffness parts, complete normal laws, friction laws.
pub fn all() -> impl Iterator<Item = Entry> {
    let dissipation = Dissipation::ALL.into_iter().map(Dissipation::entry);
    let stiffness = StiffnessKind::ALL.into_iter().map(StiffnessKind::entry);
    let complete = CompleteLawKind::ALL.into_iter().map(CompleteLawKind::entry);
    let friction = FrictionKind::ALL.into_iter().map(FrictionKind::entry);
    dissipation.chain(stiffness).chain(complete).chain(friction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_kebab_case_and_unique_within_their_group() {
        let entries: Vec<Entry> = all().collect();
        for entry in &entries {
            let kebab = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(entry.name.chars().all(kebab), "{}", entry.name);
            assert!(!entry.description.is_empty() && !entry.source.is_empty() && !entry.range.is_empty());
            let same = |e: &&Entry| e.group == entry.group && e.name == entry.name;
            assert_eq!(entries.iter().filter(same).count(), 1, "{}", entry.name);
        }
    }

    #[test]
    fn every_name_finds_its_law_and_no_other_name_does() {
        for law in Dissipation::ALL {
            assert_eq!(Dissipation::from_name(law.entry().name), Some(law));
        }
        for law in StiffnessKind::ALL {
            assert_eq!(StiffnessKind::from_name(law.entry().name), Some(law));
        }
        for law in CompleteLawKind::ALL {
            assert_eq!(CompleteLawKind::from_name(law.entry().name), Some(law));
        }
        for law in FrictionKind::ALL {
            assert_eq!(FrictionKind::from_name(law.entry().name), Some(law));
        }
        assert_eq!(Dissipation::from_name("Hunt-Crossley"), None);
        assert_eq!(StiffnessKind::from_name(""), None);
    }
}
