//! Part of a uniformly sampled history within a band of frequencies: Butterworth filters of fourth
//! order, a high pass and a low pass in series, by the bilinear transform (R. Bristow-Johnson,
//! Audio EQ cookbook). At an edge the power is halved; an octave outside it is 1/257.

/// Quality factors of the two sections of a fourth-order Butterworth filter.
const QUALITIES: [f64; 2] = [0.541_196_100_146_197, 1.306_562_964_876_376_6];

/// Second-order section in transposed direct form II.
#[derive(Clone, Copy, Debug)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
    state: [f64; 2],
}

impl Section {
    /// Low pass or high pass with its edge at a share of the sample rate.
    fn new(edge: f64, quality: f64, is_high: bool) -> Self {
        let (sin, cos) = (core::f64::consts::TAU * edge).sin_cos();
        let alpha = sin / (2.0 * quality);
        let (outer, middle) =
            if is_high { (0.5 * (1.0 + cos), -(1.0 + cos)) } else { (0.5 * (1.0 - cos), 1.0 - cos) };
        let a0 = 1.0 + alpha;
        Self {
            b: [outer / a0, middle / a0, outer / a0],
            a: [-2.0 * cos / a0, (1.0 - alpha) / a0],
            state: [0.0; 2],
        }
    }

    fn step(&mut self, input: f64) -> f64 {
        let output = self.b[0] * input + self.state[0];
        self.state[0] = self.b[1] * input - self.a[0] * output + self.state[1];
        self.state[1] = self.b[2] * input - self.a[1] * output;
        output
    }
}

/// Band of frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Band {
    /// Lower edge in Hz.
    pub(crate) low_hz: f64,
    /// Upper edge in Hz; infinite: none.
    pub(crate) high_hz: f64,
}

impl Band {
    /// Part of a history within the band. The history before its first sample counts as constant.
    pub(crate) fn filter(&self, history: &[f64], rate_hz: f64) -> Vec<f64> {
        let high = QUALITIES.map(|quality| Section::new(self.low_hz / rate_hz, quality, true));
        let low = QUALITIES.map(|quality| Section::new(self.high_hz / rate_hz, quality, false));
        let low = if self.high_hz < 0.45 * rate_hz { Some(low) } else { None };
        let mut sections: Vec<Section> = high.into_iter().chain(low.into_iter().flatten()).collect();
        let first = history.first().copied().unwrap_or_default();
        history
            .iter()
            .map(|value| sections.iter_mut().fold(value - first, |value, section| section.step(value)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(band: Band, frequency_hz: f64) -> f64 {
        let wave: Vec<f64> = (0..40_000)
            .map(|i| (core::f64::consts::TAU * frequency_hz * f64::from(i) * 1e-4).sin())
            .collect();
        let filtered = band.filter(&wave, 1e4);
        let tail = &filtered[20_000..];
        (2.0 * tail.iter().map(|v| v * v).sum::<f64>() / tail.len() as f64).sqrt()
    }

    #[test]
    fn a_band_passes_its_middle_halves_the_power_at_its_edges_and_stops_the_rest() {
        let band = Band { low_hz: 30.0, high_hz: 100.0 };
        let closed_form = |f: f64| {
            let (up, down) = ((30.0 / f).powi(8), (f / 100.0).powi(8));
            1.0 / ((1.0 + up) * (1.0 + down)).sqrt()
        };
        for frequency_hz in [5.0, 15.0, 30.0, 50.0, 100.0, 200.0] {
            let (found, expected) = (gain(band, frequency_hz), closed_form(frequency_hz));
            assert!((found - expected).abs() < 0.003, "{frequency_hz} Hz: {found} {expected}");
        }
        assert!(gain(Band { low_hz: 3.0, high_hz: f64::INFINITY }, 1000.0) > 0.999);
    }

    #[test]
    fn a_constant_history_has_no_oscillation() {
        let band = Band { low_hz: 3.0, high_hz: 10.0 };
        assert!(band.filter(&[5.0; 1000], 1e4).iter().all(|v| *v == 0.0));
    }
}
