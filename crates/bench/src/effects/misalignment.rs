//! The bearing's axis is not parallel to the machine's.
//!
//! The slices of the bearing at `s` along its length are shifted by `(slope_y_rad s, slope_z_rad
//! s)`; the equations are in `two_plane`. Parameters: `slope_y_rad`, `slope_z_rad`, within 0.05
//! rad, prior 0.5 mrad each. Only the bench in two planes has a tilt; the planar bench cannot show
//! the effect. A shaft without further supports follows its bearing: without
//! `support_stiffness_nm_rad` the slope leaves no trace in the log. In a log: journal and bearing
//! force as with a smaller clearance and a softer contact, by the square of the slope, if the load
//! passes the middle of the bearing. If drive and load act in the bearing's middle, a slope and its
//! negative give the same log. Offset cranks tilt the shaft and distinguish the two. Confounded
//! with clearance and contact stiffness.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "misalignment",
    summary: "The bearing's axis is not parallel to the machine's.",
    shows_in: Some(Channel::JournalY),
    confounded_with: &["clearance-wear", "contact-stiffness", "sensor-offset"],
    actions: &[Action {
        plants: &[Plant::TwoPlane],
        parameters: &[
            EffectParameter::size("slope_y_rad", "rad", 1e-4, [-0.05, 0.05], 5e-4),
            EffectParameter::size("slope_z_rad", "rad", 1e-4, [-0.05, 0.05], 5e-4),
        ],
        apply: Apply::Transmission(|bench, parameter| {
            if let Some(section) = &mut bench.two_plane {
                section.misalignment_y_rad += parameter("slope_y_rad");
                section.misalignment_z_rad += parameter("slope_z_rad");
            }
        }),
    }],
    ..EffectKind::DEFAULT
};
