//! Initial guesses of shapes that a derivative at size 0 does not show: the time of a step, the
//! frequency or wavelength of a ripple, the limit of a sensor.
//!
//! They are computed from the residual of the fitted base, without simulations. Only a step needs
//! two, for the sensitivity to the effect that changes.

use super::periodogram::{Grid, Spectrum};
use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::fit::least_squares::Fit;
use crate::fit::linear::cholesky;
use crate::fit::model::{Candidate, InitialGuess};
use crate::fit::sensitivities::sensitivities;
use crate::statistics::limits;
use bench::effects::{EffectParameter, Guess, kind};
use bench::simulate::RespondError;
use nalgebra::DVector;

/// Adds guesses to candidates: one copy for each guess. Candidates that need a guess and have none
/// are left out.
pub(crate) fn with_guesses(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    candidates: &[Candidate],
) -> Result<Vec<Candidate>, RespondError> {
    let mut out = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let guesses: Vec<InitialGuess> = match candidate.kind.guess {
            Guess::Defaults => {
                out.push(candidate.clone());
                magnitudes(base, candidate)
            }
            Guess::Onset(reference) => onset(data, noise, base, reference)?.into_iter().collect(),
            Guess::Frequency => frequencies(data, base),
            Guess::Wavelength => wavelengths(data, base),
            Guess::LargestReading => largest_reading(data, candidate).into_iter().collect(),
        };
        out.extend(guesses.into_iter().map(|g| Candidate { guess: Some(g), ..candidate.clone() }));
    }
    Ok(out)
}

/// Guesses of shapes of unknown order of magnitude: each shape a prior standard deviation above and
/// below the centre of its prior, the others at theirs.
///
/// A fit from a distant start would end in a local minimum.
fn magnitudes(base: &Fit, candidate: &Candidate) -> Vec<InitialGuess> {
    let bench = base.model.at(&base.z).common;
    let shapes = candidate.kind.parameters(&bench).iter().filter(|p| p.is_factor);
    let above_and_below = |p: &EffectParameter| {
        let (name, min, max, centre) = (p.name, p.min, base.model.max(p), base.model.centre(p));
        [centre / p.prior, centre * p.prior].map(|value| InitialGuess {
            value: value.clamp(min, max),
            step: 1.0,
            parameter: Some(name),
        })
    };
    shapes.flat_map(above_and_below).collect()
}

/// Guess of a sensor's limit: the largest reading.
fn largest_reading(data: &Data, candidate: &Candidate) -> Option<InitialGuess> {
    let blocks = data.blocks.iter().filter(|b| Some(b.channel) == candidate.channel);
    let largest = blocks.flat_map(|b| &b.measured).fold(0.0_f64, |m, v| m.max(v.abs()));
    (largest > 0.0).then(|| InitialGuess {
        value: 1.0 / largest,
        step: tuning::LIMIT_STEP / largest,
        parameter: None,
    })
}

/// Guess of the time at which a lasting change of the size of `reference` begins: the onset with
/// the highest score.
///
/// The sensitivity to `reference` is set to 0 before the onset and tested as in [`super::score`].
/// Sums over bins of time make all onsets together as inexpensive as one.
fn onset(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    reference: &str,
) -> Result<Option<InitialGuess>, RespondError> {
    let Some(kind) = kind(reference) else { return Ok(None) };
    let model = base.model.with_effect(Candidate { kind, channel: None, of: None, guess: None }, noise);
    let place = base.model.parameters.len();
    if model.parameters.len() != place + 1 {
        return Ok(None);
    }
    let mut z = base.z.clone();
    z.push(0.0);
    let columns = sensitivities(data, noise, &model, &z, &base.simulation, &[place])?;
    let Some(column) = columns.first() else { return Ok(None) };
    let times = data.map_fitted(|log, i| log.inputs.time_s().get(i).copied().unwrap_or_default());
    let (first, last) = limits(times.iter().map(|t| t.1));
    let width = (last - first) / tuning::ONSET_BINS as f64;
    if width.is_nan() || width <= 0.0 {
        return Ok(None);
    }
    let bin_of = |time_s: f64| (((time_s - first) / width) as usize).min(tuning::ONSET_BINS - 1);
    let bins: Vec<usize> = times.iter().map(|(_, t)| bin_of(*t)).collect();
    let best = best_onset(base, &binned_sums(base, column, &bins));
    Ok(best.map(|(low, high)| {
        let gaps = times.windows(2).filter_map(|pair| match pair {
            [(block, t), (next, later)] if block == next => Some(later - t),
            _ => None,
        });
        let gap = gaps.fold(0.0_f64, f64::max);
        InitialGuess {
            value: first + 0.5 * width * (low + high) as f64,
            step: tuning::ONSET_STEP_S.max(gap.min(tuning::MAX_ONSET_STEP_SHARE * (last - first))),
            parameter: None,
        }
    }))
}

/// Sums over samples, given the sensitivity `c` to an effect, the residual `r` and the base's
/// sensitivities `J`.
#[derive(Clone)]
struct Sums {
    /// `c'c`.
    cc: f64,
    /// `c'r`.
    cr: f64,
    /// `J'c`.
    jc: DVector<f64>,
}

impl Sums {
    fn zero(parameters: usize) -> Self {
        Self { cc: 0.0, cr: 0.0, jc: DVector::zeros(parameters) }
    }
}

/// Sums over the samples of each bin of time.
fn binned_sums(base: &Fit, column: &[f64], bins: &[usize]) -> Vec<Sums> {
    let mut sums = vec![Sums::zero(base.jacobian.len()); tuning::ONSET_BINS];
    for (i, (&bin, c)) in bins.iter().zip(column).enumerate() {
        let Sums { cc, cr, jc } = &mut sums[bin];
        *cc += c * c;
        *cr += c * base.residual[i];
        jc.iter_mut().zip(&base.jacobian).for_each(|(sum, j)| *sum += j[i] * c);
    }
    sums
}

/// First and last bin with the highest evidence for an onset: between onsets of equal evidence no
/// sample is fitted.
fn best_onset(base: &Fit, sums: &[Sums]) -> Option<(usize, usize)> {
    let information = cholesky(&base.information_with_bounds_fixed())?;
    let gradient = base.gradient();
    let mut after = Sums::zero(base.jacobian.len());
    let mut best: Option<(f64, usize, usize)> = None;
    for (bin, sum) in sums.iter().enumerate().skip(tuning::FIRST_ONSET_BIN).rev() {
        after.cc += sum.cc;
        after.cr += sum.cr;
        after.jc += &sum.jc;
        let absorbed = information.solve(&after.jc);
        let (survived, g) = (after.cc - absorbed.dot(&after.jc), after.cr - absorbed.dot(&gradient));
        let evidence = g * g / survived;
        if survived <= tuning::MIN_ONSET_SURVIVAL * after.cc {
            continue;
        }
        best = match best {
            Some((max, low, high))
                if low == bin + 1 && (evidence - max).abs() <= tuning::EQUAL_EVIDENCE * max =>
            {
                Some((max, bin, high))
            }
            Some((max, ..)) if evidence <= max => best,
            _ => Some((evidence, bin, bin)),
        };
    }
    best.map(|(_, low, high)| (low, high))
}

/// Guesses of frequencies: the highest peaks of the residual's periodogram over time.
///
/// The first periodogram covers the beginning of the log, the next one the complete log around each
/// peak.
fn frequencies(data: &Data, base: &Fit) -> Vec<InitialGuess> {
    let coordinates = data.map_fitted(|log, i| log.inputs.time_s().get(i).copied().unwrap_or_default());
    let (first, last) = limits(coordinates.iter().map(|t| t.1));
    let span = last - first;
    let rate = coordinates.len() as f64 / data.blocks.len().max(1) as f64 / span;
    let max = tuning::MAX_FREQUENCY_HZ.min(tuning::NYQUIST_SHARE * rate);
    let coarse_s = tuning::COARSE_WINDOW_S.min(span);
    let spectrum = Spectrum { data, base, coordinates };
    let is_at_beginning = |t: f64| t < first + coarse_s;
    let is_any = |_: f64| true;
    let refined = |(channel, coarse): (Option<usize>, f64)| {
        let (low, high) = (coarse - 1.0 / coarse_s, coarse + 1.0 / coarse_s);
        let step = tuning::PERIODOGRAM_STEP / span;
        let around = Grid { from: low.max(tuning::MIN_PERIODS / span), to: high, step };
        let value = spectrum.peak(channel, &is_any, around)?;
        // The phase counts from time 0 of the log's clock, which may be far from the log. A small
        // error of the frequency would then shift the phase of the ripple in the log.
        let finest =
            Grid { from: value - step, to: value + step, step: tuning::FINEST_FREQUENCY_STEP / span };
        let value = spectrum.peak(channel, &is_any, finest).unwrap_or(value);
        Some(InitialGuess {
            value,
            step: tuning::SHAPE_STEP / span.max(first.abs()).max(last.abs()),
            parameter: None,
        })
    };
    let coarse = Grid {
        from: (tuning::MIN_PERIODS / span).max(tuning::MIN_WAVES / coarse_s),
        to: max,
        step: tuning::PERIODOGRAM_STEP / coarse_s,
    };
    spectrum.peaks(&is_at_beginning, coarse).into_iter().filter_map(refined).collect()
}

/// Guesses of wavelengths: the highest peaks of the residual's periodogram over position (the angle
/// of the crank, or the axis' own).
fn wavelengths(data: &Data, base: &Fit) -> Vec<InitialGuess> {
    let described = base.model.at(&base.z).common;
    let lever = described.transmission().map(|bench| bench.geometry.drive_lever_radius_m);
    let at = |x: f64| lever.map_or(x, |r| (x / r).clamp(-1.0, 1.0).asin());
    let coordinates = data.map_fitted(|log, i| {
        if i < tuning::POSITION_SAMPLES {
            at(log.position.get(i).copied().unwrap_or_default())
        } else {
            f64::NAN
        }
    });
    let (low, high) = limits(coordinates.iter().map(|p| p.1).filter(|p| p.is_finite()));
    let span = high - low;
    let spectrum = Spectrum { data, base, coordinates };
    let grid = Grid {
        from: tuning::MIN_WAVES / span,
        to: tuning::MAX_WAVES / span,
        step: tuning::PERIODOGRAM_STEP / span,
    };
    let guess = |(_, waves): (_, f64)| InitialGuess {
        value: 1.0 / waves,
        step: tuning::SHAPE_STEP / (span * waves * waves),
        parameter: None,
    };
    spectrum.peaks(&f64::is_finite, grid).into_iter().map(guess).collect()
}
