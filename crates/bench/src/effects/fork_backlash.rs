//! Play between fork and crank pin.
//!
//! The fork pushes only beyond half the play `b` on either side: `P = k e (1 + h e')`, `e = |x_d - x_f| - b/2`, never pulling
//! back (a unilateral spring as in `transmission::fork`). Without a `[fork]` section `k` = 1e10 N/m, near enough to rigid (1 um at
//! 10 kN) for the bench to be the nominal one as `b` goes to 0. Parameter: `backlash_m`, 0 to 5 mm, prior 0.1 mm.
//! In a log: the shaft's angle leads or trails the drive by half the play and changes sides where the fork's force changes
//! its sign, with a knock. A load that never lets it change sides leaves a constant offset only.
//! Confounded with pre-sliding and a drive lag where it changes sides, with a compliant column, and with an offset of
//! the angle's sensor where it does not.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "fork-backlash",
    summary: "There is play between fork and crank pin.",
    per_channel: false,
    plants: &[Plant::Planar],
    transmission: &[EffectParameter::size("backlash_m", "m", 2e-5, [0.0, 5e-3], 1e-4)],
    axis: &[],
    shows_in: Some(Channel::ShaftAngle),
    confounded_with: &["drive-lag", "hydraulic-compliance", "presliding-hysteresis", "sensor-offset"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.extension.backlash_m += parameter("backlash_m");
        }
    },
};
