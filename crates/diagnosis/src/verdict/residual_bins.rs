//! Means of the residual over bins of each quantity that it may depend on, before and after the
//! extension.

use crate::data::features::{FEATURES, bins, explained_power};
use crate::data::logs::{Columns, Data};
use crate::data::split::Use;
use bench::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// The residual of a channel over one quantity.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct BinnedResidual {
    /// Channel.
    pub channel: Channel,
    /// Quantity: direction, load, load times direction, speed, position, time or cycle phase.
    pub quantity: &'static str,
    /// Share of the power of the residual before the extension that its means over the bins
    /// explain.
    pub share: f64,
    /// Bins of equal counts, ascending. Equal values, such as every speed at standstill, share a
    /// bin.
    pub bins: Vec<ResidualBin>,
}

/// Mean of measured minus simulated values in one bin, in the unit of the channel.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResidualBin {
    /// Lower end, SI; for a direction -1, 1 or, at standstill, 0.
    pub from: f64,
    /// Upper end, SI.
    pub to: f64,
    /// Residual of the calibrated nominal bench.
    pub before: f64,
    /// Residual of the extended bench.
    pub after: f64,
}

/// Mean square of a channel's residual over the samples in use.
fn power(data: &Data, residual: &Columns, channel: Channel) -> f64 {
    let own = data.blocks.iter().zip(residual).filter(|(block, _)| block.channel == channel);
    let used = own.flat_map(|(block, values)| data.uses(block).iter().zip(values));
    let (sum, count) = used
        .filter(|(used, _)| **used != Use::Skip)
        .fold((0.0, 0.0), |(sum, count), (_, value)| (sum + value * value, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Binned residuals by channel, the quantity that explains most first.
pub(crate) fn binned_residuals(data: &Data, before: &Columns, after: &Columns) -> Vec<BinnedResidual> {
    let mut out = Vec::new();
    for &channel in &data.channels {
        let power = power(data, before, channel);
        let binned = |feature| {
            let (first, last) = (bins(data, before, channel, feature)?, bins(data, after, channel, feature)?);
            let bins = first.iter().zip(&last);
            Some(BinnedResidual {
                channel,
                quantity: feature.name,
                share: if power > 0.0 { explained_power(&first) / power } else { 0.0 },
                bins: bins
                    .map(|(b, a)| ResidualBin { from: b.from, to: b.to, before: b.mean, after: a.mean })
                    .collect(),
            })
        };
        let mut own: Vec<BinnedResidual> = FEATURES.iter().filter_map(binned).collect();
        own.sort_by(|a, b| b.share.total_cmp(&a.share));
        out.extend(own);
    }
    out
}
