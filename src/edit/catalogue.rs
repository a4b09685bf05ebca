//! Which operations there are, what they take and what they do: the one place that parser and help
//! read.

use crate::scene::Shadow;

/// An operation that can be written.
#[derive(Debug, PartialEq)]
pub struct Entry {
    /// Its name, the first word.
    pub name: &'static str,
    /// What it does, in a sentence or two.
    pub does: &'static str,
    /// What follows the name.
    pub parameters: &'static [Parameter],
    /// Whether it is for colours, so that it can be done to the background too.
    pub colours: bool,
    /// How it is used.
    pub example: &'static str,
}

/// Something that follows the name of an operation.
#[derive(Debug, PartialEq)]
pub struct Parameter {
    /// Name of a flag with its two hyphens; or of a word that stands by its place, in capitals.
    pub name: &'static str,
    /// What it is.
    pub kind: Kind,
    /// Whether it can be left out.
    pub need: Need,
    /// What it says.
    pub does: &'static str,
}

/// What a parameter is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number from the first to the second, in a unit.
    Number(f64, f64, &'static str),
    /// `#rrggbb` or `#rgb`.
    Colour,
    /// A file.
    File,
    /// A number as of [`Kind::Number`], or a file.
    NumberOrFile(f64, f64, &'static str),
    /// One of some words.
    Choice(&'static [&'static str]),
    /// What textons must fulfil to be selected.
    Conditions,
}

/// Whether a parameter can be left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need {
    /// It cannot.
    Required,
    /// It can, and nothing takes its place.
    Optional,
    /// It can, and this takes its place.
    Default(&'static str),
}

impl Entry {
    /// How it is written, such as `tint COLOUR [--amount NUMBER] [--share NUMBER]`.
    pub fn usage(&self) -> String {
        let words = self.parameters.iter().map(|p| {
            let word = p.title();
            if p.need == Need::Required { word } else { format!("[{word}]") }
        });
        std::iter::once(self.name.to_owned()).chain(words).collect::<Vec<_>>().join(" ")
    }
}

impl Parameter {
    /// Its name, of a flag with what follows it, such as `--amount NUMBER`.
    pub fn title(&self) -> String {
        let value = match self.kind {
            _ if !self.is_flag() => return self.name.to_owned(),
            Kind::Colour => "COLOUR",
            Kind::File => "FILE",
            Kind::Conditions => "CONDITIONS",
            Kind::Choice(_) => "WORD",
            Kind::Number(..) | Kind::NumberOrFile(..) => "NUMBER",
        };
        format!("{} {value}", self.name)
    }

    /// Whether it is a flag.
    pub fn is_flag(&self) -> bool {
        self.name.starts_with("--")
    }

    /// What may be given and what holds if it is not, such as `0 to 1, default: 0.5`.
    pub fn range(&self) -> String {
        let numbers = |low: f64, high: f64, unit: &str| {
            let space = if unit.is_empty() { "" } else { " " };
            format!("{low} to {high}{space}{unit}")
        };
        let mut text = match self.kind {
            Kind::Number(low, high, unit) => numbers(low, high, unit),
            Kind::NumberOrFile(low, high, unit) => format!("{} or a file", numbers(low, high, unit)),
            Kind::Colour => "#rrggbb".into(),
            Kind::File => "a file".into(),
            Kind::Choice(words) => words.join(", "),
            Kind::Conditions => "conditions, with commas between".into(),
        };
        if let Need::Default(value) = self.need {
            text.push_str(&format!(", default: {value}"));
        }
        text
    }
}

const fn needed(name: &'static str, kind: Kind, does: &'static str) -> Parameter {
    Parameter { name, kind, need: Need::Required, does }
}

const fn usual(name: &'static str, kind: Kind, value: &'static str, does: &'static str) -> Parameter {
    Parameter { name, kind, need: Need::Default(value), does }
}

const fn optional(name: &'static str, kind: Kind, does: &'static str) -> Parameter {
    Parameter { name, kind, need: Need::Optional, does }
}

const SHARE: Kind = Kind::Number(0.0, 1.0, "");
const ANGLE: Kind = Kind::Number(-360.0, 360.0, "degrees");
const AREA: Kind = Kind::Number(0.0, 1e9, "px of area");
const FAR: Kind = Kind::Number(-1e6, 1e6, "px");

pub(super) static COMMON: [Parameter; 2] = [
    usual(
        "--layer",
        Kind::Choice(&["primary", "secondary", "all", "background"]),
        "all",
        "which textons: all is primary and secondary; background, for colours only, is the ground",
    ),
    optional(
        "--where",
        Kind::Conditions,
        "only those that fulfil all of category=3 (or 3|5, or !=3; secondaries have none), library=0, \
         id=17, area>200, elongation>1.5, x<500, y>=20 (with >, <, >= or <=), inside=FILE, outside=FILE",
    ),
];

/// What every operation takes besides its own parameters.
pub fn common_parameters() -> &'static [Parameter] {
    &COMMON
}

/// All operations.
pub fn catalogue() -> &'static [Entry] {
    &ENTRIES
}

pub(super) static ENTRIES: [Entry; 17] = [
    Entry {
        name: "thin",
        does: "Take textons away: the small ones go, and of what is left a share of each layer is kept.",
        parameters: &[
            optional("KEEP", SHARE, "share kept"),
            usual(
                "--order",
                Kind::Choice(&["blue-noise", "random", "area"]),
                "blue-noise",
                "which go first: those with the nearest neighbours, so that what is left stays even; any; \
                 or the smallest",
            ),
            optional("--min-area", AREA, "smaller textons go, and smaller details of those that stay"),
        ],
        colours: false,
        example: "thin 0.5 --layer secondary",
    },
    Entry {
        name: "density",
        does: "Keep each texton with the probability of a grey picture where it stands: white all, black none.",
        parameters: &[needed("MAP", Kind::File, "the picture, stretched over the canvas")],
        colours: false,
        example: "density fade.png --layer primary",
    },
    Entry {
        name: "orient",
        does: "Turn the longer axis of each texton towards a direction. Round ones stay as they are.",
        parameters: &[
            needed(
                "DEGREES",
                Kind::NumberOrFile(-360.0, 360.0, "degrees"),
                "clockwise from the right: 0 lies, 90 stands; or a grey picture, black 0 to white 180",
            ),
            usual("--strength", SHARE, "1", "share of the way"),
        ],
        colours: false,
        example: "orient 30 --strength 0.8",
    },
    Entry {
        name: "tint",
        does: "Mix colours with one, in Oklab.",
        parameters: &[
            needed("COLOUR", Kind::Colour, "the colour"),
            usual("--amount", SHARE, "0.5", "its share in the mixture"),
            usual("--share", SHARE, "1", "share of the textons tinted, chosen at random"),
        ],
        colours: true,
        example: "tint #ff0000 --amount 0.5 --share 0.3",
    },
    Entry {
        name: "recolor",
        does: "Move colours like one to another, and those less like it less far; shading stays.",
        parameters: &[
            needed("--from", Kind::Colour, "colour sought"),
            needed("--to", Kind::Colour, "colour that it becomes"),
            usual(
                "--reach",
                Kind::Number(0.01, 2.0, ""),
                "0.2",
                "Oklab distance up to which colours are alike; black and white are 1 apart",
            ),
        ],
        colours: true,
        example: "recolor --from #808080 --to #3060a0",
    },
    Entry {
        name: "palette",
        does: "Give the categories, from dark to light, the colours of a palette, from dark to light; shading \
               within them stays. What has no category gets the colour that stands at its lightness.",
        parameters: &[needed("FILE", Kind::File, "#rrggbb in any text, or a GIMP palette")],
        colours: true,
        example: "palette autumn.gpl",
    },
    Entry {
        name: "shadow",
        does: "Put a shadow under each texton; it falls on what lies below and on nothing above.",
        parameters: &[
            usual("--angle", ANGLE, "45", "where it falls, clockwise from the right"),
            usual("--length", Kind::Number(0.0, 1000.0, "px"), "5", "how far"),
            usual("--opacity", SHARE, "0.4", "how dark; 0 takes shadows away"),
            usual("--blur", Kind::Number(0.0, Shadow::WIDEST, "px"), "5", "width of its soft edge"),
        ],
        colours: false,
        example: "shadow --angle 60 --length 6 --layer primary",
    },
    Entry {
        name: "flatten",
        does: "Drop the details: each texton gets the mean of its colours.",
        parameters: &[],
        colours: false,
        example: "flatten",
    },
    Entry {
        name: "simplify",
        does: "Draw outlines again with fewer points, and drop the details that are smaller than that.",
        parameters: &[needed("PX", Kind::Number(0.01, 100.0, "px"), "how far an outline may move")],
        colours: false,
        example: "simplify 1",
    },
    Entry {
        name: "outline",
        does: "Draw a line along each texton's outline.",
        parameters: &[
            needed("WIDTH", Kind::Number(0.0, 1000.0, "px"), "width of the line; 0 takes lines away"),
            needed("COLOUR", Kind::Colour, "its colour"),
        ],
        colours: false,
        example: "outline 1.5 #202020 --layer primary",
    },
    Entry {
        name: "replace",
        does: "Replace each texton by the one of another library whose shape fits best; it takes its place, \
               size and direction.",
        parameters: &[needed("LIBRARY", Kind::File, "a .lib.json or .lib.json.gz")],
        colours: false,
        example: "replace other.lib.json --layer primary",
    },
    Entry {
        name: "move",
        does: "Move textons.",
        parameters: &[needed("X", FAR, "to the right"), needed("Y", FAR, "down")],
        colours: false,
        example: "move 20 -5 --where category=3",
    },
    Entry {
        name: "scale",
        does: "Make textons larger or smaller, each about its own centre.",
        parameters: &[needed("FACTOR", Kind::Number(0.01, 100.0, ""), "the factor")],
        colours: false,
        example: "scale 1.3 --where 'area<200'",
    },
    Entry {
        name: "rotate",
        does: "Turn textons, each about its own centre.",
        parameters: &[needed("DEGREES", ANGLE, "clockwise")],
        colours: false,
        example: "rotate 90 --layer primary",
    },
    Entry {
        name: "jitter",
        does: "Move, turn and scale each texton at random.",
        parameters: &[
            usual("--move", Kind::Number(0.0, 1e6, "px"), "0", "at most so far"),
            usual("--rotate", Kind::Number(0.0, 180.0, "degrees"), "0", "at most so much either way"),
            usual("--scale", Kind::Number(0.0, 90.0, "per cent"), "0", "at most so much either way"),
        ],
        colours: false,
        example: "jitter --move 4 --rotate 15 --scale 10",
    },
    Entry {
        name: "delete",
        does: "Take textons away.",
        parameters: &[],
        colours: false,
        example: "delete --where 'area<30'",
    },
    Entry {
        name: "mask",
        does: "Keep the textons whose centre lies inside a shape, or outside.",
        parameters: &[
            needed(
                "SHAPE",
                Kind::File,
                "an SVG with one path, fitted to the canvas, or a picture, white inside",
            ),
            usual("--keep", Kind::Choice(&["inside", "outside"]), "inside", "which side"),
        ],
        colours: false,
        example: "mask disc.svg --keep outside",
    },
];
