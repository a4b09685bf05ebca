//! Text → operation: words, then values by the catalogue, then the files that they name.

use super::catalogue::{COMMON, ENTRIES, Entry, Kind, Need, Parameter};
use super::operation::{
    Action, Comparison, Condition, Direction, Identity, Layers, Operation, Quantity, ThinOrder,
};
use crate::control;
use crate::error::{Error, Result};
use crate::geometry::{Outline, Region};
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

/// A condition whose file is not read yet.
#[derive(Clone, Debug, PartialEq)]
enum Term {
    Ready(Condition),
    Place { file: String, inside: bool },
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
        while let Some(word) = rest.next() {
            if !word.starts_with("--") {
                request.positional(word)?;
                continue;
            }
            let (name, joined) = word.split_once('=').map_or((word.as_str(), None), |(n, v)| (n, Some(v)));
            let parameter = request.flag(name)?;
            let value = joined.or_else(|| rest.next().map(String::as_str)).ok_or_else(|| {
                Fault::new(format!("{name} needs a value"), format!("give {}", parameter.range()))
            })?;
            request.set(parameter, value)?;
        }
        request.complete()?;
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
            return Err(Fault::new(reason, format!("write it as: {}", usage(self.entry))));
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
                    return Err(Fault::new(reason, format!("write it as: {}", usage(self.entry))));
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
        let mut conditions = Vec::with_capacity(self.conditions.len());
        for term in &self.conditions {
            conditions.push(match term {
                Term::Ready(condition) => condition.clone(),
                Term::Place { file, inside } => {
                    Condition::Place { region: region(&read(file)?, file, canvas)?, inside: *inside }
                }
            });
        }
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

/// The inside of what a file shows: the shape of an SVG, or what is white in a picture.
fn region(bytes: &[u8], name: &str, canvas: [u32; 2]) -> Result<Region> {
    let picture = image::guess_format(bytes).is_ok();
    let outline: Outline =
        if picture { control::mask(bytes, name, canvas)? } else { control::shape(bytes, name, canvas)? };
    Ok(Region::new(&outline))
}

/// What is wrong, and what to try.
struct Fault(String, String);

impl Fault {
    fn new(reason: impl Into<String>, advice: impl Into<String>) -> Self {
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

/// How an operation is written.
pub(super) fn usage(entry: &Entry) -> String {
    let mut text = entry.name.to_owned();
    for p in entry.parameters {
        let word = match (p.is_flag(), p.kind) {
            (false, _) => p.name.to_owned(),
            (true, Kind::Colour) => format!("{} COLOUR", p.name),
            (true, Kind::File) => format!("{} FILE", p.name),
            (true, Kind::Choice(_)) => format!("{} WORD", p.name),
            (true, _) => format!("{} NUMBER", p.name),
        };
        text.push(' ');
        text.push_str(&if p.need == Need::Required { word } else { format!("[{word}]") });
    }
    text
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
        Kind::File | Kind::NumberOrFile(..) => Ok(Value::File(text.to_owned())),
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

/// A condition of `--where`.
fn term(text: &str) -> Result<Term, Fault> {
    const EXPECTED: &str = "conditions are category=3, category!=3, category=3|5, library=0, id=17, area>200, \
                            elongation>1.5, x<500, y>=20, inside=FILE, outside=FILE, with commas between";
    let wrong = |reason: String| Fault::new(reason, EXPECTED);
    let signs = ["!=", ">=", "<=", "=", ">", "<"];
    let found = signs
        .iter()
        .filter_map(|sign| Some((text.find(sign)?, *sign)))
        .min_by_key(|(at, s)| (*at, 2 - s.len()));
    let (at, sign) = found.ok_or_else(|| wrong(format!("'{}' is no condition", crate::error::clip(text))))?;
    let (name, value) = (text[..at].trim(), text[at + sign.len()..].trim());
    let comparison = match sign {
        ">" => Some(Comparison::More),
        ">=" => Some(Comparison::AtLeast),
        "<" => Some(Comparison::Less),
        "<=" => Some(Comparison::AtMost),
        _ => None,
    };
    let equal = sign == "=";
    let unfit = || wrong(format!("'{name}' is not compared by '{sign}'"));
    let among = |identity| {
        if comparison.is_some() {
            return Err(unfit());
        }
        let numbers: std::result::Result<Vec<u32>, _> = value.split('|').map(|v| v.trim().parse()).collect();
        let numbers =
            numbers.map_err(|_| wrong(format!("'{}' is no whole number", crate::error::clip(value))))?;
        Ok(Term::Ready(Condition::Among { identity, numbers, wanted: equal }))
    };
    let compare = |quantity| {
        let limit = value.parse::<f64>().ok().filter(|v| v.is_finite());
        let limit = limit.ok_or_else(|| wrong(format!("'{}' is no number", crate::error::clip(value))))?;
        Ok(Term::Ready(Condition::Compare { quantity, comparison: comparison.ok_or_else(unfit)?, limit }))
    };
    let place = |inside| match (equal, value) {
        (true, "") => Err(wrong(format!("'{name}=' names no file"))),
        (true, file) => Ok(Term::Place { file: file.to_owned(), inside }),
        (false, _) => Err(unfit()),
    };
    match name {
        "category" => among(Identity::Category),
        "library" => among(Identity::Library),
        "id" => among(Identity::Id),
        "area" => compare(Quantity::Area),
        "elongation" => compare(Quantity::Elongation),
        "x" => compare(Quantity::X),
        "y" => compare(Quantity::Y),
        "inside" => place(true),
        "outside" => place(false),
        _ => {
            let names = ["category", "library", "id", "area", "elongation", "x", "y", "inside", "outside"];
            let reason = format!("'{}' is nothing that textons have", crate::error::clip(name));
            Err(Fault::new(reason, format!("did you mean '{}'? {EXPECTED}", nearest(name, &names))))
        }
    }
}

/// The name that takes the fewest changes of letters; the first of several.
fn nearest<'a>(text: &str, names: &[&'a str]) -> &'a str {
    // Hostile texts are long; their ends do not matter.
    let text: String = text.chars().take(40).collect();
    names.iter().copied().min_by_key(|name| letters_to_change(&text, name)).unwrap_or_default()
}

/// Number of letters to add, remove, replace or swap with the next to make one word the other (Damerau
/// 1964, Levenshtein 1966).
fn letters_to_change(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let above = &rows[i - 1];
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}
