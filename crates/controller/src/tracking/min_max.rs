//! Maximum and minimum of two numbers in two instructions; `f32::max` is a call on the controller.
//!
//! If either is NaN, the second one is returned.

/// Returns the larger one.
pub(crate) fn at_least(value: f32, least: f32) -> f32 {
    if value > least { value } else { least }
}

/// Returns the smaller one.
pub(crate) fn at_most(value: f32, most: f32) -> f32 {
    if value < most { value } else { most }
}
