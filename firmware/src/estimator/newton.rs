//! What Newton's law says about the rate of the deformation.
//!
//! In contact the distance from the centre hardly accelerates: 10,000 N on 150 kg are 67 m/s2, and its rate changes by 0.5 m/s2 at most.
//! So along the normal the contact force balances what the journal's swing and its load ask for,
//!
//! ```text
//! F = (a phi'^2 + p n_y - g n_z + F_f n_y n_z (1/m_y - 1/m_z)) / (n_y^2/m_y + n_z^2/m_z)
//! ```
//!
//! with the masses `m_y`, `m_z` that the force moves either way and the pull `p`, all that accelerates the journal along y but the
//! contact. The swing `a phi'` is measured a thousand times better, relative to its size, than the rate `d'`: it follows the oscillation without delay. The law of the
//! contact, `F = K (1 + chi d'/v)` with the latched speed `v`, turned round gives the rate that goes with this force,
//!
//! ```text
//! d' = (v/chi) (F/K - 1)
//! ```
//!
//! with the elastic part `K` of the last tick's estimate: it is what the network itself said at that deformation. The pull changes
//! slowly; it is what is left of Newton's law along y, `y'' - F_cy/m_y`, averaged over 128 ticks (over fewer after a start).
//! What is wrong with this rate, and slow, the [`super::observer`] takes out by the measured position; what is wrong and fast it
//! notices. Whole numbers: nm/s, mN, accelerations in units of 1024 nm/s2; no branch on data.

use core::hash::Hash;

use super::conditioning::{Conditioning, MASS_RANGE_G};
use super::geometry::ContactFrame;
use super::whole::{Factor, product, saturated, saturated_unsigned, select, within};
use crate::constants::Sum;
use inference::fixed::fraction;
use inference::held::WordSum;

/// Unit of accelerations, nm/s2.
const UNIT_NM_S2: u64 = 1024;
/// 9.81 m/s2 in that unit.
const GRAVITY: i32 = 9_580_078;
/// Fraction bits of an inverse mass in acceleration units over mN.
const MASS_BITS: u32 = 20;
/// The pull is averaged over two to this power ticks.
const PULL_SHIFT: u32 = 7;
/// Below this force the elastic part is not known well enough, mN.
const LEAST_FORCE_MN: i32 = 20_000;
/// Accelerations are below 2 to this power units, 1.1 km/s2, speeds and predicted rates below 2 to this power nm/s, 1.07 m/s.
const LIMIT_BITS: u32 = 30;

/// Newton's law along the normal, and what the last ticks told about it.
#[derive(Clone, Debug)]
pub(super) struct Newton {
    per_mass_y: i32,
    per_mass_z: i32,
    per_damping: Factor,
    per_tick: Factor,
    pull: i32,
    ticks: u32,
    last_y_nm_s: i32,
    force_y_mn: i32,
    friction_mn: i32,
    /// Normal force and `v/chi + d'` of the last tick that knew the elastic part, `F v/chi` over the latter.
    normal_mn: i32,
    speed_nm_s: i32,
    /// `v/chi` of the last tick.
    slope_nm_s: i32,
}

/// What a tick's estimate was.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told {
    pub(super) normal_mn: i32,
    pub(super) friction_mn: i32,
    pub(super) force_y_mn: i32,
    pub(super) rate_nm_s: i32,
    pub(super) approach_nm_s: u32,
    /// The networks' history is whole.
    pub(super) warm: bool,
}

impl Newton {
    pub(super) fn constants(&self, sum: &mut Sum) {
        (self.per_mass_y, self.per_mass_z, self.per_damping, self.per_tick).hash(sum);
    }

    /// Prepares the law; without masses it has nothing to say.
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
            per_damping: Factor::of(1000, conditioning.damping_per_mille.max(1).into()),
            per_tick: Factor::of(1_000_000, UNIT_NM_S2.wrapping_mul(period_us.into())),
            pull: 0,
            ticks: 0,
            last_y_nm_s: 0,
            force_y_mn: 0,
            friction_mn: 0,
            normal_mn: 0,
            speed_nm_s: 0,
            slope_nm_s: 0,
        }
    }

    /// What the next tick goes on with.
    #[inline]
    pub(super) fn carried(&self, sum: &mut WordSum) {
        sum.word(self.ticks);
        sum.word(self.pull.cast_unsigned());
        sum.word(self.last_y_nm_s.cast_unsigned());
        sum.word(self.force_y_mn.cast_unsigned());
        sum.word(self.friction_mn.cast_unsigned());
        sum.word(self.normal_mn.cast_unsigned());
        sum.word(self.speed_nm_s.cast_unsigned());
        sum.word(self.slope_nm_s.cast_unsigned());
    }

    /// Whether the masses are known.
    pub(super) const fn has_masses(&self) -> bool {
        self.per_mass_z != 0
    }

    /// The next tick does not follow the last.
    pub(super) const fn restart(&mut self) {
        self.ticks = 0;
        self.pull = 0;
        self.normal_mn = 0;
    }

    /// The rate that Newton's law asks for, nm/s; 0 without contact. `turning` is `a phi'` and `y` the journal's speed along y, both in nm/s; `settled`
    /// says that they are known since a tick at least.
    #[inline]
    pub(super) fn rate_nm_s(&mut self, contact: &ContactFrame, turning: i32, y: i32, settled: bool) -> i32 {
        self.learn_pull(y, settled);
        let ContactFrame { normal_y, normal_z, .. } = *contact;
        let part = |direction: i32, per_mass: i32| {
            product(product(direction, direction, 30) as i32, per_mass, 30) as i32
        };
        // Acceleration units over mN along the normal, 2^20: below 2^30.
        let per_mass = part(normal_y, self.per_mass_y).wrapping_add(part(normal_z, self.per_mass_z));
        let difference = self.per_mass_y.wrapping_sub(self.per_mass_z);
        let friction = within(saturated(product(self.friction_mn, difference, MASS_BITS)), LIMIT_BITS);
        let friction = product(product(normal_y, normal_z, 30) as i32, friction, 30) as i32;
        // Three parts below 2^30 and one below 2^31.
        let asked = (product(self.pull, normal_y, 30) as i32)
            .wrapping_sub(product(GRAVITY, normal_z, 30) as i32)
            .saturating_add(friction)
            .saturating_add(contact.centripetal(turning))
            .max(0)
            .cast_unsigned();
        // An eighth of `F_asked/F_last`, and so at most 8 times.
        let last = product(self.normal_mn, per_mass, MASS_BITS - 3).cast_unsigned();
        let ratio = fraction(asked, saturated_unsigned(last));
        let rate = u64::from(self.speed_nm_s.cast_unsigned()).wrapping_mul(ratio.into()) >> 29;
        let rate = saturated(rate.cast_signed()).saturating_sub(self.slope_nm_s);
        let rate = within(rate, LIMIT_BITS);
        select(self.normal_mn >= LEAST_FORCE_MN, rate, 0)
    }

    /// Remembers what a tick's estimate was; `open` says that there was no contact.
    #[inline]
    pub(super) fn remember(&mut self, told: &Told, open: bool) {
        let approach = told.approach_nm_s.min(1 << LIMIT_BITS).cast_signed();
        let speed = within(self.per_damping.times(approach), LIMIT_BITS);
        self.slope_nm_s = speed;
        let with_rate = speed.saturating_add(told.rate_nm_s);
        let known = told.warm & (with_rate >= speed >> 1) & (told.normal_mn >= LEAST_FORCE_MN);
        self.speed_nm_s = select(known, with_rate, self.speed_nm_s);
        self.normal_mn = select(open, 0, select(known, told.normal_mn, self.normal_mn));
        self.friction_mn = told.friction_mn;
        self.force_y_mn = told.force_y_mn;
    }

    /// One more tick of Newton's law along y: over 2, 4, 4, 8, 8, 8, 8, ... ticks, at last over 128.
    #[inline]
    fn learn_pull(&mut self, y_nm_s: i32, settled: bool) {
        let changed = y_nm_s.saturating_sub(self.last_y_nm_s);
        self.last_y_nm_s = y_nm_s;
        self.ticks = self.ticks.saturating_add(u32::from(settled));
        let shift = 32_u32.wrapping_sub(self.ticks.leading_zeros()).min(PULL_SHIFT);
        let by_contact = saturated(product(self.force_y_mn, self.per_mass_y, MASS_BITS));
        let found = within(self.per_tick.times(changed).saturating_sub(by_contact), LIMIT_BITS);
        // Both below 2^30.
        let step = found.wrapping_sub(self.pull) >> (shift & 31);
        self.pull = self.pull.wrapping_add(select(settled, step, 0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_that_is_carried_over_counts() {
        let newton = Newton::new(&Conditioning::of_bench(inference::Bearing::Babbitt), 100);
        let sum = |newton: &Newton| {
            let mut sum = WordSum::default();
            newton.carried(&mut sum);
            sum
        };
        let flips: [fn(&mut Newton, u32); 8] = [
            |n, b| n.pull ^= 1 << b,
            |n, b| n.ticks ^= 1 << b,
            |n, b| n.last_y_nm_s ^= 1 << b,
            |n, b| n.force_y_mn ^= 1 << b,
            |n, b| n.friction_mn ^= 1 << b,
            |n, b| n.normal_mn ^= 1 << b,
            |n, b| n.speed_nm_s ^= 1 << b,
            |n, b| n.slope_nm_s ^= 1 << b,
        ];
        for flip in flips {
            for bit in 0..32 {
                let mut there = newton.clone();
                flip(&mut there, bit);
                assert_ne!(sum(&there), sum(&newton), "bit {bit}");
            }
        }
    }
}
