//! Virtual sensor of quantities that no sensor measures: radial clearance and friction level of the
//! bearing.
//!
//! Every second sample is summed over blocks of [`BLOCK`] samples ([`block`]). Load, weight and
//! inertia give the bearing force without the contact model ([`force_balance`]). Distance and force
//! give the clearance ([`clearance`]) and, with the friction network, the friction level
//! ([`friction`]). Both are compared with their limits ([`limit`]). A block does not count if it
//! contains a sensor fault or if no force presses the journal to the bearing. A block contradicts
//! the tracked clearance if it is further from it than errors and wear explain. This detects a
//! drifting probe, since position and load then agree in one direction of the journal only.
//!
//! A block is evaluated during the next one, a step in every fourth sample, to spread the work: the
//! cost of a tick depends on its place in the block and on nothing else. The arithmetic is f32 with
//! `+ - * /` and square roots only, so that host and controller agree in every bit.

mod block;
mod clearance;
mod force_balance;
mod friction;
mod limit;
mod min_max;

use link::crc32::Digest;
use link::track::{MonitorConfiguration, SafeState, TrackReport};
use link::{BenchConfiguration, EstimateFrame, SensorFrame};

pub use block::{BLOCK, STRIDE};
pub use limit::{CONFIDENCE, CONFIRM, ENOUGH};

use crate::integrity::{Words, words};
use block::{Block, Means, Sums, Taken};
use clearance::{Clearance, ClearanceState, ROUNDS};
use force_balance::{BalanceForce, ForceBalance};
use friction::{Friction, FrictionState, Measured};
use limit::{Alarm, AlarmState};
pub(crate) use min_max::{at_least, at_most};

/// Period in samples: sums in the first and third, a step of evaluation in the last.
const PHASES: u32 = 4;
/// Steps of evaluating a block, counted from the start of the next one.
const SENSITIVITIES: u32 = 3 + ROUNDS;
const CLEARANCE: u32 = SENSITIVITIES + 1;
const WEAR_ALARM: u32 = SENSITIVITIES + 2;
const FRICTION: u32 = SENSITIVITIES + 3;
const FRICTION_LEVEL: u32 = SENSITIVITIES + 4;
const FRICTION_ALARM: u32 = SENSITIVITIES + 5;
const LAST: u32 = BLOCK / STRIDE - 1;
/// Smallest normal force of a block that counts, N.
const MIN_NORMAL_N: f32 = 50.0;
/// Largest unsteadiness of a block that counts.
const MAX_UNSTEADINESS: f32 = 0.2;

/// Virtual sensor of clearance and friction level.
#[derive(Clone, Debug)]
pub struct Tracker {
    config: Config,
    state: State,
}

/// Constants, set by the configuration.
#[derive(Clone, Debug)]
struct Config {
    force_balance: ForceBalance,
    nominal_clearance_nm: f32,
    clearance: Clearance,
    friction: Friction,
    wear_alarm: Alarm,
    friction_alarm: Alarm,
}
words!(Config { force_balance, nominal_clearance_nm, clearance, friction, wear_alarm, friction_alarm });

/// Everything that changes with the samples.
#[derive(Clone, Debug)]
struct State {
    block: Block,
    phase: u32,
    /// Place of the newest sample in its block.
    place: u32,
    /// True if the current block has no faulty sample so far.
    is_good: bool,
    closed: Closed,
    clearance: ClearanceState,
    friction: FrictionState,
    wear_alarm: AlarmState,
    friction_alarm: AlarmState,
    is_contradicted: bool,
    blocks: u32,
    friction_blocks: u32,
}

/// The last block under evaluation.
#[derive(Clone, Copy, Debug, Default)]
struct Closed {
    sums: Sums,
    means: Means,
    balance: BalanceForce,
    clearance: clearance::Measured,
    friction: Measured,
    /// True if no sample was faulty; from the second step on, if the journal also was steady and
    /// pressed to the bearing.
    counts: bool,
    /// True, from the friction's step on, if the journal slid, so that the block counts for the
    /// friction level.
    slides: bool,
}

impl Tracker {
    /// Creates a tracker for a bench.
    #[must_use]
    pub fn new(configuration: &BenchConfiguration, monitor: &MonitorConfiguration) -> Self {
        Self {
            config: Config {
                force_balance: ForceBalance::new(configuration, monitor),
                nominal_clearance_nm: configuration.radial_clearance_nm as f32,
                clearance: Clearance::new(configuration, monitor),
                friction: Friction::new(configuration, monitor),
                wear_alarm: Alarm::for_wear(monitor.wear_limit_nm, monitor.wear_hysteresis_nm),
                friction_alarm: Alarm::for_friction(0),
            },
            state: State {
                block: Block::default(),
                phase: 0,
                place: 0,
                is_good: true,
                closed: Closed::default(),
                clearance: ClearanceState::new(configuration),
                friction: FrictionState::new(),
                wear_alarm: AlarmState::default(),
                friction_alarm: AlarmState::default(),
                is_contradicted: false,
                blocks: 0,
                friction_blocks: 0,
            },
        }
    }

    /// Sets the limit of the friction level for its alarm, thousandths; 0 for none.
    pub(crate) fn limit_friction(&mut self, per_mille: u32) {
        self.config.friction_alarm = Alarm::for_friction(per_mille);
    }

    /// Adds the constants to the CRC of the configuration.
    pub(crate) fn add_config_to(&self, crc: &mut Digest) {
        self.config.add_to(crc);
    }

    /// Takes a sample with its estimate; `is_good` is false if a sensor fault was found in it.
    #[inline(never)]
    pub fn step(&mut self, frame: &SensorFrame, estimate: &EstimateFrame, is_good: bool) {
        let Self { config, state } = self;
        state.is_good &= is_good;
        let phase = state.phase;
        state.phase = phase.wrapping_add(1) % PHASES;
        if phase.is_multiple_of(STRIDE) {
            state.place = state.block.push(frame, &config.taken(frame, estimate));
        } else if phase == PHASES - 1 {
            config.evaluate(state);
        }
    }

    /// Returns true if the tracker does nothing in the next sample.
    #[must_use]
    pub const fn is_idle(&self) -> bool {
        self.state.phase == 1
    }

    /// Returns true if position and load contradicted each other in the last block that counted.
    #[must_use]
    pub const fn is_contradicted(&self) -> bool {
        self.state.is_contradicted
    }

    /// The tracked quantities; time and safe state are filled in by the monitor.
    #[must_use]
    pub fn report(&self) -> TrackReport {
        let Self { config, state } = self;
        let known = |blocks: u32, value: f32| if blocks == 0 { u32::MAX } else { value as u32 };
        TrackReport {
            time_us: 0,
            radial_clearance_nm: (state.clearance.value_m() * 1e9) as u32,
            radial_clearance_deviation_nm: known(state.blocks, state.clearance.deviation_m() * 1e9),
            friction_level_per_mille: (state.friction.value() * 1e3) as u32,
            friction_level_deviation_per_mille: known(
                state.friction_blocks,
                state.friction.deviation() * 1e3,
            ),
            clearance_blocks: state.blocks,
            friction_blocks: state.friction_blocks,
            wear: state.wear_alarm.wear(state.blocks),
            wear_alarms: state.wear_alarm.count(),
            friction: config.friction_alarm.friction(&state.friction_alarm, state.friction_blocks),
            friction_alarms: state.friction_alarm.count(),
            safe_state: SafeState::Starting,
        }
    }
}

impl Config {
    /// Prepares a sample for the block.
    fn taken(&self, frame: &SensorFrame, estimate: &EstimateFrame) -> Taken {
        let distance_nm = at_least(self.nominal_clearance_nm + estimate.deformation_m * 1e9, 1.0);
        let per_distance = 1.0 / distance_nm;
        Taken {
            distance_nm,
            normal_y: frame.journal_y_nm as f32 * per_distance,
            normal_z: frame.journal_z_nm as f32 * per_distance,
            network_normal_n: estimate.normal_force_n,
            network_torque_nm: estimate.friction_torque_nm,
        }
    }

    /// Carries out the step of evaluating the last block that belongs to this place of the new one.
    fn evaluate(&self, state: &mut State) {
        let closed = &mut state.closed;
        match state.place / STRIDE {
            0 => closed.means = closed.sums.means(),
            1 => {
                closed.balance = self.force_balance.solve(&closed.means);
                closed.counts &= (closed.balance.normal_n > MIN_NORMAL_N)
                    & (closed.balance.unsteadiness < MAX_UNSTEADINESS);
            }
            2 => {
                self.clearance.begin(&state.clearance, &closed.means, &closed.balance, &mut closed.clearance)
            }
            3..SENSITIVITIES => Clearance::round(&mut closed.clearance),
            SENSITIVITIES => {
                self.clearance.sensitivities(&closed.means, &closed.balance, &mut closed.clearance);
            }
            CLEARANCE => {
                let is_contradicted = state.clearance.is_contradicted_by(&closed.clearance);
                state.is_contradicted = if closed.counts { is_contradicted } else { state.is_contradicted };
                state.clearance.take(&closed.clearance, closed.counts);
            }
            WEAR_ALARM => {
                let (value, variance) = (state.clearance.value_m(), state.clearance.total_variance_m2());
                self.wear_alarm.update(&mut state.wear_alarm, value, variance, closed.counts);
            }
            FRICTION => closed.friction = self.friction.measure(&closed.means, &closed.balance),
            FRICTION_LEVEL => {
                state.friction.take(&closed.friction, closed.counts);
                let Measured { expected_n, variance_n2, .. } = closed.friction;
                closed.slides = closed.counts & (expected_n * expected_n > variance_n2);
                state.blocks = state.blocks.saturating_add(u32::from(closed.counts));
                state.friction_blocks = state.friction_blocks.saturating_add(u32::from(closed.slides));
            }
            FRICTION_ALARM => {
                let (value, variance) = (state.friction.value(), state.friction.total_variance());
                self.friction_alarm.update(&mut state.friction_alarm, value, variance, closed.slides);
            }
            LAST => {
                closed.sums = state.block.close();
                closed.counts = core::mem::replace(&mut state.is_good, true);
            }
            _ => {}
        }
    }
}
