//! The two bounds of a number of cycles.

/// End of a range of documented timings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bound {
    /// The fastest case.
    Lower,
    /// The slowest case.
    Upper,
}

impl Bound {
    pub(super) const ALL: [Self; 2] = [Self::Lower, Self::Upper];

    pub(super) const fn pick(self, lower: u64, upper: u64) -> u64 {
        match self {
            Self::Lower => lower,
            Self::Upper => upper,
        }
    }
}
