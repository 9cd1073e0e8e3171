//! Play in the drive that the description lacks.
//!
//! Drive of a mechanism with backlash: its play increases. Transmission bench: play between fork
//! and crank pin.
//!
//! The fork pushes only beyond half the play `b` on either side: `P = k e (1 + h e')`, `e = |x_d -
//! x_f| - b/2`, never negative (a unilateral spring as in `transmission::fork`). Without a `[fork]`
//! section `k` = 1e10 N/m, which is almost rigid (1 um at 10 kN), so that the bench becomes the
//! nominal one as `b` goes to 0. Parameter: `backlash_m`, 0 to 5 mm, prior 0.1 mm. In a log: the
//! shaft's angle leads or trails the drive by half the play. It changes sides with a knock where
//! the fork's force changes its sign. Under a load that prevents a change of sides only a constant
//! offset remains. Confounded with pre-sliding and a drive lag if it changes sides, with a
//! compliant column, and otherwise with an offset of the angle's sensor.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::{Part, Plant};
use crate::signals::Channel;

const PLAY: &[EffectParameter] = &[EffectParameter::size("backlash_m", "m", 2e-5, [0.0, 5e-3], 1e-4)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "fork-backlash",
    summary: "There is more play in the drive than described, as between fork and crank pin.",
    shows_in: Some(Channel::ShaftAngle),
    confounded_with: &["drive-lag", "hydraulic-compliance", "presliding-hysteresis", "sensor-offset"],
    actions: &[
        Action {
            plants: &[Plant::Planar],
            parameters: PLAY,
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.backlash_m += parameter("backlash_m")
            }),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: PLAY,
            apply: Apply::Mechanism(Part::Backlash, |bench, drive, parameter| {
                if let Some(play_m) = bench.joint_mut(drive).and_then(|joint| joint.backlash_m.as_mut()) {
                    *play_m += parameter("backlash_m");
                }
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
