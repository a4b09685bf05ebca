//! The engine that runs networks of Segment Anything.

use clap::{Args, ValueEnum};
use std::path::PathBuf;
use vtex::engine::{EngineOptions, Runtime};

/// The engine that runs networks.
#[derive(Args, Clone)]
#[command(next_help_heading = "Networks")]
pub(crate) struct EngineArgs {
    /// Engine for the networks of Segment Anything; auto is ONNX Runtime if vtex finds it, else rten, which
    /// is part of vtex [auto, onnxruntime or rten, default: auto]
    #[arg(long, value_name = "NAME", value_enum, hide_possible_values = true)]
    pub(crate) engine: Option<EngineName>,
    /// ONNX Runtime's shared library [default: $VTEX_ONNXRUNTIME or $ORT_DYLIB_PATH, else the first
    /// found; see 'vtex doctor']
    #[arg(long, value_name = "FILE")]
    pub(crate) onnxruntime: Option<PathBuf>,
}

/// An engine that runs networks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum EngineName {
    #[default]
    Auto,
    #[value(name = "onnxruntime")]
    OnnxRuntime,
    Rten,
}

/// The engine that runs networks.
pub(crate) fn engine(args: EngineArgs, threads: Option<u16>) -> EngineOptions {
    let runtime = match args.engine.unwrap_or_default() {
        EngineName::Auto => Runtime::Auto,
        EngineName::OnnxRuntime => Runtime::OnnxRuntime,
        EngineName::Rten => Runtime::Rten,
    };
    EngineOptions { runtime, library: args.onnxruntime, threads: threads.map(usize::from) }
}
