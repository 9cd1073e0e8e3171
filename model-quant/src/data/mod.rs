//! Contact states, forces and data sets.
//!
//! [`ranges`] defines the training ranges. [`rows`] draws states and labels them with the forces of
//! the laws in the crate `contact`. [`features`] turns a state into an input column, [`window`] a
//! row into a window of columns with its target.
//!
//! [`collision`] is the collision set: Table 2 of the paper ([`parameter_grid`]) or the ranges of
//! the bench, row by row. [`bench_runs`] takes rows from simulated runs instead. [`friction`] is
//! the friction set, from the rig's groups or from measured logs. [`stream`] generates rows in
//! blocks and [`sink`] writes them, so that a set is never completely in memory and has the same
//! bytes on any number of threads.

pub(crate) mod bench_runs;
pub(crate) mod clean;
pub(crate) mod cleaning_chart;
pub mod collision;
pub(crate) mod csv;
pub mod draw;
pub mod features;
pub(crate) mod file_io;
pub mod friction;
pub mod friction_source;
pub(crate) mod histogram;
pub(crate) mod parameter_grid;
pub(crate) mod permutation;
pub mod ranges;
pub mod rows;
pub mod sink;
pub mod split;
pub(crate) mod static_deformation;
pub(crate) mod statistics;
pub(crate) mod stream;
pub mod window;
