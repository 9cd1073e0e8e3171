//! The sensors' samples of the last 64 ticks, and the motion that parabolas through them give.
//!
//! | quantity | unit | samples | noise gain | for |
//! |---|---|---|---|---|
//! | journal y, z | nm | 24 | slope 0.1157 | swing: sliding speed, centripetal force |
//! | distance from the centre | nm/16 | 36 | value 0.473, slope 0.0626 | deformation and rate in a gap, at an onset, and when Newton's law does not tell |
//! | shaft angle | nrad | 64 | slope 0.0263 | sliding speed |
//!
//! The distance has a window of its own: the journal swings along the clearance circle at 100 mm/s and more while its distance
//! from the centre changes by less than 1 mm/s. A rate that is the projection of two Cartesian slopes would mistake a
//! fiftieth of the former for the latter.

use super::geometry::DISTANCE_STEPS_PER_NM;
use super::whole::{Factor, saturated, select};
use super::window::Window;

/// Samples until every window is full.
pub const WINDOW: usize = SHAFT_WINDOW;
/// Samples of a journal coordinate's window.
pub const SWING_WINDOW: usize = 24;
/// Samples of the distance's window.
pub const DISTANCE_WINDOW: usize = 36;
/// Samples of the shaft angle's window.
pub const SHAFT_WINDOW: usize = 64;

/// Rows kept: a power of two, the longest window.
const ROWS: usize = 64;
/// Fitted slopes are cut to this many bits before they are scaled: 1.7, 0.88 and 137 units of m/s and rad/s at a sample period of 1 ms, ten
/// times that at 100 us, in steps of 8 nm/s, 4 nm/s and 1 urad/s there.
const SWING_SHIFT: u32 = 10;
const DISTANCE_SHIFT: u32 = 16;
const SHAFT_SHIFT: u32 = 24;
/// The value's correction likewise: 170 um in steps of a ten-thousandth of a nanometre.
const VALUE_SHIFT: u32 = 6;
/// No component of the journal's speed is above this, nm/s: 1.07 m/s.
const SPEED_LIMIT_NM_S: i32 = 1 << 30;
/// The shaft speed is in units of so many nrad/s: 137 rad/s in 32 bits.
pub(super) const SHAFT_SPEED_UNIT_NRAD_S: u64 = 64;

/// One tick's samples.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    y_nm: i32,
    z_nm: i32,
    distance: i32,
    /// Unwrapped, nrad.
    angle: i64,
}

/// What the windows say about the newest sample's instant. Rates are 0 until their window is full.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Motion {
    /// Speed of the journal along y, nm/s.
    pub(super) y_nm_s: i32,
    /// The same along z.
    pub(super) z_nm_s: i32,
    /// Distance from the centre, nm/16; the raw one until its window is full.
    pub(super) distance: i32,
    /// Its rate, nm/s.
    pub(super) distance_rate_nm_s: i32,
    /// Speed of the shaft, in units of 64 nrad/s.
    pub(super) shaft_speed: i32,
    /// The distance's window is full.
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
    journal_y: Window<SWING_WINDOW>,
    journal_z: Window<SWING_WINDOW>,
    distance: Window<DISTANCE_WINDOW>,
    shaft: Window<SHAFT_WINDOW>,
    last_angle: i32,
    swing_scale: Factor,
    distance_scale: Factor,
    value_scale: Factor,
    shaft_scale: Factor,
}

impl Signals {
    /// Empty windows for a sample period.
    pub(super) fn new(period_us: u32) -> Self {
        let per_sample = |denominator: i64| u64::from(period_us).wrapping_mul(denominator.unsigned_abs());
        let steps = u64::from(DISTANCE_STEPS_PER_NM.unsigned_abs());
        Self {
            rows: [Row::default(); ROWS],
            newest: 0,
            filled: 0,
            journal_y: Window::default(),
            journal_z: Window::default(),
            distance: Window::default(),
            shaft: Window::default(),
            last_angle: 0,
            swing_scale: Factor::of(
                1_000_000 << SWING_SHIFT,
                per_sample(Window::<SWING_WINDOW>::SLOPE_DENOMINATOR),
            ),
            distance_scale: Factor::of(
                1_000_000 << DISTANCE_SHIFT,
                steps.wrapping_mul(per_sample(Window::<DISTANCE_WINDOW>::SLOPE_DENOMINATOR)),
            ),
            value_scale: Factor::of(
                1 << VALUE_SHIFT,
                Window::<DISTANCE_WINDOW>::VALUE_DENOMINATOR.unsigned_abs(),
            ),
            shaft_scale: Factor::of(
                1_000_000 << SHAFT_SHIFT,
                SHAFT_SPEED_UNIT_NRAD_S.wrapping_mul(per_sample(Window::<SHAFT_WINDOW>::SLOPE_DENOMINATOR)),
            ),
        }
    }

    /// The samples so far no longer belong to the next. They leave the windows as new ones come in.
    pub(super) const fn restart(&mut self) {
        self.filled = 0;
    }

    /// Takes a sample. The angle may wrap.
    #[inline]
    pub(super) fn push(&mut self, y_nm: i32, z_nm: i32, distance: i32, angle_nrad: i32) -> Motion {
        let last = self.row(0);
        let turned = i64::from(angle_nrad.wrapping_sub(self.last_angle));
        let angle = last.angle.wrapping_add(turned);
        self.last_angle = angle_nrad;

        let row = Row { y_nm, z_nm, distance, angle };
        let swing = self.row(SWING_WINDOW - 1);
        self.journal_y.push(y_nm.into(), swing.y_nm.into());
        self.journal_z.push(z_nm.into(), swing.z_nm.into());
        self.distance.push(distance.into(), self.row(DISTANCE_WINDOW - 1).distance.into());
        self.shaft.push(angle, self.row(SHAFT_WINDOW - 1).angle);
        self.newest = self.newest.wrapping_add(1) & (ROWS - 1);
        if let Some(slot) = self.rows.get_mut(self.newest) {
            *slot = row;
        }
        self.filled = self.filled.wrapping_add(1).min(ROWS as u32);

        let known = |samples: usize| self.filled >= samples as u32;
        let cut = |slope: i64, shift: u32| saturated(slope >> shift);
        let swing = |window: &Window<SWING_WINDOW>| {
            let speed = self.swing_scale.times(cut(window.slope(), SWING_SHIFT));
            select(known(SWING_WINDOW), speed.max(-SPEED_LIMIT_NM_S).min(SPEED_LIMIT_NM_S), 0)
        };
        let rate_known = known(DISTANCE_WINDOW);
        let correction = self.value_scale.times(cut(self.distance.value(distance.into()), VALUE_SHIFT));
        let rate = self.distance_scale.times(cut(self.distance.slope(), DISTANCE_SHIFT));
        let shaft = self.shaft_scale.times(cut(self.shaft.slope(), SHAFT_SHIFT));
        Motion {
            y_nm_s: swing(&self.journal_y),
            z_nm_s: swing(&self.journal_z),
            distance: distance.saturating_add(select(rate_known, correction, 0)),
            distance_rate_nm_s: select(rate_known, rate, 0),
            shaft_speed: select(known(SHAFT_WINDOW), shaft, 0),
            rate_known,
            full: known(WINDOW),
        }
    }

    /// The row that came so many samples before the newest one.
    #[inline]
    fn row(&self, age: usize) -> Row {
        self.rows.get(self.newest.wrapping_sub(age) & (ROWS - 1)).copied().unwrap_or_default()
    }
}
