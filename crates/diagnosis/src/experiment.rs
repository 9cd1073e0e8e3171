//! What to measure next when several effects fit equally: the experiment of a menu that tells them apart best.
//!
//! Each experiment is simulated with both extended benches; their separation is the chi-square that is left after the
//! first one has adjusted everything it may to imitate the second.

use crate::fit::{sensitivities, simulate};
use crate::linear::{dot, factor, gram, project};
use crate::model::{Candidate, Model};
use crate::noise::NoiseModel;
use crate::session::Data;
use bench::{Bench, MeasuredLog, record};

struct Experiment {
    words: &'static str,
    change: fn(&mut Bench),
}

macro_rules! experiment {
    ($words:literal, |$t:ident| $transmission:expr, |$r:ident| $rig:expr) => {
        Experiment {
            words: $words,
            change: |bench| match bench {
                Bench::Transmission($t) => $transmission,
                Bench::FrictionRig($r) => $rig,
            },
        }
    };
}

const MENU: &[Experiment] = &[
    experiment!("twice as fast", |t| t.drive.period_s *= 0.5, |r| r.axis.period_s *= 0.5),
    experiment!("at half the speed", |t| t.drive.period_s *= 2.0, |r| r.axis.period_s *= 2.0),
    experiment!("with half the load", |t| t.load.force_n *= 0.5, |r| r.load.force_n *= 0.5),
    experiment!("with twice the load", |t| t.load.force_n *= 2.0, |r| r.load.force_n *= 2.0),
    experiment!("with the load reversed", |t| t.load.force_n *= -1.0, |r| r.load.force_n *= -1.0),
    experiment!("with half the stroke", |t| t.drive.stroke_m *= 0.5, |r| r.axis.amplitude *= 0.5),
];

/// A candidate with its fitted scaled parameters, the uncertain ones first.
pub(crate) type Fitted<'a> = (Candidate, &'a [f64]);

/// The experiment that separates `best` from every one of `others` most, in words.
pub(crate) fn propose(
    bench: &Bench,
    data: &Data,
    noise: &NoiseModel,
    best: Fitted<'_>,
    others: &[Fitted<'_>],
) -> Option<String> {
    let separation = |experiment: &Experiment| -> Option<f64> {
        let mut changed = bench.clone();
        changed.set_cycles(2);
        (experiment.change)(&mut changed);
        let mut log: MeasuredLog = record::record(&changed, 0).ok()?;
        log.channels.retain(|c, _| c.role() == bench::channel::Role::Input || data.channels.contains(c));
        let planned = Data::new(&changed, &[log], &[]).ok()?;
        let model = |c: &Candidate| Model::nominal(&changed).with(*c, noise);
        let own = model(&best.0);
        let here = simulate(&planned, &own.at(best.1), None).ok()?;
        let all: Vec<usize> = (0..own.parameters.len()).collect();
        let jacobian = sensitivities(&planned, noise, &own, best.1, &here, &all).ok()?;
        let mut information = gram(&jacobian);
        for (i, p) in own.parameters.iter().enumerate() {
            information[(i, i)] += p.precision;
        }
        let information = factor(&information)?;
        let mut least = f64::INFINITY;
        for (candidate, z) in others {
            let there = simulate(&planned, &model(candidate).at(z), None).ok()?;
            let apart = there
                .columns
                .iter()
                .zip(&here.columns)
                .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
                .collect();
            let apart = noise.stack(&planned, &apart);
            let shadow = project(&jacobian, &apart);
            least = least.min(dot(&apart, &apart) - information.solve(&shadow).dot(&shadow));
        }
        Some(least)
    };
    let (experiment, chi) = MENU
        .iter()
        .filter_map(|e| Some((e, separation(e)?)))
        .filter(|(_, chi)| chi.is_finite())
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let names: Vec<&str> = others.iter().map(|(c, _)| c.kind.name).collect();
    Some(format!(
        "record two cycles {}: that would set {} apart from {} by a chi-square of {chi:.0}",
        experiment.words,
        best.0.kind.name,
        names.join(", "),
    ))
}
