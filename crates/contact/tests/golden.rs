//! The forces on which the project's other golden figures depend, to the bit: they may change only
//! on purpose.

use contact::{
    BearingMaterial, DEFAULT_LATCH_FLOOR_M_S, Dissipation, Material, NormalLaw, Stiffness,
    effective_modulus_pa, produced_restitution,
};

#[test]
fn normal_forces_keep_their_bits() {
    let effective_modulus_pa = effective_modulus_pa(&BearingMaterial::Babbitt.elastic(), &Material::STEEL);
    let radial_clearance_m = 0.5e-3;
    let hybrid = Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m };
    let liu = Stiffness::LiuTimesLength { effective_modulus_pa, radial_clearance_m, length_m: 0.14 };
    let hertz = Stiffness::Hertz { coefficient: 6.6e10 };
    for (stiffness, dissipation, force) in [
        (hybrid, Dissipation::ZhiyingQishao, 1583.8036109503569),
        (liu, Dissipation::LankaraniNikravesh, 54153.31902258786),
        (hertz, Dissipation::HuntCrossley, 10843.497452261423),
    ] {
        let law =
            NormalLaw { stiffness, dissipation, restitution: 0.4, latch_floor_m_s: DEFAULT_LATCH_FLOOR_M_S };
        assert_eq!(law.force_n(37e-6, -0.3e-3, 0.0), force, "{stiffness:?}");
    }
}

#[test]
fn friction_forces_and_the_restitution_keep_their_bits() {
    assert_eq!(BearingMaterial::Babbitt.friction_law().force_n(8067.0, 0.0123), -1478.2880081355652);
    assert_eq!(BearingMaterial::Plastic.friction_law().force_n(8067.0, -0.0323), 670.166025);
    assert_eq!(produced_restitution(Dissipation::ZhiyingQishao.factor(0.4)), 0.39883724909018914);
}
