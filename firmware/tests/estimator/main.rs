//! The estimator from outside: sensor frames of known orbits in, forces held against the laws of `contact`.

mod accuracy;
mod anything;
mod cycle;
mod flags;
mod orbit;
