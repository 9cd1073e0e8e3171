//! What the catalogue holds of an effect: where it acts, its parameters with bounds and priors, what it is confounded with.

use crate::channel::Channel;
use crate::description::{AxisKind, Bench};
use core::fmt;

/// A plant that effects act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// The transmission bench without tilt.
    Planar,
    /// The transmission bench with a `[two_plane]` section.
    TwoPlane,
    /// A driven axis of kind `rotary`: the friction rig.
    Rotary,
    /// A driven axis of kind `linear`.
    Linear,
}

impl Plant {
    /// Every plant, in the order of the documentation.
    pub const ALL: &[Self] = &[Self::Planar, Self::TwoPlane, Self::Rotary, Self::Linear];

    /// The plant of a description.
    pub fn of(bench: &Bench) -> Self {
        match bench {
            Bench::Transmission(bench) if bench.two_plane.is_some() => Self::TwoPlane,
            Bench::Transmission(_) => Self::Planar,
            Bench::FrictionRig(rig) => match rig.axis.kind {
                AxisKind::Rotary => Self::Rotary,
                AxisKind::Linear => Self::Linear,
            },
        }
    }

    /// The plant in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Planar => "planar transmission bench",
            Self::TwoPlane => "transmission bench with [two_plane]",
            Self::Rotary => "friction rig",
            Self::Linear => "linear axis",
        }
    }
}

impl fmt::Display for Plant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.words())
    }
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Name with unit.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// A size that is visible but small: the step of finite differences and the first guess of a fit.
    pub scale: f64,
    /// Smallest value that makes sense.
    pub least: f64,
    /// Largest value that makes sense.
    pub most: f64,
    /// Standard deviation of what real benches show, around the default. Wide: it only holds what a log does not tell.
    pub prior: f64,
    /// Whether the prior is a factor: the parameter is positive and may be of any order of magnitude.
    pub is_factor: bool,
    /// Value where a description gives none: 0 for a size.
    pub default: f64,
    /// Whether it is a size, at whose 0 the effect is gone; else it shapes the effect.
    pub is_size: bool,
}

impl EffectParameter {
    /// A size: 0 switches the effect off.
    pub(super) const fn size(
        name: &'static str,
        unit: &'static str,
        scale: f64,
        [least, most]: [f64; 2],
        prior: f64,
    ) -> Self {
        Self { name, unit, scale, least, most, prior, is_factor: false, default: 0.0, is_size: true }
    }

    /// A shape: what the effect looks like while its size is not 0.
    pub(super) const fn shape(
        name: &'static str,
        unit: &'static str,
        default: f64,
        [least, most]: [f64; 2],
        prior: f64,
    ) -> Self {
        Self { name, unit, scale: prior, least, most, prior, is_factor: false, default, is_size: false }
    }

    /// A shape that may be of any order of magnitude; `factor` is one standard deviation, up or down.
    pub(super) const fn magnitude(
        name: &'static str,
        unit: &'static str,
        default: f64,
        [least, most]: [f64; 2],
        factor: f64,
    ) -> Self {
        Self { name, unit, scale: 1.0, least, most, prior: factor, is_factor: true, default, is_size: false }
    }
}

/// How a log gives a first guess of an effect that a derivative at size 0 does not show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guess {
    /// None needed: sizes start at 0, shapes at their defaults.
    Defaults,
    /// The shape parameter is a time at which the effect of this name sets in with full size.
    Onset(&'static str),
    /// The shape parameter is a frequency in Hz, from peaks of the residual's periodogram over time.
    Frequency,
    /// The shape parameter is a wavelength of the position, from peaks of the residual's periodogram over position.
    Wavelength,
    /// The size is the reciprocal of the largest reading of the sensor.
    LargestReading,
}

/// Applies an effect to a description; the function gives its parameters by name.
pub(super) type Apply = fn(&mut Bench, Option<Channel>, &dyn Fn(&str) -> f64);

/// An entry of the catalogue.
#[derive(Clone, Copy)]
pub struct EffectKind {
    /// Stable name in kebab-case.
    pub name: &'static str,
    /// What it is, for people.
    pub summary: &'static str,
    /// Whether it concerns one sensor.
    pub per_channel: bool,
    /// Where it acts.
    pub plants: &'static [Plant],
    /// Parameters on a transmission bench. For a sensor effect the scale is in multiples of the sensor's own floor
    /// where the unit is the channel's.
    pub transmission: &'static [EffectParameter],
    /// Parameters on a driven axis.
    pub axis: &'static [EffectParameter],
    /// The channel of the transmission bench that shows it best; on an axis it is the effort, of a sensor effect its own.
    pub shows_in: Option<Channel>,
    /// Effects that look alike on some trajectories.
    pub confounded_with: &'static [&'static str],
    /// First guess.
    pub guess: Guess,
    /// Applies the effect to a description.
    pub(super) apply: Apply,
}

impl EffectKind {
    /// Parameters for a bench, none if the effect does not act there.
    pub fn parameters(&self, bench: &Bench) -> &'static [EffectParameter] {
        match bench {
            _ if !self.plants.contains(&Plant::of(bench)) => &[],
            Bench::Transmission(_) => self.transmission,
            Bench::FrictionRig(_) => self.axis,
        }
    }
}
