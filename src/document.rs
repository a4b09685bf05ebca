//! Versioned JSON documents, plain or gzip: what libraries and scenes share.

use crate::error::{Error, Result, clip};
use crate::gzip;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::Path;

/// A JSON document with a format name, a version and invariants.
pub(crate) trait Document: Serialize + DeserializeOwned {
    /// Value of the field `format`.
    const FORMAT: &'static str;
    /// Value of the field `version`.
    const VERSION: u32;

    /// Reads a document of an older version and brings it up to date; `None` for a version that is not
    /// known.
    fn read_older(_version: u64, _json: &[u8]) -> Option<serde_json::Result<Self>> {
        None
    }

    /// Checks what the types cannot say.
    ///
    /// # Errors
    /// The first invariant broken, in words.
    fn validate(&self) -> std::result::Result<(), String>;
}

/// Reads and validates a document from a file.
pub(crate) fn read<T: Document>(path: &Path) -> Result<T> {
    let bytes = std::fs::read(path).map_err(|e| Error::read(path, e))?;
    from_bytes(bytes, &path.display().to_string())
}

/// Reads and validates a document from bytes, plain or gzip.
pub(crate) fn from_bytes<'a, T: Document>(bytes: impl Into<Cow<'a, [u8]>>, name: &str) -> Result<T> {
    let fail = |reason: String| Error::Format { name: name.into(), format: T::FORMAT, reason };
    let json = unpacked(bytes.into()).map_err(fail)?;
    // Name and version first, so that another format is told apart from a damaged file.
    #[derive(Deserialize)]
    struct Header {
        format: Option<String>,
        version: Option<u64>,
        sha256: Option<IgnoredAny>,
    }
    let header: Header = serde_json::from_slice(&json).map_err(|e| fail(e.to_string()))?;
    match header.format.as_deref() {
        Some(f) if f == T::FORMAT => {}
        Some(f) => return Err(fail(format!("its format is '{}'", clip(f)))),
        None => return Err(fail("it has no field 'format'".into())),
    }
    let Some(version) = header.version else { return Err(fail("it has no field 'version'".into())) };
    let json = if header.sha256.is_some() { without_seal(json) } else { json };
    let known = u64::from(T::VERSION);
    let read =
        if version == known { Some(serde_json::from_slice(&json)) } else { T::read_older(version, &json) };
    let Some(read) = read else {
        return Err(Error::Version { name: name.into(), format: T::FORMAT, found: version, known });
    };
    let document: T = read.map_err(|e| fail(e.to_string()))?;
    document.validate().map_err(fail)?;
    Ok(document)
}

fn unpacked(bytes: Cow<'_, [u8]>) -> std::result::Result<Cow<'_, [u8]>, String> {
    if !gzip::is_packed(&bytes) {
        return Ok(bytes);
    }
    Ok(gzip::unpack(&bytes, u64::MAX)?.into_owned().into())
}

/// A document without the seal that files of vtex have as their last field, `sha256`. Where another
/// program has ordered the fields anew it may stand anywhere.
fn without_seal(json: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    const DIGITS: usize = 64;
    let last = || {
        let rest = json.trim_ascii_end().strip_suffix(b"}")?.trim_ascii_end().strip_suffix(b"\"")?;
        let (rest, sum) = rest.split_at_checked(rest.len().checked_sub(DIGITS)?)?;
        let rest = rest.strip_suffix(b"\"")?.trim_ascii_end().strip_suffix(b":")?.trim_ascii_end();
        let rest = rest.strip_suffix(b"\"sha256\"")?.trim_ascii_end().strip_suffix(b",")?;
        sum.iter().all(u8::is_ascii_hexdigit).then_some(rest.len())
    };
    let anywhere = || {
        let mut fields: serde_json::Map<String, serde_json::Value> = serde_json::from_slice(&json).ok()?;
        fields.remove("sha256")?;
        serde_json::to_vec(&fields).ok()
    };
    if let Some(end) = last() {
        let mut rest = json.into_owned();
        rest.truncate(end);
        rest.push(b'}');
        return rest.into();
    }
    anywhere().map_or(json, Into::into)
}

/// The document as JSON, ending in a newline.
pub(crate) fn to_json<T: Document>(document: &T) -> Vec<u8> {
    let mut bytes = serde_json::to_vec(document).expect("documents hold nothing that JSON cannot");
    bytes.push(b'\n');
    bytes
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_seal_is_left_out_wherever_it_stands() {
        let sum = "0a".repeat(32);
        let plain = r#"{"format":"x","a":{"sha256":"y"}}"#;
        let without_seal = |text: &str| super::without_seal(text.as_bytes().to_vec().into()).into_owned();
        assert_eq!(without_seal(plain), plain.as_bytes());
        let sealed = format!("{},\"sha256\":\"{sum}\"}}\n", &plain[..plain.len() - 1]);
        assert_eq!(without_seal(&sealed), plain.as_bytes());
        let spread = sealed.replace(",\"sha256\":\"0", ",\n  \"sha256\": \"0").replace("}\n", "\n}\n\n");
        assert_eq!(without_seal(&spread), plain.as_bytes());
        let moved = format!("{{\"sha256\":\"{sum}\",\"format\":7,\"z\":[1.5]}}");
        assert_eq!(without_seal(&moved), br#"{"format":7,"z":[1.5]}"#);
        for other in ["", "}", "\"}", "[1]", "{\"sha256\":1", &sum] {
            assert_eq!(without_seal(other), other.as_bytes());
        }
    }
}
