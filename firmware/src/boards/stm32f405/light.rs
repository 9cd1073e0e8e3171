//! The board's light, on the pin that [`crate::boards::pins`] names; none on the image that serves every board.

use stm32f4xx_hal::gpio::{ErasedPin, Output, PinState, gpioa, gpioc};

use crate::boards::BOARD;
use crate::boards::pins::{Light as Place, Port};

/// The light.
pub struct Light(Option<(Place, ErasedPin<Output>)>);

impl Light {
    /// Makes the pin an output, dark.
    pub(in crate::boards) fn start(pa10: gpioa::PA10, pc1: gpioc::PC1, pc12: gpioc::PC12) -> Self {
        let Some(place) = BOARD.light else { return Self(None) };
        let dark = if place.lit_when_low { PinState::High } else { PinState::Low };
        let pin = match (place.port, place.number) {
            (Port::A, 10) => pa10.into_push_pull_output_in_state(dark).erase(),
            (Port::C, 1) => pc1.into_push_pull_output_in_state(dark).erase(),
            (Port::C, 12) => pc12.into_push_pull_output_in_state(dark).erase(),
            _ => return Self(None),
        };
        Self(Some((place, pin)))
    }

    /// Switches it.
    pub fn show(&mut self, on: bool) {
        if let Some((place, pin)) = &mut self.0 {
            pin.set_state(if on == place.lit_when_low { PinState::Low } else { PinState::High });
        }
    }
}
