//! Data sets at the paper's scale, as files: never wholly in memory, the same bytes on any number of threads.
//!
//! [`collision`] is Table 2 of the paper, or the ranges of the bench, row by row; [`stream`] makes the rows in blocks and
//! [`sink`] writes them. [`bench_runs`] takes rows from recorded runs instead. [`friction`] is the friction set, from the rig's groups
//! or from measured logs.

pub mod bench_runs;
pub mod clean;
pub mod collision;
pub mod friction;
pub mod friction_source;
pub mod grid;
pub mod permutation;
pub mod picture;
pub mod sink;
pub mod split;
pub mod spread;
pub mod stream;
