//! Adam (Kingma and Ba, 2015) with a cosine learning rate.

/// Decay rates of the two moments: the authors' defaults.
const BETA: [f64; 2] = [0.9, 0.999];
const EPSILON: f32 = 1e-8;
/// Lowest learning rate divided by the highest.
const LOWEST: f64 = 1e-3;

/// Adam's moments.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Adam {
    pub(super) mean: Vec<f32>,
    pub(super) square: Vec<f32>,
    pub(super) steps: u64,
}

impl Adam {
    pub(super) fn new(parameters: usize) -> Self {
        Self { mean: vec![0.0; parameters], square: vec![0.0; parameters], steps: 0 }
    }

    /// Takes one step against the gradients; `free` is 0 for parameters that must not change.
    pub(super) fn step(
        &mut self,
        parameters: &mut [f32],
        gradients: &[f32],
        free: Option<&[f32]>,
        rate: f64,
    ) {
        self.steps += 1;
        let powers = BETA.map(|beta| 1.0 - libm::pow(beta, self.steps as f64));
        let rate = (rate * libm::sqrt(powers[1]) / powers[0]) as f32;
        let [b1, b2] = BETA.map(|beta| beta as f32);
        let moments = self.mean.iter_mut().zip(&mut self.square);
        for (((parameter, gradient), (mean, square)), index) in
            parameters.iter_mut().zip(gradients).zip(moments).zip(0..)
        {
            *mean = b1 * *mean + (1.0 - b1) * gradient;
            *square = b2 * *square + (1.0 - b2) * gradient * gradient;
            let free = free.and_then(|free| free.get::<usize>(index)).copied().unwrap_or(1.0);
            *parameter -= free * (rate * *mean / (square.sqrt() + EPSILON));
        }
    }
}

/// Learning rate after a share `done` of the steps: a cosine from the highest rate to a thousandth
/// of it.
pub(crate) fn cosine_rate(highest: f64, done: f64) -> f64 {
    let cosine = 0.5 * (1.0 + libm::cos(core::f64::consts::PI * done));
    highest * (LOWEST + (1.0 - LOWEST) * cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_is_the_rate_and_a_quadratic_is_minimised() {
        let (mut adam, mut at) = (Adam::new(2), vec![3.0f32, -2.0]);
        adam.step(&mut at, &[10.0, -0.1], None, 0.01);
        assert!((at[0] - 2.99).abs() < 1e-6 && (at[1] + 1.99).abs() < 1e-6, "{at:?}");
        for step in 0..2000 {
            let gradients: Vec<f32> = at.iter().map(|x| 2.0 * x).collect();
            adam.step(&mut at, &gradients, Some(&[1.0, 0.0]), cosine_rate(0.05, f64::from(step) / 2000.0));
        }
        assert!(at[0].abs() < 1e-3 && (at[1] + 1.99).abs() < 1e-6, "{at:?}");
    }
}
