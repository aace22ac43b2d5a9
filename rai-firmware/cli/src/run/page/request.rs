//! A request for the page, parsed by `httparse`, and its answer.

use super::text::Html;

/// Most bytes of a request; browsers send less than 1 KiB.
pub(super) const REQUEST_BYTES: usize = 8192;
const HEADERS: usize = 64;

/// What a complete request asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    Page,
    Events,
    State,
    Metrics,
    Health,
}

/// A request so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Request {
    /// More bytes must come.
    Partial,
    /// A request; with `true` only its head is wanted.
    Whole(Asked, bool),
    /// It is refused, with this status.
    Refused(&'static str),
}

/// Reads a request. `is_local` is true for a server that only programs of this computer reach: it
/// then answers only under a name of this computer, so that no page of another server can read it
/// through a name of its own.
pub(super) fn read(bytes: &[u8], is_local: bool) -> Request {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(bytes) {
        Ok(httparse::Status::Complete(_)) => {}
        Ok(httparse::Status::Partial) if bytes.len() < REQUEST_BYTES => return Request::Partial,
        Ok(httparse::Status::Partial) => return Request::Refused("431 Request Header Fields Too Large"),
        Err(_) => return Request::Refused("400 Bad Request"),
    }
    let is_head = request.method == Some("HEAD");
    if !is_head && request.method != Some("GET") {
        return Request::Refused("405 Method Not Allowed");
    }
    let host = request.headers.iter().find(|header| header.name.eq_ignore_ascii_case("host"));
    let host = host.and_then(|header| std::str::from_utf8(header.value).ok()).unwrap_or_default();
    if is_local && !is_own_name(host) {
        return Request::Refused("403 Forbidden");
    }
    let path = request.path.unwrap_or_default();
    match path.split('?').next().unwrap_or_default() {
        "/" => Request::Whole(Asked::Page, is_head),
        "/events" => Request::Whole(Asked::Events, is_head),
        "/state.json" => Request::Whole(Asked::State, is_head),
        "/metrics" => Request::Whole(Asked::Metrics, is_head),
        "/healthz" => Request::Whole(Asked::Health, is_head),
        _ => Request::Refused("404 Not Found"),
    }
}

/// Returns true for a name or an address that is this computer's own.
fn is_own_name(host: &str) -> bool {
    let without_port = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next(),
        None => host.split(':').next(),
    };
    let name = without_port.unwrap_or_default();
    name.eq_ignore_ascii_case("localhost")
        || name.parse::<std::net::IpAddr>().is_ok_and(|address| address.is_loopback())
}

/// Returns an answer with a body.
pub(super) fn answer(status: &str, kind: &str, body: &str, html: &Html, is_head: bool) -> Vec<u8> {
    let head = format!("{}Content-Length: {}\r\n\r\n", head(status, kind, html), body.len());
    [head.as_str(), if is_head { "" } else { body }].concat().into_bytes()
}

/// Returns the beginning of an answer, to which its last headers and an empty line belong. No
/// answer is kept, and none is part of another page.
pub(super) fn head(status: &str, kind: &str, html: &Html) -> String {
    let allow = if status.starts_with("405") { "Allow: GET, HEAD\r\n" } else { "" };
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Security-Policy: {}\r\nX-Content-Type-Options: nosniff\r\n\
         Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\nCache-Control: no-store\r\n\
         Connection: close\r\n{allow}",
        html.policy
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(line: &str, host: &str, is_local: bool) -> Request {
        read(format!("{line} HTTP/1.1\r\nHost: {host}\r\n\r\n").as_bytes(), is_local)
    }

    #[test]
    fn requests_are_read_or_refused() {
        let local = |line: &str| asked(line, "localhost:8080", true);
        assert_eq!(local("GET /"), Request::Whole(Asked::Page, false));
        assert_eq!(local("HEAD /metrics?x=1"), Request::Whole(Asked::Metrics, true));
        assert_eq!(local("GET /../etc/passwd"), Request::Refused("404 Not Found"));
        assert_eq!(local("POST /state.json"), Request::Refused("405 Method Not Allowed"));
        assert_eq!(read(b"GET / HTTP/1.1\r\nHost: x", true), Request::Partial);
        assert_eq!(read(b"\x16\x03\x01\x02", true), Request::Refused("400 Bad Request"));
        let long = format!("GET / HTTP/1.1\r\nCookie: {}", "x".repeat(REQUEST_BYTES));
        assert_eq!(read(long.as_bytes(), true), Request::Refused("431 Request Header Fields Too Large"));
    }

    #[test]
    fn local_page_answers_only_under_its_own_name() {
        for host in ["127.0.0.1:8080", "localhost", "[::1]:8080", "LOCALHOST:1"] {
            assert_eq!(asked("GET /", host, true), Request::Whole(Asked::Page, false), "{host}");
        }
        for host in ["evil.example:8080", "127.0.0.1.evil.example", "192.168.1.2", ""] {
            assert_eq!(asked("GET /", host, true), Request::Refused("403 Forbidden"), "{host}");
            assert_eq!(asked("GET /", host, false), Request::Whole(Asked::Page, false), "{host}");
        }
    }
}
