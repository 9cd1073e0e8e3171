//! Commands: each is carried out once, in order, and answered as often as it comes.

use link::{
    Acknowledgement, Answer, Command, Configured, ControllerConfiguration, Counters, NumberedCommand,
    Refused, Target, ToController,
};

use super::run::Run;
use super::{Session, count};
use crate::configuration::validate;

/// Position of the check sum's cause in the list of image errors.
const CHECK_SUM: u8 = 4;

/// The last command that was carried out, with its answer.
#[derive(Debug, Default)]
pub(super) struct LastCommand(Option<(NumberedCommand, Result<Answer, Refused>)>);

impl LastCommand {
    /// Its number; 0 before the first.
    pub(super) fn number(&self) -> u32 {
        self.0.as_ref().map_or(0, |(numbered, _)| numbered.id)
    }
}

impl Session {
    /// Carries a command out if it is the next one, or answers it again if it is the last one.
    pub(super) fn command(&mut self, numbered: &NumberedCommand) -> Acknowledgement {
        let id = numbered.id;
        let expected = self.commands.number().wrapping_add(1);
        let outcome = match &self.commands.0 {
            _ if id == expected => {
                let outcome = self.carry_out(&numbered.command);
                self.commands.0 = Some((*numbered, outcome));
                outcome
            }
            Some((last, outcome)) if last == numbered => {
                count(&mut self.counters.repeated_commands, true);
                return Acknowledgement { id, outcome: *outcome };
            }
            Some((last, _)) if last.id == id => Err(Refused::NumberTaken),
            _ => Err(Refused::OutOfOrder { expected }),
        };
        count(&mut self.counters.refused_commands, outcome.is_err());
        Acknowledgement { id, outcome }
    }

    fn carry_out(&mut self, command: &Command) -> Result<Answer, Refused> {
        match command {
            Command::Configure(configuration) => self.configure(configuration).map(Answer::Configured),
            Command::GetConfiguration => Ok(Answer::Configuration(self.configuration)),
            Command::Keep => {
                let kept = core::mem::take(&mut self.kept);
                match (self.run.is_some(), self.configuration) {
                    (true, _) => Err(Refused::Running),
                    (false, None) => Err(Refused::NotConfigured),
                    (false, Some(_)) if kept => Ok(Answer::Kept),
                    (false, Some(_)) => Err(Refused::NotKept),
                }
            }
            Command::GetCounters => Ok(Answer::Counters(self.counters)),
            Command::ClearTrip => {
                let run = self.run.as_mut().ok_or(Refused::NotConfigured)?;
                run.deadline.clear();
                Ok(Answer::Cleared)
            }
            Command::Stop => {
                let counters = self.counters;
                self.run = None;
                self.forget_run();
                Ok(Answer::Stopped(counters))
            }
            Command::SampleYourself => self.sample_itself().map(|every| Answer::Sampling { every }),
            Command::GetReport(kind) => self.report(*kind).map(Answer::Report).ok_or(Refused::NotConfigured),
        }
    }

    /// Checks a configuration as a whole and runs with it. Refused, it changes nothing.
    ///
    /// # Errors
    ///
    /// Fields are out of range, or there is no model for the bearing.
    pub fn configure(&mut self, configuration: &ControllerConfiguration) -> Result<Configured, Refused> {
        if self.code_altered {
            return Err(Refused::Image { cause: CHECK_SUM });
        }
        validate(configuration).map_err(Refused::Configuration)?;
        let is_timed = self.hello.target != Target::Emulator;
        let run = Run::new(*configuration, &self.models, if is_timed { self.hello.core_hz } else { 0 })?;
        let configured = run.configured;
        self.slow.left = configuration.limits.slow_every;
        self.configuration = Some(*configuration);
        self.rewired = true;
        self.hello.configuration_crc = configured.configuration_crc;
        self.run = Some(run);
        self.constants = None;
        self.forget_run();
        Ok(configured)
    }

    /// The configuration that a message wants kept and that may be kept now: the flash is written while no run is on. Whoever has a keeper
    /// keeps it, tells [`Session::take_kept`], and then has the message served.
    #[must_use]
    pub fn to_keep(&self, message: &ToController) -> Option<ControllerConfiguration> {
        let next = self.commands.number().wrapping_add(1);
        match message {
            ToController::Command(NumberedCommand { id, command: Command::Keep }) if *id == next => {
                self.configuration.filter(|_| self.run.is_none())
            }
            _ => None,
        }
    }

    /// Takes whether the configuration of [`Session::to_keep`] is kept now.
    pub const fn take_kept(&mut self, kept: bool) {
        self.kept = kept;
    }

    /// Counts anew what belongs to a run; what belongs to the link stays.
    fn forget_run(&mut self) {
        let Counters {
            dropped_answers,
            repeated_commands,
            refused_commands,
            dropped_bytes,
            line_errors,
            bad_frames,
            ..
        } = self.counters;
        self.counters = Counters {
            dropped_answers,
            repeated_commands,
            refused_commands,
            dropped_bytes,
            line_errors,
            bad_frames,
            ..Counters::default()
        };
    }
}
