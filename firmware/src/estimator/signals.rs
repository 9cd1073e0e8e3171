//! The sensors' samples of the last 64 ticks, and the motion that parabolas through them give.
//!
//! | quantity | unit | samples | noise gain | for |
//! |---|---|---|---|---|
//! | journal y, z | nm | 24 | slope 0.1137 | swing: sliding speed, centripetal force |
//! | deformation | nm | 36 | value 0.473, slope 0.0626 | deformation and rate in a gap, at an onset, and when Newton's law does not tell |
//! | shaft angle | nrad | 64 | slope 0.0267 | sliding speed |
//!
//! The deformation, that is the distance from the centre, has a window of its own: the journal swings along the clearance circle at 100 mm/s and more while its distance
//! from the centre changes by less than 1 mm/s. A rate that is the projection of two Cartesian slopes would mistake a
//! fiftieth of the former for the latter.
//!
//! The windows' sums follow from the ones before. They are exact, so nothing drifts; but a bit that flips in them, or in a row that is still to leave
//! them, would stay and grow. So every 64 samples the same sums are begun anew from nothing, and once a window's are complete they must be those in
//! use. If not, they take their place, and the windows count as empty: flagged, and held, until they are full again.

use core::hash::Hash;

use super::geometry::DISTANCE_STEPS_PER_NM;
use super::whole::{Factor, saturated, select, within};
use super::window::{WideWindow, Window};
use crate::constants::Sum;

/// Samples until every window is full.
pub const WINDOW: usize = SHAFT_WINDOW;
/// Samples of a journal coordinate's window.
pub const SWING_WINDOW: usize = 24;
/// Samples of the deformation's window.
pub const DEFORMATION_WINDOW: usize = 36;
/// Samples of the shaft angle's window.
pub const SHAFT_WINDOW: usize = 64;

/// Rows kept: a power of two, the longest window.
const ROWS: usize = 64;
/// Fitted slopes lose so many bits before they are scaled. At 100 us: steps of 8 nm/s, 4 nm/s and 1 urad/s, up to 16 m/s, 8 m/s and 2000 rad/s.
const SWING_SHIFT: u32 = 10;
const DEFORMATION_SHIFT: u32 = 12;
const SHAFT_SHIFT: u32 = 24;
/// The value's correction likewise: 2.7 mm in steps of a thousandth of a nanometre.
const VALUE_SHIFT: u32 = 6;
/// A component of the journal's speed is below 2 to this power nm/s, 1.07 m/s.
const SPEED_BITS: u32 = 30;

/// One tick's samples.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    y_nm: i32,
    z_nm: i32,
    deformation_nm: i32,
    /// Unwrapped, nrad.
    angle: i64,
}

/// The sums over the last samples.
#[derive(Clone, Copy, Debug, Default)]
struct Windows {
    journal_y: Window<SWING_WINDOW>,
    journal_z: Window<SWING_WINDOW>,
    deformation: Window<DEFORMATION_WINDOW>,
    shaft: WideWindow<SHAFT_WINDOW>,
}

impl Windows {
    /// Takes the newest row; of the rows that leave the windows it takes from each what belongs to its window.
    #[inline]
    fn push(&mut self, newest: &Row, leaving: &Row) {
        self.journal_y.push(newest.y_nm, leaving.y_nm);
        self.journal_z.push(newest.z_nm, leaving.z_nm);
        self.deformation.push(newest.deformation_nm, leaving.deformation_nm);
        self.shaft.push(newest.angle, leaving.angle);
    }
}

/// Takes sums that are complete; whether they were those in use.
fn take<W: Copy + PartialEq>(used: &mut W, anew: W) -> bool {
    core::mem::replace(used, anew) == anew
}

/// What the windows say about the newest sample's instant. Rates are 0 until their window is full.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Motion {
    /// Speed of the journal along y, nm/s.
    pub(super) y_nm_s: i32,
    /// The same along z.
    pub(super) z_nm_s: i32,
    /// Deformation, nm/16; the raw one until its window is full.
    pub(super) deformation: i32,
    /// Its rate, nm/s.
    pub(super) deformation_rate_nm_s: i32,
    /// Speed of the shaft's surface, nm/s.
    pub(super) surface_nm_s: i32,
    /// The deformation's window is full.
    pub(super) rate_known: bool,
    /// Every window is full.
    pub(super) full: bool,
}

/// Ring of rows and the windows over it: 1.6 kB.
#[derive(Clone, Debug)]
pub(super) struct Signals {
    rows: [Row; ROWS],
    newest: usize,
    filled: u32,
    windows: Windows,
    /// The same sums, begun `begun` samples ago.
    anew: Windows,
    begun: usize,
    swing_scale: Factor,
    deformation_scale: Factor,
    value_scale: Factor,
    shaft_scale: Factor,
}

impl Signals {
    /// Empty windows for a sample period and a journal radius.
    pub(super) fn new(period_us: u32, journal_radius_nm: u32) -> Self {
        let per_sample = |denominator: i64| u64::from(period_us).wrapping_mul(denominator.unsigned_abs());
        let steps = u64::from(DISTANCE_STEPS_PER_NM.unsigned_abs());
        Self {
            rows: [Row::default(); ROWS],
            newest: 0,
            filled: 0,
            windows: Windows::default(),
            anew: Windows::default(),
            begun: 0,
            swing_scale: Factor::of(
                1_000_000 << SWING_SHIFT,
                per_sample(Window::<SWING_WINDOW>::SLOPE_DENOMINATOR),
            ),
            deformation_scale: Factor::of(
                1_000_000 << DEFORMATION_SHIFT,
                per_sample(Window::<DEFORMATION_WINDOW>::SLOPE_DENOMINATOR),
            ),
            value_scale: Factor::of(
                steps << VALUE_SHIFT,
                Window::<DEFORMATION_WINDOW>::VALUE_DENOMINATOR.unsigned_abs(),
            ),
            // nrad a sample by nm, over 10^9, to nm/s.
            shaft_scale: Factor::of(
                u64::from(journal_radius_nm) << SHAFT_SHIFT,
                per_sample(WideWindow::<SHAFT_WINDOW>::SLOPE_DENOMINATOR).wrapping_mul(1000),
            ),
        }
    }

    pub(super) fn constants(&self, sum: &mut Sum) {
        (self.swing_scale, self.deformation_scale, self.value_scale, self.shaft_scale).hash(sum);
    }

    /// The samples so far no longer belong to the next. They leave the windows as new ones come in.
    pub(super) const fn restart(&mut self) {
        self.filled = 0;
    }

    /// Takes a sample: the place within the limits of [`super::geometry`], the deformation in nm/16 (beyond 2.1 mm the window sees 2.1 mm). The angle may wrap.
    #[inline(never)]
    pub(super) fn push(&mut self, y_nm: i32, z_nm: i32, deformation: i32, angle_nrad: i32) -> Motion {
        // Its lower half is the last angle as it came, so the unwrapped angle needs nothing but itself to go on from.
        let last = self.row(0).angle;
        let angle = last.wrapping_add(i64::from(angle_nrad.wrapping_sub(last as i32)));

        let deformation_nm = within(deformation >> DISTANCE_STEPS_PER_NM.ilog2(), 21);
        let row = Row { y_nm, z_nm, deformation_nm, angle };
        let swing = self.row(SWING_WINDOW - 1);
        let deformation_row = self.row(DEFORMATION_WINDOW - 1);
        let leaving = Row {
            deformation_nm: deformation_row.deformation_nm,
            angle: self.row(SHAFT_WINDOW - 1).angle,
            ..swing
        };
        self.windows.push(&row, &leaving);
        self.newest = self.newest.wrapping_add(1) & (ROWS - 1);
        if let Some(slot) = self.rows.get_mut(self.newest) {
            *slot = row;
        }
        self.filled = self.filled.wrapping_add(1).min(ROWS as u32);
        self.begin_anew(&row);

        let known = |samples: usize| self.filled >= samples as u32;
        let cut = |slope: i64, shift: u32| saturated(slope >> shift);
        let swing = |window: &Window<SWING_WINDOW>| {
            let speed = self.swing_scale.times(cut(window.slope(), SWING_SHIFT));
            select(known(SWING_WINDOW), within(speed, SPEED_BITS), 0)
        };
        let rate_known = known(DEFORMATION_WINDOW);
        let correction =
            self.value_scale.times(cut(self.windows.deformation.value(deformation_nm), VALUE_SHIFT));
        // The fit in whole nanometres, at the newest sample with its sixteenths left away.
        let fitted = (deformation_nm << DISTANCE_STEPS_PER_NM.ilog2()).saturating_add(correction);
        let rate = self.deformation_scale.times(cut(self.windows.deformation.slope(), DEFORMATION_SHIFT));
        let shaft = self.shaft_scale.times(cut(self.windows.shaft.slope(), SHAFT_SHIFT));
        Motion {
            y_nm_s: swing(&self.windows.journal_y),
            z_nm_s: swing(&self.windows.journal_z),
            deformation: select(rate_known, fitted, deformation),
            deformation_rate_nm_s: select(rate_known, rate, 0),
            surface_nm_s: select(known(SHAFT_WINDOW), shaft, 0),
            rate_known,
            full: known(WINDOW),
        }
    }

    /// Goes on with the sums begun anew, holds those that are complete against those in use, and begins them once more in their time.
    #[inline]
    fn begin_anew(&mut self, row: &Row) {
        self.anew.push(row, &Row::default());
        self.begun = self.begun.wrapping_add(1);
        let (windows, anew) = (&mut self.windows, &self.anew);
        // A branch on the place among 64 samples, on nothing else, as long as all is sound.
        let sound = match self.begun {
            SWING_WINDOW => {
                take(&mut windows.journal_y, anew.journal_y) & take(&mut windows.journal_z, anew.journal_z)
            }
            DEFORMATION_WINDOW => take(&mut windows.deformation, anew.deformation),
            SHAFT_WINDOW.. => {
                let sound = take(&mut windows.shaft, anew.shaft);
                self.anew = Windows::default();
                self.begun = 0;
                sound
            }
            _ => true,
        };
        if !sound {
            self.restart();
        }
    }

    /// The row that came so many samples before the newest one.
    #[inline]
    fn row(&self, age: usize) -> Row {
        self.rows.get(self.newest.wrapping_sub(age) & (ROWS - 1)).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a sound set of windows and a disturbed one say of the same samples.
    fn pair(disturb: impl FnOnce(&mut Signals), samples: i32) -> Vec<(Motion, Motion)> {
        let mut sound = Signals::new(100, 69_500_000);
        let swing = |index: i32| (index * index % 977, 40 * index, 300 * index, 1_000_000 * index);
        for index in 0..150 {
            let (y, z, deformation, angle) = swing(index);
            sound.push(y, z, deformation, angle);
        }
        let mut disturbed = sound.clone();
        disturb(&mut disturbed);
        (150..150 + samples)
            .map(|index| {
                let (y, z, deformation, angle) = swing(index);
                (sound.push(y, z, deformation, angle), disturbed.push(y, z, deformation, angle))
            })
            .collect()
    }

    #[test]
    fn a_flipped_bit_in_a_sum_or_a_row_is_flagged_and_does_not_stay() {
        type Disturb = fn(&mut Signals);
        let cases: [Disturb; 6] = [
            |signals| signals.windows.journal_y.push(1, 0),
            |signals| signals.windows.deformation.push(-1, 0),
            |signals| signals.windows.shaft.push(1 << 20, 0),
            |signals| signals.rows[7].z_nm ^= 1 << 3,
            |signals| signals.rows[60].deformation_nm ^= 1 << 12,
            |signals| signals.rows[1].angle ^= 1 << 33,
        ];
        for (case, disturb) in cases.into_iter().enumerate() {
            let motions = pair(disturb, 400);
            let first = motions.iter().position(|(_, disturbed)| !disturbed.full);
            // A round to be noticed in, and one for a row that was still to leave.
            assert!(first.is_some_and(|first| first <= 2 * ROWS), "case {case}: {first:?}");
            assert!(motions[3 * ROWS..].iter().all(|(sound, disturbed)| sound == disturbed), "case {case}");
        }
    }

    #[test]
    fn sound_windows_stay_full() {
        assert!(pair(|_| {}, 1_000).iter().all(|(sound, other)| sound == other && sound.full));
        // Also behind a gap.
        let motions = pair(Signals::restart, 200);
        assert_eq!(motions.iter().filter(|(_, other)| !other.full).count(), ROWS - 1);
    }
}
