//! Effects of dry and viscous friction, on the bearing of the transmission bench or on a driven axis.

use super::{EffectKind, EffectParameter};
use crate::description::Bench;

const RELATIVE: &[EffectParameter] =
    &[EffectParameter { name: "relative_change", unit: "1", scale: 0.02, least: -0.95, most: 5.0 }];
const EFFORT: &[EffectParameter] =
    &[EffectParameter { name: "coulomb_effort", unit: "N or N m", scale: 0.1, least: -1e9, most: 1e9 }];

/// The level of dry friction.
pub(super) const COULOMB_LEVEL: EffectKind = EffectKind {
    name: "coulomb-level",
    summary: "Dry friction has another level than described.",
    per_channel: false,
    parameters: |bench| match bench {
        Bench::Transmission(_) => RELATIVE,
        Bench::FrictionRig(_) => EFFORT,
    },
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.friction.level *= 1.0 + parameter("relative_change"),
        Bench::FrictionRig(rig) => rig.axis.coulomb_effort += parameter("coulomb_effort"),
    },
};

/// Friction that grows with speed.
pub(super) const VISCOUS: EffectKind = EffectKind {
    name: "viscous-friction",
    summary: "A friction force proportional to speed is missing.",
    per_channel: false,
    parameters: |bench| match bench {
        Bench::Transmission(_) => {
            &[EffectParameter { name: "viscous_n_s_m", unit: "N s/m", scale: 100.0, least: -1e6, most: 1e6 }]
        }
        Bench::FrictionRig(_) => &[EffectParameter {
            name: "viscous_effort",
            unit: "N s/m or N m s/rad",
            scale: 1.0,
            least: -1e9,
            most: 1e9,
        }],
    },
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.extension.viscous_n_s_m += parameter("viscous_n_s_m"),
        Bench::FrictionRig(rig) => rig.axis.viscous_effort += parameter("viscous_effort"),
    },
};

/// Dry friction that differs between the directions.
pub(super) const COULOMB_ASYMMETRY: EffectKind = EffectKind {
    name: "coulomb-asymmetry",
    summary: "Dry friction differs between the two directions.",
    per_channel: false,
    parameters: |bench| match bench {
        Bench::Transmission(_) => {
            &[EffectParameter { name: "asymmetry", unit: "1", scale: 0.02, least: -1.0, most: 1.0 }]
        }
        Bench::FrictionRig(_) => &[EffectParameter {
            name: "asymmetry_effort",
            unit: "N or N m",
            scale: 0.1,
            least: -1e9,
            most: 1e9,
        }],
    },
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.extension.coulomb_asymmetry += parameter("asymmetry"),
        Bench::FrictionRig(rig) => rig.axis.coulomb_asymmetry += parameter("asymmetry_effort"),
    },
};

/// Dry friction that grows with the load of an axis.
pub(super) const LOAD_DEPENDENT: EffectKind = EffectKind {
    name: "load-dependent-friction",
    summary: "Dry friction grows with the load by a coefficient that the description lacks.",
    per_channel: false,
    parameters: |bench| match bench {
        Bench::Transmission(_) => &[],
        Bench::FrictionRig(_) => {
            &[EffectParameter { name: "load_coefficient", unit: "1", scale: 0.002, least: -5.0, most: 5.0 }]
        }
    },
    apply: |bench, _, parameter| {
        if let Bench::FrictionRig(rig) = bench {
            rig.axis.load_coefficient += parameter("load_coefficient");
        }
    },
};
