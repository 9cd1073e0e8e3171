//! Parameters of a fit: those that the description declares uncertain, and those of the effects
//! that the fit adds.
//!
//! Every parameter is scaled. A declared one is scaled by its standard deviation, so its prior adds
//! `z^2` to chi-square. An effect's parameter is scaled by a size that is visible but small, far
//! below the standard deviation of the catalogue's prior. A guessed shape has an even weaker prior.
//! Nuisance parameters of one log ([`super::nuisance`]) are scaled like declared ones and act on
//! their log only.

use super::nuisance::{Nuisance, Variants};
use super::parameter::{Parameter, Target};
use super::tuning;
use crate::data::logs::Data;
use crate::data::measures::Measures;
use crate::data::noise::NoiseModel;
use bench::description::{AxisKind, FrictionRig};
use bench::effects::{Effect, EffectKind, EffectParameter, Guess, Measure};
use bench::{Bench, Channel};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Initial guess of a parameter, with a step that is small compared with the width of its optimum.
#[derive(Clone, Copy)]
pub(crate) struct InitialGuess {
    pub(crate) value: f64,
    pub(crate) step: f64,
    /// The shape parameter that is guessed; none if the effect has only one, or if the size is
    /// guessed.
    pub(crate) parameter: Option<&'static str>,
}

/// An effect of the catalogue, on a sensor, on the plant or on a part of it.
#[derive(Clone)]
pub(crate) struct Candidate {
    pub(crate) kind: &'static EffectKind,
    pub(crate) channel: Option<Channel>,
    /// Part of a mechanism.
    pub(crate) of: Option<Arc<str>>,
    /// Guess of its shape, or of its size if the catalogue requires one.
    pub(crate) guess: Option<InitialGuess>,
}

impl Candidate {
    /// Name of the part of a mechanism on which it acts.
    pub(crate) fn part(&self) -> Option<String> {
        self.of.as_deref().map(str::to_owned)
    }

    /// Returns whether the size is guessed.
    pub(crate) fn guesses_size(&self) -> bool {
        self.kind.guess == Guess::LargestReading
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.kind.name == other.kind.name && self.channel == other.channel && self.of == other.of
    }
}

/// A bench with the parameters that a fit changes.
#[derive(Clone)]
pub(crate) struct Model {
    bench: Bench,
    measures: Measures,
    pub(crate) parameters: Vec<Parameter>,
    /// Effects that the fit adds to the described ones.
    pub(crate) effects: Vec<Candidate>,
}

impl Model {
    /// The described bench with its declared parameters and, within the resolution, the offset of
    /// each sensor of the logs.
    pub(crate) fn nominal(bench: &Bench, data: &Data) -> Self {
        let mut uncertain = bench.uncertain().clone();
        for (channel, sensor) in bench.sensors().iter().filter(|(c, _)| data.channels.contains(c)) {
            // An offset that is declared for each log replaces the common one.
            let declared = bench.nuisances().offset.get(channel).copied().unwrap_or_default();
            if sensor.resolution > 0.0 && declared < tuning::OFFSET_SHARE * sensor.resolution {
                uncertain
                    .entry(format!("sensors.{channel}.offset"))
                    .or_insert(tuning::OFFSET_SHARE * sensor.resolution);
            }
        }
        let mut probe = bench.clone();
        let mut parameters = Vec::new();
        for (name, &scale) in &uncertain {
            if let Some(&mut centre) = probe.parameter_mut(name) {
                let min = centre - tuning::MAX_DEVIATIONS * scale;
                let is_positive = centre > 0.0 && !name.ends_with(".offset");
                let min = if is_positive { min.max(tuning::MIN_POSITIVE_SHARE * centre) } else { min };
                parameters.push(Parameter {
                    target: Target::Nominal(name.clone()),
                    unit: String::new(),
                    centre,
                    scale,
                    min,
                    max: centre + tuning::MAX_DEVIATIONS * scale,
                    is_factor: false,
                    precision: 1.0,
                });
            }
        }
        let measures = Measures::new(bench, data);
        Self { bench: bench.clone(), measures, parameters, effects: Vec::new() }
    }

    /// Adds the nuisance parameters that are declared for each log.
    pub(crate) fn with_nuisances(mut self, data: &Data) -> Self {
        let own = data.logs.iter().flat_map(|log| Nuisance::declared(&self.bench, data, log.index));
        let parameters: Vec<Parameter> = own
            .map(|(nuisance, deviation)| Parameter {
                unit: nuisance.unit().into(),
                target: Target::Log(nuisance),
                centre: 0.0,
                scale: deviation,
                min: -tuning::MAX_DEVIATIONS * deviation,
                max: tuning::MAX_DEVIATIONS * deviation,
                is_factor: false,
                precision: 1.0,
            })
            .collect();
        self.parameters.extend(parameters);
        self
    }

    /// Scaled values of the nuisance parameters.
    pub(crate) fn nuisance_values(&self, z: &[f64]) -> Vec<f64> {
        let own = self.parameters.iter().zip(z).filter(|(p, _)| p.nuisance().is_some());
        own.map(|(_, z)| *z).collect()
    }

    /// The fitted bench without free parameters, as the base of nuisance parameters of held-out
    /// logs.
    pub(crate) fn fixed_at(&self, z: &[f64]) -> Self {
        let (bench, measures) = (self.at(z).common, self.measures);
        Self { bench, measures, parameters: Vec::new(), effects: Vec::new() }
    }

    /// Returns the model with one more effect.
    pub(crate) fn with_effect(&self, candidate: Candidate, noise: &NoiseModel) -> Self {
        let mut model = self.clone();
        let index = model.bench.effects().len();
        model.bench.effects_mut().push(Effect {
            name: candidate.kind.name.into(),
            channel: candidate.channel,
            of: candidate.part(),
            parameters: BTreeMap::new(),
        });
        for p in candidate.kind.parameters(&self.bench) {
            // Offsets and drifts are scaled by the noise of their sensor.
            let unit_scale = match candidate.channel {
                Some(channel) if p.unit.starts_with("channel") => noise.channel(channel).floor,
                _ => self.measures.value(p.measure),
            };
            let is_guessed = |g: &InitialGuess| match g.parameter {
                Some(name) => name == p.name,
                None => candidate.guesses_size() == p.is_size,
            };
            let (centre, scale, precision) = match candidate.guess.filter(is_guessed) {
                // The prior is centred on the start, which is one deviation from the centre at
                // most.
                Some(g) if p.is_factor => (g.value, 1.0, p.prior.ln().powi(-2)),
                Some(g) if p.is_size => (0.0, g.step, 0.0),
                Some(g) => (g.value, g.step, tuning::GUESS_PRECISION),
                None if p.is_factor => (self.centre(p), 1.0, p.prior.ln().powi(-2)),
                None => (self.centre(p), p.scale * unit_scale, (p.scale / p.prior).powi(2)),
            };
            model.parameters.push(Parameter {
                target: Target::Effect { index, name: p.name, is_size: p.is_size },
                unit: unit(p.unit, candidate.channel, &self.bench),
                centre,
                scale,
                min: p.min,
                max: self.max(p),
                is_factor: p.is_factor,
                precision,
            });
        }
        model.effects.push(candidate);
        model
    }

    /// Centre of the prior of an effect's parameter.
    pub(crate) fn centre(&self, p: &EffectParameter) -> f64 {
        (p.centre * self.measures.value(p.measure)).clamp(p.min, self.max(p))
    }

    /// Maximum of an effect's parameter.
    ///
    /// A shape in a quantity of the log is at most that quantity: friction that falls with a speed
    /// beyond the fastest log's rms can hardly be separated from a level.
    pub(crate) fn max(&self, p: &EffectParameter) -> f64 {
        if p.is_size { p.max } else { p.max.min(self.measures.largest(p.measure)).max(p.min) }
    }

    /// This model, the nominal one, with some effects of a fitted model in the given order, and
    /// with their fitted values.
    pub(crate) fn with_effects_of(
        &self,
        (fitted, z): (&Self, &[f64]),
        order: impl IntoIterator<Item = usize>,
        noise: &NoiseModel,
    ) -> (Self, Vec<f64>) {
        let mut model = self.clone();
        let mut values: Vec<f64> = z.iter().take(self.parameters.len()).copied().collect();
        for which in order {
            let Some(candidate) = fitted.effects.get(which) else { continue };
            values.extend(fitted.effect_parameters(which).iter().filter_map(|&i| z.get(i)));
            model = model.with_effect(candidate.clone(), noise);
        }
        (model, values)
    }

    /// This model without its effects.
    pub(crate) fn without_effects(&self) -> Self {
        let mut model = self.clone();
        let described = model.bench.effects().len() - model.effects.len();
        model.bench.effects_mut().truncate(described);
        model.effects.clear();
        model.parameters.retain(Parameter::is_declared);
        model
    }

    /// This model with the declared number `index` as described, and the values of the other
    /// parameters.
    pub(crate) fn without_number(&self, index: usize, mut z: Vec<f64>) -> (Self, Vec<f64>) {
        let mut model = self.clone();
        model.parameters.remove(index);
        z.remove(index);
        (model, z)
    }

    /// Returns whether a parameter is a number that the description itself declares uncertain.
    pub(crate) fn declares(&self, parameter: &Parameter) -> bool {
        parameter.is_nominal() && self.bench.uncertain().contains_key(parameter.name())
    }

    /// The bench at scaled parameters, with a variant for each log that differs.
    pub(crate) fn at(&self, z: &[f64]) -> Variants {
        let mut bench = self.bench.clone();
        for (parameter, &z) in self.parameters.iter().zip(z) {
            let value = parameter.value(z);
            match &parameter.target {
                Target::Nominal(name) => {
                    if let Some(place) = bench.parameter_mut(name) {
                        *place = value;
                    }
                }
                Target::Effect { index, name, .. } => {
                    if let Some(effect) = bench.effects_mut().get_mut(*index) {
                        effect.parameters.insert((*name).into(), value);
                    }
                }
                Target::Log(_) => {}
            }
        }
        let mut variants = Variants { common: bench, own: BTreeMap::new() };
        for (parameter, &z) in self.parameters.iter().zip(z) {
            if let Some(nuisance) = parameter.nuisance() {
                nuisance.apply(&mut variants, parameter.value(z));
            }
        }
        variants
    }

    /// The bench at scaled parameters as a description, which can be read again.
    pub(crate) fn extended(&self, z: &[f64]) -> Bench {
        let mut bench = self.at(z).common;
        if let Bench::Mechanism(mechanism) = &mut bench {
            mechanism.limit_offsets();
        }
        bench
    }

    /// Returns whether a bench can be like this: mass, dry and viscous friction of an axis are not
    /// negative, beyond a small share of the log's effort; joints of a mechanism have clearance.
    ///
    /// The bounds of a single effect cannot exclude it, because description, calibration and
    /// effects add up.
    pub(crate) fn is_possible(&self, z: &[f64]) -> bool {
        let resolved = self.at(z).common.resolved();
        if let Bench::Mechanism(mechanism) = &resolved {
            return mechanism.has_clearances();
        }
        resolved.axis().is_none_or(|rig| {
            let axis = &rig.axis;
            let numbers = [
                (axis.inertia, Measure::Inertia),
                (axis.coulomb_effort, Measure::Effort),
                (self.lowest_friction(rig), Measure::Effort),
                (axis.viscous_effort, Measure::Drag),
            ];
            numbers.iter().all(|(n, measure)| *n >= -tuning::NEGATIVE_SHARE * self.measures.value(*measure))
        })
    }

    /// Dry friction where it is lowest along the stroke; 0 without friction that changes there.
    fn lowest_friction(&self, rig: &FrictionRig) -> f64 {
        if rig.extension.friction_slope == 0.0 { 0.0 } else { self.measures.lowest_friction(rig) }
    }

    /// The declared parameter that changes the same number as effect parameter `i`, with the ratio
    /// of the two sensitivities.
    pub(crate) fn alias(&self, z: &[f64], i: usize) -> Option<(usize, f64)> {
        if self.parameters[i].is_declared() {
            return None;
        }
        let moved = |i: usize| {
            let mut there = z.to_vec();
            let (step, (_, max)) = (self.parameters[i].step(), self.parameters[i].bounds());
            let step = if z[i] + step > max { -step } else { step };
            there[i] += step;
            (self.at(&there).common.resolved(), step)
        };
        let mut here = self.at(z).common.resolved();
        let (mut effect, effect_step) = moved(i);
        for (k, parameter) in self.parameters.iter().enumerate() {
            let Target::Nominal(name) = &parameter.target else { continue };
            let (now, then) = (*here.parameter_mut(name)?, *effect.parameter_mut(name)?);
            if now == then {
                continue;
            }
            let mut probe = here.clone();
            *probe.parameter_mut(name)? = then;
            if probe != effect {
                return None;
            }
            let (mut nominal, nominal_step) = moved(k);
            let rate = (*nominal.parameter_mut(name)? - now) / nominal_step;
            return Some((k, (then - now) / effect_step / rate));
        }
        None
    }

    /// Equivalent scaled parameters in which every aliased declared parameter has its described
    /// value.
    ///
    /// If an effect and a declared parameter change the same number, only their priors separate
    /// them, along a curved valley.
    pub(crate) fn unaliased(&self, z: &[f64]) -> Vec<f64> {
        let mut out = z.to_vec();
        for i in 0..self.parameters.len() {
            let Some((k, _)) = self.alias(&out, i) else { continue };
            let Target::Nominal(name) = &self.parameters[k].target else { continue };
            let number = |z: &[f64]| self.at(z).common.resolved().parameter_mut(name).map(|n| *n);
            let Some(fitted) = number(&out) else { continue };
            let mut there = out.clone();
            there[k] = 0.0;
            let (min, max) = self.parameters[i].bounds();
            // Newton's iteration with a secant from a small step: the number is nearly linear in
            // both parameters.
            for _ in 0..tuning::ALIAS_ITERATIONS {
                let mut near = there.clone();
                near[i] += self.parameters[i].step();
                let (Some(here), Some(next)) = (number(&there), number(&near)) else { break };
                let by = (fitted - here) / (next - here) * self.parameters[i].step();
                if !by.is_finite() {
                    break;
                }
                there[i] = (there[i] + by).clamp(min, max);
            }
            if number(&there).is_some_and(|n| (n - fitted).abs() <= tuning::ALIAS_TOLERANCE * fitted.abs()) {
                out = there;
            }
        }
        out
    }

    /// Returns whether a candidate has a parameter that is no size.
    pub(crate) fn has_shape(&self, candidate: &Candidate) -> bool {
        candidate.kind.parameters(&self.bench).iter().any(|p| !p.is_size)
    }

    /// Indices of the parameters of added effect `which`.
    pub(crate) fn effect_parameters(&self, which: usize) -> Vec<usize> {
        let index = self.bench.effects().len() - self.effects.len() + which;
        let belongs = |p: &Parameter| matches!(p.target, Target::Effect { index: i, .. } if i == index);
        (0..self.parameters.len()).filter(|&i| belongs(&self.parameters[i])).collect()
    }
}

/// The unit to display: `channel` is replaced by the channel's unit, and `linear or rotary` by that
/// of the axis.
fn unit(unit: &str, channel: Option<Channel>, bench: &Bench) -> String {
    if let (Some((before, after)), Some(channel)) = (unit.split_once("channel"), channel) {
        return format!("{before}{}{after}", channel.unit());
    }
    match (bench.axis(), unit.split_once(" or ")) {
        (Some(rig), Some((linear, rotary))) => match rig.axis.kind {
            AxisKind::Linear => linear.into(),
            AxisKind::Rotary => rotary.into(),
        },
        _ => unit.into(),
    }
}
