//! Effects between the drive cylinder and the fork.

use super::{EffectKind, EffectParameter};
use crate::description::Bench;

/// The oil column between cylinder and fork gives way.
pub(super) const HYDRAULIC_COMPLIANCE: EffectKind = EffectKind {
    name: "hydraulic-compliance",
    summary: "The hydraulic column between drive cylinder and fork is compliant.",
    per_channel: false,
    parameters: |bench| match bench {
        // A column stiffer than the least value moves the fork by less than the sensors resolve, and would only
        // make the equations stiff.
        Bench::Transmission(_) => {
            &[EffectParameter { name: "compliance_m_n", unit: "m/N", scale: 5e-9, least: 0.0, most: 1e-6 }]
        }
        Bench::FrictionRig(_) => &[],
    },
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.extension.hydraulic_compliance_m_n += parameter("compliance_m_n");
        }
    },
};

/// The fork follows the cylinder late.
pub(super) const DRIVE_LAG: EffectKind = EffectKind {
    name: "drive-lag",
    summary: "The fork follows the drive cylinder late.",
    per_channel: false,
    parameters: |bench| match bench {
        Bench::Transmission(_) => {
            &[EffectParameter { name: "lag_s", unit: "s", scale: 1e-4, least: -0.05, most: 0.2 }]
        }
        Bench::FrictionRig(_) => &[],
    },
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.extension.drive_lag_s += parameter("lag_s");
        }
    },
};
