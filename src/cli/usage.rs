//! Messages of the argument parser, in the words of the help.

use super::foreign::styled;
use super::operations::verb::example;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::ffi::OsString;
use std::path::Path;
use vtex::output::file::{FileKind, Format};

/// An error of the parser as text.
pub(crate) fn text(error: &clap::Error, arguments: &[OsString]) -> String {
    let has_control = arguments.iter().any(|a| a.to_string_lossy().chars().any(char::is_control));
    // Control characters of arguments cannot be distinguished from those of colours, so the message then has
    // no colours.
    let rendered = error.render();
    let plain = styled(&if has_control { rendered.to_string() } else { rendered.ansi().to_string() });
    match suggestion(error, arguments) {
        Some(hint) => format!("{}\nhint: {}\n", plain.trim_end(), styled(&hint)),
        None => plain,
    }
}

/// A suggestion for something that the parser does not know, in one sentence.
fn suggestion(error: &clap::Error, arguments: &[OsString]) -> Option<String> {
    let own = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let word = own(ContextKind::InvalidSubcommand)?;
            if let Some(example) = operation(word) {
                return Some(format!("scenes are changed by operations: vtex edit SCENE --op \"{example}\""));
            }
            let command = command_of(word)?;
            Some(format!("did you mean 'vtex {command} {word}'?"))
        }
        ErrorKind::UnknownArgument => {
            let unknown = own(ContextKind::InvalidArg)?;
            let mut words = arguments.iter().map(|a| a.to_string_lossy());
            let command = words.nth(1)?;
            let mut after = words.skip_while(|word| word != "--op").skip(1);
            if command == "edit"
                && let Some(verb) = after.next().filter(|verb| !verb.contains(' '))
            {
                let mut all = vec![verb];
                all.extend(after.take_while(|word| word != "-o" && word != "--output"));
                let all = all.join(" ");
                let quoted = all.contains(['\'', '"']);
                return (!quoted).then(|| format!("put the operation in quotes: --op \"{all}\""));
            }
            match unknown.split('=').next()? {
                "--width" | "--height" => Some("give both sides with --size, as in --size 1000x600".into()),
                word if word.starts_with('-') => None,
                word if MAKES_ONE_FILE.contains(&&*command) => {
                    Some(format!("give the output with -o, as in -o {word}"))
                }
                _ => None,
            }
        }
        _ => None,
    }
}

/// An example of the operation that a word means.
fn operation(word: &str) -> Option<String> {
    let word = word.replace("colour", "color");
    example(if word == "color" { "recolor" } else { &word })
}

/// Commands that read one file and write one.
const MAKES_ONE_FILE: [&str; 8] =
    ["texture", "vectorize", "analyze", "edit", "render", "animate", "layers", "raster"];

/// Extensions of pictures and drawings.
const PICTURES: [&str; 10] = ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "gif", "svg", "svgz"];

/// The command that reads a file with this name; `None` if it is not the name of a file.
fn command_of(file: &str) -> Option<&'static str> {
    let path = Path::new(file);
    match FileKind::from_path(path).map(|kind| kind.format) {
        Some(Format::Library) => return Some("synth"),
        Some(Format::Scene) => return Some("render"),
        _ => {}
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let picture = extension.is_some_and(|e| PICTURES.contains(&&*e));
    if picture {
        return Some("texture");
    }
    path.is_dir().then_some("batch")
}
