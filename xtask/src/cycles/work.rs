//! Works that are traced.

/// Work that is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Work {
    /// Tick in lockstep over a cycle of bench B, from the sample to its frame.
    Tick,
    /// The same over disturbed samples.
    DisturbedTick,
    /// Handler of the timer's interrupt with own samples.
    Handler,
    /// Reference network over a complete window.
    ReferenceWindow,
    /// Reference network for each new column.
    ReferenceStream,
    /// Sample of the Kalman filter.
    Filter,
    /// Sample of the Kalman filter with a measured drive force.
    FilterDriveForce,
    /// Another image.
    Image,
}

impl Work {
    /// Works of the project.
    pub(super) const ALL: [Self; 7] = [
        Self::Tick,
        Self::DisturbedTick,
        Self::Handler,
        Self::ReferenceWindow,
        Self::ReferenceStream,
        Self::Filter,
        Self::FilterDriveForce,
    ];

    /// Works of the counting image with the interval of the inputs that are priced. The networks
    /// execute the same instructions for every input; the filter does not.
    pub(super) const COUNTING: [(Self, usize); 4] = [
        (Self::ReferenceWindow, 500),
        (Self::ReferenceStream, 50),
        (Self::Filter, 1),
        (Self::FilterDriveForce, 1),
    ];

    /// Name in the JSON and, for works of the counting image, in its output.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Tick => "tick",
            Self::DisturbedTick => "troubled_tick",
            Self::Handler => "handler",
            Self::ReferenceWindow => "reference_window",
            Self::ReferenceStream => "reference_stream",
            Self::Filter => "filter",
            Self::FilterDriveForce => "filter_drive_force",
            Self::Image => "image",
        }
    }
}
