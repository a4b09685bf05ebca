//! Ordered parallel maps: rayon with the feature `parallel`, a plain loop without it.
//!
//! Results come back in the order of the input, so what is computed from them does not depend on
//! the number of threads. Nothing here reduces across threads.

/// `f` of every item, in order.
#[cfg(feature = "parallel")]
pub(crate) fn map<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    items.par_iter().map(f).collect()
}

/// `f` of every item, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map<T, R>(items: &[T], f: impl Fn(&T) -> R) -> Vec<R> {
    items.iter().map(f).collect()
}

/// `f(index, row)` of every chunk of `size` items of `data`.
#[cfg(feature = "parallel")]
pub(crate) fn for_chunks<T: Send>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    use rayon::prelude::*;
    data.par_chunks_mut(size).enumerate().for_each(|(i, row)| f(i, row));
}

/// `f(index, row)` of every chunk of `size` items of `data`.
#[cfg(not(feature = "parallel"))]
pub(crate) fn for_chunks<T>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T])) {
    data.chunks_mut(size).enumerate().for_each(|(i, row)| f(i, row));
}
