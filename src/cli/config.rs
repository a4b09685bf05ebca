//! Parameters from three places: defaults, then the file of `--config`, then the command line.
//!
//! The keys of the file are the long names of the options, in sections, and the parsers of the options read
//! their values, so there is one definition of both: the structs in [`super::options`]. The values are merged
//! into the defaults as tables, and the result becomes a parameter struct of the library.

use super::failure::Failure;
use super::foreign::cut;
use super::input::read_text;
use super::nearest::nearest;
use super::options::analyze::{AnalyzeFlags, SegmenterName};
use super::options::global::Global;
use super::options::render::{RenderFlags, RenderParameters, ink};
use super::options::svg::{SvgFlags, SvgForm, SvgParameters};
use super::options::synth::{SynthBackgroundFlags, SynthFlags};
use super::values::{Axes, FiveWeights, Name, Seed, Size, WeightsFrom, Wrap, named, one_of_these};
use clap::error::{ContextKind, ContextValue};
use clap::{Args, FromArgMatches};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::TypeId;
use std::error::Error as _;
use std::fmt::{Display, Write};
use std::path::Path;
use toml::{Table, Value};
use vtex::library::AnalyzeParams;
use vtex::output::svg::SvgOptions;
use vtex::scene::{SynthParams, Tile};
use vtex::synth::CanvasSize;

/// Every parameter, resolved.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Parameters {
    pub(crate) seed: Option<Seed>,
    pub(crate) threads: Option<u16>,
    pub(crate) segmenter: SegmenterName,
    pub(crate) analyze: AnalyzeParams,
    /// Whether the exemplar tiles; `analyze` holds the value for a photograph.
    pub(crate) wrap: Wrap,
    pub(crate) synth: SynthParams,
    /// The size of the canvas that is asked for.
    pub(crate) size: CanvasSize,
    /// The name of the file with the weights of `synth`, if they are not given as numbers.
    pub(crate) weights: Option<Name>,
    pub(crate) svg: SvgParameters,
    pub(crate) render: RenderParameters,
}

/// The parameters on the command line, a table for each section.
#[derive(Debug, Default)]
pub(crate) struct CommandLineValues(Table);

impl CommandLineValues {
    /// Whether a seed was given.
    pub(crate) fn has_seed(&self) -> bool {
        self.0.contains_key("seed")
    }

    /// Adds the options given to a section (`""` is the top).
    pub(crate) fn add(&mut self, section: &str, flags: &impl Serialize) {
        let table = Table::try_from(flags).expect("options are plain values");
        if section.is_empty() {
            self.0.extend(table);
        } else if let Some(known) =
            self.0.entry(section).or_insert_with(|| Value::Table(Table::new())).as_table_mut()
        {
            known.extend(table);
        }
    }
}

/// The options of [`Global`] that are parameters.
#[derive(Serialize)]
pub(crate) struct Top {
    pub(crate) seed: Option<Seed>,
    pub(crate) threads: Option<u16>,
}

const SECTIONS: [&str; 5] = ["", "analyze", "synth", "svg", "render"];

/// The options of a section.
fn options(section: &str) -> clap::Command {
    let command = clap::Command::new("").no_binary_name(true);
    match section {
        "" => Global::augment_args(command),
        "analyze" => AnalyzeFlags::augment_args(command),
        "synth" => SynthBackgroundFlags::augment_args(SynthFlags::augment_args(command)),
        "svg" => SvgFlags::augment_args(command),
        "render" => RenderFlags::augment_args(command),
        _ => command,
    }
}

/// Name and help of every key of a section, in order.
fn keys(section: &str) -> Vec<(String, String)> {
    let command = options(section);
    let all = command.get_arguments().filter_map(|a| {
        let name = a.get_long()?.to_owned();
        Some((name, a.get_help().map(ToString::to_string).unwrap_or_default()))
    });
    all.filter(|(name, _)| !section.is_empty() || ["seed", "threads"].contains(&name.as_str())).collect()
}

/// A value of a file, parsed by its option; if that fails, a description of the expected value.
fn read(section: &str, key: &str, value: &Value) -> Result<CommandLineValues, String> {
    let command = options(section);
    let option = command.get_arguments().find(|a| a.get_long() == Some(key));
    let is_list = option.is_some_and(|a| a.get_value_delimiter().is_some());
    let text = match value {
        // The value with its quotes, which the parser refuses.
        Value::String(bare)
            if option.is_some_and(is_bare)
                && (bare.parse::<f64>().is_ok() || bare.parse::<bool>().is_ok()) =>
        {
            value.to_string()
        }
        Value::Array(values) if is_list && values.is_empty() => return Ok(CommandLineValues::default()),
        Value::Array(values) if is_list => values.iter().map(text).collect::<Vec<_>>().join(","),
        value => text(value),
    };
    let flags = command.try_get_matches_from([format!("--{key}={text}")]).map_err(|e| expected(&e))?;
    let mut given = CommandLineValues::default();
    let added = match section {
        "" => {
            Global::from_arg_matches(&flags).map(|g| given.add("", &Top { seed: g.seed, threads: g.threads }))
        }
        "analyze" => AnalyzeFlags::from_arg_matches(&flags).map(|flags| given.add(section, &flags)),
        "synth" => SynthFlags::from_arg_matches(&flags).and_then(|of_synth| {
            given.add(section, &of_synth);
            SynthBackgroundFlags::from_arg_matches(&flags).map(|flags| given.add(section, &flags))
        }),
        "svg" => SvgFlags::from_arg_matches(&flags).map(|flags| given.add(section, &flags)),
        _ => RenderFlags::from_arg_matches(&flags).map(|flags| given.add(section, &flags)),
    };
    added.map(|()| given).map_err(|e| expected(&e))
}

/// Whether an option takes a number or a truth value, which stand without quotes in a file.
fn is_bare(option: &clap::Arg) -> bool {
    let read = option.get_value_parser().type_id();
    let numbers = [TypeId::of::<f64>(), TypeId::of::<u32>(), TypeId::of::<u16>(), TypeId::of::<u8>()];
    numbers.into_iter().chain([TypeId::of::<bool>()]).any(|bare| read == bare)
}

/// A value as it is written on the command line.
fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// What an option expects, by the error of its parser.
fn expected(error: &clap::Error) -> String {
    match error.get(ContextKind::ValidValue) {
        Some(ContextValue::Strings(names)) => one_of_these(names),
        _ => error.source().map(ToString::to_string).unwrap_or_default(),
    }
}

/// Values for some of the parameters, in sections.
pub(crate) struct ConfigLayer {
    /// Their origin, for messages: the name of the file in quotes, and more if needed.
    place: String,
    table: Table,
}

impl ConfigLayer {
    /// Reads a configuration file.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let text = read_text(path)?;
        let table: Table = text.parse().map_err(|e: toml::de::Error| {
            Failure::usage(format!("cannot read '{}': {}", path.display(), fault(&text, &e)))
                .hint("'vtex --dump-config' prints a valid file")
        })?;
        Ok(Self::new(format!("'{}'", path.display()), table)?)
    }

    /// Checks that every key is known.
    pub(crate) fn new(place: String, table: Table) -> Result<Self, Failure> {
        for (key, value) in &table {
            match value {
                Value::Table(section) if SECTIONS[1..].contains(&key.as_str()) => {
                    for inner in section.keys() {
                        known(inner, key, &place)?;
                    }
                }
                _ if SECTIONS[1..].contains(&key.as_str()) => {
                    let failure = Failure::usage(format!("'{key}' in {place} is not a section"));
                    return Err(failure.hint(format!("write [{key}] on a line of its own")));
                }
                _ => known(key, "", &place)?,
            }
        }
        Ok(Self { place, table })
    }
}

/// An error that names the nearest key unless `key` is known in `section`.
fn known(key: &str, section: &str, file: &str) -> Result<(), Failure> {
    let mut names: Vec<String> = keys(section).into_iter().map(|k| k.0).collect();
    if names.iter().any(|n| n == key) {
        return Ok(());
    }
    let place = if section.is_empty() { String::new() } else { format!(" in [{section}]") };
    let failure = Failure::usage(format!("{file} has an unknown key '{key}'{place}"));
    let home = |s: &&str| *s != section && keys(s).iter().any(|k| k.0 == key);
    Err(match SECTIONS.iter().copied().find(home) {
        Some("") => failure.hint(format!("'{key}' stands at the top, before all sections")),
        Some(home) => failure.hint(format!("'{key}' belongs in [{home}]")),
        None => {
            if section.is_empty() {
                names.extend(SECTIONS[1..].iter().map(|s| (*s).to_owned()));
            }
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            failure.hint(format!("did you mean '{}'?", nearest(key, &names)))
        }
    })
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            seed: None,
            threads: None,
            segmenter: SegmenterName::default(),
            analyze: AnalyzeParams::default(),
            wrap: Wrap::default(),
            synth: SynthParams::default(),
            size: CanvasSize::default(),
            weights: None,
            svg: SvgParameters {
                form: SvgForm::default(),
                precision: SvgOptions::PRECISION.default(),
                expand: false,
                css: false,
                max_bytes: None,
            },
            render: RenderParameters::default(),
        }
    }
}

impl Parameters {
    /// Merges the defaults, the layers in their order and the values of the command line; a later value replaces
    /// an earlier one. Checks every range.
    pub(crate) fn resolve<'a>(
        layers: impl IntoIterator<Item = &'a ConfigLayer>,
        values: &CommandLineValues,
    ) -> anyhow::Result<Self> {
        let mut parameters = Self::default();
        for ConfigLayer { place, table } in layers {
            for section in SECTIONS {
                let inner = if section.is_empty() { Some(table) } else { section_of(table, section) };
                for (key, value) in inner.into_iter().flatten().filter(|(_, v)| !v.is_table()) {
                    let given = read(section, key, value).map_err(|reason| {
                        let value = cut(&value.to_string(), 60);
                        Failure::usage(format!("{place}: {key} = {value}: {reason}"))
                    })?;
                    parameters.merge(&given).map_err(Failure::usage)?;
                }
            }
        }
        parameters.merge(values).map_err(Failure::usage)?;
        if parameters.svg.form == SvgForm::Pattern && !parameters.synth.tile.any() {
            parameters.synth.tile = Tile { x: true, y: true };
        }
        // Libraries, on which the size may depend, are read later.
        parameters.size.set(&mut parameters.synth, &[], parameters.render.dpi.0);
        parameters.analyze.validate()?;
        parameters.synth.validate()?;
        Ok(parameters)
    }

    /// Replaces parameters by values.
    fn merge(&mut self, CommandLineValues(given): &CommandLineValues) -> Result<(), String> {
        let of = |section: &str| section_of(given, section).cloned().unwrap_or_default();
        let mut top = given.clone();
        take(&mut top, "seed", str::parse, |v| self.seed = Some(v))?;
        take(&mut top, "threads", str::parse, |v| self.threads = Some(v))?;
        let mut analyze = of("analyze");
        take(&mut analyze, "segmenter", named, |v| self.segmenter = v)?;
        take(&mut analyze, "wrap", str::parse, |v| self.wrap = v)?;
        self.analyze.wrap = self.wrap.choice() == Some(true);
        self.analyze = merged(&self.analyze, analyze)?;
        let mut synth = of("synth");
        take(&mut synth, "size", str::parse, |Size(size)| self.size = size)?;
        take(&mut synth, "tile", str::parse, |Axes(tile)| self.synth.tile = tile)?;
        take(&mut synth, "weights", str::parse, |v| match v {
            WeightsFrom::Numbers(n) => (self.synth.weights, self.weights) = (n.into(), None),
            WeightsFrom::Name(name) => self.weights = Some(name),
        })?;
        self.synth = merged(&self.synth, synth)?;
        let mut svg = of("svg");
        take(&mut svg, "as", named, |v| self.svg.form = v)?;
        take(&mut svg, "precision", str::parse, |v| self.svg.precision = v)?;
        take(&mut svg, "expand", str::parse, |v| self.svg.expand = v)?;
        take(&mut svg, "css", str::parse, |v| self.svg.css = v)?;
        take(&mut svg, "max_bytes", str::parse, |v| self.svg.max_bytes = Some(v))?;
        let mut render = of("render");
        take(&mut render, "scale", str::parse, |v| self.render.scale = v)?;
        take(&mut render, "dpi", str::parse, |v| self.render.dpi = v)?;
        take(&mut render, "ink", ink, |v| self.render.ink = Some(v))?;
        take(&mut render, "background", str::parse, |v| self.render.background = Some(v))
    }

    /// The values of a section, by key.
    fn section(&self, section: &str) -> Table {
        let table = |v: Result<Table, toml::ser::Error>| v.expect("parameters are plain values");
        let values = match section {
            "" => table(Table::try_from(Top { seed: self.seed, threads: self.threads })),
            "analyze" => {
                let mut t = table(Table::try_from(&AnalyzeParams { seed: 0, ..self.analyze.clone() }));
                t.insert("segmenter".into(), Value::try_from(self.segmenter).expect("a name"));
                t.insert("wrap".into(), Value::try_from(self.wrap).expect("a word"));
                // Libraries do not store these defaults.
                t.insert("group".into(), Value::try_from(self.analyze.group).expect("a word"));
                t.insert(
                    "contrast".into(),
                    Value::try_from(self.analyze.contrast).expect("a word or a number"),
                );
                t.insert("even_light".into(), Value::try_from(self.analyze.even_light).expect("a word"));
                t.insert("kind".into(), Value::try_from(self.analyze.kind).expect("a word"));
                t
            }
            "synth" => {
                let mut t = table(Table::try_from(&SynthParams { seed: 0, ..self.synth.clone() }));
                t.insert("size".into(), Value::try_from(Size(self.size)).expect("text"));
                let weights = match self.weights.clone() {
                    Some(name) => WeightsFrom::Name(name),
                    None => WeightsFrom::Numbers(FiveWeights::from(self.synth.weights.clone())),
                };
                t.insert("weights".into(), Value::try_from(weights).expect("numbers or a name"));
                t.insert("tile".into(), Value::try_from(Axes(self.synth.tile)).expect("text"));
                t
            }
            "svg" => table(Table::try_from(self.svg)),
            "render" => table(Table::try_from(self.render)),
            _ => Table::new(),
        };
        values.into_iter().map(|(k, v)| (k.replace('_', "-"), v)).collect()
    }

    /// All parameters that have a value, in sections.
    pub(crate) fn table(&self) -> Table {
        let known = |section: &str| {
            let keys = keys(section);
            let mut values = self.section(section);
            values.retain(|key, _| keys.iter().any(|k| k.0 == *key));
            values
        };
        let mut all = known("");
        all.extend(SECTIONS[1..].iter().map(|s| ((*s).to_owned(), Value::Table(known(s)))));
        all
    }

    /// All parameters as a file for `--config`, each under its help. Those without a value are
    /// left as comments.
    pub(crate) fn dump(&self) -> String {
        let mut text = format!("# Parameters of {}. Options on the command line win.\n", vtex::PROGRAM);
        for section in SECTIONS {
            if !section.is_empty() {
                let _ = write!(text, "\n[{section}]\n");
            }
            let values = self.section(section);
            for (key, help) in keys(section) {
                let _ = match values.get(&key) {
                    Some(value) => write!(text, "# {help}\n{key} = {value}\n"),
                    None => write!(text, "# {help}\n#{key} =\n"),
                };
            }
        }
        text
    }
}

/// The fault of a TOML file, and its line.
pub(crate) fn fault(text: &str, error: &toml::de::Error) -> String {
    let line = error.span().map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1);
    let place = line.map_or(String::new(), |line| format!("line {line}: "));
    format!("{place}{}", error.message())
}

fn section_of<'a>(table: &'a Table, section: &str) -> Option<&'a Table> {
    table.get(section).and_then(Value::as_table)
}

/// Takes a value out of a table, if it is there.
fn take<T, E: Display>(
    values: &mut Table,
    key: &str,
    read: impl Fn(&str) -> Result<T, E>,
    set: impl FnOnce(T),
) -> Result<(), String> {
    if let Some(value) = values.remove(key) {
        set(read(&text(&value)).map_err(|e| e.to_string())?);
    }
    Ok(())
}

/// A parameter struct with some of its fields replaced.
fn merged<T: Serialize + DeserializeOwned>(base: &T, values: Table) -> Result<T, String> {
    let mut table = Table::try_from(base).map_err(|e| e.to_string())?;
    table.extend(values);
    Value::Table(table).try_into().map_err(|e: toml::de::Error| e.message().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The keys of a parameter struct that have an option each.
    fn fields(parameters: impl Serialize, handled: &[&str]) -> Vec<String> {
        let table = serde_json::to_value(parameters).unwrap();
        let names = table.as_object().unwrap().keys().filter(|k| !handled.contains(&k.as_str()));
        let mut names: Vec<String> = names.map(|k| k.replace('_', "-")).collect();
        names.sort();
        names
    }

    fn sorted_keys(section: &str, handled: &[&str]) -> Vec<String> {
        let mut names: Vec<String> = keys(section).into_iter().map(|k| k.0).collect();
        names.retain(|n| !handled.contains(&n.as_str()));
        names.sort();
        names
    }

    #[test]
    fn every_parameter_has_an_option() {
        assert_eq!(
            fields(AnalyzeParams::default(), &["seed"]),
            // A kind, a contrast and a light that are the default are not stored.
            sorted_keys("analyze", &["segmenter", "group", "kind", "contrast", "even-light"])
        );
        // A variation and categories that are left out are stored only if they are given.
        let handled = ["seed", "width", "height", "weights", "variation"];
        let options = sorted_keys("synth", &["size", "weights", "variation", "exclude"]);
        assert_eq!(fields(SynthParams::default(), &handled), options);
    }

    #[test]
    fn help_names_the_true_defaults() {
        let parameters = Parameters::default();
        for section in &SECTIONS[1..] {
            let values = parameters.section(section);
            for (key, help) in keys(section) {
                let Some(value) = values.get(&key) else { continue };
                let shown = match value {
                    Value::String(s) => s.clone(),
                    Value::Float(f) => f.to_string(),
                    Value::Array(a) if a.is_empty() => "none".into(),
                    Value::Array(a) => {
                        a.iter().map(|v| v.as_float().unwrap().to_string()).collect::<Vec<_>>().join(",")
                    }
                    other => other.to_string(),
                };
                assert!(help.ends_with(&format!("default: {shown}]")), "[{section}] {key} = {shown}: {help}");
            }
        }
    }

    #[test]
    fn a_dump_reads_back_as_itself() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("vtex.toml");
        let mut values = CommandLineValues::default();
        let table: Table = "seed = '18446744073709551615'\n[synth]\nsize = 70\nbackground_spacing = 9\n\
            weights = [1, 0, -1.5, 2.5, 0.1]\n[analyze]\nwrap = true\ndetail_sigma = 1.5"
            .parse()
            .unwrap();
        values.0 = table;
        let parameters = Parameters::resolve(None, &values).unwrap();
        assert_eq!(parameters.seed, Some(Seed(u64::MAX)));
        assert_eq!((parameters.synth.height, parameters.synth.weights.mismatched), (70, 2.5));
        let weights = "tuned".parse().ok();
        for p in [parameters, Parameters { weights, ..Parameters::default() }, Parameters::default()] {
            std::fs::write(&path, p.dump()).unwrap();
            let again =
                Parameters::resolve(&[ConfigLayer::read(&path).unwrap()], &CommandLineValues::default())
                    .unwrap();
            assert_eq!(again, p);
            assert_eq!(again.dump(), p.dump());
        }
    }
}
