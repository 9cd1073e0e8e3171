//! Accuracy of float networks and images against the laws: on test rows, on held-out bench runs,
//! and compared with other runtimes.

pub mod bench_loop;
pub(crate) mod errors;
pub(crate) mod goals;
pub mod held_out;
pub mod layers;
pub mod limits;
pub mod peers;
mod results_format;
pub mod rig;
pub mod test_set;
pub mod verdict;
pub mod verify;
