//! Scripts for a bus.

use controller::sensors::{Answers, MAX_WORDS, SensorBus, Sequence};
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::spi::{Mock, Transaction};

/// A transaction of a whole frame: what is sent and what comes back.
pub(crate) fn frame(sent: &[u8], answer: &[u8]) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::transfer_in_place(sent.to_vec(), answer.to_vec()),
        Transaction::transaction_end(),
    ]
}

/// A conversion frame of the ADS8688 that selects an input.
pub(crate) fn selection(next: u8) -> [Transaction<u8>; 3] {
    frame(&[0xc0 | next << 2, 0, 0, 0], &[0; 4])
}

/// An answer of the AS5047P with its parity bit.
pub(crate) fn answer(data: u16) -> u16 {
    data | (data.count_ones() as u16 & 1) << 15
}

/// Diagnostics of the AS5047P: the offset compensation has ended.
pub(crate) const COMPENSATED: u16 = 0x0180;

/// Answers of the AS5047P to a sample.
pub(crate) fn encoder(angle: u16) -> [u16; 2] {
    [answer(angle), answer(COMPENSATED)]
}

/// Answers of a sample: the codes of the converter between those of the encoder.
pub(crate) fn answers(codes: &[u16], encoder: [u16; 2]) -> Answers {
    let mut words = vec![answer(0)];
    words.extend(codes.iter().flat_map(|code| [0, *code]));
    words.extend(encoder);
    words.resize(MAX_WORDS, 0xdead);
    words.try_into().unwrap()
}

/// Bus with a scripted converter that records the sequences.
#[derive(Debug)]
pub(crate) struct Bus {
    pub(crate) converter: Mock<u8>,
    /// Sequences that were run, with their periods.
    pub(crate) runs: Vec<(Sequence, u32)>,
}

impl Bus {
    pub(crate) fn new(script: &[Transaction<u8>]) -> Self {
        Self { converter: Mock::new(script), runs: vec![] }
    }
}

impl SensorBus for Bus {
    type Converter<'a> = Mock<u8>;

    fn converter(&mut self) -> Mock<u8> {
        self.converter.clone()
    }

    fn run(&mut self, sequence: &Sequence, period_us: u32) -> u32 {
        self.runs.push((sequence.clone(), period_us));
        self.runs.len() as u32
    }
}

/// A device that fails.
#[derive(Debug)]
pub(crate) struct Broken;

#[derive(Debug)]
pub(crate) struct Failure;

impl embedded_hal::spi::Error for Failure {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl embedded_hal::spi::ErrorType for Broken {
    type Error = Failure;
}

impl embedded_hal::spi::SpiDevice for Broken {
    fn transaction(&mut self, _: &mut [embedded_hal::spi::Operation<'_, u8>]) -> Result<(), Failure> {
        Err(Failure)
    }
}
