//! The board's indicator light on the pin that the table of boards names; none for the image that
//! serves every board.

use controller::boards::Light as Wiring;

use super::Pin;

/// The light, if the board has one.
pub struct Light(Option<(Pin, Wiring)>);

impl Light {
    /// Makes the pin an output and switches the light off.
    pub(in crate::boards) fn start(wiring: Option<Wiring>) -> Self {
        let start = |wiring: Wiring| (Pin::output(wiring.port, wiring.pin, wiring.is_active_low), wiring);
        Self(wiring.map(start))
    }

    /// Switches the light on or off.
    pub fn show(&mut self, on: bool) {
        if let Some((pin, wiring)) = &mut self.0 {
            pin.set(on != wiring.is_active_low);
        }
    }
}
