//! The boards as data: which pin does what, where it comes out, which crystal feeds the clock, how the light is wired.
//!
//! The signals use the same pins on every STM32F405 board, chosen so that each of them has all of them on its headers: USART3's pins, for
//! one, are a push button on the Netduino Plus 2. So one image (`stm32f405`) serves every board; an image for a named board also knows the
//! crystal and the light. Used by the code and, by a test, by `docs/firmware.md`.
//! Sources: Adafruit product 4382, Olimex STM32-H405 user's manual, Netduino Plus 2 schematic.

/// A GPIO port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// GPIOA.
    A,
    /// GPIOB.
    B,
    /// GPIOC.
    C,
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Light {
    /// Its port.
    pub port: Port,
    /// Number of the pin in the port.
    pub number: u8,
    /// Whether it shines when the pin is low.
    pub lit_when_low: bool,
}

/// A board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardFacts {
    /// Name for `--board`.
    pub name: &'static str,
    /// What it says on the board.
    pub title: &'static str,
    /// The crystal, MHz; `None` for "not known" or "has none".
    pub crystal_mhz: Option<u8>,
    /// The light, if there is one to use.
    pub light: Option<Light>,
}

/// Every board with an STM32F405: internal oscillator, no light.
pub const ANY_STM32F405: BoardFacts =
    BoardFacts { name: "stm32f405", title: "any board with an STM32F405", crystal_mhz: None, light: None };

/// Every board that an image can be built for.
pub const BOARDS: [BoardFacts; 5] = [
    ANY_STM32F405,
    BoardFacts {
        name: "feather-stm32f405",
        title: "Adafruit Feather STM32F405",
        crystal_mhz: Some(12),
        light: Some(Light { port: Port::C, number: 1, lit_when_low: false }),
    },
    BoardFacts {
        name: "olimex-stm32-h405",
        title: "Olimex STM32-H405",
        crystal_mhz: Some(8),
        light: Some(Light { port: Port::C, number: 12, lit_when_low: true }),
    },
    BoardFacts {
        name: "netduino-plus-2",
        title: "Netduino Plus 2",
        crystal_mhz: Some(25),
        light: Some(Light { port: Port::A, number: 10, lit_when_low: false }),
    },
    BoardFacts { name: "mps2-an505", title: "Arm MPS2+ with image AN505", crystal_mhz: None, light: None },
];

/// A signal of the controller on the STM32F405.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// What it is.
    pub name: &'static str,
    /// Its port.
    pub port: Port,
    /// Number of the pin in the port.
    pub number: u8,
    /// Alternate function number; `None` is plain output.
    pub alternate: Option<u8>,
    /// What is printed beside it: Feather, H405, Netduino Plus 2.
    pub printed: [&'static str; 3],
}

/// The signals.
pub const SIGNALS: [Signal; 7] = [
    signal("link out (USART6 TX)", Port::C, 6, Some(8), ["D6", "PC6", "D1"]),
    signal("link in (USART6 RX)", Port::C, 7, Some(8), ["D5", "PC7", "D0"]),
    signal("sensors' clock (SPI2 SCK)", Port::B, 13, Some(5), ["SCK", "PB13", "D13"]),
    signal("sensors' data in (SPI2 MISO)", Port::B, 14, Some(5), ["MISO", "PB14", "D12"]),
    signal("sensors' data out (SPI2 MOSI)", Port::B, 15, Some(5), ["MOSI", "PB15", "D11"]),
    signal("select: converter of probes and load", Port::B, 9, None, ["D10", "PB9", "D6"]),
    signal("select: absolute encoder", Port::B, 8, None, ["D9", "PB8", "D5"]),
];

const fn signal(
    name: &'static str,
    port: Port,
    number: u8,
    alternate: Option<u8>,
    printed: [&'static str; 3],
) -> Signal {
    Signal { name, port, number, alternate, printed }
}

/// The board of a name.
#[must_use]
pub const fn named(name: &str) -> Option<&'static BoardFacts> {
    let mut rest: &[BoardFacts] = &BOARDS;
    while let [board, others @ ..] = rest {
        if same(board.name.as_bytes(), name.as_bytes()) {
            return Some(board);
        }
        rest = others;
    }
    None
}

const fn same(mut left: &[u8], mut right: &[u8]) -> bool {
    while let ([a, more_left @ ..], [b, more_right @ ..]) = (left, right) {
        if *a != *b {
            return false;
        }
        (left, right) = (more_left, more_right);
    }
    left.is_empty() && right.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_are_found_by_their_name() {
        for board in &BOARDS {
            assert_eq!(named(board.name), Some(board));
        }
        assert_eq!(named("stm32f40"), None);
        assert_eq!(named("stm32f4055"), None);
        assert_eq!(named(""), None);
    }

    #[test]
    fn no_pin_has_two_uses_on_any_board() {
        for (index, signal) in SIGNALS.iter().enumerate() {
            let pin = (signal.port, signal.number);
            assert!(
                SIGNALS[..index].iter().all(|other| (other.port, other.number) != pin),
                "{}",
                signal.name
            );
            let lights = BOARDS.iter().filter_map(|board| board.light);
            assert!(lights.into_iter().all(|light| (light.port, light.number) != pin), "{}", signal.name);
        }
    }

    #[test]
    fn the_documentation_has_the_same_tables() {
        let text = include_str!("../../../docs/firmware.md");
        for signal in SIGNALS {
            let [feather, h405, netduino] = signal.printed;
            let row = format!(
                "| {} | P{:?}{} | {feather} | {h405} | {netduino} |",
                signal.name, signal.port, signal.number
            );
            assert!(text.contains(&row), "docs/firmware.md: {row}");
        }
        for board in BOARDS {
            let crystal = board.crystal_mhz.map_or("-".into(), |mhz| format!("{mhz} MHz"));
            let light = board.light.map_or("-".into(), |light| {
                format!(
                    "P{:?}{}, {}",
                    light.port,
                    light.number,
                    if light.lit_when_low { "lit when low" } else { "lit when high" }
                )
            });
            let row = format!("| `{}` | {} | {crystal} | {light} |", board.name, board.title);
            assert!(text.contains(&row), "docs/firmware.md: {row}");
        }
    }
}
