//! Rate of the deformation that Newton's law predicts.
//!
//! In contact the distance from the centre hardly accelerates: 10,000 N on 150 kg are 67 m/s2, and
//! the rate of the distance changes by 0.5 m/s2 at most. So along the normal the contact force
//! balances the swing of the journal and its load,
//!
//! ```text
//! F = (a phi'^2 + p n_y - g n_z + F_f n_y n_z (1/m_y - 1/m_z)) / (n_y^2/m_y + n_z^2/m_z)
//! ```
//!
//! with the masses `m_y`, `m_z` that the force moves along y and z and the pull `p`: the
//! acceleration of the journal along y by everything but the contact. The swing `a phi'` is
//! measured a thousand times better, relative to its size, than the rate `d'`: it follows the
//! oscillation without delay. The contact law `F = K (1 + chi d'/v)` with the latched speed `v`,
//! solved for the rate, gives the rate that belongs to this force,
//!
//! ```text
//! d' = (v/chi) (F/K - 1)
//! ```
//!
//! with the elastic part `K` of the previous estimate, that is, with the stiffness of the network
//! itself at that deformation. The pull changes slowly; it is the remainder of Newton's law along
//! y, `y'' - F_cy/m_y`, averaged over 128 ticks (over fewer after a start). The [`super::observer`]
//! corrects slow errors of this rate by the measured position and detects fast ones.
//!
//! Integers: nm/s, mN, accelerations in units of 1024 nm/s2. No branch depends on data.

use super::arithmetic::{Factor, product, saturated, saturated_unsigned, select, within};
use super::conditioning::{Conditioning, MASS_RANGE_G};
use super::geometry::ContactFrame;
use crate::integrity::words;
use inference::fixed::fraction;

/// Unit of accelerations, nm/s2.
const UNIT_NM_S2: u64 = 1024;
/// Gravity in that unit.
const GRAVITY: i32 = (contact::GRAVITY_M_S2 * 1e9 / UNIT_NM_S2 as f64) as i32;
/// Fraction bits of an inverse mass in acceleration units over mN.
const MASS_BITS: u32 = 20;
/// Logarithm to base 2 of the ticks over which the pull is averaged.
const PULL_SHIFT: u32 = 7;
/// Smallest force at which the elastic part is known well enough, mN.
const MIN_FORCE_MN: i32 = 20_000;
/// Logarithm to base 2 of the limit of accelerations (1.1 km/s2), speeds and predicted rates (1.07
/// m/s).
const LIMIT_BITS: u32 = 30;

/// Newton's law along the normal.
#[derive(Clone, Debug)]
pub(super) struct Newton {
    /// Inverse masses, acceleration units over mN times 2^20; 0 if the masses are unknown.
    per_mass_y: i32,
    per_mass_z: i32,
    /// `1/chi`.
    per_damping: Factor,
    /// Acceleration units over a change of the speed by 1 nm/s in a tick.
    per_tick: Factor,
}
words!(Newton { per_mass_y, per_mass_z, per_damping, per_tick });

/// State of the prediction: what it needs of the previous ticks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NewtonState {
    /// Acceleration along y by everything but the contact.
    pull: i32,
    /// Ticks since the last restart.
    ticks: u32,
    y_nm_s: i32,
    force_y_mn: i32,
    friction_mn: i32,
    /// Normal force of the last tick with a known elastic part; 0 without contact.
    normal_mn: i32,
    /// `v/chi + d'` of that tick: the elastic part is `F v/chi` over it.
    speed_nm_s: i32,
    /// `v/chi` of the last tick: the rate at which the damping doubles the elastic force.
    doubling_rate_nm_s: i32,
}
words!(NewtonState {
    pull,
    ticks,
    y_nm_s,
    force_y_mn,
    friction_mn,
    normal_mn,
    speed_nm_s,
    doubling_rate_nm_s
});

/// The estimate of a tick, as the next tick's prediction needs it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PreviousEstimate {
    pub(super) normal_mn: i32,
    pub(super) friction_mn: i32,
    pub(super) force_y_mn: i32,
    pub(super) rate_nm_s: i32,
    pub(super) approach_nm_s: u32,
    /// True if the networks' history is complete.
    pub(super) is_warm: bool,
}

impl NewtonState {
    /// Forgets pull and elastic part: the next tick does not follow the last one.
    pub(super) const fn restart(&mut self) {
        self.ticks = 0;
        self.pull = 0;
        self.normal_mn = 0;
    }
}

impl Newton {
    /// Prepares the law; without masses it predicts nothing.
    pub(super) fn new(conditioning: &Conditioning, period_us: u32) -> Self {
        let per_mass = |mass_g: u32| {
            let mass_g = u64::from(mass_g.max(*MASS_RANGE_G.start()));
            ((1_000_000_000_u64 << MASS_BITS) / UNIT_NM_S2 / mass_g) as i32
        };
        let (per_mass_y, per_mass_z) = conditioning
            .masses
            .map_or((0, 0), |masses| (per_mass(masses.along_y_g), per_mass(masses.along_z_g)));
        Self {
            per_mass_y,
            per_mass_z,
            per_damping: Factor::new(1000, conditioning.damping_per_mille.max(1).into()),
            per_tick: Factor::new(1_000_000, UNIT_NM_S2.wrapping_mul(period_us.into())),
        }
    }

    /// Returns true if the masses are known.
    pub(super) const fn has_masses(&self) -> bool {
        self.per_mass_z != 0
    }

    /// Returns the predicted rate, nm/s; 0 without contact. `turning_nm_s` is `a phi'`, `y_nm_s`
    /// the speed of the journal along y; `is_settled` is true if both were known in the previous
    /// tick already.
    #[inline]
    pub(super) fn rate_nm_s(
        &self,
        state: &mut NewtonState,
        contact: &ContactFrame,
        turning_nm_s: i32,
        y_nm_s: i32,
        is_settled: bool,
    ) -> i32 {
        self.learn_pull(state, y_nm_s, is_settled);
        let ContactFrame { normal_y, normal_z, .. } = *contact;
        let part = |direction: i32, per_mass: i32| {
            product(product(direction, direction, 30) as i32, per_mass, 30) as i32
        };
        // Acceleration units over mN along the normal, 2^20: below 2^30.
        let per_mass = part(normal_y, self.per_mass_y).wrapping_add(part(normal_z, self.per_mass_z));
        let difference = self.per_mass_y.wrapping_sub(self.per_mass_z);
        let friction = within(saturated(product(state.friction_mn, difference, MASS_BITS)), LIMIT_BITS);
        let friction = product(product(normal_y, normal_z, 30) as i32, friction, 30) as i32;
        // Three parts below 2^30 and one below 2^31.
        let acceleration = (product(state.pull, normal_y, 30) as i32)
            .wrapping_sub(product(GRAVITY, normal_z, 30) as i32)
            .saturating_add(friction)
            .saturating_add(contact.centripetal(turning_nm_s))
            .max(0)
            .cast_unsigned();
        // An eighth of the ratio of the predicted force to the last one, which is therefore limited
        // to 8.
        let last = product(state.normal_mn, per_mass, MASS_BITS - 3).cast_unsigned();
        let ratio = fraction(acceleration, saturated_unsigned(last));
        let rate = u64::from(state.speed_nm_s.cast_unsigned()).wrapping_mul(ratio.into()) >> 29;
        let rate = saturated(rate.cast_signed()).saturating_sub(state.doubling_rate_nm_s);
        let rate = within(rate, LIMIT_BITS);
        select(state.normal_mn >= MIN_FORCE_MN, rate, 0)
    }

    /// Stores the estimate of a tick for the next one. `is_open` is true without contact.
    #[inline]
    pub(super) fn store(&self, state: &mut NewtonState, estimate: &PreviousEstimate, is_open: bool) {
        let approach = estimate.approach_nm_s.min(1 << LIMIT_BITS).cast_signed();
        let speed = within(self.per_damping.times(approach), LIMIT_BITS);
        state.doubling_rate_nm_s = speed;
        let with_rate = speed.saturating_add(estimate.rate_nm_s);
        let is_known = estimate.is_warm & (with_rate >= speed >> 1) & (estimate.normal_mn >= MIN_FORCE_MN);
        state.speed_nm_s = select(is_known, with_rate, state.speed_nm_s);
        state.normal_mn = select(is_open, 0, select(is_known, estimate.normal_mn, state.normal_mn));
        state.friction_mn = estimate.friction_mn;
        state.force_y_mn = estimate.force_y_mn;
    }

    /// Averages the pull along y: over 2, 4, 4, 8, 8, 8, 8, ... ticks after a restart, later over
    /// 128.
    #[inline]
    fn learn_pull(&self, state: &mut NewtonState, y_nm_s: i32, is_settled: bool) {
        let change = y_nm_s.saturating_sub(state.y_nm_s);
        state.y_nm_s = y_nm_s;
        state.ticks = state.ticks.saturating_add(u32::from(is_settled));
        let shift = 32_u32.wrapping_sub(state.ticks.leading_zeros()).min(PULL_SHIFT);
        let by_contact = saturated(product(state.force_y_mn, self.per_mass_y, MASS_BITS));
        let found = within(self.per_tick.times(change).saturating_sub(by_contact), LIMIT_BITS);
        // Both below 2^30.
        let step = found.wrapping_sub(state.pull) >> (shift & 31);
        state.pull = state.pull.wrapping_add(select(is_settled, step, 0));
    }
}
