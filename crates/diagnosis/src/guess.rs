//! First guesses of what a derivative at size 0 does not show: when a step came, at which frequency or wavelength something
//! repeats, where a reading ends. They come from the residual of the fitted base alone, without a simulation of their own
//! (but two for the effect that a step is a step of).

use crate::fit::{Fit, sensitivities};
use crate::linear::factor;
use crate::model::{Candidate, Guessed};
use crate::noise::NoiseModel;
use crate::session::Data;
use crate::spectrum::{FINENESS, Spectrum};
use bench::Bench;
use bench::effects::{EffectParameter, Guess, kind};
use bench::respond::RespondError;
use nalgebra::DVector;

/// Times at which a step may begin: a fit moves an onset by little, so the guess has to be near.
const ONSETS: usize = 2048;
/// The first ones that count, a hundredth of the log: what comes before a step has to tell the level there, and not the start alone.
const FIRST_ONSET: usize = 20;
/// Relative difference of the evidence of onsets between which no sample is fitted.
const SAME: f64 = 1e-9;
/// Seconds of a log that a first periodogram looks at, and its highest frequency in Hz.
const COARSE_S: f64 = 8.0;
const MOST_HZ: f64 = 200.0;
/// Samples of each channel that a periodogram over position looks at, and its most waves over the motion's range.
const SAMPLES: usize = 8000;
const MOST_WAVES: f64 = 100.0;
/// Waves over the whole range below which a ripple cannot be told from a trend or the motion itself.
const LEAST_WAVES: f64 = 1.5;
/// The same of periods over a whole log: slower ones take the place of whatever else changes once in a log.
const LEAST_PERIODS: f64 = 3.0;
/// Step of a last look at a frequency.
const FINEST: f64 = 0.005;
/// Step of a guessed reading limit as a share of it.
const LIMIT_STEP: f64 = 0.02;
/// Step of a guessed onset in s, and the most as a share of the log: it has to reach across held-out samples, where a fit feels no slope.
const ONSET_STEP_S: f64 = 0.02;
const MOST_STEP_SHARE: f64 = 0.01;

/// The candidates with their guesses, those with several guesses several times; those that need one and have none are left out.
pub(crate) fn guessed(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    candidates: &[Candidate],
) -> Result<Vec<Candidate>, RespondError> {
    let mut out = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let guesses: Vec<Guessed> = match candidate.kind.guess {
            Guess::Defaults => {
                out.push(*candidate);
                magnitudes(base, candidate)
            }
            Guess::Onset(reference) => onset(data, noise, base, reference)?.into_iter().collect(),
            Guess::Frequency => frequencies(data, base),
            Guess::Wavelength => wavelengths(data, base),
            Guess::LargestReading => largest_reading(data, candidate).into_iter().collect(),
        };
        out.extend(guesses.into_iter().map(|g| Candidate { guess: Some(g), ..*candidate }));
    }
    Ok(out)
}

/// Shapes that may be of any order of magnitude, one at a time a standard deviation of their prior above and below the default: a fit from far off
/// ends in whatever is nearest.
fn magnitudes(base: &Fit, candidate: &Candidate) -> Vec<Guessed> {
    let bench = base.model.at(&base.z).common;
    let shapes = candidate.kind.parameters(&bench).iter().filter(|p| p.is_factor);
    let either_way = |p: &EffectParameter| {
        let (name, least, most) = (p.name, p.least, p.most);
        [p.default / p.prior, p.default * p.prior].map(|value| Guessed {
            value: value.clamp(least, most),
            step: 1.0,
            of: Some(name),
        })
    };
    shapes.flat_map(either_way).collect()
}

fn largest_reading(data: &Data, candidate: &Candidate) -> Option<Guessed> {
    let blocks = data.blocks.iter().filter(|b| Some(b.channel) == candidate.channel);
    let largest = blocks.flat_map(|b| &b.measured).fold(0.0_f64, |m, v| m.max(v.abs()));
    (largest > 0.0).then(|| Guessed { value: 1.0 / largest, step: LIMIT_STEP / largest, of: None })
}

/// When a lasting change of the size of `reference` explains most: its sensitivity, cut off before the onset, in the score
/// test of [`crate::rank`]. The sums over bins of time make every onset as cheap as one.
fn onset(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    reference: &str,
) -> Result<Option<Guessed>, RespondError> {
    let Some(kind) = kind(reference) else { return Ok(None) };
    let model = base.model.with(Candidate { kind, channel: None, guess: None }, noise);
    let place = base.model.parameters.len();
    if model.parameters.len() != place + 1 {
        return Ok(None);
    }
    let mut z = base.z.clone();
    z.push(0.0);
    let columns = sensitivities(data, noise, &model, &z, &base.simulation, &[place])?;
    let (Some(column), Some(information)) = (columns.first(), factor(&base.held_information())) else {
        return Ok(None);
    };
    let times = data.stacked(|s, i| s.inputs.time_s().get(i).copied().unwrap_or_default());
    let (first, last) = range(times.iter().map(|t| t.1));
    let width = (last - first) / ONSETS as f64;
    if width.is_nan() || width <= 0.0 {
        return Ok(None);
    }
    // Of each bin: c'c, c'r, J'c.
    let mut sums = vec![(0.0, 0.0, DVector::<f64>::zeros(place)); ONSETS];
    for (i, ((_, t), c)) in times.iter().zip(column).enumerate() {
        let bin = (((t - first) / width) as usize).min(ONSETS - 1);
        let (cc, cr, jc) = &mut sums[bin];
        *cc += c * c;
        *cr += c * base.residual[i];
        jc.iter_mut().zip(&base.jacobian).for_each(|(sum, j)| *sum += j[i] * c);
    }
    let left = base.gradient();
    let (mut cc, mut cr, mut jc) = (0.0, 0.0, DVector::<f64>::zeros(place));
    // Evidence, and the bins between whose beginnings it is the same: where samples are held out, or lost.
    let mut best: Option<(f64, usize, usize)> = None;
    for (bin, sum) in sums.iter().enumerate().skip(FIRST_ONSET).rev() {
        cc += sum.0;
        cr += sum.1;
        jc += &sum.2;
        let absorbed = information.solve(&jc);
        let (survived, g) = (cc - absorbed.dot(&jc), cr - absorbed.dot(&left));
        let evidence = g * g / survived;
        if survived <= 1e-9 * cc {
            continue;
        }
        best = match best {
            Some((most, low, high)) if low == bin + 1 && (evidence - most).abs() <= SAME * most => {
                Some((most, bin, high))
            }
            Some((most, ..)) if evidence <= most => best,
            _ => Some((evidence, bin, bin)),
        };
    }
    Ok(best.map(|(_, low, high)| {
        let value = first + 0.5 * width * (low + high) as f64;
        let gaps = times.windows(2).filter_map(|pair| match pair {
            [(block, t), (next, later)] if block == next => Some(later - t),
            _ => None,
        });
        let gap = gaps.fold(0.0_f64, f64::max);
        Guessed { value, step: ONSET_STEP_S.max(gap.min(MOST_STEP_SHARE * (last - first))), of: None }
    }))
}

/// The frequencies of the highest peaks of the residual's periodogram over time, first on the beginning of the log, then around
/// each peak on all of it.
fn frequencies(data: &Data, base: &Fit) -> Vec<Guessed> {
    let coordinates = data.stacked(|s, i| s.inputs.time_s().get(i).copied().unwrap_or_default());
    let (first, last) = range(coordinates.iter().map(|t| t.1));
    let span = last - first;
    let rate = coordinates.len() as f64 / data.blocks.len().max(1) as f64 / span;
    let most = MOST_HZ.min(0.45 * rate);
    let coarse_s = COARSE_S.min(span);
    let spectrum = Spectrum { data, base, coordinates };
    let begin = |t: f64| t < first + coarse_s;
    let finest = |(channel, coarse): (Option<usize>, f64)| {
        let (low, high) = (coarse - 1.0 / coarse_s, coarse + 1.0 / coarse_s);
        let all = |_: f64| true;
        let steps = (low.max(LEAST_PERIODS / span), high, FINENESS / span);
        let value = spectrum.peak(channel, &all, steps)?;
        // The phase counts from the time 0 of the log's clock, which may be far from the log: a frequency that is off by a
        // little would turn the whole ripple round.
        let steps = (value - FINENESS / span, value + FINENESS / span, FINEST / span);
        let value = spectrum.peak(channel, &all, steps).unwrap_or(value);
        Some(Guessed { value, step: 0.1 / span.max(first.abs()).max(last.abs()), of: None })
    };
    let peaks = spectrum
        .peaks(&begin, ((LEAST_PERIODS / span).max(LEAST_WAVES / coarse_s), most, FINENESS / coarse_s));
    peaks.into_iter().filter_map(finest).collect()
}

/// The wavelengths of the highest peaks of the residual's periodogram over position: the crank's angle, or the axis' own.
fn wavelengths(data: &Data, base: &Fit) -> Vec<Guessed> {
    let lever = match base.model.at(&base.z).common {
        Bench::Transmission(bench) => Some(bench.geometry.drive_lever_radius_m),
        Bench::FrictionRig(_) => None,
    };
    let at = |x: f64| lever.map_or(x, |r| (x / r).clamp(-1.0, 1.0).asin());
    let coordinates =
        data.stacked(
            |s, i| {
                if i < SAMPLES { at(s.position.get(i).copied().unwrap_or_default()) } else { f64::NAN }
            },
        );
    let (low, high) = range(coordinates.iter().map(|p| p.1).filter(|p| p.is_finite()));
    let span = high - low;
    let spectrum = Spectrum { data, base, coordinates };
    let steps = (LEAST_WAVES / span, MOST_WAVES / span, FINENESS / span);
    let guess =
        |(_, waves): (_, f64)| Guessed { value: 1.0 / waves, step: 0.1 / (span * waves * waves), of: None };
    spectrum.peaks(&f64::is_finite, steps).into_iter().map(guess).collect()
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}
