//! The operations: their words and flags, their help, and the actions that they are.

use super::fault::{self, Fault};
use crate::cli::colours;
use crate::cli::values::named;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Command, Subcommand};
use serde::de::DeserializeOwned;
use vtex::edit::{Action, Direction, ThinOrder};
use vtex::raster::colour::Colour;

/// Verbs of operations. Help ends in the allowed values; `after_help` is an example.
#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Take elements away: the small ones go, and of what is left a share of each layer is kept.
    #[command(after_help = "thin 0.5 --layer secondary")]
    Thin {
        /// share kept [0 to 1]
        #[arg(value_name = "KEEP", value_parser = number, allow_negative_numbers = true)]
        keep: Option<f64>,
        /// which go first: those with the nearest neighbours, so that what is left stays even; any; or
        /// the smallest [blue-noise, random, area, default: blue-noise]
        #[arg(long, value_name = "WORD", value_parser = choice::<ThinOrder>(&["blue-noise", "random", "area"]))]
        order: Option<ThinOrder>,
        /// smaller elements go, and smaller details of those that stay [0 to 1000000000 px of area]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        min_area: Option<f64>,
    },
    /// Keep each element with the probability of a grey picture where it stands: white all, black none.
    #[command(after_help = "density fade.png --layer primary")]
    Density {
        /// the picture, stretched over the canvas [a file]
        #[arg(value_name = "MAP", value_parser = file)]
        map: String,
    },
    /// Turn the longer axis of each element towards a direction. Round ones stay as they are.
    #[command(after_help = "orient 30 --strength 0.8")]
    Orient {
        /// clockwise from the right: 0 lies, 90 stands; or a grey picture, black 0 to white 180
        /// [-360 to 360 degrees or a file]
        #[arg(value_name = "DEGREES", value_parser = direction, allow_negative_numbers = true)]
        direction: Direction,
        /// share of the way [0 to 1, default: 1]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "1")]
        strength: f64,
    },
    /// Mix colours with one, in Oklab.
    #[command(after_help = "tint #ff0000 --amount 0.5 --share 0.3")]
    Tint {
        /// the colour [#rrggbb, #rgb or a name of CSS]
        #[arg(value_name = "COLOUR", value_parser = colour)]
        colour: Colour,
        /// its share in the mixture [0 to 1, default: 0.5]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "0.5")]
        amount: f64,
        /// share of the elements tinted, chosen at random [0 to 1, default: 1]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "1")]
        share: f64,
    },
    /// Move colours like one to another, and those less like it less far; shading stays.
    #[command(after_help = "recolor --from #808080 --to #3060a0")]
    Recolor {
        /// colour sought [#rrggbb, #rgb or a name of CSS, needed]
        #[arg(long, value_name = "COLOUR", value_parser = colour)]
        from: Colour,
        /// colour that it becomes [#rrggbb, #rgb or a name of CSS, needed]
        #[arg(long, value_name = "COLOUR", value_parser = colour)]
        to: Colour,
        /// Oklab distance up to which colours are alike; black and white are 1 apart [0.01 to 2, default:
        /// 0.2]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "0.2")]
        reach: f64,
    },
    /// Give the categories, from dark to light, the colours of a palette, from dark to light; shading
    /// within them stays. What has no category gets the colour that stands at its lightness.
    #[command(after_help = "palette autumn.gpl")]
    Palette {
        /// #rrggbb in any text, or a GIMP palette [a file]
        #[arg(value_name = "FILE", value_parser = file)]
        file: String,
    },
    /// Put a shadow under each element; it falls on what lies below and on nothing above.
    #[command(after_help = "shadow --angle 60 --length 6 --layer primary")]
    Shadow {
        /// where it falls, clockwise from the right [-360 to 360 degrees, default: 45]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "45")]
        angle: f64,
        /// how far [0 to 1000 px, default: 5]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "5")]
        length: f64,
        /// how dark; 0 takes shadows away [0 to 1, default: 0.4]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "0.4")]
        opacity: f64,
        /// width of its soft edge [0 to 200 px, default: 5]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "5")]
        blur: f64,
    },
    /// Drop the details: each element gets the mean of its colours.
    #[command(after_help = "flatten")]
    Flatten,
    /// Draw outlines again with fewer points, and drop the details that are smaller than that.
    #[command(after_help = "simplify 1")]
    Simplify {
        /// how far an outline may move [0.01 to 100 px]
        #[arg(value_name = "PX", value_parser = number, allow_negative_numbers = true)]
        tolerance: f64,
    },
    /// Draw a line along each element's outline.
    #[command(after_help = "outline 1.5 #202020 --layer primary")]
    Outline {
        /// width of the line; 0 takes lines away [0 to 1000 px]
        #[arg(value_name = "WIDTH", value_parser = number, allow_negative_numbers = true)]
        width: f64,
        /// its colour [#rrggbb, #rgb or a name of CSS]
        #[arg(value_name = "COLOUR", value_parser = colour)]
        colour: Colour,
    },
    /// Replace each element by the one of another library whose shape fits best; it takes its place, size
    /// and direction.
    #[command(after_help = "replace other.lib.json --layer primary")]
    Replace {
        /// a .lib.json or .lib.json.gz [a file]
        #[arg(value_name = "LIBRARY", value_parser = file)]
        library: String,
    },
    /// Move elements.
    #[command(after_help = "move 20 -5 --where category=3")]
    Move {
        /// to the right [-1000000 to 1000000 px]
        #[arg(value_name = "X", value_parser = number, allow_negative_numbers = true)]
        x: f64,
        /// down [-1000000 to 1000000 px]
        #[arg(value_name = "Y", value_parser = number, allow_negative_numbers = true)]
        y: f64,
    },
    /// Make elements larger or smaller, each about its own centre.
    #[command(after_help = "scale 1.3 --where 'area<200'")]
    Scale {
        /// the factor [0.01 to 100]
        #[arg(value_name = "FACTOR", value_parser = number, allow_negative_numbers = true)]
        factor: f64,
    },
    /// Turn elements, each about its own centre.
    #[command(after_help = "rotate 90 --layer primary")]
    Rotate {
        /// clockwise [-360 to 360 degrees]
        #[arg(value_name = "DEGREES", value_parser = number, allow_negative_numbers = true)]
        angle: f64,
    },
    /// Move, turn and scale each element at random.
    #[command(after_help = "jitter --move 4 --rotate 15 --scale 10")]
    Jitter {
        /// at most so far [0 to 1000000 px, default: 0]
        #[arg(long = "move", value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "0")]
        distance: f64,
        /// at most so much either way [0 to 180 degrees, default: 0]
        #[arg(long = "rotate", value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "0")]
        angle: f64,
        /// at most so much either way [0 to 90 per cent, default: 0]
        #[arg(long, value_name = "NUMBER", value_parser = number, allow_negative_numbers = true)]
        #[arg(default_value = "0")]
        scale: f64,
    },
    /// Take elements away.
    #[command(after_help = "delete --where 'area<30'")]
    Delete,
    /// Keep the elements whose centre lies inside a shape, or outside.
    #[command(after_help = "mask disc.svg --keep outside")]
    Mask {
        /// an SVG with one path, fitted to the canvas, or a picture, white inside [a file]
        #[arg(value_name = "SHAPE", value_parser = file)]
        shape: String,
        /// which side [inside, outside, default: inside]
        #[arg(long, value_name = "WORD", default_value = "inside", action = ArgAction::Set)]
        #[arg(value_parser = PossibleValuesParser::new(["inside", "outside"]).map(|side| side == "inside"))]
        keep: bool,
    },
}

impl Verb {
    /// Refuses flags that go with nothing that is given.
    pub(super) fn check(&self, verb: &Command) -> Result<(), Fault> {
        match self {
            Self::Thin { keep: None, order: Some(_), .. } => Err(Fault::new(
                "--order says which go first, and nothing how much to keep",
                fault::example(verb),
            )),
            _ => Ok(()),
        }
    }

    /// The action; `read` gives the bytes of a palette.
    pub(super) fn action(self, read: impl FnOnce(&str) -> vtex::Result<Vec<u8>>) -> vtex::Result<Action> {
        Ok(match self {
            Self::Thin { keep, order, min_area } => {
                Action::Thin { keep, order: order.unwrap_or_default(), minimum_area: min_area }
            }
            Self::Density { map } => Action::Density { map },
            Self::Orient { direction, strength } => Action::Orient { direction, strength },
            Self::Tint { colour, amount, share } => Action::Tint { colour, amount, share },
            Self::Recolor { from, to, reach } => Action::Recolor { from, to, reach },
            Self::Palette { file } => {
                let colours = vtex::control::palette(&read(&file)?, &file)?;
                Action::Palette { colours, file: Some(file) }
            }
            Self::Shadow { angle, length, opacity, blur } => Action::Shadow { angle, length, opacity, blur },
            Self::Flatten => Action::Flatten,
            Self::Simplify { tolerance } => Action::Simplify { tolerance },
            Self::Outline { width, colour } => Action::Outline { width, colour },
            Self::Replace { library } => Action::Replace { library },
            Self::Move { x, y } => Action::Move { x, y },
            Self::Scale { factor } => Action::Scale { factor },
            Self::Rotate { angle } => Action::Rotate { angle },
            Self::Jitter { distance, angle, scale } => Action::Jitter { distance, angle, scale },
            Self::Delete => Action::Delete,
            Self::Mask { shape, keep } => Action::Mask { shape, inside: keep },
        })
    }
}

/// One of some names that a value has in files.
pub(super) fn choice<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: DeserializeOwned + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names.iter().copied()).try_map(|name| named::<T>(&name))
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "no number".into())
}

fn file(text: &str) -> Result<String, String> {
    if text.is_empty() { Err("no name of a file".into()) } else { Ok(text.to_owned()) }
}

fn direction(text: &str) -> Result<Direction, String> {
    match text.parse() {
        Ok(angle) => Ok(Direction::Angle(angle)),
        Err(_) => file(text).map(Direction::Map),
    }
}

/// A colour, as the command line reads it.
fn colour(text: &str) -> Result<Colour, String> {
    colours::colour(text).map_err(|_| "no colour".into())
}
