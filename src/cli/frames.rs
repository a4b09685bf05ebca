//! Writes a sequence of scenes as files in a folder or as one animated file.

use super::options::frames::digits;
use super::output::{Destination, DrawingOptions, Target, WrittenFile};
use super::progress::Reporter;
use std::cmp::Reverse;
use std::path::Path;
use vtex::output::file::FileKind;
use vtex::output::raster_animation::RasterAnimation;
use vtex::output::reduce::GivenUp;
use vtex::scene::Scene;
use vtex::{Error, Progress};

/// Scenes to be written as frames.
pub(crate) struct Frames<'a> {
    pub(crate) reporter: &'a Reporter,
    pub(crate) drawing: DrawingOptions<'static>,
    pub(crate) animation: RasterAnimation,
    /// The scene of each frame, from 0.
    pub(crate) scene: &'a dyn Fn(u32) -> Scene,
}

impl Frames<'_> {
    /// Frame `k`, reported.
    fn frame(&self, k: u32) -> vtex::Result<Scene> {
        let go_on = self.reporter.advance("drawing", u64::from(k), u64::from(self.animation.frames));
        if go_on { Ok((self.scene)(k)) } else { Err(Error::Interrupted) }
    }

    /// Writes each frame to a file named by its number; `force` replaces files that vtex did not write.
    pub(crate) fn write_files(
        &self,
        folder: &Path,
        (kind, force): (FileKind, bool),
    ) -> anyhow::Result<WrittenFile> {
        std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
        let count = self.animation.frames;
        let name =
            |k: u32| folder.join(format!("frame_{k:0digits$}{}", kind.ending().text, digits = digits(count)));
        let mut written = WrittenFile::default();
        for k in 0..count {
            let target = Target { place: Destination::File { path: name(k + 1), force }, kind };
            let one = target.write_scene(&self.frame(k)?, self.drawing)?;
            written.bytes += one.bytes;
            one.warnings.iter().for_each(|warning| self.reporter.warn(warning));
            // The largest reductions of any frame.
            let lost = |given: &GivenUp| (given.details + given.elements, Reverse(given.decimals));
            written.given_up = written.given_up.into_iter().chain(one.given_up).max_by_key(lost);
        }
        if name(count + 1).exists() {
            self.reporter.warn(&format!(
                "the folder contains frames of another animation as well, from '{}' on",
                name(count + 1).display()
            ));
        }
        Ok(written)
    }

    /// One GIF.
    pub(crate) fn write_gif(&self, place: &Destination) -> anyhow::Result<WrittenFile> {
        let picture = |k: u32| self.drawing.picture(&self.frame(k)?);
        Ok(WrittenFile::of(place.write(|out| self.animation.write_gif(picture, out))?.1))
    }

    /// One animated PNG, without transparency if `opaque`.
    pub(crate) fn write_png(&self, place: &Destination, opaque: bool) -> anyhow::Result<WrittenFile> {
        let picture = |k: u32| self.drawing.picture(&self.frame(k)?);
        Ok(WrittenFile::of(place.write(|out| self.animation.write_png(opaque, picture, out))?.1))
    }
}
