//! Courses of the drive and the load of a transmission bench.

use super::profile::Context;
use super::{CourseKind, CourseSection, TransmissionBench};
use crate::description::{LoggedCourses, PlantDescription, Refusal, format_number};
use crate::signals::{Channel, Profile};
use std::path::Path;

/// Most samples at which the reach of the drive is checked.
const MAX_CHECKED: f64 = 2e5;
/// Samples per period at which it is checked.
const CHECKED_PER_PERIOD: f64 = 400.0;

impl TransmissionBench {
    fn drive_context(&self) -> Context<'_> {
        Context {
            name: "drive_profile",
            period_s: self.drive.period_s,
            run_s: self.duration_s(),
            logged: self.extension.courses.drive.as_ref(),
        }
    }

    fn load_context(&self) -> Context<'_> {
        let logged = self.extension.courses.load.as_ref();
        Context { name: "load_profile", logged, ..self.drive_context() }
    }

    /// Course of the drive; none if it is the sine of `[drive]`.
    pub(super) fn drive_course(&self) -> Option<Profile> {
        let section = self.drive_profile.as_ref()?;
        let course = Box::new(section.course(&self.drive_context()));
        Some(Profile::Raised { mean: section.mean, course, ramp_s: 0.0 })
    }

    /// Course of the load with its ramp; none if it is constant.
    pub(super) fn load_course(&self) -> Option<Profile> {
        let section = self.load_profile.as_ref()?;
        let course = Box::new(section.course(&self.load_context()));
        Some(Profile::Raised { mean: self.load.force_n + section.mean, course, ramp_s: self.load.ramp_s })
    }

    /// Reads the files of the courses; `folder` is that of the description.
    pub(crate) fn read_courses(&mut self, folder: &Path) -> Vec<Refusal> {
        let mut refusals = Vec::new();
        let mut read = |section: &mut Option<CourseSection>, name: &str, channel| {
            let section = section.as_mut().filter(|s| s.kind == CourseKind::Log && !s.file.is_empty())?;
            match section.read_log(folder, channel) {
                Ok(course) => Some(course),
                Err((found, expected)) => {
                    refusals.push((format!("{name}.file"), found, expected));
                    None
                }
            }
        };
        let drive = read(&mut self.drive_profile, "drive_profile", Channel::DriveDisplacement);
        let load = read(&mut self.load_profile, "load_profile", Channel::LoadForce);
        self.extension.courses = LoggedCourses { drive, load };
        if refusals.is_empty() {
            refusals.extend(self.length_refusals());
        }
        refusals
    }

    /// Refuses logs that are shorter than the run.
    fn length_refusals(&self) -> Vec<Refusal> {
        let run_s = self.duration_s();
        let too_short = |context: Context<'_>| match context.logged {
            Some(Profile::Curve { time_s, .. }) if time_s.last().is_some_and(|end| *end < run_s) => {
                let end_s = time_s.last().copied().unwrap_or_default();
                let found = format!("of a log of {} s", format_number(end_s));
                let expected = format!("a log as long as the run: drive.cycles of drive.period_s, {run_s} s");
                Some((format!("{}.file", context.name), found, expected))
            }
            _ => None,
        };
        [self.drive_context(), self.load_context()].into_iter().filter_map(too_short).collect()
    }

    /// Everything that is not allowed in the courses.
    pub(super) fn course_refusals(&self) -> Vec<Refusal> {
        let drive = self.drive_profile.as_ref().map(|section| section.refusals(&self.drive_context()));
        let load = self.load_profile.as_ref().map(|section| section.refusals(&self.load_context()));
        let mut all: Vec<Refusal> = drive.into_iter().chain(load).flatten().collect();
        if all.is_empty() {
            all.extend(self.reach_refusal());
        }
        all
    }

    /// Refuses a drive that reaches beyond the crank.
    fn reach_refusal(&self) -> Option<Refusal> {
        let course = self.drive_course()?;
        let (run_s, period_s) = (self.duration_s(), self.period_s());
        let count = (CHECKED_PER_PERIOD * run_s / period_s).min(MAX_CHECKED).ceil();
        let at = |i: usize| course.at(i as f64 * run_s / count).value.abs();
        let reach_m = (0..=count as usize).map(at).fold(0.0, f64::max);
        let max_m = 0.99 * self.geometry.drive_lever_radius_m;
        (reach_m > max_m).then(|| {
            let found = format!("a course that reaches {} m", format_number(reach_m));
            let expected = format!("at most {} m, 0.99 of the drive crank", format_number(max_m));
            ("drive_profile".into(), found, expected)
        })
    }
}
