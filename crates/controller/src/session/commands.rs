//! Execution of commands: each once, in the order of their numbers, answered as often as it
//! arrives.

use inference::ImageError;
use link::{
    Acknowledgement, Answer, Command, Configured, ControllerConfiguration, NumberedCommand, Refusal,
    ToController,
};

use super::Session;
use super::conversation::Execution;
use super::run::Run;
use super::telemetry::count;
use crate::configuration::validate;

impl Session {
    /// Executes a command if it is the next one, or repeats the outcome if it is the last one.
    pub(super) fn acknowledge(&mut self, numbered: &NumberedCommand) -> Acknowledgement {
        let id = numbered.id;
        if self.conversation.is_authenticated() && !numbered.command.changes_state() {
            // Its number does not count: anyone could use up the numbers of authenticated commands.
            return Acknowledgement { id, outcome: self.execute(&numbered.command) };
        }
        let outcome = match self.conversation.decide_execution(numbered) {
            Execution::Next => {
                let outcome = self.execute(&numbered.command);
                self.conversation.record(*numbered, outcome);
                outcome
            }
            Execution::Repeated(outcome) => {
                count(&mut self.telemetry.counters.repeated_commands, true);
                return Acknowledgement { id, outcome };
            }
            Execution::Refused(reason) => Err(reason),
        };
        count(&mut self.telemetry.counters.refused_commands, outcome.is_err());
        Acknowledgement { id, outcome }
    }

    /// Refuses a command without looking at its number.
    pub(crate) fn refuse(&mut self, id: u32, reason: Refusal) -> Acknowledgement {
        count(&mut self.telemetry.counters.refused_commands, true);
        Acknowledgement { id, outcome: Err(reason) }
    }

    fn execute(&mut self, command: &Command) -> Result<Answer, Refusal> {
        match command {
            Command::Configure(configuration) => self.configure(configuration).map(Answer::Configured),
            Command::GetConfiguration => Ok(Answer::Configuration(self.configuration)),
            Command::Keep => {
                let is_saved = core::mem::take(&mut self.is_saved);
                match (self.run.is_some(), self.configuration) {
                    (true, _) => Err(Refusal::Running),
                    (false, None) => Err(Refusal::NotConfigured),
                    (false, Some(_)) if is_saved => Ok(Answer::Kept),
                    (false, Some(_)) => Err(Refusal::NotKept),
                }
            }
            Command::GetCounters => Ok(Answer::Counters(self.telemetry.counters)),
            Command::ClearTrip => {
                let run = self.run.as_mut().ok_or(Refusal::NotConfigured)?;
                run.deadline.clear();
                Ok(Answer::Cleared)
            }
            Command::Stop => {
                self.finish_impacts();
                let counters = self.telemetry.counters;
                self.run = None;
                self.telemetry.reset_run();
                Ok(Answer::Stopped(counters))
            }
            Command::SampleYourself => self.start_sampling().map(|every| Answer::Sampling { every }),
            Command::PermitUpdate(_) => Ok(Answer::UpdatePermitted),
            Command::GetReport(kind) => self.report(*kind).map(Answer::Report).ok_or(Refusal::NotConfigured),
        }
    }

    /// Checks a complete configuration and starts a run with it. A refused one changes nothing.
    ///
    /// # Errors
    ///
    /// Fields are out of range, there is no model for the bearing, or the code in flash is
    /// corrupted.
    pub fn configure(&mut self, configuration: &ControllerConfiguration) -> Result<Configured, Refusal> {
        if self.conversation.is_code_corrupted {
            return Err(Refusal::Image { cause: ImageError::CRC });
        }
        validate(configuration).map_err(Refusal::Configuration)?;
        let run = Run::new(*configuration, &self.models, self.conversation.timed_hz())?;
        let configured = run.configured;
        self.finish_impacts();
        self.telemetry.schedule.restart(configuration.limits.slow_every);
        self.configuration = Some(*configuration);
        self.has_new_wiring = true;
        self.conversation.set_configuration_crc(configured.configuration_crc);
        self.run = Some(run);
        self.telemetry.reset_run();
        Ok(configured)
    }

    /// Returns the configuration that a message asks to save and that may be saved now: flash is
    /// only written while no run is on. The caller saves it, calls [`Session::set_saved`], and then
    /// has the session handle the message.
    #[must_use]
    pub(crate) fn configuration_to_save(&self, message: &ToController) -> Option<ControllerConfiguration> {
        let next = self.conversation.next_number();
        match message {
            ToController::Command(numbered) | ToController::Authenticated(numbered, _)
                if *numbered == (NumberedCommand { id: next, command: Command::Keep }) =>
            {
                self.configuration.filter(|_| self.run.is_none())
            }
            _ => None,
        }
    }

    /// Sets whether the configuration of [`Session::configuration_to_save`] has been saved.
    pub(crate) const fn set_saved(&mut self, is_saved: bool) {
        self.is_saved = is_saved;
    }
}
