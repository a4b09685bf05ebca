//! The operations: their words and flags, their help, and the actions that they are.

use super::fault::{self, Fault};
use crate::cli::number::{Takes, within};
use crate::cli::values::named;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, ArgGroup, Command, Subcommand};
use serde::de::DeserializeOwned;
use vtex::Parameter;
use vtex::edit::{
    About, Action, ColourOrMap, Direction, Distribution, Jitter, Keep, NumberOrMap, OrderBy, ThinOrder,
    Within,
};
use vtex::raster::colour::Colour;
use vtex::scene::InstanceId;

/// Verbs of operations. Help ends in what is allowed; `after_help` is an example.
#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Remove elements: first the small ones, then others until a share of each layer is left.
    #[command(after_help = "thin 0.5 --layer secondary")]
    Thin {
        /// share to keep
        #[arg(number = Action::KEEP, value_name = "KEEP")]
        keep: Option<f64>,
        /// which to remove first: those with the nearest neighbours, so that the others stay evenly spread;
        /// random ones; or the smallest [blue-noise, random, area, default: blue-noise]
        #[arg(long, value_name = "WORD", value_parser = choice::<ThinOrder>(&["blue-noise", "random", "area"]))]
        order: Option<ThinOrder>,
        /// remove smaller elements, and smaller details of the others
        #[arg(long, number = Action::MINIMUM_AREA)]
        min_area: Option<f64>,
    },
    /// Keep each element with the probability a grey map gives at its position: white all, black none.
    #[command(after_help = "density fade.png --layer primary")]
    Density {
        /// the grey map, stretched over the canvas [a file]
        #[arg(value_name = "MAP", value_parser = file)]
        map: String,
    },
    /// Turn the longer axis of each element towards a direction. Round elements do not change.
    #[command(after_help = "orient 30 --strength 0.8")]
    Orient {
        /// direction, clockwise from the right: 0 = horizontal, 90 = vertical; or a grey picture, black 0 to
        /// white 180
        #[arg(value_name = "DEGREES", takes = or_a_file(Action::DEGREES))]
        #[arg(value_parser = number_or_file(Action::DEGREES, Direction::Angle, Direction::Map))]
        direction: Direction,
        /// how far to turn; 1 is all the way
        #[arg(long, number = Action::STRENGTH, default_value_t = Action::STRENGTH.default())]
        strength: f64,
    },
    /// Mix a colour into all colours, in Oklab.
    #[command(after_help = "tint #ff0000 --amount 0.5 --share 0.3")]
    Tint {
        /// the colour; or a picture, stretched over the canvas: each element gets the colour at its position,
        /// and none where the picture is transparent [#rrggbb, #rgb or a name of CSS, or a file]
        #[arg(value_name = "COLOUR", value_parser = colour_or_map)]
        colour: ColourOrMap,
        /// share of the new colour in the mixture
        #[arg(long, number = Action::AMOUNT, default_value_t = Action::AMOUNT.default())]
        amount: f64,
        /// share of the elements to tint, chosen at random
        #[arg(long, number = Action::SHARE, default_value_t = Action::SHARE.default())]
        share: f64,
    },
    /// Shift one colour to another; similar colours follow partly. Shading stays.
    #[command(after_help = "recolor --from #808080 --to #3060a0")]
    Recolor {
        /// colour to change [#rrggbb, #rgb or a name of CSS, needed]
        #[arg(long, value_name = "COLOUR", value_parser = colour)]
        from: Colour,
        /// new colour [#rrggbb, #rgb or a name of CSS, needed]
        #[arg(long, value_name = "COLOUR", value_parser = colour)]
        to: Colour,
        /// maximum Oklab distance of similar colours; black and white are 1 apart
        #[arg(long, number = Action::REACH, default_value_t = Action::REACH.default())]
        reach: f64,
        /// what to keep: nothing, or details that differ from the main colour of their element, such as the
        /// hearts of flowers [nothing, details, default: nothing]
        #[arg(long, value_name = "WORD", value_parser = choice::<Keep>(&["nothing", "details"]))]
        #[arg(default_value = "nothing")]
        keep: Keep,
    },
    /// Replace the main colours by those of a palette, weighted by area and matched from dark to light.
    /// Shading stays. Without --layer, the background changes too.
    #[command(after_help = "palette autumn.gpl")]
    Palette {
        /// a text with #rrggbb colours, or a GIMP palette [a file]
        #[arg(value_name = "FILE", value_parser = file)]
        file: String,
    },
    /// Put a shadow under each element. It falls on what is below, not on what is above.
    #[command(after_help = "shadow --angle 60 --length 6 --layer primary")]
    Shadow {
        /// direction, clockwise from the right
        #[arg(long, number = Action::SHADOW_ANGLE, default_value_t = Action::SHADOW_ANGLE.default())]
        angle: f64,
        /// distance of the shadow
        #[arg(long, number = Action::SHADOW_LENGTH, default_value_t = Action::SHADOW_LENGTH.default())]
        length: f64,
        /// opacity; 0 removes shadows
        #[arg(long, number = Action::OPACITY, default_value_t = Action::OPACITY.default())]
        opacity: f64,
        /// width of the soft edge
        #[arg(long, number = Action::BLUR, default_value_t = Action::BLUR.default())]
        blur: f64,
    },
    /// Remove the details. Each element gets the mean of its colours.
    #[command(after_help = "flatten")]
    Flatten,
    /// Draw outlines again with fewer points, and remove smaller details.
    #[command(after_help = "simplify 1")]
    Simplify {
        /// maximum distance that an outline may move
        #[arg(number = Action::TOLERANCE, value_name = "PX")]
        tolerance: f64,
    },
    /// Draw a line along each element's outline.
    #[command(after_help = "outline 1.5 #202020 --layer primary")]
    Outline {
        /// line width; 0 removes lines
        #[arg(number = Action::WIDTH, value_name = "WIDTH")]
        width: f64,
        /// line colour [#rrggbb, #rgb or a name of CSS]
        #[arg(value_name = "COLOUR", value_parser = colour)]
        colour: Colour,
    },
    /// Draw each element in ink: an outline on paper, with lines that are closer where it is darker. Dark
    /// spots become dots.
    #[command(after_help = "hatch --spacing 5 --width 0.8 --layer primary")]
    Hatch {
        /// distance between lines of the lightest tone; darker tones have closer, then crossed lines
        #[arg(long, number = Action::HATCH_SPACING, default_value_t = Action::HATCH_SPACING.default())]
        spacing: f64,
        /// direction of the lines, clockwise from the right
        #[arg(long, number = Action::HATCH_ANGLE, default_value_t = Action::HATCH_ANGLE.default())]
        angle: f64,
        /// width of lines and outlines
        #[arg(long, number = Action::HATCH_WIDTH, default_value_t = Action::HATCH_WIDTH.default())]
        width: f64,
        /// ink colour [#rrggbb, #rgb or a name of CSS, default: #202020]
        #[arg(long, value_parser = colour, default_value = "#202020")]
        color: Colour,
        /// paper colour, inside outlines [#rrggbb, #rgb or a name of CSS, default: white]
        #[arg(long, value_parser = colour, default_value = "white")]
        paper: Colour,
    },
    /// Replace each element by the one of another library whose shape fits best. The new one takes its
    /// position, size and direction.
    #[command(after_help = "replace other.lib.json --layer primary")]
    Replace {
        /// the library, .lib.json or .lib.json.gz [a file]
        #[arg(value_name = "LIBRARY", value_parser = file)]
        library: String,
    },
    /// Move elements.
    #[command(after_help = "move 20 -5 --where category=3")]
    Move {
        /// distance to the right
        #[arg(number = Action::X, value_name = "X")]
        x: f64,
        /// distance down
        #[arg(number = Action::Y, value_name = "Y")]
        y: f64,
    },
    /// Make elements larger or smaller, each about its own centre.
    #[command(after_help = "scale 1.3 --where 'area<200'")]
    Scale {
        /// the factor; or a grey picture, stretched over the canvas: black almost nothing, middle grey no
        /// change, white twice the size
        #[arg(value_name = "FACTOR", takes = or_a_file(Action::FACTOR), value_parser = or_map(Action::FACTOR))]
        factor: NumberOrMap,
    },
    /// Turn elements, each about its own centre.
    #[command(after_help = "rotate 90 --layer primary")]
    Rotate {
        /// angle, clockwise; or a grey picture, black 0 to white 360
        #[arg(value_name = "DEGREES", takes = or_a_file(Action::DEGREES), value_parser = or_map(Action::DEGREES))]
        angle: NumberOrMap,
    },
    /// Scale, turn and move elements, each about its own centre or all about their common centre.
    #[command(
        after_help = "transform --scale 1.5 --rotate 30 --move 20,-5 --about selection --where category=3"
    )]
    Transform {
        /// distance to the right, or to the right and down with a comma between
        #[arg(long = "move", value_name = "NUMBER", value_parser = pair(Action::WAY, |_| 0.0))]
        #[arg(takes = format!("{}, default: 0", Action::WAY), default_value = "0", allow_hyphen_values = true)]
        by: Pair,
        /// factor, or factors along x and y with a comma between
        #[arg(long, value_name = "NUMBER", value_parser = pair(Action::FACTORS, |x| x))]
        #[arg(takes = format!("{}, default: 1", Action::FACTORS), default_value = "1", allow_hyphen_values = true)]
        scale: Pair,
        /// angle, clockwise, after scaling
        #[arg(long = "rotate", number = Action::TURN, default_value_t = Action::TURN.default())]
        angle: f64,
        /// point that stays: the centre of each element, or the mean of the centres of all selected ones
        /// [each, selection, default: each]
        #[arg(long, value_name = "WORD", value_parser = choice::<About>(&["each", "selection"]))]
        #[arg(default_value = "each")]
        about: About,
    },
    /// Move, turn, scale, stretch, mirror and recolour each element at random.
    #[command(after_help = "jitter --move 4 --rotate 15 --scale 10 --hue 8 --lightness 5")]
    Jitter {
        /// maximum distance
        #[arg(long = "move", number = Jitter::DISTANCE, default_value_t = Jitter::DISTANCE.default())]
        distance: f64,
        /// maximum angle, either way
        #[arg(long = "rotate", number = Jitter::ANGLE, default_value_t = Jitter::ANGLE.default())]
        angle: f64,
        /// maximum change of size, either way
        #[arg(long, number = Jitter::SCALE, default_value_t = Jitter::SCALE.default())]
        scale: f64,
        /// maximum change of the ratio of length to width, either way; areas stay
        #[arg(long, number = Jitter::STRETCH, default_value_t = Jitter::STRETCH.default())]
        stretch: f64,
        /// share of the elements to mirror, left to right
        #[arg(long, number = Jitter::FLIP, default_value_t = Jitter::FLIP.default())]
        flip: f64,
        /// maximum turn of hues, either way
        #[arg(long, number = Jitter::HUE, default_value_t = Jitter::HUE.default())]
        hue: f64,
        /// maximum change of chroma, either way
        #[arg(long, number = Jitter::CHROMA, default_value_t = Jitter::CHROMA.default())]
        chroma: f64,
        /// maximum change of lightness, either way; white is 100 above black
        #[arg(long, number = Jitter::LIGHTNESS, default_value_t = Jitter::LIGHTNESS.default())]
        lightness: f64,
        /// uniform: evenly within the maximum; normal: the maximum is two standard deviations [uniform,
        /// normal, default: uniform]
        #[arg(long, value_name = "WORD", value_parser = choice::<Distribution>(&["uniform", "normal"]))]
        #[arg(default_value = "uniform")]
        distribution: Distribution,
        /// make every change a multiple of the maximum divided by this; 0: any change
        #[arg(long, number = Jitter::STEPS, default_value_t = Jitter::STEPS.default())]
        steps: u32,
    },
    /// Exchange colours and details at random between elements of similar size.
    #[command(after_help = "shuffle --layer primary --share 0.5")]
    Shuffle {
        /// exchange within a layer, or within each category of it [layer, category, default: layer]
        #[arg(long, value_name = "WORD", value_parser = choice::<Within>(&["layer", "category"]))]
        #[arg(default_value = "layer")]
        within: Within,
        /// share of the elements that take part
        #[arg(long, number = Action::SHARE, default_value_t = Action::SHARE.default())]
        share: f64,
        /// keep outlines, or exchange them too, fitted to the size and direction of the other element [keep,
        /// exchange, default: keep]
        #[arg(long, value_name = "WORD", default_value = "keep", action = ArgAction::Set)]
        #[arg(value_parser = PossibleValuesParser::new(["keep", "exchange"]).map(|word| word == "exchange"))]
        outlines: bool,
    },
    /// Make colours and shapes more alike or more varied, relative to their mean.
    #[command(after_help = "vary --color 1.5 --shape 0.5 --within category")]
    Vary {
        /// 0: all get the median colour, 1: no change, 2: twice the variation; or a grey picture, black 0 to
        /// white 2
        #[arg(long = "color", value_name = "NUMBER", takes = or_a_file(Action::COLOUR))]
        #[arg(value_parser = or_map(Action::COLOUR))]
        colour: Option<NumberOrMap>,
        /// the same for size, elongation and direction
        #[arg(long, value_name = "NUMBER", takes = or_a_file(Action::SHAPE), value_parser = or_map(Action::SHAPE))]
        shape: Option<NumberOrMap>,
        /// use one mean for a layer, or one for each category of it [layer, category, default: layer]
        #[arg(long, value_name = "WORD", value_parser = choice::<Within>(&["layer", "category"]))]
        #[arg(default_value = "layer")]
        within: Within,
    },
    /// Move elements apart where they are too close, so that distances become even.
    #[command(after_help = "relax --rounds 30 --layer secondary")]
    Relax {
        /// maximum number of rounds; stops earlier if no element moves
        #[arg(long, number = Action::ROUNDS, default_value_t = Action::ROUNDS.default())]
        rounds: u32,
        /// share of the missing distance to move in each round
        #[arg(long, number = Action::RELAX_STRENGTH, default_value_t = Action::RELAX_STRENGTH.default())]
        strength: f64,
        /// minimum distance between centres; by default, that of a regular lattice with as many elements
        #[arg(long, number = Action::MINIMUM_DISTANCE)]
        min_distance: Option<f64>,
    },
    /// Draw on one element, and repeat the drawing on all similar ones, fitted to their position, size and
    /// direction. Give an SVG over the whole canvas, drawn on one element; or a separate drawing; or a
    /// colour.
    #[command(after_help = "propagate veins.svg --layer primary")]
    #[command(group(ArgGroup::new("what").required(true).args(["drawing", "element", "fill"])))]
    Propagate {
        /// drawing on one element, an SVG of the canvas's size [a file]
        #[arg(value_name = "DRAWING", value_parser = file)]
        drawing: Option<String>,
        /// drawing that every element becomes, an SVG of any size, fitted by its largest shape [a file]
        #[arg(long, value_name = "FILE", value_parser = file)]
        element: Option<String>,
        /// colour to fill every element with [#rrggbb, #rgb or a name of CSS]
        #[arg(long, value_name = "COLOUR", value_parser = colour)]
        fill: Option<Colour>,
        /// id of the element to compare with, such as p7 in an SVG; by default the one under the drawing.
        /// Without a drawing, all selected elements are similar by default [0 or more]
        #[arg(long, value_name = "ID", value_parser = instance)]
        of: Option<InstanceId>,
        /// maximum Oklab distance between the median colours of similar elements; by default, those of the
        /// same category are similar
        #[arg(long, number = Action::SIMILAR)]
        similar: Option<f64>,
        /// draw over each element's details, or replace them [add, replace, default: add, with --element
        /// replace]
        #[arg(long = "mode", value_name = "WORD", action = ArgAction::Set, conflicts_with = "fill")]
        #[arg(value_parser = PossibleValuesParser::new(["add", "replace"]).map(|word| word == "replace"))]
        replace: Option<bool>,
    },
    /// Sort the painting order within each layer.
    #[command(after_help = "order y --layer primary")]
    Order {
        /// sort by position from the left or the top, by size, by lightness, or at random [x, y, area,
        /// lightness, random]
        #[arg(value_name = "WORD")]
        #[arg(value_parser = choice::<OrderBy>(&["x", "y", "area", "lightness", "random"]))]
        by: OrderBy,
        /// which to paint first, below the others: the least or the most [least, most, default: least]
        #[arg(long = "first", value_name = "WORD", default_value = "least", action = ArgAction::Set)]
        #[arg(value_parser = PossibleValuesParser::new(["least", "most"]).map(|word| word == "most"))]
        reverse: bool,
    },
    /// Remove elements.
    #[command(after_help = "delete --where 'area<30'")]
    Delete,
    /// Keep the elements whose centre is inside a shape, or outside.
    #[command(after_help = "mask disc.svg --keep outside")]
    Mask {
        /// an SVG with one path, fitted to the canvas, or a picture, white is inside [a file]
        #[arg(value_name = "SHAPE", value_parser = file)]
        shape: String,
        /// which side to keep [inside, outside, default: inside]
        #[arg(long, value_name = "WORD", default_value = "inside", action = ArgAction::Set)]
        #[arg(value_parser = PossibleValuesParser::new(["inside", "outside"]).map(|side| side == "inside"))]
        keep: bool,
    },
}

impl Verb {
    /// Refuses flags that have no effect without others.
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
            Self::Recolor { from, to, reach, keep } => Action::Recolor { from, to, reach, keep },
            Self::Palette { file } => {
                let colours = vtex::control::palette(&read(&file)?, &file)?;
                Action::Palette { colours, file: Some(file) }
            }
            Self::Shadow { angle, length, opacity, blur } => Action::Shadow { angle, length, opacity, blur },
            Self::Flatten => Action::Flatten,
            Self::Simplify { tolerance } => Action::Simplify { tolerance },
            Self::Outline { width, colour } => Action::Outline { width, colour },
            Self::Hatch { spacing, angle, width, color, paper } => {
                Action::Hatch { spacing, angle, width, colour: color, paper }
            }
            Self::Replace { library } => Action::Replace { library },
            Self::Move { x, y } => Action::Move { x, y },
            Self::Scale { factor } => Action::Scale { factor },
            Self::Rotate { angle } => Action::Rotate { angle },
            Self::Transform { by, scale, angle, about } => {
                Action::Transform { by: by.0, scale: scale.0, angle, about }
            }
            Self::Jitter {
                distance,
                angle,
                scale,
                stretch,
                flip,
                hue,
                chroma,
                lightness,
                distribution,
                steps,
            } => Action::Jitter(Jitter {
                distance,
                angle,
                scale,
                stretch,
                flip,
                hue,
                chroma,
                lightness,
                distribution,
                steps,
            }),
            Self::Shuffle { within, share, outlines } => Action::Shuffle { within, share, outlines },
            Self::Vary { colour, shape, within } => Action::Vary { colour, shape, within },
            Self::Relax { rounds, strength, min_distance } => {
                Action::Relax { rounds, strength, minimum_distance: min_distance }
            }
            Self::Propagate { drawing, element, fill, of, similar, replace } => {
                let replace = replace.unwrap_or(element.is_some());
                Action::Propagate { drawing, element, fill, of, similar, replace }
            }
            Self::Order { by, reverse } => Action::Order { by, reverse },
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

fn instance(text: &str) -> Result<InstanceId, String> {
    let number = text.strip_prefix('p').unwrap_or(text).parse();
    number.map(InstanceId).map_err(|_| "expected the id of an element, such as p7".into())
}

fn file(text: &str) -> Result<String, String> {
    if text.is_empty() { Err("expected a file".into()) } else { Ok(text.to_owned()) }
}

fn or_a_file(range: Parameter<f64>) -> String {
    format!("{range} or a file")
}

/// The parser of a number in a range, or a file.
fn number_or_file<T>(
    range: Parameter<f64>,
    number: fn(f64) -> T,
    map: fn(String) -> T,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| match text.parse::<f64>() {
        Ok(_) => within(range)(text).map(number),
        Err(_) => file(text).map(map),
    }
}

/// The parser of a number in a range, or a map of such.
fn or_map(range: Parameter<f64>) -> impl Fn(&str) -> Result<NumberOrMap, String> + Clone {
    number_or_file(range, NumberOrMap::Number, NumberOrMap::Map)
}

/// Numbers along x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair([f64; 2]);

/// The parser of one or two numbers in a range; `second` gives the second number if there is only one.
fn pair(range: Parameter<f64>, second: fn(f64) -> f64) -> impl Fn(&str) -> Result<Pair, String> + Clone {
    move |text| match text.split_once(',') {
        Some((x, y)) => Ok(Pair([within(range)(x.trim())?, within(range)(y.trim())?])),
        None => within(range)(text).map(|x| Pair([x, second(x)])),
    }
}

/// A colour, or a file if the text contains a dot.
fn colour_or_map(text: &str) -> Result<ColourOrMap, String> {
    match colour(text) {
        Err(_) if text.contains('.') => file(text).map(ColourOrMap::Map),
        colour => colour.map(ColourOrMap::Colour),
    }
}

/// A colour, as the command line reads it.
fn colour(text: &str) -> Result<Colour, String> {
    vtex::raster::css::colour(text).ok_or_else(|| "expected #rrggbb, #rgb or a name of CSS".into())
}

/// An example of the operation of a name; `None` if no operation has it.
pub(in crate::cli) fn example(name: &str) -> Option<String> {
    let all = <Verb as clap::Subcommand>::augment_subcommands(clap::Command::new("operation"));
    all.find_subcommand(name)?.get_after_help().map(ToString::to_string)
}
