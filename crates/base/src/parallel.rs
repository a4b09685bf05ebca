//! Ordered parallel maps and pairs of tasks: rayon with the feature `parallel`, plain loops without it.
//!
//! Results are in the order of the input, so values computed from them do not depend on the number of
//! threads. Nothing here reduces across threads.

/// Number of pieces of work per thread; several, so that no thread waits long for the last piece.
#[cfg(feature = "parallel")]
const PIECES: usize = 32;

/// `f` of every item, in order.
#[cfg(feature = "parallel")]
pub fn map<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    use std::sync::{Mutex, PoisonError};
    let size = items.len().div_ceil(PIECES * rayon::current_num_threads()).max(1);
    let done: Vec<Mutex<Vec<R>>> = items.chunks(size).map(|_| Mutex::default()).collect();
    for_each(done.len(), &|k| {
        let piece = items[k * size..].iter().take(size).map(&f).collect();
        *done[k].lock().unwrap_or_else(PoisonError::into_inner) = piece;
    });
    let pieces = done.into_iter().map(|piece| piece.into_inner().unwrap_or_else(PoisonError::into_inner));
    let mut all = Vec::with_capacity(items.len());
    pieces.for_each(|piece| all.extend(piece));
    all
}

/// Runs `work` for every number from 0 to `count - 1`. The function is not generic, so that it and rayon's
/// code are compiled once instead of once per closure.
#[cfg(feature = "parallel")]
fn for_each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    use rayon::prelude::*;
    (0..count).into_par_iter().for_each(work);
}

/// `f` of every item, in order.
#[cfg(not(feature = "parallel"))]
pub fn map<T, R>(items: &[T], f: impl Fn(&T) -> R) -> Vec<R> {
    items.iter().map(f).collect()
}

/// `f(index, row)` of every chunk of `size` items of `data`.
#[cfg(feature = "parallel")]
pub fn for_chunks<T: Send>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    use rayon::prelude::*;
    data.par_chunks_mut(size).enumerate().for_each(|(i, row)| f(i, row));
}

/// `f(index, row)` of every chunk of `size` items of `data`.
#[cfg(not(feature = "parallel"))]
pub fn for_chunks<T>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T])) {
    data.chunks_mut(size).enumerate().for_each(|(i, row)| f(i, row));
}

/// Calls `f(index, part)` for consecutive parts of `data` with the given lengths.
#[cfg(feature = "parallel")]
pub fn for_parts<T: Send>(
    data: &mut [T],
    lengths: impl Iterator<Item = usize>,
    f: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    use rayon::prelude::*;
    parts(data, lengths).into_par_iter().enumerate().for_each(|(i, part)| f(i, part));
}

/// Calls `f(index, part)` for consecutive parts of `data` with the given lengths.
#[cfg(not(feature = "parallel"))]
pub fn for_parts<T>(data: &mut [T], lengths: impl Iterator<Item = usize>, f: impl Fn(usize, &mut [T])) {
    parts(data, lengths).into_iter().enumerate().for_each(|(i, part)| f(i, part));
}

fn parts<T>(mut data: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let part = |length| {
        let (part, rest) = std::mem::take(&mut data).split_at_mut(length);
        data = rest;
        part
    };
    lengths.map(part).collect()
}

/// The results of two independent tasks.
#[cfg(feature = "parallel")]
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// The results of two independent tasks.
#[cfg(not(feature = "parallel"))]
pub fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}
