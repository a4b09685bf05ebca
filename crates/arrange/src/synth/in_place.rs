//! Elements of a drawing that are turned, mirrored and resized where they stand.
//!
//! Methods that make a drawing's arrangement anew place elements as the drawing has them. If others are asked for, each
//! element, or each whole motif, is changed by chance in the end, about its middle, as long as it keeps its distance from
//! all others. What touches others, has others inside, or runs on from copy to copy stays as it is: it may be a part of
//! something.

use super::compose::{Arranged, What};
use super::covered::MOST_COUNTED;
use crate::arrange::Plan;
use crate::arrange::context::DrawnContext;
use crate::arrange::taken::{REACH, TakenPixels, usual_clearance};
use crate::arrange::variation::Variation;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, Point, Vec2, rounded};
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::Mask;
use vtex_base::raster::contact::{ContactPage, gaps};
use vtex_base::sampling::stream;
use vtex_scene::element::Shape;
use vtex_scene::scene::{SynthParams, pixels};

/// Shares of the usual distance that are kept, one after another, by what has not been changed yet.
const CLEARANCES: [f64; 3] = [1.0, 0.6, 0.3];
/// Variations that are tried for each element at each of them.
const TRIES: usize = 10;
/// Things drawn at a time.
const AT_ONCE: usize = 512;

/// An element on the canvas, or all parts of a motif.
struct Thing {
    /// The shapes on the canvas if they may change, and their centroid.
    shapes: Vec<Shape>,
    middle: Point,
    /// What no other may come near: the pixels of the shapes, and of their holes if nothing lies in these.
    mask: Mask,
    /// Whether it ends, and neither touches others nor has any inside.
    is_free: bool,
    /// Distance to the nearest other, up to [`REACH`], in pixels.
    gap: u16,
}

/// Turns, mirrors and resizes elements as far as the plan's parameters ask for it. Their coverage is counted in the scene,
/// in `stage`.
///
/// # Errors
/// Those of `progress`.
pub(super) fn vary_in_place(
    arranged: &mut Arranged<'_>,
    plan: &Plan<'_>,
    stage: &'static str,
    progress: &dyn Progress,
) -> Result<()> {
    let params = &plan.params;
    if !params.varies() {
        return Ok(());
    }
    let go_on = || advance(progress, stage, 1, 2);
    go_on()?;
    if u64::from(params.width) * u64::from(params.height) > MOST_COUNTED {
        progress.warn_of_placing(
            "the texture is too large for elements to be turned, mirrored or resized: it has more than 100 megapixels",
        );
        return Ok(());
    }
    let numbers = arranged.thing_numbers();
    let (mut things, mut taken) = things(arranged, &numbers, plan, &go_on)?;
    let maps = varied(&mut things, &mut taken, params, &go_on)?;
    if maps.iter().any(Option::is_some) {
        arranged.report.period = None;
    } else if !maps.is_empty() {
        progress.warn_of_placing(
            "no element is turned, mirrored or resized: each touches others, has others inside, runs on from copy to \
             copy, or has no room; '--method descriptor' turns elements before it places them",
        );
    }
    for (placement, number) in arranged.placements.iter_mut().zip(numbers) {
        if let Some(map) = maps[number] {
            placement.transform = rounded(map * Affine::new(placement.transform));
        }
    }
    arranged.counted = Some(stage);
    Ok(())
}

/// How each thing is changed, if it is.
///
/// # Errors
/// Those of `go_on`.
fn varied(
    things: &mut [Thing],
    taken: &mut TakenPixels,
    params: &SynthParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<Option<Affine>>> {
    let clearance = usual_clearance(things.iter().filter(|thing| thing.is_free).map(|thing| thing.gap));
    let shortest = things.iter().filter_map(|thing| thing.mask.bounds());
    let shortest = shortest.map(|(x0, y0, x1, y1)| (x1 - x0).min(y1 - y0)).min().unwrap_or(1);
    let variations = Variation::all(params, None);
    let mut maps: Vec<Option<Affine>> = vec![None; things.len()];
    let mut order: Vec<usize> = (0..things.len()).filter(|k| things[*k].is_free).collect();
    stream(params.seed, "synth/in-place", u64::MAX).shuffle(&mut order);
    for (round, share) in CLEARANCES.into_iter().enumerate() {
        let clearance = libm::ceil(share * f64::from(clearance)) as i32;
        for &k in &order {
            if maps[k].is_some() {
                continue;
            }
            go_on()?;
            let thing = &mut things[k];
            let middle = thing.middle.to_vec2();
            let distance = clearance.min(i32::from(thing.gap));
            let mut random = stream(params.seed, "synth/in-place", (k * CLEARANCES.len() + round) as u64);
            taken.set_mask(&thing.mask, [0; 2], false);
            for _ in 0..TRIES {
                let [a, b, c, d] = variations[random.index(variations.len())].matrix;
                let map = Affine::translate(middle)
                    * Affine::new([a, b, c, d, 0.0, 0.0])
                    * Affine::translate(-middle);
                let mask = thing.mask_in(map);
                // Its own copies across the seams have been freed with it.
                let is_apart = mask.bounds().is_some_and(|(x0, y0, x1, y1)| {
                    let sides = [x1 - x0, y1 - y0];
                    (0..2).all(|k| !taken.wraps[k] || sides[k] + distance <= taken.size[k])
                });
                if is_apart && taken.is_free(&mask, [0; 2], distance, f64::from(shortest)) {
                    (thing.mask, maps[k]) = (mask, Some(map));
                    break;
                }
            }
            taken.set_mask(&thing.mask, [0; 2], true);
        }
    }
    Ok(maps)
}

impl Thing {
    /// The pixels that it takes when it is changed.
    fn mask_in(&self, map: Affine) -> Mask {
        let shapes: Vec<Shape> = self.shapes.iter().map(|shape| shape.moved(map)).collect();
        let mask = pixels::of_shapes(&shapes);
        pixels::with_holes(&shapes, &mask)
    }
}

/// The things on the canvas of each number, and the pixels that they and a drawing that stays take.
///
/// # Errors
/// Those of `go_on`.
fn things(
    arranged: &Arranged<'_>,
    numbers: &[usize],
    plan: &Plan<'_>,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(Vec<Thing>, TakenPixels)> {
    let library = &plan.libraries[0];
    let count = numbers.iter().max().map_or(0, |last| last + 1);
    let mut shapes = vec![Vec::new(); count];
    let (mut sums, mut ends) = (vec![(Vec2::ZERO, 0.0); count], vec![true; count]);
    for (k, (placement, &number)) in arranged.placements.iter().zip(numbers).enumerate() {
        if k.is_multiple_of(AT_ONCE) {
            go_on()?;
        }
        let What::Known(_, id, _) = placement.what else {
            ends[number] = false;
            continue;
        };
        let element = &library.elements[id.index()];
        let [x, y] = element.origin().map(f64::from);
        let map = Affine::new(placement.transform) * Affine::translate((-x, -y));
        shapes[number].extend(element.shapes.iter().map(|shape| shape.moved(map)));
        ends[number] &= !element.clipped;
        let [x, y] = element.centroid.map(f64::from);
        let (area, (sum, areas)) = (f64::from(element.area.max(1)), &mut sums[number]);
        (*sum, *areas) = (*sum + area * (map * Point::new(x, y)).to_vec2(), *areas + area);
    }
    let mut masks: Vec<Mask> = Vec::with_capacity(count);
    for shapes in shapes.chunks(AT_ONCE) {
        go_on()?;
        masks.extend(parallel::map(shapes, |shapes| pixels::of_shapes(shapes)));
    }
    let standing = plan.controls.context.iter().flat_map(DrawnContext::shapes);
    masks.extend(standing.map(|shape| pixels::of_shapes(&[shape])));
    let size = [plan.params.width, plan.params.height].map(|v| v as i32);
    let wraps = [plan.params.tile.x, plan.params.tile.y];
    let mut taken = TakenPixels::none([0; 2], size, wraps);
    masks.iter().for_each(|mask| taken.set_mask(mask, [0; 2], true));
    let (page, mut contacts) = ContactPage::new(size, wraps, &masks);
    page.near(REACH, &mut contacts, go_on)?;
    let gaps = gaps(&contacts, masks.len(), REACH);
    let mut things: Vec<Thing> = Vec::with_capacity(count);
    for (k, (shapes, mask)) in shapes.into_iter().zip(masks).enumerate() {
        go_on()?;
        let (middle, gap) = ((sums[k].0 / sums[k].1).to_point(), gaps[k]);
        let mut thing = Thing { shapes, middle, mask, is_free: ends[k] && gap > 0, gap };
        if thing.is_free {
            let filled = pixels::with_holes(&thing.shapes, &thing.mask);
            let holes = filled.without(&thing.mask);
            thing.is_free = taken.is_free(&holes, [0; 2], 0, 1.0);
            thing.mask = if thing.is_free { filled } else { thing.mask };
        }
        if !thing.is_free {
            thing.shapes.clear();
        }
        things.push(thing);
    }
    things.iter().for_each(|thing| taken.set_mask(&thing.mask, [0; 2], true));
    Ok((things, taken))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::testing::{Warnings, drawing_of, fill};
    use crate::synth::{Controls, SynthReport, synthesize_with};
    use std::collections::BTreeMap;
    use vtex_base::raster::LabelMap;
    use vtex_scene::library::{ElementId, Library, Motif, MotifPart};
    use vtex_scene::scene::{Instance, Method, Scene, Tile};

    /// Side of the page.
    const SIDE: u32 = 120;

    /// Bars in six rows; two of them have a square at their side.
    fn drawing() -> Library {
        let mut map = LabelMap::filled(SIDE, SIDE, 0);
        let bars = (0..36).map(|k| [3 + k % 6 * 20, 7 + k / 6 * 20, 13, 5]);
        for (area, label) in bars.chain([[3, 12, 4, 4], [63, 72, 4, 4]]).zip(1..) {
            fill(&mut map, label, area);
        }
        drawing_of(&map)
    }

    fn methods() -> &'static [Method] {
        if cfg!(feature = "clustered") { &[Method::Period, Method::Clustered] } else { &[Method::Period] }
    }

    fn params(method: Method, tile: bool) -> SynthParams {
        let tile = Tile { x: tile, y: tile };
        SynthParams { width: 3 * SIDE, height: 2 * SIDE, seed: 3, method, tile, ..SynthParams::default() }
    }

    fn made(library: &Library, params: &SynthParams) -> (Scene, SynthReport, Vec<String>) {
        let warnings = Warnings::default();
        let libraries = std::slice::from_ref(library);
        let (scene, report) = synthesize_with(libraries, params, &Controls::default(), &warnings).unwrap();
        scene.check().unwrap();
        (scene, report, warnings.0.into_inner().unwrap())
    }

    /// An element on the canvas.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Placed {
        /// Width of its shapes.
        width: f64,
        middle: [f64; 2],
        /// In degrees.
        angle: f64,
        is_mirrored: bool,
        scale: f64,
    }

    fn all(scene: &Scene) -> Vec<Placed> {
        let placed = |i: &Instance| {
            let bounds = scene.element(i).bounds();
            let [a, b, c, d, ..] = i.affine().as_coeffs();
            let (at, area) = (i.affine() * bounds.center(), a * d - b * c);
            Placed {
                width: bounds.width(),
                middle: [at.x, at.y],
                angle: libm::atan2(area.signum() * b, area.signum() * a).to_degrees(),
                is_mirrored: area < 0.0,
                scale: libm::sqrt(area.abs()),
            }
        };
        scene.instances().map(placed).collect()
    }

    fn is_near(a: [f64; 2], b: [f64; 2]) -> bool {
        (0..2).all(|k| (a[k] - b[k]).abs() < 1.0)
    }

    #[test]
    fn elements_are_changed_about_their_middles_and_keep_apart() {
        let mut library = drawing();
        for (&method, tile) in methods().iter().flat_map(|m| [(m, false), (m, true)]) {
            library.arrangement.periodic = method == Method::Period || tile;
            let plain = params(method, tile);
            let asked = SynthParams { rotate: Some(40.0), mirror: true, scale_jitter: 10.0, ..plain.clone() };
            let (before, (scene, report, warnings)) = (made(&library, &plain).0, made(&library, &asked));
            assert_eq!(warnings, Vec::<String>::new());
            assert!(report.overlap.hidden == 0.0, "{:?}", report.overlap);
            let [before, after] = [&before, &scene].map(all);
            assert_eq!(before.len(), after.len());
            let (mut bars, mut turned, mut mirrored) = (0, 0, 0);
            for (old, new) in before.iter().zip(&after) {
                assert!(is_near(old.middle, new.middle), "{old:?} {new:?}");
                assert!(new.angle.abs() < 40.01 && (1.0 / 1.1001..1.1001).contains(&new.scale), "{new:?}");
                let is_bar = old.width > 6.0;
                // Clusters may part a square from its bar.
                assert!(is_bar || method == Method::Clustered || new == old, "{new:?}");
                bars += usize::from(is_bar);
                turned += usize::from(new.angle != 0.0);
                mirrored += usize::from(new.is_mirrored);
            }
            // Two of 36 stay with their squares.
            assert!(10 * turned > 8 * bars && turned < bars, "{method:?} {tile}: {turned} of {bars}");
            assert!(3 * mirrored > turned && 3 * mirrored < 2 * turned, "{mirrored} of {turned}");
        }
    }

    #[test]
    fn what_has_no_room_or_belongs_to_others_stays() {
        // Rings with a square inside, and with none.
        let mut map = LabelMap::filled(SIDE, SIDE, 0);
        for k in 0..16u32 {
            let (x0, y0) = (5 + k % 4 * 30, 5 + k / 4 * 30);
            for (x, y) in (0..20u32).flat_map(|y| (0..20).map(move |x| (x, y))) {
                let depth = x.min(y).min(19 - x).min(19 - y);
                let label = if depth < 3 { k + 1 } else { 17 + k / 2 };
                if depth < 3 || depth > 6 && k % 2 == 0 {
                    map.set(x0 + x, y0 + y, label);
                }
            }
        }
        let library = drawing_of(&map);
        let asked = SynthParams { rotate: Some(30.0), ..params(Method::Period, true) };
        let (scene, _, _) = made(&library, &asked);
        let rings = |scene: &Scene| all(scene).into_iter().filter(|e| e.width > 15.0).collect::<Vec<_>>();
        let turned = rings(&scene).iter().filter(|ring| ring.angle != 0.0).count();
        assert_eq!(rings(&scene).len(), 96);
        assert!((30..=48).contains(&turned), "{turned}");
        // Stripes side by side.
        let mut map = LabelMap::filled(SIDE, SIDE, 0);
        (0..SIDE * SIDE).for_each(|i| map.set(i % SIDE, i / SIDE, 1 + i % SIDE / 10));
        let packed = drawing_of(&map);
        let (scene, _, warnings) = made(&packed, &asked);
        assert!(all(&scene).iter().all(|e| e.angle == 0.0));
        assert!(warnings.iter().any(|w| w.starts_with("no element is turned")), "{warnings:?}");
    }

    #[test]
    fn an_element_keeps_apart_from_its_own_copies() {
        let mut map = LabelMap::filled(120, 40, 0);
        (0..6).for_each(|y| (0..100).for_each(|x| map.set(5 + x, 10 + y, 1)));
        let library = drawing_of(&map);
        let tile = Tile { x: true, y: true };
        for seed in 0..12 {
            let asked = SynthParams {
                width: 120,
                height: 40,
                seed,
                tile,
                method: Method::Period,
                rotate: Some(90.0),
                ..SynthParams::default()
            };
            let (scene, _, _) = made(&library, &asked);
            assert!(all(&scene).iter().all(|bar| bar.angle.abs() < 20.0), "{:?}", all(&scene));
        }
    }

    #[test]
    fn motifs_are_changed_as_wholes() {
        let mut library = drawing();
        let part = |k: usize| MotifPart { element: ElementId::after(k), periods: [0; 2] };
        let pair = |k: usize| Motif { kind: 0, parts: vec![part(2 * k), part(2 * k + 1)] };
        library.motifs = (3..18).map(pair).collect();
        for &method in methods() {
            let plain = params(method, true);
            let asked = SynthParams { rotate: Some(15.0), ..plain.clone() };
            let [before, after] = [plain, asked].map(|params| made(&library, &params).0);
            let mut motifs = BTreeMap::new();
            for ((old, new), i) in all(&before).into_iter().zip(all(&after)).zip(after.instances()) {
                if let Some(motif) = i.motif {
                    motifs.entry(motif).or_insert_with(Vec::new).push((old, new));
                }
            }
            let mut turned = 0;
            for parts in motifs.values() {
                let [a, b] = &parts[..] else { panic!("{} parts", parts.len()) };
                assert!((a.1.angle - b.1.angle).abs() < 1e-3);
                turned += usize::from(a.1.angle != 0.0);
                let between = |a: Placed, b: Placed| [0, 1].map(|k| 0.5 * (a.middle[k] + b.middle[k]));
                assert!(is_near(between(a.0, b.0), between(a.1, b.1)));
            }
            assert!(motifs.len() > 60 && 10 * turned > 5 * motifs.len(), "{turned} of {}", motifs.len());
            // Parts beyond the canvas turn with the others.
            let (ends, _, _) = made(&library, &SynthParams { rotate: Some(15.0), ..params(method, false) });
            let mut parts: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
            for (placed, i) in all(&ends).into_iter().zip(ends.instances()) {
                parts.entry(i.motif.unwrap_or(u32::MAX)).or_default().push(placed.angle);
            }
            parts.remove(&u32::MAX);
            let is_whole = |angles: &Vec<f64>| angles.len() == 2 && (angles[0] - angles[1]).abs() < 1e-3;
            assert!(parts.len() > 60 && parts.values().all(is_whole), "{parts:?}");
        }
    }
}
