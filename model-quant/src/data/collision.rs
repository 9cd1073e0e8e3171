//! The collision set: random access to any of its rows.
//!
//! Range `paper`: the grid of Table 2 ([`super::parameter_grid`]). Row `p` of the shuffled set is
//! point `permutation(p)` of the grid. Training has the first two thirds of the rows, validation
//! the next sixth, test the last. All three share the values of the axes, as in the paper, so the
//! test part measures new combinations and not values in between. No row occurs twice.
//!
//! Range `bench`: row `k` of each part is the one that [`crate::data::rows::draw_row`] draws for
//! the seed. The shipped models were trained on the first 2^18 of these rows, which
//! `train::sources` draws directly; this type serves `dataset collision` and `--set full`. A state
//! whose force exceeds the range is drawn again.
//!
//! Limit of the ratio: Table 2 sets no bound to the rate over the approach speed. The approach
//! speed is first raised to the law's floor (1 mm/s); a rate beyond 6 times that speed is then
//! lowered to 6 times, and points that become equal are one row. The grid as printed has neither
//! floor nor limit: 1.5e7 rows with forces far beyond the networks' range.

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

/// Number of rows at the limit and below the floor, and the normal forces.
#[derive(Clone, Debug, Default)]
pub struct LimitStatistics {
    /// Rows whose ratio of rate to approach speed is at the limit or beyond it.
    pub limited: u64,
    /// Rows whose approach speed lies below the floor.
    pub below_floor: u64,
    /// Normal force in N of the rows as written.
    pub force_n: Histogram,
}

impl LimitStatistics {
    /// Adds the statistics of another block of rows.
    pub(crate) fn join(&mut self, other: &Self) {
        self.limited += other.limited;
        self.below_floor += other.below_floor;
        self.force_n.join(&other.force_n);
    }
}

/// Grid of Table 2 and the order of its rows.
#[derive(Clone, Debug)]
struct Table2 {
    grid: ParameterGrid,
    order: Permutation,
    /// Laws of the clearances without floor, for the grid as printed; empty for the limited grid.
    printed_laws: Vec<NormalLaw>,
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
            let grid = ParameterGrid::draw(&features, seed).limited(&features);
            Table2 { order: Permutation::new(grid.points(), seed), grid, printed_laws: Vec::new() }
        });
        Self { kind, seed, features, table }
    }

    /// Creates Table 2 as printed for a seed: without floor of the approach speed and limit of the
    /// ratio.
    pub(crate) fn as_printed(bearing: BearingMaterial, seed: u64) -> Self {
        let features = FloatFeatures::from_header(&header(bearing, RangeKind::Paper));
        let grid = ParameterGrid::draw(&features, seed);
        let [clearances, ..] = grid.axes();
        let law = |&clearance: &f32| bearing.normal_law(f64::from(clearance), NO_FLOOR_M_S);
        let printed_laws = clearances.iter().map(law).collect();
        let table = Some(Table2 { order: Permutation::new(grid.points(), seed), grid, printed_laws });
        Self { kind: RangeKind::Paper, seed, features, table }
    }

    /// Number of rows of all parts.
    pub(crate) fn rows(&self) -> u64 {
        self.table.as_ref().map_or(ROWS, |table| table.grid.points())
    }

    /// Row `index` of a part; its sliding speed is always 0 with range `paper`.
    pub(crate) fn row(&self, split: Split, index: u64) -> Row {
        let Some(table) = &self.table else {
            let purpose = match split {
                Split::Training => Purpose::TrainingRows,
                Split::Validation => Purpose::ValidationRows,
                Split::Test => Purpose::TestRows,
            };
            return draw_row(self.features.bearing, self.kind, self.seed, purpose, index);
        };
        let (clearance_index, values) = table.grid.at(table.order.at(self.place(split, index)));
        let [radial_clearance_m, deformation_m, deformation_rate_m_s, approach_speed_m_s] = values;
        let state = ContactState {
            radial_clearance_m,
            deformation_m,
            deformation_rate_m_s,
            approach_speed_m_s,
            sliding_speed_m_s: 0.0,
        };
        let Some(law) = table.printed_laws.get(clearance_index) else {
            return Row::label(&self.features, state);
        };
        let normal_force_n =
            law.force_n(deformation_m.into(), deformation_rate_m_s.into(), approach_speed_m_s.into());
        Row { state, normal_force_n, friction_force_n: 0.0 }
    }

    /// Position of a row in the complete shuffled set.
    fn place(&self, split: Split, index: u64) -> u64 {
        let before = Split::ALL.into_iter().take_while(|&earlier| earlier != split);
        before.map(|earlier| earlier.row_count(self.rows())).sum::<u64>() + index
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
            let row = self.row(split, index);
            self.count(&mut limits, &row);
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

    fn count(&self, limits: &mut LimitStatistics, row: &Row) {
        let ratio = self.features.unclamped_rate_ratio(&row.state).abs();
        limits.limited += u64::from(ratio >= self.features.rate_ratio.high * (1.0 - f32::EPSILON));
        limits.below_floor += u64::from(row.state.approach_speed_m_s < self.features.latch_floor_m_s);
        limits.force_n.add(row.normal_force_n);
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
    fn blocks_agree_with_single_rows() {
        let set = CollisionSet::new(BearingMaterial::Babbitt, RangeKind::Paper, 9);
        let (complete, _) = set.block(Split::Test, 100..300, false);
        let (part, _) = set.block(Split::Test, 250..300, false);
        for (all, some) in complete.iter().zip(&part) {
            assert_eq!(all[150..], some[..]);
        }
        assert_eq!(set.place(Split::Test, Split::Test.row_count(set.rows()) - 1), set.rows() - 1);
        assert_eq!(CollisionSet::as_printed(BearingMaterial::Babbitt, 9).rows(), ROWS);
    }

    #[test]
    fn no_row_occurs_twice_within_or_across_the_parts() {
        let printed = CollisionSet::as_printed(BearingMaterial::Babbitt, 9);
        for set in [CollisionSet::new(BearingMaterial::Babbitt, RangeKind::Paper, 9), printed] {
            let mut seen = BTreeSet::new();
            for split in Split::ALL {
                for index in 0..split.row_count(set.rows()) / 10 {
                    let s = set.row(split, index).state;
                    let values =
                        [s.radial_clearance_m, s.deformation_m, s.deformation_rate_m_s, s.approach_speed_m_s];
                    assert!(seen.insert(values.map(f32::to_bits)), "{split:?} {index}: {s:?}");
                }
            }
            assert!(seen.len() > 1_200_000);
        }
    }

    #[test]
    fn rows_as_printed_have_the_force_of_the_formula_without_floor_and_limit() {
        let (bearing, set) =
            (BearingMaterial::Babbitt, CollisionSet::as_printed(BearingMaterial::Babbitt, 2));
        let mut beyond = 0;
        for index in 0..20_000 {
            let row = set.row(Split::Test, index);
            let [d, rate, approach] =
                [row.state.deformation_m, row.state.deformation_rate_m_s, row.state.approach_speed_m_s]
                    .map(f64::from);
            let law = bearing.normal_law(f64::from(row.state.radial_clearance_m), 1.0);
            let factor = law.dissipation.factor(law.restitution);
            let expected = law.stiffness.force_n(d) * (1.0 + factor * rate / approach);
            assert!((row.normal_force_n / expected - 1.0).abs() < 1e-12, "{row:?}");
            beyond += u32::from(rate > 6.0 * approach);
        }
        assert!((2400..3200).contains(&beyond), "14.1 % of the points: {beyond}");
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
            assert!(limits.force_n.high() <= f64::from(set.features.normal_force_n.high));
        }
    }

    #[test]
    fn bench_rows_equal_those_of_the_trainer_and_windows_end_with_their_row() {
        for kind in [RangeKind::Paper, RangeKind::Bench] {
            let set = CollisionSet::new(BearingMaterial::Plastic, kind, 2);
            let (columns, _) = set.block(Split::Validation, 40..60, true);
            assert_eq!(columns.len(), window_names().len());
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
