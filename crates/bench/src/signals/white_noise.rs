//! White noise of a smooth signal, estimated from its deviation from local cubics.
//!
//! The fourth divided difference of five neighbouring samples is 0 for every cubic, at any spacing.
//! A difference that assumes even spacing would take the motion for noise where samples are lost.
//! Scaled to weights of unit square sum, it has the variance of the noise. The median of the
//! squares is used, so that corners, jumps and stops have no influence. If more than half of the
//! squares are 0, the median of the others is used: such a log is at standstill most of the time,
//! or repeats the readings of a slow sensor.

/// Median of the square of a standard normal number.
const MEDIAN_SQUARE: f64 = 0.4549;

/// Deviation of five readings from a cubic, scaled to the variance of their white noise; not finite
/// where times coincide.
fn beyond_a_cubic(times_s: [f64; 5], values: [f64; 5]) -> f64 {
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, (t, value)) in times_s.iter().zip(values).enumerate() {
        let others = times_s.iter().enumerate().filter(|(k, _)| *k != i);
        let weight = 1.0 / others.fold(1.0, |product, (_, other)| product * (t - other));
        sum += weight * value;
        squares += weight * weight;
    }
    sum / squares.sqrt()
}

/// Squared deviations from a cubic of every five neighbours. Neighbours whose times coincide are
/// left out.
pub fn squares(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let five = |(t, v): (&[f64], &[f64])| Some(beyond_a_cubic(t.try_into().ok()?, v.try_into().ok()?));
    let parts = time_s.windows(5).zip(values.windows(5)).filter_map(five);
    parts.map(|part| part * part).filter(|square| square.is_finite()).collect()
}

/// Standard deviation from the median of `squares`; 0 for none. Sorts `squares` in part.
pub fn deviation(squares: &mut [f64]) -> f64 {
    if squares.is_empty() {
        return 0.0;
    }
    let middle = squares.len() / 2;
    let (_, median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    (*median / MEDIAN_SQUARE).sqrt()
}

/// White noise of a signal at ascending times, one standard deviation; above 0.
pub(crate) fn estimate(time_s: &[f64], values: &[f64]) -> f64 {
    let mut squares = squares(time_s, values);
    let size = values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
    let rounding = (1e-14 * size).max(f64::MIN_POSITIVE);
    let found = deviation(&mut squares);
    if found > rounding {
        return found;
    }
    squares.retain(|square| *square > rounding * rounding);
    deviation(&mut squares).max(rounding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// A stroke of 0.15 m between standstills of a quarter of the time, 200 samples per second, one
    /// in 30 lost.
    fn stroke(noise: f64) -> (Vec<f64>, Vec<f64>) {
        let mut draw = ChaCha8Rng::seed_from_u64(3);
        let times: Vec<f64> =
            (0..4000).filter(|i| i % 31 != 7 && i % 29 != 3).map(|i| 0.005 * f64::from(i)).collect();
        let place = |t: &f64| 0.15 * (4.0 * (t.rem_euclid(4.0) / 4.0 - 0.5)).clamp(-1.0, 1.0).powi(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut draw) };
        let values = times.iter().map(|t| place(t) + noise * normal()).collect();
        (times, values)
    }

    #[test]
    fn gaps_and_corners_do_not_count_as_noise() {
        let (times, values) = stroke(1e-5);
        let found = estimate(&times, &values);
        assert!((found / 1e-5 - 1.0).abs() < 0.1, "{found:e}");
    }

    #[test]
    fn a_log_mostly_at_standstill_has_the_noise_of_its_steps() {
        let times: Vec<f64> = (0..400).map(f64::from).collect();
        let rounded: Vec<f64> =
            times.iter().map(|t| if *t < 300.0 { 2.0 } else { (t * 0.04).round() }).collect();
        let found = estimate(&times, &rounded);
        assert!((0.1..1.0).contains(&found), "{found}");
        // A slow sensor whose readings repeat over twenty rows.
        let mut draw = ChaCha8Rng::seed_from_u64(5);
        let readings: Vec<f64> = (0..40).map(|_| StandardNormal.sample(&mut draw)).collect();
        let held: Vec<f64> = (0..400).map(|i| readings[i / 20]).collect();
        let found = estimate(&times, &held);
        assert!((0.2..2.0).contains(&found), "{found}");
        assert!(
            estimate(&times, &[0.0; 400]) > 0.0
                && estimate(&times[..3], &held[..3]) > 0.0
                && estimate(&[], &[]) > 0.0
        );
    }

    proptest! {
        #[test]
        fn a_cubic_has_none_at_any_spacing(
            gaps in prop::array::uniform5(0.1..10.0_f64),
            c in prop::array::uniform4(-5.0..5.0_f64),
        ) {
            let mut t = 0.0;
            let times = gaps.map(|gap| { t += gap; t });
            let values = times.map(|t| c[0] + t * (c[1] + t * (c[2] + t * c[3])));
            let size = values.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
            prop_assert!(beyond_a_cubic(times, values).abs() < 1e-9 * size);
        }
    }
}
