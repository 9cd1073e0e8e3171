//! Rows of the collision set, any of them on its own.
//!
//! `paper`: the grid of Table 2 ([`super::grid`]). Place `p` of the shuffled set is point `permutation(p)` of the grid; training is
//! places 0 to 1e7, validation the next 2.5e6, test the last 2.5e6. All three share the axes' values, as in the paper, so
//! its test part judges combinations, not values in between. `bench`: row `k` of each part is what
//! [`crate::rows::row`] draws for the seed, the rows that the shipped models were trained on; there a state
//! whose force is beyond the range's is drawn anew.
//!
//! The rule for the ratio: the rate over the latched rate has no bound in Table 2, and at 0 over 0 no value. The latched
//! rate is raised to the law's floor (1 mm/s); then a rate beyond 6 times that is lowered to 6 times.
//! [`Effects`] says what this does to the force.

use super::grid::{Grid, ROWS};
use super::permutation::Permutation;
use super::split::Split;
use super::spread::Spread;
use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use crate::law::normal_law;
use crate::ranges::{RangeKind, header};
use crate::rows::{Row, row};
use crate::window::{self, Window};
use contact::NormalLaw;
use inference::features::COLLISION_INPUTS;
use inference::{Bearing, ContactState, WINDOW};
use std::ops::Range;

/// Columns of the rows.
pub const COLUMNS: [&str; 5] =
    ["radial_clearance_m", "deformation_m", "deformation_rate_m_s", "approach_speed_m_s", "normal_force_n"];

/// Names of the columns of windows: input `i` of the column `c` samples back is `x<c>_<i>`, oldest first.
pub fn window_names() -> Vec<String> {
    let inputs = (0..WINDOW).rev().flat_map(|age| (0..COLLISION_INPUTS).map(move |i| format!("x{age}_{i}")));
    inputs.chain(["target".to_owned(), "normal_force_n".to_owned()]).collect()
}

/// The columns' values of a window, in the order of [`window_names`].
pub fn window_values(window: &Window<COLLISION_INPUTS>, normal_force_n: f64) -> impl Iterator<Item = f32> {
    window.columns.into_iter().flatten().chain([window.target, normal_force_n as f32])
}

/// What the rules do to the normal force.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// Rows whose rate was lowered, or which were drawn at the limit.
    pub limited: u64,
    /// Rows whose latched rate lies below the floor.
    pub below_floor: u64,
    /// Normal force in N of the rows as they are.
    pub force_n: Spread,
    /// Normal force in N with the floor and no limit, and with neither; only where a draw can exceed the limit.
    pub without: Option<[Spread; 2]>,
}

impl Effects {
    /// Adds another part of the stream.
    pub fn join(&mut self, other: &Self) {
        self.limited += other.limited;
        self.below_floor += other.below_floor;
        self.force_n.join(&other.force_n);
        if let Some(theirs) = &other.without {
            for (spread, more) in self.without.get_or_insert_default().iter_mut().zip(theirs) {
                spread.join(more);
            }
        }
    }
}

/// The grid of Table 2, its order, and the laws of its clearances with the floor and without.
#[derive(Clone, Debug)]
struct Table2 {
    grid: Grid,
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

/// Floor in m/s that stands for none: below every rate that is drawn.
const NO_FLOOR_M_S: f64 = 1e-12;

impl CollisionSet {
    /// The set of a seed.
    pub fn new(bearing: Bearing, kind: RangeKind, seed: u64) -> Self {
        let features = FloatFeatures::of(&header(bearing, kind));
        let table = (kind == RangeKind::Paper).then(|| {
            let grid = Grid::draw(&features, seed);
            let [clearances, ..] = grid.axes();
            let floors = [f64::from(features.latch_floor_m_s), NO_FLOOR_M_S];
            let laws = (clearances.iter())
                .map(|&clearance| floors.map(|floor| normal_law(bearing, f64::from(clearance), floor)))
                .collect();
            Table2 { grid, order: Permutation::new(ROWS, seed), laws }
        });
        Self { kind, seed, features, table }
    }

    /// The formulas of the networks' inputs over the set's ranges.
    pub fn features(&self) -> &FloatFeatures {
        &self.features
    }

    /// Row `index` of a part; its sliding speed means nothing here.
    pub fn row(&self, split: Split, index: u64) -> Row {
        self.row_and_draw(split, index).0
    }

    /// A row, and the forces of its draw before the rules where there are rules to apply.
    fn row_and_draw(&self, split: Split, index: u64) -> (Row, Option<[f64; 2]>) {
        let Some(table) = &self.table else {
            let purpose = match split {
                Split::Training => Purpose::TrainingRows,
                Split::Validation => Purpose::ValidationRows,
                Split::Test => Purpose::TestRows,
            };
            return (row(self.features.bearing, self.kind, self.seed, purpose, index), None);
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
        (Row::at(&self.features, state), forces)
    }

    /// Place of a row in the shuffled whole.
    fn place(&self, split: Split, index: u64) -> u64 {
        let before = Split::ALL.into_iter().take_while(|&earlier| earlier != split);
        before.map(|earlier| earlier.rows_of(ROWS)).sum::<u64>() + index
    }

    /// The window of a row, by the rule of [`crate::window`].
    pub fn window(&self, split: Split, index: u64, row: &Row) -> Window<COLLISION_INPUTS> {
        let stream = 3 << 32 | self.place(split, index);
        window::collision(&self.features, row, &mut Draw::new(self.seed, Purpose::FixedHistories, stream))
    }

    /// A block of rows as columns, rows or windows, and its share of the effects.
    pub fn block(&self, split: Split, rows: Range<u64>, windows: bool) -> (Vec<Vec<f32>>, Effects) {
        let count = if windows { WINDOW * COLLISION_INPUTS + 2 } else { COLUMNS.len() };
        let mut columns = vec![Vec::with_capacity((rows.end - rows.start) as usize); count];
        let mut effects = Effects::default();
        for index in rows {
            let (row, before) = self.row_and_draw(split, index);
            self.note(&mut effects, &row, before);
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
        (columns, effects)
    }

    fn note(&self, effects: &mut Effects, row: &Row, before: Option<[f64; 2]>) {
        let ratio = self.features.rate_ratio_of(&row.state).abs();
        effects.limited += u64::from(ratio >= self.features.rate_ratio.high * (1.0 - f32::EPSILON));
        effects.below_floor += u64::from(row.state.approach_speed_m_s < self.features.latch_floor_m_s);
        effects.force_n.add(row.normal_force_n);
        if let Some(forces) = before {
            for (spread, force) in effects.without.get_or_insert_default().iter_mut().zip(forces) {
                spread.add(force);
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
    fn a_block_is_its_rows_and_no_row_of_the_grid_is_in_two_parts() {
        let set = CollisionSet::new(Bearing::Babbitt, RangeKind::Paper, 9);
        let (whole, _) = set.block(Split::Test, 100..300, false);
        let (part, _) = set.block(Split::Test, 250..300, false);
        for (all, some) in whole.iter().zip(&part) {
            assert_eq!(all[150..], some[..]);
        }
        let mut seen = BTreeSet::new();
        for split in Split::ALL {
            let last = split.rows_of(ROWS);
            for index in (0..2000).chain(last - 2000..last) {
                let state = set.row(split, index).state;
                // The rate may have been limited, so the place in the grid is what must be new.
                let table = set.table.as_ref().unwrap();
                assert!(seen.insert(table.order.at(set.place(split, index))), "{state:?}");
            }
        }
        assert_eq!(set.place(Split::Test, 2_499_999), ROWS - 1);
    }

    #[test]
    fn the_limit_is_the_only_change_and_the_law_gives_the_force() {
        for bearing in Bearing::ALL {
            let set = CollisionSet::new(bearing, RangeKind::Paper, 2);
            let table = set.table.as_ref().unwrap();
            let (_, effects) = set.block(Split::Training, 0..20_000, false);
            let mut limited = 0;
            for index in 0..20_000 {
                let row = set.row(Split::Training, index);
                let (clearance, drawn) = table.grid.at(table.order.at(index));
                let limit = 6.0 * drawn[3].max(1e-3);
                limited += u64::from(drawn[2] >= limit);
                assert_eq!(row.state.deformation_rate_m_s, drawn[2].min(limit));
                let law = normal_law(bearing, f64::from(table.grid.axes()[0][clearance]), f64::from(1e-3f32));
                let rate = f64::from(row.state.deformation_rate_m_s);
                assert_eq!(row.normal_force_n, law.force_n(drawn[1].into(), rate, drawn[3].into()));
            }
            assert_eq!(effects.limited, limited);
            let [floored, bare] = effects.without.unwrap();
            assert!(effects.force_n.high() < floored.high() && floored.high() <= bare.high());
            assert!(effects.force_n.high() <= f64::from(set.features().normal_force_n.high));
            assert_eq!(effects.force_n.low(), floored.low());
        }
    }

    #[test]
    fn bench_rows_are_those_of_the_trainer_and_windows_end_in_their_rows() {
        for kind in [RangeKind::Paper, RangeKind::Bench] {
            let set = CollisionSet::new(Bearing::Plastic, kind, 2);
            let (columns, effects) = set.block(Split::Validation, 40..60, true);
            assert_eq!(columns.len(), window_names().len());
            assert_eq!(effects.without.is_some(), kind == RangeKind::Paper);
            for index in 40..60 {
                let row = set.row(Split::Validation, index);
                let expected = set.features().collision(&row.state).inputs;
                for (input, value) in expected.into_iter().enumerate() {
                    let name = format!("x0_{input}");
                    let place = window_names().iter().position(|n| *n == name).unwrap();
                    assert_eq!(columns[place][index as usize - 40], value);
                }
                let drawn = crate::rows::row(Bearing::Plastic, kind, 2, Purpose::ValidationRows, index);
                assert_eq!(row == drawn, kind == RangeKind::Bench);
            }
        }
    }
}
