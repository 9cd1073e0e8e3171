//! Responses of the server: heads and refusals.

use std::io::{self, Write};

/// Headers of every response: nothing is stored, embedded elsewhere, or known to other sites.
const COMMON: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: \
                      no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n";

/// Reason for which a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The request cannot be read.
    NotHttp,
    /// The token is missing or wrong.
    Token,
    /// The name of the host is not one of this machine.
    Host,
    /// A page of another site asked for data.
    CrossSite,
    /// There is nothing at the path.
    Path,
    /// The method is not GET.
    Method,
    /// The request took too long.
    Timeout,
    /// The request has a body.
    Body,
    /// The head is too large.
    TooLarge,
    /// Too many connections are open, or the server is about to end.
    Busy,
}

impl Refusal {
    /// Returns the status and the text.
    const fn describe(self) -> (&'static str, &'static str) {
        match self {
            Self::NotHttp => ("400 Bad Request", "expected a request in HTTP/1.1 with one Host"),
            Self::Token => ("401 Unauthorized", "expected the token: add ?token=TOKEN to the address"),
            Self::Host => ("403 Forbidden", "found another host; expected localhost or a loopback address"),
            Self::CrossSite => ("403 Forbidden", "found a request of another site"),
            Self::Path => ("404 Not Found", "expected / or /events"),
            Self::Method => ("405 Method Not Allowed", "expected GET"),
            Self::Timeout => ("408 Request Timeout", "the request was not complete in time"),
            Self::Body => ("413 Content Too Large", "expected a request without a body"),
            Self::TooLarge => ("431 Request Header Fields Too Large", "the request is too large"),
            Self::Busy => ("503 Service Unavailable", "too many connections are open"),
        }
    }

    /// Writes the refusal as a response.
    pub(super) fn write(self, out: &mut impl Write) -> io::Result<()> {
        let (status, text) = self.describe();
        let more = match self {
            Self::Method => "Allow: GET\r\n",
            Self::Token => "WWW-Authenticate: Bearer\r\n",
            _ => "",
        };
        write_text(out, status, "text/plain; charset=utf-8", more, &format!("{text}\n"))
    }
}

/// Writes a page with its policy.
pub(super) fn write_page(out: &mut impl Write, html: &str, policy: &str) -> io::Result<()> {
    let more = format!("Content-Security-Policy: {policy}\r\n");
    write_text(out, "200 OK", "text/html; charset=utf-8", &more, html)
}

fn write_text(out: &mut impl Write, status: &str, kind: &str, more: &str, text: &str) -> io::Result<()> {
    let length = text.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{COMMON}{more}\r\n"
    );
    out.write_all(head.as_bytes())?;
    out.write_all(text.as_bytes())
}

/// Writes the head of a stream of events.
pub(super) fn write_stream_head(out: &mut impl Write) -> io::Result<()> {
    out.write_all(
        format!("HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n{COMMON}\r\nretry: 1000\n\n")
            .as_bytes(),
    )
}
