//! Menu of experiments: changes of the described run that a bench description can express.
//!
//! An experiment is one recording, or several that are diagnosed together. It is omitted if the
//! plant does not support a change (standstill of the transmission bench) or if a change leaves the
//! range of a description. A description cannot express shapes of the motion other than the sine,
//! steps of the motion, other temperatures, or a load that follows the motion.
//!
//! The planned log of an axis begins after the load ramp, unless the experiment changes the load's
//! start. A user with a constant load has no ramp in the log, and an experiment must not depend on
//! a load ramp that its instructions do not mention.

use super::tuning;
use bench::Bench;
use bench::description::Field;
use bench::log::MeasuredLog;
use bench::simulate::record;

/// A change of the run.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// Factor on the period.
    Period(f64),
    /// Factor on the stroke.
    Stroke(f64),
    /// Factor on the load.
    Load(f64),
    /// The load rises during the complete recording.
    LoadRises,
    /// The load rises at the start of the recording, within a share of the period.
    LoadSteps(f64),
    /// Factor on the period at the end of the recording: a sine sweep.
    Sweep(f64),
    /// The motion starts in the other direction.
    Backwards,
    /// Standstill before each half cycle, in periods.
    Standstill(f64),
}

/// An experiment: its instruction, which completes "record two cycles ...", and its recordings.
pub(crate) struct MenuEntry {
    pub(crate) instruction: &'static str,
    recordings: &'static [&'static [Change]],
}

use Change::{Backwards, Load, LoadRises, LoadSteps, Period, Standstill, Stroke, Sweep};

/// Simple experiments first: of equally good ones the first is proposed.
pub(crate) const MENU: &[MenuEntry] = &[
    MenuEntry { instruction: "twice as fast", recordings: &[&[Period(0.5)]] },
    MenuEntry { instruction: "at half the speed", recordings: &[&[Period(2.0)]] },
    MenuEntry { instruction: "with half the load", recordings: &[&[Load(0.5)]] },
    MenuEntry { instruction: "with twice the load", recordings: &[&[Load(2.0)]] },
    MenuEntry { instruction: "with the load reversed", recordings: &[&[Load(-1.0)]] },
    MenuEntry { instruction: "with half the stroke", recordings: &[&[Stroke(0.5)]] },
    MenuEntry { instruction: "with twice the stroke", recordings: &[&[Stroke(2.0)]] },
    MenuEntry {
        instruction: "with a load that rises from 0 during the recording",
        recordings: &[&[LoadRises]],
    },
    MenuEntry { instruction: "with a standstill before each half cycle", recordings: &[&[Standstill(0.25)]] },
    MenuEntry { instruction: "starting in the other direction", recordings: &[&[Backwards]] },
    MenuEntry {
        instruction: "with the load switched on within a fiftieth of a cycle after the start of the log",
        recordings: &[&[LoadSteps(0.02)]],
    },
    MenuEntry {
        instruction: "that become steadily faster, up to four times the speed",
        recordings: &[&[Sweep(0.25)]],
    },
    MenuEntry {
        instruction: "once with half the load and once with twice the load",
        recordings: &[&[Load(0.5)], &[Load(2.0)]],
    },
    MenuEntry {
        instruction: "with the load forward, without load and with the load backward",
        recordings: &[&[Load(1.0)], &[Load(0.0)], &[Load(-1.0)]],
    },
    MenuEntry {
        instruction: "once at half the speed and once at twice the speed",
        recordings: &[&[Period(2.0)], &[Period(0.5)]],
    },
    MenuEntry {
        instruction: "at half, at twice and at four times the speed",
        recordings: &[&[Period(2.0)], &[Period(0.5)], &[Period(0.25)]],
    },
    MenuEntry {
        instruction: "once with half the stroke and once with the full stroke",
        recordings: &[&[Stroke(0.5)], &[Stroke(1.0)]],
    },
    MenuEntry {
        instruction: "once fast with half the load and once slowly with twice the load",
        recordings: &[&[Period(0.5), Load(0.5)], &[Period(2.0), Load(2.0)]],
    },
];

/// A recording of a planned experiment.
pub(crate) struct Planned {
    /// Lines of TOML, such as `drive.period_s = 0.5`.
    pub(crate) changes: Vec<String>,
    /// The complete description to record with.
    pub(crate) description: String,
    /// The log that the described bench would record.
    pub(crate) log: MeasuredLog,
}

impl MenuEntry {
    /// The recordings on a bench; `None` if the bench cannot perform one of them.
    pub(crate) fn plan(&self, bench: &Bench) -> Option<Vec<Planned>> {
        self.recordings.iter().map(|changes| planned(bench, changes)).collect()
    }
}

fn planned(bench: &Bench, changes: &[Change]) -> Option<Planned> {
    let mut bench = bench.clone();
    bench.set_cycles(tuning::CYCLES);
    let mut lines = vec![format!("{} = {}", bench.cycles_field(), tuning::CYCLES)];
    for change in changes {
        lines.extend(change.apply(&mut bench)?);
    }
    // A change that a description cannot express is no experiment.
    let description = bench.to_toml().ok()?;
    let bench = Bench::parse("experiment", &description).ok()?;
    let mut log = record(&bench, tuning::SEED).ok()?;
    if let (Some(rig), false) = (bench.axis(), changes.iter().any(|c| c.changes_load_start())) {
        let ramp = log.time_s.partition_point(|&t| t < rig.load.ramp_s);
        log.time_s.drain(..ramp);
        log.channels.values_mut().for_each(|values| drop(values.drain(..ramp.min(values.len()))));
    }
    Some(Planned { changes: lines, description, log })
}

impl Change {
    /// Returns whether it concerns the start of the load.
    fn changes_load_start(self) -> bool {
        matches!(self, LoadRises | LoadSteps(_))
    }

    /// Changes the run; returns the lines of TOML that do the same. `None` if the plant does not
    /// support the change.
    fn apply(self, bench: &mut Bench) -> Option<Vec<String>> {
        let mut lines = Vec::new();
        match self {
            Period(factor) => {
                if let Some(rig) = bench.axis_mut()
                    && rig.axis.last_period_s != 0.0
                {
                    let last_period_s = factor * rig.axis.last_period_s;
                    set(&mut lines, ("axis.last_period_s", &mut rig.axis.last_period_s), last_period_s);
                }
                let period_s = factor * bench.period_s();
                set(&mut lines, bench.period_mut()?, period_s);
            }
            Stroke(factor) => {
                let (name, place) = bench.stroke_mut()?;
                let stroke = factor * *place;
                set(&mut lines, (name, place), stroke);
            }
            Load(factor) => {
                let force_n = factor * bench.load_n();
                set(&mut lines, ("load.force_n", &mut bench.load_mut()?.force_n), force_n);
            }
            LoadRises => {
                let duration_s = bench.duration_s();
                set(&mut lines, ("load.ramp_s", &mut bench.load_mut()?.ramp_s), duration_s);
            }
            LoadSteps(share) => {
                let rig = bench.axis_mut()?;
                set(&mut lines, ("load.ramp_s", &mut rig.load.ramp_s), share * rig.axis.period_s);
            }
            Standstill(share) => {
                let axis = &mut bench.axis_mut()?.axis;
                set(&mut lines, ("axis.dwell_s", &mut axis.dwell_s), share * axis.period_s);
            }
            Sweep(factor) => {
                // The speed of an open loop follows from the effort.
                if bench.is_open_loop() {
                    return None;
                }
                let axis = &mut bench.axis_mut()?.axis;
                // A sweep has no standstill.
                if axis.dwell_s != 0.0 {
                    set(&mut lines, ("axis.dwell_s", &mut axis.dwell_s), 0.0);
                }
                set(&mut lines, ("axis.last_period_s", &mut axis.last_period_s), factor * axis.period_s);
            }
            Backwards => {
                let axis = &mut bench.axis_mut()?.axis;
                axis.backwards = !axis.backwards;
                lines.push(format!("axis.backwards = {}", axis.backwards));
            }
        }
        Some(lines)
    }
}

/// Sets a number of a description and adds the line of TOML that does the same.
fn set(lines: &mut Vec<String>, (name, place): Field<'_>, value: f64) {
    *place = value;
    lines.push(format!("{name} = {value:?}"));
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
mod tests {
    use super::*;

    #[test]
    fn the_listed_changes_turn_the_description_into_that_of_the_experiment() {
        // Without and with standstill.
        let rigs = ["friction-rig", "friction-rig-babbitt"].map(|name| Bench::open(name).unwrap());
        for (experiment, rig) in
            MENU.iter().flat_map(|experiment| rigs.iter().map(move |rig| (experiment, rig)))
        {
            let plan = experiment.plan(rig).unwrap_or_else(|| panic!("{}", experiment.instruction));
            assert_eq!(plan.len(), experiment.recordings.len());
            for recording in plan {
                // The changed lines alone turn the description into that of the plan.
                let mut described: toml::Table = toml::from_str(&rig.to_toml().unwrap()).unwrap();
                for line in &recording.changes {
                    let (section, fields) =
                        toml::from_str::<toml::Table>(line).unwrap().into_iter().next().unwrap();
                    let place = described.entry(section).or_insert(toml::Value::Table(toml::Table::new()));
                    place.as_table_mut().unwrap().extend(fields.as_table().unwrap().clone());
                }
                let described = Bench::parse("described", &described.to_string()).unwrap();
                assert_eq!(described.to_toml().unwrap(), recording.description, "{}", experiment.instruction);
                assert!(recording.log.time_s.len() > 1000);
            }
        }
    }

    #[test]
    fn experiments_that_a_bench_cannot_perform_are_omitted() {
        let bench = Bench::open("bench-b").unwrap();
        let entry = |instruction: &str| MENU.iter().find(|e| e.instruction == instruction).unwrap();
        for instruction in ["with a standstill before each half cycle", "starting in the other direction"] {
            assert!(entry(instruction).plan(&bench).is_none());
        }
        // Twice the stroke is longer than the crank.
        assert!(entry("with twice the stroke").plan(&bench).is_none());
    }
}
