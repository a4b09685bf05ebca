//! Hints for errors of the library, with commands and options.

use std::io::ErrorKind;
use std::path::Path;
use vtex::Error;
use vtex::error::{EditFault, FillFault, Large};
use vtex::library::{Library, SourceKind};
use vtex::output::file::packed_ending;
use vtex::scene::{Method, SynthParams};

/// The note of a page on a photograph that was not found.
pub(crate) const PHOTO: &str = "Name it with --exemplar.";

/// A hint for a photograph in which analysis finds the wrong elements.
pub(crate) fn of_library(library: &Library) -> Option<&'static str> {
    let (primaries, most) = (library.primaries().len(), library.source.parameters.max_paths as usize);
    if primaries == 0 {
        Some("--segmenter finds elements in other ways, --masks takes them from a file")
    } else if most > 0 && primaries > most {
        Some("a larger --minimum-area leaves fewer primary elements")
    } else {
        None
    }
}

/// A hint for a texture without elements, of libraries that have some.
pub(crate) fn of_no_elements(libraries: &[Library], asked: &SynthParams) -> Option<&'static str> {
    let mut primaries = libraries.iter().flat_map(Library::primaries).peekable();
    // Whoever excludes categories expects few elements.
    if primaries.peek().is_none() || !asked.exclude.is_empty() {
        return None;
    }
    let is_drawing = libraries.iter().all(|library| library.source.kind == SourceKind::Drawing);
    Some(if primaries.any(|primary| !primary.clipped) {
        "give a larger --size, or a --domain or --density with more room"
    } else if !is_drawing {
        "use a larger photograph, which shows elements as a whole"
    } else if asked.method != Method::Auto {
        "leave out --method, so that vtex chooses one that fits"
    } else {
        "leave out --density and --weights: with one of them a drawing is not repeated as it is"
    })
}

/// Whether a path is a pattern that a shell should have replaced.
fn is_pattern(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?'])
}

/// The hint for an error, one sentence without a full stop. Errors without a hint of the command line have
/// that of the library.
pub(crate) fn hint(error: &Error) -> Option<String> {
    let text = match error {
        Error::Read { path, source } if source.kind() == ErrorKind::NotFound && is_pattern(path) => {
            "the shell found no file of this pattern, or does not expand it: name the files, or give 'vtex batch' \
             their folder"
        }
        Error::Read { source, .. } if source.kind() == ErrorKind::IsADirectory => {
            "name a file; 'vtex batch' takes folders"
        }
        Error::Version { found, known, .. } if found > known => {
            "a newer vtex wrote it: update vtex, or write the file again with this one"
        }
        Error::Exists { .. } => "give another name with -o, or --force to replace it",
        Error::TooLarge { what: Large::Canvas, .. } => "ask for a smaller --size",
        Error::TooLarge { what: Large::Drawn, .. } => "give a smaller --scale, or a file with a smaller page",
        Error::TooLarge { what: Large::Redrawn, .. } => {
            "give a larger --element-size, or a smaller --longer-side"
        }
        Error::Format { format: "vtex-library", .. } => {
            "make a library with 'vtex analyze photo.jpg' or 'vtex analyze drawing.svg'"
        }
        Error::Format { format: "vtex-scene", .. } => {
            "make a scene with 'vtex synth photo.lib.json -o out.scene.json'"
        }
        Error::Format { format: "vtex-weights", .. } => "search weights with 'vtex tune photo.lib.json'",
        Error::Runtime { .. } => {
            "'pip install onnxruntime' brings it; name its libonnxruntime.so (.dylib, onnxruntime.dll) with \
             --onnxruntime, or use --engine rten"
        }
        Error::Engine { engine: "rten", .. } => "try --engine onnxruntime",
        Error::Engine { engine: "ONNX Runtime", .. } => {
            "use an export with 32-bit inputs and outputs, or try --engine rten"
        }
        Error::Engine { .. } => "is the file complete? Try the other --engine",
        Error::Edit { fault: EditFault::TooFar(_), .. } => "give smaller numbers",
        Error::Edit { fault: EditFault::TooMuchDrawn { .. }, .. } => {
            "draw less, or select fewer elements with --layer or --where"
        }
        Error::Edit { fault: EditFault::NoLayer { known, .. }, .. } => {
            return Some(format!("--layer takes {}", known.join(", ")));
        }
        Error::Edit { fault: EditFault::NoCategory { known, .. }, .. } => {
            return Some(match &known[..] {
                [] => "no element of the scene has a category".into(),
                known => format!("the categories are {}", known.join(", ")),
            });
        }
        Error::Undrawable { .. } => {
            return error.hint().map(|advice| advice + "; --lenient leaves it out");
        }
        Error::OtherLibrary { .. } => {
            return error.hint().map(|advice| advice + "; 'vtex inspect' lists them");
        }
        Error::DrawingPeriods { near: [w, h], .. } => {
            return Some(format!("give --size {w}x{h}, or --method descriptor, which fits any size"));
        }
        Error::Periods { nearest: Some([w, h]), .. } => {
            return Some(format!("give --size {w}x{h}, or --lattice off, which fits any size"));
        }
        Error::Periods { .. } => "give a larger --size, or --lattice off, which fits any",
        Error::Sizes { .. } => "make both with the same --size, or stretch one with 'vtex warp --stretch'",
        Error::Parameter { name: "method", value, .. } if value.starts_with("auto") => {
            "name another --method, such as --method descriptor, or leave out what it does not follow"
        }
        Error::Parameter { name: "method", .. } => "leave out --method, or what this one does not follow",
        Error::Parameter { name: "region", .. } => "draw a larger shape for --region",
        Error::Parameter { name: "canvas", .. } => "give a larger --size",
        Error::Seams => "make the texture with --tile, for both axes",
        Error::Inks(_) => {
            "'vtex edit' gives one colour to all elements, with --op 'tint red --amount 1 --layer primary'"
        }
        Error::Paper => "give --paper a colour",
        Error::Fill(FillFault::Background) => "give --background a colour, or none",
        Error::Fill(FillFault::Shading) => "analyse the photograph with --shading flat",
        Error::Fill(FillFault::Shape) => {
            "leave out --domain or --domain-mask; for layers, analyse with --layers off"
        }
        Error::MaxBytes { file, smallest, .. } => {
            let packed = packed_ending(file).map(|ending| format!("write {ending}, ")).unwrap_or_default();
            return Some(format!("give --max-bytes {smallest} or more, {packed}or make the texture smaller"));
        }
        _ => return error.hint(),
    };
    Some(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_that_options_mend_name_them() {
        for (error, option) in [
            (Error::Exists { path: "a".into(), changed: true }, "--force"),
            (
                Error::TooLarge {
                    what: Large::Canvas,
                    name: "a".into(),
                    found: "9".into(),
                    limit: "1".into(),
                },
                "--size",
            ),
            (Error::Seams, "--tile"),
            (Error::Inks("several colours".into()), "tint red"),
            (Error::Paper, "--paper"),
            (Error::Fill(FillFault::Background), "--background"),
            (Error::Sizes { from: [1, 1], to: [2, 2] }, "--stretch"),
            (Error::MaxBytes { file: "SVG", most: 1, smallest: 7 }, "write .svgz"),
            (Error::MaxBytes { file: "PDF", most: 1, smallest: 7 }, "--max-bytes 7 or more, or make"),
            (Error::Runtime { name: "a".into(), reason: "b".into() }, "--onnxruntime"),
            (Error::Engine { name: "a".into(), engine: "rten", reason: "b".into() }, "--engine onnxruntime"),
        ] {
            assert!(hint(&error).is_some_and(|h| h.contains(option)), "{error}");
        }
    }
}
