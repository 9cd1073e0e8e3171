//! Boards with the places of code and data, and the models of their cores.

use super::bound::Bound;
use super::flash::Memory;
use super::m4::CortexM4;
use super::m7::CortexM7;
use super::m7_caches::Caches;
use super::trace::Section;
use controller::clock::PLL_HZ;
use std::ops::Range;

/// Board and the places of code and data on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Placement {
    /// STM32F405 at 168 MHz as shipped: code, constants and weights in flash.
    WeightsInFlash,
    /// The same with the weights in RAM or in core-coupled memory.
    WeightsInRam,
    /// The same without any wait state: the limit of every placement.
    NoWaitStates,
    /// STM32H743 at 480 MHz as built: code, constants and weights in flash, stack and state in the
    /// data TCM.
    Cached,
    /// The same with code and constants in the instruction TCM: the limit of every placement.
    TightlyCoupled,
}

impl Placement {
    pub(super) const ALL: [Self; 5] =
        [Self::WeightsInFlash, Self::WeightsInRam, Self::NoWaitStates, Self::Cached, Self::TightlyCoupled];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::WeightsInFlash => "weights in flash, as shipped",
            Self::WeightsInRam => "weights in RAM",
            Self::NoWaitStates => "no wait states",
            Self::Cached => "flash with empty caches, as built",
            Self::TightlyCoupled => "tightly coupled memories",
        }
    }

    /// Returns the board, its core and its frequency.
    pub(super) const fn board(self) -> (&'static str, &'static str, u32) {
        match self {
            Self::Cached | Self::TightlyCoupled => ("stm32h743", "Cortex-M7", 480_000_000),
            _ => ("stm32f405", "Cortex-M4", PLL_HZ),
        }
    }

    /// Creates the model of the core; `weights` are their addresses in the traced image.
    pub(super) fn pricer(self, bound: Bound, weights: &Range<u32>) -> Pricer {
        /// Wait states of the flash at 168 MHz and 3.3 V.
        const WAIT_STATES: u64 = 5;
        let memory =
            |wait_states, is_in_flash| Memory::new(wait_states, bound, Some((weights.clone(), is_in_flash)));
        match self {
            Self::WeightsInFlash => Pricer::M4(CortexM4::new(bound, memory(WAIT_STATES, true))),
            Self::WeightsInRam => Pricer::M4(CortexM4::new(bound, memory(WAIT_STATES, false))),
            Self::NoWaitStates => Pricer::M4(CortexM4::new(bound, memory(0, false))),
            Self::Cached => Pricer::M7(CortexM7::new(bound, Some(Caches::new(bound)))),
            Self::TightlyCoupled => Pricer::M7(CortexM7::new(bound, None)),
        }
    }
}

/// Model of a core.
pub(super) enum Pricer {
    M4(CortexM4),
    M7(CortexM7),
}

impl Pricer {
    pub(super) fn price(&mut self, section: &Section) -> u64 {
        match self {
            Self::M4(core) => core.price(section),
            Self::M7(core) => core.price(section),
        }
    }
}
