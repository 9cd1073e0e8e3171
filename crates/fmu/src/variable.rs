//! Variables of a unit: one table for the model description and for the code that reads and writes
//! them.

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// Number in double precision.
    Real,
    /// Signed integer of 32 bits.
    Integer,
    /// True or false.
    Boolean,
}

/// Use of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Simulated time.
    Time,
    /// Parameter that is set before the start.
    Fixed,
    /// Parameter that may change between two steps.
    Tunable,
    /// Input, held over a step.
    Input,
    /// Result.
    Output,
}

/// A variable. Its value reference is its index in the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Unique name, with the unit as suffix.
    pub name: String,
    /// Meaning, one line.
    pub meaning: String,
    /// Unit; empty if it has none.
    pub unit: &'static str,
    /// Type.
    pub kind: Type,
    /// Use.
    pub causality: Causality,
    /// Value before anything is set; Booleans are 0 and 1. Outputs have none of their own.
    pub start: f64,
    /// Minimum and maximum of a parameter.
    pub range: Option<(f64, f64)>,
}

impl Variable {
    /// A variable of type [`Type::Real`] with the start value 0 and no range.
    pub(crate) fn real(causality: Causality, name: &str, unit: &'static str, meaning: &str) -> Self {
        Self {
            name: name.into(),
            meaning: meaning.into(),
            unit,
            kind: Type::Real,
            causality,
            start: 0.0,
            range: None,
        }
    }

    /// The same variable with another type and start value.
    pub(crate) fn with(self, kind: Type, start: f64) -> Self {
        Self { kind, start, ..self }
    }
}

impl Type {
    /// Returns whether a number is one of the type's.
    pub(crate) fn admits(self, value: f64) -> bool {
        match self {
            Self::Real => value.is_finite(),
            Self::Integer => {
                value.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value)
            }
            Self::Boolean => value == 0.0 || value == 1.0,
        }
    }
}
