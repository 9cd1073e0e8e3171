//! Verdicts on the paper's fifteen claims from the figures of runs: `holds`, `assumed`, `partly`,
//! `does not hold`.
//!
//! No verdict is fixed in advance: [`gather`] collects numbers from runs as [`facts`], and
//! `bearing`, `load`, `joint`, `frequency` and [`model_quant::report::claims`] (12 to 15) compare
//! them with thresholds that every claim states in its own words ([`Claim::threshold`]). The
//! thresholds:
//!
//! 1. at both sign changes and all clearances the oscillation is 2 times that before it; partly: at
//!    one of them.
//! 2. the oscillation doubles from the smallest to the largest clearance, no step falling by over
//!    1 %; partly: it doubles.
//! 3. at all clearances the peak along Y is 2 times that along Z; partly: it is larger.
//! 4. the coefficient changes by 10 % over the sliding speed and follows the bench's law within
//!    5 %; partly: one of the two.
//! 5. claims 1 to 3 come out the same for plastic and its peak force is smaller at all clearances;
//!    partly: one of the two.
//! 6. the force's frequency is 5 % higher for plastic at all clearances; partly: at some.
//! 7. the peak torques differ by a factor of 1.5 at all clearances; partly: at some.
//! 8. the peak force rises with positive load and is proportional within 10 %; partly: it rises.
//! 9. the peak force falls and then rises with negative load, both bearings; partly: one bearing.
//! 10. at all sizes of load, peak force and torque are larger for +; partly: at some, or one of the
//!     two.
//! 11. the slider-crank's peak acceleration is 3 to 100 times the ideal one, and the bench's as
//!     well; partly: one of the two.
//! 12. on the rig Babbitt's torque falls 5 % at every load, further at higher load; partly: it
//!     falls.
//! 13. on the rig plastic's torque is level within 2 % at low speed and 5 % higher at the end;
//!     partly: at some loads.
//! 14. on the rig Babbitt's torque is larger at every load and speed; partly: at some.
//! 15. over 200 epochs or more MSE 1e-3, MAE 2e-2 of the target's rms, validation MSE at most 1.25
//!     of the training's; partly: the errors are small.
//!
//! A claim about a measurement (4, 12 to 14) is compared with the friction law that replaces the
//! paper's unpublished measurements. Its best verdict is therefore `assumed`. Claims 12 to 14 are
//! also evaluated on the shipped networks ([`facts::Facts::networks`]).
//!
//! The paper ran one cycle from rest. [`judged`] adds the verdicts of settled operation, and
//! [`super::campaign`] the share of a parameter box in which a claim holds.

mod bearing;
pub mod cycles;
pub mod facts;
mod frequency;
pub mod gather;
mod joint;
pub mod judged;
mod load;

pub use model_quant::report::claims::{Claim, Verdict};

use facts::{Facts, MotionFacts};
use model_quant::report::claims::{friction, list, list_to, training};

/// Judges claims 1 to 11, which are about the motion of the bench.
pub(crate) fn evaluate_motion(motion: &MotionFacts) -> Vec<Claim> {
    let mut claims = bearing::evaluate(motion);
    claims.extend(load::evaluate(motion));
    claims.push(joint::evaluate(&motion.joint));
    claims
}

/// Judges all claims.
pub fn evaluate(facts: &Facts) -> Vec<Claim> {
    let mut claims = evaluate_motion(&facts.motion);
    claims.extend(friction::assess(&facts.friction));
    claims.push(training::assess(&facts.training));
    claims
}
