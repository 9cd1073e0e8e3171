//! The paper's fifteen claims, each judged from the figures of runs: `holds`, `partly`, `does not hold`.
//!
//! Nothing here is decided beforehand: [`gather`] collects numbers from runs as [`facts`], and `bearing`, `load`,
//! `joint`, `frequency` and [`model_quant::claims`] (12 to 15) compare them with thresholds that every claim states in its own words
//! ([`Claim::threshold`]). The thresholds:
//!
//! | claim | holds if | partly if |
//! |---|---|---|
//! | 1 | at both sign changes and all clearances the oscillation is 2 times that before it | at one of them |
//! | 2 | the oscillation doubles from the smallest to the largest clearance, no step falling by over 1 % | it doubles |
//! | 3 | at all clearances the peak along Y is 2 times that along Z | it is larger |
//! | 4 | the coefficient changes by 10 % over the sliding speed and follows the bench's law within 5 % | one of the two |
//! | 5 | claims 1 to 3 come out the same for plastic and its peak force is smaller at all clearances | one of the two |
//! | 6 | the force's frequency is 5 % higher for plastic at all clearances | at some |
//! | 7 | the peak torques differ by a factor of 1.5 at all clearances | at some |
//! | 8 | the peak force rises with positive load and is proportional within 10 % | it rises |
//! | 9 | the peak force falls and then rises with negative load, both bearings | one bearing |
//! | 10 | at all sizes of load, peak force and torque are larger for + | at some, or one of the two |
//! | 11 | the slider-crank's peak acceleration is 3 to 100 times the ideal one, and the bench's as well | one of the two |
//! | 12 | on the rig Babbitt's torque falls 5 % at every load, further at higher load | it falls |
//! | 13 | on the rig plastic's torque is level within 2 % at low speed and 5 % higher at the end | at some loads |
//! | 14 | on the rig Babbitt's torque is larger at every load and speed | at some |
//! | 15 | over 200 epochs or more MSE 1e-3, MAE 2e-2 of the target's rms, validation MSE at most 1.25 of the training's | the errors are small |
//!
//! Limits: a claim about a measurement (4, 12 to 14) is judged on the friction that stands in for the paper's unpublished
//! measurements, and says so.

mod bearing;
pub mod facts;
mod frequency;
pub mod gather;
mod joint;
mod load;

pub use model_quant::claims::{Claim, Verdict};

use facts::Facts;
use model_quant::claims::{friction, list, list_to, training};

/// Judges all claims.
pub fn judge(facts: &Facts) -> Vec<Claim> {
    let mut claims = bearing::judge(facts);
    claims.extend(load::judge(facts));
    claims.push(joint::judge(&facts.joint));
    claims.extend(friction::judge(&facts.friction));
    claims.push(training::judge(&facts.training));
    claims
}
