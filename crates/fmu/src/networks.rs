//! Networks of a contact with a history that can be saved and restored.

use bench::plants::transmission::{BearingForces, ContactView};
use inference::{ContactState, Flags, Model, Pair, WINDOW};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Mutex;

/// Inputs of the networks for a contact.
pub fn contact_state(view: &ContactView) -> ContactState {
    ContactState {
        radial_clearance_m: view.radial_clearance_m as f32,
        deformation_m: view.deformation_m as f32,
        deformation_rate_m_s: view.rate_m_s as f32,
        approach_speed_m_s: view.latched_m_s as f32,
        sliding_speed_m_s: view.sliding_speed_m_s as f32,
    }
}

/// Readings that determine the state of both networks: each sees a window, the second one of
/// outputs of the first.
const READINGS: usize = 2 * WINDOW - 1;

/// The last readings that the networks have seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct History(VecDeque<[f32; 5]>);

/// Networks of one contact.
#[derive(Clone, Debug)]
pub(crate) struct Networks {
    pair: Pair<'static>,
    history: History,
}

impl Networks {
    /// Networks of an image with an empty history. The error names the flaw of the image.
    pub(crate) fn new(image: &[u8]) -> Result<Self, String> {
        let model = Model::load(aligned(image)).map_err(|error| format!("image of the networks: {error}"))?;
        Ok(Self { pair: Pair::new(model), history: History::default() })
    }

    /// Forces for a contact, and the flags of the estimate.
    pub(crate) fn push(&mut self, view: &ContactView) -> (BearingForces, Flags) {
        let state = contact_state(view);
        if self.history.0.len() == READINGS {
            self.history.0.pop_front();
        }
        self.history.0.push_back([
            state.radial_clearance_m,
            state.deformation_m,
            state.deformation_rate_m_s,
            state.approach_speed_m_s,
            state.sliding_speed_m_s,
        ]);
        let found = self.pair.push(&state);
        let [normal_n, friction_n] = [found.normal_force_n(), found.friction_force_n()].map(f64::from);
        (BearingForces { normal_n, friction_n }, found.flags)
    }

    /// The history.
    pub(crate) fn history(&self) -> History {
        self.history.clone()
    }

    /// Replaces the history.
    pub(crate) fn restore(&mut self, history: &History) {
        self.pair.reset();
        for [clearance, deformation, rate, approach, sliding] in &history.0 {
            self.pair.push(&ContactState {
                radial_clearance_m: *clearance,
                deformation_m: *deformation,
                deformation_rate_m_s: *rate,
                approach_speed_m_s: *approach,
                sliding_speed_m_s: *sliding,
            });
        }
        self.history = history.clone();
    }
}

/// Bytes of an image at an address divisible by 4 that live as long as the process: one copy of
/// each image, because networks borrow theirs.
pub fn aligned(image: &[u8]) -> &'static [u8] {
    static IMAGES: Mutex<Vec<&'static [u8]>> = Mutex::new(Vec::new());
    let mut images = IMAGES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(known) = images.iter().find(|known| **known == image) {
        return known;
    }
    // An allocation of this size and one word more has an aligned place for the image.
    let padded: &'static mut [u8] = vec![0; image.len() + 4].leak();
    let offset = padded.as_ptr().align_offset(4).min(4);
    let place = &mut padded[offset..offset + image.len()];
    place.copy_from_slice(image);
    images.push(place);
    place
}
