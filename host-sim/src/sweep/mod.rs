//! A sweep: one bench, some of its parameters varied over a grid or drawn at random, one run a point.
//!
//! [`specification`] is the file that describes it, [`points`] what it comes to, [`journal`] what keeps finished runs
//! over a kill, [`work`] does the runs on all cores, [`table`] is the outcome. Every point is drawn from its own stream
//! of the seed and every run depends on its point alone, so the outcome is the same bytes in any order, on any number of
//! threads and after a resume. Wall times stay in the journal and in a file of their own.

pub mod journal;
pub mod points;
pub mod specification;
pub mod table;
pub mod work;
