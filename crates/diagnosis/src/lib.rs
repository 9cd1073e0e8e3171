//! From the residual of a measured log to a named cause, an extended bench and its gain.
//!
//! [`diagnose`] simulates the logs with the bench's description, calibrates what the description declares uncertain
//! (with its stated standard deviations as priors), asks every effect of [`bench::effects::CATALOGUE`] how much of the
//! remaining residual it explains, refits the likely ones together with the uncertain parameters, and decides:
//!
//! * `none`: no effect passes the threshold, and no structure repeats in the residual;
//! * `named`: one or two effects pass it, lower the error on samples that were not fitted, and have no equivalent;
//! * `ambiguous`: as `named`, but another effect fits as well on these logs; `next_experiment` tells them apart;
//! * `unknown`: structure repeats in the residual, and no effect explains most of it.
//!
//! The steps, one file each: `check` (logs read as found: what cannot be right is named and mended or left out), `session` (logs prepared, samples split into fitted and held out), `nuisance` (what is a session's own), `noise` (level and
//! correlation of the sensors' noise), `model`, `parameter` and `fit` (parameters, least squares with priors), `guess` and `spectrum` (first guesses of
//! shapes), `repeats` (what repeats from cycle to cycle), `rank` (score test and refits), `search` (starts far from an effect's absence), `contend` (who is refitted, and how far), `select` (forward selection), `shape` (whether a cause fits everywhere), `leftover` (structure in the last residual), `gain` (held-out error),
//! `experiment` and `menu` (what to measure next), `probability` (shares of all answers), `spread` (intervals), `identifiability` (what the logs do not tell), `again` (what a second question may add), `standing` (which causes count), `verdict` (the rules), `digits` (numbers in words).
//!
//! What this does not protect from: a cause outside the catalogue that a catalogued one imitates on the given
//! trajectory; inputs (drive, load) that are themselves measured wrongly; a declared uncertainty that is too wide.
#![forbid(unsafe_code)]

mod again;
mod answer;
mod calibration;
mod check;
mod contend;
mod cycles;
mod digits;
mod experiment;
mod fit;
mod gain;
mod guess;
mod identifiability;
mod leftover;
mod linear;
mod menu;
mod model;
mod noise;
mod nuisance;
mod parameter;
mod places;
mod probability;
mod rank;
mod repeats;
mod result;
mod search;
mod select;
mod session;
mod shape;
mod spectrum;
mod spread;
mod standing;
mod step;
mod structure;
mod verdict;

pub use calibration::{Calibrated, SessionNuisance};
pub use check::{Finding, Severity};
pub use digits::four_digits;
pub use places::{Place, PlaceBin};
pub use result::{
    Ambiguous, Cause, Diagnosis, Experiment, Gain, Hypothesis, Identifiability, Member, Noise,
    ParameterEstimate, Ranked, Recording, Refused, Separation, Series, Signature, Verdict,
};
pub use verdict::{DiagnosisError, Options, Progress, diagnose};
