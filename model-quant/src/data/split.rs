//! Division of a set into training, validation and test.

use crate::data::draw::{Draw, Purpose};
use serde::Serialize;

/// Part of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// Rows that a network is fitted to.
    Training,
    /// Rows that decide when to stop.
    Validation,
    /// Rows that measure the result.
    Test,
}

impl Split {
    /// All three, in the order of their rows.
    pub(crate) const ALL: [Self; 3] = [Self::Training, Self::Validation, Self::Test];

    /// Name in files and messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Training => "training",
            Self::Validation => "validation",
            Self::Test => "test",
        }
    }

    /// Number of rows of this part in a set of `rows`: two thirds, a sixth, a sixth, as in Table 2.
    /// The test part takes the remainder.
    pub(crate) fn row_count(self, rows: u64) -> u64 {
        let (training, validation) = (rows * 2 / 3, rows / 6);
        match self {
            Self::Training => training,
            Self::Validation => validation,
            Self::Test => rows - training - validation,
        }
    }
}

/// Assigns groups to the parts at random: a fifth, rounded, to validation and to test each, the
/// others to training.
pub(crate) fn split_groups(groups: usize, seed: u64) -> Vec<Split> {
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
    fn table_2_is_split_as_printed_and_every_row_is_used() {
        assert_eq!(Split::ALL.map(|split| split.row_count(15_000_000)), [10_000_000, 2_500_000, 2_500_000]);
        for rows in 0..100 {
            assert_eq!(Split::ALL.iter().map(|split| split.row_count(rows)).sum::<u64>(), rows);
        }
    }

    #[test]
    fn groups_are_split_by_fifths_and_the_seed_decides_which() {
        let count = |splits: &[Split], split| splits.iter().filter(|&&s| s == split).count();
        for (groups, parts) in
            [(20, [12, 4, 4]), (24, [14, 5, 5]), (5, [3, 1, 1]), (3, [1, 1, 1]), (2, [2, 0, 0])]
        {
            let splits = split_groups(groups, 1);
            assert_eq!(Split::ALL.map(|split| count(&splits, split)), parts, "{groups}");
        }
        assert_eq!(split_groups(20, 1), split_groups(20, 1));
        assert_ne!(split_groups(20, 1), split_groups(20, 2));
        // Every group is in the test part for about a fifth of the seeds.
        let tests = (0..1000).filter(|&seed| split_groups(20, seed)[7] == Split::Test).count();
        assert!((150..250).contains(&tests), "{tests}");
    }
}
