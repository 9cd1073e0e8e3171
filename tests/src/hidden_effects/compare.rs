//! Comparison of an answer with the label.
//!
//! An effect counts by its name, a sensor effect by its channel, too. A named cause is *equivalent*
//! to the hidden one if the generator can imitate the hidden effect with it. For this the generator
//! takes the cause as the engine found it, with a free factor and every move that calibration may
//! make. The remainder must be smaller than [`ALIKE`], the smallest size of the matrix.

use super::cell::Cell;
use crate::generator::hidden::HiddenEffect;
use crate::generator::size::Scale;
use crate::generator::vocabulary::size_parameters;
use diagnosis::{Cause, Diagnosis, Verdict};
use serde::{Deserialize, Serialize};

/// Size of the remainder up to which two effects are equivalent on a log.
const ALIKE: f64 = 0.1;

/// An effect in an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Named {
    /// Name of the effect.
    pub effect: String,
    /// Channel of a sensor effect.
    pub channel: Option<String>,
    /// Stated probability.
    pub probability: f64,
}

impl Named {
    fn is(&self, hidden: &HiddenEffect) -> bool {
        self.effect == hidden.effect && self.channel == hidden.channel
    }
}

impl host_sim::shard::Numbered for Outcome {
    fn number(&self) -> usize {
        self.cell.index
    }
}

/// Result of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Cell.
    pub cell: Cell,
    /// Hidden effects; empty if the plant cannot show the requested size.
    pub hidden: Vec<HiddenEffect>,
    /// Verdict.
    pub verdict: String,
    /// Causes of a named or ambiguous answer, the main one first. A partial answer gives an unknown
    /// cause at least half of the probability and counts as `unknown`.
    pub causes: Vec<Named>,
    /// Number of causes of a partial answer.
    #[serde(default)]
    pub partial_names: usize,
    /// Number of these that are hidden; all if together they are equivalent to what is hidden.
    #[serde(default)]
    pub partial_right: usize,
    /// Effects reported as fitting equally well.
    pub ambiguous_with: Vec<Named>,
    /// True if the first cause is the (first) hidden effect.
    pub first: bool,
    /// Number of hidden effects among causes and equals.
    pub in_group: usize,
    /// True if a cause that is not hidden is equivalent to the hidden one.
    pub equivalent: bool,
    /// Relative error of the size parameter, if the first cause is right.
    pub parameter_error: Option<f64>,
    /// True if the 95 % interval contains the hidden value.
    pub covered: Option<bool>,
    /// Share of the repeatable residual that the extension explains, as predicted by the engine.
    pub predicted: Option<f64>,
    /// The same share, measured on another record that the engine never saw.
    pub realised: Option<f64>,
    /// Experiment that the engine proposed.
    pub proposed: Option<String>,
    /// True if the engine reported that no experiment of its menu separates the causes.
    #[serde(default)]
    pub hopeless: bool,
    /// Result of a pair: true if the experiment settled the question. For a changed question, true
    /// if the answer was the same.
    pub settled: Option<bool>,
    /// Ratio of interval widths, for the changes that test it.
    pub ratio: Option<f64>,
    /// Wall time of the engine, s.
    pub engine_s: f64,
}

impl Outcome {
    /// Returns a cell without an answer.
    pub fn new(cell: &Cell) -> Self {
        Self {
            cell: cell.clone(),
            hidden: Vec::new(),
            verdict: String::new(),
            causes: Vec::new(),
            partial_names: 0,
            partial_right: 0,
            ambiguous_with: Vec::new(),
            first: false,
            in_group: 0,
            equivalent: false,
            parameter_error: None,
            covered: None,
            predicted: None,
            realised: None,
            proposed: None,
            hopeless: false,
            settled: None,
            ratio: None,
            engine_s: 0.0,
        }
    }

    /// Returns whether the plant could show the requested size.
    pub fn shown(&self) -> bool {
        !self.verdict.is_empty()
    }

    /// Returns whether the engine found anything.
    pub fn detected(&self) -> bool {
        self.verdict != Verdict::None.name()
    }

    /// Returns whether the engine reports an unknown cause, alone or beside others.
    pub fn unknown(&self) -> bool {
        self.detected() && self.causes.is_empty()
    }

    /// Returns whether the engine names causes of which none is hidden or equivalent.
    pub fn wrong(&self) -> bool {
        !self.causes.is_empty() && self.in_group == 0 && !self.equivalent
    }

    /// Returns whether the first cause is hidden, or equivalent to the hidden one.
    pub fn right(&self) -> bool {
        let is_hidden = |n: &Named| self.hidden.iter().any(|h| n.is(h));
        self.equivalent || self.causes.first().is_some_and(is_hidden)
    }

    /// Returns the number of effects in the answer.
    pub fn group(&self) -> usize {
        self.causes.len() + self.ambiguous_with.len()
    }

    /// Scores an answer against the label.
    pub fn score(&mut self, answer: &Diagnosis, hidden: &[HiddenEffect]) {
        self.verdict = answer.verdict.name().into();
        self.hidden = hidden.to_vec();
        let named = |effect: &String, channel: Option<bench::Channel>, probability: f64| Named {
            effect: effect.clone(),
            channel: channel.map(|c| c.name().to_owned()),
            probability,
        };
        let causes: Vec<Named> =
            answer.causes.iter().map(|c| named(&c.effect, c.channel, c.probability)).collect();
        if answer.verdict == Verdict::Partial {
            self.partial_names = causes.len();
            self.partial_right = causes.iter().filter(|n| hidden.iter().any(|h| n.is(h))).count();
        } else if matches!(answer.verdict, Verdict::Named | Verdict::Ambiguous) {
            self.causes = causes;
            let others = answer.ambiguous_with.iter();
            self.ambiguous_with = others.map(|c| named(&c.effect, c.channel, c.probability)).collect();
        }
        let group: Vec<&Named> = self.causes.iter().chain(&self.ambiguous_with).collect();
        self.in_group = hidden.iter().filter(|h| group.iter().any(|n| n.is(h))).count();
        let hit = self.causes.first().zip(hidden.first()).is_some_and(|(n, h)| n.is(h));
        self.first = hit;
        if let (true, Some(cause), [hidden]) = (hit, answer.causes.first(), hidden) {
            let (error, covered) = parameters(cause, hidden);
            (self.parameter_error, self.covered) = (error, covered);
        }
        self.predicted = answer.explained_share.filter(|_| !self.causes.is_empty());
        self.proposed.clone_from(&answer.next_experiment);
        self.hopeless = answer.experiment.as_ref().is_some_and(|e| e.recordings.is_empty());
    }

    /// Decides whether the causes are the hidden effects under other names.
    pub(crate) fn score_equivalence(&mut self, scale: &Scale<'_>, answer: &Diagnosis) {
        if answer.causes.is_empty() || self.in_group + self.partial_right > 0 || self.hidden.is_empty() {
            return;
        }
        let named: Vec<HiddenEffect> = answer.causes.iter().map(as_hidden).collect();
        // An empty answer leaves the effect's full size, so a small effect needs a smaller
        // remainder.
        let is_alike = scale.distance(&self.hidden, &named) < ALIKE.min(0.5 * scale.size(&self.hidden));
        if answer.verdict == Verdict::Partial {
            self.partial_right = if is_alike { self.partial_names } else { 0 };
        } else {
            self.equivalent = is_alike;
        }
    }
}

/// Returns a cause as the generator would hide it.
fn as_hidden(cause: &Cause) -> HiddenEffect {
    HiddenEffect {
        effect: cause.effect.clone(),
        channel: cause.channel.map(|c| c.name().to_owned()),
        parameters: cause.parameters.iter().map(|p| (p.name.clone(), p.value)).collect(),
    }
}

/// Returns the relative error of the size, and whether the interval of the largest parameter
/// contains the truth. Several parameters form a vector.
fn parameters(cause: &Cause, hidden: &HiddenEffect) -> (Option<f64>, Option<bool>) {
    let names = size_parameters(&hidden.effect);
    let found = || cause.parameters.iter().filter(|p| names.contains(&p.name.as_str()));
    // The two parts of a phase are one vector: the right amplitude at the wrong phase is an error.
    let truth: f64 = found().map(|p| hidden.get(&p.name).powi(2)).sum();
    let off: f64 = found().map(|p| (p.value - hidden.get(&p.name)).powi(2)).sum();
    let error = (truth > 0.0).then(|| (off / truth).sqrt());
    let largest = found().max_by(|a, b| hidden.get(&a.name).abs().total_cmp(&hidden.get(&b.name).abs()));
    let covered = largest.map(|p| (p.ci95[0]..=p.ci95[1]).contains(&hidden.get(&p.name)));
    (error, covered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use diagnosis::ParameterEstimate;

    #[test]
    fn a_ripple_of_the_right_amplitude_at_the_wrong_phase_has_an_error() {
        let hidden = HiddenEffect::new("position-ripple", &[("cos_effort", 3.0), ("sin_effort", 4.0)]);
        let error = |cosine: f64, sine: f64| {
            let estimate = |name: &str, value: f64| ParameterEstimate {
                name: name.into(),
                value,
                unit: String::new(),
                ci95: [value - 2.0, value + 2.0],
            };
            let parameters = vec![estimate("cos_effort", cosine), estimate("sin_effort", sine)];
            let cause = Cause {
                effect: "position-ripple".into(),
                channel: None,
                of: None,
                probability: 1.0,
                parameters,
                gain: Vec::new(),
                alternatives: Vec::new(),
            };
            super::parameters(&cause, &hidden)
        };
        assert_eq!(error(3.0, 4.0), (Some(0.0), Some(true)));
        // A quarter turn off: the distance is the square root of two times the size.
        assert!((error(-4.0, 3.0).0.unwrap() - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!((error(3.3, 4.4).0.unwrap() - 0.1).abs() < 1e-12);
    }
}
