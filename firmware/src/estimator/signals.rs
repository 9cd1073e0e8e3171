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

use super::geometry::DISTANCE_STEPS_PER_NM;
use super::whole::{Factor, saturated, select, within};
use super::window::{WideWindow, Window};

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
    journal_y: Window<SWING_WINDOW>,
    journal_z: Window<SWING_WINDOW>,
    deformation: Window<DEFORMATION_WINDOW>,
    shaft: WideWindow<SHAFT_WINDOW>,
    last_angle: i32,
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
            journal_y: Window::default(),
            journal_z: Window::default(),
            deformation: Window::default(),
            shaft: WideWindow::default(),
            last_angle: 0,
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

    /// The samples so far no longer belong to the next. They leave the windows as new ones come in.
    pub(super) const fn restart(&mut self) {
        self.filled = 0;
    }

    /// Takes a sample: the place within the limits of [`super::geometry`], the deformation in nm/16 (beyond 2.1 mm the window sees 2.1 mm). The angle may wrap.
    #[inline]
    pub(super) fn push(&mut self, y_nm: i32, z_nm: i32, deformation: i32, angle_nrad: i32) -> Motion {
        let last = self.row(0);
        let turned = i64::from(angle_nrad.wrapping_sub(self.last_angle));
        let angle = last.angle.wrapping_add(turned);
        self.last_angle = angle_nrad;

        let deformation_nm = within(deformation >> DISTANCE_STEPS_PER_NM.ilog2(), 21);
        let row = Row { y_nm, z_nm, deformation_nm, angle };
        let swing = self.row(SWING_WINDOW - 1);
        self.journal_y.push(y_nm, swing.y_nm);
        self.journal_z.push(z_nm, swing.z_nm);
        self.deformation.push(deformation_nm, self.row(DEFORMATION_WINDOW - 1).deformation_nm);
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
            select(known(SWING_WINDOW), within(speed, SPEED_BITS), 0)
        };
        let rate_known = known(DEFORMATION_WINDOW);
        let correction = self.value_scale.times(cut(self.deformation.value(deformation_nm), VALUE_SHIFT));
        // The fit in whole nanometres, at the newest sample with its sixteenths left away.
        let fitted = (deformation_nm << DISTANCE_STEPS_PER_NM.ilog2()).saturating_add(correction);
        let rate = self.deformation_scale.times(cut(self.deformation.slope(), DEFORMATION_SHIFT));
        let shaft = self.shaft_scale.times(cut(self.shaft.slope(), SHAFT_SHIFT));
        Motion {
            y_nm_s: swing(&self.journal_y),
            z_nm_s: swing(&self.journal_z),
            deformation: select(rate_known, fitted, deformation),
            deformation_rate_nm_s: select(rate_known, rate, 0),
            surface_nm_s: select(known(SHAFT_WINDOW), shaft, 0),
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
