//! There is play between the drive of an axis and its friction.
//!
//! The rubbing part moves only while the drive pushes it at one end of the play `b` (a play
//! operator: `plants::friction_rig::coupling`). Its friction is absent in between; inertia, load
//! and springs stay at the drive. Parameter: `play` in m at the friction radius, the whole width
//! from 0 to 1 m, with a prior of a tenth of half the stroke. In a log: after each reversal the
//! friction is 0 until the motion has crossed the play, then returns at once. Confounded with
//! pre-sliding and an elastic coupling (which also delay friction by a distance), and with a delay
//! of the drive or of the effort's sensor at one speed.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Guess, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "drive-play",
    summary: "There is play between the drive and the friction.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["breakaway", "drive-lag", "elastic-coupling", "presliding-hysteresis", "sensor-delay"],
    guess: Guess::Defaults,
    actions: &[Action {
        plants: Plant::AXES,
        // Friction that returns at once has a derivative only over a step that some samples cross.
        parameters: &[EffectParameter::size("play", "m", 5e-3, [0.0, 1.0], 0.1).in_log(Measure::Distance)],
        apply: Apply::Coupling(|rig, parameter| rig.axis.play += parameter("play")),
    }],
};
