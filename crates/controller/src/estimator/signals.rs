//! The last 64 samples of the sensors, and the motion from parabolas fitted to them.
//!
//! | quantity | unit | samples | noise gain | used for |
//! |---|---|---|---|---|
//! | journal y, z | nm | 24 | slope 0.1137 | swing: sliding speed, centripetal force |
//! | deformation | nm | 36 | value 0.473, slope 0.0626 | deformation and rate, see below |
//! | shaft angle | nrad | 64 | slope 0.0267 | sliding speed |
//!
//! Deformation and rate of the window are used without contact, at an onset, and where the
//! prediction by Newton's law fails.
//!
//! The deformation, that is the distance from the centre, has a separate window: the journal swings
//! along the clearance circle at 100 mm/s and more while its distance from the centre changes by
//! less than 1 mm/s. A rate projected from two Cartesian slopes would count a fiftieth of the swing
//! as deformation rate.
//!
//! The sums of the windows are recursive. They are exact, so nothing drifts; but a flipped bit in a
//! sum, or in a row that has not left yet, would stay and grow. So the same sums are computed a
//! second time from every 64 samples. As soon as a window's sums are complete they are compared
//! with those in use. If they differ, they replace them, and the windows count as empty: flagged,
//! and held, until they are full again.

use super::arithmetic::{Factor, saturated, select, within};
use super::geometry::DISTANCE_STEPS_PER_NM;
use super::window::{WideWindow, Window};
use crate::integrity::words;

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
/// Fitted slopes lose so many bits before they are scaled. At 100 us: steps of 8 nm/s, 4 nm/s and 1
/// urad/s, up to 16 m/s, 8 m/s and 2000 rad/s.
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
    /// Takes the newest row; of the rows that leave the windows it takes from each what belongs to
    /// its window.
    #[inline]
    fn push(&mut self, newest: &Row, leaving: &Row) {
        self.journal_y.push(newest.y_nm, leaving.y_nm);
        self.journal_z.push(newest.z_nm, leaving.z_nm);
        self.deformation.push(newest.deformation_nm, leaving.deformation_nm);
        self.shaft.push(newest.angle, leaving.angle);
    }
}

/// Replaces sums in use by rebuilt ones; returns true if they were equal.
fn replace<W: Copy + PartialEq>(used: &mut W, rebuilt: W) -> bool {
    core::mem::replace(used, rebuilt) == rebuilt
}

/// Motion at the time of the newest sample. Rates are 0 until their window is full.
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
    /// True if the deformation's window is full.
    pub(super) is_rate_known: bool,
    /// True if every window is full.
    pub(super) is_full: bool,
}

/// Scales of the windows' fits for a sample period and a journal radius.
#[derive(Clone, Debug)]
pub(super) struct Signals {
    swing_scale: Factor,
    deformation_scale: Factor,
    value_scale: Factor,
    shaft_scale: Factor,
}
words!(Signals { swing_scale, deformation_scale, value_scale, shaft_scale });

/// State of the windows: ring of rows and the sums over it, 1.6 kB.
#[derive(Clone, Debug)]
pub(super) struct SignalsState {
    rows: [Row; ROWS],
    newest: usize,
    filled: u32,
    windows: Windows,
    /// The same sums, formed again from the last `rebuilt` samples.
    rebuild: Windows,
    rebuilt: usize,
}

impl SignalsState {
    /// Empty windows.
    pub(super) fn new() -> Self {
        Self {
            rows: [Row::default(); ROWS],
            newest: 0,
            filled: 0,
            windows: Windows::default(),
            rebuild: Windows::default(),
            rebuilt: 0,
        }
    }

    /// Counts the windows as empty: the next sample does not continue the earlier ones, which leave
    /// as new ones arrive.
    pub(super) const fn restart(&mut self) {
        self.filled = 0;
    }

    /// Continues the second computation of the sums, compares what is complete with the sums in
    /// use, and begins again.
    #[inline]
    fn rebuild(&mut self, row: &Row) {
        self.rebuild.push(row, &Row::default());
        self.rebuilt = self.rebuilt.wrapping_add(1);
        let (windows, rebuild) = (&mut self.windows, &self.rebuild);
        // The branch depends on the place among 64 samples only, as long as no bit has flipped.
        let are_equal = match self.rebuilt {
            SWING_WINDOW => {
                replace(&mut windows.journal_y, rebuild.journal_y)
                    & replace(&mut windows.journal_z, rebuild.journal_z)
            }
            DEFORMATION_WINDOW => replace(&mut windows.deformation, rebuild.deformation),
            SHAFT_WINDOW.. => {
                let are_equal = replace(&mut windows.shaft, rebuild.shaft);
                self.rebuild = Windows::default();
                self.rebuilt = 0;
                are_equal
            }
            _ => true,
        };
        if !are_equal {
            self.restart();
        }
    }

    /// The row `age` samples before the newest one.
    #[inline]
    fn row(&self, age: usize) -> Row {
        self.rows.get(self.newest.wrapping_sub(age) & (ROWS - 1)).copied().unwrap_or_default()
    }
}

impl Signals {
    /// Prepares the scales for a sample period and a journal radius.
    pub(super) fn new(period_us: u32, journal_radius_nm: u32) -> Self {
        let per_sample = |denominator: i64| u64::from(period_us).wrapping_mul(denominator.unsigned_abs());
        let steps = u64::from(DISTANCE_STEPS_PER_NM.unsigned_abs());
        Self {
            swing_scale: Factor::new(
                1_000_000 << SWING_SHIFT,
                per_sample(Window::<SWING_WINDOW>::SLOPE_DENOMINATOR),
            ),
            deformation_scale: Factor::new(
                1_000_000 << DEFORMATION_SHIFT,
                per_sample(Window::<DEFORMATION_WINDOW>::SLOPE_DENOMINATOR),
            ),
            value_scale: Factor::new(
                steps << VALUE_SHIFT,
                Window::<DEFORMATION_WINDOW>::VALUE_DENOMINATOR.unsigned_abs(),
            ),
            // nrad a sample times nm, over 10^9, to nm/s.
            shaft_scale: Factor::new(
                u64::from(journal_radius_nm) << SHAFT_SHIFT,
                per_sample(WideWindow::<SHAFT_WINDOW>::SLOPE_DENOMINATOR).wrapping_mul(1000),
            ),
        }
    }

    /// Takes a sample: the position within the limits of [`super::geometry`], the deformation in
    /// nm/16 (the window limits it to 2.1 mm). The angle may wrap.
    #[inline(never)]
    pub(super) fn push(
        &self,
        state: &mut SignalsState,
        y_nm: i32,
        z_nm: i32,
        deformation: i32,
        angle_nrad: i32,
    ) -> Motion {
        // The lower half of the unwrapped angle is the last angle as it was sampled: unwrapping
        // needs no other state.
        let last = state.row(0).angle;
        let angle = last.wrapping_add(i64::from(angle_nrad.wrapping_sub(last as i32)));

        let deformation_nm = within(deformation >> DISTANCE_STEPS_PER_NM.ilog2(), 21);
        let row = Row { y_nm, z_nm, deformation_nm, angle };
        let swing = state.row(SWING_WINDOW - 1);
        let deformation_row = state.row(DEFORMATION_WINDOW - 1);
        let leaving = Row {
            deformation_nm: deformation_row.deformation_nm,
            angle: state.row(SHAFT_WINDOW - 1).angle,
            ..swing
        };
        state.windows.push(&row, &leaving);
        state.newest = state.newest.wrapping_add(1) & (ROWS - 1);
        if let Some(slot) = state.rows.get_mut(state.newest) {
            *slot = row;
        }
        state.filled = state.filled.wrapping_add(1).min(ROWS as u32);
        state.rebuild(&row);
        self.motion(state, deformation, deformation_nm)
    }

    /// Reads the fits at the newest sample.
    #[inline]
    fn motion(&self, state: &SignalsState, deformation: i32, deformation_nm: i32) -> Motion {
        let windows = &state.windows;
        let is_known = |samples: usize| state.filled >= samples as u32;
        let cut = |slope: i64, shift: u32| saturated(slope >> shift);
        let swing = |window: &Window<SWING_WINDOW>| {
            let speed = self.swing_scale.times(cut(window.slope(), SWING_SHIFT));
            select(is_known(SWING_WINDOW), within(speed, SPEED_BITS), 0)
        };
        let is_rate_known = is_known(DEFORMATION_WINDOW);
        let correction = self.value_scale.times(cut(windows.deformation.value(deformation_nm), VALUE_SHIFT));
        // The fit is over integer nanometres: the sixteenths of the newest sample are left out.
        let fitted = (deformation_nm << DISTANCE_STEPS_PER_NM.ilog2()).saturating_add(correction);
        let rate = self.deformation_scale.times(cut(windows.deformation.slope(), DEFORMATION_SHIFT));
        let shaft = self.shaft_scale.times(cut(windows.shaft.slope(), SHAFT_SHIFT));
        Motion {
            y_nm_s: swing(&windows.journal_y),
            z_nm_s: swing(&windows.journal_z),
            deformation: select(is_rate_known, fitted, deformation),
            deformation_rate_nm_s: select(is_rate_known, rate, 0),
            surface_nm_s: select(is_known(SHAFT_WINDOW), shaft, 0),
            is_rate_known,
            is_full: is_known(WINDOW),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Motions from intact windows and from disturbed ones over the same samples.
    fn pair(disturb: impl FnOnce(&mut SignalsState), samples: i32) -> Vec<(Motion, Motion)> {
        let signals = Signals::new(100, 69_500_000);
        let mut intact = SignalsState::new();
        let push = |state: &mut SignalsState, index: i32| {
            signals.push(state, index * index % 977, 40 * index, 300 * index, 1_000_000 * index)
        };
        for index in 0..150 {
            push(&mut intact, index);
        }
        let mut disturbed = intact.clone();
        disturb(&mut disturbed);
        (150..150 + samples).map(|index| (push(&mut intact, index), push(&mut disturbed, index))).collect()
    }

    #[test]
    fn a_flipped_bit_in_a_sum_or_a_row_is_flagged_and_does_not_stay() {
        type Disturb = fn(&mut SignalsState);
        let cases: [Disturb; 6] = [
            |state| state.windows.journal_y.push(1, 0),
            |state| state.windows.deformation.push(-1, 0),
            |state| state.windows.shaft.push(1 << 20, 0),
            |state| state.rows[7].z_nm ^= 1 << 3,
            |state| state.rows[60].deformation_nm ^= 1 << 12,
            |state| state.rows[1].angle ^= 1 << 33,
        ];
        for (case, disturb) in cases.into_iter().enumerate() {
            let motions = pair(disturb, 400);
            let first = motions.iter().position(|(_, disturbed)| !disturbed.is_full);
            // One round to be detected in, and one for a row that has not left yet.
            assert!(first.is_some_and(|first| first <= 2 * ROWS), "case {case}: {first:?}");
            assert!(motions[3 * ROWS..].iter().all(|(intact, disturbed)| intact == disturbed), "case {case}");
        }
    }

    #[test]
    fn intact_windows_stay_full() {
        assert!(pair(|_| {}, 1_000).iter().all(|(intact, other)| intact == other && intact.is_full));
        // Also after a gap.
        let motions = pair(SignalsState::restart, 200);
        assert_eq!(motions.iter().filter(|(_, other)| !other.is_full).count(), ROWS - 1);
    }
}
