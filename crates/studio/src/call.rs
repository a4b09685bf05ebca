//! Calls of the page.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use vtex_base::Progress;

/// What a call wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    /// To know something.
    Get,
    /// To change something.
    Post,
}

/// Who made a call, and whether anybody still waits for the answer. As a [`Progress`] it stops work that nobody
/// waits for.
#[derive(Clone, Debug, Default)]
pub struct Caller(Arc<AtomicBool>);

impl Caller {
    /// Whether the connection has ended before the answer.
    pub fn has_left(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// The caller has left once the returned value is dropped.
    pub(crate) fn waiting(&self) -> Waiting {
        Waiting(self.clone())
    }
}

impl Progress for Caller {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        !self.has_left()
    }
}

/// A connection that waits for an answer.
pub(crate) struct Waiting(Caller);

impl Drop for Waiting {
    fn drop(&mut self) {
        self.0.0.store(true, Ordering::Relaxed);
    }
}

/// A call that the guard has let in.
#[derive(Clone, Debug)]
pub struct StudioCall {
    /// What it wants.
    pub verb: Verb,
    /// Its name: the path below `api/`.
    pub name: String,
    /// Its parameters, decoded.
    pub query: Vec<(String, String)>,
    /// Its content.
    pub body: Vec<u8>,
    /// Who made it.
    pub caller: Caller,
}

impl StudioCall {
    /// A parameter, if it was given.
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.query.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

/// The parameters after the `?` of an address; `None` if they are not valid UTF-8.
pub(crate) fn parameters(query: &str) -> Option<Vec<(String, String)>> {
    let pairs = query.split('&').filter(|pair| !pair.is_empty());
    let pair = |pair: &str| {
        let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
        Some((decoded(name)?, decoded(value)?))
    };
    pairs.map(pair).collect()
}

/// Text with `%xx` decoded; `None` if the result is no UTF-8.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let hex = |digits: &[u8]| u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok();
        let byte =
            if *first == b'%' && after.len() >= 2 && after[0] != b'+' { hex(&after[..2]) } else { None };
        match byte {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_decoded() {
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        assert_eq!(
            parameters("name=a%20b%2Fc&scale=2&&x").unwrap(),
            [pair("name", "a b/c"), pair("scale", "2"), pair("x", "")]
        );
        assert_eq!(parameters("name=100%&y=%+1%4").unwrap(), [pair("name", "100%"), pair("y", "%+1%4")]);
        assert_eq!(parameters("name=%ff"), None);
    }
}
