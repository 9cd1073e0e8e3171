//! Kernels in safe Rust for any target: the reference for the others.

use super::engine::{BLOCK, Engine, Kernel, Quad};
use crate::activation::Activation;
use crate::storage::Storage;

/// Safe Rust without assumptions about the target.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

impl Engine for Portable {}

impl<S: Storage> Kernel<S> for Portable {
    fn pair<const IN: usize, const K: usize>(
        weights: &[Quad],
        columns: &[[S::Activation; IN]],
        [first, second]: &mut [[i32; BLOCK]; 2],
    ) {
        if let Some(columns) = columns.first_chunk::<K>() {
            <Self as Kernel<S>>::block(weights, columns, first);
        }
        if let Some(columns) = columns.last_chunk::<K>() {
            <Self as Kernel<S>>::block(weights, columns, second);
        }
    }

    fn block<const IN: usize, const K: usize>(
        weights: &[Quad],
        columns: &[[S::Activation; IN]; K],
        sums: &mut [i32; BLOCK],
    ) {
        for (quad, inputs) in weights.iter().zip(columns.as_flattened().chunks(S::TAPS)) {
            for (tap, &input) in inputs.iter().enumerate() {
                let input = input.widen();
                for (sum, &group) in sums.iter_mut().zip(quad) {
                    *sum = sum.wrapping_add(S::weight(group, tap).wrapping_mul(input));
                }
            }
        }
    }

    fn row<const IN: usize, const K: usize>(
        weights: &[u32],
        columns: &[[S::Activation; IN]; K],
        sum: i32,
    ) -> i32 {
        weights.iter().zip(columns.as_flattened().chunks(S::TAPS)).fold(sum, |sum, (&group, inputs)| {
            inputs.iter().enumerate().fold(sum, |sum, (tap, &input)| {
                sum.wrapping_add(S::weight(group, tap).wrapping_mul(input.widen()))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn requantise_rounds_to_nearest(sum in any::<i32>(), multiplier in 1..i32::MAX) {
            let exact = f64::from(sum) * f64::from(multiplier) / 4_294_967_296.0;
            prop_assert!((f64::from(Portable::requantise(sum, multiplier)) - exact).abs() <= 0.5);
        }
    }
}
