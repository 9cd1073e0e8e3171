//! Sentences of a diagnosis: numbers, causes and the verdict for a bench engineer.

use bench::Channel;
use bench::effects::kind;
use diagnosis::{
    CalibratedParameter, Cause, Diagnosis, Gain, Identifiability, Rejection, RemainingStructure, Verdict,
    four_digits,
};

/// An effect with its channel or its part of a mechanism, if it has one.
pub(crate) fn placed(effect: &str, channel: Option<Channel>, part: &Option<String>) -> String {
    match channel.map(Channel::name).or(part.as_deref()) {
        Some(place) => format!("{effect} of {place}"),
        None => effect.to_owned(),
    }
}

/// A number with its unit.
pub(crate) fn with_unit(text: String, unit: &str) -> String {
    if unit == "1" { text } else { format!("{text} {unit}") }
}

/// A share in per cent.
pub(crate) fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".into(), |s| format!("{:.1} %", 100.0 * s))
}

/// An interval of shares in per cent.
pub(crate) fn interval(share: Option<[f64; 2]>) -> String {
    share.map_or_else(|| "-".into(), |[a, b]| format!("{:.1} to {:.1} %", 100.0 * a, 100.0 * b))
}

/// Meaning of an effect as a clause: the catalogue's sentence without its full stop. A constant
/// effort of the drive reads the same as an offset of its sensor.
fn meaning(effect: &str, channel: Option<Channel>) -> &str {
    match (effect, channel) {
        ("sensor-offset", Some(Channel::DriveForce | Channel::DriveTorque)) => {
            "A sensor has a constant offset, or a constant effort such as gravity is missing"
        }
        _ => kind(effect).map_or(effect, |known| known.summary.trim_end_matches('.')),
    }
}

fn cause_words(cause: &Cause) -> String {
    let parameters: Vec<String> = cause
        .parameters
        .iter()
        .map(|p| format!("{} = {}", p.name, with_unit(four_digits(p.value), &p.unit)))
        .collect();
    let others = cause.alternatives.iter().map(|a| format!("; or {}", placed(&a.effect, a.channel, &a.of)));
    format!(
        "{} ({}: {}{})",
        meaning(&cause.effect, cause.channel),
        placed(&cause.effect, cause.channel, &cause.of),
        parameters.join(", "),
        others.collect::<String>()
    )
}

/// Converts a sentence into a continuation of another.
fn lower(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// Describes the channel whose error falls by the largest factor.
fn gain_words(diagnosis: &Diagnosis) -> String {
    let factor = |g: &&Gain| g.baseline_rms / g.extended_rms.max(f64::MIN_POSITIVE);
    let best = diagnosis.gain.iter().max_by(|a, b| factor(a).total_cmp(&factor(b)));
    let (Some(best), Some(share)) = (best, diagnosis.explained_share) else { return String::new() };
    format!(
        " This lowers the held-out error of {} from {} to {} (noise {}) and explains {:.1} % of the \
         repeatable error of all channels.",
        best.channel,
        four_digits(best.baseline_rms),
        with_unit(four_digits(best.extended_rms), best.channel.unit()),
        with_unit(four_digits(best.noise_rms), best.channel.unit()),
        100.0 * share
    )
}

/// Describes the error that remains beside causes.
fn unknown_words(diagnosis: &Diagnosis) -> String {
    let Some(left) = &diagnosis.signature else { return String::new() };
    let remaining = 100.0 * (1.0 - diagnosis.explained_share.unwrap_or_default());
    format!(
        " {remaining:.1} % of the repeatable error remains unknown: {} The named part may be an imitation of \
         something outside the catalogue.",
        left_words(left)
    )
}

/// Describes the verdict in one or two sentences.
pub(crate) fn sentence(diagnosis: &Diagnosis) -> String {
    let causes: Vec<String> = diagnosis.causes.iter().map(cause_words).collect();
    let causes = match causes.split_first() {
        Some((first, others)) => {
            others.iter().fold(first.clone(), |all, next| format!("{all}; and {}", lower(next)))
        }
        None => String::new(),
    };
    let gain = gain_words(diagnosis);
    let others: Vec<String> =
        diagnosis.ambiguous_with.iter().map(|a| placed(&a.effect, a.channel, &a.of)).collect();
    match diagnosis.verdict {
        Verdict::None => {
            let notes = diagnosis.checks.iter().filter(|f| f.kind == "immaterial");
            let notes: String = notes.map(|f| format!(" Too small to matter: {}.", f.found)).collect();
            format!(
                "No fault found: the simulation agrees with the logs within the declared uncertainty.{notes}"
            )
        }
        Verdict::Named => format!("{causes}.{gain}"),
        Verdict::Ambiguous => {
            format!("{causes}; but {} fits these logs equally well.{gain}", others.join(" or "))
        }
        Verdict::Partial => format!("{causes}.{gain}{}", unknown_words(diagnosis)),
        Verdict::Unknown => {
            let place = diagnosis
                .signature
                .as_ref()
                .map_or_else(String::new, |left| format!(" {}", left_words(left)));
            let rejection =
                diagnosis.rejection.as_ref().map_or_else(String::new, |r| format!(" {}", rejection_words(r)));
            let bounds = bounds_words(&diagnosis.identifiability, &diagnosis.calibrated);
            let numbers = diagnosis.checks.iter().filter(|f| f.kind == "out-of-tolerance");
            let numbers: Vec<&str> = numbers.map(|f| f.found.as_str()).collect();
            if diagnosis.signature.is_none() && rejection.is_empty() && !numbers.is_empty() {
                return format!("Described numbers are out of tolerance: {}.{bounds}", numbers.join("; "));
            }
            format!("The logs show a fault that no known effect explains.{place}{bounds}{rejection}")
        }
    }
}

/// Describes the parameters that calibration has moved to their limits.
fn bounds_words(remarks: &[Identifiability], calibrated: &[CalibratedParameter]) -> String {
    let at_bound =
        |name: &String| remarks.iter().any(|f| f.kind == "at-bound" && f.parameters.contains(name));
    let stopped = calibrated.iter().filter(|c| at_bound(&c.name));
    let numbers: Vec<String> = stopped
        .map(|c| {
            let [moved, described, deviation] =
                [c.value - c.described, c.described, c.declared_deviation].map(four_digits);
            format!("{} by {moved} from {described} (± {deviation})", c.name)
        })
        .collect();
    if numbers.is_empty() {
        return String::new();
    }
    format!(" Calibrated up to the limit: {}.", numbers.join("; "))
}

/// Describes what was found but is not counted as a cause, and the reason.
pub(crate) fn rejection_words(rejection: &Rejection) -> String {
    let causes: Vec<String> = rejection.causes.iter().map(|c| placed(&c.effect, c.channel, &c.of)).collect();
    format!("Found, but not counted as a cause: {}, because {}.", causes.join(" and "), rejection.words)
}

/// Describes the remaining error and its place.
pub(crate) fn left_words(left: &RemainingStructure) -> String {
    format!(
        "{} {}; {} rms, {:.1} times the sensor's noise.",
        left.channel,
        left.place,
        with_unit(four_digits(left.rms), left.channel.unit()),
        left.rms_over_noise
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use diagnosis::EffectName;

    #[test]
    fn every_effect_has_a_meaning_that_reads_as_a_clause() {
        for known in bench::effects::CATALOGUE {
            let words = meaning(known.name, None);
            assert!(words != known.name && !words.ends_with('.') && words.contains(' '), "{words}");
        }
    }

    #[test]
    fn parameters_at_the_limit_of_calibration_are_described() {
        let remarks = |kind, names: &[&str]| Identifiability {
            kind,
            parameters: names.iter().map(|n| (*n).into()).collect(),
            value: 0.0,
            words: String::new(),
        };
        let number = |name: &str, described, value| CalibratedParameter {
            name: name.into(),
            described,
            value,
            declared_deviation: 6e-6,
            deviation: 1e-6,
        };
        let numbers = [number("axis.inertia", 10.0, 10.8), number("axis.load_gain", 1.0, 1.000_024)];
        let words = bounds_words(&[remarks("at-bound", &["axis.load_gain"])], &numbers);
        assert_eq!(words, " Calibrated up to the limit: axis.load_gain by 2.400e-5 from 1.000 (± 6.000e-6).");
        assert_eq!(bounds_words(&[remarks("dead", &["axis.inertia"])], &numbers), "");
    }

    #[test]
    fn a_finding_that_is_not_counted_is_described_with_its_reason() {
        let named = |effect: &str, channel| EffectName { effect: effect.into(), channel, of: None };
        let causes = vec![named("breakaway", None), named("sensor-gain", Some(bench::Channel::DriveForce))];
        let rejection =
            |causes| Rejection { causes, reason: "explains-too-little".into(), words: "it is little".into() };
        let words = rejection_words(&rejection(causes[..1].to_vec()));
        assert_eq!(words, "Found, but not counted as a cause: breakaway, because it is little.");
        let words = rejection_words(&rejection(causes));
        assert!(words.contains("breakaway and sensor-gain of drive_force_n, because"), "{words}");
    }
}
