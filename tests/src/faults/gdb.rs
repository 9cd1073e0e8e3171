//! Minimal client of the GDB remote serial protocol over a Unix socket.
//!
//! A packet is `$text#sum`. The sum is that of the text's bytes modulo 256, as two hexadecimal
//! digits; either side acknowledges with `+`. Numbers and memory are hexadecimal, registers are
//! little-endian. Every wait has a timeout; an unexpected reply is an error. Source: the GDB
//! manual, "Remote Protocol".

use super::CampaignError;
use super::wait::wait_for;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

/// Timeout of a reply to any command but "continue".
const TIMEOUT: Duration = Duration::from_secs(10);
/// Length of a breakpoint's instruction in Thumb code, bytes.
const THUMB: u32 = 2;

/// Connection to a debugger stub. Every call but [`Gdb::resume`] needs a stopped core.
#[derive(Debug)]
pub(crate) struct Gdb {
    stream: UnixStream,
    received: Vec<u8>,
}

impl Gdb {
    /// Connects as soon as the emulator has created its socket.
    pub(crate) fn connect(path: &Path) -> Result<Self, CampaignError> {
        let until = Instant::now() + TIMEOUT;
        let stream = loop {
            match UnixStream::connect(path) {
                Ok(stream) => break stream,
                Err(_) if Instant::now() < until => std::thread::sleep(Duration::from_millis(1)),
                Err(source) => {
                    return Err(CampaignError::System { what: "the emulator's debug socket", source });
                }
            }
        };
        stream.set_nonblocking(true).map_err(failed)?;
        Ok(Self { stream, received: vec![] })
    }

    /// Returns the socket, to poll it together with others.
    pub(crate) const fn stream(&self) -> &UnixStream {
        &self.stream
    }

    /// Reads memory.
    pub(crate) fn read(&mut self, address: u32, length: usize) -> Result<Vec<u8>, CampaignError> {
        let reply = self.request(&format!("m{address:x},{length:x}"))?;
        let bytes = from_hexadecimal(&reply).filter(|bytes| bytes.len() == length);
        bytes.ok_or_else(|| unexpected(&reply, "the bytes of a memory"))
    }

    /// Writes memory, also flash.
    pub(crate) fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), CampaignError> {
        let text: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        self.command(&format!("M{address:x},{:x}:{text}", bytes.len()))
    }

    /// Flips a bit of a byte in memory.
    pub(crate) fn flip(&mut self, address: u32, bit: u8) -> Result<(), CampaignError> {
        let before = self.read(address, 1)?;
        let after: Vec<u8> = before.iter().map(|byte| byte ^ (1 << (bit & 7))).collect();
        self.write(address, &after)
    }

    /// Reads a core register: 13 is the stack pointer, 15 the program counter.
    pub(crate) fn register(&mut self, number: u32) -> Result<u32, CampaignError> {
        // The stub reads single registers only for clients that know its register description.
        let reply = self.request("g")?;
        let bytes = from_hexadecimal(&reply).unwrap_or_default();
        let word = bytes.as_chunks::<4>().0.get(number as usize);
        word.copied().map(u32::from_le_bytes).ok_or_else(|| unexpected(&reply, "the core's registers"))
    }

    /// Sets a breakpoint: the core stops before the instruction at an address.
    pub(crate) fn set_breakpoint(&mut self, address: u32) -> Result<(), CampaignError> {
        self.command(&format!("Z0,{address:x},{THUMB:x}"))
    }

    /// Removes a breakpoint.
    pub(crate) fn clear_breakpoint(&mut self, address: u32) -> Result<(), CampaignError> {
        self.command(&format!("z0,{address:x},{THUMB:x}"))
    }

    /// Executes one instruction.
    pub(crate) fn step(&mut self) -> Result<(), CampaignError> {
        let reply = self.request("s")?;
        if reply.starts_with('T') || reply.starts_with('S') {
            Ok(())
        } else {
            Err(unexpected(&reply, "a stop"))
        }
    }

    /// Resets the machine through the emulator's monitor.
    pub(crate) fn reset(&mut self) -> Result<(), CampaignError> {
        let command: String = "system_reset".bytes().map(|byte| format!("{byte:02x}")).collect();
        self.command(&format!("qRcmd,{command}"))
    }

    /// Lets the core run. [`Gdb::has_stopped`] reports when it stops.
    pub(crate) fn resume(&mut self) -> Result<(), CampaignError> {
        self.send("c")
    }

    /// Returns whether the core has stopped since [`Gdb::resume`]; does not wait.
    pub(crate) fn has_stopped(&mut self) -> Result<bool, CampaignError> {
        match self.packet()? {
            Some(text) if text.starts_with('T') || text.starts_with('S') => Ok(true),
            // The emulation has ended; the caller checks the process.
            Some(text) if text.starts_with('W') || text.starts_with('X') => Ok(false),
            Some(text) => Err(unexpected(&text, "a stop")),
            None => Ok(false),
        }
    }

    fn command(&mut self, command: &str) -> Result<(), CampaignError> {
        let reply = self.request(command)?;
        if reply == "OK" { Ok(()) } else { Err(unexpected(&reply, "OK")) }
    }

    fn request(&mut self, command: &str) -> Result<String, CampaignError> {
        self.send(command)?;
        let until = Instant::now() + TIMEOUT;
        loop {
            if let Some(text) = self.packet()? {
                // Monitor output precedes the reply.
                if text.starts_with('O') && text != "OK" {
                    continue;
                }
                return Ok(text);
            }
            if Instant::now() >= until {
                return Err(CampaignError::Debugger {
                    found: format!("no reply to `{command}` within {} s", TIMEOUT.as_secs()),
                    expected: "a packet",
                });
            }
            wait_for(&self.stream, Duration::from_millis(100))?;
        }
    }

    fn send(&mut self, command: &str) -> Result<(), CampaignError> {
        let sum = command.bytes().fold(0_u8, u8::wrapping_add);
        // The socket's buffer holds far more than one packet.
        self.stream.write_all(format!("${command}#{sum:02x}").as_bytes()).map_err(failed)
    }

    /// Returns the next received packet, if any, and acknowledges it.
    fn packet(&mut self) -> Result<Option<String>, CampaignError> {
        let mut buffer = [0; 4096];
        match self.stream.read(&mut buffer) {
            Ok(count) => self.received.extend(buffer.iter().take(count)),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            // The emulator has ended; the caller checks its process.
            Err(error) if error.kind() == ErrorKind::ConnectionReset => {}
            Err(error) => return Err(failed(error)),
        }
        let Some((text, used)) = first_packet(&self.received)? else { return Ok(None) };
        self.received.drain(..used);
        // A failure means that the emulator has ended; see above.
        let _ = self.stream.write_all(b"+");
        Ok(Some(text))
    }
}

/// Returns the first complete packet and the number of bytes up to its end.
fn first_packet(received: &[u8]) -> Result<Option<(String, usize)>, CampaignError> {
    let begin = received.iter().position(|&byte| byte == b'$');
    let end = received.iter().position(|&byte| byte == b'#');
    let (Some(begin), Some(end)) = (begin, end) else { return Ok(None) };
    let (Some(text), Some(sum)) = (received.get(begin + 1..end), received.get(end + 1..end + 3)) else {
        return Ok(None);
    };
    let found = text.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    let text = String::from_utf8_lossy(text).into_owned();
    if sum.eq_ignore_ascii_case(format!("{found:02x}").as_bytes()) {
        Ok(Some((text, end + 3)))
    } else {
        Err(unexpected(&text, "a packet with a valid checksum"))
    }
}

fn from_hexadecimal(text: &str) -> Option<Vec<u8>> {
    let (pairs, rest) = text.as_bytes().as_chunks::<2>();
    let byte = |pair: &[u8; 2]| u8::from_str_radix(str::from_utf8(pair).ok()?, 16).ok();
    if rest.is_empty() { pairs.iter().map(byte).collect() } else { None }
}

fn failed(source: std::io::Error) -> CampaignError {
    CampaignError::System { what: "the emulator's debug socket", source }
}

fn unexpected(found: &str, expected: &'static str) -> CampaignError {
    CampaignError::Debugger { found: format!("`{found}`"), expected }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_complete_packet_with_a_valid_checksum_is_read() {
        assert!(first_packet(b"+$O").unwrap().is_none());
        assert!(first_packet(b"+$OK#9").unwrap().is_none());
        assert_eq!(first_packet(b"+$OK#9a$T05#").unwrap(), Some(("OK".into(), 7)));
        assert!(first_packet(b"$OK#9b").is_err());
    }

    #[test]
    fn hexadecimal_bytes_are_read_in_pairs() {
        assert_eq!(from_hexadecimal("00ff1A"), Some(vec![0, 255, 26]));
        assert_eq!(from_hexadecimal("0"), None);
        assert_eq!(from_hexadecimal("E0x1"), None);
    }
}
