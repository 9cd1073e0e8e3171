//! Impacts of the journal, found in the estimates sample by sample.
//!
//! An impact is a contact that begins after a separation and whose force exceeds
//! [`SIGNIFICANT_SDS`] of the standard deviations that the estimate reports. Contact is a
//! deformation above 0. The record of an impact ends
//!
//! * with the separation,
//! * after [`SETTLED_US`] in contact: the impact has become sustained contact, whose later forces
//!   are in the blocks ([`block`]),
//! * with an estimate that is not trusted (held, tripped or unknown), or with the run.
//!
//! Contact after the last two cases is no impact before the journal has been seen to separate.
//!
//! Between two samples the deformation is taken as linear for onset and end. The peak is the vertex
//! of the parabola through the largest sample and its neighbours. The work of the normal force is
//! the area that force and deformation enclose, by the trapezoidal rule. The approach speed is that
//! of the last sample before the onset, the speed of separation that of the first one after the
//! end.
//!
//! Limits: an impact shorter than a sample period is found only if a sample lies in it. Two
//! contacts without a free sample between them are one impact.
//!
//! The state is checked before it is used ([`crate::integrity`]). A corrupted state starts anew,
//! and an impact that was open is counted as lost.

mod block;
mod queue;

pub(crate) use block::Block;
pub(crate) use queue::{LENGTH as MAX_WAITING, Queue};

use inference::Flags;
use link::{EstimateFrame, ImpactEnd, ImpactRecord};

use crate::flags::{HELD, IMPLAUSIBLE_POSITION, NOT_STARTED, TIME_FAULT, TRIPPED};
use crate::integrity::{Checksum, Guarded, Words, words};

/// Number of standard deviations that the peak of an impact exceeds.
const SIGNIFICANT_SDS: f32 = 3.0;
/// Time in contact after which an impact has become sustained contact, us.
pub const SETTLED_US: u32 = 50_000;

/// Flags of estimates that do not show the contact of their sample.
const UNTRUSTED: Flags = Flags::from_bits(
    HELD.bits() | TRIPPED.bits() | NOT_STARTED.bits() | TIME_FAULT.bits() | IMPLAUSIBLE_POSITION.bits(),
);

/// Phase between impacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// No separation has been seen: a contact would not be an impact.
    #[default]
    Waiting,
    /// The journal is free.
    Free,
    /// The journal is in contact after a separation.
    Contact,
}

impl Words for Phase {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        sum.add_word(*self as u32);
    }
}

/// The part of an estimate that the next sample needs.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    time_us: u32,
    force_n: f32,
    deformation_m: f32,
    rate_m_s: f32,
}
words!(Sample { time_us, force_n, deformation_m, rate_m_s });

/// The open contact.
#[derive(Clone, Copy, Debug, Default)]
struct Contact {
    onset_sequence: u32,
    onset_us: u32,
    approach_speed_m_s: f32,
    /// Largest sample, then the vertex through its neighbours, N.
    peak_force_n: f32,
    peak_sd_n: f32,
    peak_us: u32,
    /// Force of the sample before the largest one, N.
    before_peak_n: f32,
    work_j: f32,
    flags: u32,
    /// True if the last sample was the largest so far.
    is_rising: bool,
}
words!(Contact {
    onset_sequence,
    onset_us,
    approach_speed_m_s,
    peak_force_n,
    peak_sd_n,
    peak_us,
    before_peak_n,
    work_j,
    flags,
    is_rising,
});

/// Knowledge from earlier estimates.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    phase: Phase,
    last: Sample,
    contact: Contact,
}
words!(State { phase, last, contact });

/// Finds impacts in the estimates of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImpactTracker {
    state: Guarded<State>,
}

/// Event of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Found {
    /// An impact whose record ends with this estimate; its number is 0.
    Impact(ImpactRecord),
    /// The state was corrupted: an open impact is lost.
    Corruption,
}

impl ImpactTracker {
    /// Takes an estimate with the rate of its deformation in m/s.
    #[inline(never)]
    pub(crate) fn step(&mut self, estimate: &EstimateFrame, rate_m_s: f32) -> Option<Found> {
        let is_corrupted = self.state.is_corrupted();
        let state = self.state.value_mut();
        if is_corrupted {
            *state = State::default();
        }
        let sample = Sample {
            time_us: estimate.time_us,
            // Also for a force that is not a number.
            force_n: estimate.normal_force_n.max(0.0),
            deformation_m: estimate.deformation_m,
            rate_m_s,
        };
        let is_trusted = !Flags::from_bits(estimate.flags).intersects(UNTRUSTED);
        let is_contact = sample.deformation_m > 0.0;
        let record = match (state.phase, is_trusted, is_contact) {
            (Phase::Contact, true, true) => state.follow(&sample, estimate),
            (Phase::Contact, true, false) => state.separate(&sample),
            (Phase::Contact, false, _) => state.interrupt(estimate.flags),
            (Phase::Free, true, true) => {
                state.begin(&sample, estimate);
                None
            }
            (_, true, false) => {
                state.phase = Phase::Free;
                None
            }
            (_, false, _) => {
                state.phase = Phase::Waiting;
                None
            }
            (Phase::Waiting, true, true) => None,
        };
        state.last = sample;
        self.state.seal(false);
        if is_corrupted { Some(Found::Corruption) } else { record.map(Found::Impact) }
    }

    /// Ends an open impact with its run.
    pub(crate) fn finish(&mut self) -> Option<Found> {
        let is_corrupted = self.state.is_corrupted();
        let state = self.state.value_mut();
        let is_open = state.phase == Phase::Contact;
        let record = if is_open & !is_corrupted { state.interrupt(0) } else { None };
        self.state = Guarded::default();
        if is_corrupted { Some(Found::Corruption) } else { record.map(Found::Impact) }
    }
}

impl State {
    /// Opens a contact at the first sample in it.
    #[inline]
    fn begin(&mut self, sample: &Sample, estimate: &EstimateFrame) {
        let last = &self.last;
        self.contact = Contact {
            onset_sequence: estimate.sequence,
            onset_us: crossing_us(last, sample),
            approach_speed_m_s: last.rate_m_s.max(0.0),
            peak_force_n: sample.force_n,
            peak_sd_n: estimate.normal_force_sd_n,
            peak_us: sample.time_us,
            before_peak_n: 0.0,
            work_j: 0.5 * sample.force_n * sample.deformation_m,
            flags: estimate.flags,
            is_rising: true,
        };
        self.phase = Phase::Contact;
    }

    /// Continues the contact; a contact that has settled ends.
    #[inline]
    fn follow(&mut self, sample: &Sample, estimate: &EstimateFrame) -> Option<ImpactRecord> {
        self.refine_peak(sample);
        let (last, contact) = (&self.last, &mut self.contact);
        contact.flags |= estimate.flags;
        contact.work_j += 0.5 * (sample.force_n + last.force_n) * (sample.deformation_m - last.deformation_m);
        contact.is_rising = sample.force_n > contact.peak_force_n;
        if contact.is_rising {
            contact.before_peak_n = last.force_n;
            contact.peak_force_n = sample.force_n;
            contact.peak_sd_n = estimate.normal_force_sd_n;
            contact.peak_us = sample.time_us;
        }
        if sample.time_us.wrapping_sub(contact.onset_us) < SETTLED_US {
            return None;
        }
        self.phase = Phase::Waiting;
        self.record(sample.time_us, 0.0, ImpactEnd::Settled)
    }

    /// Ends the contact at the first free sample after it.
    #[inline]
    fn separate(&mut self, sample: &Sample) -> Option<ImpactRecord> {
        self.refine_peak(sample);
        let last = &self.last;
        self.contact.work_j -= 0.5 * last.force_n * last.deformation_m;
        self.phase = Phase::Free;
        self.record(crossing_us(last, sample), (-sample.rate_m_s).max(0.0), ImpactEnd::Separation)
    }

    /// Ends the contact at its last trusted sample. The flags of the estimate that is not trusted
    /// show why.
    #[inline]
    fn interrupt(&mut self, flags: u32) -> Option<ImpactRecord> {
        self.contact.flags |= flags;
        self.phase = Phase::Waiting;
        self.record(self.last.time_us, 0.0, ImpactEnd::Interrupted)
    }

    /// Replaces the largest sample by the vertex of the parabola through it and its neighbours, if
    /// the last sample was the largest.
    #[inline]
    fn refine_peak(&mut self, sample: &Sample) {
        let (last, contact) = (&self.last, &mut self.contact);
        let (before, after) = (contact.before_peak_n, sample.force_n);
        let curvature = 2.0 * last.force_n - before - after;
        if !(contact.is_rising & (after <= last.force_n) & (curvature > 0.0)) {
            return;
        }
        let slope = after - before;
        // At most half a sample period, because the middle force is the largest.
        let offset = 0.5 * slope / curvature;
        let period_us = sample.time_us.wrapping_sub(last.time_us) as f32;
        contact.peak_force_n = last.force_n + 0.25 * slope * offset;
        contact.peak_us = contact.peak_us.wrapping_add_signed((offset * period_us) as i32);
    }

    /// Forms the record of an impact; `None` if its force is not significant.
    #[inline]
    fn record(&self, end_us: u32, separation_speed_m_s: f32, end: ImpactEnd) -> Option<ImpactRecord> {
        let contact = &self.contact;
        // An infinite deviation hides every force.
        let is_significant = contact.peak_force_n > SIGNIFICANT_SDS * contact.peak_sd_n;
        is_significant.then(|| ImpactRecord {
            number: 0,
            onset_sequence: contact.onset_sequence,
            onset_us: contact.onset_us,
            peak_us: contact.peak_us,
            duration_us: end_us.wrapping_sub(contact.onset_us),
            peak_force_n: contact.peak_force_n,
            peak_force_sd_n: contact.peak_sd_n,
            approach_speed_m_s: contact.approach_speed_m_s,
            separation_speed_m_s,
            energy_lost_j: contact.work_j,
            flags: contact.flags,
            end,
        })
    }
}

/// Returns the time at which the deformation changes its sign between two samples, us.
#[inline]
fn crossing_us(last: &Sample, sample: &Sample) -> u32 {
    let passed_us = sample.time_us.wrapping_sub(last.time_us);
    let change_m = sample.deformation_m - last.deformation_m;
    let share = if change_m == 0.0 { 0.0 } else { (sample.deformation_m / change_m).clamp(0.0, 1.0) };
    sample.time_us.wrapping_sub((share * passed_us as f32) as u32)
}

#[cfg(test)]
mod tests;
