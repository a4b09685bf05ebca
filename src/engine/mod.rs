//! Neural networks: named tensors in, named tensors out. Knows nothing of images.

use crate::error::Result;

/// The elements of a tensor, the last axis fastest.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// 32-bit floats.
    F32(Vec<f32>),
    /// 64-bit integers.
    I64(Vec<i64>),
}

/// A dense tensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// Length of each axis.
    pub shape: Vec<usize>,
    /// As many elements as the shape has places.
    pub values: Values,
}

/// An input or output of a network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name in the graph.
    pub name: String,
    /// Length of each axis, where fixed; `None` if not even the number of axes is known.
    pub shape: Option<Vec<Option<usize>>>,
}

/// A loaded network. Safe to run from several threads at once.
pub trait Engine: Send + Sync {
    /// What it reads, in the order of the graph.
    fn inputs(&self) -> &[Port];

    /// What it gives, in the order of the graph.
    fn outputs(&self) -> &[Port];

    /// Runs the network on named inputs; gives the outputs asked for, in that order.
    ///
    /// # Errors
    /// [`crate::Error::Network`] if inputs do not fit the graph or the run fails.
    fn run(&self, inputs: &[(&str, &Tensor)], outputs: &[&str]) -> Result<Vec<Tensor>>;
}
