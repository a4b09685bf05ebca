//! Text → operation: words, then values by the catalogue, then the files that they name.

use super::catalogue::{COMMON, ENTRIES, Entry, Kind, Need, Parameter};
use super::conditions::{Term, region, term};
use super::operation::{Action, Direction, Layers, Operation, ThinOrder};
use crate::control;
use crate::error::{Error, Result, nearest};
use crate::library::Library;
use crate::raster::colour::Colour;

/// An operation as it was written, every value checked, no file read yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    text: String,
    entry: &'static Entry,
    /// In the order of the entry's parameters.
    values: Vec<Option<Value>>,
    layers: Layers,
    conditions: Vec<Term>,
}

/// A value of a parameter.
#[derive(Clone, Debug, PartialEq)]
enum Value {
    Number(f64),
    Colour(Colour),
    File(String),
    Choice(&'static str),
}

impl Request {
    /// Checks an operation. Words are split at spaces but within quotes, single or double.
    ///
    /// # Errors
    /// [`Error::Edit`] that says what is wrong and what would be right.
    pub fn parse(text: &str) -> Result<Self> {
        let text = text.trim();
        let fault = |fault: Fault| Error::Edit {
            operation: crate::error::clip_to(text, 60),
            reason: fault.0,
            advice: fault.1,
        };
        let words = words(text).map_err(fault)?;
        Self::from_words(text, &words).map_err(fault)
    }

    fn from_words(text: &str, words: &[String]) -> Result<Self, Fault> {
        let entry = entry(words.first().map_or("", String::as_str))?;
        let mut request = Self {
            text: text.into(),
            entry,
            values: vec![None; entry.parameters.len()],
            layers: Layers::default(),
            conditions: Vec::new(),
        };
        let mut rest = words[1..].iter();
        let mut given: Vec<&str> = Vec::new();
        while let Some(word) = rest.next() {
            if !word.starts_with("--") {
                request.positional(word)?;
                continue;
            }
            let (name, joined) = word.split_once('=').map_or((word.as_str(), None), |(n, v)| (n, Some(v)));
            let parameter = request.flag(name)?;
            // Conditions add up.
            if given.contains(&parameter.name) && parameter.kind != Kind::Conditions {
                return Err(Fault::new(format!("{name} is given twice"), "give it once"));
            }
            given.push(parameter.name);
            let value = joined.or_else(|| rest.next().map(String::as_str)).ok_or_else(|| {
                Fault::new(format!("{name} needs a value"), format!("give {}", parameter.range()))
            })?;
            request.set(parameter, value)?;
        }
        request.complete()?;
        if given.contains(&"--order") && request.value("KEEP").is_none() {
            let reason = "--order says which go first, and nothing how much to keep";
            return Err(Fault::new(reason, format!("such as: {}", request.entry.example)));
        }
        Ok(request)
    }

    /// The parameter of a flag.
    fn flag(&self, name: &str) -> Result<&'static Parameter, Fault> {
        let own = self.entry.parameters.iter().filter(|p| p.is_flag());
        let known: Vec<&'static Parameter> = own.chain(&COMMON).collect();
        if let Some(parameter) = known.iter().find(|p| p.name == name) {
            return Ok(parameter);
        }
        let names: Vec<&str> = known.iter().map(|p| p.name).collect();
        Err(Fault::new(
            format!("'{}' has no flag '{}'", self.entry.name, crate::error::clip(name)),
            format!("did you mean '{}'? there are {}", nearest(name, &names), names.join(", ")),
        ))
    }

    /// A word that stands by its place.
    fn positional(&mut self, word: &str) -> Result<(), Fault> {
        let free = self.entry.parameters.iter().zip(&self.values).find(|(p, v)| !p.is_flag() && v.is_none());
        let Some((parameter, _)) = free else {
            let reason = format!("'{}' is one word too many", crate::error::clip(word));
            return Err(Fault::new(reason, format!("write it as: {}", self.entry.usage())));
        };
        self.set(parameter, word)
    }

    fn set(&mut self, parameter: &'static Parameter, text: &str) -> Result<(), Fault> {
        match parameter.name {
            "--where" => {
                for part in text.split(',') {
                    self.conditions.push(term(part.trim())?);
                }
                return Ok(());
            }
            "--layer" => {
                self.layers = match choice(parameter, text)? {
                    "primary" => Layers::Primary,
                    "secondary" => Layers::Secondary,
                    "background" => Layers::Background,
                    _ => Layers::All,
                };
                return Ok(());
            }
            _ => {}
        }
        let value = value(parameter, text)?;
        if let Some(i) = self.entry.parameters.iter().position(|p| p.name == parameter.name) {
            self.values[i] = Some(value);
        }
        Ok(())
    }

    /// Fills in defaults and checks that nothing is missing.
    fn complete(&mut self) -> Result<(), Fault> {
        for (parameter, slot) in self.entry.parameters.iter().zip(&mut self.values) {
            match (&slot, parameter.need) {
                (None, Need::Default(text)) => *slot = Some(value(parameter, text)?),
                (None, Need::Required) => {
                    let reason = format!("{} is missing ({})", parameter.name, parameter.range());
                    return Err(Fault::new(reason, format!("write it as: {}", self.entry.usage())));
                }
                _ => {}
            }
        }
        if self.layers == Layers::Background && !self.entry.colours {
            let able: Vec<&str> = ENTRIES.iter().filter(|e| e.colours).map(|e| e.name).collect();
            return Err(Fault::new(
                format!("'{}' cannot be done to the background", self.entry.name),
                format!("the background is for {}", able.join(", ")),
            ));
        }
        if self.layers == Layers::Background && !self.conditions.iter().all(Term::is_of_place) {
            return Err(Fault::new(
                "the background has no categories, areas and the like",
                "its points are told apart by x, y, inside and outside",
            ));
        }
        let one_of = |names: &[&str], reason: &str| {
            let missing =
                self.entry.parameters.iter().zip(&self.values).filter(|(p, _)| names.contains(&p.name));
            let none = missing.clone().all(|(_, v)| matches!(v, None | Some(Value::Number(0.0))));
            if none && missing.count() > 0 {
                return Err(Fault::new(reason, format!("such as: {}", self.entry.example)));
            }
            Ok(())
        };
        match self.entry.name {
            "thin" if self.value("KEEP").is_none() => {
                one_of(&["--min-area"], "nothing says how much to keep")
            }
            "jitter" => one_of(&["--move", "--rotate", "--scale"], "nothing says what to change"),
            _ => Ok(()),
        }
    }

    fn value(&self, name: &str) -> Option<&Value> {
        let place = self.entry.parameters.iter().position(|p| p.name == name)?;
        self.values[place].as_ref()
    }

    fn number(&self, name: &str) -> Option<f64> {
        match self.value(name) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// A number that is required or has a default, so that it is there.
    fn given(&self, name: &str) -> f64 {
        self.number(name).unwrap_or_default()
    }

    fn colour(&self, name: &str) -> Colour {
        match self.value(name) {
            Some(Value::Colour(colour)) => *colour,
            _ => Colour::default(),
        }
    }

    fn file(&self, name: &str) -> &str {
        match self.value(name) {
            Some(Value::File(file)) => file,
            _ => "",
        }
    }

    fn word(&self, name: &str) -> &str {
        match self.value(name) {
            Some(Value::Choice(word)) => word,
            _ => "",
        }
    }

    /// The operation on a canvas of `width` × `height` pixels; `read` gives the bytes of the files that
    /// it names.
    ///
    /// # Errors
    /// Those of `read`, and of files that do not hold what they are used for.
    pub fn load(&self, canvas: [u32; 2], mut read: impl FnMut(&str) -> Result<Vec<u8>>) -> Result<Operation> {
        let conditions = self.conditions.iter().map(|term| term.load(canvas, &mut read));
        let conditions = conditions.collect::<Result<_>>()?;
        let action = self.action(canvas, &mut read)?;
        Ok(Operation { text: self.text.clone(), layers: self.layers, conditions, action })
    }

    fn action(&self, canvas: [u32; 2], read: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Action> {
        Ok(match self.entry.name {
            "thin" => Action::Thin {
                keep: self.number("KEEP"),
                order: match self.word("--order") {
                    "area" => ThinOrder::Area,
                    "random" => ThinOrder::Random,
                    _ => ThinOrder::BlueNoise,
                },
                minimum_area: self.number("--min-area"),
            },
            "density" => {
                let file = self.file("MAP");
                Action::Density { map: control::level(&read(file)?, file)? }
            }
            "orient" => Action::Orient {
                direction: match self.number("DEGREES") {
                    Some(angle) => Direction::Angle(angle),
                    None => {
                        let file = self.file("DEGREES");
                        Direction::Map(control::level(&read(file)?, file)?)
                    }
                },
                strength: self.given("--strength"),
            },
            "tint" => Action::Tint {
                colour: self.colour("COLOUR"),
                amount: self.given("--amount"),
                share: self.given("--share"),
            },
            "recolor" => Action::Recolor {
                from: self.colour("--from"),
                to: self.colour("--to"),
                reach: self.given("--reach"),
            },
            "palette" => {
                let file = self.file("FILE");
                Action::Palette { colours: control::palette(&read(file)?, file)? }
            }
            "shadow" => Action::Shadow {
                angle: self.given("--angle"),
                length: self.given("--length"),
                opacity: self.given("--opacity"),
                blur: self.given("--blur"),
            },
            "flatten" => Action::Flatten,
            "simplify" => Action::Simplify { tolerance: self.given("PX") },
            "outline" => Action::Outline { width: self.given("WIDTH"), colour: self.colour("COLOUR") },
            "replace" => {
                let file = self.file("LIBRARY");
                Action::Replace { library: Box::new(Library::from_bytes(&read(file)?, file)?) }
            }
            "move" => Action::Move { by: [self.given("X"), self.given("Y")] },
            "scale" => Action::Scale { factor: self.given("FACTOR") },
            "rotate" => Action::Rotate { angle: self.given("DEGREES") },
            "jitter" => Action::Jitter {
                distance: self.given("--move"),
                angle: self.given("--rotate"),
                scale: self.given("--scale"),
            },
            "mask" => {
                let file = self.file("SHAPE");
                let region = region(&read(file)?, file, canvas)?;
                Action::Mask { region, inside: self.word("--keep") == "inside" }
            }
            _ => Action::Delete,
        })
    }
}

/// What is wrong, and what to try.
pub(super) struct Fault(String, String);

impl Fault {
    pub(super) fn new(reason: impl Into<String>, advice: impl Into<String>) -> Self {
        Self(reason.into(), advice.into())
    }
}

/// The words of a text: split at spaces, quotes taken off.
fn words(text: &str) -> Result<Vec<String>, Fault> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in text.chars() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => word.get_or_insert_default().push(c),
            None if c == '\'' || c == '"' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            None => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    match quote {
        Some(open) => Err(Fault::new(format!("a quote {open} is not closed"), "close it with the same sign")),
        None => Ok(words),
    }
}

fn entry(name: &str) -> Result<&'static Entry, Fault> {
    let names: Vec<&str> = ENTRIES.iter().map(|e| e.name).collect();
    ENTRIES.iter().find(|e| e.name == name).ok_or_else(|| {
        let list = names.join(", ");
        match name {
            "" => Fault::new("it is empty", format!("the operations are {list}")),
            _ => Fault::new(
                format!("there is no operation '{}'", crate::error::clip(name)),
                format!("did you mean '{}'? the operations are {list}", nearest(name, &names)),
            ),
        }
    })
}

fn value(parameter: &'static Parameter, text: &str) -> Result<Value, Fault> {
    let wrong = |what: &str| {
        let reason = format!("{} = {} is {what}", parameter.name, crate::error::clip(text));
        Fault::new(reason, format!("{} takes {}", parameter.name, parameter.range()))
    };
    let number = |low: f64, high: f64| match text.parse::<f64>() {
        Ok(v) if (low..=high).contains(&v) => Ok(Value::Number(v)),
        Ok(_) => Err(wrong(&format!("out of range: {}", parameter.range()))),
        Err(_) => Err(wrong("no number")),
    };
    match parameter.kind {
        Kind::Number(low, high, _) => number(low, high),
        Kind::NumberOrFile(low, high, _) if text.parse::<f64>().is_ok() => number(low, high),
        Kind::Colour => colour(text).map(Value::Colour).ok_or_else(|| wrong("no colour")),
        Kind::File | Kind::NumberOrFile(..) if text.is_empty() => Err(wrong("no name of a file")),
        // Conditions are read by `set`.
        Kind::File | Kind::NumberOrFile(..) | Kind::Conditions => Ok(Value::File(text.to_owned())),
        Kind::Choice(_) => choice(parameter, text).map(Value::Choice),
    }
}

fn choice(parameter: &'static Parameter, text: &str) -> Result<&'static str, Fault> {
    let Kind::Choice(words) = parameter.kind else { return Ok("") };
    words.iter().copied().find(|w| *w == text).ok_or_else(|| {
        Fault::new(
            format!("{} = {} is none of {}", parameter.name, crate::error::clip(text), words.join(", ")),
            format!("did you mean '{}'?", nearest(text, words)),
        )
    })
}

/// `#rrggbb` or `#rgb`.
fn colour(text: &str) -> Option<Colour> {
    let digits = text.strip_prefix('#')?;
    if digits.len() == 3 && digits.is_ascii() {
        let doubled: String = digits.chars().flat_map(|c| [c, c]).collect();
        return Colour::from_hex(&format!("#{doubled}"));
    }
    Colour::from_hex(text)
}
