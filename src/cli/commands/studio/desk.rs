//! What is worked on, and what was set: plain data, of which each change makes a copy.

use super::knobs::stage_of;
use crate::cli::failure::Failure;
use crate::cli::input::{Input, InputKind};
use crate::cli::recipe::sum;
use crate::cli::values::Seed;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vtex::analyze::{Exemplar, Limits};
use vtex::output::file::write_file;
use vtex::output::seal::Sealed;
use vtex::output::{png, raster_svg};
use vtex::segment::masks_to_bytes;
use vtex_studio::elements::ElementMasks;
use vtex_studio::work::{StudioWork, WorkFile, file_name};

/// The ending of documents of work.
pub(super) const DOCUMENT: &str = ".vtex-studio.json";
/// Largest side of the photograph that the page shows, in pixels.
const SHOWN: u32 = 2400;

/// A file that is worked on.
pub(super) struct Opened {
    pub(super) kind: InputKind,
    /// Its path, as in command lines.
    pub(super) path: PathBuf,
    /// Its content.
    pub(super) bytes: Vec<u8>,
    pub(super) sha256: String,
    /// Width and height of a photograph, in pixels, or of a drawing, in its units.
    pub(super) size: Option<[u32; 2]>,
    /// A picture of a photograph or drawing: a PNG.
    pub(super) picture: Option<Vec<u8>>,
    /// The document of its work, where that has a name of its own.
    pub(super) document: Option<PathBuf>,
}

impl Opened {
    /// Reads what the page can work on.
    ///
    /// # Errors
    /// Content of another kind, or that cannot be decoded.
    pub(super) fn new(path: PathBuf, bytes: Vec<u8>) -> anyhow::Result<Self> {
        let input = Input::File(path.clone());
        let wanted = [InputKind::Image, InputKind::Svg, InputKind::Library, InputKind::Scene];
        let kind = InputKind::expect(&bytes, &input, &wanted)?;
        let (size, picture) = match kind {
            InputKind::Image => {
                let image = Exemplar::from_bytes(&bytes, &input.name(), &Limits::default())?.image;
                let size = [image.width(), image.height()];
                let share = f64::from(SHOWN) / f64::from(size[0].max(size[1]));
                let mut drawn = Vec::new();
                if share < 1.0 {
                    let [w, h] = size.map(|side| ((f64::from(side) * share) as u32).max(1));
                    png::encode_rgb(&image::imageops::thumbnail(&image, w, h), &mut drawn)?;
                } else {
                    png::encode_rgb(&image, &mut drawn)?;
                }
                (Some(size), Some(drawn))
            }
            InputKind::Svg => {
                let drawn = raster_svg::render_svg(&bytes, 1.0, &input.name(), &())?;
                let mut picture = Vec::new();
                png::encode(&drawn, None, &mut picture)?;
                (Some([drawn.width(), drawn.height()]), Some(picture))
            }
            _ => (None, None),
        };
        Ok(Self { kind, sha256: sum(&bytes), path, bytes, size, picture, document: None })
    }

    /// The path of a file beside it, named after it.
    pub(super) fn beside(&self, ending: &str) -> PathBuf {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let endings = [".lib.json.gz", ".scene.json.gz", ".lib.json", ".scene.json"];
        let stem = endings.iter().find_map(|known| name.strip_suffix(known));
        let stem = stem.unwrap_or_else(|| name.rsplit_once('.').map_or(&name[..], |(stem, _)| stem));
        self.path.with_file_name(format!("{stem}{ending}"))
    }

    /// The path of the document of its work. The ending of the file stays in its name: a photograph and the library
    /// made of it are worked on apart.
    pub(super) fn work_path(&self) -> PathBuf {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        self.document.clone().unwrap_or_else(|| self.path.with_file_name(format!("{name}{DOCUMENT}")))
    }
}

/// A file that steers, kept beside the one that is worked on.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct SideFile {
    pub(super) path: PathBuf,
    pub(super) bytes: Vec<u8>,
    pub(super) sha256: String,
}

impl SideFile {
    pub(super) fn new(path: PathBuf, bytes: Vec<u8>) -> Self {
        Self { sha256: sum(&bytes), path, bytes }
    }

    fn of_work(&self) -> WorkFile {
        let file = self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        WorkFile { file, sha256: self.sha256.clone() }
    }
}

/// What was set.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Desk {
    pub(super) analysis_seed: u64,
    pub(super) seed: u64,
    /// Options of commands, as they are written on the command line.
    pub(super) options: BTreeMap<String, String>,
    /// Operations of `edit`.
    pub(super) operations: Vec<String>,
    /// The file of mended masks, and what it holds.
    pub(super) masks: Option<Arc<SideFile>>,
    pub(super) elements: Option<Arc<ElementMasks>>,
    /// Files of `--density` and `--domain`, by these names.
    pub(super) files: BTreeMap<String, Arc<SideFile>>,
}

/// The options of files that steer.
pub(super) const SIDE_FILES: [&str; 2] = ["density", "domain"];

impl Desk {
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
        let bytes = masks_to_bytes(&path, "studio", size[0], size[1], &elements.scored())?;
        let mut sealed = Sealed::new(Vec::new());
        let sealed = sealed.write_all(&bytes).and_then(|()| sealed.finish());
        let bytes = sealed.map_err(|e| vtex::Error::write(&path, e))?;
        let masks = Some(Arc::new(SideFile::new(path, bytes)));
        Ok(Self { masks, elements: Some(Arc::new(elements)), ..self.clone() })
    }

    /// The document of the work.
    pub(super) fn work(&self, opened: &Opened) -> StudioWork {
        let input = SideFile { path: opened.path.clone(), bytes: Vec::new(), sha256: opened.sha256.clone() };
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

    /// Writes the masks that the document of the work refers to, and then the document.
    ///
    /// # Errors
    /// Those of [`write_file`].
    pub(super) fn keep(&self, opened: &Opened) -> vtex::Result<()> {
        let put = |path: &Path, bytes: &[u8]| write_file(path, false, |out| out.write_all(bytes)).map(|_| ());
        if let Some(masks) = &self.masks
            && !same_content(masks)
        {
            // It is sealed as it is written.
            let unsealed = self.elements.as_ref().map_or_else(Vec::new, |elements| elements.scored());
            let [w, h] = opened.size.unwrap_or_default();
            put(&masks.path, &masks_to_bytes(&masks.path, "studio", w, h, &unsealed)?)?;
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
        let mut desk = Self {
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
                    desk.elements = Some(Arc::new(elements_of(&file, size)?));
                    desk.masks = Some(Arc::new(file));
                }
                (option, _) if SIDE_FILES.contains(&option) => {
                    desk.files.insert(option.to_owned(), Arc::new(unchanged(file)?));
                }
                _ => return Err(Failure::failed(format!("there is no file of '{option}'")).into()),
            }
        }
        Ok(desk)
    }
}

/// Whether a file on disk holds what is in memory.
fn same_content(file: &SideFile) -> bool {
    std::fs::read(&file.path).is_ok_and(|bytes| bytes == file.bytes)
}

/// The masks of a file.
fn elements_of(file: &SideFile, size: [u32; 2]) -> vtex::Result<ElementMasks> {
    use vtex::segment::{MasksFile, Segmenter};
    let masks = MasksFile::from_bytes(file.bytes.clone(), &file.path.display().to_string())?;
    let blank = image::RgbImage::new(size[0], size[1]);
    let found = masks.segment(&blank, &())?;
    Ok(ElementMasks::new(size, found.into_iter().map(|scored| scored.mask)))
}

/// Puts a file that the page sent into a folder, under its own name, or a numbered one if there is another file
/// of that name. Nothing is replaced.
///
/// # Errors
/// A name of which nothing is left; a folder that cannot be written to.
pub(super) fn put_beside(folder: &Path, given: &str, bytes: &[u8]) -> anyhow::Result<PathBuf> {
    let name = file_name(given).ok_or_else(|| Failure::failed("the file has no usable name"))?;
    let (stem, ending) =
        name.split_once('.').map_or((&name[..], String::new()), |(s, e)| (s, format!(".{e}")));
    for number in 1..=100 {
        let numbered = if number == 1 { name.clone() } else { format!("{stem}-{number}{ending}") };
        let path = folder.join(numbered);
        match std::fs::File::create_new(&path) {
            Ok(mut file) => {
                let written = file.write_all(bytes).and_then(|()| file.sync_all());
                return match written {
                    Ok(()) => Ok(path),
                    Err(e) => {
                        let _ = std::fs::remove_file(&path);
                        Err(vtex::Error::write(&path, e).into())
                    }
                };
            }
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {
                if std::fs::read(&path).is_ok_and(|old| old == bytes) {
                    return Ok(path);
                }
            }
            Err(e) => return Err(vtex::Error::write(&path, e).into()),
        }
    }
    Err(Failure::failed(format!("there are too many files named '{name}'")).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex::raster::{Mask, Span};

    fn opened(path: PathBuf) -> Opened {
        let mut png = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(40, 40, |x, y| image::Rgb([x as u8, y as u8, 9]));
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        Opened::new(path, png.into_inner()).unwrap()
    }

    #[test]
    fn files_of_one_stem_are_worked_on_apart() {
        let [first, second] = ["a/leaf.jpg", "a/leaf.png"].map(|path| opened(path.into()));
        assert_eq!(first.work_path(), Path::new("a/leaf.jpg.vtex-studio.json"));
        assert_ne!(first.work_path(), second.work_path());
        let named = Opened { document: Some("a/copy.vtex-studio.json".into()), ..second };
        assert_eq!(named.work_path(), Path::new("a/copy.vtex-studio.json"));
    }

    #[test]
    fn newer_masks_are_taken_up_and_other_changed_files_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let opened = opened(folder.path().join("leaf.png"));
        let mask = |x1: i32| Mask::from_spans(vec![Span { y: 2, x0: 1, x1 }]);
        let elements = |x1| ElementMasks::new([40, 40], [mask(x1)]);
        let path = folder.path().join("leaf.masks.json");
        let with = |x1| Desk::new(None).with_elements(path.clone(), [40, 40], elements(x1)).unwrap();
        with(4).keep(&opened).unwrap();
        let document = StudioWork::read(&opened.work_path()).unwrap();
        // Ended between the masks and the document.
        let newer = with(6);
        std::fs::write(&path, &newer.masks.as_ref().unwrap().bytes).unwrap();
        let restored = Desk::restored(&opened, &document).unwrap();
        assert_eq!(restored.elements, newer.elements);
        let mut steered = Desk::new(None);
        let shape = folder.path().join("shape.svg");
        std::fs::write(&shape, b"1").unwrap();
        steered.files.insert("domain".into(), Arc::new(SideFile::new(shape.clone(), b"1".to_vec())));
        let document = steered.work(&opened);
        assert!(Desk::restored(&opened, &document).is_ok());
        std::fs::write(shape, b"2").unwrap();
        assert!(Desk::restored(&opened, &document).is_err());
    }

    #[test]
    fn files_of_the_page_replace_nothing_and_leave_the_folder_not() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, bytes: &[u8]| put_beside(folder.path(), name, bytes).unwrap();
        let first = put("../../leaf.tar.gz", b"1");
        assert_eq!(first, folder.path().join("leaf.tar.gz"));
        assert_eq!(put("leaf.tar.gz", b"1"), first);
        assert_eq!(put("leaf.tar.gz", b"2"), folder.path().join("leaf-2.tar.gz"));
        assert_eq!(std::fs::read(first).unwrap(), b"1");
        assert!(put_beside(folder.path(), "..", b"").is_err());
    }
}
