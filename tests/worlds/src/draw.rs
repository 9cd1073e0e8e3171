//! Worlds beside the described one: each uncertain parameter off by some of its deviations.

use crate::random::Random;
use crate::world::World;

/// Standard deviations of the uncertain parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// Deviation of the radial clearance, m.
    pub clearance_m: f64,
    /// Deviation of the bearing's Young's modulus, as a share.
    pub modulus_share: f64,
    /// Deviation of the moment of inertia, as a share.
    pub inertia_share: f64,
    /// Deviation of the mass, as a share.
    pub mass_share: f64,
    /// Deviation of the level of friction, as a share.
    pub friction_share: f64,
    /// Deviation of each lever, as a share.
    pub lever_share: f64,
}

impl Deviations {
    /// Declared deviations of bench B.
    pub const BENCH_B: Self = Self {
        clearance_m: 10e-6,
        modulus_share: 0.05,
        inertia_share: 0.05,
        mass_share: 0.02,
        friction_share: 0.03,
        lever_share: 0.003,
    };
}

/// Uncertain parameter of a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Radial clearance.
    Clearance,
    /// Young's modulus of the bearing.
    Modulus,
    /// Moment of inertia of the shaft.
    Inertia,
    /// Mass of the shaft.
    Mass,
    /// Level of friction.
    Friction,
    /// Radius of the drive crank.
    DriveLever,
    /// Radius of the load crank.
    LoadLever,
}

impl Parameter {
    /// Every uncertain parameter.
    pub const ALL: [Self; 7] = [
        Self::Clearance,
        Self::Modulus,
        Self::Inertia,
        Self::Mass,
        Self::Friction,
        Self::DriveLever,
        Self::LoadLever,
    ];

    /// Stable name, in kebab case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clearance => "clearance",
            Self::Modulus => "stiffness",
            Self::Inertia => "inertia",
            Self::Mass => "mass",
            Self::Friction => "friction",
            Self::DriveLever => "drive-lever",
            Self::LoadLever => "load-lever",
        }
    }
}

/// Largest deviation of a drawn parameter, in standard deviations: beyond it a parameter is wrong,
/// not uncertain.
const MAX_DEVIATIONS: f64 = 4.0;

impl World {
    /// Returns the world with one parameter off by a number of its standard deviations.
    #[must_use]
    pub fn moved(mut self, parameter: Parameter, deviations: &Deviations, count: f64) -> Self {
        let factor = |share: f64| 1.0 + share * count;
        match parameter {
            Parameter::Clearance => self.radial_clearance_m += deviations.clearance_m * count,
            Parameter::Modulus => self.youngs_modulus_pa *= factor(deviations.modulus_share),
            Parameter::Inertia => self.inertia_kg_m2 *= factor(deviations.inertia_share),
            Parameter::Mass => self.mass_kg *= factor(deviations.mass_share),
            Parameter::Friction => {
                let (friction, factor) = (&mut self.friction, factor(deviations.friction_share));
                friction.coulomb_coefficient *= factor;
                friction.static_coefficient *= factor;
                friction.viscous_slope_s_m *= factor;
            }
            Parameter::DriveLever => self.drive_lever_m *= factor(deviations.lever_share),
            Parameter::LoadLever => self.load_lever_m *= factor(deviations.lever_share),
        }
        self
    }

    /// Draws every uncertain parameter from a normal distribution around this world's value. A
    /// parameter's draw does not depend on the others.
    #[must_use]
    pub fn draw(&self, seed: u64, deviations: &Deviations) -> Self {
        Parameter::ALL.into_iter().fold(*self, |world, parameter| {
            let mut random = Random::new(seed, parameter.name());
            let mut count = random.normal();
            while count.abs() > MAX_DEVIATIONS {
                count = random.normal();
            }
            world.moved(parameter, deviations, count)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bearing;

    /// Reads a parameter.
    type Read = fn(&World) -> f64;

    #[test]
    fn drawn_parameters_have_the_declared_mean_and_spread() {
        let declared = Deviations::BENCH_B;
        let described = World::bench_b(Bearing::Plastic, 0.5e-3, 10e3);
        let worlds: Vec<World> = (0..4000).map(|seed| described.draw(seed, &declared)).collect();
        let shares: [(Read, f64); 9] = [
            (|w| w.radial_clearance_m, declared.clearance_m / described.radial_clearance_m),
            (|w| w.youngs_modulus_pa, declared.modulus_share),
            (|w| w.inertia_kg_m2, declared.inertia_share),
            (|w| w.mass_kg, declared.mass_share),
            (|w| w.friction.coulomb_coefficient, declared.friction_share),
            (|w| w.friction.static_coefficient, declared.friction_share),
            (|w| w.friction.viscous_slope_s_m, declared.friction_share),
            (|w| w.drive_lever_m, declared.lever_share),
            (|w| w.load_lever_m, declared.lever_share),
        ];
        let off = |read: Read| worlds.iter().map(move |w| read(w) / read(&described) - 1.0);
        let count = worlds.len() as f64;
        for (index, (read, share)) in shares.into_iter().enumerate() {
            let mean = off(read).sum::<f64>() / count;
            let spread = (off(read).map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
            assert!(mean.abs() < 0.05 * share, "{index}: {mean} of {share}");
            assert!((spread / share - 1.0).abs() < 0.04, "{index}: {spread} of {share}");
        }
        // Two parameters are independent: their correlation is within its deviation, 1/sqrt n.
        let product = off(shares[2].0).zip(off(shares[3].0)).map(|(a, b)| a * b).sum::<f64>() / count;
        assert!(product.abs() < 0.05 * shares[2].1 * shares[3].1, "{product}");
    }

    #[test]
    fn a_draw_is_a_function_of_its_seed_and_leaves_everything_else_alone() {
        let described = World::bench_b(Bearing::Babbitt, 0.1e-3, -5e3);
        let draw = |seed| described.draw(seed, &Deviations::BENCH_B);
        assert_eq!(draw(5), draw(5));
        assert_ne!(draw(5), draw(6));
        let none = Deviations {
            clearance_m: 0.0,
            modulus_share: 0.0,
            inertia_share: 0.0,
            mass_share: 0.0,
            friction_share: 0.0,
            lever_share: 0.0,
        };
        assert_eq!(described.draw(5, &none), described);
        let mass = described.draw(5, &Deviations { mass_share: 0.02, ..none });
        assert_eq!(mass, World { mass_kg: draw(5).mass_kg, ..described });
    }
}
