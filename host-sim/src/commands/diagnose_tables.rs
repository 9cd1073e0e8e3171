//! The tables of a diagnosis, for the terminal and the page alike.

use super::diagnose_words::{channelled, interval, percent, with_unit};
use diagnosis::{Diagnosis, Finding, Gain, four_digits};

/// Share of its declared deviation that a nuisance has to fall below to be told.
const LEAST_TOLD: f64 = 0.995;

/// A table with its header; empty where there is nothing to tell.
pub(super) struct Table {
    pub(super) header: &'static [&'static str],
    pub(super) rows: Vec<Vec<String>>,
}

/// Every parameter of every cause.
pub(super) fn causes(diagnosis: &Diagnosis) -> Table {
    let rows = diagnosis.causes.iter().flat_map(|cause| {
        cause.parameters.iter().map(|p| {
            vec![
                channelled(&cause.effect, cause.channel),
                format!("{:.1} %", 100.0 * cause.probability),
                p.name.clone(),
                with_unit(four_digits(p.value), &p.unit),
                format!("{} to {}", four_digits(p.ci95[0]), four_digits(p.ci95[1])),
            ]
        })
    });
    Table { header: &["cause", "probability", "parameter", "value", "95 % interval"], rows: rows.collect() }
}

/// Error before and after by channel.
pub(super) fn gains(diagnosis: &Diagnosis) -> Table {
    let row = |gain: &Gain| {
        vec![
            gain.channel.name().into(),
            four_digits(gain.baseline_rms),
            four_digits(gain.extended_rms),
            four_digits(gain.noise_rms),
            percent(gain.explained_share),
            interval(gain.explained_share_ci95),
        ]
    };
    Table {
        header: &["held-out error of", "before", "after", "noise", "explained", "95 % interval"],
        rows: diagnosis.gain.iter().map(row).collect(),
    }
}

/// What the logs look like and what was done to them, the gravest first; notes too.
pub(super) fn checks(diagnosis: &Diagnosis) -> Table {
    let row = |f: &Finding| {
        let short = f.log.rsplit(['/', '\\']).next().unwrap_or(&f.log);
        let done = f.done.clone().unwrap_or_else(|| "-".into());
        let mend = f.mend.clone().unwrap_or_else(|| "-".into());
        let words = if f.cause.is_empty() { f.found.clone() } else { format!("{}: {}", f.found, f.cause) };
        vec![f.severity.name().into(), short.into(), f.channel.clone(), f.kind.into(), words, done, mend]
    };
    Table {
        header: &[
            "finding",
            "log",
            "channel",
            "kind",
            "what was found",
            "what was done",
            "line that mends it",
        ],
        rows: diagnosis.checks.iter().map(row).collect(),
    }
}

/// What was calibrated within the declared uncertainty.
pub(super) fn calibrated(diagnosis: &Diagnosis) -> Table {
    let row = |c: &diagnosis::Calibrated| {
        vec![
            c.name.clone(),
            four_digits(c.described),
            four_digits(c.declared_deviation),
            four_digits(c.value),
            four_digits(c.deviation),
        ]
    };
    Table {
        header: &["parameter", "described", "declared deviation", "calibrated", "deviation left"],
        rows: diagnosis.calibrated.iter().map(row).collect(),
    }
}

/// What the sessions have of their own, beside what is declared.
pub(super) fn nuisances(diagnosis: &Diagnosis) -> Table {
    // What a log does not show stands under what the logs do not tell.
    let told = |n: &&diagnosis::SessionNuisance| n.deviation < LEAST_TOLD * n.declared_deviation;
    let row = |n: &diagnosis::SessionNuisance| {
        let short = n.source.rsplit(['/', '\\']).next().unwrap_or(&n.source);
        let told_by = if n.held_out { "its start" } else { "the fit" };
        vec![
            short.into(),
            n.name.into(),
            n.channel.map_or("-", bench::Channel::name).into(),
            with_unit(four_digits(n.value), &n.unit),
            four_digits(n.deviation),
            four_digits(n.declared_deviation),
            format!("{:+.1}", n.deviations_off),
            told_by.into(),
        ]
    };
    Table {
        header: &[
            "log",
            "nuisance",
            "channel",
            "value",
            "deviation left",
            "declared",
            "deviations off",
            "told by",
        ],
        rows: diagnosis.nuisances.iter().filter(told).map(row).collect(),
    }
}

/// The noise that everything is measured against.
pub(super) fn noise(diagnosis: &Diagnosis) -> Table {
    let row = |n: &diagnosis::Noise| {
        vec![
            n.channel.name().into(),
            four_digits(n.floor),
            n.source.into(),
            four_digits(n.measured_floor),
            n.repeats.to_string(),
            percent(n.repeatable_share),
            format!("{:.2}", n.excess),
            format!("{:.1}", n.correlation_samples),
        ]
    };
    Table {
        header: &[
            "channel",
            "floor",
            "known from",
            "as the log shows it",
            "cycles compared",
            "of the error repeats",
            "residual/floor",
            "correlation, samples",
        ],
        rows: diagnosis.noise.iter().map(row).collect(),
    }
}

/// What the proposed experiment would tell apart.
pub(super) fn separation(diagnosis: &Diagnosis) -> Table {
    let rows = diagnosis
        .experiment
        .iter()
        .flat_map(|e| &e.separation)
        .map(|s| vec![channelled(&s.effect, s.channel), format!("{:.0}", s.chi_square)]);
    Table { header: &["set apart from", "chi-square"], rows: rows.collect() }
}
