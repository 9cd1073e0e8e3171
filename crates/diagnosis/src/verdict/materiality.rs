//! Causes too small to matter.
//!
//! In a long log the smallest deviation is significant. A cause that changes no measured channel by
//! more than [`tuning::MATERIAL_SHARE`] of the channel's noise is a note and no fault.

use super::explanation::Explanation;
use super::tuning;
use crate::check::{Finding, Severity};
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::digits::four_digits;
use bench::Channel;

/// The channel that cause `which` changes most, and the rms of this change in units of the noise
/// floor; everything else is fitted again without the cause.
fn largest_change(
    data: &Data,
    floors: &NoiseModel,
    explanation: &Explanation,
    which: usize,
) -> Option<(Channel, f64)> {
    let without = explanation.without.get(which)?;
    let change = |channel: Channel| {
        let (mut sum, mut count) = (0.0, 0usize);
        let columns = data.blocks.iter().zip(without.iter().zip(&explanation.residual));
        for (_, (before, after)) in columns.filter(|(b, _)| b.channel == channel) {
            sum += before.iter().zip(after).map(|(b, a)| (b - a).powi(2)).sum::<f64>();
            count += before.len();
        }
        (channel, (sum / count.max(1) as f64).sqrt() / floors.channel(channel).floor)
    };
    data.channels.iter().map(|&channel| change(channel)).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns whether a cause changes no channel by more than [`tuning::MATERIAL_SHARE`] of its noise.
pub(crate) fn is_immaterial(
    data: &Data,
    floors: &NoiseModel,
    explanation: &Explanation,
    which: usize,
) -> bool {
    largest_change(data, floors, explanation, which).is_some_and(|(_, share)| share <= tuning::MATERIAL_SHARE)
}

/// A note about a cause that is immaterial.
pub(crate) fn note(
    data: &Data,
    floors: &NoiseModel,
    explanation: &Explanation,
    which: usize,
) -> Option<Finding> {
    let (channel, share) = largest_change(data, floors, explanation, which)?;
    let (candidate, _) = explanation.causes.get(which)?;
    let estimates = explanation.model.effect_parameters(which).into_iter().map(|i| {
        let p = &explanation.model.parameters[i];
        format!("{} = {} {}", p.name(), four_digits(p.value(explanation.z[i])), p.unit)
    });
    let found = format!(
        "{} ({}) changes no channel by more than {:.0} % of its noise",
        candidate.kind.name,
        estimates.collect::<Vec<_>>().join(", "),
        100.0 * tuning::MATERIAL_SHARE
    );
    let finding = Finding::new(Severity::Note, "description", channel.name(), "immaterial", found);
    Some(finding.evidence("change_over_noise", share))
}
