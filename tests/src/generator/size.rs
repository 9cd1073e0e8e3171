//! Size of a hidden effect, on one scale for every effect and plant.
//!
//! Size = rms of the part of the effect that calibration cannot absorb / rms of the noise floor.
//! The generator simulates a record with and without the effect, without noise and with the same
//! nuisance parameters. Every reading counts in units of its sensor's floor (noise and resolution).
//! The rms goes over all samples of all channels, after the landing of the transmission bench's
//! journal. An effect on one of `k` channels is therefore larger by the square root of `k` on that
//! channel. Calibration can absorb what the declared-uncertain parameters can imitate, each within
//! [`MAX_DEVIATIONS`] declared deviations of its description.

use super::hidden::HiddenEffect;
use super::planar;
use super::record::Record;

/// Deviations by which calibration may move a parameter. A larger move is a finding.
pub const MAX_DEVIATIONS: f64 = 4.0;
/// Step of the finite differences, in deviations; central on the transmission bench.
const STEP: f64 = 0.5;
const SWEEPS: usize = 400;
/// Calibration steps on the transmission bench, all with the sensitivities at the start.
const CALIBRATION_STEPS: usize = 5;

/// A record without effects, with its sensitivity to the uncertain parameters.
pub struct Scale<'a> {
    record: &'a Record,
    base: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn rms(values: &[f64]) -> f64 {
    (dot(values, values) / values.len().max(1) as f64).sqrt()
}

impl<'a> Scale<'a> {
    /// Simulates the record without effects, and with each uncertain parameter moved.
    pub fn new(record: &'a Record) -> Self {
        let base = stacked(record, &record.off, &[]);
        let by = |i: usize, step: f64| {
            let mut off = record.off.clone();
            off[i] += step;
            stacked(record, &off, &[])
        };
        let moved = |i: usize| {
            let (ahead, before, span) = if record.plant.is_transmission() {
                (by(i, 0.5 * STEP), by(i, -0.5 * STEP), STEP)
            } else {
                (by(i, STEP), base.clone(), STEP)
            };
            difference(&ahead, &before).iter().map(|d| d / span).collect()
        };
        let columns = (0..record.off.len()).map(moved).collect();
        Self { record, base, columns }
    }

    /// Returns the readings without effects and noise, in units of the floors.
    pub fn base(&self) -> &[f64] {
        &self.base
    }

    /// Returns the change of the readings by effects, in units of the floors.
    pub fn response(&self, hidden: &[HiddenEffect]) -> Vec<f64> {
        difference(&stacked(self.record, &self.record.off, hidden), &self.base)
    }

    /// Returns the part of `added` that calibration and free factors on `others` leave.
    pub fn residual(&self, added: &[f64], others: &[Vec<f64>]) -> Vec<f64> {
        self.calibrated(added, others, &vec![0.0; self.columns.len()]).0
    }

    /// Returns the remainder of `added` after calibration from given deviations and with free
    /// factors on `others`, and the moves of all of them.
    fn calibrated(&self, added: &[f64], others: &[Vec<f64>], from: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let columns: Vec<&Vec<f64>> = self.columns.iter().chain(others).collect();
        let bounds = |i: usize| {
            let gone = from.get(i).zip(self.record.off.get(i)).map(|(z, off)| z + off);
            gone.map_or([f64::NEG_INFINITY, f64::INFINITY], |z| [-MAX_DEVIATIONS - z, MAX_DEVIATIONS - z])
        };
        let gram: Vec<Vec<f64>> =
            columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect();
        let right: Vec<f64> = columns.iter().map(|c| dot(c, added)).collect();
        let mut z = vec![0.0; columns.len()];
        for _ in 0..SWEEPS {
            for i in 0..z.len() {
                if gram[i][i] > 0.0 {
                    let residual = right[i] - dot(&gram[i], &z) + gram[i][i] * z[i];
                    let [least, most] = bounds(i);
                    z[i] = (residual / gram[i][i]).clamp(least, most);
                }
            }
        }
        let mut left = added.to_vec();
        for (column, z) in columns.iter().zip(&z) {
            left.iter_mut().zip(column.iter()).for_each(|(l, c)| *l -= z * c);
        }
        (left, z)
    }

    /// Returns the size of effects.
    pub fn size(&self, hidden: &[HiddenEffect]) -> f64 {
        self.distance(hidden, &[])
    }

    /// Returns the rms that calibration leaves between a plant with hidden effects and one with
    /// `named` effects.
    ///
    /// An axis responds linearly to its parameters, and the named effects get free factors. The
    /// transmission bench does not: each parameter shifts the instant at which friction changes its
    /// sign. A calibrated bench can imitate that; a sum of small responses cannot. There the
    /// calibration is carried out in several steps.
    pub fn distance(&self, hidden: &[HiddenEffect], named: &[HiddenEffect]) -> f64 {
        let added = self.response(hidden);
        if !self.record.plant.is_transmission() {
            let named: Vec<_> = named.iter().map(|n| self.response(std::slice::from_ref(n))).collect();
            return rms(&self.residual(&added, &named));
        }
        let residual = |z: &[f64]| {
            let off: Vec<f64> = self.record.off.iter().zip(z).map(|(off, z)| off + z).collect();
            difference(&added, &difference(&stacked(self.record, &off, named), &self.base))
        };
        // An effect that moves a described parameter is first imitated by this parameter, within
        // its limits.
        let mut z = vec![0.0; self.columns.len()];
        let deviations = self.record.plant.deviations();
        let off: Vec<f64> = self.record.off.iter().zip(deviations).map(|(off, d)| off * d).collect();
        for (effects, sign) in [(hidden, 1.0), (named, -1.0)] {
            for (i, by) in effects.iter().filter_map(|e| planar::moved_number(&off, e)) {
                let off = self.record.off[i];
                z[i] = (z[i] + sign * by / deviations[i]).clamp(-MAX_DEVIATIONS - off, MAX_DEVIATIONS - off);
            }
        }
        let mut left = residual(&z);
        let mut least = rms(&left).min(rms(&added));
        for _ in 0..CALIBRATION_STEPS {
            let (_, step) = self.calibrated(&left, &[], &z);
            z.iter_mut().zip(step).for_each(|(z, step)| *z += step);
            left = residual(&z);
            if !rms(&left).is_finite() {
                break;
            }
            least = least.min(rms(&left));
        }
        least
    }

    /// Returns the magnitude at which `effect` has the requested size; `None` if the plant cannot
    /// show it within `most`.
    pub fn magnitude(
        &self,
        effect: impl Fn(f64) -> HiddenEffect,
        guess: f64,
        most: f64,
        wanted: f64,
    ) -> Option<f64> {
        if wanted <= 0.0 {
            return Some(0.0);
        }
        let over = |m: f64| self.size(&[effect(m)]).max(1e-6 * wanted).ln() - wanted.ln();
        // Bracket by factors of 2, then the Illinois variant of regula falsi on logarithms.
        let (mut low, mut high) = (guess, guess);
        let (mut under, mut above) = (over(guess), f64::NAN);
        if under > 0.0 {
            (above, high) = (under, guess);
            for _ in 0..40 {
                low *= 0.5;
                under = over(low);
                if under <= 0.0 {
                    break;
                }
                (above, high) = (under, low);
            }
        } else {
            for _ in 0..40 {
                high = (high * 2.0).min(most);
                above = over(high);
                if above >= 0.0 || high >= most {
                    break;
                }
                (under, low) = (above, high);
            }
        }
        if !(under <= 0.0 && above >= 0.0) {
            return None;
        }
        let mut last = 0;
        for _ in 0..40 {
            let at = (low.ln() - under * (high.ln() - low.ln()) / (above - under)).exp();
            let here = over(at);
            if here.abs() < 2e-3 {
                return Some(at);
            }
            if here < 0.0 {
                (low, under) = (at, here);
                above *= if last < 0 { 0.5 } else { 1.0 };
                last = -1;
            } else {
                (high, above) = (at, here);
                under *= if last > 0 { 0.5 } else { 1.0 };
                last = 1;
            }
        }
        None
    }
}

fn stacked(record: &Record, off: &[f64], hidden: &[HiddenEffect]) -> Vec<f64> {
    let sensors = record.sensors();
    let floor = |c: &str| sensors.iter().find(|s| s.channel == c).map_or(1.0, |s| s.floor());
    let floors = record.plant.outputs().iter().map(|c| floor(c));
    let landing = (record.plant.landing_s() * record.logger.rate_hz).round() as usize;
    let readings = record.readings(off, hidden);
    readings.iter().zip(floors).flat_map(|(v, f)| v.iter().skip(landing).map(move |v| v / f)).collect()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::noise::Noise;
    use crate::generator::plant::Plant;
    use crate::generator::record::Point;

    fn record() -> Record {
        Record::draw(Plant::Linear, 0.8, Point::default(), &mut Noise::new(7))
    }

    #[test]
    fn an_offset_has_the_size_that_is_left_of_it() {
        let record = record();
        let scale = Scale::new(&record);
        let floor = (9.0_f64 + 0.09 / 12.0).sqrt();
        let offset = |m: f64| HiddenEffect::for_sensor("sensor-offset", "drive_force_n", "offset", m);
        let size = scale.size(&[offset(10.0 * floor)]);
        // The gain of the load absorbs a part: at most 4 deviations of .6 N each.
        assert!(size < 10.0 && size > 9.0, "{size}");
        let found = scale.magnitude(offset, 1.0, 1e9, 2.0).unwrap();
        assert!((scale.size(&[offset(found)]) - 2.0).abs() < 0.01);
    }

    #[test]
    fn what_calibration_may_move_has_no_size() {
        let record = record();
        let scale = Scale::new(&record);
        let coulomb = |m: f64| HiddenEffect::new("coulomb-level", &[("coulomb_effort", m)]);
        assert!(scale.size(&[coulomb(3.9 * 0.6)]) < 1e-3);
        assert!(scale.size(&[coulomb(8.0 * 0.6)]) > 0.1);
    }

    #[test]
    fn a_size_out_of_reach_is_none() {
        let record = record();
        let coulomb = |m: f64| HiddenEffect::new("coulomb-level", &[("coulomb_effort", m)]);
        assert_eq!(Scale::new(&record).magnitude(coulomb, 1.0, 2.0, 1.0), None);
    }

    #[test]
    fn what_the_transmission_bench_may_be_off_by_has_no_size() {
        let record = Record::draw(Plant::Bench, 0.5, Point::default(), &mut Noise::new(7));
        let scale = Scale::new(&record);
        let one = |effect: &str, name: &str, value: f64| {
            let mut hidden = HiddenEffect::new(effect, &[]);
            hidden.parameters.insert(name.into(), value);
            [hidden]
        };
        // Up to three of the four declared deviations.
        for hidden in [
            one("clearance-wear", "clearance_increase_m", -5e-6),
            one("clearance-wear", "clearance_increase_m", 30e-6),
            one("coulomb-level", "relative_change", 0.09),
            one("inertia-mismatch", "relative_change", 0.15),
            one("contact-stiffness", "relative_change", -0.15),
            one("lever-ratio", "relative_change", 0.009),
        ] {
            let (before, size) = (rms(&scale.response(&hidden)), scale.size(&hidden));
            assert!(before > 5.0 && size < 0.3, "{hidden:?}: {size} of {before}");
        }
        assert!(scale.size(&one("clearance-wear", "clearance_increase_m", 60e-6)) > 1.0, "six deviations");
    }
}
