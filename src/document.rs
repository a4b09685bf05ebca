//! Versioned JSON documents, plain or gzip: what libraries and scenes share.

use crate::error::{Error, Result, clip};
use crate::gzip;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
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
    from_bytes(&bytes, &path.display().to_string())
}

/// Reads and validates a document from bytes, plain or gzip.
pub(crate) fn from_bytes<T: Document>(bytes: &[u8], name: &str) -> Result<T> {
    let fail = |reason: String| Error::Format { name: name.into(), format: T::FORMAT, reason };
    let json = &*gzip::unpack(bytes, u64::MAX).map_err(fail)?;
    // Name and version first, so that another format is told apart from a damaged file.
    #[derive(Deserialize)]
    struct Header {
        format: Option<String>,
        version: Option<u64>,
    }
    let header: Header = serde_json::from_slice(json).map_err(|e| fail(e.to_string()))?;
    match header.format.as_deref() {
        Some(f) if f == T::FORMAT => {}
        Some(f) => return Err(fail(format!("its format is '{}'", clip(f)))),
        None => return Err(fail("it has no field 'format'".into())),
    }
    let Some(version) = header.version else { return Err(fail("it has no field 'version'".into())) };
    let known = u64::from(T::VERSION);
    let read =
        if version == known { Some(serde_json::from_slice(json)) } else { T::read_older(version, json) };
    let Some(read) = read else {
        return Err(Error::Version { name: name.into(), format: T::FORMAT, found: version, known });
    };
    let document: T = read.map_err(|e| fail(e.to_string()))?;
    document.validate().map_err(fail)?;
    Ok(document)
}

/// The document as JSON, ending in a newline.
pub(crate) fn to_json<T: Document>(document: &T) -> Vec<u8> {
    let mut bytes = serde_json::to_vec(document).expect("documents hold nothing that JSON cannot");
    bytes.push(b'\n');
    bytes
}
