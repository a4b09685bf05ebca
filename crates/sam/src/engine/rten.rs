//! Networks run by rten, which is part of this crate. Results are the same on any number of threads.
//!
//! rten has its own thread pool: by default one thread per physical core, or as many as the variable
//! `RTEN_NUM_THREADS` or [`EngineOptions::threads`](super::EngineOptions::threads) requests. Loading always
//! uses the default threads. They do not exist in a process that is forked later, so networks are refused
//! there.

use super::{Engine, NetworkSource, Port, Tensor, Values, guarded, input_indices, places, structure};
use ::rten::{DataType, Dimension, Model, NodeId, RunOptions, ThreadPool, Value, ValueOrView, ValueType};
use rten_tensor::prelude::*;
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use vtex_base::error::{Error, Result, clip};

/// A loaded network.
pub(super) struct RtenNetwork {
    name: String,
    model: Model,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    pool: Option<Arc<ThreadPool>>,
}

impl RtenNetwork {
    /// Loads a network.
    ///
    /// # Errors
    /// [`Error::Network`], [`Error::Read`].
    pub(super) fn load(source: NetworkSource<'_>, threads: Option<usize>) -> Result<Self> {
        let name = source.name();
        let model = loaded(source, &name)?;
        let ports = |ids: &[NodeId]| ids.iter().map(|id| port(&model, *id)).collect();
        let (inputs, outputs) = (ports(model.input_ids()), ports(model.output_ids()));
        let pool = threads.map(|n| Arc::new(ThreadPool::with_num_threads(n.max(1))));
        Ok(Self { name, model, inputs, outputs, pool })
    }

    /// Converts a tensor to the number type that an input takes.
    fn converted(&self, id: NodeId, tensor: &Tensor) -> Result<Value> {
        let kind = self.model.node_info(id).and_then(|node| node.dtype());
        let shape = &tensor.shape[..];
        let value = match (kind, &tensor.values) {
            (Some(ValueType::Tensor(DataType::Float)), _) | (None, Values::F32(_)) => {
                Value::from_shape(shape, tensor.floats()).map_err(|e| e.to_string())
            }
            (Some(ValueType::Tensor(DataType::Int32)), _) | (None, Values::I64(_)) => {
                let limited = |v: &i64| (*v).clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
                Value::from_shape(shape, tensor.integers().iter().map(limited).collect::<Vec<_>>())
                    .map_err(|e| e.to_string())
            }
            (Some(ValueType::Tensor(DataType::UInt8)), _) => {
                let limited = |v: &i64| (*v).clamp(0, 255) as u8;
                Value::from_shape(shape, tensor.integers().iter().map(limited).collect::<Vec<_>>())
                    .map_err(|e| e.to_string())
            }
            (Some(other), _) => Err(format!("an input of {other} is not known here")),
        };
        value.map_err(|reason| self.failure(reason))
    }

    fn failure(&self, reason: String) -> Error {
        Error::Engine { name: self.name.clone(), engine: "rten", reason }
    }
}

impl Engine for RtenNetwork {
    fn runtime(&self) -> &str {
        "rten"
    }

    fn inputs(&self) -> &[Port] {
        &self.inputs
    }

    fn outputs(&self) -> &[Port] {
        &self.outputs
    }

    fn run(&self, inputs: &[(&str, &Tensor)], outputs: &[&str]) -> Result<Vec<Tensor>> {
        let indices = input_indices(&self.name, &self.inputs, inputs)?;
        let arguments = indices.into_iter().zip(inputs).map(|(place, (_, tensor))| {
            let id = self.model.input_ids()[place];
            Ok((id, ValueOrView::from(self.converted(id, tensor)?)))
        });
        let arguments: Vec<(NodeId, ValueOrView<'_>)> = arguments.collect::<Result<_>>()?;
        let wanted = places(&self.name, &self.outputs, outputs)?;
        let wanted: Vec<NodeId> = wanted.into_iter().map(|place| self.model.output_ids()[place]).collect();
        guarded(&self.name, || {
            let options = RunOptions::default().with_thread_pool(self.pool.clone());
            let values = self.model.run(arguments, &wanted, Some(options));
            let values = values.map_err(|e| self.failure(format!("rten cannot run it: {e}")))?;
            values.into_iter().map(|value| self.taken(value)).collect()
        })
    }
}

impl RtenNetwork {
    /// Converts a value to a tensor.
    fn taken(&self, value: Value) -> Result<Tensor> {
        Ok(match value {
            Value::FloatTensor(t) => Tensor { shape: t.shape().to_vec(), values: Values::F32(t.into_data()) },
            Value::Int32Tensor(t) => {
                let values = t.to_vec().into_iter().map(i64::from).collect();
                Tensor { shape: t.shape().to_vec(), values: Values::I64(values) }
            }
            _ => return Err(self.failure("an output is neither of floats nor of integers".into())),
        })
    }
}

/// Loads a network.
///
/// # Errors
/// As [`RtenNetwork::load`].
fn loaded(source: NetworkSource<'_>, name: &str) -> Result<Model> {
    let failure = |reason: String| Error::Network {
        name: name.to_owned(),
        reason: format!("rten cannot read it: {reason}"),
        advice: "is it an ONNX file with 32-bit weights, and complete? ONNX Runtime reads more kinds: 'vtex doctor' says how to get it",
    };
    only_with_threads(name)?;
    guarded(name, || {
        let (values, model) = match source {
            NetworkSource::File(path) => {
                let open = || -> std::io::Result<(BufReader<File>, u64)> {
                    let file = File::open(path)?;
                    let length = file.metadata()?.len();
                    Ok((BufReader::new(file), length))
                };
                let (file, length) = open().map_err(|e| Error::read(path, e))?;
                let values = structure::check(file, length).map_err(failure)?;
                // Files named `.onnx` are loaded by path, so that weights in a second file are found.
                let model = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("onnx")) {
                    Model::load_file(path)
                } else {
                    Model::load(std::fs::read(path).map_err(|e| Error::read(path, e))?)
                };
                (values, model)
            }
            NetworkSource::Bytes { bytes, .. } => {
                let values = structure::check(Cursor::new(bytes), bytes.len() as u64).map_err(failure)?;
                (values, Model::load(bytes.to_vec()))
            }
        };
        let model = model.map_err(|e| failure(e.to_string()))?;
        match values.iter().find_map(|value| too_large(&model, value)) {
            Some(reason) => Err(failure(reason)),
            None => Ok(model),
        }
    })
}

/// Most elements of a tensor within a network: 16 GiB of floats. Attention over an image of 1024 pixels takes
/// 300 million.
const MOST_ELEMENTS: u128 = 1 << 32;

/// The fault of a network of which a value is too large for memory; computing that value would end the
/// process. Only values whose shapes follow from those of the inputs are checked.
fn too_large(model: &Model, value: &str) -> Option<String> {
    let shape = model.node_info(model.find_node(value)?)?.shape()?;
    let axes = shape.iter().map(|axis| match axis {
        Dimension::Fixed(length) => *length as u128,
        Dimension::Symbolic(_) => 1,
    });
    let elements = axes.fold(1u128, u128::saturating_mul);
    (elements > MOST_ELEMENTS)
        .then(|| format!("'{}' would have {elements} elements, {MOST_ELEMENTS} are the most", clip(value)))
}

/// Refuses to load in a process that was forked after its parent had loaded networks. Loading needs rten's
/// threads, which do not exist there, and would wait for them forever.
///
/// # Errors
/// [`Error::Network`].
fn only_with_threads(name: &str) -> Result<()> {
    static FIRST: AtomicU32 = AtomicU32::new(0);
    let own = std::process::id();
    match FIRST.compare_exchange(0, own, Ordering::Relaxed, Ordering::Relaxed) {
        Err(first) if first != own => Err(Error::Network {
            name: name.to_owned(),
            reason: "it cannot be loaded in a process forked from one that has loaded networks".into(),
            advice: "start processes anew rather than by a fork, or run networks by ONNX Runtime",
        }),
        _ => Ok(()),
    }
}

/// Describes an input or output of the graph.
fn port(model: &Model, id: NodeId) -> Port {
    let node = model.node_info(id);
    let shape = node.as_ref().and_then(|node| node.shape()).map(|axes| {
        let length = |axis: &Dimension| match axis {
            Dimension::Fixed(n) => Some(*n),
            Dimension::Symbolic(_) => None,
        };
        axes.iter().map(length).collect()
    });
    let name = node.and_then(|node| node.name()).unwrap_or_default();
    Port { name: name.to_owned(), shape }
}
