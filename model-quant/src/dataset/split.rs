//! Training, validation and test: which part of a set is which.

use crate::draw::{Draw, Purpose};
use serde::Serialize;

/// One of the three parts of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// What a network is fitted to.
    Training,
    /// What decides when to stop.
    Validation,
    /// What it is judged by.
    Test,
}

impl Split {
    /// All three, in the order of their rows.
    pub const ALL: [Self; 3] = [Self::Training, Self::Validation, Self::Test];

    /// The name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Training => "training",
            Self::Validation => "validation",
            Self::Test => "test",
        }
    }

    /// Rows of this part in a set of `rows`: two thirds, a sixth, a sixth, as in Table 2; the test part takes what
    /// rounding leaves.
    pub fn rows_of(self, rows: u64) -> u64 {
        let (training, validation) = (rows * 2 / 3, rows / 6);
        match self {
            Self::Training => training,
            Self::Validation => validation,
            Self::Test => rows - training - validation,
        }
    }
}

/// Deals groups at random to the parts: a fifth, rounded, to validation and to test each, the rest to training.
pub fn deal(groups: usize, seed: u64) -> Vec<Split> {
    let mut order: Vec<usize> = (0..groups).collect();
    let mut draw = Draw::new(seed, Purpose::DatasetSplit, groups as u64);
    for last in (1..groups).rev() {
        order.swap(last, draw.below(last + 1));
    }
    let part = (groups + 2) / 5;
    let mut splits = vec![Split::Training; groups];
    for (place, group) in order.into_iter().enumerate() {
        let split = match place / part.max(1) {
            0 => Split::Validation,
            1 => Split::Test,
            _ => Split::Training,
        };
        if let Some(slot) = splits.get_mut(group).filter(|_| part > 0) {
            *slot = split;
        }
    }
    splits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_two_is_split_as_printed_and_nothing_is_lost() {
        assert_eq!(Split::ALL.map(|split| split.rows_of(15_000_000)), [10_000_000, 2_500_000, 2_500_000]);
        for rows in 0..100 {
            assert_eq!(Split::ALL.iter().map(|split| split.rows_of(rows)).sum::<u64>(), rows);
        }
    }

    #[test]
    fn twenty_groups_become_twelve_four_and_four_and_a_seed_decides_which() {
        let count = |splits: &[Split], split| splits.iter().filter(|&&s| s == split).count();
        for (groups, parts) in
            [(20, [12, 4, 4]), (24, [14, 5, 5]), (5, [3, 1, 1]), (3, [1, 1, 1]), (2, [2, 0, 0])]
        {
            let splits = deal(groups, 1);
            assert_eq!(Split::ALL.map(|split| count(&splits, split)), parts, "{groups}");
        }
        assert_eq!(deal(20, 1), deal(20, 1));
        assert_ne!(deal(20, 1), deal(20, 2));
        // Every group is in the test part for about a fifth of the seeds.
        let tests = (0..1000).filter(|&seed| deal(20, seed)[7] == Split::Test).count();
        assert!((150..250).contains(&tests), "{tests}");
    }
}
