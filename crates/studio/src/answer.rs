//! Answers to calls.

use serde::Serialize;

/// The kind of an answer's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// JSON.
    Json,
    /// A PNG.
    Png,
    /// Bytes to be saved as a file.
    Download,
}

impl Content {
    /// The media type.
    pub(crate) fn media_type(self) -> &'static str {
        match self {
            Self::Json => "application/json",
            Self::Png => "image/png",
            Self::Download => "application/octet-stream",
        }
    }
}

/// The answer to a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudioAnswer {
    /// Status of HTTP.
    pub status: u16,
    /// The kind of the bytes.
    pub content: Content,
    /// The bytes.
    pub bytes: Vec<u8>,
}

impl StudioAnswer {
    /// Bytes of some kind.
    pub fn bytes(content: Content, bytes: Vec<u8>) -> Self {
        Self { status: 200, content, bytes }
    }

    /// A value as JSON.
    ///
    /// # Panics
    /// If the value cannot be written as JSON, such as a map with keys that are no text.
    pub fn json(value: &impl Serialize) -> Self {
        let bytes = serde_json::to_vec(value).expect("plain values");
        Self { status: 200, content: Content::Json, bytes }
    }

    /// What is wrong with a call, and what to do about it.
    pub fn fault(status: u16, message: &str, hint: Option<&str>) -> Self {
        Self { status, ..Self::json(&serde_json::json!({ "error": message, "hint": hint })) }
    }
}
