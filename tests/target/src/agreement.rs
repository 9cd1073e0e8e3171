//! Digests of the outputs of layers and networks, for comparison between engines and cores.

use crate::network::{COLUMNS, INPUTS, Reference, Room, random, read, reference_shapes};
use crate::noise::Noise;
use inference::chain::{Sums, Then};
use inference::image::WeightForm;
use inference::kernel::Engine;
use inference::{Causal, Convolution, Head, LayerInput, Pad, Same, Streaming, Windowed};

/// FNV-1a hash over integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(pub u64);

impl Digest {
    /// Digest of nothing.
    pub const EMPTY: Self = Self(0xcbf2_9ce4_8422_2325);

    /// Adds an integer.
    pub fn add(&mut self, value: i64) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Shapes under test: partial groups and blocks of every kind in taps and outputs, one column and
/// one input among them.
macro_rules! shapes {
    ($run:ident $arguments:tt
     $($input:ty => $output:ty, $form:ident, $inputs:literal, $outputs:literal, $kernel:literal;)*) => {
        $($run::<E, $input, $output, $inputs, $outputs, $kernel>(WeightForm::$form, $arguments)?;)*
    };
}

const PLACES: usize = 9;

/// Computes one convolution at every position of a window with every padding, and a head over its
/// outputs.
fn layer<E: Engine, A: LayerInput, B: LayerInput, const IN: usize, const OUT: usize, const K: usize>(
    form: WeightForm,
    (seed, digest, room): (&mut u64, &mut Digest, &mut Room),
) -> Option<()> {
    *seed = seed.wrapping_add(0x9e37_79b9);
    let head_form = if B::BITS == 8 { WeightForm::Packed } else { form };
    let shapes = [Convolution::<A, B, IN, OUT, K>::shape(form), Head::<B, OUT, 2, 3>::shape(head_form)];
    let used = random(&shapes, *seed, room).ok()?;
    let bytes = room.0.get(..used)?;
    let network: Then<Convolution<'_, A, B, IN, OUT, K>, Head<'_, B, OUT, 2, 3>> = read(bytes).ok()?;
    let mut noise = Noise(*seed ^ 0x5555);
    let full_scale = A::MAX.cast_unsigned();
    let inputs: [[A; IN]; PLACES] = core::array::from_fn(|_| {
        core::array::from_fn(|_| {
            let value = noise.within(full_scale);
            // Features may be negative, down to the smallest integer.
            A::from_i32(if noise.bits().is_multiple_of(50) { -A::MAX - 1 } else { value })
        })
    });
    for (before, count) in [(K - 1, PLACES), ((K - 1) / 2, PLACES), (0, PLACES - (K - 1))] {
        let mut outputs = [[B::default(); OUT]; PLACES];
        let clipped = network.layer.positions::<E>(&inputs, before, 0..count, &mut outputs);
        digest.add(i64::from(clipped));
        outputs.as_flattened().iter().for_each(|&output| digest.add(i64::from(output.widen())));
        for columns in outputs.windows(2) {
            let sums = network.tail.apply::<E>(columns.first_chunk()?);
            sums.into_iter().for_each(|sum| digest.add(i64::from(sum)));
        }
    }
    Some(())
}

/// Computes the reference network in all of its modes.
fn network<E: Engine, A: LayerInput, D: Pad>(
    form: WeightForm,
    seed: &mut u64,
    digest: &mut Digest,
    room: &mut Room,
) -> Option<()> {
    *seed = seed.wrapping_add(0x9e37_79b9);
    let first = WeightForm::Wide;
    let used = random(&reference_shapes::<A>(first, form), *seed, room).ok()?;
    let network: Reference<'_, A> = read(room.0.get(..used)?).ok()?;
    let mut noise = Noise(*seed);
    let mut column = || core::array::from_fn::<i16, INPUTS, _>(|_| noise.within(32767) as i16);
    let mut window = Windowed::<_, i16, INPUTS, COLUMNS, D, E>::new(network);
    let mut stream = Streaming::<_, i16, INPUTS, E>::new(network);
    let columns: [[i16; INPUTS]; COLUMNS] = core::array::from_fn(|_| column());
    let mut add = |(Sums([sum]), clipped): (Sums<1>, u32)| {
        digest.add(i64::from(sum));
        digest.add(i64::from(clipped));
    };
    add(window.evaluate(&columns));
    for _ in 0..3 {
        let newest = column();
        add(window.slide(&newest));
        add(stream.push(&newest));
    }
    Some(())
}

/// Computes the digest with one engine; `None` if the parameters could not be set up.
pub fn digest<E: Engine>(mut seed: u64, room: &mut Room) -> Option<Digest> {
    let mut all = Digest::EMPTY;
    let (seed, digest) = (&mut seed, &mut all);
    shapes! { layer (&mut *seed, &mut *digest, &mut *room)
        i16 => i16, Wide, 6, 16, 5;
        i16 => i16, Wide, 16, 32, 5;
        i16 => i16, Wide, 32, 32, 3;
        i16 => i16, Wide, 8, 16, 3;
        i16 => i16, Wide, 3, 5, 3;
        i16 => i16, Wide, 1, 1, 1;
        i16 => i16, Wide, 5, 7, 1;
        i16 => i16, Wide, 7, 4, 5;
        i16 => i8, Wide, 4, 16, 3;
        i16 => i16, Packed, 6, 16, 5;
        i16 => i16, Packed, 16, 32, 5;
        i16 => i16, Packed, 3, 5, 3;
        i16 => i16, Packed, 1, 1, 1;
        i16 => i16, Packed, 2, 6, 1;
        i16 => i16, Packed, 3, 7, 1;
        i16 => i16, Packed, 5, 9, 2;
        i16 => i16, Packed, 7, 4, 5;
        i16 => i8, Packed, 8, 16, 3;
        i8 => i8, Packed, 6, 16, 5;
        i8 => i8, Packed, 16, 32, 5;
        i8 => i8, Packed, 32, 32, 3;
        i8 => i8, Packed, 3, 5, 3;
        i8 => i8, Packed, 1, 1, 1;
        i8 => i16, Packed, 2, 6, 1;
        i8 => i8, Packed, 3, 7, 1;
        i8 => i8, Packed, 5, 9, 2;
        i8 => i8, Packed, 7, 4, 5;
    }
    network::<E, i16, Same>(WeightForm::Wide, seed, digest, room)?;
    network::<E, i16, Causal>(WeightForm::Packed, seed, digest, room)?;
    network::<E, i8, Same>(WeightForm::Packed, seed, digest, room)?;
    Some(all)
}
