//! Logs without faults: of benches within their uncertainty, and of benches with an effect.

use super::tests::{found, real, wrong_findings};
use super::*;
use bench::Channel;
use bench::effects::Effect;
use bench::simulate::record;
use std::collections::BTreeMap;

#[test]
fn clean_logs_have_no_wrong_channels() {
    let effect = |name: &str, channel: Option<Channel>, parameters: &[(&str, f64)]| Effect {
        name: name.into(),
        channel,
        of: None,
        parameters: parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect::<BTreeMap<_, _>>(),
    };
    // Every effect of the catalogue at three times its scale, and two larger sensor errors.
    let mut effects: Vec<Effect> = Vec::new();
    for kind in bench::effects::CATALOGUE {
        let bench = Bench::open("bench-b").unwrap();
        let channel = kind.name.starts_with("sensor-").then_some(Channel::BearingForceY);
        let parameters = kind
            .parameters(&bench)
            .iter()
            .map(|p| {
                let unit = if p.unit.starts_with("channel") { 15.0 } else { 1.0 };
                let value = if p.is_size { 3.0 * p.scale * unit } else { p.default };
                (p.name.to_owned(), value.clamp(p.min, p.max))
            })
            .collect();
        // The scale is that of an inverse in the unit of the reading. This limit cuts off the
        // peaks.
        let parameters = if kind.name == "sensor-saturation" {
            BTreeMap::from([("inverse_limit".to_owned(), 1.0 / 4000.0)])
        } else {
            parameters
        };
        effects.push(Effect { name: kind.name.into(), channel, of: None, parameters });
    }
    effects.push(effect("sensor-gain", Some(Channel::JournalY), &[("relative_change", 0.05)]));
    effects.push(effect("sensor-delay", Some(Channel::ShaftSpeed), &[("delay_s", 1e-3)]));
    for (seed, effect) in effects.iter().enumerate() {
        let mut bench = real(seed as u64);
        bench.effects_mut().push(effect.clone());
        let Ok(log) = record(&bench, seed as u64) else { continue };
        let (after, findings) = found(&log);
        assert_eq!(wrong_findings(&findings), [], "{effect:?} {findings:#?}");
        assert!(after.time_s.len() + 4 >= log.time_s.len(), "{effect:?} {findings:#?}");
    }
}

#[test]
fn clean_logs_at_other_operating_points_have_nothing_but_notes() {
    for seed in 0..24 {
        let mut bench = real(seed);
        if let Some(b) = bench.transmission_mut() {
            b.load.force_n = [10e3, 6e3, 1e3, -5e3, 0.0, -10e3][seed as usize % 6];
            b.drive.period_s = [1.0, 0.7, 3.0][seed as usize % 3];
        }
        let (_, findings) = found(&record(&bench, seed).unwrap());
        // A reversal of the friction within one sample is as sudden as an outlier, and costs a row
        // or two.
        let few = |f: &Finding| f.kind == "outliers" && f.evidence["outliers"] <= 2.0;
        assert!(findings.iter().all(|f| f.severity == Severity::Note || few(f)), "{seed} {findings:#?}");
    }
    for name in ["friction-rig", "friction-rig-babbitt", "friction-rig-plastic"] {
        let bench = Bench::open(name).unwrap();
        let log = record(&bench, 1).unwrap();
        let checked = check(&bench, std::slice::from_ref(&log), &[]).unwrap();
        assert_eq!(wrong_findings(&checked.findings), [], "{name} {:#?}", checked.findings);
    }
}
