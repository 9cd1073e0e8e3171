//! A parameter of a fit: what it moves, its scale, bounds and prior.

use crate::nuisance::Nuisance;

/// Share of its scale below which a one-sided effect counts as absent: a column that stiff would only slow the run.
const ABSENT_SHARE: f64 = 0.02;
/// Steps of finite differences in scaled units.
const NOMINAL_STEP: f64 = 0.03;
const EFFECT_STEP: f64 = 0.1;

/// Distance from a bound in scaled units that counts as on it.
pub(crate) const ON_BOUND: f64 = 1e-6;

/// What a parameter moves.
#[derive(Clone)]
pub(crate) enum Place {
    /// What the description declares uncertain.
    Nominal(String),
    /// What one session has of its own.
    Session(Nuisance),
    /// A parameter of an effect, by the effect's place in the description.
    Effect { index: usize, name: &'static str, is_size: bool },
}

/// A parameter of a fit.
#[derive(Clone)]
pub(crate) struct Parameter {
    pub(crate) place: Place,
    pub(crate) unit: String,
    pub(crate) centre: f64,
    pub(crate) scale: f64,
    pub(crate) least: f64,
    pub(crate) most: f64,
    /// Whether a scaled unit is a factor of e: for what is positive and may be any order of magnitude. The scale is 1 then.
    pub(crate) is_factor: bool,
    /// Precision of its prior in scaled units.
    pub(crate) precision: f64,
}

impl Parameter {
    pub(crate) fn name(&self) -> &str {
        match &self.place {
            Place::Nominal(name) => name,
            Place::Session(nuisance) => nuisance.name(),
            Place::Effect { name, .. } => name,
        }
    }

    /// The nuisance that it is, if it is a session's own.
    pub(crate) fn nuisance(&self) -> Option<&Nuisance> {
        if let Place::Session(nuisance) = &self.place { Some(nuisance) } else { None }
    }

    /// Whether its scale is a standard deviation that the description declares, for all sessions or for one.
    pub(crate) fn is_declared(&self) -> bool {
        !matches!(self.place, Place::Effect { .. })
    }

    /// Whether the description declares it uncertain.
    pub(crate) fn is_nominal(&self) -> bool {
        matches!(self.place, Place::Nominal(_))
    }

    /// Whether an effect is gone at its 0.
    pub(crate) fn is_size(&self) -> bool {
        matches!(self.place, Place::Effect { is_size: true, .. })
    }

    /// Whether it says where or how an effect acts, and not how much.
    pub(crate) fn is_shape(&self) -> bool {
        matches!(self.place, Place::Effect { is_size: false, .. })
    }

    /// The bound that a scaled value lies on.
    pub(crate) fn bound_at(&self, z: f64) -> Option<f64> {
        let (least, most) = self.bounds();
        let bound = (z >= most - ON_BOUND).then_some(most).or((z <= least + ON_BOUND).then_some(least));
        bound.map(|b| self.value(b))
    }

    /// Step of a finite difference in scaled units: large against the integrator's error, which moves the journal by
    /// nanometres, small against what bends the response.
    pub(crate) fn step(&self) -> f64 {
        if self.is_declared() { NOMINAL_STEP } else { EFFECT_STEP }
    }

    /// Value at a scaled one, within its bounds.
    pub(crate) fn value(&self, z: f64) -> f64 {
        let value = if self.is_factor { self.centre * z.exp() } else { self.centre + z * self.scale };
        let value = value.clamp(self.least, self.most);
        if self.least == 0.0 && value < ABSENT_SHARE * self.scale { 0.0 } else { value }
    }

    /// Bounds in scaled units.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        if self.is_factor {
            return ((self.least / self.centre).ln(), (self.most / self.centre).ln());
        }
        ((self.least - self.centre) / self.scale, (self.most - self.centre) / self.scale)
    }

    /// Whether the effect acts in one direction only.
    pub(crate) fn one_sided(&self) -> bool {
        self.least == 0.0
    }
}
