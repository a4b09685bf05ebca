//! Parameters from three places: defaults, then the file of `--config`, then the command line.
//!
//! The keys of the file are the long names of the options, in sections, so there is one definition of both:
//! the structs in [`super::options`]. A section and the options of the command line are merged into the
//! defaults as tables, and the result becomes a parameter struct of the library.

use super::failure::Failure;
use super::foreign::cut;
use super::hints::allowed;
use super::input::read_text;
use super::nearest::nearest;
use super::options::analyze::{AnalyzeFlags, SegmenterName};
use super::options::global::Global;
use super::options::render::{RenderFlags, RenderParameters};
use super::options::svg::{SvgFlags, SvgParameters};
use super::options::synth::{SynthBackgroundFlags, SynthFlags};
use super::values::{Axes, FiveWeights, Name, Seed, Size, WeightsFrom, Wrap};
use clap::Args;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Write;
use std::path::Path;
use toml::{Table, Value};
use vtex::Error;
use vtex::library::AnalyzeParams;
use vtex::scene::SynthParams;

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
    /// Whether the size of the canvas was given.
    pub(crate) sized: bool,
    /// The size in millimetres, if it was given with units.
    pub(crate) millimetres: Option<[f64; 2]>,
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

/// Name and help of every key of a section, in order.
fn keys(section: &str) -> Vec<(String, String)> {
    let command = clap::Command::new("");
    let command = match section {
        "" => Global::augment_args(command),
        "analyze" => AnalyzeFlags::augment_args(command),
        "synth" => SynthBackgroundFlags::augment_args(SynthFlags::augment_args(command)),
        "svg" => SvgFlags::augment_args(command),
        "render" => RenderFlags::augment_args(command),
        _ => command,
    };
    let all = command.get_arguments().filter_map(|a| {
        let name = a.get_long()?.to_owned();
        Some((name, a.get_help().map(ToString::to_string).unwrap_or_default()))
    });
    all.filter(|(name, _)| !section.is_empty() || ["seed", "threads"].contains(&name.as_str())).collect()
}

/// Values for some of the parameters, in sections.
pub(crate) struct ConfigLayer {
    /// Their origin, for messages: the file's name in quotes, or more.
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
            sized: false,
            millimetres: None,
            weights: None,
            svg: SvgParameters { precision: 1, expand: false, css: false, max_bytes: None },
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
            // One key at a time, so that an error can name it.
            for section in SECTIONS {
                let inner = if section.is_empty() { Some(table) } else { section_of(table, section) };
                for (key, value) in inner.into_iter().flatten().filter(|(_, v)| !v.is_table()) {
                    let one: Table = [(key.clone(), value.clone())].into_iter().collect();
                    parameters.merge(section, &one).map_err(|reason| {
                        let value = cut(&value.to_string(), 60);
                        let reason = expected(section, key, reason);
                        Failure::usage(format!("{place}: {key} = {value}: {reason}"))
                    })?;
                }
            }
        }
        for section in SECTIONS {
            let inner = if section.is_empty() { Some(&values.0) } else { section_of(&values.0, section) };
            if let Some(table) = inner {
                parameters.merge(section, table).map_err(Failure::usage)?;
            }
        }
        if let Some(millimetres) = parameters.millimetres {
            let size = Size::physical(millimetres, parameters.render.dpi.clamp(1, 9600));
            (parameters.synth.width, parameters.synth.height) = (size.width, size.height);
        }
        parameters.validate()?;
        Ok(parameters)
    }

    fn validate(&self) -> vtex::Result<()> {
        let check = |ok: bool, name, value: String, allowed| {
            if ok { Ok(()) } else { Err(Error::Parameter { name, value, allowed }) }
        };
        if let Some(threads) = self.threads {
            check((1..=1024).contains(&threads), "threads", threads.to_string(), "1 to 1024")?;
        }
        self.analyze.validate()?;
        self.synth.validate()?;
        let SvgParameters { precision, .. } = self.svg;
        check(precision <= 6, "precision", precision.to_string(), "0 to 6 decimals")?;
        let RenderParameters { scale, dpi, .. } = self.render;
        check((1..=9600).contains(&dpi), "dpi", dpi.to_string(), "1 to 9600")?;
        check((0.01..=100.0).contains(&scale), "scale", scale.to_string(), "0.01 to 100")
    }

    /// Replaces parameters of a section by values.
    fn merge(&mut self, section: &str, values: &Table) -> Result<(), String> {
        let mut values = values.clone();
        values.retain(|_, v| !v.is_table());
        match section {
            "" => {
                take(&mut values, "seed", |v| self.seed = Some(v))?;
                take(&mut values, "threads", |v| self.threads = Some(v))?;
            }
            "analyze" => {
                take(&mut values, "segmenter", |v| self.segmenter = v)?;
                take(&mut values, "wrap", |v| self.wrap = v)?;
                self.analyze.wrap = self.wrap.given() == Some(true);
                self.analyze = merged(&self.analyze, values)?;
            }
            "synth" => {
                take(&mut values, "size", |Size { width, height, millimetres }| {
                    (self.synth.width, self.synth.height, self.sized) = (width, height, true);
                    self.millimetres = millimetres;
                })?;
                take(&mut values, "tile", |Axes(tile)| self.synth.tile = tile)?;
                take(&mut values, "weights", |v| match v {
                    WeightsFrom::Numbers(n) => (self.synth.weights, self.weights) = (n.into(), None),
                    WeightsFrom::Name(name) => self.weights = Some(name),
                })?;
                self.synth = merged(&self.synth, values)?;
            }
            "svg" => self.svg = merged(&self.svg, values)?,
            "render" => self.render = merged(&self.render, values)?,
            _ => {}
        }
        Ok(())
    }

    /// The values of a section, by key.
    fn section(&self, section: &str) -> Table {
        let table = |v: Result<Table, toml::ser::Error>| v.expect("parameters are plain values");
        let mut values = match section {
            "" => table(Table::try_from(Top { seed: self.seed, threads: self.threads })),
            "analyze" => {
                let mut t = table(Table::try_from(&AnalyzeParams { seed: 0, ..self.analyze.clone() }));
                t.insert("segmenter".into(), Value::try_from(self.segmenter).expect("a name"));
                t.insert("wrap".into(), Value::try_from(self.wrap).expect("a word"));
                t.insert("elements".into(), Value::try_from(self.analyze.elements).expect("a name"));
                t.insert("lenient".into(), self.analyze.lenient.into());
                t
            }
            "synth" => {
                let mut t = table(Table::try_from(&SynthParams { seed: 0, ..self.synth.clone() }));
                let (width, height) = (self.synth.width, self.synth.height);
                let size = Size { width, height, millimetres: self.millimetres };
                t.insert("size".into(), Value::try_from(size).expect("text"));
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
        values = values.into_iter().map(|(k, v)| (k.replace('_', "-"), v)).collect();
        values
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

/// The reason why a value is refused: the option's own message, else the values that its help allows.
fn expected(section: &str, key: &str, reason: String) -> String {
    if reason.starts_with("expected") {
        return reason;
    }
    let help = keys(section).into_iter().find(|k| k.0 == key).map(|k| k.1);
    help.and_then(|help| allowed(&help)).map_or(reason, |range| format!("expected {range}"))
}

fn section_of<'a>(table: &'a Table, section: &str) -> Option<&'a Table> {
    table.get(section).and_then(Value::as_table)
}

/// Takes a value out of a table, if it is there.
fn take<T: DeserializeOwned>(values: &mut Table, key: &str, set: impl FnOnce(T)) -> Result<(), String> {
    if let Some(value) = values.remove(key) {
        set(value.try_into().map_err(|e: toml::de::Error| e.message().to_owned())?);
    }
    Ok(())
}

/// A parameter struct with some of its fields replaced; keys with hyphens or underscores.
fn merged<T: Serialize + DeserializeOwned>(base: &T, values: Table) -> Result<T, String> {
    let mut table = Table::try_from(base).map_err(|e| e.to_string())?;
    table.extend(values.into_iter().map(|(k, v)| (k.replace('-', "_"), v)));
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
        assert_eq!(fields(AnalyzeParams::default(), &["seed"]), sorted_keys("analyze", &["segmenter"]));
        // A variation is stored only if it is given.
        let handled = ["seed", "width", "height", "weights", "variation"];
        let options = sorted_keys("synth", &["size", "weights", "variation"]);
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
                    Value::String(s) if s == "1000x1000" => "1000".into(),
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
    fn help_names_the_true_ranges() {
        // Values just outside the range of the help are refused, the limits themselves are accepted.
        for (section, key, low, high) in [
            ("analyze", "detail-scale", "0", "10000"),
            ("analyze", "fidelity", "0.05", "5"),
            ("analyze", "descriptor-reach", "0.5", "10"),
            ("analyze", "background-margin", "0", "100"),
            ("analyze", "background-spacing", "4", "1000"),
            ("synth", "background-spacing", "4", "1000"),
            ("synth", "candidates", "1", "1000"),
            ("synth", "moves", "0", "100"),
            ("synth", "rotate", "0", "180"),
            ("synth", "scale-jitter", "0", "50"),
            ("analyze", "colors", "0", "4096"),
            ("analyze", "max-paths", "0", "10000000"),
            ("analyze", "cells", "0", "4"),
            ("svg", "precision", "0", "6"),
            ("render", "scale", "0.01", "100"),
        ] {
            let help = keys(section).into_iter().find(|k| k.0 == key).unwrap().1;
            assert!(help.contains(&format!("[{low} to {high},")), "{help}");
            let test = |value: &str| {
                let mut p = Parameters::default();
                let table: Table = format!("{key} = {value}").parse().unwrap();
                p.merge(section, &table).is_ok() && p.validate().is_ok()
            };
            assert!(test(low) && test(high), "{key}");
            assert!(!test(&format!("{high}1")), "{key}");
            let below = if low.parse::<f64>().unwrap() > 0.0 { "0" } else { "-1" };
            assert!(!test(below), "{key}");
        }
    }

    #[test]
    fn a_dump_reads_back_as_itself() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("vtex.toml");
        let mut values = CommandLineValues::default();
        let table: Table = "seed = '18446744073709551615'\n[synth]\nsize = 70\nbackground-spacing = 9\n\
            weights = [1, 0, -1.5, 2.5, 0.1]\n[analyze]\nwrap = true\ndetail-sigma = 1.5"
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
            // A size that is written down counts as given.
            assert!(again.sized);
            assert_eq!(Parameters { sized: p.sized, ..again.clone() }, p);
            assert_eq!(again.dump(), p.dump());
        }
    }
}
