//! Operations that change colours and keep the shading. All arithmetic is in Oklab.

use super::Draw;
use super::amount::ColourByPlace;
use super::selection::Chosen;
use super::textons::{change, repaint, selected, selected_mut};
use vtex_base::geometry::Point;
use vtex_base::raster::colour::{Colour, squared_distance};
use vtex_base::raster::oklab_map::OklabMap;
use vtex_scene::element::Appearance;
use vtex_scene::scene::{Element, Gradient, Instance, InstanceId, Scene, Shape};

/// Mixes a colour by `amount` into the colours of a random share of the selected elements and points.
pub(super) fn tint(
    scene: &mut Scene,
    chosen: &Chosen,
    paint: &ColourByPlace<'_>,
    amount: f64,
    share: f64,
    draw: &Draw,
) {
    let drawn = |id: InstanceId| share >= 1.0 || draw.of("edit/tint", id).chance(share);
    let point = |_: usize, i: usize| drawn(InstanceId(i as u32));
    let chosen = &chosen.only(scene, |i| drawn(i.id), point);
    if let ColourByPlace::Colour(colour) = paint {
        return recolour(scene, chosen, |_, c| c.mixed(*colour, amount));
    }
    let canvas = [f64::from(scene.width), f64::from(scene.height)];
    let mixed = |at: Point| {
        let (colour, opacity) = paint.at(at, canvas);
        OklabMap::mix(colour, (amount * opacity) as f32)
    };
    let maps: Vec<OklabMap> = selected(scene, chosen).map(|i| mixed(scene.place(i))).collect();
    repaint(scene, chosen, &maps);
    for (layer, chosen) in scene.layers.iter_mut().zip(&chosen.layers) {
        let Some(field) = &mut layer.field else { continue };
        let middle = Point::new(canvas[0] / 2.0, canvas[1] / 2.0);
        if chosen.fallback {
            field.fallback = mixed(middle).of(field.fallback);
        }
        for (point, _) in field.points.iter_mut().zip(&chosen.points).filter(|(_, chosen)| **chosen) {
            point.colour = mixed(Point::new(point.x, point.y)).of(point.colour);
        }
    }
}

/// Colours that are moved, and how far.
#[derive(Clone, Copy)]
pub(super) struct Shift {
    pub(super) from: Colour,
    pub(super) to: Colour,
    /// Oklab distance from `from` at which nothing moves.
    pub(super) reach: f64,
    /// Whether colours unlike the main one of their element stay.
    pub(super) keeps_details: bool,
}

/// Distance from the main colour of an element from which on a colour is a detail, in Oklab, and the factor of
/// differences in lightness in it, which are mostly shading.
const DETAIL: f64 = 0.12;
const SHADING: f32 = 0.4;
/// Least share of an element at which details that are recoloured have its main colour.
const MAIN: f64 = 0.2;

/// Shifts colours near `from` by the difference to `to`; the shift falls to 0 at the distance `reach`.
/// Returns the number of textons and points with a colour that moves.
pub(super) fn recolor(scene: &mut Scene, chosen: &Chosen, shift: Shift) -> usize {
    let Shift { from, to, reach, keeps_details } = shift;
    let (from, to) = (from.to_oklab(), to.to_oklab());
    let way: [f32; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let share = |colour: Colour, main: Option<[f32; 3]>| {
        let lab = colour.to_oklab();
        let own = main.map_or(1.0, |main| falling(apart(lab, main) / DETAIL));
        own * falling(f64::from(libm::sqrtf(squared_distance(lab, from))) / reach)
    };
    let alike = |colour: Colour, main: Option<[f32; 3]>| share(colour, main) > 0.0;
    let main_of = |element: &Element| keeps_details.then(|| main_colour(element, from));
    // For each element, whether its base and whether its details have a colour near `from`. An instance's own
    // colour hides the base.
    let elements: Vec<[bool; 2]> = vtex_base::parallel::map(&scene.elements, |e| {
        let main = main_of(e);
        let shaded = |g: &Option<Box<Gradient>>| {
            g.as_ref().is_some_and(|g| alike(g.start, main) || alike(g.end, main))
        };
        let has = |s: &Shape| alike(s.colour, main) || shaded(&s.gradient);
        [has(e.base()), e.details().iter().any(has)]
    });
    let has = |i: &Instance| {
        let [base, detail] = elements[i.element.index()];
        detail || i.colour.map_or(base, |colour| alike(colour, None))
    };
    let point =
        |k: usize, i: usize| scene.layers[k].field.as_ref().is_some_and(|f| alike(f.points[i].colour, None));
    let chosen = chosen.only(scene, has, point);
    recolour(scene, &chosen, |element, colour| match share(colour, element.and_then(main_of)) {
        0.0 => colour,
        share => moved(colour.to_oklab(), way, share as f32),
    });
    chosen.count()
}

/// The main colour of an element: the colours like `from` if they are seen, else that of the first shape.
fn main_colour(element: &Element, from: [f32; 3]) -> [f32; 3] {
    let base = element.base().colour.to_oklab();
    let alike = element.details().iter().map(|d| (d.colour.to_oklab(), d.area() * d.opacity));
    let alike = alike.filter(|(lab, _)| apart(*lab, from) < DETAIL);
    let [l, a, b, area] = alike.fold([0.0; 4], |[l, a, b, all], (lab, area)| {
        let [own_l, own_a, own_b] = lab.map(|v| f64::from(v) * area);
        [l + own_l, a + own_a, b + own_b, all + area]
    });
    let is_base = apart(base, from) < DETAIL || area <= MAIN * element.base().area();
    if is_base { base } else { [l, a, b].map(|v| (v / area) as f32) }
}

/// Distance of colours in Oklab, in which lightness counts less, because it is mostly shading.
fn apart([l, a, b]: [f32; 3], other: [f32; 3]) -> f64 {
    let as_light = [other[0] + SHADING * (l - other[0]), a, b];
    f64::from(libm::sqrtf(squared_distance(as_light, other)))
}

/// 1 up to a half, 0 from 1 on, smooth between.
fn falling(far: f64) -> f64 {
    let far = (2.0 * far - 1.0).clamp(0.0, 1.0);
    1.0 - far * far * (3.0 - 2.0 * far)
}

/// The mean colour of a texton, details included: details painted later hide those below, and are assumed to
/// hide the base first.
pub(super) fn mean(element: &Element) -> Colour {
    Colour::from_oklab(Appearance::new(&element.shapes, element.outline().area(), None).mean)
}

fn moved(lab: [f32; 3], way: [f32; 3], share: f32) -> Colour {
    Colour::from_oklab(std::array::from_fn(|i| lab[i] + share * way[i]))
}

/// Replaces all colours of selected elements and points. `new` gets the element; `None` for fields, and for the colours
/// of instances, which are main colours.
pub(super) fn recolour(
    scene: &mut Scene,
    chosen: &Chosen,
    new: impl Fn(Option<&Element>, Colour) -> Colour + Sync + Send,
) {
    // The instances' own colours are replaced first, while the elements still have their old colours.
    let own: Vec<Option<Colour>> = selected(scene, chosen).map(|i| i.colour.map(|c| new(None, c))).collect();
    selected_mut(scene, chosen).zip(own).for_each(|(instance, colour)| instance.colour = colour);
    change(scene, chosen, |element, _| {
        let shapes = element.shapes.iter().map(|s| s.recoloured(|c| new(Some(element), c)));
        element.with_shapes(shapes.collect())
    });
    for (layer, chosen) in scene.layers.iter_mut().zip(&chosen.layers) {
        let Some(field) = &mut layer.field else { continue };
        if chosen.fallback {
            field.fallback = new(None, field.fallback);
        }
        for (point, _) in field.points.iter_mut().zip(&chosen.points).filter(|(_, chosen)| **chosen) {
            point.colour = new(None, point.colour);
        }
    }
}
