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
    /// Take elements away: the small ones go, and of what is left a share of each layer is kept.
    #[command(after_help = "thin 0.5 --layer secondary")]
    Thin {
        /// share kept
        #[arg(number = Action::KEEP, value_name = "KEEP")]
        keep: Option<f64>,
        /// which go first: those with the nearest neighbours, so that what is left stays even; any; or
        /// the smallest [blue-noise, random, area, default: blue-noise]
        #[arg(long, value_name = "WORD", value_parser = choice::<ThinOrder>(&["blue-noise", "random", "area"]))]
        order: Option<ThinOrder>,
        /// smaller elements go, and smaller details of those that stay
        #[arg(long, number = Action::MINIMUM_AREA)]
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
        #[arg(value_name = "DEGREES", takes = or_a_file(Action::DEGREES))]
        #[arg(value_parser = number_or_file(Action::DEGREES, Direction::Angle, Direction::Map))]
        direction: Direction,
        /// share of the way
        #[arg(long, number = Action::STRENGTH, default_value_t = Action::STRENGTH.default())]
        strength: f64,
    },
    /// Mix colours with one, in Oklab.
    #[command(after_help = "tint #ff0000 --amount 0.5 --share 0.3")]
    Tint {
        /// the colour; or a picture, stretched over the canvas, that gives each element the colour it has
        /// where the element stands, and none where it is transparent [#rrggbb, #rgb or a name of CSS, or a
        /// file]
        #[arg(value_name = "COLOUR", value_parser = colour_or_map)]
        colour: ColourOrMap,
        /// its share in the mixture
        #[arg(long, number = Action::AMOUNT, default_value_t = Action::AMOUNT.default())]
        amount: f64,
        /// share of the elements tinted, chosen at random
        #[arg(long, number = Action::SHARE, default_value_t = Action::SHARE.default())]
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
        /// Oklab distance up to which colours are alike; black and white are 1 apart
        #[arg(long, number = Action::REACH, default_value_t = Action::REACH.default())]
        reach: f64,
        /// leave colours unlike the main one of their element, such as the hearts of flowers
        /// [nothing, details, default: nothing]
        #[arg(long, value_name = "WORD", value_parser = choice::<Keep>(&["nothing", "details"]))]
        #[arg(default_value = "nothing")]
        keep: Keep,
    },
    /// Replace the main colours, by the area that they cover, with those of a palette, both from dark to
    /// light; shading stays. Without --layer the background changes, too.
    #[command(after_help = "palette autumn.gpl")]
    Palette {
        /// #rrggbb in any text, or a GIMP palette [a file]
        #[arg(value_name = "FILE", value_parser = file)]
        file: String,
    },
    /// Put a shadow under each element; it falls on what lies below and on nothing above.
    #[command(after_help = "shadow --angle 60 --length 6 --layer primary")]
    Shadow {
        /// where it falls, clockwise from the right
        #[arg(long, number = Action::SHADOW_ANGLE, default_value_t = Action::SHADOW_ANGLE.default())]
        angle: f64,
        /// how far
        #[arg(long, number = Action::SHADOW_LENGTH, default_value_t = Action::SHADOW_LENGTH.default())]
        length: f64,
        /// how dark; 0 takes shadows away
        #[arg(long, number = Action::OPACITY, default_value_t = Action::OPACITY.default())]
        opacity: f64,
        /// width of its soft edge
        #[arg(long, number = Action::BLUR, default_value_t = Action::BLUR.default())]
        blur: f64,
    },
    /// Drop the details: each element gets the mean of its colours.
    #[command(after_help = "flatten")]
    Flatten,
    /// Draw outlines again with fewer points, and drop the details that are smaller than that.
    #[command(after_help = "simplify 1")]
    Simplify {
        /// how far an outline may move
        #[arg(number = Action::TOLERANCE, value_name = "PX")]
        tolerance: f64,
    },
    /// Draw a line along each element's outline.
    #[command(after_help = "outline 1.5 #202020 --layer primary")]
    Outline {
        /// width of the line; 0 takes lines away
        #[arg(number = Action::WIDTH, value_name = "WIDTH")]
        width: f64,
        /// its colour [#rrggbb, #rgb or a name of CSS]
        #[arg(value_name = "COLOUR", value_parser = colour)]
        colour: Colour,
    },
    /// Draw each element in ink: an outline on paper, and hatching that is the denser the darker it is; dark spots
    /// become dots.
    #[command(after_help = "hatch --spacing 5 --width 0.8 --layer primary")]
    Hatch {
        /// distance of the lines of the lightest tone; darker ones have them closer, then crossed
        #[arg(long, number = Action::HATCH_SPACING, default_value_t = Action::HATCH_SPACING.default())]
        spacing: f64,
        /// their direction, clockwise from the right
        #[arg(long, number = Action::HATCH_ANGLE, default_value_t = Action::HATCH_ANGLE.default())]
        angle: f64,
        /// their width, and that of outlines
        #[arg(long, number = Action::HATCH_WIDTH, default_value_t = Action::HATCH_WIDTH.default())]
        width: f64,
        /// the ink [#rrggbb, #rgb or a name of CSS, default: #202020]
        #[arg(long, value_parser = colour, default_value = "#202020")]
        color: Colour,
        /// the paper, within outlines [#rrggbb, #rgb or a name of CSS, default: white]
        #[arg(long, value_parser = colour, default_value = "white")]
        paper: Colour,
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
        /// to the right
        #[arg(number = Action::X, value_name = "X")]
        x: f64,
        /// down
        #[arg(number = Action::Y, value_name = "Y")]
        y: f64,
    },
    /// Make elements larger or smaller, each about its own centre.
    #[command(after_help = "scale 1.3 --where 'area<200'")]
    Scale {
        /// the factor; or a grey picture, stretched over the canvas: black almost nothing, middle grey as it
        /// is, white twice
        #[arg(value_name = "FACTOR", takes = or_a_file(Action::FACTOR), value_parser = or_map(Action::FACTOR))]
        factor: NumberOrMap,
    },
    /// Turn elements, each about its own centre.
    #[command(after_help = "rotate 90 --layer primary")]
    Rotate {
        /// clockwise; or a grey picture, black 0 to white 360
        #[arg(value_name = "DEGREES", takes = or_a_file(Action::DEGREES), value_parser = or_map(Action::DEGREES))]
        angle: NumberOrMap,
    },
    /// Scale, turn and move elements in one go, each about its own centre or all about theirs.
    #[command(
        after_help = "transform --scale 1.5 --rotate 30 --move 20,-5 --about selection --where category=3"
    )]
    Transform {
        /// to the right, or to the right and down with a comma between
        #[arg(long = "move", value_name = "NUMBER", value_parser = pair(Action::WAY, |_| 0.0))]
        #[arg(takes = format!("{}, default: 0", Action::WAY), default_value = "0", allow_hyphen_values = true)]
        by: Pair,
        /// the factor, or those along x and y with a comma between
        #[arg(long, value_name = "NUMBER", value_parser = pair(Action::FACTORS, |x| x))]
        #[arg(takes = format!("{}, default: 1", Action::FACTORS), default_value = "1", allow_hyphen_values = true)]
        scale: Pair,
        /// clockwise, after scaling
        #[arg(long = "rotate", number = Action::TURN, default_value_t = Action::TURN.default())]
        angle: f64,
        /// the point that stays: the centre of each, or the mean of the centres of all selected
        /// [each, selection, default: each]
        #[arg(long, value_name = "WORD", value_parser = choice::<About>(&["each", "selection"]))]
        #[arg(default_value = "each")]
        about: About,
    },
    /// Move, turn, scale, stretch, mirror and recolour each element at random.
    #[command(after_help = "jitter --move 4 --rotate 15 --scale 10 --hue 8 --lightness 5")]
    Jitter {
        /// at most so far
        #[arg(long = "move", number = Jitter::DISTANCE, default_value_t = Jitter::DISTANCE.default())]
        distance: f64,
        /// at most this much either way
        #[arg(long = "rotate", number = Jitter::ANGLE, default_value_t = Jitter::ANGLE.default())]
        angle: f64,
        /// at most this much either way
        #[arg(long, number = Jitter::SCALE, default_value_t = Jitter::SCALE.default())]
        scale: f64,
        /// the ratio of length to width at most this much either way; areas stay
        #[arg(long, number = Jitter::STRETCH, default_value_t = Jitter::STRETCH.default())]
        stretch: f64,
        /// share of the elements that are mirrored, left to right
        #[arg(long, number = Jitter::FLIP, default_value_t = Jitter::FLIP.default())]
        flip: f64,
        /// hues turned at most this much either way
        #[arg(long, number = Jitter::HUE, default_value_t = Jitter::HUE.default())]
        hue: f64,
        /// chroma at most so much more or less
        #[arg(long, number = Jitter::CHROMA, default_value_t = Jitter::CHROMA.default())]
        chroma: f64,
        /// lightness at most so much more or less; white is 100 above black
        #[arg(long, number = Jitter::LIGHTNESS, default_value_t = Jitter::LIGHTNESS.default())]
        lightness: f64,
        /// evenly between the bounds, or normally, with the bounds at two standard deviations
        /// [uniform, normal, default: uniform]
        #[arg(long, value_name = "WORD", value_parser = choice::<Distribution>(&["uniform", "normal"]))]
        #[arg(default_value = "uniform")]
        distribution: Distribution,
        /// every change is a multiple of the bound divided by this; 0 for any change
        #[arg(long, number = Jitter::STEPS, default_value_t = Jitter::STEPS.default())]
        steps: u32,
    },
    /// Let appearances, colours and details, change places at random among elements of like size.
    #[command(after_help = "shuffle --layer primary --share 0.5")]
    Shuffle {
        /// among the elements of a layer, or of each category in it [layer, category, default: layer]
        #[arg(long, value_name = "WORD", value_parser = choice::<Within>(&["layer", "category"]))]
        #[arg(default_value = "layer")]
        within: Within,
        /// share of the elements that take part
        #[arg(long, number = Action::SHARE, default_value_t = Action::SHARE.default())]
        share: f64,
        /// whether outlines stay, or change places too, each fitted to the size and direction of the other
        /// [keep, exchange, default: keep]
        #[arg(long, value_name = "WORD", default_value = "keep", action = ArgAction::Set)]
        #[arg(value_parser = PossibleValuesParser::new(["keep", "exchange"]).map(|word| word == "exchange"))]
        outlines: bool,
    },
    /// Make colours and shapes more alike or more varied, about their mean.
    #[command(after_help = "vary --color 1.5 --shape 0.5 --within category")]
    Vary {
        /// 0 gives all the same median colour, 1 changes nothing, 2 makes them vary twice as much; or a
        /// grey picture, black 0 to white 2
        #[arg(long = "color", value_name = "NUMBER", takes = or_a_file(Action::COLOUR))]
        #[arg(value_parser = or_map(Action::COLOUR))]
        colour: Option<NumberOrMap>,
        /// as much for size, elongation and direction
        #[arg(long, value_name = "NUMBER", takes = or_a_file(Action::SHAPE), value_parser = or_map(Action::SHAPE))]
        shape: Option<NumberOrMap>,
        /// one mean for the elements of a layer, or for each category in it [layer, category, default: layer]
        #[arg(long, value_name = "WORD", value_parser = choice::<Within>(&["layer", "category"]))]
        #[arg(default_value = "layer")]
        within: Within,
    },
    /// Move elements apart where they are close, so that distances become even.
    #[command(after_help = "relax --rounds 30 --layer secondary")]
    Relax {
        /// how often they move; it ends sooner if none moves any more
        #[arg(long, number = Action::ROUNDS, default_value_t = Action::ROUNDS.default())]
        rounds: u32,
        /// share of the way each time
        #[arg(long, number = Action::RELAX_STRENGTH, default_value_t = Action::RELAX_STRENGTH.default())]
        strength: f64,
        /// no centres nearer than this; by default, the distance in a regular lattice of as many elements
        #[arg(long, number = Action::MINIMUM_DISTANCE)]
        min_distance: Option<f64>,
    },
    /// Draw on one element, and it appears on all like it, fitted to their place, size and direction. The
    /// drawing is an SVG over the whole canvas, and the element under it is the one that is drawn on; or a
    /// drawing by itself, or a colour.
    #[command(after_help = "propagate veins.svg --layer primary")]
    #[command(group(ArgGroup::new("what").required(true).args(["drawing", "element", "fill"])))]
    Propagate {
        /// what is drawn, an SVG of the canvas's size [a file]
        #[arg(value_name = "DRAWING", value_parser = file)]
        drawing: Option<String>,
        /// what every element becomes, an SVG of any size, fitted by its largest shape [a file]
        #[arg(long, value_name = "FILE", value_parser = file)]
        element: Option<String>,
        /// the colour that every element is filled with [#rrggbb, #rgb or a name of CSS]
        #[arg(long, value_name = "COLOUR", value_parser = colour)]
        fill: Option<Colour>,
        /// id of the element that the others are like, as in p7 of an SVG; by default the one under the
        /// drawing, and without a drawing all that are selected are alike [0 or more]
        #[arg(long, value_name = "ID", value_parser = instance)]
        of: Option<InstanceId>,
        /// alike are elements whose median colours are no further apart in Oklab; by default, those of the
        /// same category
        #[arg(long, number = Action::SIMILAR)]
        similar: Option<f64>,
        /// draw it on what elements show, or in place of that [add, replace, default: add, with --element
        /// replace]
        #[arg(long = "mode", value_name = "WORD", action = ArgAction::Set, conflicts_with = "fill")]
        #[arg(value_parser = PossibleValuesParser::new(["add", "replace"]).map(|word| word == "replace"))]
        replace: Option<bool>,
    },
    /// Sort the painting order within each layer.
    #[command(after_help = "order y --layer primary")]
    Order {
        /// place from the left or the top, size, lightness, or none [x, y, area, lightness, random]
        #[arg(value_name = "WORD")]
        #[arg(value_parser = choice::<OrderBy>(&["x", "y", "area", "lightness", "random"]))]
        by: OrderBy,
        /// which is painted first, and lies undermost [least, most, default: least]
        #[arg(long = "first", value_name = "WORD", default_value = "least", action = ArgAction::Set)]
        #[arg(value_parser = PossibleValuesParser::new(["least", "most"]).map(|word| word == "most"))]
        reverse: bool,
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
