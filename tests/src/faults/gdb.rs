//! A minimal client of the GDB remote serial protocol, as the emulator's stub speaks it over a unix socket.
//!
//! Packets are `$text#sum` with the sum of the text's bytes modulo 256 as two hexadecimal digits; either side acknowledges with `+`. Numbers and
//! memory are hexadecimal, registers little endian. Every wait is bounded; a reply that is none of those expected is an error that says which.
//! Source: the GDB manual, "Remote Protocol".

use super::CampaignError;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

/// Bound on the stub's answer to anything but "go on".
const BOUND: Duration = Duration::from_secs(10);
/// Length of an instruction for a breakpoint, as Thumb wants it.
const THUMB: u32 = 2;

/// A connection to a stub. The core stands whenever something other than [`Gdb::go_on`] is asked.
#[derive(Debug)]
pub struct Gdb {
    stream: UnixStream,
    received: Vec<u8>,
}

impl Gdb {
    /// Connects once the emulator has made its socket.
    pub fn connect(path: &Path) -> Result<Self, CampaignError> {
        let until = Instant::now() + BOUND;
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

    /// The socket, to be polled together with other things.
    pub const fn stream(&self) -> &UnixStream {
        &self.stream
    }

    /// Reads memory.
    pub fn read(&mut self, address: u32, length: usize) -> Result<Vec<u8>, CampaignError> {
        let reply = self.ask(&format!("m{address:x},{length:x}"))?;
        let bytes = from_hexadecimal(&reply).filter(|bytes| bytes.len() == length);
        bytes.ok_or_else(|| unexpected(&reply, "the bytes of a memory"))
    }

    /// Writes memory; flash, too.
    pub fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), CampaignError> {
        let text: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        self.done(&format!("M{address:x},{:x}:{text}", bytes.len()))
    }

    /// Flips a bit of a byte in memory.
    pub fn flip(&mut self, address: u32, bit: u8) -> Result<(), CampaignError> {
        let before = self.read(address, 1)?;
        let after: Vec<u8> = before.iter().map(|byte| byte ^ (1 << (bit & 7))).collect();
        self.write(address, &after)
    }

    /// Core register of a number: 13 is the stack pointer, 15 the program counter.
    pub fn register(&mut self, number: u32) -> Result<u32, CampaignError> {
        // One at a time is for clients that have read the stub's description of its registers.
        let reply = self.ask("g")?;
        let bytes = from_hexadecimal(&reply).unwrap_or_default();
        let word = bytes.as_chunks::<4>().0.get(number as usize);
        word.copied().map(u32::from_le_bytes).ok_or_else(|| unexpected(&reply, "the core's registers"))
    }

    /// Has the core stop before the instruction at an address.
    pub fn set_breakpoint(&mut self, address: u32) -> Result<(), CampaignError> {
        self.done(&format!("Z0,{address:x},{THUMB:x}"))
    }

    /// Takes that back.
    pub fn clear_breakpoint(&mut self, address: u32) -> Result<(), CampaignError> {
        self.done(&format!("z0,{address:x},{THUMB:x}"))
    }

    /// Lets the core carry out one instruction.
    pub fn step(&mut self) -> Result<(), CampaignError> {
        let reply = self.ask("s")?;
        if reply.starts_with('T') || reply.starts_with('S') {
            Ok(())
        } else {
            Err(unexpected(&reply, "a stop"))
        }
    }

    /// Resets the machine, through the emulator's own command.
    pub fn reset(&mut self) -> Result<(), CampaignError> {
        let command: String = "system_reset".bytes().map(|byte| format!("{byte:02x}")).collect();
        self.done(&format!("qRcmd,{command}"))
    }

    /// Lets the core run on. What stops it comes by [`Gdb::stopped`].
    pub fn go_on(&mut self) -> Result<(), CampaignError> {
        self.send("c")
    }

    /// Whether the core has stopped again; does not wait.
    pub fn stopped(&mut self) -> Result<bool, CampaignError> {
        match self.packet()? {
            Some(text) if text.starts_with('T') || text.starts_with('S') => Ok(true),
            // The emulation has ended: the process tells.
            Some(text) if text.starts_with('W') || text.starts_with('X') => Ok(false),
            Some(text) => Err(unexpected(&text, "a stop")),
            None => Ok(false),
        }
    }

    fn done(&mut self, command: &str) -> Result<(), CampaignError> {
        let reply = self.ask(command)?;
        if reply == "OK" { Ok(()) } else { Err(unexpected(&reply, "OK")) }
    }

    fn ask(&mut self, command: &str) -> Result<String, CampaignError> {
        self.send(command)?;
        let until = Instant::now() + BOUND;
        loop {
            if let Some(text) = self.packet()? {
                // Output of the emulator's own commands comes before their reply.
                if text.starts_with('O') && text != "OK" {
                    continue;
                }
                return Ok(text);
            }
            if Instant::now() >= until {
                return Err(CampaignError::Debugger {
                    found: format!("no answer to `{command}` within {} s", BOUND.as_secs()),
                    expected: "a packet",
                });
            }
            super::emulator::wait_for(&self.stream, Duration::from_millis(100))?;
        }
    }

    fn send(&mut self, command: &str) -> Result<(), CampaignError> {
        let sum = command.bytes().fold(0_u8, u8::wrapping_add);
        // A socket's buffer holds far more than one packet.
        self.stream.write_all(format!("${command}#{sum:02x}").as_bytes()).map_err(failed)
    }

    /// The next packet that has come, acknowledged.
    fn packet(&mut self) -> Result<Option<String>, CampaignError> {
        let mut buffer = [0; 4096];
        match self.stream.read(&mut buffer) {
            Ok(count) => self.received.extend(buffer.iter().take(count)),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            // The emulator has gone; whoever waits asks its process.
            Err(error) if error.kind() == ErrorKind::ConnectionReset => {}
            Err(error) => return Err(failed(error)),
        }
        let Some((text, used)) = first_packet(&self.received)? else { return Ok(None) };
        self.received.drain(..used);
        // Gone again is no matter here either.
        let _ = self.stream.write_all(b"+");
        Ok(Some(text))
    }
}

/// The first whole packet of what was received, and the bytes up to its end.
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
        Err(unexpected(&text, "a packet with its sum"))
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
    fn packets_are_taken_whole_and_with_a_sound_sum_only() {
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
