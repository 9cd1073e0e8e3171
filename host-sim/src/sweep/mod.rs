//! A sweep: one bench, with some parameters varied over a grid or drawn at random, one run per
//! point.
//!
//! [`specification`] is the file that describes it, [`points`] its benches, [`journal`] stores
//! finished runs, [`work`] runs on all cores, [`table`] is the result. Every point is drawn from
//! its own stream of the seed, and every run depends on its point alone. The result is therefore
//! the same bytes in any order, on any number of threads and after a resume. Wall times are written
//! to the journal and to a separate file.

pub(crate) mod file;
mod journal;
pub(crate) mod latch;
pub(crate) mod options;
pub(crate) mod owner;
mod points;
mod specification;
pub(crate) mod step;
pub(crate) mod table;
mod work;
