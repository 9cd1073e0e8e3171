//! A sensor for what no sensor measures: the bearing's radial clearance and its friction level, from the signals that are there.
//!
//! Every second sample is summed up over blocks of [`BLOCK`] ([`block`]); load, weight and inertia give the bearing's force without the contact
//! model ([`balance`]); distance and force give the clearance ([`clearance`]) and, with the friction network, the friction level
//! ([`friction`]); both are held against their limits ([`limit`]). A block with a sensor fault in it, or without a force that
//! presses the journal to the bearing, counts for nothing. One whose clearance is further from the tracked one than errors and wear explain
//! contradicts it: a probe that drifts shows there, since position and load then agree in no direction of the journal but one.
//!
//! What a block says is worked out during the next one, a step in every fourth sample, so that no tick has to bear all of it: what a
//! tick costs depends on its place in the block and on nothing else. f32 with `+ - * /` and square roots only, so that host and
//! controller agree in every bit.

mod balance;
mod block;
mod clearance;
mod friction;
mod limit;
mod order;

use link::track::{MonitorConfiguration, SafeState, TrackReport};
use link::{Configuration, EstimateFrame, SensorFrame};

pub use block::{BLOCK, STRIDE};
pub use limit::{CONFIDENCE, CONFIRM, ENOUGH};

use crate::constants::Sum;
use balance::{Balance, Levers};
use block::{Block, Means, Sums, Taken};
use clearance::{Clearance, ROUNDS};
use friction::{FrictionLevel, Measured};
use limit::Alarm;
pub(crate) use order::{at_least, at_most};

/// Samples after which everything comes again: sums in the first and third, a step of working out in the last.
const PHASES: u32 = 4;
/// Steps of working out a block, counted from the start of the next one.
const ROUNDED: u32 = 3 + ROUNDS;
const TAKEN: u32 = ROUNDED + 1;
const WORN: u32 = ROUNDED + 2;
const RUBBED: u32 = ROUNDED + 3;
const COUNTED: u32 = ROUNDED + 4;
const HELD_AGAINST: u32 = ROUNDED + 5;
const LAST: u32 = BLOCK / STRIDE - 1;
/// Normal force below which a block tells nothing, N.
const LEAST_NORMAL_N: f32 = 50.0;
/// Unsteadiness above which a block tells nothing.
const MOST_UNSTEADINESS: f32 = 0.2;

/// The virtual sensor.
#[derive(Clone, Debug)]
pub struct Tracker {
    levers: Levers,
    nominal_clearance_nm: f32,
    block: Block,
    phase: u32,
    /// The newest sample's place in its block.
    place: u32,
    clearance: Clearance,
    friction: FrictionLevel,
    wear: Alarm,
    friction_alarm: Alarm,
    sound: bool,
    closed: Closed,
    contradicted: bool,
    blocks: u32,
    friction_blocks: u32,
}

/// What is being worked out of the last block.
#[derive(Clone, Copy, Debug, Default)]
struct Closed {
    sums: Sums,
    means: Means,
    balance: Balance,
    clearance: clearance::Measured,
    friction: Measured,
    /// No fault in it; from the second step on also: the journal was pressed to the bearing and steady.
    counts: bool,
    /// From the friction's step on: it slid, so that the friction level rests on it.
    slides: bool,
}

impl Tracker {
    /// Creates a tracker for a bench.
    #[must_use]
    pub fn new(configuration: &Configuration, monitor: &MonitorConfiguration) -> Self {
        Self {
            levers: Levers::new(configuration, monitor),
            nominal_clearance_nm: configuration.radial_clearance_nm as f32,
            block: Block::default(),
            phase: 0,
            place: 0,
            clearance: Clearance::new(configuration, monitor),
            friction: FrictionLevel::new(configuration, monitor),
            wear: Alarm::of_wear(monitor.wear_limit_nm, monitor.wear_hysteresis_nm),
            friction_alarm: Alarm::of_friction(0),
            sound: true,
            closed: Closed::default(),
            contradicted: false,
            blocks: 0,
            friction_blocks: 0,
        }
    }

    /// Raises an alarm when the friction level is above a limit, thousandths; 0 for none.
    pub(crate) fn limit_friction(&mut self, per_mille: u32) {
        self.friction_alarm = Alarm::of_friction(per_mille);
    }

    /// What the configuration set.
    pub(crate) fn constants(&self, sum: &mut Sum) {
        self.levers.constants(sum);
        sum.float(self.nominal_clearance_nm);
        self.clearance.constants(sum);
        self.friction.constants(sum);
        self.wear.constants(sum);
        self.friction_alarm.constants(sum);
    }

    /// Takes a sample with its estimate; `sound` is false when a sensor fault was found in it.
    #[inline(never)]
    pub fn step(&mut self, frame: &SensorFrame, estimate: &EstimateFrame, sound: bool) {
        self.sound &= sound;
        let phase = self.phase;
        self.phase = phase.wrapping_add(1) % PHASES;
        if phase.is_multiple_of(STRIDE) {
            self.sum_up(frame, estimate);
        } else if phase == PHASES - 1 {
            self.work();
        }
    }

    /// Whether the sample to come is one in which nothing is done here.
    #[must_use]
    pub const fn is_idle(&self) -> bool {
        self.phase == 1
    }

    /// Whether position and load contradicted each other in the last block that counts.
    #[must_use]
    pub const fn is_contradicted(&self) -> bool {
        self.contradicted
    }

    fn sum_up(&mut self, frame: &SensorFrame, estimate: &EstimateFrame) {
        let distance_nm = at_least(self.nominal_clearance_nm + estimate.deformation_m * 1e9, 1.0);
        let per_distance = 1.0 / distance_nm;
        let taken = Taken {
            distance_nm,
            normal_y: frame.journal_y_nm as f32 * per_distance,
            normal_z: frame.journal_z_nm as f32 * per_distance,
            network_normal_n: estimate.normal_force_n,
            network_torque_nm: estimate.friction_torque_nm,
        };
        self.place = self.block.push(frame, &taken);
    }

    /// The step of working out the last block that this place of the new one has.
    fn work(&mut self) {
        let closed = &mut self.closed;
        match self.place / STRIDE {
            0 => closed.means = closed.sums.means(),
            1 => {
                closed.balance = self.levers.balance(&closed.means);
                closed.counts &= (closed.balance.normal_n > LEAST_NORMAL_N)
                    & (closed.balance.unsteadiness < MOST_UNSTEADINESS);
            }
            2 => self.clearance.begin(&closed.means, &closed.balance, &mut closed.clearance),
            3..ROUNDED => Clearance::round(&mut closed.clearance),
            ROUNDED => self.clearance.sensitivities(&closed.means, &closed.balance, &mut closed.clearance),
            TAKEN => {
                let contradicted = self.clearance.is_contradicted_by(&closed.clearance);
                self.contradicted = if closed.counts { contradicted } else { self.contradicted };
                self.clearance.take(&closed.clearance, closed.counts);
            }
            WORN => {
                self.wear.update(self.clearance.value_m(), self.clearance.whole_variance_m2(), closed.counts);
            }
            RUBBED => closed.friction = self.friction.measure(&closed.means, &closed.balance),
            COUNTED => {
                self.friction.take(&closed.friction, closed.counts);
                let Measured { expected_n, variance_n2, .. } = closed.friction;
                closed.slides = closed.counts & (expected_n * expected_n > variance_n2);
                self.blocks = self.blocks.saturating_add(u32::from(closed.counts));
                self.friction_blocks = self.friction_blocks.saturating_add(u32::from(closed.slides));
            }
            HELD_AGAINST => {
                self.friction_alarm.update(
                    self.friction.value(),
                    self.friction.whole_variance(),
                    closed.slides,
                );
            }
            LAST => {
                closed.sums = self.block.close();
                closed.counts = core::mem::replace(&mut self.sound, true);
            }
            _ => {}
        }
    }

    /// What is tracked; time and safe state are the monitor's.
    #[must_use]
    pub fn report(&self) -> TrackReport {
        let known = |blocks: u32, value: f32| if blocks == 0 { u32::MAX } else { value as u32 };
        TrackReport {
            time_us: 0,
            radial_clearance_nm: (self.clearance.value_m() * 1e9) as u32,
            radial_clearance_deviation_nm: known(self.blocks, self.clearance.deviation_m() * 1e9),
            friction_level_per_mille: (self.friction.value() * 1e3) as u32,
            friction_level_deviation_per_mille: known(self.friction_blocks, self.friction.deviation() * 1e3),
            clearance_blocks: self.blocks,
            friction_blocks: self.friction_blocks,
            wear: self.wear.wear(self.blocks),
            wear_alarms: self.wear.times(),
            friction: self.friction_alarm.friction(self.friction_blocks),
            friction_alarms: self.friction_alarm.times(),
            safe_state: SafeState::Starting,
        }
    }
}
