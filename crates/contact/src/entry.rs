//! Catalogue entry of a law: name, description, source and range.

/// Kind of law that a name selects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Dissipation factor, [`crate::Dissipation`].
    Dissipation,
    /// Stiffness part, [`crate::Stiffness`].
    Stiffness,
    /// Complete normal law with its own damping, [`crate::CompleteLawKind`].
    Complete,
    /// Friction law, [`crate::FrictionKind`].
    Friction,
}

/// Catalogue entry of one law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Kind of law.
    pub group: Group,
    /// Stable name, in kebab case.
    pub name: &'static str,
    /// Description in one line.
    pub description: &'static str,
    /// Author and year.
    pub source: &'static str,
    /// Range of validity.
    pub range: &'static str,
}
