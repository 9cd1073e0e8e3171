//! Where the residual lives: its mean over bins of everything that it may depend on, before and after the extension.

use crate::session::{Columns, Data, Use};
use crate::structure::{FEATURES, bins};
use bench::Channel;
use serde::Serialize;

/// The residual of a channel over one quantity.
#[derive(Clone, Debug, Serialize)]
pub struct Place {
    /// Channel.
    pub channel: Channel,
    /// Quantity: direction, load, speed, position, time, cycle phase.
    pub quantity: &'static str,
    /// Share of the power of the residual before that its means over the bins make up.
    pub share: f64,
    /// Bins of equal counts, ascending; what is equal, as every speed at rest, is in one bin.
    pub bins: Vec<PlaceBin>,
}

/// One bin: measured less simulated, mean, in the unit of the channel.
#[derive(Clone, Debug, Serialize)]
pub struct PlaceBin {
    /// Lower end, SI; of a direction -1, 1 or, at rest, 0.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// With the calibrated nominal bench.
    pub before: f64,
    /// With the extended bench.
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

/// All of them, by channel, the quantity that makes up most first.
pub(crate) fn places(data: &Data, before: &Columns, after: &Columns) -> Vec<Place> {
    let mut out = Vec::new();
    for &channel in &data.channels {
        let power = power(data, before, channel);
        let of = |feature| {
            let (first, last) = (bins(data, before, channel, feature)?, bins(data, after, channel, feature)?);
            let total: f64 = first.iter().map(|b| b.count).sum();
            let made_up = first.iter().map(|b| b.count * b.mean * b.mean).sum::<f64>() / total;
            let bins = first.iter().zip(&last);
            Some(Place {
                channel,
                quantity: feature.name,
                share: if power > 0.0 { made_up / power } else { 0.0 },
                bins: bins
                    .map(|(b, a)| PlaceBin { from: b.from, to: b.to, before: b.mean, after: a.mean })
                    .collect(),
            })
        };
        let mut own: Vec<Place> = FEATURES.iter().filter_map(of).collect();
        own.sort_by(|a, b| b.share.total_cmp(&a.share));
        out.extend(own);
    }
    out
}
