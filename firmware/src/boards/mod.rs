//! The boards: the one place that touches registers.
//!
//! A board is one file that starts it (`start`) and names its parts: the device for the task framework, the link's serial port, the
//! watchdog, the light. Everything else here is shared by all of them. Another board is another such file, a memory map in
//! `firmware/memory`, a feature of this crate and a line in [`pins::BOARDS`].
//!
//! * `stm32f405.rs`: Cortex-M4F. One image serves every board with an STM32F405 and the emulator's `netduinoplus2`; which of the two it
//!   is, it finds out when it starts.
//! * `mps2_an505.rs`: Cortex-M33, Arm's prototyping board with the image AN505, as the emulator's `mps2-an505`.
//!
//! The link goes over semihosting files where the emulator offers them, else over the serial port or a debug probe, whichever the host
//! last spoke through. The serial path has been tried on
//! the emulator's ports only, which know neither baud rate nor line errors; clock bring-up, pins and baud rate are still to be seen on
//! silicon.

pub mod channel;
pub mod pins;
pub mod ring;

macro_rules! on_target {
    ($($item:item)*) => { $(#[cfg(all(target_os = "none", feature = "board"))] $item)* };
}

on_target! {
    mod code;
    mod fault;
    mod guard;
    mod log;
    mod memory;
    mod model_memory;
    mod rtt;
    mod semihosting;
    mod timer;

    #[cfg(feature = "mps2-an505")]
    mod mps2_an505;
    #[cfg(feature = "stm32f405")]
    mod stm32f405;

    #[cfg(feature = "mps2-an505")]
    pub use mps2_an505::{Inbox, Light, PACKAGES_FOR, Receiver, Sensors, Transmitter, Watchdog, device, start};
    #[cfg(feature = "stm32f405")]
    pub use stm32f405::{Inbox, Light, PACKAGES_FOR, Receiver, Sensors, Transmitter, Watchdog, device, start};

    #[cfg(feature = "provoke")]
    mod provoke;
    #[cfg(feature = "provoke")]
    pub use provoke::provoke;

    /// Notes that a party is at work.
    pub fn check_in(attendance: &crate::supervisor::Attendance, party: crate::supervisor::Party) {
        #[cfg(feature = "provoke")]
        if provoke::keeps_away(party) {
            return;
        }
        attendance.check_in(party, uptime_us());
    }

    pub use code::{code_check, code_word};
    pub use fault::give_up;
    pub use memory::{stack_mark, stack_used};
    pub use model_memory::{Memory, Storage};
    pub use rtt::Probe;
    pub use semihosting::{Files, leave};
    pub use timer::{TICKS_PER_SECOND, Timer, advance_uptime, uptime_us};

    /// Name of this build: `git describe`, or the crate's version.
    const BUILD_ID: &str = match option_env!("PINTLE_BUILD_ID") {
        Some(id) => id,
        None => env!("CARGO_PKG_VERSION"),
    };

    /// The board that the image is built for; there is one MPS2 only.
    #[cfg(feature = "stm32f405")]
    pub(crate) const BOARD: &pins::BoardFacts = match option_env!("PINTLE_BOARD") {
        None => &pins::ANY_STM32F405,
        Some(name) => match pins::named(name) {
            Some(board) => board,
            None => panic!("PINTLE_BOARD names no board of boards/pins.rs"),
        },
    };

    /// What the link goes over.
    pub enum Link {
        /// Files of the host: lockstep, a frame is a tick.
        Files(Files),
        /// The serial port and, beside it, a debug probe: SysTick paces.
        Serial(Transmitter, Probe),
    }

    /// What the serial port's interrupt finds.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Came {
        /// A byte, where bytes come by interrupt.
        pub byte: Option<u8>,
        /// Each 1 or 0.
        pub errors: link::LineErrors,
    }

    /// The started board.
    pub struct Board {
        /// What to say in the greeting.
        pub identity: crate::session::Identity,
        /// Why it started.
        pub start: link::start::StartReport,
        /// The link.
        pub link: Link,
        /// The serial port's receiving half, for its interrupt.
        pub receiver: Receiver,
        /// What comes in without interrupts, for the link's loop.
        pub inbox: Inbox,
        /// The counter of a tick's work.
        pub timer: Timer,
        /// The hardware's watchdog, running.
        pub watchdog: Watchdog,
        /// The light.
        pub light: Light,
        /// Who must check in.
        pub attendance: crate::supervisor::Attendance,
        /// What models and configuration are kept in.
        pub storage: Storage,
        /// The sensors, if it has any.
        pub sensors: Option<Sensors>,
    }
}
