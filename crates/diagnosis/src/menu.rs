//! The experiments that a diagnosis may propose: changes of the described run, as a bench description can say them.
//!
//! An experiment is one recording or several that are diagnosed together. A change that a plant does not have (a rest of the
//! transmission bench) or that leaves the ranges of a description takes its experiment off the menu. Not on it, as no description
//! says them: motions of another shape than the sine, steps of the motion, other temperatures, a load that follows the motion.
//!
//! Unless an experiment is about how the load comes on, an axis' plan begins where the load is there: a user who takes the load as it
//! stands has no ramp in the log, and no experiment shall live on a ramp that its words do not ask for.

use bench::Bench;
use bench::log::MeasuredLog;
use bench::record::record;

/// Cycles of a recording: one is fitted, one held out.
const CYCLES: u32 = 2;
/// Any seed: a plan is compared without its noise.
const SEED: u64 = 0;

/// A change of the run.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// Factor on the period.
    Period(f64),
    /// Factor on the stroke.
    Stroke(f64),
    /// Factor on the load.
    Load(f64),
    /// The load rises over the whole recording.
    LoadRises,
    /// The load comes on at the start of the recording, over a share of the period.
    LoadSteps(f64),
    /// Factor on the period at the end of the recording: a sine sweep.
    Sweep(f64),
    /// The motion starts the other way.
    Backwards,
    /// Rest before each half cycle, in periods.
    Rest(f64),
}

/// An experiment in words, with its recordings.
pub(crate) struct Experiment {
    pub(crate) words: &'static str,
    recordings: &'static [&'static [Change]],
}

use Change::{Backwards, Load, LoadRises, LoadSteps, Period, Rest, Stroke, Sweep};

/// Plain ones first: of equals the first is proposed.
pub(crate) const MENU: &[Experiment] = &[
    Experiment { words: "twice as fast", recordings: &[&[Period(0.5)]] },
    Experiment { words: "at half the speed", recordings: &[&[Period(2.0)]] },
    Experiment { words: "with half the load", recordings: &[&[Load(0.5)]] },
    Experiment { words: "with twice the load", recordings: &[&[Load(2.0)]] },
    Experiment { words: "with the load reversed", recordings: &[&[Load(-1.0)]] },
    Experiment { words: "with half the stroke", recordings: &[&[Stroke(0.5)]] },
    Experiment { words: "with twice the stroke", recordings: &[&[Stroke(2.0)]] },
    Experiment { words: "with a load that rises from 0 over the recording", recordings: &[&[LoadRises]] },
    Experiment { words: "with a rest before each half cycle", recordings: &[&[Rest(0.25)]] },
    Experiment { words: "starting the other way", recordings: &[&[Backwards]] },
    Experiment {
        words: "with the load switched on within a fiftieth of a cycle while the log runs",
        recordings: &[&[LoadSteps(0.02)]],
    },
    Experiment { words: "that get faster evenly, up to four times the speed", recordings: &[&[Sweep(0.25)]] },
    Experiment {
        words: "once with half the load and once with twice the load",
        recordings: &[&[Load(0.5)], &[Load(2.0)]],
    },
    Experiment {
        words: "with the load forwards, without it and with it backwards",
        recordings: &[&[Load(1.0)], &[Load(0.0)], &[Load(-1.0)]],
    },
    Experiment {
        words: "once at half the speed and once at twice the speed",
        recordings: &[&[Period(2.0)], &[Period(0.5)]],
    },
    Experiment {
        words: "at half, at twice and at four times the speed",
        recordings: &[&[Period(2.0)], &[Period(0.5)], &[Period(0.25)]],
    },
    Experiment {
        words: "once with half the stroke and once with the whole",
        recordings: &[&[Stroke(0.5)], &[Stroke(1.0)]],
    },
    Experiment {
        words: "once fast with half the load and once slowly with twice the load",
        recordings: &[&[Period(0.5), Load(0.5)], &[Period(2.0), Load(2.0)]],
    },
];

/// A recording of a planned experiment.
pub(crate) struct Planned {
    /// Lines of TOML, such as `drive.period_s = 0.5`.
    pub(crate) changes: Vec<String>,
    /// The whole description to record with.
    pub(crate) description: String,
    /// What the bench as described would log.
    pub(crate) log: MeasuredLog,
}

impl Experiment {
    /// The recordings on a bench; `None` where it cannot take one of them.
    pub(crate) fn plan(&self, bench: &Bench) -> Option<Vec<Planned>> {
        self.recordings.iter().map(|changes| planned(bench, changes)).collect()
    }
}

fn planned(bench: &Bench, changes: &[Change]) -> Option<Planned> {
    let mut bench = bench.clone();
    bench.set_cycles(CYCLES);
    let mut lines = vec![match bench {
        Bench::Transmission(_) => format!("drive.cycles = {CYCLES}"),
        Bench::FrictionRig(_) => format!("axis.cycles = {CYCLES}"),
    }];
    for change in changes {
        lines.extend(change.apply(&mut bench)?);
    }
    // What a description may not say is no experiment.
    let description = bench.to_toml().ok()?;
    let bench = Bench::parse("experiment", &description).ok()?;
    let mut log = record(&bench, SEED).ok()?;
    if let (Bench::FrictionRig(rig), false) = (&bench, changes.iter().any(|c| c.loads())) {
        let loaded = log.time_s.partition_point(|&t| t < rig.load.ramp_s);
        log.time_s.drain(..loaded);
        log.channels.values_mut().for_each(|values| drop(values.drain(..loaded.min(values.len()))));
    }
    Some(Planned { changes: lines, description, log })
}

impl Change {
    /// Whether it is about how the load comes on.
    fn loads(self) -> bool {
        matches!(self, LoadRises | LoadSteps(_))
    }

    /// Changes the run; the lines of TOML that do the same.
    fn apply(self, bench: &mut Bench) -> Option<Vec<String>> {
        let mut lines = Vec::new();
        let (name, place) = match (self, &mut *bench) {
            (Period(_), Bench::Transmission(b)) => ("drive.period_s", &mut b.drive.period_s),
            (Period(factor), Bench::FrictionRig(r)) => {
                if r.axis.last_period_s != 0.0 {
                    r.axis.last_period_s *= factor;
                    lines.push(format!("axis.last_period_s = {:?}", r.axis.last_period_s));
                }
                ("axis.period_s", &mut r.axis.period_s)
            }
            (Stroke(_), Bench::Transmission(b)) => ("drive.stroke_m", &mut b.drive.stroke_m),
            (Stroke(_), Bench::FrictionRig(r)) => ("axis.amplitude", &mut r.axis.amplitude),
            (Load(_), Bench::Transmission(b)) => ("load.force_n", &mut b.load.force_n),
            (Load(_), Bench::FrictionRig(r)) => ("load.force_n", &mut r.load.force_n),
            (LoadRises, Bench::Transmission(b)) => {
                b.load.ramp_s = b.duration_s();
                ("load.ramp_s", &mut b.load.ramp_s)
            }
            (LoadRises, Bench::FrictionRig(r)) => {
                r.load.ramp_s = r.axis.duration_s();
                ("load.ramp_s", &mut r.load.ramp_s)
            }
            (LoadSteps(share), Bench::FrictionRig(r)) => {
                r.load.ramp_s = share * r.axis.period_s;
                ("load.ramp_s", &mut r.load.ramp_s)
            }
            (Rest(share), Bench::FrictionRig(r)) => {
                r.axis.dwell_s = share * r.axis.period_s;
                ("axis.dwell_s", &mut r.axis.dwell_s)
            }
            (Sweep(factor), Bench::FrictionRig(r)) => {
                // A sweep has no rests.
                if r.axis.dwell_s != 0.0 {
                    r.axis.dwell_s = 0.0;
                    lines.push("axis.dwell_s = 0.0".to_owned());
                }
                r.axis.last_period_s = factor * r.axis.period_s;
                ("axis.last_period_s", &mut r.axis.last_period_s)
            }
            (Backwards, Bench::FrictionRig(r)) => {
                r.axis.backwards = !r.axis.backwards;
                return Some(vec![format!("axis.backwards = {}", r.axis.backwards)]);
            }
            (Rest(_) | LoadSteps(_) | Sweep(_) | Backwards, Bench::Transmission(_)) => return None,
        };
        if let Period(factor) | Stroke(factor) | Load(factor) = self {
            *place *= factor;
        }
        lines.push(format!("{name} = {place:?}"));
        Some(lines)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
mod tests {
    use super::*;

    #[test]
    fn every_experiment_can_be_recorded_on_some_plant_and_says_what_it_changes() {
        // Without and with rests.
        let rigs = ["friction-rig", "friction-rig-babbitt"].map(|name| Bench::open(name).unwrap());
        for (experiment, rig) in
            MENU.iter().flat_map(|experiment| rigs.iter().map(move |rig| (experiment, rig)))
        {
            let plan = experiment.plan(rig).unwrap_or_else(|| panic!("{}", experiment.words));
            assert_eq!(plan.len(), experiment.recordings.len());
            for recording in plan {
                // Whoever carries the lines over into his description has that of the plan.
                let mut described: toml::Table = toml::from_str(&rig.to_toml().unwrap()).unwrap();
                for line in &recording.changes {
                    let (section, fields) =
                        toml::from_str::<toml::Table>(line).unwrap().into_iter().next().unwrap();
                    let place = described.entry(section).or_insert(toml::Value::Table(toml::Table::new()));
                    place.as_table_mut().unwrap().extend(fields.as_table().unwrap().clone());
                }
                let described = Bench::parse("described", &described.to_string()).unwrap();
                assert_eq!(described.to_toml().unwrap(), recording.description, "{}", experiment.words);
                assert!(recording.log.time_s.len() > 1000);
            }
        }
    }

    #[test]
    fn a_bench_is_not_asked_for_what_it_cannot_do() {
        let bench = Bench::open("bench-b").unwrap();
        let of = |words: &str| MENU.iter().find(|e| e.words == words).unwrap();
        for words in ["with a rest before each half cycle", "starting the other way"] {
            assert!(of(words).plan(&bench).is_none());
        }
        // Twice the stroke is longer than the crank.
        assert!(of("with twice the stroke").plan(&bench).is_none());
    }
}
