//! Checks the structure of ONNX files before rten reads them.
//!
//! rten 0.27 hangs on varints of ten bytes or more, which occur in damaged files. It also adds up lengths of
//! axes in 32 bits, and allocates all memory that a network requests, so the process ends if there is not
//! enough. The check walks through the whole file but skips weights, so it is fast.

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
enum FieldContent {
    Message(Message),
    /// Packed varints.
    Numbers,
    /// Text, weights, or anything not inspected.
    Bytes,
}

impl Message {
    fn content(self, field: u64) -> FieldContent {
        use FieldContent::{Message as Of, Numbers};
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
            _ => FieldContent::Bytes,
        }
    }
}

/// Largest nesting depth of graphs.
const DEEPEST: u32 = 100;

/// Longest name of a value that is kept, in bytes.
const LONGEST_NAME: u64 = 1000;
/// Most integers of a tensor that may be the lengths of axes: two for each of sixteen.
const MOST_LENGTHS: u64 = 32;
/// Integers above this cannot be lengths of axes. Those above [`NO_END`] stand for the end of an axis,
/// whatever its length.
const LONGEST_AXIS: u64 = 1 << 31;
const NO_END: u64 = 1 << 62;

/// Walks through a file of `length` bytes. Gives the names of the values that its nodes compute.
///
/// # Errors
/// A description of the first fault, with its byte offset.
pub(super) fn check(file: impl BufRead + Seek, length: u64) -> Result<Vec<String>, String> {
    let mut walk = Walk { file, at: 0, values: Vec::new() };
    walk.message(Message::Model, length, 0)?;
    Ok(walk.values)
}

struct Walk<R> {
    file: R,
    /// Number of bytes read and skipped.
    at: u64,
    /// Names of the values that nodes compute.
    values: Vec<String>,
}

impl<R: BufRead + Seek> Walk<R> {
    fn message(&mut self, message: Message, end: u64, depth: u32) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("it is nested too deeply".into());
        }
        let (mut kind, mut raw) = (0, Vec::new());
        while self.at < end {
            let tag = self.number(end)?;
            match tag & 7 {
                0 => {
                    let number = self.number(end)?;
                    if let (Message::Tensor, 2) = (message, tag >> 3) {
                        kind = number;
                    }
                }
                1 => self.step(8, end)?,
                5 => self.step(4, end)?,
                2 => {
                    let length = self.number(end)?;
                    let inner = self.at.checked_add(length).filter(|inner| *inner <= end);
                    let inner = inner.ok_or_else(|| self.wrong("a part is longer than the whole"))?;
                    match (message, tag >> 3) {
                        (Message::Node, 2) if length <= LONGEST_NAME => {
                            let name = self.bytes(length, end)?;
                            self.values.push(String::from_utf8_lossy(&name).into_owned());
                            continue;
                        }
                        // 64-bit integers, if the tensor holds integers. Floats are read like integers, but
                        // hardly ever have the bits of a length.
                        (Message::Tensor, 9) if length <= 8 * MOST_LENGTHS && length.is_multiple_of(8) => {
                            raw = self.bytes(length, end)?;
                            continue;
                        }
                        _ => {}
                    }
                    match message.content(tag >> 3) {
                        FieldContent::Message(message) => self.message(message, inner, depth + 1)?,
                        FieldContent::Numbers => {
                            let begin = self.at;
                            while self.at < inner {
                                let number = self.number(inner)?;
                                if let (Message::Tensor, 7) = (message, tag >> 3)
                                    && inner - begin <= 10 * MOST_LENGTHS
                                {
                                    self.check_axis(number)?;
                                }
                            }
                        }
                        FieldContent::Bytes => self.step(length, end)?,
                    }
                }
                _ => return Err(self.wrong("a part of no known kind")),
            }
        }
        const INT64: u64 = 7;
        if kind == INT64 {
            for eight in raw.as_chunks::<8>().0 {
                self.check_axis(u64::from_le_bytes(*eight))?;
            }
        }
        Ok(())
    }

    /// Refuses an integer, as two's complement, that stands for an axis longer than any memory.
    fn check_axis(&self, number: u64) -> Result<(), String> {
        let size = (number as i64).unsigned_abs();
        if (LONGEST_AXIS..NO_END).contains(&size) {
            return Err(format!(
                "it asks for a tensor of {size} elements along an axis, before byte {}",
                self.at
            ));
        }
        Ok(())
    }

    /// Raw bytes.
    fn bytes(&mut self, length: u64, end: u64) -> Result<Vec<u8>, String> {
        let mut bytes = vec![0; length as usize];
        if length > end - self.at || self.file.read_exact(&mut bytes).is_err() {
            return Err(self.wrong("it ends too soon"));
        }
        self.at += length;
        Ok(bytes)
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
        check(Cursor::new(bytes), bytes.len() as u64).map(drop)
    }

    #[test]
    fn values_that_nodes_compute_are_named() {
        let bytes = std::fs::read(network("sam_decoder")).unwrap();
        let values = check(Cursor::new(&bytes), bytes.len() as u64).unwrap();
        assert!(values.iter().any(|v| v == "masks"), "{values:?}");
    }

    #[test]
    fn lengths_beyond_any_memory_are_found() {
        // A model of a graph of a tensor: of 64-bit integers, as raw data or packed.
        let of = |tensor: &[u8]| {
            let graph = [&[0x2a, tensor.len() as u8], tensor].concat();
            [&[0x3a, graph.len() as u8], &graph[..]].concat()
        };
        let raw = |number: i64| of(&[&[0x10, 7, 0x4a, 8], &number.to_le_bytes()[..]].concat());
        for fine in [0, 1, -1, 1 << 30, i64::MAX, i64::MIN, i64::from(i32::MAX)] {
            checked(&raw(fine)).unwrap();
        }
        for far in [1 << 31, -(1 << 40), 125_000_000_000] {
            assert!(checked(&raw(far)).unwrap_err().contains("along an axis"), "{far}");
        }
        // Floats of the same bytes are not lengths.
        checked(&of(&[&[0x10, 1, 0x4a, 8], &(1i64 << 40).to_le_bytes()[..]].concat())).unwrap();
        let packed = [0x10, 7, 0x3a, 6, 0x80, 0x80, 0x80, 0x80, 0x80, 0x01];
        assert!(checked(&of(&packed)).unwrap_err().contains("along an axis"));
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
