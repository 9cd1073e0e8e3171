//! Changes of a transmission bench's description: bearing material, clearance and servo.

use super::{ShapeName, TransmissionBench};
use contact::{BearingMaterial, FrictionKind, StribeckShape};

impl TransmissionBench {
    /// The bench with the measured motion of the fork as its input instead of the servo.
    pub(crate) fn without_servo(&self) -> Self {
        Self { servo: None, ..self.clone() }
    }

    /// Replaces bearing material and friction by those of a trained bearing. Clearance and geometry
    /// do not change. Brown and McPhee's law keeps its own viscous part.
    pub fn set_material(&mut self, material: BearingMaterial) {
        let (elastic, friction) = (material.elastic(), material.friction_law());
        let old_modulus = self.bearing.youngs_modulus_pa;
        self.bearing.material = material;
        self.bearing.youngs_modulus_pa = elastic.youngs_modulus_pa;
        self.bearing.poisson_ratio = elastic.poisson_ratio;
        self.bearing.restitution = material.restitution();
        self.friction.coulomb_coefficient = friction.coulomb_coefficient;
        self.friction.static_coefficient = friction.static_coefficient;
        self.friction.stribeck_speed_m_s = friction.stribeck_speed_m_s;
        self.friction.shape = match friction.shape {
            StribeckShape::Tustin => ShapeName::Tustin,
            StribeckShape::Gauss => ShapeName::Gauss,
        };
        if self.friction.law.is_none_or(|law| law.0 != FrictionKind::BrownMcPhee) {
            self.friction.viscous_slope_s_m = friction.viscous_slope_s_m;
        }
        self.friction.viscous_onset_m_s = friction.viscous_onset_m_s;
        // For Karnopp's law the width is that of a band, which no material has.
        if self.friction.law.is_none_or(|law| law.0 != FrictionKind::Karnopp) {
            self.friction.regularisation_m_s = friction.regularisation_m_s;
        }
        // The relative uncertainty of the modulus does not change.
        if let Some(deviation) = self.common.uncertain.get_mut("bearing.youngs_modulus_pa") {
            *deviation *= elastic.youngs_modulus_pa / old_modulus;
        }
    }

    /// Changes the clearance. Its relative uncertainty does not change.
    pub fn set_radial_clearance(&mut self, radial_clearance_m: f64) {
        if let Some(deviation) = self.common.uncertain.get_mut("bearing.radial_clearance_m") {
            *deviation *= radial_clearance_m / self.bearing.radial_clearance_m;
        }
        self.bearing.radial_clearance_m = radial_clearance_m;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bench, PRESETS};

    #[test]
    fn a_material_replaces_the_width_of_a_law_but_not_the_band_of_karnopp() {
        for (law, expected_m_s) in [("stribeck-tustin", 1e-3), ("karnopp", 0.0075)] {
            let text = PRESETS[0].1.replace("\n[drive]", &format!("law = \"{law}\"\n\n[drive]"));
            let Bench::Transmission(mut bench) = Bench::parse("x", &text).unwrap() else { panic!("bench-b") };
            bench.friction.regularisation_m_s = 0.0075;
            bench.set_material(BearingMaterial::Babbitt);
            assert_eq!(bench.friction.regularisation_m_s, expected_m_s, "{law}");
        }
    }
}
