//! Reset, clock and power controllers for [`ClockPort`]. Sources: RM0433 sections 4.3.8 (flash),
//! 6.6 (supply), 8 (RCC); data sheet DS12110 (frequencies).
//!
//! | supply | revision | core | buses | peripherals' buses |
//! |---|---|---|---|---|
//! | VOS0 | V | 480 MHz | 240 MHz | 120 MHz |
//! | VOS1 | others | 400 MHz | 200 MHz | 100 MHz |
//! | after a reset | all | 64 MHz or less | half | a quarter |
//!
//! The link's port and the sensor bus run on the internal oscillator of 64 MHz, whatever the core
//! runs on.

use link::ClockSource;
use stm32h7::stm32h743v::{FLASH, PWR, RCC, SYSCFG};

use controller::clock::{ClockPort, PllInput, within_polls};

/// Wait states of the flash at 240 MHz.
const WAIT_STATES: u8 = 4;
/// Programming delay of the flash at 240 MHz.
const PROGRAMMING_DELAY: u8 = 2;
/// Voltage scale 1.
const SCALE_1: u8 = 3;

/// The registers.
pub(super) struct ClockTree<'a> {
    pub(super) rcc: &'a RCC,
    pub(super) flash: &'a FLASH,
    pub(super) power: &'a PWR,
    pub(super) system: &'a SYSCFG,
    /// True if the microcontroller's revision allows voltage scale 0.
    pub(super) allows_scale_0: bool,
    /// True if the external clock is a signal and not a crystal.
    pub(super) is_signal: bool,
    /// Core frequency with the PLL, Hz.
    pub(super) pll_hz: u32,
}

impl ClockTree<'_> {
    /// Sets bus dividers and flash timing for 240 MHz; they are right for every lower frequency.
    /// Returns false if the flash does not confirm them.
    fn prepare_buses(&self) -> bool {
        self.rcc.d1cfgr().modify(|_, w| w.hpre().div2().d1ppre().div2());
        self.rcc.d2cfgr().modify(|_, w| w.d2ppre1().div2().d2ppre2().div2());
        self.rcc.d3cfgr().modify(|_, w| w.d3ppre().div2());
        self.flash.acr().modify(|_, w| {
            #[expect(unsafe_code, reason = "values of RM0433 table 17")]
            unsafe {
                w.latency().bits(WAIT_STATES).wrhighfreq().bits(PROGRAMMING_DELAY)
            }
        });
        within_polls(|| {
            let timing = self.flash.acr().read();
            timing.latency().bits() == WAIT_STATES && timing.wrhighfreq().bits() == PROGRAMMING_DELAY
        })
    }

    /// Raises the supply to voltage scale 1. The regulator's register can be written once after
    /// power-on; each start writes the same.
    fn raise_to_scale_1(&self) -> bool {
        self.power.cr3().modify(|_, w| w.scuen().set_bit().ldoen().set_bit().bypass().clear_bit());
        if !within_polls(|| self.power.csr1().read().actvosrdy().bit_is_set()) {
            return false;
        }
        self.power.d3cr().modify(|_, w| {
            #[expect(unsafe_code, reason = "a value of RM0433 section 6.8.6")]
            unsafe {
                w.vos().bits(SCALE_1)
            }
        });
        self.is_voltage_ready()
    }

    /// Raises the supply from scale 1 to scale 0, or leaves it at scale 1.
    fn raise_to_scale_0(&self) -> bool {
        self.rcc.apb4enr().modify(|_, w| w.syscfgen().set_bit());
        // The clock runs two of its cycles after the write.
        let _ = self.rcc.apb4enr().read().bits();
        self.system.pwrcr().modify(|_, w| w.oden().set_bit());
        // The flag below would else still be that of scale 1.
        let _ = self.system.pwrcr().read().bits();
        let is_ready = self.is_voltage_ready();
        if !is_ready {
            self.system.pwrcr().modify(|_, w| w.oden().clear_bit());
        }
        is_ready
    }

    fn is_voltage_ready(&self) -> bool {
        within_polls(|| self.power.d3cr().read().vosrdy().bit_is_set())
    }
}

impl ClockPort for ClockTree<'_> {
    const INTERNAL_HZ: u32 = 64_000_000;

    fn prepare_pll(&mut self) -> Option<u32> {
        if !self.prepare_buses() || !self.raise_to_scale_1() {
            return None;
        }
        let is_scale_0 = self.allows_scale_0 && self.raise_to_scale_0();
        self.pll_hz = if is_scale_0 { 480_000_000 } else { 400_000_000 };
        Some(self.pll_hz)
    }

    fn start_crystal(&mut self) {
        // The bypass must be set before the oscillator is switched on.
        self.rcc.cr().modify(|_, w| w.hsebyp().bit(self.is_signal));
        self.rcc.cr().modify(|_, w| w.hseon().set_bit());
    }

    fn crystal_ready(&self) -> bool {
        self.rcc.cr().read().hserdy().bit_is_set()
    }

    fn start_pll(&mut self, input: PllInput) {
        // The divided input is 4 to 8 MHz, also with the internal oscillator's tolerance.
        let (mhz, divider, is_external) = match input {
            PllInput::Crystal { mhz } => (mhz, mhz / 4, true),
            PllInput::Internal => (64, 12, false),
        };
        self.rcc.pllckselr().modify(|_, w| {
            let w = w.divm1().set(divider);
            if is_external { w.pllsrc().hse() } else { w.pllsrc().hsi() }
        });
        self.rcc.pllcfgr().modify(|_, w| {
            let w = w.pll1vcosel().wide_vco().pll1rge().range4().pll1fracen().reset();
            w.divp1en().set_bit().divq1en().clear_bit().divr1en().clear_bit()
        });
        // The oscillator of the PLL runs at twice the core's frequency. Both fields are less 1.
        let pll_mhz = 2 * (self.pll_hz / 1_000_000);
        let multiplier = pll_mhz.saturating_mul(divider.into()).checked_div(mhz.into()).unwrap_or(1);
        self.rcc.pll1divr().modify(|_, w| {
            #[expect(unsafe_code, reason = "150 to 240, and 2: within the manual's ranges")]
            unsafe {
                w.divn1().bits(multiplier.saturating_sub(1) as u16).divp1().bits(1)
            }
        });
        self.rcc.cr().modify(|_, w| w.pll1on().set_bit());
    }

    fn pll_ready(&self) -> bool {
        self.rcc.cr().read().pll1rdy().bit_is_set()
    }

    fn stop_pll(&mut self) {
        // It cannot be stopped while the core runs on it, nor programmed before it has stopped.
        within_polls(|| self.selected(ClockSource::Internal));
        self.rcc.cr().modify(|_, w| w.pll1on().clear_bit());
        within_polls(|| !self.pll_ready());
    }

    fn select(&mut self, source: ClockSource) {
        self.rcc.cfgr().modify(|_, w| match source {
            ClockSource::PllCrystal | ClockSource::PllInternal => w.sw().pll1(),
            ClockSource::Crystal => w.sw().hse(),
            ClockSource::Internal | ClockSource::Host => w.sw().hsi(),
        });
    }

    fn selected(&self, source: ClockSource) -> bool {
        let status = self.rcc.cfgr().read().sws();
        match source {
            ClockSource::PllCrystal | ClockSource::PllInternal => status.is_pll1(),
            ClockSource::Crystal => status.is_hse(),
            ClockSource::Internal | ClockSource::Host => status.is_hsi(),
        }
    }
}
