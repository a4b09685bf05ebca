//! The command lines that make what the page shows.

use super::knobs::{Stage, stage_of};
use super::opened::Opened;
use super::settings::{STEERING, StudioSettings};
use crate::cli::format::default_name;
use crate::cli::input::InputKind;
use std::path::Path;
use vtex::output::file::Format;

/// What is saved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wanted {
    pub(super) format: Format,
    /// Pixels of a PNG for each pixel of the canvas.
    pub(super) scale: Option<f64>,
}

/// Words of a command line, without the name of the program.
pub(super) type Words = Vec<String>;

/// The commands that make a result, one after the other. Each reads what the one before it has written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Commands {
    /// `vtex analyze`, for a photograph or a drawing.
    pub(super) analyze: Option<Words>,
    /// `vtex synth`, unless a scene was opened.
    pub(super) synth: Option<Words>,
    /// `vtex edit`, if there are operations; of a scene without any, `vtex render`.
    pub(super) last: Option<Words>,
}

impl Commands {
    /// The commands for a result of some work.
    pub(super) fn new(opened: &Opened, settings: &StudioSettings, wanted: Wanted) -> Self {
        let name = |word: &str, format| as_word(&default_name(&opened.path, word, format));
        let file = as_word(&opened.path);
        let library =
            if opened.kind == InputKind::Library { file.clone() } else { name("", Format::Library) };
        let writes = |stage| options(settings, stage);
        let result = |word: &str| {
            let mut words = vec!["-o".to_owned(), name(word, wanted.format)];
            if wanted.format != Format::Scene {
                words.extend(writes(Stage::Write));
            }
            if let Some(scale) = wanted.scale.filter(|scale| wanted.format.uses().scale && *scale != 1.0) {
                words.extend(["--scale".to_owned(), scale.to_string()]);
            }
            words
        };
        let mut commands = Self::default();
        if matches!(opened.kind, InputKind::Image | InputKind::Svg) {
            let seed = settings.analysis_seed.to_string();
            let mut words =
                vec!["analyze".into(), file.clone(), "-o".into(), library.clone(), "--seed".into(), seed];
            words.extend(settings.masks.iter().flat_map(|masks| named("--masks", &masks.path)));
            // Masks of a file need no segmenter, and the program refuses both. Categories of the file are taken.
            let is_categorized = settings.elements.as_ref().is_some_and(|e| !e.category_names().is_empty());
            let kept = |word: &String| {
                !(settings.masks.is_some() && word.starts_with("--segmenter=")
                    || is_categorized && word.starts_with("--categories="))
            };
            words.extend(writes(Stage::Analyze).into_iter().filter(kept));
            commands.analyze = Some(words);
            if wanted.format == Format::Library {
                return commands;
            }
        }
        let edits = !settings.operations.is_empty();
        let scene = if opened.kind == InputKind::Scene { file } else { name("texture", Format::Scene) };
        if opened.kind != InputKind::Scene {
            let mut words = vec!["synth".into(), library];
            words.extend(if edits { vec!["-o".to_owned(), scene.clone()] } else { result("texture") });
            words.extend(["--seed".into(), settings.seed.to_string()]);
            words.extend(writes(Stage::Synth));
            words.extend(
                settings
                    .files
                    .iter()
                    .filter(|(option, _)| STEERING.contains(&&option[..]))
                    .flat_map(|(option, file)| named(&format!("--{option}"), &file.path)),
            );
            commands.synth = Some(words);
        } else if !edits {
            commands.last = Some([vec!["render".to_owned(), scene.clone()], result("texture")].concat());
        }
        if edits {
            let mut words = [vec!["edit".to_owned(), scene], result("edited")].concat();
            words.extend(settings.operations.iter().flat_map(|text| ["--op".to_owned(), text.clone()]));
            commands.last = Some(words);
        }
        commands
    }

    /// The name of the file that the last of them writes.
    pub(super) fn result(&self) -> Option<&str> {
        let last = [&self.last, &self.synth, &self.analyze].into_iter().flatten().next()?;
        let path = last.iter().skip_while(|word| *word != "-o").nth(1)?;
        Path::new(path).file_name()?.to_str()
    }

    /// The commands as they are typed, one a line.
    pub(super) fn text(&self) -> Vec<String> {
        let all = [&self.analyze, &self.synth, &self.last].into_iter().flatten();
        all.map(|words| {
            let quoted: Vec<String> = words.iter().map(|word| quoted(word)).collect();
            format!("vtex {}", quoted.join(" "))
        })
        .collect()
    }
}

/// The options of a stage that are set.
fn options(settings: &StudioSettings, stage: Stage) -> Words {
    let own = settings.options.iter().filter(|(name, _)| stage_of(name) == Some(stage));
    own.map(|(name, value)| format!("--{name}={value}")).collect()
}

fn named(option: &str, path: &Path) -> [String; 2] {
    [option.to_owned(), as_word(path)]
}

/// A path that is not taken for an option.
fn as_word(path: &Path) -> String {
    let path = path.display().to_string();
    if path.starts_with('-') { format!("./{path}") } else { path }
}

/// A word as a shell reads it back.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    if cfg!(windows) {
        return format!("\"{}\"", word.replace('"', "\\\""));
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_begins_with_a_dash_is_no_option() {
        let opened = Opened::picture("-leaf.png".into());
        let wanted = Wanted { format: Format::Svg, scale: None };
        let commands = Commands::new(&opened, &StudioSettings::new(None), wanted);
        assert_eq!(commands.analyze.as_ref().unwrap()[1..4], ["./-leaf.png", "-o", "./-leaf.lib.json"]);
        assert_eq!(commands.result(), Some("-leaf.texture.svg"));
    }

    #[cfg(unix)]
    #[test]
    fn a_shell_reads_words_back() {
        for word in
            ["a", "", "it's", "a b", "tint '#ff0000' --where 'area>3'", "$(ls)`x`\"\\", "ä.png", "~/*"]
        {
            let echoed = std::process::Command::new("sh")
                .args(["-c", &format!("printf %s {}", quoted(word))])
                .output()
                .unwrap();
            assert_eq!(String::from_utf8(echoed.stdout).unwrap(), word);
        }
    }
}
