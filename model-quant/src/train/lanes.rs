//! Eight numbers at a time: fused with AVX2 and FMA where the machine has them, plain elsewhere.
//!
//! The choice is made at run time. Fused and plain arithmetic round differently, so a training gives the same bytes on
//! any machine and number of threads for one [`InstructionSet`], which its record names.

use pulp::f32x8;
use serde::{Deserialize, Serialize};

/// Numbers in a vector.
pub(super) const LANES: usize = 8;

/// Arithmetic of a training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum InstructionSet {
    /// `+` and `*`: any machine
    Portable,
    /// Fused multiply-add, 256 bits: x86 from 2013 on
    Avx2Fma,
}

impl InstructionSet {
    /// The fastest that this machine has.
    pub fn best() -> Self {
        if Self::Avx2Fma.is_here() { Self::Avx2Fma } else { Self::Portable }
    }

    /// Whether this machine has it.
    pub fn is_here(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2Fma => pulp::x86::V3::try_new().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2Fma => false,
        }
    }

    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2Fma => "avx2-fma",
        }
    }

    /// Runs an operation with its vectors; a set that the machine does not have falls back on the portable one.
    pub(super) fn run<O: Operation>(self, operation: O) -> O::Output {
        #[cfg(target_arch = "x86_64")]
        if self == Self::Avx2Fma
            && let Some(lanes) = pulp::x86::V3::try_new()
        {
            struct Call<O>(O, pulp::x86::V3);
            impl<O: Operation> pulp::NullaryFnOnce for Call<O> {
                type Output = O::Output;
                #[inline(always)]
                fn call(self) -> O::Output {
                    self.0.run(self.1)
                }
            }
            return lanes.vectorize(Call(operation, lanes));
        }
        operation.run(Plain)
    }
}

/// Work that is compiled once for every instruction set.
pub(super) trait Operation {
    type Output;

    /// Must be `inline(always)`, like all that it calls, to be compiled for the set.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Arithmetic on vectors.
pub(super) trait Lanes: Copy {
    /// Whether the registers hold twelve sums of eight.
    const MANY: bool;

    fn splat(self, value: f32) -> f32x8;

    /// `a b + c`.
    fn multiply_add(self, a: f32x8, b: f32x8, c: f32x8) -> f32x8;
}

/// Plain arithmetic, vectorised as far as the compiler sees fit.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Lanes for Plain {
    const MANY: bool = false;

    #[inline(always)]
    fn splat(self, value: f32) -> f32x8 {
        pulp::cast([value; LANES])
    }

    #[inline(always)]
    fn multiply_add(self, a: f32x8, b: f32x8, c: f32x8) -> f32x8 {
        let (a, b): ([f32; LANES], [f32; LANES]) = (pulp::cast(a), pulp::cast(b));
        let mut sums: [f32; LANES] = pulp::cast(c);
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
        pulp::cast(sums)
    }
}

#[cfg(target_arch = "x86_64")]
impl Lanes for pulp::x86::V3 {
    const MANY: bool = true;

    #[inline(always)]
    fn splat(self, value: f32) -> f32x8 {
        self.splat_f32x8(value)
    }

    #[inline(always)]
    fn multiply_add(self, a: f32x8, b: f32x8, c: f32x8) -> f32x8 {
        self.mul_add_f32x8(a, b, c)
    }
}
