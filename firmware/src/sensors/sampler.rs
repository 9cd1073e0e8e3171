//! One sample of all sensors as a frame in the controller's time.
//!
//! The inputs of the converter are asked in a ring: each frame returns the input selected by the one before and selects the next, the
//! last one selects the first for the next sample. So the first input is sampled at the select of the sample's first frame, the others
//! one frame time (2 us at 16 MHz) apart after it.
//!
//! A channel without a value keeps its last one in the frame and is marked missing; a channel at its rail carries the rail's value and is
//! marked. Two probes make two coordinates: when one has no value, neither coordinate has.
//!
//! After a fault of the converter's bus the input that the next frame returns is not known, so that one is missing too.
//!
//! A converter that has not taken its configuration is asked again instead of being read: all its channels are missing until it has.

use embedded_hal::spi::SpiDevice;
use link::track::{CHANNELS, SensorChannel, SensorStatus};
use link::{InputRange, SensorFrame};

use super::{Ads8688, AngleSensor, FAULTS, ProbePair, Scale, SensorFault, Transmitter};

/// Inputs of a sample: two probes, the third one, two transmitters.
const MOST_INPUTS: usize = 5;
/// Codes so near to an end of the range are at the rail.
const RAIL_CODES: u16 = 16;

/// A probe: where it is connected and what its codes mean.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// Input of the converter.
    pub input: u8,
    /// Its gap.
    pub scale: Scale,
}

/// A transmitter: where it is connected and what its codes mean.
#[derive(Clone, Copy, Debug)]
pub struct LoadInput {
    /// Input of the converter.
    pub input: u8,
    /// Its force.
    pub transmitter: Transmitter,
}

/// What is connected to the converter.
#[derive(Clone, Copy, Debug)]
pub struct Wiring {
    /// The two probes.
    pub probes: [Probe; 2],
    /// The third probe, if the geometry has one.
    pub opposite: Option<Probe>,
    /// Where the probes look.
    pub geometry: ProbePair,
    /// The transmitter whose piston pushes along +y.
    pub load: LoadInput,
    /// The transmitter of the other side, if there is one.
    pub counter_load: Option<LoadInput>,
    /// Range of the probes' inputs.
    pub probe_range: InputRange,
    /// Range of the transmitters' inputs.
    pub load_range: InputRange,
}

/// How often each fault came, by channel, saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultCounts([[u32; FAULTS.len()]; CHANNELS]);

impl FaultCounts {
    /// How often a channel had a fault.
    #[must_use]
    pub fn of(&self, channel: SensorChannel, fault: SensorFault) -> u32 {
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
pub struct Sampler<SPI, ANGLE> {
    converter: Ads8688<SPI>,
    angle: ANGLE,
    wiring: Wiring,
    /// Whether the converter has taken its configuration.
    configured: bool,
    /// Whether the next frame returns the input that it should.
    in_step: bool,
    frame: SensorFrame,
    faults: FaultCounts,
}

type Code = Result<u16, SensorFault>;

impl<SPI: SpiDevice, ANGLE: AngleSensor> Sampler<SPI, ANGLE> {
    /// Takes the devices. The first sample configures the converter unless [`Self::configure`] has.
    pub fn new(converter: Ads8688<SPI>, angle: ANGLE, wiring: Wiring) -> Self {
        let first = SensorFrame { sequence: u32::MAX, ..SensorFrame::default() };
        Self {
            converter,
            angle,
            wiring,
            configured: false,
            in_step: false,
            frame: first,
            faults: FaultCounts::default(),
        }
    }

    /// Goes on with other wiring from the next sample on, which configures the converter anew.
    pub fn rewire(&mut self, wiring: Wiring) {
        self.wiring = wiring;
        self.configured = false;
        self.in_step = false;
    }

    /// Configures the converter. May be repeated whenever it does not answer.
    ///
    /// # Errors
    ///
    /// The bus failed, or a register did not read back.
    pub fn configure(&mut self) -> Result<(), SensorFault> {
        self.configured = false;
        self.in_step = false;
        let (inputs, count) = self.inputs();
        let mut ranges = [(0, self.wiring.probe_range); MOST_INPUTS];
        for (range, (input, is_load)) in ranges.iter_mut().zip(inputs) {
            *range = (input, if is_load { self.wiring.load_range } else { self.wiring.probe_range });
        }
        self.converter.configure(ranges.get(..count).unwrap_or_default())?;
        self.configured = true;
        self.in_step = true;
        Ok(())
    }

    /// Samples everything once; `time_us` is the controller's time of the sample.
    pub fn sample(&mut self, time_us: u32) -> (SensorFrame, SensorStatus) {
        let mut status = SensorStatus::GOOD;
        let codes = if self.configured {
            self.codes()
        } else {
            [Err(self.configure().err().unwrap_or(SensorFault::NotConfigured)); MOST_INPUTS]
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
        match self.angle.angle_nrad() {
            Ok(angle) => self.frame.shaft_angle_nrad = angle,
            Err(fault) => self.fault(SensorChannel::ShaftAngle, fault, &mut status),
        }
        match self.load_mn(&codes) {
            Ok(load_mn) => self.frame.load_force_mn = load_mn,
            Err(fault) => self.fault(SensorChannel::LoadForce, fault, &mut status),
        }
        self.frame.sequence = self.frame.sequence.wrapping_add(1);
        self.frame.time_us = time_us;
        (self.frame, status)
    }

    /// The last sample.
    #[must_use]
    pub const fn latest(&self) -> SensorFrame {
        self.frame
    }

    /// The faults so far.
    #[must_use]
    pub const fn faults(&self) -> &FaultCounts {
        &self.faults
    }

    /// Gives the devices back.
    pub fn release(self) -> (SPI, ANGLE) {
        (self.converter.release(), self.angle)
    }

    fn fault(&mut self, channel: SensorChannel, fault: SensorFault, status: &mut SensorStatus) {
        self.faults.add(channel, fault);
        *status =
            if fault == SensorFault::AtRail { status.at_rail(channel) } else { status.missing(channel) };
    }

    /// The inputs in their ring, whether each is a transmitter's, and how many there are.
    fn inputs(&self) -> ([(u8, bool); MOST_INPUTS], usize) {
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
        let mut ring = [(0, false); MOST_INPUTS];
        let mut count = 0;
        for (place, input) in ring.iter_mut().zip(connected.into_iter().flatten()) {
            *place = input;
            count += 1;
        }
        (ring, count)
    }

    /// A code of every input, in the order of the ring.
    fn codes(&mut self) -> [Code; MOST_INPUTS] {
        let (ring, count) = self.inputs();
        let mut codes = [Err(SensorFault::NoAnswer); MOST_INPUTS];
        let connected = ring.iter().take(count);
        let next = connected.clone().skip(1).chain(connected.take(1));
        for (code, (next, _)) in codes.iter_mut().zip(next) {
            let found = self.converter.select(*next);
            *code = if self.in_step { found } else { found.and(Err(SensorFault::NoAnswer)) };
            self.in_step = found.is_ok();
        }
        codes
    }

    /// The journal's centre, and whether a probe stands at its rail.
    fn journal(&self, codes: &[Code; MOST_INPUTS]) -> Result<([i32; 2], bool), SensorFault> {
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

    fn load_mn(&self, codes: &[Code; MOST_INPUTS]) -> Result<i32, SensorFault> {
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
