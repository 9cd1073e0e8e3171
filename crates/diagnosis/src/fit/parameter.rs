//! One parameter of a fit: what it changes, its scale, bounds and prior.

use super::nuisance::Nuisance;
use super::tuning;

/// Number that a parameter changes.
#[derive(Clone)]
pub(crate) enum Target {
    /// A number of the bench that the description declares uncertain, by its dotted name.
    Nominal(String),
    /// A nuisance parameter of one log.
    Log(Nuisance),
    /// A parameter of an effect, by the index of the effect in the description.
    Effect { index: usize, name: &'static str, is_size: bool },
}

/// A scaled parameter: `value = centre + z * scale`, or `centre * exp(z)` for a factor.
#[derive(Clone)]
pub(crate) struct Parameter {
    pub(crate) target: Target,
    pub(crate) unit: String,
    pub(crate) centre: f64,
    pub(crate) scale: f64,
    pub(crate) min: f64,
    pub(crate) max: f64,
    /// True if one scaled unit is a factor of e. This suits positive parameters of unknown order of
    /// magnitude. `scale` is 1 then.
    pub(crate) is_factor: bool,
    /// Precision of the prior in scaled units; 0 for no prior.
    pub(crate) precision: f64,
}

impl Parameter {
    /// Name in the description, or of the nuisance parameter with its log.
    pub(crate) fn name(&self) -> &str {
        match &self.target {
            Target::Nominal(name) => name,
            Target::Log(nuisance) => nuisance.name(),
            Target::Effect { name, .. } => name,
        }
    }

    /// The nuisance parameter, if it belongs to one log.
    pub(crate) fn nuisance(&self) -> Option<&Nuisance> {
        if let Target::Log(nuisance) = &self.target { Some(nuisance) } else { None }
    }

    /// Returns whether its scale is a standard deviation that the description declares, for all
    /// logs or for one.
    pub(crate) fn is_declared(&self) -> bool {
        !matches!(self.target, Target::Effect { .. })
    }

    /// Returns whether the description declares it uncertain for all logs.
    pub(crate) fn is_nominal(&self) -> bool {
        matches!(self.target, Target::Nominal(_))
    }

    /// Returns whether its value 0 means that the effect is absent.
    pub(crate) fn is_size(&self) -> bool {
        matches!(self.target, Target::Effect { is_size: true, .. })
    }

    /// Returns whether it describes where or how an effect acts, and not how large it is.
    pub(crate) fn is_shape(&self) -> bool {
        matches!(self.target, Target::Effect { is_size: false, .. })
    }

    /// The bound on which a scaled value lies, in the parameter's unit.
    pub(crate) fn bound_at(&self, z: f64) -> Option<f64> {
        let (min, max) = self.bounds();
        let bound = (z >= max - tuning::BOUND_TOLERANCE)
            .then_some(max)
            .or((z <= min + tuning::BOUND_TOLERANCE).then_some(min));
        bound.map(|b| self.value(b))
    }

    /// Step of a finite difference in scaled units.
    pub(crate) fn step(&self) -> f64 {
        if self.is_declared() { tuning::DECLARED_STEP } else { tuning::EFFECT_STEP }
    }

    /// Value in its unit at a scaled value, limited to the bounds; a small one-sided effect counts
    /// as 0.
    pub(crate) fn value(&self, z: f64) -> f64 {
        let value = if self.is_factor { self.centre * z.exp() } else { self.centre + z * self.scale };
        let value = value.clamp(self.min, self.max);
        if self.min == 0.0 && value < tuning::ABSENT_SHARE * self.scale { 0.0 } else { value }
    }

    /// Bounds in scaled units.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        if self.is_factor {
            return ((self.min / self.centre).ln(), (self.max / self.centre).ln());
        }
        ((self.min - self.centre) / self.scale, (self.max - self.centre) / self.scale)
    }

    /// Returns whether the effect acts in one direction only.
    pub(crate) fn is_one_sided(&self) -> bool {
        self.min == 0.0
    }
}
