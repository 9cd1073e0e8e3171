//! Contact and friction laws of a transmission bench, built from its description.

use crate::description::{ContactSection, FrictionMemory, FrictionSection, ShapeName, TransmissionBench};
use crate::plants::stick_slip::StickingLaw;
use contact::{
    CompleteLawParameters, ContactLaw, Dahl, FactorisedLaw, FrictionKind, FrictionLaw, Joint, LawError,
    LuGre, Material, NormalLaw, SlidingLaw, SlidingParameters, Stiffness, StiffnessKind, StiffnessParameters,
    StribeckShape, effective_modulus_pa,
};

/// Normal law of a joint, with its elastic part, which the energy balance needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointLaw {
    pub(crate) law: ContactLaw,
    pub(crate) elastic: Stiffness,
}

impl JointLaw {
    /// Builds the law that a description names, for the bearing on a steel shaft.
    pub(crate) fn from_bench(bench: &TransmissionBench) -> Result<Self, LawError> {
        let joint = Joint {
            bearing_radius_m: bench.bearing.bearing_radius_m,
            radial_clearance_m: bench.bearing.radial_clearance_m,
            length_m: bench.bearing.length_m,
            bearing: Material {
                youngs_modulus_pa: bench.bearing.youngs_modulus_pa,
                poisson_ratio: bench.bearing.poisson_ratio,
            },
            journal: Material::STEEL,
        };
        Self::from_section(&bench.contact, joint, bench.bearing.restitution, bench.shaft.mass_kg)
    }

    /// Builds the law that a section names, for a joint with a nominal restitution and an effective
    /// mass in kg, which only the law of Anagnostopoulos needs.
    pub(crate) fn from_section(
        section: &ContactSection,
        joint: Joint,
        restitution: f64,
        mass_kg: f64,
    ) -> Result<Self, LawError> {
        let Some(complete) = section.law else {
            let parameters =
                StiffnessParameters { joint, coefficient: section.coefficient, exponent: section.exponent };
            let elastic = section.stiffness.0.build(&parameters)?;
            let dissipation = section.dissipation.0;
            let law = if section.damping.is_latched() {
                let latch_floor_m_s = section.latch_floor_m_s;
                NormalLaw::new(elastic, dissipation, restitution, latch_floor_m_s)?.into()
            } else {
                let damping = section.damping.damping(section.latch_floor_m_s);
                ContactLaw::Factorised(FactorisedLaw::new(elastic, dissipation, restitution, damping)?)
            };
            return Ok(Self { law, elastic });
        };
        let missing = LawError::Missing { law: complete.0.entry().name, quantity: "a coefficient" };
        let law = complete.0.build(&CompleteLawParameters {
            coefficient: section.coefficient.ok_or(missing)?,
            exponent: section.exponent,
            damping_n_s_m: section.damping_n_s_m,
            full_damping_depth_m: section.full_damping_depth_m,
            restitution: Some(restitution),
            effective_mass_kg: Some(mass_kg),
        })?;
        Ok(Self { law, elastic: law.elastic() })
    }

    /// Builds the law of a description that was checked and then changed by an effect or a fit,
    /// perhaps beyond the law's range. For a factorised law with a latch only the parameters of its
    /// formula are required. Any other law outside its range gets an elastic part of NaN, and the
    /// run ends with a state that is not finite.
    pub(crate) fn after_changes(bench: &TransmissionBench) -> Self {
        Self::from_bench(bench).unwrap_or_else(|_| {
            let bearing = Material {
                youngs_modulus_pa: bench.bearing.youngs_modulus_pa,
                poisson_ratio: bench.bearing.poisson_ratio,
            };
            let effective_modulus_pa = effective_modulus_pa(&bearing, &Material::STEEL);
            let radial_clearance_m = bench.bearing.radial_clearance_m;
            let length_m = bench.bearing.length_m;
            let elastic = match bench.contact.stiffness.0 {
                _ if bench.contact.law.is_some() => Stiffness::Linear { coefficient: f64::NAN },
                StiffnessKind::HybridAsPrinted => {
                    Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m }
                }
                StiffnessKind::LiuTimesLength => {
                    Stiffness::LiuTimesLength { effective_modulus_pa, radial_clearance_m, length_m }
                }
                _ => Stiffness::Linear { coefficient: f64::NAN },
            };
            let law = NormalLaw {
                stiffness: elastic,
                dissipation: bench.contact.dissipation.0,
                restitution: bench.bearing.restitution,
                latch_floor_m_s: bench.contact.latch_floor_m_s,
            };
            Self { law: law.into(), elastic }
        })
    }
}

/// Friction law of a bearing.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BearingFriction {
    /// A function of the sliding speed.
    Sliding(SlidingLaw),
    /// Bristles with one deflection.
    Dahl(Dahl, f64),
    /// Bristles with one deflection.
    LuGre(LuGre),
    /// Sliding and sticking are separate.
    Sticking(StickingLaw),
}

impl BearingFriction {
    /// Builds the law that a section names; Stribeck's without a name. A law with its own memory
    /// also needs that section.
    pub(crate) fn from_section(
        section: &FrictionSection,
        memory: Option<&FrictionMemory>,
    ) -> Result<Self, LawError> {
        let Some(name) = section.law else {
            return Ok(Self::Sliding(SlidingLaw::Stribeck(stribeck(section))));
        };
        Ok(match name.0 {
            FrictionKind::Dahl => {
                let stiffness = bristle_stiffness(section, name.0)?;
                let law = Dahl::new(section.coulomb_coefficient, stiffness, 1.0)?;
                Self::Dahl(law, section.coulomb_coefficient / stiffness)
            }
            FrictionKind::LuGre => {
                let law = LuGre {
                    coulomb_coefficient: section.coulomb_coefficient,
                    static_coefficient: section.static_coefficient,
                    stribeck_speed_m_s: section.stribeck_speed_m_s,
                    stiffness_per_m: bristle_stiffness(section, name.0)?,
                    damping_s_m: section.bristle_damping_s_m,
                    viscous_slope_s_m: section.viscous_slope_s_m,
                };
                law.check()?;
                Self::LuGre(law)
            }
            kind if kind.sticks() => Self::Sticking(StickingLaw::from_section(kind, section, memory)?),
            kind => Self::Sliding(SlidingLaw::new(kind, sliding_parameters(section))?),
        })
    }

    /// Builds the law of a bench, as [`Self::from_section`].
    pub(crate) fn from_bench(bench: &TransmissionBench) -> Result<Self, LawError> {
        Self::from_section(&bench.friction, bench.friction_memory.as_ref())
    }

    /// Builds the law of a section that was checked and then changed; Stribeck's if it is out of
    /// its range.
    pub(crate) fn after_changes(section: &FrictionSection) -> Self {
        Self::from_section(section, None).unwrap_or(Self::Sliding(SlidingLaw::Stribeck(stribeck(section))))
    }

    /// Builds the law of a bench as [`Self::after_changes`].
    pub(crate) fn of_changed_bench(bench: &TransmissionBench) -> Self {
        Self::from_bench(bench).unwrap_or_else(|_| Self::after_changes(&bench.friction))
    }

    /// Returns whether the law has a deflection.
    pub(crate) fn has_state(&self) -> bool {
        match self {
            Self::Sliding(_) => false,
            Self::Dahl(..) | Self::LuGre(_) => true,
            Self::Sticking(law) => !law.is_rigid(),
        }
    }

    /// The law, if sliding and sticking are separate.
    pub(crate) fn sticking(&self) -> Option<&StickingLaw> {
        match self {
            Self::Sticking(law) => Some(law),
            _ => None,
        }
    }

    /// Friction force in N along the sliding direction.
    pub(crate) fn force_n(&self, normal_n: f64, sliding_m_s: f64, deflection_m: f64) -> f64 {
        match self {
            Self::Sliding(law) => law.force_n(normal_n, sliding_m_s),
            Self::Dahl(law, _) => law.force_n(normal_n, deflection_m),
            Self::LuGre(law) => law.force_n(normal_n, deflection_m, sliding_m_s),
            Self::Sticking(law) => law.steady_n(normal_n, sliding_m_s),
        }
    }

    /// Rate of the deflection in m/s.
    pub(crate) fn rate_m_s(&self, sliding_m_s: f64, deflection_m: f64) -> f64 {
        match self {
            Self::Sliding(_) | Self::Sticking(_) => 0.0,
            Self::Dahl(law, _) => law.rate_m_s(deflection_m, sliding_m_s),
            Self::LuGre(law) => law.rate_m_s(deflection_m, sliding_m_s),
        }
    }

    /// Deflection of steady sliding, for a contact whose history is unknown.
    pub(crate) fn steady_deflection_m(&self, sliding_m_s: f64) -> f64 {
        match self {
            Self::Sliding(_) | Self::Sticking(_) => 0.0,
            Self::Dahl(_, deflection) => deflection * sliding_m_s.signum(),
            Self::LuGre(law) => {
                law.steady_coefficient(sliding_m_s) / law.stiffness_per_m * sliding_m_s.signum()
            }
        }
    }
}

/// Parameters of the laws without memory.
pub(crate) fn sliding_parameters(section: &FrictionSection) -> SlidingParameters {
    SlidingParameters {
        coulomb_coefficient: section.coulomb_coefficient,
        static_coefficient: section.static_coefficient,
        still_speed_m_s: section.still_speed_m_s,
        full_speed_m_s: section.regularisation_m_s,
        stribeck_speed_m_s: section.stribeck_speed_m_s,
        viscous_slope_s_m: section.viscous_slope_s_m,
        viscous_damping_n_s_m: section.viscous_damping_n_s_m,
        transition_force_n: section.transition_force_n,
    }
}

/// Stiffness of the bristles of a law that needs it.
pub(crate) fn bristle_stiffness(section: &FrictionSection, kind: FrictionKind) -> Result<f64, LawError> {
    let missing = LawError::Missing { law: kind.entry().name, quantity: "bristle_stiffness_per_m" };
    section.bristle_stiffness_per_m.ok_or(missing)
}

fn stribeck(f: &FrictionSection) -> FrictionLaw {
    FrictionLaw {
        coulomb_coefficient: f.coulomb_coefficient,
        static_coefficient: f.static_coefficient,
        stribeck_speed_m_s: f.stribeck_speed_m_s,
        shape: match f.shape {
            ShapeName::Tustin => StribeckShape::Tustin,
            ShapeName::Gauss => StribeckShape::Gauss,
        },
        viscous_slope_s_m: f.viscous_slope_s_m,
        viscous_onset_m_s: f.viscous_onset_m_s,
        regularisation_m_s: f.regularisation_m_s,
    }
}

impl TransmissionBench {
    /// Stribeck's law with the description's parameters, without its level: the friction of the
    /// bench unless the description names another law.
    pub fn friction_law(&self) -> FrictionLaw {
        stribeck(&self.friction)
    }
}
