//! Access to the server: the host's name and the token.
//!
//! A page of another site can let its own name lead to a loopback address (DNS rebinding). Its
//! requests have that name as Host, so a server on a loopback address accepts only names of the
//! machine itself. The token of a server on another address protects against this as well.

use super::request::Request;
use super::response::Refusal;
use sha2::{Digest, Sha256};
use std::net::IpAddr;
use subtle::ConstantTimeEq;

/// Conditions that a request must meet.
#[derive(Debug)]
pub(super) struct Access {
    is_loopback: bool,
    /// SHA-256 of the token: values of equal length, compared in constant time.
    token: Option<[u8; 32]>,
}

impl Access {
    /// Creates the conditions for a server on an address.
    pub(super) fn new(address: IpAddr, token: Option<&str>) -> Self {
        Self { is_loopback: address.is_loopback(), token: token.map(|token| Sha256::digest(token).into()) }
    }

    /// Checks a request.
    ///
    /// # Errors
    ///
    /// Method, host, site or token are not permitted.
    pub(super) fn check(&self, request: &Request) -> Result<(), Refusal> {
        if request.method != "GET" {
            return Err(Refusal::Method);
        }
        if self.is_loopback && !is_own_name(&request.host) {
            return Err(Refusal::Host);
        }
        if let Some(token) = &self.token {
            let found: [u8; 32] = Sha256::digest(request.token.as_deref().unwrap_or_default()).into();
            if !bool::from(found.ct_eq(token)) {
                return Err(Refusal::Token);
            }
        }
        // Links from other sites to the page are harmless; streams of events for them are not.
        if request.is_cross_site && request.path != "/" { Err(Refusal::CrossSite) } else { Ok(()) }
    }
}

/// Returns true for `localhost` and loopback addresses, with any port: it may be forwarded.
fn is_own_name(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => match rest.split_once(']') {
            Some((name, port)) if port.is_empty() || port.starts_with(':') => name,
            _ => return false,
        },
        None => host.split_once(':').map_or(host, |(name, _)| name),
    };
    name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn get(host: &str, token: Option<&str>) -> Request {
        Request {
            method: "GET".into(),
            path: "/events".into(),
            host: host.into(),
            token: token.map(str::to_owned),
            ..Request::default()
        }
    }

    const LOCAL: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);
    const ANY: IpAddr = IpAddr::V4(std::net::Ipv4Addr::UNSPECIFIED);

    #[test]
    fn a_loopback_server_accepts_only_names_of_this_machine() {
        let access = Access::new(LOCAL, None);
        for host in ["localhost", "LocalHost:80", "127.0.0.1:8750", "127.0.0.2", "[::1]", "[::1]:9"] {
            assert_eq!(access.check(&get(host, None)), Ok(()), "{host}");
        }
        for host in [
            "",
            "evil.example",
            "localhost.evil.example",
            "127.0.0.1.evil.example:80",
            "10.0.0.1",
            "[::1]x",
            "[::1",
        ] {
            assert_eq!(access.check(&get(host, None)), Err(Refusal::Host), "{host}");
            let secured = Access::new(LOCAL, Some("0123456789abcdef"));
            assert_eq!(secured.check(&get(host, Some("0123456789abcdef"))), Err(Refusal::Host), "{host}");
        }
        assert_eq!(Access::new(ANY, None).check(&get("bench-pc:8750", None)), Ok(()));
    }

    #[test]
    fn the_token_must_be_the_same() {
        for address in [LOCAL, ANY] {
            let access = Access::new(address, Some("0123456789abcdef"));
            let check = |token| access.check(&get("localhost", token));
            assert_eq!(check(Some("0123456789abcdef")), Ok(()));
            for token in [None, Some(""), Some("0123456789abcdee"), Some("0123456789abcdef0")] {
                assert_eq!(check(token), Err(Refusal::Token), "{token:?}");
            }
        }
    }

    #[test]
    fn other_methods_and_requests_of_other_sites_are_refused() {
        let access = Access::new(LOCAL, None);
        let request = get("localhost", None);
        for method in ["POST", "HEAD", "get", ""] {
            let request = Request { method: method.into(), ..request.clone() };
            assert_eq!(access.check(&request), Err(Refusal::Method), "{method}");
        }
        let foreign = Request { is_cross_site: true, ..request };
        assert_eq!(access.check(&foreign), Err(Refusal::CrossSite));
        assert_eq!(access.check(&Request { path: "/".into(), ..foreign }), Ok(()));
    }
}
