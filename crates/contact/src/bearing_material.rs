//! Bearing materials: the one table of everything that the project knows about a material.
//!
//! To add a material, add a variant, its place in [`BearingMaterial::ALL`], its row in `properties`
//! and its name in [`embed_for_each_material`](crate::embed_for_each_material).

use crate::dissipation::Dissipation;
use crate::friction::FrictionLaw;
use crate::material::{Material, effective_modulus_pa};
use crate::normal::NormalLaw;
use crate::stiffness::Stiffness;

/// Material of a clearance bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum BearingMaterial {
    /// Babbitt alloy.
    Babbitt,
    /// Engineering plastic alloy.
    Plastic,
}

/// Dry friction on the friction rig: its dependence on pressure and slow sliding, in addition to
/// [`BearingMaterial::friction_law`]. The formula is in `bench::plants::friction_rig`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigFriction {
    /// Exponent of (mean pressure / 5 MPa) that multiplies the Coulomb coefficient.
    pub pressure_exponent: f64,
    /// Rise of the coefficient at the onset of sliding under 100 kN.
    pub stribeck_rise: f64,
    /// Sliding speed in m/s over which the rise decays to 1/e.
    pub stribeck_speed_m_s: f64,
    /// Relative growth of the rise with every 100 kN of load.
    pub rise_growth: f64,
    /// Slope of the coefficient over the speed within the rig's speed range, s/m.
    pub slow_slope_s_m: f64,
    /// Sliding speed in m/s where that slope begins.
    pub slow_onset_m_s: f64,
}

/// Wear and expansion of a bearing's lining.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lining {
    /// Worn volume per normal force and sliding distance against the steel shaft, m3/(N m).
    pub specific_wear_rate_m3_nm: f64,
    /// Linear thermal expansion, 1/K.
    pub expansion_per_k: f64,
}

/// Largest deformations and forces of a bearing: the limits of the training of its networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoadLimits {
    /// Deformation in um under the loads of the transmission bench, up to 40 kN.
    pub bench_deformation_um: u32,
    /// Deformation in um under the loads of the friction rig, up to 300 kN.
    pub rig_deformation_um: u32,
    /// Force in N at a deformation of 100 um and a rate of 1 m/s (Table 2 of the paper).
    pub paper_force_n: u32,
}

/// Calls a macro with the name of every material and gives an array in the order of
/// [`BearingMaterial::ALL`]. The macro embeds the material's files, whose names must be literals.
#[macro_export]
macro_rules! embed_for_each_material {
    ($embed:ident) => {
        [$embed!("babbitt"), $embed!("plastic")]
    };
}

/// Row of the table.
struct Properties {
    name: &'static str,
    title: &'static str,
    elastic: Material,
    restitution: f64,
    damping_per_mille: u32,
    friction: FrictionLaw,
    rig_friction: RigFriction,
    lining: Lining,
    limits: LoadLimits,
}

impl BearingMaterial {
    /// Every material, in the order of the codes.
    pub const ALL: [Self; 2] = [Self::Babbitt, Self::Plastic];

    /// Number of materials.
    pub const COUNT: usize = Self::ALL.len();

    const fn properties(self) -> Properties {
        match self {
            Self::Babbitt => Properties {
                name: "babbitt",
                title: "Babbitt",
                // Table 2 of the paper.
                elastic: Material { youngs_modulus_pa: 50e9, poisson_ratio: 0.3 },
                restitution: 0.4,
                damping_per_mille: 2_092,
                friction: FrictionLaw {
                    static_coefficient: 0.22,
                    stribeck_speed_m_s: 0.02,
                    ..FrictionLaw::coulomb(0.14, 1e-3)
                },
                rig_friction: RigFriction {
                    stribeck_rise: 0.08,
                    stribeck_speed_m_s: 0.010,
                    rise_growth: 0.15,
                    ..RigFriction::CONSTANT
                },
                // No published rate of this pair was found. Archard's coefficient of dry metals
                // that hardly dissolve in each other is about 1.5e-5 (Rabinowicz, Lubrication
                // Engineering 37, 1981), over a hardness of 250 MPa. Expansion: tin-based white
                // metal.
                lining: Lining { specific_wear_rate_m3_nm: 6e-14, expansion_per_k: 23e-6 },
                limits: LoadLimits {
                    bench_deformation_um: 80,
                    rig_deformation_um: 420,
                    paper_force_n: 1_000_000,
                },
            },
            Self::Plastic => Properties {
                name: "plastic",
                title: "plastic",
                // Table 2 of the paper.
                elastic: Material { youngs_modulus_pa: 2.5e9, poisson_ratio: 0.4 },
                restitution: 0.8,
                damping_per_mille: 403,
                friction: FrictionLaw {
                    viscous_slope_s_m: 0.25,
                    viscous_onset_m_s: 0.02,
                    ..FrictionLaw::coulomb(0.08, 1e-3)
                },
                rig_friction: RigFriction {
                    pressure_exponent: -0.15,
                    slow_slope_s_m: 6.0,
                    slow_onset_m_s: 0.0035,
                    ..RigFriction::CONSTANT
                },
                // Orkot TLM Marine at 10 MPa and 1 m/min in water (Trelleborg, Better than Bronze,
                // 2021). Expansion: fabric-reinforced thermoset, across its layers.
                lining: Lining { specific_wear_rate_m3_nm: 6.184e-15, expansion_per_k: 90e-6 },
                limits: LoadLimits {
                    bench_deformation_um: 260,
                    rig_deformation_um: 2_100,
                    paper_force_n: 20_000,
                },
            },
        }
    }

    /// Name in descriptions, file names and on the command line, in kebab case.
    pub const fn name(self) -> &'static str {
        self.properties().name
    }

    /// Name within a sentence.
    pub const fn title(self) -> &'static str {
        self.properties().title
    }

    /// Returns the material of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|material| material.name() == name)
    }

    /// Code in model images and frames: the place in [`Self::ALL`].
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Returns the material of a code.
    pub const fn from_code(code: u8) -> Option<Self> {
        let mut remaining: &[Self] = &Self::ALL;
        while let Some((material, others)) = remaining.split_first() {
            if material.code() == code {
                return Some(*material);
            }
            remaining = others;
        }
        None
    }

    /// Elastic properties.
    pub const fn elastic(self) -> Material {
        self.properties().elastic
    }

    /// Effective modulus in Pa of a bearing of this material with the steel shaft.
    pub fn effective_modulus_pa(self) -> f64 {
        effective_modulus_pa(&self.elastic(), &Material::STEEL)
    }

    /// Coefficient of restitution against the steel shaft, 0 to 1.
    pub const fn restitution(self) -> f64 {
        self.properties().restitution
    }

    /// Dissipation factor of Zhiying and Qishao at [`Self::restitution`], in thousandths, for
    /// integer arithmetic.
    pub const fn damping_per_mille(self) -> u32 {
        self.properties().damping_per_mille
    }

    /// Dry friction against the steel shaft on the transmission bench.
    pub const fn friction_law(self) -> FrictionLaw {
        self.properties().friction
    }

    /// Dry friction on the friction rig.
    pub const fn rig_friction(self) -> RigFriction {
        self.properties().rig_friction
    }

    /// Wear and expansion of the lining.
    pub const fn lining(self) -> Lining {
        self.properties().lining
    }

    /// Largest deformations and forces.
    pub const fn load_limits(self) -> LoadLimits {
        self.properties().limits
    }

    /// Normal law of the bench and of the shipped networks: the hybrid stiffness as printed with
    /// the dissipation factor of Zhiying and Qishao.
    pub fn normal_law(self, radial_clearance_m: f64, latch_floor_m_s: f64) -> NormalLaw {
        NormalLaw {
            stiffness: Stiffness::HybridAsPrinted {
                effective_modulus_pa: self.effective_modulus_pa(),
                radial_clearance_m,
            },
            dissipation: Dissipation::ZhiyingQishao,
            restitution: self.restitution(),
            latch_floor_m_s,
        }
    }
}

impl RigFriction {
    /// A coefficient that depends on neither pressure nor slow sliding.
    const CONSTANT: Self = Self {
        pressure_exponent: 0.0,
        stribeck_rise: 0.0,
        stribeck_speed_m_s: 1.0,
        rise_growth: 0.0,
        slow_slope_s_m: 0.0,
        slow_onset_m_s: 0.0,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_places_and_codes_and_names_round_trip() {
        for (place, material) in BearingMaterial::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(material.code()), place);
            assert_eq!(BearingMaterial::from_code(material.code()), Some(material));
            assert_eq!(BearingMaterial::from_name(material.name()), Some(material));
        }
        assert_eq!(BearingMaterial::from_code(BearingMaterial::COUNT as u8), None);
        assert_eq!(BearingMaterial::from_name("Babbitt"), None);
    }

    #[test]
    fn parameters_are_in_the_range_of_their_laws() {
        for material in BearingMaterial::ALL {
            let elastic = material.elastic();
            Material::new(elastic.youngs_modulus_pa, elastic.poisson_ratio).unwrap();
            material.friction_law().check().unwrap();
            let lining = material.lining();
            assert!((1e-17..1e-12).contains(&lining.specific_wear_rate_m3_nm), "{material:?}");
            assert!((1e-6..1e-3).contains(&lining.expansion_per_k), "{material:?}");
            assert!((0.0..=1.0).contains(&material.restitution()));
        }
    }

    #[test]
    fn damping_in_thousandths_is_the_factor_of_the_restitution() {
        for material in BearingMaterial::ALL {
            let factor: f64 = Dissipation::ZhiyingQishao.factor(material.restitution());
            assert_eq!(f64::from(material.damping_per_mille()), (1e3 * factor).round(), "{material:?}");
        }
    }
}
