//! Views of the logs: all samples, the fitted part, and its first cycle. Work that needs fewer
//! samples simulates a shorter view.

use super::logs::Data;

/// The logs in three extents.
pub(crate) struct Views {
    /// All samples.
    pub(crate) all: Data,
    /// Samples up to the last fitted one.
    pub(crate) fitted: Data,
    /// First cycle of the fitted samples; none if there is only one.
    pub(crate) first_cycle: Option<Data>,
}

impl Views {
    /// The views of all logs.
    pub(crate) fn new(all: Data) -> Self {
        let fitted = all.fitted_view();
        Self { first_cycle: fitted.first_cycle_view(), fitted, all }
    }
}
