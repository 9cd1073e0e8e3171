//! Down-sampling: blocks of consecutive samples that keep every extreme and every flag.
//!
//! A block has the smallest and the largest normal force of its samples, the outer edges of their
//! bands, the OR of their flags, and the journal at the last and at the outermost sample.

use super::event::Blocks;
use link::{EstimateFrame, SensorFrame};

/// Half width of the band, in standard deviations.
const BAND_DEVIATIONS: f32 = 2.0;

/// Samples of a block, unless the run is long.
const MIN_BLOCK_SAMPLES: u64 = 10;
/// Maximum number of blocks of a run: a browser keeps and draws as many.
const MAX_BLOCKS: u64 = 200_000;
/// Wall time that an event may cover, s.
const EVENT_S: f64 = 0.04;
/// Maximum number of blocks of an event.
const MAX_EVENT_BLOCKS: f64 = 100.0;

/// Sizes of blocks and events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sizes {
    /// Samples of a block.
    pub(super) block_samples: u32,
    /// Blocks of an event.
    pub(super) event_blocks: usize,
}

impl Sizes {
    /// Chooses the sizes for a run of so many samples, shown at `samples_per_s` of wall time.
    pub(super) fn new(samples: u64, samples_per_s: f64) -> Self {
        let block_samples = samples.div_ceil(MAX_BLOCKS).max(MIN_BLOCK_SAMPLES);
        let blocks = EVENT_S * samples_per_s / block_samples as f64;
        Self {
            block_samples: u32::try_from(block_samples).unwrap_or(u32::MAX),
            event_blocks: blocks.clamp(1.0, MAX_EVENT_BLOCKS) as usize,
        }
    }
}

/// Block under construction.
#[derive(Clone, Copy, Debug)]
struct Block {
    first_sequence: u32,
    samples: u32,
    first_us: u32,
    min_force_n: f32,
    max_force_n: f32,
    lower_n: f32,
    upper_n: f32,
    outermost: (i32, i32),
    last: (SensorFrame, EstimateFrame),
    flags: u32,
}

/// Square of the distance from the bearing's centre, nm^2.
fn distance((y_nm, z_nm): (i32, i32)) -> u64 {
    u64::from(y_nm.unsigned_abs()).pow(2).saturating_add(u64::from(z_nm.unsigned_abs()).pow(2))
}

impl Block {
    fn new(sample: &SensorFrame, estimate: &EstimateFrame) -> Self {
        let half = BAND_DEVIATIONS * estimate.normal_force_sd_n;
        Self {
            first_sequence: sample.sequence,
            samples: 1,
            first_us: sample.time_us,
            min_force_n: estimate.normal_force_n,
            max_force_n: estimate.normal_force_n,
            lower_n: estimate.normal_force_n - half,
            upper_n: estimate.normal_force_n + half,
            outermost: (sample.journal_y_nm, sample.journal_z_nm),
            last: (*sample, *estimate),
            flags: estimate.flags,
        }
    }

    fn join(self, later: Self) -> Self {
        let is_farther = distance(later.outermost) > distance(self.outermost);
        Self {
            first_sequence: self.first_sequence,
            samples: self.samples.saturating_add(later.samples),
            first_us: self.first_us,
            min_force_n: self.min_force_n.min(later.min_force_n),
            max_force_n: self.max_force_n.max(later.max_force_n),
            lower_n: self.lower_n.min(later.lower_n),
            upper_n: self.upper_n.max(later.upper_n),
            outermost: if is_farther { later.outermost } else { self.outermost },
            last: later.last,
            flags: self.flags | later.flags,
        }
    }
}

impl Blocks {
    fn push(&mut self, block: &Block) {
        let (sample, estimate) = &block.last;
        self.first_sequence.push(block.first_sequence);
        self.samples.push(block.samples);
        self.first_us.push(block.first_us);
        self.last_us.push(sample.time_us);
        self.min_force_n.push(block.min_force_n);
        self.max_force_n.push(block.max_force_n);
        self.lower_n.push(block.lower_n);
        self.upper_n.push(block.upper_n);
        self.force_n.push(estimate.normal_force_n);
        self.friction_torque_nm.push(estimate.friction_torque_nm);
        self.journal_y_nm.push(sample.journal_y_nm);
        self.journal_z_nm.push(sample.journal_z_nm);
        self.outermost_y_nm.push(block.outermost.0);
        self.outermost_z_nm.push(block.outermost.1);
        self.flags.push(block.flags);
    }
}

/// Down-sampler of a run.
#[derive(Clone, Debug)]
pub(super) struct DownSampler {
    sizes: Sizes,
    open: Option<Block>,
    blocks: Blocks,
}

impl DownSampler {
    /// Creates a down-sampler without samples.
    pub(super) fn new(sizes: Sizes) -> Self {
        Self { sizes, open: None, blocks: Blocks::default() }
    }

    /// Takes a sample and its estimate. Returns the blocks of an event that is complete.
    pub(super) fn push(&mut self, sample: &SensorFrame, estimate: &EstimateFrame) -> Option<Blocks> {
        let new = Block::new(sample, estimate);
        let block = self.open.take().map_or(new, |open| open.join(new));
        if block.samples < self.sizes.block_samples {
            self.open = Some(block);
            return None;
        }
        self.blocks.push(&block);
        (self.blocks.samples.len() >= self.sizes.event_blocks).then(|| core::mem::take(&mut self.blocks))
    }

    /// Returns the blocks that no event contains yet; the last one may be shorter than the others.
    pub(super) fn finish(&mut self) -> Option<Blocks> {
        if let Some(block) = self.open.take() {
            self.blocks.push(&block);
        }
        (!self.blocks.samples.is_empty()).then(|| core::mem::take(&mut self.blocks))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sample(sequence: u32, y_nm: i32, z_nm: i32) -> SensorFrame {
        SensorFrame {
            sequence,
            time_us: 100 * sequence,
            journal_y_nm: y_nm,
            journal_z_nm: z_nm,
            ..SensorFrame::default()
        }
    }

    fn estimate(normal_force_n: f32, normal_force_sd_n: f32, flags: u32) -> EstimateFrame {
        EstimateFrame {
            normal_force_n,
            normal_force_sd_n,
            flags,
            friction_torque_nm: -normal_force_n,
            ..EstimateFrame::default()
        }
    }

    #[test]
    fn blocks_are_short_and_events_frequent_unless_the_run_is_long_or_slow() {
        assert_eq!(Sizes::new(10_000, 1e4), Sizes { block_samples: 10, event_blocks: 40 });
        assert_eq!(Sizes::new(2_000_000, 1e4).block_samples, 10);
        assert_eq!(Sizes::new(2_000_001, 1e4).block_samples, 11);
        assert_eq!(Sizes::new(20_000_000, 1e4), Sizes { block_samples: 100, event_blocks: 4 });
        assert_eq!(Sizes::new(10_000, 1.0).event_blocks, 1);
        assert_eq!(Sizes::new(10_000, 1e7).event_blocks, 100);
    }

    #[test]
    fn an_unknown_deviation_leaves_the_band_of_its_block_open() {
        let mut sampler = DownSampler::new(Sizes { block_samples: 2, event_blocks: 1 });
        assert_eq!(sampler.push(&sample(0, 0, 0), &estimate(5.0, 1.0, 0)), None);
        let blocks = sampler.push(&sample(1, 0, 0), &estimate(6.0, f32::INFINITY, 0)).unwrap();
        let json = serde_json::to_value(&blocks).unwrap();
        assert!(json["lower_n"][0].is_null() && json["upper_n"][0].is_null());
        assert_eq!(
            (json["min_force_n"][0].as_f64(), json["max_force_n"][0].as_f64()),
            (Some(5.0), Some(6.0))
        );
        assert_eq!(sampler.finish(), None);
    }

    type Reading = (f32, f32, u32, i32, i32);

    proptest! {
        #[test]
        fn every_sample_is_in_one_block_and_no_extreme_and_no_flag_is_lost(
            readings in prop::collection::vec(
                (-1e4_f32..2e4, 0.0_f32..1e3, any::<u32>(), any::<i32>(), any::<i32>()), 1..300),
            block_samples in 1_u32..20,
            event_blocks in 1_usize..5,
        ) {
            let mut sampler = DownSampler::new(Sizes { block_samples, event_blocks });
            let mut events = Vec::new();
            for (sequence, &(force, sd, flags, y, z)) in (0..).zip(&readings) {
                events.extend(sampler.push(&sample(sequence, y, z), &estimate(force, sd, flags)));
            }
            prop_assert!(events.iter().all(|event| event.samples.len() == event_blocks));
            events.extend(sampler.finish());
            let mut expected = readings.chunks(block_samples as usize);
            let mut next = 0;
            let each = |event: &Blocks| 0..event.samples.len();
            for (event, i) in events.iter().flat_map(|event| each(event).map(move |i| (event, i))) {
                let block: &[Reading] = expected.next().unwrap();
                let (first, last) = (next, next + block.len() as u32 - 1);
                next = last + 1;
                prop_assert_eq!((event.first_sequence[i], event.samples[i]), (first, block.len() as u32));
                prop_assert_eq!((event.first_us[i], event.last_us[i]), (100 * first, 100 * last));
                let extreme = |value: fn(&Reading) -> f32, choose: fn(f32, f32) -> f32| {
                    block.iter().map(value).reduce(choose).unwrap()
                };
                prop_assert_eq!(event.min_force_n[i], extreme(|r| r.0, f32::min));
                prop_assert_eq!(event.max_force_n[i], extreme(|r| r.0, f32::max));
                prop_assert_eq!(event.lower_n[i], extreme(|r| r.0 - 2.0 * r.1, f32::min));
                prop_assert_eq!(event.upper_n[i], extreme(|r| r.0 + 2.0 * r.1, f32::max));
                prop_assert_eq!(event.flags[i], block.iter().fold(0, |all, r| all | r.2));
                let end = block[block.len() - 1];
                prop_assert_eq!((event.force_n[i], event.friction_torque_nm[i]), (end.0, -end.0));
                prop_assert_eq!((event.journal_y_nm[i], event.journal_z_nm[i]), (end.3, end.4));
                let farthest = block.iter().map(|r| distance((r.3, r.4))).max().unwrap();
                let outermost = (event.outermost_y_nm[i], event.outermost_z_nm[i]);
                prop_assert_eq!(distance(outermost), farthest);
                prop_assert!(block.iter().any(|r| (r.3, r.4) == outermost));
            }
            prop_assert_eq!(next as usize, readings.len());
        }
    }
}
