//! Request of a browser: its head, within limits of size and time.

use super::response::Refusal;
use std::io::{ErrorKind, Read};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Maximum number of bytes of a request's head. A request has no body.
const MAX_HEAD_BYTES: usize = 8192;
/// Maximum number of headers; browsers send about 20.
const MAX_HEADERS: usize = 64;
/// Timeout of the head of a request.
const HEAD_TIMEOUT: Duration = Duration::from_secs(5);

/// Request, as far as the server needs it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: String,
    /// Path without the query.
    pub(super) path: String,
    pub(super) host: String,
    /// Token of the header `Authorization`, else of the query.
    pub(super) token: Option<String>,
    pub(super) last_event_id: Option<String>,
    /// True if a page of another site caused the request.
    pub(super) is_cross_site: bool,
}

/// Reads a request.
///
/// # Errors
///
/// The request is no HTTP, too large, or not complete in time; none if the connection was closed.
pub(super) fn read(stream: &mut TcpStream) -> Result<Request, Option<Refusal>> {
    let deadline = Instant::now() + HEAD_TIMEOUT;
    let mut head = Vec::new();
    let mut part = [0; 1024];
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(Some(Refusal::Timeout));
        }
        stream.set_read_timeout(Some(left)).map_err(|_| None)?;
        match stream.read(&mut part) {
            Ok(0) => return Err(None),
            Ok(count) => head.extend_from_slice(part.get(..count).unwrap_or_default()),
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => continue,
            Err(_) => return Err(None),
        }
        if let Some(request) = parse(&head).map_err(Some)? {
            return Ok(request);
        }
    }
}

/// Parses a head; `None` if it is not complete.
fn parse(head: &[u8]) -> Result<Option<Request>, Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    match parsed.parse(head) {
        Ok(httparse::Status::Complete(length)) if length <= MAX_HEAD_BYTES => {}
        Ok(httparse::Status::Partial) if head.len() <= MAX_HEAD_BYTES => return Ok(None),
        Ok(_) | Err(httparse::Error::TooManyHeaders) => return Err(Refusal::TooLarge),
        Err(_) => return Err(Refusal::NotHttp),
    }
    let target = parsed.path.filter(|path| path.starts_with('/')).ok_or(Refusal::NotHttp)?;
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let mut request = Request {
        method: parsed.method.unwrap_or_default().into(),
        path: path.into(),
        token: query.split('&').find_map(|pair| pair.strip_prefix("token=")).map(str::to_owned),
        ..Request::default()
    };
    let mut hosts = 0;
    for header in parsed.headers.iter() {
        let value = core::str::from_utf8(header.value).map_err(|_| Refusal::NotHttp)?.trim();
        match header.name.to_ascii_lowercase().as_str() {
            "host" => (request.host, hosts) = (value.into(), hosts + 1),
            "authorization" => {
                request.token = value.strip_prefix("Bearer ").map(str::to_owned).or(request.token);
            }
            "last-event-id" => request.last_event_id = Some(value.into()),
            "sec-fetch-site" => request.is_cross_site = value == "cross-site",
            "content-length" if value != "0" => return Err(Refusal::Body),
            "transfer-encoding" => return Err(Refusal::Body),
            _ => {}
        }
    }
    if hosts == 1 { Ok(Some(request)) } else { Err(Refusal::NotHttp) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parsed(head: &str) -> Result<Option<Request>, Refusal> {
        parse(head.as_bytes())
    }

    fn complete(head: &str) -> Request {
        parsed(head).unwrap().unwrap()
    }

    #[test]
    fn a_request_is_complete_after_its_empty_line() {
        let head = "GET /events?x=1&token=abc HTTP/1.1\r\nHost: a:1\r\nLast-Event-ID: r-5\r\n\
                    Sec-Fetch-Site: cross-site\r\n\r\n";
        for end in 0..head.len() {
            assert_eq!(parsed(&head[..end]), Ok(None), "{end}");
        }
        let expected = Request {
            method: "GET".into(),
            path: "/events".into(),
            host: "a:1".into(),
            token: Some("abc".into()),
            last_event_id: Some("r-5".into()),
            is_cross_site: true,
        };
        assert_eq!(complete(head), expected);
        assert!(!complete("GET / HTTP/1.1\r\nHost: a\r\nSec-Fetch-Site: none\r\n\r\n").is_cross_site);
    }

    #[test]
    fn the_header_with_a_token_precedes_the_query() {
        let token = |query: &str, header: &str| {
            complete(&format!("GET /{query} HTTP/1.1\r\nHost: a\r\n{header}\r\n")).token
        };
        assert_eq!(token("", ""), None);
        assert_eq!(token("?token=q", "Authorization: Bearer h\r\n").as_deref(), Some("h"));
        assert_eq!(token("?token=q", "Authorization: Basic h\r\n").as_deref(), Some("q"));
        assert_eq!(token("?mytoken=q", ""), None);
    }

    #[test]
    fn anything_else_is_refused() {
        for (head, expected) in [
            ("nonsense\r\n\r\n", Refusal::NotHttp),
            ("GET / HTTP/1.1\r\n\r\n", Refusal::NotHttp),
            ("GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", Refusal::NotHttp),
            ("GET http://a/ HTTP/1.1\r\nHost: a\r\n\r\n", Refusal::NotHttp),
            ("GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 3\r\n\r\nabc", Refusal::Body),
            ("GET / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n", Refusal::Body),
        ] {
            assert_eq!(parsed(head), Err(expected), "{head}");
        }
        assert!(complete("GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n").host == "a");
    }

    #[test]
    fn a_head_has_at_most_8192_bytes_and_64_headers() {
        let of = |padding: usize| format!("GET / HTTP/1.1\r\nHost: a\r\nX: {}\r\n\r\n", "x".repeat(padding));
        let fixed = of(0).len();
        assert!(parsed(&of(MAX_HEAD_BYTES - fixed)).unwrap().is_some());
        assert_eq!(parsed(&of(MAX_HEAD_BYTES - fixed + 1)), Err(Refusal::TooLarge));
        assert_eq!(parsed(&"GET /".repeat(2000)[..MAX_HEAD_BYTES + 1]), Err(Refusal::NotHttp));
        let open = format!("GET /{}", "x".repeat(MAX_HEAD_BYTES));
        assert_eq!(parsed(&open), Err(Refusal::TooLarge));
        assert_eq!(parsed(&open[..MAX_HEAD_BYTES]), Ok(None));
        let many = |count: usize| format!("GET / HTTP/1.1\r\nHost: a\r\n{}\r\n", "X: y\r\n".repeat(count));
        assert!(parsed(&many(MAX_HEADERS - 1)).unwrap().is_some());
        assert_eq!(parsed(&many(MAX_HEADERS)), Err(Refusal::TooLarge));
    }

    proptest! {
        #[test]
        fn no_bytes_cause_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse(&bytes);
            let _ = parse(&[b"GET /? HTTP/1.1\r\nHost: ", bytes.as_slice(), b"\r\n\r\n"].concat());
        }
    }
}
