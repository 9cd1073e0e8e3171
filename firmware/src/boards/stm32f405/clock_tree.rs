//! Reset and clock controller for [`ClockPort`]. Sources: RM0090 sections 3.5 (flash), 6 and 7
//! (RCC).

use link::ClockSource;
use stm32f4xx_hal::pac::{FLASH, RCC};

use controller::clock::{ClockPort, INTERNAL_HZ, PLL_HZ, PllInput};

/// Dividers of the PLL. Its input after the first divider must be 1 to 2 MHz; 2 MHz has the least
/// jitter. 25 MHz can only be divided to 1 MHz.
const fn dividers(input: PllInput) -> (u8, u16) {
    match input {
        PllInput::Internal => (8, 168),
        PllInput::Crystal { mhz: 25 } => (25, 336),
        PllInput::Crystal { mhz } => (mhz / 2, 168),
    }
}

/// The registers.
pub(in crate::boards) struct ClockTree<'a> {
    pub(in crate::boards) rcc: &'a RCC,
    pub(in crate::boards) flash: &'a FLASH,
}

impl ClockPort for ClockTree<'_> {
    const INTERNAL_HZ: u32 = INTERNAL_HZ;

    fn prepare_pll(&mut self) -> Option<u32> {
        // The voltage after a reset suffices.
        Some(PLL_HZ)
    }

    fn start_crystal(&mut self) {
        self.rcc.cr().modify(|_, w| w.hseon().set_bit());
    }

    fn crystal_ready(&self) -> bool {
        self.rcc.cr().read().hserdy().bit_is_set()
    }

    fn start_pll(&mut self, input: PllInput) {
        let (m, n) = dividers(input);
        self.rcc.pllcfgr().modify(|_, w| {
            #[expect(unsafe_code, reason = "raw divider fields; `dividers` keeps to the manual's ranges")]
            let w = unsafe { w.pllm().bits(m).plln().bits(n) };
            w.pllp().div2().pllsrc().bit(matches!(input, PllInput::Crystal { .. }))
        });
        self.rcc.cr().modify(|_, w| w.pllon().set_bit());
    }

    fn pll_ready(&self) -> bool {
        self.rcc.cr().read().pllrdy().bit_is_set()
    }

    fn stop_pll(&mut self) {
        self.rcc.cr().modify(|_, w| w.pllon().clear_bit());
    }

    fn select(&mut self, source: ClockSource) {
        let fast = matches!(source, ClockSource::PllCrystal | ClockSource::PllInternal);
        if fast {
            // Five wait states for 168 MHz at 3.3 V; buses at 42 and 84 MHz. They must be set
            // before the switch.
            self.flash
                .acr()
                .modify(|_, w| w.latency().ws5().prften().set_bit().icen().set_bit().dcen().set_bit());
            self.rcc.cfgr().modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2());
        }
        self.rcc.cfgr().modify(|_, w| match source {
            ClockSource::PllCrystal | ClockSource::PllInternal => w.sw().pll(),
            ClockSource::Crystal => w.sw().hse(),
            ClockSource::Internal | ClockSource::Host => w.sw().hsi(),
        });
    }

    fn selected(&self, source: ClockSource) -> bool {
        let status = self.rcc.cfgr().read().sws();
        match source {
            ClockSource::PllCrystal | ClockSource::PllInternal => status.is_pll(),
            ClockSource::Crystal => status.is_hse(),
            ClockSource::Internal | ClockSource::Host => status.is_hsi(),
        }
    }
}
