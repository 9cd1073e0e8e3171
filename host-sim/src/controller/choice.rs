//! Selection of the controller that a command uses.

use crate::cli::error::CliError;
use crate::controller::{
    AttachedController, Controller, EmulatedController, NativeController, RemoteController,
};
use clap::Args;
use controller::boards::{BOARDS, Board, parse as parse_board};
use link::authentication::LinkKey;
use std::path::{Path, PathBuf};

/// Kind of controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ControllerKind {
    /// The firmware's code in this process.
    Native,
    /// The firmware's image in the emulator.
    Emulated,
    /// A board on a serial port or at a debug probe.
    Attached,
}

/// Kind of controller outside this process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum RemoteKind {
    /// The firmware's image in the emulator; its state is lost at the end.
    Emulated,
    /// A board on a serial port or at a debug probe.
    Attached,
}

/// Connection to a controller outside this process.
#[derive(Args, Clone, Debug, Default)]
pub struct ConnectionOptions {
    /// Connect to the attached controller through a debug probe: VID:PID or VID:PID:SERIAL in
    /// hexadecimal; without a value the only probe. --elf is then the image that the board runs.
    #[arg(
        long,
        value_name = "PROBE",
        num_args = 0..=1,
        default_missing_value = "",
        value_parser = selector,
        group = "way"
    )]
    pub probe: Option<String>,
    /// Board at the probe; the default stm32f405 is any board with that microcontroller.
    #[arg(long, value_parser = parse_board, requires = "probe")]
    pub board: Option<Board>,
    /// Key of the link, for a firmware that was built with it (`PINTLE_LINK_KEY`); `model-quant key
    /// --link` makes one.
    #[arg(long, value_name = "FILE", value_parser = read_link_key)]
    pub link_key: Option<LinkKey>,
}

/// Reads the file of a key of the link.
///
/// # Errors
///
/// The file cannot be read, or contains no key.
pub fn read_link_key(path: &str) -> Result<LinkKey, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    model_quant::exchange::key::secret(&text).map(LinkKey::new).map_err(|error| error.to_string())
}

/// Checks the name of a probe; an empty name selects the only one.
fn selector(text: &str) -> Result<String, String> {
    let mut parts = text.splitn(3, ':');
    let mut number = || parts.next().is_some_and(|part| u16::from_str_radix(part, 16).is_ok());
    if text.is_empty() || number() && number() {
        return Ok(text.into());
    }
    Err("expected VID:PID or VID:PID:SERIAL in hexadecimal".into())
}

/// Opens a controller without configuring it.
pub(crate) fn open(
    end: ControllerKind,
    elf: Option<&Path>,
    port: Option<&Path>,
    connection: &ConnectionOptions,
) -> Result<Box<dyn Controller>, CliError> {
    Ok(match end {
        ControllerKind::Native => Box::new(NativeController::open()?),
        ControllerKind::Emulated => Box::new(emulated(elf, connection)?),
        ControllerKind::Attached => Box::new(attached(elf, port, connection)?),
    })
}

/// Starts the emulator.
pub(crate) fn emulated(
    elf: Option<&Path>,
    connection: &ConnectionOptions,
) -> Result<RemoteController, CliError> {
    let default = EmulatedController::default_elf();
    Ok(EmulatedController::open(elf.unwrap_or(&default))?.with_key(connection.link_key))
}

/// Opens a board.
pub(crate) fn attached(
    elf: Option<&Path>,
    port: Option<&Path>,
    connection: &ConnectionOptions,
) -> Result<RemoteController, CliError> {
    let controller = match (port, &connection.probe) {
        (Some(port), _) => AttachedController::open(port)?,
        (None, Some(selector)) => {
            let [any, ..] = BOARDS;
            let board = connection.board.unwrap_or(any);
            let selector = (!selector.is_empty()).then_some(selector.as_str());
            at_probe(selector, board, &image_for(board, elf))?
        }
        (None, None) => {
            return Err(CliError::Input(
                "--controller attached: found neither --port nor --probe; expected a serial port or a debug \
                 probe"
                    .into(),
            ));
        }
    };
    Ok(controller.with_key(connection.link_key))
}

#[cfg(feature = "probe")]
fn at_probe(selector: Option<&str>, board: Board, image: &Path) -> Result<RemoteController, CliError> {
    Ok(crate::controller::ProbedController::open(selector, board, image)?)
}

#[cfg(not(feature = "probe"))]
fn at_probe(_: Option<&str>, _: Board, _: &Path) -> Result<RemoteController, CliError> {
    Err(without_probes("run --controller attached --probe ..."))
}

/// Error returned by probe commands in a build without feature `probe`.
#[cfg(not(feature = "probe"))]
pub(crate) fn without_probes(command: &str) -> CliError {
    CliError::Input(format!(
        "this build has no support for probes; found no feature `probe`, expected it: \
         cargo run --release -p host-sim --features probe -- {command}"
    ))
}

/// Returns the image of a board: the given file, or the output of `cargo xtask firmware --board`.
pub(crate) fn image_for(board: Board, elf: Option<&Path>) -> PathBuf {
    let default = EmulatedController::default_elf();
    match elf {
        Some(elf) => elf.into(),
        None => default.with_file_name(board.image_name().to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_is_named_by_two_numbers_and_perhaps_its_serial_or_not_at_all() {
        for good in ["", "0483:374b", "0483:374B:066BFF:12", "1:2:"] {
            assert_eq!(selector(good).as_deref(), Ok(good));
        }
        for bad in ["0483", "0483:", "st-link", "12345:1", ":1", "link.rec"] {
            assert!(selector(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_file_without_a_key_of_the_link_is_refused_without_its_content() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("link.key");
        let path = file.to_str().expect("a name");
        assert!(read_link_key(path).is_err());
        for text in ["# only a remark\n".to_owned(), "secret\n".into(), "ab".repeat(33)] {
            std::fs::write(&file, &text).expect("written");
            let error = read_link_key(path).expect_err("no key");
            assert!(error.contains("expected") && !error.contains("secret"), "{error}");
        }
        std::fs::write(&file, "ab".repeat(32)).expect("written");
        assert!(read_link_key(path).is_ok());
    }

    #[test]
    fn an_attached_controller_without_port_or_probe_is_an_input_error() {
        let error = attached(None, None, &ConnectionOptions::default()).expect_err("an error");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("neither --port nor --probe"), "{error}");
    }
}
