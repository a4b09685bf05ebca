//! Values of options of `vtex batch`.

use crate::cli::values::one_of_these;
use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::LazyLock;
use vtex::output::file::{FileKind, Format};

/// The extension of a written file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Extension(pub(crate) FileKind);

impl Extension {
    /// The default formats.
    pub(crate) const DEFAULT: Self = Self(FileKind { format: Format::Svg, gzip: false });

    /// The names of all, in the order in which they are listed.
    pub(crate) fn names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&'static str>> =
            LazyLock::new(|| FileKind::all().map(|kind| Extension(kind).as_str()).collect());
        &NAMES
    }

    /// The name, without a dot.
    pub(crate) fn as_str(self) -> &'static str {
        self.0.ending().text.trim_start_matches('.')
    }
}

impl FromStr for Extension {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = |kind: &FileKind| Self(*kind).as_str() == text.trim_start_matches('.');
        FileKind::all().find(named).map(Self).ok_or_else(|| one_of_these(Self::names()))
    }
}

/// The jobs that are done again although they are done, or left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Forced {
    All,
    /// Those of these names or inputs.
    Jobs(Vec<String>),
}

impl Forced {
    /// The value of `--force` without jobs.
    pub(crate) const ALL: &'static str = "";

    /// Whether it holds for a job, known by its name or its input.
    pub(crate) fn holds(&self, name: &str, input: &Path) -> bool {
        match self {
            Self::All => true,
            Self::Jobs(jobs) => jobs.iter().any(|job| is_called(job, name, input)),
        }
    }
}

/// Whether a text that a user typed stands for a job: its name, or its input.
pub(crate) fn is_called(text: &str, name: &str, input: &Path) -> bool {
    text == name || Path::new(text) == input
}

impl FromStr for Forced {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let jobs = || Self::Jobs(text.split(',').map(|job| job.trim().to_owned()).collect());
        Ok(if text == Self::ALL { Self::All } else { jobs() })
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
    fn jobs_are_forced_by_name_or_input() {
        let forced = |text: &str| text.parse::<Forced>().unwrap();
        let holds = |text: &str| forced(text).holds("a", Path::new("photos/a.png"));
        assert!(holds("") && holds("a") && holds("b, a") && holds("photos/a.png"));
        assert!(!holds("b") && !holds("a.png") && !holds("b,c"));
    }

    #[test]
    fn every_extension_is_read() {
        for &name in Extension::names() {
            assert_eq!(name.parse::<Extension>().unwrap().as_str(), name);
            assert_eq!(format!(".{name}").parse(), name.parse::<Extension>());
        }
        assert_eq!(Extension::DEFAULT.as_str(), "svg");
        assert!("jpg".parse::<Extension>().is_err());
    }
}
