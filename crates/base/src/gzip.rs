//! Unpacking of gzip, with a bound on the number of unpacked bytes.

use flate2::read::GzDecoder;
use std::borrow::Cow;
use std::io::{ErrorKind, Read};

/// Number of unpacked bytes that is always allowed.
const ALWAYS: u64 = 64_000_000;
/// Largest ratio of unpacked to packed bytes above [`ALWAYS`]. For libraries, scenes and SVGs of vtex the
/// ratio is 3 to 10; gzip can reach 1000.
const RATIO: u64 = 32;

/// Whether bytes begin as gzip does.
pub fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

/// Unpacks gzip, to at most `limit` bytes; other bytes are returned as they are.
///
/// # Errors A description: damaged data, or data that unpack to more than 64 MB and to more than 32 times the
/// packed bytes.
pub fn unpack<'a>(bytes: impl Into<Cow<'a, [u8]>>, limit: u64) -> Result<Cow<'a, [u8]>, String> {
    let bytes = bytes.into();
    if !is_packed(&bytes) {
        return Ok(bytes);
    }
    let most = ALWAYS.max(RATIO * bytes.len() as u64);
    let mut unpacked = Vec::new();
    let read = GzDecoder::new(&*bytes).take(limit.min(most + 1)).read_to_end(&mut unpacked);
    read.map_err(|e| match e.kind() {
        ErrorKind::UnexpectedEof => "damaged gzip data: the file ends in the middle".to_owned(),
        _ => "damaged gzip data".to_owned(),
    })?;
    if unpacked.len() as u64 > most {
        return Err(format!("it unpacks to more than {} MB, over {RATIO} times its size", most / 1_000_000));
    }
    Ok(unpacked.into())
}

/// The first bytes, at most `most`, unpacked if they are gzip. For damaged data, the bytes before the damage.
pub fn beginning(bytes: &[u8], most: usize) -> Cow<'_, [u8]> {
    if !is_packed(bytes) {
        return bytes[..bytes.len().min(most)].into();
    }
    let mut unpacked = Vec::new();
    // An error ends the data; a full read reports it.
    let _ = GzDecoder::new(bytes).take(most as u64).read_to_end(&mut unpacked);
    unpacked.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;

    fn packed(bytes: &[u8], times: usize) -> Vec<u8> {
        let mut out = GzEncoder::new(Vec::new(), Compression::fast());
        (0..times).for_each(|_| out.write_all(bytes).unwrap());
        out.finish().unwrap()
    }

    #[test]
    fn plain_and_packed_are_the_same() {
        for bytes in [&b"{\"format\":1}"[..], b""] {
            assert_eq!(unpack(bytes, u64::MAX).unwrap(), bytes);
            assert_eq!(unpack(packed(bytes, 1), u64::MAX).unwrap(), bytes);
            assert_eq!(beginning(&packed(bytes, 1), 3), &bytes[..bytes.len().min(3)]);
            assert_eq!(beginning(bytes, 3), &bytes[..bytes.len().min(3)]);
        }
        assert!(unpack(&[0x1f, 0x8b, 8, 0, 1], u64::MAX).unwrap_err().contains("damaged"));
    }

    #[test]
    fn a_bomb_is_given_up() {
        let bomb = packed(&[b' '; 1 << 20], 80);
        assert!(bomb.len() < 1_000_000);
        assert!(unpack(&bomb, u64::MAX).unwrap_err().contains("more than 64 MB"));
        let large = packed(&[b' '; 1 << 20], 60);
        assert_eq!(unpack(&large, u64::MAX).unwrap().len(), 60 << 20);
        assert_eq!(unpack(&large, 1000).unwrap().len(), 1000);
    }
}
