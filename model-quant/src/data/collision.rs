//! The collision set: random access to any of its rows.
//!
//! Range `paper`: the grid of Table 2 ([`super::parameter_grid`]). Row `p` of the shuffled set is
//! point `permutation(p)` of the grid. Training has rows 0 to 1e7, validation the next 2.5e6, test
//! the last 2.5e6. All three share the values of the axes, as in the paper, so the test part
//! measures new combinations and not values in between.
//!
//! Range `bench`: row `k` of each part is the one that [`crate::data::rows::draw_row`] draws for
//! the seed. The shipped models were trained on these rows. A state whose force exceeds the range
//! is drawn again.
//!
//! Limit of the ratio: Table 2 sets no bound to the rate over the approach speed. The approach
//! speed is first raised to the law's floor (1 mm/s); a rate beyond 6 times that speed is then
//! lowered to 6 times. [`LimitStatistics`] measures how this changes the force.

use super::histogram::Histogram;
use super::parameter_grid::{ParameterGrid, ROWS};
use super::permutation::Permutation;
use super::split::Split;
use crate::data::draw::{Draw, HistorySet, Purpose};
use crate::data::features::FloatFeatures;
use crate::data::ranges::{RangeKind, header};
use crate::data::rows::{Row, draw_row};
use crate::data::window::{self, Window};
use contact::NormalLaw;
use inference::features::COLLISION_INPUTS;
use inference::{BearingMaterial, ContactState, WINDOW};
use std::ops::Range;

/// Columns of a table of rows.
pub(crate) const COLUMNS: [&str; 5] =
    ["radial_clearance_m", "deformation_m", "deformation_rate_m_s", "approach_speed_m_s", "normal_force_n"];

/// Column names of a table of windows: input `i` of the column `c` samples ago is `x<c>_<i>`,
/// oldest first.
pub(crate) fn window_names() -> Vec<String> {
    let inputs = (0..WINDOW).rev().flat_map(|age| (0..COLLISION_INPUTS).map(move |i| format!("x{age}_{i}")));
    inputs.chain(["target".to_owned(), "normal_force_n".to_owned()]).collect()
}

/// Values of a window in the order of [`window_names`].
pub(crate) fn window_values(
    window: &Window<COLLISION_INPUTS>,
    normal_force_n: f64,
) -> impl Iterator<Item = f32> {
    window.columns.into_iter().flatten().chain([window.target, normal_force_n as f32])
}

/// Number of rows that the floor and the limit changed, and the normal forces with and without
/// them.
#[derive(Clone, Debug, Default)]
pub struct LimitStatistics {
    /// Rows whose rate was lowered to the limit, or was drawn at the limit.
    pub limited: u64,
    /// Rows whose approach speed lies below the floor.
    pub below_floor: u64,
    /// Normal force in N of the rows as written.
    pub force_n: Histogram,
    /// Normal force in N with floor but without limit, and with neither; None if no draw can exceed
    /// the limit.
    pub unlimited_force_n: Option<[Histogram; 2]>,
}

impl LimitStatistics {
    /// Adds the statistics of another block of rows.
    pub(crate) fn join(&mut self, other: &Self) {
        self.limited += other.limited;
        self.below_floor += other.below_floor;
        self.force_n.join(&other.force_n);
        if let Some(theirs) = &other.unlimited_force_n {
            for (histogram, more) in self.unlimited_force_n.get_or_insert_default().iter_mut().zip(theirs) {
                histogram.join(more);
            }
        }
    }
}

/// Grid of Table 2, order of its rows, and the laws of its clearances with and without floor.
#[derive(Clone, Debug)]
struct Table2 {
    grid: ParameterGrid,
    order: Permutation,
    laws: Vec<[NormalLaw; 2]>,
}

/// The collision set of a bearing.
#[derive(Clone, Debug)]
pub struct CollisionSet {
    kind: RangeKind,
    seed: u64,
    features: FloatFeatures,
    table: Option<Table2>,
}

/// Floor in m/s that has no effect: below every speed that is drawn.
const NO_FLOOR_M_S: f64 = 1e-12;

impl CollisionSet {
    /// Creates the set for a seed.
    pub fn new(bearing: BearingMaterial, kind: RangeKind, seed: u64) -> Self {
        let features = FloatFeatures::from_header(&header(bearing, kind));
        let table = (kind == RangeKind::Paper).then(|| {
            let grid = ParameterGrid::draw(&features, seed);
            let [clearances, ..] = grid.axes();
            let floors = [f64::from(features.latch_floor_m_s), NO_FLOOR_M_S];
            let laws = (clearances.iter())
                .map(|&clearance| floors.map(|floor| bearing.normal_law(f64::from(clearance), floor)))
                .collect();
            Table2 { grid, order: Permutation::new(ROWS, seed), laws }
        });
        Self { kind, seed, features, table }
    }

    /// Row `index` of a part; its sliding speed is always 0 with range `paper`.
    pub(crate) fn row(&self, split: Split, index: u64) -> Row {
        self.row_and_draw(split, index).0
    }

    /// Returns a row and, for Table 2, the forces of its draw before the floor and the limit were
    /// applied.
    fn row_and_draw(&self, split: Split, index: u64) -> (Row, Option<[f64; 2]>) {
        let Some(table) = &self.table else {
            let purpose = match split {
                Split::Training => Purpose::TrainingRows,
                Split::Validation => Purpose::ValidationRows,
                Split::Test => Purpose::TestRows,
            };
            return (draw_row(self.features.bearing, self.kind, self.seed, purpose, index), None);
        };
        let (clearance_index, values) = table.grid.at(table.order.at(self.place(split, index)));
        let [radial_clearance_m, deformation_m, deformation_rate_m_s, approach_speed_m_s] = values;
        let force = |law: &NormalLaw| {
            law.force_n(deformation_m.into(), deformation_rate_m_s.into(), approach_speed_m_s.into())
        };
        let forces = table.laws.get(clearance_index).map(|laws| laws.each_ref().map(force));
        let state = ContactState {
            radial_clearance_m,
            deformation_m,
            deformation_rate_m_s,
            approach_speed_m_s,
            sliding_speed_m_s: 0.0,
        };
        (Row::label(&self.features, state), forces)
    }

    /// Position of a row in the complete shuffled set.
    fn place(&self, split: Split, index: u64) -> u64 {
        let before = Split::ALL.into_iter().take_while(|&earlier| earlier != split);
        before.map(|earlier| earlier.row_count(ROWS)).sum::<u64>() + index
    }

    /// Window of a row, by the rule of [`crate::data::window`].
    pub(crate) fn window(&self, split: Split, index: u64, row: &Row) -> Window<COLLISION_INPUTS> {
        let mut draw = Draw::history(self.seed, HistorySet::Dataset, self.place(split, index));
        window::draw_collision_window(&self.features, row, &mut draw)
    }

    /// Returns a block of rows or windows as columns, and how many of them were limited.
    pub fn block(&self, split: Split, rows: Range<u64>, windows: bool) -> (Vec<Vec<f32>>, LimitStatistics) {
        let count = if windows { WINDOW * COLLISION_INPUTS + 2 } else { COLUMNS.len() };
        let mut columns = vec![Vec::with_capacity((rows.end - rows.start) as usize); count];
        let mut limits = LimitStatistics::default();
        for index in rows {
            let (row, before) = self.row_and_draw(split, index);
            self.count(&mut limits, &row, before);
            let state = &row.state;
            if windows {
                let window = self.window(split, index, &row);
                push(&mut columns, window_values(&window, row.normal_force_n));
            } else {
                let values = [
                    state.radial_clearance_m,
                    state.deformation_m,
                    state.deformation_rate_m_s,
                    state.approach_speed_m_s,
                    row.normal_force_n as f32,
                ];
                push(&mut columns, values);
            }
        }
        (columns, limits)
    }

    fn count(&self, limits: &mut LimitStatistics, row: &Row, before: Option<[f64; 2]>) {
        let ratio = self.features.unclamped_rate_ratio(&row.state).abs();
        limits.limited += u64::from(ratio >= self.features.rate_ratio.high * (1.0 - f32::EPSILON));
        limits.below_floor += u64::from(row.state.approach_speed_m_s < self.features.latch_floor_m_s);
        limits.force_n.add(row.normal_force_n);
        if let Some(forces) = before {
            for (histogram, force) in limits.unlimited_force_n.get_or_insert_default().iter_mut().zip(forces)
            {
                histogram.add(force);
            }
        }
    }
}

/// Adds one value to every column.
pub(super) fn push(columns: &mut [Vec<f32>], values: impl IntoIterator<Item = f32>) {
    for (column, value) in columns.iter_mut().zip(values) {
        column.push(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn blocks_agree_with_single_rows_and_parts_share_no_grid_point() {
        let set = CollisionSet::new(BearingMaterial::Babbitt, RangeKind::Paper, 9);
        let (complete, _) = set.block(Split::Test, 100..300, false);
        let (part, _) = set.block(Split::Test, 250..300, false);
        for (all, some) in complete.iter().zip(&part) {
            assert_eq!(all[150..], some[..]);
        }
        let mut seen = BTreeSet::new();
        for split in Split::ALL {
            let last = split.row_count(ROWS);
            for index in (0..2000).chain(last - 2000..last) {
                let state = set.row(split, index).state;
                // The rate may have been limited, so grid positions are compared and not states.
                let table = set.table.as_ref().unwrap();
                assert!(seen.insert(table.order.at(set.place(split, index))), "{state:?}");
            }
        }
        assert_eq!(set.place(Split::Test, 2_499_999), ROWS - 1);
    }

    #[test]
    fn only_the_limit_changes_a_row_and_its_force_is_that_of_the_law() {
        for bearing in BearingMaterial::ALL {
            let set = CollisionSet::new(bearing, RangeKind::Paper, 2);
            let table = set.table.as_ref().unwrap();
            let (_, limits) = set.block(Split::Training, 0..20_000, false);
            let mut limited = 0;
            for index in 0..20_000 {
                let row = set.row(Split::Training, index);
                let (clearance, drawn) = table.grid.at(table.order.at(index));
                let limit = 6.0 * drawn[3].max(1e-3);
                limited += u64::from(drawn[2] >= limit);
                assert_eq!(row.state.deformation_rate_m_s, drawn[2].min(limit));
                let law = bearing.normal_law(f64::from(table.grid.axes()[0][clearance]), f64::from(1e-3f32));
                let rate = f64::from(row.state.deformation_rate_m_s);
                assert_eq!(row.normal_force_n, law.force_n(drawn[1].into(), rate, drawn[3].into()));
            }
            assert_eq!(limits.limited, limited);
            let [floored, bare] = limits.unlimited_force_n.unwrap();
            assert!(limits.force_n.high() < floored.high() && floored.high() <= bare.high());
            assert!(limits.force_n.high() <= f64::from(set.features.normal_force_n.high));
            assert_eq!(limits.force_n.low(), floored.low());
        }
    }

    #[test]
    fn bench_rows_equal_those_of_the_trainer_and_windows_end_with_their_row() {
        for kind in [RangeKind::Paper, RangeKind::Bench] {
            let set = CollisionSet::new(BearingMaterial::Plastic, kind, 2);
            let (columns, limits) = set.block(Split::Validation, 40..60, true);
            assert_eq!(columns.len(), window_names().len());
            assert_eq!(limits.unlimited_force_n.is_some(), kind == RangeKind::Paper);
            for index in 40..60 {
                let row = set.row(Split::Validation, index);
                let expected = set.features.collision(&row.state).inputs;
                for (input, value) in expected.into_iter().enumerate() {
                    let name = format!("x0_{input}");
                    let place = window_names().iter().position(|n| *n == name).unwrap();
                    assert_eq!(columns[place][index as usize - 40], value);
                }
                let drawn = crate::data::rows::draw_row(
                    BearingMaterial::Plastic,
                    kind,
                    2,
                    Purpose::ValidationRows,
                    index,
                );
                assert_eq!(row == drawn, kind == RangeKind::Bench);
            }
        }
    }
}
