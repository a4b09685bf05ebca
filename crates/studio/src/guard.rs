//! Who may speak to the server: the page that it served, and nobody else.
//!
//! Another page in the same browser cannot read the token, which is 128 random bits in the address. It could
//! make the browser send requests here; those have its own `Origin`, or, after DNS rebinding, its own `Host`.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long the address that is handed to the browser can be opened.
const TICKET_LIFE: Duration = Duration::from_secs(60);

/// The parts of a request that the guard looks at.
#[derive(Clone, Copy, Debug, Default)]
pub struct RequestHead<'a> {
    /// Path of the address, undecoded.
    pub path: &'a str,
    /// Whether it may change something.
    pub changes: bool,
    /// Values of the header `Host`.
    pub host: Option<&'a str>,
    /// Value of the header `Origin`.
    pub origin: Option<&'a str>,
    /// Value of the header `Sec-Fetch-Site`.
    pub site: Option<&'a str>,
}

/// The guard's decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It may come in; the path below the token.
    Welcome(String),
    /// The browser is sent on to the page.
    SentOn(String),
    /// It is refused with a status of HTTP.
    Refused(u16),
}

/// Checks requests.
#[derive(Debug)]
pub struct Guard {
    token: String,
    port: u16,
    ticket: String,
    ticket_used: AtomicBool,
    began: Instant,
}

/// Random text that an address can hold, of 128 bits.
fn random() -> std::io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|e| std::io::Error::other(e.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Compares in a time that does not depend on where texts differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differences, (x, y)| differences | (x ^ y)) == 0
}

impl Guard {
    /// A guard of a server on a port, with a new token.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn new(port: u16) -> std::io::Result<Self> {
        let (token, ticket) = (random()?, random()?);
        Ok(Self { token, port, ticket, ticket_used: AtomicBool::new(false), began: Instant::now() })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// An address that leads to the page once, within a minute. Programs that other people start can see the
    /// arguments of a browser, so the token does not stand there.
    pub fn ticket_address(&self) -> String {
        format!("http://127.0.0.1:{}/open/{}", self.port, self.ticket)
    }

    /// Decides on a request.
    pub fn check(&self, head: &RequestHead<'_>) -> Verdict {
        let port = self.port;
        let ours = |host: &str| host == format!("127.0.0.1:{port}") || host == format!("localhost:{port}");
        if !head.host.is_some_and(ours) {
            return Verdict::Refused(403);
        }
        let same_origin = |origin: &str| origin.strip_prefix("http://").is_some_and(ours);
        match head.origin {
            Some(origin) if !same_origin(origin) => return Verdict::Refused(403),
            None if head.changes => return Verdict::Refused(403),
            _ => {}
        }
        if head.site.is_some_and(|site| site != "same-origin" && site != "none") {
            return Verdict::Refused(403);
        }
        let path = head.path.strip_prefix('/').unwrap_or_default();
        if let Some(ticket) = path.strip_prefix("open/") {
            let valid = same(ticket, &self.ticket) && self.began.elapsed() < TICKET_LIFE && !head.changes;
            // A second use is refused, so a ticket that was taken is noticed.
            if valid && !self.ticket_used.swap(true, Ordering::SeqCst) {
                return Verdict::SentOn(format!("/{}/", self.token));
            }
            return Verdict::Refused(404);
        }
        match path.split_once('/') {
            Some((token, below)) if same(token, &self.token) => Verdict::Welcome(below.to_owned()),
            _ => Verdict::Refused(404),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head<'a>(guard: &Guard, path: &'a str) -> RequestHead<'a> {
        assert_eq!(guard.port, 80);
        RequestHead { path, host: Some("127.0.0.1:80"), ..RequestHead::default() }
    }

    #[test]
    fn only_the_page_comes_in() {
        let guard = Guard::new(80).unwrap();
        let path = format!("/{}/api/state", guard.token);
        let good = head(&guard, &path);
        assert_eq!(guard.check(&good), Verdict::Welcome("api/state".into()));
        let origin = Some("http://localhost:80");
        let from_page = RequestHead {
            changes: true,
            origin,
            host: Some("localhost:80"),
            site: Some("same-origin"),
            ..good
        };
        assert_eq!(guard.check(&from_page), Verdict::Welcome("api/state".into()));
        for host in [None, Some(""), Some("127.0.0.1"), Some("evil.example:80"), Some("127.0.0.1:81")] {
            assert_eq!(guard.check(&RequestHead { host, ..from_page }), Verdict::Refused(403), "{host:?}");
        }
        for origin in [None, Some("null"), Some("http://evil.example"), Some("https://localhost:80")] {
            assert_eq!(
                guard.check(&RequestHead { origin, ..from_page }),
                Verdict::Refused(403),
                "{origin:?}"
            );
        }
        for site in ["cross-site", "same-site", ""] {
            let site = Some(site);
            assert_eq!(guard.check(&RequestHead { site, ..good }), Verdict::Refused(403), "{site:?}");
        }
        let wrong = "0".repeat(32);
        let wrong =
            [format!("/{wrong}/"), "/".into(), "//".into(), format!("/{}", guard.token), String::new()];
        for path in &wrong {
            assert_eq!(guard.check(&RequestHead { path, ..good }), Verdict::Refused(404), "{path}");
        }
    }

    #[test]
    fn a_ticket_opens_once() {
        let guard = Guard::new(80).unwrap();
        let path = format!("/open/{}", guard.ticket);
        let posted =
            RequestHead { changes: true, origin: Some("http://127.0.0.1:80"), ..head(&guard, &path) };
        assert_eq!(guard.check(&posted), Verdict::Refused(404));
        assert_eq!(guard.check(&head(&guard, &path)), Verdict::SentOn(format!("/{}/", guard.token)));
        assert_eq!(guard.check(&head(&guard, &path)), Verdict::Refused(404));
        assert_ne!(guard.token, Guard::new(80).unwrap().token);
    }
}
