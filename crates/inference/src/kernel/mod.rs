//! Dot products: nearly all multiplications of a network are here.
//!
//! Channels-last columns are contiguous, so the taps of an output are one slice of memory and a
//! convolution is a set of dot products. Three shapes cover everything: four outputs at two
//! neighbouring positions, four outputs at one position, and one output at one position.
//!
//! [`Portable`] is safe Rust and the reference; `Simd` runs on hosts, `CortexM` on cores with the
//! DSP instructions. Sums of 32-bit integers do not depend on the order, and the loader has proven
//! that none overflows ([`crate::image::prove`]). So all engines give the same bits, which tests
//! show for each of them.

#[cfg(pintle_dsp)]
mod cortex_m;
mod engine;
mod portable;
#[cfg(not(target_os = "none"))]
mod simd;

pub use engine::{BLOCK, Engine, Kernel, LayerOutcome, Quad};
pub(crate) use engine::{copy, finish, scaling};
pub use portable::Portable;

/// Forces the compiler to store a value in memory and to read it from there afterwards, in place of
/// copies in registers.
#[inline]
pub fn read_anew<T>(value: &mut T) {
    #[cfg(pintle_dsp)]
    cortex_m::read_anew(value);
    // The same effect through a pointer that is itself stored in memory.
    #[cfg(not(pintle_dsp))]
    core::hint::black_box(value);
}

/// Returns non-zero if two columns of words differ.
#[inline]
pub(crate) fn difference(first: &[u32], second: &[u32]) -> u32 {
    #[cfg(pintle_dsp)]
    {
        let found = quads_difference::<2>(first, second).or_else(|| quads_difference::<1>(first, second));
        if let Some(difference) = found {
            return difference;
        }
    }
    first.iter().zip(second).fold(0, |found, (first, second)| found | (first ^ second))
}

/// Compares columns of exactly four times `QUADS` words.
#[cfg(pintle_dsp)]
#[inline]
fn quads_difference<const QUADS: usize>(first: &[u32], second: &[u32]) -> Option<u32> {
    fn quads<const QUADS: usize>(words: &[u32]) -> Option<&[[u32; 4]; QUADS]> {
        if words.len() == 4 * QUADS { words.as_chunks().0.try_into().ok() } else { None }
    }
    Some(cortex_m::difference::<QUADS>(quads(first)?, quads(second)?))
}

/// The fastest engine of this target.
#[cfg(pintle_dsp)]
pub type Native = cortex_m::CortexM;
/// The fastest engine of this target.
#[cfg(not(target_os = "none"))]
pub type Native = simd::Simd;
/// The fastest engine of this target.
#[cfg(all(target_os = "none", not(pintle_dsp)))]
pub type Native = Portable;
