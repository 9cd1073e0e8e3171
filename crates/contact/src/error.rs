//! Errors of the laws' parameters, and the checks that return them.

use crate::real::Real;

/// Error of a law that cannot be built or is evaluated outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LawError {
    /// A quantity outside the range in which the law holds.
    #[error("{quantity}: found {found:e}, expected {expected}")]
    OutOfRange {
        /// Name of the quantity, with its unit.
        quantity: &'static str,
        /// Its value.
        found: f64,
        /// Range of validity.
        expected: &'static str,
    },
    /// A required quantity that was not given.
    #[error("{law} needs {quantity}, found none")]
    Missing {
        /// Name of the law.
        law: &'static str,
        /// Name of the quantity.
        quantity: &'static str,
    },
    /// An unknown name; [`crate::catalogue`] lists the known ones.
    #[error("unknown {group} law, expected a name of the catalogue")]
    UnknownName {
        /// Kind of law that was searched.
        group: &'static str,
    },
}

fn check<T: Real>(
    holds: bool,
    quantity: &'static str,
    value: T,
    expected: &'static str,
) -> Result<T, LawError> {
    if holds && value.is_finite() {
        Ok(value)
    } else {
        Err(LawError::OutOfRange { quantity, found: value.to_f64(), expected })
    }
}

pub(crate) fn above_zero<T: Real>(quantity: &'static str, value: T) -> Result<T, LawError> {
    check(value > T::ZERO, quantity, value, "a finite number above 0")
}

pub(crate) fn at_least_zero<T: Real>(quantity: &'static str, value: T) -> Result<T, LawError> {
    check(value >= T::ZERO, quantity, value, "a finite number, 0 or more")
}

/// Checks that a value is in a range; `holds` is the result of the comparison, `expected` describes
/// the range.
pub(crate) fn expect<T: Real>(
    quantity: &'static str,
    value: T,
    holds: bool,
    expected: &'static str,
) -> Result<T, LawError> {
    check(holds, quantity, value, expected)
}

pub(crate) fn needed<T>(value: Option<T>, law: &'static str, quantity: &'static str) -> Result<T, LawError> {
    value.ok_or(LawError::Missing { law, quantity })
}
