//! The bearing's axis is not parallel to the machine's.
//!
//! The slices of the bearing at `s` along its length are shifted by `(slope_y_rad s, slope_z_rad s)`; see `two_plane` for
//! the equations. Parameters: `slope_y_rad`, `slope_z_rad`, within 0.05 rad, prior 0.5 mrad each.
//! Only the bench in two planes has a tilt. The planar bench cannot show it at all, and a shaft that nothing else
//! supports follows its bearing: without `support_stiffness_nm_rad` the slope leaves no trace in the log.
//! In a log: journal and bearing force as if the clearance were smaller and the contact softer, by the square of the slope
//! where the load passes the middle of the bearing.
//! Where drive and load act in the bearing's middle, a slope and its opposite are the same; cranks beside it tilt the shaft themselves and tell them apart.
//! Confounded with clearance and contact stiffness.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "misalignment",
    summary: "The bearing's axis is tilted against the machine's.",
    per_channel: false,
    plants: &[Plant::TwoPlane],
    transmission: &[
        EffectParameter::size("slope_y_rad", "rad", 1e-4, [-0.05, 0.05], 5e-4),
        EffectParameter::size("slope_z_rad", "rad", 1e-4, [-0.05, 0.05], 5e-4),
    ],
    axis: &[],
    shows_in: Some(Channel::JournalY),
    confounded_with: &["clearance-wear", "contact-stiffness", "sensor-offset"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench
            && let Some(section) = &mut bench.two_plane
        {
            section.misalignment_y_rad += parameter("slope_y_rad");
            section.misalignment_z_rad += parameter("slope_z_rad");
        }
    },
};
