//! Shares of draws in which a claim holds, their intervals, and the effect of each parameter.
//!
//! A share has Wilson's 95 % score interval. The effect of a parameter is the difference of two
//! shares: of the draws in the upper half of its range and of those in the lower half, or of the
//! two names of a choice that differ most. Its interval is Newcombe's hybrid score interval
//! (Newcombe 1998, method 10). It is widened so that all parameters together have 95 %
//! (Bonferroni). The intervals assume independent draws; those of a Latin hypercube scatter less.

use super::parameter_box::{BOX, Draw, PARAMETERS, Values};
use schemars::JsonSchema;
use serde::Serialize;

/// Normal quantile of a 95 % interval.
const QUANTILE: f64 = 1.959_964;
/// The same over [`PARAMETERS`] comparisons: two-sided 5 % divided by 9.
const QUANTILE_OVER_PARAMETERS: f64 = 2.772_921;

/// A share with its interval.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
pub struct Share {
    /// Number of draws in which the claim holds.
    pub hits: usize,
    /// Number of draws.
    pub count: usize,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

impl Share {
    /// Counts hits. Without draws the share is 0 and its interval 0 to 1.
    pub fn new(hits: usize, count: usize) -> Self {
        let (low, high) = wilson(hits, count, QUANTILE);
        Self { hits, count, low, high }
    }

    /// The share itself, 0 to 1.
    pub fn value(&self) -> f64 {
        share(self.hits, self.count)
    }
}

fn share(hits: usize, count: usize) -> f64 {
    if count > 0 { hits as f64 / count as f64 } else { 0.0 }
}

/// Wilson's score interval of a share.
fn wilson(hits: usize, count: usize, quantile: f64) -> (f64, f64) {
    if count == 0 {
        return (0.0, 1.0);
    }
    let (n, p, square) = (count as f64, share(hits, count), quantile * quantile);
    let middle = (p + square / (2.0 * n)) / (1.0 + square / n);
    let half = quantile / (1.0 + square / n) * (p * (1.0 - p) / n + square / (4.0 * n * n)).sqrt();
    ((middle - half).max(0.0), (middle + half).min(1.0))
}

/// Difference of two shares with Newcombe's interval: first less second.
fn newcombe(first: (usize, usize), second: (usize, usize), quantile: f64) -> (f64, f64, f64) {
    let ((a, m), (b, n)) = (first, second);
    let (p, q) = (share(a, m), share(b, n));
    let ((low_p, high_p), (low_q, high_q)) = (wilson(a, m, quantile), wilson(b, n, quantile));
    let difference = p - q;
    (difference, difference - (p - low_p).hypot(high_q - q), difference + (high_p - p).hypot(q - low_q))
}

/// Effect of a parameter on the share of a claim.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize)]
pub struct Effect {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Groups that are compared: the second has the larger share if the difference is positive.
    pub groups: [String; 2],
    /// Share in the second group less that in the first, -1 to 1.
    pub difference: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
}

impl Effect {
    /// Returns whether the interval excludes 0.
    pub fn is_significant(&self) -> bool {
        self.low > 0.0 || self.high < 0.0
    }
}

/// Effects of all parameters on a claim, in the order of the box.
pub fn effects(draws: &[(Draw, bool)]) -> Vec<Effect> {
    BOX.iter().enumerate().map(|(number, _)| effect(draws, number)).collect()
}

fn effect(draws: &[(Draw, bool)], number: usize) -> Effect {
    let parameter = BOX.get(number).unwrap_or(&BOX[0]);
    let counted = |belongs: &dyn Fn(f64) -> bool| {
        let of_group = draws.iter().filter(|(draw, _)| belongs(value(draw, number)));
        of_group.fold((0, 0), |(hits, count), (_, holds)| (hits + usize::from(*holds), count + 1))
    };
    let build = |groups: [String; 2], first, second| {
        let (difference, low, high) = newcombe(second, first, QUANTILE_OVER_PARAMETERS);
        Effect { parameter: parameter.name, groups, difference, low, high }
    };
    match parameter.values {
        Values::Between(..) => {
            let is_upper = |value: f64| parameter.values.share(value) >= 0.5;
            let groups = ["lower half".into(), "upper half".into()];
            build(groups, counted(&|v| !is_upper(v)), counted(&is_upper))
        }
        Values::OneOf(names) => {
            let mut options: Vec<(&str, (usize, usize))> = names
                .iter()
                .enumerate()
                .map(|(option, name)| (*name, counted(&|v| v as usize == option)))
                .collect();
            if names.len() > 2 {
                // Stable: options of the same share keep their order.
                options.sort_by(|a, b| share(a.1.0, a.1.1).total_cmp(&share(b.1.0, b.1.1)));
            }
            let (first, last) = (options.first(), options.last());
            let (first, last) = (first.copied().unwrap_or_default(), last.copied().unwrap_or_default());
            build([first.0.into(), last.0.into()], first.1, last.1)
        }
    }
}

fn value(draw: &Draw, number: usize) -> f64 {
    draw.values.get(number).copied().unwrap_or_default()
}

/// The parameter with the largest effect; none if the intervals of all contain 0.
pub(crate) fn deciding(effects: &[Effect]) -> Option<&Effect> {
    let significant = effects.iter().filter(|effect| effect.is_significant());
    significant.max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()))
}

/// Shares over bands of a range: middle of the band and share. Empty for a choice.
pub(crate) fn over_range(draws: &[(Draw, bool)], number: usize, bands: usize) -> Vec<(f64, Share)> {
    let Some(Values::Between(from, to)) = BOX.get(number).map(|p| p.values) else { return Vec::new() };
    let values = Values::Between(from, to);
    let mut counts = vec![(0, 0); bands];
    for (draw, holds) in draws {
        let band = (values.share(value(draw, number)) * bands as f64) as usize;
        if let Some(count) = counts.get_mut(band.min(bands.saturating_sub(1))) {
            *count = (count.0 + usize::from(*holds), count.1 + 1);
        }
    }
    let middle = |band: usize| from * (to / from).powf((band as f64 + 0.5) / bands as f64);
    counts.iter().enumerate().map(|(band, (hits, count))| (middle(band), Share::new(*hits, *count))).collect()
}

const _: () = assert!(PARAMETERS == 9, "the quantile above is for nine parameters");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_the_published_ones() {
        // Newcombe 1998, Statistics in Medicine 17: 857-872 and 873-890.
        let share = Share::new(81, 263);
        assert!((share.low - 0.2553).abs() < 5e-5 && (share.high - 0.3662).abs() < 5e-5, "{share:?}");
        let (difference, low, high) = newcombe((56, 70), (48, 80), QUANTILE);
        assert!((difference - 0.2).abs() < 1e-12);
        assert!((low - 0.0524).abs() < 5e-5 && (high - 0.3339).abs() < 5e-5, "{low} {high}");
        assert_eq!(wilson(0, 0, QUANTILE), (0.0, 1.0));
    }

    #[test]
    fn the_deciding_parameter_is_found_and_chance_decides_nothing() {
        let draws = |holds: &dyn Fn(&Draw) -> bool| -> Vec<(Draw, bool)> {
            (0..400).map(|index| Draw::new(1, index)).map(|draw| (draw, holds(&draw))).collect()
        };
        let period = effects(&draws(&|draw| draw.values[5] > 1.0));
        let decided = deciding(&period).unwrap();
        assert_eq!((decided.parameter, decided.difference), ("period", 1.0));
        let law = effects(&draws(&|draw| draw.values[2] == 1.0));
        let decided = deciding(&law).unwrap();
        assert_eq!((decided.parameter, decided.groups[1].as_str()), ("stiffness", "liu-times-length"));
        let smaller = effects(&draws(&|draw| draw.values[3] < 60.0 || draw.index % 2 == 0));
        let decided = deciding(&smaller).unwrap();
        assert!(decided.parameter == "J" && decided.difference < -0.4, "{decided:?}");
        assert_eq!(deciding(&effects(&draws(&|draw| draw.index % 3 == 0))), None);
        assert_eq!(deciding(&effects(&draws(&|_| true))), None);
    }

    #[test]
    fn bands_divide_a_range_by_its_logarithm() {
        let draws: Vec<(Draw, bool)> =
            (0..400).map(|index| Draw::new(1, index)).map(|draw| (draw, draw.values[5] > 1.0)).collect();
        let bands = over_range(&draws, 5, 10);
        assert_eq!(bands.iter().map(|(_, share)| share.hits).sum::<usize>(), 200);
        assert!(bands.iter().all(|(_, share)| share.count == 40));
        assert!(bands[4].1.hits == 0 && bands[5].1.hits == 40);
        assert!(over_range(&draws, 2, 10).is_empty());
    }
}
