//! Networks as types: layers in a chain, each with its shape, and the memory that running them takes.
//!
//! `Then<Convolution<..>, Then<Convolution<..>, Head<..>>>` is a network; the compiler sizes its streams and windows. A chain
//! runs in four ways that give the same sums:
//!
//! * as a stream ([`Chain::accept`] and [`Chain::run`]): one new column a sample, causal, every layer keeps the columns it
//!   looks at ([`crate::Streaming`]);
//! * as a stream in pieces: the same with the units of work spread over several ticks ([`crate::Interleaved`]);
//! * over a whole window ([`crate::Windowed::evaluate`]);
//! * over a window that moved on by one column, computing only what has changed ([`crate::Windowed::slide`]).

use crate::activation::Activation;
use crate::convolution::Convolution;
use crate::error::ImageError;
use crate::head::Head;
use crate::image::{LayerName, Reader};
use crate::kernel::Engine;
use crate::ring::Ring;
use crate::windowed::Padding;
use core::hash::Hasher;
use core::ops::Range;

/// A layer and what follows it.
#[derive(Clone, Copy, Debug)]
pub struct Then<L, R> {
    /// The layer.
    pub layer: L,
    /// What takes its outputs.
    pub rest: R,
}

/// A chain of layers that takes columns of `IN` activations `A`.
pub trait Chain<'a, A: Activation, const IN: usize>: Sized {
    /// Units of work of a streaming step.
    const UNITS: usize;
    /// Multiply-accumulates of a streaming step.
    const MACS: usize;
    /// Columns that one result depends on.
    const WINDOW: usize;
    /// Columns of the last convolution that the head takes.
    const HEAD_COLUMNS: usize;
    /// The head's sums.
    type Output: Copy + Default + PartialEq + core::fmt::Debug;
    /// What a stream keeps.
    type Stream: Clone + core::fmt::Debug;
    /// What a window of `P` columns keeps.
    type Window<const P: usize>: Clone + core::fmt::Debug;

    /// Takes the chain from an image and checks it against its type.
    fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError>;

    /// A stream that has seen nothing but zeros.
    fn stream() -> Self::Stream;

    /// Forgets what the stream has seen; its result is none until the next column has been run.
    fn clear(stream: &mut Self::Stream);

    /// Takes the newest column.
    fn accept(stream: &mut Self::Stream, column: &[A; IN]);

    /// Takes some units of the newest column from the layer in front; gives how many activations were clipped.
    fn receive<E: Engine, F: Activation, const FRONT: usize, const TAPS: usize>(
        stream: &mut Self::Stream,
        layer: &Convolution<'_, F, A, FRONT, IN, TAPS>,
        columns: &[[F; FRONT]; TAPS],
        units: Range<usize>,
    ) -> u32;

    /// Does some units of the work that the newest column brought, in order; gives how many activations were clipped.
    fn run<E: Engine>(&self, stream: &mut Self::Stream, units: Range<usize>) -> u32;

    /// Not 0 where something that the stream remembers has been found to be no longer what was put there, with the last column, or where the way through a layer's
    /// numbers did not end where they end.
    fn altered(stream: &Self::Stream) -> usize;

    /// Gives whatever must stay as it is to a sum: where the layers' numbers lie, and the head's scale.
    fn constants(&self, sum: &mut impl Hasher);

    /// The sums after the last unit.
    fn output(stream: &Self::Stream) -> Self::Output;

    /// Multiply-accumulates of one unit.
    fn unit_macs(unit: usize) -> usize;

    /// A window of zeros.
    fn window<const P: usize>() -> Self::Window<P>;

    /// The columns at the chain's entrance.
    fn columns<const P: usize>(window: &mut Self::Window<P>) -> &mut [[A; IN]; P];

    /// Computes everything behind the first `count` columns of a window.
    fn evaluate<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        padding: Padding,
        count: usize,
    ) -> (Self::Output, u32);

    /// After a move by one column: computes what depends on the first `left` or the last `right` of `count` columns, or on
    /// padding. The columns at the entrance have moved already; those behind are moved here.
    fn slide<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        padding: Padding,
        count: usize,
        changed: [usize; 2],
    ) -> (Self::Output, u32);
}

/// Stream of a convolution and what follows it.
#[derive(Clone, Debug)]
pub struct ConvolutionStream<A, const IN: usize, const K: usize, R> {
    history: Ring<A, IN, K>,
    rest: R,
}

/// Window of a convolution's inputs and what follows it.
#[derive(Clone, Debug)]
#[repr(align(4))]
pub struct ConvolutionWindow<A, const IN: usize, const P: usize, R> {
    columns: [[A; IN]; P],
    rest: R,
}

/// Stream of a head.
#[derive(Clone, Debug)]
pub struct HeadStream<A, const IN: usize, const COLUMNS: usize, const OUT: usize> {
    history: Ring<A, IN, COLUMNS>,
    sums: [i32; OUT],
}

/// Window of a head's inputs.
#[derive(Clone, Debug)]
#[repr(align(4))]
pub struct HeadWindow<A, const IN: usize, const P: usize> {
    columns: [[A; IN]; P],
}

impl<'a, A, B, R, const IN: usize, const OUT: usize, const K: usize> Chain<'a, A, IN>
    for Then<Convolution<'a, A, B, IN, OUT, K>, R>
where
    A: Activation,
    B: Activation,
    R: Chain<'a, B, OUT>,
{
    const UNITS: usize = Convolution::<A, B, IN, OUT, K>::UNITS + R::UNITS;
    const MACS: usize = Convolution::<A, B, IN, OUT, K>::MACS + R::MACS;
    const WINDOW: usize = K - 1 + R::WINDOW;
    const HEAD_COLUMNS: usize = R::HEAD_COLUMNS;
    type Output = R::Output;
    type Stream = ConvolutionStream<A, IN, K, R::Stream>;
    type Window<const P: usize> = ConvolutionWindow<A, IN, P, R::Window<P>>;

    fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        Ok(Self { layer: Convolution::read(reader, layer)?, rest: R::read(reader, layer.next())? })
    }

    fn stream() -> Self::Stream {
        ConvolutionStream { history: Ring::new(), rest: R::stream() }
    }

    #[inline]
    fn clear(stream: &mut Self::Stream) {
        stream.history.clear();
        R::clear(&mut stream.rest);
    }

    #[inline]
    fn accept(stream: &mut Self::Stream, column: &[A; IN]) {
        stream.history.push(column);
    }

    #[inline]
    fn receive<E: Engine, F: Activation, const FRONT: usize, const TAPS: usize>(
        stream: &mut Self::Stream,
        layer: &Convolution<'_, F, A, FRONT, IN, TAPS>,
        columns: &[[F; FRONT]; TAPS],
        units: Range<usize>,
    ) -> u32 {
        receive::<E, F, A, FRONT, IN, TAPS, K>(&mut stream.history, layer, columns, units)
    }

    #[inline]
    fn run<E: Engine>(&self, stream: &mut Self::Stream, units: Range<usize>) -> u32 {
        let own = Convolution::<A, B, IN, OUT, K>::UNITS;
        let mut clipped = 0u32;
        if units.start < own {
            let here = units.start..units.end.min(own);
            clipped =
                R::receive::<E, A, IN, K>(&mut stream.rest, &self.layer, stream.history.columns(), here);
        }
        if units.end > own {
            let there = units.start.saturating_sub(own)..units.end.wrapping_sub(own);
            clipped = clipped.wrapping_add(self.rest.run::<E>(&mut stream.rest, there));
        }
        clipped
    }

    #[inline]
    fn altered(stream: &Self::Stream) -> usize {
        stream.history.altered() | R::altered(&stream.rest)
    }

    fn constants(&self, sum: &mut impl Hasher) {
        self.layer.constants(sum);
        self.rest.constants(sum);
    }

    #[inline]
    fn output(stream: &Self::Stream) -> Self::Output {
        R::output(&stream.rest)
    }

    fn unit_macs(unit: usize) -> usize {
        let own = Convolution::<A, B, IN, OUT, K>::UNITS;
        match unit.checked_sub(own) {
            Some(there) => R::unit_macs(there),
            None if unit < OUT / crate::kernel::BLOCK => K * IN * crate::kernel::BLOCK,
            None => K * IN * (OUT % crate::kernel::BLOCK),
        }
    }

    fn window<const P: usize>() -> Self::Window<P> {
        ConvolutionWindow { columns: [[A::default(); IN]; P], rest: R::window() }
    }

    fn columns<const P: usize>(window: &mut Self::Window<P>) -> &mut [[A; IN]; P] {
        &mut window.columns
    }

    fn evaluate<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        padding: Padding,
        count: usize,
    ) -> (Self::Output, u32) {
        let inputs = window.columns.get(..count).unwrap_or_default();
        let count = padding.outputs(count, K);
        let outputs = R::columns(&mut window.rest);
        let clipped = self.layer.positions::<E>(inputs, padding.before(K), 0..count, outputs);
        let (output, behind) = self.rest.evaluate::<E, P>(&mut window.rest, padding, count);
        (output, clipped.wrapping_add(behind))
    }

    fn slide<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        padding: Padding,
        count: usize,
        [left, right]: [usize; 2],
    ) -> (Self::Output, u32) {
        let inputs = window.columns.get(..count).unwrap_or_default();
        let count = padding.outputs(count, K);
        let left = left.saturating_add(padding.stale_left(K)).min(count);
        let right = right.saturating_add(padding.stale_right(K)).min(count.saturating_sub(left));
        let outputs = R::columns(&mut window.rest);
        forget_oldest(outputs);
        let before = padding.before(K);
        let mut clipped = self.layer.positions::<E>(inputs, before, 0..left, outputs);
        let fresh = count.saturating_sub(right)..count;
        clipped = clipped.wrapping_add(self.layer.positions::<E>(inputs, before, fresh, outputs));
        let (output, behind) = self.rest.slide::<E, P>(&mut window.rest, padding, count, [left, right]);
        (output, clipped.wrapping_add(behind))
    }
}

impl<'a, A: Activation, const IN: usize, const COLUMNS: usize, const OUT: usize> Chain<'a, A, IN>
    for Head<'a, A, IN, COLUMNS, OUT>
{
    const UNITS: usize = 1;
    const MACS: usize = Self::MACS;
    const WINDOW: usize = COLUMNS;
    const HEAD_COLUMNS: usize = COLUMNS;
    type Output = Sums<OUT>;
    type Stream = HeadStream<A, IN, COLUMNS, OUT>;
    type Window<const P: usize> = HeadWindow<A, IN, P>;

    fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        Head::read(reader, layer)
    }

    fn stream() -> Self::Stream {
        HeadStream { history: Ring::new(), sums: [0; OUT] }
    }

    #[inline]
    fn clear(stream: &mut Self::Stream) {
        stream.history.clear();
    }

    #[inline]
    fn accept(stream: &mut Self::Stream, column: &[A; IN]) {
        stream.history.push(column);
    }

    #[inline]
    fn receive<E: Engine, F: Activation, const FRONT: usize, const TAPS: usize>(
        stream: &mut Self::Stream,
        layer: &Convolution<'_, F, A, FRONT, IN, TAPS>,
        columns: &[[F; FRONT]; TAPS],
        units: Range<usize>,
    ) -> u32 {
        receive::<E, F, A, FRONT, IN, TAPS, COLUMNS>(&mut stream.history, layer, columns, units)
    }

    #[inline]
    fn run<E: Engine>(&self, stream: &mut Self::Stream, units: Range<usize>) -> u32 {
        if units.start == 0 && units.end > 0 {
            stream.sums = self.apply::<E>(stream.history.columns());
        }
        0
    }

    #[inline]
    fn altered(stream: &Self::Stream) -> usize {
        stream.history.altered()
    }

    fn constants(&self, sum: &mut impl Hasher) {
        Head::constants(self, sum);
    }

    #[inline]
    fn output(stream: &Self::Stream) -> Self::Output {
        Sums(stream.sums)
    }

    fn unit_macs(unit: usize) -> usize {
        if unit == 0 { Self::MACS } else { 0 }
    }

    fn window<const P: usize>() -> Self::Window<P> {
        HeadWindow { columns: [[A::default(); IN]; P] }
    }

    fn columns<const P: usize>(window: &mut Self::Window<P>) -> &mut [[A; IN]; P] {
        &mut window.columns
    }

    fn evaluate<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        _: Padding,
        count: usize,
    ) -> (Self::Output, u32) {
        let newest = window.columns.get(..count).and_then(<[_]>::last_chunk::<COLUMNS>);
        (newest.map_or(Sums::default(), |columns| Sums(self.apply::<E>(columns))), 0)
    }

    fn slide<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        padding: Padding,
        count: usize,
        _: [usize; 2],
    ) -> (Self::Output, u32) {
        self.evaluate::<E, P>(window, padding, count)
    }
}

/// The sums of a head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sums<const OUT: usize>(pub [i32; OUT]);

impl<const OUT: usize> Default for Sums<OUT> {
    fn default() -> Self {
        Self([0; OUT])
    }
}

/// Writes some units of a layer's outputs into a history, both copies at once: nothing is kept elsewhere meanwhile, where a bit could flip unseen.
#[inline]
fn receive<
    E: Engine,
    A: Activation,
    B: Activation,
    const IN: usize,
    const OUT: usize,
    const K: usize,
    const N: usize,
>(
    history: &mut Ring<B, OUT, N>,
    layer: &Convolution<'_, A, B, IN, OUT, K>,
    columns: &[[A; IN]; K],
    units: Range<usize>,
) -> u32 {
    if units.is_empty() {
        return 0;
    }
    let newest = if units.start == 0 { history.open() } else { history.newest() };
    let done = layer.units::<E, N>(units, columns, newest);
    history.mark(done.astray);
    done.clipped
}

/// Moves every column to the place of its elder; the newest place keeps a copy.
pub(crate) fn forget_oldest<T: Copy>(columns: &mut [T]) {
    if columns.len() > 1 {
        columns.copy_within(1.., 0);
    }
}

#[cfg(test)]
impl<A, const IN: usize, const K: usize, R> ConvolutionStream<A, IN, K, R> {
    pub(crate) fn history(&mut self) -> &mut Ring<A, IN, K> {
        &mut self.history
    }

    pub(crate) fn rest(&mut self) -> &mut R {
        &mut self.rest
    }
}

#[cfg(test)]
impl<A, const IN: usize, const COLUMNS: usize, const OUT: usize> HeadStream<A, IN, COLUMNS, OUT> {
    pub(crate) fn history(&mut self) -> &mut Ring<A, IN, COLUMNS> {
        &mut self.history
    }
}
