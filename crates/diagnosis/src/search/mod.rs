//! Search for the effects that explain a residual: score tests, initial guesses, refits and forward
//! selection of causes.

pub(crate) mod contender;
mod initial_guess;
pub(crate) mod marginality;
pub(crate) mod parts;
mod periodogram;
mod plausibility;
mod refinement;
pub(crate) mod score;
pub(crate) mod selection;
mod size_search;
pub(crate) mod stage;
pub(crate) mod threshold;
pub(crate) mod tuning;
