//! What can be set, for the page: names, words, ranges and defaults of options and operations, as the help of
//! the command line has them.

use crate::cli::number::range_of;
use crate::cli::operations;
use crate::cli::options::analyze::AnalyzeFlags;
use crate::cli::options::render::RenderFlags;
use crate::cli::options::svg::SvgFlags;
use crate::cli::options::synth::SynthFlags;
use clap::{Arg, Args};
use serde::Serialize;
use std::any::TypeId;
use vtex::edit::{Direction, NumberOrMap};
use vtex::output::file::Format;

/// The command that an option belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Stage {
    Analyze,
    Synth,
    /// The last one, which writes the file.
    Write,
}

/// The options that the page may set, in its order, under their headings. Options that name files or programs
/// are not among them.
const OPTIONS: [(&str, Stage, &[&str]); 5] = [
    ("Canvas", Stage::Synth, &["size", "dpi", "tile"]),
    (
        "Placement",
        Stage::Synth,
        &["method", "variation", "lattice", "edge", "exclude", "candidates", "moves"],
    ),
    ("Variety", Stage::Synth, &["rotate", "scale-jitter", "mirror"]),
    (
        "Analysis",
        Stage::Analyze,
        &[
            "segmenter",
            "categories",
            "minimum-area",
            "shading",
            "fidelity",
            "detail-scale",
            "detail-minimum",
            "secondary-tolerance",
            "secondary-minimum",
            "secondary-maximum",
            "background-spacing",
            "background-margin",
            "colors",
            "max-paths",
            "layers",
            "contrast",
            "even-light",
            "wrap",
            "elements",
            "group",
            "lenient",
        ],
    ),
    ("File", Stage::Write, &["background", "precision", "css", "expand"]),
];

/// The stage of an option; `None` for one that the page may not set.
pub(super) fn stage_of(option: &str) -> Option<Stage> {
    OPTIONS.iter().find(|(_, _, names)| names.contains(&option)).map(|(_, stage, _)| *stage)
}

/// How a value is set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
enum Control {
    Number { least: f64, most: f64, whole: bool },
    Choice,
    Switch,
    Colour,
    Text,
}

/// An option, or a word of an operation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Knob {
    name: String,
    /// What it does, in a sentence.
    words: String,
    /// What it takes, with its default.
    takes: String,
    #[serde(flatten)]
    control: Control,
    /// The names of a choice.
    choices: Vec<String>,
    default: Option<String>,
    /// Whether an operation needs it.
    needed: bool,
    /// Whether it stands by its place, without a name.
    placed: bool,
}

/// A heading with its options.
#[derive(Debug, Serialize)]
struct Group {
    title: &'static str,
    stage: Stage,
    knobs: Vec<Knob>,
}

/// An operation of `edit`.
#[derive(Debug, Serialize)]
struct OperationKnobs {
    name: String,
    words: String,
    knobs: Vec<Knob>,
}

/// All that can be set.
#[derive(Debug, Serialize)]
pub(super) struct Table {
    program: &'static str,
    groups: Vec<Group>,
    operations: Vec<OperationKnobs>,
    formats: Vec<FormatChoice>,
}

/// A format in which the page saves.
#[derive(Debug, Serialize)]
struct FormatChoice {
    name: &'static str,
    title: &'static str,
    words: &'static str,
    /// Whether it is made of pixels, which have a scale.
    scaled: bool,
}

impl FormatChoice {
    fn new(format: Format) -> Self {
        let writer = format.writer();
        let title = writer.endings[0].title;
        Self { name: writer.name, title, words: writer.purpose, scaled: writer.uses.scale }
    }
}

/// Operations whose words name files.
const WITH_FILES: [&str; 5] = ["density", "palette", "replace", "propagate", "mask"];

/// Builds the table.
pub(super) fn table() -> Table {
    let bare = || clap::Command::new("");
    let flags = RenderFlags::augment_args(SvgFlags::augment_args(SynthFlags::augment_args(
        AnalyzeFlags::augment_args(bare()),
    )));
    let group = |&(title, stage, names): &(&'static str, Stage, &[&str])| {
        let known = |name: &&str| flags.get_arguments().find(|arg| arg.get_long() == Some(name));
        Group { title, stage, knobs: names.iter().filter_map(known).map(knob).collect() }
    };
    let operations = operations::verbs();
    let operations = operations.get_subcommands().filter(|verb| !WITH_FILES.contains(&verb.get_name()));
    let operations = operations.map(|verb| OperationKnobs {
        name: verb.get_name().to_owned(),
        words: verb.get_about().map(ToString::to_string).unwrap_or_default(),
        knobs: verb.get_arguments().filter(|arg| !arg.is_global_set()).map(knob).collect(),
    });
    Table {
        program: vtex::PROGRAM,
        groups: OPTIONS.iter().map(group).collect(),
        operations: operations.collect(),
        formats: Format::all().map(FormatChoice::new).collect(),
    }
}

/// Methods behind a feature of their name, and whether the program was built with it: else it cannot be chosen.
const METHODS: [(&str, bool); 2] =
    [("clustered", cfg!(feature = "clustered")), ("curves", cfg!(feature = "curves"))];

/// What the help says about an option: its words and, in brackets at the end, what it takes.
fn knob(arg: &Arg) -> Knob {
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let (words, takes) = match help.rsplit_once(" [") {
        Some((words, takes)) => (words.to_owned(), takes.trim_end_matches(']').to_owned()),
        None => (help.clone(), String::new()),
    };
    let default = takes.rsplit_once("default: ").map(|(_, default)| default.to_owned());
    let choices = arg.get_possible_values();
    let choices = choices.iter().map(|v| v.get_name().to_owned());
    let is_left_out = |name: &String| METHODS.iter().any(|(method, is_built)| name == method && !is_built);
    let choices: Vec<String> = choices.filter(|name| !is_left_out(name)).collect();
    let value = arg.get_value_names().into_iter().flatten().map(ToString::to_string).collect::<String>();
    let is_switch = choices == ["true", "false"];
    let control = match range_of(&takes) {
        _ if is_switch => Control::Switch,
        _ if !choices.is_empty() => Control::Choice,
        Some([least, most]) if is_number(arg) => Control::Number { least, most, whole: is_whole(arg) },
        _ if value == "COLOUR" => Control::Colour,
        _ => Control::Text,
    };
    let name = arg.get_long().unwrap_or(arg.get_id().as_str()).to_owned();
    Knob {
        name,
        words,
        takes,
        control,
        choices: if is_switch { Vec::new() } else { choices },
        default,
        needed: arg.is_required_set(),
        placed: arg.get_long().is_none(),
    }
}

/// Whether an option reads a number, be it beside other things.
fn is_number(arg: &Arg) -> bool {
    let read = arg.get_value_parser().type_id();
    is_whole(arg)
        || [TypeId::of::<f64>(), TypeId::of::<NumberOrMap>(), TypeId::of::<Direction>()]
            .into_iter()
            .any(|known| read == known)
}

/// Whether an option reads whole numbers.
fn is_whole(arg: &Arg) -> bool {
    let read = arg.get_value_parser().type_id();
    [TypeId::of::<u32>(), TypeId::of::<u8>()].into_iter().any(|number| read == number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex::library::AnalyzeParams;
    use vtex::scene::{Jitter, SynthParams};

    fn found<'a>(table: &'a Table, name: &str) -> &'a Knob {
        let all = table.groups.iter().flat_map(|group| &group.knobs);
        all.clone().find(|knob| knob.name == name).unwrap_or_else(|| panic!("{name}"))
    }

    #[test]
    fn every_option_of_the_page_is_known_and_has_the_range_of_its_parameter() {
        let table = table();
        let count: usize = table.groups.iter().map(|group| group.knobs.len()).sum();
        assert_eq!(count, OPTIONS.iter().map(|(.., names)| names.len()).sum::<usize>());
        let number = |least, most, whole| Control::Number { least, most, whole };
        let [least, most] = SynthParams::ROTATE.range;
        assert_eq!(found(&table, "rotate").control, number(least, most, false));
        let [least, most] = SynthParams::MOVES.range.map(f64::from);
        assert_eq!(found(&table, "moves").control, number(least, most, true));
        let [least, most] = AnalyzeParams::SECONDARY_TOLERANCE.range;
        let tolerance = found(&table, "secondary-tolerance");
        assert_eq!(tolerance.control, number(least, most, false));
        assert_eq!(tolerance.default, Some(AnalyzeParams::SECONDARY_TOLERANCE.default().to_string()));
        let methods = &found(&table, "method").choices;
        assert!(["auto", "descriptor"].iter().all(|name| methods.iter().any(|m| m == name)), "{methods:?}");
        assert_eq!(found(&table, "mirror").control, Control::Switch);
        assert_eq!(
            [found(&table, "size").control, found(&table, "background").control],
            [Control::Text, Control::Colour]
        );
        for knob in table.groups.iter().flat_map(|group| &group.knobs) {
            assert!(!knob.words.is_empty() && !knob.takes.is_empty(), "{knob:?}");
        }
        let jitter = table.operations.iter().find(|operation| operation.name == "jitter").unwrap();
        let [least, most] = Jitter::HUE.range;
        let hue = jitter.knobs.iter().find(|knob| knob.name == "hue").unwrap();
        assert_eq!(hue.control, number(least, most, false));
    }

    #[test]
    fn no_option_that_names_a_file_can_be_set() {
        for name in ["masks", "weights", "onnxruntime", "encoder", "again", "config", "output", "domain", "o"]
        {
            assert_eq!(stage_of(name), None, "{name}");
        }
    }
}
