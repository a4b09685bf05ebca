//! Fast hashing of small keys of our own making. Maps with it are never iterated over.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A map by numbers below 2⁶⁴, such as packed indices.
pub(super) type ByNumber<V> = HashMap<u64, V, BuildHasherDefault<Multiplicative>>;

/// Multiplicative hashing. Keys come from an image, so it needs no protection against attacks.
#[derive(Default)]
pub(super) struct Multiplicative(u64);

impl Hasher for Multiplicative {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u64(u64::from(b)));
    }

    fn write_u64(&mut self, n: u64) {
        let mixed = (self.0 ^ n).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ (mixed >> 29);
    }
}
