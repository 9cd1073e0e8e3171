//! What a sensor sample may look like: every doubt becomes a flag, never a guess.
//!
//! | doubt | rule, by channel |
//! |---|---|
//! | missing | its driver says so ([`SensorStatus`]), or its value is `i32::MIN` |
//! | saturated | its driver says so, or the value is at or beyond the rail |
//! | stuck | so many samples of one code |
//! | jumped | it moved further since the last sample than the machine can, or a journal coordinate's step differs from the one before by more than [`BENDS`] times its noise limit and an acceleration of 200 m/s2 allow |
//! | noisy | mean square of the second difference above 6 times the square of the limit; each channel is looked at in every eighth sample, the mean is over 64 of those; motion leaves 0.7 um there at most |
//!
//! and for the sample as a whole: the sequence does not follow, the time did not advance by the period, the journal is farther out than
//! clearance and largest deformation, it swings along the clearance faster than it can ([`swing`]).
//!
//! The limits that nobody configures are the machine's: 0.5 m/s is three times what the journal reaches falling freely through the widest
//! clearance, 100 rad/s fifty times the rudder shaft's speed, 2 MN/s a load from nothing to full in 5 ms. The allowances on
//! top are far above sensor noise (0.2 um, 20 urad).
//!
//! No branch depends on data: a sample costs the same whatever it holds.

mod swing;

use core::hash::Hash;

use inference::Flags;
use link::SensorFrame;
use link::track::{CHANNELS, SensorStatus};

use crate::constants::Sum;
use crate::flags::{
    IMPLAUSIBLE_POSITION, IMPLAUSIBLE_SWING, JUMP, NOISY, SENSOR_MISSING, SENSOR_SATURATED, SEQUENCE_GAP,
    STUCK, TIME_FAULT,
};
pub use swing::SwingLimit;

/// Deformation above which the position cannot be true, nm.
pub const MAX_DEFORMATION_NM: u32 = 500_000;
/// Samples of one unchanging code after which a sensor counts as stuck unless configured otherwise: 10 ms at 10 kHz.
pub const STUCK_SAMPLES: u8 = 100;
/// Journal speed that the machine cannot exceed, nm/us (mm/s): 0.5 m/s.
const MAX_JOURNAL_SPEED_NM_US: u32 = 500;
/// Allowance on a journal step for noise, nm.
const JOURNAL_ALLOWANCE_NM: u32 = 5_000;
/// Shaft speed that the machine cannot exceed, nrad/us: 100 rad/s.
const MAX_SHAFT_SPEED_NRAD_US: u32 = 100_000;
/// A journal coordinate's step may differ from the one before by so many times its limit of noise, 10 um for 2 um, and by what the journal's acceleration
/// makes of a period.
const BENDS: u32 = 5;
/// Acceleration that the journal cannot exceed: 200 m/s2, 30 kN on 150 kg, is 1 nm in so many us2.
const US2_PER_NM: u32 = 5;
/// Allowance on an angle step for noise, nrad.
const ANGLE_ALLOWANCE_NRAD: u32 = 500_000;
/// Load rate that the machine cannot exceed, mN/us: 2 MN/s.
const MAX_LOAD_RATE_MN_US: u32 = 2_000;
/// The mean square is over 2 to this power differences.
const MEAN_SHIFT: u32 = 6;
/// Second differences beyond this multiple of the limit count as this: one outlier is a jump, not noise.
const CLIP: i32 = 8;

/// Limits that depend on the sensors; `u32::MAX` for none.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Samples of one code after which a channel is stuck.
    pub stuck_samples: [u32; CHANNELS],
    /// Largest short-term standard deviation, in the channel's unit.
    pub noise: [u32; CHANNELS],
    /// Magnitude at the rail, in the channel's unit.
    pub rail: [u32; CHANNELS],
    /// What limits the swing.
    pub swing: SwingLimit,
}

impl Limits {
    /// Nothing but the time for which a position or angle may stand still.
    pub const NONE: Self = Self {
        stuck_samples: [STUCK_SAMPLES as u32, STUCK_SAMPLES as u32, STUCK_SAMPLES as u32, u32::MAX],
        noise: [u32::MAX; CHANNELS],
        rail: [u32::MAX; CHANNELS],
        swing: SwingLimit::NONE,
    };
}

/// What was found in a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// A bit a channel for each kind: bits 0 to 3 missing, 4 to 7 saturated, then stuck, noisy, jumped.
    pub events: u32,
    /// All of it as flags, with those of the sample as a whole.
    pub flags: Flags,
}

impl Findings {
    /// The channels, a bit each, of a kind: 0 missing, 1 saturated, 2 stuck, 3 noisy, 4 jumped.
    #[must_use]
    pub const fn channels(&self, kind: u32) -> u8 {
        (self.events >> (4 * (kind % 8)) & 0xf) as u8
    }
}

/// Places of the kinds in [`Findings::events`].
const MISSING: u32 = 0;
const SATURATED: u32 = 4;
const STILL: u32 = 8;
const LOUD: u32 = 12;
const FAR: u32 = 16;
/// The motion's channels of every kind.
const MOTION: u32 = 0x7_7777;

/// One channel's watch.
#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    /// Largest magnitude that is not at the rail.
    below_rail: u32,
    step_limit: u32,
    stuck_samples: u32,
    noise_shift: u32,
    noise_clip: i32,
    noise_threshold: u32,
    unchanged: u32,
    mean_square: u32,
}

/// Watches the samples of one run.
#[derive(Clone, Debug)]
pub struct Plausibility {
    period_us: u32,
    farthest_squared: u64,
    channels: [Channel; CHANNELS],
    /// Largest differences of two steps of the journal.
    bend_limits: [u32; 2],
    swing: swing::Swing,
    previous: SensorFrame,
    /// Steps of the channels from the sample before the previous one to it.
    steps: [i32; CHANNELS],
    /// All ones if those are the steps of a sample that followed the one before it; 0 if they say nothing about the next.
    followed: u32,
    /// Twice the channel whose noise is looked at, and whether the sample is one for looking.
    turn: usize,
    /// The channels that were too noisy when they were looked at last.
    loud: u32,
    /// Whether there was a sample before.
    seen: bool,
    status: SensorStatus,
    findings: Findings,
}

/// Largest limit of [`is_beyond`].
const LARGEST: u32 = i32::MAX as u32;

/// Whether a value is farther from 0 than a limit: with the limit added, and no sign, it is above twice that.
fn is_beyond(value: i32, limit: u32) -> bool {
    value.cast_unsigned().wrapping_add(limit) > limit.wrapping_mul(2)
}

/// Doubts after which the samples before this one no longer belong to it.
pub(super) const DISCONTINUITY: Flags =
    Flags::from_bits(JUMP.bits() | SEQUENCE_GAP.bits() | TIME_FAULT.bits());

impl Plausibility {
    /// Creates a watch for a bearing and a sample period.
    #[must_use]
    pub fn new(radial_clearance_nm: u32, period_us: u32) -> Self {
        let farthest_nm = u64::from(radial_clearance_nm.saturating_add(MAX_DEFORMATION_NM));
        let mut watch = Self {
            period_us,
            farthest_squared: farthest_nm.saturating_mul(farthest_nm),
            channels: [Channel::default(); CHANNELS],
            bend_limits: [LARGEST; 2],
            swing: swing::Swing::default(),
            previous: SensorFrame::default(),
            steps: [0; CHANNELS],
            followed: 0,
            turn: 0,
            loud: 0,
            seen: false,
            status: SensorStatus::GOOD,
            findings: Findings::default(),
        };
        watch.set_limits(&Limits::NONE);
        watch
    }

    /// Sets the limits that depend on the sensors. Forgets what was seen of noise and standing still.
    pub fn set_limits(&mut self, limits: &Limits) {
        let journal_nm =
            self.period_us.saturating_mul(MAX_JOURNAL_SPEED_NM_US).saturating_add(JOURNAL_ALLOWANCE_NM);
        let angle_nrad =
            self.period_us.saturating_mul(MAX_SHAFT_SPEED_NRAD_US).saturating_add(ANGLE_ALLOWANCE_NRAD);
        let [.., load_noise] = limits.noise;
        let load_mn =
            self.period_us.saturating_mul(MAX_LOAD_RATE_MN_US).saturating_add(load_noise.saturating_mul(10));
        let sensors = limits.rail.iter().zip(limits.stuck_samples).zip(limits.noise);
        let steps = [journal_nm, journal_nm, angle_nrad, load_mn];
        let [y_noise, z_noise, ..] = limits.noise;
        let bend_nm = self.period_us.saturating_mul(self.period_us) / US2_PER_NM;
        self.bend_limits =
            [y_noise, z_noise].map(|noise| noise.saturating_mul(BENDS).saturating_add(bend_nm).min(LARGEST));
        for (channel, (step_limit, ((rail, stuck), noise))) in
            self.channels.iter_mut().zip(steps.into_iter().zip(sensors))
        {
            // Scaled so that the limit has 10 to 11 bits: its clipped square then has 28 at most.
            let noise_shift = 22_u32.saturating_sub(noise.leading_zeros()).saturating_sub(1);
            let scaled = noise >> noise_shift;
            *channel = Channel {
                below_rail: rail.saturating_sub(1).min(LARGEST),
                step_limit: step_limit.min(LARGEST),
                stuck_samples: stuck.saturating_sub(1),
                noise_shift,
                noise_clip: scaled.saturating_mul(CLIP as u32) as i32,
                noise_threshold: if noise == u32::MAX {
                    u32::MAX
                } else {
                    scaled.saturating_mul(scaled).saturating_mul(6)
                },
                ..Channel::default()
            };
        }
        self.loud = 0;
        self.swing = swing::Swing::new(&limits.swing, self.period_us);
    }

    /// What the configuration set.
    pub(super) fn constants(&self, sum: &mut Sum) {
        (self.period_us, self.farthest_squared, self.bend_limits).hash(sum);
        for channel in &self.channels {
            (channel.below_rail, channel.step_limit, channel.stuck_samples).hash(sum);
            (channel.noise_shift, channel.noise_clip, channel.noise_threshold).hash(sum);
        }
        self.swing.constants(sum);
    }

    /// What the drivers say of the next sample.
    pub const fn take_status(&mut self, status: SensorStatus) {
        self.status = status;
    }

    /// What was found in the last sample, by channel.
    #[must_use]
    pub const fn findings(&self) -> &Findings {
        &self.findings
    }

    /// Takes a sample and returns the doubts about it, as far as they concern the motion: what is wrong with the load is among
    /// the [`Self::findings`] only, as no estimate rests on it.
    pub fn check(&mut self, frame: &SensorFrame) -> Flags {
        let first = !self.seen;
        if first {
            // Before the first sample the machine stood as it does in it.
            self.seen = true;
            self.previous = SensorFrame {
                sequence: frame.sequence.wrapping_sub(1),
                time_us: frame.time_us.wrapping_sub(self.period_us),
                ..*frame
            };
            for channel in &mut self.channels {
                channel.unchanged = u32::MAX;
            }
        }
        let previous = core::mem::replace(&mut self.previous, *frame);
        let values = |frame: &SensorFrame| {
            [frame.journal_y_nm, frame.journal_z_nm, frame.shaft_angle_nrad, frame.load_force_mn]
        };
        let status = u32::from(self.status.missing_bits()) << MISSING
            | u32::from(self.status.rail_bits()) << SATURATED;
        self.status = SensorStatus::GOOD;
        let mut events = status;
        let mut steps = [0; CHANNELS];
        let samples = values(frame).into_iter().zip(values(&previous));
        for (((channel, (value, before)), index), kept) in
            self.channels.iter_mut().zip(samples).zip(0_u32..).zip(&mut steps)
        {
            let step = value.wrapping_sub(before);
            *kept = step;
            events |= u32::from(value == i32::MIN) << (MISSING + index);
            events |= u32::from(is_beyond(value, channel.below_rail)) << (SATURATED + index);
            events |= u32::from(is_beyond(step, channel.step_limit)) << (FAR + index);
            // Counts up to 2^31 and stands there.
            let longer = channel.unchanged.wrapping_add(1);
            channel.unchanged = longer.wrapping_sub(longer >> 31).wrapping_mul(u32::from(step == 0));
            events |= u32::from(channel.unchanged >= channel.stuck_samples) << (STILL + index);
        }
        let before = core::mem::replace(&mut self.steps, steps);
        let ([y, z, ..], [y_before, z_before, ..]) = (steps, before);
        let [y_limit, z_limit] = self.bend_limits;
        let bends = u32::from(is_beyond(y.wrapping_sub(y_before), y_limit))
            | u32::from(is_beyond(z.wrapping_sub(z_before), z_limit)) << 1;
        events |= (bends & self.followed) << FAR;
        self.turn = self.turn.wrapping_add(1) % (2 * CHANNELS);
        if self.turn.is_multiple_of(2) {
            self.listen(self.turn / 2, &steps, &before);
        }
        events |= self.loud << LOUD;

        let elapsed_us = frame.time_us.wrapping_sub(previous.time_us);
        let gap = frame.sequence.wrapping_sub(previous.sequence) != 1;
        let late = elapsed_us.abs_diff(self.period_us) > self.period_us / 2;
        let jumped = events & MOTION & 0xf << FAR != 0;
        self.followed = u32::from(!(gap | late | jumped | first)).wrapping_neg();
        let sample = IMPLAUSIBLE_POSITION.when(self.is_too_far(frame))
            | SEQUENCE_GAP.when(gap)
            | TIME_FAULT.when(late)
            | IMPLAUSIBLE_SWING.when(self.swing.too_fast(frame));
        let flags_of = |events: u32| {
            SENSOR_MISSING.when(events & 0xf << MISSING != 0)
                | SENSOR_SATURATED.when(events & 0xf << SATURATED != 0)
                | STUCK.when(events & 0xf << STILL != 0)
                | NOISY.when(events & 0xf << LOUD != 0)
                | JUMP.when(events & 0xf << FAR != 0)
        };
        self.findings = Findings { events, flags: sample | flags_of(events) };
        sample | flags_of(events & MOTION)
    }

    /// Looks at the noise of a channel: at how its step differs from the one before.
    fn listen(&mut self, channel: usize, steps: &[i32; CHANNELS], before: &[i32; CHANNELS]) {
        let bends = steps.get(channel).zip(before.get(channel));
        let bend = bends.map_or(0, |(step, before)| step.wrapping_sub(*before));
        let lane = channel as u32;
        if let Some(channel) = self.channels.get_mut(channel) {
            let bend = bend.wrapping_shr(channel.noise_shift);
            let bend = bend.min(channel.noise_clip).max(channel.noise_clip.wrapping_neg());
            let square = bend.wrapping_mul(bend).cast_unsigned();
            channel.mean_square = channel
                .mean_square
                .wrapping_add(square >> MEAN_SHIFT)
                .wrapping_sub(channel.mean_square >> MEAN_SHIFT);
            let loud = u32::from(channel.mean_square > channel.noise_threshold);
            self.loud = (self.loud & !1_u32.wrapping_shl(lane)) | loud.wrapping_shl(lane);
        }
    }

    fn is_too_far(&self, frame: &SensorFrame) -> bool {
        let square = |value: i32| i64::from(value).wrapping_mul(i64::from(value)).cast_unsigned();
        // Two squares of 2^62 at most.
        square(frame.journal_y_nm).wrapping_add(square(frame.journal_z_nm)) > self.farthest_squared
    }
}

#[cfg(test)]
mod tests;
