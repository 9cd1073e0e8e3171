//! A known answer: value, reference, tolerance, and the error of computing it.

use crate::integrate::IntegrationError;

/// Computed value with its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownAnswer {
    /// Quantity, unit included.
    pub name: String,
    /// Computed value.
    pub value: f64,
    /// Reference value.
    pub reference: f64,
    /// Tolerance of the error.
    pub tolerance: f64,
    /// True if the tolerance is relative to the reference, or in the unit of the value.
    pub relative: bool,
}

impl KnownAnswer {
    pub(super) fn relative(name: impl Into<String>, value: f64, reference: f64, tolerance: f64) -> Self {
        Self { name: name.into(), value, reference, tolerance, relative: true }
    }

    pub(super) fn absolute(name: impl Into<String>, value: f64, reference: f64, tolerance: f64) -> Self {
        Self { relative: false, ..Self::relative(name, value, reference, tolerance) }
    }

    /// Error in the measure of the tolerance.
    pub fn error(&self) -> f64 {
        let distance = (self.value - self.reference).abs();
        if self.relative { distance / self.reference.abs() } else { distance }
    }

    /// Returns whether the error is within the tolerance.
    pub fn holds(&self) -> bool {
        self.error() <= self.tolerance
    }
}

/// Error of computing a case.
#[derive(Debug, thiserror::Error)]
pub enum KnownAnswerError {
    /// The integration failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
    /// The slider-crank's preset was refused.
    #[error(transparent)]
    Description(#[from] crate::description::DescriptionError),
    /// A run lacks a quantity that the case reads.
    #[error("{0}")]
    Missing(&'static str),
}
