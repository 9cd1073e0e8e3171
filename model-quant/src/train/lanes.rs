//! Eight or sixteen numbers at a time: fused where the machine has it, plain elsewhere.
//!
//! The choice is made at run time. Fused and plain arithmetic round differently, so a training gives the same bytes on
//! any machine and number of threads for one [`InstructionSet`], which its record names. How wide the vectors are changes
//! no byte, since every number has a sum of its own: the fused set runs on AVX-512 where the machine has it.

use bytemuck::Pod;
use pulp::f32x8;
use serde::{Deserialize, Serialize};

/// Channels are filled up to a multiple of this many, the numbers in a narrow vector.
pub(super) const LANES: usize = 8;

/// Arithmetic of a training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum InstructionSet {
    /// `+` and `*`: any machine
    Portable,
    /// Fused multiply-add: x86 from 2013 on, with vectors of 512 bits where it has them and of 256 elsewhere
    Avx2Fma,
}

impl InstructionSet {
    /// The fastest that this machine has.
    pub fn best() -> Self {
        if Self::Avx2Fma.is_here() { Self::Avx2Fma } else { Self::Portable }
    }

    /// Whether this machine has it.
    pub fn is_here(self) -> bool {
        self == Self::Portable || !matches!(self.machine(), Machine::Plain)
    }

    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2Fma => "avx2-fma",
        }
    }

    /// The machines that run it here, the fastest first; a set that is not here falls back on the portable one.
    pub(super) fn machines(self) -> impl Iterator<Item = Machine> {
        let plain = Some(Machine::Plain);
        #[cfg(target_arch = "x86_64")]
        if self == Self::Avx2Fma {
            let wide = pulp::x86::V4::try_new().map(Machine::Fused512);
            let narrow = pulp::x86::V3::try_new().map(Machine::Fused256);
            let plain = plain.filter(|_| narrow.is_none());
            return [wide, narrow, plain].into_iter().flatten();
        }
        [plain, None, None].into_iter().flatten()
    }

    /// The fastest of them.
    pub(super) fn machine(self) -> Machine {
        self.machines().next().unwrap_or(Machine::Plain)
    }
}

/// What the operations of a set are compiled for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Machine {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Fused256(pulp::x86::V3),
    #[cfg(target_arch = "x86_64")]
    Fused512(pulp::x86::V4),
}

impl Machine {
    /// Runs an operation with its vectors.
    pub(super) fn run<O: Operation>(self, operation: O) -> O::Output {
        match self {
            Self::Plain => operation.run(Plain),
            #[cfg(target_arch = "x86_64")]
            Self::Fused256(lanes) => lanes.vectorize(Call(operation, lanes)),
            #[cfg(target_arch = "x86_64")]
            Self::Fused512(lanes) => lanes.vectorize(Call(operation, lanes)),
        }
    }
}

/// An operation and its vectors, for what `pulp` compiles.
#[cfg(target_arch = "x86_64")]
struct Call<O, L>(O, L);

#[cfg(target_arch = "x86_64")]
impl<O: Operation, L: Lanes> pulp::NullaryFnOnce for Call<O, L> {
    type Output = O::Output;

    #[inline(always)]
    fn call(self) -> O::Output {
        self.0.run(self.1)
    }
}

/// Work that is compiled once for every machine.
pub(super) trait Operation {
    type Output;

    /// Must be `inline(always)`, like all that it calls, to be compiled for the machine.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Arithmetic on vectors.
pub(super) trait Lanes: Copy {
    /// As many numbers as a register holds, eight at least.
    type Vector: Pod;
    /// The same arithmetic, eight at a time.
    type Narrow: Lanes<Vector = f32x8>;

    /// Numbers in a vector.
    const WIDTH: usize = size_of::<Self::Vector>() / size_of::<f32>();
    /// Rows of sums that the registers hold beside two vectors of factors.
    const ROWS: usize;
    /// Whether they hold that many rows of two vectors.
    const PAIRS: bool;

    fn narrow(self) -> Self::Narrow;

    fn splat(self, value: f32) -> Self::Vector;

    /// `a b + c`.
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;

    /// Each value where its gate is above 0, else 0.
    fn gate(self, values: Self::Vector, gates: Self::Vector) -> Self::Vector;

    /// The first numbers of a row; zeros where it is too short.
    #[inline(always)]
    fn load(self, row: &[f32]) -> Self::Vector {
        let row = row.get(..Self::WIDTH).map(bytemuck::must_cast_slice);
        row.and_then(|row| bytemuck::try_pod_read_unaligned(row).ok()).unwrap_or(self.splat(0.0))
    }

    /// Puts a vector into the first numbers of a row; nothing where it is too short.
    #[inline(always)]
    fn store(self, vector: Self::Vector, row: &mut [f32]) {
        if let Some(row) = row.get_mut(..Self::WIDTH) {
            bytemuck::must_cast_slice_mut(row).copy_from_slice(bytemuck::bytes_of(&vector));
        }
    }
}

/// Plain arithmetic, vectorised as far as the compiler sees fit.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Lanes for Plain {
    type Vector = f32x8;
    type Narrow = Self;

    const ROWS: usize = 6;
    const PAIRS: bool = false;

    #[inline(always)]
    fn narrow(self) -> Self {
        self
    }

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

    #[inline(always)]
    fn gate(self, values: f32x8, gates: f32x8) -> f32x8 {
        let (mut values, gates): ([f32; LANES], [f32; LANES]) = (pulp::cast(values), pulp::cast(gates));
        for (value, gate) in values.iter_mut().zip(gates) {
            *value = if gate > 0.0 { *value } else { 0.0 };
        }
        pulp::cast(values)
    }
}

#[cfg(target_arch = "x86_64")]
impl Lanes for pulp::x86::V3 {
    type Vector = f32x8;
    type Narrow = Self;

    const ROWS: usize = 6;
    const PAIRS: bool = true;

    #[inline(always)]
    fn narrow(self) -> Self {
        self
    }

    #[inline(always)]
    fn splat(self, value: f32) -> f32x8 {
        self.splat_f32x8(value)
    }

    #[inline(always)]
    fn multiply_add(self, a: f32x8, b: f32x8, c: f32x8) -> f32x8 {
        self.mul_add_f32x8(a, b, c)
    }

    #[inline(always)]
    fn gate(self, values: f32x8, gates: f32x8) -> f32x8 {
        let zeros = self.splat_f32x8(0.0);
        self.select_f32x8(self.cmp_gt_f32x8(gates, zeros), values, zeros)
    }
}

#[cfg(target_arch = "x86_64")]
impl Lanes for pulp::x86::V4 {
    type Vector = pulp::f32x16;
    type Narrow = pulp::x86::V3;

    const ROWS: usize = 8;
    const PAIRS: bool = true;

    #[inline(always)]
    fn narrow(self) -> pulp::x86::V3 {
        *self
    }

    #[inline(always)]
    fn splat(self, value: f32) -> pulp::f32x16 {
        self.splat_f32x16(value)
    }

    #[inline(always)]
    fn multiply_add(self, a: pulp::f32x16, b: pulp::f32x16, c: pulp::f32x16) -> pulp::f32x16 {
        self.mul_add_f32x16(a, b, c)
    }

    #[inline(always)]
    fn gate(self, values: pulp::f32x16, gates: pulp::f32x16) -> pulp::f32x16 {
        let zeros = self.splat_f32x16(0.0);
        self.select_f32x16(self.cmp_gt_f32x16(gates, zeros), values, zeros)
    }
}
