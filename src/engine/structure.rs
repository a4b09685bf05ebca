//! Checks the structure of ONNX files before rten reads them.
//!
//! rten 0.27 hangs on varints of ten bytes or more, as they occur in damaged files. The check walks
//! through the whole file but skips weights, so it is fast.

use std::io::{BufRead, Seek};

/// The messages of an ONNX file (onnx.proto of ONNX 1.19) that are inspected.
#[derive(Clone, Copy)]
enum Message {
    Model,
    Graph,
    Node,
    Attribute,
    Tensor,
    Sparse,
    ValueInfo,
    Type,
    TensorType,
    Shape,
    Wrapped,
    Function,
    Plain,
}

/// Content of a length-delimited field.
enum Content {
    Message(Message),
    /// Packed varints.
    Numbers,
    /// Text, weights, or anything not inspected.
    Bytes,
}

impl Message {
    fn content(self, field: u64) -> Content {
        use Content::{Message as Of, Numbers};
        match (self, field) {
            (Self::Model, 7) => Of(Self::Graph),
            (Self::Model, 25) => Of(Self::Function),
            (Self::Model, 8 | 14) => Of(Self::Plain),
            (Self::Graph, 1) | (Self::Function, 7) => Of(Self::Node),
            (Self::Graph, 5) | (Self::Attribute, 5 | 10) | (Self::Sparse, 1 | 2) => Of(Self::Tensor),
            (Self::Graph, 11..=13) | (Self::Function, 12) => Of(Self::ValueInfo),
            (Self::Graph, 15) | (Self::Attribute, 22 | 23) => Of(Self::Sparse),
            (Self::Graph, 14 | 16) | (Self::Node, 9) | (Self::Tensor, 3 | 13 | 16) => Of(Self::Plain),
            (Self::Node, 5) | (Self::Function, 11) => Of(Self::Attribute),
            (Self::Attribute, 6 | 11) => Of(Self::Graph),
            (Self::Attribute, 14 | 15) | (Self::ValueInfo, 2) | (Self::Wrapped, 1 | 2) => Of(Self::Type),
            (Self::Type, 1 | 8) => Of(Self::TensorType),
            (Self::Type, 4 | 5 | 9) => Of(Self::Wrapped),
            (Self::TensorType, 2) => Of(Self::Shape),
            (Self::Shape, 1) => Of(Self::Plain),
            (Self::Attribute, 8) | (Self::Tensor, 1 | 5 | 7 | 11) | (Self::Sparse, 3) => Numbers,
            _ => Content::Bytes,
        }
    }
}

/// Largest nesting depth of graphs.
const DEEPEST: u32 = 100;

/// Walks through a file of `length` bytes.
///
/// # Errors
/// A description of the first fault, with its byte offset.
pub(super) fn check(file: impl BufRead + Seek, length: u64) -> Result<(), String> {
    Walk { file, at: 0 }.message(Message::Model, length, 0)
}

struct Walk<R> {
    file: R,
    /// Number of bytes read and skipped.
    at: u64,
}

impl<R: BufRead + Seek> Walk<R> {
    fn message(&mut self, message: Message, end: u64, depth: u32) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("it is nested too deeply".into());
        }
        while self.at < end {
            let tag = self.number(end)?;
            match tag & 7 {
                0 => drop(self.number(end)?),
                1 => self.step(8, end)?,
                5 => self.step(4, end)?,
                2 => {
                    let length = self.number(end)?;
                    let inner = self.at.checked_add(length).filter(|inner| *inner <= end);
                    let inner = inner.ok_or_else(|| self.wrong("a part is longer than the whole"))?;
                    match message.content(tag >> 3) {
                        Content::Message(message) => self.message(message, inner, depth + 1)?,
                        Content::Numbers => {
                            while self.at < inner {
                                self.number(inner)?;
                            }
                        }
                        Content::Bytes => self.step(length, end)?,
                    }
                }
                _ => return Err(self.wrong("a part of no known kind")),
            }
        }
        Ok(())
    }

    /// A varint of at most ten bytes.
    fn number(&mut self, end: u64) -> Result<u64, String> {
        let mut number = 0u64;
        for k in 0..10 {
            let mut byte = [0];
            if self.at >= end || self.file.read_exact(&mut byte).is_err() {
                return Err(self.wrong("it ends too soon"));
            }
            self.at += 1;
            number |= u64::from(byte[0] & 0x7f).checked_shl(7 * k).unwrap_or(0);
            if byte[0] < 0x80 && (k < 9 || byte[0] < 2) {
                return Ok(number);
            }
        }
        Err(self.wrong("a number is too long"))
    }

    fn step(&mut self, length: u64, end: u64) -> Result<(), String> {
        let distance = i64::try_from(length).ok().filter(|_| length <= end - self.at);
        let distance = distance.ok_or_else(|| self.wrong("it ends too soon"))?;
        self.file.seek_relative(distance).map_err(|e| e.to_string())?;
        self.at += length;
        Ok(())
    }

    fn wrong(&self, what: &str) -> String {
        format!("it is no ONNX file, or damaged: {what}, at byte {}", self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::testing::network;
    use std::io::Cursor;

    fn checked(bytes: &[u8]) -> Result<(), String> {
        check(Cursor::new(bytes), bytes.len() as u64)
    }

    #[test]
    fn networks_pass_and_their_beginnings_do_not() {
        for name in ["product", "sam_decoder", "efficient_both"] {
            let bytes = std::fs::read(network(name)).unwrap();
            checked(&bytes).unwrap();
            // Some prefixes of the file are valid files.
            let passing = (1..bytes.len()).filter(|n| checked(&bytes[..*n]).is_ok()).count();
            assert!(passing < 10, "{passing} beginnings of {name} pass");
        }
    }

    #[test]
    fn numbers_that_never_end_are_found_wherever_they_are() {
        for bytes in [
            &[0xff; 12][..],
            &[0x08, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
            // In a graph, and among the packed lengths of a tensor in it.
            &[0x3a, 11, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0],
            &[0x3a, 15, 0x2a, 13, 0x0a, 11, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0],
            &[0x0b, 0x0c],
            b"hello",
        ] {
            assert!(checked(bytes).is_err(), "{bytes:x?}");
        }
        // The longest valid varint.
        checked(&[0x08, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01]).unwrap();
    }
}
