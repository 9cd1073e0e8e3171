//! Both networks in series, one sample at a time: contact in, forces out.

use crate::chain::{Chain, Sums};
use crate::estimate::Estimate;
use crate::features::{COLLISION_INPUTS, FRICTION_INPUTS, Features};
use crate::fixed::scaled_root;
use crate::flags::Flags;
use crate::kernel::{Engine, Native};
use crate::model::{Between, Model, Network, WINDOW};
use crate::sample::{ContactState, Sample};
use crate::scale::Scale;
use crate::word_sum::guard;
use core::hash::{Hash, Hasher};
use core::marker::PhantomData;

/// Fraction bits of the root of the normal force in N.
const ROOT_BITS: u32 = 16;
/// Fraction bits of the coefficient of friction.
const COEFFICIENT_BITS: u32 = 24;

/// History of one network.
type Stream<'a, B, const IN: usize> = <Network<'a, B, IN> as Chain<'a, i16, IN>>::Stream;

/// A model with the histories of both of its networks.
///
/// The collision network gives the square root of the normal force divided by a power of the
/// deformation. The friction network takes that root (16 bits wide also in compact models) and the
/// sliding speed and gives the coefficient of friction. Without contact both forces are exactly 0.
/// All arithmetic from a [`Sample`] to the [`Estimate`] is integer arithmetic.
#[derive(Clone, Debug)]
pub struct Pair<'a, B: Between = i16, E: Engine = Native> {
    model: Model<'a, B>,
    features: Features,
    collision: Stream<'a, B, COLLISION_INPUTS>,
    friction: Stream<'a, B, FRICTION_INPUTS>,
    seen: u8,
    engine: PhantomData<E>,
}

impl<'a, B: Between, E: Engine> Pair<'a, B, E> {
    /// Creates a pair with an empty history.
    pub fn new(model: Model<'a, B>) -> Self {
        Self {
            features: Features::new(model.header()),
            collision: Network::stream(),
            friction: Network::stream(),
            model,
            seen: 0,
            engine: PhantomData,
        }
    }

    /// Clears the history: the next [`WINDOW`] - 1 samples are flagged [`Flags::WARMING_UP`].
    pub fn reset(&mut self) {
        Network::<'a, B, COLLISION_INPUTS>::clear(&mut self.collision);
        Network::<'a, B, FRICTION_INPUTS>::clear(&mut self.friction);
        self.seen = 0;
    }

    /// Replaces the model between two samples. The activations in the history belong to the old
    /// model, so the history restarts as after [`Self::reset`].
    pub fn switch(&mut self, model: Model<'a, B>) {
        *self = Self::new(model);
    }

    /// Model in use.
    pub fn model(&self) -> &Model<'a, B> {
        &self.model
    }

    /// Hashes everything that must not change while the model is in use, except the bytes of the
    /// image.
    pub fn hash_config(&self, state: &mut impl Hasher) {
        self.model.hash_config(state);
        self.features.hash(state);
    }

    /// Estimates the forces of a sample in SI units. A sample that is not finite gives forces of 0,
    /// flagged [`Flags::NON_FINITE`], and restarts the history. Speeds that exceed the range of a
    /// [`Sample`] (metres per second) are flagged as outside the training range.
    pub fn push(&mut self, state: &ContactState) -> Estimate {
        match state.sample() {
            Some(sample) => {
                let outside = sample.deformation_pm > 0 && !state.rates_fit();
                let mut estimate = self.step(&sample);
                estimate.flags |= Flags::OUTSIDE_RATE_RATIO.when(outside);
                estimate
            }
            None => self.without_sample(Flags::NON_FINITE),
        }
    }

    /// Records a missing sample: forces of 0, flagged [`Flags::MISSING`]; the history restarts.
    pub fn skip(&mut self) -> Estimate {
        self.without_sample(Flags::MISSING)
    }

    fn without_sample(&mut self, flag: Flags) -> Estimate {
        self.reset();
        Estimate::new(0, 0, flag | Flags::WARMING_UP, 0)
    }

    /// Estimates the forces of a sample.
    pub fn step(&mut self, sample: &Sample) -> Estimate {
        let column = self.features.collision(sample);
        let collision = self.model.collision();
        let kept =
            [column.root_force_factor_q30, column.flags.bits(), sample.sliding_speed_nm_s.cast_unsigned()];
        let ([factor, flags, sliding], flipped, (sum, clipped)) =
            guard(kept, || push::<B, E, _>(collision, &mut self.collision, &column.inputs));
        let root = scaled_root(collision.scale().apply(sum, ROOT_BITS), factor);
        let normal_force_mn = squared_mn(root);

        let inputs = self.features.friction(root, sliding.cast_signed());
        let friction = self.model.friction();
        let kept = [normal_force_mn.cast_unsigned(), flags, clipped, sliding];
        let ([normal_force, flags, clipped, sliding], flipped_later, (sum, clipped_later)) =
            guard(kept, || push::<B, E, _>(friction, &mut self.friction, &inputs));
        let normal_force_mn = normal_force.cast_signed();
        let coefficient = friction.scale().apply(sum, COEFFICIENT_BITS);
        let magnitude = product_mn(coefficient, normal_force_mn);
        let friction_force_mn = magnitude.wrapping_mul(sliding.cast_signed().signum()).wrapping_neg();

        let clipped = clipped.wrapping_add(clipped_later);
        self.seen = self.seen.saturating_add(1);
        let corruption = flipped as usize
            | flipped_later as usize
            | Network::<'a, B, COLLISION_INPUTS>::corruption(&self.collision)
            | Network::<'a, B, FRICTION_INPUTS>::corruption(&self.friction);
        let flags = Flags::from_bits(flags)
            | Flags::OUTSIDE_FORCE.when(normal_force > self.features.header().normal_force_high_mn)
            | Flags::SATURATED.when(clipped > 0)
            | Flags::IMPLAUSIBLE_FRICTION.when(coefficient >> COEFFICIENT_BITS != 0)
            | Flags::WARMING_UP.when(usize::from(self.seen) < WINDOW)
            | Flags::CORRUPTED.when(corruption != 0);
        Estimate::new(normal_force_mn, friction_force_mn, flags, clipped.min(u32::from(u16::MAX)) as u16)
    }
}

impl<B: Between, const IN: usize> Network<'_, B, IN> {
    /// Scale of the network's output sum.
    pub fn scale(&self) -> Scale {
        self.tail.tail.tail.scale()
    }
}

/// Computes one streaming step; returns the head's sum and the number of clipped activations.
#[inline]
fn push<'a, B: Between, E: Engine, const IN: usize>(
    network: &Network<'a, B, IN>,
    stream: &mut Stream<'a, B, IN>,
    column: &[i16; IN],
) -> (i32, u32) {
    Network::<'a, B, IN>::accept(stream, column);
    let clipped = network.run::<E>(stream);
    let Sums([sum]) = Network::<'a, B, IN>::output(stream);
    (sum, clipped)
}

/// Returns the square of a root force as a force in mN, at most `i32::MAX`.
#[inline]
fn squared_mn(root: u32) -> i32 {
    let square = u64::from(root).wrapping_mul(u64::from(root)) >> 12;
    (square.wrapping_mul(1000) >> (2 * ROOT_BITS - 12)).min(i32::MAX as u64) as i32
}

/// Multiplies a coefficient by a force in mN; at most `i32::MAX`.
#[inline]
fn product_mn(coefficient: u32, force_mn: i32) -> i32 {
    let product = u64::from(coefficient).wrapping_mul(u64::from(force_mn.cast_unsigned()));
    (product >> COEFFICIENT_BITS).min(i32::MAX as u64) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weights::hash_place;
    use crate::{BearingMaterial, shipped};

    fn pair() -> Pair<'static> {
        let mut pair = Pair::new(Model::load(shipped(BearingMaterial::Babbitt)).unwrap());
        for _ in 0..100 {
            flags(&mut pair);
        }
        pair
    }

    fn flags(pair: &mut Pair) -> Flags {
        pair.step(&Sample {
            radial_clearance_nm: 500_000,
            deformation_pm: 20_000_000,
            deformation_rate_nm_s: 100_000,
            approach_speed_nm_s: 3_000_000,
            sliding_speed_nm_s: 20_000_000,
        })
        .flags
    }

    #[test]
    fn a_bit_that_flips_anywhere_in_the_history_is_flagged_within_its_columns() {
        assert!((0..10).all(|_| !flags(&mut pair()).contains(Flags::CORRUPTED)));
        type Place = for<'p> fn(&'p mut Pair<'static>) -> &'p mut [u8];
        let places: [Place; 8] = [
            |p| p.collision.history().bytes(),
            |p| p.collision.tail().history().bytes(),
            |p| p.collision.tail().tail().history().bytes(),
            |p| p.collision.tail().tail().tail().history().bytes(),
            |p| p.friction.history().bytes(),
            |p| p.friction.tail().history().bytes(),
            |p| p.friction.tail().tail().history().bytes(),
            |p| p.friction.tail().tail().tail().history().bytes(),
        ];
        for (number, place) in places.into_iter().enumerate() {
            for byte in 0..place(&mut pair()).len() {
                let mut corrupted = pair();
                place(&mut corrupted)[byte] ^= 1 << (byte % 8);
                let flagged = (0..3).filter(|_| flags(&mut corrupted).contains(Flags::CORRUPTED)).count();
                assert_eq!(flagged, 1, "byte {byte} of ring {number}");
                assert!(!flags(&mut corrupted).contains(Flags::CORRUPTED));
            }
        }
    }

    #[test]
    fn a_cleared_history_is_not_flagged_as_corrupted() {
        let mut pair = pair();
        for _ in 0..20 {
            pair.reset();
            assert!((0..30).all(|_| !flags(&mut pair).contains(Flags::CORRUPTED)));
            pair.skip();
            flags(&mut pair);
        }
    }

    /// Hasher that records the bytes it is given.
    #[derive(Default)]
    struct Record(Vec<u8>);

    impl Hasher for Record {
        fn write(&mut self, bytes: &[u8]) {
            self.0.extend_from_slice(bytes);
        }

        fn finish(&self) -> u64 {
            0
        }
    }

    #[test]
    fn the_configuration_hash_covers_every_parameter() {
        let pair = pair();
        let of = |feed: &dyn Fn(&mut Record)| {
            let mut record = Record::default();
            feed(&mut record);
            record.0
        };
        let all = of(&|sum| pair.hash_config(sum));
        let contains = |part: &[u8]| all.windows(part.len()).any(|window| window == part);
        let model = pair.model();
        let parts = [
            of(&|sum| model.header().hash(sum)),
            of(&|sum| model.checksum().hash(sum)),
            of(&|sum| model.collision().scale().hash(sum)),
            of(&|sum| model.friction().scale().hash(sum)),
            of(&|sum| pair.features.hash(sum)),
            of(&|sum| model.collision().hash_config(sum)),
            of(&|sum| model.friction().hash_config(sum)),
        ];
        for (number, part) in parts.iter().enumerate() {
            assert!(!part.is_empty() && contains(part), "part {number}");
        }
        // Every network has two addresses per layer and one for the head's biases.
        let place = of(&|sum| hash_place(&[0_u32][..], sum)).len();
        for network in [&parts[5], &parts[6]] {
            let scale = parts[2].len();
            // The storage form of each layer's weights is hashed, too.
            assert!(network.len() >= scale + 9 * place, "{} bytes", network.len());
        }
    }
}
