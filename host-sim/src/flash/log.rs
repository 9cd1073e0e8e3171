//! The controller's log: decodes defmt records from its RTT buffer. The image contains the texts;
//! the controller sends numbers.

use super::FlashError;
use defmt_decoder::{DecodeError, StreamDecoder, Table};

/// The texts of an image.
pub struct Texts(Table);

impl Texts {
    /// Reads the texts of an ELF image.
    ///
    /// # Errors
    ///
    /// The image has none, or they have another version.
    pub fn from_elf(elf: &[u8]) -> Result<Self, FlashError> {
        let failed = |cause: String| FlashError::Probe { what: "the texts of the log", cause };
        match Table::parse(elf) {
            Ok(Some(table)) => Ok(Self(table)),
            Ok(None) => Err(failed("the image has none".into())),
            Err(error) => Err(failed(error.to_string())),
        }
    }

    /// Creates a decoder.
    pub fn decoder(&self) -> Log<'_> {
        Log { decoder: self.0.new_stream_decoder() }
    }
}

/// A decoder from bytes to lines.
pub struct Log<'a> {
    decoder: Box<dyn StreamDecoder + Send + Sync + 'a>,
}

impl Log<'_> {
    /// Decodes bytes and returns every complete line. Damaged records are skipped.
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
