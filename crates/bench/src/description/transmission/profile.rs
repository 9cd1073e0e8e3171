//! Sections of courses other than one sine: steps, ramps, splines, sea states, logs.

use crate::description::{Refusal, format_number, is_one, is_zero, one};
use crate::log::{Column, Columns, LogFormat, MeasuredLog, TIME};
use crate::schema::{FieldType, HUGE, named_field, section};
use crate::signals::{Channel, Course, Motion, Profile, Schedule, SeaState, spline};
use serde::{Deserialize, Serialize};
use std::path::Path;

section! {
    /// Course over time. `[drive_profile]` replaces the sine of `[drive]`, whose stroke and period
    /// then are typical ones: the period is the length of a cycle for statistics, and the estimator
    /// knows both. With a servo it is the order. `[load_profile]` is added to `load.force_n` within
    /// its ramp. Every course has two continuous derivatives.
    CourseSection {
        /// Form. `sine`: `mean + height/2 sin(2 pi t/period)`. `steps`, `ramps` and `spline` go
        /// through `points`, which repeat; `spectrum` is a sea state from a seed; `log` is a column
        /// of a file.
        kind: CourseKind,
        /// Peak-to-peak height of a `sine`; significant height (four times the rms) of a
        /// `spectrum`.
        #[serde(default, skip_serializing_if = "is_zero")]
        height: f64 [0.0, HUGE, "m or N"],
        /// Value that is added.
        #[serde(default, skip_serializing_if = "is_zero")]
        mean: f64 [-1e7, 1e7, "m or N"],
        /// Period of a `sine`, peak period of a `spectrum`, or time after which `points` repeat.
        /// Default: `drive.period_s`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        period_s: Option<f64> [1e-3, 1e6],
        /// Pairs of time (s, from 0, ascending, within the period) and value. The course returns to
        /// the first value at the end of the period.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        points: Vec<[f64; 2]>,
        /// Time of a step of `steps`, or over which a corner of `ramps` is rounded: cycloids, after
        /// the point's time. At most the smallest distance of two points.
        #[serde(default, skip_serializing_if = "is_zero")]
        transition_s: f64 [0.0, 1e6],
        /// Peak enhancement of a `spectrum`: 1 (Pierson and Moskowitz), or 3.3 (JONSWAP).
        #[serde(default = "one", skip_serializing_if = "is_one")]
        peak_enhancement: f64 [1.0, 20.0],
        /// Seed of a `spectrum`.
        #[serde(default, skip_serializing_if = "is_seedless")]
        seed: u32 [0.0, 4.294967295e9],
        /// File of a `log` (`docs/logs.md`), relative to the description.
        #[serde(default, skip_serializing_if = "String::is_empty")]
        file: String,
        /// Column, or expression of columns, of a `log`. Default: `drive_displacement_m` or
        /// `load_force_n`.
        #[serde(default, skip_serializing_if = "String::is_empty")]
        column: String,
        /// Column, or expression of columns, with the times of a `log` in s. Default: `t_s`.
        #[serde(default, skip_serializing_if = "String::is_empty")]
        time_column: String,
        /// Half window of the polynomials of order 4 that smooth a noisy `log`, at least six
        /// intervals of the log; 0: a cubic spline through every row.
        #[serde(default, skip_serializing_if = "is_zero")]
        smoothing_s: f64 [0.0, 1e3],
    }
}

fn is_seedless(seed: &u32) -> bool {
    *seed == 0
}

/// Form of a course.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CourseKind {
    /// Sine about the mean.
    Sine,
    /// Constant with steps.
    Steps,
    /// Straight with rounded corners.
    Ramps,
    /// Periodic cubic spline.
    Spline,
    /// Sea state.
    Spectrum,
    /// Column of a log.
    Log,
}

named_field!(CourseKind {
    Sine "sine", Steps "steps", Ramps "ramps", Spline "spline", Spectrum "spectrum", Log "log"
});

/// Shortest transition in s; a single point needs none, and its square has to be a number.
const MIN_TRANSITION_S: f64 = 1e-9;
/// Largest number of peak periods in a run: its spline takes some 100 bytes a node.
const MAX_PEAK_PERIODS: f64 = 1e5;
/// Fewest intervals of a log in half a window of smoothing.
const MIN_INTERVALS: f64 = 6.0;

/// A section with what its kind needs: its name, its default period, the length of the run.
pub(super) struct Context<'a> {
    pub(super) name: &'static str,
    pub(super) period_s: f64,
    pub(super) run_s: f64,
    pub(super) logged: Option<&'a Profile>,
}

impl CourseSection {
    /// Course from 0 to the end of a run, without the mean.
    pub(super) fn course(&self, context: &Context<'_>) -> Profile {
        let period_s = self.period_s.unwrap_or(context.period_s);
        let schedule = |course| {
            Profile::Schedule(Schedule::new(
                course,
                &self.points,
                period_s,
                self.transition_s.max(MIN_TRANSITION_S),
            ))
        };
        match self.kind {
            CourseKind::Sine => Profile::Sine { height: self.height, period_s },
            CourseKind::Steps => schedule(Course::Steps),
            CourseKind::Ramps => schedule(Course::Ramps),
            CourseKind::Spline => {
                let (times, values): (Vec<f64>, Vec<f64>) = self.points.iter().map(|[t, v]| (*t, *v)).unzip();
                let (time_s, nodes) = spline::periodic(&times, &values, period_s);
                Profile::Repeated { curve: Box::new(Profile::Curve { time_s, nodes }), period_s }
            }
            CourseKind::Spectrum => {
                let sea = SeaState {
                    height: self.height,
                    peak_period_s: period_s,
                    peak_enhancement: self.peak_enhancement,
                    seed: self.seed.into(),
                };
                let (time_s, nodes) = sea.nodes(context.run_s);
                Profile::Curve { time_s, nodes }
            }
            CourseKind::Log => context
                .logged
                .cloned()
                .unwrap_or(Profile::Curve { time_s: vec![0.0], nodes: vec![Motion::default()] }),
        }
    }

    /// Entries that the kind does not use, that it lacks, or that contradict each other.
    pub(super) fn refusals(&self, context: &Context<'_>) -> Vec<Refusal> {
        use CourseKind::{Log, Ramps, Sine, Spectrum, Spline, Steps};
        let refuse = |field: &str, found: String, expected: String| {
            (format!("{}.{field}", context.name), found, expected)
        };
        let own: [(&str, bool, &[CourseKind]); 9] = [
            ("height", self.height != 0.0, &[Sine, Spectrum]),
            ("period_s", self.period_s.is_some(), &[Sine, Spectrum, Steps, Ramps, Spline]),
            ("points", !self.points.is_empty(), &[Steps, Ramps, Spline]),
            ("transition_s", self.transition_s != 0.0, &[Steps, Ramps]),
            ("peak_enhancement", self.peak_enhancement != 1.0, &[Spectrum]),
            ("seed", self.seed != 0, &[Spectrum]),
            ("file", !self.file.is_empty(), &[Log]),
            ("column", !self.column.is_empty() || !self.time_column.is_empty(), &[Log]),
            ("smoothing_s", self.smoothing_s != 0.0, &[Log]),
        ];
        let kind = self.kind.text();
        let mut all: Vec<Refusal> = own
            .iter()
            .filter(|(_, is_set, kinds)| *is_set && !kinds.contains(&self.kind))
            .map(|(field, ..)| refuse(field, "set".into(), format!("no value with kind = \"{kind}\"")))
            .collect();
        let lacks = |field: &str, expected: &str| {
            refuse(field, "missing".into(), format!("{expected} with kind = \"{kind}\""))
        };
        match self.kind {
            Sine | Spectrum if self.height == 0.0 => all.push(lacks("height", "a height above 0")),
            Steps | Ramps | Spline if self.points.is_empty() => all.push(lacks("points", "points")),
            Steps | Ramps | Spline => all.extend(self.point_refusals(context)),
            Log if self.file.is_empty() => all.push(lacks("file", "a file")),
            Spectrum if context.run_s > MAX_PEAK_PERIODS * self.period_s.unwrap_or(context.period_s) => {
                let found = format_number(self.period_s.unwrap_or(context.period_s));
                let expected = format!("at most {MAX_PEAK_PERIODS:.0} peak periods in the run");
                all.push(refuse("period_s", found, expected));
            }
            _ => {}
        }
        all
    }

    /// Refuses times that do not ascend within the period, and transitions that overlap.
    fn point_refusals(&self, context: &Context<'_>) -> Option<Refusal> {
        let period_s = self.period_s.unwrap_or(context.period_s);
        let ends = self.points.iter().map(|[time_s, _]| *time_s).chain([period_s]).collect::<Vec<_>>();
        let gap_s = ends.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
        let field = |name: &str| format!("{}.{name}", context.name);
        if ends.first() != Some(&0.0) || gap_s <= 0.0 || self.points.iter().flatten().any(|v| !v.is_finite())
        {
            let expected =
                format!("ascending times from 0 to below the period of {} s", format_number(period_s));
            let times = ends
                .split_last()
                .map(|(_, times)| times.iter().map(|t| format_number(*t)).collect::<Vec<_>>());
            let found = format!("at the times {}", times.unwrap_or_default().join(", "));
            return Some((field("points"), found, expected));
        }
        let needs_transition = self.kind != CourseKind::Spline && self.points.len() > 1;
        let is_possible = (1e-6..=gap_s).contains(&self.transition_s);
        (needs_transition && !is_possible).then(|| {
            let expected = format!("1e-6 to {} s, the smallest distance of two points", format_number(gap_s));
            (field("transition_s"), format_number(self.transition_s), expected)
        })
    }

    /// Reads the file of a `log`, and makes its path absolute. The folder is that of the
    /// description.
    pub(super) fn read_log(&mut self, folder: &Path, channel: Channel) -> Result<Profile, (String, String)> {
        let expected = |reason: String| (format!("`{}`", self.file), format!("a readable log: {reason}"));
        let path = std::path::absolute(folder.join(&self.file)).map_err(|e| expected(e.to_string()))?;
        let mut columns = Columns::new();
        for (name, column) in [(channel.name(), &self.column), (TIME, &self.time_column)] {
            if !column.is_empty() {
                columns.insert(name.into(), Column::from(column.clone()));
            }
        }
        let log = MeasuredLog::read(&path, &LogFormat { text: None, columns })
            .map_err(|e| expected(e.to_string()))?;
        let values = log.need(channel).map_err(|e| expected(e.to_string()))?;
        let first_s = log.time_s.first().copied().unwrap_or_default();
        let time_s: Vec<f64> = log.time_s.iter().map(|t| t - first_s).collect();
        self.file = path.display().to_string();
        let interval_s = time_s.last().copied().unwrap_or_default() / time_s.len().max(2) as f64;
        Ok(if self.smoothing_s > 0.0 {
            // Fewer samples do not determine the polynomials at both ends of the log.
            let half_s = self.smoothing_s.max(MIN_INTERVALS * interval_s);
            Profile::through(&time_s, values, None, half_s, 4)
        } else {
            let nodes = spline::open(&time_s, values);
            Profile::Curve { time_s, nodes }
        })
    }
}
