//! The record of a batch: a line of JSON for each job, so that an interrupted batch can be continued.
//!
//! A job is identified by a checksum over everything that its results depend on, the content of networks
//! included. Its line is added after the results are in place. A job is skipped if a line has its checksum
//! and its results are unchanged, byte for byte. Shards write records of their own and read all.

use super::values::Shard;
use crate::cli::interrupt::Passing;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;
use vtex::{Error, Result};

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Status {
    Done,
    /// The job was done in an earlier run from the same inputs.
    Skipped,
    Failed,
}

/// A line: one job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// Name of its results.
    pub(crate) job: String,
    pub(crate) input: String,
    pub(crate) status: Status,
    /// SHA-256 of everything that the results depend on, except a seed that was not given.
    #[serde(default)]
    pub(crate) key: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) seed: Option<u64>,
    /// Size of the texture, in pixels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) size: Option<[u32; 2]>,
    /// Primaries placed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) primaries: Option<usize>,
    /// Share of the area that primaries cover: in the exemplar, and in the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) coverage: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) outputs: Vec<RecordedFile>,
    #[serde(default)]
    pub(crate) seconds: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) hint: Option<String>,
    /// Whether it failed because the program died during the job, in this or an earlier run.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) died: bool,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) warnings: Vec<String>,
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct RecordedFile {
    /// Its name in the folder for results.
    pub(crate) file: String,
    pub(crate) bytes: u64,
    pub(crate) sha256: String,
}

impl RecordedFile {
    /// Reads the size and checksum of a file in the folder of results.
    ///
    /// # Errors
    /// [`Error::Read`].
    pub(crate) fn of(folder: &Path, file: &str) -> Result<Self> {
        let path = folder.join(file);
        let bytes = fs::read(&path).map_err(|e| Error::read(&path, e))?;
        Ok(Self { file: file.to_owned(), bytes: bytes.len() as u64, sha256: sum(&bytes) })
    }
}

/// The records in a folder for results.
pub(crate) struct Records {
    folder: PathBuf,
    /// The file to which this run adds.
    path: PathBuf,
    /// The records of jobs that were done, by job and key; several where one was done again.
    done: BTreeMap<String, Vec<Record>>,
    /// How often the program died during jobs, by job and key, since they were last done.
    deaths: BTreeMap<String, usize>,
}

/// A job and its key, by which its records are found.
fn both(job: &str, key: &str) -> String {
    format!("{job}\n{key}")
}

/// Prefix and suffix of the name of a marker file, which names the job in progress.
const MARKER: [&str; 2] = [".batch-", ".running"];

/// A locked marker file that names the job in progress. If the process dies, the file stays.
pub(crate) struct Running {
    _file: NamedTempFile,
    _passing: Passing,
}

impl Records {
    /// Reads the records of all shards. Lines that cannot be read, such as one that was cut off, are ignored.
    ///
    /// # Errors
    /// A folder or file that cannot be read.
    pub(crate) fn open(folder: &Path, shard: Shard) -> Result<Self> {
        let name = if shard == Shard::WHOLE {
            "batch.jsonl".to_owned()
        } else {
            format!("batch-{}.jsonl", shard.to_string().replace('/', "-of-"))
        };
        let mut files = Vec::new();
        for entry in fs::read_dir(folder).map_err(|e| Error::read(folder, e))? {
            let path = entry.map_err(|e| Error::read(folder, e))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if name.starts_with("batch") && name.ends_with(".jsonl") {
                files.push(path);
            }
        }
        files.sort();
        let mut done: BTreeMap<String, Vec<Record>> = BTreeMap::new();
        let mut deaths: BTreeMap<String, usize> = BTreeMap::new();
        for path in files {
            let bytes = fs::read(&path).map_err(|e| Error::read(&path, e))?;
            for line in bytes.split(|b| *b == b'\n') {
                let Ok(record) = serde_json::from_slice::<Record>(line) else { continue };
                let both = both(&record.job, &record.key);
                if record.died {
                    // A job that was left out has a hint; it did not run.
                    *deaths.entry(both).or_default() += usize::from(record.hint.is_none());
                } else if record.status == Status::Done {
                    deaths.remove(&both);
                    done.entry(both).or_default().push(record);
                }
            }
        }
        let records = Self { folder: folder.to_owned(), path: folder.join(name), done, deaths };
        records.with_dead()
    }

    /// Notes the jobs of processes that died.
    fn with_dead(mut self) -> Result<Self> {
        for path in markers(&self.folder)? {
            // A process that is still working on the job holds the lock.
            let Ok(file) = File::open(&path) else { continue };
            if file.try_lock().is_err() {
                continue;
            }
            let bytes = fs::read(&path).map_err(|e| Error::read(&path, e))?;
            if let Ok(record) = serde_json::from_slice::<Record>(&bytes) {
                *self.deaths.entry(both(&record.job, &record.key)).or_default() += 1;
                self.add(&record)?;
            }
            fs::remove_file(&path).map_err(|e| Error::write(&path, e))?;
        }
        Ok(self)
    }

    /// How often the program died during a job since it was last done.
    pub(crate) fn deaths(&self, job: &str, key: &str) -> usize {
        self.deaths.get(&both(job, key)).copied().unwrap_or(0)
    }

    /// Marks a job as in progress until the returned value is dropped.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub(crate) fn begin(&self, record: &Record) -> Result<Running> {
        let fail = |e: std::io::Error| Error::write(&self.folder, e.kind().into());
        let record = Record {
            status: Status::Failed,
            died: true,
            error: Some("the program ended while it did this job".into()),
            ..record.clone()
        };
        let mut file = tempfile::Builder::new()
            .prefix(MARKER[0])
            .suffix(MARKER[1])
            .tempfile_in(&self.folder)
            .map_err(fail)?;
        // Without support for locks, no job counts as died.
        let _ = file.as_file().lock();
        file.write_all(&serde_json::to_vec(&record).map_err(|e| fail(e.into()))?).map_err(fail)?;
        let passing = Passing::new(file.path());
        Ok(Running { _file: file, _passing: passing })
    }

    /// The record of a job that was done from the same inputs and whose results are unchanged.
    pub(crate) fn done(&self, job: &str, key: &str, files: &[String]) -> Option<&Record> {
        let is_there = |w: &RecordedFile| {
            let same_size = fs::metadata(self.folder.join(&w.file)).is_ok_and(|m| m.len() == w.bytes);
            same_size && RecordedFile::of(&self.folder, &w.file).is_ok_and(|found| found == *w)
        };
        let wanted = |r: &Record| files.iter().all(|file| r.outputs.iter().any(|w| w.file == *file));
        let known = self.done.get(&both(job, key))?;
        known.iter().find(|record| wanted(record) && record.outputs.iter().all(is_there))
    }

    /// Adds a line in one write.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub(crate) fn add(&self, record: &Record) -> Result<()> {
        let fail = |e| Error::write(&self.path, e);
        let mut file = File::options().create(true).read(true).append(true).open(&self.path).map_err(fail)?;
        let mut line = serde_json::to_vec(record).map_err(|e| fail(e.into()))?;
        line.push(b'\n');
        // Ends a line that was cut off.
        let mut last = [b'\n'];
        if file.seek(SeekFrom::End(0)).map_err(fail)? > 0 {
            file.seek(SeekFrom::End(-1)).map_err(fail)?;
            file.read_exact(&mut last).map_err(fail)?;
        }
        if last != [b'\n'] {
            line.insert(0, b'\n');
        }
        file.write_all(&line).and_then(|()| file.sync_data()).map_err(fail)
    }
}

/// The marker files in a folder.
fn markers(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(|e| Error::read(folder, e))? {
        let path = entry.map_err(|e| Error::read(folder, e))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with(MARKER[0]) && name.ends_with(MARKER[1]) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// SHA-256 of a value's JSON, in hexadecimal.
pub(crate) fn key(value: &impl Serialize) -> String {
    let bytes = serde_json::to_vec(value).expect("plain values");
    sum(&bytes)
}

/// SHA-256, in hexadecimal.
pub(crate) fn sum(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(job: &str, key: &str, outputs: Vec<RecordedFile>) -> Record {
        Record {
            job: job.into(),
            input: format!("{job}.png"),
            status: Status::Done,
            key: key.into(),
            seed: Some(3),
            size: Some([10, 20]),
            primaries: Some(4),
            coverage: Some([0.5, 0.25]),
            outputs,
            seconds: 1.5,
            error: None,
            hint: None,
            died: false,
            warnings: Vec::new(),
        }
    }

    #[test]
    fn what_was_done_is_known_until_its_results_change() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.svg");
        fs::write(&file, "one").unwrap();
        let shard = "2/3".parse().unwrap();
        let written = RecordedFile::of(folder.path(), "a.svg").unwrap();
        Records::open(folder.path(), shard).unwrap().add(&record("a", "k", vec![written])).unwrap();
        // Another shard finds it too.
        let known = |key: &str, files: &[&str]| {
            let files: Vec<String> = files.iter().map(|f| (*f).to_owned()).collect();
            Records::open(folder.path(), Shard::WHOLE).unwrap().done("a", key, &files).is_some()
        };
        assert!(known("k", &["a.svg"]) && !known("other", &["a.svg"]) && !known("k", &["a.svg", "a.png"]));
        fs::write(&file, "two").unwrap();
        assert!(!known("k", &["a.svg"]));
        fs::remove_file(&file).unwrap();
        assert!(!known("k", &["a.svg"]));
    }

    #[test]
    fn deaths_of_the_process_during_a_job_are_counted_until_it_is_done() {
        let folder = tempfile::tempdir().unwrap();
        let open = || Records::open(folder.path(), Shard::WHOLE).unwrap();
        let job = record("a", "k", Vec::new());
        let running = open().begin(&job).unwrap();
        assert_eq!(open().deaths("a", "k"), 0, "the process lives");
        drop(running);
        assert!(open().deaths("a", "k") == 0 && markers(folder.path()).unwrap().is_empty());
        // A marker without a lock, as a dead process leaves it.
        let dead = Record { status: Status::Failed, died: true, ..job.clone() };
        for deaths in 1..3 {
            fs::write(folder.path().join(".batch-0aB9zZ.running"), serde_json::to_vec(&dead).unwrap())
                .unwrap();
            assert!(open().deaths("a", "k") == deaths && markers(folder.path()).unwrap().is_empty());
            // That it is left out is no further death.
            open().add(&Record { hint: Some("--force".into()), ..dead.clone() }).unwrap();
            assert_eq!(["a", "b"].map(|job| open().deaths(job, "k")), [deaths, 0]);
            assert_eq!(open().deaths("a", "other"), 0);
        }
        open().add(&job).unwrap();
        assert_eq!(open().deaths("a", "k"), 0);
    }

    #[test]
    fn what_was_done_again_elsewhere_is_known_too() {
        let folder = tempfile::tempdir().unwrap();
        // Without a seed the results of one key differ. The whole batch ran first, then a shard.
        for (shard, text) in [(Shard::WHOLE, "one"), ("1/2".parse().unwrap(), "two")] {
            fs::write(folder.path().join("a.svg"), text).unwrap();
            let written = RecordedFile::of(folder.path(), "a.svg").unwrap();
            Records::open(folder.path(), shard).unwrap().add(&record("a", "k", vec![written])).unwrap();
        }
        let again = Records::open(folder.path(), Shard::WHOLE).unwrap();
        assert!(again.done("a", "k", &["a.svg".into()]).is_some());
    }

    #[test]
    fn a_line_that_was_cut_off_harms_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("batch.jsonl");
        let records = Records::open(folder.path(), Shard::WHOLE).unwrap();
        records.add(&record("a", "k", Vec::new())).unwrap();
        let whole = fs::read(&path).unwrap();
        fs::write(&path, &whole[..whole.len() - 9]).unwrap();
        records.add(&record("b", "k", Vec::new())).unwrap();
        records.add(&record("c", "k", Vec::new())).unwrap();
        let again = Records::open(folder.path(), Shard::WHOLE).unwrap();
        let known = ["a", "b", "c"].map(|job| again.done(job, "k", &[]).is_some());
        assert_eq!(known, [false, true, true]);
    }
}
