//! Picture × scene → scene: any picture redrawn in the elements of a texture (Tu, dissertation, figure 4.5).
//!
//! Elements are placed in levels, large ones first. Those of a level are half as large as those of the
//! previous one, and are placed only where the picture has detail that earlier levels do not show (as
//! Hertzmann 1998, "Painterly Rendering with Curved Brush Strokes of Multiple Sizes"). Each element follows
//! the direction of the edge under it, given by the structure tensor; clearer edges have longer elements.
//!
//! Works badly with large elements of strong contrast, whose details hide those of the picture.

use super::donors::Donors;
use crate::edit::draw_as;
use image::RgbImage;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use vtex_base::Parameter;
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::{Point, Vec2};
use vtex_base::parallel;
use vtex_base::raster::blur::{Plane, oklab_planes};
use vtex_base::raster::colour::{Colour, squared_distance};
use vtex_base::raster::oklab_map::OklabMap;
use vtex_base::sampling::{Area, poisson_disk, stream};
use vtex_scene::element::{Appearance, Gaussian};
use vtex_scene::scene::{
    ControlPoint, Element, ElementId, Field, Instance, InstanceId, Layer, Repaint, Role, Scene,
};

/// Longer side of the reduced picture that is analysed, in pixels.
const LOOKED_AT: u32 = 640;
/// Side of an element's square over the distance between elements of its level: above 1, they overlap.
const COVER: f64 = 1.35;
/// Difference in Oklab from the larger elements above which smaller ones are placed.
const DETAIL: f64 = 0.035;
/// Largest ratio of length to width.
const LONGEST: f64 = 2.6;
/// Standard deviation of a square over its side.
const SQUARE: f64 = 0.288_675;

/// What elements take over from the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Keep {
    /// Lightness; hue and chroma are their own.
    Lightness,
    /// Lightness and colour.
    #[default]
    Color,
    /// Nothing: the elements with the nearest colours are chosen.
    None,
}

/// How a picture is redrawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StylizeParams {
    /// Longer side of the canvas, in pixels.
    pub size: u32,
    /// Distance of the largest elements, in pixels of the canvas; `None`, the default, for a 28th of the longer
    /// side.
    pub element: Option<f64>,
    /// Number of levels.
    pub levels: u32,
    /// What elements take over from the picture. Default: [`Keep::Color`].
    pub keep: Keep,
    /// Seed of random choices. Default 0.
    pub seed: u64,
}

/// Ranges, units and defaults of the fields of the same names.
#[allow(missing_docs)]
impl StylizeParams {
    pub const SIZE: Parameter<u32> = Parameter::new("size", [32, 16_384], "px").or(1000);
    /// At least 2 pixels, because smaller elements are hardly wider than a pixel.
    pub const ELEMENT: Parameter<f64> = Parameter::new("element-size", [2.0, 1000.0], "px");
    pub const LEVELS: Parameter<u32> = Parameter::new("levels", [1, 6], "").or(4);
}

impl Default for StylizeParams {
    fn default() -> Self {
        let (size, levels) = (Self::SIZE.default(), Self::LEVELS.default());
        Self { size, element: None, levels, keep: Keep::Color, seed: 0 }
    }
}

/// Most control points of the background along the longer side.
const FINEST_FIELD: f64 = 200.0;
/// Most places of elements on one level.
const MOST_PLACES: f64 = 4e6;

/// A picture redrawn in the elements of a texture, on a canvas of its proportions. A texture without large
/// elements is used with its small ones.
///
/// # Errors
/// [`Error::Format`] for a scene that breaks its invariants; [`Error::Parameter`] for a parameter out of
/// range; [`Error::TooLarge`] for more than four million places on one level; [`Error::Control`] for a texture
/// none of whose elements has a frame.
pub fn stylize(picture: &RgbImage, texture: &Scene, params: &StylizeParams) -> Result<Scene> {
    texture.check()?;
    StylizeParams::SIZE.check(params.size)?;
    StylizeParams::LEVELS.check(params.levels)?;
    let [w, h] = [picture.width(), picture.height()].map(f64::from);
    let scale = f64::from(params.size) / w.max(h);
    let canvas = [w, h].map(|v| libm::round(v * scale).max(1.0));
    let largest =
        params.element.unwrap_or((f64::from(params.size) / 28.0).max(StylizeParams::ELEMENT.range[0]));
    StylizeParams::ELEMENT.check(largest)?;
    let donors = Donors::new(texture);
    let role = [Role::Primary, Role::Secondary].into_iter().find(|role| donors.has(*role));
    let Some(role) = role else {
        return Err(Error::Control {
            name: "the texture".into(),
            role: "something to redraw a picture in",
            reason: "none of its elements is wider than a pixel".into(),
            advice: "give a photograph or a drawing in which elements are found",
        });
    };
    let view = StretchedPicture::new(picture, canvas);
    let mut spots: Vec<Spot> = Vec::new();
    let mut distance = largest;
    let mut shown: Option<[Plane; 3]> = None;
    for level in 0..params.levels {
        if distance < StylizeParams::ELEMENT.range[0] {
            break;
        }
        let places = canvas[0] * canvas[1] / (distance * distance);
        if places > MOST_PLACES {
            return Err(Error::TooLarge {
                what: Large::Redrawn,
                name: "the redrawn picture".into(),
                found: format!("{:.0} million places for elements {distance} px apart", places / 1e6),
                limit: format!("{:.0} million places", MOST_PLACES / 1e6),
            });
        }
        let seen = view.blurred(distance / 2.5);
        spots.extend(view.level((level, distance), &seen, shown.as_ref(), params.seed));
        shown = Some(seen);
        distance /= 2.0;
    }
    let scene = composed(&Painting { texture, donors, role, params }, &view, &spots, largest);
    scene.check()?;
    Ok(scene)
}

/// The place of an element to paint.
struct Spot {
    gaussian: Gaussian,
    /// The colour of the picture there, in Oklab.
    colour: [f32; 3],
}

/// A reduced picture, and the canvas over which it is stretched.
struct StretchedPicture {
    planes: [Plane; 3],
    canvas: [f64; 2],
}

impl StretchedPicture {
    fn new(picture: &RgbImage, canvas: [f64; 2]) -> Self {
        let longer = picture.width().max(picture.height());
        let factor = longer.div_ceil(LOOKED_AT).min(picture.width().min(picture.height())).max(1);
        Self { planes: oklab_planes(picture, factor as usize), canvas }
    }

    /// Pixels of the picture per pixel of the canvas.
    fn scale(&self) -> f64 {
        self.planes[0].size[0] as f64 / self.canvas[0]
    }

    /// The picture under a Gaussian of a deviation in pixels of the canvas.
    fn blurred(&self, sigma: f64) -> [Plane; 3] {
        let sigma = (sigma * self.scale()) as f32;
        self.planes.each_ref().map(|plane| plane.blurred(sigma, [false; 2]))
    }

    /// Column and row of a point of the canvas.
    fn cell(&self, p: Point) -> [usize; 2] {
        let [columns, rows] = self.planes[0].size;
        let along = |v: f64, size: f64, count: usize| ((v / size * count as f64) as usize).min(count - 1);
        [along(p.x, self.canvas[0], columns), along(p.y, self.canvas[1], rows)]
    }

    /// Places about `distance` apart. The largest elements form a Poisson-disk set; smaller ones are many, so
    /// each is placed at random in a cell of a lattice, which is cheaper.
    fn points(&self, (level, distance): (u32, f64), seed: u64) -> Vec<[f64; 2]> {
        let mut random = stream(seed, "stylize/level", level.into());
        let [width, height] = self.canvas;
        if level == 0 {
            return poisson_disk(Area::plane(width, height), 0.8 * distance, &mut random);
        }
        let [columns, rows] = self.canvas.map(|v| libm::ceil(v / distance) as usize);
        let side = [width / columns as f64, height / rows as f64];
        let mut within = |i: usize, side: f64| (i as f64 + random.range(0.15, 0.85)) * side;
        (0..columns * rows).map(|i| [within(i % columns, side[0]), within(i / columns, side[1])]).collect()
    }

    /// The spots of a level, about `distance` apart, where the picture painted so far differs from the
    /// original.
    fn level(
        &self,
        (level, distance): (u32, f64),
        seen: &[Plane; 3],
        shown: Option<&[Plane; 3]>,
        seed: u64,
    ) -> Vec<Spot> {
        let points = self.points((level, distance), seed);
        let tensor = StructureTensor::new(&seen[0], (distance / 2.0 * self.scale()) as f32);
        let spots = points.into_iter().filter_map(|[x, y]| {
            let at = Point::new(x, y);
            let [column, row] = self.cell(at);
            let colour = seen.each_ref().map(|plane| plane.at(column, row));
            let missing = shown.is_none_or(|shown| {
                let before = shown.each_ref().map(|plane| plane.at(column, row));
                let square: f32 = (0..3).map(|k| (colour[k] - before[k]) * (colour[k] - before[k])).sum();
                f64::from(square) > DETAIL * DETAIL
            });
            missing.then(|| Spot { gaussian: tensor.gaussian(at, [column, row], distance), colour })
        });
        spots.collect()
    }
}

/// The structure tensor of a plane: products of its slopes, smoothed.
struct StructureTensor([Plane; 3]);

impl StructureTensor {
    fn new(plane: &Plane, sigma: f32) -> Self {
        let [w, h] = plane.size;
        let slopes = |x: usize, y: usize| {
            let across = plane.at((x + 1).min(w - 1), y) - plane.at(x.saturating_sub(1), y);
            let down = plane.at(x, (y + 1).min(h - 1)) - plane.at(x, y.saturating_sub(1));
            [across * across, across * down, down * down]
        };
        let all: Vec<[f32; 3]> = (0..w * h).map(|i| slopes(i % w, i / w)).collect();
        let plane = |k: usize| Plane { size: [w, h], values: all.iter().map(|v| v[k]).collect() };
        Self([0, 1, 2].map(|k| plane(k).blurred(sigma, [false; 2])))
    }

    /// The Gaussian of an element that lies along the edge at a place.
    fn gaussian(&self, mean: Point, [column, row]: [usize; 2], distance: f64) -> Gaussian {
        let [xx, xy, yy] = self.0.each_ref().map(|plane| f64::from(plane.at(column, row)));
        let difference = libm::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy);
        // Slopes of a thousandth of the range of lightness are noise.
        let clear = difference / (xx + yy + 1e-6);
        let across = libm::atan2(2.0 * xy, xx - yy) / 2.0;
        let along = across + std::f64::consts::FRAC_PI_2;
        let ratio = libm::sqrt(1.0 + (LONGEST - 1.0) * clear);
        let deviation = distance * COVER * SQUARE;
        let [long, short] = [deviation * ratio, deviation / ratio].map(|v| v * v);
        let (sine, cosine) = libm::sincos(along);
        let covariance = [
            long * cosine * cosine + short * sine * sine,
            (long - short) * cosine * sine,
            long * sine * sine + short * cosine * cosine,
        ];
        Gaussian { mean, covariance, direction: Vec2::new(cosine, sine) }
    }
}

/// The elements that a picture is painted with.
struct Painting<'a> {
    texture: &'a Scene,
    donors: Donors<'a>,
    role: Role,
    params: &'a StylizeParams,
}

/// The scene of all spots, over a soft picture.
fn composed(painting: &Painting<'_>, view: &StretchedPicture, spots: &[Spot], largest: f64) -> Scene {
    let Painting { texture, donors, role, params } = painting;
    let size = view.canvas.map(|v| v as u32);
    // Denser elements hide the background, and its cost grows with the inverse square of the spacing.
    let spacing = largest.max(f64::from(params.size) / FINEST_FIELD);
    let background = Layer { field: Some(field(view, spacing)), ..Layer::new(Role::Background) };
    let mut scene = Scene::new(size, texture.libraries.clone(), vec![background]);
    let appearances =
        parallel::map(&texture.elements, |e| Appearance::new(&e.shapes, e.outline().area(), None));
    let (mut known, mut repaint) = (BTreeMap::new(), Repaint::default());
    let mut elements: Vec<Element> = Vec::new();
    let mut layer = Layer::new(*role);
    for (k, spot) in spots.iter().enumerate() {
        let random = stream(params.seed, "stylize/elements", k as u64);
        let colour_of = |i: &Instance| {
            let element = texture.element(i);
            let own = i.colour.map(|c| Appearance::new(&element.shapes, element.outline().area(), Some(c)));
            own.unwrap_or(appearances[i.element.index()]).median
        };
        let donor = match params.keep {
            Keep::None => {
                donors.nearest(*role, &spot.gaussian, |i| squared_distance(colour_of(i), spot.colour))
            }
            Keep::Lightness | Keep::Color => donors.draw(*role, &spot.gaussian, random),
        };
        let Some(donor) = donor else { continue };
        let mut instance = Instance { id: InstanceId(k as u32), motif: None, ..donor.instance.clone() };
        instance.shadow = None;
        instance.stroke = None;
        instance.element = *known.entry(donor.instance.element).or_insert_with(|| {
            elements.push(texture.element(donor.instance).clone());
            ElementId::after(elements.len() - 1)
        });
        draw_as(&mut instance, donor.instance, &donor.gaussian, &spot.gaussian, [None; 2]);
        repaint.paint(
            &mut elements,
            &mut instance,
            &change(params.keep, colour_of(donor.instance), spot.colour),
        );
        layer.instances.push(instance);
    }
    scene.elements = elements;
    scene.layers.push(layer);
    scene.drop_unused();
    scene
}

/// The change of an element's colours, given its own and the picture's. Rounded, so that equal elements are
/// stored once.
fn change(keep: Keep, own: [f32; 3], wanted: [f32; 3]) -> OklabMap {
    let short = |v: f32| libm::roundf(v * 200.0) / 200.0;
    let way: [f32; 3] = std::array::from_fn(|k| short(wanted[k] - own[k]));
    match keep {
        Keep::Color => OklabMap::shift(way),
        Keep::Lightness => OklabMap::shift([way[0], 0.0, 0.0]),
        Keep::None => OklabMap::IDENTITY,
    }
}

/// A field with the colours of the picture.
fn field(view: &StretchedPicture, spacing: f64) -> Field {
    let soft = view.blurred(spacing / 2.0);
    let [columns, rows] = view.canvas.map(|v| (v / spacing) as usize + 2);
    let at = |i: usize, count: usize, size: f64| size * i as f64 / (count - 1) as f64;
    let point = |i: usize| {
        let p = Point::new(at(i % columns, columns, view.canvas[0]), at(i / columns, rows, view.canvas[1]));
        let [column, row] = view.cell(p);
        let colour = Colour::from_oklab(soft.each_ref().map(|plane| plane.at(column, row)));
        ControlPoint { x: p.x, y: p.y, colour }
    };
    let points: Vec<ControlPoint> = (0..columns * rows).map(point).collect();
    Field { spacing, fallback: points[0].colour, points }
}
