//! Clock bring-up: order of the sources, and the limit of each wait.
//!
//! PLL on the crystal -> PLL on the internal oscillator -> crystal alone -> internal oscillator.
//! Every wait is a limited number of polls. A board with a dead crystal, or an emulator without
//! ready flags, starts all the same and reports its source in the hello frame. The registers are
//! accessed through [`ClockPort`], so the decisions are tested on the host.
//!
//! A clock signal from outside, such as that of a debugger on the board, counts as a crystal.
//!
//! Boards with an STM32F405 carry crystals of 8, 12 or 25 MHz, and one image serves them all. By
//! default no crystal is assumed, and the PLL runs on the internal oscillator: 168 MHz with 1 %
//! tolerance. Samples from the link carry their own time and tolerate that.

use link::ClockSource;

/// Core frequency of the STM32F405 with the PLL, Hz.
pub const PLL_HZ: u32 = 168_000_000;
/// Internal oscillator of the STM32F405, Hz.
pub const INTERNAL_HZ: u32 = 16_000_000;
/// Maximum number of polls of a flag: about 25 ms at 16 MHz and 6 ms at 64 MHz. A crystal may take
/// 2.5 ms.
pub const POLLS: u32 = 50_000;

/// Input of the PLL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PllInput {
    /// Crystal.
    Crystal {
        /// Frequency, MHz.
        mhz: u8,
    },
    /// Internal oscillator.
    Internal,
}

/// Registers of the clock tree.
pub trait ClockPort {
    /// Internal oscillator, Hz.
    const INTERNAL_HZ: u32;
    /// Prepares the supply voltage for the PLL. Returns the core frequency with it, Hz; `None` if
    /// the voltage does not suffice.
    fn prepare_pll(&mut self) -> Option<u32>;
    /// Switches the crystal oscillator on.
    fn start_crystal(&mut self);
    /// Returns `true` if the crystal oscillator runs.
    fn crystal_ready(&self) -> bool;
    /// Programs and starts the PLL for the frequency of [`ClockPort::prepare_pll`].
    fn start_pll(&mut self, input: PllInput);
    /// Returns `true` if the PLL has locked.
    fn pll_ready(&self) -> bool;
    /// Stops the PLL so that it can be programmed again.
    fn stop_pll(&mut self);
    /// Sets flash wait states and bus dividers for a source, and switches the core to it.
    fn select(&mut self, source: ClockSource);
    /// Returns `true` if the core runs on the source selected last.
    fn selected(&self, source: ClockSource) -> bool;
}

/// Result of the bring-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clocks {
    /// Clock source.
    pub source: ClockSource,
    /// Core frequency, Hz.
    pub core_hz: u32,
}

/// Starts the best available clock. `crystal_mhz` is the board's crystal, if known.
pub fn bring_up<P: ClockPort>(port: &mut P, crystal_mhz: Option<u8>) -> Clocks {
    let pll_hz = port.prepare_pll();
    let crystal = crystal_mhz.filter(|_| {
        port.start_crystal();
        within_polls(|| port.crystal_ready())
    });
    let inputs = [
        crystal.map(|mhz| (PllInput::Crystal { mhz }, ClockSource::PllCrystal)),
        Some((PllInput::Internal, ClockSource::PllInternal)),
    ];
    for (input, source) in inputs.into_iter().flatten() {
        let Some(core_hz) = pll_hz else { break };
        port.start_pll(input);
        if within_polls(|| port.pll_ready()) && switch(port, source) {
            return Clocks { source, core_hz };
        }
        port.select(ClockSource::Internal);
        port.stop_pll();
    }
    if let Some(mhz) = crystal
        && switch(port, ClockSource::Crystal)
    {
        return Clocks { source: ClockSource::Crystal, core_hz: u32::from(mhz).saturating_mul(1_000_000) };
    }
    port.select(ClockSource::Internal);
    Clocks { source: ClockSource::Internal, core_hz: P::INTERNAL_HZ }
}

fn switch(port: &mut impl ClockPort, source: ClockSource) -> bool {
    port.select(source);
    within_polls(|| port.selected(source))
}

/// Polls a flag until it is set or [`POLLS`] are over. Returns whether it was set.
pub fn within_polls(mut ready: impl FnMut() -> bool) -> bool {
    (0..POLLS).any(|_| ready())
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::Cell;

    /// Clock tree with some dead parts.
    #[derive(Default)]
    struct Fake {
        crystal: bool,
        pll_on_crystal: bool,
        pll_on_internal: bool,
        switch_dead: bool,
        low_voltage: bool,
        input: Option<PllInput>,
        chosen: Option<ClockSource>,
        polls: Cell<u32>,
    }

    impl Fake {
        fn polled(&self, answer: bool) -> bool {
            self.polls.set(self.polls.get() + 1);
            answer
        }
    }

    impl ClockPort for Fake {
        const INTERNAL_HZ: u32 = INTERNAL_HZ;

        fn prepare_pll(&mut self) -> Option<u32> {
            (!self.low_voltage).then_some(PLL_HZ)
        }

        fn start_crystal(&mut self) {}

        fn crystal_ready(&self) -> bool {
            self.polled(self.crystal)
        }

        fn start_pll(&mut self, input: PllInput) {
            assert!(!self.low_voltage);
            assert_eq!(self.input, None, "the PLL must be stopped before it is programmed");
            self.input = Some(input);
        }

        fn pll_ready(&self) -> bool {
            self.polled(match self.input {
                Some(PllInput::Crystal { .. }) => self.pll_on_crystal,
                Some(PllInput::Internal) => self.pll_on_internal,
                None => false,
            })
        }

        fn stop_pll(&mut self) {
            assert_eq!(
                self.chosen,
                Some(ClockSource::Internal),
                "the core must not run on the PLL that is stopped"
            );
            self.input = None;
        }

        fn select(&mut self, source: ClockSource) {
            self.chosen = Some(source);
        }

        fn selected(&self, source: ClockSource) -> bool {
            self.polled(!self.switch_dead && self.chosen == Some(source))
        }
    }

    #[test]
    fn each_dead_part_falls_back_to_the_next() {
        let all = || Fake { crystal: true, pll_on_crystal: true, pll_on_internal: true, ..Fake::default() };
        let cases = [
            (all(), Some(12), ClockSource::PllCrystal, PLL_HZ),
            (all(), None, ClockSource::PllInternal, PLL_HZ),
            (Fake { crystal: false, ..all() }, Some(12), ClockSource::PllInternal, PLL_HZ),
            (Fake { pll_on_crystal: false, ..all() }, Some(12), ClockSource::PllInternal, PLL_HZ),
            (Fake { crystal: true, ..Fake::default() }, Some(12), ClockSource::Crystal, 12_000_000),
            (Fake::default(), Some(8), ClockSource::Internal, INTERNAL_HZ),
            (Fake { switch_dead: true, ..all() }, Some(8), ClockSource::Internal, INTERNAL_HZ),
            (Fake { low_voltage: true, ..all() }, Some(8), ClockSource::Crystal, 8_000_000),
            (Fake { low_voltage: true, ..all() }, None, ClockSource::Internal, INTERNAL_HZ),
        ];
        for (index, (mut fake, crystal, source, core_hz)) in cases.into_iter().enumerate() {
            assert_eq!(bring_up(&mut fake, crystal), Clocks { source, core_hz }, "case {index}");
            assert_eq!(fake.chosen, Some(source), "case {index}");
        }
    }

    #[test]
    fn the_worst_board_costs_a_bounded_number_of_polls() {
        let mut dead = Fake::default();
        bring_up(&mut dead, Some(25));
        assert_eq!(dead.polls.get(), 2 * POLLS);
    }
}
