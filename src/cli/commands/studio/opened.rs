//! Files that are worked on, and those that the page sends.

use crate::cli::failure::Failure;
use crate::cli::format::stem;
use crate::cli::input::{Input, InputKind};
use crate::cli::recipe::sum;
use std::io::Write;
use std::path::{Path, PathBuf};
use vtex::analyze::{Exemplar, Limits};
use vtex::output::{png, raster_svg};
use vtex_studio::work::file_name;

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
                let image = Exemplar::tile_from_bytes(&bytes, &input.name(), &Limits::default())?.image;
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
                png::encode(&drawn, None, None, &mut picture)?;
                (Some([drawn.width(), drawn.height()]), Some(picture))
            }
            _ => (None, None),
        };
        Ok(Self { kind, sha256: sum(&bytes), path, bytes, size, picture, document: None })
    }

    /// The path of a file beside it, named after it.
    pub(super) fn beside(&self, ending: &str) -> PathBuf {
        let mut name = stem(&self.path);
        name.push(ending);
        self.path.with_file_name(name)
    }

    /// The path of the document of its work. The ending of the file stays in its name: a photograph and the library
    /// made of it are worked on apart.
    pub(super) fn work_path(&self) -> PathBuf {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        self.document.clone().unwrap_or_else(|| self.path.with_file_name(format!("{name}{DOCUMENT}")))
    }
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
impl Opened {
    /// A picture of 40 × 40 pixels, for tests.
    pub(super) fn picture(path: PathBuf) -> Self {
        let mut png = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(40, 40, |x, y| image::Rgb([x as u8, y as u8, 9]));
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        Self::new(path, png.into_inner()).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_one_stem_are_worked_on_apart() {
        let [first, second] = ["a/leaf.jpg", "a/leaf.png"].map(|path| Opened::picture(path.into()));
        assert_eq!(first.work_path(), Path::new("a/leaf.jpg.vtex-studio.json"));
        assert_ne!(first.work_path(), second.work_path());
        let named = Opened { document: Some("a/copy.vtex-studio.json".into()), ..second };
        assert_eq!(named.work_path(), Path::new("a/copy.vtex-studio.json"));
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
