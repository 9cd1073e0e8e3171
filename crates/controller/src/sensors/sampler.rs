//! One sample of all sensors as a frame in the controller's time.
//!
//! The inputs of the converter are read in a ring: each frame returns the input selected by the
//! previous one and selects the next. The last frame selects the first input for the next sample.
//! Each input is sampled at the select of its frame. The first probe's instant counts as that of
//! the sample. The second probe follows two slots later ([`SlotTiming::input_interval_ns`]), which
//! the filter takes into account. Load and third probe follow later still; the load changes too
//! slowly for that to matter, and the tolerance of the third probe covers it.
//!
//! [`SlotTiming::input_interval_ns`]: super::SlotTiming::input_interval_ns
//!
//! A channel without a value keeps its last one in the frame and is marked as missing. A channel at
//! its rail carries the rail's value and is marked. Two probes make two coordinates: if one has no
//! value, neither coordinate has one.
//!
//! After a fault of the converter's bus the input of the next frame is unknown, so that one is
//! missing, too.
//!
//! A converter that has not accepted its configuration is configured again instead of being read.
//! All its channels are missing until then.

use link::track::{CHANNELS, SensorChannel, SensorStatus};
use link::{InputRange, SensorFrame};

use super::converter::code;
use super::sequence::{EncoderAnswers, conversion};
use super::{
    Acquired, Ads8688, AngleSensor, Answers, FAULTS, ProbePair, Scale, SensorBus, SensorFault, Sequence,
    Transmitter,
};

/// Maximum number of inputs in a sample: two probes, a third one, two transmitters.
pub(super) const MAX_INPUTS: usize = 5;
/// Distance from an end of the range within which a code counts as at the rail.
const RAIL_CODES: u16 = 16;

/// Samples without any code after which the converter is configured again and the sequence starts
/// anew: the converter may have lost its supply, or the words their places.
const MAX_SILENT: u8 = 8;

/// Probe: its input and its scale.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// Input of the converter.
    pub input: u8,
    /// Scale of its gap.
    pub scale: Scale,
}

/// Transmitter: its input and its scale.
#[derive(Clone, Copy, Debug)]
pub struct LoadInput {
    /// Input of the converter.
    pub input: u8,
    /// Scale of its force.
    pub transmitter: Transmitter,
}

/// Connections of the converter.
#[derive(Clone, Copy, Debug)]
pub struct Wiring {
    /// First two probes.
    pub probes: [Probe; 2],
    /// Third probe, if the geometry has one.
    pub opposite: Option<Probe>,
    /// Directions and gaps of the probes.
    pub geometry: ProbePair,
    /// Transmitter whose piston pushes along +y.
    pub load: LoadInput,
    /// Transmitter of the opposite side, if there is one.
    pub counter_load: Option<LoadInput>,
    /// Range of the probes' inputs.
    pub probe_range: InputRange,
    /// Range of the transmitters' inputs.
    pub load_range: InputRange,
}

/// Number of faults by channel and kind, saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultCounts([[u32; FAULTS.len()]; CHANNELS]);

impl FaultCounts {
    /// Returns the number of faults of one kind in one channel.
    #[must_use]
    pub fn count(&self, channel: SensorChannel, fault: SensorFault) -> u32 {
        self.0.get(channel as usize).and_then(|row| row.get(fault as usize)).copied().unwrap_or_default()
    }

    fn add(&mut self, channel: SensorChannel, fault: SensorFault) {
        if let Some(count) = self.0.get_mut(channel as usize).and_then(|row| row.get_mut(fault as usize)) {
            *count = count.saturating_add(1);
        }
    }
}

/// All sensors of a bench.
#[derive(Debug)]
pub struct Sampler<BUS, ANGLE> {
    bus: BUS,
    angle: ANGLE,
    wiring: Wiring,
    period_us: u32,
    /// Number of the run of the hardware, and of the inputs in it; `None` before the first one.
    running: Option<(u32, usize)>,
    /// Samples since the last one with a code of the converter.
    silent: u8,
    /// `true` once the converter has accepted its configuration.
    configured: bool,
    /// `true` if the next frame returns the expected input.
    in_step: bool,
    frame: SensorFrame,
    faults: FaultCounts,
}

type Code = Result<u16, SensorFault>;

impl<BUS: SensorBus, ANGLE: AngleSensor> Sampler<BUS, ANGLE> {
    /// Takes the devices and the first period of the samples, us. The first sample configures the
    /// converter if [`Self::configure`] has not.
    pub fn new(bus: BUS, angle: ANGLE, wiring: Wiring, period_us: u32) -> Self {
        let first = SensorFrame { sequence: u32::MAX, ..SensorFrame::default() };
        Self {
            bus,
            angle,
            wiring,
            period_us,
            running: None,
            silent: 0,
            configured: false,
            in_step: false,
            frame: first,
            faults: FaultCounts::default(),
        }
    }

    /// Changes the wiring. The next sample configures the converter again.
    pub(crate) fn rewire(&mut self, wiring: Wiring) {
        self.wiring = wiring;
        self.configured = false;
        self.in_step = false;
    }

    /// Configures the converter and runs the sequence of the samples, also without an answer: the
    /// sequence paces the controller. May be repeated.
    ///
    /// # Errors
    ///
    /// The bus failed, or a register did not read back.
    pub fn configure(&mut self) -> Result<(), SensorFault> {
        self.configured = false;
        self.in_step = false;
        let (inputs, count) = self.inputs();
        let mut ranges = [(0, self.wiring.probe_range); MAX_INPUTS];
        for (range, (input, is_load)) in ranges.iter_mut().zip(inputs) {
            *range = (input, if is_load { self.wiring.load_range } else { self.wiring.probe_range });
        }
        let ranges = ranges.get(..count).unwrap_or_default();
        let configured = Ads8688::new(self.bus.converter()).configure(ranges);
        self.run();
        configured?;
        self.configured = true;
        self.in_step = true;
        self.silent = 0;
        Ok(())
    }

    /// Runs the sequence anew.
    pub(crate) fn run(&mut self) {
        let (_, count) = self.inputs();
        let run = self.bus.run(&self.sequence(), self.period_us);
        self.running = Some((run, count));
        // The sequence before may have been cut.
        self.in_step = false;
    }

    /// Changes the period of the samples, us. Returns true if it is that already; if not, the
    /// sequence starts anew.
    pub fn set_period(&mut self, period_us: u32) -> bool {
        let is_current = self.period_us == period_us;
        self.period_us = period_us;
        if !is_current {
            self.run();
        }
        is_current
    }

    /// Returns the sequence of a sample.
    #[must_use]
    pub fn sequence(&self) -> Sequence {
        let (ring, count) = self.inputs();
        let inputs = ring.map(|(input, _)| input);
        Sequence::new(inputs.get(..count).unwrap_or_default(), ANGLE::IS_ON_BUS)
    }

    /// Converts the answers of a sequence to a sample. Those of an earlier run, from before a
    /// change of wiring or period, do not count.
    pub fn sample(&mut self, acquired: &Acquired) -> (SensorFrame, SensorStatus) {
        let mut status = SensorStatus::GOOD;
        let running = self.running.filter(|(run, _)| *run == acquired.run);
        let answers = running.and_then(|(_, count)| Some((acquired.answers.as_ref()?, count)));
        let encoder = answers.and_then(|(answers, count)| EncoderAnswers::of(answers, count));
        let codes = match answers {
            _ if !self.configured => {
                [Err(self.configure().err().unwrap_or(SensorFault::NotConfigured)); MAX_INPUTS]
            }
            Some((answers, _)) => self.codes(answers),
            None => [Err(SensorFault::Bus); MAX_INPUTS],
        };
        match self.journal(&codes) {
            Ok(([y, z], at_rail)) => {
                self.frame.journal_y_nm = y;
                self.frame.journal_z_nm = z;
                if at_rail {
                    self.fault(SensorChannel::JournalY, SensorFault::AtRail, &mut status);
                    self.fault(SensorChannel::JournalZ, SensorFault::AtRail, &mut status);
                }
            }
            Err(fault) => {
                self.fault(SensorChannel::JournalY, fault, &mut status);
                self.fault(SensorChannel::JournalZ, fault, &mut status);
            }
        }
        match self.angle.angle_nrad(encoder.as_ref()) {
            Ok(angle) => self.frame.shaft_angle_nrad = angle,
            Err(fault) => self.fault(SensorChannel::ShaftAngle, fault, &mut status),
        }
        match self.load_mn(&codes) {
            Ok(load_mn) => self.frame.load_force_mn = load_mn,
            Err(fault) => self.fault(SensorChannel::LoadForce, fault, &mut status),
        }
        self.frame.sequence = self.frame.sequence.wrapping_add(acquired.lost).wrapping_add(1);
        self.frame.time_us = acquired.time_us;
        (self.frame, status)
    }

    /// Returns the last sample.
    #[must_use]
    pub(crate) const fn latest(&self) -> SensorFrame {
        self.frame
    }

    /// Returns the fault counts.
    #[must_use]
    pub const fn faults(&self) -> &FaultCounts {
        &self.faults
    }

    /// Returns the devices.
    pub fn release(self) -> (BUS, ANGLE) {
        (self.bus, self.angle)
    }

    fn fault(&mut self, channel: SensorChannel, fault: SensorFault, status: &mut SensorStatus) {
        self.faults.add(channel, fault);
        *status =
            if fault == SensorFault::AtRail { status.at_rail(channel) } else { status.missing(channel) };
    }

    /// Returns the ring of inputs, each with a mark for transmitters, and their number.
    fn inputs(&self) -> ([(u8, bool); MAX_INPUTS], usize) {
        let wiring = &self.wiring;
        let [first, second] = wiring.probes;
        let probe = |probe: Probe| (probe.input, false);
        let load = |load: LoadInput| (load.input, true);
        let connected = [
            Some(probe(first)),
            Some(probe(second)),
            wiring.opposite.map(probe),
            Some(load(wiring.load)),
            wiring.counter_load.map(load),
        ];
        let mut ring = [(0, false); MAX_INPUTS];
        let mut count = 0;
        for (place, input) in ring.iter_mut().zip(connected.into_iter().flatten()) {
            *place = input;
            count += 1;
        }
        (ring, count)
    }

    /// Returns a code of every input, in the order of the ring.
    fn codes(&mut self, answers: &Answers) -> [Code; MAX_INPUTS] {
        let (_, count) = self.inputs();
        let mut codes = [Err(SensorFault::NoAnswer); MAX_INPUTS];
        for (number, found) in codes.iter_mut().enumerate().take(count) {
            let answer = conversion(answers, number, ANGLE::IS_ON_BUS).map_or(Err(SensorFault::Bus), code);
            *found = if self.in_step { answer } else { answer.and(Err(SensorFault::NoAnswer)) };
            self.in_step = answer.is_ok();
        }
        self.silent = if codes.iter().any(Result::is_ok) { 0 } else { self.silent.saturating_add(1) };
        self.configured = self.silent < MAX_SILENT;
        codes
    }

    /// Returns the journal's centre, and whether a probe is at its rail.
    fn journal(&self, codes: &[Code; MAX_INPUTS]) -> Result<([i32; 2], bool), SensorFault> {
        let [first, second, third, ..] = *codes;
        let (first, second) = (first?, second?);
        let [probe_first, probe_second] = self.wiring.probes;
        let gaps = [probe_first.scale.length_nm(first), probe_second.scale.length_nm(second)];
        if let Some(opposite) = self.wiring.opposite {
            self.wiring.geometry.agree(gaps, opposite.scale.length_nm(third?))?;
        }
        let at_rail = |code: u16| !(RAIL_CODES..=u16::MAX - RAIL_CODES).contains(&code);
        Ok((self.wiring.geometry.centre_nm(gaps), at_rail(first) | at_rail(second)))
    }

    fn load_mn(&self, codes: &[Code; MAX_INPUTS]) -> Result<i32, SensorFault> {
        let mut codes = codes.iter().skip(if self.wiring.opposite.is_some() { 3 } else { 2 });
        let mut force = |input: &LoadInput| {
            let code = codes.next().copied().unwrap_or(Err(SensorFault::NoAnswer))?;
            input.transmitter.force_mn(code)
        };
        let push = force(&self.wiring.load)?;
        let pull = self.wiring.counter_load.as_ref().map_or(Ok(0), force)?;
        Ok(push.wrapping_sub(pull).clamp(i64::from(i32::MIN) + 1, i64::from(i32::MAX)) as i32)
    }
}
