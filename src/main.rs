//! The `vtex` program: see `vtex::program`.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    vtex::program::run(std::env::args_os().collect(), None).into()
}
