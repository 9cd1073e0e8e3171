//! Changes of a transmission bench's description: parameters by name, another bearing, another clearance.

use super::{BearingMaterial, LoadFriction, ShapeName, TransmissionBench};
use contact::{FrictionLaw, Material, StribeckShape};

impl LoadFriction {
    /// Force on the load crank's pin along +Y in N at the pin's speed.
    pub(crate) fn force_n(&self, rate_m_s: f64) -> f64 {
        -self.coulomb_n * (rate_m_s / self.regularisation_m_s).tanh() - self.viscous_n_s_m * rate_m_s
    }
}

impl TransmissionBench {
    pub(crate) fn parameter_mut(&mut self, name: &str) -> Option<&mut f64> {
        Some(match name {
            "geometry.drive_lever_radius_m" => &mut self.geometry.drive_lever_radius_m,
            "geometry.load_lever_radius_m" => &mut self.geometry.load_lever_radius_m,
            "shaft.mass_kg" => &mut self.shaft.mass_kg,
            "shaft.inertia_kg_m2" => &mut self.shaft.inertia_kg_m2,
            "bearing.radial_clearance_m" => &mut self.bearing.radial_clearance_m,
            "bearing.youngs_modulus_pa" => &mut self.bearing.youngs_modulus_pa,
            "bearing.restitution" => &mut self.bearing.restitution,
            "contact.latch_floor_m_s" => &mut self.contact.latch_floor_m_s,
            "friction.level" => &mut self.friction.level,
            "load.force_n" => &mut self.load.force_n,
            _ => return None,
        })
    }

    /// Replaces bearing material and friction by those of a trained bearing; clearance and geometry stay.
    pub fn set_material(&mut self, material: BearingMaterial) {
        let (solid, restitution, friction) = match material {
            BearingMaterial::Babbitt => (Material::BABBITT, 0.4, FrictionLaw::BABBITT_BENCH),
            BearingMaterial::Plastic => (Material::PLASTIC, 0.8, FrictionLaw::PLASTIC_BENCH),
        };
        let old_modulus = self.bearing.youngs_modulus_pa;
        self.bearing.material = material;
        self.bearing.youngs_modulus_pa = solid.youngs_modulus_pa;
        self.bearing.poisson_ratio = solid.poisson_ratio;
        self.bearing.restitution = restitution;
        self.friction.coulomb_coefficient = friction.coulomb_coefficient;
        self.friction.static_coefficient = friction.static_coefficient;
        self.friction.stribeck_speed_m_s = friction.stribeck_speed_m_s;
        self.friction.shape = match friction.shape {
            StribeckShape::Tustin => ShapeName::Tustin,
            StribeckShape::Gauss => ShapeName::Gauss,
        };
        self.friction.viscous_slope_s_m = friction.viscous_slope_s_m;
        self.friction.viscous_onset_m_s = friction.viscous_onset_m_s;
        self.friction.regularisation_m_s = friction.regularisation_m_s;
        // The modulus is as uncertain, relatively, as it was.
        if let Some(deviation) = self.uncertain.get_mut("bearing.youngs_modulus_pa") {
            *deviation *= solid.youngs_modulus_pa / old_modulus;
        }
    }

    /// Changes the clearance; it stays as uncertain, relatively, as it was.
    pub fn set_radial_clearance(&mut self, radial_clearance_m: f64) {
        if let Some(deviation) = self.uncertain.get_mut("bearing.radial_clearance_m") {
            *deviation *= radial_clearance_m / self.bearing.radial_clearance_m;
        }
        self.bearing.radial_clearance_m = radial_clearance_m;
    }
}
