//! The controller's side of the conversation with the host: a message in, a message out.
//!
//! Waiting (after start or [`ToController::Stop`]) -> configured by [`ToController::Configure`] -> one estimate a sample. Nothing is served
//! before it is configured; every refusal has a name.

use inference::{Bearing, Model, shipped};
use link::{
    BadFrames, BuildId, ClockSource, Configuration, Configured, Counters, EstimateFrame, Fault, FrameError,
    Hello, MAGIC, ModelId, PROTOCOL_VERSION, Refusal, SensorFrame, Target, ToController, ToHost,
};

use crate::estimator::{Estimator, WINDOW, flags_of};
use crate::flags::{SENSOR_FAULT, SEQUENCE_GAP, TIME_FAULT};

/// A free-running counter that times one tick's work.
pub trait TickSource {
    /// Takes the count at the start of the work.
    fn start(&mut self) -> u32;
    /// Ticks since `start`.
    fn since(&mut self, start: u32) -> u32;
}

/// No counter: every duration is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoTicks;

impl TickSource for NoTicks {
    fn start(&mut self) -> u32 {
        0
    }

    fn since(&mut self, _start: u32) -> u32 {
        0
    }
}

/// What the controller says about itself in a [`Hello`].
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Name of the build.
    pub build_id: BuildId,
    /// Where it runs.
    pub target: Target,
    /// What drives the core.
    pub clock: ClockSource,
    /// Core frequency, Hz.
    pub core_hz: u32,
}

/// One conversation.
#[derive(Debug)]
pub struct Session {
    hello: Hello,
    running: Option<(Estimator, Configuration)>,
    counters: Counters,
    bad_frames: BadFrames,
}

impl Session {
    /// Creates a session that waits to be configured.
    #[must_use]
    pub fn new(identity: Identity) -> Self {
        let hello = Hello {
            magic: MAGIC,
            protocol: PROTOCOL_VERSION,
            build_id: identity.build_id,
            target: identity.target,
            clock: identity.clock,
            core_hz: identity.core_hz,
            window: WINDOW as u16,
            models: Bearing::ALL.map(model_id),
        };
        Self { hello, running: None, counters: Counters::default(), bad_frames: BadFrames::default() }
    }

    /// The greeting.
    #[must_use]
    pub const fn hello(&self) -> Hello {
        self.hello
    }

    /// Serves one message.
    pub fn handle(&mut self, message: &ToController, ticks: &mut impl TickSource) -> ToHost {
        match message {
            ToController::Identify => ToHost::Hello(self.hello),
            ToController::Configure(configuration) => match self.configure(*configuration) {
                Ok(configured) => ToHost::Configured(configured),
                Err(refusal) => ToHost::Fault(Fault::Refused(refusal)),
            },
            ToController::Sensor(frame) => match self.sample(frame, ticks) {
                Some(estimate) => ToHost::Estimate(estimate),
                None => ToHost::Fault(Fault::NotConfigured { sequence: frame.sequence }),
            },
            ToController::Stop => {
                self.running = None;
                ToHost::Stopped(Counters {
                    bad_frames: self.bad_frames,
                    ..core::mem::take(&mut self.counters)
                })
            }
        }
    }

    /// Counts a frame that could not be read, and answers it so that a waiting host learns of it.
    pub fn bad_frame(&mut self, error: FrameError) -> ToHost {
        self.bad_frames.count(error);
        ToHost::Fault(Fault::BadFrame(error))
    }

    /// Counts a timer tick whose work ran into the next one.
    pub const fn count_overrun(&mut self) {
        self.counters.deadline_overruns = self.counters.deadline_overruns.saturating_add(1);
    }

    /// Counts a timer tick of a configured session that found no sample waiting. In lockstep the timer paces nothing.
    pub fn count_idle_tick(&mut self) {
        if self.running.is_some() && self.hello.target == Target::Silicon {
            self.counters.idle_ticks = self.counters.idle_ticks.saturating_add(1);
        }
    }

    /// Counts a sample that was dropped because there was no room for it.
    pub const fn count_dropped(&mut self) {
        self.counters.dropped = self.counters.dropped.saturating_add(1);
    }

    fn configure(&mut self, configuration: Configuration) -> Result<Configured, Refusal> {
        self.running = None;
        self.counters = Counters::default();
        let bearing = Bearing::from_code(configuration.bearing)
            .ok_or(Refusal::UnknownBearing { found: configuration.bearing })?;
        let estimator = Estimator::new(shipped(bearing), configuration)?;
        self.running = Some((estimator, configuration));
        Ok(Configured { configuration, model: model_id(bearing), window: self.hello.window })
    }

    fn sample(&mut self, frame: &SensorFrame, ticks: &mut impl TickSource) -> Option<EstimateFrame> {
        let (estimator, configuration) = self.running.as_mut()?;
        let start = ticks.start();
        let mut estimate = estimator.step(frame);
        estimate.instruction_ticks = ticks.since(start);

        let flags = flags_of(&estimate);
        let budget =
            u64::from(self.hello.core_hz).wrapping_mul(u64::from(configuration.sample_period_us)) / 1_000_000;
        let late = self.hello.target == Target::Silicon && u64::from(estimate.instruction_ticks) > budget;
        let count =
            |counter: &mut u32, happened: bool| *counter = counter.saturating_add(u32::from(happened));
        count(&mut self.counters.samples, true);
        count(&mut self.counters.flagged, flags.intersects(SENSOR_FAULT));
        count(&mut self.counters.sequence_gaps, flags.contains(SEQUENCE_GAP));
        count(&mut self.counters.time_faults, flags.contains(TIME_FAULT));
        count(&mut self.counters.deadline_overruns, late);
        Some(estimate)
    }
}

fn model_id(bearing: Bearing) -> ModelId {
    match Model::<i16>::load(shipped(bearing)) {
        Ok(model) => ModelId { crc: model.check_sum(), training_id: model.header().training_id },
        Err(_) => ModelId { crc: 0, training_id: 0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIGURATION: Configuration = Configuration {
        bearing: 0,
        radial_clearance_nm: 500_000,
        journal_radius_nm: 69_500_000,
        sample_period_us: 100,
        latch_floor_um_s: 1_000,
        unseen_approach_um_s: 1_000,
    };

    struct Fixed(u32);

    impl TickSource for Fixed {
        fn start(&mut self) -> u32 {
            5
        }

        fn since(&mut self, start: u32) -> u32 {
            self.0 - start
        }
    }

    fn session(target: Target) -> Session {
        let build_id = BuildId::new("test");
        Session::new(Identity { build_id, target, clock: ClockSource::Internal, core_hz: 168_000_000 })
    }

    fn sensor(sequence: u32) -> ToController {
        ToController::Sensor(SensorFrame { sequence, time_us: sequence * 100, ..SensorFrame::default() })
    }

    #[test]
    fn the_greeting_names_both_models() {
        let ToHost::Hello(hello) = session(Target::Native).handle(&ToController::Identify, &mut NoTicks)
        else {
            panic!("expected a greeting");
        };
        assert_eq!((hello.magic, hello.protocol, hello.window), (MAGIC, PROTOCOL_VERSION, WINDOW as u16));
        assert!(hello.models.iter().all(|model| model.crc != 0));
        assert_ne!(hello.models[0], hello.models[1]);
    }

    #[test]
    fn samples_before_a_configuration_and_after_a_stop_are_refused() {
        let mut session = session(Target::Native);
        let refused = ToHost::Fault(Fault::NotConfigured { sequence: 3 });
        assert_eq!(session.handle(&sensor(3), &mut NoTicks), refused);
        assert!(matches!(
            session.handle(&ToController::Configure(CONFIGURATION), &mut NoTicks),
            ToHost::Configured(_)
        ));
        assert!(matches!(session.handle(&sensor(3), &mut NoTicks), ToHost::Estimate(_)));
        session.handle(&ToController::Stop, &mut NoTicks);
        assert_eq!(session.handle(&sensor(3), &mut NoTicks), refused);
    }

    #[test]
    fn a_refused_configuration_leaves_nothing_running() {
        let mut session = session(Target::Native);
        session.handle(&ToController::Configure(CONFIGURATION), &mut NoTicks);
        let bad = Configuration { bearing: 7, ..CONFIGURATION };
        let answer = session.handle(&ToController::Configure(bad), &mut NoTicks);
        assert_eq!(answer, ToHost::Fault(Fault::Refused(Refusal::UnknownBearing { found: 7 })));
        assert!(matches!(
            session.handle(&sensor(1), &mut NoTicks),
            ToHost::Fault(Fault::NotConfigured { .. })
        ));
    }

    #[test]
    fn the_counters_tell_what_happened() {
        let mut session = session(Target::Silicon);
        session.bad_frame(FrameError::Crc);
        session.handle(&ToController::Configure(CONFIGURATION), &mut NoTicks);
        for sequence in [0, 1, 2, 5, 6] {
            session.handle(&sensor(sequence), &mut Fixed(16_805));
        }
        session.handle(&sensor(7), &mut Fixed(16_806));
        session.count_idle_tick();
        session.count_dropped();
        let ToHost::Stopped(counters) = session.handle(&ToController::Stop, &mut NoTicks) else {
            panic!("expected the counters");
        };
        let expected = Counters {
            samples: 6,
            flagged: 1,
            sequence_gaps: 1,
            time_faults: 1,
            deadline_overruns: 1,
            idle_ticks: 1,
            dropped: 1,
            bad_frames: BadFrames { crc: 1, ..BadFrames::default() },
        };
        assert_eq!(counters, expected);
    }

    #[test]
    fn the_emulator_s_timer_counts_for_nothing() {
        let mut session = session(Target::Emulator);
        session.handle(&ToController::Configure(CONFIGURATION), &mut NoTicks);
        session.handle(&sensor(0), &mut Fixed(20_000));
        session.count_idle_tick();
        let expected = Counters { samples: 1, ..Counters::default() };
        assert_eq!(session.handle(&ToController::Stop, &mut NoTicks), ToHost::Stopped(expected));
    }
}
