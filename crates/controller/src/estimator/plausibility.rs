//! Checks of a sensor sample: every doubt becomes a flag; no value is replaced by a guess.
//!
//! Rules for each channel:
//!
//! * **Missing**: its driver reports it ([`SensorStatus`]), or its value is `i32::MIN`.
//! * **Saturated**: its driver reports it, or the value is at or beyond the rail.
//! * **Stuck**: the configured number of samples have the same code.
//! * **Jumped**: a step is larger than the machine can move in a sample. For a journal coordinate
//!   also: the step differs from the previous one by more than the sum of [`BENDS`] times the noise
//!   limit and the effect of an acceleration of 200 m/s2.
//! * **Noisy**: the mean square of the second difference is above 6 times the square of the limit.
//!   Each channel is checked in every eighth sample, and the mean is over 64 of those. Motion
//!   contributes at most 0.7 um.
//!
//! The sample as a whole is checked for its sequence number, for the sample period, for a journal
//! further outside than clearance and largest deformation allow, and for a swing along the
//! clearance that is too fast for the load ([`swing`]).
//!
//! Limits that are not configured are those of the machine: 0.5 m/s is three times the speed of a
//! journal that falls freely through the widest clearance, 100 rad/s is fifty times the speed of
//! the rudder shaft, 2 MN/s is a load from zero to full in 5 ms. The allowances for noise are far
//! above the sensors' noise (0.2 um, 20 urad).
//!
//! No branch depends on data: every sample costs the same.

mod swing;

use inference::Flags;
use link::SensorFrame;
use link::crc32::Digest;
use link::track::{CHANNELS, SensorStatus};

use crate::flags::{
    IMPLAUSIBLE_POSITION, IMPLAUSIBLE_SWING, JUMP, NOISY, SENSOR_MISSING, SENSOR_SATURATED, SEQUENCE_GAP,
    STUCK, TIME_FAULT,
};
use crate::integrity::{Words, words};
pub(crate) use swing::SwingLimit;

/// Deformation above which the position cannot be true, nm.
const MAX_DEFORMATION_NM: u32 = 500_000;
/// Default number of samples with one code after which a sensor counts as stuck: 10 ms at 10 kHz.
pub const STUCK_SAMPLES: u8 = 100;
/// Journal speed that the machine cannot exceed, nm/us (mm/s): 0.5 m/s.
const MAX_JOURNAL_SPEED_NM_US: u32 = 500;
/// Allowance on a journal step for noise, nm.
const JOURNAL_ALLOWANCE_NM: u32 = 5_000;
/// Shaft speed that the machine cannot exceed, nrad/us: 100 rad/s.
const MAX_SHAFT_SPEED_NRAD_US: u32 = 100_000;
/// Two successive steps of a journal coordinate may differ by this multiple of its noise limit (10
/// um for 2 um), plus the effect of the journal's acceleration in a period.
const BENDS: u32 = 5;
/// Largest acceleration of the journal as a time: at 200 m/s2 (30 kN on 150 kg), 1 nm is reached in
/// this many us2.
const US2_PER_NM: u32 = 5;
/// Allowance on an angle step for noise, nrad.
const ANGLE_ALLOWANCE_NRAD: u32 = 500_000;
/// Load rate that the machine cannot exceed, mN/us: 2 MN/s.
const MAX_LOAD_RATE_MN_US: u32 = 2_000;
/// Logarithm to base 2 of the differences in the mean square.
const MEAN_SHIFT: u32 = 6;
/// Multiple of the limit to which second differences are clipped: one outlier is a jump, not noise.
const CLIP: i32 = 8;

/// Limits that depend on the sensors; `u32::MAX` for none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Samples of one code after which a channel is stuck.
    pub(crate) stuck_samples: [u32; CHANNELS],
    /// Largest short-term standard deviation, in the channel's unit.
    pub(crate) noise: [u32; CHANNELS],
    /// Magnitude at the rail, in the channel's unit.
    pub(crate) rail: [u32; CHANNELS],
    /// Limits of the swing.
    pub(crate) swing: SwingLimit,
}

impl Limits {
    /// No limit but the default of stuck positions and angles.
    pub(crate) const NONE: Self = Self {
        stuck_samples: [STUCK_SAMPLES as u32, STUCK_SAMPLES as u32, STUCK_SAMPLES as u32, u32::MAX],
        noise: [u32::MAX; CHANNELS],
        rail: [u32::MAX; CHANNELS],
        swing: SwingLimit::NONE,
    };
}

/// Findings in a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Findings {
    /// One bit a channel for each kind: bits 0 to 3 missing, 4 to 7 saturated, then stuck, noisy,
    /// jumped.
    pub(crate) events: u32,
    /// The events as flags, with those of the sample as a whole.
    pub(crate) flags: Flags,
}

impl Findings {
    /// Returns true if anything but noise was found in the load.
    #[must_use]
    pub(crate) const fn is_load_faulty(&self) -> bool {
        self.events & !MOTION & !(0xf << NOISE) != 0
    }
}

/// Shifts of the kinds in [`Findings::events`].
const MISSING: u32 = 0;
const SATURATED: u32 = 4;
const UNCHANGED: u32 = 8;
const NOISE: u32 = 12;
const JUMPED: u32 = 16;
/// Mask of the channels that concern the motion, for every kind.
const MOTION: u32 = 0x7_7777;

/// Limits of one channel.
#[derive(Clone, Copy, Debug, Default)]
struct ChannelLimits {
    /// Largest magnitude that is not at the rail.
    below_rail: u32,
    step: u32,
    stuck_samples: u32,
    noise_shift: u32,
    noise_clip: i32,
    noise_threshold: u32,
}
words!(ChannelLimits { below_rail, step, stuck_samples, noise_shift, noise_clip, noise_threshold });

/// State of one channel.
#[derive(Clone, Copy, Debug, Default)]
struct ChannelState {
    /// Samples since the code changed.
    unchanged: u32,
    mean_square: u32,
}

/// Limits of all checks, set by the configuration.
#[derive(Clone, Copy, Debug)]
struct Config {
    period_us: u32,
    max_distance_squared: u64,
    channels: [ChannelLimits; CHANNELS],
    /// Largest difference of two successive steps of the journal along y and z.
    bends: [u32; 2],
    swing: swing::Swing,
}
words!(Config { period_us, max_distance_squared, channels, bends, swing });

/// Checks of the samples of one run.
#[derive(Clone, Debug)]
pub(crate) struct Plausibility {
    config: Config,
    state: State,
}

/// Previous samples, as far as the checks need them.
#[derive(Clone, Debug, Default)]
struct State {
    channels: [ChannelState; CHANNELS],
    swing: swing::SwingState,
    previous: SensorFrame,
    /// Steps of the channels to the previous sample.
    steps: [i32; CHANNELS],
    /// All ones if `steps` belong to a sample that followed the one before it; else 0.
    has_steps: u32,
    /// Twice the channel whose noise is checked next; odd in the samples between two checks.
    turn: usize,
    /// The channels that were too noisy when they were last checked.
    noisy: u32,
    /// True after the first sample.
    has_previous: bool,
    status: SensorStatus,
    findings: Findings,
    lost: u32,
}

/// Largest limit of [`is_beyond`].
const LARGEST: u32 = i32::MAX as u32;

/// Returns true if a value is farther from 0 than a limit. Unsigned, value plus limit is then above
/// twice the limit.
fn is_beyond(value: i32, limit: u32) -> bool {
    value.cast_unsigned().wrapping_add(limit) > limit.wrapping_mul(2)
}

impl Plausibility {
    /// Creates the checks for a bearing and a sample period, with [`Limits::NONE`].
    #[must_use]
    pub(crate) fn new(radial_clearance_nm: u32, period_us: u32) -> Self {
        let max_distance_nm = u64::from(radial_clearance_nm.saturating_add(MAX_DEFORMATION_NM));
        let mut checks = Self {
            config: Config {
                period_us,
                max_distance_squared: max_distance_nm.saturating_mul(max_distance_nm),
                channels: [ChannelLimits::default(); CHANNELS],
                bends: [LARGEST; 2],
                swing: swing::Swing::default(),
            },
            state: State::default(),
        };
        checks.set_limits(&Limits::NONE);
        checks
    }

    /// Sets the limits that depend on the sensors. Noise and stuck codes are counted from 0 again.
    pub(crate) fn set_limits(&mut self, limits: &Limits) {
        let config = &mut self.config;
        let journal_nm =
            config.period_us.saturating_mul(MAX_JOURNAL_SPEED_NM_US).saturating_add(JOURNAL_ALLOWANCE_NM);
        let angle_nrad =
            config.period_us.saturating_mul(MAX_SHAFT_SPEED_NRAD_US).saturating_add(ANGLE_ALLOWANCE_NRAD);
        let [y_noise, z_noise, _, load_noise] = limits.noise;
        let load_mn = config
            .period_us
            .saturating_mul(MAX_LOAD_RATE_MN_US)
            .saturating_add(load_noise.saturating_mul(10));
        let bend_nm = config.period_us.saturating_mul(config.period_us) / US2_PER_NM;
        config.bends =
            [y_noise, z_noise].map(|noise| noise.saturating_mul(BENDS).saturating_add(bend_nm).min(LARGEST));
        let sensors = limits.rail.iter().zip(limits.stuck_samples).zip(limits.noise);
        let steps = [journal_nm, journal_nm, angle_nrad, load_mn];
        for (channel, (step, ((rail, stuck), noise))) in
            config.channels.iter_mut().zip(steps.into_iter().zip(sensors))
        {
            // Scaled so that the limit has 10 to 11 bits: its clipped square then has 28 at most.
            // The binary point depends on the limit, so no type of `fixed` can carry it.
            let noise_shift = 22_u32.saturating_sub(noise.leading_zeros()).saturating_sub(1);
            let scaled = noise >> noise_shift;
            *channel = ChannelLimits {
                below_rail: rail.saturating_sub(1).min(LARGEST),
                step: step.min(LARGEST),
                stuck_samples: stuck.saturating_sub(1),
                noise_shift,
                noise_clip: scaled.saturating_mul(CLIP as u32) as i32,
                noise_threshold: if noise == u32::MAX {
                    u32::MAX
                } else {
                    scaled.saturating_mul(scaled).saturating_mul(6)
                },
            };
        }
        config.swing = swing::Swing::new(&limits.swing, config.period_us);
        self.state.channels = [ChannelState::default(); CHANNELS];
        self.state.noisy = 0;
        self.state.swing = swing::SwingState::default();
    }

    /// Adds the limits to the CRC of the configuration.
    pub(super) fn add_config_to(&self, crc: &mut Digest) {
        self.config.add_to(crc);
    }

    /// Stores the status that the drivers report for the next sample.
    pub(crate) const fn set_status(&mut self, status: SensorStatus) {
        self.state.status = status;
    }

    /// Findings of the last sample, by channel.
    #[must_use]
    pub(crate) const fn findings(&self) -> &Findings {
        &self.state.findings
    }

    /// Number of samples that sequence numbers or time leave out before the last sample; more than
    /// 2^31 if it was repeated or out of order.
    #[must_use]
    pub(crate) const fn lost(&self) -> u32 {
        self.state.lost
    }

    /// Takes a sample and returns the flags that concern the motion. Findings about the load alone
    /// are in [`Self::findings`] only: the last good load is used then.
    pub(crate) fn check(&mut self, frame: &SensorFrame) -> Flags {
        let Self { config, state } = self;
        let is_first = !state.has_previous;
        if is_first {
            state.begin(frame, config.period_us);
        }
        let previous = core::mem::replace(&mut state.previous, *frame);
        let status = core::mem::replace(&mut state.status, SensorStatus::GOOD);
        let mut events =
            u32::from(status.missing_bits()) << MISSING | u32::from(status.rail_bits()) << SATURATED;
        let (steps, found) = config.check_channels(&mut state.channels, frame, &previous);
        events |= found;
        let steps_before = core::mem::replace(&mut state.steps, steps);
        events |= (config.bends(&steps, &steps_before) & state.has_steps) << JUMPED;
        state.turn = state.turn.wrapping_add(1) % (2 * CHANNELS);
        if state.turn.is_multiple_of(2) {
            config.check_noise(state, state.turn / 2, &steps, &steps_before);
        }
        events |= state.noisy << NOISE;

        let elapsed_us = frame.time_us.wrapping_sub(previous.time_us);
        let skipped = frame.sequence.wrapping_sub(previous.sequence).wrapping_sub(1);
        let is_gap = skipped != 0;
        let is_late = elapsed_us.abs_diff(config.period_us) > config.period_us / 2;
        state.lost = skipped.max(config.periods_missed(elapsed_us, is_late));
        let has_jumped = events & MOTION & 0xf << JUMPED != 0;
        state.has_steps = u32::from(!(is_gap | is_late | has_jumped | is_first)).wrapping_neg();
        let is_load_good = events & !MOTION == 0;
        let sample = IMPLAUSIBLE_POSITION.when(config.is_too_far(frame))
            | SEQUENCE_GAP.when(is_gap)
            | TIME_FAULT.when(is_late)
            | IMPLAUSIBLE_SWING.when(config.swing.update(&mut state.swing, frame, is_load_good));
        state.findings = Findings { events, flags: sample | flags_of(events) };
        sample | flags_of(events & MOTION)
    }
}

/// Returns the flags of the channels' events.
fn flags_of(events: u32) -> Flags {
    SENSOR_MISSING.when(events & 0xf << MISSING != 0)
        | SENSOR_SATURATED.when(events & 0xf << SATURATED != 0)
        | STUCK.when(events & 0xf << UNCHANGED != 0)
        | NOISY.when(events & 0xf << NOISE != 0)
        | JUMP.when(events & 0xf << JUMPED != 0)
}

/// The values of a sample by channel.
const fn values(frame: &SensorFrame) -> [i32; CHANNELS] {
    [frame.journal_y_nm, frame.journal_z_nm, frame.shaft_angle_nrad, frame.load_force_mn]
}

impl State {
    /// Assumes that the machine was at standstill before the first sample.
    fn begin(&mut self, frame: &SensorFrame, period_us: u32) {
        self.has_previous = true;
        self.previous = SensorFrame {
            sequence: frame.sequence.wrapping_sub(1),
            time_us: frame.time_us.wrapping_sub(period_us),
            ..*frame
        };
        for channel in &mut self.channels {
            channel.unchanged = u32::MAX;
        }
    }
}

impl Config {
    /// Returns the number of periods that a late sample left out; 0 if the time went back.
    #[inline]
    fn periods_missed(&self, elapsed_us: u32, is_late: bool) -> u32 {
        if !is_late || elapsed_us > i32::MAX.cast_unsigned() {
            return 0;
        }
        elapsed_us
            .saturating_add(self.period_us / 2)
            .checked_div(self.period_us)
            .unwrap_or(0)
            .saturating_sub(1)
    }

    /// Checks every channel alone; returns the steps from the previous sample and the events.
    #[inline]
    fn check_channels(
        &self,
        states: &mut [ChannelState; CHANNELS],
        frame: &SensorFrame,
        previous: &SensorFrame,
    ) -> ([i32; CHANNELS], u32) {
        let mut events = 0;
        let mut steps = [0; CHANNELS];
        let samples = values(frame).into_iter().zip(values(previous));
        let channels = self.channels.iter().zip(states).zip(samples).zip(0_u32..).zip(&mut steps);
        for ((((limits, state), (value, before)), index), kept) in channels {
            let step = value.wrapping_sub(before);
            *kept = step;
            events |= u32::from(value == i32::MIN) << (MISSING + index);
            events |= u32::from(is_beyond(value, limits.below_rail)) << (SATURATED + index);
            events |= u32::from(is_beyond(step, limits.step)) << (JUMPED + index);
            // Saturates at 2^31.
            let longer = state.unchanged.wrapping_add(1);
            state.unchanged = longer.wrapping_sub(longer >> 31).wrapping_mul(u32::from(step == 0));
            events |= u32::from(state.unchanged >= limits.stuck_samples) << (UNCHANGED + index);
        }
        (steps, events)
    }

    /// Returns the channels of the journal, bits 0 and 1, whose step differs too much from the
    /// previous one.
    #[inline]
    fn bends(&self, steps: &[i32; CHANNELS], before: &[i32; CHANNELS]) -> u32 {
        let ([y, z, ..], [y_before, z_before, ..]) = (*steps, *before);
        let [y_limit, z_limit] = self.bends;
        u32::from(is_beyond(y.wrapping_sub(y_before), y_limit))
            | u32::from(is_beyond(z.wrapping_sub(z_before), z_limit)) << 1
    }

    /// Checks the noise of a channel: the difference of its last two steps.
    fn check_noise(
        &self,
        state: &mut State,
        channel: usize,
        steps: &[i32; CHANNELS],
        before: &[i32; CHANNELS],
    ) {
        let pair = steps.get(channel).zip(before.get(channel));
        let bend = pair.map_or(0, |(step, before)| step.wrapping_sub(*before));
        let lane = channel as u32;
        if let (Some(limits), Some(noise)) = (self.channels.get(channel), state.channels.get_mut(channel)) {
            let bend = bend.wrapping_shr(limits.noise_shift);
            let bend = bend.min(limits.noise_clip).max(limits.noise_clip.wrapping_neg());
            let square = bend.wrapping_mul(bend).cast_unsigned();
            noise.mean_square = noise
                .mean_square
                .wrapping_add(square >> MEAN_SHIFT)
                .wrapping_sub(noise.mean_square >> MEAN_SHIFT);
            let is_noisy = u32::from(noise.mean_square > limits.noise_threshold);
            state.noisy = (state.noisy & !1_u32.wrapping_shl(lane)) | is_noisy.wrapping_shl(lane);
        }
    }

    fn is_too_far(&self, frame: &SensorFrame) -> bool {
        let square = |value: i32| i64::from(value).wrapping_mul(i64::from(value)).cast_unsigned();
        // Two squares of 2^62 at most.
        square(frame.journal_y_nm).wrapping_add(square(frame.journal_z_nm)) > self.max_distance_squared
    }
}

#[cfg(test)]
mod tests;
