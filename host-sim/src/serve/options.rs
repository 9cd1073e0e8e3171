//! Options of the server of a live view.

use crate::cli::error::CliError;
use clap::Args;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::Duration;

/// Address of `--serve` without a value.
const DEFAULT_ADDRESS: &str = "127.0.0.1:8750";
/// Variable with the token, which a list of processes does not show.
const TOKEN_VARIABLE: &str = "HOST_SIM_SERVE_TOKEN";
/// Lengths of a token.
const TOKEN_LENGTHS: core::ops::RangeInclusive<usize> = 16..=256;
/// Maximum time for which the server stays, s: a day.
const MAX_STAY_S: f64 = 86_400.0;

/// Server of a live view.
#[derive(Args, Clone, Debug, Default)]
pub struct ServeOptions {
    /// Show force, orbit, flags and impacts in browsers while the estimator runs, at the bench's
    /// own pace. The address is printed; without a value it is 127.0.0.1:8750, and port 0 is any
    /// free port. Other machines need a token.
    #[arg(long, value_name = "[IP:]PORT", num_args = 0..=1, default_missing_value = DEFAULT_ADDRESS,
        value_parser = parse_address)]
    pub serve: Option<SocketAddr>,
    /// Token that a page must state as `?token=`; at least 16 letters, digits, `-`, `.`, `_` or
    /// `~`. The variable HOST_SIM_SERVE_TOKEN has the same effect.
    #[arg(long, value_name = "TOKEN", requires = "serve")]
    pub serve_token: Option<String>,
    /// Seconds for which the server stays after the end of the run, and then until all connected
    /// pages have received everything; default: until control-C.
    #[arg(long, value_name = "SECONDS", requires = "serve", allow_negative_numbers = true)]
    pub serve_for: Option<f64>,
}

/// Checked options of a server.
#[derive(Clone, PartialEq, Eq)]
pub(super) struct Checked {
    pub(super) address: SocketAddr,
    pub(super) token: Option<String>,
    /// Time for which the server stays after the run; none: until the process is ended.
    pub(super) stay: Option<Duration>,
}

impl ServeOptions {
    /// Checks the options; `None` without a server.
    ///
    /// # Errors
    ///
    /// The token is missing or too simple, or the time is out of range.
    pub(super) fn check(&self) -> Result<Option<Checked>, CliError> {
        self.check_with(|| std::env::var(TOKEN_VARIABLE).ok())
    }

    fn check_with(&self, variable: impl FnOnce() -> Option<String>) -> Result<Option<Checked>, CliError> {
        let Some(address) = self.serve else { return Ok(None) };
        let token = self.serve_token.clone().or_else(variable);
        match &token {
            Some(token) => check_token(token)?,
            None if address.ip().is_loopback() => {}
            None => {
                return Err(CliError::Input(format!(
                    "--serve: found {address} without a token; expected --serve-token or the variable \
                     {TOKEN_VARIABLE}, or an address of this machine alone, such as {DEFAULT_ADDRESS}"
                )));
            }
        }
        let stay = match self.serve_for {
            None => None,
            Some(stay_s) if (0.0..=MAX_STAY_S).contains(&stay_s) => Some(Duration::from_secs_f64(stay_s)),
            Some(stay_s) => {
                let text = format!("--serve-for: found {stay_s}; expected 0 to {MAX_STAY_S}");
                return Err(CliError::Input(text));
            }
        };
        Ok(Some(Checked { address, token, stay }))
    }
}

/// Refuses a token that is short or needs escapes in an address. The message does not contain it.
fn check_token(token: &str) -> Result<(), CliError> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-._~".contains(c);
    let found = if !TOKEN_LENGTHS.contains(&token.len()) {
        format!("a token of {} characters", token.len())
    } else if !token.chars().all(is_plain) {
        "another character in the token".into()
    } else {
        return Ok(());
    };
    let (min, max) = (TOKEN_LENGTHS.start(), TOKEN_LENGTHS.end());
    Err(CliError::Input(format!(
        "--serve-token: found {found}; expected {min} to {max} letters, digits, `-`, `.`, `_` or `~`"
    )))
}

/// Reads an address; a port alone is one of this machine.
fn parse_address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = text.parse() {
        return Ok(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
    }
    let named = text.strip_prefix("localhost:").map(|port| format!("{}:{port}", Ipv4Addr::LOCALHOST));
    let address = named.as_deref().unwrap_or(text).parse();
    address.map_err(|_| format!("expected a port or IP:PORT, such as {DEFAULT_ADDRESS}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN: &str = "0123456789abcdef";

    fn checked(address: &str, token: Option<&str>, stay_s: Option<f64>) -> Result<Option<Checked>, String> {
        let options = ServeOptions {
            serve: Some(parse_address(address).unwrap()),
            serve_token: token.map(str::to_owned),
            serve_for: stay_s,
        };
        options.check_with(|| None).map_err(|error| error.to_string())
    }

    fn refusal(address: &str, token: Option<&str>, stay_s: Option<f64>) -> String {
        checked(address, token, stay_s).err().unwrap()
    }

    #[test]
    fn an_address_is_a_port_or_an_ip_with_a_port() {
        let local = |port| SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port);
        for (text, expected) in [
            ("8080", local(8080)),
            ("0", local(0)),
            ("localhost:1", local(1)),
            (DEFAULT_ADDRESS, local(8750)),
            ("[::1]:9", "[::1]:9".parse().unwrap()),
        ] {
            assert_eq!(parse_address(text).unwrap(), expected);
        }
        for text in ["", "70000", "host:1", "127.0.0.1", "::1", "localhost"] {
            assert!(parse_address(text).unwrap_err().contains("127.0.0.1:8750"), "{text}");
        }
    }

    #[test]
    fn an_address_that_other_machines_reach_needs_a_token() {
        for address in ["0.0.0.0:1", "192.168.0.2:1", "[::]:1", "[::ffff:127.0.0.1]:1"] {
            assert!(refusal(address, None, None).contains("without a token"), "{address}");
            assert!(checked(address, Some(TOKEN), None).is_ok());
        }
        for address in ["127.0.0.1:1", "127.9.9.9:1", "[::1]:1"] {
            assert!(checked(address, None, None).is_ok(), "{address}");
        }
    }

    #[test]
    fn a_simple_token_is_refused_and_not_repeated() {
        let message = refusal("1", Some("0123456789abcde"), None);
        assert!(message.contains("15 characters") && !message.contains("abcde"), "{message}");
        assert!(refusal("1", Some(&"a".repeat(257)), None).contains("257 characters"));
        let message = refusal("1", Some("0123456789abcde&"), None);
        assert!(message.contains("another character") && !message.contains("abcde"), "{message}");
        assert_eq!(checked("1", Some("AZaz09-._~AZaz09"), None).unwrap().unwrap().stay, None);
    }

    #[test]
    fn the_variable_replaces_a_token_that_is_not_given_and_needs_a_server() {
        let options = |serve: Option<&str>, token: Option<&str>| ServeOptions {
            serve: serve.map(|text| parse_address(text).unwrap()),
            serve_token: token.map(str::to_owned),
            serve_for: None,
        };
        let variable = || Some("from-the-variable".to_owned());
        let token = |options: ServeOptions| options.check_with(variable).ok().unwrap().unwrap().token;
        assert_eq!(token(options(Some("0.0.0.0:1"), None)).as_deref(), Some("from-the-variable"));
        assert_eq!(token(options(Some("1"), Some(TOKEN))).as_deref(), Some(TOKEN));
        assert!(options(None, None).check_with(|| Some("short".into())).ok().unwrap().is_none());
        assert!(options(Some("1"), None).check_with(|| Some("short".into())).is_err());
    }

    #[test]
    fn the_time_after_the_run_is_bounded() {
        let stay = |stay_s| checked("1", None, Some(stay_s)).map(|checked| checked.unwrap().stay);
        assert_eq!(stay(1.5), Ok(Some(Duration::from_millis(1500))));
        assert_eq!(stay(0.0), Ok(Some(Duration::ZERO)));
        for stay_s in [-1.0, 86_401.0, f64::NAN] {
            assert!(stay(stay_s).unwrap_err().contains("expected 0 to 86400"));
        }
    }
}
