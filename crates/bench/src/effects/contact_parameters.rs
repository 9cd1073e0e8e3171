//! Effects that move a number of the nominal transmission bench beyond its stated uncertainty.

use super::{EffectKind, EffectParameter};
use crate::description::Bench;

macro_rules! shift {
    ($constant:ident, $name:literal, $summary:literal, $parameter:literal, $unit:literal, $scale:expr, $least:expr, $most:expr,
     |$bench:ident, $value:ident| $body:expr) => {
        #[doc = $summary]
        pub(super) const $constant: EffectKind = EffectKind {
            name: $name,
            summary: $summary,
            per_channel: false,
            parameters: |bench| match bench {
                Bench::Transmission(_) => &[EffectParameter {
                    name: $parameter,
                    unit: $unit,
                    scale: $scale,
                    least: $least,
                    most: $most,
                }],
                Bench::FrictionRig(_) => &[],
            },
            apply: |bench, _, parameter| {
                if let Bench::Transmission($bench) = bench {
                    let $value = parameter($parameter);
                    $body;
                }
            },
        };
    };
}

shift!(
    CLEARANCE_WEAR,
    "clearance-wear",
    "The bearing has worn: its radial clearance is larger than described.",
    "clearance_increase_m",
    "m",
    1e-5,
    -4e-4,
    2e-3,
    |bench, value| bench.bearing.radial_clearance_m += value
);
shift!(
    CONTACT_STIFFNESS,
    "contact-stiffness",
    "The bearing's modulus differs from its description by a factor.",
    "relative_change",
    "1",
    0.02,
    -0.8,
    4.0,
    |bench, value| bench.bearing.youngs_modulus_pa *= 1.0 + value
);
shift!(
    RESTITUTION,
    "restitution",
    "The restitution of the contact differs from its description.",
    "restitution_change",
    "1",
    0.02,
    -0.35,
    0.55,
    |bench, value| bench.bearing.restitution = (bench.bearing.restitution + value).clamp(0.05, 1.0)
);
shift!(
    INERTIA_MISMATCH,
    "inertia-mismatch",
    "The shaft's moment of inertia differs from its description by a factor.",
    "relative_change",
    "1",
    0.01,
    -0.8,
    4.0,
    |bench, value| bench.shaft.inertia_kg_m2 *= 1.0 + value
);
shift!(
    LEVER_RATIO,
    "lever-ratio",
    "The load crank's radius differs from its description by a factor.",
    "relative_change",
    "1",
    0.002,
    -0.3,
    0.3,
    |bench, value| bench.geometry.load_lever_radius_m *= 1.0 + value
);
