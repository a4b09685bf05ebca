//! Scenes as files of any format: the one place that reduces them to a number of bytes and packs them.

use super::formats::{FileKind, Uses, WriteOptions, endings};
use super::reduce::{self, GivenUp};
use super::seal::Sealed;
use super::svg::SvgOptions;
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::io::{self, Write};
use std::str::FromStr;
use vtex_base::Progress;
use vtex_base::error::{Error, Result};
use vtex_base::raster::colour::Colour;
use vtex_base::raster::css;
use vtex_scene::scene::Scene;

/// A scene and all that decides on its file.
pub struct PreparedFile<'a> {
    kind: FileKind,
    scene: Cow<'a, Scene>,
    options: WriteOptions<'a>,
    /// The reductions that made it small enough, if any.
    pub given_up: Option<GivenUp>,
}

impl<'a> PreparedFile<'a> {
    /// Decides on the decimals that the scene needs, and reduces it to the maximum number of bytes, if there is one and
    /// the format uses it. `progress` may stop this.
    ///
    /// # Errors
    /// Those of the writer and of [`reduce::to_fit`]; [`Error::Interrupted`].
    pub fn new(
        kind: FileKind,
        scene: &'a Scene,
        options: WriteOptions<'a>,
        progress: &dyn Progress,
    ) -> io::Result<Self> {
        let options = WriteOptions { svg: options.svg.fit(scene), ..options };
        let Some(most) = options.max_bytes.filter(|_| kind.format.uses().max_bytes) else {
            return Ok(Self { kind, scene: Cow::Borrowed(scene), options, given_up: None });
        };
        let measure = |scene: &Scene, svg: &SvgOptions| {
            let options = WriteOptions { svg: *svg, ..options };
            let mut out = Sealed::new(ReportedBytes { progress, count: 0 });
            write(kind, scene, &options, progress, &mut out)?;
            io::Result::Ok(out.finish()?.count)
        };
        let reduced = reduce::to_fit(scene, &options.svg, most, measure).map_err(|e| of_kind(kind, e))?;
        let options = WriteOptions { svg: reduced.options, ..options };
        Ok(Self { kind, scene: reduced.scene, options, given_up: reduced.given_up })
    }

    /// Writes the file. Returns warnings for the user, a sentence each. `progress` may stop the drawing of pixels.
    ///
    /// # Errors
    /// Those of the writer; [`Error::Interrupted`].
    pub fn write(&self, progress: &dyn Progress, out: &mut dyn Write) -> io::Result<Vec<String>> {
        write(self.kind, &self.scene, &self.options, progress, out)
    }
}

fn write(
    kind: FileKind,
    scene: &Scene,
    options: &WriteOptions<'_>,
    progress: &dyn Progress,
    out: &mut dyn Write,
) -> io::Result<Vec<String>> {
    let Some(write) = kind.format.writer().write else {
        return Err(io::Error::new(io::ErrorKind::Unsupported, "a library contains no scene"));
    };
    kind.pack(out, |out| write(scene, options, progress, out))
}

/// An error that names the kind of file.
fn of_kind(kind: FileKind, error: io::Error) -> io::Error {
    match error.downcast::<Error>() {
        Ok(Error::MaxBytes { most, smallest, .. }) => {
            Error::MaxBytes { file: kind.ending().title, most, smallest }.into()
        }
        Ok(other) => other.into(),
        Err(other) => other,
    }
}

/// The endings of the formats that use an option, in words, such as `.svg, .svgz and .pdf`.
pub fn users_of(option: fn(&Uses) -> bool) -> String {
    match &endings(|format| option(&format.uses()))[..] {
        [others @ .., last] if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        few => few.concat(),
    }
}

/// The ending of the packed form of files that messages call `title`: `.svgz` for `SVG`. `None` for files that are
/// packed, or never are.
pub fn packed_ending(title: &str) -> Option<&'static str> {
    let kind = FileKind::all().find(|kind| kind.ending().title == title && !kind.gzip)?;
    kind.format.writer().endings.iter().find(|ending| ending.gzip).map(|ending| ending.text)
}

/// A scene in another ink and with another background, where these are given.
///
/// # Errors
/// Those of [`Scene::with_ink`].
pub fn coloured<'s>(
    scene: Cow<'s, Scene>,
    ink: Option<Colour>,
    background: Option<BackgroundChoice>,
) -> Result<Cow<'s, Scene>> {
    let paper = background.map(BackgroundChoice::colour);
    Ok(match (ink, paper) {
        (None, None) => scene,
        (None, Some(paper)) => Cow::Owned(scene.into_owned().with_background(paper)),
        (Some(ink), paper) => Cow::Owned(scene.into_owned().with_ink(ink, paper)?),
    })
}

/// The background between the elements, in place of the scene's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackgroundChoice {
    /// One colour.
    Colour(Colour),
    /// Nothing.
    None,
}

impl BackgroundChoice {
    /// The colour, if there is one.
    pub fn colour(self) -> Option<Colour> {
        match self {
            Self::Colour(colour) => Some(colour),
            Self::None => None,
        }
    }
}

impl FromStr for BackgroundChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "none" || text == "transparent" {
            return Ok(Self::None);
        }
        let expected = || "expected #rrggbb, #rgb or a name such as red, or none".into();
        css::colour(text).map(Self::Colour).ok_or_else(expected)
    }
}

impl Serialize for BackgroundChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Colour(colour) => colour.serialize(serializer),
            Self::None => serializer.serialize_str("none"),
        }
    }
}

/// Counts and reports the bytes that are written to it. It fails when the user stops.
struct ReportedBytes<'a> {
    progress: &'a dyn Progress,
    count: u64,
}

impl Write for ReportedBytes<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        vtex_base::progress::advance(self.progress, "writing", self.count, 0)?;
        self.count += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::Format;
    use crate::testing;

    fn written(kind: FileKind, scene: &Scene, options: WriteOptions<'_>) -> io::Result<Vec<u8>> {
        let mut out = Vec::new();
        PreparedFile::new(kind, scene, options, &())?.write(&(), &mut out)?;
        Ok(out)
    }

    #[test]
    fn every_format_of_scenes_is_written_as_its_signature_says() {
        let scene = testing::scene(60, 50, 1);
        for kind in FileKind::all() {
            let Ok(bytes) = written(kind, &scene, WriteOptions::default()) else {
                assert!(!kind.format.is_of_scene(), "{kind:?}");
                continue;
            };
            let unpacked = vtex_base::gzip::beginning(&bytes, usize::MAX);
            assert_eq!(kind.gzip, unpacked.len() != bytes.len(), "{kind:?}");
            let signature = kind.format.writer().signature;
            assert!(unpacked.starts_with(signature.beginning), "{kind:?}");
            assert!(kind.gzip || unpacked.ends_with(signature.end), "{kind:?}");
            assert!((signature.is_own)(&unpacked, &mut io::empty()).unwrap(), "{kind:?}");
        }
    }

    #[test]
    fn formats_keep_to_the_maximum_if_they_say_so() {
        let scene = testing::scene(200, 160, 2);
        for kind in FileKind::all().filter(|kind| kind.format.is_of_scene()) {
            let whole = written(kind, &scene, WriteOptions::default()).unwrap();
            let most = whole.len() as u64 * 9 / 10;
            let options = WriteOptions { max_bytes: Some(most), ..WriteOptions::default() };
            let small = written(kind, &scene, options).unwrap();
            assert_eq!(small.len() as u64 <= most, kind.format.uses().max_bytes, "{kind:?}");
            let options = WriteOptions { max_bytes: Some(1), ..options };
            match written(kind, &scene, options).map_err(io::Error::downcast::<Error>) {
                Ok(bytes) => assert_eq!(bytes, whole),
                Err(Ok(Error::MaxBytes { file, .. })) => assert_eq!(file, kind.ending().title),
                Err(other) => panic!("{kind:?}: {other:?}"),
            }
        }
    }

    #[test]
    fn formats_have_a_scale_if_they_say_so() {
        let scene = testing::scene(60, 50, 3);
        for kind in FileKind::all().filter(|kind| kind.format.is_of_scene()) {
            let [one, two] = [1.0, 2.0].map(|scale| {
                written(kind, &scene, WriteOptions { scale, ..WriteOptions::default() }).unwrap()
            });
            assert_eq!(one != two, kind.format.uses().scale, "{kind:?}");
        }
    }

    #[test]
    fn drawings_on_small_pages_have_two_decimals() {
        let mut scene = testing::scene(60, 50, 4);
        let kind = FileKind { format: Format::Svg, gzip: false };
        let of = |scene: &Scene, precision| {
            let svg = SvgOptions { precision, ..SvgOptions::default() };
            written(kind, scene, WriteOptions { svg, ..WriteOptions::default() }).unwrap()
        };
        assert_ne!(of(&scene, 1), of(&scene, 2));
        scene.libraries[0].fine = true;
        assert_eq!(of(&scene, 1), of(&scene, 2));
        assert_ne!(of(&scene, 0), of(&scene, 1), "fewer are fewer");
    }

    #[test]
    fn work_on_a_file_can_be_stopped() {
        struct Stopped;
        impl Progress for Stopped {
            fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
                false
            }
        }
        let scene = testing::scene(60, 50, 5);
        let stopped = |error: io::Error| matches!(error.downcast::<Error>(), Ok(Error::Interrupted));
        let options = WriteOptions { max_bytes: Some(1), ..WriteOptions::default() };
        let kind = |format| FileKind { format, gzip: false };
        assert!(stopped(PreparedFile::new(kind(Format::Svg), &scene, options, &Stopped).err().unwrap()));
        let picture = PreparedFile::new(kind(Format::Png), &scene, options, &Stopped).unwrap();
        assert!(stopped(picture.write(&Stopped, &mut io::sink()).unwrap_err()));
    }

    #[test]
    fn words_name_formats() {
        assert_eq!(users_of(|uses| uses.max_bytes), ".svg, .svgz and .pdf");
        assert_eq!(users_of(|uses| uses.scale), ".png");
        assert_eq!(
            [packed_ending("SVG"), packed_ending("SVGZ"), packed_ending("PDF")],
            [Some(".svgz"), None, None]
        );
    }

    #[test]
    fn backgrounds_are_read() {
        for (text, expected) in [
            ("none", Some(BackgroundChoice::None)),
            ("transparent", Some(BackgroundChoice::None)),
            ("#102030", Some(BackgroundChoice::Colour(Colour([16, 32, 48])))),
            ("nothing", None),
        ] {
            assert_eq!(text.parse().ok(), expected, "{text}");
        }
    }
}
