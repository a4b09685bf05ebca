//! Operations that change colours and keep the shading. All arithmetic is in Oklab.

use super::Draw;
use super::amount::ColourByPlace;
use super::selection::Chosen;
use super::textons::{change, repaint, selected, selected_mut};
use std::collections::BTreeMap;
use vtex_base::geometry::Point;
use vtex_base::raster::colour::{Colour, squared_distance};
use vtex_base::raster::oklab_map::OklabMap;
use vtex_scene::element::Appearance;
use vtex_scene::scene::{CategoryId, Element, Gradient, Instance, InstanceId, LibraryId, Scene, Shape};

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

/// Shifts colours near `from` by the difference to `to`; the shift falls to 0 at the distance `reach`.
/// Returns the number of textons and points with a colour within `reach`.
pub(super) fn recolor(scene: &mut Scene, chosen: &Chosen, from: Colour, to: Colour, reach: f64) -> usize {
    let (from, to) = (from.to_oklab(), to.to_oklab());
    let way: [f32; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let share = |colour: Colour| {
        // The full shift up to half the reach, none from the reach on, smooth between.
        let far = 2.0 * f64::from(libm::sqrtf(squared_distance(colour.to_oklab(), from))) / reach - 1.0;
        let far = far.clamp(0.0, 1.0);
        1.0 - far * far * (3.0 - 2.0 * far)
    };
    let alike = |colour: Colour| share(colour) > 0.0;
    let shaded = |g: &Option<Box<Gradient>>| g.as_ref().is_some_and(|g| alike(g.start) || alike(g.end));
    // For each element, whether its base and whether its details have a colour near `from`. An instance's own
    // colour hides the base.
    let elements: Vec<[bool; 2]> = vtex_base::parallel::map(&scene.elements, |e| {
        let has = |s: &Shape| alike(s.colour) || shaded(&s.gradient);
        [has(e.base()), e.details().iter().any(has)]
    });
    let has = |i: &Instance| {
        let [base, detail] = elements[i.element.index()];
        detail || i.colour.map_or(base, alike)
    };
    let point =
        |k: usize, i: usize| scene.layers[k].field.as_ref().is_some_and(|f| alike(f.points[i].colour));
    let chosen = chosen.only(scene, has, point);
    recolour(scene, &chosen, |_, colour| match share(colour) {
        0.0 => colour,
        share => moved(colour.to_oklab(), way, share as f32),
    });
    chosen.count()
}

/// Gives categories new mean colours, by rank of lightness.
pub(super) fn palette(scene: &mut Scene, chosen: &Chosen, colours: &[Colour]) {
    let mut ranked: Vec<(Key, [f32; 3])> = means(scene, colours.len()).into_iter().collect();
    ranked.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]).then(a.0.cmp(&b.0)));
    let mut wanted: Vec<[f32; 3]> = colours.iter().map(|c| c.to_oklab()).collect();
    wanted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (count, new) = (ranked.len(), wanted.len());
    // With more colours than categories, the palette is divided evenly among categories, and each gets the
    // middle colour of its part.
    let chosen_colour = |rank: usize| wanted[(2 * rank + 1) * new / (2 * count)];
    let known: BTreeMap<Key, [f32; 3]> = (ranked.iter().enumerate())
        .map(|(rank, (key, mean))| (*key, std::array::from_fn(|i| chosen_colour(rank)[i] - mean[i])))
        .collect();
    let tones: Vec<(f32, [f32; 3])> =
        ranked.iter().enumerate().map(|(rank, (_, mean))| (mean[0], chosen_colour(rank))).collect();
    let tones = joined(&tones);
    recolour(scene, chosen, |element, colour| {
        let lab = colour.to_oklab();
        match element.and_then(key_of).and_then(|key| known.get(&key)) {
            Some(way) => moved(lab, *way, 1.0),
            None => Colour::from_oklab(toned(&tones, lab)),
        }
    });
}

/// One tone for each run of the same colour, at the mean lightness of the run.
fn joined(tones: &[(f32, [f32; 3])]) -> Vec<(f32, [f32; 3])> {
    let runs = tones.chunk_by(|a, b| a.1 == b.1);
    runs.map(|run| (run.iter().map(|t| t.0).sum::<f32>() / run.len() as f32, run[0].1)).collect()
}

/// The colour at the lightness of `lab`, interpolated between tones of ascending lightness.
fn toned(tones: &[(f32, [f32; 3])], lab: [f32; 3]) -> [f32; 3] {
    let above = tones.partition_point(|t| t.0 <= lab[0]);
    match (above.checked_sub(1).map(|i| tones[i]), tones.get(above)) {
        (Some((low, a)), Some(&(high, b))) => {
            let share = (lab[0] - low) / (high - low).max(1e-6);
            std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
        }
        // Beyond the ends only lightness changes.
        (Some((tone, [l, a, b])), None) | (None, Some(&(tone, [l, a, b]))) => [l + lab[0] - tone, a, b],
        (None, None) => lab,
    }
}

/// Library and category. Without categories, a step of lightness takes the place of the library.
type Key = (LibraryId, Option<CategoryId>);

/// The group of a texton that belongs to a category.
fn key_of(element: &Element) -> Option<Key> {
    element.category.map(|c| (element.library, Some(c)))
}

/// The mean colour of each category, by area. In a scene without categories, the mean colour of each of
/// `steps` steps of lightness of equal area.
fn means(scene: &Scene, steps: usize) -> BTreeMap<Key, [f32; 3]> {
    let means: Vec<[f32; 3]> = vtex_base::parallel::map(&scene.elements, |t| mean(t).to_oklab());
    let areas: Vec<f64> = scene.elements.iter().map(|t| t.outline().area()).collect();
    let measured = |instance: &Instance| {
        let index = instance.element.index();
        let lab = instance.colour.map_or(means[index], Colour::to_oklab);
        let area = areas[index] * instance.affine().determinant().abs() + 1e-6;
        (key_of(&scene.elements[index]), lab, area)
    };
    let mut all: Vec<_> = scene.instances().map(measured).collect();
    if all.iter().all(|(key, ..)| key.is_none()) {
        all.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
        let whole: f64 = all.iter().map(|(.., area)| area).sum();
        let mut below = 0.0;
        for (key, _, area) in &mut all {
            let step = (below + *area / 2.0) / whole * steps as f64;
            *key = Some((LibraryId(step as u32), None));
            below += *area;
        }
    }
    let mut sums: BTreeMap<Key, [f64; 4]> = BTreeMap::new();
    for (key, lab, area) in all {
        let Some(key) = key else { continue };
        let sum = sums.entry(key).or_default();
        (0..3).for_each(|i| sum[i] += area * f64::from(lab[i]));
        sum[3] += area;
    }
    sums.into_iter().map(|(key, [l, a, b, area])| (key, [l, a, b].map(|v| (v / area) as f32))).collect()
}

/// The mean colour of a texton, details included: details painted later hide those below, and are assumed to
/// hide the base first.
pub(super) fn mean(element: &Element) -> Colour {
    Colour::from_oklab(Appearance::new(&element.shapes, element.outline().area(), None).mean)
}

fn moved(lab: [f32; 3], way: [f32; 3], share: f32) -> Colour {
    Colour::from_oklab(std::array::from_fn(|i| lab[i] + share * way[i]))
}

/// Replaces all colours of selected elements and points. `new` gets the element; `None` for fields.
fn recolour(
    scene: &mut Scene,
    chosen: &Chosen,
    new: impl Fn(Option<&Element>, Colour) -> Colour + Sync + Send,
) {
    // The instances' own colours are replaced first, while the elements still have their old colours.
    let own: Vec<Option<Colour>> =
        selected(scene, chosen).map(|i| i.colour.map(|c| new(Some(scene.element(i)), c))).collect();
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
