//! The monitor from outside: runs of the bench in, what it tracks, flags and holds out.

mod faults;
mod run;
mod tracking;
