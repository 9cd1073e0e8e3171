//! Vectors of eight or sixteen numbers with fused or plain arithmetic, selected at run time.
//!
//! Fused and plain arithmetic round differently. A training therefore gives the same bytes on any
//! machine and number of threads for one [`InstructionSet`], which its recipe names. The width of
//! the vectors has no influence, because every lane has a separate sum: the fused set uses AVX-512
//! where available.

use crate::network::recipe::InstructionSet;
use bytemuck::Pod;
use pulp::f32x8;

/// Width of a narrow vector; channels are padded to a multiple of it.
pub(super) const LANES: usize = 8;

impl InstructionSet {
    /// Fastest set of this machine.
    pub fn best() -> Self {
        if Self::Avx2Fma.is_available() { Self::Avx2Fma } else { Self::Portable }
    }

    /// Returns true if this machine supports the set.
    pub(crate) fn is_available(self) -> bool {
        self == Self::Portable || !matches!(self.machine(), Machine::Plain)
    }

    /// Vector types that implement the set on this machine, the fastest first. An unsupported set
    /// falls back to plain arithmetic.
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

    /// Fastest vector type of the set.
    pub(super) fn machine(self) -> Machine {
        self.machines().next().unwrap_or(Machine::Plain)
    }
}

/// Vector type that an operation is compiled for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Machine {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Fused256(pulp::x86::V3),
    #[cfg(target_arch = "x86_64")]
    Fused512(pulp::x86::V4),
}

impl Machine {
    /// Runs an operation with these vectors.
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

/// Operation with its vectors, in the form that `pulp` compiles.
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

/// Operation that is compiled once for every vector type.
pub(super) trait Operation {
    type Output;

    /// Must be `inline(always)`, like every function it calls, so that it is compiled for the
    /// vector type.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Arithmetic on vectors.
pub(super) trait Lanes: Copy {
    /// Register of at least eight numbers.
    type Vector: Pod;
    /// The same arithmetic with eight numbers.
    type Narrow: Lanes<Vector = f32x8>;

    /// Numbers in a vector.
    const WIDTH: usize = size_of::<Self::Vector>() / size_of::<f32>();
    /// Rows of sums that fit into registers together with two vectors of factors.
    const ROWS: usize;
    /// True if that many rows of two vectors fit into registers.
    const PAIRS: bool;

    fn narrow(self) -> Self::Narrow;

    fn splat(self, value: f32) -> Self::Vector;

    /// `a b + c`.
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;

    /// Sets every value to 0 whose gate is not above 0.
    fn gate(self, values: Self::Vector, gates: Self::Vector) -> Self::Vector;

    /// Loads the first numbers of a row; zeros if the row is too short.
    #[inline(always)]
    fn load(self, row: &[f32]) -> Self::Vector {
        let row = row.get(..Self::WIDTH).map(bytemuck::must_cast_slice);
        row.and_then(|row| bytemuck::try_pod_read_unaligned(row).ok()).unwrap_or(self.splat(0.0))
    }

    /// Stores a vector in the first numbers of a row; does nothing if the row is too short.
    #[inline(always)]
    fn store(self, vector: Self::Vector, row: &mut [f32]) {
        if let Some(row) = row.get_mut(..Self::WIDTH) {
            bytemuck::must_cast_slice_mut(row).copy_from_slice(bytemuck::bytes_of(&vector));
        }
    }
}

/// Plain arithmetic, vectorised by the compiler.
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
