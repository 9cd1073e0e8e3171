//! Networks as types: a chain of layers, each with its shape, and the memory that running them
//! takes.
//!
//! `Then<Convolution<..>, Then<Convolution<..>, Head<..>>>` is a network. The compiler computes the
//! size of its streams and windows. A chain runs in three modes that give the same sums:
//!
//! * as a causal stream ([`Chain::accept`] and [`Chain::run`]): one new column per sample; every
//!   layer keeps the columns that it needs ([`crate::Streaming`]);
//! * over a complete window ([`crate::Windowed::evaluate`]);
//! * over a window that moved by one column, where only the changed outputs are computed
//!   ([`crate::Windowed::slide`]).

use crate::convolution::Convolution;
use crate::head::Head;
use crate::image::{ImageError, LayerName, ReadLayers, Reader};
use crate::kernel::Engine;
use crate::padding::Padding;
use crate::ring::Ring;
use crate::weights::LayerInput;
use core::hash::Hasher;

/// A layer and the rest of the chain.
#[derive(Clone, Copy, Debug)]
pub struct Then<L, R> {
    /// First layer of this chain.
    pub layer: L,
    /// Chain that takes the layer's outputs.
    pub tail: R,
}

/// Chain of layers that takes columns of `IN` activations `A`.
pub trait Chain<'a, A: LayerInput, const IN: usize>: ReadLayers<'a> {
    /// Multiply-accumulates of a streaming step.
    const MACS: usize;
    /// Number of columns that one result depends on.
    const WINDOW: usize;
    /// Number of columns of the last convolution that the head takes.
    const HEAD_COLUMNS: usize;
    /// Sums of the head.
    type Output: Copy + Default + PartialEq + core::fmt::Debug;
    /// State of a stream.
    type Stream: Clone + core::fmt::Debug;
    /// State of a window of `P` columns.
    type Window<const P: usize>: Clone + core::fmt::Debug;

    /// Returns a stream whose history is zeros.
    fn stream() -> Self::Stream;

    /// Clears the history. The stream has no valid output until the next column has been run.
    fn clear(stream: &mut Self::Stream);

    /// Appends the newest column.
    fn accept(stream: &mut Self::Stream, column: &[A; IN]);

    /// Computes the newest column with the preceding layer; returns the number of clipped
    /// activations.
    fn receive<E: Engine, F: LayerInput, const FRONT: usize, const TAPS: usize>(
        stream: &mut Self::Stream,
        layer: &Convolution<'_, F, A, FRONT, IN, TAPS>,
        columns: &[[F; FRONT]; TAPS],
    ) -> u32;

    /// Computes everything that depends on the newest column; returns the number of clipped
    /// activations.
    fn run<E: Engine>(&self, stream: &mut Self::Stream) -> u32;

    /// Non-zero if the history or a layer's weight pointer was corrupted since the last column.
    fn corruption(stream: &Self::Stream) -> usize;

    /// Hashes the configuration: the addresses of the layers' parameters and the head's scale.
    fn hash_config(&self, state: &mut impl Hasher);

    /// Sums after [`Self::run`].
    fn output(stream: &Self::Stream) -> Self::Output;

    /// Returns a window of zeros.
    fn window<const P: usize>() -> Self::Window<P>;

    /// Input columns of the chain.
    fn columns<const P: usize>(window: &mut Self::Window<P>) -> &mut [[A; IN]; P];

    /// Computes all outputs that follow from the first `count` columns of a window.
    fn evaluate<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        padding: Padding,
        count: usize,
    ) -> (Self::Output, u32);

    /// Updates the outputs after the input columns moved by one place. Computes what depends on the
    /// first `left` or the last `right` of `count` columns, or on padding. The columns of the
    /// following layers are moved here.
    fn slide<E: Engine, const P: usize>(
        &self,
        window: &mut Self::Window<P>,
        padding: Padding,
        count: usize,
        changed: [usize; 2],
    ) -> (Self::Output, u32);
}

/// Stream of a convolution and of the rest of the chain.
#[derive(Clone, Debug)]
pub struct ConvolutionStream<A, const IN: usize, const K: usize, R> {
    history: Ring<A, IN, K>,
    tail: R,
}

/// Window of a convolution's inputs and of the rest of the chain.
#[derive(Clone, Debug)]
#[repr(align(4))]
pub struct ConvolutionWindow<A, const IN: usize, const P: usize, R> {
    columns: [[A; IN]; P],
    tail: R,
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

impl<'a, A, B, R, const IN: usize, const OUT: usize, const K: usize> ReadLayers<'a>
    for Then<Convolution<'a, A, B, IN, OUT, K>, R>
where
    A: LayerInput,
    B: LayerInput,
    R: ReadLayers<'a>,
{
    fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        Ok(Self { layer: Convolution::read(reader, layer)?, tail: R::read(reader, layer.next())? })
    }
}

impl<'a, A, B, R, const IN: usize, const OUT: usize, const K: usize> Chain<'a, A, IN>
    for Then<Convolution<'a, A, B, IN, OUT, K>, R>
where
    A: LayerInput,
    B: LayerInput,
    R: Chain<'a, B, OUT>,
{
    const MACS: usize = Convolution::<A, B, IN, OUT, K>::MACS + R::MACS;
    const WINDOW: usize = K - 1 + R::WINDOW;
    const HEAD_COLUMNS: usize = R::HEAD_COLUMNS;
    type Output = R::Output;
    type Stream = ConvolutionStream<A, IN, K, R::Stream>;
    type Window<const P: usize> = ConvolutionWindow<A, IN, P, R::Window<P>>;

    fn stream() -> Self::Stream {
        ConvolutionStream { history: Ring::new(), tail: R::stream() }
    }

    #[inline]
    fn clear(stream: &mut Self::Stream) {
        stream.history.clear();
        R::clear(&mut stream.tail);
    }

    #[inline]
    fn accept(stream: &mut Self::Stream, column: &[A; IN]) {
        stream.history.push(column);
    }

    #[inline]
    fn receive<E: Engine, F: LayerInput, const FRONT: usize, const TAPS: usize>(
        stream: &mut Self::Stream,
        layer: &Convolution<'_, F, A, FRONT, IN, TAPS>,
        columns: &[[F; FRONT]; TAPS],
    ) -> u32 {
        receive::<E, F, A, FRONT, IN, TAPS, K>(&mut stream.history, layer, columns)
    }

    #[inline]
    fn run<E: Engine>(&self, stream: &mut Self::Stream) -> u32 {
        let clipped = R::receive::<E, A, IN, K>(&mut stream.tail, &self.layer, stream.history.columns());
        clipped.wrapping_add(self.tail.run::<E>(&mut stream.tail))
    }

    #[inline]
    fn corruption(stream: &Self::Stream) -> usize {
        stream.history.corruption() | R::corruption(&stream.tail)
    }

    fn hash_config(&self, state: &mut impl Hasher) {
        self.layer.hash_config(state);
        self.tail.hash_config(state);
    }

    #[inline]
    fn output(stream: &Self::Stream) -> Self::Output {
        R::output(&stream.tail)
    }

    fn window<const P: usize>() -> Self::Window<P> {
        ConvolutionWindow { columns: [[A::default(); IN]; P], tail: R::window() }
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
        let outputs = R::columns(&mut window.tail);
        let clipped = self.layer.positions::<E>(inputs, padding.before(K), 0..count, outputs);
        let (output, clipped_after) = self.tail.evaluate::<E, P>(&mut window.tail, padding, count);
        (output, clipped.wrapping_add(clipped_after))
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
        let outputs = R::columns(&mut window.tail);
        forget_oldest(outputs);
        let before = padding.before(K);
        let mut clipped = self.layer.positions::<E>(inputs, before, 0..left, outputs);
        let fresh = count.saturating_sub(right)..count;
        clipped = clipped.wrapping_add(self.layer.positions::<E>(inputs, before, fresh, outputs));
        let (output, clipped_after) =
            self.tail.slide::<E, P>(&mut window.tail, padding, count, [left, right]);
        (output, clipped.wrapping_add(clipped_after))
    }
}

impl<'a, A: LayerInput, const IN: usize, const COLUMNS: usize, const OUT: usize> ReadLayers<'a>
    for Head<'a, A, IN, COLUMNS, OUT>
{
    fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        Head::read(reader, layer)
    }
}

impl<'a, A: LayerInput, const IN: usize, const COLUMNS: usize, const OUT: usize> Chain<'a, A, IN>
    for Head<'a, A, IN, COLUMNS, OUT>
{
    const MACS: usize = Self::MACS;
    const WINDOW: usize = COLUMNS;
    const HEAD_COLUMNS: usize = COLUMNS;
    type Output = Sums<OUT>;
    type Stream = HeadStream<A, IN, COLUMNS, OUT>;
    type Window<const P: usize> = HeadWindow<A, IN, P>;

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
    fn receive<E: Engine, F: LayerInput, const FRONT: usize, const TAPS: usize>(
        stream: &mut Self::Stream,
        layer: &Convolution<'_, F, A, FRONT, IN, TAPS>,
        columns: &[[F; FRONT]; TAPS],
    ) -> u32 {
        receive::<E, F, A, FRONT, IN, TAPS, COLUMNS>(&mut stream.history, layer, columns)
    }

    #[inline]
    fn run<E: Engine>(&self, stream: &mut Self::Stream) -> u32 {
        stream.sums = self.apply::<E>(stream.history.columns());
        0
    }

    #[inline]
    fn corruption(stream: &Self::Stream) -> usize {
        stream.history.corruption()
    }

    fn hash_config(&self, state: &mut impl Hasher) {
        Head::hash_config(self, state);
    }

    #[inline]
    fn output(stream: &Self::Stream) -> Self::Output {
        Sums(stream.sums)
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

/// Sums of a head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sums<const OUT: usize>(pub [i32; OUT]);

impl<const OUT: usize> Default for Sums<OUT> {
    fn default() -> Self {
        Self([0; OUT])
    }
}

/// Computes the newest column of a history and writes both copies at once. No other copy exists
/// meanwhile in which a bit flip would go unnoticed.
#[inline]
fn receive<
    E: Engine,
    A: LayerInput,
    B: LayerInput,
    const IN: usize,
    const OUT: usize,
    const K: usize,
    const N: usize,
>(
    history: &mut Ring<B, OUT, N>,
    layer: &Convolution<'_, A, B, IN, OUT, K>,
    columns: &[[A; IN]; K],
) -> u32 {
    let outcome = layer.compute::<E, N>(columns, history.advance());
    history.mark_corrupted(outcome.corruption);
    outcome.clipped
}

/// Moves every column one place towards the oldest; the newest place keeps its value.
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

    pub(crate) fn tail(&mut self) -> &mut R {
        &mut self.tail
    }
}

#[cfg(test)]
impl<A, const IN: usize, const COLUMNS: usize, const OUT: usize> HeadStream<A, IN, COLUMNS, OUT> {
    pub(crate) fn history(&mut self) -> &mut Ring<A, IN, COLUMNS> {
        &mut self.history
    }
}
