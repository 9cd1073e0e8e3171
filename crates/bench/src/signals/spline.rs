//! Cubic splines through points: curves with two continuous derivatives.
//!
//! An open spline has no third-derivative jump at its second and its last but one point
//! ("not-a-knot"), so that it reproduces cubics; a periodic one continues after its period with all
//! derivatives. Both are exact as nodes of [`Profile::Curve`](super::Profile), because a
//! cubic follows from its values and slopes.

use super::Motion;

/// Nodes of the open spline through values at ascending times. Fewer than four points have no
/// second derivative at the ends.
pub(crate) fn open(time_s: &[f64], values: &[f64]) -> Vec<Motion> {
    let count = time_s.len().min(values.len());
    if count < 3 {
        let slope = if count == 2 { (values[1] - values[0]) / (time_s[1] - time_s[0]) } else { 0.0 };
        let node = |value: &f64| Motion { value: *value, rate: slope, acceleration: 0.0 };
        return values.iter().take(count).map(node).collect();
    }
    let (steps, slopes) = intervals(time_s, values);
    let inner = count - 2;
    let mut lower: Vec<f64> = (0..inner).map(|i| steps[i]).collect();
    let mut middle: Vec<f64> = (0..inner).map(|i| 2.0 * (steps[i] + steps[i + 1])).collect();
    let mut upper: Vec<f64> = (0..inner).map(|i| steps[i + 1]).collect();
    // The second derivative at an end is extrapolated from the next two points.
    let (first_ratio, last_ratio) = (steps[0] / steps[1], steps[inner] / steps[inner - 1]);
    if inner > 1 {
        middle[0] += steps[0] * (1.0 + first_ratio);
        upper[0] -= steps[0] * first_ratio;
        middle[inner - 1] += steps[inner] * (1.0 + last_ratio);
        lower[inner - 1] -= steps[inner] * last_ratio;
    }
    let right: Vec<f64> = (0..inner).map(|i| 6.0 * (slopes[i + 1] - slopes[i])).collect();
    let solved = tridiagonal(&lower, &middle, &upper, right);
    let beyond = |near: f64, far: f64, ratio: f64| near + ratio * (near - far);
    let (start, end) = if inner > 1 {
        (beyond(solved[0], solved[1], first_ratio), beyond(solved[inner - 1], solved[inner - 2], last_ratio))
    } else {
        (0.0, 0.0)
    };
    let second: Vec<f64> = [start].into_iter().chain(solved).chain([end]).collect();
    let last = count - 1;
    let rate = |i: usize| {
        if i < last {
            slopes[i] - steps[i] * (2.0 * second[i] + second[i + 1]) / 6.0
        } else {
            slopes[i - 1] + steps[i - 1] * (second[i - 1] + 2.0 * second[i]) / 6.0
        }
    };
    (0..count).map(|i| Motion { value: values[i], rate: rate(i), acceleration: second[i] }).collect()
}

/// Nodes of the periodic spline through values at ascending times within a period. The node after
/// the last one equals the first, a period later; it is included.
pub(crate) fn periodic(time_s: &[f64], values: &[f64], period_s: f64) -> (Vec<f64>, Vec<Motion>) {
    let count = time_s.len().min(values.len());
    let mut times = time_s[..count].to_vec();
    let mut closed = values[..count].to_vec();
    let (Some(&first_s), Some(&first)) = (times.first(), closed.first()) else { return (times, Vec::new()) };
    times.push(first_s + period_s);
    closed.push(first);
    let (steps, slopes) = intervals(&times, &closed);
    let before = |i: usize| (i + count - 1) % count;
    let lower: Vec<f64> = (0..count).map(|i| steps[before(i)]).collect();
    let upper: Vec<f64> = steps.clone();
    let middle: Vec<f64> = (0..count).map(|i| 2.0 * (steps[before(i)] + steps[i])).collect();
    let right: Vec<f64> = (0..count).map(|i| 6.0 * (slopes[i] - slopes[before(i)])).collect();
    let second = cyclic(&lower, &middle, &upper, &right);
    let node = |i: usize| {
        let (here, next) = (second[i % count], second[(i + 1) % count]);
        let rate = slopes[i % count] - steps[i % count] * (2.0 * here + next) / 6.0;
        Motion { value: closed[i], rate, acceleration: here }
    };
    (times, (0..=count).map(node).collect())
}

/// Lengths and mean slopes of the intervals.
fn intervals(time_s: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    let slopes = values.windows(2).zip(&steps).map(|(w, step)| (w[1] - w[0]) / step).collect();
    (steps, slopes)
}

/// Solves a tridiagonal system (Thomas); the first of `lower` and the last of `upper` are not used.
fn tridiagonal(lower: &[f64], middle: &[f64], upper: &[f64], mut right: Vec<f64>) -> Vec<f64> {
    let mut diagonal = middle.to_vec();
    for i in 1..right.len() {
        let factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        right[i] -= factor * right[i - 1];
    }
    for i in (0..right.len()).rev() {
        let after = if i + 1 < right.len() { upper[i] * right[i + 1] } else { 0.0 };
        right[i] = (right[i] - after) / diagonal[i];
    }
    right
}

/// Solves a cyclic tridiagonal system (Sherman and Morrison) of three equations or more; with two
/// the neighbours on both sides are the same one.
fn cyclic(lower: &[f64], middle: &[f64], upper: &[f64], right: &[f64]) -> Vec<f64> {
    let count = right.len();
    if count == 1 {
        return vec![0.0];
    }
    if count == 2 {
        let (across0, across1) = (lower[0] + upper[0], lower[1] + upper[1]);
        let determinant = middle[0] * middle[1] - across0 * across1;
        return vec![
            (right[0] * middle[1] - across0 * right[1]) / determinant,
            (middle[0] * right[1] - across1 * right[0]) / determinant,
        ];
    }
    let last = count - 1;
    let (corner_up, corner_down) = (lower[0], upper[last]);
    let gamma = -middle[0];
    let mut diagonal = middle.to_vec();
    diagonal[0] -= gamma;
    diagonal[last] -= corner_up * corner_down / gamma;
    let mut column = vec![0.0; count];
    (column[0], column[last]) = (gamma, corner_down);
    let plain = tridiagonal(lower, &diagonal, upper, right.to_vec());
    let corner = tridiagonal(lower, &diagonal, upper, column);
    let factor =
        (plain[0] + corner_up * plain[last] / gamma) / (1.0 + corner[0] + corner_up * corner[last] / gamma);
    plain.iter().zip(&corner).map(|(p, c)| p - factor * c).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::Profile;

    #[test]
    fn an_open_spline_reproduces_a_cubic_and_converges_to_a_sine() {
        let times = [0.0, 0.4, 1.0, 1.5, 3.0, 3.2];
        let cubic = |t: f64| 2.0 - 3.0 * t + 0.5 * t * t - 0.7 * t * t * t;
        let nodes = open(&times, &times.map(cubic));
        for (t, node) in times.iter().zip(nodes) {
            assert!((node.rate - (-3.0 + t - 2.1 * t * t)).abs() < 1e-11, "{node:?}");
            assert!((node.acceleration - (1.0 - 4.2 * t)).abs() < 1e-11, "{node:?}");
        }
        let worst = |count: usize| {
            let times: Vec<f64> = (0..=count).map(|i| 3.0 * i as f64 / count as f64).collect();
            let values: Vec<f64> = times.iter().map(|t| (t + 0.4).sin()).collect();
            let curve = Profile::Curve { nodes: open(&times, &values), time_s: times };
            let off =
                |i: i32| (curve.at(3e-3 * f64::from(i)).value - (3e-3 * f64::from(i) + 0.4).sin()).abs();
            (0..1000).map(off).fold(0.0, f64::max)
        };
        let ratio = worst(20) / worst(40);
        assert!((12.0..22.0).contains(&ratio), "fourth order: {ratio}");
        assert_eq!(
            open(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0])[1],
            Motion { value: 1.0, rate: 0.0, acceleration: -3.0 }
        );
    }

    #[test]
    fn a_periodic_spline_continues_with_all_derivatives() {
        for values in [vec![0.0, 1.0, -0.5, 0.3, 0.9], vec![0.0, 1.0], vec![0.0, 1.0, 0.2]] {
            let times: Vec<f64> = (0..values.len()).map(|i| 0.3 * i as f64 + 0.05 * (i * i) as f64).collect();
            let (times, nodes) = periodic(&times, &values, 2.5);
            let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
            for (a, b) in
                [(first.value, last.value), (first.rate, last.rate), (first.acceleration, last.acceleration)]
            {
                assert!((a - b).abs() < 1e-12, "{first:?} {last:?}");
            }
            // Within every interval, and from the last to the first, the cubics meet smoothly.
            for i in 0..nodes.len() - 1 {
                let (a, b, h) = (nodes[i], nodes[i + 1], times[i + 1] - times[i]);
                let end_rate = a.rate + 0.5 * h * (a.acceleration + b.acceleration);
                let third = (b.acceleration - a.acceleration) / h;
                let end = a.value + h * a.rate + 0.5 * h * h * a.acceleration + h * h * h * third / 6.0;
                assert!((end_rate - b.rate).abs() < 1e-10, "{a:?} {b:?}");
                assert!((end - b.value).abs() < 1e-10, "{a:?} {b:?}");
            }
        }
    }
}
