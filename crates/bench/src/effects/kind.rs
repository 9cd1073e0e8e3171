//! Entry of the effect catalogue: plants, parameters with bounds and priors, and confounded
//! effects.

use crate::description::{Bench, Effect, FrictionRig, MechanismBench, Part, Plant, TransmissionBench};
use crate::signals::{Channel, Sensor};

/// Quantity of a log in which step and prior of a parameter are given.
///
/// A driven axis may be a valve or a press, so its efforts and distances have no absolute order of
/// magnitude. A parameter that is given in such a quantity is found alike in a log in other units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The parameter's own unit.
    Unit,
    /// Rms effort of the drive, N or N m.
    Effort,
    /// Half the range of the motion at the friction radius, m.
    Distance,
    /// Rms speed at the friction radius, m/s.
    Speed,
    /// Effort over the rms speed, N s/m or N m s/rad.
    Drag,
    /// Effort over half the range of the motion, N/m or N m/rad.
    Stiffness,
    /// Effort over the rms load, N/N or N m/N; 1 without a load.
    LoadGain,
    /// Load with this effort, by the described gain and load-dependent friction, N.
    Load,
    /// Effort over the acceleration that rms speed and half range imply, kg or kg m2.
    Inertia,
}

/// Parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Name with unit.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// A visible but small value: the step of finite differences and the initial value of a fit.
    pub scale: f64,
    /// Quantity in which `scale`, `centre` and a `prior` that is no factor are given.
    pub measure: Measure,
    /// Minimum value.
    pub min: f64,
    /// Maximum value.
    pub max: f64,
    /// Expected value over real benches: the default unless it is given in a quantity of the log.
    pub centre: f64,
    /// Standard deviation over real benches, around `centre`. It is wide and matters only where a
    /// log contains no information.
    pub prior: f64,
    /// True if the prior is a factor: the parameter is positive and may have any order of
    /// magnitude.
    pub is_factor: bool,
    /// Value if a description gives none: 0 for a size.
    pub default: f64,
    /// True if it is a size, which removes the effect at 0; otherwise it is a shape.
    pub is_size: bool,
}

impl EffectParameter {
    /// Creates a size: 0 switches the effect off.
    pub(super) const fn size(
        name: &'static str,
        unit: &'static str,
        scale: f64,
        [min, max]: [f64; 2],
        prior: f64,
    ) -> Self {
        let (measure, is_factor, default, is_size) = (Measure::Unit, false, 0.0, true);
        Self { name, unit, scale, measure, min, max, centre: 0.0, prior, is_factor, default, is_size }
    }

    /// Gives step and prior of a size in a quantity of the log.
    pub(super) const fn in_log(self, measure: Measure) -> Self {
        Self { measure, ..self }
    }

    /// Gives the centre of a shape's prior in a quantity of the log.
    pub(super) const fn around(self, centre: f64, measure: Measure) -> Self {
        Self { centre, measure, ..self }
    }

    /// Creates a shape: a property of the effect while its size is not 0.
    pub(super) const fn shape(
        name: &'static str,
        unit: &'static str,
        default: f64,
        [min, max]: [f64; 2],
        prior: f64,
    ) -> Self {
        let (scale, measure, is_factor, is_size) = (prior, Measure::Unit, false, false);
        Self { name, unit, scale, measure, min, max, centre: default, prior, is_factor, default, is_size }
    }

    /// Creates a shape of any order of magnitude; `factor` is one standard deviation, up or down.
    pub(super) const fn magnitude(
        name: &'static str,
        unit: &'static str,
        default: f64,
        [min, max]: [f64; 2],
        factor: f64,
    ) -> Self {
        let (scale, measure, prior, is_factor, is_size) = (1.0, Measure::Unit, factor, true, false);
        Self { name, unit, scale, measure, min, max, centre: default, prior, is_factor, default, is_size }
    }
}

/// Source of the initial value for an effect whose derivative at size 0 does not show its shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guess {
    /// No source needed: sizes start at 0, shapes at their defaults.
    Defaults,
    /// The shape parameter is a time. The effect with this name, at full size, locates it.
    Onset(&'static str),
    /// The shape parameter is a frequency in Hz, from peaks of the residual's periodogram over
    /// time.
    Frequency,
    /// The shape parameter is a wavelength of the position, from peaks of the residual's
    /// periodogram over position.
    Wavelength,
    /// The size is the reciprocal of the largest reading of the sensor.
    LargestReading,
}

/// Values of an effect's parameters by name.
pub(super) type Values<'a> = dyn Fn(&str) -> f64 + 'a;

/// Function that applies an effect to the part of a bench on which it acts.
#[derive(Clone, Copy)]
pub(super) enum Apply {
    /// Action on the sensor of the effect's channel.
    Sensor(fn(&mut Sensor, &Values<'_>)),
    /// Action on a transmission bench.
    Transmission(fn(&mut TransmissionBench, &Values<'_>)),
    /// Action on a driven axis.
    Axis(fn(&mut FrictionRig, &Values<'_>)),
    /// Action on a part of a mechanism, by its name.
    Mechanism(Part, fn(&mut MechanismBench, &str, &Values<'_>)),
}

impl Apply {
    pub(super) fn to(self, bench: &mut Bench, effect: &Effect, values: &Values<'_>) {
        match self {
            Self::Sensor(change) => {
                if let Some(channel) = effect.channel {
                    change(bench.sensors_mut().entry(channel).or_default(), values);
                }
            }
            Self::Transmission(change) => {
                if let Some(bench) = bench.transmission_mut() {
                    change(bench, values);
                }
            }
            Self::Axis(change) => {
                if let Some(rig) = bench.axis_mut() {
                    change(rig, values);
                }
            }
            Self::Mechanism(_, change) => {
                if let (Bench::Mechanism(mechanism), Some(part)) = (bench, &effect.of) {
                    change(mechanism, part, values);
                }
            }
        }
    }
}

/// Action of an effect on some plants.
#[derive(Clone, Copy)]
pub struct Action {
    /// Plants on which it acts.
    pub plants: &'static [Plant],
    /// Parameters there. For a sensor effect in the unit of the channel the scale is a multiple of
    /// the sensor's noise floor.
    pub parameters: &'static [EffectParameter],
    /// Applies the effect to a description.
    pub(super) apply: Apply,
}

/// Entry of the catalogue.
#[derive(Clone, Copy)]
pub struct EffectKind {
    /// Stable name in kebab-case.
    pub name: &'static str,
    /// Summary for users.
    pub summary: &'static str,
    /// Channel of the transmission bench that shows it best. On an axis this is the effort, for a
    /// sensor effect its own channel.
    pub shows_in: Option<Channel>,
    /// Effects that look alike on some trajectories. It is sufficient if one of two effects names
    /// the other; [`EffectKind::confounded`] returns both directions.
    pub confounded_with: &'static [&'static str],
    /// Main effect that this one refines: friction that grows with load refines dry friction. A
    /// diagnosis selects the main effect first.
    pub refines: Option<&'static str>,
    /// Effect that this one equals but for its shape: friction that falls with speed, is lost by
    /// sliding, or changes at a time or with the temperature contains a level.
    pub generalises: Option<&'static str>,
    /// True if it has a shape and depends on the speed alone, so that its size is the same for
    /// rising and falling speed.
    pub is_function_of_speed: bool,
    /// Source of the initial value.
    pub guess: Guess,
    /// Actions, at most one for each plant. The effect is refused on every other plant.
    pub actions: &'static [Action],
}

impl EffectKind {
    /// Defaults of the fields that most effects leave out. An effect gives the others.
    pub(super) const DEFAULT: Self = Self {
        name: "",
        summary: "",
        shows_in: None,
        confounded_with: &[],
        refines: None,
        generalises: None,
        is_function_of_speed: false,
        guess: Guess::Defaults,
        actions: &[],
    };

    /// Returns whether it acts on one sensor.
    pub fn is_per_channel(&self) -> bool {
        self.actions.iter().all(|action| matches!(action.apply, Apply::Sensor(_)))
    }

    /// Action on a plant; none if the effect does not act there.
    pub fn action(&self, plant: Plant) -> Option<&'static Action> {
        self.actions.iter().find(|action| action.plants.contains(&plant))
    }

    /// Names of the parts of a bench on which it may act; none if it acts on a sensor or on the
    /// complete plant.
    pub fn parts(&self, bench: &Bench) -> Option<Vec<String>> {
        let action = bench.effect_plant().and_then(|plant| self.action(plant))?;
        match (action.apply, bench) {
            (Apply::Mechanism(part, _), Bench::Mechanism(mechanism)) => Some(mechanism.parts(part)),
            _ => None,
        }
    }

    /// Plants on which it acts, in the order of the documentation.
    pub fn plants(&self) -> impl Iterator<Item = Plant> {
        Plant::ALL.iter().copied().filter(move |plant| self.action(*plant).is_some())
    }

    /// Parameters for a bench; none if the effect does not act there.
    pub fn parameters(&self, bench: &Bench) -> &'static [EffectParameter] {
        bench.effect_plant().and_then(|plant| self.action(plant)).map_or(&[], |action| action.parameters)
    }
}
