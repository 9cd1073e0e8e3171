//! The contacts of a plant during a run: their phase, the search for the next event, and the
//! impacts.
//!
//! Events are onset and separation, and with a friction law that sticks the beginning and the end
//! of sticking and sliding. An onset or the end of a slip lets the plant choose the slip that
//! follows.

use super::measure::Span;
use super::{
    CHATTER_CONTACTS, ContactPhase, ContactReading, Impact, Integration, IntegrationError, Pause,
    SlicedPlant, Slip, Touch,
};
use differential_equations::prelude::ODE;
use std::collections::VecDeque;

/// Parts of a step at whose ends a grazing contact is noticed.
const PROBES: usize = 4;
/// Bisections of an event's bracket: more than a double has binary digits.
const BISECTIONS: usize = 60;

/// Time and state at which a contact or its slip begins or ends.
pub(super) type Event<const N: usize> = (f64, [f64; N]);

/// Contacts at the start of a span.
#[derive(Clone, Copy)]
pub(super) enum Start<'a> {
    /// Start of a run: true for each contact that touches, with the latched speed 0.
    InContact(&'a [bool]),
    /// Continuation.
    Resumed(&'a Pause),
}

impl Start<'_> {
    /// First step in s to try in a span.
    pub(super) fn first_step_s(&self, span_s: f64, largest_step_s: f64) -> f64 {
        match self {
            // The last step may have been cut to a rest of rounding.
            Self::Resumed(pause) if pause.step_s > 0.0 => pause.step_s.clamp(span_s * 1e-3, span_s),
            _ => span_s.min(largest_step_s) * 1e-3,
        }
    }
}

/// A contact in which a run starts.
fn in_contact<P: SlicedPlant<N>, const N: usize>(
    plant: &P,
    slice: usize,
    start_s: f64,
    initial: &mut [f64; N],
) -> ContactPhase {
    let slip = plant.next_slice_slip(slice, start_s, initial, Touch::default());
    let impact = Impact {
        contact: slice,
        onset_s: start_s,
        peak_s: start_s,
        sticks: usize::from(slip.is_sticking()),
        angles: plant.slice_angles(slice, start_s, initial),
        ..Impact::default()
    };
    ContactPhase { latched_m_s: Some(0.0), slip, impact: Some(impact) }
}

/// The plant between two events: each contact touches, with a latched speed, or has a gap.
pub(super) struct Phase<'a, P> {
    plant: &'a P,
    /// Latched approach speed of each contact in m/s, `None` in a gap.
    pub(super) latched_m_s: Vec<Option<f64>>,
    /// Slip of each contact.
    slips: Vec<Slip>,
}

impl<P> Phase<'_, P> {
    /// A contact; latched speed 0 in a gap.
    pub(super) fn touch(&self, slice: usize) -> Touch {
        Touch {
            latched_m_s: self.latched_m_s.get(slice).copied().flatten().unwrap_or_default(),
            slip: self.slips.get(slice).copied().unwrap_or_default(),
        }
    }

    /// Returns whether the slip of a contact has ended at a state.
    fn has_slip_ended<const N: usize>(&self, slice: usize, time_s: f64, state: &[f64; N]) -> bool
    where
        P: SlicedPlant<N>,
    {
        let touch = self.touch(slice);
        touch.slip != Slip::Smooth && self.plant.has_slice_slip_ended(slice, time_s, state, touch)
    }
}

impl<P: SlicedPlant<N>, const N: usize> ODE<f64, [f64; N]> for Phase<'_, P> {
    fn diff(&self, time_s: f64, state: &[f64; N], derivative: &mut [f64; N]) {
        self.plant.slipping_derivative(time_s, state, (&self.latched_m_s, &self.slips), derivative);
    }
}

/// One contact during a run.
#[derive(Default)]
struct Contact {
    is_touching: bool,
    /// True if the surface may be reached within the step.
    is_near: bool,
    /// Index of the open impact.
    impact: usize,
    /// Reading at the start of the step.
    before: ContactReading,
    /// Reading at the end of the step.
    after: ContactReading,
    /// Times of the last onsets in s.
    onsets_s: VecDeque<f64>,
    /// Times of the last changes of the slip in s.
    slips_s: VecDeque<f64>,
}

/// Records an event and returns the duration in s of [`CHATTER_CONTACTS`] events that follow each
/// other too fast.
fn record_event(events_s: &mut VecDeque<f64>, time_s: f64, window_s: f64) -> Option<f64> {
    events_s.push_back(time_s);
    if events_s.len() <= CHATTER_CONTACTS {
        return None;
    }
    events_s.pop_front().map(|first_s| time_s - first_s).filter(|duration_s| *duration_s < window_s)
}

/// All contacts of a plant during a run.
pub(super) struct Contacts<'a, P> {
    pub(super) phase: Phase<'a, P>,
    contacts: Vec<Contact>,
    /// Impacts so far, in the order of their onsets.
    pub(super) impacts: Vec<Impact>,
}

impl<'a, P> Contacts<'a, P> {
    /// Contacts at the start of a span, not yet read.
    pub(super) fn new<const N: usize>(
        plant: &'a P,
        start_s: f64,
        initial: &mut [f64; N],
        start: Start<'_>,
    ) -> Self
    where
        P: SlicedPlant<N>,
    {
        let count = plant.slices();
        let phase = Phase { plant, latched_m_s: Vec::with_capacity(count), slips: Vec::with_capacity(count) };
        let mut contacts = Self { phase, contacts: Vec::with_capacity(count), impacts: Vec::new() };
        for slice in 0..count {
            let ContactPhase { latched_m_s, slip, impact } = match start {
                Start::Resumed(pause) => pause.contacts.get(slice).copied().unwrap_or_default(),
                Start::InContact(flags) if flags.get(slice).copied().unwrap_or(false) => {
                    in_contact(plant, slice, start_s, initial)
                }
                Start::InContact(_) => ContactPhase::default(),
            };
            contacts.phase.latched_m_s.push(latched_m_s);
            contacts.phase.slips.push(slip);
            contacts.impacts.extend(impact);
            contacts.contacts.push(Contact {
                is_touching: latched_m_s.is_some(),
                impact: contacts.impacts.len().saturating_sub(1),
                ..Contact::default()
            });
        }
        contacts
    }

    /// Result of an integration that ends here.
    pub(super) fn end<const N: usize>(self, state: [f64; N], steps: usize, step_s: f64) -> Integration<N> {
        let phases = self.contacts.iter().zip(&self.phase.latched_m_s).zip(&self.phase.slips);
        let contacts = phases.map(|((contact, latched_m_s), slip)| ContactPhase {
            latched_m_s: *latched_m_s,
            slip: *slip,
            impact: self.impacts.get(contact.impact).copied().filter(|_| contact.is_touching),
        });
        Integration {
            state,
            steps,
            pause: Pause { contacts: contacts.collect(), step_s },
            impacts: self.impacts,
        }
    }

    /// Reads every contact at the end of a step and returns whether any may have changed within it.
    /// A contact whose surface cannot be reached within the step needs no search.
    pub(super) fn read_end<const N: usize>(&mut self, (from, to): (f64, f64), end: &[f64; N]) -> bool
    where
        P: SlicedPlant<N>,
    {
        let mut is_near = false;
        for slice in 0..self.contacts.len() {
            let reading = self.phase.plant.slice_contact(slice, to, end, self.phase.touch(slice).latched_m_s);
            let can_stick = self.phase.touch(slice).slip != Slip::Smooth;
            let Some(contact) = self.contacts.get_mut(slice) else { continue };
            let reach = (to - from) * (contact.before.rate_m_s.abs() + reading.rate_m_s.abs());
            contact.is_near = can_stick
                || (reading.depth_m > 0.0) != contact.is_touching
                || reading.depth_m.abs().min(contact.before.depth_m.abs()) <= reach;
            is_near |= contact.is_near;
            contact.after = reading;
        }
        is_near
    }

    /// Returns whether any near contact touches where it had a gap, or the reverse, or the slip of
    /// one has ended.
    fn has_changed<const N: usize>(&self, time_s: f64, state: &[f64; N]) -> bool
    where
        P: SlicedPlant<N>,
    {
        let plant = self.phase.plant;
        self.contacts.iter().enumerate().filter(|(_, c)| c.is_near).any(|(slice, c)| {
            (plant.slice_deformation(slice, time_s, state).0 > 0.0) != c.is_touching
                || self.phase.has_slip_ended(slice, time_s, state)
        })
    }

    /// The first event within a step, if there is one. The first probe on the other side of a
    /// surface brackets it.
    pub(super) fn locate_event<const N: usize>(
        &self,
        (from, to): (f64, f64),
        state_at: &mut impl FnMut(f64) -> Result<[f64; N], IntegrationError>,
    ) -> Result<Option<Event<N>>, IntegrationError>
    where
        P: SlicedPlant<N>,
    {
        let mut low = from;
        for i in 1..=PROBES {
            let t = if i == PROBES { to } else { from + (to - from) * i as f64 / PROBES as f64 };
            if self.has_changed(t, &state_at(t)?) {
                let high = self.bisect((low, t), state_at)?;
                return Ok(Some((high, state_at(high)?)));
            }
            low = t;
        }
        Ok(None)
    }

    /// The earliest time after the event in a bracket that holds it.
    fn bisect<const N: usize>(
        &self,
        (mut low, mut high): (f64, f64),
        state_at: &mut impl FnMut(f64) -> Result<[f64; N], IntegrationError>,
    ) -> Result<f64, IntegrationError>
    where
        P: SlicedPlant<N>,
    {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.has_changed(middle, &state_at(middle)?) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(high)
    }

    /// Adds the span of a step up to its end or its event to the open impacts.
    pub(super) fn measure<const N: usize>(
        &mut self,
        (from, to): (f64, f64),
        event: Option<&Event<N>>,
        state_at: &mut impl FnMut(f64) -> Result<[f64; N], IntegrationError>,
    ) -> Result<(), IntegrationError>
    where
        P: SlicedPlant<N>,
    {
        let plant = self.phase.plant;
        for (slice, contact) in self.contacts.iter().enumerate().filter(|(_, c)| c.is_touching) {
            let Touch { latched_m_s, slip } = self.phase.touch(slice);
            let end = match event {
                Some((t, state)) => plant.slice_contact(slice, *t, state, latched_m_s),
                None => contact.after,
            };
            if let Some(impact) = self.impacts.get_mut(contact.impact) {
                let span = Span { from, to, start: contact.before, end };
                let mut read = |t: f64| state_at(t).map(|s| plant.slice_contact(slice, t, &s, latched_m_s));
                span.measure(&mut read, impact)?;
                impact.stuck_s += if slip.is_sticking() { to - from } else { 0.0 };
            }
        }
        Ok(())
    }

    /// Reads every contact at the start of a run, and again after its force has changed by itself.
    pub(super) fn read_start<const N: usize>(&mut self, time_s: f64, state: &[f64; N])
    where
        P: SlicedPlant<N>,
    {
        for (slice, contact) in self.contacts.iter_mut().enumerate() {
            let latched_m_s = self.phase.touch(slice).latched_m_s;
            contact.before = self.phase.plant.slice_contact(slice, time_s, state, latched_m_s);
        }
    }

    /// Completes a step without an event.
    pub(super) fn complete_step(&mut self) {
        for contact in &mut self.contacts {
            contact.before = contact.after;
        }
    }

    /// Changes the phase of every contact that begins or ends at an event: opens or closes its
    /// impact and its latch, and chooses its slip.
    pub(super) fn switch<const N: usize>(
        &mut self,
        time_s: f64,
        state: &mut [f64; N],
        chatter_window_s: f64,
    ) -> Result<(), IntegrationError>
    where
        P: SlicedPlant<N>,
    {
        let plant = self.phase.plant;
        for slice in 0..self.contacts.len() {
            let has_slip_ended = self.phase.has_slip_ended(slice, time_s, state);
            let (depth, rate) = plant.slice_deformation(slice, time_s, state);
            let Some(contact) = self.contacts.get_mut(slice) else { continue };
            let Some(latched) = self.phase.latched_m_s.get_mut(slice) else { continue };
            let Some(slip) = self.phase.slips.get_mut(slice) else { continue };
            let has_turned = (depth > 0.0) != contact.is_touching;
            if has_turned {
                contact.is_touching = !contact.is_touching;
                *latched = contact.is_touching.then_some(rate.max(0.0));
                *slip = Slip::Smooth;
                if let Some(speed) = *latched {
                    contact.impact = self.impacts.len();
                    self.impacts.push(Impact {
                        contact: slice,
                        onset_s: time_s,
                        peak_s: time_s,
                        angles: plant.slice_angles(slice, time_s, state),
                        approach_speed_m_s: speed,
                        ..Impact::default()
                    });
                } else if let Some(impact) = self.impacts.get_mut(contact.impact) {
                    impact.separation_s = Some(time_s);
                    impact.separation_speed_m_s = -rate;
                }
            }
            if let Some(latched_m_s) = latched.filter(|_| has_turned || has_slip_ended) {
                *slip = plant.next_slice_slip(slice, time_s, state, Touch { latched_m_s, slip: *slip });
                if let Some(impact) = self.impacts.get_mut(contact.impact) {
                    impact.sticks += usize::from(slip.is_sticking());
                }
                let events_s = if has_turned { &mut contact.onsets_s } else { &mut contact.slips_s };
                if let Some(window_s) = record_event(events_s, time_s, chatter_window_s) {
                    return Err(IntegrationError::chattering(slice, has_turned, window_s, time_s));
                }
            }
            contact.before = plant.slice_contact(slice, time_s, state, latched.unwrap_or_default());
        }
        Ok(())
    }
}
