//! A drawn effect, whose magnitude is still free.

use super::hidden::HiddenEffect;

/// A drawn effect without its magnitude.
#[derive(Clone, Debug)]
pub struct Drawn {
    pub(super) effect: HiddenEffect,
    /// Names of the parameters that are proportional to the magnitude, with their factors.
    pub(super) sizes: Vec<(&'static str, f64)>,
    /// First guess of a visible magnitude.
    pub guess: f64,
    /// Maximum magnitude.
    pub most: f64,
}

impl Drawn {
    /// Returns the effect at a magnitude.
    pub fn at(&self, magnitude: f64) -> HiddenEffect {
        let mut effect = self.effect.clone();
        for (name, share) in &self.sizes {
            effect.parameters.insert((*name).into(), share * magnitude);
        }
        effect
    }
}

/// Factors of the size parameters, first guess and maximum of the magnitude, shapes.
pub(super) type Draw = (Vec<(&'static str, f64)>, f64, f64, Vec<(&'static str, f64)>);
