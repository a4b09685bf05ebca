//! What is worked on, and what was set: plain data, of which each change makes a copy.

use super::knobs::stage_of;
use super::opened::Opened;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::recipe::sum;
use crate::cli::values::Seed;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vtex::output::file::write_file;
use vtex::output::seal::{Sealed, without_seal};
use vtex::segment::masks_to_bytes;
use vtex_studio::elements::ElementMasks;
use vtex_studio::work::{StudioWork, WorkFile};

/// A file that steers, kept beside the one that is worked on.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct SideFile {
    pub(super) path: PathBuf,
    pub(super) bytes: Vec<u8>,
    pub(super) sha256: String,
    /// Whether it was drawn in the page. Such a file is replaced as the drawing goes on.
    pub(super) drawn: bool,
}

impl SideFile {
    pub(super) fn new(path: PathBuf, bytes: Vec<u8>) -> Self {
        Self { sha256: sum(&bytes), path, bytes, drawn: false }
    }

    /// One that was drawn in the page, of content without a seal.
    pub(super) fn drawn(path: PathBuf, content: Vec<u8>) -> Self {
        let mut sealed = Sealed::new(Vec::new());
        // Writing to memory does not fail.
        let sealed = sealed.write_all(&content).and_then(|()| sealed.finish()).unwrap_or_default();
        Self { drawn: true, ..Self::new(path, sealed) }
    }

    /// What is to be written of a file that was drawn in the page and is not on disk as it is: its content, without the
    /// seal that is added then.
    fn to_be_written(&self) -> Option<Vec<u8>> {
        let same = || std::fs::read(&self.path).is_ok_and(|bytes| bytes == self.bytes);
        let content = || without_seal(&self.bytes).unwrap_or_else(|| self.bytes.clone());
        (self.drawn && !same()).then(content)
    }

    fn of_work(&self) -> WorkFile {
        let file = self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        WorkFile { file, sha256: self.sha256.clone(), drawn: self.drawn }
    }
}

/// What was set.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StudioSettings {
    pub(super) analysis_seed: u64,
    pub(super) seed: u64,
    /// Options of commands, as they are written on the command line.
    pub(super) options: BTreeMap<String, String>,
    /// Operations of `edit`.
    pub(super) operations: Vec<String>,
    /// The file of mended masks, and what it holds.
    pub(super) masks: Option<Arc<SideFile>>,
    pub(super) elements: Option<Arc<ElementMasks>>,
    /// Files of `--density` and `--domain`, by these names, and that of the operation `palette`.
    pub(super) files: BTreeMap<String, Arc<SideFile>>,
}

/// The options of `synth` that name files.
pub(super) const STEERING: [&str; 2] = ["density", "domain"];
/// The operation that reads a file.
pub(super) const PALETTE: &str = "palette";

/// Whether a file may be kept for an option or an operation.
pub(super) fn is_side_file(name: &str) -> bool {
    STEERING.contains(&name) || name == PALETTE
}

impl StudioSettings {
    /// Nothing set but a seed.
    pub(super) fn new(seed: Option<Seed>) -> Self {
        let seed = seed.map_or(1, |seed| seed.0);
        Self { analysis_seed: seed, seed, ..Self::default() }
    }

    /// The content of a file that steers, by its path.
    pub(super) fn file(&self, input: &Input) -> vtex::Result<Vec<u8>> {
        let known = self.files.values().find(|file| file.path == input.path());
        let missing = || vtex::Error::read(input.path(), std::io::ErrorKind::NotFound.into());
        known.map(|file| file.bytes.clone()).ok_or_else(missing)
    }

    /// The same with masks of elements, as the file of a path.
    ///
    /// # Errors
    /// Masks that cannot be written as a file.
    pub(super) fn with_elements(
        &self,
        path: PathBuf,
        size: [u32; 2],
        elements: ElementMasks,
    ) -> vtex::Result<Self> {
        let (scored, given) = (elements.scored(), elements.given_categories());
        let bytes = masks_to_bytes(&path, "studio", size[0], size[1], &scored, &given)?;
        let masks = Some(Arc::new(SideFile::drawn(path, bytes)));
        Ok(Self { masks, elements: Some(Arc::new(elements)), ..self.clone() })
    }

    /// Bytes that it holds and what was set before does not.
    pub(super) fn bytes_beyond(&self, before: Option<&Self>) -> usize {
        let is_new = |file: &Arc<SideFile>| {
            let known = before.into_iter().flat_map(|before| before.files.values().chain(&before.masks));
            known.into_iter().all(|known| !Arc::ptr_eq(known, file))
        };
        // Masks are held twice, as a file and as runs of about as many bytes.
        self.files
            .values()
            .chain(&self.masks)
            .filter(|file| is_new(file))
            .map(|file| 2 * file.bytes.len())
            .sum()
    }

    /// The document of the work.
    pub(super) fn work(&self, opened: &Opened) -> StudioWork {
        let input =
            SideFile { sha256: opened.sha256.clone(), ..SideFile::new(opened.path.clone(), Vec::new()) };
        let mut files: BTreeMap<String, WorkFile> =
            self.files.iter().map(|(option, file)| (option.clone(), file.of_work())).collect();
        files.extend(self.masks.iter().map(|masks| ("masks".to_owned(), masks.of_work())));
        StudioWork {
            format: StudioWork::FORMAT.into(),
            version: StudioWork::VERSION,
            input: input.of_work(),
            analysis_seed: self.analysis_seed,
            seed: self.seed,
            options: self.options.clone(),
            operations: self.operations.clone(),
            files,
        }
    }

    /// Writes the masks and drawings that the document of the work refers to, and then the document.
    ///
    /// # Errors
    /// Those of [`write_file`].
    pub(super) fn keep(&self, opened: &Opened) -> vtex::Result<()> {
        let put = |path: &Path, bytes: &[u8]| write_file(path, false, |out| out.write_all(bytes)).map(|_| ());
        for file in self.files.values().chain(&self.masks) {
            file.to_be_written().map_or(Ok(()), |content| put(&file.path, &content))?;
        }
        put(&opened.work_path(), &self.work(opened).to_json())
    }

    /// What a document of work says, if it is about the file that was opened.
    ///
    /// # Errors
    /// A document that cannot be read, of other content, or whose files are missing or changed.
    pub(super) fn restored(opened: &Opened, work: &StudioWork) -> anyhow::Result<Self> {
        if work.input.sha256 != opened.sha256 {
            return Err(Failure::failed("the file has changed since it was worked on").into());
        }
        if let Some(name) = work.options.keys().find(|name| stage_of(name).is_none()) {
            return Err(Failure::failed(format!("there is no option '{name}'")).into());
        }
        let read = |file: &WorkFile| -> anyhow::Result<SideFile> {
            // A document names files only, which `StudioWork` has checked.
            let path = opened.path.with_file_name(&file.file);
            Ok(SideFile::new(path.clone(), Input::File(path).read()?))
        };
        let unchanged = |file: &WorkFile| -> anyhow::Result<SideFile> {
            let read = read(file)?;
            if read.sha256 != file.sha256 {
                let message = format!("'{}' has changed since it was used", read.path.display());
                return Err(Failure::failed(message).into());
            }
            Ok(read)
        };
        let mut settings = Self {
            analysis_seed: work.analysis_seed,
            seed: work.seed,
            options: work.options.clone(),
            operations: work.operations.clone(),
            ..Self::default()
        };
        for (option, file) in &work.files {
            match (&option[..], opened.size) {
                ("masks", Some(size)) => {
                    // Masks are written before the document: newer ones are those of the last change.
                    let file = read(file)?;
                    settings.elements = Some(Arc::new(elements_of(&file, size)?));
                    settings.masks = Some(Arc::new(SideFile { drawn: true, ..file }));
                }
                (option, _) if is_side_file(option) && file.drawn => {
                    // Like masks.
                    let drawn = SideFile { drawn: true, ..read(file)? };
                    settings.files.insert(option.to_owned(), Arc::new(drawn));
                }
                (option, _) if is_side_file(option) => {
                    settings.files.insert(option.to_owned(), Arc::new(unchanged(file)?));
                }
                _ => return Err(Failure::failed(format!("there is no file of '{option}'")).into()),
            }
        }
        Ok(settings)
    }
}

/// The masks of a file.
fn elements_of(file: &SideFile, size: [u32; 2]) -> vtex::Result<ElementMasks> {
    use vtex::segment::{MasksFile, Segmenter};
    let masks = MasksFile::from_bytes(file.bytes.clone(), &file.path.display().to_string())?;
    let blank = image::RgbImage::new(size[0], size[1]);
    let found = masks.segment(&blank, &())?;
    let elements = ElementMasks::new(size, found.into_iter().map(|scored| scored.mask));
    Ok(elements.with_categories(&masks.categories(size)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex::raster::{Mask, Span};

    #[test]
    fn newer_masks_are_taken_up_and_other_changed_files_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let opened = Opened::picture(folder.path().join("leaf.png"));
        let mask = |x1: i32| Mask::from_spans(vec![Span { y: 2, x0: 1, x1 }]);
        let elements = |x1| ElementMasks::new([40, 40], [mask(x1)]);
        let path = folder.path().join("leaf.masks.json");
        let with =
            |x1| StudioSettings::new(None).with_elements(path.clone(), [40, 40], elements(x1)).unwrap();
        with(4).keep(&opened).unwrap();
        let document = StudioWork::read(&opened.work_path()).unwrap();
        // Ended between the masks and the document.
        let newer = with(6);
        std::fs::write(&path, &newer.masks.as_ref().unwrap().bytes).unwrap();
        let restored = StudioSettings::restored(&opened, &document).unwrap();
        assert_eq!(restored.elements, newer.elements);
        let mut steered = StudioSettings::new(None);
        let shape = folder.path().join("shape.svg");
        std::fs::write(&shape, b"1").unwrap();
        steered.files.insert("domain".into(), Arc::new(SideFile::new(shape.clone(), b"1".to_vec())));
        let document = steered.work(&opened);
        assert!(StudioSettings::restored(&opened, &document).is_ok());
        std::fs::write(shape, b"2").unwrap();
        assert!(StudioSettings::restored(&opened, &document).is_err());
    }
}
