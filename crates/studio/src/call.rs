//! Calls of the page.

/// What a call wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    /// To know something.
    Get,
    /// To change something.
    Post,
}

/// A call that the guard has let in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudioCall {
    /// What it wants.
    pub verb: Verb,
    /// Its name: the path below `api/`.
    pub name: String,
    /// Its parameters, decoded.
    pub query: Vec<(String, String)>,
    /// Its content.
    pub body: Vec<u8>,
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
