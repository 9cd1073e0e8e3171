//! The same laws in `f32` agree with `f64` to single precision.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use contact::{
    BearingMaterial, Dahl, Damping, Dissipation, FactorisedLaw, FrictionKind, FrictionLaw, Joint, LuGre,
    Material, Real, SlidingLaw, SlidingParameters, StiffnessKind, StiffnessParameters,
};
use proptest::prelude::*;

fn parameters<T: Real>() -> StiffnessParameters<T> {
    let of = T::from_f64;
    let joint = Joint {
        bearing_radius_m: of(0.07),
        radial_clearance_m: of(0.5e-3),
        length_m: of(0.14),
        bearing: Material { youngs_modulus_pa: of(50e9), poisson_ratio: of(0.3) },
        journal: Material { youngs_modulus_pa: of(206e9), poisson_ratio: of(0.3) },
    };
    StiffnessParameters { joint, coefficient: Some(of(1e9)), exponent: Some(of(1.2)) }
}

fn normal_force<T: Real>(kind: StiffnessKind, dissipation: Dissipation, d: f64, rate: f64, e: f64) -> f64 {
    let of = T::from_f64;
    let damping = Damping::Latched { floor_m_s: of(1e-3) };
    let stiffness = kind.build(&parameters()).unwrap();
    let law = FactorisedLaw::new(stiffness, dissipation, of(e), damping).unwrap();
    law.force_n(of(d), of(rate), of(0.1)).to_f64()
}

fn friction_force<T: Real>(kind: FrictionKind, v: f64) -> f64 {
    let of = T::from_f64;
    let parameters = SlidingParameters {
        coulomb_coefficient: of(0.15),
        static_coefficient: of(0.25),
        still_speed_m_s: of(1e-4),
        full_speed_m_s: of(1e-3),
        stribeck_speed_m_s: of(0.01),
        viscous_slope_s_m: of(0.1),
        viscous_damping_n_s_m: of(250.0),
        transition_force_n: of(100.0),
    };
    SlidingLaw::new(kind, parameters).unwrap().force_n(of(1000.0), of(v)).to_f64()
}

fn bristle_forces<T: Real>(v: f64) -> [f64; 2] {
    let of = T::from_f64;
    let law = LuGre {
        coulomb_coefficient: of(0.15),
        static_coefficient: of(0.25),
        stribeck_speed_m_s: of(0.01),
        stiffness_per_m: of(1e5),
        damping_s_m: of(30.0),
        viscous_slope_s_m: of(0.5),
    };
    let dahl = Dahl::new(of(0.2), of(1e5), T::ONE).unwrap();
    let mut states = (T::ZERO, T::ZERO);
    for _ in 0..20 {
        states.0 = law.advanced_m(states.0, of(v), of(1e-4));
        states.1 = dahl.advanced_m(states.1, of(v), of(1e-4)).unwrap();
    }
    [law.force_n(of(100.0), states.0, of(v)).to_f64(), dahl.force_n(of(100.0), states.1).to_f64()]
}

proptest! {
    #[test]
    fn normal_laws_agree(d in 1e-7..1e-4_f64, q in -0.5..1.0_f64, e in 0.3..0.99_f64) {
        for kind in StiffnessKind::ALL {
            for dissipation in Dissipation::ALL {
                let double = normal_force::<f64>(kind, dissipation, d, 0.1 * q, e);
                let single = normal_force::<f32>(kind, dissipation, d, 0.1 * q, e);
                let scale = normal_force::<f64>(kind, Dissipation::None, d, 0.0, e);
                prop_assert!((single - double).abs() < 2e-5 * scale, "{:?} {:?}", kind, dissipation);
            }
        }
    }

    #[test]
    fn friction_laws_agree(v in 1e-5..0.1_f64) {
        let is_tested = |kind: &FrictionKind| {
            !kind.has_state() && (!kind.sticks() || *kind == FrictionKind::Coulomb)
        };
        for kind in FrictionKind::ALL.into_iter().filter(is_tested) {
            let (single, double) = (friction_force::<f32>(kind, v), friction_force::<f64>(kind, v));
            prop_assert!((single - double).abs() < 1e-5 * 250.0, "{:?}: {} {}", kind, single, double);
        }
        for (single, double) in bristle_forces::<f32>(v).into_iter().zip(bristle_forces::<f64>(v)) {
            prop_assert!((single - double).abs() < 1e-4 * 25.0, "{} {}", single, double);
        }
    }
}

#[test]
fn the_bench_law_is_available_in_single_precision() {
    let double = BearingMaterial::Babbitt.friction_law();
    let single = FrictionLaw { coulomb_coefficient: 0.14_f32, ..FrictionLaw::coulomb(0.14, 1e-3) };
    assert!((f64::from(single.force_n(100.0, 0.05)) + 14.0).abs() < 1e-5);
    assert!(double.force_n(100.0, 0.5) < -13.9);
}
