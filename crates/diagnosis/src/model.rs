//! The parameters of a fit: what the description declares uncertain, and what the chosen effects add.
//!
//! Every parameter is scaled: an uncertain one by its standard deviation, so that its prior is `z^2`, an effect's by a
//! size that is visible but small; the catalogue's prior of it is then weak. A shape that a guess gave has a weaker one.
//! What the description declares as a session's own ([`crate::nuisance`]) is scaled as what is uncertain, and moves its session only.

use crate::noise::NoiseModel;
use crate::nuisance::{Nuisance, Variants};
use crate::parameter::{Parameter, Place};
use crate::session::Data;
use bench::description::AxisKind;
use bench::effects::{Effect, EffectKind, Guess};
use bench::{Bench, Channel};
use std::collections::BTreeMap;

/// Least share of its described value that a positive parameter may fall to.
const LEAST_SHARE: f64 = 0.1;
/// Standard deviations that calibration may move a parameter: what lies farther out is a finding.
pub(crate) const MOST_DEVIATIONS: f64 = 4.0;
/// Standard deviation of an offset in units of the sensor's resolution: it may lie anywhere within one of them.
const OFFSET_SHARE: f64 = 0.577;
/// Precision of a guessed shape's prior in its own steps: a hundred of them. Without one a step between two samples, which
/// nothing moves while it stays between them, would have no place at all.
const GUESS_PRECISION: f64 = 1e-4;

/// A first guess of a parameter, with a step that is small against its sharpness.
#[derive(Clone, Copy)]
pub(crate) struct Guessed {
    pub(crate) value: f64,
    pub(crate) step: f64,
    /// The shape that it is one of; none where the effect has but one, or where it is of the size.
    pub(crate) of: Option<&'static str>,
}

/// An effect of the catalogue on a sensor or on the plant.
#[derive(Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) kind: &'static EffectKind,
    pub(crate) channel: Option<Channel>,
    /// Of its shape, or of its size where the catalogue says so.
    pub(crate) guess: Option<Guessed>,
}

impl Candidate {
    /// Whether the guess is one of the size.
    pub(crate) fn guesses_size(&self) -> bool {
        self.kind.guess == Guess::LargestReading
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.kind.name == other.kind.name && self.channel == other.channel
    }
}

/// A bench with the parameters that a fit moves.
#[derive(Clone)]
pub(crate) struct Model {
    bench: Bench,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) chosen: Vec<Candidate>,
}

/// Iterations to the same number, and how near it has to come.
const ROUNDS: usize = 6;
const SAME: f64 = 1e-12;

impl Model {
    /// The described bench: only what is uncertain moves, and the offset of each sensor of `channels` within its resolution.
    pub(crate) fn nominal(bench: &Bench, channels: &[Channel]) -> Self {
        let mut uncertain = bench.uncertain().clone();
        for (channel, sensor) in bench.sensors().iter().filter(|(c, _)| channels.contains(c)) {
            // An offset that each session may have of its own stands for it.
            let declared = bench.nuisances().offset.get(channel).copied().unwrap_or_default();
            if sensor.resolution > 0.0 && declared < OFFSET_SHARE * sensor.resolution {
                uncertain
                    .entry(format!("sensors.{channel}.offset"))
                    .or_insert(OFFSET_SHARE * sensor.resolution);
            }
        }
        let mut probe = bench.clone();
        let mut parameters = Vec::new();
        for (name, &scale) in &uncertain {
            if let Some(&mut centre) = probe.parameter_mut(name) {
                let least = centre - MOST_DEVIATIONS * scale;
                let positive = centre > 0.0 && !name.ends_with(".offset");
                let least = if positive { least.max(LEAST_SHARE * centre) } else { least };
                parameters.push(Parameter {
                    place: Place::Nominal(name.clone()),
                    unit: String::new(),
                    centre,
                    scale,
                    least,
                    most: centre + MOST_DEVIATIONS * scale,
                    is_factor: false,
                    precision: 1.0,
                });
            }
        }
        Self { bench: bench.clone(), parameters, chosen: Vec::new() }
    }

    /// The same with every nuisance that is declared for some sessions.
    pub(crate) fn with_nuisances(mut self, data: &Data) -> Self {
        let own = data.sessions.iter().flat_map(|s| Nuisance::declared(&self.bench, data, s.number));
        let parameters: Vec<Parameter> = own
            .map(|(nuisance, deviation)| Parameter {
                unit: nuisance.unit().into(),
                place: Place::Session(nuisance),
                centre: 0.0,
                scale: deviation,
                least: -MOST_DEVIATIONS * deviation,
                most: MOST_DEVIATIONS * deviation,
                is_factor: false,
                precision: 1.0,
            })
            .collect();
        self.parameters.extend(parameters);
        self
    }

    /// Scaled parameters of sessions alone.
    pub(crate) fn nuisances_of(&self, z: &[f64]) -> Vec<f64> {
        let own = self.parameters.iter().zip(z).filter(|(p, _)| p.nuisance().is_some());
        own.map(|(_, z)| *z).collect()
    }

    /// A fitted model as it stands, with nothing to move: for the nuisances of sessions that were not fitted.
    pub(crate) fn settled(&self, z: &[f64]) -> Self {
        Self { bench: self.at(z).common, parameters: Vec::new(), chosen: Vec::new() }
    }

    /// The same with one more effect.
    pub(crate) fn with(&self, candidate: Candidate, noise: &NoiseModel) -> Self {
        let mut model = self.clone();
        let index = model.bench.effects().len();
        model.bench.effects_mut().push(Effect {
            name: candidate.kind.name.into(),
            channel: candidate.channel,
            parameters: BTreeMap::new(),
        });
        for p in candidate.kind.parameters(&self.bench) {
            // Offsets and drifts are scaled by their sensor's noise.
            let unit_scale = match candidate.channel {
                Some(channel) if p.unit.starts_with("channel") => noise.of(channel).floor,
                _ => 1.0,
            };
            let is_of = |g: &Guessed| match g.of {
                Some(name) => name == p.name,
                None => candidate.guesses_size() == p.is_size,
            };
            let (centre, scale, precision) = match candidate.guess.filter(is_of) {
                // The prior moves with the start: by one deviation at most.
                Some(g) if p.is_factor => (g.value, 1.0, p.prior.ln().powi(-2)),
                Some(g) if p.is_size => (0.0, g.step, 0.0),
                Some(g) => (g.value, g.step, GUESS_PRECISION),
                None if p.is_factor => (p.default, 1.0, p.prior.ln().powi(-2)),
                None => (p.default, p.scale * unit_scale, (p.scale / p.prior).powi(2)),
            };
            model.parameters.push(Parameter {
                place: Place::Effect { index, name: p.name, is_size: p.is_size },
                unit: unit(p.unit, candidate.channel, &self.bench),
                centre,
                scale,
                least: p.least,
                most: p.most,
                is_factor: p.is_factor,
                precision,
            });
        }
        model.chosen.push(candidate);
        model
    }

    /// The bench at scaled parameters, and what it is in the sessions that differ.
    pub(crate) fn at(&self, z: &[f64]) -> Variants {
        let mut bench = self.bench.clone();
        for (parameter, &z) in self.parameters.iter().zip(z) {
            let value = parameter.value(z);
            match &parameter.place {
                Place::Nominal(name) => {
                    if let Some(place) = bench.parameter_mut(name) {
                        *place = value;
                    }
                }
                Place::Effect { index, name, .. } => {
                    if let Some(effect) = bench.effects_mut().get_mut(*index) {
                        effect.parameters.insert((*name).into(), value);
                    }
                }
                Place::Session(_) => {}
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

    /// The uncertain parameter that moves the very number which the effect parameter `i` moves, with the ratio of their
    /// sensitivities.
    pub(crate) fn alias(&self, z: &[f64], i: usize) -> Option<(usize, f64)> {
        if self.parameters[i].is_declared() {
            return None;
        }
        let moved = |i: usize| {
            let mut there = z.to_vec();
            let (step, (_, most)) = (self.parameters[i].step(), self.parameters[i].bounds());
            let step = if z[i] + step > most { -step } else { step };
            there[i] += step;
            (self.at(&there).common.resolved(), step)
        };
        let mut here = self.at(z).common.resolved();
        let (mut effect, effect_step) = moved(i);
        for (k, parameter) in self.parameters.iter().enumerate() {
            let Place::Nominal(name) = &parameter.place else { continue };
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

    /// Scaled parameters of the same plant with an uncertain parameter as described, where an effect moves the very same number: nothing but the
    /// priors tells the two apart, along a valley that bends.
    pub(crate) fn unaliased(&self, z: &[f64]) -> Vec<f64> {
        let mut out = z.to_vec();
        for i in 0..self.parameters.len() {
            let Some((k, _)) = self.alias(&out, i) else { continue };
            let Place::Nominal(name) = &self.parameters[k].place else { continue };
            let number = |z: &[f64]| self.at(z).common.resolved().parameter_mut(name).map(|n| *n);
            let Some(wanted) = number(&out) else { continue };
            let mut there = out.clone();
            there[k] = 0.0;
            let (least, most) = self.parameters[i].bounds();
            // Newton's iteration with a rate from a small step: the number is nearly linear in either.
            for _ in 0..ROUNDS {
                let mut near = there.clone();
                near[i] += self.parameters[i].step();
                let (Some(here), Some(next)) = (number(&there), number(&near)) else { break };
                let by = (wanted - here) / (next - here) * self.parameters[i].step();
                if !by.is_finite() {
                    break;
                }
                there[i] = (there[i] + by).clamp(least, most);
            }
            if number(&there).is_some_and(|n| (n - wanted).abs() <= SAME * wanted.abs()) {
                out = there;
            }
        }
        out
    }

    /// Indices of the parameters of the chosen effect number `which`.
    pub(crate) fn of_effect(&self, which: usize) -> Vec<usize> {
        let index = self.bench.effects().len() - self.chosen.len() + which;
        let belongs = |p: &Parameter| matches!(p.place, Place::Effect { index: i, .. } if i == index);
        (0..self.parameters.len()).filter(|&i| belongs(&self.parameters[i])).collect()
    }
}

/// The unit for people: of the channel, of the axis' effort.
fn unit(unit: &str, channel: Option<Channel>, bench: &Bench) -> String {
    if let (Some((before, after)), Some(channel)) = (unit.split_once("channel"), channel) {
        return format!("{before}{}{after}", channel.unit());
    }
    match (bench, unit.split_once(" or ")) {
        (Bench::FrictionRig(rig), Some((linear, rotary))) => match rig.axis.kind {
            AxisKind::Linear => linear.into(),
            AxisKind::Rotary => rotary.into(),
        },
        _ => unit.into(),
    }
}
