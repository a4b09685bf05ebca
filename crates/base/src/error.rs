//! The library's error type: what went wrong, where, and what to try.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Result of every fallible function of the library.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Errors of the library. [`Error::hint`] says what to try.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be opened or read.
    #[error("cannot read '{}': {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file could not be created, written or renamed into place.
    #[error("cannot write '{}': {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file exists, and vtex did not write it or it was changed since.
    #[error("'{}' exists and was {}", path.display(), if *changed { "changed since vtex wrote it" } else { "not written by vtex" })]
    Exists {
        /// The file.
        path: PathBuf,
        /// Whether vtex wrote it, and something else has changed it since.
        changed: bool,
    },
    /// The bytes are not an image that can be decoded.
    #[error("cannot decode '{name}' as an image: {reason}")]
    Decode {
        /// File name, or `-` for standard input.
        name: String,
        /// The decoder's reason.
        reason: String,
    },
    /// A picture of a format, or a kind of it, that is not read.
    #[error("'{name}' is {format}, which vtex does not read")]
    OtherFormat {
        /// File name, or `-` for standard input.
        name: String,
        /// The format with its article, such as `a HEIC picture`.
        format: String,
    },
    /// Something is larger than the limits allow.
    #[error("'{name}' is too large: {found}, the limit is {limit}")]
    TooLarge {
        /// Its kind.
        what: Large,
        /// File name or the parameter concerned.
        name: String,
        /// The value found, with its unit.
        found: String,
        /// The values allowed, with their unit.
        limit: String,
    },
    /// The image cannot be analysed (too small, without any variation …).
    #[error("'{name}' cannot be analysed: {reason}")]
    Unusable {
        /// File name.
        name: String,
        /// Why.
        reason: String,
        /// A hint, as [`Error::hint`] gives it.
        advice: &'static str,
    },
    /// A library, scene or mask file does not follow its format.
    #[error("'{name}' is not a valid {format} file: {reason}")]
    Format {
        /// File name, or `-` for standard input.
        name: String,
        /// The format expected, such as `vtex-library`.
        format: &'static str,
        /// The fault and its place.
        reason: String,
    },
    /// The file was written by a version of the format that is not known here.
    #[error("'{name}' has {format} version {found}; this vtex reads version {known}")]
    Version {
        /// File name.
        name: String,
        /// The format.
        format: &'static str,
        /// The version found.
        found: u64,
        /// The version known.
        known: u64,
    },
    /// A parameter lies outside its range, or a method does not suit what it is for.
    #[error("{}", refused(name, value, allowed))]
    Parameter {
        /// The parameter, with hyphens between words.
        name: &'static str,
        /// The value given.
        value: String,
        /// The range allowed; of a method, what it works for, as in `for a single library`.
        allowed: Cow<'static, str>,
    },
    /// A texture that repeats does not contain whole periods of the lattice.
    #[error("a repeating texture of {width} x {height} px does not contain whole rows{}",
        nearest.map_or(String::new(), |[w, h]| format!(": {w} x {h} px does")))]
    Periods {
        /// Width asked for, in pixels.
        width: u32,
        /// Height asked for, in pixels.
        height: u32,
        /// The nearest size that holds whole periods, if one is near.
        nearest: Option<[u32; 2]>,
    },
    /// The size of a texture that repeats is not a whole number of periods of its drawing.
    #[error(
        "a repeating texture of {} x {} px does not contain whole periods of the drawing, {} x {} px each: {} x {} px \
         does",
        size[0], size[1], period[0], period[1], near[0], near[1]
    )]
    DrawingPeriods {
        /// Width and height asked for, in pixels.
        size: [u32; 2],
        /// Width and height of the drawing's period, in pixels.
        period: [f64; 2],
        /// The nearest size that holds whole periods.
        near: [u32; 2],
    },
    /// Masks do not fit the image.
    #[error("the masks do not fit the image: {0}")]
    Masks(String),
    /// An SVG could not be parsed or drawn.
    #[error("cannot draw '{name}': {reason}")]
    Render {
        /// File name.
        name: String,
        /// Why.
        reason: String,
    },
    /// A pattern was asked for of a scene that does not tile along both axes.
    #[error("a pattern needs a texture that repeats along both axes")]
    Seams,
    /// One ink was asked for of a scene that has several; what its elements have instead.
    #[error("an ink replaces one colour, but the elements have {0}")]
    Inks(String),
    /// A transparent paper was asked for under shapes in its colour.
    #[error("some shapes have the colour of the paper and hide others, so the paper cannot be transparent")]
    Paper,
    /// A tile for the fills of other programs was asked for of a scene that needs more than they read.
    #[error("a tile for fills has no masks and clip paths, which {0} would need")]
    Fill(FillFault),
    /// Two scenes cannot turn into one another.
    #[error("the scenes have different sizes, {}x{} and {}x{}", from[0], from[1], to[0], to[1])]
    Sizes {
        /// Width and height of the first, in pixels.
        from: [u32; 2],
        /// Width and height of the second.
        to: [u32; 2],
    },
    /// The caller asked to stop (see [`crate::Progress`]).
    #[error("interrupted")]
    Interrupted,
    /// Two cages do not define a map of the plane.
    #[error("the cages do not correspond: {0}")]
    Cages(String),
    /// The content of a file that steers synthesis does not suit its use.
    #[error("'{name}' cannot be used as {role}: {reason}")]
    Control {
        /// File name.
        name: String,
        /// Its use, such as `a shape`.
        role: &'static str,
        /// Why not.
        reason: String,
        /// A hint, as [`Error::hint`] gives it.
        advice: &'static str,
    },
    /// A drawing contains an element that vtex does not draw; analysis can leave it out on request.
    #[error("'{name}' cannot be used as a drawing: {reason}")]
    Undrawable {
        /// File name.
        name: String,
        /// The element, and what is wrong with it.
        reason: String,
    },
    /// A library is not one that the scene was made from.
    #[error("'{name}' cannot be used as a library of the scene: {reason}")]
    OtherLibrary {
        /// File name of the exemplar.
        name: String,
        /// Why not.
        reason: String,
    },
    /// A neural network cannot be loaded, recognised or run.
    #[error("network '{name}': {reason}")]
    Network {
        /// File or name of the network.
        name: String,
        /// Why.
        reason: String,
        /// A hint, as [`Error::hint`] gives it.
        advice: &'static str,
    },
    /// ONNX Runtime's shared library cannot be found, loaded or used.
    #[error("network '{name}': {reason}")]
    Runtime {
        /// The library, or the network that needs it.
        name: String,
        /// Why not.
        reason: String,
    },
    /// An engine cannot run a network that it has loaded.
    #[error("network '{name}': {reason}")]
    Engine {
        /// File or name of the network.
        name: String,
        /// The engine, such as `rten`; empty where it is not known.
        engine: &'static str,
        /// Why not.
        reason: String,
    },
    /// An operation on a scene cannot be done.
    #[error("cannot do '{operation}': {fault}")]
    Edit {
        /// The operation as text.
        operation: String,
        /// Its fault.
        fault: EditFault,
    },
    /// No reduction makes a file small enough.
    #[error("no {file} of the scene fits in {most} bytes: the smallest has {smallest}")]
    MaxBytes {
        /// The kind of file, such as `SVG`.
        file: &'static str,
        /// The bytes allowed.
        most: u64,
        /// The bytes of the smallest.
        smallest: u64,
    },
}

/// The kind of what is too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Large {
    /// A file of any kind.
    File,
    /// A picture that is read.
    Picture,
    /// A picture that is drawn.
    Drawn,
    /// A picture that is redrawn in elements.
    Redrawn,
    /// A drawing: its text, its shapes or their curves.
    Drawing,
    /// The canvas of a texture.
    Canvas,
}

/// Content of a scene that fills of other programs do not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FillFault {
    /// A background of several colours, which is masked.
    #[error("a background of several colours")]
    Background,
    /// Soft shading, which is clipped by its element.
    #[error("soft shading")]
    Shading,
    /// A shape that the texture fills, or a layer that covers a part of the canvas.
    #[error("a part of the canvas")]
    Shape,
}

/// A fault of an operation on a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditFault {
    /// A number lies outside its range.
    #[error("{name} = {value} is out of range: {allowed}")]
    Range {
        /// The parameter, named as in `vtex edit`.
        name: &'static str,
        /// The value given.
        value: String,
        /// The range allowed.
        allowed: String,
    },
    /// Thinning has neither a share nor a smallest area.
    #[error("nothing says how much to keep")]
    NothingKept,
    /// Jitter changes neither place nor angle nor size.
    #[error("nothing says what to change")]
    NothingChanged,
    /// Exactly one of several parameters must be given.
    #[error("one of {0} is needed, and only one")]
    NotOneOf(&'static str),
    /// Similar elements are selected, but no element to compare them with is given.
    #[error("nothing says what the others are like")]
    LikeNothing,
    /// Only colours of the background can be changed.
    #[error("it cannot be done to the background")]
    NotForBackground,
    /// A condition on a property that points of the background do not have.
    #[error("the background has no categories, areas and the like")]
    BackgroundCondition,
    /// No layer of the scene has the name or role that the operation is for.
    #[error("the scene has no layer '{name}'")]
    NoLayer {
        /// The name.
        name: String,
        /// The names of the scene's layers.
        known: Vec<String>,
    },
    /// No library of the scene has a category of the name that a condition gives.
    #[error("the scene has no category '{name}'")]
    NoCategory {
        /// The name.
        name: String,
        /// The names of the categories.
        known: Vec<String>,
    },
    /// More lines and curves would be drawn on elements than a scene may hold.
    #[error(
        "{lines} lines and curves on each of {elements} elements are too many: {most} are the most in all"
    )]
    TooMuchDrawn {
        /// Lines and curves of the drawing.
        lines: usize,
        /// Elements that would get them.
        elements: usize,
        /// The most allowed.
        most: usize,
    },
    /// The content of a file that the operation names is missing.
    #[error("the content of '{0}' is not given")]
    NoFile(String),
    /// The resulting scene breaks the invariants of scenes.
    #[error("it leads too far: {0}")]
    TooFar(String),
}

impl Error {
    /// Shorthand for [`Error::Read`].
    pub fn read(path: &Path, source: std::io::Error) -> Self {
        Self::Read { path: path.to_owned(), source }
    }

    /// The error of a writer, which does not know the path that it writes to: [`Error::Write`], unless the
    /// writer passed on an [`Error`].
    pub fn write(path: &Path, source: std::io::Error) -> Self {
        source.downcast().unwrap_or_else(|source| Self::Write { path: path.to_owned(), source })
    }

    /// A hint, in one sentence without a full stop. It names no commands and no options: those
    /// are the program's.
    pub fn hint(&self) -> Option<String> {
        use std::io::ErrorKind;
        Some(match self {
            Self::Read { source, .. } => match source.kind() {
                ErrorKind::NotFound => "check the spelling of the path".into(),
                ErrorKind::PermissionDenied => "the file is there but may not be read by you".into(),
                _ => return None,
            },
            Self::Write { path, source } => match source.kind() {
                ErrorKind::NotFound => "the folder does not exist; create it first".into(),
                ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                    "choose a place that you may write to".into()
                }
                ErrorKind::StorageFull if path == Path::new("-") => "standard output is full".into(),
                ErrorKind::StorageFull => "the disk is full: make room there, or choose another place".into(),
                ErrorKind::FileTooLarge => {
                    "the system limits the size of files (ulimit -f): raise the limit, or write a smaller file"
                        .into()
                }
                ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
                    "a folder is needed where there is a file".into()
                }
                _ => return None,
            },
            Self::Decode { name, .. } if ends_as_svg(name) => {
                "an SVG begins with '<svg' or '<?xml'; is the file complete?".into()
            }
            Self::Decode { .. } => {
                "SVG, PNG, JPEG, TIFF, WebP, BMP, GIF and PNM are read; is the file complete?".into()
            }
            Self::OtherFormat { .. } => "export it as JPEG or PNG".into(),
            Self::TooLarge { what, .. } => match what {
                Large::File => "no file of vtex is as large: is it the right one?",
                Large::Picture => "scale it down first, or crop a part of it",
                Large::Drawing => "simplify it in the program that made it, or leave a part of it out",
                Large::Drawn => "draw it at a smaller scale",
                Large::Redrawn => "ask for larger elements, or for a smaller canvas",
                Large::Canvas => "ask for a smaller canvas",
            }
            .into(),
            Self::DrawingPeriods { near: [w, h], .. } => format!("ask for {w} x {h} px"),
            Self::Undrawable { .. } => {
                "turn it into plain shapes in the program that made it, or delete it".into()
            }
            Self::OtherLibrary { .. } => "give the libraries that the scene was made from".into(),
            Self::Version { found, known, .. } if found > known => {
                "a newer vtex wrote it: update vtex, or write the file again with this version".into()
            }
            Self::Version { .. } => "write the file again with this version of vtex".into(),
            Self::Cages(_) => "draw the second by moving the points of a copy of the first".into(),
            Self::Control { advice, .. } | Self::Unusable { advice, .. } => (*advice).into(),
            Self::Runtime { .. } => "'pip install onnxruntime' brings it".into(),
            Self::Engine { .. } => "is the file complete? Another engine may run it".into(),
            Self::Network { advice, .. } if !advice.is_empty() => (*advice).into(),
            Self::Masks(_) => "masks must have the size of the image they belong to".into(),
            Self::Sizes { .. } => "make both of the same size, or stretch one".into(),
            Self::Inks(_) => "tint the elements instead: that gives one colour to all".into(),
            Self::Paper => "give the paper a colour".into(),
            Self::Fill(FillFault::Background) => "use a background of one colour, or none".into(),
            Self::Fill(FillFault::Shading) => "analyse the photograph with flat shading".into(),
            Self::Fill(FillFault::Shape) => "fill the whole canvas".into(),
            Self::Seams => "synthesise it so that it repeats along both".into(),
            Self::MaxBytes { .. } => "allow more bytes, or make the texture smaller".into(),
            _ => return None,
        })
    }
}

/// For writers, which return [`std::io::Error`]. [`Error::write`] extracts the error again.
impl From<Error> for std::io::Error {
    fn from(error: Error) -> Self {
        Self::other(error)
    }
}

fn ends_as_svg(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.ends_with(".svg") || name.ends_with(".svgz")
}

/// The message about a parameter. Only numbers have a range.
fn refused(name: &str, value: &str, allowed: &str) -> String {
    match name {
        "method" => format!("method = {value} cannot be used here: it works {allowed}"),
        "canvas" | "region" => format!("{name} = {value} is too small: it must be {allowed}"),
        _ => format!("{name} = {value} is out of range: {allowed}"),
    }
}

/// An error naming the parameter unless `ok`.
pub fn check(
    ok: bool,
    name: &'static str,
    value: impl std::fmt::Display,
    allowed: impl Into<Cow<'static, str>>,
) -> Result<()> {
    let refused = || Error::Parameter { name, value: short(&value.to_string()), allowed: allowed.into() };
    if ok { Ok(()) } else { Err(refused()) }
}

/// Runs code of another library; a panic becomes an error with its message.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).map_err(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str);
        said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given").to_owned()
    })
}

/// A number with few digits, for messages.
fn short(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if value.len() > 16 => format!("{number:e}"),
        _ => clip(value),
    }
}

/// The first characters of a hostile string, for an error message.
pub fn clip(text: &str) -> String {
    clip_to(text, 24)
}

/// As [`clip`], with a number of characters.
pub fn clip_to(text: &str, characters: usize) -> String {
    text.chars().take(characters).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_are_out_of_range() {
        let said = |name, value| check(false, name, value, "for a drawing").unwrap_err().to_string();
        assert_eq!(said("scale", "7"), "scale = 7 is out of range: for a drawing");
        assert_eq!(said("method", "curves"), "method = curves cannot be used here: it works for a drawing");
        assert_eq!(said("region", "3 x 4 px"), "region = 3 x 4 px is too small: it must be for a drawing");
    }
}
