//! Description of a residual: the quantity that its mean varies with most.

use super::tuning;
use crate::data::features::{Bin, FEATURES, Feature, bins, explained_power};
use crate::data::logs::{Columns, Data};
use crate::digits::{four_digit_range, four_digits};
use bench::Channel;

/// Returns the name of that quantity, and a clause with the ranges of it in which the residual of a
/// channel is largest and smallest.
pub(crate) fn describe(data: &Data, residual: &Columns, channel: Channel) -> (&'static str, String) {
    let binned: Vec<(&Feature, Vec<Bin>, f64)> = FEATURES
        .iter()
        .filter_map(|feature| {
            let bins = bins(data, residual, channel, feature)?;
            let power = explained_power(&bins);
            Some((feature, bins, power))
        })
        .collect();
    let max = binned.iter().map(|b| b.2).fold(0.0, f64::max);
    let Some((feature, bins, _)) = binned.iter().find(|b| b.2 >= tuning::SIMPLER_FEATURE_SHARE * max) else {
        return ("none", "spread evenly".into());
    };
    let low = bins.iter().min_by(|a, b| a.mean.total_cmp(&b.mean));
    let high = bins.iter().max_by(|a, b| a.mean.total_cmp(&b.mean));
    let unit = channel.unit();
    let description = match (low, high) {
        (Some(low), Some(high)) => format!(
            "varies with {}: mean residual {} {unit} at {} and {} {unit} at {}",
            feature.name,
            four_digits(high.mean),
            range_text(high, feature.name),
            four_digits(low.mean),
            range_text(low, feature.name),
        ),
        _ => String::new(),
    };
    (feature.name, description)
}

fn range_text(bin: &Bin, feature: &str) -> String {
    match feature {
        "direction" if bin.to > 0.0 => "forward motion".into(),
        "direction" if bin.to < 0.0 => "backward motion".into(),
        "direction" | "speed" if bin.from == 0.0 && bin.to == 0.0 => "standstill".into(),
        _ => four_digit_range(bin.from, bin.to),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_described_by_their_range_or_direction() {
        let bin = |from, to| Bin { from, to, mean: 1.0, count: 1.0 };
        assert_eq!(range_text(&bin(0.0, 0.0), "direction"), "standstill");
        assert_eq!(range_text(&bin(-1.0, -1.0), "direction"), "backward motion");
        assert_eq!(range_text(&bin(0.0, 0.0), "speed"), "standstill");
        assert_eq!(range_text(&bin(0.0, 0.2), "speed"), "0 to 0.2000");
        assert_eq!(range_text(&bin(0.0, 0.0), "load"), "0");
    }
}
