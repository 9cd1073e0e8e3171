//! What is done with the blocks of [`super::block`]: outputs, slopes over inputs, gradients over weights.

use super::block::{Sums, Visit, across, along, gate, load, store, vectors};
use super::lanes::Lanes;
use super::room::Room;

/// The outputs of a convolution with ReLU.
pub(super) struct Convolve<'a> {
    pub(super) seen: &'a [f32],
    pub(super) step: usize,
    pub(super) taps: usize,
    pub(super) weights: &'a [f32],
    pub(super) biases: &'a [f32],
    pub(super) outputs: &'a mut [f32],
}

impl Visit for Convolve<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()> {
        let channels = self.biases.len();
        let seen = (self.seen.get(row * self.step..)?, self.step, self.taps);
        let sums: Sums<L, R, V> = [vectors(lanes, self.biases, at)?; R];
        let sums = along(lanes, seen, (self.weights, channels, at), sums)?;
        store(lanes, &gate::<L, R, V>(lanes, sums, &sums), (self.outputs, channels), (row, at))
    }
}

/// The slopes over what a convolution sees, through the ReLU that gave it.
pub(super) struct Spread<'a> {
    pub(super) slopes: &'a [f32],
    pub(super) step: usize,
    pub(super) taps: usize,
    pub(super) weights: &'a [f32],
    pub(super) channels: usize,
    pub(super) seen: &'a [f32],
    pub(super) outputs: &'a mut [f32],
}

impl Visit for Spread<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()> {
        let slopes = (self.slopes.get(row * self.step..)?, self.step, self.taps);
        let sums: Sums<L, R, V> = [[lanes.splat(0.0); V]; R];
        let sums = along(lanes, slopes, (self.weights, self.channels, at), sums)?;
        let gates = load::<L, R, V>(lanes, (self.seen, self.channels), (row, at))?;
        store(lanes, &gate::<L, R, V>(lanes, sums, &gates), (self.outputs, self.channels), (row, at))
    }
}

/// The gradient over a convolution's weights, added up over the windows that go back.
pub(super) struct Collect<'a> {
    pub(super) rooms: &'a [Room],
    pub(super) layer: usize,
    pub(super) channels: usize,
    pub(super) sums: &'a mut [f32],
}

impl Visit for Collect<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()> {
        let mut sums = load::<L, R, V>(lanes, (self.sums, self.channels), (row, at))?;
        for room in self.rooms.iter().filter(|room| room.goes_back) {
            let (seen, slopes) = (room.seen.get(self.layer)?, room.slopes.get(self.layer)?);
            let slopes = (slopes.inside(), self.channels, at);
            sums = across(lanes, (seen.values.get(row..)?, seen.channels), slopes, sums)?;
        }
        store(lanes, &sums, (self.sums, self.channels), (row, at))
    }
}

/// Slopes end where a ReLU gave 0.
#[inline(always)]
pub(super) fn stop(slopes: &mut [f32], seen: &[f32]) {
    for (slope, seen) in slopes.iter_mut().zip(seen) {
        *slope = if *seen > 0.0 { *slope } else { 0.0 };
    }
}
