//! Static friction grows with the time of rest and is lost by sliding.
//!
//! `m' = (1 - m)/t_r - |v| m/d`, the ageing law of rate-and-state friction (Dieterich 1979, Ruina 1983) with its state between 0
//! and 1. Bearing: dry friction times `1 + excess m` (`excess`, -0.9 to 5, prior 0.3); axis: an effort `excess m` more
//! (`excess_effort` in N or N m, within 1e9, prior 1e3). Shapes: `rest_time_s` 1e-3 to 1e3, 0.5 unless given;
//! `distance_m` 1e-6 to 0.1, 2e-4 unless given; the prior of both is a factor of 10. What stands at the start has rested for long, what moves has
//! the age that this speed leaves.
//! In a log: a peak of friction after each rest or reversal, lost over the distance.
//! Confounded with Stribeck's fall (which peaks before a reversal too) and, where nothing rests, with pre-sliding.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::{Bench, BreakawayTerm};

const REST: EffectParameter = EffectParameter::magnitude("rest_time_s", "s", 0.5, [1e-3, 1e3], 10.0);
const DISTANCE: EffectParameter = EffectParameter::magnitude("distance_m", "m", 2e-4, [1e-6, 0.1], 10.0);

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "breakaway",
    summary: "Static friction grows with the time of rest and is lost by sliding.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::Rotary, Plant::Linear],
    transmission: &[EffectParameter::size("excess", "1", 0.05, [-0.9, 5.0], 0.3), REST, DISTANCE],
    axis: &[EffectParameter::size("excess_effort", "N or N m", 0.1, [-1e9, 1e9], 1e3), REST, DISTANCE],
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["coulomb-level", "presliding-hysteresis", "stribeck-friction"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        let term = |excess: &str| BreakawayTerm {
            excess: parameter(excess),
            rest_time_s: parameter("rest_time_s"),
            distance_m: parameter("distance_m"),
        };
        match bench {
            Bench::Transmission(bench) => bench.extension.breakaway = Some(term("excess")),
            Bench::FrictionRig(rig) => rig.extension.breakaway = Some(term("excess_effort")),
        }
    },
};
