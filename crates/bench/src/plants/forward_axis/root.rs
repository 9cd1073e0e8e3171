//! Root of a function whose slope is known to be no smaller than a given one.

/// Maximum argument.
pub(super) const MAX_SPEED: f64 = 1e9;
/// Maximum number of steps of a search.
const MAX_SEARCH: usize = 300;
/// A bisection takes the place of every third secant.
const BISECTION_EVERY: usize = 3;

/// Root of a function near a guess. The inertia's `slope` is the smallest one if friction does not
/// fall with speed, so the first step reaches or passes the root.
pub(super) fn root(f: impl Fn(f64) -> f64, guess: f64, slope: f64, tolerance: f64) -> f64 {
    let (mut a, mut fa) = (guess, f(guess));
    let mut step = (-fa / slope).clamp(-MAX_SPEED, MAX_SPEED);
    if fa == 0.0 || step.abs() <= tolerance {
        return guess + step;
    }
    let (mut b, mut fb) = (a + step, f(a + step));
    while fa * fb > 0.0 && b.abs() < MAX_SPEED {
        (a, fa) = (b, fb);
        step *= 2.0;
        b = (a + step).clamp(-MAX_SPEED, MAX_SPEED);
        fb = f(b);
    }
    if fa * fb > 0.0 {
        return b;
    }
    // The Illinois form of the secant; a bisection now and then bounds the number of steps.
    for count in 1..=MAX_SEARCH {
        let width = (b - a).abs();
        if fb.abs() <= slope * tolerance || fb == 0.0 {
            return b;
        }
        if width <= tolerance.max(4.0 * f64::EPSILON * a.abs().max(b.abs())) {
            return 0.5 * (a + b);
        }
        let secant = b - fb * ((b - a) / (fb - fa));
        let is_inside = (secant - a) * (secant - b) < 0.0;
        let c = if count % BISECTION_EVERY == 0 || !is_inside { 0.5 * (a + b) } else { secant };
        let fc = f(c);
        if fc * fb <= 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (c, fc);
    }
    b
}
