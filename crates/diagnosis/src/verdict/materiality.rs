//! Causes too small to matter.
//!
//! In a long log the smallest deviation is significant. A cause that in no cycle changes a measured
//! channel by more than [`tuning::MATERIAL_SHARE`] of the channel's noise is a note and no fault.

use super::acceptance::is_acceptable;
use super::explanation::Explanation;
use super::tuning;
use crate::check::{Finding, Severity};
use crate::data::logs::{Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::split::Use;
use crate::digits::four_digits;
use bench::Channel;
use std::collections::BTreeMap;

/// Largest rms difference of two residuals over a cycle of a log, in units of the noise floor, and
/// its channel. A log without cycles counts as one.
pub(crate) fn largest_change(
    data: &Data,
    floors: &NoiseModel,
    before: &Columns,
    after: &Columns,
) -> (Channel, f64) {
    let mut largest = (Channel::Position, 0.0);
    for (block, (before, after)) in data.blocks.iter().zip(before.iter().zip(after)) {
        let phase = data.logs.get(block.log).and_then(|log| log.phase.as_ref());
        let mut cycles: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
        for (i, (b, a)) in before.iter().zip(after).enumerate() {
            if data.uses(block).get(i) == Some(&Use::Skip) {
                continue;
            }
            let cycle = phase.and_then(|p| p.get(i)).map_or(0, |p| p.floor() as i64);
            let (sum, count) = cycles.entry(cycle).or_default();
            *sum += (b - a).powi(2);
            *count += 1.0;
        }
        let floor = floors.channel(block.channel).floor;
        for (sum, count) in cycles.into_values() {
            let share = (sum / count).sqrt() / floor;
            if share > largest.1 {
                largest = (block.channel, share);
            }
        }
    }
    largest
}

/// A note of what changes no channel beyond a small share of its noise; none if it matters.
pub(crate) fn note(what: &str, (channel, share): (Channel, f64)) -> Option<Finding> {
    let found = format!(
        "{what} changes no channel by more than {:.0} % of its noise",
        100.0 * tuning::MATERIAL_SHARE
    );
    let finding = Finding::new(Severity::Note, "description", channel.name(), "immaterial", found);
    (share <= tuning::MATERIAL_SHARE).then(|| finding.evidence("change_over_noise", share))
}

/// Number of accepted causes without the immaterial ones, and notes about these.
///
/// They stay if no examined explanation has the other causes alone.
pub(crate) fn without_immaterial(
    data: &Data,
    floors: &NoiseModel,
    explanations: &[Explanation],
    accepted: usize,
) -> (usize, Vec<Finding>) {
    let explanation = &explanations[accepted];
    let (mut others, mut notes) = (Vec::new(), Vec::new());
    for (which, ((candidate, _), without)) in explanation.causes.iter().zip(&explanation.without).enumerate()
    {
        let change = largest_change(data, floors, without, &explanation.residual);
        match note(&cause_with_parameters(explanation, which), change) {
            Some(note) => notes.push(note),
            None => others.push(candidate.clone()),
        }
    }
    let has_others = |k: &usize| explanations[*k].causes.iter().map(|(c, _)| c).eq(&others);
    let is_accepted = |k: &usize| *k == 0 || is_acceptable(data, &explanations[0], &explanations[*k]);
    match (0..accepted).find(|k| has_others(k) && is_accepted(k)) {
        Some(remaining) if !notes.is_empty() => (remaining, notes),
        _ => (accepted, Vec::new()),
    }
}

/// A cause with its parameters.
fn cause_with_parameters(explanation: &Explanation, which: usize) -> String {
    let estimates = explanation.model.effect_parameters(which).into_iter().map(|i| {
        let p = &explanation.model.parameters[i];
        format!("{} = {} {}", p.name(), four_digits(p.value(explanation.z[i])), p.unit)
    });
    let effect = explanation.causes.get(which).map_or("", |(c, _)| c.kind.name);
    format!("{effect} ({})", estimates.collect::<Vec<_>>().join(", "))
}
