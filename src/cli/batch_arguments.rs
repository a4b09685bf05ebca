//! `vtex batch` as clap sees it.

use super::arguments::{AnalyzeFlags, ControlArgs, EngineArgs, SamArgs, SvgFlags, SynthFlags};
use clap::Args;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use vtex::output::file::Kind;

/// Textures of many photographs or libraries
#[derive(Args)]
#[command(
    override_usage = "vtex batch [OPTIONS] --out-dir <DIR> <INPUT>...",
    after_help = "\
Examples:
  vtex batch photos --out-dir textures --size 1000 --seed 7
  vtex batch a.jpg b.lib.json --out-dir textures --format svgz,scene.json.gz
  vtex batch jobs.toml --out-dir textures --shard 2/8 --json

A job that fails does not stop the others; the exit code is then 1. Run again, jobs that were done
from the same input and parameters are skipped: DIR/batch.jsonl tells what was done. A file of jobs
has the keys of --config at its top, for all jobs, then a [[job]] for each, with input (beside the
file), output (a name without extension), format, and such keys of its own, as in [job.synth]."
)]
pub(crate) struct BatchArgs {
    /// Photographs, libraries, folders (all pictures in them, by name), or one .toml file of jobs
    #[arg(value_name = "INPUT", required = true)]
    pub(crate) input: Vec<PathBuf>,
    /// Folder for results, named after their inputs, made if need be
    #[arg(long, value_name = "DIR", required = true, help_heading = "Output")]
    pub(crate) out_dir: Option<PathBuf>,
    /// What is written for each: svg, svgz, pdf, png, scene.json, scene.json.gz, lib.json,
    /// lib.json.gz [default: svg]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', help_heading = "Output")]
    pub(crate) format: Option<Vec<Extension>>,
    /// Do all jobs anew, and replace existing files even if vtex did not write them
    #[arg(short, long, help_heading = "Output")]
    pub(crate) force: bool,
    /// Do only the I-th of N parts of the jobs, for many machines: every N-th from the I-th
    /// [1/1 to 10000/10000, default: 1/1]
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    pub(crate) shard: Option<Shard>,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) synth: SynthFlags,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    #[command(flatten)]
    pub(crate) sam: SamArgs,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

/// What follows the name of a file that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Extension(&'static str);

impl Extension {
    /// All of them, the default first.
    const ALL: [&'static str; 8] =
        ["svg", "svgz", "pdf", "png", "scene.json", "scene.json.gz", "lib.json", "lib.json.gz"];

    /// What is written if nothing is said.
    pub(crate) const DEFAULT: Self = Self(Self::ALL[0]);

    pub(crate) fn as_str(self) -> &'static str {
        self.0
    }

    /// The kind of file.
    pub(crate) fn kind(self) -> Kind {
        Kind::from_path(Path::new(&format!("x.{}", self.0))).expect("all are known")
    }
}

impl FromStr for Extension {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|e| *e == text.trim_start_matches('.'));
        known.map(Self).ok_or_else(|| format!("expected one of {}", Self::ALL.join(", ")))
    }
}

/// A part of the jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// From 1.
    number: usize,
    of: usize,
}

impl Shard {
    /// All jobs.
    pub(crate) const WHOLE: Self = Self { number: 1, of: 1 };
    const MOST: usize = 10_000;

    /// Whether the job at an index belongs to it.
    pub(crate) fn holds(self, index: usize) -> bool {
        index % self.of + 1 == self.number
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((number, of)) if 1 <= number && number <= of && of <= Self::MOST => Ok(Self { number, of }),
            _ => Err(format!("expected I/N, such as 2/8, with I from 1 to N and N up to {}", Self::MOST)),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex::output::file::Format;

    #[test]
    fn shards_split_all_jobs() {
        let shards = ["1/3", "2/3", "3/3"].map(|s| s.parse::<Shard>().unwrap());
        for index in 0..20 {
            assert_eq!(shards.iter().filter(|s| s.holds(index)).count(), 1);
        }
        assert_eq!(shards[1].to_string(), "2/3");
        assert_eq!("1/1".parse(), Ok(Shard::WHOLE));
        for bad in ["", "1", "0/3", "4/3", "1/0", "-1/3", "1/10001", "a/b", "1/2/3"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }

    #[test]
    fn every_extension_has_a_kind() {
        for name in Extension::ALL {
            let kind = name.parse::<Extension>().unwrap().kind();
            assert_eq!(kind.gzip, name.ends_with('z'));
        }
        assert_eq!(Extension::DEFAULT.kind().format, Format::Svg);
        assert!("jpg".parse::<Extension>().is_err());
    }
}
