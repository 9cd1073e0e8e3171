//! The controller's log: defmt records from its RTT buffer to lines of text. The texts are in the image, the controller sends numbers only.

use super::FlashError;
use defmt_decoder::{DecodeError, StreamDecoder, Table};

/// The texts of an image.
pub struct Texts(Table);

impl Texts {
    /// Reads them from an ELF image.
    ///
    /// # Errors
    ///
    /// The image has none, or they are of another version.
    pub fn of(elf: &[u8]) -> Result<Self, FlashError> {
        let failed = |cause: String| FlashError::Probe { what: "the texts of the log", cause };
        match Table::parse(elf) {
            Ok(Some(table)) => Ok(Self(table)),
            Ok(None) => Err(failed("the image has none".into())),
            Err(error) => Err(failed(error.to_string())),
        }
    }

    /// A decoder that waits for the first byte.
    pub fn decoder(&self) -> Log<'_> {
        Log { decoder: self.0.new_stream_decoder() }
    }
}

/// Turns bytes into lines.
pub struct Log<'a> {
    decoder: Box<dyn StreamDecoder + Send + Sync + 'a>,
}

impl Log<'_> {
    /// Takes bytes and gives every line that is complete. What is damaged is left out: the encoding finds its place again.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<String> {
        self.decoder.received(bytes);
        let mut lines = Vec::new();
        loop {
            match self.decoder.decode() {
                Ok(frame) => lines.push(frame.display(false).to_string()),
                Err(DecodeError::Malformed) => {}
                Err(DecodeError::UnexpectedEof) => return lines,
            }
        }
    }
}
