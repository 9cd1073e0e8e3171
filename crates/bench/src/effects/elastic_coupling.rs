//! The coupling between the drive of an axis and its friction is elastic.
//!
//! The drive deflects the coupling by `c F` before the friction `F` slips, and releases it after
//! each reversal (`plants::friction_rig::coupling`). Inertia, load and springs stay at the drive.
//! Parameter: `compliance` in m/N or rad/(N m), 0 to 1e6, with a prior of a tenth of half the
//! stroke over the log's rms effort. In a log: after each reversal the effort changes in proportion
//! to the motion, with slope `1/c`, until the friction is reached. Confounded with pre-sliding and
//! play (which also delay friction by a distance), and with a delay of the drive or of the effort's
//! sensor at one speed.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Guess, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "elastic-coupling",
    summary: "The coupling between the drive and the friction is elastic.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["breakaway", "drive-lag", "presliding-hysteresis", "sensor-delay"],
    guess: Guess::Defaults,
    actions: &[Action {
        plants: Plant::AXES,
        parameters: &[EffectParameter::size("compliance", "m/N or rad/(N m)", 1e-3, [0.0, 1e6], 0.1)
            .in_log(Measure::Compliance)],
        apply: Apply::Coupling(|rig, parameter| rig.axis.coupling_compliance += parameter("compliance")),
    }],
};
