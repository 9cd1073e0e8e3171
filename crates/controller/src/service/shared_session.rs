//! State that the timer tick and the link service share.

use core::convert::Infallible;

use heapless::Deque;
use link::track::SensorStatus;
use link::{BadFrames, SamplingReport, SensorFrame, State};

use super::journal::{LoggedState, Losses};
use crate::sensors::{Acquired, AngleSensor, SampleClock, Sampler, SensorBus, Wiring};
use crate::session::{SentEstimate, Session, TickSource};

/// Length of the queues of samples and estimates. A host in lockstep has one sample on the way.
const QUEUE: usize = 8;

/// Sensors of the board.
pub trait SampleSource {
    /// Converts what was acquired to a sample of every sensor.
    fn sample(&mut self, acquired: &Acquired) -> (SensorFrame, SensorStatus);
    /// Changes the period of the samples, us. Returns true if it is that already.
    fn set_period(&mut self, period_us: u32) -> bool;
    /// Starts the samples anew.
    fn restart(&mut self);
    /// Returns the last sample before calibration.
    fn latest(&self) -> SensorFrame;
    /// Uses other wiring from the next sample on.
    fn rewire(&mut self, wiring: Wiring);
}

impl<BUS: SensorBus, ANGLE: AngleSensor> SampleSource for Sampler<BUS, ANGLE> {
    fn sample(&mut self, acquired: &Acquired) -> (SensorFrame, SensorStatus) {
        Sampler::sample(self, acquired)
    }

    fn set_period(&mut self, period_us: u32) -> bool {
        Sampler::set_period(self, period_us)
    }

    fn restart(&mut self) {
        Sampler::run(self);
    }

    fn latest(&self) -> SensorFrame {
        Sampler::latest(self)
    }

    fn rewire(&mut self, wiring: Wiring) {
        Sampler::rewire(self, wiring);
    }
}

/// The sensors of a board without sensors.
impl SampleSource for Infallible {
    fn sample(&mut self, _acquired: &Acquired) -> (SensorFrame, SensorStatus) {
        match *self {}
    }

    fn set_period(&mut self, _period_us: u32) -> bool {
        match *self {}
    }

    fn restart(&mut self) {
        match *self {}
    }

    fn latest(&self) -> SensorFrame {
        match *self {}
    }

    fn rewire(&mut self, _wiring: Wiring) {
        match *self {}
    }
}

/// Outcome of [`SharedSession::tick`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tick {
    /// There was a sample.
    Sampled,
    /// No sample was waiting.
    Idle,
}

/// The session with the queues between tick and service, and the board's sensors.
///
/// In this type and those within it the state of the filter comes first. It is a static of the
/// firmware, and offsets below 4 KiB fit into an instruction of the core.
#[repr(C)]
pub struct SharedSession<S> {
    /// The session.
    pub session: Session,
    samples: Deque<(SensorFrame, SensorStatus), QUEUE>,
    estimates: Deque<SentEstimate, QUEUE>,
    sensors: Option<S>,
    /// Timing of own samples; `None` without a timer that triggers them.
    sampling: Option<SampleClock>,
}

impl<S: SampleSource> SharedSession<S> {
    /// Creates the state with empty queues.
    pub const fn new(session: Session, sensors: Option<S>) -> Self {
        Self { session, samples: Deque::new(), estimates: Deque::new(), sensors, sampling: None }
    }

    /// Decides whether the session estimates.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.session.state() == State::Running
    }

    /// Runs one timer tick: takes a sample of the board's sensors or the link's next one,
    /// estimates, and queues the frame of the estimate. `is_paced`: the time since the next tick on
    /// is the sample period of the run, see [`Pace::set_period`]; own samples wait for that.
    ///
    /// [`Pace::set_period`]: super::Pace::set_period
    pub fn tick(&mut self, acquired: &Acquired, is_paced: bool, ticks: &mut impl TickSource) -> Tick {
        let period_us = self.session.sample_period_us();
        let is_paced = self.sensors.as_mut().is_none_or(|sensors| sensors.set_period(period_us)) && is_paced;
        if self.session.is_sampling() && !is_paced {
            return Tick::Idle;
        }
        let received = self.samples.pop_front();
        let estimate = match (&mut self.sensors, received) {
            (Some(sensors), received) if self.session.is_sampling() => {
                if received.is_some() {
                    self.session.count_dropped_sample();
                }
                self.session.tick_own_sample(|| sensors.sample(acquired), ticks)
            }
            // A sample before any configuration has no answer: the state is in every hello frame.
            (_, Some((frame, status))) => {
                let frame = self.session.tick(&frame, status, ticks).ok();
                frame.map(|frame| SentEstimate { frame, block: None })
            }
            (_, None) => {
                self.session.count_idle_tick();
                return Tick::Idle;
            }
        };
        if let Some(estimate) = estimate
            && self.estimates.push_back(estimate).is_err()
        {
            self.session.count_dropped_estimate();
        }
        Tick::Sampled
    }

    /// Returns the period of the timer that paces the samples, us.
    #[must_use]
    pub fn sample_period_us(&self) -> u32 {
        self.session.sample_period_us()
    }

    /// Queues a sample of the link for the tick, or counts it as dropped.
    pub(super) fn queue_sample(&mut self, frame: SensorFrame, status: SensorStatus) {
        if self.samples.push_back((frame, status)).is_err() {
            self.session.count_dropped_sample();
        }
    }

    /// Takes the oldest queued estimate.
    pub(super) fn next_estimate(&mut self) -> Option<SentEstimate> {
        self.estimates.pop_front()
    }

    /// Returns the last sample of the board's sensors.
    pub(super) fn latest_sample(&self) -> Option<SensorFrame> {
        self.sensors.as_ref().map(S::latest)
    }

    /// Starts the samples of the board anew, after they have failed to arrive.
    pub fn restart_samples(&mut self) {
        if let Some(sensors) = &mut self.sensors {
            sensors.restart();
        }
    }

    /// Notes the timing of the board's samples.
    pub fn note_sampling(&mut self, clock: &SampleClock) {
        self.sampling = Some(clock.clone());
    }

    /// Returns the timing of the board's samples.
    pub(super) fn sampling(&self) -> Option<SamplingReport> {
        self.sampling.as_ref().map(SampleClock::report)
    }

    /// Returns the state for the log.
    pub(super) fn logged_state(&self) -> LoggedState {
        LoggedState {
            state: self.session.state(),
            is_sampling: self.session.is_sampling(),
            period_us: self.session.sample_period_us(),
        }
    }

    /// Returns what was late, lost or refused, for the log.
    pub(super) fn losses(&self) -> Losses {
        let counters = self.session.counters();
        let BadFrames { cobs, crc, overlong, unknown } = counters.bad_frames;
        let frames = [cobs, crc, overlong, unknown];
        Losses {
            late: counters.deadline_overruns,
            samples: self
                .sampling
                .as_ref()
                .map_or(0, |clock| clock.report().lost)
                .saturating_add(counters.dropped_samples),
            estimates: counters.dropped_estimates,
            received: frames.iter().fold(counters.dropped_bytes, |sum, count| sum.saturating_add(*count)),
            commands: counters.refused_commands,
        }
    }

    /// Passes the wiring of a newly accepted configuration to the sensors.
    pub(super) fn rewire(&mut self) {
        if let (Some(wiring), Some(sensors)) = (self.session.take_wiring(), &mut self.sensors) {
            sensors.rewire(wiring);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;
    use crate::session::{Identity, NoTicks, OwnSampling};
    use link::{BuildId, ClockSource, Target};

    /// Sensors that count their samples.
    struct Counted(u32);

    impl SampleSource for Counted {
        fn sample(&mut self, acquired: &Acquired) -> (SensorFrame, SensorStatus) {
            self.0 += 1;
            (
                SensorFrame { sequence: self.0, time_us: acquired.time_us, ..SensorFrame::default() },
                SensorStatus::GOOD,
            )
        }

        fn set_period(&mut self, _period_us: u32) -> bool {
            true
        }

        fn restart(&mut self) {}

        fn latest(&self) -> SensorFrame {
            SensorFrame::default()
        }

        fn rewire(&mut self, _wiring: Wiring) {}
    }

    #[test]
    fn own_samples_wait_until_the_timer_has_their_period() {
        let (target, clock) = (Target::Silicon, ClockSource::Internal);
        let identity = Identity { build_id: BuildId::new("test"), target, clock, core_hz: 168_000_000 };
        let mut session = Session::new(identity);
        session.set_own_sampling(Some(OwnSampling { shortest_period_us: 100, input_interval_ns: 0 }));
        session.configure(&BENCH_B).unwrap();
        session.start_sampling().unwrap();
        let mut shared = SharedSession::new(session, Some(Counted(0)));
        let acquired = Acquired::nothing;
        assert_eq!(shared.tick(&acquired(100), false, &mut NoTicks), Tick::Idle);
        assert_eq!(shared.sensors.as_ref().unwrap().0, 0);
        assert_eq!(shared.tick(&acquired(200), true, &mut NoTicks), Tick::Sampled);
        assert_eq!(shared.sensors.as_ref().unwrap().0, 1);
    }
}
